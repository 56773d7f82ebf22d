/// \file
/// Sides: the polyline that the border of a tile is, chosen from the samples along it alone.
///
/// With heights that are samples a side is split at its own worst sample until all are within the bound (D. Douglas and
/// T. Peucker, "Algorithms for the reduction of the number of points required to represent a digitized line or its caricature",
/// 1973), in O(n log n) for most rows. With free heights it has few vertices, at samples with heights of 9 levels
/// around them, by dynamic programming: some 0.7 of these, in O(9^2 n m) for edges of at most m samples. Either way
/// whatever is beside the side counts for nothing: so two tiles that share a row of samples get the same border, meshed apart.
#ifndef HMESH_METHODS_BOUNDED_SIDE_HPP
#define HMESH_METHODS_BOUNDED_SIDE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/methods/bounded/face_error.hpp"
#include "hmesh/methods/bounded/height_field.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A straight line across the image at a whole coordinate: column `at` where `is_upright`, else row, from `begin` to `end`, all
/// in px of the plane.
struct SideLine {
    bool is_upright;  ///< along a column
    int at;           ///< column or row
    int begin,        ///< from here
        end;          ///< to here, > begin
};

/// The share of its limit that a border keeps back: what is within the rest stays so when others round otherwise.
inline constexpr double border_margin = 1e-6;

namespace detail {

/// A height field along a line: what stands where.
struct Profile {
    Array<double> place;           ///< px along the line, rising
    Array<float> heights;          ///< `channels` for each place
    Array<float> chosen;           ///< those that a vertex there would have: the same, or near
    Array<std::uint8_t> has_data;  ///< for each place
    std::size_t channels;          ///< 1 to 4

    /// The largest difference between places i and k of the chord from there to there, and where.
    struct Worst {
        double error;
        std::size_t place;
    };
    [[nodiscard]] Worst worst(std::size_t i, std::size_t k) const noexcept {
        Worst most{0, i};
        const double length = place[k] - place[i];
        for (std::size_t m = i + 1; m < k; ++m)
            for (std::size_t c = 0; c < channels; ++c) {
                const auto from = static_cast<double>(chosen[i * channels + c]);
                const double rise = static_cast<double>(chosen[k * channels + c]) - from;
                const double here = static_cast<double>(heights[m * channels + c]) - from;
                const double error = std::abs((place[m] - place[i]) * rise - length * here) / length;
                if (error > most.error) most = {error, m};
            }
        return most;
    }
};

/// The mean of the samples with data at columns [i0, i1] and rows [j0, j1] that the image has; false where there is none.
[[nodiscard]] inline bool mean_height(const HeightField& field, int i0, int i1, int j0, int j1, float* heights) {
    double sum[max_bounded_channels] = {}, count = 0;
    for (int j = std::max(0, j0); j <= std::min(field.height - 1, j1); ++j)
        for (int i = std::max(0, i0); i <= std::min(field.width - 1, i1); ++i) {
            if (!field.has_data(i, j)) continue;
            ++count;
            for (int c = 0; c < field.channels; ++c) sum[c] += static_cast<double>(field.row(c, j)[i]);
        }
    for (int c = 0; c < field.channels; ++c) heights[c] = count > 0 ? static_cast<float>(sum[c] / count) : 0.0F;
    return count > 0;
}

/// Whether cells of data begin or end at place k of a line, on one side of it.
[[nodiscard]] inline bool cells_change(const HeightField& field, const SideLine& line, int k) noexcept {
    const auto cell = [&](int at, int along) { return line.is_upright ? field.is_cell(at, along) : field.is_cell(along, at); };
    return cell(line.at - 1, k - 1) != cell(line.at - 1, k) || cell(line.at, k - 1) != cell(line.at, k);
}

/// What stands along a line: for points the samples on it; for squares at the middle of each px the mean of the samples on both
/// sides, and at the ends, and where cells of data begin or end, that of the four around.
[[nodiscard]] HMESH_COLD inline Profile profile(const HeightField& field, const SideLine& line) {
    Profile out;
    out.channels = static_cast<std::size_t>(field.channels);
    const bool squares = field.samples == Samples::squares;
    const auto add = [&](double place, int first, int last) {
        float heights[max_bounded_channels];
        const int before = squares ? line.at - 1 : line.at;
        const bool has_data = line.is_upright ? mean_height(field, before, line.at, first, last, heights)
                                              : mean_height(field, first, last, before, line.at, heights);
        out.place.push_back(place);
        out.heights.insert(out.heights.end(), heights, heights + field.channels);
        out.has_data.push_back(has_data ? 1 : 0);
    };
    for (int k = line.begin; k <= line.end; ++k) {
        const bool is_end = k == line.begin || k == line.end;
        if (squares && (is_end || (!field.data.empty() && cells_change(field, line, k)))) add(k, k - 1, k);
        if (!squares || k < line.end) add(k + field.offset(), k, k);
    }
    out.chosen = out.heights;
    return out;
}

/// Chooses few vertices from place `first` to `last` of a profile of one channel, and their heights, so that all is within
/// `limit` > 0: marks them in `keep`. Both ends keep their heights. A vertex that is off by the whole limit counts as three: what
/// is beside the side would pay for it.
HMESH_COLD inline void choose_fewest(Profile& profile, std::size_t first, std::size_t last, double limit,
                                     Array<std::uint8_t>& keep) {
    constexpr int middle = 4, levels = 2 * middle + 1;
    constexpr std::uint32_t none = 0xffffffffU;
    struct State {
        float links = 1e30F;  // edges up to here, and twice the squares of what heights are off, in bounds
        std::uint32_t from = none;
    };
    const std::size_t n = last - first + 1;
    Array<State> states(n * levels);
    const double step = limit * 0.999 / middle;
    const auto sample = [&](std::size_t k) { return static_cast<double>(profile.heights[first + k]); };
    const auto at = [&](std::size_t k, int level) { return k * levels + static_cast<std::size_t>(level); };
    Array<float> heights(n * levels);
    for (std::size_t k = 0; k < n; ++k)
        for (int level = 0; level < levels; ++level)
            heights[at(k, level)] = static_cast<float>(sample(k) + step * (level - middle));
    states[at(0, middle)].links = 0;
    for (std::size_t i = 0; i + 1 < n; ++i)
        for (int level = 0; level < levels; ++level) {
            const State state = states[at(i, level)];
            if (state.links >= 1e30F) continue;
            const auto z = static_cast<double>(heights[at(i, level)]);
            double low = -1e300, high = 1e300;  // slopes that keep all samples since within the limit
            for (std::size_t k = i + 1; k < n; ++k) {
                const double run = profile.place[first + k] - profile.place[first + i], above = sample(k) - z;
                const double lowest = (low * run - above) / step + middle, highest = (high * run - above) / step + middle;
                const int begin = lowest > 0 ? static_cast<int>(std::min(lowest, 100.0)) + 1 : 0;
                const int end = highest < levels ? static_cast<int>(std::max(highest, -1.0) + 1) : levels;
                for (int to = begin; to < end; ++to) {
                    if (k + 1 == n && to != middle) continue;
                    // A height is a float: one that rounding has taken from its level too far is left out.
                    const double rise = static_cast<double>(heights[at(k, to)]) - z;
                    if (rise < low * run || rise > high * run || std::abs(rise - above) > limit) continue;
                    const float off = static_cast<float>(to - middle) / middle;
                    const float links = state.links + 1 + 2 * off * off;
                    State& next = states[at(k, to)];
                    if (links < next.links) next = {links, static_cast<std::uint32_t>(at(i, level))};
                }
                low = std::max(low, (above - limit) / run);
                high = std::min(high, (above + limit) / run);
                if (!(low <= high)) break;
            }
        }
    for (auto k = static_cast<std::uint32_t>(at(n - 1, middle)); k != none; k = states[k].from) {
        keep[first + k / levels] = 1;
        profile.chosen[first + k / levels] = heights[k];
    }
}

}  // namespace detail

/// The vertices of the border along a line, its ends included, in order: of each stretch with data the polyline within `limit`
/// of what stands there, with a vertex more wherever cells of data begin or end on one side of the line. Cells outside of the
/// image count as none. The same from both sides. `lift`: whether heights may differ from samples; those of several channels
/// do not.
[[nodiscard]] HMESH_COLD inline Array<Corner> side_vertices(const HeightField& field, const SideLine& line, double limit,
                                                            bool lift) {
    detail::Profile profile = detail::profile(field, line);
    limit *= 1 - border_margin;
    const std::size_t n = profile.place.size();
    Array<std::uint8_t> keep(n, 0);
    keep[0] = keep[n - 1] = 1;
    std::vector<std::pair<std::size_t, std::size_t>> open;
    const auto split = [&](std::size_t from, std::size_t to) {
        open.assign(1, {from, to});
        while (!open.empty()) {
            const auto [i, k] = open.back();
            open.pop_back();
            const detail::Profile::Worst worst = profile.worst(i, k);
            if (!(worst.error > limit)) continue;
            keep[worst.place] = 1;
            open.emplace_back(i, worst.place);
            open.emplace_back(worst.place, k);
        }
    };
    for (std::size_t first = 0; first < n; ++first) {
        if (profile.has_data[first] == 0) continue;
        std::size_t last = first;
        while (last + 1 < n && profile.has_data[last + 1] != 0) ++last;
        keep[first] = keep[last] = 1;
        if (lift && limit > 0 && profile.channels == 1) detail::choose_fewest(profile, first, last, limit, keep);
        else split(first, last);
        first = last;
    }
    Array<Corner> out;
    const auto corner = [&](std::size_t k) {
        Corner c;
        c.position = line.is_upright ? Point{static_cast<double>(line.at), profile.place[k]}
                                     : Point{profile.place[k], static_cast<double>(line.at)};
        for (std::size_t channel = 0; channel < profile.channels; ++channel)
            c.heights[channel] = profile.chosen[k * profile.channels + channel];
        return c;
    };
    if (!field.data.empty()) {
        // Vertices where cells begin or end are ends of a border.
        for (int k = line.begin + 1; k < line.end; ++k) {
            if (!detail::cells_change(field, line, k)) continue;
            const auto here = static_cast<std::size_t>(
                std::lower_bound(profile.place.begin(), profile.place.end(), static_cast<double>(k)) - profile.place.begin());
            if (keep[here] != 0) continue;
            keep[here] = 1;
            std::size_t before = here - 1, after = here + 1;
            while (keep[before] == 0) --before;
            while (keep[after] == 0) ++after;
            split(before, here);
            split(here, after);
        }
    }
    for (std::size_t k = 0; k < n; ++k)
        if (keep[k] != 0) out.push_back(corner(k));
    return out;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_SIDE_HPP
