#include "terrain/job/plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "job/plan_file.hpp"
#include "terrain/tile_maker.hpp"

namespace terrain {
namespace {

using job::Json;

constexpr char program[] = "hmesh-terrain";

// How many tiles of Cesium's grid there are around the Earth.
constexpr std::int64_t around(int zoom) noexcept { return std::int64_t{2} << zoom; }

// Whether tiles are those of Cesium's grid, to a millionth of a tile's side.
std::optional<GlobeGrid> find_globe(const Plan& plan, const Frame& frame, const Dem& dem) {
    if (plan.arguments.format != Format::quantized_mesh) return {};
    const int cells = plan.arguments.tile;
    if ((plan.width - 1) % cells != 0 || (plan.height - 1) % cells != 0) return {};
    const Extent first = extent_of(frame, dem.width, dem.height, {{}, 0, 0, cells + 1, cells + 1, ""});
    const double side = first[2] - first[0], zoom = std::log2(180 / side);
    const auto is_whole = [](double number) { return std::fabs(number - std::round(number)) < 1e-6; };
    const double west = (first[0] + 180) / side, north = (first[1] + 90) / side;
    if (!is_whole(zoom) || zoom < -0.5 || zoom > 30 || !is_whole(west) || !is_whole(north)) return {};
    if (std::fabs(first[3] - first[1] - side) > 1e-6 * side) return {};
    const int level = static_cast<int>(std::lround(zoom));
    const std::int64_t most = around(level), from_west = std::llround(west);
    if ((plan.width - 1) / cells > most) return {};  // tiles would have one name
    return GlobeGrid{level, static_cast<int>((from_west % most + most) % most), static_cast<int>(std::lround(north))};
}

Json frame_value(const Frame& frame) {
    Json value = {{"x", {frame.x_origin, frame.x_step}},
                  {"y", {frame.y_origin, frame.y_step}},
                  {"z", {frame.z_offset, frame.z_scale}},
                  {"metres", frame.metres},
                  {"origin", frame.origin},
                  {"extent", nullptr}};
    if (frame.extent) value["extent"] = *frame.extent;
    return value;
}

Frame frame_of(const Json& value) {
    Frame frame;
    const auto pair = [&](const char* name, double& first, double& second) {
        first = value[name][0].get<double>();
        second = value[name][1].get<double>();
    };
    pair("x", frame.x_origin, frame.x_step);
    pair("y", frame.y_origin, frame.y_step);
    pair("z", frame.z_offset, frame.z_scale);
    pair("metres", frame.metres[0], frame.metres[1]);
    pair("origin", frame.origin[0], frame.origin[1]);
    if (const Json& extent = value["extent"]; !extent.is_null()) frame.extent = extent.get<Extent>();
    return frame;
}

Json metadata_value(const Dem& dem) {
    return {{"geotransform", dem.place.is_known ? Json(dem.place.transform) : Json()},
            {"coordinate system", dem.place.crs},
            {"no-data value", dem.no_data && std::isfinite(*dem.no_data) ? Json(*dem.no_data) : Json()},
            {"mask", dem.has_mask},
            {"scale", dem.height_scale},
            {"offset", dem.height_offset}};
}

// Each as the text that a plan has, in which what is not UTF-8 is replaced.
std::map<std::string, std::string> texts_of(const Json& values) {
    std::map<std::string, std::string> texts;
    for (const auto& [name, value] : values.items()) texts[name] = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return texts;
}

// At most so many levels.
void cut(Plan& plan, int most) {
    plan.levels = find_levels(plan.arguments, plan.frame, plan.width, plan.height, plan.globe, most);
}

std::string parse_arguments(const std::string& input, const std::vector<std::string>& options, const std::string& format,
                            Plan& plan) {
    std::vector<std::string> words = {"-o", plan.folder.path("tiles." + format)};
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"--", input});
    CommandLine line = parse(words);
    plan.arguments = line.arguments;
    return line.wrong;
}

// A number of a name, with as many digits as the largest.
std::string digits(const Plan& plan, int number) {
    int most = 0;
    for (const Level& level : plan.levels) most = std::max({most, level.across - 1, level.down - 1});
    return job::digits(number, most);
}

std::string number_text(double number) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", number);
    return text;
}

}  // namespace

std::string make_plan(const JobArguments& job, Plan& plan) {
    plan = {};
    plan.folder = job::Folder(job.folder);
    if (std::string why = job::check_new(plan.folder); !why.empty()) return why;
    if (std::string why = job::find_input(job.input, job.hashes, plan.input); !why.empty()) return why;
    plan.arguments = job.dem;
    const std::string& input = plan.arguments.input = plan.input.path;
    DemPointer dem;
    if (const std::string why = open_dem(input, plan.arguments.reading, dem); !why.empty())
        return "cannot read '" + input + "': " + why;
    plan.width = dem->width;
    plan.height = dem->height;
    std::vector<Tile> tiles;
    Arguments one = plan.arguments;
    one.only = {{0, 0}};
    if (std::string why = find_tiles(one, *dem, tiles); !why.empty()) return why;
    if (std::string why = find_frame(plan.arguments, *dem, plan.frame); !why.empty()) return why;
    plan.globe = find_globe(plan, plan.frame, *dem);
    cut(plan, job.levels);
    if (const auto levels = static_cast<int>(plan.levels.size()); levels < job.levels)
        return "'" + input + "' has " + std::to_string(levels) + " levels, not " + std::to_string(job.levels) +
               (plan.globe ? ": no tile of Cesium's next zoom lies within it" : ": it has too few samples for more");
    if (std::string why = find_too_many(input, plan.levels[0].across, plan.levels[0].down); !why.empty()) return why;

    std::vector<std::string> words = job.words;
    if (std::find(words.begin(), words.end(), "--tiles") == words.end())
        words.insert(words.end(), {"--tiles", std::to_string(plan.arguments.tile)});
    if (plan.arguments.format == Format::quantized_mesh && !plan.arguments.heights) {
        HeightRange heights;
        if (const std::string why = find_heights(*dem, heights); !why.empty()) return "cannot read '" + input + "': " + why;
        words.insert(words.end(), {"--heights", number_text(heights.low) + "," + number_text(heights.high)});
    }
    Json body = job::begin_plan(program);
    body["input"] = job::value_of(plan.input);
    body["reader"] = dem->reader;
    body["width"] = plan.width;
    body["height"] = plan.height;
    body["metadata"] = metadata_value(*dem);
    body["tiles"] = plan.arguments.tile;
    body["levels"] = plan.levels.size();
    body["skirts"] = job.has_skirts;
    body["format"] = plan.arguments.format == Format::glb ? "glb" : "terrain";
    body["frame"] = frame_value(plan.frame);
    body["globe"] = nullptr;
    body["options"] = words;
    if (plan.globe) body["globe"] = {plan.globe->zoom, plan.globe->west, plan.globe->north};
    if (std::string why = job::write_plan(plan.folder, body); !why.empty()) return why;
    if (std::string why = read_plan(job.folder, "", plan); !why.empty()) return why;
    return job::write_engines(plan.folder, job.program, phases_of(plan));
}

std::string read_plan(const std::string& folder, const std::string& input, Plan& plan) {
    plan = {};
    plan.folder = job::Folder(folder);
    Json body;
    if (std::string why = job::read_plan(plan.folder, program, body, plan.identity); !why.empty()) return why;
    plan.input = job::input_of(body["input"]);
    plan.reader = body["reader"].get<std::string>();
    plan.width = body["width"].get<int>();
    plan.height = body["height"].get<int>();
    plan.metadata = texts_of(body.at("metadata"));
    plan.frame = frame_of(body["frame"]);
    if (const Json& globe = body["globe"]; !globe.is_null())
        plan.globe = GlobeGrid{globe[0].get<int>(), globe[1].get<int>(), globe[2].get<int>()};
    if (const std::string why = parse_arguments(input.empty() ? plan.input.path : input,
                                                body["options"].get<std::vector<std::string>>(), body["format"], plan);
        !why.empty())
        return "'" + plan.folder.path("plan.json") + "' has options that mean nothing: " + why;
    cut(plan, body["levels"].get<int>());
    plan.has_skirts = body["skirts"].get<bool>();
    return {};
}

std::string open_input(const Plan& plan, DemPointer& dem) {
    const std::string& input = plan.arguments.input;
    if (std::string why = job::check_input(input, plan.input); !why.empty()) return why;
    if (const std::string why = open_dem(input, plan.arguments.reading, dem); !why.empty())
        return "cannot read '" + input + "': " + why;
    if (dem->width != plan.width || dem->height != plan.height)
        return job::not_as_planned(input) + "it has " + std::to_string(dem->width) + " x " + std::to_string(dem->height) +
               " samples, and had " + std::to_string(plan.width) + " x " + std::to_string(plan.height);
    const std::map<std::string, std::string> metadata = texts_of(metadata_value(*dem));
    const auto other = std::mismatch(metadata.begin(), metadata.end(), plan.metadata.begin(), plan.metadata.end()).first;
    if (other == metadata.end()) return {};
    return job::not_as_planned(input) + "its " + other->first +
           " is another, which files beside it may say, as .prj and .aux.xml do";
}

std::string name_of(const Plan& plan, const TaskName& task) {
    switch (task.kind) {
        case TaskKind::tile:
            return "tile_" + std::to_string(task.level) + "_" + digits(plan, task.x) + "_" + digits(plan, task.y);
        case TaskKind::seams: return "seams_" + std::to_string(task.level) + "_" + digits(plan, task.y);
        case TaskKind::index: break;
    }
    return "index";
}

std::string find_task(const Plan& plan, const std::string& name, TaskName& task) {
    const auto [kind, numbers] = job::parts_of(name);
    const auto number = [&, &all = numbers](std::size_t k) { return k < all.size() ? all[k] : 0; };
    task = {};
    if (kind == "tile") task = {TaskKind::tile, number(0), number(1), number(2)};
    if (kind == "seams") task = {TaskKind::seams, number(0), 0, number(1)};
    const auto level = static_cast<std::size_t>(task.level);
    const bool is_there = level < plan.levels.size() && task.x < plan.levels[level].across && task.y < plan.levels[level].down;
    return is_there && name_of(plan, task) == name ? "" : job::no_task(name);
}

std::vector<job::Phase> phases_of(const Plan& plan) {
    std::vector<job::Phase> phases = {{"tiles", {}}, {"seams", {}}, {"index", {}}};
    job::Task index{"index", {}};
    for (int level = 0; level < static_cast<int>(plan.levels.size()); ++level) {
        const int across = plan.level(level).across, down = plan.level(level).down;
        const auto tile = [&](int x, int y) { return name_of(plan, {TaskKind::tile, level, x, y}); };
        for (int y = 0; y < down; ++y) {
            job::Task seams{name_of(plan, {TaskKind::seams, level, 0, y}), {}};
            for (int x = 0; x < across; ++x) {
                phases[0].tasks.push_back({tile(x, y), {}});
                seams.needs.push_back(tile(x, y));
                if (y + 1 < down) seams.needs.push_back(tile(x, y + 1));
            }
            index.needs.push_back(seams.name);
            phases[1].tasks.push_back(std::move(seams));
        }
    }
    phases[2].tasks.push_back(std::move(index));
    return phases;
}

Tile tile_of(const Plan& plan, const TaskName& task) {
    const Level& level = plan.level(task.level);
    Tile tile = tile_at(plan.arguments.tile, level.width, level.height, {task.x, task.y});
    tile.file = plan.folder.path("tiles/" + tile_file(plan, task));
    return tile;
}

GlobeTile globe_tile(const Plan& plan, const TaskName& task) {
    const Level& level = plan.level(task.level);
    const int cells = plan.arguments.tile;
    const int zoom = plan.globe->zoom - task.level;
    const std::int64_t x = (std::int64_t{plan.globe->west} + level.column / cells) / level.step + task.x;
    return {zoom, static_cast<int>(x % around(zoom)), (plan.globe->north + 1 - level.row / cells) / level.step - 1 - task.y};
}

std::string tile_file(const Plan& plan, const TaskName& task) {
    if (plan.globe) {  // where Cesium looks for it
        const GlobeTile at = globe_tile(plan, task);
        return std::to_string(at.zoom) + "/" + std::to_string(at.x) + "/" + std::to_string(at.y) + ".terrain";
    }
    return std::to_string(task.level) + "/" + digits(plan, task.x) + "_" + digits(plan, task.y) +
           (plan.arguments.format == Format::glb ? ".glb" : ".terrain");
}

}  // namespace terrain
