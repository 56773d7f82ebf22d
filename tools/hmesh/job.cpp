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
#include "readers/image_set.hpp"
#include "readers/readers.hpp"
#include "readers/rectangles.hpp"
#include "readers/weights.hpp"
#include "results/made.hpp"
#include "results/maps.hpp"
#include "results/outline_files.hpp"
#include "results/read_mesh.hpp"
#include "results/report.hpp"
#include "results/summary.hpp"
#include "results/writing.hpp"
#include "results/written_psnr.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"
#include "writers/output_set.hpp"

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
    if (outcome.report.vertices <= most) return;
    const hmesh::Status why = outcome.status;
    const hmesh::Mesh reached = std::move(outcome.mesh);
    options.start = &reached;
    options.colors = final_colors(options);  // of its method; that which starts from a mesh has its own
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
    ImageFile image;        // all of them as one, where there are several maps
    ImageFile first;        // the first of several, to draw beside the mesh
    std::vector<Map> maps;  // where there are several
    std::vector<double> channel_weights;
    std::vector<unsigned char> bytes;  // of its file, where they are needed
    hmesh::Image<float, 1> weights;
};

// Reads the other maps and joins them with the image.
std::string join_maps(const Arguments& arguments, Inputs& inputs) {
    if (arguments.others.empty()) return {};
    std::vector<ImageFile> images{std::move(inputs.image)};
    std::vector<std::string> names{arguments.input};
    for (const OtherMap& other : arguments.others) {
        names.push_back(other.file);
        if (const std::string why = read_image(other.file, images.emplace_back()); !why.empty())
            return "cannot read " + input_words(other.file) + ": " + (interrupted ? "interrupted" : why);
    }
    if (std::string why = join_images(images, names, inputs.image); !why.empty()) return why;
    if (arguments.meshing.border_tolerance && inputs.image.padding > 0)  // channels of weight 0, which sides do not know
        return std::string("--border-tolerance makes sides of 1 to 4") + (inputs.image.bits == 32 ? "" : ", 8") +
               " or 16 channels, and the images have " + std::to_string(inputs.image.channels - inputs.image.padding) +
               " together";
    if (std::string why = find_maps(arguments, images, inputs.maps); !why.empty()) return why;
    for (const ImageFile& image : images)
        if (inputs.image.note.empty()) inputs.image.note = image.note;
    inputs.first = std::move(images[0]);
    return {};
}

// The step of positions in px: as asked for, or the finest that all files keep.
double position_step(const Arguments& arguments, const ImageFile& image) {
    if (arguments.grid > 0) return 1.0 / arguments.grid;
    double step = 1.0 / 256;
    if (arguments.glb == GlbForm::exact || !has_output(arguments, ".glb")) return step;
    while (step < 0.25 && std::max(image.width, image.height) / step > 65535) step *= 2;
    return step;
}

std::string read_inputs(const Arguments& arguments, Inputs& inputs) {
    if (arguments.out_of_core) {
        if (const std::string why = open_rectangles(arguments.input, inputs.image); !why.empty())
            return "cannot read " + input_words(arguments.input) + ": " + why;
    } else if (const std::string why = read_bytes_as_image({inputs.bytes.data(), inputs.bytes.size()}, inputs.image);
               !why.empty())
        return "cannot read " + input_words(arguments.input) + ": " + (interrupted ? "interrupted" : why);
    if (!has_output(arguments, ".html") || !arguments.original) std::vector<unsigned char>().swap(inputs.bytes);
    if (std::string why = join_maps(arguments, inputs); !why.empty()) return why;
    if (std::string why = spread_weights(arguments.channel_weights, inputs.maps, inputs.image, inputs.channel_weights);
        !why.empty())
        return why;
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

// What is wrong with as many levels of detail after a mesh of n vertices; empty: nothing.
std::string find_too_many_levels(const MeshingOptions& options, std::size_t n) {
    int most = 0;
    for (std::size_t left = n; left >= 4; left /= 2) ++most;
    if (n < 4 || options.levels <= most) return {};
    return "--lods " + std::to_string(options.levels) + " is too many for " + std::to_string(n) +
           " vertices: a mesh has at least 4, and level " + std::to_string(most) + " would have " + std::to_string(n >> most) +
           "; at most --lods " + std::to_string(most);
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
Failure make_outline(const Arguments& arguments, bool is_one_of_several, const ImageFile& image, OutputSet& outputs,
                     ProgressWatch& watch) {
    const hmesh::Outline outline = outline_file(image, arguments.outline_options);
    const double seconds = watch.seconds();
    if (!outline.status) return {"the outline of " + input_words(arguments.input) + ": " + in_words(outline.status)};
    const auto report = [&](bool is_wanted, Layout layout) {
        return is_wanted ? outline_json(arguments, image, outline, seconds, layout) : std::string();
    };
    const std::string file_report = report(!arguments.report.empty(), Layout::indented);
    if (std::string why = write_outline_files(arguments, image, outline, file_report, outputs); !why.empty()) return {why};
    watch.finish();
    std::string why = tell(arguments, report(arguments.json, Layout::one_line),
                           [&](std::FILE* to) { print_outline(to, arguments, image, outline, is_one_of_several, seconds); });
    return why.empty() ? Failure() : Failure{why, true, true};
}

// What is done to all levels once they are meshed: faces of sprites are dropped, and colours found for linear light. Returns ""
// or what went wrong.
std::string finish_levels(const Arguments& arguments, const ImageFile& image, const MeshingOptions& options, bool is_set,
                          const hmesh::ParallelFor& parallel_for, ProgressWatch& watch, Made& made) {
    for (Level& level : made.levels) {
        if (!arguments.sprite) break;
        level.sprite = drop_faces(image, options, level.outcome, parallel_for);
        if (!level.sprite->status) return in_words(level.sprite->status);
    }
    if (!has_output(arguments, ".glb") || options.fit_space == FitSpace::linear || options.premultiplied || is_set ||
        image.rectangles)
        return {};
    watch.step("linear light", light_work(image));
    for (Level& level : made.levels)
        if (&level == &made.levels.front() || options.fit_space == FitSpace::each)
            level.light = light_mesh(image, options, level.outcome.mesh, parallel_for);
    return {};
}

// The files and pictures of a mesh that was read.
Failure convert(Arguments arguments, bool is_one_of_several, const std::vector<unsigned char>& bytes, ProgressWatch& watch) {
    if (!arguments.of_images.empty()) return {means_nothing_to_mesh(arguments, arguments.input)};
    ImageFile image;
    Made made;
    if (const std::string why = read_mesh(bytes, arguments, image, made); !why.empty())
        return {"cannot read " + input_words(arguments.input) + ": " + why};
    OutputSet outputs(arguments.folders);
    if (std::string why = outputs.test(output_files(arguments)); !why.empty()) return {why};
    watch.begin_mesh(0, 0, writing_work(arguments, image));
    if (std::string why = write_files(arguments, image, {}, made, {}, outputs, watch); !why.empty()) return {why};
    made.seconds = watch.seconds();
    watch.finish();
    std::string why = tell(arguments, {}, [&](std::FILE* to) { print_read(to, arguments, image, made, is_one_of_several); });
    return why.empty() ? Failure() : Failure{why, true, true};
}

Failure make_mesh(Arguments arguments, bool is_one_of_several, std::optional<example::ThreadPool>& pool) {
    ProgressWatch watch(!arguments.quiet && is_terminal(stderr));
    Inputs inputs;
    OutputSet outputs(arguments.folders);
    if (!arguments.out_of_core)  // else it is read as it is meshed
        if (const std::string why = read_file(arguments.input, inputs.bytes); !why.empty())
            return {"cannot read " + input_words(arguments.input) + ": " + (interrupted ? "interrupted" : why)};
    if (is_mesh({inputs.bytes.data(), inputs.bytes.size()})) return convert(arguments, is_one_of_several, inputs.bytes, watch);
    if (std::string why = read_inputs(arguments, inputs); !why.empty()) return {why};
    const ImageFile& image = inputs.image;
    if (arguments.meshing.target.kind != hmesh::Target::Kind::psnr)
        if (std::string why = find_too_many_levels(arguments.meshing, budget(arguments.meshing.target, image)); !why.empty())
            return {input_words(arguments.input) + ": " + why};
    if (std::string why = outputs.test(output_files(arguments)); !why.empty()) return {why};
    if (arguments.outline) {
        if (arguments.alpha >= 0) arguments.outline_options.threshold = arguments.alpha;
        watch.begin_mesh(0.03 * image.width * image.height, 0.03 * image.width * image.height, 1);
        return make_outline(arguments, is_one_of_several, image, outputs, watch);
    }
    if (arguments.sprite) {
        arguments.meshing.premultiplied = arguments.meshing.premultiplied || hmesh::kit::has_alpha(image.channels);
        arguments.meshing.transparent = arguments.alpha >= 0 ? arguments.alpha : default_transparent;
    }
    if (arguments.meshing.bytes > 0 && image.bits != 8)
        return {input_words(arguments.input) + ": --bytes makes files of 8-bit colours, and the image has " +
                std::to_string(image.bits) + " bits a sample"};
    if (!pool)
        if (std::string why = start(pool, arguments.threads); !why.empty()) return {why, false, true};

    MeshingOptions options = arguments.meshing;
    options.progress = watch;
    options.position_step = position_step(arguments, image);
    options.channel_weights = inputs.channel_weights;
    if (!arguments.weights.empty()) options.weights = inputs.weights.view();
    const hmesh::ParallelFor parallel_for = *pool;
    watch.begin_mesh(0.03 * image.width * image.height, meshing_work(image, options), writing_work(arguments, image));
    if (arguments.balances_maps) {
        MeshingOptions trial = options;
        const auto go_on = [](const hmesh::ProgressInfo&) { return !interrupted; };
        trial.progress = go_on;
        balance_maps(image, trial, parallel_for, inputs.maps);
        for (const Map& map : inputs.maps) arguments.channel_weights.push_back(map.weight);
        if (std::string why = spread_weights(arguments.channel_weights, inputs.maps, image, options.channel_weights);
            !why.empty())
            return {why};
    }
    const WrittenFiles files(arguments, image, options, parallel_for);
    const bool is_set = !inputs.maps.empty();
    if (options.target.kind == hmesh::Target::Kind::psnr && !is_set) options.psnr_of = files;
    Made made;
    hmesh::Lods lods;
    if (options.bytes == 0) lods = mesh_levels(image, options, *pool);
    hmesh::Result outcome = options.bytes == 0 ? first_level(lods) : fit_bytes(image, options, *pool, made.file);
    const bool is_interrupted = outcome.status.code == hmesh::Errc::cancelled;
    if (is_interrupted && arguments.keep_partial) {
        interrupted = false;
        keep_budget(image, options, *pool, outcome);
    }
    made.seconds = watch.seconds();
    watch.end_mesh();

    const std::string unread =
        image.rectangles && outcome.status.code == hmesh::Errc::read_failed ? ": " + image.rectangles->why() : "";
    const std::string sentence = what_is_made(arguments) + ": " + in_words(outcome.status) + unread;
    if (!outcome.has_mesh()) return {sentence, false, is_interrupted};
    if (is_interrupted && !arguments.keep_partial)
        return {sentence + "; nothing is written" + (options.levels > 1 ? "" : ", as --keep-partial is not given"), false, true};
    // make and Ninja would take files that are there as up to date, whatever the exit status was.
    if (!outcome.status && !arguments.depfile.empty())
        return {sentence + "; nothing is written, as --depfile asks for whole results", false, is_interrupted};
    // The mesh of four corners has not the sides that were asked for.
    if (options.border_tolerance && outcome.status.code == hmesh::Errc::target_out_of_range && outcome.report.vertices == 4)
        return {sentence + "; nothing is written"};
    if (std::string why = find_too_many_levels(options, outcome.report.vertices); !why.empty())
        return {input_words(arguments.input) + ": " + why + "; nothing is written"};
    made.levels.emplace_back().outcome = std::move(outcome);
    for (hmesh::Result& level : lods.levels) made.levels.emplace_back().outcome = std::move(level);
    if (std::string why = finish_levels(arguments, image, options, is_set, *pool, watch, made); !why.empty())
        return {what_is_made(arguments) + ": " + why};
    for (MeshFile& mesh : arguments.meshes)  // what was made of the levels, where it ended early
        mesh.coarser.resize(std::min(mesh.coarser.size(), made.levels.size() - 1));
    const auto& [finest, light, sprite] = made.finest();
    const hmesh::Status& status = finest.status;
    const bool has_missed = options.psnr_of && status.code == hmesh::Errc::target_out_of_range;
    const bool is_summed_up = !arguments.quiet && !is_one_of_several;
    if (is_summed_up || arguments.json || !arguments.report.empty() || has_missed) {
        if (is_set) measure_maps(finest.mesh, image, options.weights, inputs.maps);
        else if (!image.rectangles) made.written = files.measure(finest.mesh, finest.report.psnr, light);
    }
    made.maps = std::move(inputs.maps);
    const auto report = [&](bool is_wanted, Layout layout) {
        return is_wanted ? report_json(arguments, image, made, watch, layout) : std::string();
    };
    const std::string file_report = report(!arguments.report.empty(), Layout::indented);
    if (std::string why = write_files(arguments, is_set ? inputs.first : image, inputs.bytes, made, file_report, outputs, watch);
        !why.empty())
        return {why, false, is_interrupted};
    watch.finish();
    const std::string json_line = report(arguments.json, Layout::one_line);
    std::string untold = tell(arguments, json_line, [&](std::FILE* to) {
        if (is_one_of_several) print_line(to, arguments, image, made);
        else print_summary(to, arguments, image, made);
    });
    if (!untold.empty()) return {untold, true, true};
    if (status) return {};
    return {sentence + "; the mesh reached so far, " + std::to_string(finest.report.vertices) + " vertices and " +
                psnr_text(finest.report.psnr) + (has_missed ? least_text(made.written, finest.report.psnr) : "") + ", " +
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
