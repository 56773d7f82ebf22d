// The only file of this command that compiles CLI11.
#include "terrain/arguments.hpp"

#include <cmath>

#include "arguments/command_words.hpp"
#include "arguments/job_options.hpp"
#include "arguments/parser.hpp"
#include "arguments/values.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/image/image_view.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/ending.hpp"

namespace terrain {
namespace {

using tool::add;
using tool::add_name;
using tool::JobCommand;

// A tile's window has up to three samples a side more than it has cells, and an image so many.
constexpr int most_cells = hmesh::kit::max_side - 3;

constexpr tool::Note notes[] = {
    {"Local metres",
     "+x is the east, +y the north and +z up (.glb: -z the north and +y up), from the south-western sample of the\n"
     "whole file; heights are its own. --report says where on the map that is. Degrees become metres by the length of a degree\n"
     "in the middle of the file, for all of it: reproject what is larger than some hundred kilometres."},
    {"Tiles",
     "with a bound, or --border-tolerance, neighbours have the same vertices and normals along their common row bit for\n"
     "bit, each made without the other: in one run, in several at once on many machines (--only), or after a crash (--resume)."},
    {"Jobs", "models that are more than one run's work, on one machine or many: hmesh-terrain job --help."},
    {"Examples",
     "  hmesh-terrain dem.tif -o terrain.glb --max-error 2\n"
     "  hmesh-terrain dem.tif -o tiles/t.terrain --max-error 2 --tiles 512 --resume --report tiles.json\n"
     "  hmesh-terrain dem.tif --tiles 512 --list | parallel hmesh-terrain dem.tif -o t.ply --max-error 2 --tiles 512 --only {}\n"
     "  hmesh-terrain N45E006.hgt -o model.stl --max-error 5 --scale 0.001 --z-scale 2 --base 0\n"
     "  hmesh-terrain heights.r16 --size 1025x1025 --type uint16 --spacing 2 -o terrain.obj --vertices 20000"},
    {"Exit status", "0 done, 1 failed, 2 wrong usage."}};

tool::CommandWords about() {
    return {"hmesh-terrain",
            HMESH_VERSION_STRING,
            "Turns a model of heights into the fewest triangles that keep a bound",
            {std::begin(notes), std::end(notes)},
            {}};
}

std::string formats_read() {
    const std::string gdal = gdal_version();
    return gdal.empty() ? ".asc, .hgt, 16-bit PNG and PGM" : "whatever GDAL reads";
}

// Numbers between commas, as many as there are.
template <std::size_t n>
std::string parse_numbers(const std::string& text, std::array<double, n>& values) {
    std::size_t from = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t comma = text.find(',', from);
        if ((comma == std::string::npos) != (k + 1 == n))
            return "is not " + std::to_string(n) + " numbers with commas between them";
        const std::string number = text.substr(from, comma == std::string::npos ? comma : comma - from);
        if (const std::string why = tool::parse_number(number, values[k]); !why.empty())
            return "has '" + number + "', which " + why;
        from = comma + 1;
    }
    return {};
}

// Two whole numbers with a mark between them.
std::string parse_two(const std::string& text, char mark, int least, int& a, int& b) {
    const std::size_t at = text.find(mark);
    if (at == std::string::npos) return std::string("is not two numbers with '") + mark + "' between them";
    if (std::string why = tool::parse_in_range(text.substr(0, at), least, 1000000000, a); !why.empty()) return why;
    return tool::parse_in_range(text.substr(at + 1), least, 1000000000, b);
}

std::string parse_finite(const std::string& text, double& value) {
    if (std::string why = tool::parse_number(text, value); !why.empty()) return why;
    return std::isfinite(value) ? "" : "is not finite";
}

std::string parse_factor(const std::string& text, double& value) {
    if (std::string why = parse_finite(text, value); !why.empty()) return why;
    return value > 0 ? "" : "must be above 0";
}

// The same into what may be left out.
template <class Parse>
std::string parse_into(Parse&& parse, const std::string& text, std::optional<double>& to) {
    double value = 0;
    std::string why = parse(text, value);
    to = value;
    return why;
}

std::string parse_extent(const std::string& text, std::optional<Extent>& extent) {
    Extent e{};
    if (std::string why = parse_numbers(text, e); !why.empty()) return why;
    extent = e;
    const bool is_within = std::fabs(e[0]) <= 360 && std::fabs(e[2]) <= 360 && e[1] >= -90 && e[3] <= 90;
    return is_within && e[0] < e[2] && e[1] < e[3] ? "" : "must be degrees: west below east, south below north, from -90 to 90";
}

void add_output_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("Files");
    add(app, "-o,--output", "FILE",
        "write the mesh; the ending chooses the format: .glb .ply .obj .stl, or .terrain, which is\n"
        "quantized-mesh 1.0 for Cesium",
        [&](const std::string& text) {
            out.output = text;
            out.format = format_of(text);
            return out.format == Format::none ? "must end in one of: .glb, .ply, .obj, .stl, .terrain" : "";
        });
    add(app, "--report", "FILE.json",
        "write what was made: samples, triangles, the largest error as measured on the very numbers\n"
        "of the file, the origin of its metres, the georeference, the share without data, seconds",
        [&](const std::string& text) {
            out.report = text;
            return "";
        });
}

void add_reading_options(CLI::App& app, Arguments& out) {
    add(app, "--no-data", "VALUE", "the height that stands for none, in place of the file's; NaN and infinities always do",
        [&](const std::string& text) { return parse_into(parse_finite, text, out.reading.no_data); });
    add(app, "--size", "WxH", "of a raw file: columns and rows, little-endian, the first row in the north",
        [&](const std::string& text) { return parse_two(text, 'x', 1, out.reading.raw_width, out.reading.raw_height); });
    add_name(app, "--type", "of a raw file: float32, int16 or uint16 (default: float32 or int16, by its size)", raw_types,
             [&](RawType type) { out.reading.raw_type = type; });
    app.add_flag_callback(
        "--no-gdal", [&] { out.reading.gdal = false; }, "read .asc, .hgt, PNG and PGM without GDAL, as builds without it do");
}

void add_mesh_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("How fine, one of");
    CLI::Option* bound =
        add(app, "--max-error", "E", "the fewest triangles of which none is off by more than E, in the file's heights",
            [&](const std::string& text) {
                std::string why = parse_into(parse_finite, text, out.max_error);
                return why.empty() && *out.max_error < 0 ? "must be 0 or more" : why;
            });
    CLI::Option* vertices =
        add(app, "--vertices", "N", "the least squared error with N vertices, in each tile; at most its samples in the last ones",
            [&](const std::string& text) {
                std::int64_t count = 0;
                std::string why = tool::parse_integer(text, count);
                out.vertices = count;
                return why.empty() && count < 4 ? "must be at least 4, the corners" : why;
            });
    CLI::Option* percent = add(app, "--percent", "P", "the same with P vertices for 100 samples", [&](const std::string& text) {
        double value = 0;
        std::string why = tool::parse_positive(text, 100, value);
        out.percent = value;
        return why;
    });
    vertices->excludes(bound);
    percent->excludes(bound)->excludes(vertices);
    add_name(app, "--effort", "draft, fast, normal or best: how long to look for fewer triangles (default: normal)", efforts,
             [&](Effort effort) { out.effort = effort; });

    app.add_flag_callback(
        "--free-borders", [&] { out.has_free_borders = true; },
        "with --max-error, 1 % fewer triangles of large models, up to a tenth of small ones, where nothing is\n"
        "to meet the borders, which else follow from their rows of samples alone");

    add(app, "--border-tolerance", "E",
        "with --vertices or --percent, borders within E of their rows of samples, from which alone they\n"
        "follow: tiles meet then",
        [&](const std::string& text) {
            std::string why = parse_into(parse_finite, text, out.border_tolerance);
            return why.empty() && *out.border_tolerance < 0 ? "must be 0 or more" : why;
        });
}

CLI::Option* add_tiles(CLI::App& app, Arguments& out, const char* description) {
    app.option_defaults()->group("Tiles");
    return add(app, "--tiles", "N", description, [&](const std::string& text) {
        std::string why = tool::parse_in_range(text, 1, most_cells, out.tile);
        out.reading.rows = out.tile;
        return why;
    });
}

void add_tile_options(CLI::App& app, Arguments& out) {
    CLI::Option* tiles =
        add_tiles(app, out,
                  "cut the model into tiles of N cells a side, 1 to 65533, of N + 1 samples, of which neighbours share\n"
                  "a row: files NAME_x_y.glb, x from the west, y from the north. No more of the file is in memory\n"
                  "than the tiles in work");
    tool::add_list(app, "--only", "X_Y", "this tile alone; may be given more than once", [&](const std::string& text) {
        out.only.emplace_back();
        return parse_two(text, '_', 0, out.only.back().x, out.only.back().y);
    })->needs(tiles);
    app.add_flag_callback(
        "--list", [&] { out.lists_tiles = true; }, "print the names of the tiles, x_y, one a line, and write nothing");
    app.add_flag_callback(
        "--resume", [&] { out.resumes = true; },
        "leave tiles as they are whose files are newer than the input. They are whole, but of which\n"
        "options they were made is not looked at");
    tool::add_jobs(app, "work on N tiles at once, or on one with N threads, 1 to 1024 (default: 0, all cores)", out.jobs);
}

void add_model_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("The model");
    add(app, "--scale", "S", "multiply metres and heights by S (default: 1)",
        [&](const std::string& text) { return parse_factor(text, out.scale); });
    add(app, "--z-scale", "S", "multiply heights by S (default: 1)",
        [&](const std::string& text) { return parse_factor(text, out.z_scale); });
    add(app, "--offset", "Z", "add Z to heights, in the file's, before they are multiplied (default: 0)",
        [&](const std::string& text) { return parse_finite(text, out.offset); });
    add(app, "--spacing", "M", "metres from sample to sample, in place of the file's (default: 1 where it says none)",
        [&](const std::string& text) { return parse_into(parse_factor, text, out.spacing); });
    app.add_flag_callback(
        "--no-normals", [&] { out.has_normals = false; }, "leave out the normals, which are those of the samples");
    add(app, "--base", "Z", ".stl: close the model with walls and a floor at this height, in the file's, to print it",
        [&](const std::string& text) { return parse_into(parse_finite, text, out.base); });
    add(app, "--extent", "W,S,E,N", ".terrain: degrees of the outermost samples, in place of the file's",
        [&](const std::string& text) { return parse_extent(text, out.extent); });
    add(app, "--heights", "LOW,HIGH",
        ".terrain: between which the heights of all tiles are, in the file's, so that 15 bits say\n"
        "them alike (default with --tiles: the file is read once to find out; else its own)",
        [&](const std::string& text) {
            out.heights.emplace();
            std::string why = parse_numbers(text, *out.heights);
            return why.empty() && !((*out.heights)[0] <= (*out.heights)[1]) ? "must be the lowest, then the highest" : why;
        });
}

constexpr char version_words[] = "print the version, and what reads files";

std::string dem_words() { return "one file of one channel: " + formats_read() + ";\nor raw numbers, see --size"; }

std::string version() {
    const std::string gdal = gdal_version();
    return "hmesh-terrain " HMESH_VERSION_STRING "\nreads\n  " + (gdal.empty() ? "" : gdal + "\n  ") +
           ".asc, .hgt, PGM, PNG, raw: hmesh\n";
}

std::string find_second(const std::vector<std::string>& inputs) {
    if (inputs.size() < 2) return {};
    return "'" + inputs[0] + "' and '" + inputs[1] + "' are two inputs: gdalbuildvrt makes one of them";
}

// Whether an option is, which this command line need not have.
bool is_given(const CLI::App& app, const char* name) {
    const CLI::Option* const option = app.get_option_no_throw(name);
    return option != nullptr && option->count() != 0;
}

// What is wrong with a command line of which each option is right by itself.
std::string find_conflict(const CLI::App& app, const Arguments& arguments) {
    if (tool::is_standard(arguments.input)) return "the standard input is no file, of which parts can be read";
    if (arguments.input.empty()) return "no input file is given";
    for (const char* option : {"--list", "--resume"})  // a flag's needs() would be seen in the help
        if (is_given(app, option) && arguments.tile == 0) return std::string(option) + " requires --tiles";
    if (arguments.reading.raw_type != RawType::by_size && arguments.reading.raw_width == 0)
        return "--type is given without --size";
    if (arguments.lists_tiles) return {};
    if (arguments.output.empty()) return "no output is given: -o names it";
    if (!arguments.max_error && !arguments.vertices && !arguments.percent)
        return "how fine is not said: --max-error, or --vertices or --percent";
    if (arguments.has_free_borders && !arguments.max_error) return "--free-borders is given without --max-error";
    if (arguments.has_free_borders && arguments.tile != 0)
        return "--free-borders is given with --tiles, whose borders are to meet";
    if (arguments.border_tolerance && arguments.max_error)
        return "--border-tolerance is given with --max-error, whose borders follow from their rows in any case";
    if (!arguments.has_normals && arguments.format == Format::stl)
        return "--no-normals means nothing to .stl, which has normals of faces alone";
    if (arguments.base && arguments.format != Format::stl) return "--base is given without an output that ends in .stl";
    const bool is_globe = arguments.format == Format::quantized_mesh;
    if (arguments.extent && !is_globe) return "--extent is given without an output that ends in .terrain";
    if (arguments.heights && !is_globe) return "--heights is given without an output that ends in .terrain";
    for (const char* option : {"--scale", "--spacing"})
        if (is_globe && is_given(app, option))
            return std::string(option) + " means nothing to .terrain, which stands on the Earth by its degrees";
    return {};
}

}  // namespace

Format format_of(const std::string& name) {
    for (const auto& format : formats)
        if (tool::has_ending(name, format.name)) return format.value;
    return Format::none;
}

CommandLine parse(const std::vector<std::string>& words) {
    CommandLine line;
    Arguments& arguments = line.arguments;
    const tool::CommandWords words_of_command = about();
    CLI::App app(words_of_command.summary + ".\n", words_of_command.name);
    tool::lay_out(app, "The heights");
    app.footer(tool::footer(words_of_command.notes));
    std::vector<std::string> inputs;
    tool::add_names(app, "DEM", dem_words(), inputs);
    add_output_options(app, arguments);
    add_reading_options(app, arguments);
    add_mesh_options(app, arguments);
    add_tile_options(app, arguments);
    add_model_options(app, arguments);
    tool::add_quiet(app, arguments.quiet, version_words);
    tool::add_words(app);
    try {
        line.wrong = tool::parse_words(app, words, "no input file is given");
    } catch (const tool::Question& question) {
        line.answer = tool::answer(app, question, version(), words_of_command, {"only"});
        return line;
    }
    if (!line.wrong.empty()) return line;
    line.wrong = find_second(inputs);
    arguments.input = inputs.front();
    if (line.wrong.empty()) line.wrong = find_conflict(app, arguments);
    return line;
}

// ---- hmesh-terrain job ----

namespace {

constexpr char job_help[] =
    "Meshes a model of heights as a job in files: a folder in which a plan says what is to be done, and any engine does it,\n"
    "task after task, on one machine or on many that share the folder. The files are byte for byte those of one process,\n"
    "whatever engine, order, machine or restart.\n"
    "\n"
    "  hmesh-terrain job plan DEM -o JOB --max-error E   writes what is to be done, and build.ninja, slurm.sh and parallel.sh,\n"
    "                                                    by which ninja, Slurm and GNU parallel do it\n"
    "  hmesh-terrain job run JOB TASK...                 does tasks\n"
    "  hmesh-terrain job status JOB                      says what is done, and what is missing or damaged\n"
    "  hmesh-terrain job join JOB -o FILE|FOLDER         one .ply, .obj or .glb, or a folder of tiles with its index\n"
    "\n"
    "`hmesh-terrain job plan --help`, and so on, lists options. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

constexpr char plan_footer[] =
    "JOB is a new folder: nothing outside of it is written. The same plan may be made again.\n"
    "Examples:\n"
    "  hmesh-terrain job plan dem.tif -o job --max-error 2 && ninja -C job && hmesh-terrain job join job -o terrain.ply\n"
    "  hmesh-terrain job plan dem.tif -o job --max-error 2 --format terrain && job/slurm.sh --partition=short";

constexpr tool::Named<Format> job_formats[] = {{"glb", Format::glb}, {"terrain", Format::quantized_mesh}};

// The words of the options that say what is made, for the plan.
std::vector<std::string> words_of(const CLI::App& app) {
    std::vector<std::string> words;
    for (const CLI::Option* option : app.get_options()) {
        const bool is_made = option->get_group() != "The job" && option->get_group() != "What is said";
        if (option->count() == 0 || option->get_lnames().empty() || !is_made) continue;
        words.push_back("--" + option->get_lnames().front());
        if (option->get_items_expected_max() > 0) words.insert(words.end(), option->results().begin(), option->results().end());
    }
    return words;
}

void add_plan_options(CLI::App& app, JobArguments& out, std::vector<std::string>& inputs) {
    tool::begin_job(app, "The heights");
    app.footer(plan_footer);
    tool::add_names(app, "DEM", dem_words(), inputs);
    tool::add_plan_options(app, out);
    add_name(app, "--format", "of tiles: glb, which job join makes one file of, or terrain for Cesium (default: glb)",
             job_formats, [&](Format format) { out.dem.format = format; });
    add(app, "--levels", "N",
        "levels of detail, 1 to 16 (default: 1): tiles of each next one have twice the side, every other sample\n"
        "and twice the bound",
        [&](const std::string& text) { return tool::parse_in_range(text, 1, 16, out.levels); });
    app.add_flag_callback(
        "--skirts", [&] { out.has_skirts = true; },
        "with --levels, hang walls from the sides of .glb tiles, so deep that no crack to a tile of another\n"
        "level is seen");
    tool::add_quiet(app, out.quiet, version_words);
    app.option_defaults()->group("How the input is read");
    add_reading_options(app, out.dem);
    add_mesh_options(app, out.dem);
    add_tiles(app, out.dem, "cells of a tile's side, 1 to 65533 (default: 2048)");
    add_model_options(app, out.dem);
    for (const char* refused : {"--free-borders", "--base"}) app.get_option(refused)->group("");  // in a sentence
}

void add_join_options(CLI::App& app, JobArguments& out) {
    tool::begin_job(app, "What is done");
    tool::add_folder(app, out);
    tool::add_text(app, "-o,--output", "PATH", "a file that ends in .ply, .obj or .glb, or a folder for tiles and their index",
                   out.output);
    app.add_flag_callback(
        "--open-seams", [&] { out.takes_open_seams = true; }, "join tiles that do not meet, too");
    tool::add_quiet(app, out.quiet, version_words);
}

std::string find_conflict(const CLI::App& app, JobArguments& job) {
    Arguments& dem = job.dem;
    if (job.folder.empty()) return "no folder is given: -o names it";
    if (dem.tile == 0) dem.tile = dem.reading.rows = 2048;
    if (dem.has_free_borders) return "--free-borders is given for a job, whose tiles are to meet";
    if (dem.base) return "--base is given for a job, which makes no .stl files";
    if ((dem.vertices || dem.percent) && !dem.border_tolerance)
        return "tiles with a number of vertices meet with --border-tolerance alone, which is not given";
    if (dem.format == Format::none) dem.format = Format::glb;
    if (job.has_skirts && job.levels == 1) return "--skirts is given without --levels: tiles of one level meet";
    if (job.has_skirts && dem.format == Format::quantized_mesh)
        return "--skirts is given for .terrain, of which Cesium hangs skirts itself";
    if (dem.format == Format::glb && (dem.extent || dem.heights))
        return std::string(dem.extent ? "--extent" : "--heights") + " is given without --format terrain";
    dem.output = job.folder + (dem.format == Format::glb ? "/tiles.glb" : "/tiles.terrain");
    return find_conflict(app, dem);
}

}  // namespace

JobCommandLine parse_job(const std::vector<std::string>& words) {
    JobCommandLine line;
    JobArguments& job = line.arguments;
    if (!tool::find_job_command(words, job_help, job, line.wrong, line.answer)) return line;
    CLI::App app("", "hmesh-terrain job " + words.front());
    std::vector<std::string> inputs;
    switch (job.command) {
        case JobCommand::plan: add_plan_options(app, job, inputs); break;
        case JobCommand::run: tool::add_run_options(app, job, version_words); break;
        case JobCommand::status: tool::add_status_options(app, job, version_words); break;
        case JobCommand::join: add_join_options(app, job); break;
    }
    try {
        line.wrong = tool::parse_words(app, {words.begin() + 1, words.end()}, tool::missing_words(job.command));
    } catch (const tool::Question& question) {
        line.answer = tool::answer(app, question, version(), {}, {});
        return line;
    }
    if (!line.wrong.empty()) return line;
    if (job.command == JobCommand::join) line.wrong = tool::find_output_conflict(job);
    if (job.command != JobCommand::plan) return line;
    line.wrong = find_second(inputs);
    job.input = job.dem.input = inputs.front();
    if (line.wrong.empty()) line.wrong = find_conflict(app, job);
    job.words = words_of(app);
    return line;
}

}  // namespace terrain
