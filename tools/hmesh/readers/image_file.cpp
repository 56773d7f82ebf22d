#include "readers/image_file.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "readers/readers.hpp"
#include "readers/rectangles.hpp"
#include "terminal/standard_streams.hpp"

namespace tool {
namespace {

constexpr std::size_t first_read = std::size_t{1} << 20U;

// What lies at a TIFF file's directory, which is usually its end; the place of reading stays. Empty where it cannot be reached.
std::vector<unsigned char> read_directory(std::FILE* file, Bytes beginning) {
    if (beginning.u8(2) == '+' || beginning.u8(3) == '+') return {};  // BigTIFF
    const std::uint32_t at = beginning.u8(0) == 'I' ? beginning.le32(4) : beginning.be32(4);
    std::vector<unsigned char> directory(std::size_t{1} << 16U);
    const auto here = std::ftell(file);
    if (here < 0 || at > INT_MAX || std::fseek(file, static_cast<int>(at), SEEK_SET) != 0) return {};
    directory.resize(std::fread(directory.data(), 1, directory.size(), file));
    return std::fseek(file, here, SEEK_SET) == 0 ? directory : std::vector<unsigned char>();
}

// Whether the picture that begins so is too large or none, which is known long before the file is read. Of the standard input
// nobody knows where it began, so that no place in it can be looked up.
std::string check_early(std::FILE* file, Bytes beginning) {
    const FileKind kind = kind_of(beginning);
    const bool is_whole = beginning.size < first_read;
    if (kind == FileKind::unknown && !is_mesh(beginning) && !is_whole) return not_known(beginning);
    if (kind != FileKind::tiff || is_whole) return check_beginning(beginning);
    if (file == stdin) return {};
    const std::vector<unsigned char> directory = read_directory(file, beginning);
    return check_tiff_directory({directory.data(), directory.size()}, beginning.u8(0) == 'I');
}

// `expected`: as many bytes as there may be, or 0. Memory that grows is touched several times over, which for a raw image takes
// up to a tenth of the time of a draft.
std::string read_bytes(std::FILE* file, std::size_t expected, std::vector<unsigned char>& bytes) {
    errno = 0;
    bytes.resize(first_read);
    std::size_t size = std::fread(bytes.data(), 1, first_read, file);
    if (std::string why = check_early(file, {bytes.data(), size}); !why.empty()) return why;
    while (size == bytes.size() && std::ferror(file) == 0 && size <= INT_MAX) {
        bytes.resize(size < expected ? expected + 1 : size + first_read + size / 2);
        size += std::fread(bytes.data() + size, 1, bytes.size() - size, file);
    }
    bytes.resize(size);
    if (std::ferror(file) != 0) return std::strerror(errno);
    if (size == 0) return file == stdin ? "it is empty" : "the file is empty";
    return size > INT_MAX ? "the file is larger than 2 GiB" : "";
}

}  // namespace

std::string read_file(const std::string& path, std::vector<unsigned char>& bytes) {
    if (is_standard(path)) {
        if (is_terminal(stdin)) return "it is a terminal, and no image";
        set_binary(stdin);
        return read_bytes(stdin, 0, bytes);
    }
    errno = 0;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return std::strerror(errno);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> owner(file, std::fclose);
    std::error_code unknown;
    const std::uintmax_t expected = std::filesystem::file_size(path, unknown);
    return read_bytes(file, unknown ? 0 : static_cast<std::size_t>(std::min<std::uintmax_t>(expected, INT_MAX)), bytes);
}

std::string read_image(const std::string& path, ImageFile& image, std::vector<unsigned char>& bytes) {
    if (std::string why = read_file(path, bytes); !why.empty()) return why;
    return read_bytes_as_image({bytes.data(), bytes.size()}, image);
}

std::string read_image(const std::string& path, ImageFile& image) {
    std::vector<unsigned char> bytes;
    return read_image(path, image, bytes);
}

std::string find_not_finite(const ImageFile& image) {
    const auto& samples = image.samples32;
    const auto found = std::find_if(samples.begin(), samples.end(), [](float sample) { return !std::isfinite(sample); });
    if (found == samples.end()) return {};
    return "a sample that is NaN or infinite, in row " + std::to_string((found - samples.begin()) / image.channels / image.width);
}

std::string formats_read() {
    return std::string("PNG, JPEG, ") + (webp_decoder().empty() ? "" : "WebP, ") + (tiff_decoder().empty() ? "" : "TIFF, ") +
           "BMP, TGA, GIF, PSD, PGM, PPM, PFM or HDR";
}

std::string decoders() {
    const auto line = [](const char* formats, const std::string& decoder) {
        return decoder.empty() ? std::string() : std::string("  ") + formats + ": " + decoder + "\n";
    };
    return line("PNG", png_decoder()) + line("JPEG", jpeg_decoder()) + line("WebP", webp_decoder()) +
           line("TIFF", tiff_decoder()) + line("BMP, TGA, GIF", stb_decoder()) + line("PSD, PGM, PPM, PFM, HDR", "hmesh") +
           line("others, by rectangles", rectangle_decoder());
}

}  // namespace tool
