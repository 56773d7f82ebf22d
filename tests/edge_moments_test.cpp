#include "hmesh/fit/edge_moments.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::ImageView;
using hmesh::PixelTraits;
using hmesh::kit::edge_moments;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::Moments;
using hmesh::kit::MomentTable;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Rect;

namespace {

template <class Sample, int Channels>
struct Kind {
    using T = Sample;
    static constexpr int channels = Channels;
};

// --- random triangulations of [0, width] x [0, height] ---

enum class Positions { on_grid, off_grid };

struct PlaneMesh {
    HalfedgeMesh topology;
    std::vector<Point> position;

    [[nodiscard]] Point at(hmesh::kit::Vertex v) const { return position[v.index()]; }
};

// Jittered cells, then random splits and flips that leave no face below half a grid step squared: with slivers, with
// points on pixel centres, and with long edges.
PlaneMesh random_mesh(int width, int height, int columns, int rows, Positions where, std::uint64_t seed) {
    Random random(seed);
    const auto place = [&](double x, double y) {
        if (where == Positions::off_grid) return Point{x, y};
        // A third of the points on centres and corners of pixels, where the ties are.
        const double steps = random.below(3) == 0 ? 2 : hmesh::kit::grid_steps;
        return Point{std::floor(x * steps + 0.5) / steps, std::floor(y * steps + 0.5) / steps};
    };
    PlaneMesh mesh;
    const double dx = static_cast<double>(width) / columns, dy = static_cast<double>(height) / rows;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const Point p = place((i + 0.3 * (random.uniform() - 0.5)) * dx, (j + 0.3 * (random.uniform() - 0.5)) * dy);
            mesh.position.push_back({i == 0 ? 0 : i == columns ? width : p.x, j == 0 ? 0 : j == rows ? height : p.y});
        }
    std::vector<hmesh::Triangle> triangles;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i), b = a + 1;
            const auto d = a + static_cast<std::uint32_t>(columns) + 1, c = d + 1;
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
    REQUIRE(mesh.topology.assign(mesh.position.size(), triangles));

    constexpr double least = 1.0 / 65536;
    HalfedgeMesh& topology = mesh.topology;
    for (int step = 0; step < 6 * columns * rows; ++step) {
        const hmesh::kit::Edge e(random.below(topology.edge_slots()));
        if (topology.is_flip_ok(e)) {
            const hmesh::kit::Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
            const Point from = mesh.at(topology.from_vertex(h)), to = mesh.at(topology.to_vertex(h));
            const Point own = mesh.at(topology.to_vertex(topology.next(h))),
                        other = mesh.at(topology.to_vertex(topology.next(o)));
            if (orient2d(other, own, from) > least && orient2d(own, other, to) > least) topology.flip(e);
        }
        const hmesh::kit::Face f(random.below(topology.face_slots()));
        if (random.below(6) != 0) continue;
        const auto [a, b, c] = topology.vertices(f);
        const double u = random.uniform(), v = random.uniform() * (1 - u), w = 1 - u - v;
        const Point p =
            place(u * mesh.at(a).x + v * mesh.at(b).x + w * mesh.at(c).x, u * mesh.at(a).y + v * mesh.at(b).y + w * mesh.at(c).y);
        if (!(orient2d(mesh.at(a), mesh.at(b), p) > least && orient2d(mesh.at(b), mesh.at(c), p) > least &&
              orient2d(mesh.at(c), mesh.at(a), p) > least))
            continue;
        topology.split(f);
        mesh.position.push_back(p);
    }
    REQUIRE(topology.check());
    return mesh;
}

// --- brute force over pixel centres ---

// Whether the face owns pixel (i, j): its centre is inside, or on a left or a level top side. Exact on the 1/256 grid.
bool owns(const Point (&corner)[3], int i, int j) {
    const long double x = i + 0.5L, y = j + 0.5L;
    for (std::size_t k = 0; k < 3; ++k) {
        const Point a = corner[k], b = corner[(k + 1) % 3];
        const long double dx = static_cast<long double>(b.x) - static_cast<long double>(a.x);
        const long double dy = static_cast<long double>(b.y) - static_cast<long double>(a.y);
        const long double side = dx * (y - static_cast<long double>(a.y)) - (x - static_cast<long double>(a.x)) * dy;
        const bool top_left = dy < 0 || (dy == 0 && dx > 0);
        if (side < 0 || (side == 0 && !top_left)) return false;
    }
    return true;
}

// Integers for integer samples, long double for others. `s`, `sx`, `sy` hold the channels and then 1.
template <class T, int C>
struct Sums {
    using Number = std::conditional_t<PixelTraits<T>::is_integer, std::int64_t, long double>;
    Number s[C + 1] = {}, sx[C + 1] = {}, sy[C + 1] = {}, q[4] = {};

    void add(const T* pixel, int x, int y) {
        for (int c = 0; c <= C; ++c) {
            const Number value = c < C ? static_cast<Number>(PixelTraits<T>::to_real(pixel[c])) : Number{1};
            s[c] += value;
            sx[c] += x * value;
            sy[c] += y * value;
            if (c < C) q[3] += value * value;
        }
        const auto i = static_cast<Number>(x), j = static_cast<Number>(y);
        q[0] += i * i;
        q[1] += i * j;
        q[2] += j * j;
    }
};

// Whether all numbers agree: exactly for integers, else within `tolerance` of those of `scale`, which bound the terms.
template <class T, int C>
bool equal(const Moments<C>& got, const Sums<T, C>& want, const Sums<T, C>& scale) {
    const auto near = [](double a, auto b, auto size) {
        if constexpr (PixelTraits<T>::is_integer) return static_cast<void>(size), a == static_cast<double>(b);
        else return std::abs(static_cast<long double>(a) - b) <= 1e-14L * size;
    };
    for (int c = 0; c <= C; ++c)
        if (!near(got.s[c], want.s[c], scale.s[c]) || !near(got.sx[c], want.sx[c], scale.sx[c]) ||
            !near(got.sy[c], want.sy[c], scale.sy[c]))
            return false;
    for (int c = C + 1; c < hmesh::kit::lanes_for(C + 1); ++c)
        if (got.s[c] != 0 || got.sx[c] != 0 || got.sy[c] != 0) return false;
    // The sums without samples are integers for every type.
    for (int k = 0; k < 3; ++k)
        if (static_cast<long double>(got.q[k]) != static_cast<long double>(want.q[k])) return false;
    return got.s[C] == static_cast<double>(want.s[C]) && near(got.q[3], want.q[3], scale.q[3]);
}

template <int C>
bool same_numbers(const Moments<C>& a, const Moments<C>& b, double sign = 1) {
    bool same = true;
    for (int k = 0; k < hmesh::kit::lanes_for(C + 1); ++k)
        same = same && a.s[k] == sign * b.s[k] && a.sx[k] == sign * b.sx[k] && a.sy[k] == sign * b.sy[k];
    for (int k = 0; k < 4; ++k) same = same && a.q[k] == sign * b.q[k];
    return same;
}

template <int C>
Moments<C> face_moments(const MomentTable<C>& table, const Point (&corner)[3]) {
    Moments<C> sum = Moments<C>::zero();
    for (std::size_t k = 0; k < 3; ++k) {
        Moments<C> edge;
        edge_moments(table, corner[k], corner[(k + 1) % 3], edge);
        sum += edge;
    }
    return sum;
}

struct Findings {
    int wrong_faces = 0;      // moments unlike the brute force
    int wrong_pixels = 0;     // not in exactly one face
    int wrong_sums = 0;       // all faces together unlike the rectangle
    int faces = 0, ties = 0;  // what was met: pixels whose centre is on an edge
};

// Every face of a mesh over `rect` of the view, in local coordinates, against brute force.
template <class T, int C>
void compare(const MomentTable<C>& table, const ImageView<T, C>& view, const Rect& rect, const PlaneMesh& mesh,
             Findings& findings) {
    Sums<T, C> whole;
    for (int y = 0; y < rect.height; ++y)
        for (int x = 0; x < rect.width; ++x) whole.add(view.pixel(rect.x + x, rect.y + y), x, y);
    std::vector<int> owners(static_cast<std::size_t>(rect.width) * static_cast<std::size_t>(rect.height), 0);
    Moments<C> total = Moments<C>::zero();
    for (const hmesh::kit::Face f : mesh.topology.faces()) {
        const auto v = mesh.topology.vertices(f);
        const Point corner[3] = {mesh.at(v[0]), mesh.at(v[1]), mesh.at(v[2])};
        const auto [left, right] = std::minmax({corner[0].x, corner[1].x, corner[2].x});
        const auto [top, bottom] = std::minmax({corner[0].y, corner[1].y, corner[2].y});
        Sums<T, C> expected;
        for (int y = std::max(0, static_cast<int>(top) - 1); y < std::min(rect.height, static_cast<int>(bottom) + 1); ++y)
            for (int x = std::max(0, static_cast<int>(left) - 1); x < std::min(rect.width, static_cast<int>(right) + 1); ++x) {
                for (std::size_t k = 0; k < 3; ++k)
                    findings.ties += orient2d(corner[k], corner[(k + 1) % 3], {x + 0.5, y + 0.5}) == 0;
                if (!owns(corner, x, y)) continue;
                ++owners[static_cast<std::size_t>(y) * static_cast<std::size_t>(rect.width) + static_cast<std::size_t>(x)];
                expected.add(view.pixel(rect.x + x, rect.y + y), x, y);
            }
        const Moments<C> got = face_moments(table, corner);
        findings.wrong_faces += !equal(got, expected, whole);
        ++findings.faces;
        total += got;
    }
    findings.wrong_sums += !equal(total, whole, whole);
    for (const int count : owners) findings.wrong_pixels += count != 1;
}

template <class T, int C>
void compare(const ImageView<T, C>& view, const Rect& rect, const PlaneMesh& mesh, Findings& findings) {
    compare(MomentTable<C>(view, rect), view, rect, mesh, findings);
}

// --- the same with weights ---

template <int C>
struct WeightedSums {
    long double s[C + 1] = {}, sx[C + 1] = {}, sy[C + 1] = {}, q[4] = {};

    template <class T>
    void add(const T* pixel, long double weight, int x, int y) {
        for (int c = 0; c <= C; ++c) {
            const long double value = c < C ? static_cast<long double>(PixelTraits<T>::to_real(pixel[c])) : 1.0L;
            s[c] += weight * value;
            sx[c] += weight * x * value;
            sy[c] += weight * y * value;
            if (c < C) q[3] += weight * value * value;
        }
        q[0] += weight * x * x;
        q[1] += weight * x * y;
        q[2] += weight * y * y;
    }
};

// The largest difference between numbers that should agree, relative to those of `scale`.
template <int C>
double difference(const Moments<C>& got, const WeightedSums<C>& want, const WeightedSums<C>& scale) {
    double largest = 0;
    const auto compare = [&](double a, long double b, long double size) {
        const auto error = static_cast<double>(std::abs(static_cast<long double>(a) - b));
        if (!(error <= 0)) largest = std::max(largest, size > 0 ? error / static_cast<double>(size) : 1e300);
    };
    for (int c = 0; c <= C; ++c) {
        compare(got.s[c], want.s[c], scale.s[c]);
        compare(got.sx[c], want.sx[c], scale.sx[c]);
        compare(got.sy[c], want.sy[c], scale.sy[c]);
    }
    for (int c = C + 1; c < hmesh::kit::lanes_for(C + 1); ++c) {
        compare(got.s[c], 0, 0);
        compare(got.sx[c], 0, 0);
        compare(got.sy[c], 0, 0);
    }
    for (int k = 0; k < 4; ++k) compare(got.q[k], want.q[k], scale.q[k]);
    return largest;
}

// Every face and every edge of a mesh over `rect` of a weighted view; the largest difference found.
template <class T, int C>
double weighted_difference(const ImageView<T, C>& view, const ImageView<float, 1>& weights, double unit, const Rect& rect,
                           const PlaneMesh& mesh) {
    const MomentTable<C> table(view, weights, unit, rect);
    const auto add = [&](WeightedSums<C>& sums, int x, int y) {
        const hmesh::kit::WeightScale scale(unit, view.width, view.height);
        sums.add(view.pixel(rect.x + x, rect.y + y), scale(*weights.pixel(rect.x + x, rect.y + y)), x, y);
    };
    WeightedSums<C> whole;
    for (int y = 0; y < rect.height; ++y)
        for (int x = 0; x < rect.width; ++x) add(whole, x, y);
    double largest = 0;
    Moments<C> total = Moments<C>::zero();
    for (const hmesh::kit::Face f : mesh.topology.faces()) {
        const auto v = mesh.topology.vertices(f);
        const Point corner[3] = {mesh.at(v[0]), mesh.at(v[1]), mesh.at(v[2])};
        WeightedSums<C> expected;
        for (int y = 0; y < rect.height; ++y)
            for (int x = 0; x < rect.width; ++x)
                if (owns(corner, x, y)) add(expected, x, y);
        const Moments<C> got = face_moments(table, corner);
        largest = std::max(largest, difference(got, expected, whole));
        total += got;
        for (std::size_t k = 0; k < 3; ++k) {
            Point a = corner[k], b = corner[(k + 1) % 3];
            Moments<C> edge;
            edge_moments(table, a, b, edge);
            if (b.y < a.y) {
                std::swap(a, b);
                edge *= -1;
            }
            WeightedSums<C> left;
            for (int y = 0; y < rect.height; ++y)
                for (int x = 0; x < rect.width && a.y < y + 0.5 && y + 0.5 <= b.y; ++x)
                    if (orient2d(a, b, {x + 0.5, y + 0.5}) > 0) add(left, x, y);
            // A centre at the height of an end belongs to the edge below it.
            if (a.y - std::floor(a.y) != 0.5 && b.y - std::floor(b.y) != 0.5)
                largest = std::max(largest, difference(edge, left, whole));
        }
    }
    return std::max(largest, difference(total, whole, whole));
}

Point random_point(Random& random, int width, int height, Positions where) {
    const Point p{random.uniform() * width, random.uniform() * height};
    return where == Positions::on_grid ? hmesh::kit::snap(p) : p;
}

}  // namespace

TEST_CASE_TEMPLATE("the edge moments of a face sum to those of its pixels, each pixel in one face, bit for bit for integers", K,
                   Kind<std::uint8_t, 1>, Kind<std::uint8_t, 2>, Kind<std::uint8_t, 3>, Kind<std::uint8_t, 4>,
                   Kind<std::uint8_t, 5>, Kind<std::uint8_t, 16>, Kind<std::uint16_t, 1>, Kind<std::uint16_t, 2>,
                   Kind<std::uint16_t, 3>, Kind<std::uint16_t, 4>, Kind<std::uint16_t, 5>, Kind<std::uint16_t, 16>,
                   Kind<float, 1>, Kind<float, 3>, Kind<float, 16>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(52, 41, 1);
    Findings on_grid, off_grid;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        compare(image.view(), image.view().bounds(), random_mesh(52, 41, 6, 5, Positions::on_grid, seed), on_grid);
        compare(image.view(), image.view().bounds(), random_mesh(52, 41, 6, 5, Positions::off_grid, seed), off_grid);
    }
    for (const Findings& findings : {on_grid, off_grid}) {
        CHECK(findings.wrong_faces == 0);
        CHECK(findings.wrong_pixels == 0);
        CHECK(findings.wrong_sums == 0);
        CHECK(findings.faces > 300);
    }
    CHECK(on_grid.ties > 100);
}

TEST_CASE("sums of columns are those of multiplied rows, exact below 2^53, up to tables of 2^28 pixels") {
    const auto is_sum = [](double found, std::int64_t sum) {
        const auto expected = static_cast<double>(sum);
        return sum < (std::int64_t{1} << 53U) ? found == expected : found == doctest::Approx(expected).epsilon(1e-15);
    };
    const auto pairs = [](std::int64_t n) { return n * (n - 1) / 2; };
    const auto squares = [](std::int64_t n) { return (n - 1) * n * (2 * n - 1) / 6; };
    const auto powers = [&](std::int64_t width) {
        const double sums[] = {static_cast<double>(squares(width)), 0, static_cast<double>(pairs(width)),
                               static_cast<double>(width)};
        return hmesh::kit::Lanes<4>::load(sums);
    };
    // Rows of one length, whose sums have closed forms: the widest table, the highest one, and an edge that begins far down.
    const auto check = [&](std::int64_t width, std::int64_t first, std::int64_t end) {
        hmesh::kit::detail::ColumnSums sums;
        for (std::int64_t j = first; j < end; ++j) sums.add(powers(width));
        const auto by_row = sums.by_row(static_cast<double>(end)), by_square = sums.by_row_squared(static_cast<double>(end));
        CHECK(is_sum(sums.x[3], (end - first) * width));
        CHECK(is_sum(sums.x[2], (end - first) * pairs(width)));
        CHECK(is_sum(sums.x[0], (end - first) * squares(width)));
        CHECK(is_sum(by_row[3], (pairs(end) - pairs(first)) * width));
        CHECK(is_sum(by_row[2], (pairs(end) - pairs(first)) * pairs(width)));
        CHECK(is_sum(by_square[3], (squares(end) - squares(first)) * width));
    };
    check(65536, 0, 4096);
    check(4096, 0, 65536);
    check(4096, 65000, 65536);
    check(1, 7, 8);
    check(0, 0, 9);
    // And of columns that differ, by definition.
    Random random(5);
    hmesh::kit::detail::ColumnSums sums;
    std::int64_t count = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (std::int64_t j = 40; j < 90; ++j) {
        const auto column = static_cast<std::int64_t>(random.below(300));
        sums.add(powers(column));
        for (std::int64_t i = 0; i < column; ++i) ++count, x += i, y += j, xx += i * i, xy += i * j, yy += j * j;
    }
    CHECK(sums.x[3] == static_cast<double>(count));
    CHECK(sums.x[2] == static_cast<double>(x));
    CHECK(sums.x[0] == static_cast<double>(xx));
    CHECK(sums.by_row(90)[3] == static_cast<double>(y));
    CHECK(sums.by_row(90)[2] == static_cast<double>(xy));
    CHECK(sums.by_row_squared(90)[3] == static_cast<double>(yy));
}

TEST_CASE("the edge moments of 8-bit images are exact along edges of any number of rows, up to the brightest of 32-bit sums") {
    for (const int width : {12, 4104}) {
        for (const int height : {61, 62, 63, 124, 125, 190}) {
            const auto image = hmesh_test::draw<std::uint8_t, 3>(width, height, [](int, int, int) { return 1; });
            const MomentTable<3> table(image.view(), image.view().bounds());
            REQUIRE(table.is_int32());
            Moments<3> found;
            const auto right = static_cast<double>(width), bottom = static_cast<double>(height);
            edge_moments(table, {right, 0}, {right, bottom}, found);
            const double n = right * bottom, of_x = n * (right - 1) / 2, of_y = n * (bottom - 1) / 2;
            for (int c = 0; c < 3; ++c) {
                CHECK(found.s[c] == 255 * n);
                CHECK(found.sx[c] == 255 * of_x);
                CHECK(found.sy[c] == 255 * of_y);
            }
            CHECK(found.s[3] == n);
            CHECK(found.sx[3] == of_x);
            CHECK(found.sy[3] == of_y);
            CHECK(found.q[0] == n * (right - 1) * (2 * right - 1) / 6);
            CHECK(found.q[1] == of_x * (bottom - 1) / 2);
            CHECK(found.q[2] == n * (bottom - 1) * (2 * bottom - 1) / 6);
            CHECK(found.q[3] == 3.0 * 255 * 255 * n);
        }
    }
    const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(33, 300, 4);
    Findings findings;
    compare(image.view(), image.view().bounds(), random_mesh(33, 300, 2, 1, Positions::on_grid, 1), findings);
    compare(image.view(), image.view().bounds(), random_mesh(33, 300, 2, 3, Positions::off_grid, 2), findings);
    CHECK(findings.wrong_faces == 0);
    CHECK(findings.wrong_pixels == 0);
    CHECK(findings.wrong_sums == 0);
}

TEST_CASE("the edge moments of 8-bit images too wide for 32-bit sums are exact too, up to the widest") {
    for (const int width : {4200, 65536}) {
        const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(width, 5, 2);
        CHECK_FALSE(MomentTable<3>(image.view(), image.view().bounds()).is_int32());
        Findings findings;
        compare(image.view(), image.view().bounds(), random_mesh(width, 5, 40, 1, Positions::on_grid, 1), findings);
        compare(image.view(), image.view().bounds(), random_mesh(width, 5, 3, 2, Positions::off_grid, 2), findings);
        CHECK(findings.wrong_faces == 0);
        CHECK(findings.wrong_pixels == 0);
        CHECK(findings.wrong_sums == 0);
    }
}

TEST_CASE("the edge moments of images of few levels are exact up to the last column that 15 bits number, and beyond") {
    for (const int width : {32768, 32769}) {
        Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(width, 4, 3);
        for (std::size_t k = 0; k < image.size(); ++k) image.data()[k] &= 3U;
        const auto view = image.view();
        const auto read = [&](int x, int y, int count, auto* to) { std::copy_n(view.pixel(x, y), 3 * count, to); };
        const MomentTable<3> table(view.bounds(), {read, read, {}}, {3, false, false});
        CHECK(table.is_int32() == (width == 32768));
        Findings findings;
        compare(table, view, view.bounds(), random_mesh(width, 4, 40, 1, Positions::on_grid, 1), findings);
        compare(table, view, view.bounds(), random_mesh(width, 4, 3, 2, Positions::off_grid, 2), findings);
        CHECK(findings.wrong_faces == 0);
        CHECK(findings.wrong_pixels == 0);
        CHECK(findings.wrong_sums == 0);
    }
}

TEST_CASE("bright 16-bit images keep all moments exact as long as 2^32 C pixels stays within 2^53") {
    Random random(9);
    const Image<std::uint16_t, 8> image =
        hmesh_test::draw<std::uint16_t, 8>(512, 512, [&random](int, int, int) { return 1 - 0.02 * random.uniform(); });
    Findings findings;
    compare(image.view(), image.view().bounds(), random_mesh(512, 512, 1, 1, Positions::on_grid, 3), findings);
    CHECK(findings.wrong_faces == 0);
    CHECK(findings.wrong_pixels == 0);
    CHECK(findings.wrong_sums == 0);
}

TEST_CASE_TEMPLATE("edge_moments(a, b) is the negative of edge_moments(b, a), bit for bit", K, Kind<std::uint8_t, 1>,
                   Kind<std::uint8_t, 3>, Kind<std::uint16_t, 4>, Kind<float, 3>, Kind<std::uint8_t, 16>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(40, 30, 3);
    const MomentTable<n> table(image.view(), image.view().bounds());
    Random random(4);
    int wrong = 0, level = 0;
    for (int i = 0; i < 5000; ++i) {
        const Positions where = i % 2 == 0 ? Positions::on_grid : Positions::off_grid;
        const Point a = random_point(random, 40, 30, where);
        Point b = random_point(random, 40, 30, where);
        if (random.below(10) == 0) b.y = a.y;
        Moments<n> down, up;
        edge_moments(table, a, b, down);
        edge_moments(table, b, a, up);
        wrong += !same_numbers(down, up, -1);
        if (a.y != b.y) continue;
        ++level;
        wrong += !same_numbers(down, Moments<n>::zero());
    }
    CHECK(wrong == 0);
    CHECK(level > 300);
}

TEST_CASE("a split edge has the moments of its halves where the middle lies on the edge") {
    const Image<std::uint16_t, 3> image = hmesh_test::noise<std::uint16_t, 3>(40, 30, 3);
    const MomentTable<3> table(image.view(), image.view().bounds());
    Random random(5);
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        // Steps of 1/128, so that the middle is on the 1/256 grid.
        const auto draw = [&] {
            return Point{static_cast<double>(random.below(5121)) / 128, static_cast<double>(random.below(3841)) / 128};
        };
        const Point a = draw(), b = draw();
        Moments<3> whole, first, second;
        edge_moments(table, a, b, whole);
        edge_moments(table, a, midpoint(a, b), first);
        edge_moments(table, midpoint(a, b), b, second);
        first += second;
        wrong += !same_numbers(whole, first);
    }
    CHECK(wrong == 0);
}

TEST_CASE("the sides of the rectangle give the moments of all its pixels, whatever the order of the executor") {
    const Image<float, 3> image = hmesh_test::noise<float, 3>(57, 43, 6);
    const Rect rect = image.view().bounds();
    const MomentTable<3> tables[] = {MomentTable<3>(image.view(), rect),
                                     MomentTable<3>(image.view(), rect, hmesh_test::ReverseFor()),
                                     MomentTable<3>(image.view(), rect, hmesh_test::ShuffledFor())};
    Sums<float, 3> whole;
    for (int y = 0; y < 43; ++y)
        for (int x = 0; x < 57; ++x) whole.add(image.pixel(x, y), x, y);
    Moments<3> right, left;
    edge_moments(tables[0], {57, 0}, {57, 43}, right);
    edge_moments(tables[0], {0, 43}, {0, 0}, left);
    CHECK(same_numbers(left, Moments<3>::zero()));
    CHECK(equal(right, whole, whole));
    for (const MomentTable<3>& table : tables) {
        Moments<3> again;
        edge_moments(table, {57, 0}, {57, 43}, again);
        CHECK(same_numbers(right, again));
    }
}

TEST_CASE_TEMPLATE("a table of a rectangle gives the moments of its pixels in local coordinates", K, Kind<std::uint8_t, 3>,
                   Kind<std::uint16_t, 1>, Kind<float, 2>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(70, 60, 7);
    Findings findings;
    for (const Rect& rect : {Rect{11, 7, 40, 33}, Rect{69, 0, 1, 60}, Rect{0, 59, 70, 1}, Rect{30, 20, 40, 40}}) {
        compare(image.view(), rect, random_mesh(rect.width, rect.height, 4, 3, Positions::off_grid, 8), findings);
        // Padded rows, stored bottom up.
        compare(hmesh_test::PaddedCopy<T, n>(image, 5, true, T(1)).view(), rect,
                random_mesh(rect.width, rect.height, 4, 3, Positions::off_grid, 9), findings);
    }
    CHECK(findings.wrong_faces == 0);
    CHECK(findings.wrong_pixels == 0);
    CHECK(findings.wrong_sums == 0);
}

TEST_CASE_TEMPLATE("over a weighted table, edges and faces have the weighted moments of their pixels", K, Kind<std::uint8_t, 1>,
                   Kind<std::uint8_t, 2>, Kind<std::uint8_t, 3>, Kind<std::uint8_t, 4>, Kind<std::uint8_t, 8>,
                   Kind<std::uint16_t, 1>, Kind<std::uint16_t, 3>, Kind<std::uint16_t, 8>, Kind<float, 1>, Kind<float, 2>,
                   Kind<float, 3>, Kind<float, 4>, Kind<float, 8>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    for (const Rect& size : {Rect{0, 0, 1, 1}, Rect{0, 0, 1, 6}, Rect{0, 0, 5, 1}, Rect{0, 0, 37, 29}}) {
        const Image<T, n> image = hmesh_test::noise<T, n>(size.width, size.height, 1);
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            const Image<float, 1> weights = hmesh_test::random_weights(size.width, size.height, seed);
            const Positions where = seed == 1 ? Positions::on_grid : Positions::off_grid;
            const int cells = size.width > 20 ? 4 : 1;
            const PlaneMesh mesh = random_mesh(size.width, size.height, cells, cells, where, seed);
            CHECK(weighted_difference(image.view(), weights.view(), 1.0 / 37, size, mesh) <= 1e-13);
        }
    }
    const Image<T, n> image = hmesh_test::noise<T, n>(60, 50, 7);
    const Image<float, 1> weights = hmesh_test::random_weights(60, 50, 4);
    for (const Rect& rect : {Rect{11, 7, 30, 33}, Rect{59, 0, 1, 50}, Rect{0, 49, 60, 1}}) {
        const PlaneMesh mesh = random_mesh(rect.width, rect.height, 3, 2, Positions::off_grid, 8);
        CHECK(weighted_difference(image.view(), weights.view(), 0.3, rect, mesh) <= 1e-13);
    }
}

TEST_CASE("weights of 1 give the moments of a table without weights, bit for bit, and weights of 0 none") {
    const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(40, 30, 3);
    const Image<float, 1> ones = hmesh_test::constant_image<float, 1>(40, 30, 1), zeros(40, 30);
    const Rect rect = image.view().bounds();
    const MomentTable<3> plain(image.view(), rect), weighted(image.view(), ones.view(), 1, rect),
        empty(image.view(), zeros.view(), 1, rect);
    Random random(4);
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        const Positions where = i % 2 == 0 ? Positions::on_grid : Positions::off_grid;
        const Point a = random_point(random, 40, 30, where), b = random_point(random, 40, 30, where);
        Moments<3> one, other, none;
        edge_moments(plain, a, b, one);
        edge_moments(weighted, a, b, other);
        edge_moments(empty, a, b, none);
        wrong += !same_numbers(one, other);
        wrong += !same_numbers(none, Moments<3>::zero());
    }
    CHECK(wrong == 0);
}

TEST_CASE("faces without weight have no moments at all, whatever the weights beside them, for 8-bit samples") {
    const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(600, 400, 3);
    Image<float, 1> weights = hmesh_test::random_weights(600, 400, 4);
    for (int y = 0; y < 400; ++y)
        for (int x = 300; x < 600; ++x) *weights.pixel(x, y) = 0;
    const MomentTable<3> table(image.view(), weights.view(), 1.0 / 37, image.view().bounds());
    Random random(5);
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        const double top = 368 * random.uniform();
        const auto draw = [&] { return Point{300 + 300 * random.uniform(), top + 32 * random.uniform()}; };
        const Point corner[3] = {draw(), draw(), draw()};
        wrong += !same_numbers(face_moments(table, corner), Moments<3>::zero());
    }
    CHECK(wrong == 0);
}

TEST_CASE("over a weighted table, edge_moments(a, b) is the negative of edge_moments(b, a), bit for bit") {
    const Image<float, 3> image = hmesh_test::noise<float, 3>(40, 30, 3);
    const Image<float, 1> weights = hmesh_test::random_weights(40, 30, 4);
    const MomentTable<3> table(image.view(), weights.view(), 0.3, image.view().bounds());
    Random random(4);
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        const Point a = random_point(random, 40, 30, Positions::off_grid);
        const Point b = random_point(random, 40, 30, Positions::off_grid);
        Moments<3> down, up;
        edge_moments(table, a, b, down);
        edge_moments(table, b, a, up);
        wrong += !same_numbers(down, up, -1);
    }
    CHECK(wrong == 0);
}

TEST_CASE("moments add, subtract and scale number by number") {
    const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(20, 20, 8);
    const MomentTable<3> table(image.view(), image.view().bounds());
    Moments<3> a, b;
    edge_moments(table, {3, 1}, {9, 18}, a);
    edge_moments(table, {12, 2}, {15, 20}, b);
    Moments<3> sum = a;
    sum += b;
    for (int k = 0; k < 4; ++k) {
        CHECK(sum.s[k] == a.s[k] + b.s[k]);
        CHECK(sum.sx[k] == a.sx[k] + b.sx[k]);
        CHECK(sum.sy[k] == a.sy[k] + b.sy[k]);
        CHECK(sum.q[k] == a.q[k] + b.q[k]);
    }
    sum -= a;
    CHECK(same_numbers(sum, b));
    sum *= -1;
    CHECK(same_numbers(sum, b, -1));
    CHECK(Moments<3>::one == 3);
}
