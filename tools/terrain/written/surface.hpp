// hmesh-terrain - Surface: a written file read back, so that a bound is proved on the very numbers that a program will read from
// it.
//
// The readers here know no more of the files than their specifications, and share nothing with what writes them.
#ifndef HMESH_TERRAIN_WRITTEN_SURFACE_HPP
#define HMESH_TERRAIN_WRITTEN_SURFACE_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "readers/bytes.hpp"
#include "terrain/arguments.hpp"
#include "terrain/frame.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// In samples of the tile, x to the east and y to the south, and heights as the model's file has them.
struct Surface {
    std::vector<double> x, y, height;                 // of each vertex
    std::vector<std::array<std::uint32_t, 3>> faces;  // clockwise as seen on a map, of positive area; others are walls and floors
};

// From the bytes of a file of this format. Returns "" or what is wrong with them, which is a fault of ours.
[[nodiscard]] std::string read_back(Format format, tool::Bytes file, const Frame& frame, const Tile& tile, Surface& surface);

// In the coordinates of the file, +y to the north and +z up; corners in any order.
struct Model {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> faces;
    std::vector<std::array<double, 3>>
        normals;                               // of the vertices, by read_glb(), and by read_quantized_mesh() as two bytes and 0
    std::vector<std::array<double, 3>> skirt;  // vertices of what hangs from the sides, by read_glb()
};

[[nodiscard]] std::string read_ply(tool::Bytes file, Model& model);
[[nodiscard]] std::string read_obj(tool::Bytes file, Model& model);
[[nodiscard]] std::string read_stl(tool::Bytes file, Model& model);
[[nodiscard]] std::string read_glb(tool::Bytes file, Model& model);
// x and y are shares of the tile's sides, from 0 in the south-west to 1; z is in metres.
[[nodiscard]] std::string read_quantized_mesh(tool::Bytes file, Model& model);

}  // namespace terrain

#endif  // HMESH_TERRAIN_WRITTEN_SURFACE_HPP
