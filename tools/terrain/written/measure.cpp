#include "terrain/written/measure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace terrain {
namespace {

struct Point {
    double x = 0, y = 0, height = 0;
};

// Twice the area of a, b and (x, y), positive where they are clockwise as seen on a map: exactly the negative where a and b
// change places, so that no sample falls between two faces.
double side(const Point& a, const Point& b, double x, double y) {
    const bool is_turned = b.x < a.x || (!(a.x < b.x) && b.y < a.y);
    const Point &from = is_turned ? b : a, &to = is_turned ? a : b;
    const double area = (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x);
    return is_turned ? -area : area;
}

// The place of the segment that is nearest to (x, y).
Point nearest(const Point& a, const Point& b, double x, double y) {
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    const double share = square > 0 ? std::clamp(((x - a.x) * dx + (y - a.y) * dy) / square, 0.0, 1.0) : 0;
    return {a.x + share * dx, a.y + share * dy, a.height + share * (b.height - a.height)};
}

// Calls visit(i, j) for the samples in the face and within `slack` of its box, row after row.
template <class Visit>
void for_samples(const std::array<Point, 3>& face, double slack, int width, int height, Visit&& visit) {
    const auto [a, b, c] = face;
    const double top = std::min({a.y, b.y, c.y}) - slack, bottom = std::max({a.y, b.y, c.y}) + slack;
    const int first = static_cast<int>(std::ceil(std::max(top, 0.0)));
    const int last = static_cast<int>(std::floor(std::min(bottom, height - 1.0)));
    for (int j = first; j <= last; ++j) {
        // Where the edges cross the rows around this one.
        double west = std::numeric_limits<double>::max(), east = -west;
        for (std::size_t k = 0; k < 3; ++k) {
            const Point &from = face[k], &to = face[(k + 1) % 3];
            const double low = std::min(from.y, to.y), high = std::max(from.y, to.y);
            if (high < j - slack || low > j + slack) continue;
            for (const double y : {std::max(low, j - slack), std::min(high, j + slack)}) {
                const double share = high > low ? (y - from.y) / (to.y - from.y) : 0;
                const double x = from.x + share * (to.x - from.x);
                west = std::min(west, high > low ? x : std::min(from.x, to.x));
                east = std::max(east, high > low ? x : std::max(from.x, to.x));
            }
        }
        const int begin = static_cast<int>(std::ceil(std::max(west - slack, 0.0)));
        const int end = static_cast<int>(std::floor(std::min(east + slack, width - 1.0)));
        for (int i = begin; i <= end; ++i) visit(i, j);
    }
}

}  // namespace

Measured measure(const Surface& surface, const hmesh::ImageView<float, 1>& heights, double slack) {
    const int width = heights.width, height = heights.height;
    constexpr double none = -1;
    Measured found;
    std::vector<double> errors(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), none);
    const auto at = [&](int i, int j) -> double& {
        return errors[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
    };
    const auto corners = [&](const std::array<std::uint32_t, 3>& face) {
        std::array<Point, 3> points;
        for (std::size_t k = 0; k < 3; ++k) points[k] = {surface.x[face[k]], surface.y[face[k]], surface.height[face[k]]};
        return points;
    };
    constexpr double rounding = 1e-9;  // of the places where edges cross a row: what is in the face is decided by side()
    for (const auto& face : surface.faces) {
        const std::array<Point, 3> p = corners(face);
        const double area = side(p[0], p[1], p[2].x, p[2].y);
        for_samples(p, rounding * (width + height), width, height, [&](int i, int j) {
            const double a = side(p[1], p[2], i, j), b = side(p[2], p[0], i, j), c = side(p[0], p[1], i, j);
            if (a < 0 || b < 0 || c < 0 || !(area > 0)) return;
            const auto sample = static_cast<double>(*heights.pixel(i, j));
            if (std::isnan(sample)) {
                // On its border a face may come as near to a sample as rounding lets it.
                const double inside = slack * std::sqrt(2 * area);
                found.outside += a > inside && b > inside && c > inside ? 1 : 0;
                return;
            }
            // Exactly 0 in a vertex that is the sample.
            const double error =
                std::fabs(a * (p[0].height - sample) + b * (p[1].height - sample) + c * (p[2].height - sample)) / (a + b + c);
            at(i, j) = std::max(at(i, j), error);
        });
    }
    const auto needs = [&](int i, int j) {
        for (int y = std::max(j - 1, 0); y <= std::min(j, height - 2); ++y)
            for (int x = std::max(i - 1, 0); x <= std::min(i, width - 2); ++x)
                if (has_data(heights, x, y)) return true;
        return false;
    };
    std::vector<char> is_open(errors.size(), 0);
    bool is_whole = true;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            if (at(i, j) < 0 && needs(i, j)) is_whole = false, is_open[static_cast<std::size_t>(&at(i, j) - errors.data())] = 1;
    if (!is_whole)
        for (const auto& face : surface.faces) {
            const std::array<Point, 3> p = corners(face);
            for_samples(p, slack, width, height, [&](int i, int j) {
                double& error = at(i, j);
                if (is_open[static_cast<std::size_t>(&error - errors.data())] == 0) return;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Point q = nearest(p[k], p[(k + 1) % 3], i, j);
                    if (std::hypot(q.x - i, q.y - j) > slack) continue;
                    const double there = std::fabs(q.height - static_cast<double>(*heights.pixel(i, j)));
                    error = error < 0 ? there : std::min(error, there);
                }
            });
        }
    for (std::size_t k = 0; k < errors.size(); ++k) {
        if (errors[k] < 0) {
            found.left_out += static_cast<std::size_t>(is_open[k]);
            continue;
        }
        ++found.samples;
        found.max_error = std::max(found.max_error, errors[k]);
        found.sum_of_squares += errors[k] * errors[k];
    }
    return found;
}

}  // namespace terrain
