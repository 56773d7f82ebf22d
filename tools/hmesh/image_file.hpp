// tools - reads image files of 8 and 16 bits and 1 to 4 channels, and encodes PNG files of 8 bits, with stb.
//
// The bit depth and the number of channels are those of the file; a caller picks its ImageView<T, C> at run time. Photographs
// are turned as their Exif tags say.
#ifndef HMESH_TOOLS_IMAGE_FILE_HPP
#define HMESH_TOOLS_IMAGE_FILE_HPP

#include <cerrno>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "exif.hpp"
#include "hmesh/image/image_view.hpp"
#include "pnm.hpp"

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

// What stb may be given to deflate, in bytes: it counts in int, and doubles its buffer when what it made outgrows it.
inline constexpr std::size_t max_deflated = std::size_t{1} << 30U;

// The pixels of a file, packed: in `samples8` where bits is 8, in `samples16` where it is 16.
struct ImageFile {
    int width = 0, height = 0, channels = 0, bits = 0;
    std::vector<std::uint8_t> samples8;
    std::vector<std::uint16_t> samples16;
};

// Pixels of 8 bits, packed, 1 to 4 channels: what a PNG file is made of.
struct Picture {
    int width = 0, height = 0, channels = 0;
    std::vector<std::uint8_t> samples;
};

namespace detail {

[[nodiscard]] inline std::string read_bytes(const std::string& path, std::vector<unsigned char>& bytes) {
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

[[nodiscard]] inline std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

[[nodiscard]] inline std::string stb_reason() {
    const char* reason = stbi_failure_reason();
    return "not an image file that stb_image reads (" + lower_case(reason != nullptr ? reason : "unknown reason") + ")";
}

// Whether hmesh takes an image of this size: asked before the pixels are decoded.
[[nodiscard]] inline std::string check_size(int width, int height) {
    const std::uint8_t no_pixel = 0;
    const hmesh::Status status = hmesh::check(hmesh::ImageView<std::uint8_t, 1>{&no_pixel, width, height, 0});
    if (status) return {};
    return std::string(status.what) + " (got " + std::to_string(status.got) + ", limit " + std::to_string(status.want) + ")";
}

template <class T>
[[nodiscard]] std::string take(T* pixels, ImageFile& image, std::vector<T>& samples) {
    const std::unique_ptr<T, void (*)(void*)> owner(pixels, stbi_image_free);
    if (pixels == nullptr) return stb_reason();
    if (image.channels < 1 || image.channels > 4) return "it has " + std::to_string(image.channels) + " channels, not 1 to 4";
    const auto count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * static_cast<std::size_t>(image.channels);
    samples.assign(pixels, pixels + count);
    return {};
}

[[nodiscard]] inline std::string read_pnm(const std::vector<unsigned char>& bytes, ImageFile& image) {
    PnmHeader header;
    if (const std::string why = read_pnm_header(bytes, header); !why.empty()) return why;
    image.width = header.width;
    image.height = header.height;
    image.channels = header.channels;
    image.bits = header.maximum > 255 ? 16 : 8;
    if (const std::string why = check_size(image.width, image.height); !why.empty()) return why;
    return image.bits == 16 ? read_pnm_samples(bytes, header, image.samples16) : read_pnm_samples(bytes, header, image.samples8);
}

[[nodiscard]] inline std::string read_stb(const std::vector<unsigned char>& bytes, ImageFile& image) {
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

}  // namespace detail

// Reads the file, and leaves its bytes as they are in `bytes`. Returns "" or what is wrong, as the end of a sentence that
// begins with the file's name.
[[nodiscard]] inline std::string read_image(const std::string& path, ImageFile& image, std::vector<unsigned char>& bytes) {
    if (const std::string why = detail::read_bytes(path, bytes); !why.empty()) return why;
    return is_pnm(bytes) ? detail::read_pnm(bytes, image) : detail::read_stb(bytes, image);
}

[[nodiscard]] inline std::string read_image(const std::string& path, ImageFile& image) {
    std::vector<unsigned char> bytes;
    return read_image(path, image, bytes);
}

// Encodes a picture and hands the bytes of the PNG file to `sink`, a callable bool(const void*, std::size_t). False
// when there is no memory, the picture has more than 2^30 samples, or the sink refused.
template <class Sink>
[[nodiscard]] bool write_png(const Picture& picture, Sink& sink) {
    if (picture.samples.size() + static_cast<std::size_t>(picture.height) > max_deflated) return false;
    struct Call {
        Sink* sink;
        bool done;
    } call{&sink, false};
    const auto give = [](void* context, void* bytes, int size) {
        auto* to = static_cast<Call*>(context);
        to->done = (*to->sink)(bytes, static_cast<std::size_t>(size));
    };
    return stbi_write_png_to_func(give, &call, picture.width, picture.height, picture.channels, picture.samples.data(), 0) != 0 &&
           call.done;
}

}  // namespace tool

#endif  // HMESH_TOOLS_IMAGE_FILE_HPP
