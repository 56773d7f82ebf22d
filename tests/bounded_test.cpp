// hmesh tests - meshes within a bound, judged by brute force: each sample against each face, in code of the tests alone.
#include "hmesh/methods/bounded/bounded.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/render.hpp"
#include "test_executors.hpp"
#include "test_sanitized.hpp"

// Samples that floats do not hold.
template <>
struct hmesh::PixelTraits<std::int32_t> {
    static constexpr double peak = 2147483647;
    static constexpr double highest = peak;
    static constexpr double lowest = -peak;
    static constexpr bool is_integer = false;
    static double to_real(std::int32_t value) noexcept { return value; }
    static std::int32_t from_real(double value) noexcept { return static_cast<std::int32_t>(value); }
};
template <>
struct hmesh::PixelTraits<double> {
    static constexpr double peak = 1;
    static constexpr double highest = std::numeric_limits<double>::max();
    static constexpr double lowest = -highest;
    static constexpr bool is_integer = false;
    static double to_real(double value) noexcept { return value; }
    static double from_real(double value) noexcept { return value; }
};

namespace {

using hmesh::Bounded;
using hmesh::Samples;
using Effort = hmesh::Bounded::Effort;

constexpr Effort efforts[] = {Effort::draft, Effort::fast, Effort::normal, Effort::best};

/// Samples of C channels with what has data.
template <class T, int C = 1>
struct Terrain {
    int width = 0, height = 0;
    std::vector<T> samples;          // interleaved
    std::vector<std::uint8_t> data;  // or empty: all
    [[nodiscard]] hmesh::ImageView<T, C> view() const { return {samples.data(), width, height, 0}; }
    [[nodiscard]] double at(int i, int j, int c) const {
        return static_cast<double>(
            samples[(static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)) * C +
                    static_cast<std::size_t>(c)]);
    }
    [[nodiscard]] bool has(int i, int j) const {
        return i >= 0 && j >= 0 && i < width && j < height &&
               (data.empty() ||
                data[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)] != 0);
    }
    /// Whether the mesh must cover a sample.
    [[nodiscard]] bool wants(int i, int j, Samples convention) const {
        if (convention == Samples::squares) return has(i, j);
        for (int y = j - 1; y <= j; ++y)
            for (int x = i - 1; x <= i; ++x)
                if (has(x, y) && has(x + 1, y) && has(x, y + 1) && has(x + 1, y + 1)) return true;
        return false;
    }
};

double cross(double ax, double ay, double bx, double by, double cx, double cy) {
    return (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
}

/// What is wrong with a mesh; empty: nothing.
template <class T, int C>
std::string fault(const hmesh::Mesh& mesh, const Terrain<T, C>& terrain, Samples convention, double bound) {
    const double offset = convention == Samples::squares ? 0.5 : 0;
    const double right = terrain.width - (convention == Samples::squares ? 0 : 1);
    const double bottom = terrain.height - (convention == Samples::squares ? 0 : 1);
    if (mesh.channels != C || mesh.samples != convention || mesh.width != terrain.width || mesh.height != terrain.height)
        return "the mesh is not of the image";
    if (!hmesh::check(mesh.view(), C)) return "check() refuses the mesh";
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    std::vector<int> covered(static_cast<std::size_t>(terrain.width) * static_cast<std::size_t>(terrain.height), 0);
    std::vector<char> used(mesh.vertex_count(), 0);
    double area = 0;
    const auto x = [&](std::uint32_t v) { return static_cast<double>(mesh.positions[2 * std::size_t{v}]); };
    const auto y = [&](std::uint32_t v) { return static_cast<double>(mesh.positions[2 * std::size_t{v} + 1]); };
    const double rounding =
        terrain.samples.empty()
            ? 0
            : 1e-15 * std::abs(static_cast<double>(*std::max_element(terrain.samples.begin(), terrain.samples.end())));
    for (const hmesh::Triangle& t : mesh.faces) {
        const double x0 = x(t[0]), y0 = y(t[0]), x1 = x(t[1]), y1 = y(t[1]), x2 = x(t[2]), y2 = y(t[2]);
        const double twice = cross(x0, y0, x1, y1, x2, y2);
        if (!(twice > 0)) return "a face is not positively oriented";
        area += twice / 2;
        for (std::size_t k = 0; k < 3; ++k) {
            ++edges[{t[k], t[(k + 1) % 3]}];
            used[t[k]] = 1;
            if (x(t[k]) < 0 || x(t[k]) > right || y(t[k]) < 0 || y(t[k]) > bottom) return "a vertex is outside";
        }
        for (int j = 0; j < terrain.height; ++j)
            for (int i = 0; i < terrain.width; ++i) {
                const double px = i + offset, py = j + offset;
                const double a = cross(x1, y1, x2, y2, px, py), b = cross(x2, y2, x0, y0, px, py),
                             c = cross(x0, y0, x1, y1, px, py);
                if (a < 0 || b < 0 || c < 0) continue;  // exact: positions are multiples of 1/256
                if (!terrain.has(i, j)) return "a face covers a sample without data";
                ++covered[static_cast<std::size_t>(j) * static_cast<std::size_t>(terrain.width) + static_cast<std::size_t>(i)];
                for (int channel = 0; channel < C; ++channel) {
                    const auto z = [&](std::uint32_t v) {
                        return static_cast<double>(mesh.colors[std::size_t{v} * C + static_cast<std::size_t>(channel)]);
                    };
                    const double height = z(t[0]) + b / twice * (z(t[1]) - z(t[0])) + c / twice * (z(t[2]) - z(t[0]));
                    const double off = std::abs(height - terrain.at(i, j, channel));
                    if (off > bound + (bound == 0 ? rounding + 1e-13 * std::abs(terrain.at(i, j, channel)) : 0))
                        return "a sample is off by " + std::to_string(off) + " of " + std::to_string(bound);
                }
            }
    }
    for (const char u : used)
        if (u == 0) return "a vertex has no face";
    const bool whole = terrain.data.empty();
    for (const auto& [edge, count] : edges) {
        if (count != 1) return "an edge is used twice in one direction";
        if (edges.count({edge.second, edge.first}) != 0 || !whole) continue;
        const bool on_side = (x(edge.first) == x(edge.second) && (x(edge.first) == 0 || x(edge.first) == right)) ||
                             (y(edge.first) == y(edge.second) && (y(edge.first) == 0 || y(edge.first) == bottom));
        if (!on_side) return "an edge within the image has one face";
    }
    if (whole && area != right * bottom) return "the faces do not have the area of the rectangle";
    for (int j = 0; j < terrain.height; ++j)
        for (int i = 0; i < terrain.width; ++i)
            if (terrain.wants(i, j, convention) &&
                covered[static_cast<std::size_t>(j) * static_cast<std::size_t>(terrain.width) + static_cast<std::size_t>(i)] == 0)
                return "a sample is not covered";
    if (whole) return {};
    // Faces of a mesh with holes do not overlap: no place, off all edges, is in two.
    for (double py = 0.137; py < bottom; py += 0.31)
        for (double px = 0.0713; px < right; px += 0.29) {
            int in = 0;
            for (const hmesh::Triangle& t : mesh.faces)
                if (cross(x(t[0]), y(t[0]), x(t[1]), y(t[1]), px, py) > 0 &&
                    cross(x(t[1]), y(t[1]), x(t[2]), y(t[2]), px, py) > 0 &&
                    cross(x(t[2]), y(t[2]), x(t[0]), y(t[0]), px, py) > 0)
                    ++in;
            if (in > 1) return "two faces overlap";
        }
    return {};
}

using Random = hmesh::kit::Random;

double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

/// A terrain of one of eight kinds, one in five 2 x N or N x 2.
template <class T, int C = 1>
Terrain<T, C> random_terrain(Random& random, int kind, double scale) {
    Terrain<T, C> t;
    t.width = 2 + static_cast<int>(random.uniform() * 18);
    t.height = 2 + static_cast<int>(random.uniform() * 18);
    if (kind % 5 == 0) (random.uniform() < 0.5 ? t.width : t.height) = 2;
    const int high_i = static_cast<int>(random.uniform() * t.width), high_j = static_cast<int>(random.uniform() * t.height);
    const double a = between(random, -3, 3), b = between(random, -3, 3), level = 40;
    const double at = between(random, 0, t.width), frequency = between(random, 0.1, 1);
    for (int j = 0; j < t.height; ++j)
        for (int i = 0; i < t.width; ++i)
            for (int c = 0; c < C; ++c) {
                double z = level;
                switch (kind % 8) {
                    case 0: z += 20 * std::sin(frequency * i + c) * std::cos(frequency * j); break;
                    case 1: break;                                                               // flat
                    case 2: z += i < at ? 0 : 60; break;                                         // a step
                    case 3: z += random.uniform() < 0.05 ? between(random, -40, 60) : 0; break;  // spikes
                    case 4: z += between(random, -40, 60); break;                                // noise
                    case 5: z += a * i + b * j; break;                                           // a plane
                    case 6: z += i == high_i && j == high_j ? 1 : 0; break;                      // one sample
                    default: z += 20 * std::sin(frequency * (i + j)) + between(random, -2, 2); break;
                }
                t.samples.push_back(static_cast<T>(std::max(0.0, z) * scale));
            }
    return t;
}

/// Gives a terrain holes: a disc, specks, a half plane, most samples, or everything but a cell.
template <class T, int C>
void add_holes(Terrain<T, C>& t, Random& random, int kind) {
    t.data.assign(static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height), kind % 5 == 4 ? 0 : 1);
    const auto set = [&](int i, int j, std::uint8_t value) {
        if (i >= 0 && j >= 0 && i < t.width && j < t.height)
            t.data[static_cast<std::size_t>(j) * static_cast<std::size_t>(t.width) + static_cast<std::size_t>(i)] = value;
    };
    const int x = static_cast<int>(random.uniform() * (t.width - 1)), y = static_cast<int>(random.uniform() * (t.height - 1));
    const double slope = between(random, -2, 2), radius = between(random, 1, 6);
    for (int j = 0; j < t.height; ++j)
        for (int i = 0; i < t.width; ++i) switch (kind % 5) {
                case 0:
                    if (std::hypot(i - x, j - y) < radius) set(i, j, 0);
                    break;
                case 1:
                    if (random.uniform() < 0.15) set(i, j, 0);
                    break;
                case 2:
                    if (j - y > slope * (i - x)) set(i, j, 0);
                    break;
                case 3:
                    if (random.uniform() < 0.6) set(i, j, 0);
                    break;
                default: break;
            }
    if (kind % 5 == 4)
        for (int k = 0; k < 4; ++k) set(x + k % 2, y + k / 2, 1);
}

template <class T, int C>
hmesh::Options options_of(const Terrain<T, C>& terrain, Samples convention) {
    hmesh::Options options;
    options.samples = convention;
    if (!terrain.data.empty()) options.mask = {terrain.data.data(), terrain.width, terrain.height, 0};
    return options;
}

template <class T, int C>
bool has_cell(const Terrain<T, C>& terrain, Samples convention) {
    for (int j = 0; j < terrain.height; ++j)
        for (int i = 0; i < terrain.width; ++i)
            if (terrain.wants(i, j, convention)) return true;
    return false;
}

/// Meshes a terrain and judges the mesh.
template <class T, int C>
void try_terrain(const Terrain<T, C>& terrain, Samples convention, const Bounded& recipe) {
    const hmesh::Result result = hmesh::mesh_image(terrain.view(), options_of(terrain, convention), recipe);
    CAPTURE(terrain.width);
    CAPTURE(terrain.height);
    CAPTURE(recipe.max_error);
    CAPTURE(static_cast<int>(recipe.effort));
    CAPTURE(static_cast<int>(convention));
    if (!has_cell(terrain, convention)) {
        CHECK(!result.status);
        CHECK(!result.has_mesh());
        return;
    }
    CHECK(std::string(hmesh::message(result.status).c_str()) == "ok");
    if (!result.status) return;
    CHECK(fault(result.mesh, terrain, convention, recipe.max_error) == "");
    CHECK(result.report.max_error <= recipe.max_error);
    if (recipe.max_error == 0) CHECK(result.report.energy == 0);
    CHECK(result.report.faces == result.mesh.face_count());
    CHECK(result.report.vertices == result.mesh.vertex_count());
}

/// Meshes `count` random terrains times `scale` with random bounds, one in six 0, and judges them. HMESH_TEST_ROUNDS=N in the
/// environment: N times as many, the same ones first.
template <class T, int C = 1>
void try_terrains(std::uint64_t seed, int count, double scale) {
    const char* const rounds = std::getenv("HMESH_TEST_ROUNDS");
    Random random(seed);
    for (int k = 0; k < count * std::max(1, rounds != nullptr ? std::atoi(rounds) : 1); ++k) {
        CAPTURE(k);
        CAPTURE(seed);
        Terrain<T, C> terrain = random_terrain<T, C>(random, k, scale);
        if (random.uniform() < 0.5) add_holes(terrain, random, static_cast<int>(random.uniform() * 100));
        const bool is_exact = random.uniform() < 1.0 / 6;
        const double bound = is_exact ? 0 : scale * std::pow(10.0, between(random, -2, 2.3));
        const Samples convention = random.uniform() < 0.6 ? Samples::points : Samples::squares;
        try_terrain(terrain, convention, {bound, efforts[static_cast<int>(random.uniform() * 4)], random.uniform() < 0.5});
    }
}

}  // namespace

TEST_CASE("meshes of random terrains of whole numbers are within the bound") {
    try_terrains<std::uint8_t>(1, 200, 1);
    try_terrains<std::uint16_t>(2, 300, 100);
}

TEST_CASE("meshes of random terrains of floats are within the bound") {
    try_terrains<float>(3, 200, 1);
    try_terrains<float>(4, 100, 1e-3);
    try_terrains<float>(5, 100, 1e6);
}

TEST_CASE("meshes of several channels are within the bound in each") {
    try_terrains<std::uint8_t, 3>(6, 60, 1);
    try_terrains<float, 4>(7, 40, 1);
}

TEST_CASE("a bound of 0 gives a mesh of error 0, with fewer faces where samples lie in planes") {
    Random random(8);
    for (int k = 0; k < 14; ++k) {
        const auto terrain = random_terrain<std::uint16_t>(random, k, 100);
        for (const Effort effort : efforts) {
            const hmesh::Result result =
                hmesh::mesh_image(terrain.view(), options_of(terrain, Samples::points), Bounded{0, effort});
            REQUIRE(result.status);
            CHECK(result.report.max_error == 0);
            CHECK(result.report.energy == 0);
        }
    }
    Terrain<std::uint8_t> flat;
    flat.width = 30, flat.height = 20;
    flat.samples.assign(600, 7);
    for (const Samples samples : {Samples::points, Samples::squares})
        CHECK(hmesh::mesh_image(flat.view(), options_of(flat, samples), Bounded{0}).report.faces == 2);
}

TEST_CASE("an image of one sample is a rectangle") {
    const Terrain<float> one{1, 1, {3.5F}, {}};
    const hmesh::Result result = hmesh::mesh_image(one.view(), hmesh::Options(), Bounded{0});
    REQUIRE(result.status);
    CHECK(fault(result.mesh, one, Samples::squares, 0) == "");
    CHECK(result.report.faces == 2);
    CHECK(!hmesh::mesh_image(one.view(), options_of(one, Samples::points), Bounded{0}).status);
}

TEST_CASE("heights at the end of what floats hold stay finite and within the bound") {
    Random random(9);
    for (int k = 0; k < 20; ++k) {
        auto terrain = random_terrain<float>(random, k, 1);
        for (float& z : terrain.samples) z = (z - 50) / 50 * std::numeric_limits<float>::max();
        for (const double bound : {0.0, 1e37, 3e38}) try_terrain(terrain, Samples::points, {bound, efforts[k % 4], true});
    }
}

TEST_CASE("more effort takes fewer faces") {
    Terrain<std::uint16_t> terrain = {60, 50, {}, {}};
    for (int j = 0; j < 50; ++j)
        for (int i = 0; i < 60; ++i)
            terrain.samples.push_back(
                static_cast<std::uint16_t>(2000 + 700 * std::sin(0.21 * i) * std::cos(0.17 * j) + 200 * std::sin(0.1 * i * j)));
    std::size_t last = terrain.samples.size() * 2;
    for (const Effort effort : efforts) {
        const hmesh::Result result =
            hmesh::mesh_image(terrain.view(), options_of(terrain, Samples::points), Bounded{60, effort, true});
        REQUIRE(result.status);
        CHECK(fault(result.mesh, terrain, Samples::points, 60) == "");
        CHECK(result.report.faces < last);
        last = result.report.faces;
        CHECK(!result.report.stages.empty());
        CHECK(result.report.stages.back().energy == result.report.energy);
    }
}

namespace {

/// The vertices of a mesh on a line, sorted: position along it and height.
std::vector<std::pair<float, float>> line_of(const hmesh::Mesh& mesh, std::size_t axis, float at) {
    std::vector<std::pair<float, float>> line;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        if (mesh.positions[2 * v + axis] == at) line.emplace_back(mesh.positions[2 * v + 1 - axis], mesh.colors[v]);
    std::sort(line.begin(), line.end());
    return line;
}

}  // namespace

TEST_CASE("tiles that share a row of samples share its border vertices and heights") {
    constexpr int width = 61, height = 41;
    std::vector<float> samples;
    Random random(10);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            samples.push_back(static_cast<float>(100 * std::sin(0.2 * i) * std::cos(0.13 * j) + between(random, -9, 9)));
    const auto tile = [&](int x, int y, int w, int h) {
        return hmesh::ImageView<float, 1>{samples.data() + y * width + x, w, h,
                                          width * static_cast<std::ptrdiff_t>(sizeof(float))};
    };
    hmesh::Options options;
    options.samples = Samples::points;
    for (const Effort effort : efforts)
        for (const double bound : {0.0, 3.0, 15.0, 60.0}) {
            const Bounded recipe{bound, effort};
            const hmesh::Mesh left = hmesh::mesh_image(tile(0, 0, 31, 41), options, recipe).mesh;
            const hmesh::Mesh right = hmesh::mesh_image(tile(30, 0, 31, 41), options, recipe).mesh;
            const hmesh::Mesh top = hmesh::mesh_image(tile(7, 0, 40, 21), options, recipe).mesh;
            const hmesh::Mesh bottom = hmesh::mesh_image(tile(7, 20, 40, 21), options, recipe).mesh;
            CHECK(line_of(left, 0, 30).size() >= 2);
            CHECK(line_of(left, 0, 30) == line_of(right, 0, 0));
            CHECK(line_of(top, 1, 20) == line_of(bottom, 1, 0));
        }
}

namespace {

/// Meshes 2 x 2 tiles that share their middle row and column with each effort, and compares their borders. Of the first a sample,
/// or all off the border it shares, is `far` higher. Where a bound is refused, the smallest that all take is tried instead.
template <class T>
void try_tiles(double scale, double far, std::initializer_list<double> bounds, bool nearly_far = false) {
    constexpr int half = 11, side = 2 * half + 1;
    Random random(21);
    Terrain<T> tiles[4];
    double high[side * side];
    for (int k = 0; k < side * side; ++k)
        high[k] = (60 + 40 * std::sin(0.3 * (k % side)) * std::cos(0.002 * k) + between(random, -9, 9)) * scale;
    for (int t = 0; t < 4; ++t) {
        tiles[t].width = tiles[t].height = half + 1;
        for (int j = t / 2 * half; j <= (t / 2 + 1) * half; ++j)
            for (int i = t % 2 * half; i <= (t % 2 + 1) * half; ++i) {
                const bool is_high = t == 0 && i < half && j < half && (nearly_far || (i == 5 && j == 6));
                tiles[t].samples.push_back(static_cast<T>(high[j * side + i] + (is_high ? far : 0)));
            }
    }
    for (double bound : bounds) {
        for (const Terrain<T>& tile : tiles) {
            const hmesh::Result result =
                hmesh::mesh_image(tile.view(), options_of(tile, Samples::points), {bound, Effort::draft});
            CHECK((result.status || result.status.limit > bound));
            if (!result.status) bound = result.status.limit;
        }
        for (const Effort effort : efforts) {
            CAPTURE(bound);
            CAPTURE(static_cast<int>(effort));
            hmesh::Mesh mesh[4];
            for (int t = 0; t < 4; ++t) {
                hmesh::Result result = hmesh::mesh_image(tiles[t].view(), options_of(tiles[t], Samples::points), {bound, effort});
                REQUIRE(result.status);
                CHECK(fault(result.mesh, tiles[t], Samples::points, bound) == "");
                mesh[t] = std::move(result.mesh);
            }
            for (const std::size_t axis : {0U, 1U}) {
                const std::size_t across = axis == 0 ? 1 : 2, along = 3 - across;
                CHECK(line_of(mesh[0], axis, half) == line_of(mesh[across], axis, 0));
                CHECK(line_of(mesh[along], axis, half) == line_of(mesh[3], axis, 0));
            }
        }
    }
}

}  // namespace

TEST_CASE("tiles of any type share their border vertices, whatever rounding takes of their insides") {
    try_tiles<std::uint8_t>(1, 100, {0, 3, 20});
    try_tiles<std::uint16_t>(300, 30000, {0, 900, 6000});
    try_tiles<float>(1e-3, 1, {0, 1e-9, 3e-3, 2e-2});
    try_tiles<float>(1, 1e9, {0, 1e-5, 3, 20});
    try_tiles<double>(1, 0, {0, 1e-5, 0.01, 3, 20});
    try_tiles<double>(1, 3000, {0, 2e-4, 0.01, 3, 20});
    try_tiles<double>(1, 3e6, {0, 0.2, 3, 20}, true);
    try_tiles<double>(1e9, 0, {1e3, 3e9});
    try_tiles<std::int32_t>(1, 1000000000, {0, 33, 40, 100});
    try_tiles<std::int32_t>(1000, 1000000000, {0, 33, 40, 3000, 20000}, true);
    try_tiles<std::int32_t>(10000000, 0, {0, 33, 40, 30000000});
}

TEST_CASE("the inside may have a bound of its own, which leaves the border as it is") {
    Random random(22);
    Terrain<float> terrain{31, 23, {}, {}};
    for (int k = 0; k < 31 * 23; ++k) terrain.samples.push_back(static_cast<float>(between(random, 0, 100)));
    const hmesh::Options options = options_of(terrain, Samples::points);
    for (const Effort effort : efforts) {
        Bounded recipe{20, effort};
        const hmesh::Mesh usual = hmesh::mesh_image(terrain.view(), options, recipe).mesh;
        for (const double inside : {0.0, 3.0, 30.0}) {
            recipe.inside_error = inside;
            const hmesh::Result result = hmesh::mesh_image(terrain.view(), options, recipe);
            REQUIRE(result.status);
            CHECK(fault(result.mesh, terrain, Samples::points, 20) == "");
            CHECK((result.mesh.faces == usual.faces) == (inside == 30));
            for (const std::size_t axis : {0U, 1U})
                for (const float at : {0.0F, axis == 0 ? 30.0F : 22.0F})
                    CHECK(line_of(result.mesh, axis, at) == line_of(usual, axis, at));
            if (inside > 0) continue;
            // Inside each sample is a vertex then, or on a face that holds it.
            for (int j = 1; j < 22; ++j)
                for (int i = 1; i < 30; ++i) {
                    const auto line = line_of(result.mesh, 1, static_cast<float>(j));
                    const std::pair<float, float> sample{static_cast<float>(i),
                                                         terrain.samples[static_cast<std::size_t>(31 * j + i)]};
                    CHECK(std::find(line.begin(), line.end(), sample) != line.end());
                }
        }
    }
}

TEST_CASE("borders do not depend on what is high beside them, nor with a bound of their own on that of the inside") {
    constexpr int width = hmesh_test::sanitized ? 31 : 61, height = 81;
    Random random(12);
    std::vector<float> samples;
    for (int k = 0; k < width * height; ++k) samples.push_back(static_cast<float>(500 + between(random, -9, 9)));
    const auto half = [&](int y) { return hmesh::ImageView<float, 1>{samples.data() + y * width, width, 41, 0}; };
    hmesh::Options options;
    options.samples = Samples::points;
    samples[20 * width + width / 2] = 1e8F;  // of the upper one alone
    for (const Effort effort : efforts) {
        Bounded recipe{1, effort};
        CHECK(line_of(hmesh::mesh_image(half(0), options, recipe).mesh, 1, 40) ==
              line_of(hmesh::mesh_image(half(40), options, recipe).mesh, 1, 0));
        recipe.max_error = 15;
        recipe.border_error = 4;
        const hmesh::Mesh upper = hmesh::mesh_image(half(0), options, recipe).mesh;
        recipe.max_error = 5;
        const hmesh::Mesh lower = hmesh::mesh_image(half(40), options, recipe).mesh;
        CHECK(line_of(upper, 1, 40) == line_of(lower, 1, 0));
        CHECK(line_of(lower, 1, 40) != line_of(upper, 1, 0));
        recipe.max_error = 15;
        recipe.border_error = 1e9;
        const hmesh::Mesh far = hmesh::mesh_image(half(0), options, recipe).mesh;
        CHECK(line_of(far, 1, 40) == line_of(hmesh::mesh_image(half(0), options, {15, effort}).mesh, 1, 40));
        CHECK(line_of(far, 1, 40) != line_of(upper, 1, 40));
    }
}

TEST_CASE("no vertex is farther above or below all samples than the bound") {
    Random random(13);
    Terrain<float> terrain{40, 30, {}, {}};
    for (int k = 0; k < 40 * 30; ++k) terrain.samples.push_back(random.uniform() < 0.2 ? 100.0F : 0.0F);
    for (const Samples convention : {Samples::points, Samples::squares})
        for (const Effort effort : efforts)
            for (const double bound : {1.0, 5.0, 20.0}) {
                const hmesh::Mesh mesh = hmesh::mesh_image(terrain.view(), options_of(terrain, convention), {bound, effort}).mesh;
                REQUIRE(!mesh.colors.empty());
                const auto [low, high] = std::minmax_element(mesh.colors.begin(), mesh.colors.end());
                CHECK(static_cast<double>(*low) >= -bound);
                CHECK(static_cast<double>(*high) <= 100 + bound);
            }
}

TEST_CASE("any executor gives the same bytes, in one piece and in several") {
    constexpr int width = 1100, height = 60;
    std::vector<std::uint16_t> samples;
    std::vector<std::uint8_t> data;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            samples.push_back(static_cast<std::uint16_t>(2000 + 500 * std::sin(0.05 * i) * std::cos(0.04 * j) +
                                                         500 * std::sin(0.0004 * i * j)));
            data.push_back(std::hypot(i - 520, j - 30) < 20 || (i + 2 * j) % 977 < 3 ? 0 : 1);
        }
    for (const bool holes : {false, true}) {
        hmesh::Options options;
        options.samples = holes ? Samples::squares : Samples::points;
        if (holes) options.mask = {data.data(), width, height, 0};
        const hmesh::ImageView<std::uint16_t, 1> view{samples.data(), width, height, 0};
        const Bounded recipe{150, holes || hmesh_test::sanitized ? Effort::fast : Effort::best};
        const hmesh::Result a = hmesh::mesh_image(view, options, recipe);
        const hmesh_test::ShuffledFor shuffled{3};
        const hmesh_test::ThreadFor threads{3};
        const hmesh::Result b = hmesh::mesh_image(view, options, recipe, shuffled);
        const hmesh::Result c = hmesh::mesh_image(view, options, recipe, threads);
        REQUIRE(a.status);
        CHECK(a.mesh.positions == b.mesh.positions);
        CHECK(a.mesh.colors == b.mesh.colors);
        CHECK(a.mesh.faces == b.mesh.faces);
        CHECK(a.mesh.positions == c.mesh.positions);
        CHECK(a.mesh.faces == c.mesh.faces);
        CHECK(a.report.max_error <= 150);
    }
}

TEST_CASE("a cancelled run returns a mesh within the bound, or none while samples were being inserted") {
    Terrain<std::uint16_t> terrain = {90, 80, {}, {}};
    Random random(11);
    for (int k = 0; k < 7200; ++k) terrain.samples.push_back(static_cast<std::uint16_t>(between(random, 0, 100)));
    int meshes = 0, none = 0;
    for (int last = 1; last < 200; last = 2 * last + 1) {
        int calls = 0;
        double total = 0, energy = 0;
        bool rises = true, is_told = true;
        const auto progress = [&](const hmesh::ProgressInfo& info) {
            rises = rises && info.total >= total && info.total <= 1;
            total = info.total;
            is_told = is_told && (energy == 0 || info.energy > 0);  // once there is a mesh
            energy = info.energy;
            return ++calls < last;
        };
        hmesh::Options options = options_of(terrain, Samples::points);
        options.progress = progress;
        const hmesh::Result result = hmesh::mesh_image(terrain.view(), options, Bounded{20, Effort::best});
        CHECK(rises);
        CHECK(is_told);
        if (result.status) {
            CHECK(total == 1);
            continue;
        }
        CHECK(result.status.code == hmesh::Errc::cancelled);
        if (result.has_mesh()) CHECK(fault(result.mesh, terrain, Samples::points, 20) == "");
        result.has_mesh() ? ++meshes : ++none;
    }
    CHECK(meshes > 0);
    CHECK(none > 0);
}

TEST_CASE("what a mesh within a bound cannot honour is refused with a sentence") {
    const Terrain<float> terrain{4, 3, std::vector<float>(12, 1.0F), {}};
    const auto refused = [&](const hmesh::Options& options, const Bounded& recipe) {
        const hmesh::Result result = hmesh::mesh_image(terrain.view(), options, recipe);
        return result.status.code == hmesh::Errc::invalid_argument && !result.has_mesh() && result.status.what[0] != 0;
    };
    CHECK(!refused({}, {1}));
    for (const double bound : {-1.0, -1e-300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        CHECK(refused({}, {bound}));
    CHECK(refused({}, {1, static_cast<Effort>(7)}));
    for (const double bound : {-1.0, std::numeric_limits<double>::quiet_NaN()})
        CHECK((refused({}, {1, Effort::fast, false, bound}) && refused({}, {1, Effort::fast, false, 1, bound})));
    hmesh::Options options;
    options.target = hmesh::Target::percent(2);
    CHECK(refused(options, {1}));
    options.target = hmesh::Target::at_most(4);
    CHECK(refused(options, {1}));
    options = {};
    options.channel_weights = {2};
    CHECK(refused(options, {1}));
    options = {};
    options.colors = hmesh::Colors::sampled;
    CHECK(refused(options, {1}));
    options = {};
    options.periodic = hmesh::Periodic::x;
    CHECK(refused(options, {1}));
    options = {};
    options.limits.ridge = 1;
    CHECK(refused(options, {1}));
    const std::vector<float> weights(12, 1.0F);
    options = {};
    options.weights = {weights.data(), 4, 3, 0};
    CHECK(refused(options, {1}));
    const std::vector<std::uint8_t> mask(12, 1), empty(12, 0);
    options = {};
    options.mask = {mask.data(), 3, 4, 0};
    CHECK(refused(options, {1}));
    options.mask = {mask.data(), 4, 3, 0};
    CHECK(!refused(options, {1}));
    options.mask = {empty.data(), 4, 3, 0};
    CHECK(refused(options, {1}));
}

TEST_CASE("samples that are NaN are refused, or have no data where that is asked for") {
    Terrain<float> terrain{6, 5, std::vector<float>(30, 2.0F), {}};
    terrain.samples[8] = std::numeric_limits<float>::quiet_NaN();
    hmesh::Options options;
    CHECK(hmesh::mesh_image(terrain.view(), options, Bounded{1}).status.code == hmesh::Errc::not_finite);
    options.nan_is_no_data = true;
    for (const Samples samples : {Samples::points, Samples::squares}) {
        options.samples = samples;
        Terrain<float> judged = terrain;
        judged.data.assign(30, 1);
        judged.data[8] = 0;
        for (const Effort effort : efforts) {
            const hmesh::Result result = hmesh::mesh_image(terrain.view(), options, Bounded{1, effort});
            REQUIRE(result.status);
            CHECK(fault(result.mesh, judged, samples, 1) == "");
        }
    }
    // A sentinel under the mask is never a height, whatever it is.
    std::vector<std::uint8_t> mask(30, 1);
    mask[8] = 0;
    options = {};
    options.mask = {mask.data(), 6, 5, 0};
    const hmesh::Result masked = hmesh::mesh_image(terrain.view(), options, Bounded{0});
    REQUIRE(masked.status);
    for (const float height : masked.mesh.colors) CHECK(height == 2.0F);
}

TEST_CASE("samples that floats do not hold are within bounds above what rounding takes, and smaller ones are refused with that") {
    Terrain<std::int32_t> terrain{9, 8, {}, {}};
    for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 9; ++i) terrain.samples.push_back(1000000001 + 7 * i * i + 1000 * j);
    const hmesh::Result refused = hmesh::mesh_image(terrain.view(), options_of(terrain, Samples::points), Bounded{1});
    CHECK(refused.status.code == hmesh::Errc::invalid_argument);
    CHECK(!refused.has_mesh());
    const double smallest = refused.status.limit;
    CHECK(smallest > 1);
    CHECK(smallest <= 32);  // half a step of floats at 1e9
    for (const double bound : {smallest, 2 * smallest, 200.0, 3000.0})
        for (const Effort effort : efforts) try_terrain(terrain, Samples::points, {bound, effort});
}

TEST_CASE("meshes with holes can be drawn and written") {
    Random random(12);
    auto terrain = random_terrain<std::uint8_t>(random, 6, 1);
    add_holes(terrain, random, 1);
    const hmesh::Result result = hmesh::mesh_image(terrain.view(), options_of(terrain, Samples::squares), Bounded{3});
    REQUIRE(result.status);
    std::size_t bytes = 0;
    const auto sink = [&bytes](const void*, std::size_t size) {
        bytes += size;
        return true;
    };
    CHECK(hmesh::write_ply(result.mesh.view(), sink));
    CHECK(bytes > 0);
    CHECK(hmesh::render<1>(result.mesh.view()).status);
}
