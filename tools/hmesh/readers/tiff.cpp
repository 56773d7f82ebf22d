// TIFF files (revision 6.0), by libtiff: grey, RGB and CMYK of 8 and 16 bits and floats as they are stored, all else, such as
// palettes, bilevel pictures and YCbCr, by libtiff's way to 8-bit RGB. The first page. What is stored is read by rectangles too,
// strips or tiles of the file being decoded where they are wanted.
#include "readers/readers.hpp"
#include "readers/rectangles.hpp"

#ifdef HMESH_HAS_TIFF
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/image/image_reader.hpp"
#include "readers/file_at.hpp"
#include "readers/image_file.hpp"
#include "terminal/words.hpp"
#endif

namespace tool {

#ifdef HMESH_HAS_TIFF

namespace {

// A file in memory, or one that is read where libtiff wants it, and the first thing that was said against it.
struct TiffSource {
    Bytes file;
    const FileAt* large = nullptr;  // in place of that
    bool is_mapped = false;         // the former: libtiff is given its bytes where they lie
    std::uint64_t at = 0;
    std::string why;

    static TiffSource& of(thandle_t handle) { return *static_cast<TiffSource*>(handle); }
    static tmsize_t read(thandle_t handle, void* to, tmsize_t count) {
        TiffSource& source = of(handle);
        if (source.large != nullptr) return source.read_large(to, static_cast<std::uint64_t>(count));
        const Bytes part = source.file.part(static_cast<std::size_t>(source.at), static_cast<std::size_t>(count));
        if (part.size != 0) std::memcpy(to, part.data, part.size);
        source.at += part.size;
        return static_cast<tmsize_t>(part.size);
    }
    static int map(thandle_t handle, void** to, toff_t* count) {
        const TiffSource& source = of(handle);
        if (!source.is_mapped) return 0;
        *to = const_cast<unsigned char*>(source.file.data);  // it is not written to
        *count = source.file.size;
        return 1;
    }
    static void unmap(thandle_t /*handle*/, void* /*from*/, toff_t /*count*/) {}
    static tmsize_t write(thandle_t /*handle*/, void* /*from*/, tmsize_t /*count*/) { return -1; }
    static toff_t seek(thandle_t handle, toff_t to, int whence) {
        TiffSource& source = of(handle);
        const toff_t base = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? source.at : size(handle);
        source.at = base + to;
        return source.at;
    }
    static int close(thandle_t /*handle*/) { return 0; }
    static toff_t size(thandle_t handle) {
        const TiffSource& source = of(handle);
        return source.large != nullptr ? source.large->size() : source.file.size;
    }
    tmsize_t read_large(void* to, std::uint64_t count) {
        count = at > large->size() ? 0 : std::min(count, large->size() - at);
        if (count == 0) return 0;
        if (const std::string wrong = large->read(at, static_cast<std::size_t>(count), to); !wrong.empty()) {
            if (why.empty()) why = wrong;
            return 0;
        }
        at += count;
        return static_cast<tmsize_t>(count);
    }

    static void hear_error(thandle_t handle, const char* module, const char* format, std::va_list values) {
        if (handle == nullptr || !of(handle).why.empty()) return;
        char text[512];
        std::vsnprintf(text, sizeof text, format, values);
        // These are no pixels: libtiff goes on as if they were not there.
        for (const char* name : {"\"Orientation\"", "\"ResolutionUnit\""})
            if (std::strstr(text, name) != nullptr) return;
        of(handle).why = std::string("libtiff refuses it: ") + text + (module != nullptr ? std::string(" (") + module + ")" : "");
    }
    // Of tags that nobody knows, or that are in no order, there are many. Decoders warn of pixels.
    static void hear_warning(thandle_t handle, const char* module, const char* format, std::va_list values) {
        if (module != nullptr && std::strncmp(module, "TIFF", 4) != 0) hear_error(handle, module, format, values);
    }
};

using Tiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;

Tiff open_tiff(TiffSource& source) {
    TIFFSetErrorHandler(nullptr);
    TIFFSetWarningHandler(nullptr);
    TIFFSetErrorHandlerExt(TiffSource::hear_error);
    TIFFSetWarningHandlerExt(TiffSource::hear_warning);
    return {TIFFClientOpen("TIFF", "r", &source, TiffSource::read, TiffSource::write, TiffSource::seek, TiffSource::close,
                           TiffSource::size, TiffSource::map, TiffSource::unmap),
            TIFFClose};
}

template <class T>
T tag(TIFF* tiff, std::uint32_t name, T otherwise) {
    T value = otherwise;
    return TIFFGetFieldDefaulted(tiff, name, &value) != 0 ? value : otherwise;
}

// How the first page is stored.
struct Layout {
    std::uint32_t width = 0, height = 0;
    std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, photometric = PHOTOMETRIC_MINISBLACK;
    std::uint16_t planar = PLANARCONFIG_CONTIG, compression = COMPRESSION_NONE, orientation = 1;
    std::uint16_t colors = 1;                       // samples that are not extra
    bool has_alpha = false, is_associated = false;  // the first extra sample

    [[nodiscard]] bool is_plain() const {
        const bool is_light = photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_RGB;
        if (format == SAMPLEFORMAT_IEEEFP) return bits == 32 && is_light;
        return (bits == 8 || bits == 16) &&
               (is_light || photometric == PHOTOMETRIC_MINISWHITE || photometric == PHOTOMETRIC_SEPARATED);
    }
    [[nodiscard]] std::size_t sample_bytes() const { return bits / 8U; }
};

Layout read_layout(TIFF* tiff) {
    Layout layout;
    layout.width = tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
    layout.height = tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
    layout.bits = tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
    layout.samples = tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    layout.format = tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    if (layout.format == SAMPLEFORMAT_VOID) layout.format = SAMPLEFORMAT_UINT;
    layout.photometric =
        tag<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, layout.samples < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
    layout.planar = tag<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    layout.compression = tag<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    layout.orientation = tag<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, 1);
    layout.colors = layout.photometric == PHOTOMETRIC_RGB ? 3 : layout.photometric == PHOTOMETRIC_SEPARATED ? 4 : 1;
    std::uint16_t count = 0, *extra = nullptr;
    if (TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &count, &extra) != 0 && count > 0 && layout.samples > layout.colors) {
        layout.is_associated = extra[0] == EXTRASAMPLE_ASSOCALPHA;
        layout.has_alpha = layout.is_associated || extra[0] == EXTRASAMPLE_UNASSALPHA;
    }
    return layout;
}

std::string find_unread(const Layout& layout) {
    const bool has_known_format =
        layout.format == SAMPLEFORMAT_UINT || (layout.format == SAMPLEFORMAT_IEEEFP && layout.is_plain());
    if (!has_known_format || layout.bits > 16 + 16 * (layout.format == SAMPLEFORMAT_IEEEFP ? 1 : 0))
        return "its samples have " + std::to_string(layout.bits) + " bits" +
               (layout.format == SAMPLEFORMAT_INT      ? " and a sign"
                : layout.format == SAMPLEFORMAT_IEEEFP ? " and are floats"
                                                       : "") +
               "; hmesh reads whole numbers of up to 16 bits without a sign, and floats of 32 bits in grey or RGB";
    if (layout.is_plain() && layout.samples < layout.colors)
        return "it has " + std::to_string(layout.samples) + " samples a pixel, and its colours need " +
               std::to_string(layout.colors);
    return {};
}

// What compression cannot have made: none of these makes more than 4096 bytes of one. Those that make more of nothing are left
// out.
std::string check_compression(const Layout& layout, std::uint64_t file_size) {
    const std::size_t bits = std::size_t{layout.width} * layout.samples * layout.bits;
    const std::size_t needed = (bits + 7) / 8 * layout.height;
    switch (layout.compression) {
        case COMPRESSION_NONE: return layout.photometric == PHOTOMETRIC_YCBCR ? "" : check_ratio(needed, file_size, 1);
        case COMPRESSION_LZW:
        case COMPRESSION_PACKBITS:
        case COMPRESSION_ADOBE_DEFLATE:
        case COMPRESSION_DEFLATE:
        case COMPRESSION_JPEG: return check_ratio(needed, file_size, 4096);
        default: return check_ratio(needed, file_size, std::size_t{1} << 20U);
    }
}

// Copies what a strip or tile holds of the picture: `from` has rows of `stride` pixels with `step` samples of `size` bytes, and
// lies at (x, y) of the picture `to`, from sample `first` of each pixel on.
void copy_part(const unsigned char* from, const Layout& layout, std::uint32_t x, std::uint32_t y, std::uint32_t stride,
               std::uint32_t rows, std::uint32_t step, std::uint32_t first, unsigned char* to) {
    const std::size_t size = layout.sample_bytes(), pixel = layout.samples * size;
    const std::uint32_t columns = std::min(stride, layout.width - x);
    for (std::uint32_t row = 0; row < std::min(rows, layout.height - y); ++row)
        for (std::uint32_t column = 0; column < columns; ++column)
            std::memcpy(to + ((std::size_t{y} + row) * layout.width + x + column) * pixel + first * size,
                        from + (std::size_t{row} * stride + column) * step * size, step * size);
}

// How the picture is cut into strips or tiles.
struct Parts {
    bool are_tiles = false;
    std::uint32_t width = 0, height = 0;  // px
    std::uint32_t planes = 1, step = 1;   // step: samples of a pixel in a plane
    std::uint32_t columns = 1, rows = 1;  // how many
};

// How large strips and tiles are, and how many there are. Returns "" or what is wrong with them.
std::string find_parts(TIFF* tiff, const Layout& layout, Parts& parts) {
    parts.are_tiles = TIFFIsTiled(tiff) != 0;
    parts.width = layout.width;
    parts.height = std::min(layout.height, tag<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP, layout.height));
    if (parts.are_tiles) {
        parts.width = tag<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 0);
        parts.height = tag<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 0);
    }
    if (parts.width == 0 || parts.height == 0 || parts.width > 65536 || parts.height > 65536)
        return std::string("its ") + (parts.are_tiles ? "tiles" : "strips") + " have no valid size";
    parts.planes = layout.planar == PLANARCONFIG_SEPARATE ? layout.samples : 1U;
    parts.step = layout.samples / parts.planes;
    parts.columns = (layout.width - 1) / parts.width + 1;
    parts.rows = (layout.height - 1) / parts.height + 1;
    return {};
}

// All samples of all pixels, interleaved.
std::string read_samples(TIFF* tiff, const Layout& layout, std::vector<unsigned char>& samples) {
    const bool is_tiled = TIFFIsTiled(tiff) != 0;
    auto part_width = layout.width;
    auto part_height = tag<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP, layout.height);
    if (is_tiled) {
        part_width = tag<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 0);
        part_height = tag<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 0);
        if (part_width == 0 || part_height == 0 || part_width > 65536 || part_height > 65536 ||
            std::size_t{part_width} * part_height >
                std::max(std::size_t{1} << 22U, 4 * std::size_t{layout.width} * layout.height))
            return "its tiles of " + std::to_string(part_width) + " x " + std::to_string(part_height) +
                   " px are too large for it";
    }
    part_height = is_tiled ? part_height : std::min(part_height, layout.height);
    if (part_height == 0) return "its strips have no rows";
    const std::uint32_t planes = layout.planar == PLANARCONFIG_SEPARATE ? layout.samples : 1U;
    const std::uint32_t step = layout.samples / planes;
    const std::size_t row_bytes = std::size_t{part_width} * step * layout.sample_bytes();
    std::vector<unsigned char> part(row_bytes * part_height);
    samples.assign(std::size_t{layout.width} * layout.height * layout.samples * layout.sample_bytes(), 0);
    std::uint32_t index = 0;
    for (std::uint32_t plane = 0; plane < planes; ++plane)
        for (std::uint32_t y = 0; y < layout.height; y += part_height)
            for (std::uint32_t x = 0; x < layout.width; x += part_width, ++index) {
                const std::uint32_t rows = is_tiled ? part_height : std::min(part_height, layout.height - y);
                const auto size = static_cast<tmsize_t>(row_bytes * rows);
                const tmsize_t got = is_tiled ? TIFFReadEncodedTile(tiff, index, part.data(), size)
                                              : TIFFReadEncodedStrip(tiff, index, part.data(), size);
                if (got != size)
                    return std::string("its ") + (is_tiled ? "tile " : "strip ") + std::to_string(index) +
                           " is cut off or damaged";
                copy_part(part.data(), layout, x, y, part_width, rows, step, plane * step, samples.data());
            }
    return {};
}

// Straight colours of what was multiplied by alpha.
template <class T>
void divide_by_alpha(T* pixel, int colors, double peak) {
    const auto alpha = static_cast<double>(pixel[colors]);
    for (int c = 0; c < colors && alpha > 0; ++c) {
        const double straight = static_cast<double>(pixel[c]) * peak / alpha;
        pixel[c] = peak > 1 ? static_cast<T>(std::min(straight, peak) + 0.5) : static_cast<T>(straight);
    }
}

// Makes `pixels` pixels of a picture of `channels` channels.
template <class T>
void take_samples(const Layout& layout, const unsigned char* bytes, std::size_t pixels, double peak, int channels, T* to) {
    const int colors = layout.colors;
    std::vector<T> pixel(layout.samples);
    for (std::size_t i = 0; i < pixels; ++i) {
        std::memcpy(pixel.data(), bytes + i * layout.samples * sizeof(T), layout.samples * sizeof(T));
        if (layout.photometric == PHOTOMETRIC_MINISWHITE) pixel[0] = static_cast<T>(peak - static_cast<double>(pixel[0]));
        T* const out = to + i * static_cast<std::size_t>(channels);
        if (layout.photometric == PHOTOMETRIC_SEPARATED) {
            if constexpr (sizeof(T) < 4) cmyk_to_rgb(pixel.data(), 1, false, out);
            continue;
        }
        std::copy_n(pixel.data(), channels, out);
        if (layout.is_associated) divide_by_alpha(out, colors, peak);
    }
}

// The same in samples of as many bits as the file's.
void take_samples(const Layout& layout, const unsigned char* bytes, std::size_t pixels, int channels, void* to) {
    if (layout.bits == 8) take_samples(layout, bytes, pixels, 255, channels, static_cast<std::uint8_t*>(to));
    else if (layout.bits == 16) take_samples(layout, bytes, pixels, 65535, channels, static_cast<std::uint16_t*>(to));
    else take_samples(layout, bytes, pixels, 1, channels, static_cast<float*>(to));
}

int channels_of(const Layout& layout) {
    return layout.photometric == PHOTOMETRIC_SEPARATED ? 3 : layout.colors + (layout.has_alpha ? 1 : 0);
}

std::string read_plain(TIFF* tiff, const Layout& layout, ImageFile& image) {
    std::vector<unsigned char> bytes;
    if (std::string why = read_samples(tiff, layout, bytes); !why.empty()) return why;
    if (std::string why = start_image(image, layout.width, layout.height, channels_of(layout), layout.bits); !why.empty())
        return why;
    void* const to = layout.bits == 8    ? static_cast<void*>(image.samples8.data())
                     : layout.bits == 16 ? static_cast<void*>(image.samples16.data())
                                         : static_cast<void*>(image.samples32.data());
    take_samples(layout, bytes.data(), std::size_t{layout.width} * layout.height, image.channels, to);
    return {};
}

std::string read_as_rgb(TIFF* tiff, const Layout& layout, ImageFile& image) {
    char why_not[1024] = "";
    if (TIFFRGBAImageOK(tiff, why_not) == 0) return std::string("libtiff refuses it: ") + why_not;
    TIFFRGBAImage rgba;
    if (TIFFRGBAImageBegin(&rgba, tiff, 1, why_not) == 0) return std::string("libtiff refuses it: ") + why_not;
    const std::unique_ptr<TIFFRGBAImage, void (*)(TIFFRGBAImage*)> owner(&rgba, TIFFRGBAImageEnd);
    rgba.req_orientation = rgba.orientation;  // as it is stored: it is turned later
    std::vector<std::uint32_t> pixels(std::size_t{layout.width} * layout.height);
    if (TIFFRGBAImageGet(&rgba, pixels.data(), layout.width, layout.height) == 0) return "libtiff refuses its pixels";
    const bool is_grey = layout.photometric == PHOTOMETRIC_MINISBLACK || layout.photometric == PHOTOMETRIC_MINISWHITE;
    if (std::string why = start_image(image, layout.width, layout.height, is_grey ? 1 : 3, 8); !why.empty()) return why;
    std::uint8_t* to = image.samples8.data();
    for (const std::uint32_t pixel : pixels)
        for (int c = 0; c < image.channels; ++c) *to++ = static_cast<std::uint8_t>(pixel >> (8 * c));
    return {};
}

// A file by rectangles. Strips or tiles are decoded by one thread at a time, and those of two rows of tiles of the mesh are kept.
class TiffFile : public RectangleFile {
  public:
    // Opens a file. Returns "" or what is wrong.
    [[nodiscard]] std::string open(const std::string& path) {
        if (std::string why = file_.open(path); !why.empty()) return why;
        source_.large = &file_;
        tiff_ = open_tiff(source_);
        if (tiff_ == nullptr) return source_.why.empty() ? "libtiff refuses its header" : source_.why;
        layout_ = read_layout(tiff_.get());
        if (layout_.width > 65536 || layout_.height > 65536 || layout_.width == 0 || layout_.height == 0)
            return "its sides must be 1 to 65536 px";
        if (layout_.samples < 1 || layout_.samples > 16)
            return "it has " + std::to_string(layout_.samples) + " samples a pixel, not 1 to 16";
        if (std::string why = find_unread(layout_); !why.empty()) return why;
        if (!layout_.is_plain()) return "it has palettes, bits or YCbCr, which are not read by rectangles";
        if (layout_.orientation != 1) return "it is turned, and not read by rectangles";
        if (std::string why = check_compression(layout_, file_.size()); !why.empty()) return why;
        if (std::string why = find_parts(tiff_.get(), layout_, parts_); !why.empty()) return why;
        const std::size_t part = part_bytes(parts_.height);
        if (part > std::size_t{1} << 28U)
            return std::string("its ") + (parts_.are_tiles ? "tiles" : "strips") + " of " + std::to_string(part) +
                   " bytes are too large to be read by rectangles";
        const std::size_t rows = std::size_t{600} * layout_.width * layout_.samples * layout_.sample_bytes();
        most_ = std::max<std::size_t>(std::size_t{4} * parts_.planes, (rows + (std::size_t{1} << 24U)) / part + 1);
        if (!source_.why.empty()) return source_.why;
        return {};
    }
    [[nodiscard]] const Layout& layout() const noexcept { return layout_; }
    [[nodiscard]] bool has_more_pages() const { return TIFFLastDirectory(tiff_.get()) == 0; }
    [[nodiscard]] std::string why() const override { return source_.why; }

    bool read(const hmesh::kit::Rect& rect, void* samples, std::ptrdiff_t row_stride) override {
        const std::size_t pixel = layout_.samples * layout_.sample_bytes();
        const auto width = static_cast<std::size_t>(rect.width), height = static_cast<std::size_t>(rect.height);
        std::vector<unsigned char> bytes(width * height * pixel);
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            const auto left = static_cast<std::uint32_t>(rect.x), top = static_cast<std::uint32_t>(rect.y);
            const std::uint32_t right = left + static_cast<std::uint32_t>(rect.width) - 1;
            const std::uint32_t bottom = top + static_cast<std::uint32_t>(rect.height) - 1;
            for (std::uint32_t plane = 0; plane < parts_.planes; ++plane)
                for (std::uint32_t j = top / parts_.height; j <= bottom / parts_.height; ++j)
                    for (std::uint32_t i = left / parts_.width; i <= right / parts_.width; ++i) {
                        const std::vector<unsigned char>* const part = find_part(plane, i, j);
                        if (part == nullptr) return false;
                        copy(*part, plane, i, j, rect, bytes.data());
                    }
        }
        for (std::size_t y = 0; y < height; ++y)
            take_samples(layout_, bytes.data() + y * width * pixel, width, channels_of(layout_),
                         static_cast<unsigned char*>(samples) + static_cast<std::ptrdiff_t>(y) * row_stride);
        return true;
    }

  private:
    struct Kept {
        std::vector<unsigned char> bytes;
        std::uint64_t used = 0;  // when it was last
    };

    [[nodiscard]] std::size_t part_bytes(std::uint32_t rows) const {
        return std::size_t{parts_.width} * rows * parts_.step * layout_.sample_bytes();
    }
    // The decoded part, which stays until others are asked for; null: it cannot be decoded.
    const std::vector<unsigned char>* find_part(std::uint32_t plane, std::uint32_t i, std::uint32_t j) {
        const std::uint32_t index = (plane * parts_.rows + j) * parts_.columns + i;
        if (const auto found = kept_.find(index); found != kept_.end()) {
            found->second.used = ++time_;
            return &found->second.bytes;
        }
        std::vector<unsigned char> bytes;
        if (kept_.size() >= most_) {
            const auto oldest = std::min_element(kept_.begin(), kept_.end(),
                                                 [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
            bytes = std::move(oldest->second.bytes);
            kept_.erase(oldest);
        }
        const std::uint32_t rows = parts_.are_tiles ? parts_.height : std::min(parts_.height, layout_.height - j * parts_.height);
        bytes.resize(part_bytes(rows));
        const auto size = static_cast<tmsize_t>(bytes.size());
        const tmsize_t got = parts_.are_tiles ? TIFFReadEncodedTile(tiff_.get(), index, bytes.data(), size)
                                              : TIFFReadEncodedStrip(tiff_.get(), index, bytes.data(), size);
        if (got != size || !source_.why.empty()) {
            if (source_.why.empty())
                source_.why = std::string("its ") + (parts_.are_tiles ? "tile " : "strip ") + std::to_string(index) +
                              " is cut off or damaged";
            return nullptr;
        }
        Kept& kept = kept_[index];
        kept = {std::move(bytes), ++time_};
        return &kept.bytes;
    }
    // What a part has of a rectangle, whose pixels have all samples.
    void copy(const std::vector<unsigned char>& part, std::uint32_t plane, std::uint32_t i, std::uint32_t j,
              const hmesh::kit::Rect& rect, unsigned char* to) const {
        const int x = static_cast<int>(i * parts_.width), y = static_cast<int>(j * parts_.height);
        const int left = std::max(rect.x, x), right = std::min(rect.x + rect.width, x + static_cast<int>(parts_.width));
        const int top = std::max(rect.y, y), bottom = std::min(rect.y + rect.height, y + static_cast<int>(parts_.height));
        const std::size_t size = layout_.sample_bytes(), pixel = layout_.samples * size, run = parts_.step * size;
        for (int row = top; row < bottom; ++row) {
            const unsigned char* from =
                part.data() + (static_cast<std::size_t>(row - y) * parts_.width + static_cast<std::size_t>(left - x)) * run;
            unsigned char* out = to + (static_cast<std::size_t>(row - rect.y) * static_cast<std::size_t>(rect.width) +
                                       static_cast<std::size_t>(left - rect.x)) *
                                          pixel;
            const auto count = static_cast<std::size_t>(right - left);
            if (run == pixel) {
                std::memcpy(out, from, count * pixel);
                continue;
            }
            out += plane * run;
            for (std::size_t k = 0; k < count; ++k, out += pixel, from += run) std::memcpy(out, from, run);
        }
    }

    FileAt file_;
    TiffSource source_;
    Tiff tiff_{nullptr, TIFFClose};
    Layout layout_;
    Parts parts_;
    std::mutex mutex_;
    std::map<std::uint32_t, Kept> kept_;
    std::size_t most_ = 0;  // parts that are kept
    std::uint64_t time_ = 0;
};

std::string read_page(TIFF* tiff, std::size_t file_size, ImageFile& image, Layout& layout) {
    layout = read_layout(tiff);
    if (std::string why = check_size(layout.width, layout.height); !why.empty()) return why;
    if (layout.samples < 1 || layout.samples > 16)
        return "it has " + std::to_string(layout.samples) + " samples a pixel, not 1 to 16";
    if (std::string why = find_unread(layout); !why.empty()) return why;
    if (std::string why = check_compression(layout, file_size); !why.empty()) return why;
    return layout.is_plain() ? read_plain(tiff, layout, image) : read_as_rgb(tiff, layout, image);
}

}  // namespace

std::string read_tiff(Bytes file, ImageFile& image) {
    TiffSource source;
    source.file = file;
    Tiff tiff = open_tiff(source);
    if (tiff == nullptr) return source.why.empty() ? "libtiff refuses its header" : source.why;
    // Of tiles that are not compressed libtiff's way to RGB refuses those that do not fill its own buffer, of whole kilobytes.
    if (TIFFIsTiled(tiff.get()) != 0 && !read_layout(tiff.get()).is_plain()) {
        source.is_mapped = true;
        source.at = 0;
        tiff = open_tiff(source);
        if (tiff == nullptr) return source.why.empty() ? "libtiff refuses its header" : source.why;
    }
    Layout layout;
    std::string why = read_page(tiff.get(), file.size, image, layout);
    if (!source.why.empty()) why = source.why;  // it may have gone on
    if (!why.empty()) return why;
    if (TIFFLastDirectory(tiff.get()) == 0) image.note = "the file has more pages than one: its first page is taken";
    turn_upright(layout.orientation, image);
    return {};
}

std::string open_tiff_rectangles(const std::string& path, ImageFile& image) {
    auto file = std::make_shared<TiffFile>();
    if (std::string why = file->open(path); !why.empty()) return why;
    const Layout& layout = file->layout();
    image = {};
    image.width = static_cast<int>(layout.width);
    image.height = static_cast<int>(layout.height);
    image.channels = channels_of(layout);
    image.bits = layout.bits;
    if (file->has_more_pages()) image.note = "the file has more pages than one: its first page is taken";
    image.rectangles = std::move(file);
    return {};
}

std::string tiff_decoder() {
    const std::string text = TIFFGetVersion();  // "LIBTIFF, Version 4.5.0\nCopyright ..."
    const std::size_t at = text.find("Version ");
    return "libtiff " + (at == std::string::npos ? "" : text.substr(at + 8, text.find('\n') - at - 8));
}

#else

std::string read_tiff(Bytes /*file*/, ImageFile& /*image*/) {
    return "it is a TIFF file, and this hmesh was built without libtiff";
}
std::string open_tiff_rectangles(const std::string& /*path*/, ImageFile& /*image*/) {
    return "it is a TIFF file, and this hmesh was built without libtiff";
}
std::string tiff_decoder() { return {}; }

#endif

}  // namespace tool
