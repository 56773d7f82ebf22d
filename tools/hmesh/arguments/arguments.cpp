// The only file of this command that compiles CLI11. Numbers are parsed here, so that every sentence about them names the value
// and the bound.
#include "arguments/arguments.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "arguments/command_words.hpp"
#include "arguments/job_options.hpp"
#include "arguments/map_names.hpp"
#include "arguments/parser.hpp"
#include "arguments/patterns.hpp"
#include "arguments/tile_job.hpp"
#include "arguments/values.hpp"
#include "hmesh/core/version.hpp"
#include "readers/image_file.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/depfile.hpp"
#include "writers/ending.hpp"
#include "writers/formats.hpp"
#include "writers/meshopt.hpp"

namespace tool {
namespace {

// --- options ---

constexpr int most_border_tolerance = 1000000;  // in stored values, of meshes and of jobs

std::string set_png(const std::string& text, std::string& file) {
    file = text;
    return is_standard(text) || has_ending(text, ".png") ? "" : "must end in .png";
}

std::string set_file(const std::string& text, std::string& file) {
    file = text;
    return {};
}

std::string find_too_few(std::int64_t vertices) { return vertices >= 4 ? "" : "must be at least 4, the corners of an image"; }

void add_file_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("Mesh files");
    add_list(app, "-o,--output", "FILE",
             "write the mesh; may be given more than once, and the ending chooses the format:\n"
             ".ply .obj .glb (models), .pdf .eps .svg (drawings), .html (a page that shows it),\n"
             ".hmc (the smallest, which hmesh reads: docs/compact.md).\n"
             "{name} in it is the name of the image, without folder and ending; folders of such\n"
             "names are made. - is the standard output, and the summary goes to stderr then",
             [&](const std::string& text) {
                 out.meshes.push_back({text, format_ending(text)});
                 return "";
             });
    const std::vector<std::string> formats = format_names();
    add(
        app, "--format", "NAME", "ply, obj, glb, pdf, eps, svg, html or hmc: of -o - and of names that end in none of these",
        [&, formats](const std::string& text) {
            if (std::find(formats.begin(), formats.end(), text) == formats.end())
                return "is not one of: " + joined(formats, ", ");
            for (MeshFile& mesh : out.meshes)
                if (mesh.ending.empty()) mesh.ending = "." + text;
            return std::string();
        },
        joined(formats, " "));
    add_name(app, "--svg",
             "how .svg shows a face: gradient (default), one gradient; exact, one a channel, larger\n"
             "and slower; flat, its mean colour",
             svg_kinds, [&](hmesh::SvgOptions::Kind kind) { out.svg = kind; });
    add_name(app, "--glb",
             "how .glb holds the mesh: exact (default), for every reader; packed, 16-bit positions in\n"
             "an order for GPUs (KHR_mesh_quantization); meshopt, that compressed\n"
             "(EXT_meshopt_compression); which viewers read them: docs/formats.md",
             glb_forms, [&](GlbForm form) { out.glb = form; });
    add(
        app, "--glb-bits", "N", "bits of a colour in .glb: 16 (default), or 8, smaller and coarser",
        [&](const std::string& text) {
            if (text != "8" && text != "16") return "must be 8 or 16";
            out.glb_color_bits = text == "8" ? 8 : 16;
            return "";
        },
        "8 16");
    add(app, "--lods", "N",
        "N levels of detail, 1 to 32, with n, n/2, n/4 .. vertices. A .glb holds all (MSFT_lod);\n"
        "in other formats, and where the name holds {lod}, each has its file: {lod} is 0, 1 .., or\n"
        "_lod1, _lod2 .. comes before the ending of all but the finest. Pictures show the finest",
        [&](const std::string& text) { return parse_in_range(text, 1, 32, out.meshing.levels); });
    app.add_flag_callback(
        "--no-original", [&] { out.original = false; },
        "leave the image out of .html, of which it is the larger part: nothing to compare with");
}

void add_target_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("How many vertices, one of");
    CLI::Option* vertices = add(app, "--vertices", "N", "the mesh has N vertices", [&](const std::string& text) {
        std::int64_t count = 0;
        std::string why = parse_integer(text, count);
        out.meshing.target = hmesh::Target::vertices(count);
        out.target = "--vertices " + text;
        return why.empty() ? find_too_few(count) : why;
    });
    CLI::Option* rate =
        add(app, "--rate", "PERCENT", "PERCENT vertices for 100 pixels (default: 1)", [&](const std::string& text) {
            double percent = 0;
            std::string why = parse_positive(text, 100, percent);
            out.meshing.target = hmesh::Target::percent(percent);
            out.target = "--rate " + text;
            return why;
        });
    CLI::Option* psnr = add(app, "--psnr", "DB",
                            "as few vertices as reach this PSNR, as every file holds it that is written, and the .png\n"
                            "of --render; with --with that of the mesh, over all images",
                            [&](const std::string& text) {
                                double decibel = 0;
                                std::string why = parse_positive(text, 1000, decibel);
                                out.meshing.target = hmesh::Target::psnr(decibel);
                                out.target = "--psnr " + text;
                                return why;
                            });
    CLI::Option* bytes = add(app, "--bytes", "N",
                             "a .hmc file of at most N bytes: vertices, their places and colours as coarse as that takes;\n"
                             "other files hold the same mesh",
                             [&](const std::string& text) {
                                 std::int64_t count = 0;
                                 std::string why = parse_integer(text, count);
                                 if (why.empty() && (count < 1 || count > 1000000000)) why = "must be 1 to 1000000000";
                                 out.meshing.bytes = static_cast<std::size_t>(std::max<std::int64_t>(0, count));
                                 out.target = "--bytes " + text;
                                 return why;
                             });
    // Called after those above, whatever their order is on the command line: options are, as they were added.
    add(app, "--max-vertices", "N",
        "at most N vertices, and fewer where these are good enough; with --psnr, where N do not reach\n"
        "it, the best mesh of so many is written, and the exit status is 1",
        [&](const std::string& text) {
            std::int64_t count = 0;
            if (std::string why = parse_integer(text, count); !why.empty()) return why;
            const bool is_search = out.meshing.target.kind == hmesh::Target::Kind::psnr;
            if (is_search) out.meshing.target.max_vertices = count;
            else out.meshing.target = hmesh::Target::at_most(count);
            out.outline_options.max_vertices = static_cast<int>(std::min<std::int64_t>(count, 1 << 30));
            out.target = (is_search ? out.target + " " : "") + "--max-vertices " + text;
            return find_too_few(count);
        })
        ->excludes(vertices)
        ->excludes(rate);
    add(app, "--good-enough", "DB",
        "fewer vertices than --vertices, --rate or --max-vertices say where these reach this PSNR\n"
        "(--max-vertices: 55, below half a step of 8 bits)",
        [&](const std::string& text) {
            double decibel = 0;
            std::string why = parse_positive(text, 1000, decibel);
            out.meshing.target.good_enough = decibel;
            out.target += " --good-enough " + text;
            return why;
        })
        ->excludes(psnr);
    rate->excludes(vertices);
    psnr->excludes(vertices)->excludes(rate);
    bytes->excludes(vertices)->excludes(rate)->excludes(psnr);
    app.add_flag_callback(
        "--no-table", [&] { out.meshing.start_table = false; },
        "with --bytes: a file for readers that lack the start table, such as the page; 11 % fewer\n"
        "vertices in 300 bytes");
}

void add_meshing_options(CLI::App& app, Arguments& out) {
    MeshingOptions& meshing = out.meshing;
    app.option_defaults()->group("How the mesh is made");
    add_name(app, "--effort", "draft, fast, normal, fine or best: how long to look for a better mesh (default: normal)", efforts,
             [&](hmesh::Effort effort) { meshing.effort = effort; });
    add_name(app, "--method",
             "annealed (default), or what it is compared with: hierarchical, xie, adams or\n"
             "adaptive_thinning, which know no effort, seed or tile",
             methods, [&](Method method) { meshing.method = method; });
    add_name(app, "--colors",
             "optimal, by least squares, or sampled from the image under the vertices (default:\n"
             "sampled for xie, adams and adaptive_thinning, else optimal)",
             colors, [&](hmesh::Colors chosen) { meshing.colors = chosen; });
    add_name(app, "--fit-space",
             "stored values (default), linear light or each: linear fits colours for programs that\n"
             "interpolate light, as glTF's do; each does so for .glb alone",
             fit_spaces, [&](FitSpace space) { meshing.fit_space = space; });
    app.add_flag_callback(
        "--premultiplied", [&] { meshing.premultiplied = true; },
        "fit colours times alpha: what transparent pixels hide leaves no fringes");
    add_name(app, "--periodic",
             "x, y or xy: the image repeats from left to right, from top to bottom or both, and so does\n"
             "the mesh: copies of it join without a gap or a jump of colour (default: none)",
             periodics, [&](hmesh::Periodic periodic) { meshing.periodic = periodic; });
    app.add_flag_callback(
        "--straight-border", [&] { meshing.straight_border = true; },
        "with --periodic, end the mesh at the sides of the image; else its border is jagged, as faces are");
    add_name(app, "--samples",
             "squares (default), as pictures have them, or points, as heightmaps do: the mesh of W x H\n"
             "points is W - 1 wide and H - 1 high, and tiles that share a row of them share a border",
             sample_kinds, [&](hmesh::Samples samples) { meshing.samples = samples; });
    add(app, "--border-tolerance", "X",
        "with --samples points, make each side of the mesh of its row of samples alone, which it\n"
        "passes within X, in stored values: tiles that share a row then share its vertices",
        [&](const std::string& text) {
            return parse_at_least_0(text, most_border_tolerance, meshing.border_tolerance.emplace());
        });
    add(app, "--weights", "FILE",
        "an image of the same size: how much each pixel counts, black nothing, white fully\n"
        "(of colours the mean, without alpha)",
        [&](const std::string& text) { return set_file(text, out.weights); });
    add_list(app, "--with", "FILE",
             "another image of the same size for the same mesh, such as a material's normals; may be\n"
             "given more than once, up to 16 channels in all. .glb and .ply hold it under a name: that\n"
             "of NAME=FILE, or what the file's adds to the image's; one that ends in normal as normals",
             [&](const std::string& text) {
                 const std::size_t equals = text.find('=');
                 const std::string name = equals == std::string::npos ? "" : text.substr(0, equals);
                 const bool has_name = hmesh::detail::is_name(name.c_str());
                 out.others.push_back({has_name ? text.substr(equals + 1) : text, has_name ? name : ""});
                 if (out.others.back().file.empty()) return std::string("names no file");
                 return std::string(has_name && hmesh::detail::is_reserved_name(name.c_str())
                                        ? "has a name that positions or colours have in files"
                                        : "");
             });
    add(app, "--channel-weights", "N",
        "numbers with commas between them: how much each image of the mesh counts, the first\n"
        "before those of --with, or each channel of all (default: all the same); with --with\n"
        "also balanced: such that a dB of each image counts the same, in some twice the time",
        [&](const std::string& text) {
            out.balances_maps = text == "balanced";
            return out.balances_maps ? std::string() : parse_weights(text, out.channel_weights);
        });
    add(app, "--grid", "N",
        "positions are multiples of 1/N px, N 4, 8, 16, 32, 64, 128 or 256 (default: 256, or as\n"
        "many as a packed .glb keeps): 16 makes smaller files",
        [&](const std::string& text) {
            if (std::string why = parse_in_range(text, 4, 256, out.grid); !why.empty()) return why;
            return std::string((out.grid & (out.grid - 1)) == 0 ? "" : "must be a power of two");
        });
    add(app, "--seed", "N", "of the random numbers, of which draft has none; the same seed gives the same mesh (default: 1)",
        [&](const std::string& text) { return parse_seed(text, meshing.seed); });
    add(app, "--tile", "N", "mesh in tiles of about N px, 64 to 65536 (default: 128 to 256, by the number of vertices)",
        [&](const std::string& text) { return parse_in_range(text, 64, hmesh::kit::max_side, meshing.tile); });
    app.add_flag_callback(
        "--out-of-core", [&] { out.out_of_core = true; },
        "read the image by rectangles where they are needed, rather than into memory: PGM, PPM, PFM\n"
        "and TIFF files up to 65536 x 65536, and what GDAL reads; the mesh is the same. For .ply,\n"
        ".obj and .glb");
    add(app, "--threads", "N", "work on N threads, 1 to 1024; the mesh is the same for all N (default: 0, all cores)",
        [&](const std::string& text) { return parse_in_range(text, 0, 1024, out.threads); });
}

void add_sprite_options(CLI::App& app, Arguments& out) {
    app.option_defaults()->group("Sprites");
    app.add_flag_callback(
        "--sprite", [&] { out.sprite = true; },
        "fit colours times alpha, drop the faces that show nothing, and put opaque ones first; a picture\n"
        "of nothing becomes an empty mesh");
    CLI::Option* outline = app.add_flag_callback(
        "--outline", [&] { out.outline = true; },
        "few vertices around the pixels that show something, in place of a mesh, to draw the image on:\n"
        ".ply, .obj (with .mtl) and .glb hold texture coordinates and the texture's name");
    add(app, "--alpha", "N", "alpha, 0 to 254, above which pixels show something (default: 2 with --sprite, 0 with --outline)",
        [&](const std::string& text) { return parse_in_range(text, 0, 254, out.alpha); });
    add(app, "--margin", "PX", "around these pixels (default: 0.5, what bilinear filters show of them; 0 at their own size)",
        [&](const std::string& text) { return parse_at_least_0(text, 64, out.outline_options.margin); })
        ->needs(outline);
    add(app, "--tolerance", "PX", "how far an outline may stand out on average, for fewer vertices (default: 1)",
        [&](const std::string& text) { return parse_at_least_0(text, 1000, out.outline_options.tolerance); })
        ->needs(outline);
    // A flag's needs() would be seen in the help.
    app.add_flag_callback(
        "--no-holes", [&] { out.outline_options.holes = false; }, "fill the holes of an outline");
    add(app, "--texture", "NAME", "the texture's name in the files of an outline (default: the image, as seen from each)",
        [&](const std::string& text) { return set_file(text, out.texture); })
        ->needs(outline);
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
    app.add_flag_callback(
        "--json", [&] { out.json = true; },
        "print the report, one line of JSON for each image, in place of the summary; what failed\n"
        "has its sentence as status, and no figures");
    add_help(app, "print the version, and which image files are read by what");
    add_words(app);
}

constexpr Note notes[] = {
    {"PSNR",
     "10 log10(peak^2 / MSE), MSE the mean over pixels and channels of the image's stored values; with weights\n"
     "over weighted pixels, with --premultiplied of colours times alpha, with --fit-space linear of the mesh drawn so.\n"
     "The values drawn are not rounded for it. A .png is rounded to 8 bits, and so are the colours of some formats where the\n"
     "image has more: --psnr is kept by what the files hold, with --fit-space each by .glb as its viewers show it."},
    {"Several images",
     "each needs files of its own, whose names hold {name}. A line is printed for each; of one that fails\n"
     "a sentence on stderr, the others are meshed all the same, and the exit status is 1."},
    {"Interrupts", "Ctrl-C stops early and leaves files as they are; with --keep-partial the mesh reached so far is written."},
    {"Several maps",
     "images of --with become one mesh with the channels of all, each drawn by --render in a file of its own,\n"
     "whose name ends in the map's. Samples of 8 bits become 16, and floats where one of the images has floats.\n"
     "--psnr is then that of the mesh over the channels of all, by --channel-weights, whatever files round of it."},
    {"Jobs", "images that are more than one machine's work: hmesh job --help."},
    {"Examples",
     "  hmesh rock.png --with rock_normal.png --with rough=rock_r.png -o rock.glb --glb packed\n"
     "  hmesh photo.png -o mesh.glb -o mesh.html --rate 2\n"
     "  hmesh photo.png -o mesh.glb -o levels/{lod}.ply --lods 5\n"
     "  hmesh *.png -o out/{name}.glb --psnr 32 --max-vertices 20000 --json > reports.jsonl\n"
     "  hmesh icon.png -o icon.glb --sprite --max-vertices 500\n"
     "  hmesh icon.png -o icon.obj --outline --max-vertices 24\n"
     "  hmesh photo.jpg -o photo.hmc && hmesh photo.hmc --render photo.png --render-scale 2\n"
     "  hmesh photo.jpg -o photo.hmc --bytes 300 --effort fine\n"
     "  convert photo.gif png:- | hmesh - -o - --format pdf > mesh.pdf"},
    {"Exit status", "0 done, 1 failed, 2 wrong usage."}};

CommandWords about() {
    return {"hmesh",
            HMESH_VERSION_STRING,
            "Turns images into triangle meshes with one colour per vertex",
            {std::begin(notes), std::end(notes)},
            {}};
}

std::string version() {
    return "hmesh " HMESH_VERSION_STRING "\nreads\n" + decoders() +
           (gltf_compressor().empty() ? "" : "writes\n  --glb meshopt: " + gltf_compressor() + "\n");
}

// The names of the files that are written; of arguments that are const or not.
template <class AnyArguments, class Take>
void for_each_output(AnyArguments& arguments, Take&& take) {
    for (auto& mesh : arguments.meshes) {
        take(mesh.name);
        for (auto& level : mesh.coarser) take(level);
    }
    for (auto& material : arguments.materials) take(material);
    for (auto* file :
         {&arguments.render, &arguments.wireframe, &arguments.residual, &arguments.strip, &arguments.report, &arguments.depfile})
        if (!file->empty()) take(*file);
}

// Gives the maps names. Returns "" or what is wrong with them, as a sentence.
std::string name_maps(Arguments& arguments) {
    if (arguments.others.empty()) return {};
    std::vector<std::string> files{arguments.input};
    for (const OtherMap& other : arguments.others) files.push_back(other.file);
    std::vector<std::string> names = map_names(files);
    for (std::size_t i = 0; i < arguments.others.size(); ++i) {
        OtherMap& other = arguments.others[i];
        if (other.name.empty()) other.name = names[i + 1];
        names[i + 1] = other.name;
    }
    arguments.name = names[0];
    for (std::size_t i = 0; i < names.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (hmesh::detail::is_same_name(names[i].c_str(), names[k].c_str()))
                return "'" + files[k] + "' and '" + files[i] + "' are both called '" + names[i] + "': --with NAME=FILE names one";
    return {};
}

bool has_pattern(const Arguments& arguments) {
    const std::vector<std::string> files = output_files(arguments);
    const auto is_pattern_of = [](const OtherMap& other) { return is_pattern(other.file); };
    return is_pattern(arguments.weights) || std::any_of(files.begin(), files.end(), is_pattern) ||
           std::any_of(arguments.others.begin(), arguments.others.end(), is_pattern_of);
}

// Names the files of the levels of detail.
void name_levels(Arguments& arguments) {
    for (MeshFile& mesh : arguments.meshes) {
        const std::string all = mesh.name;
        const int levels = mesh.ending == ".glb" && !has_level_mark(all) ? 1 : arguments.meshing.levels;
        mesh.name = level_file(all, 0);
        for (int level = 1; level < levels; ++level) mesh.coarser.push_back(level_file(all, level));
        if (!has_level_mark(all)) continue;
        arguments.folders.push_back(std::filesystem::path(mesh.name).parent_path().string());
        for (const std::string& level : mesh.coarser)
            arguments.folders.push_back(std::filesystem::path(level).parent_path().string());
    }
}

Arguments for_image(Arguments all, const std::string& input) {
    all.input = input;
    name_levels(all);
    const std::string name = image_name(input);
    for (std::string& folder : all.folders) folder = expand(folder, name);
    all.weights = expand(all.weights, name);
    for (OtherMap& other : all.others) other.file = expand(other.file, name);
    for_each_output(all, [&](std::string& file) {
        if (!is_pattern(file)) return;
        file = expand(file, name);
        all.folders.push_back(std::filesystem::path(file).parent_path().string());
    });
    all.texture = expand(all.texture, name);
    for (const MeshFile& mesh : all.meshes)
        if (all.outline && mesh.ending == ".obj" && !is_standard(mesh.name))
            all.materials.push_back(std::filesystem::path(mesh.name).replace_extension(".mtl").string());
    return all;
}

// What is wrong with several maps for one mesh.
std::string find_map_conflict(const CLI::App& app, const std::vector<std::string>& inputs, const Arguments& arguments) {
    const std::vector<OtherMap>& others = arguments.others;
    if (arguments.balances_maps && others.empty()) return "--channel-weights balanced is given without --with";
    if (others.empty()) return {};
    if (arguments.balances_maps && arguments.meshing.target.kind == hmesh::Target::Kind::psnr)
        return "--channel-weights balanced goes by a number of vertices, and --psnr looks for one: leave one of them out";
    const auto is_shared = [](const OtherMap& other) { return !is_pattern(other.file); };
    if (inputs.size() > 1 && std::any_of(others.begin(), others.end(), is_shared))
        return "--with is given for " + std::to_string(inputs.size()) + " images: it needs {name} in it, which is that of each";
    for (const MeshFile& mesh : arguments.meshes)
        if (mesh.ending != ".glb" && mesh.ending != ".ply")
            return "--with makes a mesh that .glb and .ply hold, and " + mesh.ending + " does not";
    if (is_standard(arguments.render)) return "--with draws several pictures, and --render - names one";
    if (arguments.meshing.method != Method::annealed)
        return std::string("--with means nothing to --method ") + name_of(methods, arguments.meshing.method);
    for (const char* option : {"--premultiplied", "--fit-space", "--sprite"})
        if (app.count(option) != 0) return std::string(option) + " is given with --with, whose images are no colours alone";
    return {};
}

// What is wrong with levels of detail.
std::string find_level_conflict(const CLI::App& app, const Arguments& arguments) {
    const bool is_asked_for = app.count("--lods") != 0;
    for (const MeshFile& mesh : arguments.meshes) {
        if (has_level_mark(mesh.name) && !is_asked_for)
            return "--output '" + mesh.name + "' has {lod} in it, and there are no levels of detail without --lods";
        if (is_standard(mesh.name) && mesh.ending != ".glb" && arguments.meshing.levels > 1)
            return "--lods makes a file of each level, and --output - is one: of the formats .glb alone holds all";
    }
    if (!is_asked_for) return {};
    if (arguments.meshing.method != Method::annealed)
        return std::string("--lods means nothing to --method ") + name_of(methods, arguments.meshing.method);
    if (arguments.keep_partial) return "--keep-partial is given with --lods, of which all levels are written or none";
    return {};
}

// What is wrong with an outline in place of a mesh.
std::string find_outline_conflict(const CLI::App& app, const std::vector<std::string>& inputs, const Arguments& arguments) {
    for (const char* option :
         {"--sprite",    "--vertices",        "--rate",    "--psnr", "--good-enough", "--effort",  "--method",   "--colors",
          "--fit-space", "--premultiplied",   "--weights", "--seed", "--tile",        "--render",  "--residual", "--strip",
          "--with",      "--channel-weights", "--lods",    "--grid", "--glb",         "--samples", "--glb-bits"})
        if (app.count(option) != 0) return std::string(option) + " means nothing to --outline, which makes no mesh of colours";
    for (const MeshFile& mesh : arguments.meshes)
        if (mesh.ending != ".ply" && mesh.ending != ".obj" && mesh.ending != ".glb")
            return "--outline is written as .ply, .obj or .glb, which hold texture coordinates: '" + mesh.name + "' holds none";
    if (arguments.texture.empty() && std::find(inputs.begin(), inputs.end(), "-") != inputs.end())
        return "--outline of the standard input needs --texture, the name of the image in the files";
    return {};
}

// What is wrong with an image that is read by rectangles: much else wants all of it.
std::string find_rectangle_conflict(const CLI::App& app, const Arguments& arguments) {
    if (arguments.meshing.method != Method::annealed)
        return std::string("--out-of-core means nothing to --method ") + name_of(methods, arguments.meshing.method);
    for (const char* option : {"--psnr", "--fit-space", "--sprite", "--outline", "--with", "--lods", "--render", "--wireframe",
                               "--residual", "--strip", "--premultiplied", "--keep-partial", "--glb-bits"})
        if (app.count(option) != 0) return std::string(option) + " wants the whole image, which --out-of-core does not read";
    for (const MeshFile& mesh : arguments.meshes)
        if (mesh.ending != ".ply" && mesh.ending != ".obj" && mesh.ending != ".glb")
            return "--out-of-core makes large meshes, for .ply, .obj and .glb: '" + mesh.name + "' is none";
    return {};
}

// What is wrong with a number of bytes, for which the mesh is made otherwise.
std::string find_byte_conflict(const CLI::App& app, const Arguments& arguments) {
    for (const char* option : {"--max-vertices", "--good-enough", "--method", "--colors", "--fit-space", "--periodic",
                               "--samples", "--weights", "--with", "--channel-weights", "--lods", "--sprite", "--outline",
                               "--keep-partial", "--grid", "--out-of-core", "--border-tolerance", "--straight-border"})
        if (app.count(option) != 0) return std::string(option) + " means nothing to --bytes, which makes a small .hmc file";
    return has_output(arguments, ".hmc") ? "" : "--bytes is given without an output that ends in .hmc";
}

// An option that makes a mesh, or compares it with an image.
std::string find_option_of_images(const CLI::App& app) {
    for (const char* option :
         {"--vertices", "--rate",        "--psnr",      "--bytes",    "--max-vertices",    "--good-enough", "--effort",
          "--method",   "--colors",      "--fit-space", "--periodic", "--premultiplied",   "--samples",     "--border-tolerance",
          "--weights",  "--with",        "--grid",      "--seed",     "--channel-weights", "--tile",        "--lods",
          "--sprite",   "--outline",     "--residual",  "--strip",    "--straight-border", "--out-of-core", "--report",
          "--json",     "--keep-partial"})
        if (app.count(option) != 0) return option;
    return {};
}

// What is wrong with a command line of which each option is right by itself.
std::string find_conflict(const CLI::App& app, const std::vector<std::string>& inputs, const Arguments& arguments) {
    if (std::find(inputs.begin(), inputs.end(), "") != inputs.end()) return "no input image is given";
    for (const std::string& input : inputs)
        if (has_ending(input, ".hmc") && !arguments.of_images.empty()) return means_nothing_to_mesh(arguments, input);
    for (const MeshFile& mesh : arguments.meshes) {
        if (is_standard(mesh.name) && mesh.ending.empty())
            return "--output - needs --format, one of: " + joined(format_names(), ", ");
        if (mesh.ending.empty())
            return "--output '" + mesh.name + "' must end in one of: " + format_endings() + "; or --format names one";
    }
    if (app.count("--format") != 0 && std::all_of(arguments.meshes.begin(), arguments.meshes.end(),
                                                  [](const MeshFile& mesh) { return !format_ending(mesh.name).empty(); }))
        return "--format is given without an output that leaves its format open, as -o - does";
    if (arguments.json && writes_standard_output(arguments))
        return "--json is given with an output that is -, and both would be the standard output";
    const bool reads_standard_input =
        is_standard(arguments.weights) || std::find(inputs.begin(), inputs.end(), "-") != inputs.end() ||
        std::any_of(arguments.others.begin(), arguments.others.end(), [](const OtherMap& map) { return is_standard(map.file); });
    for (const std::string& input : inputs)
        if (image_name(input).empty() && has_pattern(arguments))
            return "'" + input + "' is no file: it has no name to stand for {name}";
    if (!arguments.depfile.empty() && (reads_standard_input || writes_standard_output(arguments)))
        return "--depfile is given with -, which is no file";
    if (app.count("--svg") != 0 && !has_output(arguments, ".svg")) return "--svg is given without an output that ends in .svg";
    for (const char* option : {"--glb", "--glb-bits"})
        if (app.count(option) != 0 && !has_output(arguments, ".glb"))
            return std::string(option) + " is given without an output that ends in .glb";
    if (arguments.glb == GlbForm::meshopt && gltf_compressor().empty())
        return "--glb meshopt needs meshoptimizer, and this hmesh was built without it";
    if (std::string why = find_map_conflict(app, inputs, arguments); !why.empty()) return why;
    if (std::string why = find_level_conflict(app, arguments); !why.empty()) return why;
    if (!arguments.original && !has_output(arguments, ".html"))
        return "--no-original is given without an output that ends in .html";
    if (!arguments.depfile.empty() && output_files(arguments).size() == 1) return "--depfile is given without another output";
    if (!arguments.depfile.empty()) {
        std::vector<std::string> names = inputs;
        for (const std::vector<std::string>& more : {output_files(arguments), input_files(arguments)})
            names.insert(names.end(), more.begin(), more.end());
        for (const std::string& name : names)
            if (!is_make_name(name))
                return "--depfile is given with '" + name +
                       "', and makefiles have no names with control characters, a parenthesis at the end or any of " +
                       foreign_to_make;
    }
    if (arguments.keep_partial && !arguments.depfile.empty())
        return "--keep-partial is given with --depfile, for which nothing but whole results is written";
    if (arguments.meshing.straight_border && arguments.meshing.periodic == hmesh::Periodic::none)
        return "--straight-border is given without --periodic";
    if (arguments.meshing.periodic != hmesh::Periodic::none && (arguments.sprite || arguments.outline))
        return "--periodic is given with a sprite, which does not repeat";
    if (arguments.meshing.samples == hmesh::Samples::points && arguments.meshing.periodic != hmesh::Periodic::none)
        return "--samples points is given with --periodic, whose samples are squares";
    if (arguments.meshing.border_tolerance && arguments.meshing.samples != hmesh::Samples::points)
        return "--border-tolerance is given without --samples points";
    if (arguments.meshing.border_tolerance && app.count("--channel-weights") != 0)
        return "--border-tolerance is given with --channel-weights, which sides of the mesh do not know";
    for (const char* option : {"--effort", "--seed", "--tile", "--periodic", "--border-tolerance"})
        if (arguments.meshing.method != Method::annealed && app.count(option) != 0)
            return std::string(option) + " means nothing to --method " + name_of(methods, arguments.meshing.method);
    if (app.count("--alpha") != 0 && !arguments.sprite && !arguments.outline)
        return "--alpha is given without --sprite or --outline";
    if (arguments.sprite && arguments.meshing.fit_space != FitSpace::stored)
        return "--fit-space linear fits straight colours, and --sprite those times alpha: leave one of them out";
    if (!arguments.outline && !arguments.outline_options.holes) return "--no-holes is given without --outline";
    if (arguments.out_of_core)
        if (std::string why = find_rectangle_conflict(app, arguments); !why.empty()) return why;
    if (!arguments.meshing.start_table && arguments.meshing.bytes == 0) return "--no-table is given without --bytes";
    if (arguments.meshing.bytes > 0)
        if (std::string why = find_byte_conflict(app, arguments); !why.empty()) return why;
    if (arguments.outline) return find_outline_conflict(app, inputs, arguments);
    if (std::string why = find_conflict(arguments.meshing); !why.empty()) return why;
    if (arguments.meshing.fit_space == FitSpace::each && !has_output(arguments, ".glb"))
        return "--fit-space each is given without an output that ends in .glb, for which alone it fits linear light";
    return {};
}

}  // namespace

std::string means_nothing_to_mesh(const Arguments& arguments, const std::string& input) {
    return arguments.of_images + " means nothing to '" + input + "', which is a mesh and no image";
}

std::vector<std::string> render_files(const Arguments& arguments) {
    const std::string& render = arguments.render;
    if (render.empty()) return {};
    if (arguments.others.empty() || is_standard(render)) return {render};
    const std::size_t dot = render.size() - 4;  // of .png
    std::vector<std::string> files{render.substr(0, dot) + "_" + arguments.name + render.substr(dot)};
    for (const OtherMap& other : arguments.others) files.push_back(render.substr(0, dot) + "_" + other.name + render.substr(dot));
    return files;
}

std::vector<std::string> output_files(const Arguments& arguments) {
    std::vector<std::string> files;
    for_each_output(arguments, [&](const std::string& file) {
        if (&file != &arguments.render) return files.push_back(file);
        const std::vector<std::string> pictures = render_files(arguments);
        files.insert(files.end(), pictures.begin(), pictures.end());
    });
    return files;
}

std::vector<std::string> input_files(const Arguments& arguments) {
    std::vector<std::string> files{arguments.input};
    for (const OtherMap& other : arguments.others) files.push_back(other.file);
    if (!arguments.weights.empty()) files.push_back(arguments.weights);
    return files;
}

bool writes_standard_output(const Arguments& arguments) {
    const std::vector<std::string> files = output_files(arguments);
    return std::any_of(files.begin(), files.end(), is_standard);
}

bool has_output(const Arguments& arguments, const std::string& ending) {
    return std::any_of(arguments.meshes.begin(), arguments.meshes.end(),
                       [&](const MeshFile& mesh) { return mesh.ending == ending; });
}

CommandLine parse(const std::vector<std::string>& words) {
    CommandLine line;
    Arguments arguments;
    std::vector<std::string> inputs;
    const CommandWords words_of_command = about();
    CLI::App app(words_of_command.summary + ".\n", words_of_command.name);
    app.footer(footer(words_of_command.notes));
    lay_out(app, "The images");
    const auto set_inputs = [&](const CLI::results_t& texts) {
        inputs = texts;
        return true;
    };
    app.add_option("IMAGE", set_inputs,
                   "image files: " + formats_read() +
                       ";\n8 or 16 bits or floats, 1 to 4 channels; --version says what reads them. - is the standard\n"
                       "input. A mesh of an .hmc file is drawn and written again")
        ->expected(1, CLI::detail::expected_max_vector_size)
        ->allow_extra_args()
        ->required();
    add_file_options(app, arguments);
    add_target_options(app, arguments);
    add_meshing_options(app, arguments);
    add_sprite_options(app, arguments);
    add_other_options(app, arguments);
    try {
        line.wrong = parse_words(app, words, "no input image is given");
        if (!line.wrong.empty()) return line;
        arguments.of_images = find_option_of_images(app);
        line.wrong = find_conflict(app, inputs, arguments);
        for (const std::string& input : inputs) {
            line.images.push_back(for_image(arguments, input));
            if (line.wrong.empty()) line.wrong = name_maps(line.images.back());
        }
    } catch (const Question& question) {
        line.answer = answer(app, question, version(), words_of_command, {"output", "with", "IMAGE"});
    }
    return line;
}

// ---- hmesh job ----

namespace {

constexpr char job_help[] =
    "Meshes an image as a job in files: a folder in which a plan says what is to be done, and any engine does it, task after\n"
    "task, on one machine or on many that share the folder. The files are byte for byte those of one process, whatever engine,\n"
    "order, machine or restart.\n"
    "\n"
    "  hmesh job plan IMAGE -o JOB     writes what is to be done, and build.ninja, slurm.sh and parallel.sh, by which ninja,\n"
    "                                  Slurm and GNU parallel do it\n"
    "  hmesh job run JOB TASK...       does tasks\n"
    "  hmesh job status JOB            says what is done, and what is missing or damaged\n"
    "  hmesh job join JOB -o FILE      one mesh file, or a folder of tiles with its index\n"
    "\n"
    "`hmesh job plan --help`, and so on, lists options. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

constexpr char plan_footer[] =
    "JOB is a new folder: nothing outside of it is written. The same plan may be made again. Samples are points, as with\n"
    "--samples points: the mesh of W x H of them is W - 1 wide and H - 1 high, and tiles share a row of samples.\n"
    "Examples:\n"
    "  hmesh job plan slide.tif -o job --rate 1 && ninja -C job && hmesh job join job -o slide.glb\n"
    "  hmesh job plan mosaic.ppm -o job --effort draft && job/slurm.sh --partition=short";

constexpr char version_words[] = "print the version, and which image files are read by what";

void add_tile_options(CLI::App& app, TileJob& out, std::vector<std::string>& inputs) {
    begin_job(app, "The image");
    app.footer(plan_footer);
    add_names(app, "IMAGE", "one file; PGM, PPM, PFM, TIFF and what GDAL reads by rectangles, others as a whole by each process",
              inputs);
    add_plan_options(app, out);
    add_quiet(app, out.quiet, version_words);
    app.option_defaults()->group("How the mesh is made");
    CLI::Option* vertices = add(app, "--vertices", "N", "the whole mesh has N vertices", [&](const std::string& text) {
        std::int64_t count = 0;
        std::string why = parse_in_range(text, 4, std::int64_t{1} << 32, count);
        out.target = hmesh::Target::vertices(count);
        return why;
    });
    add(app, "--rate", "PERCENT", "PERCENT vertices for 100 pixels (default: 1)", [&](const std::string& text) {
        double percent = 0;
        std::string why = parse_positive(text, 100, percent);
        out.target = hmesh::Target::percent(percent);
        return why;
    })->excludes(vertices);
    add_name(app, "--effort", "draft, fast, normal, fine or best: how long to look for a better mesh (default: normal)", efforts,
             [&](hmesh::Effort effort) { out.tiles.effort = effort; });
    add(app, "--tile", "N",
        "tiles of at most N samples from line to line, 64 to 65536 (default: 2047; up to there a tile is\n"
        "one table, which is faster)",
        [&](const std::string& text) { return parse_in_range(text, 64, 65536, out.tiles.tile); });
    add(app, "--levels", "N",
        "levels of detail, 1 to 10 (default: 1): each next one is of the image at half the size, with a quarter\n"
        "of the vertices and of the tiles",
        [&](const std::string& text) { return parse_in_range(text, 1, 10, out.tiles.levels); });
    add(app, "--border-tolerance", "X",
        "sides of tiles pass their samples within X, in stored values (default: by the mean error that\n"
        "the looks at the tiles foretell)",
        [&](const std::string& text) {
            return parse_at_least_0(text, most_border_tolerance, out.tiles.border_tolerance.emplace());
        });
    add(app, "--seed", "N", "of the random numbers (default: 1)",
        [&](const std::string& text) { return parse_seed(text, out.tiles.seed); });
}

constexpr Named<const char*> tile_formats[] = {{"glb", "glb"}, {"ply", "ply"}, {"obj", "obj"}, {"hmc", "hmc"}};

void add_join_options(CLI::App& app, TileJob& out) {
    begin_job(app, "What is done");
    add_folder(app, out);
    add_text(app, "-o,--output", "PATH", "a file with the ending of a mesh format, or a folder for tiles and their index",
             out.output);
    add_name(app, "--format", "of tiles in a folder: glb, ply, obj or hmc (default: glb)", tile_formats,
             [&](const char* format) { out.format = format; });
    add_quiet(app, out.quiet, version_words);
}

// What is wrong with the output of join, or "". Of a folder the format is given then.
std::string find_join_conflict(TileJob& job) {
    if (std::string why = find_output_conflict(job); !why.empty()) return why;
    for (const char* mark : {name_mark, level_mark})
        if (job.output.find(mark) != std::string::npos)
            return "--output '" + job.output + "' has " + mark +
                   " in it, which stands for nothing in a job: name the file itself";
    const std::string ending = format_ending(job.output);
    if (!ending.empty() && !job.format.empty())
        return "--format is given, of tiles in a folder, and '" + job.output + "' is one file of the format " + ending;
    if (ending.empty() && job.format.empty() && !may_be_folder(job.output))
        return "'" + job.output + "' must end in one of: " + format_endings() +
               "; or --format names that of tiles in a folder, whose name may end in a slash";
    if (ending.empty() && job.format.empty()) job.format = tile_formats[0].value;
    return {};
}

}  // namespace

TileJobLine parse_tile_job(const std::vector<std::string>& words) {
    TileJobLine line;
    TileJob& job = line.arguments;
    if (!find_job_command(words, job_help, job, line.wrong, line.answer)) return line;
    CLI::App app("", "hmesh job " + words.front());
    std::vector<std::string> inputs;
    switch (job.command) {
        case JobCommand::plan: add_tile_options(app, job, inputs); break;
        case JobCommand::run: add_run_options(app, job, version_words); break;
        case JobCommand::status: add_status_options(app, job, version_words); break;
        case JobCommand::join: add_join_options(app, job); break;
    }
    try {
        line.wrong = parse_words(app, {words.begin() + 1, words.end()}, missing_words(job.command));
    } catch (const Question& question) {
        line.answer = answer(app, question, version(), {}, {});
        return line;
    }
    if (!line.wrong.empty()) return line;
    if (job.command == JobCommand::join) line.wrong = find_join_conflict(job);
    if (job.command != JobCommand::plan) return line;
    if (inputs.size() > 1) line.wrong = "'" + inputs[0] + "' and '" + inputs[1] + "' are two images: each is a job of its own";
    else if (is_standard(inputs.front())) line.wrong = "the standard input is no file, of which parts can be read";
    else if (job.folder.empty()) line.wrong = "no folder is given: -o names it";
    job.input = inputs.front();
    return line;
}

}  // namespace tool
