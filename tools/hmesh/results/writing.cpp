#include "results/writing.hpp"

#include "results/web_page.hpp"
#include "results/write_file.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/words.hpp"
#include "writers/formats.hpp"
#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"
#include "writers/wireframe.hpp"

namespace tool {
namespace {

std::string write_picture(const std::string& name, const hmesh::Status& status, const Picture& picture) {
    if (!status) return "cannot draw '" + name + "': " + in_words(status);
    return write_file(name, [&](OutputFile& file) {
        return write_png(picture, file) ? "" : "it has more than 2^30 samples, or there is no memory";
    });
}

// The mesh drawn in red, green and blue, whatever is transparent over white.
hmesh::Status draw_rgb(const hmesh::MeshView& mesh, const DrawOptions& options, Rgb& rgb) {
    Picture drawn;
    const hmesh::Status status = draw(mesh, options, drawn);
    if (status) rgb = to_rgb(drawn);
    return status;
}

hmesh::Status draw_with_edges(const hmesh::MeshView& mesh, const DrawOptions& options, Rgb& rgb) {
    if (const hmesh::Status status = draw_rgb(mesh, options, rgb); !status) return status;
    return draw_wireframe(mesh, rgb);
}

// Image, mesh, mesh with edges and error, side by side.
hmesh::Status draw_strip(const hmesh::MeshView& mesh, bool linear_light, const Rgb& original, Rgb& strip) {
    Rgb drawn;
    if (const hmesh::Status status = draw_rgb(mesh, {1, linear_light}, drawn); !status) return status;
    Rgb edges = drawn;
    if (const hmesh::Status status = draw_wireframe(mesh, edges); !status) return status;
    strip = side_by_side({original, drawn, edges, residual(original, drawn)});
    return {};
}

// How long files take to write, in microseconds, roughly: of so many pixels drawn, each in 1 to 3 channels.
double mesh_file_work(std::size_t vertices) { return 2.0 * static_cast<double>(vertices); }
double picture_work(const ImageFile& image, int copies) { return 0.15 * image.width * image.height * copies; }

std::string write_pictures(const Arguments& arguments, const ImageFile& image, const hmesh::MeshView& mesh,
                           ProgressWatch& watch) {
    std::string why;
    const bool linear_light = arguments.meshing.fit_space == FitSpace::linear;  // as what it is meant for shows it
    if (!arguments.render.empty()) {
        watch.step("drawing", picture_work(image, arguments.render_scale * arguments.render_scale));
        Picture picture;
        const hmesh::Status status = draw(mesh, {arguments.render_scale, linear_light}, picture);
        if (why = write_picture(arguments.render, status, picture); !why.empty()) return why;
    }
    Rgb rgb;
    if (!arguments.wireframe.empty()) {
        watch.step("drawing", picture_work(image, 4));
        const int scale = mesh.width <= 2048 && mesh.height <= 2048 ? 2 : 1;
        const hmesh::Status status = draw_with_edges(mesh, {scale, linear_light}, rgb);
        if (why = write_picture(arguments.wireframe, status, to_picture(rgb)); !why.empty()) return why;
    }
    if (!arguments.residual.empty()) {
        watch.step("drawing", picture_work(image, 1));
        const hmesh::Status status = draw_rgb(mesh, {1, linear_light}, rgb);
        if (status) rgb = residual(to_rgb(to_picture(image)), rgb);
        if (why = write_picture(arguments.residual, status, to_picture(rgb)); !why.empty()) return why;
    }
    if (!arguments.strip.empty()) {
        watch.step("drawing", picture_work(image, 4));
        const hmesh::Status status = draw_strip(mesh, linear_light, to_rgb(to_picture(image)), rgb);
        if (why = write_picture(arguments.strip, status, to_picture(rgb)); !why.empty()) return why;
    }
    return {};
}

// `light`: of the mesh, for .glb where --fit-space is each.
std::string write_meshes(const Arguments& arguments, const hmesh::MeshView& mesh, const std::optional<LightMesh>& light,
                         const WebPage& page, ProgressWatch& watch) {
    FormatOptions options;
    options.svg.kind = arguments.svg;
    options.html = page.options();
    for (const MeshFile& wanted : arguments.meshes) {
        watch.step("writing", mesh_file_work(mesh.vertex_count));
        const std::string why = write_file(wanted.name, [&](OutputFile& file) {
            const bool is_light = light && arguments.meshing.fit_space == FitSpace::each && wanted.ending == ".glb";
            const hmesh::Status status = write_mesh(is_light ? light->mesh.view() : mesh, wanted.ending, options, file);
            return status ? std::string() : in_words(status);
        });
        if (!why.empty()) return why;
    }
    return {};
}

}  // namespace

std::string find_unwritable(const Arguments& arguments, NewFolders& folders) {
    for (const std::string& folder : arguments.folders)
        if (std::string why = folders.make(folder); !why.empty()) return why;
    for (const std::string& name : output_files(arguments)) {
        OutputFile file(name);
        if (!file.is_writable()) return "cannot write '" + name + "': " + file.error();
    }
    return {};
}

double writing_work(const Arguments& arguments, const ImageFile& image) {
    double work = 1;
    if (has_output(arguments, ".glb") && arguments.meshing.fit_space != FitSpace::linear) work += light_work(image);
    work +=
        static_cast<double>(arguments.meshes.size()) * mesh_file_work(static_cast<std::size_t>(image.width) * image.height / 50);
    if (!arguments.render.empty()) work += picture_work(image, arguments.render_scale * arguments.render_scale);
    for (const std::string* name : {&arguments.wireframe, &arguments.residual, &arguments.strip})
        if (!name->empty()) work += picture_work(image, name == &arguments.residual ? 1 : 4);
    return work;
}

std::string write_files(const Arguments& arguments, const ImageFile& image, const std::vector<unsigned char>& bytes,
                        const hmesh::Result& outcome, const std::optional<LightMesh>& light, const std::string& report,
                        ProgressWatch& watch) {
    WebPage page;
    if (has_output(arguments, ".html")) page = make_web_page(arguments, image, bytes, outcome.report);
    std::string why = write_meshes(arguments, outcome.mesh.view(), light, page, watch);
    if (why.empty()) why = write_pictures(arguments, image, outcome.mesh.view(), watch);
    if (why.empty() && !arguments.report.empty()) why = write_text(arguments.report, report);
    if (why.empty() && !arguments.depfile.empty()) why = write_depfile(arguments);
    return why;
}

}  // namespace tool
