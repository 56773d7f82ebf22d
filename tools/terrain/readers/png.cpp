// PNG files of one channel, up to 16 bits.
#include <cstdint>
#include <limits>
#include <vector>

#include "readers/bytes.hpp"
#include "readers/image_file.hpp"
#include "readers/readers.hpp"
#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/grid_memory.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {

std::string open_png(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    tool::ImageFile image;
    std::vector<unsigned char> bytes;
    if (std::string why = tool::read_image(path, image, bytes); !why.empty()) return why;
    const tool::Bytes file{bytes.data(), bytes.size()};
    if (file.u8(25) == 3) return no_palette;
    if (image.channels != 1) return "it has " + std::to_string(image.channels) + " channels, and heights are one";
    // Pictures are turned upright and stretched to 8 bits: heights are as the file has them.
    const int way = image.orientation;
    tool::turn_upright(static_cast<unsigned>(way == 6 ? 8 : way == 8 ? 6 : way), image);
    const std::uint32_t depth = file.u8(24);
    const int stretch = depth < 8 ? 255 / ((1 << depth) - 1) : 1;
    auto grid = std::make_unique<GridMemory>();
    grid->width = image.width;
    grid->height = image.height;
    grid->reader = "hmesh";
    grid->no_data = options.no_data;
    const auto take = [&](const auto& samples) {
        grid->heights.reserve(samples.size());
        for (const auto sample : samples) {
            const float height = static_cast<float>(sample) / static_cast<float>(stretch);
            const bool is_none = is_no_data(static_cast<double>(height), options.no_data);
            grid->heights.push_back(is_none ? std::numeric_limits<float>::quiet_NaN() : height);
        }
    };
    if (image.bits == 8) take(image.samples8);
    else if (image.bits == 16) take(image.samples16);
    else take(image.samples32);
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
