#include "hmesh/tiles/patch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::Image;
using hmesh::Triangle;
using hmesh::kit::Edge;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::ImageMesh;
using hmesh::kit::ImageSource;
using hmesh::kit::IndexedMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Patch;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Rect;
using hmesh::kit::Tiling;
using hmesh::kit::Vertex;
using hmesh::kit::detail::Cut;
using hmesh::kit::detail::PatchFaces;
using hmesh::kit::detail::PatchResult;
using hmesh_test::Corner;
using hmesh_test::Corners;
using hmesh_test::make_indexed;
using hmesh_test::Shape;

namespace {

// The tile of a point given by three times its coordinates, which may be exact where they are not; the right and lower
// border belong to the last tiles.
std::size_t brute_tile(const Tiling& tiling, int width, int height, Point thrice) {
    std::size_t found = tiling.size();
    int count = 0;
    for (std::size_t k = 0; k < tiling.size(); ++k) {
        const Rect r = tiling.rect(k);
        const auto holds = [](double x, int low, int size, int end) {
            return x >= 3.0 * low && (x < 3.0 * (low + size) || (low + size == end && x == 3.0 * end));
        };
        if (!holds(thrice.x, r.x, r.width, width) || !holds(thrice.y, r.y, r.height, height)) continue;
        found = k;
        ++count;
    }
    REQUIRE(count == 1);
    return found;
}

template <int C>
std::vector<std::size_t> brute_tiles(const IndexedMesh<C>& whole, const Tiling& tiling) {
    std::vector<std::size_t> tiles;
    for (const Triangle& t : whole.faces) {
        const Point a = whole.positions[t[0]], b = whole.positions[t[1]], c = whole.positions[t[2]];
        tiles.push_back(brute_tile(tiling, whole.width, whole.height, {a.x + b.x + c.x, a.y + b.y + c.y}));
    }
    return tiles;
}

// Sets of things that are joined one by one.
class Groups {
  public:
    explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
    [[nodiscard]] std::size_t of(std::size_t k) const {
        while (parent_[k] != k) k = parent_[k];
        return k;
    }
    void join(std::size_t a, std::size_t b) { parent_[of(a)] = of(b); }

  private:
    std::vector<std::size_t> parent_;
};

// What a tile's triangles are like.
struct Form {
    std::size_t components = 0;  // joined by sides
    std::size_t pinched = 0;     // vertices where several fans meet
    std::ptrdiff_t holes = 0;
    std::map<std::uint32_t, std::vector<int>> fans;  // of each vertex: how many triangles each has, ascending
};

Form form_of(const std::vector<Triangle>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> sides;  // by direction: the triangle
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) sides[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
    Groups components(triangles.size()), corners(3 * triangles.size());
    std::size_t inner = 0;
    for (const auto& [side, t] : sides) {
        const auto other = sides.find({side.second, side.first});
        if (other == sides.end()) continue;
        ++inner;
        components.join(t, other->second);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (const std::uint32_t v = triangles[t][i];
                    v == triangles[other->second][k] && (v == side.first || v == side.second))
                    corners.join(3 * t + i, 3 * other->second + k);
    }
    Form form;
    std::map<std::size_t, int> sizes;
    for (std::size_t c = 0; c < 3 * triangles.size(); ++c) ++sizes[corners.of(c)];
    for (const auto& [corner, size] : sizes) form.fans[triangles[corner / 3][corner % 3]].push_back(size);
    for (auto& [v, fans] : form.fans) {
        std::sort(fans.begin(), fans.end());
        form.pinched += fans.size() > 1 ? 1 : 0;
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) form.components += components.of(t) == t ? 1 : 0;
    // Euler: each component without holes has vertices - edges + faces = 1, and each hole takes one away.
    const auto count = [](std::size_t n) { return static_cast<std::ptrdiff_t>(n); };
    form.holes = count(form.components) - (count(sizes.size()) - count(sides.size() - inner / 2) + count(triangles.size()));
    return form;
}

template <int C>
std::vector<Triangle> triangles_of(const IndexedMesh<C>& whole, const Cut& cut, std::size_t tile) {
    std::vector<Triangle> triangles;
    for (std::size_t k = cut.first[tile]; k < cut.first[tile + 1]; ++k) triangles.push_back(whole.faces[cut.faces[k]]);
    return triangles;
}

// How often the odd cases came up: a test that never meets them proves little.
struct Met {
    std::size_t holes = 0, pinched = 0, apart = 0, all_locked = 0, alone = 0, narrow = 0, one_tile = 0;
};

// Position and colour of free vertex v of a result.
template <int C>
Corner<C> corner_of(const PatchResult<C>& result, std::size_t v) {
    Corner<C> corner{result.positions[v].x, result.positions[v].y};
    std::copy(result.colors[v].begin(), result.colors[v].end(), corner.begin() + 2);
    return corner;
}

// The triangles of a result by the coordinates and colours of their corners, sorted.
template <int C>
std::vector<Corners<C>> corners_of(const IndexedMesh<C>& whole, const PatchResult<C>& result) {
    const std::size_t free = result.positions.size();
    std::vector<Corners<C>> out;
    for (const Triangle& t : result.faces) {
        Corners<C> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = t[k] < free ? corner_of(result, t[k]) : hmesh_test::corner_of(whole, result.locked[t[k] - free]);
        out.push_back(hmesh_test::turned<C>(corners));
    }
    std::sort(out.begin(), out.end());
    return out;
}

template <int C>
void prove_result(const IndexedMesh<C>& whole, const Cut& cut, std::size_t tile, const PatchResult<C>& result, bool by_fan,
                  const Form& form) {
    std::vector<Corners<C>> expected;
    for (const Triangle& t : triangles_of(whole, cut, tile)) expected.push_back(hmesh_test::corners_of(whole, t));
    std::sort(expected.begin(), expected.end());
    REQUIRE(corners_of(whole, result) == expected);

    std::map<Corner<C>, bool> due, expected_due;
    for (std::size_t k = 0; k < result.positions.size(); ++k) due[corner_of(result, k)] = result.dirty[k] != 0;
    for (std::size_t v = 0; v < whole.vertex_count(); ++v)
        if (cut.owner[v] == tile) expected_due[hmesh_test::corner_of(whole, v)] = whole.dirty[v] != 0;
    REQUIRE(result.positions.size() == cut.free_count[tile]);
    REQUIRE(due == expected_due);
    for (const std::uint32_t v : result.locked) REQUIRE(cut.owner[v] == Cut::locked);
    if (!by_fan) return;
    std::vector<std::uint32_t> locked = result.locked, locked_dirty = result.locked_dirty, fans, due_fans;
    for (const auto& [v, sizes] : form.fans)
        for (std::size_t k = 0; k < sizes.size() && cut.owner[v] == Cut::locked; ++k) {
            fans.push_back(v);
            if (whole.dirty[v] != 0) due_fans.push_back(v);
        }
    std::sort(locked.begin(), locked.end());
    std::sort(locked_dirty.begin(), locked_dirty.end());
    REQUIRE(locked == fans);
    REQUIRE(locked_dirty == due_fans);
}

// Everything that is promised of the patches of one cut.
template <int C>
void prove_patches(const ImageSource<C>& source, const IndexedMesh<C>& whole, const Tiling& tiling, Met& met) {
    const Cut cut = kit::detail::cut(whole.positions, whole.faces, tiling);
    double energy = 0;
    std::vector<int> room(whole.vertex_count(), 0);  // triangles that the fans of a locked vertex may have together
    std::size_t free = 0;
    for (std::size_t tile = 0; tile < tiling.size(); ++tile) {
        const std::vector<Triangle> triangles = triangles_of(whole, cut, tile);
        if (triangles.empty()) continue;
        const Form form = form_of(triangles);
        Patch<C> patch(whole, source, cut, tile, {});
        const ImageMesh<C>& mesh = patch.mesh();
        const hmesh::Status status = mesh.check();
        REQUIRE_MESSAGE(status, std::string(status.what) << " at " << status.value);
        REQUIRE(mesh.topology().face_count() == triangles.size());
        energy += mesh.energy();

        std::size_t fans = 0, owned = 0;
        for (const auto& [v, sizes] : form.fans) {
            if (cut.owner[v] == tile) ++owned;
            else fans += sizes.size();
        }
        REQUIRE(patch.free_count() == owned);
        REQUIRE(patch.vertex_count() == owned + fans);
        free += owned;
        const PatchFaces numbered = kit::detail::renumber(whole.faces, cut, tile);
        REQUIRE(numbered.locked.size() == fans);
        std::map<std::uint32_t, std::vector<int>> sizes;
        for (std::size_t k = 0; k < fans; ++k) {
            const Vertex v(owned + k);
            const auto& locked = numbered.locked[k];
            REQUIRE(mesh.vertex(v).mobility == Mobility::locked);
            REQUIRE(mesh.topology().valence(v) == locked.face_count + 1);
            REQUIRE(mesh.topology().valence(v) <= mesh.vertex(v).valence_limit);
            REQUIRE(mesh.topology().is_boundary(v));
            room[locked.vertex] += mesh.vertex(v).valence_limit - 1;
            sizes[locked.vertex].push_back(locked.face_count);
        }
        for (auto& [v, list] : sizes) {
            std::sort(list.begin(), list.end());
            REQUIRE(list == form.fans.at(v));
        }
        for (std::size_t k = 0; k < owned; ++k) {
            const Mobility mobility = mesh.vertex(Vertex(k)).mobility;
            REQUIRE(mobility != Mobility::locked);
            REQUIRE(mesh.vertex(Vertex(k)).valence_limit == kit::max_valence);
        }
        // Rim edges inside of the image must stay.
        for (const Edge e : mesh.topology().edges()) {
            const Halfedge h = HalfedgeMesh::halfedge(e);
            const Vertex a = mesh.topology().from_vertex(h), b = mesh.topology().to_vertex(h);
            if (mesh.topology().is_boundary(e) && mesh.edge_mobility(e) == Mobility::locked) {
                REQUIRE(mesh.vertex(a).mobility == Mobility::locked);
                REQUIRE(mesh.vertex(b).mobility == Mobility::locked);
            }
        }
        const double scaled = whole.mean_energy() / (mesh.energy() / static_cast<double>(mesh.vertex_count()));
        patch.set_mean_energy(whole.mean_energy());
        if (mesh.energy() > 1e-6 * whole.energy && scaled < 1e3)
            REQUIRE(mesh.mean_energy() == doctest::Approx(whole.mean_energy()).epsilon(1e-12));

        const PatchResult<C> result = patch.result();
        prove_result(whole, cut, tile, result, true, form);
        REQUIRE(result.energy == mesh.energy());
        prove_result(whole, cut, tile, kit::detail::unchanged(whole, cut, tile), false, form);

        met.holes += form.holes > 0 ? 1 : 0;
        met.pinched += form.pinched > 0 ? 1 : 0;
        met.apart += form.components > 1 ? 1 : 0;
        met.all_locked += owned == 0 ? 1 : 0;
        met.alone += triangles.size() == 1 ? 1 : 0;
        met.narrow += mesh.width() == 1 || mesh.height() == 1 ? 1 : 0;
        met.one_tile += fans == 0 ? 1 : 0;
    }
    REQUIRE(free + cut.locked_vertices.size() == whole.vertex_count());
    REQUIRE(std::abs(energy - whole.energy) <= 1e-9 * whole.energy);
    for (const int triangles : room) REQUIRE(triangles < kit::max_valence);
}

template <class T, int C>
void prove_tilings(const Image<T, C>& image, const IndexedMesh<C>& whole, std::uint64_t seed, Met& met) {
    const ImageSource<C> source(image.view());
    for (const double tile : {1.0, 2.0, 3.0, 5.0, 8.0, 13.0, 29.0, 1000.0})
        prove_patches(source, whole, Tiling(image.width(), image.height(), tile, (seed & 1U) != 0, (seed & 2U) != 0), met);
}

}  // namespace

TEST_CASE("every triangle is in one tile, that of its centroid; vertices are free where all their triangles are") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(50, 37, 1);
    for (const Shape shape : hmesh_test::all_shapes)
        for (const double tile : {1.0, 4.0, 11.0, 25.0, 100.0})
            for (int shift = 0; shift < 4; ++shift) {
                const IndexedMesh<1> whole = make_indexed(image, shape, 80, 3);
                const Tiling tiling(50, 37, tile, (shift & 1) != 0, (shift & 2) != 0);
                const Cut cut = kit::detail::cut(whole.positions, whole.faces, tiling);
                const std::vector<std::size_t> tiles = brute_tiles(whole, tiling);
                REQUIRE(cut.first.size() == tiling.size() + 1);
                REQUIRE((cut.first.front() == 0 && cut.first.back() == whole.faces.size()));
                std::vector<std::uint32_t> listed;
                for (std::size_t k = 0; k < tiling.size(); ++k)
                    for (std::size_t t = cut.first[k]; t < cut.first[k + 1]; ++t) {
                        REQUIRE(tiles[cut.faces[t]] == k);
                        if (t > cut.first[k]) REQUIRE(cut.faces[t - 1] < cut.faces[t]);
                        listed.push_back(cut.faces[t]);
                    }
                std::sort(listed.begin(), listed.end());
                for (std::size_t t = 0; t < listed.size(); ++t) REQUIRE(listed[t] == t);

                std::vector<std::set<std::size_t>> around(whole.vertex_count());
                std::vector<int> count(whole.vertex_count(), 0);
                for (std::size_t t = 0; t < tiles.size(); ++t)
                    for (const std::uint32_t v : whole.faces[t]) around[v].insert(tiles[t]), ++count[v];
                std::vector<std::size_t> free(tiling.size(), 0);
                std::size_t locked = 0;
                for (std::size_t v = 0; v < whole.vertex_count(); ++v) {
                    const bool is_free = around[v].size() == 1;
                    REQUIRE(cut.owner[v] == (is_free ? *around[v].begin() : Cut::locked));
                    REQUIRE(cut.number[v] == (is_free ? free[*around[v].begin()]++ : locked++));
                    REQUIRE(cut.face_count[v] == count[v]);
                }
                REQUIRE(cut.free_count == free);
                REQUIRE(cut.locked_vertices.size() == locked);
                for (std::size_t k = 0; k < locked; ++k) {
                    const std::uint32_t v = cut.locked_vertices[k];
                    REQUIRE(cut.owner[v] == Cut::locked);
                    REQUIRE(cut.number[v] == k);
                }
            }
}

TEST_CASE("a vertex on the cut of a periodic mesh is free in no tile, and has the faces of all its copies") {
    for (const hmesh::Periodic periodic : {hmesh::Periodic::x, hmesh::Periodic::y, hmesh::Periodic::xy})
        for (const double tile : {4.0, 9.0, 100.0}) {
            const IndexedMesh<1> whole = hmesh_test::random_periodic(24, 18, 60, periodic, 4);
            const Cut cut = kit::detail::cut(whole.positions, whole.faces, Tiling(24, 18, tile), whole.roots);
            std::vector<int> count(whole.vertex_count(), 0);
            for (const Triangle& face : whole.faces)
                for (const std::uint32_t v : face) ++count[whole.roots[v]];
            for (std::size_t v = 0; v < whole.vertex_count(); ++v) {
                REQUIRE(cut.face_count[v] == count[whole.roots[v]]);
                if (whole.roots[v] == v) continue;
                REQUIRE(cut.owner[v] == Cut::locked);
                REQUIRE(cut.owner[whole.roots[v]] == Cut::locked);
            }
        }
}

TEST_CASE("patches of irregular meshes are sound, know their rims, sum up to the whole and come back as they went") {
    Met met;
    std::uint64_t seed = 0;
    for (const Shape shape : hmesh_test::all_shapes) {
        const auto bytes = hmesh_test::scene<std::uint8_t, 3>(64, 47, 1 + seed);
        prove_tilings(bytes, make_indexed(bytes, shape, 150, seed), seed, met);
        const auto floats = hmesh_test::scene<float, 1>(38, 60, 2 + seed);
        prove_tilings(floats, make_indexed(floats, shape, 90, seed), seed + 1, met);
        ++seed;
    }
    const auto shorts = hmesh_test::noise<std::uint16_t, 4>(33, 33, 3);
    prove_tilings(shorts, make_indexed(shorts, Shape::delaunay, 90, 3), 3, met);
    CHECK(met.holes > 0);
    CHECK(met.pinched > 100);
    CHECK(met.apart > 100);
    CHECK(met.all_locked > 500);
    CHECK(met.alone > 300);
    CHECK(met.narrow > 5);
    CHECK(met.one_tile >= 11);
}

TEST_CASE("patches of images of one pixel, one row and one column are sound") {
    Met met;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {37, 1}, {2, 2}, {2, 30}}) {
        const auto image = hmesh_test::noise<std::uint8_t, 3>(width, height, 4);
        for (std::uint64_t seed = 0; seed < 4; ++seed)
            prove_tilings(image, make_indexed(image, seed < 2 ? Shape::grid : Shape::scattered, 25, seed), seed, met);
    }
    CHECK(met.narrow > 50);
}

TEST_CASE("a hub whose many spokes lie in many tiles is held once a fan, and its fans share the bound of its edges") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(80, 80, 5);
    Met met;
    for (const int spokes : {8, 20, 36}) {
        const auto wheel = hmesh_test::wheel(80, spokes);
        const IndexedMesh<1> whole = make_indexed(image, wheel, 1);
        for (std::uint64_t seed = 0; seed < 4; ++seed) prove_tilings(image, whole, seed, met);
    }
    CHECK(met.pinched > 10);
}

TEST_CASE("a patch with a hole, the island of another tile, is sound") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(64, 40, 5);
    const IndexedMesh<3> whole = make_indexed(image, hmesh_test::island(), 1);
    Met met;
    prove_patches(ImageSource<3>(image.view()), whole, Tiling(64, 40, 32), met);
    CHECK(met.holes == 1);
    CHECK(met.apart == 1);  // the island is no neighbour of its tile's other faces
}

TEST_CASE("patches of an image with weights sum up to the whole") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(48, 40, 6);
    const auto weights = hmesh_test::random_weights(48, 40, 7);
    const double unit = kit::weight_unit(weights.view());
    const ImageSource<3> source(image.view(), weights.view(), unit);
    IndexedMesh<3> whole = make_indexed(image, Shape::worn, 90, 8);
    const auto table = source.table({0, 0, 48, 40});
    ImageMesh<3> one(table, source.low(), source.high());
    REQUIRE(one.assign(whole.positions, whole.faces, whole.colors, {}));
    REQUIRE(std::abs(one.energy() - whole.energy) > 0.1 * whole.energy);  // without weights it is another
    whole.energy = one.energy();
    Met met;
    for (const double tile : {4.0, 12.0, 30.0, 100.0}) prove_patches(source, whole, Tiling(48, 40, tile, true, false), met);
}

TEST_CASE("patches over the table of the whole image are those with tables of their own") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 30, 9);
    const IndexedMesh<3> whole = make_indexed(image, Shape::worn, 60, 9);
    const ImageSource<3> source(image.view());
    const auto table = source.table({0, 0, 40, 30});
    for (const double size : {100.0, 20.0}) {
        const Tiling tiling(40, 30, size);
        const Cut cut = kit::detail::cut(whole.positions, whole.faces, tiling);
        double energy = 0;
        for (std::size_t tile = 0; tile < tiling.size(); ++tile) {
            Patch<3> shared(whole, source, cut, tile, {}, &table);
            CHECK(shared.mesh().check());
            CHECK(shared.mesh().width() == 40);
            Patch<3> own(whole, source, cut, tile, {});
            CHECK(shared.mesh().energy() == doctest::Approx(own.mesh().energy()).epsilon(1e-12));
            CHECK(shared.first_energy() == shared.mesh().energy());
            energy += shared.mesh().energy();
            auto a = shared.result(), b = own.result();
            const auto by_place = [](const Point& p, const Point& q) { return std::pair{p.x, p.y} < std::pair{q.x, q.y}; };
            std::sort(a.positions.begin(), a.positions.end(), by_place);
            std::sort(b.positions.begin(), b.positions.end(), by_place);
            CHECK(a.positions == b.positions);
            CHECK(a.faces.size() == b.faces.size());
            CHECK(a.locked == b.locked);
        }
        CHECK(energy == doctest::Approx(whole.energy).epsilon(1e-12));
    }
}

namespace {

// The energy of a patch at `origin` pixel by pixel.
template <class T, int C>
double brute_energy(const Image<T, C>& image, const ImageMesh<C>& mesh, Point origin) {
    double energy = 0;
    for (const kit::Face f : mesh.topology().faces()) {
        auto v = mesh.topology().vertices(f);
        kit::VertexState<C> state[3];
        for (std::size_t k = 0; k < 3; ++k) {
            state[k] = mesh.vertex(v[k]);
            state[k].position = {state[k].position.x + origin.x, state[k].position.y + origin.y};
        }
        energy += hmesh_test::brute_energy(image, state[0], state[1], state[2]);
    }
    return energy;
}

// Edits in nested transactions, ended at random; rollbacks give back what was.
template <int C>
void transact(ImageMesh<C>& mesh, double range, Random& random, int depth, int& edits) {
    const hmesh_test::Snapshot before = hmesh_test::snapshot(mesh);
    const auto mark = mesh.begin();
    for (std::size_t k = 1 + random.below(12); k > 0; --k, ++edits) {
        if (depth < 3 && random.below(8) == 0) transact(mesh, range, random, depth + 1, edits);
        hmesh_test::random_free_edit(mesh, range, random);
    }
    if (random.below(3) == 0) return mesh.commit(mark);
    mesh.rollback(mark);
    REQUIRE(hmesh_test::snapshot(mesh) == before);
}

template <class T, int C>
void torture(const Image<T, C>& image, const IndexedMesh<C>& whole, double tile_size, int rounds, std::uint64_t seed) {
    const double range = hmesh::PixelTraits<T>::peak;
    const ImageSource<C> source(image.view());
    const Tiling tiling(image.width(), image.height(), tile_size, (seed & 1U) != 0, (seed & 2U) != 0);
    const Cut cut = kit::detail::cut(whole.positions, whole.faces, tiling);
    const double squares = hmesh_test::squares(image);  // a patch may own no pixel, and have rounding for an energy
    Random random(seed);
    for (std::size_t tile = 0; tile < tiling.size(); ++tile) {
        const std::vector<Triangle> triangles = triangles_of(whole, cut, tile);
        if (triangles.empty()) continue;
        Patch<C> patch(whole, source, cut, tile, {});
        ImageMesh<C>& mesh = patch.mesh();
        Point low{1e9, 1e9};
        for (const Triangle& t : triangles)
            for (const std::uint32_t v : t) low = {std::min(low.x, whole.positions[v].x), std::min(low.y, whole.positions[v].y)};
        const Point origin{std::floor(low.x), std::floor(low.y)};

        std::vector<std::pair<Vertex, Vertex>> rim;
        for (const Edge e : mesh.topology().edges()) {
            const Halfedge h = HalfedgeMesh::halfedge(e);
            if (mesh.topology().is_boundary(e) && mesh.edge_mobility(e) == Mobility::locked)
                rim.emplace_back(mesh.topology().from_vertex(h), mesh.topology().to_vertex(h));
        }
        std::vector<std::pair<Vertex, kit::VertexState<C>>> locked;
        for (const Vertex v : mesh.topology().vertices())
            if (mesh.vertex(v).mobility == Mobility::locked) locked.emplace_back(v, mesh.vertex(v));

        int edits = 0;
        for (int round = 0; round < rounds; ++round) {
            transact(mesh, range, random, 1, edits);
            if (round % 8 != 7) continue;
            const hmesh::Status status = mesh.check();
            REQUIRE_MESSAGE(status, std::string(status.what) << " at " << status.value);
            const double brute = brute_energy(image, mesh, origin);
            REQUIRE(std::abs(mesh.energy() - brute) <= 1e-9 * brute + 1e-13 * squares);
        }
        REQUIRE(edits >= 5 * rounds);
        for (const auto& [v, state] : locked) {
            REQUIRE_FALSE(mesh.topology().is_deleted(v));
            REQUIRE(mesh.position(v) == state.position);
            for (int k = 0; k < C; ++k) REQUIRE(mesh.color(v)[k] == state.color[k]);
        }
        for (const auto& [a, b] : rim) {
            const Halfedge h = mesh.topology().find_halfedge(a, b);
            REQUIRE(h.is_valid());
            REQUIRE(mesh.topology().is_boundary(HalfedgeMesh::edge(h)));
        }
        for (const Vertex v : mesh.topology().vertices()) REQUIRE(mesh.topology().valence(v) <= mesh.vertex(v).valence_limit);
    }
}

}  // namespace

TEST_CASE("a patch stays true to its pixels, and its rim stays, through thousands of random edits and rollbacks") {
    const auto scene = hmesh_test::scene<std::uint8_t, 3>(64, 40, 1);
    torture(scene, make_indexed(scene, Shape::worn, 120, 1), 28, 100, 1);
    torture(scene, make_indexed(scene, hmesh_test::island(), 2), 32, 200, 0);
    const auto bytes = hmesh_test::noise<std::uint8_t, 1>(40, 44, 2);
    torture(bytes, make_indexed(bytes, Shape::delaunay, 90, 2), 21, 100, 2);
    const auto floats = hmesh_test::scene<float, 2>(40, 30, 3);
    torture(floats, make_indexed(floats, Shape::scattered, 70, 3), 15, 60, 3);
    torture(floats, make_indexed(floats, Shape::scattered, 60, 4), 3, 16, 1);  // most are pinched or in several parts
    const auto shorts = hmesh_test::noise<std::uint16_t, 4>(30, 30, 4);
    torture(shorts, make_indexed(shorts, Shape::slivers, 50, 5), 15, 60, 2);
}
