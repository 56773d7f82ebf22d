// stages - shows how a method gets to its mesh: stages DIRECTORY annealed|hierarchical [IMAGE]
//
// Writes DIRECTORY/METHOD-K-STAGE.jpg, the mesh with its edges as stage K leaves it, DIRECTORY/METHOD-residual.jpg, four times
// the final error around grey, and for hierarchical DIRECTORY/levels.jpg; and prints a Markdown table of them. The
// meshes in between are had by the public interface alone: a callback that says no when the next stage begins. Without IMAGE a
// scene of the program's own is meshed.
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/paper.hpp>

#include "readers/image_file.hpp"
#include "scene.hpp"
#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"
#include "writers/wireframe.hpp"

namespace {

using tool::Rgb;

// Stops the work when stage `last` + 1 begins.
struct Stop {
    int last = 0;
    int stage = -1;
    std::string name;
    double fraction = 2;

    bool operator()(const hmesh::ProgressInfo& info) {
        if (name != info.stage || info.fraction < fraction) ++stage;
        name = info.stage;
        fraction = info.fraction;
        return stage <= last;
    }
};

bool write_jpeg(const std::string& name, const Rgb& picture) {
    tool::OutputFile file(name);
    return file.open() && tool::write_jpeg(tool::to_picture(picture), 88, file) && file.commit();
}

Rgb drawn(const hmesh::Mesh& mesh) {
    const hmesh::RenderResult<3> out = hmesh::render<3>(mesh.view());
    return out.status ? hmesh::to_pixels<std::uint8_t>(out.image) : Rgb(1, 1);
}

int run(const std::string& directory, const std::string& method, const Rgb& image) {
    hmesh::Options options;
    const bool is_hierarchical = method == "hierarchical";
    const auto view = image.view();
    const auto write = [&](const std::string& name, const Rgb& picture) {
        if (write_jpeg(directory + "/" + name, picture)) return true;
        std::fprintf(stderr, "stages: cannot write '%s/%s'\n", directory.c_str(), name.c_str());
        return false;
    };
    std::printf("| stage | mesh |\n|---|---|\n");
    if (is_hierarchical) {
        const auto pyramid = hmesh::kit::make_pyramid(view, 3);
        std::vector<Rgb> levels;
        for (int level = 0; level < 3; ++level) {
            Rgb picture(image.width(), image.height());
            for (int y = 0; y < image.height(); ++y)
                std::copy_n(pyramid.level(level).row(y), 3 * image.width(), picture.pixel(0, y));
            levels.push_back(std::move(picture));
        }
        if (!write("levels.jpg", tool::side_by_side(levels))) return 1;
    }
    for (int k = 0;; ++k) {
        Stop stop;
        stop.last = k;
        options.progress = stop;
        const hmesh::Result result =
            is_hierarchical ? hmesh::mesh_image(view, options, hmesh::Hierarchical()) : hmesh::mesh_image(view, options);
        if (!result.has_mesh()) {
            std::fprintf(stderr, "stages: %s\n", hmesh::message(result.status).c_str());
            return 1;
        }
        Rgb picture = drawn(result.mesh);
        if (result.status) {  // no stage is left: this was the last
            return write(method + "-residual.jpg", tool::residual(image, picture)) ? 0 : 1;
        }
        const std::string stage = result.report.stages[static_cast<std::size_t>(k)].name;
        const std::string name = method + "-" + std::to_string(k + 1) + "-" + stage + ".jpg";
        if (!tool::draw_wireframe(result.mesh.view(), picture)) return 1;
        if (!write(name, picture)) return 1;
        std::printf("| %d %s: %zu vertices, %.2f dB | ![%s](%s) |\n", k + 1, stage.c_str(), result.report.vertices,
                    result.report.psnr, stage.c_str(), name.c_str());
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string method = argc > 2 ? argv[2] : "";
    if ((argc != 3 && argc != 4) || (method != "annealed" && method != "hierarchical")) {
        std::fprintf(stderr, "usage: stages DIRECTORY annealed|hierarchical [IMAGE]\n");
        return 2;
    }
    if (argc == 3) return run(argv[1], method, tool::draw_scene(384, 256));
    tool::ImageFile file;
    if (const std::string why = tool::read_image(argv[3], file); !why.empty()) {
        std::fprintf(stderr, "stages: cannot read '%s': %s\n", argv[3], why.c_str());
        return 1;
    }
    return run(argv[1], method, tool::to_rgb(tool::to_picture(file)));
}
