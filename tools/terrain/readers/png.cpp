// PNG files of one channel, 8 or 16 bits.
#include <limits>

#include "readers/image_file.hpp"
#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/grid_memory.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {

std::string open_png(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    tool::ImageFile image;
    if (std::string why = tool::read_image(path, image); !why.empty()) return why;
    if (image.channels != 1) return "it has " + std::to_string(image.channels) + " channels, and heights are one";
    auto grid = std::make_unique<GridMemory>();
    grid->width = image.width;
    grid->height = image.height;
    grid->reader = "hmesh";
    grid->no_data = options.no_data;
    const auto take = [&](const auto& samples) {
        grid->heights.reserve(samples.size());
        for (const auto height : samples)
            grid->heights.push_back(is_no_data(static_cast<double>(height), options.no_data)
                                        ? std::numeric_limits<float>::quiet_NaN()
                                        : static_cast<float>(height));
    };
    if (image.bits == 8) take(image.samples8);
    else if (image.bits == 16) take(image.samples16);
    else take(image.samples32);
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
