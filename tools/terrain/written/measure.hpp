// hmesh-terrain - measure(): how far a surface is from the samples of a tile, by brute force over all of them.
#ifndef HMESH_TERRAIN_WRITTEN_MEASURE_HPP
#define HMESH_TERRAIN_WRITTEN_MEASURE_HPP

#include <cstddef>

#include "hmesh/image/image_view.hpp"
#include "terrain/written/surface.hpp"

namespace terrain {

struct Measured {
    double max_error = 0;       // |surface - sample|, in the heights of the samples
    double sum_of_squares = 0;  // of these
    std::size_t samples = 0;    // that are covered
    std::size_t left_out = 0;   // samples of a cell of which all four have data, and yet no face covers them
    std::size_t outside = 0;    // samples without data that a face covers
};

// A sample on an edge belongs to both faces. One that no face covers, though one does within `slack` samples of it, is held
// against the nearest point of that: rounding moves the border of a surface.
[[nodiscard]] Measured measure(const Surface& surface, const hmesh::ImageView<float, 1>& heights, double slack);

}  // namespace terrain

#endif  // HMESH_TERRAIN_WRITTEN_MEASURE_HPP
