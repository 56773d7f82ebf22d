#include "hmesh/mesh/unrolled.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "periodic_sheets.hpp"

using hmesh::Mesh;
using hmesh::Periodic;

namespace {

// A strip of two faces that leans out of its image of 4 x 2 px by `lean` px.
Mesh leaning(float lean) {
    Mesh mesh;
    mesh.channels = 1;
    mesh.width = 4, mesh.height = 2;
    mesh.peak = 255;
    mesh.periodic = Periodic::x;
    mesh.positions = {0, 0, 4, 0, lean, 2, 4 + lean, 2};
    mesh.colors = {10, 10, 30, 30};
    mesh.faces = {{0, 1, 3}, {0, 3, 2}};
    return mesh;
}

}  // namespace

TEST_CASE("copies of a leaning strip cover its image, each place once") {
    for (const float lean : {0.5F, 3.0F, 9.0F, -6.5F}) {
        const Mesh whole = hmesh::kit::unrolled(leaning(lean).view());
        REQUIRE(whole.periodic == Periodic::none);
        for (std::int64_t y = 7; y < 512; y += 61)
            for (std::int64_t x = 5; x < 1024; x += 37)
                if (const int count = hmesh_test::faces_over(whole, {x, y}); count != -1) CHECK(count == 1);
        // Colours come along, and the first faces are the mesh's own.
        CHECK(whole.faces[1] == leaning(lean).faces[1]);
        CHECK(whole.colors.size() == whole.vertex_count());
        for (std::size_t v = 0; v < whole.vertex_count(); ++v)
            CHECK(whole.colors[v] == (whole.positions[2 * v + 1] == 0 ? 10 : 30));
    }
}

TEST_CASE("a mesh that stands nowhere out of its image comes back as it is") {
    Mesh mesh = leaning(0);
    const Mesh straight = hmesh::kit::unrolled(mesh.view());
    CHECK(straight.faces == mesh.faces);
    CHECK(straight.positions == mesh.positions);
    mesh = leaning(3);
    mesh.periodic = Periodic::none;
    CHECK(hmesh::kit::unrolled(mesh.view()).faces == mesh.faces);
}

TEST_CASE("faces far outside are left where they are") {
    Mesh mesh = leaning(0);
    mesh.positions[0] = -1e9F;
    CHECK(hmesh::kit::unrolled(mesh.view()).face_count() <= 4);
}
