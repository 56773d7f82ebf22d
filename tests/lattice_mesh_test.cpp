#include "hmesh/rate/lattice_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact_meshes.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/rate/compact_lattice.hpp"
#include "hmesh/render.hpp"
#include "mesh_flaws.hpp"
#include "test_images.hpp"

using hmesh::Mesh;
using hmesh::detail::CompactLattice;
using hmesh::detail::LatticeMesh;

namespace {

// A mesh of the first image of a lattice.
Mesh first_mesh(const hmesh::Image<std::uint8_t, 3>& image, const CompactLattice& lattice, std::int64_t n, double position_step) {
    const auto step = [&](const hmesh::detail::LatticeAxis& axis, int side) {
        return static_cast<double>(axis.step) / static_cast<double>(axis.end) * side / lattice.per_site;
    };
    const auto first = hmesh::detail::shrunk(image.view(), lattice.x.pixels, lattice.y.pixels, step(lattice.x, image.width()),
                                             step(lattice.y, image.height()), {});
    hmesh::Options options;
    options.target = hmesh::Target::vertices(n);
    options.limits.position_step = position_step;
    hmesh::Annealed recipe;
    recipe.effort = hmesh::Effort::draft;
    return mesh_image(first.view(), options, recipe).mesh;
}
double psnr_of(Mesh mesh, const hmesh::Image<std::uint8_t, 3>& image) {
    hmesh::RenderOptions size;
    size.width = image.width();
    size.height = image.height();
    const auto drawn = hmesh::render<3>(mesh.view(), size);
    return hmesh::psnr(image.view(), hmesh::to_pixels<std::uint8_t>(drawn.image).view());
}

// A mesh of random points, flipped here and there, after so many rounds on the lattice of `cell` px of a width x height image.
Mesh settled_slivers(int width, int height, double cell, std::size_t points, std::size_t flips, std::uint64_t seed, int rounds) {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(width, height, seed);
    const hmesh::kit::MomentTable<3> table(image.view(), hmesh::kit::Rect{0, 0, width, height});
    const CompactLattice lattice = hmesh::detail::find_lattice(width, height, width, height, cell, false);
    hmesh_test::MeshKind kind;
    kind.width = lattice.x.pixels;
    kind.height = lattice.y.pixels;
    kind.points = points;
    kind.flips = flips;
    LatticeMesh<3> moved(table, lattice, 1);
    REQUIRE(moved.settle(hmesh_test::random_mesh(kind, seed), rounds, [](double) { return true; }));
    Mesh mesh = moved.mesh();
    CHECK(hmesh_test::flaw_of(mesh.view(), width, height).empty());
    return mesh;
}

}  // namespace

TEST_CASE("a mesh goes to the sites of a lattice, wherever it comes from, and is the better the longer it stays") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 83, 1);
    const hmesh::kit::MomentTable<3> table(image.view(), hmesh::kit::Rect{0, 0, 120, 83});
    for (const bool bare : {false, true})
        for (const double cell : {1.3, 2.0, 5.0, 17.0}) {
            double gain = 0;  // on coarse lattices one mesh may lose, since others of its vertices come to sites
            for (const bool is_free : {false, true}) {
                CAPTURE(bare);
                CAPTURE(cell);
                CAPTURE(is_free);
                const CompactLattice lattice = hmesh::detail::find_lattice(120, 83, 120, 83, cell, bare);
                // Off the lattice many find no site near them.
                const Mesh first = first_mesh(image, lattice, 60, is_free ? 1.0 / 256 : lattice.per_site);
                double before = 0;
                for (const int rounds : {0, 20}) {
                    LatticeMesh<3> moved(table, lattice, 1);
                    int told = 0;
                    REQUIRE(moved.settle(first, rounds, [&](double) { return ++told > 0; }));
                    CHECK(told == rounds);
                    const Mesh mesh = moved.mesh();
                    CHECK(mesh.width == (bare ? lattice.x.sites : 120));
                    CHECK(hmesh_test::flaw_of(mesh.view(), mesh.width, mesh.height).empty());
                    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
                        const double step = static_cast<double>(lattice.x.step) / lattice.units;
                        const double place = static_cast<double>(mesh.positions[i]), side = i % 2 == 0 ? mesh.width : mesh.height;
                        CHECK((place == side || std::fmod(place, step) == 0));
                    }
                    const double psnr = psnr_of(mesh, image);
                    CHECK(mesh.vertex_count() > 12);
                    if (rounds > 0) gain += psnr - before;
                    before = psnr;
                }
            }
            CHECK(gain > 0.4);
        }
}

TEST_CASE("where sites are as near as pixels a mesh of the image itself goes to them") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(320, 240, 2);
    const hmesh::kit::MomentTable<3> table(image.view(), hmesh::kit::Rect{0, 0, 320, 240});
    hmesh::Options options;
    options.target = hmesh::Target::vertices(300);
    options.limits.position_step = 0.25;
    hmesh::Annealed recipe;
    recipe.effort = hmesh::Effort::draft;
    const Mesh first = mesh_image(image.view(), options, recipe).mesh;
    for (const bool bare : {false, true}) {
        CAPTURE(bare);
        CHECK(!hmesh::detail::find_lattice(320, 240, 320, 240, 1.03, bare).has_one_image);
        const CompactLattice lattice = hmesh::detail::find_lattice(320, 240, 320, 240, 0.97, bare);
        REQUIRE(lattice.has_one_image);
        LatticeMesh<3> moved(table, lattice, 1);
        REQUIRE(moved.settle(first, 4, [](double) { return true; }));
        const Mesh mesh = moved.mesh();
        CHECK(hmesh_test::flaw_of(mesh.view(), mesh.width, mesh.height).empty());
        CHECK(mesh.vertex_count() >= 295);
        CHECK(psnr_of(mesh, image) > psnr_of(first, image) - 0.5);
    }
}

TEST_CASE("slivers that rounding turns over come to the lattice too, and no edge is flipped onto another") {
    for (const std::uint64_t seed : {15U, 26U, 42U, 56U}) {  // those of the first 60 where such a flip is tried
        CAPTURE(seed);
        (void)settled_slivers(40, 26, 5, 150, 600, seed, 2);
    }
    (void)settled_slivers(40, 26, 5, 150, 600, 243, 0);  // where it is tried so that a vertex can be removed
}

TEST_CASE("edges that are flipped away from a vertex give no other more neighbours than it may have") {
    for (const std::uint64_t seed : {2U, 6U, 7U, 17U}) {  // those of the first 20 where one had as many
        CAPTURE(seed);
        const Mesh mesh = settled_slivers(60, 40, 1, 1600, 16000, seed, 0);
        std::vector<int> faces(mesh.vertex_count(), 0);
        for (const hmesh::Triangle& face : mesh.faces)
            for (const std::uint32_t v : face) ++faces[v];
        CHECK(*std::max_element(faces.begin(), faces.end()) <= hmesh::kit::max_valence);
    }
}

TEST_CASE("where slivers lie so close that none can be removed, a neighbour is") {
    for (const std::uint64_t seed : {3U, 57U}) {  // those of the first 60 where one is
        CAPTURE(seed);
        CHECK(settled_slivers(60, 40, 1, 1600, 16000, seed, 0).vertex_count() > 1000);
    }
}

TEST_CASE("who says stop is heard between two rounds") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(60, 40, 1);
    const hmesh::kit::MomentTable<3> table(image.view(), hmesh::kit::Rect{0, 0, 60, 40});
    const CompactLattice lattice = hmesh::detail::find_lattice(60, 40, 60, 40, 2, true);
    LatticeMesh<3> moved(table, lattice, 1);
    int told = 0;
    CHECK(moved.settle(first_mesh(image, lattice, 30, lattice.per_site), 50, [&](double) { return ++told < 3; }));
    CHECK(told == 3);
}

TEST_CASE("lattices of all sizes have their ends on the image's sides") {
    for (const int side : {1, 2, 5, 512, 65536})
        for (const bool bare : {false, true})
            for (const double cell : {0.1, 1.0, 1.6, 37.5, 1e6}) {
                const CompactLattice lattice = hmesh::detail::find_lattice(side, 3, std::min(side, 512), 3, cell, bare);
                CAPTURE(side);
                CAPTURE(bare);
                CAPTURE(cell);
                const hmesh::detail::LatticeAxis& x = lattice.x;
                CHECK(x.sites >= 1);
                CHECK(x.sites <= (bare ? 65536 : 1 << 24));
                CHECK(x.at(x.sites) == (bare ? x.sites : 256 * side));
                CHECK(x.at(x.sites - 1) < x.at(x.sites));
                CHECK(x.place(0) == 0);
                CHECK(x.place(x.sites) == x.size);
                CHECK(x.pixels >= 1);
                for (int k = 0; k <= x.sites; k += 1 + x.sites / 7) CHECK(x.nearest(x.place(k)) == k);
            }
}

TEST_CASE("the first image of a lattice is one that can be meshed, whatever the image and its sites") {
    for (const auto& size : {std::array{65536, 65536}, {65536, 3}, {2, 65536}, {40000, 50000}, {300, 200}}) {
        const int width = size[0], height = size[1];
        for (const bool bare : {false, true})
            for (const double cell : {0.0, 0.7, 1.0, 1.9, 3.0, 40.0, 1e9}) {
                CAPTURE(width);
                CAPTURE(height);
                CAPTURE(bare);
                CAPTURE(cell);
                const CompactLattice lattice = hmesh::detail::find_lattice(width, height, width, height, cell, bare);
                CHECK((lattice.x.pixels >= 1 && lattice.x.pixels <= hmesh::kit::max_side));
                CHECK((lattice.y.pixels >= 1 && lattice.y.pixels <= hmesh::kit::max_side));
                CHECK(std::int64_t{lattice.x.pixels} * lattice.y.pixels <= hmesh::kit::max_pixels);
            }
    }
}
