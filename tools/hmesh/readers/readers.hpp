// tools - the readers of image files, one a format; what they share, and which of them this build has.
//
// Whole pictures or a refusal: a reader returns "" and the image, or what is wrong, as the end of a sentence that begins with
// the file's name. It checks the header's size before it allocates anything, fills its buffers with zeros, and takes whatever its
// decoder warns of as damage.
#ifndef HMESH_TOOLS_READERS_READERS_HPP
#define HMESH_TOOLS_READERS_READERS_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "readers/bytes.hpp"
#include "readers/image_file.hpp"

namespace tool {

enum class FileKind : std::uint8_t { unknown, png, jpeg, webp, tiff, pnm, pfm, hdr, bmp, tga, gif, psd };

// By the first bytes. TGA files have none of their own: they are what has the header of one, and is nothing else.
[[nodiscard]] FileKind kind_of(Bytes file) noexcept;
// Whether it is a compact file, which is unknown as an image.
[[nodiscard]] inline bool is_mesh(Bytes file) noexcept { return file.says(0, "\x9dHMC"); }
// What is said of a file that is neither.
[[nodiscard]] std::string not_known(Bytes file);

// "PNG": as people call it.
[[nodiscard]] const char* name_of(FileKind kind) noexcept;

// Of any size: whether hmesh takes such an image.
[[nodiscard]] std::string check_size(std::int64_t width, std::int64_t height);

// Whether hmesh takes the image whose file begins so, as far as this says it: asked before the rest is read.
[[nodiscard]] std::string check_beginning(Bytes file);

// The size that the header of a PGM, PPM or PFM file, or of a Radiance file, says; below 0 where these bytes do not hold it.
void find_pnm_size(Bytes file, std::int64_t& width, std::int64_t& height);
void find_hdr_size(Bytes file, std::int64_t& width, std::int64_t& height);

// As check_beginning() of a TIFF file, of which these are the bytes from its first directory on.
[[nodiscard]] std::string check_tiff_directory(Bytes directory, bool is_little);

// What a file of `size` bytes, compressed `ratio` : 1 at most, cannot hold: refused before as much is allocated.
[[nodiscard]] std::string check_ratio(std::size_t needed, std::size_t size, std::size_t ratio);

// "the file ends before its last pixel (119982 of 230400 bytes)".
[[nodiscard]] std::string too_short(std::size_t has, std::size_t needs);

// Sets all but the samples, checks the size, and makes the samples zeros.
[[nodiscard]] std::string start_image(ImageFile& image, std::int64_t width, std::int64_t height, int channels, int bits);

// Leaves alpha out where all is opaque: for formats that do not say whether they have it.
void drop_opaque_alpha(ImageFile& image);

// Turns the samples upright, see exif.hpp.
void turn_upright(unsigned orientation, ImageFile& image);

// CMYK to RGB for what is not colour-managed: each of red, green and blue is what its ink and black let through. `ink` is 0 for
// paper. 8 or 16 bits.
template <class T>
void cmyk_to_rgb(const T* cmyk, std::size_t pixels, bool is_inverted, T* rgb) {
    constexpr std::uint64_t peak = static_cast<T>(-1);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint64_t ink = cmyk[4 * i + c], black = cmyk[4 * i + 3];
            const std::uint64_t light = is_inverted ? ink * black : (peak - ink) * (peak - black);
            rgb[3 * i + c] = static_cast<T>((light + peak / 2) / peak);
        }
}

// Each is there in every build; it says so where it needs a library that is not.
[[nodiscard]] std::string read_png(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_jpeg(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_webp(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_tiff(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_pnm(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_pfm(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_hdr(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_bmp(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_tga(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_gif(Bytes file, ImageFile& image);
[[nodiscard]] std::string read_psd(Bytes file, ImageFile& image);

// By kind_of(). Never more than 2 GiB.
[[nodiscard]] std::string read_bytes_as_image(Bytes file, ImageFile& image);

// What stb_image decodes of a file that was checked: the only call of it.
[[nodiscard]] std::string decode_stb(Bytes file, ImageFile& image);

// "libpng 1.6.39", or what reads the format instead.
[[nodiscard]] std::string png_decoder();
[[nodiscard]] std::string jpeg_decoder();
[[nodiscard]] std::string webp_decoder();
[[nodiscard]] std::string tiff_decoder();
[[nodiscard]] std::string stb_decoder();

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_READERS_HPP
