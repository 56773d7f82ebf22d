// Files without a header, whose size the command line says: little-endian, the first row in the north.
#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {

std::string open_raw(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    auto grid = std::make_unique<GridFile>();
    if (std::string why = grid->open(path); !why.empty()) return why;
    grid->width = options.raw_width;
    grid->height = options.raw_height;
    grid->no_data = options.no_data;
    const std::int64_t samples = static_cast<std::int64_t>(grid->width) * grid->height;
    const auto is = [&](RawType type, std::int64_t bytes) {
        return (options.raw_type == type || options.raw_type == RawType::by_size) && grid->size() == bytes * samples;
    };
    if (is(RawType::float32, 4)) grid->type = SampleType::f32_little;
    else if (is(RawType::int16, 2)) grid->type = SampleType::i16_little;
    else if (is(RawType::uint16, 2)) grid->type = SampleType::u16_little;
    else
        return "it has " + std::to_string(grid->size()) + " bytes, and " + std::to_string(grid->width) + " x " +
               std::to_string(grid->height) + " samples are " + std::to_string(4 * samples) + " as float32 and " +
               std::to_string(2 * samples) + " as int16 or uint16";
    if (std::string why = grid->check(); !why.empty()) return why;
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
