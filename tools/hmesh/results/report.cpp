// The only file that compiles nlohmann/json.
#include "results/report.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>

#include "hmesh/core/version.hpp"
#include "results/lines.hpp"
#include "terminal/words.hpp"

namespace tool {
namespace {

using Json = nlohmann::ordered_json;

// The PSNR for programs, without anything left to guess.
std::string psnr_convention(const Arguments& arguments) {
    const MeshingOptions& meshing = arguments.meshing;
    return std::string("10 log10(peak^2 / MSE) in dB, MSE the mean over pixels") +
           (arguments.weights.empty() ? "" : ", each as often as its weight over the largest says,") + " and channels" +
           (arguments.channel_weights.empty() ? "" : ", by their weights,") + " of the image's stored values" +
           (meshing.premultiplied ? ", colours times alpha" : "") +
           (meshing.fit_space == FitSpace::linear ? ", the mesh drawn in linear light" : "") +
           "; psnr of the mesh, values drawn not rounded, psnr_written of what the files hold";
}

Json psnr_value(double psnr) { return std::isinf(psnr) && psnr > 0 ? Json("inf") : Json(psnr); }

// In microseconds; below 0: not measured.
Json seconds_value(double seconds) { return seconds < 0 ? Json() : Json(std::round(seconds * 1e6) / 1e6); }

Json stage_value(const hmesh::StageReport& stage, double seconds) {
    Json value = {{"name", stage.name},
                  {"vertices", stage.vertices},
                  {"energy", stage.energy},
                  {"psnr", psnr_value(stage.psnr)},
                  {"seconds", seconds_value(seconds)}};
    if (stage.iterations > 0) {
        value["iterations"] = stage.iterations;
        value["residual"] = stage.residual;
    }
    return value;
}

// null where there is one image.
Json map_values(const std::vector<Map>& maps, bool are_balanced) {
    constexpr const char* meanings[] = {"color", "normal", "data"};
    Json values = maps.empty() ? Json() : Json::array();
    for (const Map& map : maps) {
        values.push_back({{"file", map.file},
                          {"name", map.name},
                          {"meaning", meanings[static_cast<std::size_t>(map.meaning)]},
                          {"channels", map.channels},
                          {"psnr", psnr_value(map.psnr)}});
        if (are_balanced) values.back()["weight"] = map.weight;
    }
    return values;
}

// The level's own files; a .glb that holds all levels is the first one's.
Json level_value(const Arguments& arguments, const hmesh::Report& report, std::size_t level) {
    Json files = Json::array();
    for (const MeshFile& mesh : arguments.meshes)
        if (level == 0 || level <= mesh.coarser.size()) files.push_back(level == 0 ? mesh.name : mesh.coarser[level - 1]);
    return {{"vertices", report.vertices}, {"faces", report.faces},         {"psnr", psnr_value(report.psnr)},
            {"energy", report.energy},     {"max_error", report.max_error}, {"files", files}};
}

std::string in_layout(const Json& value, Layout layout) {
    return value.dump(layout == Layout::indented ? 2 : -1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string psnr_formula(const Arguments& arguments) {
    const MeshingOptions& meshing = arguments.meshing;
    return std::string("10 log10(peak^2 / MSE), MSE over ") + (arguments.weights.empty() ? "" : "weighted ") +
           "pixels and channels" + (arguments.channel_weights.empty() ? "" : " by their weights") +
           (meshing.premultiplied ? ", colours times alpha" : "") +
           (meshing.fit_space == FitSpace::linear ? ", drawn in linear light" : "") + ", values drawn not rounded";
}

std::string report_json(const Arguments& arguments, const ImageFile& image, const Made& made, const ProgressWatch& watch,
                        Layout layout) {
    const hmesh::Result& outcome = made.finest().outcome;
    const std::optional<LightMesh>& light = made.finest().light;
    const std::optional<hmesh::SpriteReport>& sprite = made.finest().sprite;
    const MeshingOptions& meshing = arguments.meshing;
    const bool is_each = meshing.fit_space == FitSpace::each;
    Json stages = Json::array();
    for (const hmesh::StageReport& stage : outcome.report.stages) stages.push_back(stage_value(stage, watch.seconds_of(stage)));
    Json files = Json::object();
    for (const WrittenPsnr& file : made.written) files[file.file] = psnr_value(file.psnr);
    Json levels = Json::array();
    for (const Level& level : made.levels) levels.push_back(level_value(arguments, level.outcome.report, levels.size()));
    const Json report = {{"version", HMESH_VERSION_STRING},
                         {"input", arguments.input},
                         {"width", image.width},
                         {"height", image.height},
                         {"channels", image.channels - image.padding},
                         {"bits", image.bits},
                         {"method", name_of(methods, meshing.method)},
                         {"effort", name_of(efforts, meshing.effort)},
                         {"colors", name_of(colors, final_colors(meshing))},
                         {"fit_space", name_of(fit_spaces, meshing.fit_space)},
                         {"premultiplied", meshing.premultiplied},
                         {"periodic", name_of(periodics, meshing.periodic)},
                         {"straight_border", meshing.straight_border},
                         {"samples", name_of(sample_kinds, meshing.samples)},
                         {"border_tolerance", meshing.border_tolerance ? Json(*meshing.border_tolerance) : Json()},
                         {"seed", meshing.seed},
                         {"weights", arguments.weights.empty() ? Json() : Json(arguments.weights)},
                         {"tile", meshing.tile},
                         {"target", arguments.target},
                         {"status", outcome.status ? "ok" : in_words(outcome.status)},
                         {"vertices", outcome.report.vertices},
                         {"border_copies", border_copies(outcome)},
                         {"faces", outcome.report.faces},
                         {"opaque_faces", sprite ? Json(sprite->opaque_faces) : Json()},
                         {"area", sprite ? Json(sprite->area / (static_cast<double>(image.width) * image.height)) : Json()},
                         {"psnr", psnr_value(outcome.report.psnr)},
                         {"psnr_convention", psnr_convention(arguments)},
                         {"psnr_written", files},
                         {"levels", levels},
                         {"maps", map_values(made.maps, arguments.balances_maps)},
                         {"psnr_glb", light ? psnr_value(is_each ? light->psnr : light->stored_psnr) : Json()},
                         {"psnr_glb_fitted", light ? psnr_value(light->psnr) : Json()},
                         {"energy", outcome.report.energy},
                         {"max_error", outcome.report.max_error},
                         {"seconds", seconds_value(made.seconds)},
                         {"stages", stages}};
    return in_layout(report, layout);
}

std::string outline_json(const Arguments& arguments, const ImageFile& image, const hmesh::Outline& outline, double seconds,
                         Layout layout) {
    const hmesh::OutlineOptions& options = arguments.outline_options;
    const double all = static_cast<double>(image.width) * image.height;
    return in_layout({{"version", HMESH_VERSION_STRING},
                      {"input", arguments.input},
                      {"width", image.width},
                      {"height", image.height},
                      {"channels", image.channels},
                      {"bits", image.bits},
                      {"method", "outline"},
                      {"alpha", options.threshold},
                      {"margin", options.margin},
                      {"tolerance", options.tolerance},
                      {"max_vertices", options.max_vertices != 0 ? Json(options.max_vertices) : Json()},
                      {"status", "ok"},
                      {"vertices", outline.mesh.vertex_count()},
                      {"faces", outline.mesh.face_count()},
                      {"borders", outline.loops.size()},
                      {"area", outline.area / all},
                      {"area_needed", outline.covered / all},
                      {"seconds", seconds_value(seconds)}},
                     layout);
}

std::string failure_json(const Arguments& arguments, const std::string& why) {
    return in_layout({{"version", HMESH_VERSION_STRING}, {"input", arguments.input}, {"status", why}}, Layout::one_line);
}

}  // namespace tool
