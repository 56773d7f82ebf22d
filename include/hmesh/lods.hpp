/// \file
/// Levels of detail, beside hmesh/hmesh.hpp: mesh_lods(), meshes of n, n / 2, n / 4 .. vertices; progressive_mesh(), the same
/// over one vertex buffer; write_glb_lods(), which writes them as one .glb.
///
/// This header defines nothing itself.
#ifndef HMESH_LODS_HPP
#define HMESH_LODS_HPP

#include "hmesh/io/gltf_lods.hpp"
#include "hmesh/lods/mesh_lods.hpp"
#include "hmesh/lods/progressive_mesh.hpp"

#endif  // HMESH_LODS_HPP
