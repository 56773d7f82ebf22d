#include "results/outline_files.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "hmesh/io/textured.hpp"
#include "results/lines.hpp"
#include "results/write_notes.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"
#include "writers/pictures.hpp"
#include "writers/wireframe.hpp"
#include "writers/write_picture.hpp"

namespace tool {
namespace {

// The texture's name in a file: the one asked for, or the way from the file to the image.
std::string texture_name(const Arguments& arguments, const std::string& file) {
    if (!arguments.texture.empty()) return arguments.texture;
    std::error_code none;
    const std::filesystem::path folder = is_standard(file) ? "" : std::filesystem::path(file).parent_path();
    const std::filesystem::path way = std::filesystem::proximate(arguments.input, folder.empty() ? "." : folder, none);
    return none || way.empty() ? arguments.input : way.generic_string();
}

std::string material_of(const std::string& file) {
    return std::filesystem::path(file).filename().replace_extension(".mtl").string();
}

hmesh::Status write_model(const Arguments& arguments, const MeshFile& file, const hmesh::MeshView& mesh, hmesh::Sink sink) {
    const std::string texture = texture_name(arguments, file.name);
    if (file.ending == ".ply") return hmesh::write_textured_ply(mesh, texture.c_str(), sink);
    if (file.ending == ".glb") return hmesh::write_textured_glb(mesh, texture.c_str(), sink);
    return hmesh::write_textured_obj(mesh, is_standard(file.name) ? nullptr : material_of(file.name).c_str(), sink);
}

// The image over grey, on which both it and white edges are seen.
Rgb over_grey(const Picture& picture) {
    Rgb rgb = to_rgb(picture);  // over white
    if (picture.channels % 2 != 0) return rgb;
    const auto channels = static_cast<std::size_t>(picture.channels);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const int alpha = picture.samples[channels * (i / 3) + channels - 1];
        rgb.data()[i] = static_cast<std::uint8_t>(rgb.data()[i] - (255 - alpha) / 2);
    }
    return rgb;
}

// The image twice as large with the outline's edges.
std::string write_edges(OutputSet& files, const std::string& name, const ImageFile& image, const hmesh::MeshView& mesh) {
    const Rgb rgb = over_grey(to_picture(image));
    const int scale = wireframe_scale(image.width, image.height);
    Rgb large(scale * rgb.width(), scale * rgb.height());
    for (int y = 0; y < large.height(); ++y)
        for (int x = 0; x < large.width(); ++x)
            for (int c = 0; c < 3; ++c) large.pixel(x, y)[c] = rgb.pixel(x / scale, y / scale)[c];
    const hmesh::Status status = draw_wireframe(mesh, large);
    return write_picture(files, name, status, to_picture(large));
}

}  // namespace

std::string write_outline_files(const Arguments& arguments, const ImageFile& image, const hmesh::Outline& outline,
                                const std::string& report, OutputSet& files) {
    const hmesh::MeshView mesh = outline.mesh.view();
    const auto in_sentence = [](const hmesh::Status& status) { return status ? std::string() : in_words(status); };
    std::string why;
    for (const MeshFile& file : arguments.meshes)
        if (why.empty())
            why = files.write(file.name, [&](OutputFile& out) { return in_sentence(write_model(arguments, file, mesh, out)); });
    for (const std::string& material : arguments.materials)
        if (why.empty())
            why = files.write(material, [&](OutputFile& out) {
                return in_sentence(hmesh::write_material(texture_name(arguments, material).c_str(), out));
            });
    if (why.empty() && !arguments.wireframe.empty()) why = write_edges(files, arguments.wireframe, image, mesh);
    if (why.empty()) why = write_notes(files, arguments, report);
    return why.empty() ? files.commit() : why;
}

void print_outline(std::FILE* to, const Arguments& arguments, const ImageFile& image, const hmesh::Outline& outline,
                   bool is_one_of_several, double seconds) {
    const std::size_t vertices = outline.mesh.vertex_count(), faces = outline.mesh.face_count();
    const double all = static_cast<double>(image.width) * image.height;
    const double share = 100 * outline.area / all, least = 100 * outline.covered / all;
    if (is_one_of_several) {
        std::fprintf(to, "%s: outline of %zu vertices, %.1f %% of the rectangle, %s\n", arguments.input.c_str(), vertices, share,
                     written_words(arguments, seconds).c_str());
        return;
    }
    print_image(to, arguments, image);
    std::fprintf(to, "vertices  %zu of %zu border%s\n", vertices, outline.loops.size(), outline.loops.size() == 1 ? "" : "s");
    std::fprintf(to, "faces     %zu\n", faces);
    std::fprintf(to, "area      %.2f %% of the rectangle, of which %.2f %% have to be inside\n", share, least);
    print_written(to, arguments, seconds);
}

}  // namespace tool
