#include "hmesh/tiles/tiled_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/methods/annealed/annealing.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"
#include "test_meshes.hpp"
#include "test_sanitized.hpp"

namespace kit = hmesh::kit;
using hmesh::Image;
using hmesh::ParallelFor;
using hmesh::ProgressInfo;
using hmesh::Triangle;
using hmesh::kit::ImageMesh;
using hmesh::kit::ImageSource;
using hmesh::kit::IndexedMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Patch;
using hmesh::kit::Point;
using hmesh::kit::ProgressReporter;
using hmesh::kit::Random;
using hmesh::kit::TiledMesh;
using hmesh::kit::Tiling;
using hmesh::kit::Vertex;
using hmesh::kit::detail::Cut;
using hmesh_test::Corner;
using hmesh_test::corner_of;
using hmesh_test::make_indexed;
using hmesh_test::same_bytes;
using hmesh_test::Shape;

namespace {

ProgressReporter silent() { return ProgressReporter({}, 1, 255); }

// --- work ---

enum class Kind { sweep, flip, insert, remove, anneal, chaos };
inline constexpr std::size_t kinds = 6;

// One phase: how it is cut and what is done, which depends on the tile alone and not on when its turn comes.
struct Phase {
    std::uint64_t number = 0;
    double tile = 16;
    bool shift_x = false, shift_y = false;
    bool mixed = false;  // another kind of work in each tile
    Kind kind = Kind::sweep;
    double price = 0;
    double range = 255;

    [[nodiscard]] Tiling tiling(int width, int height) const { return {width, height, tile, shift_x, shift_y}; }

    template <int C>
    void operator()(Patch<C>& patch, std::size_t tile_number) const {
        Random random(number, tile_number);
        ImageMesh<C>& mesh = patch.mesh();
        const std::size_t count = mesh.vertex_count();
        switch (mixed ? static_cast<Kind>(random.below(kinds)) : kind) {
            case Kind::sweep: kit::sweep(mesh); return;
            case Kind::flip: kit::flip_edges(mesh); return;
            case Kind::insert: kit::insert_batch(mesh, 1 + random.below(count / 3 + 1), {true, true}); return;
            case Kind::remove: kit::remove_batch(mesh, 1 + random.below(count / 3 + 1), {}); return;
            case Kind::anneal: {
                const double least = 0.7 * static_cast<double>(count), most = 1.3 * static_cast<double>(count);
                kit::AnnealingSweep<C>(mesh, {}, price, 0.4 * price, {least, most}, random).run(kit::spatial_vertices(mesh));
                return;
            }
            default:
                for (std::size_t k = 0; k < count; ++k) hmesh_test::random_free_edit(mesh, range, random);
        }
    }
};

// Phases in tilings of all sizes, one tile at times; the price is that of the mesh at their beginning.
std::vector<Phase> phases(std::size_t count, double price, double range, std::uint64_t seed) {
    Random random(seed);
    std::vector<Phase> out;
    for (std::size_t k = 0; k < count; ++k) {
        constexpr double sizes[] = {3, 7, 12, 20, 33, 50, 1000};
        Phase phase;
        phase.number = 1000 * seed + k;
        phase.tile = sizes[random.below(7)];
        phase.shift_x = random.below(2) == 0;
        phase.shift_y = random.below(2) == 0;
        phase.mixed = random.below(3) == 0;
        phase.kind = static_cast<Kind>(k % kinds);
        phase.price = price;
        phase.range = range;
        out.push_back(phase);
    }
    return out;
}

// --- what may not change ---

using Side = std::array<double, 4>;

// Vertices whose triangles are in several tiles, and sides between triangles of two tiles, from the geometry.
template <int C>
struct Rim {
    std::set<Corner<C>> vertices;
    std::set<Side> sides;
};

template <int C>
Side side_of(const IndexedMesh<C>& whole, std::uint32_t a, std::uint32_t b) {
    Point p = whole.positions[a], q = whole.positions[b];
    if (std::pair{q.x, q.y} < std::pair{p.x, p.y}) std::swap(p, q);
    return {p.x, p.y, q.x, q.y};
}

template <int C>
Rim<C> rim_of(const IndexedMesh<C>& whole, const Tiling& tiling) {
    std::vector<std::set<std::size_t>> around(whole.vertex_count());
    std::map<Side, std::set<std::size_t>> beside;
    for (const Triangle& t : whole.faces) {
        const Point a = whole.positions[t[0]], b = whole.positions[t[1]], c = whole.positions[t[2]];
        const std::size_t tile = tiling.tile_at({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3});
        for (std::size_t k = 0; k < 3; ++k) {
            around[t[k]].insert(tile);
            beside[side_of(whole, t[k], t[(k + 1) % 3])].insert(tile);
        }
    }
    Rim<C> rim;
    for (std::size_t v = 0; v < whole.vertex_count(); ++v)
        if (around[v].size() > 1) rim.vertices.insert(corner_of(whole, v));
    for (const auto& [side, tiles] : beside)
        if (tiles.size() > 1) rim.sides.insert(side);
    return rim;
}

template <int C>
void prove_rim(const IndexedMesh<C>& after, const Rim<C>& rim) {
    std::set<Corner<C>> vertices;
    std::set<Side> sides;
    for (std::size_t v = 0; v < after.vertex_count(); ++v) vertices.insert(corner_of(after, v));
    for (const Triangle& t : after.faces)
        for (std::size_t k = 0; k < 3; ++k) sides.insert(side_of(after, t[k], t[(k + 1) % 3]));
    REQUIRE(std::includes(vertices.begin(), vertices.end(), rim.vertices.begin(), rim.vertices.end()));
    REQUIRE(std::includes(sides.begin(), sides.end(), rim.sides.begin(), rim.sides.end()));
}

template <int C>
int valence_limit(const IndexedMesh<C>& whole) {
    std::vector<std::set<std::uint32_t>> around(whole.vertex_count());
    for (const Triangle& t : whole.faces)
        for (std::size_t k = 0; k < 3; ++k) {
            around[t[k]].insert(t[(k + 1) % 3]);
            around[t[k]].insert(t[(k + 2) % 3]);
        }
    std::size_t most = 0;
    for (const auto& neighbors : around) most = std::max(most, neighbors.size());
    return static_cast<int>(most);
}

// The whole is a mesh, and its energy that of a mesh of one piece.
template <class T, int C>
void prove_whole(const Image<T, C>& image, const IndexedMesh<C>& whole) {
    hmesh_test::prove(whole);
    REQUIRE(valence_limit(whole) <= kit::max_valence);
    REQUIRE(std::abs(whole.energy - hmesh_test::fresh_energy(image, whole)) <= 1e-9 * whole.energy);
}

template <class T, int C>
void work_through(const Image<T, C>& image, IndexedMesh<C> start, std::size_t count, std::uint64_t seed) {
    const ImageSource<C> source(image.view());
    ProgressReporter progress = silent();
    TiledMesh<C> work(source, {}, progress);
    work.indexed() = std::move(start);
    std::size_t changed = 0, border_splits = 0;
    for (const Phase& phase : phases(count, 0.4 * work.indexed().mean_energy(), hmesh::PixelTraits<T>::peak, seed)) {
        const Tiling tiling = phase.tiling(image.width(), image.height());
        const IndexedMesh<C> before = work.indexed();
        const Rim<C> rim = rim_of(before, tiling);
        REQUIRE(work.for_each(tiling, phase));
        prove_whole(image, work.indexed());
        prove_rim(work.indexed(), rim);
        changed += same_bytes(before, work.indexed()) ? 0 : 1;
        const auto on_border = [&](const IndexedMesh<C>& whole) {
            return std::count_if(whole.positions.begin(), whole.positions.end(),
                                 [&](Point p) { return p.x == 0 || p.y == 0 || p.x == whole.width || p.y == whole.height; });
        };
        border_splits += on_border(work.indexed()) > on_border(before) ? 1 : 0;
    }
    CHECK(changed > count / 2);
    CHECK(border_splits > 0);
}

// Every phase in turn, on an executor.
template <class T, int C>
std::vector<IndexedMesh<C>> history(const Image<T, C>& image, const IndexedMesh<C>& start, std::size_t count,
                                    const ParallelFor& parallel_for) {
    const ImageSource<C> source(image.view());
    ProgressReporter progress = silent();
    TiledMesh<C> work(source, {}, progress, parallel_for);
    work.indexed() = start;
    std::vector<IndexedMesh<C>> out;
    for (const Phase& phase : phases(count, 0.4 * start.mean_energy(), hmesh::PixelTraits<T>::peak, 7)) {
        REQUIRE(work.for_each(phase.tiling(image.width(), image.height()), phase));
        out.push_back(work.indexed());
    }
    return out;
}

// A progress callback that stops the work when it is called for the k-th time; never, if k is 0.
struct StopAt {
    std::size_t k = 0, calls = 0;
    double last_fraction = -1;
    bool operator()(const ProgressInfo& info) {
        last_fraction = info.fraction;
        return ++calls != k;
    }
};

}  // namespace

TEST_CASE("work that does nothing keeps every triangle, colour and mark of what is due, and finds the energy") {
    std::uint64_t seed = 0;
    ProgressReporter progress = silent();
    for (const Shape shape : hmesh_test::all_shapes) {
        const auto image = hmesh_test::scene<std::uint8_t, 3>(70, 53, 1 + seed);
        const ImageSource<3> source(image.view());
        const IndexedMesh<3> start = make_indexed(image, shape, 130, ++seed);
        const auto expected = hmesh_test::describe(start);
        TiledMesh<3> work(source, {}, progress);
        work.indexed() = start;
        work.indexed().energy = 0;
        for (const double tile : {1.0, 3.0, 8.0, 21.0, 40.0, 1000.0})
            for (int shift = 0; shift < 4; ++shift) {
                const Tiling tiling(70, 53, tile, (shift & 1) != 0, (shift & 2) != 0);
                std::vector<int> visits(tiling.size(), 0);
                REQUIRE(work.for_each(tiling, [&](Patch<3>&, std::size_t k) { ++visits[k]; }));
                // Each tile with triangles had its turn.
                std::vector<int> expected_visits(tiling.size(), 0);
                for (const Triangle& t : start.faces) {
                    const Point a = start.positions[t[0]], b = start.positions[t[1]], c = start.positions[t[2]];
                    expected_visits[tiling.tile_at({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3})] = 1;
                }
                REQUIRE(visits == expected_visits);
                REQUIRE(hmesh_test::describe(work.indexed()) == expected);
                REQUIRE(std::abs(work.indexed().energy - start.energy) <= 1e-9 * start.energy);
                hmesh_test::prove(work.indexed());
            }
    }
}

TEST_CASE("after every phase of work the whole is a mesh with its true energy, and what was locked is where it was") {
    const auto bytes = hmesh_test::scene<std::uint8_t, 3>(100, 70, 1);
    work_through(bytes, make_indexed(bytes, Shape::worn, 220, 1), 36, 1);
    const auto grey = hmesh_test::scene<std::uint8_t, 1>(60, 90, 2);
    work_through(grey, make_indexed(grey, Shape::delaunay, 150, 2), 36, 2);
    const auto noise = hmesh_test::noise<std::uint16_t, 2>(50, 40, 3);
    work_through(noise, make_indexed(noise, Shape::scattered, 120, 3), 36, 3);
    const auto floats = hmesh_test::scene<float, 4>(64, 40, 4);
    work_through(floats, make_indexed(floats, Shape::slivers, 80, 4), 24, 4);
    work_through(floats, make_indexed(floats, hmesh_test::island(), 5), 24, 5);
}

TEST_CASE("a mesh of an image of one row or one column stays one through all phases") {
    for (const auto& [width, height] : {std::pair{1, 60}, {75, 1}, {2, 40}}) {
        const auto image = hmesh_test::noise<std::uint8_t, 3>(width, height, 5);
        work_through(image, make_indexed(image, Shape::grid, 30, 1), 18, 6);
    }
}

TEST_CASE("a hub with as many spokes as may be gets no more, though its spokes are in the patches of many tiles") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(64, 64, 6);
    work_through(image, make_indexed(image, hmesh_test::wheel(64, 36), 1), 30, 7);
    work_through(image, make_indexed(image, hmesh_test::wheel(64, 24), 1), 30, 8);
}

TEST_CASE("patches that give a vertex which they share all the edges they may leave it with as many as a vertex may have") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(96, 96, 6);
    const ImageSource<1> source(image.view());
    for (const int spokes : {12, 36})
        for (const double tile : {24.0, 48.0}) {
            ProgressReporter progress = silent();
            TiledMesh<1> work(source, {}, progress);
            work.indexed() = make_indexed(image, hmesh_test::wheel(96, spokes), 1);
            for (int phase = 0; phase < 2; ++phase) {
                const Tiling tiling(96, 96, tile, phase % 2 != 0, phase % 2 != 0);
                const Rim<1> rim = rim_of(work.indexed(), tiling);
                work.for_each(tiling, [](Patch<1>& patch, std::size_t) {
                    ImageMesh<1>& mesh = patch.mesh();
                    kit::RingScratch<1> ring;
                    for (bool inserted = true; inserted;) {
                        inserted = false;
                        std::vector<kit::Face> faces;
                        for (const kit::Face f : mesh.topology().faces()) faces.push_back(f);
                        for (const kit::Face f : faces) {
                            const auto v = mesh.topology().vertices(f);
                            const bool is_shared = std::any_of(v.begin(), v.end(), [&](Vertex u) {
                                return mesh.vertex(u).mobility == Mobility::locked && mesh.can_gain_edge(u);
                            });
                            const auto candidate = kit::face_candidate(mesh, ring, f, false);
                            if (!is_shared || !candidate.fits || !kit::can_gain_edge(mesh, candidate)) continue;
                            kit::insert(mesh, candidate);
                            inserted = true;
                        }
                    }
                });
                prove_rim(work.indexed(), rim);
                prove_whole(image, work.indexed());
            }
            CHECK(valence_limit(work.indexed()) > 30);
        }
}

TEST_CASE("the mesh is the same to the last byte on executors of any order and on any number of threads") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(110, 80, 8);
    const IndexedMesh<3> start = make_indexed(image, Shape::delaunay, 260, 8);
    const std::size_t count = 12;
    const auto expected = history(image, start, count, {});
    const auto prove_same = [&](const std::vector<IndexedMesh<3>>& other) {
        REQUIRE(other.size() == expected.size());
        for (std::size_t k = 0; k < count; ++k) REQUIRE(same_bytes(other[k], expected[k]));
    };
    prove_same(history(image, start, count, hmesh_test::ReverseFor{}));
    prove_same(history(image, start, count, hmesh_test::ShuffledFor{3}));
    prove_same(history(image, start, count, hmesh_test::ThreadFor{2}));
    prove_same(history(image, start, count, hmesh_test::ThreadFor{7}));
    for (std::size_t k = 1; k < count; ++k) CHECK_FALSE(same_bytes(expected[k], expected[k - 1]));
}

TEST_CASE("a phase depends on the mesh it begins with and on nothing that was before") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(70, 60, 9);
    const ImageSource<1> source(image.view());
    ProgressReporter progress = silent(), another = silent();
    TiledMesh<1> work(source, {}, progress);
    work.indexed() = make_indexed(image, Shape::worn, 160, 9);
    std::vector<Phase> all = phases(18, 0.4 * work.indexed().mean_energy(), 255, 9);
    // Also one tile before and after others: its table is kept in between.
    for (const std::size_t k : {1U, 2U, 4U, 9U, 17U}) all[k].tile = 1000;
    for (const Phase& phase : all) {
        TiledMesh<1> fresh(source, {}, another);
        fresh.indexed() = work.indexed();
        const Tiling tiling = phase.tiling(70, 60);
        REQUIRE(work.for_each(tiling, phase));
        REQUIRE(fresh.for_each(tiling, phase));
        REQUIRE(same_bytes(work.indexed(), fresh.indexed()));
    }
}

TEST_CASE("what a patch makes due is due in the whole, its locked vertices too") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 40, 10);
    const ImageSource<1> source(image.view());
    ProgressReporter progress = silent();
    TiledMesh<1> work(source, {}, progress);
    work.indexed() = make_indexed(image, Shape::grid, 100, 10);
    std::fill(work.indexed().dirty.begin(), work.indexed().dirty.end(), static_cast<unsigned char>(0));
    const Tiling tiling(40, 40, 20);
    work.for_each(tiling, [&](Patch<1>& patch, std::size_t tile) {
        if (tile != 3) return;  // the last, at (20, 20) or a little less
        for (const Vertex v : patch.mesh().topology().vertices()) patch.mesh().set_dirty(v, true);
    });
    const Cut cut = kit::detail::cut(work.indexed().positions, work.indexed().faces, tiling);
    std::vector<unsigned char> expected(work.indexed().vertex_count(), 0);
    for (std::size_t k = cut.first[3]; k < cut.first[4]; ++k)
        for (const std::uint32_t v : work.indexed().faces[cut.faces[k]]) expected[v] = 1;
    CHECK(work.indexed().dirty == expected);
    // Sweeps of the others leave it so: locked vertices are due for another patch.
    work.for_each(tiling, [&](Patch<1>& patch, std::size_t tile) {
        if (tile != 3) kit::sweep(patch.mesh());
    });
    const auto still = std::count(work.indexed().dirty.begin(), work.indexed().dirty.end(), static_cast<unsigned char>(1));
    CHECK(still >= std::count(expected.begin(), expected.end(), static_cast<unsigned char>(1)));
}

TEST_CASE("looking changes nothing and names the triangles of the whole, one for each face of a patch") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(60, 45, 11);
    const ImageSource<3> source(image.view());
    for (const Shape shape : hmesh_test::all_shapes)
        for (const double tile : {2.0, 9.0, 25.0, 1000.0}) {
            const IndexedMesh<3> start = make_indexed(image, shape, 110, 11);
            const hmesh_test::ShuffledFor shuffled{5};
            ProgressReporter progress = silent();
            TiledMesh<3> work(source, {}, progress, shuffled);
            work.indexed() = start;
            std::vector<int> seen(start.faces.size(), 0);
            std::vector<double> energies(start.faces.size(), 0.0);
            const Tiling tiling(60, 45, tile, true, false);
            REQUIRE(work.visit(tiling, [&](Patch<3>& patch, std::size_t number, const std::uint32_t* triangles) {
                const ImageMesh<3>& mesh = patch.mesh();
                const std::size_t count = mesh.topology().face_count();
                for (std::size_t f = 0; f < count; ++f) {
                    const Triangle& t = start.faces[triangles[f]];
                    const auto v = mesh.topology().vertices(kit::Face(f));
                    hmesh_test::Corners<3> corners;
                    for (std::size_t k = 0; k < 3; ++k) corners[k] = corner_of<3>(mesh.position(v[k]), mesh.color(v[k]));
                    REQUIRE(hmesh_test::turned<3>(corners) == hmesh_test::corners_of(start, t));
                    const Point middle = kit::centroid(mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2]));
                    REQUIRE(tiling.tile_at(middle) == number);
                    ++seen[triangles[f]];
                    energies[triangles[f]] = mesh.energy(kit::Face(f));
                }
                kit::sweep(patch.mesh());  // what is done to a patch that is looked at is forgotten
            }));
            REQUIRE(std::count(seen.begin(), seen.end(), 1) == static_cast<std::ptrdiff_t>(seen.size()));
            REQUIRE(same_bytes(work.indexed(), start));
            double sum = 0;
            for (const double energy : energies) sum += energy;
            REQUIRE(std::abs(sum - start.energy) <= 1e-9 * start.energy);
        }
}

TEST_CASE("patches of a small image stay while the tiling stays, and the whole is known all the time") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(100, 70, 1);
    const ImageSource<3> source(image.view());
    const std::vector<Phase> all = phases(8, 0.4 * make_indexed(image, Shape::worn, 220, 1).mean_energy(), 255, 17);
    for (const double tile : {12.0, 33.0, 1000.0}) {
        ProgressReporter progress = silent();
        TiledMesh<3> work(source, {}, progress);
        REQUIRE(work.has_whole_table());
        work.indexed() = make_indexed(image, Shape::worn, 220, 1);
        const Tiling tiling(100, 70, tile);
        std::map<std::size_t, const Patch<3>*> patches;
        for (const Phase& phase : all) {
            const Rim<3> rim = rim_of(work.indexed(), tiling);
            for (int round = 0; round < 2; ++round) {
                REQUIRE(work.for_each(tiling, [&](Patch<3>& patch, std::size_t k) {
                    if (round == 0) patches[k] = &patch;
                    CHECK(patches[k] == &patch);
                    phase(patch, k);
                }));
            }
            const double energy = work.energy();
            const std::size_t count = work.vertex_count(), locked = work.locked_count();
            prove_whole(image, work.indexed());
            prove_rim(work.indexed(), rim);
            CHECK(work.indexed().vertex_count() == count);
            CHECK(work.indexed().energy == energy);
            CHECK(work.locked_count() == locked);
            CHECK(locked == rim.vertices.size());
        }
    }
}

TEST_CASE("the copies of a periodic mesh are no vertices of their own, as patches and put together") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(24, 18, 5);
    for (const hmesh::Periodic periodic : {hmesh::Periodic::x, hmesh::Periodic::y, hmesh::Periodic::xy})
        for (const double tile : {6.0, 100.0}) {
            const auto source = ImageSource<1>(image.view()).with_periodic(periodic, false);
            ProgressReporter progress = silent();
            TiledMesh<1> work(source, {}, progress);
            work.indexed() = hmesh_test::random_periodic(24, 18, 60, periodic, 5);
            const std::size_t distinct = work.vertex_count();
            for (const bool shift : {false, true}) {
                const Tiling tiling(24, 18, tile, shift, shift, periodic);
                REQUIRE(work.for_each(tiling, [](Patch<1>& patch, std::size_t) { kit::sweep(patch.mesh()); }));
                CHECK(work.vertex_count() == distinct);
                const IndexedMesh<1>& whole = work.indexed();
                std::size_t copies = 0;
                for (std::size_t v = 0; v < whole.vertex_count(); ++v) copies += whole.roots[v] != v ? 1 : 0;
                CHECK(copies > 0);
                CHECK(whole.copy_count == copies);
                CHECK(work.vertex_count() == distinct);
            }
        }
}

TEST_CASE("what was locked in a phase is handed out in the next, once, and only patches that hold some of it have their turn") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(100, 70, 1);
    const ImageSource<1> source(image.view());
    const auto sweep_all = [](Patch<1>& patch, std::size_t) { kit::sweep(patch.mesh()); };
    for (const double tile : {12.0, 33.0, 1000.0}) {
        ProgressReporter progress = silent();
        TiledMesh<1> work(source, {}, progress);
        work.indexed() = make_indexed(image, Shape::worn, 220, 1);
        const Tiling first(100, 70, tile), second(100, 70, tile, true, true);
        REQUIRE(work.for_each(first, sweep_all));
        const IndexedMesh<1> start = make_indexed(image, Shape::worn, 220, 1), swept = work.indexed();
        std::map<std::pair<double, double>, Corner<1>> corners;
        for (std::size_t v = 0; v < swept.vertex_count(); ++v)
            corners.emplace(std::pair{swept.positions[v].x, swept.positions[v].y}, corner_of(swept, v));
        std::set<Corner<1>> expected, handed_out;
        if (first != second) {
            expected = rim_of(start, first).vertices;  // they are where they were
            for (const Corner<1>& corner : rim_of(swept, second).vertices) expected.erase(corner);
        }
        REQUIRE(work.for_each_seam(second, [&](Patch<1>& patch, std::size_t) {
            const std::vector<Vertex> vertices = patch.take_was_locked();
            CHECK(!vertices.empty());
            for (const Vertex v : vertices) {
                CHECK(patch.mesh().vertex(v).mobility != Mobility::locked);
                CHECK(handed_out.insert(corners.at({patch.mesh().position(v).x, patch.mesh().position(v).y})).second);
            }
            for (const Vertex v : vertices) kit::improve_vertex(patch.mesh(), v, 0);
            CHECK(patch.take_was_locked().empty());
            CHECK(patch.mesh().energy() <= patch.first_energy());
        }));
        CHECK(handed_out == expected);
        CHECK(work.energy() <= swept.energy);
        prove_whole(image, work.indexed());
    }
}

TEST_CASE("the hindered are those that were locked and their free neighbours") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(100, 70, 1);
    const ImageSource<1> source(image.view());
    const IndexedMesh<1> start = make_indexed(image, Shape::worn, 220, 1);
    const Tiling first(100, 70, 33), second(100, 70, 33, true, true);
    const auto hand_out = [&](bool hindered) {
        ProgressReporter progress = silent();
        TiledMesh<1> work(source, {}, progress);
        work.indexed() = start;
        REQUIRE(work.for_each(first, [](Patch<1>&, std::size_t) {}));
        std::map<std::size_t, std::set<std::size_t>> out;
        REQUIRE(work.for_each_seam(second, [&](Patch<1>& patch, std::size_t tile) {
            const std::vector<Vertex> vertices = hindered ? patch.take_hindered() : patch.take_was_locked();
            for (const Vertex v : vertices) {
                CHECK(out[tile].insert(v.index()).second);
                if (hindered) continue;
                for (const kit::Halfedge h : patch.mesh().topology().outgoing(v)) {
                    const Vertex u = patch.mesh().topology().to_vertex(h);
                    if (patch.mesh().vertex(u).mobility != Mobility::locked) out[1000 + tile].insert(u.index());
                }
            }
        }));
        return out;
    };
    auto strict = hand_out(false);
    const auto hindered = hand_out(true);
    REQUIRE(!hindered.empty());
    for (const auto& [tile, vertices] : hindered) {
        std::set<std::size_t> expected = strict[tile];
        expected.insert(strict[1000 + tile].begin(), strict[1000 + tile].end());
        CHECK(vertices == expected);
    }
}

template <int C>
void check_large(int width, int height) {
    const auto image = hmesh_test::noise<std::uint8_t, C>(width, height, 1);
    const ImageSource<C> source(image.view());
    const IndexedMesh<C> start = make_indexed(image, Shape::delaunay, 900, 1);
    const auto run = [&](const ParallelFor& parallel_for) {
        ProgressReporter progress = silent();
        TiledMesh<C> work(source, {}, progress, parallel_for);
        REQUIRE(!work.is_small());
        REQUIRE(!work.has_whole_table());
        work.indexed() = start;
        const Tiling first(width, height, 3000), second(width, height, 3000, true);
        std::atomic<int> narrow{0};
        REQUIRE(work.for_each(first, [&](Patch<C>& patch, std::size_t) {
            narrow += std::max(patch.mesh().width(), patch.mesh().height()) < 65536 / 4 ? 1 : 0;
            kit::sweep(patch.mesh());
        }));
        CHECK(narrow > 10);
        // Who looks at some sees every second one of 32 or more, whose mesh stays as it is.
        const Tiling many(width, height, 2000);
        REQUIRE(work.sample_step(many) == 2);
        std::vector<unsigned char> is_seen(many.size());
        const std::size_t count = work.vertex_count();
        REQUIRE(work.look_at_each(
            many, [&](Patch<C>&, std::size_t tile) { is_seen[tile] = 1; }, work.sample_step(many)));
        for (std::size_t k = 0; k < is_seen.size(); ++k) CHECK(is_seen[k] == (k % 2 == 0 ? 1 : 0));
        CHECK(work.vertex_count() == count);
        // Who looks finds the patches again, vertex for vertex.
        std::vector<std::vector<Point>> looked(second.size()), places(second.size());
        REQUIRE(work.look_at_each(second, [&](Patch<C>& patch, std::size_t tile) {
            for (const Vertex v : patch.free_vertices()) looked[tile].push_back(patch.mesh().position(v));
        }));
        REQUIRE(work.for_each(second, [&](Patch<C>& patch, std::size_t tile) {
            for (const Vertex v : patch.free_vertices()) places[tile].push_back(patch.mesh().position(v));
            kit::sweep(patch.mesh());
        }));
        CHECK(places == looked);
        REQUIRE(work.for_each_seam(first, [&](Patch<C>& patch, std::size_t) {
            for (const Vertex v : patch.take_was_locked()) kit::improve_vertex(patch.mesh(), v, 0);
        }));
        prove_whole(image, work.indexed());
        return work.indexed();
    };
    const IndexedMesh<C> reversed = run(hmesh_test::ReverseFor{});
    if (!hmesh_test::sanitized) CHECK(same_bytes(run({}), reversed));
}

TEST_CASE("patches of a large image are merged at once, and the whole is the same in any order") {
    SUBCASE("of 65 x 65536 px") { check_large<1>(65, 65536); }
    SUBCASE("of 65536 x 40 px, whose sums along a row would be too large") { check_large<1>(65536, 40); }
}

TEST_CASE("an image of 2^22 pixels at most, whose rows are not too long, has one table") {
    const auto has_whole_table = [](int width, int height, bool is_weighted = false) {
        const hmesh::Image<std::uint8_t, 3> image(width, height);
        const hmesh::Image<float, 1> weights(width, height);
        const ImageSource<3> source(image.view(), is_weighted ? weights.view() : hmesh::ImageView<float, 1>());
        ProgressReporter progress = silent();
        return TiledMesh<3>(source, {}, progress).has_whole_table();
    };
    CHECK(has_whole_table(2048, 2048));
    CHECK(!has_whole_table(2049, 2048));
    CHECK(has_whole_table(16384, 256));
    CHECK(!has_whole_table(16385, 2));
    CHECK(has_whole_table(4096, 2, true));
    CHECK(!has_whole_table(4097, 2, true));
}

TEST_CASE("a phase tells how far it is: its patches together are all that was expected") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(60, 45, 12);
    const ImageSource<1> source(image.view());
    StopAt never;
    ProgressReporter progress(never, 60.0 * 45, 255);
    TiledMesh<1> work(source, {}, progress);
    work.indexed() = make_indexed(image, Shape::worn, 110, 12);
    for (const double tile : {5.0, 20.0, 1000.0}) {
        progress.set_range(0.25, 0.75);
        REQUIRE(work.for_each(Tiling(60, 45, tile), [](Patch<1>&, std::size_t) {}));
        progress.poll();
        CHECK(never.last_fraction == doctest::Approx(0.75).epsilon(1e-9));
    }
}

namespace {

// Phases that are cancelled at the k-th call, for many k, and what follows such an end.
template <class T, int C>
void cancel(const Image<T, C>& image, const IndexedMesh<C>& start, std::size_t step, const ParallelFor& parallel_for) {
    const ImageSource<C> source(image.view());
    const std::vector<Phase> all = phases(6, 0.4 * start.mean_energy(), hmesh::PixelTraits<T>::peak, 10);
    const auto run = [&](StopAt& stop) {
        ProgressReporter progress(stop, 1, 255);
        TiledMesh<C> work(source, {}, progress, parallel_for);
        work.indexed() = start;
        for (const Phase& phase : all) {
            const Tiling tiling = phase.tiling(image.width(), image.height());
            const Rim<C> rim = rim_of(work.indexed(), tiling);
            const bool go_on = work.for_each(tiling, phase);
            REQUIRE(go_on == !progress.stopped());
            prove_whole(image, work.indexed());  // its energy is true also where some patches had no turn
            prove_rim(work.indexed(), rim);
            if (!go_on) break;
        }
        return work.indexed();
    };
    StopAt never;
    const IndexedMesh<C> uncancelled = run(never);
    REQUIRE(never.calls > 60);
    for (std::size_t k = 1; k <= never.calls; k += step) {
        StopAt stop;
        stop.k = k;
        IndexedMesh<C> left = run(stop);
        if (stop.calls < k) continue;  // threads ask as often as they happen to meet
        REQUIRE(stop.calls == k);      // nobody asks again
        // What is left can be worked on.
        ProgressReporter progress = silent();
        TiledMesh<C> work(source, {}, progress, parallel_for);
        work.indexed() = std::move(left);
        REQUIRE(work.for_each(Tiling(image.width(), image.height(), 30), all[k % all.size()]));
        prove_whole(image, work.indexed());
    }
}

}  // namespace

TEST_CASE("work that is cancelled at any call leaves a mesh, on any executor, that may be worked on again") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(48, 40, 13);
    const IndexedMesh<1> start = make_indexed(image, Shape::worn, 130, 13);
    cancel(image, start, 5, {});
    cancel(image, start, 11, hmesh_test::ReverseFor{});
    cancel(image, start, 23, hmesh_test::ThreadFor{2});
    cancel(image, start, 23, hmesh_test::ThreadFor{7});
}

TEST_CASE("a phase that is cancelled at once changes nothing, and a look at all patches goes on after the end") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(48, 40, 14);
    const ImageSource<1> source(image.view());
    const IndexedMesh<1> start = make_indexed(image, Shape::worn, 130, 14);
    for (const double tile : {6.0, 20.0, 1000.0}) {
        StopAt first;
        first.k = 1;
        ProgressReporter progress(first, 1, 255);
        TiledMesh<1> work(source, {}, progress);
        work.indexed() = start;
        const Tiling tiling(48, 40, tile);
        int visits = 0;
        CHECK_FALSE(work.for_each(tiling, [&](Patch<1>&, std::size_t) { ++visits; }));
        CHECK(visits == 0);
        CHECK(hmesh_test::describe(work.indexed()) == hmesh_test::describe(start));
        std::size_t faces = 0;
        const auto look = [&](Patch<1>& patch, std::size_t, const std::uint32_t*) {
            faces += patch.mesh().topology().face_count();
        };
        CHECK_FALSE(work.visit(tiling, look));
        CHECK(faces == 0);
        CHECK_FALSE(work.visit(tiling, look, true));
        CHECK(faces == start.faces.size());
    }
}

TEST_CASE("measuring finds the energy of a mesh that was changed from outside, however it is cut, and nothing else") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(60, 45, 15);
    const ImageSource<3> source(image.view());
    for (const Shape shape : hmesh_test::all_shapes)
        for (const double tile : {2.0, 9.0, 25.0, 1000.0}) {
            IndexedMesh<3> start = make_indexed(image, shape, 110, 15);
            Random random(15);
            for (auto& color : start.colors)
                for (int c = 0; c < 3; ++c) color.set(c, 255 * random.uniform());
            start.energy = -1;
            ProgressReporter progress = silent();
            const hmesh_test::ThreadFor threads{3};
            TiledMesh<3> work(source, {}, progress, threads);
            work.indexed() = start;
            work.measure(Tiling(60, 45, tile, true, false));
            const double energy = hmesh_test::fresh_energy(image, start);
            CHECK(work.energy() == work.indexed().energy);
            CHECK(std::abs(work.energy() - energy) <= 1e-9 * energy);
            start.energy = work.indexed().energy;
            CHECK(same_bytes(work.indexed(), start));
        }
}

TEST_CASE("a mesh whose energy rounding made negative has none on average") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(48, 40, 16);
    const ImageSource<1> source(image.view());
    ProgressReporter progress = silent();
    TiledMesh<1> work(source, {}, progress);
    work.indexed() = make_indexed(image, Shape::worn, 130, 16);
    CHECK(work.mean_energy() == work.energy() / static_cast<double>(work.vertex_count()));
    work.indexed().energy = -1e-9;
    CHECK(work.mean_energy() == 0);
}

TEST_CASE("measuring is not to be cancelled, and sees what one patch that is all has become") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(48, 40, 16);
    const ImageSource<1> source(image.view());
    const IndexedMesh<1> start = make_indexed(image, Shape::worn, 130, 16);
    for (const double tile : {6.0, 20.0, 1000.0}) {
        StopAt later;
        ProgressReporter progress(later, 1, 255);
        TiledMesh<1> work(source, {}, progress);
        work.indexed() = start;
        CHECK(work.for_each(Tiling(48, 40, 1000), [](Patch<1>& patch, std::size_t) { kit::sweep(patch.mesh()); }));
        const double swept = work.energy();
        CHECK(swept < start.energy);
        later.k = later.calls + 1;
        (void)progress.poll();
        REQUIRE(progress.stopped());
        work.measure(Tiling(48, 40, tile));
        CHECK(std::abs(work.energy() - swept) <= 1e-9 * swept);
        CHECK(std::abs(work.energy() - hmesh_test::fresh_energy(image, work.indexed())) <= 1e-9 * swept);
    }
}
