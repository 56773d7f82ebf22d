// hmesh tests - meshes in tiles over small images, and proofs of what they claim.
#ifndef HMESH_TESTS_TEST_TILED_MESHES_HPP
#define HMESH_TESTS_TEST_TILED_MESHES_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/limits.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "test_meshes.hpp"

namespace hmesh_test {

namespace kit = hmesh::kit;

// An image and all that a TiledMesh over it needs; the mesh is empty at first.
template <class T, int C>
struct Work {
    hmesh::Image<T, C> image;
    kit::ImageSource<C> source;
    kit::ProgressReporter progress;
    mutable kit::TiledMesh<C> tiled;  // which looks at its mesh by putting it together

    explicit Work(hmesh::Image<T, C> picture, const hmesh::MeshLimits& limits = {}, const hmesh::Progress& callback = {},
                  const hmesh::ParallelFor& parallel_for = {})
        : image(std::move(picture)), source(image.view()),
          progress(callback, static_cast<double>(image.size()), hmesh::PixelTraits<T>::peak),
          tiled(source, limits, progress, parallel_for) {}
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    [[nodiscard]] const kit::IndexedMesh<C>& indexed() const { return tiled.indexed(); }
    [[nodiscard]] std::size_t count() const { return indexed().vertex_count(); }
};

template <int C>
[[nodiscard]] int most_neighbors(const kit::IndexedMesh<C>& mesh) {
    kit::HalfedgeMesh topology;
    REQUIRE(topology.assign(mesh.vertex_count(), mesh.faces));
    int most = 0;
    for (const kit::Vertex v : topology.vertices()) most = std::max(most, topology.valence(v));
    return most;
}

template <class T, int C>
[[nodiscard]] double brute_energy(const hmesh::Image<T, C>& image, const kit::IndexedMesh<C>& mesh) {
    double energy = 0;
    for (const hmesh::Triangle& t : mesh.faces) {
        kit::VertexState<C> corners[3]{};
        for (std::size_t k = 0; k < 3; ++k) corners[k].position = mesh.positions[t[k]], corners[k].color = mesh.colors[t[k]];
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
    REQUIRE(most_neighbors(work.indexed()) <= kit::max_valence);
    bool padded = true;
    for (const kit::Color<C>& color : work.indexed().colors)
        for (int k = C; k < kit::lanes_for(C + 1); ++k) padded = padded && color[k] == 0;
    REQUIRE(padded);
    if (!energy_known) return;
    const double energy = brute_energy(work.image, work.indexed());
    REQUIRE(std::abs(work.indexed().energy - energy) <= 1e-9 * energy + 1e-12 * squares(work.image));
}

// Everything of a mesh that can differ is equal to the last bit.
template <int C>
[[nodiscard]] bool same_bits(const kit::IndexedMesh<C>& a, const kit::IndexedMesh<C>& b) {
    bool same = a.width == b.width && a.height == b.height && a.positions == b.positions && a.dirty == b.dirty &&
                a.faces == b.faces && a.energy == b.energy && a.colors.size() == b.colors.size();
    for (std::size_t k = 0; same && k < a.colors.size(); ++k)
        for (int c = 0; c < C; ++c) same = same && a.colors[k][c] == b.colors[k][c];
    return same;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_TILED_MESHES_HPP
