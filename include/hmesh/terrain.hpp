/// \file
/// Terrain, beside hmesh/hmesh.hpp: meshes that differ from no sample by more than a bound, with the recipe Bounded.
///
/// This header defines nothing itself.
#ifndef HMESH_TERRAIN_HPP
#define HMESH_TERRAIN_HPP

#include "hmesh/methods/bounded/bounded.hpp"

#endif  // HMESH_TERRAIN_HPP
