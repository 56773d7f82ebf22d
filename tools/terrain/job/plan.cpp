#include "terrain/job/plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "arguments/values.hpp"
#include "hmesh/core/version.hpp"
#include "job/receipt.hpp"
#include "job/sha256.hpp"
#include "terrain/tile_maker.hpp"

namespace terrain {
namespace {

namespace fs = std::filesystem;
using job::Json;

constexpr char plan_file[] = "plan.json", plan_kind[] = "job of hmesh-terrain";
constexpr std::size_t most_tiles = 1000000;

// Whose bits are whose: another compiler may round otherwise, and tiles would not meet.
std::string builder() {
#if defined(__clang__)
    const std::string name = "clang " __clang_version__;
#elif defined(__GNUC__)
    const std::string name = "g++ " __VERSION__;
#elif defined(_MSC_VER)
    const std::string name = "MSVC " + std::to_string(_MSC_FULL_VER);
#else
    const std::string name = "an unknown compiler";
#endif
#ifdef __FMA__
    return name + " with FMA";
#else
    return name;
#endif
}

// None of what is no plain file, as GDAL's names of other things are.
std::string find_identity(const std::string& input, bool hashes, std::optional<InputIdentity>& identity) {
    std::error_code code;
    identity.reset();
    if (!fs::is_regular_file(input, code)) {
        return hashes ? "'" + input + "' is no plain file, which --hash could sum up" : "";
    }
    identity.emplace();
    identity->bytes = fs::file_size(input, code);
    if (!code) identity->modified = static_cast<std::int64_t>(fs::last_write_time(input, code).time_since_epoch().count());
    if (code) return "cannot read '" + input + "': " + code.message();
    if (!hashes) return {};
    const std::string why = job::sha256_of_file(input, identity->sha256);
    return why.empty() ? "" : "cannot read '" + input + "': " + why;
}

Json input_value(const Plan& plan) {
    Json value = {{"path", plan.input}, {"bytes", nullptr}, {"modified", nullptr}, {"sha256", nullptr}};
    if (!plan.input_identity) return value;
    value["bytes"] = plan.input_identity->bytes;
    value["modified"] = plan.input_identity->modified;
    if (!plan.input_identity->sha256.empty()) value["sha256"] = plan.input_identity->sha256;
    return value;
}

// Whether tiles are those of Cesium's grid, to a millionth of a tile's side.
std::optional<GlobeGrid> find_globe(const Plan& plan, const Frame& frame, const Dem& dem) {
    if (plan.arguments.format != Format::quantized_mesh) return {};
    const int cells = plan.arguments.tile;
    if ((plan.width - 1) % cells != 0 || (plan.height - 1) % cells != 0) return {};
    const Extent first = extent_of(frame, dem, {{}, 0, 0, cells + 1, cells + 1, ""});
    const double side = first[2] - first[0], zoom = std::log2(180 / side);
    const auto is_whole = [](double number) { return std::fabs(number - std::round(number)) < 1e-6; };
    const double west = (first[0] + 180) / side, north = (first[1] + 90) / side;
    if (!is_whole(zoom) || zoom < -0.5 || zoom > 30 || !is_whole(west) || !is_whole(north)) return {};
    if (std::fabs(first[3] - first[1] - side) > 1e-6 * side) return {};
    return GlobeGrid{static_cast<int>(std::lround(zoom)), static_cast<int>(std::lround(west)),
                     static_cast<int>(std::lround(north))};
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

// Sets all that follows from the size.
void cut(Plan& plan) {
    plan.levels.clear();
    plan.levels.push_back({tiles_along(plan.width, plan.arguments.tile), tiles_along(plan.height, plan.arguments.tile)});
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

// Numbers in names have as many digits, so that they sort.
std::string digits(const Plan& plan, int number) {
    int most = 9999;
    for (const Level& level : plan.levels) most = std::max({most, level.across - 1, level.down - 1});
    std::string text = std::to_string(number);
    const std::size_t length = std::to_string(most).size();
    return std::string(length - std::min(length, text.size()), '0') + text;
}

std::string number_text(double number) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", number);
    return text;
}

}  // namespace

std::string make_plan(const JobArguments& job, Plan& plan) {
    std::error_code code;
    plan = {};
    plan.folder = job::Folder(job.folder);
    plan.input = fs::exists(job.input, code) ? fs::absolute(job.input).lexically_normal().string() : job.input;
    plan.arguments = job.dem;
    plan.arguments.input = plan.input;
    const fs::path folder(job.folder);
    if (fs::exists(folder, code) && !fs::is_directory(folder, code)) return "'" + job.folder + "' is no folder";
    if (fs::exists(folder, code) && !plan.folder.has(plan_file) && !fs::is_empty(folder, code))
        return "'" + job.folder + "' is not empty, and no job: name a new folder";

    if (std::string why = find_identity(plan.input, job.hashes, plan.input_identity); !why.empty()) return why;
    DemPointer dem;
    if (const std::string why = open_dem(plan.input, plan.arguments.reading, dem); !why.empty())
        return "cannot read '" + plan.input + "': " + why;
    plan.width = dem->width;
    plan.height = dem->height;
    std::vector<Tile> tiles;
    Arguments one = plan.arguments;
    one.only = {{0, 0}};
    if (std::string why = find_tiles(one, *dem, tiles); !why.empty()) return why;
    Frame frame;
    if (std::string why = find_frame(plan.arguments, *dem, frame); !why.empty()) return why;
    cut(plan);
    if (const auto count = static_cast<std::size_t>(plan.levels[0].across) * static_cast<std::size_t>(plan.levels[0].down);
        count > most_tiles)
        return "'" + plan.input + "' would be " + std::to_string(count) + " tiles, more than " + std::to_string(most_tiles) +
               ": take larger ones by --tiles";
    plan.globe = find_globe(plan, frame, *dem);

    std::vector<std::string> words = job.words;
    if (std::find(words.begin(), words.end(), "--tiles") == words.end())
        words.insert(words.end(), {"--tiles", std::to_string(plan.arguments.tile)});
    if (plan.arguments.format == Format::quantized_mesh && !plan.arguments.heights) {
        HeightRange heights;
        if (const std::string why = find_heights(*dem, heights); !why.empty()) return "cannot read '" + plan.input + "': " + why;
        words.insert(words.end(), {"--heights", number_text(heights.low) + "," + number_text(heights.high)});
    }
    Json body = {{"is", plan_kind},
                 {"version", HMESH_VERSION_STRING},
                 {"compiler", builder()},
                 {"input", input_value(plan)},
                 {"reader", dem->reader},
                 {"width", plan.width},
                 {"height", plan.height},
                 {"tiles", plan.arguments.tile},
                 {"format", plan.arguments.format == Format::glb ? "glb" : "terrain"},
                 {"frame", frame_value(frame)},
                 {"globe", nullptr},
                 {"options", words}};
    if (plan.globe) body["globe"] = {plan.globe->zoom, plan.globe->west, plan.globe->north};
    const std::string text = job::checked_text(body);
    if (plan.folder.has(plan_file)) {
        std::vector<unsigned char> before;
        if (std::string why = plan.folder.read(plan_file, before); !why.empty()) return why;
        if (std::string(before.begin(), before.end()) != text)
            return "'" + job.folder + "' holds another plan, or its input has changed: name a new folder, or remove it";
    } else if (std::string why = plan.folder.write(plan_file, text); !why.empty()) {
        return why;
    }
    if (std::string why = read_plan(job.folder, "", plan); !why.empty()) return why;
    return job::write_engines(plan.folder, job.program, phases_of(plan));
}

std::string read_plan(const std::string& folder, const std::string& input, Plan& plan) {
    plan = {};
    plan.folder = job::Folder(folder);
    const std::string path = plan.folder.path(plan_file);
    std::vector<unsigned char> text;
    if (!plan.folder.has(plan_file)) return "'" + folder + "' is no job: '" + path + "' is missing";
    if (std::string why = plan.folder.read(plan_file, text); !why.empty()) return why;
    Json body;
    if (!job::parse_checked(text, body)) return "'" + path + "' is damaged: its checksum is not that of its words";
    if (!body.contains("is") || body["is"] != plan_kind) return "'" + path + "' is no plan of hmesh-terrain's";
    if (const std::string version = body["version"]; version != HMESH_VERSION_STRING)
        return "'" + path + "' was made by hmesh-terrain " + version + ", and this is " HMESH_VERSION_STRING;
    if (const std::string compiler = body["compiler"]; compiler != builder())
        return "'" + path + "' was made by an hmesh-terrain of " + compiler + ", and this is one of " + builder() +
               ", whose tiles need not meet those of that";
    plan.identity = job::sha256_of(text.data(), text.size());
    const Json& in = body["input"];
    plan.input = in["path"].get<std::string>();
    plan.reader = body["reader"].get<std::string>();
    if (!in["bytes"].is_null()) {
        plan.input_identity = InputIdentity{in["bytes"].get<std::uint64_t>(), in["modified"].get<std::int64_t>(), ""};
        if (!in["sha256"].is_null()) plan.input_identity->sha256 = in["sha256"].get<std::string>();
    }
    plan.width = body["width"].get<int>();
    plan.height = body["height"].get<int>();
    plan.frame = frame_of(body["frame"]);
    if (const Json& globe = body["globe"]; !globe.is_null())
        plan.globe = GlobeGrid{globe[0].get<int>(), globe[1].get<int>(), globe[2].get<int>()};
    if (const std::string why = parse_arguments(input.empty() ? plan.input : input,
                                                body["options"].get<std::vector<std::string>>(), body["format"], plan);
        !why.empty())
        return "'" + path + "' has options that mean nothing: " + why;
    cut(plan);
    return {};
}

std::string open_input(const Plan& plan, DemPointer& dem) {
    const std::string& input = plan.arguments.input;
    const std::string other = "'" + input + "' is not the input that was planned: ";
    if (const auto& planned = plan.input_identity) {
        std::optional<InputIdentity> now;
        std::error_code code;
        if (!fs::exists(input, code))
            return "cannot read '" + input + "': there is no such file" + (code ? ": " + code.message() : "");
        if (std::string why = find_identity(input, false, now); !why.empty()) return why;
        if (!now) return other + "it is no plain file";
        if (now->bytes != planned->bytes)
            return other + "it has " + std::to_string(now->bytes) + " bytes, and had " + std::to_string(planned->bytes);
        if (now->modified != planned->modified) {
            if (planned->sha256.empty()) return other + "it has been written since; with --hash a plan goes by its bytes";
            if (std::string why = find_identity(input, true, now); !why.empty()) return why;
            if (now->sha256 != planned->sha256) return other + "its bytes are others";
        }
    }
    if (const std::string why = open_dem(input, plan.arguments.reading, dem); !why.empty())
        return "cannot read '" + input + "': " + why;
    if (dem->width != plan.width || dem->height != plan.height)
        return other + "it has " + std::to_string(dem->width) + " x " + std::to_string(dem->height) + " samples, and had " +
               std::to_string(plan.width) + " x " + std::to_string(plan.height);
    return {};
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
    const std::string wrong = "'" + name + "' is no task of this job: phase_1.txt and so on list them";
    std::vector<std::int64_t> numbers;
    const std::size_t first = name.find('_');
    for (std::size_t from = first; from != std::string::npos;) {
        const std::size_t to = name.find('_', from + 1);
        numbers.emplace_back();
        const std::string text = name.substr(from + 1, to == std::string::npos ? to : to - from - 1);
        if (!tool::parse_in_range(text, 0, 1000000000, numbers.back()).empty()) return wrong;
        from = to;
    }
    const auto number = [&](std::size_t k) { return k < numbers.size() ? static_cast<int>(numbers[k]) : 0; };
    task = {};
    const std::string kind = name.substr(0, first);
    if (kind == "tile") task = {TaskKind::tile, number(0), number(1), number(2)};
    if (kind == "seams") task = {TaskKind::seams, number(0), 0, number(1)};
    const auto level = static_cast<std::size_t>(task.level);
    const bool is_there = level < plan.levels.size() && task.x < plan.levels[level].across && task.y < plan.levels[level].down;
    return is_there && name_of(plan, task) == name ? "" : wrong;
}

std::vector<job::Phase> phases_of(const Plan& plan) {
    std::vector<job::Phase> phases = {{"tiles", {}}, {"seams", {}}, {"index", {}}};
    job::Task index{"index", {}};
    for (int level = 0; level < static_cast<int>(plan.levels.size()); ++level) {
        const auto [across, down] = plan.levels[static_cast<std::size_t>(level)];
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
    Tile tile = tile_at(plan.arguments.tile, plan.width, plan.height, {task.x, task.y});
    tile.file = plan.folder.path("tiles/" + tile_file(plan, task));
    return tile;
}

std::string tile_file(const Plan& plan, const TaskName& task) {
    if (plan.globe)  // where Cesium looks for it
        return std::to_string(plan.globe->zoom - task.level) + "/" + std::to_string((plan.globe->west >> task.level) + task.x) +
               "/" + std::to_string((plan.globe->north >> task.level) - task.y) + ".terrain";
    return std::to_string(task.level) + "/" + digits(plan, task.x) + "_" + digits(plan, task.y) +
           (plan.arguments.format == Format::glb ? ".glb" : ".terrain");
}

}  // namespace terrain
