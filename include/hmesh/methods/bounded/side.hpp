/// \file
/// Sides: the polyline that the border of a tile is, chosen from the samples along it alone.
///
/// A side is split at its own worst sample until all are within the bound (D. Douglas and T. Peucker, "Algorithms for the
/// reduction of the number of points required to represent a digitized line or its caricature", 1973), whatever is beside it:
/// so two tiles that share a row of samples get the same border, meshed apart. O(n log n) for most rows.
#ifndef HMESH_METHODS_BOUNDED_SIDE_HPP
#define HMESH_METHODS_BOUNDED_SIDE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

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

namespace detail {

/// A height field along a line: what stands where.
struct Profile {
    std::vector<double> place;           ///< px along the line, rising
    std::vector<float> heights;          ///< `channels` for each place
    std::vector<std::uint8_t> has_data;  ///< for each place
    std::size_t channels;                ///< 1 to 4

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
                const double from = static_cast<double>(heights[i * channels + c]);
                const double rise = static_cast<double>(heights[k * channels + c]) - from;
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
    return out;
}

}  // namespace detail

/// The vertices of the border along a line, its ends included, in order: of each stretch with data the polyline within `limit`
/// of what stands there, with a vertex more wherever cells of data begin or end on one side of the line. Cells outside of the
/// image count as none. The same from both sides.
[[nodiscard]] HMESH_COLD inline std::vector<Corner> side_vertices(const HeightField& field, const SideLine& line, double limit) {
    const detail::Profile profile = detail::profile(field, line);
    const std::size_t n = profile.place.size();
    std::vector<std::uint8_t> keep(n, 0);
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
            open.push_back({i, worst.place});
            open.push_back({worst.place, k});
        }
    };
    for (std::size_t first = 0; first < n; ++first) {
        if (profile.has_data[first] == 0) continue;
        std::size_t last = first;
        while (last + 1 < n && profile.has_data[last + 1] != 0) ++last;
        keep[first] = keep[last] = 1;
        split(first, last);
        first = last;
    }
    std::vector<Corner> out;
    const auto corner = [&](std::size_t k) {
        Corner c;
        c.position = line.is_upright ? Point{static_cast<double>(line.at), profile.place[k]}
                                     : Point{profile.place[k], static_cast<double>(line.at)};
        for (std::size_t channel = 0; channel < profile.channels; ++channel)
            c.heights[channel] = profile.heights[k * profile.channels + channel];
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
