// hmesh tests - meshes in patches over small images, and proofs of what they claim.
#ifndef HMESH_TESTS_TEST_PATCHWORKS_HPP
#define HMESH_TESTS_TEST_PATCHWORKS_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "test_meshes.hpp"

namespace hmesh_test {

// An image and all that a TiledMesh over it needs; the mesh is empty at first.
template <class T, int C>
struct Work {
    hmesh::Image<T, C> image;
    hmesh::kit::ImageSource<C> source;
    hmesh::kit::ProgressReporter monitor;
    mutable hmesh::kit::TiledMesh<C> patchwork;  // which looks at its mesh by putting it together

    explicit Work(hmesh::Image<T, C> picture, const hmesh::kit::MeshLimits& limits = {}, const hmesh::Progress& progress = {},
                  const hmesh::ParallelFor& parallel_for = {})
        : image(std::move(picture)), source(image.view()),
          monitor(progress, static_cast<double>(image.samples().size()), hmesh::PixelTraits<T>::peak),
          patchwork(source, limits, monitor, parallel_for) {}
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    [[nodiscard]] const hmesh::kit::IndexedMesh<C>& indexed() const { return patchwork.indexed(); }
    [[nodiscard]] std::size_t count() const { return indexed().vertex_count(); }
};

template <int C>
[[nodiscard]] int most_neighbors(const hmesh::kit::IndexedMesh<C>& whole) {
    hmesh::kit::HalfedgeMesh topology;
    REQUIRE(topology.assign(whole.vertex_count(), whole.triangles));
    int most = 0;
    for (const hmesh::kit::Vertex v : topology.vertices()) most = std::max(most, topology.valence(v));
    return most;
}

template <class T, int C>
[[nodiscard]] double brute_energy(const hmesh::Image<T, C>& image, const hmesh::kit::IndexedMesh<C>& whole) {
    double energy = 0;
    for (const hmesh::kit::Triangle& t : whole.triangles) {
        hmesh::kit::VertexState<C> corners[3]{};
        for (std::size_t k = 0; k < 3; ++k) corners[k].position = whole.positions[t[k]], corners[k].color = whole.colors[t[k]];
        energy += brute_energy(image, corners[0], corners[1], corners[2]);
    }
    return energy;
}

// The mesh is one of the whole image, no vertex has too many neighbours, and its energy, where known, is that of its pixels.
template <class T, int C>
void prove(const Work<T, C>& work, bool energy_known = true) {
    const hmesh::Status status = check(work.indexed());
    REQUIRE_MESSAGE(status, status.what << " at " << status.value);
    REQUIRE(work.indexed().width == work.image.width());
    REQUIRE(work.indexed().height == work.image.height());
    REQUIRE(most_neighbors(work.indexed()) <= hmesh::kit::max_valence);
    bool padded = true;
    for (const hmesh::kit::Color<C>& color : work.indexed().colors)
        for (int k = C; k < hmesh::kit::lanes_for(C + 1); ++k) padded = padded && color[k] == 0;
    REQUIRE(padded);
    if (!energy_known) return;
    const double energy = brute_energy(work.image, work.indexed());
    REQUIRE(std::abs(work.indexed().energy - energy) <= 1e-9 * energy + 1e-12 * squares(work.image));
}

// Everything of a mesh that can differ is equal to the last bit.
template <int C>
[[nodiscard]] bool same_bits(const hmesh::kit::IndexedMesh<C>& a, const hmesh::kit::IndexedMesh<C>& b) {
    bool same = a.width == b.width && a.height == b.height && a.positions == b.positions && a.dirty == b.dirty &&
                a.triangles == b.triangles && a.energy == b.energy && a.colors.size() == b.colors.size();
    for (std::size_t k = 0; same && k < a.colors.size(); ++k)
        for (int c = 0; c < C; ++c) same = same && a.colors[k][c] == b.colors[k][c];
    return same;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_PATCHWORKS_HPP
