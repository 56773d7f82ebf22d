#include "tiles/plan.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "arguments/arguments.hpp"
#include "job/plan_file.hpp"

namespace tool {
namespace {

using job::Json;

constexpr char program[] = "hmesh";
constexpr std::size_t most_tiles = 100000;

std::string of_samples(int width, int height, int channels, int bits) {
    return std::to_string(width) + " x " + std::to_string(height) + " samples of " + std::to_string(channels) + " channels and " +
           std::to_string(bits) + " bits";
}

}  // namespace

std::string make_tile_plan(const TileJob& job, TilePlan& plan) {
    plan = {};
    plan.folder = job::Folder(job.folder);
    if (std::string why = job::check_new(plan.folder); !why.empty()) return why;
    if (std::string why = job::find_input(job.input, job.hashes, plan.input); !why.empty()) return why;
    const std::string& path = plan.input.path;
    TileImage image;
    if (const std::string why = image.open(path); !why.empty()) return "cannot read '" + path + "': " + why;
    const ImageFile& head = image.head();
    plan.width = head.width;
    plan.height = head.height;
    if (plan.width < 2 || plan.height < 2)
        return "'" + path + "' is " + std::to_string(plan.width) + " x " + std::to_string(plan.height) +
               " px: tiles have 2 samples or more a side";
    plan.options = job.tiles;
    const double samples = static_cast<double>(plan.width) * plan.height;
    const bool is_share = job.target.kind == hmesh::Target::Kind::percent;
    const double wanted = is_share ? std::round(samples * job.target.value / 100) : job.target.value;
    plan.levels = find_levels(plan.width, plan.height, static_cast<std::size_t>(wanted), plan.options.tile, plan.options.levels);
    if (const auto levels = static_cast<int>(plan.levels.size()); levels < plan.options.levels)
        return "'" + path + "' has " + std::to_string(levels) + " levels, not " + std::to_string(plan.options.levels) +
               ": it has too few pixels for more";
    if (const std::size_t count = plan.levels[0].tile_count(); count > most_tiles)
        return "'" + path + "' would be " + std::to_string(count) + " tiles, more than " + std::to_string(most_tiles) +
               ": take larger ones by --tile";

    Json body = job::begin_plan(program);
    body["input"] = job::value_of(plan.input);
    body["width"] = plan.width;
    body["height"] = plan.height;
    body["channels"] = head.channels;
    body["bits"] = head.bits;
    body["tile"] = plan.options.tile;
    body["vertices"] = plan.levels[0].vertices;
    body["levels"] = plan.options.levels;
    body["effort"] = name_of(efforts, plan.options.effort);
    body["seed"] = plan.options.seed;
    body["border_tolerance"] = nullptr;
    if (plan.options.border_tolerance) body["border_tolerance"] = *plan.options.border_tolerance;
    if (std::string why = job::write_plan(plan.folder, body); !why.empty()) return why;
    if (std::string why = read_tile_plan(job.folder, "", plan); !why.empty()) return why;
    return job::write_engines(plan.folder, job.program, phases_of(plan));
}

std::string read_tile_plan(const std::string& folder, const std::string& input, TilePlan& plan) {
    plan = {};
    plan.folder = job::Folder(folder);
    Json body;
    if (std::string why = job::read_plan(plan.folder, program, body, plan.identity); !why.empty()) return why;
    plan.input = job::input_of(body["input"]);
    plan.path = input.empty() ? plan.input.path : input;
    plan.width = body["width"].get<int>();
    plan.height = body["height"].get<int>();
    plan.channels = body["channels"].get<int>();
    plan.bits = body["bits"].get<int>();
    plan.options.tile = body["tile"].get<int>();
    plan.options.levels = body["levels"].get<int>();
    plan.options.seed = body["seed"].get<std::uint64_t>();
    if (const Json& tolerance = body["border_tolerance"]; !tolerance.is_null())
        plan.options.border_tolerance = tolerance.get<double>();
    if (const std::string why = find_name(efforts, body["effort"].get<std::string>(), plan.options.effort); !why.empty())
        return "'" + plan.folder.path("plan.json") + "' has an effort that " + why;
    plan.levels =
        find_levels(plan.width, plan.height, body["vertices"].get<std::size_t>(), plan.options.tile, plan.options.levels);
    return {};
}

std::string open_planned(const TilePlan& plan, TileImage& image) {
    if (std::string why = job::check_input(plan.path, plan.input); !why.empty()) return why;
    if (const std::string why = image.open(plan.path); !why.empty()) return "cannot read '" + plan.path + "': " + why;
    const ImageFile& head = image.head();
    if (head.width == plan.width && head.height == plan.height && head.channels == plan.channels && head.bits == plan.bits)
        return {};
    return job::not_as_planned(plan.path) + "it has " + of_samples(head.width, head.height, head.channels, head.bits) +
           ", and had " + of_samples(plan.width, plan.height, plan.channels, plan.bits);
}

std::string name_of(const TilePlan& plan, const TileTask& task) {
    const TileLevel& level = plan.level(task.level);
    const std::string number = "_" + std::to_string(task.level), y = "_" + job::digits(task.y, level.down() - 1);
    const std::string place = number + "_" + job::digits(task.x, level.across() - 1) + y;
    switch (task.kind) {
        case TileTaskKind::look: return "look" + place;
        case TileTaskKind::shares: return "shares" + number;
        case TileTaskKind::tile: return "tile" + place;
        case TileTaskKind::seams: return "seams" + number + y;
        case TileTaskKind::index: break;
    }
    return "index";
}

std::string find_task(const TilePlan& plan, const std::string& name, TileTask& task) {
    const auto [kind, numbers] = job::parts_of(name);
    const auto number = [&, &all = numbers](std::size_t k) { return k < all.size() ? all[k] : 0; };
    task = {};
    if (kind == "look") task = {TileTaskKind::look, number(0), number(1), number(2)};
    if (kind == "shares") task = {TileTaskKind::shares, number(0), 0, 0};
    if (kind == "tile") task = {TileTaskKind::tile, number(0), number(1), number(2)};
    if (kind == "seams") task = {TileTaskKind::seams, number(0), 0, number(1)};
    const bool is_there = static_cast<std::size_t>(task.level) < plan.levels.size() && task.x < plan.level(task.level).across() &&
                          task.y < plan.level(task.level).down();
    return is_there && name_of(plan, task) == name ? "" : job::no_task(name);
}

std::vector<job::Phase> phases_of(const TilePlan& plan) {
    std::vector<job::Phase> phases = {{"looks", {}}, {"shares", {}}, {"tiles", {}}, {"seams", {}}, {"index", {{"index", {}}}}};
    for (int k = 0; k < static_cast<int>(plan.levels.size()); ++k) {
        const TileLevel& level = plan.level(k);
        job::Task shares{name_of(plan, {TileTaskKind::shares, k, 0, 0}), {}};
        for (int y = 0; y < level.down(); ++y) {
            job::Task seams{name_of(plan, {TileTaskKind::seams, k, 0, y}), {}};
            for (int x = 0; x < level.across(); ++x) {
                const std::string look = name_of(plan, {TileTaskKind::look, k, x, y});
                const std::string tile = name_of(plan, {TileTaskKind::tile, k, x, y});
                phases[0].tasks.push_back({look, {}});
                shares.needs.push_back(look);
                phases[2].tasks.push_back({tile, {shares.name}});
                seams.needs.push_back(tile);
                if (y + 1 < level.down()) seams.needs.push_back(name_of(plan, {TileTaskKind::tile, k, x, y + 1}));
            }
            phases[4].tasks[0].needs.push_back(seams.name);
            phases[3].tasks.push_back(std::move(seams));
        }
        phases[1].tasks.push_back(std::move(shares));
    }
    return phases;
}

hmesh::kit::Rect rect_of(const TilePlan& plan, const TileTask& tile) {
    const auto x = static_cast<std::size_t>(tile.x), y = static_cast<std::size_t>(tile.y);
    const std::vector<int>&columns = plan.level(tile.level).columns, &rows = plan.level(tile.level).rows;
    return {columns[x], rows[y], columns[x + 1] - columns[x] + 1, rows[y + 1] - rows[y] + 1};
}

std::string file_of(const TilePlan& plan, const TileTask& tile) {
    const TileLevel& level = plan.level(tile.level);
    return std::to_string(tile.level) + "/" + job::digits(tile.y, level.down() - 1) + "_" +
           job::digits(tile.x, level.across() - 1);
}

}  // namespace tool
