#include "hmesh/io/heights/height_models.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/io/heights/height_glb.hpp"
#include "test_exports.hpp"
#include "test_heights.hpp"

namespace {

using hmesh_test::Bytes;
using hmesh_test::Model;
using hmesh_test::Point3;
using hmesh_test::Terrain;
using hmesh_test::terrain;

const auto to_ply = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_height_ply(mesh, {}, sink); };
const auto to_obj = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_height_obj(mesh, {}, sink); };
const auto to_glb = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_height_glb(mesh, {}, sink); };

Bytes ply(const hmesh::MeshView& mesh, const hmesh::HeightSamples& samples, const hmesh::HeightOptions& options = {}) {
    return hmesh_test::exported(mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_height_ply(view, samples, sink, options);
    });
}
Bytes obj(const hmesh::MeshView& mesh, const hmesh::HeightSamples& samples, const hmesh::HeightOptions& options = {}) {
    return hmesh_test::exported(mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_height_obj(view, samples, sink, options);
    });
}
Bytes glb(const hmesh::MeshView& mesh, const hmesh::HeightSamples& samples, const hmesh::HeightOptions& options = {}) {
    return hmesh_test::exported(mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_height_glb(view, samples, sink, options);
    });
}

double hills(double x, double y) { return 40 + 7 * std::sin(x / 3) * std::cos(y / 5) + 0.5 * x; }

hmesh::HeightOptions units() {
    hmesh::HeightOptions options;
    options.x_step = 30, options.y_step = 20;
    options.x_origin = 1000, options.y_origin = -500;
    options.z = {0, 0.5, 100};
    return options;
}

Model rotated(Model model) {  // y up as z up
    for (std::vector<Point3>* points : {&model.positions, &model.normals})
        for (Point3& a : *points) a = {a[0], -a[2], a[1]};
    return model;
}

}  // namespace

TEST_CASE("all models have the same positions, normals, places and faces, each in the axes of its format") {
    for (const hmesh::Samples kind : {hmesh::Samples::squares, hmesh::Samples::points}) {
        const Terrain land = terrain(9, 6, kind, hills);
        const Model a = hmesh_test::read_height_ply(ply(land.mesh.view(), land.samples.view(), units())),
                    b = hmesh_test::read_height_obj(obj(land.mesh.view(), land.samples.view(), units())),
                    c = rotated(hmesh_test::read_height_glb(glb(land.mesh.view(), land.samples.view(), units())));
        REQUIRE(a.positions.size() == land.mesh.vertex_count());
        REQUIRE(b.positions.size() == a.positions.size());
        REQUIRE(c.positions == a.positions);
        CHECK(c.normals == a.normals);
        CHECK(b.faces == a.faces);
        CHECK(c.faces == a.faces);
        for (std::size_t v = 0; v < a.positions.size(); ++v) {
            const auto x = static_cast<double>(land.mesh.positions[2 * v]),
                       y = static_cast<double>(land.mesh.positions[2 * v + 1]);
            const auto value = static_cast<double>(land.mesh.colors[v]);
            const Point3 expected = {1000 + 30 * x, -500 - 20 * y, 100 + 0.5 * value};
            for (std::size_t k = 0; k < 3; ++k) {
                CHECK(a.positions[v][k] == doctest::Approx(expected[k]).epsilon(1e-7));
                CHECK(b.positions[v][k] == doctest::Approx(expected[k]).epsilon(1e-8));
                CHECK(b.normals[v][k] == doctest::Approx(a.normals[v][k]).epsilon(1e-6));
            }
            for (std::size_t k = 0; k < 2; ++k) CHECK(std::abs(b.places[v][k] - a.places[v][k]) < 1e-6);
            CHECK(std::abs(a.places[v][1] - (1 - c.places[v][1])) < 1e-6);  // v is up in PLY and OBJ, down in glTF
            CHECK(a.places[v][0] == c.places[v][0]);
            CHECK(hmesh_test::size_of_vector(a.normals[v]) == doctest::Approx(1).epsilon(1e-6));
        }
    }
}

TEST_CASE("faces face up, whichever axis is up, and the map is no mirror image") {
    const Terrain land = terrain(4, 3, hmesh::Samples::points, hills);
    for (const hmesh::UpAxis up : {hmesh::UpAxis::usual, hmesh::UpAxis::y, hmesh::UpAxis::z}) {
        hmesh::HeightOptions options = units();
        options.up = up;
        const std::array<Model, 3> models = {hmesh_test::read_height_ply(ply(land.mesh.view(), {}, options)),
                                             hmesh_test::read_height_obj(obj(land.mesh.view(), {}, options)),
                                             hmesh_test::read_height_glb(glb(land.mesh.view(), {}, options))};
        for (std::size_t i = 0; i < models.size(); ++i) {
            const bool is_y_up = up == hmesh::UpAxis::y || (up == hmesh::UpAxis::usual && i == 2);
            const Model model = is_y_up ? rotated(models[i]) : models[i];
            for (const hmesh::Triangle& face : model.faces) {
                const Point3 normal =
                    hmesh_test::cross_product(hmesh_test::minus(model.positions[face[1]], model.positions[face[0]]),
                                              hmesh_test::minus(model.positions[face[2]], model.positions[face[0]]));
                CHECK(normal[2] > 0);
                for (const std::uint32_t v : face) CHECK(hmesh_test::inner(normal, model.normals[v]) > 0);
            }
            // Vertex 0 is the image's upper left one: north of vertex (0, 3), west of (4, 0).
            CHECK(model.positions[0][0] == 1000);
            CHECK(model.positions[0][1] == -500);
            for (const Point3& at : model.positions) {
                CHECK(at[0] >= 1000);
                CHECK(at[0] <= 1000 + 4 * 30);
                CHECK(at[1] <= -500);
                CHECK(at[1] >= -500 - 3 * 20);
            }
        }
    }
}

TEST_CASE("an image of the raster's extent has its pixels on the samples, one of the mesh's extent ends with it") {
    const auto places = [](hmesh::Samples kind, hmesh::Drape drape) {
        const Terrain land = terrain(4, 2, kind, hills);
        hmesh::HeightOptions options;
        options.drape = drape;
        return hmesh_test::read_height_glb(glb(land.mesh.view(), {}, options)).places;
    };
    const auto first_and_last = [&](hmesh::Samples kind, hmesh::Drape drape) {
        const std::vector<std::array<double, 2>> all = places(kind, drape);
        return std::array<double, 4>{all.front()[0], all.front()[1], all.back()[0], all.back()[1]};
    };
    // 5 x 3 samples: the first pixel's centre is at 1/2 of a fifth and of a third.
    const std::array<double, 4> expected = {0.1, 0.5 / 3, 0.9, 2.5 / 3}, whole = {0, 0, 1, 1};
    for (std::size_t k = 0; k < 4; ++k)
        CHECK(first_and_last(hmesh::Samples::points, hmesh::Drape::raster)[k] == doctest::Approx(expected[k]));
    CHECK(first_and_last(hmesh::Samples::points, hmesh::Drape::mesh) == whole);
    CHECK(first_and_last(hmesh::Samples::squares, hmesh::Drape::raster) == whole);
    CHECK(first_and_last(hmesh::Samples::squares, hmesh::Drape::mesh) == whole);
    CHECK(places(hmesh::Samples::points, hmesh::Drape::none).empty());
    // Each axis has its own size, between the ends too.
    const std::vector<std::array<double, 2>> of_mesh = places(hmesh::Samples::points, hmesh::Drape::mesh),
                                             of_raster = places(hmesh::Samples::points, hmesh::Drape::raster);
    const hmesh::Mesh mesh = terrain(4, 2, hmesh::Samples::points, hills).mesh;
    REQUIRE(of_mesh.size() == mesh.vertex_count());
    REQUIRE(of_raster.size() == mesh.vertex_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const double x = static_cast<double>(mesh.positions[2 * v]), y = static_cast<double>(mesh.positions[2 * v + 1]);
        CHECK(of_mesh[v][0] == doctest::Approx(x / 4));
        CHECK(of_mesh[v][1] == doctest::Approx(y / 2));
        CHECK(of_raster[v][0] == doctest::Approx((x + 0.5) / 5));
        CHECK(of_raster[v][1] == doctest::Approx((y + 0.5) / 3));
    }
}

TEST_CASE("heights of any channel make the same models as those of a mesh that has no other") {
    const Terrain land = terrain(5, 4, hmesh::Samples::points, hills);
    hmesh::HeightOptions options = units();
    for (const int channel : {0, 1, 2}) {
        hmesh::Mesh mesh = land.mesh;
        mesh.channels = 3;
        mesh.colors.clear();
        for (std::size_t v = 0; v < land.mesh.vertex_count(); ++v)
            for (int k = 0; k < 3; ++k) mesh.colors.push_back(k == channel ? land.mesh.colors[v] : static_cast<float>(v));
        options.z.channel = channel;
        CHECK(ply(mesh.view(), {}, options) == ply(land.mesh.view(), {}, units()));
        CHECK(glb(mesh.view(), {}, options) == glb(land.mesh.view(), {}, units()));
    }
}

TEST_CASE("normals and texture coordinates can be left out, and what is left can be read") {
    const Terrain land = terrain(4, 3, hmesh::Samples::points, hills);
    for (const bool has_normals : {false, true})
        for (const hmesh::Drape drape : {hmesh::Drape::none, hmesh::Drape::mesh}) {
            hmesh::HeightOptions options;
            options.has_normals = has_normals;
            options.drape = drape;
            const std::array<Model, 3> models = {hmesh_test::read_height_ply(ply(land.mesh.view(), {}, options)),
                                                 hmesh_test::read_height_obj(obj(land.mesh.view(), {}, options)),
                                                 hmesh_test::read_height_glb(glb(land.mesh.view(), {}, options))};
            for (const Model& model : models) {
                CHECK(model.positions.size() == 20);
                CHECK(model.normals.size() == (has_normals ? 20 : 0));
                CHECK(model.places.size() == (drape == hmesh::Drape::mesh ? 20 : 0));
                CHECK(model.faces.size() == 24);
            }
            const std::string json = hmesh_test::json_of(glb(land.mesh.view(), {}, options));
            CHECK((json.find("KHR_materials_unlit") == std::string::npos) == has_normals);
        }
}

TEST_CASE("a draped image is named: as a URI, as MeshLab's comment, by the material file") {
    const Terrain land = terrain(4, 3, hmesh::Samples::points, hills);
    hmesh::HeightOptions options;
    options.texture = "my map.jpg";
    const std::string json = hmesh_test::json_of(glb(land.mesh.view(), {}, options));
    CHECK(json.find("\"uri\":\"my%20map.jpg\"") != std::string::npos);
    CHECK(json.find("BLEND") == std::string::npos);
    CHECK(hmesh_test::as_text(ply(land.mesh.view(), {}, options)).find("\ncomment TextureFile my map.jpg\n") !=
          std::string::npos);
    CHECK(hmesh_test::as_text(obj(land.mesh.view(), {}, options)).find("\nmtllib my map.jpg\nusemtl image\n") !=
          std::string::npos);
    options.drape = hmesh::Drape::none;
    Bytes bytes;
    CHECK(hmesh::write_height_glb(land.mesh.view(), {}, hmesh::kit::append_to(bytes), options).code ==
          hmesh::Errc::invalid_argument);
    options.drape = hmesh::Drape::mesh;
    options.texture = "a\nb";
    CHECK(hmesh::write_height_ply(land.mesh.view(), {}, hmesh::kit::append_to(bytes), options).code ==
          hmesh::Errc::invalid_argument);
    CHECK(bytes.empty());
}

TEST_CASE("a skirt is a second primitive of a .glb, and leaves the first and other files as they were") {
    const Terrain land = terrain(20, 12, hmesh::Samples::points, hills);
    hmesh::HeightOptions plain = units(), options = plain;
    options.skirt = 2.5;
    const Bytes before = glb(land.mesh.view(), land.samples.view(), plain),
                bytes = glb(land.mesh.view(), land.samples.view(), options);
    const std::string json = hmesh_test::json_of(bytes);
    const std::size_t arrays = hmesh_test::json_of(before).size();
    CHECK(std::equal(before.begin() + 28 + static_cast<std::ptrdiff_t>(arrays), before.end(),
                     bytes.begin() + 28 + static_cast<std::ptrdiff_t>(json.size())));
    const hmesh::MeshView mesh = land.mesh.view();
    double in_sides = 0;
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const float x = mesh.positions[2 * v], y = mesh.positions[2 * v + 1];
        in_sides += x <= 0 || y <= 0 || x >= static_cast<float>(mesh.right()) || y >= static_cast<float>(mesh.bottom()) ? 1 : 0;
    }
    REQUIRE(in_sides >= 4);
    CHECK(hmesh_test::numbers_of(json, "count", 4, 1)[0] == 2 * in_sides);  // positions, normals and places
    CHECK(hmesh_test::numbers_of(json, "count", 7, 1)[0] == 6 * in_sides);  // corners: a ring of as many walls as vertices
    CHECK(hmesh_test::numbers_of(json, "min", 1, 3)[1] >= hmesh_test::numbers_of(json, "min", 0, 3)[1] - 2.5 - 1e-4);
    CHECK(hmesh_test::numbers_of(json, "max", 1, 3)[1] <= hmesh_test::numbers_of(json, "max", 0, 3)[1]);
    CHECK(ply(land.mesh.view(), land.samples.view(), options) == ply(land.mesh.view(), land.samples.view(), plain));
    for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e39, 3.4e38}) {
        options.skirt = bad;
        options.z.offset = -3e38;
        std::vector<unsigned char> none;
        CHECK(!hmesh::write_height_glb(land.mesh.view(), {}, hmesh::kit::append_to(none), options));
        CHECK(none.empty());
    }
}

TEST_CASE("walls of a skirt hang from the edges of all sides, face outward, and are shaded as what they hang from") {
    const auto is_gap = [](int column, int row) { return column == 3 && row == 0; };  // one wall less than vertices in the sides
    const Terrain land = terrain(6, 3, hmesh::Samples::points, hills, is_gap);
    hmesh::HeightOptions options = units();
    options.skirt = 0.5;
    const Bytes bytes = glb(land.mesh.view(), land.samples.view(), options);
    const Model above = hmesh_test::read_height_glb(glb(land.mesh.view(), land.samples.view(), units()));
    // Behind the arrays of the first primitive: positions, normals, places and indices of 16 bits.
    Model walls;
    std::size_t at = 28 + hmesh_test::json_of(bytes).size() + above.positions.size() * 32 + above.faces.size() * 6;
    const std::size_t count = 2 * 18;
    for (std::size_t v = 0; v < count; ++v) walls.positions.push_back(hmesh_test::floats_in<3>(bytes, at));
    for (std::size_t v = 0; v < count; ++v) walls.normals.push_back(hmesh_test::floats_in<3>(bytes, at));
    for (std::size_t v = 0; v < count; ++v) walls.places.push_back(hmesh_test::floats_in<2>(bytes, at));
    while (at < bytes.size()) {
        hmesh::Triangle face{};
        for (std::uint32_t& v : face) v = hmesh_test::number_in<std::uint16_t>(bytes, at);
        walls.faces.push_back(face);
    }
    REQUIRE(walls.faces.size() == count - 2);
    for (const std::size_t array : {4U, 5U, 6U, 7U})  // as the file tells it
        CHECK(hmesh_test::numbers_of(hmesh_test::json_of(bytes), "count", array, 1)[0] ==
              static_cast<double>(array < 7 ? count : 3 * (count - 2)));
    // Each vertex is one of the surface or 0.5 below one, with all else that it has.
    std::vector<std::array<std::size_t, 2>> from;  // which one, and 1 if below
    for (std::size_t w = 0; w < count; ++w) {
        const Point3& p = walls.positions[w];
        for (std::size_t v = 0; v < above.positions.size(); ++v) {
            const Point3& q = above.positions[v];
            if (p[0] != q[0] || p[2] != q[2]) continue;
            const bool is_below = p[1] != q[1];
            if (is_below) CHECK(p[1] == doctest::Approx(q[1] - 0.5));
            CHECK(walls.normals[w] == above.normals[v]);
            CHECK(walls.places[w] == above.places[v]);
            from.push_back({v, is_below ? 1U : 0U});
        }
    }
    REQUIRE(from.size() == count);
    std::vector<std::array<std::size_t, 2>> sorted = from;
    std::sort(sorted.begin(), sorted.end());
    CHECK(std::unique(sorted.begin(), sorted.end()) == sorted.end());
    // All faces upright and outward, as large as the walls are, and joined: a ring that begins and ends at the gap.
    double area = 0;
    std::set<std::array<std::uint32_t, 2>> edges;
    for (const hmesh::Triangle& face : walls.faces) {
        const Point3 a = walls.positions[face[0]], b = walls.positions[face[1]], c = walls.positions[face[2]];
        const Point3 normal = hmesh_test::cross_product(hmesh_test::minus(b, a), hmesh_test::minus(c, a));
        const Point3 out = {a[0] + b[0] + c[0] - 3 * 1090, 0, a[2] + b[2] + c[2] - 3 * 530};  // from the middle of the mesh
        CHECK(std::abs(normal[1]) < 1e-3);
        CHECK(hmesh_test::inner(normal, out) > 0);
        area += hmesh_test::size_of_vector(normal) / 2;
        for (std::size_t k = 0; k < 3; ++k) CHECK(edges.insert({face[k], face[(k + 1) % 3]}).second);
    }
    CHECK(area == doctest::Approx(0.5 * (11 * 30 + 6 * 20)).epsilon(1e-4));
    int open = 0;
    for (const auto& [a, b] : edges)
        if (from[a][1] != from[b][1] && edges.count({b, a}) == 0) ++open;
    CHECK(open == 2);
}

TEST_CASE("a .glb is a scene of one mesh, of one primitive where there is no skirt, or no side that it could hang from") {
    const auto all = terrain(6, 4, hmesh::Samples::points, hills),
               inner = terrain(6, 4, hmesh::Samples::points, hills,
                               [](int column, int row) { return column == 0 || row == 0 || column == 5 || row == 3; });
    const auto primitives = [](const Terrain& land, double skirt) {
        hmesh::HeightOptions options;
        options.skirt = skirt;
        const std::string json = hmesh_test::json_of(glb(land.mesh.view(), {}, options));
        CHECK(json.find("\"nodes\":[0]") != std::string::npos);  // of the scene
        CHECK(json.find("\"mesh\":0") != std::string::npos);
        int count = 0;
        for (std::size_t at = json.find("\"POSITION\""); at != std::string::npos; at = json.find("\"POSITION\"", at + 1)) ++count;
        return count;
    };
    CHECK(primitives(all, 0) == 1);
    CHECK(primitives(all, 3) == 2);
    CHECK(primitives(inner, 3) == 1);
}

TEST_CASE("vertices of no face, or of none with an area, have normals that point up") {
    hmesh::Mesh mesh = terrain(2, 2, hmesh::Samples::points, hills).mesh;
    mesh.faces = {{0, 1, 3}, {2, 2, 5}};  // the third vertex is a corner twice, and four are named by none
    const Model model = hmesh_test::read_height_ply(ply(mesh.view(), {}));
    REQUIRE(model.normals.size() == 9);
    for (const std::size_t v : {2U, 4U, 5U, 6U, 7U, 8U}) CHECK(model.normals[v] == Point3{0, 0, 1});
    CHECK(model.normals[0] != Point3{0, 0, 1});
    CHECK(hmesh_test::size_of_vector(model.normals[0]) == doctest::Approx(1));
}

TEST_CASE("samples that do not suit a mesh are refused with what is asked for and what there is") {
    const hmesh::Mesh mesh = terrain(4, 2, hmesh::Samples::points, hills).mesh;  // 5 x 3 samples
    const hmesh::Image<float, 2> image(8, 6);
    const auto status = [&](int column, int row, int channel) {
        return hmesh::HeightSamples(image.view(), {}, column, row).check_for(mesh.view(), channel);
    };
    const auto says = [](const hmesh::Status& said, double value, double limit) {
        CHECK(said.code == hmesh::Errc::invalid_argument);
        CHECK(said.value == value);
        CHECK(said.limit == limit);
    };
    CHECK(status(0, 0, 1));
    CHECK(status(3, 3, 0));
    says(status(0, 0, 2), 2, 1);
    says(status(-2, 1, 0), -2, 0);
    says(status(1, -3, 0), -3, 0);
    says(status(4, 3, 0), 5, 4);
    says(status(3, 4, 0), 3, 2);
}

TEST_CASE("bounds of a .glb are those of all vertices, the first and the last among them") {
    for (const double sign : {-1.0, 1.0}) {
        const Terrain land = terrain(4, 3, hmesh::Samples::points, [&](double x, double y) { return sign * (x + y); });
        CHECK(hmesh_test::read_height_glb(glb(land.mesh.view(), {})).positions.size() == 20);  // which compares them
    }
}

TEST_CASE("tiles of a map have the vertices of their common side bit for bit") {
    const auto map = [](double x, double y) { return hills(x, y); };
    const Terrain left = terrain(16, 9, hmesh::Samples::points, map),
                  right = terrain(16, 9, hmesh::Samples::points, [&](double x, double y) { return map(x + 16, y); }),
                  below = terrain(16, 9, hmesh::Samples::points, [&](double x, double y) { return map(x, y + 9); });
    hmesh::HeightOptions options = units();
    options.x_step = 30.87, options.y_step = 29.1, options.x_origin = 0.1;
    const Model a = hmesh_test::read_height_ply(ply(left.mesh.view(), {}, options));
    options.first_column = 16;
    const Model b = hmesh_test::read_height_ply(ply(right.mesh.view(), {}, options));
    options.first_column = 0, options.first_row = 9;
    const Model c = hmesh_test::read_height_ply(ply(below.mesh.view(), {}, options));
    const auto shared = [](const Model& one, const Model& other) {
        int count = 0;
        for (const Point3& p : one.positions)
            for (const Point3& q : other.positions) count += p == q ? 1 : 0;
        return count;
    };
    CHECK(shared(a, b) == 10);
    CHECK(shared(a, c) == 17);
}

TEST_CASE("more than 65,535 vertices have indices of 32 bits") {
    const Terrain small = terrain(255, 254, hmesh::Samples::points, hills),
                  large = terrain(255, 255, hmesh::Samples::points, hills);
    REQUIRE(large.mesh.vertex_count() == 65536);
    for (const Terrain* land : {&small, &large}) {
        const Bytes bytes = glb(land->mesh.view(), land->samples.view());
        CHECK((hmesh_test::json_of(bytes).find("\"componentType\":5125") != std::string::npos) == (land == &large));
        const Model model = hmesh_test::read_height_glb(bytes);
        REQUIRE(model.faces.size() == land->mesh.face_count());
        bool is_same = true;
        for (std::size_t f = 0; f < model.faces.size(); ++f) {
            const auto [a, b, c] = land->mesh.faces[f];
            is_same = is_same && model.faces[f] == hmesh::Triangle{a, c, b};
        }
        CHECK(is_same);
    }
}

TEST_CASE("a mesh of nothing is written as nothing") {
    hmesh::Mesh mesh;
    mesh.channels = 1, mesh.width = 3, mesh.height = 2, mesh.peak = 1;
    CHECK(hmesh_test::read_height_ply(hmesh_test::exported(mesh.view(), to_ply)).positions.empty());
    CHECK(hmesh_test::read_height_obj(hmesh_test::exported(mesh.view(), to_obj)).positions.empty());
    CHECK(hmesh_test::as_text(hmesh_test::exported(mesh.view(), to_glb)).find("\"scenes\":[{}]}") != std::string::npos);
}

TEST_CASE("meshes, samples and options that no model holds give a Status and no byte, and a sink that refuses is reported") {
    const Terrain land = terrain(30, 30, hmesh::Samples::points, hills), small = terrain(20, 20, hmesh::Samples::points, hills);
    for (const hmesh_test::Write write : {hmesh_test::Write(to_ply), hmesh_test::Write(to_obj), hmesh_test::Write(to_glb)}) {
        hmesh::Mesh mesh = land.mesh;
        mesh.faces[1][2] = 1000;
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
        mesh = land.mesh, mesh.colors[5] = std::numeric_limits<float>::infinity();
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::not_finite, write);
        mesh = land.mesh, mesh.positions[5] = std::numeric_limits<float>::quiet_NaN();
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::not_finite, write);
        mesh = land.mesh, mesh.width = 1;
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
        mesh = land.mesh, mesh.height = 1;
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
        hmesh_test::check_refusing_sinks(small.mesh.view(), write);
        hmesh_test::check_locale_makes_no_difference(land.mesh.view(), write);
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refuses = [&](const hmesh::HeightOptions& options, const hmesh::HeightSamples& samples = {},
                             hmesh::Errc code = hmesh::Errc::invalid_argument) {
        const auto write = [&](const hmesh::MeshView& mesh, hmesh::Sink sink) {
            return hmesh::write_height_ply(mesh, samples, sink, options);
        };
        hmesh_test::check_refused(land.mesh.view(), code, write);
    };
    for (const int channel : {-1, 1}) {
        hmesh::HeightOptions options;
        options.z.channel = channel;
        refuses(options);
    }
    for (const double bad : {0.0, -1.0, nan, 1e39}) {
        hmesh::HeightOptions options;
        options.x_step = bad;
        refuses(options);
        options = {}, options.y_step = bad;
        refuses(options);
    }
    for (const double bad : {nan, 1e39, -1e39}) {
        hmesh::HeightOptions options;
        options.x_origin = bad;
        refuses(options);
        options = {}, options.z.scale = bad;
        refuses(options);
        options = {}, options.z.offset = bad;
        refuses(options);
    }
    hmesh::HeightOptions options;
    options.z.scale = 3e38;
    refuses(options, {}, hmesh::Errc::not_finite);
    options = {}, options.up = static_cast<hmesh::UpAxis>(3);
    refuses(options);
    options = {}, options.drape = static_cast<hmesh::Drape>(3);
    refuses(options);
    const hmesh::Image<std::uint16_t, 1> few(30, 31), enough(31, 31);
    refuses({}, few.view());
    refuses({}, {enough.view(), {}, 1, 0});
    refuses({}, {enough.view(), {}, -1, 0});
    refuses({}, hmesh::ImageView<float, 1>{nullptr, 31, 31, 0});
    const hmesh::Image<std::uint16_t, 1> low(31, 29);
    refuses({}, low.view());
    refuses({}, {enough.view(), {}, 0, 2});
    refuses({}, {enough.view(), {}, 0, -1});
    for (const auto& [width, height] : {std::array<int, 2>{31, 30}, {30, 31}}) {
        const hmesh::Image<std::uint8_t, 1> mask(width, height);
        refuses({}, {enough.view(), mask.view()});
    }
    hmesh::Mesh two = land.mesh;  // heights are its second channel, and the samples have one
    two.channels = 2, two.colors.resize(2 * two.vertex_count());
    hmesh::HeightOptions second;
    second.z.channel = 1;
    const auto write = [&](const hmesh::MeshView& mesh, hmesh::Sink sink) {
        return hmesh::write_height_ply(mesh, enough.view(), sink, second);
    };
    hmesh_test::check_refused(two.view(), hmesh::Errc::invalid_argument, write);
    CHECK(!ply(land.mesh.view(), enough.view()).empty());
    // More than readers number, and than a file of less than 4 GiB holds; none is read.
    constexpr std::size_t numbered = 2147483647;
    for (const bool are_faces : {false, true}) {
        hmesh::MeshView many = land.mesh.view();
        for (const auto& [writer, most] : {std::pair{hmesh_test::Write(to_ply), numbered},
                                           {hmesh_test::Write(to_obj), numbered},
                                           {hmesh_test::Write(to_glb), numbered / 48}}) {
            (are_faces ? many.face_count : many.vertex_count) = most + 1;
            std::vector<unsigned char> none;
            const hmesh::Status status = writer(many, hmesh::kit::append_to(none));
            CHECK(status.value == static_cast<double>(most + 1));
            CHECK(status.limit == static_cast<double>(most));
            CHECK(none.empty());
        }
    }
}
