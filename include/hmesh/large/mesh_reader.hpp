/// \file
/// mesh_image() of an image that is not in memory.
///
///     hmesh::ImageReader<std::uint8_t, 3> reader{width, height, read};    // image/image_reader.hpp
///     const hmesh::Result result = hmesh::mesh_image(reader);
///
/// The mesh is that of mesh_image() of a view of the same pixels, byte for byte. What is in memory are the mesh and, of the
/// image, the tiles at work; images have at most kit::max_side px a side, but any number of pixels, up to 2^32.
///
/// How often pixels are read: once for the first points (of float samples once more before that), once for their colours, and
/// then once for each pass over the tiles, with what stands out of the tiles; by what the picture is 15 to 18 times in all for
/// Effort::draft, 22 to 28 for fast, 28 to 44 for normal, and once or twice more for each sweep of longer annealing.
/// docs/scale.md has more of that.
#ifndef HMESH_LARGE_MESH_READER_HPP
#define HMESH_LARGE_MESH_READER_HPP

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_reader.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/options.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Turns an image that is not in memory into a mesh of the number of vertices that options.target asks for.
///
/// \param reader        the image, which check() must accept
/// \param options       as for an image in memory. Weights are a view, as there, of at most kit::max_pixels
/// \param recipe        the default recipe with its options; others look at the image in their own way, and want it in memory
/// \param parallel_for  executor, as for an image in memory. It calls reader.read() from its threads, one at a time unless
///     reader.is_concurrent
/// \return              the mesh, its error, and a status, as for an image in memory, and besides:
///     - read_failed where reader.read() returned false, with the rectangle in message() (no mesh). The work is then given up as
///       if it were cancelled; options.progress is not called any more;
///     - not_finite where a sample is not finite that was, when it was read before (no mesh);
///     - target_out_of_range where more than kit::max_pixels vertices are asked for (no mesh).
///
/// Memory: 0.28 KB a vertex asked for with Effort::draft, 0.54 KB with normal, and for each tile at work its pixels, its
/// moment table and 0.6 KB for each vertex placed there; images of up to 4194304 px (of 4 channels 3.3 million, of 16 1.3) are
/// one table where they are 16384 px wide at most, 4096 with weights. Of periodic images 4 bytes a pixel.
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE Result mesh_image(const ImageReader<T, C>& reader, const Options& options = {},
                                                   const Annealed& recipe = {}, const ParallelFor& parallel_for = {});

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

/// Compiles mesh_image() for readers of images of C channels of type T; where and why, see mesh_image.hpp.
#define HMESH_INSTANTIATE_READER(T, C)                                                                           \
    template ::hmesh::Result hmesh::mesh_image<T, C>(const ::hmesh::ImageReader<T, C>&, const ::hmesh::Options&, \
                                                     const ::hmesh::Annealed&, const ::hmesh::ParallelFor&);

#include "hmesh/large/mesh_reader.ipp"

#endif  // HMESH_LARGE_MESH_READER_HPP
