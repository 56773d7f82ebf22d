// Test data shared by the tests of fit/: images, and meshes over them that are valid but not nice.
#ifndef HMESH_TESTS_JITTERED_MESH_HPP
#define HMESH_TESTS_JITTERED_MESH_HPP

#include "hmesh/core/random.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace test {

// The executor at its worst: the last piece first.
struct BackwardFor {
    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        while (n-- > 0) body(n);
    }
};

// Uniform noise over the whole range of an integer type; in [-1, 2) for float.
template <class T, int C>
hmesh::Image<T, C> noise(int width, int height, std::uint64_t seed) {
    hmesh::Image<T, C> image(width, height);
    hmesh::kit::Random random(seed);
    for (std::size_t k = 0; k < image.size(); ++k) {
        T& sample = image.data()[k];
        if constexpr (hmesh::PixelTraits<T>::is_integer) sample = static_cast<T>(random.next());
        else sample = static_cast<T>(3 * random.uniform() - 1);
    }
    return image;
}

// Soft hills around 128, from about 20 to 236, different in each channel.
template <int C>
hmesh::Image<std::uint8_t, C> hills(int width, int height) {
    hmesh::Image<std::uint8_t, C> image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int k = 0; k < C; ++k)
                image.pixel(x, y)[k] = hmesh::PixelTraits<std::uint8_t>::from_real(128 + 54 * std::sin(0.11 * x + k) +
                                                                                   54 * std::cos(0.13 * y - 2 * k));
    return image;
}

// A grid of columns x rows squares over the table's rectangle, cut along one diagonal or the other.
inline std::vector<hmesh::Triangle> grid_triangles(int columns, int rows) {
    std::vector<hmesh::Triangle> triangles;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i), b = a + 1;
            const auto d = a + static_cast<std::uint32_t>(columns) + 1, c = d + 1;
            if ((i + j) % 2 == 0) triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
            else triangles.insert(triangles.end(), {{a, b, d}, {b, c, d}});
        }
    return triangles;
}

// Such a grid with its vertices displaced by up to 0.3 of a square, then `edits` random flips, splits of edges and of
// faces, and collapses, so that slots are in no order and some are unused. Colours are random.
template <int C>
void jitter(hmesh::kit::ImageMesh<C>& mesh, int columns, int rows, int edits, std::uint64_t seed) {
    hmesh::kit::Random random(seed, 1);
    const auto shake = [&](int i, int steps, int size) {
        const double cell = static_cast<double>(size) / steps;
        return hmesh::kit::snap(i == 0 ? 0.0 : i == steps ? size : cell * (i + 0.6 * random.uniform() - 0.3));
    };
    std::vector<hmesh::kit::Point> points;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double x = shake(i, columns, mesh.width()), y = shake(j, rows, mesh.height());
            points.push_back({x, y});
        }
    REQUIRE(mesh.assign(points, grid_triangles(columns, rows)));
    const hmesh::kit::HalfedgeMesh& topology = mesh.topology();
    const auto random_color = [&] {
        auto c = hmesh::kit::Color<C>::zero();
        for (int k = 0; k < C; ++k) c.set(k, 200 * random.uniform());
        return c;
    };
    for (int edit = 0; edit < edits; ++edit) {
        const auto mark = mesh.begin();
        const hmesh::kit::Edge e(random.below(topology.edge_slots()));
        const hmesh::kit::Face f(random.below(topology.face_slots()));
        bool done = false;
        const bool last = 8 * edit >= 7 * edits;  // leaves slots unused
        if (last || edit % 4 == 3) {
            if (!topology.is_deleted(e)) {
                const hmesh::kit::Halfedge h = hmesh::kit::HalfedgeMesh::halfedge(e);
                done = mesh.vertex(topology.from_vertex(h)).mobility == hmesh::kit::Mobility::free && topology.is_collapse_ok(h);
                if (done) mesh.collapse(h);
            }
        } else if (edit % 4 < 2 && !topology.is_deleted(e) && can_flip(mesh, e)) {
            hmesh::kit::FlipTrial<C> trial;
            evaluate_flip(mesh, e, trial);
            mesh.flip(e, trial.moments, trial.own, trial.opposite);
            done = true;
        } else if (edit % 8 == 2 && !topology.is_deleted(f)) {
            const auto v = topology.vertices(f);
            const hmesh::kit::Point a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
            mesh.split(f, hmesh::kit::snap(hmesh::kit::Point{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}), random_color());
            done = true;
        } else if (edit % 8 == 6 && !topology.is_deleted(e)) {
            const hmesh::kit::Halfedge h = hmesh::kit::HalfedgeMesh::halfedge(e);
            const hmesh::kit::Point a = mesh.position(topology.from_vertex(h)), b = mesh.position(topology.to_vertex(h));
            mesh.split(e, hmesh::kit::snap(midpoint(a, b)), random_color());
            done = true;
        }
        if (done && mesh.check()) mesh.commit(mark);
        else mesh.rollback(mark);
    }
    std::vector<hmesh::kit::Color<C>> colors(topology.vertex_slots(), hmesh::kit::Color<C>::zero());
    for (auto& c : colors) c = random_color();
    mesh.set_colors(colors);
    REQUIRE(mesh.check());
}

// The image, its table and a mesh over them, which point to each other and so stay where they are.
template <class T, int C>
struct Sample {
    hmesh::Image<T, C> image;
    hmesh::kit::MomentTable<C> table;
    hmesh::kit::ImageMesh<C> mesh;
    explicit Sample(hmesh::Image<T, C> picture, const hmesh::MeshLimits& limits = {})
        : image(std::move(picture)), table(image.view(), image.view().bounds()),
          mesh(table, hmesh::PixelTraits<T>::lowest, hmesh::PixelTraits<T>::highest, limits) {}
    Sample(const Sample&) = delete;
    Sample& operator=(const Sample&) = delete;
};

}  // namespace test

#endif  // HMESH_TESTS_JITTERED_MESH_HPP
