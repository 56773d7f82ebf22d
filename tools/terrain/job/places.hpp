// hmesh-terrain - where viewers of maps find a job's tiles: tileset.json (3D Tiles 1.1) and layer.json (Cesium's quantized-mesh).
//
// Sources: OGC, 3D Tiles Specification 1.1, 22-025r4; Cesium, quantized-mesh-1.0; Mapbox, TileJSON 2.1.0.
#ifndef HMESH_TERRAIN_JOB_PLACES_HPP
#define HMESH_TERRAIN_JOB_PLACES_HPP

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "job/receipt.hpp"
#include "terrain/dem.hpp"
#include "terrain/job/plan.hpp"
#include "terrain/job/tasks.hpp"

namespace terrain {

struct PlacedTile {
    TaskName task;
    std::string file;  // as the JSON file, which is beside it, names it
    TileFacts facts;
};

// Tiles as a tree of boxes, each cut in four, in local metres; where the input is in degrees, on the plane that touches the
// ellipsoid in its middle.
[[nodiscard]] job::Json tileset_value(const Plan& plan, const Georeference& place, const std::vector<PlacedTile>& tiles);

// Of tiles that are those of Cesium's grid.
[[nodiscard]] job::Json layer_value(const Plan& plan, const std::vector<PlacedTile>& tiles);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_PLACES_HPP
