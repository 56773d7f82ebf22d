/// \file
/// compact_image(): an image in a given number of bytes, as a compact file.
///
/// Nothing is rounded but what was meshed for it: the mesh is annealed with its vertices on the lattice of the file
/// (rate/lattice_mesh.hpp). How coarse that lattice is and the steps of colours are, and with it how many vertices the bytes pay
/// for, is tried: first a quick mesh of each lattice that comes into question, at several steps of colours; then what promises
/// most, in all the bytes (rate/compact_search.hpp).
#ifndef HMESH_RATE_COMPACT_IMAGE_HPP
#define HMESH_RATE_COMPACT_IMAGE_HPP

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/rate/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// An image as a compact file of at most options.bytes bytes: vertices, lattice and steps of colours are chosen together, for the
/// least error found, as the image is drawn from the file. Of the bytes all but 2 % are used, unless fewer give a PSNR of 55 dB,
/// all pixels are vertices, or four vertices have less error than as many as are paid for, as of noise. Same bytes for any
/// executor. Takes a run of mesh_image() and a draft, or seven runs where the bytes are so few that several meshes are tried, and
/// nearly as long again on the lattice: 0.4 s for 300 bytes of a photograph with Effort::normal, 0.5 s for 3,000; 1.0 s and 1.4 s
/// with Effort::fine, which is 0.02 to 0.2 dB better.
///
/// \param view          the image, of 1 to 4 channels; those of more than 8 bits keep 8
/// \param options       how many bytes, and which profile
/// \param recipe        how much work goes into the last meshes, and all else about them; start must be null
/// \param parallel_for  executor
/// \return              the file and its mesh; or no bytes and the status of mesh_image(), cancelled among them, or
///                      target_out_of_range with the number of bytes that 4 vertices take
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE CompactImage compact_image(const ImageView<T, C>& view, const CompactImageOptions& options = {},
                                                            const Annealed& recipe = {}, const ParallelFor& parallel_for = {});

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

/// Compiles compact_image() for images of C channels of type T; where and why, see mesh_image.hpp. It needs
/// HMESH_INSTANTIATE(std::uint8_t, C) too, whatever T is.
#define HMESH_INSTANTIATE_COMPACT(T, C)                                                                                      \
    template ::hmesh::CompactImage hmesh::compact_image<T, C>(const ::hmesh::ImageView<T, C>&,                               \
                                                              const ::hmesh::CompactImageOptions&, const ::hmesh::Annealed&, \
                                                              const ::hmesh::ParallelFor&);

#include "hmesh/rate/compact_image.ipp"

#endif  // HMESH_RATE_COMPACT_IMAGE_HPP
