/// \file
/// write_height_stl(), write_solid_stl(): a mesh of heights as a binary STL file, a surface or a solid to be printed in three dimensions.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_STL_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_STL_HPP

#include "hmesh/core/status.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Writes a mesh as a binary STL file, an open surface, z up. (Signature; the body follows.)
inline Status write_height_stl(const MeshView& mesh, Sink sink, const HeightOptions& options = {});

/// The same with walls along all its borders, those of holes too, down to a flat base at the height `base`, in units, below all
/// heights: a watertight, manifold solid. (Signature; the body follows.)
inline Status write_solid_stl(const MeshView& mesh, double base, Sink sink, const HeightOptions& options = {});

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_STL_HPP
