#include "terrain/report.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "hmesh/core/version.hpp"

namespace terrain {
namespace {

using Json = nlohmann::ordered_json;
using Kind = TileEnd::Kind;

// All tiles as one.
struct Sum {
    std::size_t vertices = 0, triangles = 0, samples = 0, no_data = 0, measured = 0, made = 0, empty = 0, kept = 0, tighter = 0;
    double max_error = 0, squares = 0;
};

Sum sum_of(const std::vector<TileEnd>& ends) {
    Sum sum;
    for (const TileEnd& end : ends) {
        sum.vertices += end.vertices;
        sum.triangles += end.triangles;
        sum.samples += end.samples;
        sum.no_data += end.own_no_data;
        sum.measured += end.measured;
        sum.made += end.kind == Kind::made ? 1 : 0;
        sum.empty += end.kind == Kind::empty ? 1 : 0;
        sum.kept += end.kind == Kind::kept ? 1 : 0;
        sum.tighter += end.is_tighter ? 1 : 0;
        sum.max_error = std::max(sum.max_error, end.max_error);
        sum.squares += end.sum_of_squares;
    }
    return sum;
}

double root_mean_square(double squares, std::size_t count) {
    return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

double share_of(std::size_t part, std::size_t all) { return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0; }

double in_microseconds(double seconds) { return std::round(seconds * 1e6) / 1e6; }

Json tile_value(const Tile& tile, const TileEnd& end) {
    constexpr const char* kinds[] = {"made", "empty", "kept", "failed"};
    Json value = {
        {"x", tile.name.x}, {"y", tile.name.y},    {"file", tile.file},     {"column", tile.column},
        {"row", tile.row},  {"width", tile.width}, {"height", tile.height}, {"is", kinds[static_cast<std::size_t>(end.kind)]}};
    if (end.kind != Kind::made) return value;
    value["vertices"] = end.vertices;
    value["triangles"] = end.triangles;
    value["no_data"] = end.no_data;
    value["max_error"] = end.max_error;
    value["rms_error"] = root_mean_square(end.sum_of_squares, end.measured);
    value["is_tighter"] = end.is_tighter;
    return value;
}

// Where on the map the numbers of the files are.
Json frame_value(const Arguments& arguments, const Dem& dem, const Frame& frame) {
    if (arguments.format == Format::quantized_mesh) return {{"is", "degrees and metres"}, {"extent", *frame.extent}};
    const char* const how = arguments.spacing && dem.place.is_known
                                ? "units of the map, times the metres of one, by which samples are --spacing apart"
                            : dem.place.is_geographic ? "degrees, times the metres of one in the middle of the input"
                            : dem.place.is_known      ? "units of the map, times the metres of one"
                                                      : "samples, times their spacing";
    return {{"is", "local metres, times scale: +x east, +y north, +z up (.glb: +x east, +y up, -z north)"},
            {"metres", how},
            {"origin", frame.origin},
            {"metres_of_unit", frame.metres},
            {"scale", arguments.scale},
            {"z_scale", frame.z_scale},
            {"z_offset", frame.z_offset}};
}

std::string thousands(std::size_t number) {
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
    return text;
}

}  // namespace

Json report_value(const Arguments& arguments, const Dem& dem, const Frame& frame, const std::vector<Tile>& tiles,
                  const std::vector<TileEnd>& ends) {
    const Sum sum = sum_of(ends);
    // Of all tiles together nothing is known that is not known of each.
    const auto known = [&](auto number) { return sum.kept > 0 ? Json() : Json(number); };
    Json report = {{"hmesh", HMESH_VERSION_STRING},
                   {"input", arguments.input},
                   {"reader", dem.reader},
                   {"width", dem.width},
                   {"height", dem.height}};
    report["samples"] = sum.samples;
    report["no_data"] = {{"value", dem.no_data && std::isfinite(*dem.no_data) ? Json(*dem.no_data) : Json()},
                         {"samples", known(sum.no_data)},
                         {"share", known(share_of(sum.no_data, sum.samples))}};
    report["crs"] = dem.place.crs.empty() ? Json() : Json(dem.place.crs);
    report["geotransform"] = dem.place.is_known ? Json(dem.place.transform) : Json();
    report["coordinates"] = frame_value(arguments, dem, frame);
    report["effort"] = tool::name_of(efforts, arguments.effort);
    report["bound"] = arguments.max_error ? Json(*arguments.max_error) : Json();
    report["vertices"] = known(sum.vertices);
    report["triangles"] = known(sum.triangles);
    report["max_error"] = known(sum.max_error);
    report["rms_error"] = known(root_mean_square(sum.squares, sum.measured));
    report["measured"] = "|surface - sample| at every sample, of the files as they were read back, in heights of the input";
    Json& values = report["tiles"] = Json::array();
    for (std::size_t k = 0; k < tiles.size(); ++k) values.push_back(tile_value(tiles[k], ends[k]));
    return report;
}

std::string report_json(const Arguments& arguments, const Dem& dem, const Frame& frame, const std::vector<Tile>& tiles,
                        const std::vector<TileEnd>& ends, double seconds) {
    Json report = report_value(arguments, dem, frame, tiles, ends);
    Json values = std::move(report["tiles"]);
    report.erase("tiles");
    report["seconds"] = in_microseconds(seconds);
    for (std::size_t k = 0; k < tiles.size(); ++k)
        if (ends[k].kind == Kind::made) values[k]["seconds"] = in_microseconds(ends[k].seconds);
    report["tiles"] = std::move(values);
    return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void print_summary(std::FILE* to, const Arguments& arguments, const Dem& dem, const std::vector<Tile>& tiles,
                   const std::vector<TileEnd>& ends, double seconds) {
    const Sum sum = sum_of(ends);
    std::fprintf(to, "input      %s, %d x %d samples", arguments.input.c_str(), dem.width, dem.height);
    if (sum.no_data > 0 && sum.kept == 0) std::fprintf(to, ", %.2f %% without data", 100 * share_of(sum.no_data, sum.samples));
    std::fprintf(to, "\nread by    %s\n", dem.reader.c_str());
    if (arguments.tile != 0) {
        std::fprintf(to, "tiles      %zu made", sum.made);
        if (sum.kept > 0) std::fprintf(to, ", %zu kept", sum.kept);
        if (sum.empty > 0) std::fprintf(to, ", %zu empty, which have no file", sum.empty);
        std::fprintf(to, "\n");
    }
    if (sum.made > 0) {
        std::fprintf(to, "mesh       %s vertices, %s triangles%s\n", thousands(sum.vertices).c_str(),
                     thousands(sum.triangles).c_str(), sum.kept > 0 ? " of the tiles made" : "");
        std::fprintf(to, "error      at most %.6g", sum.max_error);
        if (arguments.max_error) std::fprintf(to, " (bound %.6g)", *arguments.max_error);
        std::fprintf(to, ", root mean square %.4g, as written\n", root_mean_square(sum.squares, sum.measured));
    }
    if (tiles.size() == 1 && sum.made == 1) std::fprintf(to, "written    %s\n", tiles.front().file.c_str());
    std::fprintf(to, "seconds    %.2f\n", seconds);
    if (sum.tighter > 0 && arguments.tile != 0)
        std::fprintf(
            to, "note       %zu tiles needed a tighter bound, so much is rounded: their borders may not be those of others\n",
            sum.tighter);
}

}  // namespace terrain
