#include "arguments/conflicts.hpp"

#include <algorithm>
#include <initializer_list>

#include "arguments/files.hpp"
#include "arguments/named.hpp"
#include "arguments/patterns.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/depfile.hpp"
#include "writers/ending.hpp"
#include "writers/formats.hpp"
#include "writers/meshopt.hpp"

namespace tool {
namespace {

// The first of these options that is given; empty: none is.
std::string first_given(const Said& said, std::initializer_list<const char*> options) {
    const auto* const found = std::find_if(options.begin(), options.end(), said.has);
    return found == options.end() ? "" : *found;
}

// The first mesh whose ending is none of these; null: there is none.
const MeshFile* first_other_than(const Arguments& arguments, std::initializer_list<const char*> endings) {
    for (const MeshFile& mesh : arguments.meshes)
        if (std::find(endings.begin(), endings.end(), mesh.ending) == endings.end()) return &mesh;
    return nullptr;
}

std::string find_input_conflict(const Said& said) {
    for (const std::string& input : said.inputs) {
        if (input.empty()) return "no input image is given";
        if (has_ending(input, ".hmc") && !said.arguments.of_images.empty()) return means_nothing_to_mesh(said.arguments, input);
        if (image_name(input).empty() && has_pattern(said.arguments))
            return "'" + input + "' is no file: it has no name to stand for {name}";
    }
    return {};
}

// Formats, and what is said of one that none of the files has.
std::string find_format_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    for (const MeshFile& mesh : arguments.meshes) {
        if (is_standard(mesh.name) && mesh.ending.empty())
            return "--output - needs --format, one of: " + joined(format_names(), ", ");
        if (mesh.ending.empty())
            return "--output '" + mesh.name + "' must end in one of: " + format_endings() + "; or --format names one";
    }
    const auto has_format = [](const MeshFile& mesh) { return !format_ending(mesh.name).empty(); };
    if (said.has("--format") && std::all_of(arguments.meshes.begin(), arguments.meshes.end(), has_format))
        return "--format is given without an output that leaves its format open, as -o - does";
    if (said.has("--svg") && !has_output(arguments, ".svg")) return "--svg is given without an output that ends in .svg";
    if (const std::string option = first_given(said, {"--glb", "--glb-bits"}); !option.empty() && !has_output(arguments, ".glb"))
        return option + " is given without an output that ends in .glb";
    if (arguments.glb == GlbForm::meshopt && gltf_compressor().empty())
        return "--glb meshopt needs meshoptimizer, and this hmesh was built without it";
    if (!arguments.original && !has_output(arguments, ".html"))
        return "--no-original is given without an output that ends in .html";
    if (arguments.json && writes_standard_output(arguments))
        return "--json is given with an output that is -, and both would be the standard output";
    return {};
}

std::string find_depfile_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    if (arguments.depfile.empty()) return {};
    const std::vector<std::string> outputs = output_files(arguments);
    std::vector<std::string> names = said.inputs;
    for (const std::vector<std::string>& more : {outputs, input_files(arguments)})
        names.insert(names.end(), more.begin(), more.end());
    if (std::any_of(names.begin(), names.end(), is_standard)) return "--depfile is given with -, which is no file";
    if (outputs.size() == 1) return "--depfile is given without another output";
    for (const std::string& name : names)
        if (!is_make_name(name))
            return "--depfile is given with '" + name +
                   "', and makefiles have no names with control characters, a parenthesis at the end or any of " +
                   foreign_to_make;
    if (arguments.keep_partial) return "--keep-partial is given with --depfile, for which nothing but whole results is written";
    return {};
}

// Several maps for one mesh.
std::string find_map_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    const std::vector<OtherMap>& others = arguments.others;
    if (arguments.balances_maps && others.empty()) return "--channel-weights balanced is given without --with";
    if (others.empty()) return {};
    if (arguments.balances_maps && arguments.meshing.target.kind == hmesh::Target::Kind::psnr)
        return "--channel-weights balanced goes by a number of vertices, and --psnr looks for one: leave one of them out";
    const auto is_shared = [](const OtherMap& other) { return !is_pattern(other.file); };
    if (said.inputs.size() > 1 && std::any_of(others.begin(), others.end(), is_shared))
        return "--with is given for " + std::to_string(said.inputs.size()) +
               " images: it needs {name} in it, which is that of each";
    if (const MeshFile* const mesh = first_other_than(arguments, {".glb", ".ply"}))
        return "--with makes a mesh that .glb and .ply hold, and " + mesh->ending + " does not";
    if (is_standard(arguments.render)) return "--with draws several pictures, and --render - names one";
    if (arguments.meshing.method != Method::annealed)
        return std::string("--with means nothing to --method ") + name_of(methods, arguments.meshing.method);
    if (const std::string option = first_given(said, {"--premultiplied", "--fit-space", "--sprite"}); !option.empty())
        return option + " is given with --with, whose images are no colours alone";
    return {};
}

// Levels of detail.
std::string find_level_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    const bool is_asked_for = said.has("--lods");
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

// What samples are, how they go on beyond the image, and sides that pass them.
std::string find_border_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    const MeshingOptions& options = arguments.meshing;
    const bool is_periodic = options.periodic != hmesh::Periodic::none, has_points = options.samples == hmesh::Samples::points;
    if (options.straight_border && !is_periodic) return "--straight-border is given without --periodic";
    if (is_periodic && (arguments.sprite || arguments.outline)) return "--periodic is given with a sprite, which does not repeat";
    if (is_periodic && has_points) return "--samples points is given with --periodic, whose samples are squares";
    if (options.border_tolerance && !has_points) return "--border-tolerance is given without --samples points";
    if (options.border_tolerance && said.has("--channel-weights"))
        return "--border-tolerance is given with --channel-weights, which sides of the mesh do not know";
    return {};
}

std::string find_method_conflict(const Said& said) {
    const Method method = said.arguments.meshing.method;
    if (method == Method::annealed) return {};
    const std::string option = first_given(said, {"--effort", "--seed", "--tile", "--periodic", "--border-tolerance"});
    return option.empty() ? "" : option + " means nothing to --method " + name_of(methods, method);
}

std::string find_sprite_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    if (said.has("--alpha") && !arguments.sprite && !arguments.outline) return "--alpha is given without --sprite or --outline";
    if (arguments.sprite && arguments.meshing.fit_space != FitSpace::stored)
        return "--fit-space linear fits straight colours, and --sprite those times alpha: leave one of them out";
    if (!arguments.outline && !arguments.outline_options.holes) return "--no-holes is given without --outline";
    return {};
}

// An image that is read by rectangles: much else wants all of it.
std::string find_rectangle_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    if (!arguments.out_of_core) return {};
    if (arguments.meshing.method != Method::annealed)
        return std::string("--out-of-core means nothing to --method ") + name_of(methods, arguments.meshing.method);
    const std::string option =
        first_given(said, {"--psnr", "--fit-space", "--sprite", "--outline", "--with", "--lods", "--render", "--wireframe",
                           "--residual", "--strip", "--premultiplied", "--keep-partial", "--glb-bits"});
    if (!option.empty()) return option + " wants the whole image, which --out-of-core does not read";
    if (const MeshFile* const mesh = first_other_than(arguments, {".ply", ".obj", ".glb"}))
        return "--out-of-core makes large meshes, for .ply, .obj and .glb: '" + mesh->name + "' is none";
    return {};
}

// A number of bytes, for which the mesh is made otherwise.
std::string find_byte_conflict(const Said& said) {
    const MeshingOptions& options = said.arguments.meshing;
    if (!options.start_table && options.bytes == 0) return "--no-table is given without --bytes";
    if (options.bytes == 0) return {};
    const std::string option =
        first_given(said, {"--max-vertices", "--good-enough", "--method", "--colors", "--fit-space", "--periodic", "--samples",
                           "--weights", "--with", "--channel-weights", "--lods", "--sprite", "--outline", "--keep-partial",
                           "--grid", "--out-of-core", "--border-tolerance", "--straight-border"});
    if (!option.empty()) return option + " means nothing to --bytes, which makes a small .hmc file";
    return has_output(said.arguments, ".hmc") ? "" : "--bytes is given without an output that ends in .hmc";
}

// An outline in place of a mesh.
std::string find_outline_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    if (!arguments.outline) return {};
    const std::string option = first_given(
        said, {"--sprite",    "--vertices",        "--rate",    "--psnr", "--good-enough", "--effort",  "--method",   "--colors",
               "--fit-space", "--premultiplied",   "--weights", "--seed", "--tile",        "--render",  "--residual", "--strip",
               "--with",      "--channel-weights", "--lods",    "--grid", "--glb",         "--samples", "--glb-bits"});
    if (!option.empty()) return option + " means nothing to --outline, which makes no mesh of colours";
    if (const MeshFile* const mesh = first_other_than(arguments, {".ply", ".obj", ".glb"}))
        return "--outline is written as .ply, .obj or .glb, which hold texture coordinates: '" + mesh->name + "' holds none";
    if (arguments.texture.empty() && std::any_of(said.inputs.begin(), said.inputs.end(), is_standard))
        return "--outline of the standard input needs --texture, the name of the image in the files";
    return {};
}

// What makes a mesh of colours; of an outline nothing of this is asked.
std::string find_meshing_conflict(const Said& said) {
    const Arguments& arguments = said.arguments;
    if (arguments.outline) return {};
    if (std::string why = find_conflict(arguments.meshing); !why.empty()) return why;
    if (arguments.meshing.fit_space == FitSpace::each && !has_output(arguments, ".glb"))
        return "--fit-space each is given without an output that ends in .glb, for which alone it fits linear light";
    return {};
}

}  // namespace

std::string find_option_of_images(const Said& said) {
    return first_given(
        said,
        {"--vertices", "--rate",        "--psnr",      "--bytes",    "--max-vertices",    "--good-enough", "--effort",
         "--method",   "--colors",      "--fit-space", "--periodic", "--premultiplied",   "--samples",     "--border-tolerance",
         "--weights",  "--with",        "--grid",      "--seed",     "--channel-weights", "--tile",        "--lods",
         "--sprite",   "--outline",     "--residual",  "--strip",    "--straight-border", "--out-of-core", "--report",
         "--json",     "--keep-partial"});
}

std::string means_nothing_to_mesh(const Arguments& arguments, const std::string& input) {
    return arguments.of_images + " means nothing to '" + input + "', which is a mesh and no image";
}

std::string find_conflict(const Said& said) {
    for (const auto find : {find_input_conflict, find_format_conflict, find_depfile_conflict, find_map_conflict,
                            find_level_conflict, find_border_conflict, find_method_conflict, find_sprite_conflict,
                            find_rectangle_conflict, find_byte_conflict, find_outline_conflict, find_meshing_conflict})
        if (std::string why = find(said); !why.empty()) return why;
    return {};
}

}  // namespace tool
