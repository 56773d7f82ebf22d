#include "job.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "meshing.hpp"
#include "readers/image_file.hpp"
#include "readers/weights.hpp"
#include "results/outline_files.hpp"
#include "results/report.hpp"
#include "results/summary.hpp"
#include "results/writing.hpp"
#include "results/written_psnr.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"
#include "writers/new_folders.hpp"

namespace tool {
namespace {

// The most vertices that a mesh may have: as mesh_image() counts them.
std::size_t budget(const hmesh::Target& target, const ImageFile& image) {
    const double pixels = static_cast<double>(image.width) * image.height;
    switch (target.kind) {
        case hmesh::Target::Kind::vertices: return static_cast<std::size_t>(std::min(target.value, std::max(4.0, pixels)));
        case hmesh::Target::Kind::percent:
            return static_cast<std::size_t>(std::max(4LL, std::llround(pixels * target.value / 100)));
        case hmesh::Target::Kind::psnr: break;
    }
    const auto all = static_cast<std::int64_t>(std::max(4.0, pixels));
    return static_cast<std::size_t>(std::min(all, target.max_vertices.value_or(all)));
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

// Alpha of faces that --sprite drops, in 255ths, where --alpha does not say.
constexpr double default_transparent = 2;

// What went wrong, if anything did.
struct Failure {
    std::string why;           // a sentence; empty: nothing
    bool is_reported = false;  // the mesh is, all the same
    bool ends_the_run = false;
};

struct Inputs {
    ImageFile image;
    std::vector<unsigned char> bytes;  // of its file, where they are needed
    hmesh::Image<float, 1> weights;
};

std::string read_inputs(const Arguments& arguments, Inputs& inputs) {
    if (const std::string why = read_image(arguments.input, inputs.image, inputs.bytes); !why.empty())
        return "cannot read " + input_words(arguments.input) + ": " + (interrupted ? "interrupted" : why);
    if (!has_output(arguments, ".html") || !arguments.original) std::vector<unsigned char>().swap(inputs.bytes);
    if (arguments.weights.empty()) return {};
    return read_weights(arguments.weights, inputs.image.width, inputs.image.height, inputs.weights);
}

// Which mesh a sentence is about.
std::string what_is_made(const Arguments& arguments) {
    const MeshingOptions& options = arguments.meshing;
    return input_words(arguments.input) + " with " + arguments.target +
           (options.method == Method::annealed ? std::string(" --effort ") + name_of(efforts, options.effort)
                                               : std::string(" --method ") + name_of(methods, options.method));
}

// Prints what is said of a mesh, by print(stream) or as a line of JSON. Returns "" or why it cannot be, as a sentence.
template <class Print>
std::string tell(const Arguments& arguments, const std::string& json_line, Print&& print) {
    std::FILE* const to = writes_standard_output(arguments) ? stderr : stdout;
    if (arguments.json) std::fputs(json_line.c_str(), to);
    else if (!arguments.quiet) print(to);
    errno = 0;
    const bool is_printed = std::fflush(to) == 0 && std::ferror(to) == 0;
    return is_printed ? "" : "cannot write to the standard output: " + std::string(std::strerror(errno != 0 ? errno : EIO));
}

// Which of the files is furthest below the mesh, if one is.
std::string least_text(const std::vector<WrittenPsnr>& written, double psnr) {
    const WrittenPsnr* least = nullptr;
    for (const WrittenPsnr& file : written)
        if (file.psnr < (least != nullptr ? least->psnr : psnr)) least = &file;
    if (least == nullptr || psnr_text(least->psnr) == psnr_text(psnr)) return {};
    return ", of which " + output_words(least->file) + " keeps " + psnr_text(least->psnr);
}

// The files of an outline of the image, in place of a mesh.
Failure make_outline(const Arguments& arguments, bool is_one_of_several, const ImageFile& image, ProgressWatch& watch) {
    const hmesh::Outline outline = outline_file(image, arguments.outline_options);
    const double seconds = watch.seconds();
    if (!outline.status) return {"the outline of " + input_words(arguments.input) + ": " + in_words(outline.status)};
    const auto report = [&](bool is_wanted, Layout layout) {
        return is_wanted ? outline_json(arguments, image, outline, seconds, layout) : std::string();
    };
    const std::string file_report = report(!arguments.report.empty(), Layout::indented);
    if (std::string why = write_outline_files(arguments, image, outline, file_report); !why.empty()) return {why};
    watch.finish();
    std::string why = tell(arguments, report(arguments.json, Layout::one_line),
                           [&](std::FILE* to) { print_outline(to, arguments, image, outline, is_one_of_several, seconds); });
    return why.empty() ? Failure() : Failure{why, true, true};
}

Failure make_mesh(Arguments arguments, bool is_one_of_several, std::optional<example::ThreadPool>& pool) {
    ProgressWatch watch(!arguments.quiet && is_terminal(stderr));
    Inputs inputs;
    NewFolders folders;
    if (std::string why = read_inputs(arguments, inputs); !why.empty()) return {why};
    const ImageFile& image = inputs.image;
    if (std::string why = find_unwritable(arguments, folders); !why.empty()) return {why};
    if (arguments.outline) {
        if (arguments.alpha >= 0) arguments.outline_options.threshold = arguments.alpha;
        watch.begin_mesh(0.03 * image.width * image.height, 0.03 * image.width * image.height, 1);
        return make_outline(arguments, is_one_of_several, image, watch);
    }
    if (arguments.sprite) {
        arguments.meshing.premultiplied = arguments.meshing.premultiplied || hmesh::kit::has_alpha(image.channels);
        arguments.meshing.transparent = arguments.alpha >= 0 ? arguments.alpha : default_transparent;
    }
    if (!pool)
        if (std::string why = start(pool, arguments.threads); !why.empty()) return {why, false, true};

    MeshingOptions options = arguments.meshing;
    options.progress = watch;
    if (!arguments.weights.empty()) options.weights = inputs.weights.view();
    const hmesh::ParallelFor parallel_for = *pool;
    const WrittenFiles files(arguments, image, options, parallel_for);
    if (options.target.kind == hmesh::Target::Kind::psnr) options.psnr_of = files;
    watch.begin_mesh(0.03 * image.width * image.height, meshing_work(image, options), writing_work(arguments, image));
    hmesh::Result outcome = mesh_file(image, options, *pool);
    const bool is_interrupted = outcome.status.code == hmesh::Errc::cancelled;
    if (is_interrupted && arguments.keep_partial) {
        interrupted = false;
        keep_budget(image, options, *pool, outcome);
    }
    const double seconds = watch.seconds();
    watch.end_mesh();

    const std::string sentence = what_is_made(arguments) + ": " + in_words(outcome.status);
    if (!outcome.has_mesh()) return {sentence, false, is_interrupted};
    if (is_interrupted && !arguments.keep_partial)
        return {sentence + "; nothing is written, as --keep-partial is not given", false, true};
    // make and Ninja would take files that are there as up to date, whatever the exit status was.
    if (!outcome.status && !arguments.depfile.empty())
        return {sentence + "; nothing is written, as --depfile asks for whole results", false, is_interrupted};
    std::optional<hmesh::SpriteReport> sprite;
    if (arguments.sprite) {
        sprite = drop_faces(image, options, outcome, *pool);
        if (!sprite->status) return {what_is_made(arguments) + ": " + in_words(sprite->status)};
    }
    std::optional<LightMesh> light;
    if (has_output(arguments, ".glb") && options.fit_space != FitSpace::linear && !options.premultiplied) {
        watch.step("linear light", light_work(image));
        light = light_mesh(image, options, outcome.mesh, *pool);
    }
    const bool has_missed = options.psnr_of && outcome.status.code == hmesh::Errc::target_out_of_range;
    const bool is_summed_up = !arguments.quiet && !is_one_of_several;
    std::vector<WrittenPsnr> written;
    if (is_summed_up || arguments.json || !arguments.report.empty() || has_missed)
        written = files.measure(outcome.mesh, outcome.report.psnr, light);
    const auto report = [&](bool is_wanted, Layout layout) {
        return is_wanted ? report_json(arguments, image, outcome, light, sprite, written, seconds, watch, layout) : std::string();
    };
    const std::string file_report = report(!arguments.report.empty(), Layout::indented);
    if (std::string why = write_files(arguments, image, inputs.bytes, outcome, light, file_report, watch); !why.empty())
        return {why, false, is_interrupted};
    watch.finish();
    const std::string json_line = report(arguments.json, Layout::one_line);
    std::string untold = tell(arguments, json_line, [&](std::FILE* to) {
        if (is_one_of_several) print_line(to, arguments, image, outcome, seconds);
        else print_summary(to, arguments, image, outcome, light, sprite, written, seconds);
    });
    if (!untold.empty()) return {untold, true, true};
    if (outcome.status) return {};
    return {sentence + "; the mesh reached so far, " + std::to_string(outcome.report.vertices) + " vertices and " +
                psnr_text(outcome.report.psnr) + (has_missed ? least_text(written, outcome.report.psnr) : "") + ", " +
                (output_files(arguments).empty() ? "is as above" : "is written"),
            true, is_interrupted};
}

}  // namespace

JobEnd run_job(const Arguments& arguments, bool is_one_of_several, std::optional<example::ThreadPool>& pool) {
    Failure failure;
    try {
        failure = make_mesh(arguments, is_one_of_several, pool);
    } catch (const std::bad_alloc&) {
        failure.why = is_one_of_several ? input_words(arguments.input) + ": " + no_memory : no_memory;
    }
    if (failure.why.empty()) return JobEnd::done;
    fail(failed, failure.why);
    if (arguments.json && !failure.is_reported) {
        std::fputs(failure_json(arguments, failure.why).c_str(), stdout);
        failure.ends_the_run = std::fflush(stdout) != 0 || failure.ends_the_run;
    }
    return failure.ends_the_run || interrupted ? JobEnd::failed_for_all : JobEnd::failed;
}

}  // namespace tool
