// The only file that compiles CLI11. Numbers are parsed here, so that every sentence about them names the value and the bound.
#include "arguments.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <functional>

#include "formats.hpp"
#include "hmesh/core/version.hpp"
#include "image_file.hpp"

namespace tool {
namespace {

// --- values: what returns a string returns "" or what is wrong with the text, as the end of a sentence ---

bool is_integer(const std::string& text) {
    const std::size_t sign = !text.empty() && text[0] == '-' ? 1 : 0;
    return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string::npos;
}

std::string parse_integer(const std::string& text, std::int64_t& value) {
    errno = 0;
    value = is_integer(text) ? std::strtoll(text.c_str(), nullptr, 10) : 0;
    if (!is_integer(text)) return "is not a whole number";
    return errno == 0 ? "" : "is a larger number than any image has pixels";
}

template <class Integer>
std::string parse_in_range(const std::string& text, std::int64_t least, std::int64_t most, Integer& value) {
    std::int64_t number = 0;
    if (std::string why = parse_integer(text, number); !why.empty()) return why;
    value = static_cast<Integer>(number);
    if (number >= least && number <= most) return {};
    return "must be from " + std::to_string(least) + " to " + std::to_string(most);
}

std::string parse_seed(const std::string& text, std::uint64_t& value) {
    errno = 0;
    value = is_integer(text) ? std::strtoull(text.c_str(), nullptr, 10) : 0;
    return is_integer(text) && text[0] != '-' && errno == 0 ? "" : "is not a whole number from 0 to 2^64 - 1";
}

// A decimal number in (0, most].
std::string parse_positive(const std::string& text, int most, double& value) {
    char* end = nullptr;
    const bool is_plain = !text.empty() && text.find_first_not_of("0123456789.eE+-") == std::string::npos;
    value = is_plain ? std::strtod(text.c_str(), &end) : 0;
    if (!is_plain || *end != '\0') return "is not a number";
    return value > 0 && value <= most ? "" : "must be above 0 and at most " + std::to_string(most);
}

std::string set_png(const std::string& text, std::string& file) {
    file = text;
    return has_ending(text, ".png") ? "" : "must end in .png";
}

std::string add_mesh(const std::string& text, std::vector<std::string>& meshes) {
    meshes.push_back(text);
    return is_format(text) ? "" : "must end in one of: " + format_endings();
}

std::string set_file(const std::string& text, std::string& file) {
    file = text;
    return {};
}

// --- options ---

using Set = std::function<std::string(const std::string& text)>;

// Adds an option with a value, which `set` takes. Where `set` finds something wrong, the parser throws it as a sentence.
CLI::Option* add(CLI::App& app, const std::string& names, const char* value, const char* description, Set set) {
    const std::string name = names.substr(names.find(',') + 1);
    const auto set_all = [name, set = std::move(set), is_list = name == "--output"](const CLI::results_t& texts) {
        if (texts.size() > 1 && !is_list) throw CLI::ValidationError(name + " is given twice");
        for (const std::string& text : texts) {
            if (text.empty()) throw CLI::ValidationError(name + " needs a value that is not empty");
            if (const std::string why = set(text); !why.empty()) throw CLI::ValidationError(name + " '" + text + "' " + why);
        }
        return true;
    };
    return app.add_option(names, set_all, description)->option_text(value)->take_all();
}

void add_mesh_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("Mesh files");
    add(app, "-o,--output", "FILE",
        "write the mesh; may be given more than once, and the ending chooses the format:\n"
        ".ply .obj .glb (models), .pdf .eps .svg (drawings), .html (a page that shows it)",
        [&](const std::string& text) { return add_mesh(text, out.meshes); });
    add(app, "--svg", "NAME",
        "how .svg shows a face: gradient (default), one gradient; exact, one a channel, larger\n"
        "and slower; flat, its mean colour",
        [&](const std::string& text) { return find_name(svg_kinds, text, out.svg); });
    app.add_flag_callback(
        "--no-original", [&] { out.original = false; },
        "leave the image out of .html, of which it is the larger part: nothing to compare with");

    app.option_defaults()->group("How many vertices, one of");
    CLI::Option* vertices = add(app, "--vertices", "N", "the mesh has N vertices", [&](const std::string& text) {
        std::int64_t count = 0;
        std::string why = parse_integer(text, count);
        out.meshing.target = hmesh::Target::vertices(count);
        out.target = "--vertices " + text;
        return why;
    });
    CLI::Option* rate =
        add(app, "--rate", "PERCENT", "PERCENT vertices for 100 pixels (default: 1)", [&](const std::string& text) {
            double percent = 0;
            std::string why = parse_positive(text, 100, percent);
            out.meshing.target = hmesh::Target::percent(percent);
            out.target = "--rate " + text;
            return why;
        });
    CLI::Option* psnr =
        add(app, "--psnr", "DB",
            "as few vertices as reach this PSNR, as every file\nholds it that is written, and the .png of --render",
            [&](const std::string& text) {
                double decibel = 0;
                std::string why = parse_positive(text, 1000, decibel);
                out.meshing.target = hmesh::Target::psnr(decibel);
                out.target = "--psnr " + text;
                return why;
            });
    rate->excludes(vertices);
    psnr->excludes(vertices)->excludes(rate);
}

void add_meshing_options(CLI::App& app, Arguments& out) {
    MeshingOptions& meshing = out.meshing;
    app.option_defaults()->group("How the mesh is made");
    add(app, "--effort", "NAME", "draft, fast, normal or best: how long to look for a better mesh (default: normal)",
        [&](const std::string& text) { return find_name(efforts, text, meshing.effort); });
    add(app, "--method", "NAME",
        "annealed (default), or what it is compared with: hierarchical, xie, adams or\n"
        "adaptive_thinning, which know no effort, seed or tile",
        [&](const std::string& text) { return find_name(methods, text, meshing.method); });
    add(app, "--colors", "NAME",
        "optimal, by least squares, or sampled from the image under the vertices (default:\n"
        "sampled for xie, adams and adaptive_thinning, else optimal)",
        [&](const std::string& text) { return find_name(colors, text, meshing.colors.emplace()); });
    add(app, "--fit-space", "NAME",
        "stored (default); linear: colours for programs that interpolate light, as glTF's do;\n"
        "each: those in .glb, all else as stored",
        [&](const std::string& text) { return find_name(fit_spaces, text, meshing.fit_space); });
    app.add_flag_callback(
        "--premultiplied", [&] { meshing.premultiplied = true; },
        "fit colours times alpha: what transparent pixels hide leaves no fringes");
    add(app, "--weights", "FILE",
        "an image of the same size: how much each pixel counts, black nothing, white fully\n"
        "(of colours the mean, without alpha)",
        [&](const std::string& text) { return set_file(text, out.weights); });
    add(app, "--seed", "N", "of the random numbers; the same seed gives the same mesh (default: 1)",
        [&](const std::string& text) { return parse_seed(text, meshing.seed); });
    add(app, "--tile", "N", "mesh in tiles of about N px, 64 to 65536 (default: one up to a megapixel, then 256)",
        [&](const std::string& text) { return parse_in_range(text, 64, hmesh::kit::max_side, meshing.tile); });
    add(app, "--threads", "N", "work on N threads, 1 to 1024; the mesh is the same for all N (default: 0, all cores)",
        [&](const std::string& text) { return parse_in_range(text, 0, 1024, out.threads); });
}

void add_other_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("Pictures of the mesh");
    CLI::Option* render =
        add(app, "--render", "FILE.png", "draw the mesh", [&](const std::string& text) { return set_png(text, out.render); });
    add(app, "--render-scale", "N", "at N times the size, 1 to 16 (default: 1)", [&](const std::string& text) {
        return parse_in_range(text, 1, 16, out.render_scale);
    })->needs(render);
    add(app, "--wireframe", "FILE.png", "draw the mesh with its edges, at twice the size up to 2048 px",
        [&](const std::string& text) { return set_png(text, out.wireframe); });
    add(app, "--residual", "FILE.png", "draw the error: mesh less image, times 4, around grey",
        [&](const std::string& text) { return set_png(text, out.residual); });
    add(app, "--strip", "FILE.png", "draw image, mesh, mesh with edges and error side by side",
        [&](const std::string& text) { return set_png(text, out.strip); });

    app.option_defaults()->group("What is said");
    add(app, "--report", "FILE.json", "write figures of the mesh and of each stage",
        [&](const std::string& text) { return set_file(text, out.report); });
    add(app, "--depfile", "FILE",
        "write, as a rule for make or Ninja, which files were read for those written; nothing\n"
        "is written then where the PSNR asked for is out of reach",
        [&](const std::string& text) { return set_file(text, out.depfile); });
    app.add_flag_callback(
        "--keep-partial", [&] { out.keep_partial = true; },
        "after Ctrl-C, write the mesh reached so far, with no more vertices than asked for");
    app.add_flag_callback(
        "-q,--quiet", [&] { out.quiet = true; }, "print errors only");
    // At once, whatever is wrong with the rest of the command line.
    app.set_help_flag();
    app.add_flag_callback(
           "-h,--help", [] { throw CLI::CallForHelp(); }, "print this text")
        ->trigger_on_parse();
    app.add_flag_callback(
           "--version", [] { throw CLI::CallForVersion("", 0); }, "print the version, and which image files are read by what")
        ->trigger_on_parse();
}

constexpr char footer[] =
    "PSNR = 10 log10(peak^2 / MSE), MSE the mean over pixels and channels of the image's stored values; with weights\n"
    "over weighted pixels, with --premultiplied of colours times alpha, with --fit-space linear of the mesh drawn so.\n"
    "The values drawn are not rounded for it. A .png is rounded to 8 bits, and so are the colours of some formats where the\n"
    "image has more: --psnr is kept by what the files hold, with --fit-space each by .glb as its viewers show it.\n"
    "Ctrl-C stops early and leaves files as they are; with --keep-partial the mesh reached so far is written.\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.";

// What is wrong with a command line of which each option is right by itself.
std::string find_conflict(const CLI::App& app, const Arguments& arguments) {
    if (arguments.input.empty()) return "no input image is given";
    if (app.count("--svg") != 0 && !has_output(arguments, ".svg")) return "--svg is given without an output that ends in .svg";
    if (!arguments.original && !has_output(arguments, ".html"))
        return "--no-original is given without an output that ends in .html";
    if (!arguments.depfile.empty() && output_files(arguments).size() == 1) return "--depfile is given without another output";
    if (arguments.keep_partial && !arguments.depfile.empty())
        return "--keep-partial is given with --depfile, for which nothing but whole results is written";
    for (const char* option : {"--effort", "--seed", "--tile"})
        if (arguments.meshing.method != Method::annealed && app.count(option) != 0)
            return std::string(option) + " means nothing to --method " + name_of(methods, arguments.meshing.method);
    return find_conflict(arguments.meshing);
}

}  // namespace

std::vector<std::string> output_files(const Arguments& arguments) {
    std::vector<std::string> files = arguments.meshes;
    for (const std::string& file :
         {arguments.render, arguments.wireframe, arguments.residual, arguments.strip, arguments.report, arguments.depfile})
        if (!file.empty()) files.push_back(file);
    return files;
}

bool has_output(const Arguments& arguments, const std::string& ending) {
    return std::any_of(arguments.meshes.begin(), arguments.meshes.end(),
                       [&](const std::string& name) { return has_ending(name, ending); });
}

CommandLine parse(const std::vector<std::string>& words) {
    CommandLine line;
    Arguments& arguments = line.arguments;
    CLI::App app("Turns an image into a triangle mesh with one colour per vertex.\n", "hmesh");
    app.footer(footer);
    app.get_formatter()->column_width(24);
    app.get_formatter()->label("Positionals", "The image");
    app.get_formatter()->label("OPTIONS", "OPTION...");
    app.get_formatter()->label("REQUIRED", "");
    app.allow_extras();  // they are told below
    app.option_defaults()->disable_flag_override();
    const auto set_input = [&](const CLI::results_t& texts) {
        arguments.input = texts.front();
        return true;
    };
    app.add_option("INPUT", set_input,
                   "image file: " + formats_read() + "; 8 or 16\nbits or floats, 1 to 4 channels; --version says what reads them")
        ->required();
    add_mesh_options(app, arguments);
    add_meshing_options(app, arguments);
    add_other_options(app, arguments);
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
        line.wrong = find_conflict(app, arguments);
    } catch (const CLI::CallForHelp&) {
        line.answer = CLI::detail::find_and_replace(app.help(), "\n\n\n", "\n\n");  // between groups
        return line;
    } catch (const CLI::CallForVersion&) {
        line.answer = "hmesh " HMESH_VERSION_STRING "\nreads\n" + decoders();
        return line;
    } catch (const CLI::RequiredError&) {
        line.wrong = "no input image is given";
    } catch (const CLI::ArgumentMismatch& error) {  // says "--rate: 1 required  missing" or "quiet was given a disallowed ..."
        const std::string what = error.what();
        const std::size_t colon = what.find(':');
        line.wrong = colon == std::string::npos ? "--" + what.substr(0, what.find(' ')) + " takes no value"
                                                : what.substr(0, colon) + " needs a value";
    } catch (const CLI::ParseError& error) {
        line.wrong = error.what();
    }
    for (const std::string& word : app.remaining()) {
        if (word == "--") continue;
        return {{},
                word[0] == '-' ? "unknown option '" + word + "'" : "only one input image can be given, not also '" + word + "'",
                {}};
    }
    return line;
}

}  // namespace tool
