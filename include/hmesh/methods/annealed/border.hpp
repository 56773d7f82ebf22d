/// \file
/// Borders alone: the vertices on the sides of an image, those of each side from its row of samples and nothing else.
///
/// Images that share a row of samples, as tiles of a heightmap do (Samples::points), are then meshed each by itself, and their
/// meshes share the vertices of that row to the bit. Vertices stand on samples and have their values, so that the side is a
/// polyline; it has the fewest of them with which no sample of the row is off by more than a tolerance.
///
/// Which vertices may follow each other: those whose chord passes all samples between them within the tolerance. From each
/// sample on, the slopes that do are a range that shrinks sample by sample (J. O'Rourke, "An on-line algorithm for fitting
/// straight lines between data ranges", 1981); the fewest chords are the shortest way. Cost: some ns for each sample and
/// channel that a chord may pass, 1,024 for each sample at most.
#ifndef HMESH_METHODS_ANNEALED_BORDER_HPP
#define HMESH_METHODS_ANNEALED_BORDER_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The longest chord between vertices of a side, in samples.
inline constexpr std::size_t longest_chord = 1024;

/// The fewest of `count` >= 2 samples, the first and the last among them, whose polyline passes all others within a tolerance
/// >= 0 in each channel; chords are of longest_chord samples at most. In rising order.
template <int C>
[[nodiscard]] HMESH_COLD Array<std::uint32_t> polyline_nodes(const Array<std::array<double, std::size_t{C}>>& samples,
                                                             double tolerance) {
    constexpr std::uint32_t unknown = std::numeric_limits<std::uint32_t>::max();
    const std::size_t count = samples.size();
    Array<std::uint32_t> chords(count, unknown), before(count, 0);  // on the shortest way to each sample
    chords.front() = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<double, std::size_t{C}> low{}, high{};  // slopes of chords from here on
        low.fill(-std::numeric_limits<double>::infinity());
        high.fill(std::numeric_limits<double>::infinity());
        for (std::size_t k = i + 1; k < std::min(count, i + longest_chord + 1); ++k) {
            const auto length = static_cast<double>(k - i);
            bool passes = true, goes_on = true;
            for (std::size_t c = 0; c < C; ++c) {
                const double rise = samples[k][c] - samples[i][c];
                passes = passes && rise >= low[c] * length && rise <= high[c] * length;
                low[c] = std::max(low[c], (rise - tolerance) / length);
                high[c] = std::min(high[c], (rise + tolerance) / length);
                goes_on = goes_on && low[c] <= high[c];
            }
            if (passes && chords[i] + 1 < chords[k]) {
                chords[k] = chords[i] + 1;
                before[k] = static_cast<std::uint32_t>(i);
            }
            if (!goes_on) break;
        }
    }
    Array<std::uint32_t> nodes{static_cast<std::uint32_t>(count - 1)};
    while (nodes.back() != 0) nodes.push_back(before[nodes.back()]);
    std::reverse(nodes.begin(), nodes.end());
    return nodes;
}

/// The vertices on the sides of an image of points, in the plane where it is fitted (mesh/samples.hpp), each once.
template <int C>
[[nodiscard]] HMESH_COLD Array<Point> border_vertices(const ImageSource<C>& source, double tolerance) {
    Array<Point> vertices;
    const auto add_side = [&](const Rect& side, bool has_ends, FunctionRef<Point(int i)> place) {
        Array<std::array<double, std::size_t{C}>> samples(static_cast<std::size_t>(std::max(side.width, side.height)));
        source.with_window(side, [&](const SourceWindow<C>& window) {
            for (std::size_t i = 0; i < samples.size(); ++i) {
                const Point p = place(static_cast<int>(i));
                const auto color = window.pixel(static_cast<int>(p.x), static_cast<int>(p.y));
                for (std::size_t c = 0; c < C; ++c) samples[i][c] = color[static_cast<int>(c)];
            }
        });
        const Array<std::uint32_t> nodes = polyline_nodes<C>(samples, tolerance);
        for (std::size_t k = has_ends ? 0 : 1; k + (has_ends ? 0 : 1) < nodes.size(); ++k)
            vertices.push_back(place(static_cast<int>(nodes[k])));
    };
    const int width = source.width(), height = source.height();
    add_side({0, 0, width, 1}, true, [](int i) { return Point{i + 0.5, 0.5}; });
    add_side({0, height - 1, width, 1}, true, [&](int i) { return Point{i + 0.5, height - 0.5}; });
    add_side({0, 0, 1, height}, false, [](int i) { return Point{0.5, i + 0.5}; });
    add_side({width - 1, 0, 1, height}, false, [&](int i) { return Point{width - 0.5, i + 0.5}; });
    return vertices;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_BORDER_HPP
