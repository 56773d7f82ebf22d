// tools - pictures that show what a mesh does: colours for people, its error, several pictures side by side.
#ifndef HMESH_TOOLS_WRITERS_PICTURES_HPP
#define HMESH_TOOLS_WRITERS_PICTURES_HPP

#include <cstdint>
#include <vector>

#include "hmesh/image/image_view.hpp"
#include "readers/image_file.hpp"
#include "writers/picture_file.hpp"

namespace tool {

using Rgb = hmesh::Image<std::uint8_t, 3>;

// The samples of a file at 8 bits.
[[nodiscard]] Picture to_picture(const ImageFile& image);
[[nodiscard]] Picture to_picture(const Rgb& rgb);

// The picture as red, green and blue, whatever is transparent over white.
[[nodiscard]] Rgb to_rgb(const Picture& picture);

// The difference `drawn` - `original`, times `gain`, around middle grey: brighter where the mesh is. Both of one size.
[[nodiscard]] Rgb residual(const Rgb& original, const Rgb& drawn, double gain = 4);

// The pictures from left to right, `gap` white pixels between them, white below the lower ones.
[[nodiscard]] Rgb side_by_side(const std::vector<Rgb>& pictures, int gap = 4);

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_PICTURES_HPP
