#include <hmesh/io/compact/colors/foretelling.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include <hmesh/core/random.hpp>
#include <hmesh/io/compact/faces.hpp>

using hmesh::detail::AreaForetelling;
using hmesh::detail::ColorNumbers;
using hmesh::detail::DistanceForetelling;
using hmesh::detail::Foretold;
using hmesh::detail::GridPoint;
using hmesh::detail::Triangulation;

namespace {

constexpr std::int64_t side = 256 * 64;

std::vector<GridPoint> random_points(std::size_t n, hmesh::kit::Random& random) {
    std::vector<GridPoint> points{{0, 0}, {side, 0}, {side, side}, {0, side}};
    while (points.size() < n) {
        const auto coordinate = [&] { return static_cast<std::int32_t>(1 + random.below(side - 1)); };
        const GridPoint p{coordinate(), coordinate()};
        if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
    }
    return points;
}

/// What docs/compact.md says, from all faces and all numbers at once.
struct Reference {
    const std::vector<GridPoint>& points;
    const std::vector<hmesh::Triangle> faces;
    const std::vector<bool>& used;
    ColorNumbers numbers;
    std::vector<std::array<std::int64_t, 4>> planes, missed;
    std::array<std::array<std::int64_t, 2>, 3> slopes{};  // of second by first, third by first, third by second

    /// What u and v share.
    [[nodiscard]] std::int64_t shared(std::size_t u, std::size_t v) const {
        std::int64_t area = 0;
        for (const auto& f : faces)
            if (std::count(f.begin(), f.end(), u) + std::count(f.begin(), f.end(), v) == 2)
                area += hmesh::detail::orient2d(points[f[0]], points[f[1]], points[f[2]]);
        return area == 0 ? 0 : area / (numbers.frame_area / 536870912 + 1) + 1;
    }
    struct Neighbor {
        std::int64_t weight;
        std::array<std::int64_t, 4> plane, missed;
    };
    [[nodiscard]] std::vector<Neighbor> neighbors(std::size_t v, std::size_t last) const {
        std::vector<Neighbor> out;
        for (std::size_t u = 0; u < points.size(); ++u) {
            const std::int64_t weight = used[u] && u != v ? shared(u, v) : 0;
            if (weight == 0) continue;
            if (u < v) {
                out.push_back({weight, planes[u], missed[u]});
                continue;
            }
            Neighbor mean{weight, {}, {}};
            std::int64_t sum = 0;
            for (std::size_t t = 0; t < v; ++t) {
                const std::int64_t part = used[t] ? shared(t, u) : 0;
                for (std::size_t k = 0; k < 4; ++k) mean.plane[k] += part * planes[t][k], mean.missed[k] += part * missed[t][k];
                sum += part;
            }
            if (sum == 0) continue;
            for (std::size_t k = 0; k < 4; ++k) mean.plane[k] /= sum, mean.missed[k] /= sum;
            out.push_back(mean);
        }
        if (out.empty() && last < v) out.push_back({1, planes[last], missed[last]});
        return out;
    }
};

std::int64_t distance(std::int64_t a, std::int64_t b) { return a < b ? b - a : a - b; }

}  // namespace

TEST_CASE("by area a number is foretold as all neighbours say together") {
    hmesh::kit::Random random(3);
    const ColorNumbers kinds[] = {{3, 255, true, true, 2 * side * side},
                                  {4, 255, false, true, 2 * side * side},
                                  {3, 65535, false, true, 2 * side * side},
                                  {2, 255, true, false, 2 * side * side},
                                  {1, 4294967295, false, false, 2 * side * side}};
    for (const ColorNumbers& numbers : kinds)
        for (const std::size_t n : std::vector<std::size_t>{4, 5, 30, 60}) {
            const std::vector<GridPoint> points = random_points(n, random);
            const Triangulation mesh(points);
            std::vector<bool> used(n);
            for (std::size_t v = 0; v < n; ++v) used[v] = random.below(8) != 0;
            AreaForetelling foretelling(n, numbers);
            const std::int64_t one = numbers.is_coarse ? 4080 : numbers.most, usual = one / 13 * (one / 13);
            Reference reference{points, hmesh::detail::all_faces(mesh), used, numbers, {}, {}, {}};
            reference.planes.resize(n);
            reference.missed.resize(n);
            reference.slopes.fill({0, std::max<std::int64_t>(usual, 1)});
            std::size_t last = n;
            for (std::size_t v = 0; v < n; ++v) {
                if (!used[v]) continue;
                CAPTURE(v);
                foretelling.look(mesh, used, v, last);
                const auto around = reference.neighbors(v, last);
                auto& planes = reference.planes[v];
                for (std::size_t c = 0; c < numbers.channels; ++c) {
                    const std::size_t k = numbers.channels % 2 == 0 ? (c == 0 ? numbers.channels - 1 : c - 1) : c;
                    const bool is_difference = numbers.is_luma && (k == 1 || k == 2);
                    const std::int64_t most = numbers.is_coarse ? 16383 : is_difference ? 2 * numbers.most : numbers.most;
                    const auto weight = [&](const Reference::Neighbor& u) {
                        if (!is_difference) return u.weight;
                        const std::int64_t like = std::max<std::int64_t>(one / 64, 1);
                        return std::max<std::int64_t>(16 * u.weight * like / (like + distance(u.plane[0], planes[0])), 1);
                    };
                    std::int64_t weights = 0;
                    for (const auto& u : around) weights += weight(u);
                    const auto mean = [&](std::size_t of) {
                        std::int64_t sum = 0;
                        for (const auto& u : around) sum += weight(u) * u.plane[of];
                        return (sum + weights / 2) / weights;
                    };
                    std::int64_t guess = weights == 0 ? 77 : mean(k);
                    if (is_difference && weights > 0) {
                        for (std::size_t j = 0; j < k; ++j) {
                            const auto& slope = reference.slopes[k - 1 + j];
                            guess += slope[0] * (planes[j] - mean(j)) / slope[1];
                        }
                        guess = std::max<std::int64_t>(0, std::min(guess, most));
                    }
                    const Foretold got = foretelling.foretell(k, 77, most);
                    CHECK(got.guess == guess);
                    CHECK(got.weights == weights);
                    std::int64_t spread = 0, missed = 0;
                    for (const auto& u : around)
                        spread += weight(u) * distance(u.plane[k], guess), missed += weight(u) * u.missed[k];
                    CHECK(got.spread == spread);
                    CHECK(got.missed == missed);
                    // Numbers that follow each other somewhat, and ends of the range.
                    const std::int64_t number = random.below(4) == 0 ? static_cast<std::int64_t>(random.below(2)) * most
                                                : k > 0 && is_difference
                                                    ? std::min(most, planes[k - 1])
                                                    : static_cast<std::int64_t>(random.uniform() * static_cast<double>(most));
                    planes[k] = number;
                    reference.missed[v][k] = distance(number, guess);
                    foretelling.note(k, number, distance(number, guess));
                    if (!is_difference || weights == 0) continue;
                    std::int64_t off = number - mean(k);
                    for (std::size_t j = 0; j < k; ++j) {
                        auto& slope = reference.slopes[k - 1 + j];
                        const std::int64_t by = planes[j] - mean(j), told = slope[0] * by / slope[1];
                        slope[0] += by * off - slope[0] / 512;
                        slope[1] += by * by - slope[1] / 512;
                        off -= told;
                    }
                }
                foretelling.close();
                last = v;
            }
        }
}

TEST_CASE("by distance a number is foretold as the nearest say") {
    const std::vector<GridPoint> points{{0, 0}, {side, 0}, {side, side}, {0, side}, {side / 4, side / 4}};
    const Triangulation mesh(points);
    const std::vector<bool> used(5, true);
    DistanceForetelling foretelling(5, {1, 255, false, false, 2 * side * side});
    std::size_t last = 5;
    for (std::size_t v = 0; v < 4; ++v) {
        foretelling.look(mesh, used, v, last);
        foretelling.note(0, v == 0 ? 200 : 0, 0);
        foretelling.close();
        last = v;
    }
    foretelling.look(mesh, used, 4, last);
    const Foretold got = foretelling.foretell(0, 128, 255);
    // Of the corners, (0, 0) is at 11/32 of a side, two at 27/32 and one at 33/32.
    const double parts[] = {32.0 / 11, 32.0 / 27, 32.0 / 33, 32.0 / 27};
    CHECK(got.guess == doctest::Approx(200 * parts[0] / (parts[0] + parts[1] + parts[2] + parts[3])).epsilon(0.01));
}
