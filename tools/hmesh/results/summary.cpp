#include "results/summary.hpp"

#include <string>

#include "results/advice.hpp"
#include "results/report.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"

namespace tool {

void print_summary(std::FILE* to, const Arguments& arguments, const ImageFile& image, const hmesh::Result& outcome,
                   const std::optional<LightMesh>& light, const std::optional<hmesh::SpriteReport>& sprite,
                   const std::vector<WrittenPsnr>& written, double seconds) {
    std::fprintf(to, "image     %s, %d x %d, %d channel%s of %d bits\n", arguments.input.c_str(), image.width, image.height,
                 image.channels, image.channels == 1 ? "" : "s", image.bits);
    if (!image.note.empty()) std::fprintf(to, "note      %s\n", image.note.c_str());
    std::fprintf(to, "vertices  %zu\n", outcome.report.vertices);
    std::fprintf(to, "faces     %zu", outcome.report.faces);
    if (sprite)
        std::fprintf(to, ", the first %zu opaque; %.1f %% of the rectangle", sprite->opaque_faces,
                     100 * sprite->area / (static_cast<double>(image.width) * image.height));
    std::fprintf(to, "\n");
    std::fprintf(to, "PSNR      %s (%s)\n", psnr_text(outcome.report.psnr).c_str(), psnr_formula(arguments).c_str());
    if (light && arguments.meshing.fit_space == FitSpace::each)
        std::fprintf(to, "PSNR .glb %s as its viewers show it, in linear light\n", psnr_text(light->psnr).c_str());
    else if (light)
        std::fprintf(to, "PSNR .glb %s as its viewers show it, in linear light; %s with --fit-space each or linear\n",
                     psnr_text(light->stored_psnr).c_str(), psnr_text(light->psnr).c_str());
    for (const WrittenPsnr& file : written)
        if (file.ending != ".glb" && psnr_text(file.psnr) != psnr_text(outcome.report.psnr))
            std::fprintf(to, "PSNR      %s as %s %s\n", psnr_text(file.psnr).c_str(), output_name(file.file).c_str(),
                         file.ending == ".png" ? "shows it, rounded to 8 bits" : "holds it, colours of 8 bits");
    std::fprintf(to, "time      %.2f s\n", seconds);
    for (const std::string& name : output_files(arguments)) std::fprintf(to, "written   %s\n", name.c_str());
    print_advice(to, arguments, outcome.report.vertices);
}

void print_line(std::FILE* to, const Arguments& arguments, const ImageFile& image, const hmesh::Result& outcome, double seconds) {
    std::string files, note;
    for (const std::string& name : output_files(arguments)) files += (files.empty() ? ", written " : ", ") + name;
    if (!image.note.empty()) note = " (" + image.note + ")";
    std::fprintf(to, "%s: %zu vertices, %s, %.2f s%s%s\n", arguments.input.c_str(), outcome.report.vertices,
                 psnr_text(outcome.report.psnr).c_str(), seconds, files.c_str(), note.c_str());
}

}  // namespace tool
