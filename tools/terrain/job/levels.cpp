#include "terrain/job/levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "terrain/tile_maker.hpp"
#include "terrain/written/measure.hpp"

namespace terrain {
namespace {

class ThinnedDem : public Dem {
  public:
    ThinnedDem(Dem& dem, const Level& level) : dem_(dem), column_(level.column), row_(level.row), step_(level.step) {
        width = level.width;
        height = level.height;
        no_data = dem.no_data;
        reader = dem.reader;
        place = dem.place;
        auto& t = place.transform;
        t[0] += t[1] * column_ + t[2] * row_;
        t[3] += t[4] * column_ + t[5] * row_;
        for (std::size_t k = 0; k < t.size(); ++k)
            if (k % 3 != 0) t[k] *= step_;
    }

    [[nodiscard]] std::string read(int x, int y, int columns, int rows, float* heights, double& rounding) override {
        rounding = 0;
        const int wide = (columns - 1) * step_ + 1;
        samples_.resize(static_cast<std::size_t>(wide));
        for (int j = y; j < y + rows; ++j) {
            double most = 0;
            if (std::string why = dem_.read(column_ + x * step_, row_ + j * step_, wide, 1, samples_.data(), most); !why.empty())
                return why;
            rounding = std::max(rounding, most);
            for (int i = 0; i < columns; ++i)
                *heights++ = samples_[static_cast<std::size_t>(i) * static_cast<std::size_t>(step_)];
        }
        return {};
    }

  private:
    Dem& dem_;
    int column_, row_, step_;
    std::vector<float> samples_;  // a row between the outermost that are asked for
};

constexpr int up(int number, int step) noexcept { return (number + step - 1) / step; }

// Sets which tiles of Cesium's grid, of a zoom above that of the finest level, lie within the input.
void fit(const GlobeGrid& globe, const Level& finest, int cells, Level& level) {
    const int south = globe.north - finest.down + 1;
    const int west = up(globe.west, level.step), north = (globe.north + 1) / level.step - 1;
    level.across = (globe.west + finest.across) / level.step - west;
    level.down = north - up(south, level.step) + 1;
    level.column = (west * level.step - globe.west) * cells;
    level.row = (globe.north + 1 - (north + 1) * level.step) * cells;
    level.width = level.across * cells + 1;
    level.height = level.down * cells + 1;
}

// The frame of the level's samples in the numbers of the finest's: a step of 2^k times as much is exact, so that vertices of all
// levels on one line have one coordinate there.
Frame frame_of(const Frame& all, int width, int height, const Level& level) {
    Frame frame = all;
    frame.x_origin += frame.x_step * level.column;
    frame.y_origin -= frame.y_step * level.row;
    frame.x_step *= level.step;
    frame.y_step *= level.step;
    if (frame.extent)
        frame.extent =
            extent_of(all, width, height,
                      {{}, level.column, level.row, (level.width - 1) * level.step + 1, (level.height - 1) * level.step + 1, ""});
    return frame;
}

// How far samples are from the straight lines between every so manyth of them; those beside which there is no data are left out.
double off_lines(const std::vector<float>& samples, int step) {
    double most = 0;
    const auto at = [&](std::size_t k) { return static_cast<double>(samples[k]); };
    const auto stride = static_cast<std::size_t>(step);
    for (std::size_t first = 0; first + stride < samples.size(); first += stride)
        for (std::size_t k = 1; k < stride; ++k) {
            const double share = static_cast<double>(k) / step;
            const double off = std::fabs((1 - share) * at(first) + share * at(first + stride) - at(first + k));
            if (off > most) most = off;  // not where one is NaN
        }
    return most;
}

}  // namespace

std::vector<Level> find_levels(const Arguments& arguments, const Frame& frame, int width, int height,
                               const std::optional<GlobeGrid>& globe, int most) {
    std::vector<Level> levels;
    const int cells = arguments.tile;
    for (int k = 0; k < most; ++k) {
        Level level;
        level.step = 1 << k;
        level.width = (width - 1) / level.step + 1;
        level.height = (height - 1) / level.step + 1;
        level.across = tiles_along(level.width, cells);
        level.down = tiles_along(level.height, cells);
        if (globe && k > 0) fit(*globe, levels.front(), cells, level);
        if (level.across < 1 || level.down < 1 || (globe && k > globe->zoom)) break;
        level.arguments = arguments;
        if (level.arguments.max_error) *level.arguments.max_error *= level.step;
        if (level.arguments.border_tolerance) *level.arguments.border_tolerance *= level.step;
        level.frame = k == 0 ? frame : frame_of(frame, width, height, level);
        levels.push_back(std::move(level));
    }
    return levels;
}

std::unique_ptr<Dem> thinned(Dem& dem, const Level& level) { return std::make_unique<ThinnedDem>(dem, level); }

std::string measure_all(const Level& level, const Tile& tile, Surface surface, Dem& dem, double& max_error) {
    const int step = level.step, wide = (tile.width - 1) * step + 1, high = (tile.height - 1) * step + 1;
    for (double& x : surface.x) x *= step;
    for (double& y : surface.y) y *= step;
    // Metres are rounded alike whatever the step, 15 bits by so many of the level's samples.
    const double slack = slack_of(level.arguments, tile) * (level.arguments.format == Format::quantized_mesh ? step : 1);
    const int rows = std::max(1, tile.height / step);
    // And one more on each side: of a sample that rounding leaves beside the surface the cells around it say that it counts.
    std::vector<float> heights(static_cast<std::size_t>(wide) * static_cast<std::size_t>(rows + 2));
    max_error = 0;
    for (int row = 0, before = 0; row < high; row += rows) {
        const int first = std::max(0, row - 1), count = std::min(high, row + rows + 1) - first;
        for (double& y : surface.y) y -= first - before;
        before = first;
        double rounding = 0;
        if (std::string why = dem.read(level.column + tile.column * step, level.row + tile.row * step + first, wide, count,
                                       heights.data(), rounding);
            !why.empty())
            return why;
        const Measured found = measure(surface, {heights.data(), wide, count, 0}, slack);
        if (found.samples > 0) max_error = std::max(max_error, found.max_error + rounding);
    }
    return {};
}

std::string find_skirt(const std::vector<Level>& levels, int level, const Tile& tile, Dem& dem, double& depth) {
    const Level& own = levels[static_cast<std::size_t>(level)];
    const int coarsest = levels.back().step, cells = own.arguments.tile;
    const auto bound = [](const Level& of) {
        return of.arguments.max_error ? *of.arguments.max_error : of.arguments.border_tolerance.value_or(0);
    };
    // Of the input: the corners of the tile.
    const std::array<int, 2> first = {tile.column * own.step, tile.row * own.step},
                             last = {first[0] + (tile.width - 1) * own.step, first[1] + (tile.height - 1) * own.step};
    depth = 0;
    for (std::size_t along = 0; along < 2; ++along)
        for (const int line : {first[1 - along], last[1 - along]}) {
            // From a sample of the coarsest level to another one, as far as there are samples.
            const int begin = first[along] / coarsest * coarsest;
            const int end = std::min(up(last[along], coarsest) * coarsest, (along == 0 ? dem.width : dem.height) - 1);
            std::vector<float> samples(static_cast<std::size_t>(end - begin + 1));
            double rounding = 0;
            if (std::string why = along == 0 ? dem.read(begin, line, end - begin + 1, 1, samples.data(), rounding)
                                             : dem.read(line, begin, 1, end - begin + 1, samples.data(), rounding);
                !why.empty())
                return why;
            const double here = bound(own) + off_lines(samples, own.step);
            const auto has_side = [&](const Level& of) {  // where a level ends there may be tiles of finer ones beyond
                const int end_of = ((along == 0 ? of.height : of.width) - 1) * of.step;
                return line % (cells * of.step) == 0 || line == end_of;
            };
            for (const Level& other : levels)
                if (other.step != own.step && has_side(other))
                    depth = std::max(depth, here + bound(other) + off_lines(samples, other.step));
        }
    depth *= 1.001;  // floats round
    return {};
}

}  // namespace terrain
