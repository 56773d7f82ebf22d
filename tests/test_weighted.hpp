// hmesh tests - meshes over images whose pixels have weights, and their energy by brute force.
#ifndef HMESH_TESTS_TEST_WEIGHTED_HPP
#define HMESH_TESTS_TEST_WEIGHTED_HPP

#include <doctest/doctest.h>

#include <utility>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "test_meshes.hpp"

namespace hmesh_test {

// An image with weights, their table, and a mesh over it.
template <class T, int C>
struct Weighted {
    hmesh::Image<T, C> image;
    hmesh::Image<float, 1> weights;
    double unit;
    hmesh::kit::MomentTable<C> table;
    hmesh::kit::ImageMesh<C> mesh;

    Weighted(hmesh::Image<T, C> picture, hmesh::Image<float, 1> counts, const Triangulation& triangulation)
        : image(std::move(picture)), weights(std::move(counts)), unit(hmesh::kit::weight_unit(weights.view())),
          table(image.view(), weights.view(), unit, image.view().bounds()),
          mesh(table, hmesh::PixelTraits<T>::lowest, hmesh::PixelTraits<T>::highest) {
        REQUIRE(mesh.assign(triangulation.positions, triangulation.triangles));
    }
    Weighted(const Weighted&) = delete;
    Weighted& operator=(const Weighted&) = delete;
};

template <class T, int C>
double weighted_energy(const Weighted<T, C>& subject) {
    double energy = 0;
    const hmesh::kit::ImageMesh<C>& mesh = subject.mesh;
    const hmesh::kit::WeightScale scale(subject.unit, mesh.width(), mesh.height());
    for (const hmesh::kit::Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        const auto &a = mesh.vertex(v[0]), &b = mesh.vertex(v[1]), &c = mesh.vertex(v[2]);
        for_each_pixel(mesh.width(), mesh.height(), a.position, b.position, c.position, [&](int i, int j) {
            const double weight = scale(*subject.weights.pixel(i, j));
            for (int k = 0; k < C; ++k) {
                const double residual =
                    interpolate(a, b, c, i + 0.5, j + 0.5, k) - static_cast<double>(subject.image.pixel(i, j)[k]);
                energy += weight * residual * residual;
            }
        });
    }
    return energy;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_WEIGHTED_HPP
