/// \file
/// drop_transparent(): the mesh of a sprite without the faces that show nothing, those that hide everything first.
///
/// A GPU blends every pixel of every face, also where alpha is 0, and most of a sprite is air. Faces whose alpha is nowhere
/// above a threshold are dropped, with the vertices that only they used; what is left covers a part of the image's rectangle and
/// is transparent elsewhere (render()). Faces that are opaque come first and are counted: they can be drawn without blending,
/// front to back, and hide what is behind them from the depth buffer on.
///
///     hmesh::Options options;
///     options.premultiplied = true;  // colours under transparent pixels do not count
///     options.target = hmesh::Target::at_most(500);
///     hmesh::Result result = hmesh::mesh_image(view, options);
///     const hmesh::SpriteReport sprite = hmesh::drop_transparent(result, view, options);
///
/// O(vertices + faces), and with a report some 10 ns for each pixel of the faces dropped.
#ifndef HMESH_SPRITE_HPP
#define HMESH_SPRITE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/torus.hpp"
#include "hmesh/mesh/unrolled.hpp"
#include "hmesh/options.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// What drop_transparent() did, or why it did nothing.
struct [[nodiscard]] SpriteReport {
    /// Faces [0, opaque_faces) of the mesh are opaque: the alpha of their vertices is full in 8 bits, 254.5 / 255 of the peak or
    /// more.
    std::size_t opaque_faces = 0;
    std::size_t dropped_faces = 0;     ///< faces that are gone
    std::size_t dropped_vertices = 0;  ///< vertices that are gone: those that no face uses any more
    double area = 0;                   ///< px^2 of the faces that are left
    Status status;                     ///< ok, or why the mesh is as it was
};

namespace detail {

/// What becomes of a face.
enum class FaceAlpha : std::uint8_t { opaque, blended, dropped };

/// The kind of each face of a mesh that has alpha. O(faces).
[[nodiscard]] inline std::vector<FaceAlpha> face_alphas(const Mesh& mesh, double threshold) {
    const auto channels = static_cast<std::size_t>(mesh.channels);
    std::vector<FaceAlpha> kinds;
    kinds.reserve(mesh.faces.size());
    for (const Triangle& face : mesh.faces) {
        const auto alpha = [&](std::size_t k) { return static_cast<double>(mesh.colors[channels * face[k] + channels - 1]); };
        const auto [least, most] = std::minmax({alpha(0), alpha(1), alpha(2)});
        kinds.push_back(!kit::is_alpha_above(most, threshold, mesh.peak) ? FaceAlpha::dropped
                        : 255 * least >= 254.5 * mesh.peak               ? FaceAlpha::opaque
                                                                         : FaceAlpha::blended);
    }
    return kinds;
}

/// The area of a face, in px^2.
[[nodiscard]] inline double area_of(const Mesh& mesh, const Triangle& face) noexcept {
    return 0.5 *
           std::abs(kit::orient2d(kit::position(mesh, face[0]), kit::position(mesh, face[1]), kit::position(mesh, face[2])));
}

/// Removes the vertices that no face uses; the others keep their order. Returns how many are gone.
inline std::size_t remove_unused_vertices(Mesh& mesh) {
    const std::size_t count = mesh.vertex_count();
    const auto channels = static_cast<std::size_t>(mesh.channels);
    std::vector<unsigned char> is_used(count, 0);
    for (const Triangle& face : mesh.faces)
        for (const std::uint32_t v : face) is_used[v] = 1;
    std::vector<std::uint32_t> place(count);
    std::size_t next = 0;
    for (std::size_t v = 0; v < count; ++v) {
        if (is_used[v] == 0) continue;
        place[v] = static_cast<std::uint32_t>(next);
        std::copy_n(mesh.positions.begin() + static_cast<std::ptrdiff_t>(2 * v), 2,
                    mesh.positions.begin() + static_cast<std::ptrdiff_t>(2 * next));
        std::copy_n(mesh.colors.begin() + static_cast<std::ptrdiff_t>(channels * v), channels,
                    mesh.colors.begin() + static_cast<std::ptrdiff_t>(channels * next));
        ++next;
    }
    mesh.positions.resize(2 * next);
    mesh.colors.resize(channels * next);
    for (Triangle& face : mesh.faces)
        for (std::uint32_t& v : face) v = place[v];
    return count - next;
}

/// Whether a mesh and a threshold are ones that drop_transparent() can take. O(vertices + faces).
[[nodiscard]] inline Status check_sprite(const Mesh& mesh, double threshold) noexcept {
    if (const Status status = check(mesh, kit::max_channels); !status) return status;
    if (!kit::has_alpha(mesh.channels))
        return {Errc::invalid_argument, "a sprite has alpha, which meshes of 2 or 4 channels have", mesh.channels, 4};
    if (!kit::is_within(threshold, 0, 254))
        return {Errc::invalid_argument, "the threshold must be from 0 to 254, in 255ths of full alpha", threshold, 254};
    return {};
}

/// The same of what mesh_image() returned for an image of this size, and of the options that it was made with.
[[nodiscard]] inline Status check_sprite(const Result& result, int width, int height, int channels, const Options& options,
                                         double threshold, const ParallelFor& parallel_for) {
    const Mesh& mesh = result.mesh;
    if (const Status status = kit::check_weights(options.weights, width, height, parallel_for); !status) return status;
    if (const Status status = kit::check_channel_weights(options.channel_weights, channels); !status) return status;
    if (!result.has_mesh()) return {Errc::invalid_argument, "the result has no mesh", 0, 1};
    if (mesh.width != width || mesh.height != height || mesh.channels != channels)
        return {Errc::invalid_argument, "the result is that of another image, by its size or channels"};
    if (const Status status = check_sprite(mesh, threshold); !status) return status;
    const kit::Torus torus{width, height, mesh.periodic};
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)  // a periodic mesh may stand out
        if (mesh.periodic == Periodic::none ? !kit::is_inside(mesh, v) : !kit::is_near(kit::position(mesh, v), torus))
            return {Errc::invalid_argument, "the mesh has a position outside of the image, at vertex", v};
    return {};
}

/// The number of vertices as Report has it.
[[nodiscard]] HMESH_COLD inline std::size_t distinct_count(const Mesh& mesh) {
    if (mesh.periodic == Periodic::none) return mesh.vertex_count();
    std::size_t count = 0, v = 0;
    for (const std::uint32_t root : kit::tied_vertices(kit::positions_of(mesh.view()), {mesh.width, mesh.height, mesh.periodic}))
        count += root == v++ ? 1U : 0U;
    return count;
}

/// What the report of a mesh of this image becomes where faces of `kinds` are dropped, of which there are some.
template <int C>
HMESH_COLD void measure_sprite(Result& result, const std::vector<FaceAlpha>& kinds, const kit::ImageSource<C>& source,
                               const Options& options, double unit, const ParallelFor& parallel_for) {
    Mesh gone = result.mesh, kept = result.mesh;
    gone.faces.clear();
    kept.faces.clear();
    for (std::size_t f = 0; f < kinds.size(); ++f)
        (kinds[f] == FaceAlpha::dropped ? gone : kept).faces.push_back(result.mesh.faces[f]);
    kit::ChannelScale<C> scale;
    scale.share = kit::channel_shares<C>(options.channel_weights);
    const auto errors_of = [&](const Mesh& part) {
        if (part.periodic == Periodic::none) return kit::rendered_errors(part, source, parallel_for, scale);
        return kit::rendered_errors(kit::unrolled(part.view()), source, parallel_for, scale);
    };
    const double before = errors_of(gone).energy;
    std::fill(gone.colors.begin(), gone.colors.end(), 0.0F);
    const kit::RenderedError after = errors_of(gone);
    const double samples = scale.sum() * kit::weight_sum(options.weights, unit, source.width(), source.height(), parallel_for);
    result.report.energy = std::max(0.0, result.report.energy + (after.energy - before));
    result.report.max_error = std::max(after.largest, errors_of(kept).largest);
    result.report.psnr = kit::psnr_of_energy(result.report.energy, samples, source.peak());
}

}  // namespace detail

/// Drops the faces of a mesh of 2 or 4 channels whose alpha is at most a threshold at all three vertices, hence everywhere, and
/// the vertices that no face uses; puts opaque faces first. Faces and vertices that are left keep their order otherwise, and
/// their values. A mesh of which nothing is left is empty, and that is no error. Only the mesh of a premultiplied image stays
/// what it was to look at over any background: colours of straight ones are whatever transparent pixels hide.
///
/// \param mesh       as mesh_image() makes it, or any that check() accepts
/// \param threshold  alpha in 255ths of the peak, 0 to 254: what is at most 2 nobody sees
/// \return           what was done; invalid_argument or not_finite, with the mesh as it was, for a mesh without alpha or one that
///                   check() refuses, and a threshold out of range
inline SpriteReport drop_transparent(Mesh& mesh, double threshold = 2) {
    SpriteReport report;
    report.status = detail::check_sprite(mesh, threshold);
    if (!report.status) return report;
    const std::vector<detail::FaceAlpha> kinds = detail::face_alphas(mesh, threshold);
    std::vector<Triangle> left;
    left.reserve(mesh.faces.size());
    for (const detail::FaceAlpha kind : {detail::FaceAlpha::opaque, detail::FaceAlpha::blended}) {
        for (std::size_t f = 0; f < kinds.size(); ++f)
            if (kinds[f] == kind) left.push_back(mesh.faces[f]);
        if (kind == detail::FaceAlpha::opaque) report.opaque_faces = left.size();
    }
    report.dropped_faces = mesh.faces.size() - left.size();
    mesh.faces = std::move(left);
    for (const Triangle& face : mesh.faces) report.area += detail::area_of(mesh, face);
    report.dropped_vertices = detail::remove_unused_vertices(mesh);
    return report;
}

/// The same of what mesh_image() returned, whose report becomes that of the mesh that is left: pixels of no face are 0, as
/// render() draws them, colours and alpha alike.
///
/// \param result        of mesh_image(view, options); the stages of its report stay those of the mesh before
/// \param view          the image that was meshed, straight as it was
/// \param options       those that the mesh was made with, of which the weights of pixels and channels are read
/// \param threshold     alpha in 255ths of the peak, 0 to 254
/// \param parallel_for  executor of the faces dropped
/// \return              as above, also invalid_argument where result has no mesh of this image
template <class T, int C>
SpriteReport drop_transparent(Result& result, const ImageView<T, C>& view, const Options& options = {}, double threshold = 2,
                              const ParallelFor& parallel_for = {}) {
    static_assert(kit::has_alpha(C), "images of 2 or 4 channels have alpha");
    SpriteReport report;
    Mesh& mesh = result.mesh;
    report.status = check(view);
    if (report.status) report.status = detail::check_sprite(result, view.width, view.height, C, options, threshold, parallel_for);
    if (!report.status) return report;

    const std::vector<detail::FaceAlpha> kinds = detail::face_alphas(mesh, threshold);
    if (std::find(kinds.begin(), kinds.end(), detail::FaceAlpha::dropped) != kinds.end()) {
        Image<T, C> premultiplied;
        if (mesh.premultiplied) premultiplied = kit::premultiply(view, parallel_for);
        const double unit = kit::weight_unit(options.weights, parallel_for);
        const kit::ImageSource<C> source(mesh.premultiplied ? premultiplied.view() : view, options.weights, unit);
        detail::measure_sprite(result, kinds, source, options, unit, parallel_for);
    }
    report = drop_transparent(mesh, threshold);
    result.report.vertices = detail::distinct_count(mesh);
    result.report.faces = mesh.face_count();
    return report;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SPRITE_HPP
