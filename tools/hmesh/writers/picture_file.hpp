// tools - pictures of 8 bits as PNG and JPEG files, encoded with stb.
#ifndef HMESH_TOOLS_WRITERS_PICTURE_FILE_HPP
#define HMESH_TOOLS_WRITERS_PICTURE_FILE_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/sink.hpp"

namespace tool {

// Pixels of 8 bits, packed, 1 to 4 channels: what a PNG file is made of.
struct Picture {
    int width = 0, height = 0, channels = 0;
    std::vector<std::uint8_t> samples;
};

// Encodes a picture. False when there is no memory, the picture has more than 2^30 samples, or the sink refused.
[[nodiscard]] bool write_png(const Picture& picture, hmesh::Sink sink);
// The same of 1 or 3 channels, lossy: `quality` from 1 to 100.
[[nodiscard]] bool write_jpeg(const Picture& picture, int quality, hmesh::Sink sink);

// hmesh::PageOptions::Deflate by stb_image_write: no zlib is needed. About 10 MB/s.
[[nodiscard]] bool deflate(const unsigned char* bytes, std::size_t size, std::vector<unsigned char>& out);

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_PICTURE_FILE_HPP
