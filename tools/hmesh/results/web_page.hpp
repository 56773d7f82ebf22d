// tools - what an .html page shows beside the mesh: the file's name, figures, and the original to compare with.
//
// The original is the JPEG or PNG file as it was, less what is not its pixels (plain_file.hpp); the page turns photographs. What
// browsers do not read, or not alike, is encoded as PNG with 8 bits.
#ifndef HMESH_TOOLS_RESULTS_WEB_PAGE_HPP
#define HMESH_TOOLS_RESULTS_WEB_PAGE_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "hmesh/io/html.hpp"
#include "meshing.hpp"
#include "readers/image_file.hpp"
#include "results/report.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"
#include "writers/plain_file.hpp"

namespace tool {

struct WebPage {
    std::string title, figures, notes;
    std::vector<unsigned char> original;
    const char* original_type = "image/png";
    int original_orientation = 1;

    // Refers to this object.
    [[nodiscard]] hmesh::HtmlOptions options() const noexcept {
        hmesh::HtmlOptions options;
        options.title = title.c_str();
        options.figures = figures.c_str();
        options.notes = notes.c_str();
        options.original = original.data();
        options.original_size = original.size();
        options.original_type = original_type;
        options.original_orientation = original_orientation;
        return options;
    }
};

namespace detail {

[[nodiscard]] inline std::string file_name(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string::npos ? path : path.substr(slash + 1);
}

}  // namespace detail

// `bytes` are those of the input file. Without an original if there is no memory to encode one, or if none is wanted.
[[nodiscard]] inline WebPage make_web_page(const Arguments& arguments, const ImageFile& image,
                                           const std::vector<unsigned char>& bytes, const hmesh::Report& report) {
    WebPage page;
    page.title = is_standard(arguments.input) ? "standard input" : detail::file_name(arguments.input);
    page.figures = std::to_string(report.vertices) + " vertices\n" + std::to_string(report.faces) + " faces";
    if (has_pixels(image)) {
        page.figures += "\nPSNR " + psnr_text(report.psnr);
        page.notes = "PSNR = " + psnr_formula(arguments);
    }
    if (!arguments.original || !has_pixels(image)) return page;
    page.original_orientation = image.orientation;
    if (page.original = plain_png({bytes.data(), bytes.size()}); !page.original.empty()) return page;
    if (page.original = plain_jpeg({bytes.data(), bytes.size()}); !page.original.empty()) {
        page.original_type = "image/jpeg";
        return page;
    }
    page.original_orientation = 1;
    if (!write_png(to_picture(image), hmesh::kit::append_to(page.original))) page.original.clear();
    return page;
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WEB_PAGE_HPP
