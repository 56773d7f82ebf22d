// tools - what an .html page shows beside the mesh: the file's name, figures, and the original to compare with.
//
// The original is the file itself where browsers read it and show its pixels as they are stored: PNG and JPEG, unless the
// picture is to be turned or holds CMYK. Else it is encoded as PNG with 8 bits.
#ifndef HMESH_TOOLS_WEB_PAGE_HPP
#define HMESH_TOOLS_WEB_PAGE_HPP

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/io/html.hpp"
#include "image_file.hpp"
#include "meshing.hpp"
#include "pictures.hpp"
#include "report.hpp"
#include "words.hpp"

namespace tool {

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

[[nodiscard]] inline std::string file_name(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string::npos ? path : path.substr(slash + 1);
}

}  // namespace detail

// `bytes` are those of the input file. Without an original if there is no memory to encode one.
[[nodiscard]] inline WebPage make_web_page(const Arguments& arguments, const ImageFile& image, std::vector<unsigned char>&& bytes,
                                           const hmesh::Report& report) {
    WebPage page;
    page.title = detail::file_name(arguments.input);
    page.figures = std::to_string(report.vertices) + " vertices\n" + std::to_string(report.faces) + " faces\nPSNR " +
                   psnr_text(report.psnr) + "\n(" + psnr_formula(arguments) + ")";
    if (!image.media_type.empty()) {
        page.original_type = image.media_type == "image/png" ? "image/png" : "image/jpeg";
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

}  // namespace tool

#endif  // HMESH_TOOLS_WEB_PAGE_HPP
