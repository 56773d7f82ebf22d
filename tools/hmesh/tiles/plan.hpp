// tools - TilePlan: what a job of `hmesh job` makes, as its file plan.json says it: the image, the options and how it is cut. Its
// tasks follow from it:
//
//     look_L_X_Y    how the error of a tile of level L falls with its vertices, and how many its sides need: its receipt
//     shares_L      how many vertices each tile of the level gets, and how closely sides follow their samples: its receipt
//     tile_L_X_Y    the mesh of a tile, from the image and the shares: a file of tiles/
//     seams_L_Y     whether the tiles of a row, and of the row below, meet bit for bit: its receipt
//     index         what all tiles are together: tiles/index.json
//
// Neighbours share a row of samples, which are points here (hmesh/mesh/samples.hpp), and a tile's side follows from that row
// alone (hmesh::Annealed::border_tolerance): so no tile waits for another, and there is one reduction a level, the shares.
#ifndef HMESH_TOOLS_TILES_PLAN_HPP
#define HMESH_TOOLS_TILES_PLAN_HPP

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arguments/tile_job.hpp"
#include "hmesh/image/image_view.hpp"
#include "job/folder.hpp"
#include "job/input.hpp"
#include "job/phases.hpp"
#include "tiles/levels.hpp"
#include "tiles/tile_image.hpp"

namespace tool {

struct TilePlan {
    job::Folder folder{""};
    std::string identity;
    job::Input input;
    std::string path;  // of the image on this machine
    int width = 0, height = 0, channels = 0, bits = 0;
    TileOptions options;
    std::vector<TileLevel> levels;  // the finest first

    [[nodiscard]] const TileLevel& level(int number) const { return levels[static_cast<std::size_t>(number)]; }
};

enum class TileTaskKind : std::uint8_t { look, shares, tile, seams, index };

struct TileTask {
    TileTaskKind kind = TileTaskKind::index;
    int level = 0, x = 0, y = 0;  // of a look and a tile; of shares the level, of seams level and y
};

// What returns a string returns "" or what is wrong, a sentence.

// Looks at the image's header and writes the plan and the engines' files. A plan that is there already may be the same.
[[nodiscard]] std::string make_tile_plan(const TileJob& job, TilePlan& plan);

// Of a job's folder, for this program. `input`: where the image is on this machine; empty: where it was planned.
[[nodiscard]] std::string read_tile_plan(const std::string& folder, const std::string& input, TilePlan& plan);

// Opens the image, if it is that of the plan.
[[nodiscard]] std::string open_planned(const TilePlan& plan, TileImage& image);

[[nodiscard]] std::vector<job::Phase> phases_of(const TilePlan& plan);
[[nodiscard]] std::string name_of(const TilePlan& plan, const TileTask& task);
[[nodiscard]] std::string find_task(const TilePlan& plan, const std::string& name, TileTask& task);

// The samples of its level that a tile has, those that it shares with its neighbours included.
[[nodiscard]] hmesh::kit::Rect rect_of(const TilePlan& plan, const TileTask& tile);
// Its file's name without ending: level, row, column, so that names sort as the picture is read.
[[nodiscard]] std::string file_of(const TilePlan& plan, const TileTask& tile);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_PLAN_HPP
