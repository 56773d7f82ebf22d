// hmesh tests - meshes of whole images between two phases of work: irregular ones, and what there is to know of them.
#ifndef HMESH_TESTS_TEST_INDEXED_MESHES_HPP
#define HMESH_TESTS_TEST_INDEXED_MESHES_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/tiles/delaunay_mesh.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/recut.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace hmesh_test {

namespace kit = hmesh::kit;

// --- meshes ---

// The mesh as arrays; of each vertex chance decides whether it is due, and how its colour differs from the mesh's.
template <int C>
kit::IndexedMesh<C> indexed_of(const kit::ImageMesh<C>& mesh, double range, std::uint64_t seed) {
    kit::Random random(seed);
    kit::IndexedMesh<C> whole;
    whole.width = mesh.width();
    whole.height = mesh.height();
    for (const kit::Vertex v : mesh.topology().vertices()) {
        kit::Color<C> color = mesh.color(v);
        for (int k = 0; k < C; ++k) color.set(k, color[k] + 0.05 * range * (random.uniform() - 0.5));
        whole.add(mesh.position(v), color);
        whole.dirty.back() = random.below(2) == 0 ? 1 : 0;
    }
    whole.faces = mesh.topology().triangles();
    return whole;
}

// Whether the circle through the corners of e's first face holds the far corner of its second.
template <int C>
bool breaks_delaunay(const kit::ImageMesh<C>& mesh, kit::Edge e) {
    const kit::HalfedgeMesh& topology = mesh.topology();
    const kit::Halfedge h = kit::HalfedgeMesh::halfedge(e), o = kit::HalfedgeMesh::opposite(h);
    const kit::Point d = mesh.position(topology.to_vertex(topology.next(o)));
    double x[3], y[3], z[3];
    const auto v = topology.vertices(topology.face(h));
    for (std::size_t k = 0; k < 3; ++k) {
        x[k] = mesh.position(v[k]).x - d.x;
        y[k] = mesh.position(v[k]).y - d.y;
        z[k] = x[k] * x[k] + y[k] * y[k];
    }
    const double inside =
        z[0] * (x[1] * y[2] - x[2] * y[1]) - z[1] * (x[0] * y[2] - x[2] * y[0]) + z[2] * (x[0] * y[1] - x[1] * y[0]);
    return inside > 1e-6 * (z[0] + z[1] + z[2]);
}

// `count` random vertices one after another, inside or on the border, each in the face that happens to be there: many
// slivers. With `delaunay`, edges are turned afterwards until almost all circles are empty.
template <int C>
void scatter(kit::ImageMesh<C>& mesh, int count, bool delaunay, std::uint64_t seed) {
    const kit::HalfedgeMesh& topology = mesh.topology();
    kit::Random random(seed);
    for (int k = 0; k < count; ++k) {
        if (random.below(6) == 0) {
            const kit::Edge e = any_edge(mesh, random);
            kit::RingScratch<C> work;
            const auto candidate = kit::edge_candidate(mesh, work, e, false);
            if (candidate.fits && kit::can_gain_edge(mesh, candidate)) kit::insert(mesh, candidate);
            continue;
        }
        const kit::Point p = kit::snap(kit::Point{mesh.width() * random.uniform(), mesh.height() * random.uniform()});
        for (const kit::Face f : topology.faces()) {
            const auto v = topology.vertices(f);
            bool fits = true;
            for (std::size_t i = 0; i < 3; ++i)
                if (!(kit::orient2d(mesh.position(v[i]), mesh.position(v[(i + 1) % 3]), p) >= mesh.limits().min_double_area) ||
                    !mesh.can_gain_edge(v[i]))
                    fits = false;
            if (!fits) continue;
            mesh.split(f, p, mesh.color(v[0]));
            break;
        }
    }
    for (int round = 0; delaunay && round < 20; ++round)
        for (const kit::Edge e : topology.edges()) {
            if (!kit::can_flip(mesh, e) || !breaks_delaunay(mesh, e)) continue;
            kit::FlipTrial<C> trial;
            kit::evaluate_flip(mesh, e, trial);
            mesh.flip(e, trial.moments, trial.own, trial.opposite);
        }
}

enum class Shape { grid, worn, delaunay, scattered, slivers };
inline constexpr std::array<Shape, 5> all_shapes = {Shape::grid, Shape::worn, Shape::delaunay, Shape::scattered, Shape::slivers};

// A mesh of 64 x 40 px whose face 1, 2, 3 has its centroid to the right of x = 32, while all other faces that touch it
// have theirs to the left.
inline Triangulation island() {
    Triangulation mesh;
    mesh.positions = {{46, 20}, {44, 20}, {30, 18}, {26, 21}, {0, 0}, {0, 40}, {64, 0}, {64, 40}};
    mesh.triangles = {{1, 2, 3}, {1, 0, 4}, {1, 5, 0}, {1, 4, 2}, {1, 3, 5},
                      {2, 4, 3}, {3, 4, 5}, {0, 4, 6}, {0, 6, 7}, {0, 7, 5}};
    for (hmesh::Triangle& t : mesh.triangles)
        if (kit::orient2d(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) < 0) std::swap(t[1], t[2]);
    return mesh;
}

// A triangulation of the image with colours and due vertices as in indexed_of(), its energy known.
template <class T, int C>
kit::IndexedMesh<C> make_indexed(const hmesh::Image<T, C>& image, const Triangulation& triangulation, std::uint64_t seed) {
    Subject<T, C> subject(image, triangulation);
    kit::IndexedMesh<C> whole = indexed_of(subject.mesh, hmesh::PixelTraits<T>::peak, seed);
    REQUIRE(subject.mesh.assign(whole.positions, whole.faces, whole.colors, {}));
    whole.energy = subject.mesh.energy();
    return whole;
}

// A mesh over the image of about `count` vertices, its energy known.
template <class T, int C>
kit::IndexedMesh<C> make_indexed(const hmesh::Image<T, C>& image, Shape shape, int count, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    const double spacing = std::sqrt(static_cast<double>(width) * height / count);
    const auto cells = [&](int side) { return std::max(1, std::min(side, static_cast<int>(side / spacing))); };
    const bool few = shape == Shape::delaunay || shape == Shape::scattered;
    const bool longish = shape == Shape::slivers;  // across the whole image
    const int columns = few ? 1 : longish ? 2 : cells(width);
    const int rows = few ? 1 : longish ? std::min(height, count / 3 + 1) : cells(height);
    Subject<T, C> subject(image, jittered_grid(width, height, columns, rows, seed));
    const double range = hmesh::PixelTraits<T>::peak;
    if (shape == Shape::worn) wear(subject.mesh, 3 * count, range, seed);
    if (few) scatter(subject.mesh, count, shape == Shape::delaunay, seed);
    kit::IndexedMesh<C> whole = indexed_of(subject.mesh, range, seed);
    REQUIRE(subject.mesh.assign(whole.positions, whole.faces, whole.colors, {}));
    whole.energy = subject.mesh.energy();
    return whole;
}

// A periodic mesh of random points, whose cut is along the sides.
inline kit::IndexedMesh<1> random_periodic(int width, int height, int points, hmesh::Periodic periodic, std::uint64_t seed) {
    kit::Random random(seed);
    kit::Delaunay delaunay(width, height);
    for (int k = 0; k < points; ++k) {
        kit::Point p = kit::snap(kit::Point{random.uniform() * width, random.uniform() * height});
        if (k % 3 == 0) p.x = 0;
        if (k % 5 == 0) p.y = 0;
        (void)delaunay.insert(p);
    }
    kit::pair_sides(delaunay, periodic);
    const auto image = noise<std::uint8_t, 1>(width, height, seed);
    const auto view = image.view();
    kit::IndexedMesh<1> mesh = kit::delaunay_mesh(kit::ImageSource<1>(view), delaunay);
    kit::tie(mesh, periodic);
    return mesh;
}

// --- what is true of a mesh whatever its vertices' numbers ---

template <int C>
using Corner = std::array<double, 2 + C>;  // position and colour
template <int C>
using Corners = std::array<Corner<C>, 3>;

template <int C>
Corner<C> corner_of(kit::Point position, const kit::Color<C>& color) {
    Corner<C> corner{position.x, position.y};
    for (int k = 0; k < C; ++k) corner[static_cast<std::size_t>(2 + k)] = color[k];
    return corner;
}
template <int C>
Corner<C> corner_of(const kit::IndexedMesh<C>& whole, std::size_t v) {
    return corner_of<C>(whole.positions[v], whole.colors[v]);
}

// The corners in the order that the face turns, the least one first.
template <int C>
Corners<C> turned(Corners<C> corners) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners;
}
template <int C>
Corners<C> corners_of(const kit::IndexedMesh<C>& whole, const hmesh::Triangle& t) {
    return turned<C>({corner_of(whole, t[0]), corner_of(whole, t[1]), corner_of(whole, t[2])});
}

// All triangles, and all vertices with whether they are due.
template <int C>
struct Description {
    std::vector<Corners<C>> triangles;
    std::vector<std::pair<Corner<C>, bool>> vertices;
    friend bool operator==(const Description& a, const Description& b) {
        return a.triangles == b.triangles && a.vertices == b.vertices;
    }
};
template <int C>
Description<C> describe(const kit::IndexedMesh<C>& whole) {
    Description<C> out;
    for (const hmesh::Triangle& t : whole.faces) out.triangles.push_back(corners_of(whole, t));
    for (std::size_t v = 0; v < whole.vertex_count(); ++v) out.vertices.emplace_back(corner_of(whole, v), whole.dirty[v] != 0);
    std::sort(out.triangles.begin(), out.triangles.end());
    std::sort(out.vertices.begin(), out.vertices.end());
    return out;
}

// Equal in every number, vertices and triangles in the same order.
template <int C>
bool same_bytes(const kit::IndexedMesh<C>& a, const kit::IndexedMesh<C>& b) {
    // Not ==, for which 0 and -0 are the same.
    const auto same = [](double x, double y) { return std::memcmp(&x, &y, sizeof(double)) == 0; };
    if (a.width != b.width || a.height != b.height || a.vertex_count() != b.vertex_count()) return false;
    if (a.colors.size() != b.colors.size() || a.dirty != b.dirty || a.faces != b.faces) return false;
    for (std::size_t v = 0; v < a.vertex_count(); ++v) {
        if (!same(a.positions[v].x, b.positions[v].x) || !same(a.positions[v].y, b.positions[v].y)) return false;
        for (int k = 0; k < kit::lanes_for(C + 1); ++k)
            if (!same(a.colors[v][k], b.colors[v][k])) return false;
    }
    return same(a.energy, b.energy);
}

// --- proofs ---

template <int C>
void prove(const kit::IndexedMesh<C>& whole) {
    const hmesh::Status status = kit::check(whole);
    REQUIRE_MESSAGE(status, std::string(status.what) << " at " << status.value);
}

// The energy of the whole in one piece, over one table.
template <class T, int C>
double fresh_energy(const hmesh::Image<T, C>& image, const kit::IndexedMesh<C>& whole) {
    Subject<T, C> subject(image);
    REQUIRE(subject.mesh.assign(whole.positions, whole.faces, whole.colors, {}));
    return subject.mesh.energy();
}

// --- chance ---

// One edit picked by chance, good or bad for the energy, as the parts of a mesh allow it: locked vertices stay.
template <int C>
void random_free_edit(kit::ImageMesh<C>& mesh, double range, kit::Random& random) {
    kit::RingScratch<C> work;
    switch (random.below(6)) {
        case 0:
        case 1: {
            const kit::Vertex v = any_vertex(mesh, random);
            if (mesh.vertex(v).mobility == kit::Mobility::locked) return;
            const kit::Point p = any_place(mesh, v, 3, random);
            mesh.place(v, p, any_color(mesh, v, range, random));
            return;
        }
        case 2: {
            const kit::Edge e = any_edge(mesh, random);
            if (!kit::can_flip(mesh, e)) return;
            kit::FlipTrial<C> trial;
            kit::evaluate_flip(mesh, e, trial);
            mesh.flip(e, trial.moments, trial.own, trial.opposite);
            return;
        }
        case 3: {
            const bool in_edge = random.below(2) == 0, may_move = random.below(2) == 0;
            const auto candidate = in_edge ? kit::edge_candidate(mesh, work, any_edge(mesh, random), may_move)
                                           : kit::face_candidate(mesh, work, any_face(mesh, random), may_move);
            if (candidate.fits && kit::can_gain_edge(mesh, candidate)) kit::insert(mesh, candidate);
            return;
        }
        case 4: {
            const auto candidate = kit::cheapest_collapse(mesh, work, any_vertex(mesh, random));
            if (candidate.halfedge.is_valid()) mesh.collapse(candidate.halfedge);
            return;
        }
        default: {
            if (random.below(2) == 0) kit::improve_vertex(mesh, any_vertex(mesh, random), 0);
            else kit::improve_edge(mesh, any_edge(mesh, random), 0);
            return;
        }
    }
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_INDEXED_MESHES_HPP
