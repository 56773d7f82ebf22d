// .hgt files of the Shuttle Radar Topography Mission: a square of big-endian 16-bit metres, -32768 where there are none, points
// of a degree from edge to edge, named after the south-western one: N45E006.hgt.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {
namespace {

// The digits at `at`, -1 where there are not so many.
int digits(const std::string& text, std::size_t at, std::size_t count) {
    int value = 0;
    for (std::size_t k = at; k < at + count; ++k) {
        if (k >= text.size() || text[k] < '0' || text[k] > '9') return -1;
        value = 10 * value + (text[k] - '0');
    }
    return value;
}

bool is_one_of(char c, char a, char b) { return (c | 32) == a || (c | 32) == b; }

// South and west of what is called N45E006, in degrees.
bool find_corner(const std::string& name, int& south, int& west) {
    if (name.size() < 7 || !is_one_of(name[0], 'n', 's') || !is_one_of(name[3], 'e', 'w')) return false;
    south = digits(name, 1, 2);
    west = digits(name, 4, 3);
    if (south < 0 || south > 90 || west < 0 || west > 180) return false;
    if ((name[0] | 32) == 's') south = -south;
    if ((name[3] | 32) == 'w') west = -west;
    return true;
}

}  // namespace

std::string open_hgt(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    auto grid = std::make_unique<GridFile>();
    if (std::string why = grid->open(path); !why.empty()) return why;
    const auto side = static_cast<std::int64_t>(std::llround(std::sqrt(static_cast<double>(grid->size()) / 2)));
    if (side < 2 || side > 65536 || 2 * side * side != grid->size())
        return "its " + std::to_string(grid->size()) +
               " bytes are no square of 16-bit samples, as an .hgt file is: 25934402 or 2884802";
    grid->width = grid->height = static_cast<int>(side);
    grid->type = SampleType::i16_big;
    grid->no_data = options.no_data ? options.no_data : std::optional<double>(-32768);
    int south = 0, west = 0;
    if (find_corner(std::filesystem::path(path).filename().string(), south, west)) {
        const double step = 1.0 / static_cast<double>(side - 1);
        grid->place.is_known = grid->place.is_geographic = true;
        grid->place.transform = {static_cast<double>(west), step, 0, south + 1.0, 0, -step};
        grid->place.crs = wgs84;
    }
    dem = std::move(grid);
    return {};
}

}  // namespace terrain
