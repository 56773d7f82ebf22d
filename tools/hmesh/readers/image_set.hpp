// tools - several images of one size as one: the maps of a material, which are to become one mesh.
#ifndef HMESH_TOOLS_READERS_IMAGE_SET_HPP
#define HMESH_TOOLS_READERS_IMAGE_SET_HPP

#include <string>
#include <vector>

#include "readers/image_file.hpp"

namespace tool {

inline constexpr int most_channels = 16;

// The channels of all images, one image after the other. Up to 4 channels are as they are in the files, samples of the widest
// kind among them; more are samples of 16 bits, and zeros fill them up to 8 or 16 channels, or floats, up to 16: for these
// mesh_image() is compiled. Samples of 8 bits become 16 by a factor of 257, and floats as shares of the largest. Returns "" or
// what is wrong, a sentence; `names` are the files' own.
[[nodiscard]] std::string join_images(const std::vector<ImageFile>& images, const std::vector<std::string>& names,
                                      ImageFile& joined);

// What of a channel is stored, in the units of the joined image's samples.
[[nodiscard]] double sample_of(const ImageFile& image, std::size_t index) noexcept;

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_IMAGE_SET_HPP
