/// \file
/// Terrain, beside hmesh/hmesh.hpp: meshes that differ from no sample by more than a bound, with the recipe Bounded, and
/// exporters that write heights as geometry. write_height_ply(), write_height_obj(), write_height_glb(), write_height_stl(),
/// write_solid_stl(), write_quantized_mesh().
///
/// This header defines nothing itself.
#ifndef HMESH_TERRAIN_HPP
#define HMESH_TERRAIN_HPP

#include "hmesh/io/heights/height_glb.hpp"
#include "hmesh/io/heights/height_models.hpp"
#include "hmesh/io/heights/height_stl.hpp"
#include "hmesh/io/heights/quantized_mesh.hpp"
#include "hmesh/methods/bounded/bounded.hpp"

#endif  // HMESH_TERRAIN_HPP
