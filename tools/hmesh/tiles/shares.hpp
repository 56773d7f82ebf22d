// tools - how many vertices each tile of an image gets: as many as make one more of them worth the same everywhere.
//
// The error E of a tile with n vertices is taken for a power of n, E_1 (n_1 / n)^a, between meshes of effort draft that were
// tried. One vertex more then gains the price a E / n, and tiles have the numbers at which their prices are equal: what annealing
// does in one mesh, where vertices go where they are worth most. Draft meshes err more than others, everywhere about alike.
#ifndef HMESH_TOOLS_TILES_SHARES_HPP
#define HMESH_TOOLS_TILES_SHARES_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "tiles/tile_image.hpp"

namespace tool {

// A mesh of a tile: its vertices, and its squared error in stored values, over pixels and channels.
struct TrialMesh {
    std::size_t vertices = 0;
    double energy = 0;
};

// What a look at a tile found.
struct Look {
    std::vector<TrialMesh> trials;  // one or more, the finest first
    double lost = 0;                // error beside that of the trials, which no vertices make less
    std::size_t pixels = 0;
    std::vector<SideCounts> sides;  // for each tolerance
};

struct Shares {
    std::vector<std::size_t> vertices;  // of each tile
    double tolerance = 0;               // of sides, stored values
};

// The tolerances of sides among which find_shares() chooses, stored values, each 0.7 of the one before, roughly: from a quarter
// of the peak to a sixth of a step, or of samples that may all be far above the peak or far below from 2^64 to 2^-64 times that.
[[nodiscard]] std::vector<double> side_tolerances(double peak, bool is_open);

// Of the tiles of an image, row after row, `across` in each, whose mesh is to have `vertices`, those of seams counted once. Sides
// are taken within the mean error that such meshes are expected to have, so that what is on them and beside them errs less than
// the rest (docs/jobs.md has the figures), or less closely where they would need, with those between them, more than half of the
// vertices. Returns "" or what is wrong, a sentence without what to do about it.
[[nodiscard]] std::string find_shares(const std::vector<Look>& looks, int across, int channels, std::size_t vertices,
                                      const std::vector<double>& tolerances, Shares& shares);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_SHARES_HPP
