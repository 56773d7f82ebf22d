// tools - image files that are read by rectangles, and never as a whole: binary PGM and PPM, and PFM, whose samples lie in the
// file as they are, TIFF (tiff.cpp), and what GDAL reads (gdal.cpp). Any size that hmesh::ImageReader takes.
#ifndef HMESH_TOOLS_READERS_RECTANGLES_HPP
#define HMESH_TOOLS_READERS_RECTANGLES_HPP

#include <cstddef>
#include <string>

#include "hmesh/image/image_view.hpp"

namespace tool {

struct ImageFile;

class RectangleFile {
  public:
    RectangleFile() = default;
    RectangleFile(const RectangleFile&) = delete;
    RectangleFile& operator=(const RectangleFile&) = delete;
    virtual ~RectangleFile() = default;

    // Fills a rectangle with samples of the image's type and channels, rows row_stride bytes apart, on any thread. False: it
    // could not.
    virtual bool read(const hmesh::kit::Rect& rect, void* samples, std::ptrdiff_t row_stride) = 0;
    // Why not, as the end of a sentence that begins with the file's name. Not while others read.
    [[nodiscard]] virtual std::string why() const = 0;
};

// Opens the file: `image` gets all but the samples, and `image.rectangles`. Returns "" or what is wrong, as the end of a sentence
// that begins with the file's name.
[[nodiscard]] std::string open_rectangles(const std::string& path, ImageFile& image);
[[nodiscard]] std::string open_tiff_rectangles(const std::string& path, ImageFile& image);  // where it is one
[[nodiscard]] std::string open_gdal_rectangles(const std::string& path, ImageFile& image);  // of what hmesh does not know

// "GDAL 3.6.2"; empty: this build has none.
[[nodiscard]] std::string rectangle_decoder();

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_RECTANGLES_HPP
