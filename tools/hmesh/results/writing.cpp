#include "results/writing.hpp"

#include <cstddef>

#include "arguments/files.hpp"
#include "results/mesh_file.hpp"
#include "results/web_page.hpp"
#include "results/write_notes.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/words.hpp"
#include "writers/formats.hpp"
#include "writers/output_set.hpp"
#include "writers/pictures.hpp"
#include "writers/wireframe.hpp"
#include "writers/write_picture.hpp"

namespace tool {
namespace {

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

std::string write_pictures(const Arguments& arguments, const ImageFile& image, const hmesh::Mesh& all,
                           const std::vector<Map>& maps, OutputSet& files, ProgressWatch& watch) {
    std::string why;
    const bool linear_light = arguments.meshing.fit_space == FitSpace::linear;  // as what it is meant for shows it
    const std::vector<std::string> renders = render_files(arguments);
    for (std::size_t i = 0; i < renders.size(); ++i) {
        watch.step("drawing", picture_work(image, arguments.render_scale * arguments.render_scale));
        Picture picture;
        const hmesh::Mesh part = maps.empty() ? hmesh::Mesh() : mesh_of(maps[i], all);
        const hmesh::Status status = draw((maps.empty() ? all : part).view(), {arguments.render_scale, linear_light}, picture);
        if (why = write_picture(files, renders[i], status, picture); !why.empty()) return why;
    }
    if (arguments.wireframe.empty() && arguments.residual.empty() && arguments.strip.empty()) return {};
    const hmesh::Mesh first = maps.empty() ? hmesh::Mesh() : mesh_of(maps[0], all);  // these show one picture
    const hmesh::MeshView mesh = (maps.empty() ? all : first).view();
    Rgb rgb;
    if (!arguments.wireframe.empty()) {
        watch.step("drawing", picture_work(image, 4));
        const hmesh::Status status = draw_with_edges(mesh, {wireframe_scale(mesh.width, mesh.height), linear_light}, rgb);
        if (why = write_picture(files, arguments.wireframe, status, to_picture(rgb)); !why.empty()) return why;
    }
    if (!arguments.residual.empty()) {
        watch.step("drawing", picture_work(image, 1));
        const hmesh::Status status = draw_rgb(mesh, {1, linear_light}, rgb);
        if (status) rgb = residual(to_rgb(to_picture(image)), rgb);
        if (why = write_picture(files, arguments.residual, status, to_picture(rgb)); !why.empty()) return why;
    }
    if (!arguments.strip.empty()) {
        watch.step("drawing", picture_work(image, 4));
        const hmesh::Status status = draw_strip(mesh, linear_light, to_rgb(to_picture(image)), rgb);
        if (why = write_picture(files, arguments.strip, status, to_picture(rgb)); !why.empty()) return why;
    }
    return {};
}

// What a file of this format holds of a level: its twin for linear light where there is one.
hmesh::MeshView view_of(const Arguments& arguments, const Level& level, const std::string& ending) {
    const bool is_light = level.light && arguments.meshing.fit_space == FitSpace::each && ending == ".glb";
    return is_light ? level.light->mesh.view() : level.outcome.mesh.view();
}

std::string write_meshes(const Arguments& arguments, const ImageFile& image, const std::vector<unsigned char>& bytes,
                         const Made& made, OutputSet& files, ProgressWatch& watch) {
    const std::vector<hmesh::ChannelGroup> groups = groups_of(made.maps);
    FormatOptions options;
    options.glb = arguments.glb;
    options.glb_color_bits = arguments.glb_color_bits;
    options.groups = {groups.data(), groups.size()};
    options.svg.kind = arguments.svg;
    options.compact.colors = compact_colors(image.bits);
    options.compact.linear = arguments.meshing.fit_space == FitSpace::linear;
    for (const MeshFile& wanted : arguments.meshes) {
        std::vector<hmesh::MeshView> levels;
        for (const Level& level : made.levels) levels.push_back(view_of(arguments, level, wanted.ending));
        const bool holds_all = wanted.coarser.empty() && wanted.ending == ".glb";
        for (std::size_t k = 0; k < (holds_all ? 1 : levels.size()); ++k) {
            watch.step("writing", mesh_file_work(levels[k].vertex_count));
            WebPage page;
            if (wanted.ending == ".html") page = make_web_page(arguments, image, bytes, made.levels[k].outcome.report);
            options.html = page.options();
            const std::string why = files.write(k == 0 ? wanted.name : wanted.coarser[k - 1], [&](OutputFile& file) {
                if (!made.file.empty() && wanted.ending == ".hmc")
                    return file(made.file.data(), made.file.size()) ? std::string() : file.error();
                const hmesh::Status status =
                    holds_all ? write_glb_levels(levels, options, file) : write_mesh(levels[k], wanted.ending, options, file);
                return status ? std::string() : in_words(status);
            });
            if (!why.empty()) return why;
        }
    }
    return {};
}

}  // namespace

double writing_work(const Arguments& arguments, const ImageFile& image) {
    double work = 1;
    if (has_output(arguments, ".glb") && arguments.meshing.fit_space != FitSpace::linear && arguments.others.empty())
        work += light_work(image);
    work += static_cast<double>(arguments.meshes.size()) *
            mesh_file_work(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) / 50);
    work += static_cast<double>(render_files(arguments).size()) *
            picture_work(image, arguments.render_scale * arguments.render_scale);
    for (const std::string* name : {&arguments.wireframe, &arguments.residual, &arguments.strip})
        if (!name->empty()) work += picture_work(image, name == &arguments.residual ? 1 : 4);
    return work;
}

std::string write_files(const Arguments& arguments, const ImageFile& image, const std::vector<unsigned char>& bytes,
                        const Made& made, const std::string& report, OutputSet& files, ProgressWatch& watch) {
    std::string why = write_meshes(arguments, image, bytes, made, files, watch);
    if (why.empty()) why = write_pictures(arguments, image, made.finest().outcome.mesh, made.maps, files, watch);
    if (why.empty()) why = write_notes(files, arguments, report);
    return why.empty() ? files.commit() : why;
}

}  // namespace tool
