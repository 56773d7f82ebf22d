// tools - a coarser level of detail, as it is written and reported.
#ifndef HMESH_TOOLS_RESULTS_LEVEL_HPP
#define HMESH_TOOLS_RESULTS_LEVEL_HPP

#include <optional>

#include "hmesh/result.hpp"
#include "meshing.hpp"

namespace tool {

struct Level {
    hmesh::Result outcome;
    std::optional<LightMesh> light;  // its twin for .glb, where --fit-space is each
};

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_LEVEL_HPP
