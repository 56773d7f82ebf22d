// tools - image files of 8 and 16 bits or floats and 1 to 4 channels: from a name to the pixels, with the reader of its format.
//
// The bit depth and the number of channels are those of the file; a caller picks its ImageView<T, C> at run time. Photographs
// are turned as their tags say.
#ifndef HMESH_TOOLS_READERS_IMAGE_FILE_HPP
#define HMESH_TOOLS_READERS_IMAGE_FILE_HPP

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hmesh/core/array.hpp"

namespace tool {

class RectangleFile;  // rectangles.hpp

// The pixels of a file, packed: in `samples8` where bits is 8, in `samples16` where it is 16, in `samples32` where it is 32.
struct ImageFile {
    int width = 0, height = 0, channels = 0, bits = 0;
    int padding = 0;  // of the channels, those behind the others that are 0 everywhere: of several images, see image_set.hpp
    hmesh::kit::Array<std::uint8_t> samples8;
    hmesh::kit::Array<std::uint16_t> samples16;
    hmesh::kit::Array<float> samples32;
    std::shared_ptr<RectangleFile> rectangles;  // where the file is read by rectangles: then there are no samples
    std::string note;                           // what the file has beside this picture, a sentence; empty: nothing
    int orientation = 1;  // of the picture in a PNG or JPEG file as Exif numbers them, 1 to 8; here it is upright
};

// Whether there are any: not of a mesh that was read from a file.
[[nodiscard]] inline bool has_pixels(const ImageFile& image) noexcept {
    return !image.samples8.empty() || !image.samples16.empty() || !image.samples32.empty();
}

// Reads a file of images, or one of a mesh, "-" being the standard input. Returns "" or what is wrong, as below.
[[nodiscard]] std::string read_file(const std::string& path, std::vector<unsigned char>& bytes);

// Reads the file, "-" being the standard input, and leaves its bytes as they are in `bytes`. Returns "" or what is wrong, as the
// end of a sentence that begins with the file's name.
[[nodiscard]] std::string read_image(const std::string& path, ImageFile& image, std::vector<unsigned char>& bytes);
[[nodiscard]] std::string read_image(const std::string& path, ImageFile& image);

// What an image has that is no number: "a sample that is NaN or infinite, in row 3"; empty: nothing.
[[nodiscard]] std::string find_not_finite(const ImageFile& image);

// The formats that this build reads: "PNG, JPEG, ...".
[[nodiscard]] std::string formats_read();
// What it reads them with: lines of "  PNG: libpng 1.6.39".
[[nodiscard]] std::string decoders();

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_IMAGE_FILE_HPP
