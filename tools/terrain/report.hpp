// hmesh-terrain - what is said of a run: its summary, and its report as JSON.
#ifndef HMESH_TERRAIN_REPORT_HPP
#define HMESH_TERRAIN_REPORT_HPP

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"
#include "terrain/frame.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// What became of a tile.
struct TileEnd {
    enum class Kind : std::uint8_t {
        made,
        empty,   // it has no data: there is no file
        kept,    // of a run before this one: only its samples are known
        failed,  // and those that were not begun
    } kind = Kind::failed;
    std::size_t vertices = 0, triangles = 0;
    std::size_t no_data = 0;                   // samples of the tile without data
    std::size_t samples = 0, own_no_data = 0;  // its own, and those of them without data
    double max_error = 0, sum_of_squares = 0;  // of the file, as it was measured
    std::size_t measured = 0;                  // samples that were
    double asked = 0;                          // the bound that the mesh was made with, so much less than the one asked for
    bool is_tighter = false;                   // than that of its neighbours' borders
    double seconds = 0;
};

// What all tiles are together, then each of them; no seconds.
[[nodiscard]] nlohmann::ordered_json report_value(const Arguments& arguments, const Dem& dem, const Frame& frame,
                                                  const std::vector<Tile>& tiles, const std::vector<TileEnd>& ends);

// The same as text, with the seconds of the run and of each tile.
[[nodiscard]] std::string report_json(const Arguments& arguments, const Dem& dem, const Frame& frame,
                                      const std::vector<Tile>& tiles, const std::vector<TileEnd>& ends, double seconds);

void print_summary(std::FILE* to, const Arguments& arguments, const Dem& dem, const std::vector<Tile>& tiles,
                   const std::vector<TileEnd>& ends, double seconds);

}  // namespace terrain

#endif  // HMESH_TERRAIN_REPORT_HPP
