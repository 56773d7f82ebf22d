// tools - the maps of a material, each as a part of the mesh that they became together.
#ifndef HMESH_TOOLS_RESULTS_MAPS_HPP
#define HMESH_TOOLS_RESULTS_MAPS_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/io/channel_groups.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "meshing.hpp"
#include "readers/image_file.hpp"

namespace tool {

// A map: some channels of the mesh.
struct Map {
    std::string file, name;
    hmesh::ChannelGroup::Meaning meaning = hmesh::ChannelGroup::Meaning::color;
    int first = 0, channels = 0;
    double psnr = 0;    // dB, once it is measured
    double weight = 1;  // of each of its channels, where they are balanced
};

// The maps of images that were joined; the first is a colour, a name that ends in normal a normal, all else data. Returns "" or
// what is wrong, a sentence.
[[nodiscard]] std::string find_maps(const Arguments& arguments, const std::vector<ImageFile>& images, std::vector<Map>& maps);

// How much each channel of the joined image counts; empty: all alike. `weights` are those of maps or channels. Returns "" or what
// is wrong, a sentence.
[[nodiscard]] std::string spread_weights(const std::vector<double>& weights, const std::vector<Map>& maps,
                                         const ImageFile& joined, std::vector<double>& spread);

// Gives maps the weights with which a dB of each counts the same, the largest 1, which makes the sum of their PSNRs largest. Each
// is 1 over the squared error of its map, and found by three meshes of effort draft, each with the weights found before: a sum of
// logarithms falls where its tangent does (majorize, minimize). Ends early where a mesh cannot be made.
void balance_maps(const ImageFile& joined, MeshingOptions options, const hmesh::ParallelFor& parallel_for,
                  std::vector<Map>& maps);

// As exporters take them. Refers to the maps.
[[nodiscard]] std::vector<hmesh::ChannelGroup> groups_of(const std::vector<Map>& maps);

// The mesh with the channels of one map.
[[nodiscard]] hmesh::Mesh mesh_of(const Map& map, const hmesh::Mesh& mesh);

// Measures the PSNR of each map, of values that are not rounded. `weights`: of the pixels.
void measure_maps(const hmesh::Mesh& mesh, const ImageFile& joined, const hmesh::ImageView<float, 1>& weights,
                  std::vector<Map>& maps);

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_MAPS_HPP
