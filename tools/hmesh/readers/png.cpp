// PNG files (W3C, third edition), by libpng, else by stb_image, which looks at no check sum: that is done here.
#include <algorithm>
#include <cstring>
#include <utility>

#include "readers/exif.hpp"
#include "readers/png_chunks.hpp"
#include "readers/readers.hpp"

#ifdef HMESH_HAS_PNG
#include <png.h>

#include <csetjmp>
#endif

namespace tool {
namespace {

struct Chunks {
    std::size_t image_bytes = 0;  // of IDAT
    unsigned orientation = 1;     // of eXIf
    bool has_end = false, is_animated = false;
};

Chunks find_chunks(Bytes file) {
    Chunks found;
    for (Chunk chunk; !found.has_end && read_chunk(file, chunk); chunk.at += chunk.size + 12) {
        if (file.says(chunk.at + 4, "IDAT")) found.image_bytes += chunk.size;
        if (file.says(chunk.at + 4, "eXIf")) found.orientation = tiff_orientation(file.part(chunk.at + 8, chunk.size));
        if (file.says(chunk.at + 4, "acTL")) found.is_animated = true;
        found.has_end = file.says(chunk.at + 4, "IEND");
    }
    return found;
}

// Bytes of the pixels as they are deflated.
std::size_t bytes_of_pixels(Bytes file) {
    constexpr std::size_t samples[] = {1, 0, 3, 1, 2, 0, 4, 0};
    return (file.be32(16) * samples[file.u8(25) & 7U] * file.u8(24) + 7) / 8 * file.be32(20);
}

#ifdef HMESH_HAS_PNG

constexpr bool is_little_endian() {
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    return false;
#else
    return true;
#endif
}

// What libpng is given: it calls back with `this`.
struct PngSource {
    Bytes left;
    std::string why;
    std::jmp_buf escape;

    static void read(png_structp png, png_bytep to, std::size_t count) {
        auto* source = static_cast<PngSource*>(png_get_io_ptr(png));
        if (count > source->left.size) png_error(png, "the file ends before its last chunk");
        std::memcpy(to, source->left.data, count);
        source->left = source->left.part(count);
    }
    [[noreturn]] static void fail(png_structp png, png_const_charp message) {
        auto* source = static_cast<PngSource*>(png_get_error_ptr(png));
        source->why = message;
        std::longjmp(source->escape, 1);
    }
    static void ignore(png_structp /*png*/, png_const_charp /*message*/) {}  // odd profiles and the like; no pixel is lost
};

// libpng's object: freed whatever happens.
struct PngReader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    explicit PngReader(PngSource& source)
        : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, PngSource::fail, PngSource::ignore)) {
        if (png != nullptr) info = png_create_info_struct(png);
    }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

// No object with a destructor lives in these two: longjmp() passes through them.
bool read_header(PngReader& reader, PngSource& source) {
    if (setjmp(source.escape) != 0) return false;
    png_set_read_fn(reader.png, &source, PngSource::read);
    png_set_crc_action(reader.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_user_limits(reader.png, 65536, 65536);
    png_read_info(reader.png, reader.info);
    if (png_get_color_type(reader.png, reader.info) == PNG_COLOR_TYPE_PALETTE) png_set_packing(reader.png);
    else png_set_expand(reader.png);  // 1, 2 and 4 bits, and a colour that is transparent
    if (is_little_endian() && png_get_bit_depth(reader.png, reader.info) == 16) png_set_swap(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    return true;
}

bool read_rows(PngReader& reader, PngSource& source, png_bytepp rows) {
    if (setjmp(source.escape) != 0) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, reader.info);
    return true;
}

// Colours for indices: libpng would take one that is not there for black.
std::string take_palette(PngReader& reader, ImageFile& image) {
    png_colorp palette = nullptr;
    png_bytep alpha = nullptr;
    int colors = 0, alphas = 0;
    if (png_get_PLTE(reader.png, reader.info, &palette, &colors) == 0) return "it has no palette";
    if (png_get_tRNS(reader.png, reader.info, &alpha, &alphas, nullptr) == 0 || alpha == nullptr) alphas = 0;
    const hmesh::kit::Array<std::uint8_t> indices = std::move(image.samples8);
    if (std::string why = start_image(image, image.width, image.height, alphas == 0 ? 3 : 4, 8); !why.empty()) return why;
    std::uint8_t* to = image.samples8.data();
    for (const std::uint8_t index : indices) {
        if (index >= colors)
            return "it has a pixel of colour " + std::to_string(index) + ", and its palette has " + std::to_string(colors);
        for (const png_byte sample : {palette[index].red, palette[index].green, palette[index].blue}) *to++ = sample;
        if (alphas != 0) *to++ = index < alphas ? alpha[index] : png_byte{255};
    }
    return {};
}

std::string decode(Bytes file, ImageFile& image) {
    PngSource source{file, {}, {}};
    PngReader reader(source);
    if (reader.info == nullptr) return "there is no memory for libpng";
    if (!read_header(reader, source)) return "libpng refuses it: " + source.why;
    const int bits = png_get_bit_depth(reader.png, reader.info);
    const int channels = png_get_channels(reader.png, reader.info);
    const auto width = png_get_image_width(reader.png, reader.info), height = png_get_image_height(reader.png, reader.info);
    if (std::string why = start_image(image, width, height, channels, bits); !why.empty()) return why;
    auto* const first = bits == 16 ? reinterpret_cast<unsigned char*>(image.samples16.data()) : image.samples8.data();
    const std::size_t row = png_get_rowbytes(reader.png, reader.info);
    std::vector<png_bytep> rows(height);
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = first + y * row;
    if (!read_rows(reader, source, rows.data())) return "libpng refuses it: " + source.why;
    return png_get_color_type(reader.png, reader.info) == PNG_COLOR_TYPE_PALETTE ? take_palette(reader, image) : "";
}

#else

std::string find_damage(Bytes file) {
    for (Chunk chunk; read_chunk(file, chunk); chunk.at += chunk.size + 12) {
        if (!is_undamaged(file, chunk)) return "the check sum of the chunk at byte " + std::to_string(chunk.at) + " is wrong";
        if (file.says(chunk.at + 4, "CgBI")) return "it is a PNG file for iOS alone";
        if (file.says(chunk.at + 4, "IEND")) return {};
    }
    return "the file ends before its last chunk";
}

// The same file with 256 colours in its palette, the new ones grey: stb_image takes a colour that is not there from the stack.
std::vector<unsigned char> with_whole_palette(Bytes file, unsigned char grey) {
    std::vector<unsigned char> whole(file.data, file.data + std::min<std::size_t>(file.size, 8));
    for (Chunk chunk; read_chunk(file, chunk); chunk.at += chunk.size + 12) {
        const unsigned char* first = file.data + chunk.at;
        const bool is_palette = file.says(chunk.at + 4, "PLTE") && chunk.size < 768;
        if (is_palette) whole.insert(whole.end(), {0, 0, 3, 0});
        whole.insert(whole.end(), first + (is_palette ? 4 : 0), first + 8 + chunk.size);
        if (is_palette) whole.resize(whole.size() + 768 - chunk.size, grey);
        whole.insert(whole.end(), first + 8 + chunk.size, first + 12 + chunk.size);
    }
    return whole;
}

std::string decode(Bytes file, ImageFile& image) {
    if (std::string why = find_damage(file); !why.empty()) return why;
    if (file.u8(25) != 3) return decode_stb(file, image);
    // A pixel of a colour that is not there looks different each time.
    ImageFile again;
    const std::vector<unsigned char> black = with_whole_palette(file, 0), white = with_whole_palette(file, 255);
    if (std::string why = decode_stb({black.data(), black.size()}, image); !why.empty()) return why;
    if (std::string why = decode_stb({white.data(), white.size()}, again); !why.empty()) return why;
    return image.samples8 == again.samples8 ? "" : "it has a pixel of a colour that its palette has not";
}

#endif

}  // namespace

std::string read_png(Bytes file, ImageFile& image) {
    const Chunks chunks = find_chunks(file);
    if (!file.says(12, "IHDR") || file.size < 33) return "its PNG header is cut off";
    if (std::string why = check_size(file.be32(16), file.be32(20)); !why.empty()) return why;
    if (!chunks.has_end) return "the file ends before its last chunk";
    // Deflate makes 1032 bytes of one at most.
    if (std::string why = check_ratio(bytes_of_pixels(file), chunks.image_bytes, 1032); !why.empty()) return why;
    if (std::string why = decode(file, image); !why.empty()) return why;
    if (chunks.is_animated) image.note = "the file is animated: the picture for programs that show no animation is taken";
    image.orientation = static_cast<int>(chunks.orientation);
    turn_upright(chunks.orientation, image);
    return {};
}

std::string png_decoder() {
#ifdef HMESH_HAS_PNG
    return std::string("libpng ") + png_get_libpng_ver(nullptr);
#else
    return stb_decoder();
#endif
}

}  // namespace tool
