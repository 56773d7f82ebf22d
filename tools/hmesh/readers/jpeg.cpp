// JPEG files (ITU T.81), by libjpeg-turbo or another libjpeg, else by stb_image behind a look at the segments.
//
// Of libjpeg's warnings only those about what is no pixel are passed over: a decoder that goes on after damage makes up a
// picture.
#include <array>
#include <cstdio>
#include <cstring>

#include "readers/exif.hpp"
#include "readers/readers.hpp"

#ifdef HMESH_HAS_JPEG
#include <jpeglib.h>

#include <jerror.h>

#include <csetjmp>
#endif

namespace tool {
namespace {

#ifdef HMESH_HAS_JPEG

// What libjpeg calls back with.
struct JpegErrors {
    jpeg_error_mgr base;  // first: libjpeg knows this part alone
    std::jmp_buf escape;
    char why[JMSG_LENGTH_MAX];

    [[noreturn]] static void fail(j_common_ptr jpeg) {
        auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);
        jpeg->err->format_message(jpeg, errors->why);
        std::longjmp(errors->escape, 1);
    }
    static void hear(j_common_ptr jpeg, int level) {
        const int what = jpeg->err->msg_code;
        if (level < 0 && what != JWRN_ADOBE_XFORM && what != JWRN_JFIF_MAJOR && what != JWRN_TOO_MUCH_DATA) fail(jpeg);
    }
};

// Ends what reads the same pixels again and again: no encoder makes 500 scans.
struct ScanLimit {
    jpeg_progress_mgr base;
    static void look(j_common_ptr jpeg) {
        if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > 500) jpeg->err->error_exit(jpeg);
    }
};

struct JpegReader {
    jpeg_decompress_struct jpeg{};
    JpegErrors errors{};
    ScanLimit limit{};
    JpegReader() = default;
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
};

// No object with a destructor lives in these two: longjmp() passes through them.
bool read_header(JpegReader& reader, Bytes file) {
    jpeg_decompress_struct& jpeg = reader.jpeg;
    jpeg.err = jpeg_std_error(&reader.errors.base);
    jpeg.err->error_exit = JpegErrors::fail;
    jpeg.err->emit_message = JpegErrors::hear;
    if (setjmp(reader.errors.escape) != 0) return false;
    jpeg_create_decompress(&jpeg);
    reader.limit.base.progress_monitor = ScanLimit::look;
    jpeg.progress = &reader.limit.base;
    jpeg_mem_src(&jpeg, file.data, static_cast<unsigned>(file.size));  // 2 GiB at most
    jpeg_read_header(&jpeg, TRUE);
    if (jpeg.num_components == 1) jpeg.out_color_space = JCS_GRAYSCALE;
    else jpeg.out_color_space = jpeg.num_components == 4 ? JCS_CMYK : JCS_RGB;
    jpeg_calc_output_dimensions(&jpeg);
    return true;
}

bool read_rows(JpegReader& reader, unsigned char* to) {
    jpeg_decompress_struct& jpeg = reader.jpeg;
    if (setjmp(reader.errors.escape) != 0) return false;
    jpeg_start_decompress(&jpeg);
    const std::size_t row = std::size_t{jpeg.output_width} * static_cast<std::size_t>(jpeg.output_components);
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW line = to + row * jpeg.output_scanline;
        jpeg_read_scanlines(&jpeg, &line, 1);
    }
    jpeg_finish_decompress(&jpeg);
    return true;
}

std::string refusal(const JpegReader& reader) {
    const bool has_scans = reader.jpeg.input_scan_number > 500;
    return has_scans ? "it has more than 500 scans" : std::string("libjpeg refuses it: ") + reader.errors.why;
}

std::string decode(Bytes file, ImageFile& image) {
    JpegReader reader;
    if (!read_header(reader, file)) return refusal(reader);
    const jpeg_decompress_struct& jpeg = reader.jpeg;
    if (jpeg.num_components != 1 && jpeg.num_components != 3 && jpeg.num_components != 4)
        return "it has " + std::to_string(jpeg.num_components) + " components, not 1, 3 or 4";
    if (std::string why = check_size(jpeg.image_width, jpeg.image_height); !why.empty()) return why;
    // Each block of 8 x 8 samples takes a bit at least, but not with arithmetic coding.
    const std::size_t pixels = std::size_t{jpeg.image_width} * jpeg.image_height;
    if (std::string why = check_ratio(pixels, file.size, jpeg.arith_code != 0 ? 1U << 20U : 512); !why.empty()) return why;
    if (std::string why = start_image(image, jpeg.image_width, jpeg.image_height, jpeg.num_components, 8); !why.empty())
        return why;
    if (!read_rows(reader, image.samples8.data())) return refusal(reader);
    if (jpeg.num_components != 4) return {};
    hmesh::kit::Array<std::uint8_t> rgb(3 * pixels);
    cmyk_to_rgb(image.samples8.data(), pixels, jpeg.saw_Adobe_marker != 0, rgb.data());
    image.samples8.swap(rgb);
    image.channels = 3;
    return {};
}

#else

// Tables that are longer than they may be: stb_image before 2.28 writes behind its own.
std::string find_wrong_table(Bytes segment) {
    for (std::size_t at = 0; at < segment.size;) {
        std::size_t count = 0;
        for (std::size_t k = 1; k <= 16; ++k) count += segment.u8(at + k);
        if (count > 256 || !segment.has(at, 17 + count)) return "it has a Huffman table of " + std::to_string(count) + " codes";
        at += 17 + count;
    }
    return {};
}

// Where the entropy-coded data from `at` on end.
std::size_t skip_scan(Bytes file, std::size_t at) {
    while (at < file.size &&
           (file.u8(at) != 0xff || file.u8(at + 1) == 0 || (file.u8(at + 1) >= 0xd0 && file.u8(at + 1) <= 0xd7)))
        ++at;
    return at;
}

// Whether an Adobe marker says that four components are inks, as they are or as YCCK. Without, stb_image takes them for YCbCr.
bool says_inks(Bytes segment) { return segment.says(0, "Adobe\0") && (segment.u8(11) == 0 || segment.u8(11) == 2); }

std::string find_damage(Bytes file) {
    bool has_frame = false, has_scan = false, has_four = false, has_inks = false;
    for (std::size_t at = 2; file.has(at, 2);) {
        const std::uint32_t marker = file.u8(at + 1);
        if (file.u8(at) != 0xff) return "there is no marker at byte " + std::to_string(at);
        if (marker == 0xff) {
            ++at;
            continue;
        }
        if (marker == 0xd9 && has_scan && has_four && !has_inks)
            return "it is CMYK without Adobe's marker, and this hmesh was built without libjpeg";
        if (marker == 0xd9) return has_scan ? "" : "it has no pixels";
        const std::size_t size = file.be16(at + 2);
        if (size < 2 || !file.has(at + 2, size)) return "its segment at byte " + std::to_string(at) + " is cut off";
        if (marker == 0xc4)
            if (std::string why = find_wrong_table(file.part(at + 4, size - 2)); !why.empty()) return why;
        if (marker == 0xee) has_inks = says_inks(file.part(at + 4, size - 2));
        if (marker >= 0xc0 && marker <= 0xc2) {
            if (has_frame) return "it has two frames";
            has_frame = true;
            has_four = file.u8(at + 9) == 4;
            const std::size_t pixels = std::size_t{file.be16(at + 5)} * file.be16(at + 7);
            if (std::string why = check_ratio(pixels, file.size, 512); !why.empty()) return why;
        }
        at += 2 + size;
        if (marker != 0xda) continue;
        if (!has_frame) return "it has pixels before the header of its frame";
        has_scan = true;
        at = skip_scan(file, at);
    }
    return "the file ends before its end marker";
}

std::string decode(Bytes file, ImageFile& image) {
    const std::string why = find_damage(file);
    return why.empty() ? decode_stb(file, image) : why;
}

#endif

}  // namespace

std::string read_jpeg(Bytes file, ImageFile& image) {
    if (std::string why = decode(file, image); !why.empty()) return why;
    const unsigned orientation = jpeg_orientation(file);
    image.orientation = static_cast<int>(orientation);
    turn_upright(orientation, image);
    return {};
}

std::string jpeg_decoder() {
#ifdef HMESH_HAS_JPEG
#ifdef LIBJPEG_TURBO_VERSION
#define HMESH_TEXT_OF(x) #x
#define HMESH_TEXT(x) HMESH_TEXT_OF(x)
    return "libjpeg-turbo " HMESH_TEXT(LIBJPEG_TURBO_VERSION);
#else
    return "libjpeg " + std::to_string(JPEG_LIB_VERSION / 10);
#endif
#else
    return stb_decoder();
#endif
}

}  // namespace tool
