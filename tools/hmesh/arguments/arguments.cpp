// The only file of this command that compiles CLI11. Numbers are parsed here, so that every sentence about them names the value
// and the bound.
#include "arguments/arguments.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "arguments/command_words.hpp"
#include "arguments/conflicts.hpp"
#include "arguments/files.hpp"
#include "arguments/job_options.hpp"
#include "arguments/parser.hpp"
#include "arguments/patterns.hpp"
#include "arguments/tile_job.hpp"
#include "arguments/values.hpp"
#include "hmesh/core/version.hpp"
#include "readers/image_file.hpp"
#include "terminal/standard_streams.hpp"
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
    add(app, "--seed", "N",
        "of the random numbers, of which draft has none but with --bytes; the same seed gives the same\n"
        "mesh (default: 1)",
        [&](const std::string& text) { return parse_seed(text, meshing.seed); });
    add(app, "--tile", "N", "mesh in tiles of about N px, 64 to 65536 (default: 128 to 256, by the number of vertices)",
        [&](const std::string& text) { return parse_in_range(text, 64, hmesh::kit::max_side, meshing.tile); });
    app.add_flag_callback(
        "--out-of-core", [&] { out.out_of_core = true; },
        "read the image by rectangles where they are needed, rather than into memory: PGM, PPM, PFM\n"
        "and TIFF files up to 65536 x 65536, and what GDAL reads and hmesh does not, as JPEG 2000; the\n"
        "mesh is the same. For .ply, .obj and .glb");
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
    add(app, "--wireframe", "FILE.png", "draw the mesh with its edges, at twice the size of images up to 2048 px",
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
        "has its sentence as status, and no figures unless the best mesh short of --psnr is written");
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
     "whose name ends in the map's. With more than 4 channels in all samples of 8 bits become 16, and\n"
     "floats where one of the images has floats; else they are of the widest kind among the images.\n"
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

}  // namespace

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
        const Said said{[&](const char* option) { return app.count(option) != 0; }, inputs, arguments};
        arguments.of_images = find_option_of_images(said);
        line.wrong = find_conflict(said);
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
    CLI::Option* vertices =
        add(app, "--vertices", "N", "the whole mesh has N vertices, at most one a sample", [&](const std::string& text) {
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
