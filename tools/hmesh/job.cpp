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

#include "arguments/conflicts.hpp"
#include "arguments/files.hpp"
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

// What the steps from an image to the files of its mesh share.
struct MeshJob {
    MeshJob(const Arguments& given, bool is_of_several)
        : arguments(given), is_one_of_several(is_of_several), watch(!given.quiet && is_terminal(stderr)), outputs(given.folders) {
    }

    Arguments arguments;
    bool is_one_of_several;
    ProgressWatch watch;
    Inputs inputs;
    bool is_set = false;  // whether there are several maps
    OutputSet outputs;
    MeshingOptions options;  // those of the arguments, with what the inputs and the command add
    Made made;
};

// The files of an outline of the image, in place of a mesh.
Failure make_outline(MeshJob& job) {
    Arguments& arguments = job.arguments;
    const ImageFile& image = job.inputs.image;
    if (arguments.alpha >= 0) arguments.outline_options.threshold = arguments.alpha;
    job.watch.begin_mesh(0.03 * image.width * image.height, 0.03 * image.width * image.height, 1);
    const hmesh::Outline outline = outline_file(image, arguments.outline_options);
    const double seconds = job.watch.seconds();
    if (!outline.status) return {"the outline of " + input_words(arguments.input) + ": " + in_words(outline.status)};
    const auto report = [&](bool is_wanted, Layout layout) {
        return is_wanted ? outline_json(arguments, image, outline, seconds, layout) : std::string();
    };
    const std::string file_report = report(!arguments.report.empty(), Layout::indented);
    if (std::string why = write_outline_files(arguments, image, outline, file_report, job.outputs); !why.empty()) return {why};
    job.watch.finish();
    std::string why = tell(arguments, report(arguments.json, Layout::one_line),
                           [&](std::FILE* to) { print_outline(to, arguments, image, outline, job.is_one_of_several, seconds); });
    return why.empty() ? Failure() : Failure{why, true, true};
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

// The options that the mesh is made with, and the estimates of how long that takes. Returns "" or what went wrong.
std::string settle_options(MeshJob& job, const hmesh::ParallelFor& parallel_for) {
    Arguments& arguments = job.arguments;
    const ImageFile& image = job.inputs.image;
    if (arguments.sprite) {
        arguments.meshing.premultiplied = arguments.meshing.premultiplied || hmesh::kit::has_alpha(image.channels);
        arguments.meshing.transparent = arguments.alpha >= 0 ? arguments.alpha : default_transparent;
    }
    MeshingOptions& options = job.options;
    options = arguments.meshing;
    options.progress = job.watch;
    options.position_step = position_step(arguments, image);
    options.channel_weights = job.inputs.channel_weights;
    if (!arguments.weights.empty()) options.weights = job.inputs.weights.view();
    job.watch.begin_mesh(0.03 * image.width * image.height, meshing_work(image, options), writing_work(arguments, image));
    if (!arguments.balances_maps) return {};
    MeshingOptions trial = options;
    const auto go_on = [](const hmesh::ProgressInfo&) { return !interrupted; };
    trial.progress = go_on;
    balance_maps(image, trial, parallel_for, job.inputs.maps);
    for (const Map& map : job.inputs.maps) arguments.channel_weights.push_back(map.weight);
    return spread_weights(arguments.channel_weights, job.inputs.maps, image, options.channel_weights);
}

// What meshing came to.
struct Meshed {
    hmesh::Result outcome;  // of the finest level
    hmesh::Lods coarser;    // its levels are the others
    bool is_interrupted = false;
    std::string sentence;  // what is made, and the status
};

Meshed mesh_inputs(MeshJob& job, const hmesh::ParallelFor& parallel_for) {
    const ImageFile& image = job.inputs.image;
    const MeshingOptions& options = job.options;
    Meshed out;
    if (options.bytes == 0) out.coarser = mesh_levels(image, options, parallel_for);
    out.outcome = options.bytes == 0 ? first_level(out.coarser) : fit_bytes(image, options, parallel_for, job.made.file);
    out.is_interrupted = out.outcome.status.code == hmesh::Errc::cancelled;
    if (out.is_interrupted && job.arguments.keep_partial) {
        interrupted = false;
        keep_budget(image, options, parallel_for, out.outcome);
    }
    job.made.seconds = job.watch.seconds();
    job.watch.end_mesh();
    const hmesh::Status& status = out.outcome.status;
    const std::string unread = image.rectangles && status.code == hmesh::Errc::read_failed ? ": " + image.rectangles->why() : "";
    out.sentence = what_is_made(job.arguments) + ": " + in_words(status) + unread;
    return out;
}

// Why nothing is written of what meshing came to, if nothing is.
Failure find_unwritable(const MeshJob& job, const Meshed& meshed) {
    const Arguments& arguments = job.arguments;
    const MeshingOptions& options = job.options;
    const hmesh::Result& outcome = meshed.outcome;
    if (!outcome.has_mesh()) return {meshed.sentence, false, meshed.is_interrupted};
    if (meshed.is_interrupted && !arguments.keep_partial) {
        const char* const hint = options.levels > 1 ? "" : ", as --keep-partial is not given";
        return {meshed.sentence + "; nothing is written" + hint, false, true};
    }
    // make and Ninja would take files that are there as up to date, whatever the exit status was.
    if (!outcome.status && !arguments.depfile.empty())
        return {meshed.sentence + "; nothing is written, as --depfile asks for whole results", false, meshed.is_interrupted};
    if (std::string why = find_too_many_levels(options, outcome.report.vertices); !why.empty())
        return {input_words(arguments.input) + ": " + why + "; nothing is written"};
    return {};
}

// Takes all levels as what is made: faces of sprites are dropped, and colours found for linear light. Returns "" or what went
// wrong.
std::string finish_levels(MeshJob& job, Meshed& meshed, const hmesh::ParallelFor& parallel_for) {
    const ImageFile& image = job.inputs.image;
    const MeshingOptions& options = job.options;
    std::vector<Level>& levels = job.made.levels;
    levels.emplace_back().outcome = std::move(meshed.outcome);
    for (hmesh::Result& level : meshed.coarser.levels) levels.emplace_back().outcome = std::move(level);
    for (MeshFile& mesh : job.arguments.meshes)  // what was made of the levels, where it ended early
        mesh.coarser.resize(std::min(mesh.coarser.size(), levels.size() - 1));
    for (Level& level : levels) {
        if (!job.arguments.sprite) break;
        level.sprite = drop_faces(image, options, level.outcome, parallel_for);
        if (!level.sprite->status) return in_words(level.sprite->status);
    }
    if (!has_output(job.arguments, ".glb") || options.fit_space == FitSpace::linear || options.premultiplied || job.is_set ||
        image.rectangles)
        return {};
    job.watch.step("linear light", light_work(image));
    for (Level& level : levels)
        if (&level == &levels.front() || options.fit_space == FitSpace::each)
            level.light = light_mesh(image, options, level.outcome.mesh, parallel_for);
    return {};
}

// Whether the mesh is that of a search in which no file reached the PSNR.
bool has_missed(const MeshJob& job) {
    return job.options.psnr_of && job.made.finest().outcome.status.code == hmesh::Errc::target_out_of_range;
}

// Measures the finest level as the files hold it, where that is told.
void measure_finest(MeshJob& job, const WrittenFiles& files) {
    const Arguments& arguments = job.arguments;
    const Level& finest = job.made.finest();
    const hmesh::Result& outcome = finest.outcome;
    const bool is_summed_up = !arguments.quiet && !job.is_one_of_several;
    if (is_summed_up || arguments.json || !arguments.report.empty() || has_missed(job)) {
        if (job.is_set) measure_maps(outcome.mesh, job.inputs.image, job.options.weights, job.inputs.maps);
        else if (!job.inputs.image.rectangles) job.made.written = files.measure(outcome.mesh, outcome.report.psnr, finest.light);
    }
    job.made.maps = std::move(job.inputs.maps);
}

// Writes all files of what is made, and says what it is.
Failure write_and_tell(MeshJob& job, const Meshed& meshed) {
    const Arguments& arguments = job.arguments;
    const ImageFile& image = job.inputs.image;
    const Made& made = job.made;
    const auto report = [&](bool is_wanted, Layout layout) {
        return is_wanted ? report_json(arguments, image, made, job.watch, layout) : std::string();
    };
    const std::string file_report = report(!arguments.report.empty(), Layout::indented);
    if (std::string why = write_files(arguments, job.is_set ? job.inputs.first : image, job.inputs.bytes, made, file_report,
                                      job.outputs, job.watch);
        !why.empty())
        return {why, false, meshed.is_interrupted};
    job.watch.finish();
    const std::string json_line = report(arguments.json, Layout::one_line);
    std::string untold = tell(arguments, json_line, [&](std::FILE* to) {
        if (job.is_one_of_several) print_line(to, arguments, image, made);
        else print_summary(to, arguments, image, made);
    });
    if (!untold.empty()) return {untold, true, true};
    const hmesh::Result& finest = made.finest().outcome;
    if (finest.status) return {};
    return {meshed.sentence + "; the mesh reached so far, " + std::to_string(finest.report.vertices) + " vertices and " +
                psnr_text(finest.report.psnr) + (has_missed(job) ? least_text(made.written, finest.report.psnr) : "") + ", " +
                (output_files(arguments).empty() ? "is as above" : "is written"),
            true, meshed.is_interrupted};
}

// Why the image cannot be meshed as it is asked for, as far as that is known before; empty: it can.
std::string find_unmeshable(const Arguments& arguments, const ImageFile& image) {
    if (arguments.meshing.bytes == 0 || image.bits == 8) return {};
    return input_words(arguments.input) + ": --bytes makes files of 8-bit colours, and the image has " +
           std::to_string(image.bits) + " bits a sample";
}

Failure make_mesh(const Arguments& given, bool is_one_of_several, std::optional<example::ThreadPool>& pool) {
    MeshJob job(given, is_one_of_several);
    const Arguments& arguments = job.arguments;
    Inputs& inputs = job.inputs;
    if (!arguments.out_of_core)  // else it is read as it is meshed
        if (const std::string why = read_file(arguments.input, inputs.bytes); !why.empty())
            return {"cannot read " + input_words(arguments.input) + ": " + (interrupted ? "interrupted" : why)};
    if (is_mesh({inputs.bytes.data(), inputs.bytes.size()}))
        return convert(arguments, is_one_of_several, inputs.bytes, job.watch);
    if (std::string why = read_inputs(arguments, inputs); !why.empty()) return {why};
    job.is_set = !inputs.maps.empty();
    const ImageFile& image = inputs.image;
    if (arguments.meshing.target.kind != hmesh::Target::Kind::psnr)
        if (std::string why = find_too_many_levels(arguments.meshing, budget(arguments.meshing.target, image)); !why.empty())
            return {input_words(arguments.input) + ": " + why};
    if (std::string why = job.outputs.test(output_files(arguments)); !why.empty()) return {why};
    if (arguments.outline) return make_outline(job);
    if (std::string why = find_unmeshable(arguments, image); !why.empty()) return {why};
    if (!pool)
        if (std::string why = start(pool, arguments.threads); !why.empty()) return {why, false, true};

    const hmesh::ParallelFor parallel_for = *pool;
    if (std::string why = settle_options(job, parallel_for); !why.empty()) return {why};
    const WrittenFiles files(arguments, image, job.options, parallel_for);
    if (job.options.target.kind == hmesh::Target::Kind::psnr && !job.is_set) job.options.psnr_of = files;
    Meshed meshed = mesh_inputs(job, parallel_for);
    if (Failure failure = find_unwritable(job, meshed); !failure.why.empty()) return failure;
    if (std::string why = finish_levels(job, meshed, parallel_for); !why.empty()) return {what_is_made(arguments) + ": " + why};
    measure_finest(job, files);
    return write_and_tell(job, meshed);
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
        const std::string untold = tell(arguments, failure_json(arguments, failure.why), [](std::FILE*) {});
        if (!untold.empty()) fail(failed, untold);
        failure.ends_the_run = !untold.empty() || failure.ends_the_run;
    }
    return failure.ends_the_run || interrupted ? JobEnd::failed_for_all : JobEnd::failed;
}

}  // namespace tool
