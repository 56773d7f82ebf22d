// hmesh tests - meshes over small images, and their energy by brute force.
//
// The brute force takes each pixel centre, finds the face that owns it and interpolates the corners' colours there, all
// in plain doubles: it shares nothing with moments and prefix sums.
#ifndef HMESH_TESTS_TEST_MESHES_HPP
#define HMESH_TESTS_TEST_MESHES_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/image/image_view.hpp"
#include "same_bytes.hpp"
#include "test_images.hpp"
#include "test_kit.hpp"

namespace hmesh_test {

// --- triangulations of [0, width] x [0, height] ---

struct Triangulation {
    std::vector<hmesh::kit::Point> positions;
    std::vector<hmesh::Triangle> triangles;
};

// columns x rows cells, their inner corners moved by up to `jitter` < 0.25 cells, diagonals at random.
inline Triangulation jittered_grid(int width, int height, int columns, int rows, std::uint64_t seed, double jitter = 0.2) {
    hmesh::kit::Random random(seed);
    Triangulation grid;
    const double dx = static_cast<double>(width) / columns, dy = static_cast<double>(height) / rows;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double u = 2 * random.uniform() - 1, v = 2 * random.uniform() - 1;
            const double x = i == 0 ? 0 : i == columns ? width : (i + jitter * u) * dx;
            const double y = j == 0 ? 0 : j == rows ? height : (j + jitter * v) * dy;
            grid.positions.push_back(hmesh::kit::snap(hmesh::kit::Point{x, y}));
        }
    const auto at = [columns](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            if (random.below(2) == 0) {
                grid.triangles.push_back({a, b, c});
                grid.triangles.push_back({a, c, d});
            } else {
                grid.triangles.push_back({a, b, d});
                grid.triangles.push_back({b, c, d});
            }
        }
    return grid;
}

// Vertex 0 in the middle of a side x side square, vertices 1 .. spokes on a circle around it, then the four corners.
// `spokes` is a multiple of 4; the four chords on the square's diagonals can be turned into the hub.
inline Triangulation wheel(int side, int spokes) {
    Triangulation mesh;
    const double middle = 0.5 * side, turn = 6.283185307179586 / spokes;
    mesh.positions.push_back({middle, middle});
    for (int k = 0; k < spokes; ++k)  // half a step off the diagonals of the square
        mesh.positions.push_back(
            hmesh::kit::snap(hmesh::kit::Point{middle + 0.3 * side * std::cos((k + 0.5) * turn + 0.125 * 6.283185307179586),
                                               middle + 0.3 * side * std::sin((k + 0.5) * turn + 0.125 * 6.283185307179586)}));
    const double s = side;
    for (const hmesh::kit::Point corner : {hmesh::kit::Point{s, s}, {0, s}, {0, 0}, {s, 0}}) mesh.positions.push_back(corner);
    const auto rim = [spokes](int k) { return static_cast<std::uint32_t>(1 + k % spokes); };
    const auto corner = [spokes](int q) { return static_cast<std::uint32_t>(1 + spokes + q % 4); };
    // Chord k joins rim k and rim k + 1; chord spokes - 1 faces corner 0, and so on round.
    const auto nearest = [spokes](int k) { return ((k + 1) * 4 + spokes / 2) / spokes; };
    for (int k = 0; k < spokes; ++k) {
        mesh.triangles.push_back({0, rim(k), rim(k + 1)});
        mesh.triangles.push_back({rim(k + 1), rim(k), corner(nearest(k))});
        if (nearest(k) % 4 != nearest(k + 1) % 4)
            mesh.triangles.push_back({rim(k + 1), corner(nearest(k)), corner(nearest(k + 1))});
    }
    return mesh;
}

// The image with its samples times `factor`.
template <int C>
hmesh::Image<float, C> scaled(hmesh::Image<float, C> image, double factor) {
    for_each_sample(image, [&](float& sample) { sample = static_cast<float>(factor * static_cast<double>(sample)); });
    return image;
}

// An image, its table, and a mesh over it.
template <class T, int C>
struct Subject {
    hmesh::Image<T, C> image;
    hmesh::kit::MomentTable<C> table;
    hmesh::kit::ImageMesh<C> mesh;

    explicit Subject(hmesh::Image<T, C> picture, const hmesh::MeshLimits& limits = {})
        : image(std::move(picture)), table(image.view(), image.view().bounds()),
          mesh(table, hmesh::PixelTraits<T>::lowest, hmesh::PixelTraits<T>::highest, limits) {}
    Subject(hmesh::Image<T, C> picture, const Triangulation& triangulation, const hmesh::MeshLimits& limits = {})
        : Subject(std::move(picture), limits) {
        REQUIRE(mesh.assign(triangulation.positions, triangulation.triangles));
    }
    Subject(const Subject&) = delete;
    Subject& operator=(const Subject&) = delete;
};

// --- brute force ---

// Whether the positively oriented face a, b, c owns pixel (i, j): its centre is inside, or on a left or level top side.
inline bool owns(hmesh::kit::Point a, hmesh::kit::Point b, hmesh::kit::Point c, int i, int j) {
    const hmesh::kit::Point corner[4] = {a, b, c, a};
    const double x = i + 0.5, y = j + 0.5;
    for (int k = 0; k < 3; ++k) {
        const double dx = corner[k + 1].x - corner[k].x, dy = corner[k + 1].y - corner[k].y;
        const double side = dx * (y - corner[k].y) - dy * (x - corner[k].x);
        if (side < 0 || (side == 0 && !(dy < 0 || (dy == 0 && dx > 0)))) return false;
    }
    return true;
}

// Calls visit(i, j) for each pixel of a width x height image that the face a, b, c owns.
template <class Visit>
void for_each_pixel(int width, int height, hmesh::kit::Point a, hmesh::kit::Point b, hmesh::kit::Point c, Visit&& visit) {
    const int i0 = std::max(0, static_cast<int>(std::min({a.x, b.x, c.x})) - 1);
    const int j0 = std::max(0, static_cast<int>(std::min({a.y, b.y, c.y})) - 1);
    const int i1 = std::min(width, static_cast<int>(std::max({a.x, b.x, c.x})) + 2);
    const int j1 = std::min(height, static_cast<int>(std::max({a.y, b.y, c.y})) + 2);
    for (int j = j0; j < j1; ++j)
        for (int i = i0; i < i1; ++i)
            if (owns(a, b, c, i, j)) visit(i, j);
}

// The picture of the face a, b, c at (x, y), in channel k.
template <int C>
double interpolate(const hmesh::kit::VertexState<C>& a, const hmesh::kit::VertexState<C>& b, const hmesh::kit::VertexState<C>& c,
                   double x, double y, int k) {
    const double ux = b.position.x - a.position.x, uy = b.position.y - a.position.y;
    const double vx = c.position.x - a.position.x, vy = c.position.y - a.position.y;
    const double px = x - a.position.x, py = y - a.position.y, area = ux * vy - uy * vx;
    const double s = (px * vy - py * vx) / area, t = (ux * py - uy * px) / area;
    return (1 - s - t) * a.color[k] + s * b.color[k] + t * c.color[k];
}

template <class T, int C>
double brute_energy(const hmesh::Image<T, C>& image, const hmesh::kit::VertexState<C>& a, const hmesh::kit::VertexState<C>& b,
                    const hmesh::kit::VertexState<C>& c) {
    double energy = 0;
    for_each_pixel(image.width(), image.height(), a.position, b.position, c.position, [&](int i, int j) {
        for (int k = 0; k < C; ++k) {
            const double residual = interpolate(a, b, c, i + 0.5, j + 0.5, k) - static_cast<double>(image.pixel(i, j)[k]);
            energy += residual * residual;
        }
    });
    return energy;
}

template <class T, int C>
double brute_energy(const Subject<T, C>& subject, hmesh::kit::Face f) {
    const auto v = subject.mesh.topology().vertices(f);
    return brute_energy(subject.image, subject.mesh.vertex(v[0]), subject.mesh.vertex(v[1]), subject.mesh.vertex(v[2]));
}

template <class T, int C>
double brute_energy(const Subject<T, C>& subject) {
    double energy = 0;
    for (const hmesh::kit::Face f : subject.mesh.topology().faces()) energy += brute_energy(subject, f);
    return energy;
}

// How many faces own each pixel, row after row.
template <int C>
std::vector<int> owners(const hmesh::kit::ImageMesh<C>& mesh) {
    std::vector<int> count(static_cast<std::size_t>(mesh.width()) * static_cast<std::size_t>(mesh.height()), 0);
    for (const hmesh::kit::Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        for_each_pixel(mesh.width(), mesh.height(), mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2]),
                       [&](int i, int j) { ++count[static_cast<std::size_t>(j * mesh.width() + i)]; });
    }
    return count;
}

template <class T, int C>
double squares(const hmesh::Image<T, C>& image) {
    double sum = 0;
    for (const T sample : samples_of(image)) sum += static_cast<double>(sample) * static_cast<double>(sample);
    return sum;
}

// What rounding may do to an energy: it is a difference of sums as large as the squares of the picture.
template <class T, int C>
double rounding(const Subject<T, C>& subject) {
    return 1e-9 * std::abs(subject.mesh.energy()) + 1e-12 * squares(subject.image);
}

// The mesh is what it claims to be: valid, each pixel in one face, and its energy that of its pixels.
template <class T, int C>
void prove(const Subject<T, C>& subject) {
    const hmesh::Status status = subject.mesh.check();
    REQUIRE_MESSAGE(status, status.what << " at " << status.value);
    const std::vector<int> count = owners(subject.mesh);
    REQUIRE(std::count(count.begin(), count.end(), 1) == static_cast<std::ptrdiff_t>(count.size()));
    REQUIRE(std::abs(subject.mesh.energy() - brute_energy(subject)) <= rounding(subject));
}

// --- everything a mesh shows, to compare byte by byte ---

struct Snapshot {
    std::vector<std::size_t> indices;
    std::vector<double> numbers;
    friend bool operator==(const Snapshot& a, const Snapshot& b) {
        return a.indices == b.indices && same_bytes(a.numbers, b.numbers);
    }
};

template <int C>
Snapshot snapshot(const hmesh::kit::ImageMesh<C>& mesh) {
    using hmesh::kit::HalfedgeMesh;
    const HalfedgeMesh& topology = mesh.topology();
    Snapshot s;
    const auto put = [&s](const auto& lanes, int n) {
        for (int k = 0; k < n; ++k) s.numbers.push_back(lanes[k]);
    };
    const int n = hmesh::kit::lanes_for(C + 1);
    s.indices = {topology.vertex_count(), topology.edge_count(), topology.face_count(),
                 topology.vertex_slots(), topology.edge_slots(), topology.face_slots()};
    for (std::size_t i = 0; i < topology.vertex_slots(); ++i) {
        const hmesh::kit::Vertex v(i);
        s.indices.push_back(topology.halfedge(v).index());
        s.indices.push_back(static_cast<std::size_t>(mesh.vertex(v).mobility));
        s.numbers.push_back(mesh.position(v).x);
        s.numbers.push_back(mesh.position(v).y);
        put(mesh.color(v), n);
    }
    for (std::size_t i = 0; i < 2 * topology.edge_slots(); ++i) {
        const hmesh::kit::Halfedge h(i);
        s.indices.push_back(topology.next(h).index());
        s.indices.push_back(topology.to_vertex(h).index());
        s.indices.push_back(topology.face(h).index());
        hmesh::kit::Moments<C> m;
        mesh.moments(h, m);
        put(m.s, n), put(m.sx, n), put(m.sy, n), put(m.q, 4);
    }
    for (std::size_t i = 0; i < topology.face_slots(); ++i) {
        s.indices.push_back(topology.halfedge(hmesh::kit::Face(i)).index());
        s.numbers.push_back(mesh.energy(hmesh::kit::Face(i)));
    }
    s.numbers.push_back(mesh.energy());
    return s;
}

// --- chance ---

template <int C>
hmesh::kit::Vertex any_vertex(const hmesh::kit::ImageMesh<C>& mesh, hmesh::kit::Random& random) {
    for (;;) {
        const hmesh::kit::Vertex v(random.below(mesh.topology().vertex_slots()));
        if (!mesh.topology().is_deleted(v)) return v;
    }
}
template <int C>
hmesh::kit::Edge any_edge(const hmesh::kit::ImageMesh<C>& mesh, hmesh::kit::Random& random) {
    for (;;) {
        const hmesh::kit::Edge e(random.below(mesh.topology().edge_slots()));
        if (!mesh.topology().is_deleted(e)) return e;
    }
}
template <int C>
hmesh::kit::Face any_face(const hmesh::kit::ImageMesh<C>& mesh, hmesh::kit::Random& random) {
    for (;;) {
        const hmesh::kit::Face f(random.below(mesh.topology().face_slots()));
        if (!mesh.topology().is_deleted(f)) return f;
    }
}

// A place where v may be, up to about `reach` px away; where it is when 20 tries find no other.
template <int C>
hmesh::kit::Point any_place(const hmesh::kit::ImageMesh<C>& mesh, hmesh::kit::Vertex v, double reach,
                            hmesh::kit::Random& random) {
    hmesh::kit::RingScratch<C> work;
    mesh.gather(v, work.ring, work.spokes);
    const hmesh::kit::Point here = mesh.position(v);
    if (mesh.vertex(v).mobility == hmesh::kit::Mobility::corner) return here;
    for (int tries = 0; tries < 20; ++tries) {
        const hmesh::kit::Mobility mobility = mesh.vertex(v).mobility;
        const double dx = reach * (2 * random.uniform() - 1), dy = reach * (2 * random.uniform() - 1);
        const hmesh::kit::Point p = mesh.clamp({mobility == hmesh::kit::Mobility::along_y ? here.x : here.x + dx,
                                                mobility == hmesh::kit::Mobility::along_x ? here.y : here.y + dy},
                                               mobility);
        if (work.ring.accepts(p, mesh.limits().min_double_area)) return p;
    }
    return here;
}

// A colour near the picture under v, up to a tenth of `range` off.
template <int C>
hmesh::kit::Color<C> any_color(const hmesh::kit::ImageMesh<C>& mesh, hmesh::kit::Vertex v, double range,
                               hmesh::kit::Random& random) {
    const hmesh::kit::Point p = mesh.position(v);
    hmesh::kit::Color<C> color;
    mesh.table().pixel(std::min(static_cast<int>(p.x), mesh.width() - 1), std::min(static_cast<int>(p.y), mesh.height() - 1),
                       color);
    for (int k = 0; k < C; ++k) color.set(k, color[k] + 0.2 * range * (random.uniform() - 0.5));
    return color;
}

// One edit picked by chance, good or bad for the energy: move, turn, insert or remove.
template <int C>
void random_edit(hmesh::kit::ImageMesh<C>& mesh, double range, hmesh::kit::Random& random) {
    hmesh::kit::RingScratch<C> work;
    switch (random.below(5)) {
        case 0: {
            const hmesh::kit::Vertex v = any_vertex(mesh, random);
            const hmesh::kit::Point p = any_place(mesh, v, 3, random);
            mesh.place(v, p, any_color(mesh, v, range, random));
            return;
        }
        case 1: {
            const hmesh::kit::Edge e = any_edge(mesh, random);
            if (!hmesh::kit::can_flip(mesh, e)) return;
            hmesh::kit::FlipTrial<C> trial;
            hmesh::kit::evaluate_flip(mesh, e, trial);
            mesh.flip(e, trial.moments, trial.own, trial.opposite);
            return;
        }
        case 2: {
            const bool in_edge = random.below(2) == 0, may_move = random.below(2) == 0;
            const auto candidate = in_edge ? hmesh::kit::edge_candidate(mesh, work, any_edge(mesh, random), may_move)
                                           : hmesh::kit::face_candidate(mesh, work, any_face(mesh, random), may_move);
            if (candidate.fits && hmesh::kit::can_gain_edge(mesh, candidate)) hmesh::kit::insert(mesh, candidate);
            return;
        }
        default: {  // as often as insertions happen
            if (random.below(2) != 0) return;
            const auto candidate = hmesh::kit::cheapest_collapse(mesh, work, any_vertex(mesh, random));
            if (candidate.halfedge.is_valid()) mesh.collapse(candidate.halfedge);
            return;
        }
    }
}

// Irregular valences, slivers, reused slots.
template <int C>
void wear(hmesh::kit::ImageMesh<C>& mesh, int edits, double range, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    for (int k = 0; k < edits; ++k) random_edit(mesh, range, random);
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_MESHES_HPP
