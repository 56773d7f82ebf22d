#include "hmesh/mesh/raster.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"

using hmesh::kit::ClipRect;
using hmesh::kit::Point;

namespace {

// A corner in whole numbers of 1/256 px.
struct Corner {
    std::int64_t x, y;
    [[nodiscard]] Point point() const { return {static_cast<double>(x) / 256, static_cast<double>(y) / 256}; }
};

std::int64_t orient2d(const Corner& a, const Corner& b, const Corner& p) {
    return (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
}

// The top-left rule by the signs of the centre's distances to the edges.
bool owns(Corner a, Corner b, Corner c, int i, int j) {
    if (orient2d(a, b, c) < 0) std::swap(b, c);
    if (orient2d(a, b, c) == 0) return false;
    const Corner center{256 * std::int64_t{i} + 128, 256 * std::int64_t{j} + 128};
    const auto inside = [&](const Corner& from, const Corner& to) {
        const std::int64_t side = orient2d(from, to, center);
        const bool is_top = from.y == to.y && to.x > from.x, is_left = to.y < from.y;
        return side > 0 || (side == 0 && (is_top || is_left));
    };
    return inside(a, b) && inside(b, c) && inside(c, a);
}

}  // namespace

TEST_CASE("the spans of a face are the pixels that it owns by the top-left rule, clipped or not") {
    hmesh::kit::Random random(5);
    constexpr int width = 24, height = 20;
    int wrong = 0, owned = 0;
    for (int round = 0; round < 3000; ++round) {
        // Multiples of half a pixel put many centres on edges. Some corners lie outside of what is seen.
        const int step = round % 3 == 0 ? 128 : 1, beyond = round % 2 == 0 ? 0 : 10;
        const auto draw = [&](int size) {
            const auto places = static_cast<std::uint64_t>((size + 2 * beyond) * 256 / step + 1);
            return static_cast<std::int64_t>(random.below(places)) * step - 256 * beyond;
        };
        Corner corners[3];
        for (Corner& corner : corners) corner = {draw(width), draw(height)};
        const ClipRect clips[] = {{width, 0, height}, {width / 2, 3, 11}, {}};
        for (const ClipRect& clip : clips) {
            if (beyond != 0 && clip.width > width) continue;
            const int last = clip.last < height ? clip.last : height, columns = clip.width < width ? clip.width : width;
            std::vector<int> visits(width * height, 0);
            int row = -1;
            hmesh::kit::for_each_span(
                corners[0].point(), corners[1].point(), corners[2].point(), clip, [&](int j, int begin, int end) {
                    wrong += j <= row || begin >= end || begin < 0 || end > columns || j < clip.first || j >= last;
                    row = j;
                    for (int i = begin; i < end && i < width && j < height; ++i)
                        ++visits[static_cast<std::size_t>(j * width + i)];
                });
            for (int j = clip.first; j < last; ++j)
                for (int i = 0; i < columns; ++i) {
                    const int expected = owns(corners[0], corners[1], corners[2], i, j) ? 1 : 0;
                    wrong += visits[static_cast<std::size_t>(j * width + i)] != expected;
                    owned += expected;
                }
        }
    }
    CHECK(wrong == 0);
    CHECK(owned > 100000);
}
