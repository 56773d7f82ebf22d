// Meshes over weighted tables: what counts is the weighted squared error, and pixels that do not count do no harm.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "hmesh/core/random.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/optimal_colors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"
#include "test_weighted.hpp"

namespace kit = hmesh::kit;
using hmesh::Image;
using hmesh::PixelTraits;
using hmesh::kit::Color;
using hmesh::kit::Face;
using hmesh::kit::ImageMesh;
using hmesh::kit::MomentTable;
using hmesh::kit::Vertex;
using hmesh_test::Weighted;
using hmesh_test::weighted_energy;

namespace {

// 0 left of the middle, or everywhere, else random.
Image<float, 1> half_zero(int width, int height, std::uint64_t seed) {
    Image<float, 1> weights = hmesh_test::random_weights(width, height, seed);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width / 2; ++x) *weights.pixel(x, y) = 0;
    return weights;
}

template <int C>
bool all_finite(const ImageMesh<C>& mesh) {
    bool finite = std::isfinite(mesh.energy());
    for (const Vertex v : mesh.topology().vertices()) {
        finite = finite && std::isfinite(mesh.position(v).x) && std::isfinite(mesh.position(v).y);
        for (int k = 0; k < C; ++k) finite = finite && std::isfinite(mesh.color(v)[k]);
    }
    for (const Face f : mesh.topology().faces()) finite = finite && std::isfinite(mesh.energy(f));
    return finite;
}

// Positions, edges and colours are optimised in turn: all stays finite and true, and the energy falls.
template <class T, int C>
void optimise(Weighted<T, C>& subject, std::uint64_t seed) {
    ImageMesh<C>& mesh = subject.mesh;
    const double range = PixelTraits<T>::peak;
    hmesh_test::wear(mesh, 60, range, seed);
    REQUIRE(mesh.check());
    const double rounding = 1e-12 * hmesh_test::squares(subject.image);
    const auto prove = [&] {
        REQUIRE(all_finite(mesh));
        const hmesh::Status status = mesh.check();
        REQUIRE_MESSAGE(status, std::string(status.what) << " at " << status.value);
        const double energy = weighted_energy(subject);
        REQUIRE(std::abs(mesh.energy() - energy) <= 1e-9 * energy + rounding);
    };
    for (int round = 0; round < 4; ++round) {
        const double before = mesh.energy();
        for (const Vertex v : mesh.topology().vertices()) {
            REQUIRE(kit::improve_vertex(mesh, v, 0) >= 0);
            mesh.set_dirty(v, true);
        }
        prove();
        kit::sweep(mesh);
        prove();
        kit::flip_edges(mesh);
        prove();
        CHECK(mesh.energy() <= before + 1e-9 * before + rounding);
    }
    kit::optimal_colors(mesh);
    prove();
    kit::bounded_colors(mesh, {0, range, PixelTraits<T>::is_integer ? 1.0 : 0.0});
    prove();
}

}  // namespace

TEST_CASE("a mesh over weights of 1 has the energy of one without weights") {
    const auto compare = [](auto image) {
        const int width = image.width(), height = image.height();
        const auto triangulation = hmesh_test::jittered_grid(width, height, 6, 5, 1);
        Weighted weighted(image, hmesh_test::constant_image<float, 1>(width, height, 0.3), triangulation);
        hmesh_test::Subject plain(std::move(image), triangulation);
        CHECK(weighted.mesh.check());
        CHECK(std::abs(weighted.mesh.energy() - plain.mesh.energy()) <= 1e-9 * plain.mesh.energy());
        CHECK(plain.mesh.energy() > 0);
        for (const Vertex v : plain.mesh.topology().vertices())
            for (int k = 0; k < 2; ++k) CHECK(weighted.mesh.color(v)[k] == plain.mesh.color(v)[k]);
    };
    compare(hmesh_test::scene<std::uint8_t, 3>(45, 38, 1));
    compare(hmesh_test::noise<std::uint16_t, 2>(45, 38, 2));
    compare(hmesh_test::scene<float, 4>(45, 38, 3));
}

TEST_CASE("a mesh over weights of 1 is optimised like one without weights, to the last bit for 8-bit samples") {
    const auto triangulation = hmesh_test::jittered_grid(61, 52, 7, 6, 2);
    Weighted weighted(hmesh_test::scene<std::uint8_t, 3>(61, 52, 4), hmesh_test::constant_image<float, 1>(61, 52, 1),
                      triangulation);
    hmesh_test::Subject plain(hmesh_test::scene<std::uint8_t, 3>(61, 52, 4), triangulation);
    for (int round = 0; round < 3; ++round) {
        kit::sweep(weighted.mesh);
        kit::sweep(plain.mesh);
        CHECK(kit::flip_edges(weighted.mesh) == kit::flip_edges(plain.mesh));
    }
    CHECK(hmesh_test::snapshot(weighted.mesh) == hmesh_test::snapshot(plain.mesh));
}

TEST_CASE("the energy of a mesh over weights is the weighted squared error of its pixels") {
    const auto prove = [](auto image, std::uint64_t seed) {
        const int width = image.width(), height = image.height();
        Weighted subject(std::move(image), hmesh_test::random_weights(width, height, seed),
                         hmesh_test::jittered_grid(width, height, 6, 5, seed));
        const double expected = weighted_energy(subject);
        CHECK(subject.mesh.check());
        CHECK(expected > 0);
        CHECK(std::abs(subject.mesh.energy() - expected) <= 1e-9 * expected);
    };
    prove(hmesh_test::noise<std::uint8_t, 1>(41, 33, 1), 1);
    prove(hmesh_test::noise<std::uint8_t, 3>(41, 33, 2), 2);
    prove(hmesh_test::noise<std::uint16_t, 4>(41, 33, 3), 3);
    prove(hmesh_test::noise<float, 2>(41, 33, 4), 4);
    prove(hmesh_test::noise<float, 8>(41, 33, 5), 5);
}

TEST_CASE("a mesh can be optimised where weights are 0 in places, in one half or everywhere") {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const auto grid = hmesh_test::jittered_grid(61, 52, 8, 7, seed);
        for (const Image<float, 1>& weights :
             {hmesh_test::random_weights(61, 52, seed), half_zero(61, 52, seed), Image<float, 1>(61, 52)}) {
            Weighted bytes(hmesh_test::scene<std::uint8_t, 3>(61, 52, seed), weights, grid);
            optimise(bytes, seed);
            Weighted words(hmesh_test::noise<std::uint16_t, 1>(61, 52, seed), weights, grid);
            optimise(words, seed);
            Weighted floats(hmesh_test::scene<float, 4>(61, 52, seed), weights, grid);
            optimise(floats, seed);
        }
    }
}

TEST_CASE("vertices whose faces hold no weight stay where they are, with the colour they have") {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        // The zeros lie right of random weights, so that sums over them are left with rounding.
        Image<float, 1> weights = hmesh_test::random_weights(61, 52, seed);
        for (int y = 0; y < 52; ++y)
            for (int x = 30; x < 61; ++x) *weights.pixel(x, y) = 0;
        Weighted subject(hmesh_test::noise<std::uint8_t, 3>(61, 52, seed), std::move(weights),
                         hmesh_test::jittered_grid(61, 52, 10, 8, seed));
        ImageMesh<3>& mesh = subject.mesh;
        int alone = 0;
        for (const Vertex v : mesh.topology().vertices()) {
            double left = mesh.position(v).x;
            for (const auto h : mesh.topology().outgoing(v)) left = std::min(left, mesh.position(mesh.topology().to_vertex(h)).x);
            if (left < 30) continue;
            const auto before = mesh.vertex(v);
            kit::improve_vertex(mesh, v, 0);
            CHECK(mesh.position(v) == before.position);
            for (int k = 0; k < 3; ++k) CHECK(mesh.color(v)[k] == before.color[k]);
            ++alone;
        }
        CHECK(alone > 15);
    }
}

TEST_CASE("pixels without weight do not pull at the colours of those with weight") {
    // Grey 100 with weight; anything without.
    Image<std::uint8_t, 1> image = hmesh_test::noise<std::uint8_t, 1>(61, 52, 3);
    Image<float, 1> weights(61, 52);
    kit::Random random(1);
    for (int y = 0; y < 52; ++y)
        for (int x = 0; x < 61; ++x)
            if (random.below(2) == 0) {
                *image.pixel(x, y) = 100;
                *weights.pixel(x, y) = 0.7F;
            }
    Weighted subject(std::move(image), std::move(weights), hmesh_test::jittered_grid(61, 52, 6, 5, 1));
    kit::optimal_colors(subject.mesh);
    CHECK(subject.mesh.energy() < 1);
    for (const Vertex v : subject.mesh.topology().vertices()) CHECK(std::abs(subject.mesh.color(v)[0] - 100) < 0.5);
}
