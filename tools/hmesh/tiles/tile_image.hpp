// tools - TileImage: an image of which tiles are read, by rectangles where its format allows that.
#ifndef HMESH_TOOLS_TILES_TILE_IMAGE_HPP
#define HMESH_TOOLS_TILES_TILE_IMAGE_HPP

#include <array>
#include <string>
#include <vector>

#include "hmesh/image/image_view.hpp"
#include "readers/image_file.hpp"

namespace tool {

class TileImage {
  public:
    // Returns "" or what is wrong, as the end of a sentence that begins with the file's name, and so does read().
    [[nodiscard]] std::string open(const std::string& path);

    // Its size, channels and bits; the samples too, where it cannot be read by rectangles.
    [[nodiscard]] const ImageFile& head() const noexcept { return file_; }

    // The samples of a rectangle of the image at 1 / step of its size. Each is the mean of the square of step x step px around
    // pixel (step * x, step * y), of as much of it as is in the image; colours count by their alpha. Rectangles have the same
    // samples where they overlap.
    [[nodiscard]] std::string read(const hmesh::kit::Rect& rect, int step, ImageFile& tile) const;

  private:
    // The pixels of a rectangle within the image.
    [[nodiscard]] std::string read(const hmesh::kit::Rect& rect, ImageFile& tile) const;
    // The samples of a part of the tile, which is that of `rect`.
    [[nodiscard]] std::string read_part(const hmesh::kit::Rect& rect, const hmesh::kit::Rect& part, int step,
                                        ImageFile& tile) const;

    ImageFile file_;
};

// For each tolerance, in stored values, the vertices of a tile's sides (hmesh/methods/annealed/border.hpp) in the order north,
// south, west, east, each with both its ends.
using SideCounts = std::array<std::size_t, 4>;
[[nodiscard]] std::vector<SideCounts> count_side_vertices(const ImageFile& tile, const std::vector<double>& tolerances);

// The tile at half its size, each pixel the mean of four, and what that leaves out, over all channels: their squared differences
// from it, or from its slopes, which a mesh shows, where those are less. A last column or row without a partner is left out.
[[nodiscard]] double halve(const ImageFile& tile, ImageFile& half);

// The stored value of full intensity.
[[nodiscard]] double peak_of(const ImageFile& image) noexcept;

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_TILE_IMAGE_HPP
