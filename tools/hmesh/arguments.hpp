// tools - the command line of hmesh: parsed strictly, every refusal a sentence that names the value.
#ifndef HMESH_TOOLS_ARGUMENTS_HPP
#define HMESH_TOOLS_ARGUMENTS_HPP

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "formats.hpp"
#include "hmesh/mesh_image.hpp"

namespace tool {

inline constexpr char usage[] =
    "usage: hmesh INPUT [-o FILE]... [--vertices N | --rate PERCENT | --psnr DB]\n"
    "             [--effort draft|fast|normal|best] [--method NAME] [--colors optimal|sampled]\n"
    "             [--fit-space stored|linear] [--premultiplied] [--seed N] [--weights FILE] [--tile N] [--threads N]\n"
    "             [--svg gradient|exact|flat] [--render FILE.png] [--render-scale N] [--wireframe FILE.png]\n"
    "             [--residual FILE.png] [--strip FILE.png] [--report FILE.json] [--depfile FILE]\n"
    "             [--quiet]\n";

inline constexpr char help[] =
    "\n"
    "Turns an image into a triangle mesh with one colour per vertex.\n"
    "\n"
    "  INPUT                 PNG, JPEG, BMP, TGA or binary PGM or PPM file, 8 or 16 bits, 1 to 4 channels\n"
    "  -o, --output FILE     write the mesh; may be given more than once, and the ending chooses the format:\n"
    "                        .ply .obj .glb (models), .pdf .eps .svg (drawings), .html (a page that shows it)\n"
    "  --vertices N          the mesh has N vertices\n"
    "  --rate PERCENT        the mesh has PERCENT vertices for 100 pixels (default: 1)\n"
    "  --psnr DB             the mesh has as few vertices as reach this PSNR\n"
    "  --effort NAME         draft, fast, normal or best: how long to look for a better mesh (default: normal)\n"
    "  --method NAME         annealed (default), or what it is compared with: hierarchical, xie, adams or\n"
    "                        adaptive_thinning, which know no effort, seed or tile\n"
    "  --colors NAME         optimal, by least squares, or sampled from the image under the vertices (default: sampled\n"
    "                        for xie, adams and adaptive_thinning, else optimal)\n"
    "  --fit-space NAME      stored (default), or linear: colours for programs that interpolate light, as glTF's do\n"
    "  --premultiplied       fit colours times alpha: what transparent pixels hide leaves no fringes\n"
    "  --seed N              of the random numbers; the same seed gives the same mesh (default: 1)\n"
    "  --weights FILE        an image of the same size: how much each pixel counts, black nothing, white fully\n"
    "                        (of colours the mean, without alpha)\n"
    "  --tile N              mesh in tiles of about N px, 64 to 65536 (default: one up to a megapixel, then 256)\n"
    "  --threads N           work on N threads, 1 to 1024; the mesh is the same for all N (default: 0, all cores)\n"
    "  --svg NAME            how .svg shows a face: gradient (default), one gradient; exact, one a channel, larger and\n"
    "                        slower; flat, its mean colour\n"
    "  --render FILE.png     draw the mesh\n"
    "  --render-scale N      at N times the size, 1 to 16 (default: 1)\n"
    "  --wireframe FILE.png  draw the mesh with its edges, at twice the size up to 2048 px\n"
    "  --residual FILE.png   draw the error: mesh less image, times 4, around grey\n"
    "  --strip FILE.png      draw image, mesh, mesh with edges and error side by side\n"
    "  --report FILE.json    write figures of the mesh and of each stage\n"
    "  --depfile FILE        write, as a rule for make or Ninja, which files were read for those written; nothing is\n"
    "                        written then after Ctrl-C, or where the PSNR asked for is out of reach\n"
    "  -q, --quiet           print errors only\n"
    "  -h, --help            print this text\n"
    "  --version             print the version\n"
    "\n"
    "PSNR = 10 log10(peak^2 / MSE), MSE the mean over pixels and channels of the image's stored values; with weights\n"
    "over weighted pixels, with --premultiplied of colours times alpha, with --fit-space linear of the mesh drawn so.\n"
    "Ctrl-C stops early and writes the mesh reached so far, unless --depfile is given.\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.\n";

template <class Value>
struct Named {
    const char* name;
    Value value;
};

inline constexpr Named<hmesh::Method> methods[] = {{"annealed", hmesh::Method::annealed},
                                                   {"hierarchical", hmesh::Method::hierarchical},
                                                   {"xie", hmesh::Method::xie},
                                                   {"adams", hmesh::Method::adams},
                                                   {"adaptive_thinning", hmesh::Method::adaptive_thinning}};
inline constexpr Named<hmesh::Colors> colors[] = {{"optimal", hmesh::Colors::optimal}, {"sampled", hmesh::Colors::sampled}};
inline constexpr Named<hmesh::FitSpace> fit_spaces[] = {{"stored", hmesh::FitSpace::stored},
                                                        {"linear", hmesh::FitSpace::linear_light}};
inline constexpr Named<hmesh::Effort> efforts[] = {{"draft", hmesh::Effort::draft},
                                                   {"fast", hmesh::Effort::fast},
                                                   {"normal", hmesh::Effort::normal},
                                                   {"best", hmesh::Effort::best}};
inline constexpr Named<hmesh::SvgKind> svg_kinds[] = {
    {"gradient", hmesh::SvgKind::gradient}, {"exact", hmesh::SvgKind::exact}, {"flat", hmesh::SvgKind::flat}};

template <class Value, std::size_t n>
[[nodiscard]] const char* name_of(const Named<Value> (&table)[n], Value value) {
    for (const Named<Value>& entry : table)
        if (entry.value == value) return entry.name;
    return "?";
}

struct Arguments {
    std::string input;
    std::vector<std::string> meshes;
    std::string weights;  // a file; empty: none
    std::string render, wireframe, residual, strip, report, depfile;
    int render_scale = 1;
    hmesh::SvgKind svg = hmesh::SvgKind::gradient;
    hmesh::Options options;
    unsigned threads = 0;             // 0: all cores
    std::string target = "--rate 1";  // as typed
    bool quiet = false, help = false, version = false;
};

namespace detail {

using std::to_string;

template <class Value, std::size_t n>
[[nodiscard]] std::string find_name(const Named<Value> (&table)[n], const std::string& option, const std::string& text,
                                    Value& value) {
    std::string names;
    for (const Named<Value>& entry : table) {
        if (text == entry.name) {
            value = entry.value;
            return {};
        }
        names += (names.empty() ? "" : ", ") + std::string(entry.name);
    }
    return option + " '" + text + "' is not one of: " + names;
}

[[nodiscard]] inline bool is_integer(const std::string& text) {
    const std::size_t sign = !text.empty() && text[0] == '-' ? 1 : 0;
    return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string::npos;
}

[[nodiscard]] inline std::string parse_integer(const std::string& option, const std::string& text, std::int64_t& value) {
    errno = 0;
    value = is_integer(text) ? std::strtoll(text.c_str(), nullptr, 10) : 0;
    return is_integer(text) && errno == 0 ? "" : option + " '" + text + "' is not a whole number";
}

[[nodiscard]] inline std::string parse_in_range(const std::string& option, const std::string& text, int least, int most,
                                                std::int64_t& value) {
    if (const std::string why = parse_integer(option, text, value); !why.empty()) return why;
    if (value >= least && value <= most) return {};
    return option + " '" + text + "' must be from " + to_string(least) + " to " + to_string(most);
}

[[nodiscard]] inline std::string parse_seed(const std::string& option, const std::string& text, std::uint64_t& value) {
    errno = 0;
    value = is_integer(text) ? std::strtoull(text.c_str(), nullptr, 10) : 0;
    return is_integer(text) && text[0] != '-' && errno == 0 ? ""
                                                            : option + " '" + text + "' is not a whole number from 0 to 2^64 - 1";
}

// A decimal number in (0, most].
[[nodiscard]] inline std::string parse_positive(const std::string& option, const std::string& text, double most, double& value) {
    char* end = nullptr;
    const bool plain = !text.empty() && text.find_first_not_of("0123456789.eE+-") == std::string::npos;
    value = plain ? std::strtod(text.c_str(), &end) : 0;
    if (!plain || *end != '\0') return option + " '" + text + "' is not a number";
    if (value > 0 && value <= most) return {};
    return option + " '" + text + "' must be above 0 and at most " + to_string(static_cast<int>(most));
}

[[nodiscard]] inline std::string set_png(const std::string& option, const std::string& text, std::string& file) {
    file = text;
    return has_ending(text, ".png") ? "" : option + " '" + text + "' must end in .png";
}

[[nodiscard]] inline std::string set_target(const std::string& option, const std::string& text, Arguments& out) {
    std::string why;
    std::int64_t count = 0;
    double number = 0;
    if (option == "--vertices") {
        why = parse_integer(option, text, count);
        out.options.target = hmesh::Target::vertices(count);
    } else if (option == "--rate") {
        why = parse_positive(option, text, 100, number);
        out.options.target = hmesh::Target::rate(number);
    } else {
        why = parse_positive(option, text, 1000, number);
        out.options.target = hmesh::Target::psnr(number);
    }
    out.target = option + " " + text;
    return why;
}

[[nodiscard]] inline std::string set_threads(const std::string& option, const std::string& text, unsigned& threads) {
    std::int64_t number = 0;
    const std::string why = parse_in_range(option, text, 0, 1024, number);
    threads = static_cast<unsigned>(number);
    return why;
}

[[nodiscard]] inline std::string set_tile(const std::string& option, const std::string& text, int& tile) {
    std::int64_t side = 0;
    const std::string why = parse_in_range(option, text, 64, hmesh::max_side, side);
    tile = static_cast<int>(side);
    return why;
}

[[nodiscard]] inline std::string set_scale(const std::string& option, const std::string& text, int& scale) {
    std::int64_t number = 0;
    const std::string why = parse_in_range(option, text, 1, 16, number);
    scale = static_cast<int>(number);
    return why;
}

// Sets an option that takes a value.
[[nodiscard]] inline std::string set(const std::string& option, const std::string& text, Arguments& out) {
    if (text.empty()) return option + " needs a value that is not empty";
    if (option == "-o" || option == "--output") {
        out.meshes.push_back(text);
        return find_format(text) != nullptr ? "" : option + " '" + text + "' must end in one of: " + format_endings();
    }
    if (option == "--vertices" || option == "--rate" || option == "--psnr") return set_target(option, text, out);
    if (option == "--effort") return find_name(efforts, option, text, out.options.effort);
    if (option == "--method") return find_name(methods, option, text, out.options.method);
    if (option == "--fit-space") return find_name(fit_spaces, option, text, out.options.fit_space);
    if (option == "--colors") return find_name(colors, option, text, out.options.colors.emplace());
    if (option == "--seed") return parse_seed(option, text, out.options.seed);
    if (option == "--tile") return set_tile(option, text, out.options.tile);
    if (option == "--threads") return set_threads(option, text, out.threads);
    if (option == "--render") return set_png(option, text, out.render);
    if (option == "--render-scale") return set_scale(option, text, out.render_scale);
    if (option == "--wireframe") return set_png(option, text, out.wireframe);
    if (option == "--residual") return set_png(option, text, out.residual);
    if (option == "--strip") return set_png(option, text, out.strip);
    if (option == "--svg") return find_name(svg_kinds, option, text, out.svg);
    (option == "--weights" ? out.weights : option == "--report" ? out.report : out.depfile) = text;
    return {};
}

[[nodiscard]] inline bool takes_value(const std::string& option) {
    static constexpr const char* names[] = {"-o",       "--output", "--vertices",     "--rate",      "--psnr",      "--effort",
                                            "--method", "--colors", "--seed",         "--weights",   "--tile",      "--threads",
                                            "--svg",    "--render", "--render-scale", "--fit-space", "--wireframe", "--residual",
                                            "--strip",  "--report", "--depfile"};
    return std::any_of(std::begin(names), std::end(names), [&](const char* name) { return option == name; });
}

[[nodiscard]] inline bool set_flag(const std::string& option, Arguments& out) {
    if (option == "--quiet" || option == "-q") return out.quiet = true;
    if (option == "--help" || option == "-h") return out.help = true;
    if (option == "--version") return out.version = true;
    if (option == "--premultiplied") return out.options.premultiplied = true;
    return false;
}

}  // namespace detail

// Every file that the command writes.
[[nodiscard]] inline std::vector<std::string> output_files(const Arguments& arguments) {
    std::vector<std::string> files = arguments.meshes;
    for (const std::string& file :
         {arguments.render, arguments.wireframe, arguments.residual, arguments.strip, arguments.report, arguments.depfile})
        if (!file.empty()) files.push_back(file);
    return files;
}

// Whether a mesh is to be written with this ending.
[[nodiscard]] inline bool has_output(const Arguments& arguments, const std::string& ending) {
    return std::any_of(arguments.meshes.begin(), arguments.meshes.end(),
                       [&](const std::string& name) { return has_ending(name, ending); });
}

// Reads the command line into `out`. Returns "" or what is wrong with it; asking for help or the version ends the
// reading.
[[nodiscard]] inline std::string parse(const std::vector<std::string>& words, Arguments& out) {
    std::vector<std::string> inputs, seen;
    bool options_end = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        std::string word = words[i];
        if (options_end || word.empty() || word[0] != '-') {
            inputs.push_back(word);
        } else if (word == "--") {
            options_end = true;
        } else if (detail::set_flag(word, out)) {
            if (out.help || out.version) return {};
        } else {
            const std::size_t equals = word.compare(0, 2, "--") == 0 ? word.find('=') : std::string::npos;
            const std::string option = word.substr(0, equals);
            if (!detail::takes_value(option)) return "unknown option '" + word + "'";
            if (equals == std::string::npos && i + 1 == words.size()) return option + " needs a value";
            const bool is_target = option == "--vertices" || option == "--rate" || option == "--psnr";
            const std::string kind = is_target ? "target" : option;
            if (option != "-o" && option != "--output" && std::count(seen.begin(), seen.end(), kind) != 0)
                return is_target ? "only one of --vertices, --rate and --psnr can be given, not also '" + word + "'"
                                 : option + " is given twice";
            seen.push_back(kind);
            const std::string text = equals == std::string::npos ? words[++i] : word.substr(equals + 1);
            if (const std::string why = detail::set(option, text, out); !why.empty()) return why;
        }
    }
    if (inputs.empty() || inputs[0].empty()) return "no input image is given";
    if (inputs.size() > 1) return "only one input image can be given, not also '" + inputs[1] + "'";
    out.input = inputs[0];
    if (std::count(seen.begin(), seen.end(), "--svg") != 0 && !has_output(out, ".svg"))
        return "--svg is given without an output that ends in .svg";
    if (std::count(seen.begin(), seen.end(), "--render-scale") != 0 && out.render.empty())
        return "--render-scale is given without --render";
    if (!out.depfile.empty() && output_files(out).size() == 1) return "--depfile is given without another output";
    return {};
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_HPP
