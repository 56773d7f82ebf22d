// examples - what an .html page shows beside the mesh: the file's name, figures, and the original to compare with.
//
// The original is the file itself where browsers read it and show what stb_image read: PNG, and JPEG unless its Exif tags
// say that it is to be turned. Else it is encoded as PNG with 8 bits.
#ifndef HMESH_EXAMPLES_WEB_PAGE_HPP
#define HMESH_EXAMPLES_WEB_PAGE_HPP

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/io/html.hpp"
#include "image_file.hpp"
#include "meshing.hpp"
#include "pictures.hpp"
#include "report.hpp"

namespace example {

struct WebPage {
    std::string title, figures;
    std::vector<unsigned char> original;
    const char* original_type = "image/png";

    // Refers to this object.
    [[nodiscard]] hmesh::HtmlOptions options() const noexcept {
        hmesh::HtmlOptions options;
        options.title = title.c_str();
        options.figures = figures.c_str();
        options.original = original.data();
        options.original_size = original.size();
        options.original_type = original_type;
        return options;
    }
};

namespace detail {

[[nodiscard]] inline bool is_png(const std::vector<unsigned char>& bytes) noexcept {
    return bytes.size() > 8 && std::memcmp(bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0;
}

[[nodiscard]] inline bool is_jpeg(const std::vector<unsigned char>& bytes) noexcept {
    return bytes.size() > 3 && std::memcmp(bytes.data(), "\xff\xd8\xff", 3) == 0;
}

// The Orientation (274) of a JPEG file's Exif segment, 1 to 8; 1, which is upright, without one. Exif 2.32, 4.5 and 4.6.
[[nodiscard]] inline unsigned orientation(const std::vector<unsigned char>& bytes) noexcept {
    const auto number = [&](std::size_t at, std::size_t size, bool little) {
        unsigned value = 0;
        for (std::size_t k = 0; k < size && at + size <= bytes.size(); ++k)
            value = value << 8U | bytes[little ? at + size - 1 - k : at + k];
        return value;
    };
    for (std::size_t at = 2; at + 18 < bytes.size() && bytes[at] == 0xff && bytes[at + 1] != 0xda;
         at += 2 + std::max(2U, number(at + 2, 2, false))) {
        if (bytes[at + 1] != 0xe1 || std::memcmp(bytes.data() + at + 4, "Exif\0\0", 6) != 0) continue;
        const std::size_t tiff = at + 10;
        const bool little = bytes[tiff] == 'I';
        const std::size_t table = tiff + number(tiff + 4, 4, little);
        for (std::size_t entry = 0; entry < number(table, 2, little); ++entry)
            if (number(table + 2 + 12 * entry, 2, little) == 274) return number(table + 10 + 12 * entry, 2, little);
    }
    return 1;
}

[[nodiscard]] inline std::string file_name(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string::npos ? path : path.substr(slash + 1);
}

}  // namespace detail

// `bytes` are those of the input file. Without an original if there is no memory to encode one.
[[nodiscard]] inline WebPage make_web_page(const std::string& input, const ImageFile& image, std::vector<unsigned char>&& bytes,
                                           const hmesh::Report& report, bool is_weighted) {
    WebPage page;
    page.title = detail::file_name(input);
    page.figures = std::to_string(report.vertices) + " vertices\n" + std::to_string(report.faces) + " faces\nPSNR " +
                   psnr_text(report.psnr) + "\n(" + (is_weighted ? weighted_psnr_formula : psnr_formula) + ")";
    if (detail::is_png(bytes) || (detail::is_jpeg(bytes) && detail::orientation(bytes) == 1)) {
        page.original_type = detail::is_png(bytes) ? "image/png" : "image/jpeg";
        page.original = std::move(bytes);
        return page;
    }
    const auto keep = [&](const void* from, std::size_t size) {
        const auto* first = static_cast<const unsigned char*>(from);
        page.original.insert(page.original.end(), first, first + size);
        return true;
    };
    if (!write_png(to_picture(image), keep)) page.original.clear();
    return page;
}

}  // namespace example

#endif  // HMESH_EXAMPLES_WEB_PAGE_HPP
