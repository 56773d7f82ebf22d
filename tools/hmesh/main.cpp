// hmesh - the command: an image file becomes a mesh. See `hmesh --help`.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "advice.hpp"
#include "arguments.hpp"
#include "depfile.hpp"
#include "formats.hpp"
#include "image_file.hpp"
#include "meshing.hpp"
#include "output_file.hpp"
#include "pictures.hpp"
#include "progress_watch.hpp"
#include "report.hpp"
#include "thread_pool.hpp"
#include "web_page.hpp"
#include "weights.hpp"
#include "wireframe.hpp"
#include "words.hpp"

namespace tool {
namespace {

constexpr int done = 0, failed = 1, wrong_usage = 2;

int fail(int exit_status, const std::string& sentence) {
    std::fprintf(stderr, "hmesh: %s\n", sentence.c_str());
    if (exit_status == wrong_usage) std::fprintf(stderr, "Try 'hmesh --help'.\n");
    return exit_status;
}

bool is_same_file(const std::string& a, const std::string& b) {
    std::error_code none;
    const auto full = [&](const std::string& name) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(name, none), none);
    };
    return a == b || std::filesystem::equivalent(a, b, none) || (full(a) == full(b) && !full(a).empty());
}

// Whether an output would overwrite an input or another output. Devices may be named twice.
std::string find_clash(const Arguments& arguments) {
    const std::vector<std::string> files = output_files(arguments);
    for (std::size_t i = 0; i < files.size(); ++i) {
        std::error_code none;
        if (std::filesystem::exists(files[i], none) && !std::filesystem::is_regular_file(files[i], none)) continue;
        if (is_same_file(files[i], arguments.input)) return "'" + files[i] + "' would overwrite the input";
        if (!arguments.weights.empty() && is_same_file(files[i], arguments.weights))
            return "'" + files[i] + "' would overwrite the weights";
        for (std::size_t k = 0; k < i; ++k)
            if (is_same_file(files[i], files[k])) return "'" + files[i] + "' is named for two outputs";
    }
    return {};
}

std::string find_unwritable(const Arguments& arguments) {
    for (const std::string& name : output_files(arguments)) {
        OutputFile file(name);
        if (!file.is_writable()) return "cannot write '" + name + "': " + file.error();
    }
    return {};
}

// Writes one file whole: write(OutputFile&) gives its bytes and returns "" or what went wrong.
template <class Write>
std::string write_file(const std::string& name, Write&& write) {
    OutputFile file(name);
    std::string why = file.open() ? write(file) : file.error();
    if (!file.error().empty()) why = file.error();
    if (why.empty() && interrupted) why = "interrupted";
    if (why.empty() && !file.commit()) why = file.error();
    return why.empty() ? "" : "cannot write '" + name + "': " + why;
}

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

std::string write_pictures(const Arguments& arguments, const ImageFile& image, const hmesh::MeshView& mesh) {
    std::string why;
    const bool linear_light = arguments.meshing.fit_space == FitSpace::linear;  // as what it is meant for shows it
    if (!arguments.render.empty()) {
        Picture picture;
        const hmesh::Status status = draw(mesh, {arguments.render_scale, linear_light}, picture);
        if (why = write_picture(arguments.render, status, picture); !why.empty()) return why;
    }
    Rgb rgb;
    if (!arguments.wireframe.empty()) {
        const int scale = mesh.width <= 2048 && mesh.height <= 2048 ? 2 : 1;
        const hmesh::Status status = draw_with_edges(mesh, {scale, linear_light}, rgb);
        if (why = write_picture(arguments.wireframe, status, to_picture(rgb)); !why.empty()) return why;
    }
    if (!arguments.residual.empty()) {
        const hmesh::Status status = draw_rgb(mesh, {1, linear_light}, rgb);
        if (status) rgb = residual(to_rgb(to_picture(image)), rgb);
        if (why = write_picture(arguments.residual, status, to_picture(rgb)); !why.empty()) return why;
    }
    if (!arguments.strip.empty()) {
        const hmesh::Status status = draw_strip(mesh, linear_light, to_rgb(to_picture(image)), rgb);
        if (why = write_picture(arguments.strip, status, to_picture(rgb)); !why.empty()) return why;
    }
    return {};
}

// `light`: of the mesh, for .glb where --fit-space is each.
std::string write_meshes(const Arguments& arguments, const hmesh::MeshView& mesh, const std::optional<LightMesh>& light,
                         const WebPage& page) {
    FormatOptions options;
    options.svg.kind = arguments.svg;
    options.html = page.options();
    for (const std::string& name : arguments.meshes) {
        const std::string why = write_file(name, [&](OutputFile& file) {
            const bool is_light = light && arguments.meshing.fit_space == FitSpace::each && has_ending(name, ".glb");
            const hmesh::Status status = write_mesh(is_light ? light->mesh.view() : mesh, name, options, file);
            return status ? std::string() : in_words(status);
        });
        if (!why.empty()) return why;
    }
    return {};
}

std::string write_depfile(const Arguments& arguments) {
    std::vector<std::string> written = output_files(arguments), read = {arguments.input};
    written.pop_back();  // itself
    if (!arguments.weights.empty()) read.push_back(arguments.weights);
    const std::string rule = depfile(written, read);
    return write_file(arguments.depfile,
                      [&](OutputFile& file) { return file(rule.data(), rule.size()) ? "" : "the disk refused the rule"; });
}

void print_summary(const Arguments& arguments, const ImageFile& image, const hmesh::Result& outcome,
                   const std::optional<LightMesh>& light, double seconds) {
    std::printf("image     %s, %d x %d, %d channel%s of %d bits\n", arguments.input.c_str(), image.width, image.height,
                image.channels, image.channels == 1 ? "" : "s", image.bits);
    if (!image.note.empty()) std::printf("note      %s\n", image.note.c_str());
    std::printf("vertices  %zu\n", outcome.report.vertices);
    std::printf("faces     %zu\n", outcome.report.faces);
    std::printf("PSNR      %s (%s)\n", psnr_text(outcome.report.psnr).c_str(), psnr_formula(arguments).c_str());
    if (light && arguments.meshing.fit_space == FitSpace::each)
        std::printf("PSNR .glb %s as its viewers show it, in linear light\n", psnr_text(light->psnr).c_str());
    else if (light)
        std::printf("PSNR .glb %s as its viewers show it, in linear light; %s with --fit-space each or linear\n",
                    psnr_text(light->stored_psnr).c_str(), psnr_text(light->psnr).c_str());
    std::printf("time      %.2f s\n", seconds);
    for (const std::string& name : output_files(arguments)) std::printf("written   %s\n", name.c_str());
    print_advice(arguments, outcome.report.vertices);
}

// The most vertices that a mesh may have; a PSNR sets no bound.
std::size_t budget(const hmesh::Target& target, const ImageFile& image) {
    const double pixels = static_cast<double>(image.width) * image.height;
    switch (target.kind) {
        case hmesh::Target::Kind::vertices: return static_cast<std::size_t>(target.value);
        case hmesh::Target::Kind::percent: return static_cast<std::size_t>(std::max(4.0, pixels * target.value / 100));
        case hmesh::Target::Kind::psnr: break;
    }
    return static_cast<std::size_t>(std::max(4.0, pixels));
}

// Brings the mesh of an interrupted run to its budget, if it has more vertices: the method inserts too many before it removes.
void keep_budget(const ImageFile& image, MeshingOptions options, const hmesh::ParallelFor& parallel_for, hmesh::Result& outcome) {
    const std::size_t most = budget(options.target, image);
    if (outcome.mesh.vertex_count() <= most) return;
    const hmesh::Status why = outcome.status;
    const hmesh::Mesh reached = std::move(outcome.mesh);
    options.start = &reached;
    options.target = hmesh::Target::vertices(static_cast<std::int64_t>(most));
    options.progress = {};
    outcome = mesh_file(image, options, parallel_for);
    if (outcome.status) outcome.status = why;
}

// Starts the pool. Returns "" or why not, as a sentence.
std::string start(std::optional<example::ThreadPool>& pool, unsigned threads) {
    try {
        pool.emplace(threads);
    } catch (const std::system_error& error) {
        return "cannot start the threads: " + error.code().message();
    }
    return {};
}

int run(const Arguments& arguments) {
    catch_interrupt();
    if (const std::string clash = find_clash(arguments); !clash.empty()) return fail(wrong_usage, clash);
    ImageFile image;
    std::vector<unsigned char> bytes;
    if (const std::string why = read_image(arguments.input, image, bytes); !why.empty())
        return fail(failed, "cannot read '" + arguments.input + "': " + why);
    if (!has_output(arguments, ".html") || !arguments.original) std::vector<unsigned char>().swap(bytes);
    hmesh::Image<float, 1> weights;
    if (!arguments.weights.empty()) {
        const std::string why = read_weights(arguments.weights, image.width, image.height, weights);
        if (!why.empty()) return fail(failed, why);
    }
    if (const std::string why = find_unwritable(arguments); !why.empty()) return fail(failed, why);
    std::optional<example::ThreadPool> pool;
    if (const std::string why = start(pool, arguments.threads); !why.empty()) return fail(failed, why);

    ProgressWatch watch(!arguments.quiet && is_terminal(stderr));
    MeshingOptions options = arguments.meshing;
    options.progress = watch;
    if (!arguments.weights.empty()) options.weights = weights.view();
    hmesh::Result outcome = mesh_file(image, options, *pool);
    const bool is_interrupted = outcome.status.code == hmesh::Errc::cancelled;
    if (is_interrupted && arguments.keep_partial) {
        interrupted = false;
        keep_budget(image, options, *pool, outcome);
    }
    const double seconds = watch.seconds();
    watch.finish();

    const bool has_effort = options.method == Method::annealed;
    const std::string where = "'" + arguments.input + "' with " + arguments.target +
                              (has_effort ? std::string(" --effort ") + name_of(efforts, options.effort)
                                          : std::string(" --method ") + name_of(methods, options.method));
    if (!outcome.has_mesh()) return fail(failed, where + ": " + in_words(outcome.status));
    if (is_interrupted && !arguments.keep_partial)
        return fail(failed, where + ": interrupted; nothing is written, as --keep-partial is not given");
    // make and Ninja would take files that are there as up to date, whatever the exit status was.
    if (!outcome.status && !arguments.depfile.empty())
        return fail(failed,
                    where + ": " + in_words(outcome.status) + "; nothing is written, as --depfile asks for whole results");
    std::optional<LightMesh> light;
    if (has_output(arguments, ".glb") && options.fit_space != FitSpace::linear && !options.premultiplied)
        light = light_mesh(image, options, outcome.mesh, *pool);
    WebPage page;
    if (has_output(arguments, ".html")) page = make_web_page(arguments, image, bytes, outcome.report);
    std::string why = write_meshes(arguments, outcome.mesh.view(), light, page);
    if (why.empty()) why = write_pictures(arguments, image, outcome.mesh.view());
    if (why.empty() && !arguments.report.empty()) {
        const std::string report = report_json(arguments, image, outcome, light, seconds, watch);
        why = write_file(arguments.report, [&](OutputFile& file) {
            return file(report.data(), report.size()) ? "" : "the disk refused the report";
        });
    }
    if (why.empty() && !arguments.depfile.empty()) why = write_depfile(arguments);
    if (!why.empty()) return fail(failed, why);
    if (!arguments.quiet) print_summary(arguments, image, outcome, light, seconds);
    if (std::fflush(stdout) != 0) return fail(failed, "cannot write to the standard output");
    if (outcome.status) return done;
    const std::string reached = "the mesh reached so far, " + std::to_string(outcome.report.vertices) + " vertices and " +
                                psnr_text(outcome.report.psnr) + ", " +
                                (output_files(arguments).empty() ? "is as above" : "is written");
    return fail(failed, where + ": " + in_words(outcome.status) + "; " + reached);
}

constexpr char no_memory[] = "there is not enough memory for this image and these options";

// Where a worker of the pool, which throws nothing, has no memory.
[[noreturn]] void give_up() {
    try {
        if (std::exception_ptr why = std::current_exception()) std::rethrow_exception(why);
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "hmesh: %s\n", no_memory);
        std::_Exit(failed);
    } catch (...) {
    }
    std::abort();
}

}  // namespace
}  // namespace tool

int main(int argc, char** argv) {
    const tool::CommandLine line = tool::parse({argv + (argc > 0 ? 1 : 0), argv + argc});
    if (!line.wrong.empty()) return tool::fail(tool::wrong_usage, line.wrong);
    if (!line.answer.empty()) {
        const bool printed = std::fputs(line.answer.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
        return printed ? tool::done : tool::failed;
    }
    std::set_terminate(tool::give_up);
    try {
        return tool::run(line.arguments);
    } catch (const std::bad_alloc&) {
        return tool::fail(tool::failed, tool::no_memory);
    }
}
