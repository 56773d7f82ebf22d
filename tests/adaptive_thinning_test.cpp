#include "hmesh/methods/baselines/adaptive_thinning.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#include "test_images.hpp"
#include "test_methods.hpp"
#include "test_tiled_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh_test::Work;

// What it shares with adams is proven in adams_test.cpp.

TEST_CASE("stages come in order: all pixels and the corners, then the number asked for") {
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(24, 20, 2));
    CHECK(hmesh::AdaptiveThinning().run(work.tiled, 50));
    CHECK(hmesh_test::names_of(work.progress) == "points removal");
    CHECK(work.progress.stages()[0].vertices == 480);
    CHECK(work.progress.stages()[1].vertices == 50);
    CHECK(work.progress.stages()[1].energy == work.indexed().energy);
}

TEST_CASE("the last vertex to go is the one whose absence costs least, told by trying them all") {
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
        const auto image = hmesh_test::noise<std::uint8_t, 1>(7, 6, seed);
        Work<std::uint8_t, 1> work(image), one_more(image);
        CHECK(hmesh::AdaptiveThinning().run(work.tiled, 12));
        CHECK(hmesh::AdaptiveThinning().run(one_more.tiled, 13));
        const kit::IndexedMesh<1>& before = one_more.indexed();
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t gone = 0; gone < before.vertex_count(); ++gone) {
            kit::Delaunay mesh(7, 6);
            for (std::size_t v = 0; v < before.vertex_count(); ++v)
                if (v != gone) mesh.insert(before.positions[v]);
            if (mesh.topology().vertex_count() != 12) continue;  // a corner stays
            kit::IndexedMesh<1> after;
            for (const kit::Point p : mesh.positions())
                for (std::size_t v = 0; v < before.vertex_count(); ++v)
                    if (before.positions[v] == p) after.add(p, before.colors[v]);
            for (const kit::Face f : mesh.topology().faces()) {
                const auto v = mesh.topology().vertices(f);
                const auto index = [](kit::Vertex u) { return static_cast<std::uint32_t>(u.index()); };
                after.faces.push_back({index(v[0]), index(v[1]), index(v[2])});
            }
            const double energy = hmesh_test::brute_energy(image, after);
            least = energy < least ? energy : least;
        }
        // Where four points lie on a circle there is a choice of edges, and more or less error.
        CHECK(work.indexed().energy <= 1.02 * least);
    }
}
