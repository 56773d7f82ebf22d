#include "results/summary.hpp"

#include <cstddef>
#include <string>

#include "results/advice.hpp"
#include "results/lines.hpp"
#include "results/report.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"

namespace tool {
namespace {

// Whether a file holds colours of 8 bits.
bool has_bytes(const std::string& ending, const Arguments& arguments, int bits) {
    if (ending == ".glb") return arguments.glb_color_bits == 8;
    return ending != ".obj" && (bits == 8 || (ending != ".pdf" && ending != ".eps" && ending != ".hmc"));
}

}  // namespace

void print_summary(std::FILE* to, const Arguments& arguments, const ImageFile& image, const Made& made) {
    const auto& [outcome, light, sprite] = made.finest();
    print_image(to, arguments, image);
    print_vertices(to, outcome);
    std::fprintf(to, "faces     %zu", outcome.report.faces);
    if (sprite)
        std::fprintf(to, ", the first %zu opaque; %.1f %% of the rectangle", sprite->opaque_faces,
                     100 * sprite->area / (static_cast<double>(image.width) * image.height));
    std::fprintf(to, "\n");
    std::fprintf(to, "PSNR      %s (%s)\n", psnr_text(outcome.report.psnr).c_str(), psnr_formula(arguments).c_str());
    for (const Map& map : made.maps) {
        std::fprintf(to, "PSNR      %s of %s, %d channel%s as %s", psnr_text(map.psnr).c_str(), input_words(map.file).c_str(),
                     map.channels, map.channels == 1 ? "" : "s", map.name.c_str());
        if (arguments.balances_maps) std::fprintf(to, ", weight %.2g", map.weight);
        std::fprintf(to, "\n");
    }
    if (light && arguments.meshing.fit_space == FitSpace::each)
        std::fprintf(to, "PSNR .glb %s as its viewers show it, in linear light\n", psnr_text(light->psnr).c_str());
    else if (light)
        std::fprintf(to, "PSNR .glb %s as its viewers show it, in linear light; %s with --fit-space each or linear\n",
                     psnr_text(light->stored_psnr).c_str(), psnr_text(light->psnr).c_str());
    for (const WrittenPsnr& file : made.written)
        if ((file.ending != ".glb" || !light || arguments.glb_color_bits == 8) &&
            psnr_text(file.psnr) != psnr_text(outcome.report.psnr))
            std::fprintf(to, "PSNR      %s as %s %s\n", psnr_text(file.psnr).c_str(), output_name(file.file).c_str(),
                         file.ending == ".png"                           ? "shows it, rounded to 8 bits"
                         : has_bytes(file.ending, arguments, image.bits) ? "holds it, colours of 8 bits"
                                                                         : "holds it");
    for (std::size_t k = 1; k < made.levels.size(); ++k) {
        const hmesh::Report& report = made.levels[k].outcome.report;
        std::fprintf(to, "level %-2zu  %zu vertices, %zu faces, %s\n", k, report.vertices, report.faces,
                     psnr_text(report.psnr).c_str());
    }
    print_written(to, arguments, made.seconds);
    print_advice(to, arguments, outcome.report.vertices);
}

void print_line(std::FILE* to, const Arguments& arguments, const ImageFile& image, const Made& made) {
    std::string note, levels;
    const hmesh::Report& finest = made.finest().outcome.report;
    for (std::size_t k = 1; k < made.levels.size(); ++k) {
        const hmesh::Report& report = made.levels[k].outcome.report;
        levels +=
            (levels.empty() ? " (levels: " : ", ") + std::to_string(report.vertices) + " vertices, " + psnr_text(report.psnr);
    }
    if (!levels.empty()) levels += ")";
    if (!image.note.empty()) note = " (" + image.note + ")";
    std::fprintf(to, "%s: %zu vertices, %s%s, %s%s\n", arguments.input.c_str(), finest.vertices, psnr_text(finest.psnr).c_str(),
                 levels.c_str(), written_words(arguments, made.seconds).c_str(), note.c_str());
}

}  // namespace tool
