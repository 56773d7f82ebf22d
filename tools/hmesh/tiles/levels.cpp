#include "tiles/levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tool {
namespace {

// The samples of level k on the lines across a side of the image, which has `size` px. Those of the first level at which that is
// one tile, or of the last, are as far apart as one another; each finer level has these, and one in the middle of any two.
std::vector<int> lines(int size, int tile, int k, int levels) {
    const std::int64_t cells = size - 1, last = cells >> k;
    int coarsest = 0;
    const auto cells_there = [&] { return (cells + (std::int64_t{1} << coarsest) - 1) >> coarsest; };
    while (coarsest + 1 < levels && cells_there() > tile) ++coarsest;
    if (k > coarsest) return {0, static_cast<int>(last)};
    const std::int64_t count = (cells_there() + tile - 1) / tile, parts = std::int64_t{1} << (coarsest - k);
    const auto line = [&](std::int64_t j) { return (2 * j * cells_there() + count) / (2 * count); };
    std::vector<int> at;
    for (std::int64_t j = 0; at.empty() || at.back() < last; ++j) {
        const std::int64_t before = line(j / parts), after = line(j / parts + 1);
        at.push_back(static_cast<int>(std::min(last, parts * before + (after - before) * (j % parts))));
    }
    return at;
}

}  // namespace

std::vector<TileLevel> find_levels(int width, int height, std::size_t vertices, int tile, int most) {
    int count = 1;
    while (count < most && (std::min(width, height) - 1) >> count > 0) ++count;
    std::vector<TileLevel> levels;
    for (int k = 0; k < count; ++k) {
        TileLevel& level = levels.emplace_back();
        level.step = 1 << k;
        level.width = ((width - 1) >> k) + 1;
        level.height = ((height - 1) >> k) + 1;
        const double samples = static_cast<double>(level.width) * level.height;
        const double wanted = std::round(static_cast<double>(vertices) / level.step / level.step);
        level.vertices = static_cast<std::size_t>(std::max(4.0, std::min(samples, wanted)));
        level.columns = lines(width, tile, k, count);
        level.rows = lines(height, tile, k, count);
    }
    return levels;
}

}  // namespace tool
