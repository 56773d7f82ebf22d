#include "image_file.hpp"

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "exif.hpp"
#include "hmesh/image/image_view.hpp"
#include "pnm.hpp"
#include "words.hpp"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_PNM  // pnm.hpp
#define STBI_NO_HDR  // would come tone-mapped to 8 bits
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
#include <stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace tool {
namespace {

// What stb may be given to deflate, in bytes: it counts in int, and doubles its buffer when what it made outgrows it.
constexpr std::size_t max_deflated = std::size_t{1} << 30U;

std::string read_bytes(const std::string& path, std::vector<unsigned char>& bytes) {
    errno = 0;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return std::strerror(errno);
    std::size_t size = 0, got = 0;
    do {
        bytes.resize(size + (std::size_t{1} << 20) + size / 2);
        got = std::fread(bytes.data() + size, 1, bytes.size() - size, file);
        size += got;
    } while (got != 0 && size <= INT_MAX);
    bytes.resize(size);
    const bool failed = std::ferror(file) != 0;
    const std::string why = failed ? std::strerror(errno) : "";
    std::fclose(file);
    if (!failed && size == 0) return "the file is empty";
    if (size > INT_MAX) return "the file is larger than 2 GiB";
    return why;
}

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

std::string stb_reason() {
    const char* reason = stbi_failure_reason();
    return "not an image file that stb_image reads (" + lower_case(reason != nullptr ? reason : "unknown reason") + ")";
}

// Whether hmesh takes an image of this size: asked before the pixels are decoded.
std::string check_size(int width, int height) {
    const std::uint8_t no_pixel = 0;
    const hmesh::Status status = hmesh::check(hmesh::ImageView<std::uint8_t, 1>{&no_pixel, width, height, 0});
    return status ? std::string() : in_words(status);
}

template <class T>
std::string take(T* pixels, ImageFile& image, std::vector<T>& samples) {
    const std::unique_ptr<T, void (*)(void*)> owner(pixels, stbi_image_free);
    if (pixels == nullptr) return stb_reason();
    if (image.channels < 1 || image.channels > 4) return "it has " + std::to_string(image.channels) + " channels, not 1 to 4";
    const auto count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * static_cast<std::size_t>(image.channels);
    samples.assign(pixels, pixels + count);
    return {};
}

std::string read_pnm(const std::vector<unsigned char>& bytes, ImageFile& image) {
    PnmHeader header;
    if (const std::string why = read_pnm_header(bytes, header); !why.empty()) return why;
    image.width = header.width;
    image.height = header.height;
    image.channels = header.channels;
    image.bits = header.maximum > 255 ? 16 : 8;
    if (const std::string why = check_size(image.width, image.height); !why.empty()) return why;
    return image.bits == 16 ? read_pnm_samples(bytes, header, image.samples16) : read_pnm_samples(bytes, header, image.samples8);
}

std::string read_stb(const std::vector<unsigned char>& bytes, ImageFile& image) {
    const auto size = static_cast<int>(bytes.size());
    if (stbi_info_from_memory(bytes.data(), size, &image.width, &image.height, &image.channels) == 0) return stb_reason();
    if (const std::string why = check_size(image.width, image.height); !why.empty()) return why;
    image.bits = stbi_is_16_bit_from_memory(bytes.data(), size) != 0 ? 16 : 8;
    int &w = image.width, &h = image.height, &c = image.channels;
    if (image.bits == 16) return take(stbi_load_16_from_memory(bytes.data(), size, &w, &h, &c, 0), image, image.samples16);
    const std::string why = take(stbi_load_from_memory(bytes.data(), size, &w, &h, &c, 0), image, image.samples8);
    if (why.empty() && is_jpeg(bytes)) turn_upright(orientation(bytes), c, w, h, image.samples8);
    return why;
}

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

std::string read_image(const std::string& path, ImageFile& image, std::vector<unsigned char>& bytes) {
    if (const std::string why = read_bytes(path, bytes); !why.empty()) return why;
    return is_pnm(bytes) ? read_pnm(bytes, image) : read_stb(bytes, image);
}

std::string read_image(const std::string& path, ImageFile& image) {
    std::vector<unsigned char> bytes;
    return read_image(path, image, bytes);
}

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

bool is_png(const std::vector<unsigned char>& bytes) noexcept {
    return bytes.size() > 8 && std::memcmp(bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0;
}

}  // namespace tool
