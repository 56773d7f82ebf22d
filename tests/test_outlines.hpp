// hmesh tests - masks of all kinds, and whether an outline of one is as it must be, told in whole numbers without the library's
// geometry.
#ifndef HMESH_TESTS_TEST_OUTLINES_HPP
#define HMESH_TESTS_TEST_OUTLINES_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/outline/contour.hpp"

namespace hmesh_test {

using AlphaImage = hmesh::Image<std::uint8_t, 2>;

// A picture whose alpha is 255 where shape(x, y) is true, else 0.
template <class Shape>
AlphaImage silhouette(int width, int height, Shape&& shape) {
    AlphaImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.pixel(x, y)[1] = shape(x, y) ? 255 : 0;
    return image;
}

// Kinds of silhouettes; `kind` is taken modulo their number.
inline AlphaImage some_silhouette(int kind, int width, int height, hmesh::kit::Random& random) {
    struct Disc {
        double x, y, r;
        bool is_hole;
    };
    std::vector<Disc> discs;
    for (int i = 0; i < 8; ++i)
        discs.push_back({random.uniform() * width, random.uniform() * height,
                         (0.02 + 0.25 * random.uniform()) * std::min(width, height), random.below(3) == 0});
    const double cx = 0.5 * width, cy = 0.5 * height, size = 0.5 * std::min(width, height);
    const double density = random.uniform();
    return silhouette(width, height, [&](int i, int j) {
        const double x = i + 0.5, y = j + 0.5, far = std::hypot(x - cx, y - cy), angle = std::atan2(y - cy, x - cx);
        switch (kind % 8) {
            case 0: return random.uniform() < density;
            case 1: return far < 0.9 * size;
            case 2: return far < (0.6 + 0.35 * std::cos(5 * angle)) * size;            // a star
            case 3: return far < 0.95 * size && far > 0.6 * size;                      // a ring
            case 4: return far < size && std::fmod(far + 2 * angle + 20, 12.566) < 6;  // a spiral
            case 5: return (i + j) % 2 == 0;                                           // corners that touch
            case 6: return std::abs(i - j) < 2 || (i % 9 == 0 && j % 7 < 3);
            default: break;
        }
        bool is_in = false;
        for (const Disc& disc : discs)
            if (std::hypot(x - disc.x, y - disc.y) < disc.r) is_in = !disc.is_hole;
        return is_in;
    });
}

// The pixels of a picture that are not transparent.
inline hmesh::kit::Mask mask_of(const AlphaImage& image) {
    hmesh::kit::Mask mask{image.width(), image.height(), {}};
    for (std::size_t k = 1; k < image.size(); k += 2) mask.pixels.push_back(image.data()[k]);
    return mask;
}

struct UnitPoint {
    std::int64_t x = 0, y = 0;  // 1/256 px
    friend bool operator==(UnitPoint a, UnitPoint b) { return a.x == b.x && a.y == b.y; }
};

inline std::int64_t turn_of(UnitPoint a, UnitPoint b, UnitPoint c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Whether the segment from a to b runs through the inside of the box [low, high].
inline bool cuts(UnitPoint a, UnitPoint b, UnitPoint low, UnitPoint high) {
    if (std::max(a.x, b.x) <= low.x || std::min(a.x, b.x) >= high.x || std::max(a.y, b.y) <= low.y ||
        std::min(a.y, b.y) >= high.y)
        return false;
    int left = 0, right = 0;
    for (const UnitPoint corner : {low, {high.x, low.y}, high, {low.x, high.y}}) {
        const std::int64_t side = turn_of(a, b, corner);
        left += side > 0 ? 1 : 0, right += side < 0 ? 1 : 0;
    }
    return left > 0 && right > 0;
}

// Whether two segments have a point in common.
inline bool touch(UnitPoint a, UnitPoint b, UnitPoint c, UnitPoint d) {
    const auto sign = [](std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
    const int abc = sign(turn_of(a, b, c)), abd = sign(turn_of(a, b, d)), cda = sign(turn_of(c, d, a)),
              cdb = sign(turn_of(c, d, b));
    const auto between = [](UnitPoint p, UnitPoint q, UnitPoint r) {
        return std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= r.y && r.y <= std::max(p.y, q.y);
    };
    if (abc != abd && cda != cdb && abc * abd <= 0 && cda * cdb <= 0 && abc * abd * cda * cdb != 0) return true;
    return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
           (cdb == 0 && between(c, d, b)) || (abc * abd < 0 && cda * cdb < 0);
}

using UnitLoops = std::vector<std::vector<UnitPoint>>;

inline UnitLoops unit_loops(const std::vector<hmesh::kit::Loop>& loops) {
    UnitLoops out;
    for (const hmesh::kit::Loop& loop : loops) {
        out.emplace_back();
        for (const hmesh::kit::GridPoint p : loop) out.back().push_back({p.x, p.y});
    }
    return out;
}

// By counting sides that are crossed on the way to the right.
inline bool is_within(const UnitLoops& loops, UnitPoint p) {
    bool is_in = false;
    for (const auto& loop : loops)
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const UnitPoint a = loop[i], b = loop[(i + 1) % loop.size()];
            if ((a.y > p.y) == (b.y > p.y)) continue;
            const std::int64_t side = turn_of(a, b, p);
            if (b.y > a.y ? side < 0 : side > 0) is_in = !is_in;
        }
    return is_in;
}

// Empty if no two sides of the loops meet but neighbours, all lies within the image and every pixel that counts is inside with
// `margin` units around it; else what is wrong.
template <class Counts>
std::string flaw_of_loops(const UnitLoops& loops, int width, int height, std::int64_t margin, Counts&& counts) {
    struct Side {
        UnitPoint a, b;
        std::size_t loop, at;
    };
    std::vector<Side> sides;
    const std::int64_t right = 256 * std::int64_t{width}, bottom = 256 * std::int64_t{height};
    for (std::size_t l = 0; l < loops.size(); ++l) {
        if (loops[l].size() < 3) return "a loop has fewer than three corners";
        for (std::size_t i = 0; i < loops[l].size(); ++i) {
            const UnitPoint a = loops[l][i];
            if (a.x < 0 || a.y < 0 || a.x > right || a.y > bottom) return "a corner lies outside of the image";
            sides.push_back({a, loops[l][(i + 1) % loops[l].size()], l, i});
        }
    }
    for (std::size_t i = 0; i < sides.size(); ++i)
        for (std::size_t j = i + 1; j < sides.size(); ++j) {
            const Side &s = sides[i], &t = sides[j];
            const bool in_turn = s.loop == t.loop && t.at == s.at + 1;
            const bool closes = s.loop == t.loop && s.at == 0 && t.at + 1 == loops[s.loop].size();
            if (in_turn || closes) {
                const UnitPoint shared = in_turn ? s.b : s.a, one = in_turn ? s.a : s.b, other = in_turn ? t.b : t.a;
                const std::int64_t along = (one.x - shared.x) * (other.x - shared.x) + (one.y - shared.y) * (other.y - shared.y);
                if (turn_of(shared, one, other) == 0 && along >= 0) return "a side folds back on its neighbour";
            } else if (touch(s.a, s.b, t.a, t.b)) {
                return "two sides meet";
            }
        }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (!counts(x, y)) continue;
            const UnitPoint low{std::max<std::int64_t>(0, 256 * x - margin), std::max<std::int64_t>(0, 256 * y - margin)};
            const UnitPoint high{std::min(right, 256 * (x + 1) + margin), std::min(bottom, 256 * (y + 1) + margin)};
            for (const Side& side : sides)
                if (cuts(side.a, side.b, low, high)) return "a side cuts pixel " + std::to_string(x) + ", " + std::to_string(y);
            // A point of the square that is on no side: sides do not cut it, and its inside is on one side of all.
            if (!is_within(loops, {(low.x + high.x) / 2, (low.y + high.y) / 2}))
                return "pixel " + std::to_string(x) + ", " + std::to_string(y) + " is outside";
        }
    return {};
}

// Empty if the triangles divide what is inside of the loops between them; else what is wrong.
inline std::string flaw_of_faces(const UnitLoops& loops, const std::vector<std::array<std::uint32_t, 3>>& faces) {
    std::vector<UnitPoint> at;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> borders, sides;
    std::int64_t area = 0;
    for (const auto& loop : loops) {
        const auto first = static_cast<std::uint32_t>(at.size()), size = static_cast<std::uint32_t>(loop.size());
        for (std::uint32_t i = 0; i < size; ++i) {
            at.push_back(loop[i]);
            borders.emplace_back(first + i, first + (i + 1) % size);
            area += turn_of({0, 0}, loop[i], loop[(i + 1) % size]);
        }
    }
    for (const auto& face : faces) {
        for (const std::uint32_t v : face)
            if (v >= at.size()) return "a face names no corner";
        const std::int64_t twice = turn_of(at[face[0]], at[face[1]], at[face[2]]);
        if (twice <= 0) return "a face is flipped or has no area";
        area -= twice;
        for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(face[k], face[(k + 1) % 3]);
    }
    if (area != 0) return "the faces' areas do not add up to that inside of the borders";
    std::sort(sides.begin(), sides.end());
    if (std::adjacent_find(sides.begin(), sides.end()) != sides.end()) return "a side is used twice in one direction";
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
    for (const auto& [a, b] : sides)
        if (!std::binary_search(sides.begin(), sides.end(), std::pair{b, a})) open.emplace_back(a, b);
    std::sort(borders.begin(), borders.end());
    return open == borders ? "" : "the faces' border is not that of the loops";
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_OUTLINES_HPP
