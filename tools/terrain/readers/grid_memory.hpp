// hmesh-terrain - GridMemory: heights that are in memory as a whole, for formats of which no part can be read by itself.
#ifndef HMESH_TERRAIN_READERS_GRID_MEMORY_HPP
#define HMESH_TERRAIN_READERS_GRID_MEMORY_HPP

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "terrain/dem.hpp"

namespace terrain {

class GridMemory : public Dem {
  public:
    std::vector<float> heights;  // NaN where there is no data
    double rounding = 0;         // the most by which one differs from the file

    [[nodiscard]] std::string read(int x, int y, int columns, int rows, float* out, double& most) override {
        for (int j = y; j < y + rows; ++j) {
            const float* const row = heights.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + x;
            out = std::copy_n(row, columns, out);
        }
        most = rounding;
        return {};
    }
};

}  // namespace terrain

#endif  // HMESH_TERRAIN_READERS_GRID_MEMORY_HPP
