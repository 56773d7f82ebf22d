#include "tiles/tile_image.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <type_traits>
#include <utility>

#include "hmesh/methods/annealed/polyline.hpp"
#include "readers/rectangles.hpp"
#include "terminal/progress_watch.hpp"

namespace tool {
namespace {

std::size_t bytes_of_pixel(const ImageFile& image) {
    return static_cast<std::size_t>(image.channels) * static_cast<std::size_t>(image.bits) / 8;
}

void* samples_of(ImageFile& image) {
    return image.bits == 8    ? static_cast<void*>(image.samples8.data())
           : image.bits == 16 ? static_cast<void*>(image.samples16.data())
                              : static_cast<void*>(image.samples32.data());
}
const void* samples_of(const ImageFile& image) {
    return image.bits == 8    ? static_cast<const void*>(image.samples8.data())
           : image.bits == 16 ? static_cast<const void*>(image.samples16.data())
                              : static_cast<const void*>(image.samples32.data());
}

// A number of the image, by its place among all.
double sample_at(const ImageFile& image, std::size_t k) {
    return image.bits == 8 ? image.samples8[k] : image.bits == 16 ? image.samples16[k] : static_cast<double>(image.samples32[k]);
}

// The counts of one side, whose pixel k is pixel_at(k) of the tile, 0 <= k < length.
void count_side(const ImageFile& tile, std::size_t length, const std::function<std::size_t(std::size_t)>& pixel_at,
                const std::vector<double>& tolerances, std::size_t side, std::vector<SideCounts>& counts) {
    const auto channels = static_cast<std::size_t>(tile.channels);
    hmesh::kit::Array<double> row;
    for (std::size_t k = 0; k < length; ++k)
        for (std::size_t c = 0; c < channels; ++c) row.push_back(sample_at(tile, channels * pixel_at(k) + c));
    hmesh::kit::PolylineFinder finder(std::move(row), channels);
    for (std::size_t t = 0; t < tolerances.size(); ++t) counts[t][side] = finder.nodes(tolerances[t]).size();
}

// Calls body(from, to) with the samples of two images of one kind.
template <class Body>
auto with_samples(const ImageFile& from, ImageFile& to, Body&& body) {
    return from.bits == 8    ? body(from.samples8, to.samples8)
           : from.bits == 16 ? body(from.samples16, to.samples16)
                             : body(from.samples32, to.samples32);
}

// Makes an image of the kind of another, whose samples are to be set.
void make_like(const ImageFile& other, int width, int height, ImageFile& image) {
    image = {};
    image.width = width;
    image.height = height;
    image.channels = other.channels;
    image.bits = other.bits;
    const std::size_t count =
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(image.channels);
    with_samples(other, image, [&](const auto& /*from*/, auto& to) { to.resize(count); });
}

// The four pixels that become one, of a channel: those above and those below.
template <class T>
std::array<double, 4> four_of(const T* above, std::ptrdiff_t across, std::ptrdiff_t down) {
    return {static_cast<double>(above[0]), static_cast<double>(above[across]), static_cast<double>(above[down]),
            static_cast<double>(above[down + across])};
}

template <class T>
double halve(const T* from, int width, int channels, int half_width, int half_height, T* to) {
    const std::ptrdiff_t across = channels, down = across * width, row = across * half_width;
    const auto each = [&](auto&& body) {
        for (int y = 0; y < half_height; ++y)
            for (int x = 0; x < half_width; ++x)
                for (std::ptrdiff_t c = 0; c < across; ++c)
                    body(x, y, four_of(from + 2 * (y * down + x * across) + c, across, down), to + y * row + x * across + c);
    };
    each([](int, int, const std::array<double, 4>& four, T* half) {
        const double mean = (four[0] + four[1] + four[2] + four[3]) / 4;
        *half = static_cast<T>(std::is_integral_v<T> ? mean + 0.5 : mean);
    });
    double left_out = 0;
    each([&](int x, int y, const std::array<double, 4>& four, const T* half) {
        const auto slope = [&](std::ptrdiff_t step, bool has_before, bool has_after) {  // of half a pixel of the image
            return (static_cast<double>(half[has_after ? step : 0]) - static_cast<double>(half[has_before ? -step : 0])) / 8;
        };
        const double right = slope(across, x > 0, x + 1 < half_width), up = slope(row, y > 0, y + 1 < half_height);
        const double mean = (four[0] + four[1] + four[2] + four[3]) / 4;
        const std::array<double, 4> sloped = {mean - right - up, mean + right - up, mean - right + up, mean + right + up};
        double of_mean = 0, of_slopes = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            of_mean += (four[k] - mean) * (four[k] - mean);
            of_slopes += (four[k] - sloped[k]) * (four[k] - sloped[k]);
        }
        left_out += std::min(of_mean, of_slopes);
    });
    return left_out;
}

// The mean of the square around a pixel, for a sample of a level. A square ends in the middle of pixels, hence halves of the
// outermost and quarters of the corners.
template <class T>
class SquareMean {
  public:
    // Of `step` pixels a side in an image of `width` x `height`, of which `pixels` has the rectangle `known`.
    SquareMean(const T* pixels, const hmesh::kit::Rect& known, int width, int height, int channels, int step)
        : pixels_(pixels), known_(known), width_(width), height_(height), channels_(channels), step_(step) {}

    // Of pixel (x, y) of the image.
    void take(int x, int y, T* sample) const {
        const int half = step_ / 2;
        const auto has_alpha = hmesh::kit::has_alpha(channels_);
        std::array<double, 4> sums{}, plain{};
        double area = 0, alpha = 0;
        for (int j = std::max(0, y - half); j <= std::min(height_ - 1, y + half); ++j)
            for (int i = std::max(0, x - half); i <= std::min(width_ - 1, x + half); ++i) {
                const double part = (std::abs(i - x) == half ? 0.5 : 1) * (std::abs(j - y) == half ? 0.5 : 1);
                const T* const at = pixels_ + channels_ * ((j - known_.y) * std::ptrdiff_t{known_.width} + (i - known_.x));
                const double weight = has_alpha ? part * static_cast<double>(at[channels_ - 1]) : part;
                for (std::size_t c = 0; c < static_cast<std::size_t>(channels_); ++c) {
                    plain[c] += part * static_cast<double>(at[c]);
                    sums[c] += weight * static_cast<double>(at[c]);
                }
                area += part;
                alpha += weight;
            }
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels_); ++c) {
            const bool is_color = has_alpha && c + 1 < static_cast<std::size_t>(channels_);
            const double mean = is_color && alpha > 0 ? sums[c] / alpha : plain[c] / area;
            sample[c] = static_cast<T>(std::is_integral_v<T> ? mean + 0.5 : mean);
        }
    }

  private:
    const T* pixels_;
    hmesh::kit::Rect known_;
    int width_, height_, channels_, step_;
};

}  // namespace

double halve(const ImageFile& tile, ImageFile& half) {
    make_like(tile, tile.width / 2, tile.height / 2, half);
    return with_samples(tile, half, [&](const auto& from, auto& to) {
        return halve(from.data(), tile.width, tile.channels, half.width, half.height, to.data());
    });
}

std::string TileImage::open(const std::string& path) {
    file_ = {};
    if (open_rectangles(path, file_).empty()) return {};
    return read_image(path, file_);  // says what is wrong with a file of any format
}

std::string TileImage::read(const hmesh::kit::Rect& rect, ImageFile& tile) const {
    make_like(file_, rect.width, rect.height, tile);
    const std::size_t pixel = bytes_of_pixel(tile), row = pixel * static_cast<std::size_t>(rect.width);
    if (file_.rectangles)
        return file_.rectangles->read(rect, samples_of(tile), static_cast<std::ptrdiff_t>(row)) ? "" : file_.rectangles->why();
    const auto* const from = static_cast<const unsigned char*>(samples_of(file_));
    auto* const to = static_cast<unsigned char*>(samples_of(tile));
    for (int y = 0; y < rect.height; ++y) {
        const std::size_t first = static_cast<std::size_t>(rect.y + y) * static_cast<std::size_t>(file_.width);
        std::memcpy(to + static_cast<std::size_t>(y) * row, from + (first + static_cast<std::size_t>(rect.x)) * pixel, row);
    }
    return {};
}

std::string TileImage::read(const hmesh::kit::Rect& rect, int step, ImageFile& tile) const {
    if (step == 1) return read(rect, tile);
    make_like(file_, rect.width, rect.height, tile);
    // Parts of the tile that are made of 8192 x 256 px each, or of what one sample is made of: files are read by rows.
    const int columns = std::max(1, 8192 / step), rows = std::max(1, 256 / step);
    for (int y = 0; y < rect.height; y += rows)
        for (int x = 0; x < rect.width; x += columns) {
            if (interrupted) return "interrupted";
            const hmesh::kit::Rect part{x, y, std::min(columns, rect.width - x), std::min(rows, rect.height - y)};
            if (std::string why = read_part(rect, part, step, tile); !why.empty()) return why;
        }
    return {};
}

std::string TileImage::read_part(const hmesh::kit::Rect& rect, const hmesh::kit::Rect& part, int step, ImageFile& tile) const {
    const int half = step / 2, x = rect.x + part.x, y = rect.y + part.y;
    const int left = std::max(0, x * step - half), right = std::min(file_.width - 1, (x + part.width - 1) * step + half);
    const int top = std::max(0, y * step - half), bottom = std::min(file_.height - 1, (y + part.height - 1) * step + half);
    const hmesh::kit::Rect known{left, top, right - left + 1, bottom - top + 1};
    ImageFile pixels;
    if (std::string why = read(known, pixels); !why.empty()) return why;
    with_samples(pixels, tile, [&](const auto& from, auto& to) {
        const SquareMean mean(from.data(), known, file_.width, file_.height, file_.channels, step);
        for (int j = 0; j < part.height; ++j) {
            const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(part.y + j) * tile.width + part.x;
            for (int i = 0; i < part.width; ++i)
                mean.take((x + i) * step, (y + j) * step, to.data() + tile.channels * (first + i));
        }
    });
    return {};
}

std::vector<SideCounts> count_side_vertices(const ImageFile& tile, const std::vector<double>& tolerances) {
    std::vector<SideCounts> counts(tolerances.size());
    const auto width = static_cast<std::size_t>(tile.width), height = static_cast<std::size_t>(tile.height);
    const auto count = [&](std::size_t side, std::size_t length, const std::function<std::size_t(std::size_t)>& pixel_at) {
        count_side(tile, length, pixel_at, tolerances, side, counts);
    };
    count(0, width, [](std::size_t k) { return k; });
    count(1, width, [&](std::size_t k) { return (height - 1) * width + k; });
    count(2, height, [&](std::size_t k) { return k * width; });
    count(3, height, [&](std::size_t k) { return k * width + width - 1; });
    return counts;
}

double peak_of(const ImageFile& image) noexcept { return image.bits == 8 ? 255 : image.bits == 16 ? 65535 : 1; }

}  // namespace tool
