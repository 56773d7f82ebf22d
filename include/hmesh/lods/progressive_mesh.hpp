/// \file
/// progressive_mesh(): levels of detail that share one vertex buffer. Level k draws the first n_k vertices with an index list of
/// its own.
///
///     const hmesh::Result finest = hmesh::mesh_image(view, options);
///     const hmesh::ProgressiveMesh nested = hmesh::progressive_mesh(view, finest.mesh);
///     upload_vertices(nested.mesh);                                         // once
///     for (const hmesh::ProgressiveLevel& level : nested.levels) upload_indices(level.faces, level.vertices);
///
/// From the finest mesh on, the vertices whose loss raises the error least are merged into neighbours (edit/collapse.hpp), a few
/// per cent at a time, each judged after the colours around it are fitted anew and edges are flipped: positions stay. A level is
/// what is left when its number of vertices is reached. The colours of the one buffer are a trade between the levels: least
/// squares over all of them, each weighted by its share over its error, which makes a weighted sum of their PSNRs largest.
/// After H. Hoppe, Progressive meshes, SIGGRAPH 1996, with flips and without geomorphs.
///
/// The price, of Lena from 8,192 and kodim03 from 16,384 vertices: the finest level loses 0.2 and 0.4 dB, the coarser ones are
/// 0.9 to 2.4 dB below those of mesh_lods(), the coarsest most. What it buys: half of the vertex memory, and a level is a range
/// of indices.
///
/// Cost: some 60 us a vertex of the finest mesh, half of mesh_image() at effort normal; one moment table of the whole image (16
/// bytes a pixel for 8-bit RGB, 64 beyond 4104 px of width) and 2.7 KB a vertex, 1.9 KB with one level. One piece of work, but
/// for sums.
#ifndef HMESH_LODS_PROGRESSIVE_MESH_HPP
#define HMESH_LODS_PROGRESSIVE_MESH_HPP

#include <cstddef>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/lods/mesh_lods.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of progressive_mesh().
struct ProgressiveOptions {
    /// How many levels, the finest included, in [1, 32]. There are fewer before a level would have less than 4 vertices.
    int levels = 5;
    /// How much the error of a level in dB counts when the colours are fitted, as a share of the next finer one's, in [0, 1].
    /// Each level that is drawn at its size covers half of the pixels of the one before. 0: the finest level alone counts.
    double coarser_weight = 0.5;
};

/// Whether the options are in range; else Errc::invalid_argument with value and bound.
[[nodiscard]] HMESH_COLD inline Status check(const ProgressiveOptions& options) noexcept {
    LodOptions lods;
    lods.levels = options.levels;
    if (const Status status = check(lods); !status) return status;
    if (kit::is_within(options.coarser_weight, 0, 1)) return {};
    return {Errc::invalid_argument, "the weight of coarser levels must be in [0, 1]", options.coarser_weight, 1};
}

/// A level of a ProgressiveMesh.
struct ProgressiveLevel {
    std::size_t vertices = 0;     ///< n_k: it uses the vertices [0, n_k) of the buffer, all of them
    std::vector<Triangle> faces;  ///< they tile the image
    double energy = 0;            ///< sum of squared differences over pixels and channels, as Report::energy
    double psnr = 0;              ///< dB, as Report::psnr
};

/// Levels of detail over one vertex buffer.
struct [[nodiscard]] ProgressiveMesh {
    Mesh mesh;                             ///< the buffer, those of coarser levels first, and the faces of the finest level
    std::vector<ProgressiveLevel> levels;  ///< the finest first; empty: see `status`
    Status status;                         ///< ok, or why there are no levels

    /// Level k < levels.size() as a mesh to draw or write, valid as long as this object is unchanged.
    [[nodiscard]] MeshView view(std::size_t k) const noexcept {
        MeshView out = mesh.view();
        out.vertex_count = levels[k].vertices;
        out.faces = levels[k].faces.data();
        out.face_count = levels[k].faces.size();
        return out;
    }
};

/// Orders the vertices of a mesh so that prefixes of them are its levels of detail.
///
/// \param view          the image that the mesh was made of
/// \param finest        the finest level: a mesh of mesh_image(), or any mesh that Annealed::start takes. It keeps its vertices
///     and faces, in another order; its colours change
/// \param options       progress, limits, weights, round_colors, premultiplied and samples are those of mesh_image(), with the
///     values that the mesh was made with; channel_weights that differ and periodic are refused, the others say nothing, but what
///     mesh_image() refuses of them is refused too
/// \param nested_options  how many levels, of n, n / 2, n / 4 .. vertices, and what they count; there are fewer levels where no
///     more vertices can be removed
/// \param parallel_for  executor of sums; the order is found on the calling thread
/// \return              the levels, or none and a status: what mesh_image() says of image and options, invalid_argument for a
///     mesh that is not of this image or a number of levels out of range, image_too_large, cancelled
///
/// The same input gives the same bytes with any executor.
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE ProgressiveMesh progressive_mesh(const ImageView<T, C>& view, const Mesh& finest,
                                                                  const Options& options = {},
                                                                  const ProgressiveOptions& nested_options = {},
                                                                  const ParallelFor& parallel_for = {});

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

/// Compiles progressive_mesh() for images of C channels of type T; where and why, see mesh_image.hpp. It needs
/// HMESH_INSTANTIATE(T, C) too.
#define HMESH_INSTANTIATE_PROGRESSIVE(T, C)                                                                                      \
    template ::hmesh::ProgressiveMesh hmesh::progressive_mesh<T, C>(const ::hmesh::ImageView<T, C>&, const ::hmesh::Mesh&,       \
                                                                    const ::hmesh::Options&, const ::hmesh::ProgressiveOptions&, \
                                                                    const ::hmesh::ParallelFor&);

#include "hmesh/lods/progressive_mesh.ipp"

#endif  // HMESH_LODS_PROGRESSIVE_MESH_HPP
