#include "tiles/tile_image.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>

#include "hmesh/methods/annealed/border.hpp"
#include "readers/rectangles.hpp"

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
template <int C>
void count_side(const ImageFile& tile, std::size_t length, const std::function<std::size_t(std::size_t)>& pixel_at,
                const std::vector<double>& tolerances, std::size_t side, std::vector<SideCounts>& counts) {
    hmesh::kit::Array<std::array<double, std::size_t{C}>> row(length);
    for (std::size_t k = 0; k < length; ++k)
        for (std::size_t c = 0; c < C; ++c) row[k][c] = sample_at(tile, C * pixel_at(k) + c);
    for (std::size_t t = 0; t < tolerances.size(); ++t)
        counts[t][side] = hmesh::kit::polyline_nodes<C>(row, tolerances[t]).size();
}

template <int C>
std::vector<SideCounts> count_sides(const ImageFile& tile, const std::vector<double>& tolerances) {
    std::vector<SideCounts> counts(tolerances.size());
    const auto width = static_cast<std::size_t>(tile.width), height = static_cast<std::size_t>(tile.height);
    const auto count = [&](std::size_t side, std::size_t length, const std::function<std::size_t(std::size_t)>& pixel_at) {
        count_side<C>(tile, length, pixel_at, tolerances, side, counts);
    };
    count(0, width, [](std::size_t k) { return k; });
    count(1, width, [&](std::size_t k) { return (height - 1) * width + k; });
    count(2, height, [&](std::size_t k) { return k * width; });
    count(3, height, [&](std::size_t k) { return k * width + width - 1; });
    return counts;
}

void make_samples(ImageFile& image) {
    const std::size_t count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * static_cast<std::size_t>(image.channels);
    if (image.bits == 8) image.samples8.resize(count);
    else if (image.bits == 16) image.samples16.resize(count);
    else image.samples32.resize(count);
}

template <class T>
double halve(const T* from, int width, int channels, int half_width, int half_height, T* to) {
    const auto across = static_cast<std::size_t>(channels), down = static_cast<std::size_t>(width) * across;
    double left_out = 0;
    for (int y = 0; y < half_height; ++y)
        for (int x = 0; x < half_width; ++x)
            for (std::size_t c = 0; c < across; ++c) {
                const T* const at = from + 2 * static_cast<std::size_t>(y) * down + 2 * static_cast<std::size_t>(x) * across + c;
                const std::array<double, 4> four = {static_cast<double>(at[0]), static_cast<double>(at[across]),
                                                    static_cast<double>(at[down]), static_cast<double>(at[down + across])};
                const double mean = (four[0] + four[1] + four[2] + four[3]) / 4;
                for (const double value : four) left_out += (value - mean) * (value - mean);
                *to++ = static_cast<T>(std::is_integral_v<T> ? mean + 0.5 : mean);
            }
    return left_out;
}

}  // namespace

double halve(const ImageFile& tile, ImageFile& half) {
    half = {};
    half.width = tile.width / 2;
    half.height = tile.height / 2;
    half.channels = tile.channels;
    half.bits = tile.bits;
    make_samples(half);
    const auto of = [&](const auto& from, auto& to) {
        return halve(from.data(), tile.width, tile.channels, half.width, half.height, to.data());
    };
    return tile.bits == 8    ? of(tile.samples8, half.samples8)
           : tile.bits == 16 ? of(tile.samples16, half.samples16)
                             : of(tile.samples32, half.samples32);
}

std::string TileImage::open(const std::string& path) {
    file_ = {};
    if (open_rectangles(path, file_).empty()) return {};
    return read_image(path, file_);  // says what is wrong with a file of any format
}

std::string TileImage::read(const hmesh::kit::Rect& rect, ImageFile& tile) const {
    tile = {};
    tile.width = rect.width;
    tile.height = rect.height;
    tile.channels = file_.channels;
    tile.bits = file_.bits;
    make_samples(tile);
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

std::vector<SideCounts> count_side_vertices(const ImageFile& tile, const std::vector<double>& tolerances) {
    switch (tile.channels) {
        case 1: return count_sides<1>(tile, tolerances);
        case 2: return count_sides<2>(tile, tolerances);
        case 3: return count_sides<3>(tile, tolerances);
        default: return count_sides<4>(tile, tolerances);
    }
}

double peak_of(const ImageFile& image) noexcept { return image.bits == 8 ? 255 : image.bits == 16 ? 65535 : 1; }

}  // namespace tool
