// hmesh-terrain - Plan: what a job makes, as its file plan.json says it: the input, the options and how it is cut. Its tasks
// follow from it:
//
//     tile_L_X_Y    a tile of level L, from the input: a file of tiles/
//     seams_L_Y     whether the tiles of a row, and of the row south of it, meet bit for bit: from their files
//     index         what all tiles are together: index.json, and tileset.json or layer.json, in tiles/
//
// Its identity is that of the file (job/plan_file.hpp).
#ifndef HMESH_TERRAIN_JOB_PLAN_HPP
#define HMESH_TERRAIN_JOB_PLAN_HPP

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "job/folder.hpp"
#include "job/input.hpp"
#include "job/phases.hpp"
#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"
#include "terrain/frame.hpp"
#include "terrain/job/levels.hpp"
#include "terrain/readers/readers.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

struct Plan {
    job::Folder folder{""};
    std::string identity;
    job::Input input;
    std::string reader;         // of the input, as it was planned
    int width = 0, height = 0;  // samples
    // What else was read of the input, by name, as JSON. Files beside it may say it, of which its identity knows nothing.
    std::map<std::string, std::string> metadata;
    Arguments arguments;             // of all tiles, the input where it is on this machine
    Frame frame;                     // of all tiles
    std::vector<Level> levels;       // the finest first
    bool has_skirts = false;         // of tiles
    std::optional<GlobeGrid> globe;  // of the finest level

    [[nodiscard]] const Level& level(int number) const { return levels[static_cast<std::size_t>(number)]; }
};

enum class TaskKind : std::uint8_t { tile, seams, index };

struct TaskName {
    TaskKind kind = TaskKind::index;
    int level = 0, x = 0, y = 0;  // of a tile; of seams level and y
};

// What returns a string returns "" or what is wrong, a sentence.

// Looks at the input and writes the plan and the engines' files. A plan that is there already may be the same.
[[nodiscard]] std::string make_plan(const JobArguments& job, Plan& plan);

// Of a job's folder, for this program. `input`: where the input is on this machine; empty: where it was planned.
[[nodiscard]] std::string read_plan(const std::string& folder, const std::string& input, Plan& plan);

// Opens the input, if it is that of the plan.
[[nodiscard]] std::string open_input(const Plan& plan, DemPointer& dem);

[[nodiscard]] std::vector<job::Phase> phases_of(const Plan& plan);
[[nodiscard]] std::string name_of(const Plan& plan, const TaskName& task);
[[nodiscard]] std::string find_task(const Plan& plan, const std::string& name, TaskName& task);

// The tile, with its file's path.
[[nodiscard]] Tile tile_of(const Plan& plan, const TaskName& task);
// Of a job whose tiles are Cesium's: which one it is there, counted from the west and from the south.
struct GlobeTile {
    int zoom = 0, x = 0, y = 0;
};
[[nodiscard]] GlobeTile globe_tile(const Plan& plan, const TaskName& task);
// Its file as a path from the folder tiles/ on.
[[nodiscard]] std::string tile_file(const Plan& plan, const TaskName& task);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_PLAN_HPP
