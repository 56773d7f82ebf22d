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

// The samples on the lines across a side of `size` samples, as far apart as one another and no further than a tile's side.
std::vector<int> lines(int size, int tile) {
    const std::int64_t cells = size - 1, count = (cells + tile - 1) / tile;
    std::vector<int> at;
    for (std::int64_t k = 0; k <= count; ++k) at.push_back(static_cast<int>((2 * k * cells + count) / (2 * count)));
    return at;
}

void cut(TilePlan& plan) {
    plan.columns = lines(plan.width, plan.options.tile);
    plan.rows = lines(plan.height, plan.options.tile);
}

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
    cut(plan);
    if (plan.tile_count() > most_tiles)
        return "'" + path + "' would be " + std::to_string(plan.tile_count()) + " tiles, more than " +
               std::to_string(most_tiles) + ": take larger ones by --tile";
    const double samples = static_cast<double>(plan.width) * plan.height;
    const bool is_share = job.target.kind == hmesh::Target::Kind::percent;
    const double wanted = is_share ? std::round(samples * job.target.value / 100) : job.target.value;
    plan.vertices = static_cast<std::size_t>(std::max(4.0, std::min(samples, wanted)));

    Json body = job::begin_plan(program);
    body["input"] = job::value_of(plan.input);
    body["width"] = plan.width;
    body["height"] = plan.height;
    body["channels"] = head.channels;
    body["bits"] = head.bits;
    body["tile"] = plan.options.tile;
    body["vertices"] = plan.vertices;
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
    plan.vertices = body["vertices"].get<std::size_t>();
    plan.options.tile = body["tile"].get<int>();
    plan.options.seed = body["seed"].get<std::uint64_t>();
    if (const Json& tolerance = body["border_tolerance"]; !tolerance.is_null())
        plan.options.border_tolerance = tolerance.get<double>();
    if (const std::string why = find_name(efforts, body["effort"].get<std::string>(), plan.options.effort); !why.empty())
        return "'" + plan.folder.path("plan.json") + "' has an effort that " + why;
    cut(plan);
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
    const auto x = [&] { return "_" + job::digits(task.x, plan.across() - 1); };
    const auto y = [&] { return "_" + job::digits(task.y, plan.down() - 1); };
    switch (task.kind) {
        case TileTaskKind::look: return "look" + x() + y();
        case TileTaskKind::shares: return "shares";
        case TileTaskKind::tile: return "tile" + x() + y();
        case TileTaskKind::seams: return "seams" + y();
        case TileTaskKind::index: break;
    }
    return "index";
}

std::string find_task(const TilePlan& plan, const std::string& name, TileTask& task) {
    const auto [kind, numbers] = job::parts_of(name);
    const auto number = [&, &all = numbers](std::size_t k) { return k < all.size() ? all[k] : 0; };
    task = {};
    if (kind == "look") task = {TileTaskKind::look, number(0), number(1)};
    if (kind == "shares") task.kind = TileTaskKind::shares;
    if (kind == "tile") task = {TileTaskKind::tile, number(0), number(1)};
    if (kind == "seams") task = {TileTaskKind::seams, 0, number(0)};
    return task.x < plan.across() && task.y < plan.down() && name_of(plan, task) == name ? "" : job::no_task(name);
}

std::vector<job::Phase> phases_of(const TilePlan& plan) {
    std::vector<job::Phase> phases = {
        {"looks", {}}, {"shares", {{"shares", {}}}}, {"tiles", {}}, {"seams", {}}, {"index", {{"index", {}}}}};
    job::Task &shares = phases[1].tasks[0], &index = phases[4].tasks[0];
    for (int y = 0; y < plan.down(); ++y) {
        job::Task seams{name_of(plan, {TileTaskKind::seams, 0, y}), {}};
        for (int x = 0; x < plan.across(); ++x) {
            const std::string look = name_of(plan, {TileTaskKind::look, x, y}), tile = name_of(plan, {TileTaskKind::tile, x, y});
            phases[0].tasks.push_back({look, {}});
            shares.needs.push_back(look);
            phases[2].tasks.push_back({tile, {"shares"}});
            seams.needs.push_back(tile);
            if (y + 1 < plan.down()) seams.needs.push_back(name_of(plan, {TileTaskKind::tile, x, y + 1}));
        }
        index.needs.push_back(seams.name);
        phases[3].tasks.push_back(std::move(seams));
    }
    return phases;
}

hmesh::kit::Rect rect_of(const TilePlan& plan, const TileTask& tile) {
    const auto x = static_cast<std::size_t>(tile.x), y = static_cast<std::size_t>(tile.y);
    return {plan.columns[x], plan.rows[y], plan.columns[x + 1] - plan.columns[x] + 1, plan.rows[y + 1] - plan.rows[y] + 1};
}

std::string file_of(const TilePlan& plan, const TileTask& tile) {
    return job::digits(tile.y, plan.down() - 1) + "_" + job::digits(tile.x, plan.across() - 1);
}

}  // namespace tool
