#include "writers/picture_file.hpp"

#include <cstdlib>
#include <memory>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace tool {
namespace {

// What stb may be given to deflate, in bytes: it counts in int, and doubles its buffer when what it made outgrows it.
constexpr std::size_t max_deflated = std::size_t{1} << 30U;

// What stb's writers call, once for a PNG file and often for a JPEG file.
struct Taker {
    hmesh::Sink sink;
    bool called = false, refused = false;

    static void call(void* context, void* bytes, int size) {
        auto* taker = static_cast<Taker*>(context);
        taker->called = true;
        taker->refused = taker->refused || !taker->sink(bytes, static_cast<std::size_t>(size));
    }
};

}  // namespace

bool write_png(const Picture& picture, hmesh::Sink sink) {
    if (picture.samples.size() + static_cast<std::size_t>(picture.height) > max_deflated) return false;
    Taker taker{sink};
    return stbi_write_png_to_func(Taker::call, &taker, picture.width, picture.height, picture.channels, picture.samples.data(),
                                  0) != 0 &&
           taker.called && !taker.refused;
}

bool write_jpeg(const Picture& picture, int quality, hmesh::Sink sink) {
    Taker taker{sink};
    return stbi_write_jpg_to_func(Taker::call, &taker, picture.width, picture.height, picture.channels, picture.samples.data(),
                                  quality) != 0 &&
           taker.called && !taker.refused;
}

bool deflate(const unsigned char* bytes, std::size_t size, std::vector<unsigned char>& out) {
    if (size > max_deflated) return false;
    std::vector<unsigned char> copy(bytes, bytes + size);  // stb takes no const
    int length = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> made(
        stbi_zlib_compress(copy.data(), static_cast<int>(size), &length, stbi_write_png_compression_level), std::free);
    if (made) out.assign(made.get(), made.get() + length);
    return made != nullptr;
}

}  // namespace tool
