// tools - the command line of hmesh: parsed strictly, every refusal a sentence that names the value.
#ifndef HMESH_TOOLS_ARGUMENTS_ARGUMENTS_HPP
#define HMESH_TOOLS_ARGUMENTS_ARGUMENTS_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "arguments/named.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/outline.hpp"
#include "meshing.hpp"
#include "writers/formats.hpp"

namespace tool {

inline constexpr Named<Method> methods[] = {{"annealed", Method::annealed},
                                            {"hierarchical", Method::hierarchical},
                                            {"xie", Method::xie},
                                            {"adams", Method::adams},
                                            {"adaptive_thinning", Method::adaptive_thinning}};
inline constexpr Named<hmesh::Colors> colors[] = {{"optimal", hmesh::Colors::optimal}, {"sampled", hmesh::Colors::sampled}};
inline constexpr Named<FitSpace> fit_spaces[] = {
    {"stored", FitSpace::stored}, {"linear", FitSpace::linear}, {"each", FitSpace::each}};
inline constexpr Named<hmesh::Periodic> periodics[] = {
    {"none", hmesh::Periodic::none}, {"x", hmesh::Periodic::x}, {"y", hmesh::Periodic::y}, {"xy", hmesh::Periodic::xy}};
inline constexpr Named<hmesh::Samples> sample_kinds[] = {{"squares", hmesh::Samples::squares},
                                                         {"points", hmesh::Samples::points}};
inline constexpr Named<hmesh::Effort> efforts[] = {{"draft", hmesh::Effort::draft},
                                                   {"fast", hmesh::Effort::fast},
                                                   {"normal", hmesh::Effort::normal},
                                                   {"fine", hmesh::Effort::fine},
                                                   {"best", hmesh::Effort::best}};
inline constexpr Named<hmesh::SvgOptions::Kind> svg_kinds[] = {{"gradient", hmesh::SvgOptions::Kind::gradient},
                                                               {"exact", hmesh::SvgOptions::Kind::exact},
                                                               {"flat", hmesh::SvgOptions::Kind::flat}};

inline constexpr Named<GlbForm> glb_forms[] = {
    {"exact", GlbForm::exact}, {"packed", GlbForm::packed}, {"meshopt", GlbForm::meshopt}};

struct MeshFile {
    std::string name;
    std::string ending;                  // that of the format, in lower case: ".ply"
    std::vector<std::string> coarser{};  // the files of further levels of detail; none: there are none, or the first holds all
};

// Another image of the same mesh.
struct OtherMap {
    std::string file;
    std::string name;  // as in files and reports; empty: not given
};

// What is to be done with one image. A name that is "-" is a standard stream.
struct Arguments {
    std::string input;
    std::vector<MeshFile> meshes;
    std::string weights;                  // a file; empty: none
    std::vector<OtherMap> others;         // more maps of one material
    std::string name = "color";           // of the first, where there are others
    std::vector<double> channel_weights;  // one for each map or channel; empty: all alike
    bool balances_maps = false;           // in their place such that a dB of each map counts the same
    std::string render, wireframe, residual, strip, report, depfile;
    int render_scale = 1;
    hmesh::SvgOptions::Kind svg = hmesh::SvgOptions::Kind::gradient;
    GlbForm glb = GlbForm::exact;
    int glb_color_bits = 16;
    int grid = 0;          // positions are multiples of 1 px over this; 0: as the outputs ask for
    bool original = true;  // is in .html files
    bool sprite = false;   // faces that show nothing are dropped
    double alpha = -1;     // 255ths of full alpha above which pixels count; below 0: as sprites and outlines have it
    bool outline = false;  // few vertices around the image's pixels, for the image as their texture, in place of a mesh
    hmesh::OutlineOptions outline_options;
    std::string texture;                 // its name in the files; empty: the image, as seen from them
    std::vector<std::string> materials;  // the files of materials that go with .obj
    MeshingOptions meshing;              // but for the weights and the progress
    std::string target = "--rate 1";     // as typed
    unsigned threads = 0;                // 0: all cores
    bool quiet = false;
    bool json = false;                 // the report on the standard output, for the summary
    bool keep_partial = false;         // after an interrupt
    bool out_of_core = false;          // the image is read by rectangles
    std::string of_images;             // an option that means nothing to a mesh that is read; empty: none is given
    std::vector<std::string> folders;  // to be made where they are not there: those of names that held {name} or {lod}
};

struct CommandLine {
    std::vector<Arguments> images;  // one for each, {name} in names of files replaced by its own
    std::string wrong;              // what is wrong with the command line, a sentence; empty: nothing
    std::string answer;             // what is to be printed instead of running, for --help and its like; empty: nothing
};

// The words after the program's name.
[[nodiscard]] CommandLine parse(const std::vector<std::string>& words);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_ARGUMENTS_HPP
