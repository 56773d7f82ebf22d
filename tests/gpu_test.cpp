#include "hmesh/io/gpu.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"
#include "test_sanitized.hpp"

namespace {

using hmesh::GpuAlpha;
using hmesh::GpuBuffers;
using hmesh::GpuFormat;
using hmesh::GpuIndexFormat;
using hmesh::GpuOptions;
using hmesh::GpuTopology;
using Bytes = std::vector<std::uint8_t>;

// A vertex as a shader gets it.
struct Fetched {
    std::array<double, 2> at{};     // px
    std::array<double, 4> color{};  // shares; of two numbers: grey, alpha, 0, 0
};

std::uint32_t little_endian(const Bytes& bytes, std::size_t at, std::uint32_t size) {
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < size; ++i) value |= std::uint32_t{bytes.at(at + i)} << (8 * i);
    return value;
}

// An attribute, by its WebGPU name.
std::array<double, 4> fetch(const Bytes& bytes, std::size_t at, GpuFormat format) {
    std::array<double, 4> out{};
    for (std::uint32_t k = 0; k < hmesh::components_of(format); ++k) {
        const std::uint32_t size = hmesh::size_of(format) / hmesh::components_of(format);
        const std::uint32_t bits = little_endian(bytes, at + std::size_t{k} * size, size);
        if (format == GpuFormat::float32x2) {
            float value = 0;
            std::memcpy(&value, &bits, 4);
            out.at(k) = static_cast<double>(value);
        } else {
            out.at(k) = static_cast<double>(bits) / (size == 1 ? 255 : 65535);
        }
    }
    return out;
}

Fetched fetch_vertex(const GpuBuffers& buffers, std::size_t v) {
    const auto& layout = buffers.layout;
    const std::size_t base = v * layout.stride;
    const auto at = fetch(buffers.vertices, base + layout.position.offset, layout.position.format);
    Fetched out;
    for (std::size_t k = 0; k < 2; ++k) {
        const auto from = static_cast<double>(layout.offset.at(k)), scale = static_cast<double>(layout.scale.at(k));
        out.at.at(k) = from + scale * at.at(k);
    }
    out.color = fetch(buffers.vertices, base + layout.color.offset, layout.color.format);
    return out;
}

// The faces that a GPU draws, of vertices of the buffer. Checks that the buffers keep to what GpuChunk says.
std::vector<hmesh::Triangle> drawn(const GpuBuffers& buffers) {
    const auto& layout = buffers.layout;
    const std::uint32_t size = hmesh::size_of(layout.index);
    CHECK(buffers.indices.size() % 4 == 0);
    CHECK(layout.stride % 4 == 0);
    CHECK(buffers.vertices.size() % layout.stride == 0);
    std::vector<hmesh::Triangle> faces;
    std::size_t count = 0;
    for (const auto& chunk : buffers.chunks) {
        REQUIRE(chunk.first_index == count);
        REQUIRE(std::size_t{chunk.first_vertex} + chunk.vertex_count <= buffers.vertex_count());
        count += chunk.index_count;
        std::vector<std::uint32_t> strip;
        for (std::size_t i = 0; i < chunk.index_count; ++i) {
            const std::uint32_t index = little_endian(buffers.indices, (chunk.first_index + i) * size, size);
            const bool is_strip = layout.topology == GpuTopology::triangle_strip;
            if (is_strip && index == layout.restart) {
                strip.clear();
                continue;
            }
            if (index >= chunk.vertex_count) FAIL("index ", index, " of ", chunk.vertex_count);
            strip.push_back(chunk.first_vertex + index);
            const std::size_t n = strip.size();
            if (n < 3) continue;
            hmesh::Triangle face{strip[n - 3], strip[n - 2], strip[n - 1]};
            if (!is_strip) strip.clear();
            else if (n % 2 == 0) std::swap(face[0], face[1]);
            if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) faces.push_back(face);
        }
        CHECK((layout.topology == GpuTopology::triangle_strip || strip.empty()));
    }
    CHECK((count * size + 3) / 4 * 4 == buffers.indices.size());
    return faces;
}

// The least corner first, in the same sense; then the faces in order.
std::vector<hmesh::Triangle> sorted(std::vector<hmesh::Triangle> faces) {
    for (auto& face : faces) std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    std::sort(faces.begin(), faces.end());
    return faces;
}

// A grid with its vertices moved by less than half of a cell, on the 1/256 px grid, colours at random and vertices in disorder.
hmesh::Mesh disordered(int columns, int rows, int channels, bool premultiplied, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    hmesh::Mesh mesh = hmesh_test::square_grid(columns, rows);
    mesh.channels = channels;
    mesh.premultiplied = premultiplied;
    mesh.peak = 255;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        float& x = mesh.positions[2 * v];
        float& y = mesh.positions[2 * v + 1];
        if (x > 0 && x < static_cast<float>(columns)) x += static_cast<float>(random.below(100)) / 256;
        if (y > 0 && y < static_cast<float>(rows)) y += static_cast<float>(random.below(100)) / 256;
    }
    mesh.colors.clear();
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const double alpha = random.below(4) == 0 ? 0 : 255 * random.uniform();
        for (int k = 0; k < channels; ++k) {
            const bool is_alpha = channels % 2 == 0 && k + 1 == channels;
            const double most = channels % 2 == 0 && premultiplied ? alpha : 265;  // some are above the peak
            mesh.colors.push_back(static_cast<float>(is_alpha ? alpha : most * random.uniform()));
        }
    }
    for (std::size_t f = mesh.face_count(); f > 1; --f) std::swap(mesh.faces[f - 1], mesh.faces[random.below(f)]);
    std::vector<std::uint32_t> place(mesh.vertex_count());
    for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
    for (std::size_t v = place.size(); v > 1; --v) std::swap(place[v - 1], place[random.below(v)]);
    hmesh::Mesh moved = mesh;
    const auto channel_count = static_cast<std::size_t>(channels);
    for (std::size_t v = 0; v < place.size(); ++v) {
        std::copy_n(mesh.positions.begin() + static_cast<std::ptrdiff_t>(2 * v), 2,
                    moved.positions.begin() + static_cast<std::ptrdiff_t>(2 * std::size_t{place[v]}));
        std::copy_n(mesh.colors.begin() + static_cast<std::ptrdiff_t>(channel_count * v), channels,
                    moved.colors.begin() + static_cast<std::ptrdiff_t>(channel_count * place[v]));
    }
    for (auto& face : moved.faces)
        for (std::uint32_t& v : face) v = place[v];
    return moved;
}

// The vertex of a disordered() mesh at a place that is at most 0.01 px off: there is one a cell.
std::vector<std::uint32_t> by_cell(const hmesh::Mesh& mesh) {
    std::vector<std::uint32_t> cells(static_cast<std::size_t>(mesh.width + 1) * static_cast<std::size_t>(mesh.height + 1));
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        const auto x = static_cast<std::size_t>(mesh.positions[2 * v]), y = static_cast<std::size_t>(mesh.positions[2 * v + 1]);
        cells[y * static_cast<std::size_t>(mesh.width + 1) + x] = v;
    }
    return cells;
}
std::uint32_t vertex_at(const hmesh::Mesh& mesh, const std::vector<std::uint32_t>& cells, const Fetched& vertex) {
    const auto x = static_cast<std::size_t>(vertex.at[0] + 0.01), y = static_cast<std::size_t>(vertex.at[1] + 0.01);
    return cells.at(y * static_cast<std::size_t>(mesh.width + 1) + x);
}

// The shares that a vertex of the mesh should have.
std::array<double, 4> expected_color(const hmesh::Mesh& mesh, std::size_t v, const GpuOptions& options) {
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const auto share = [&](std::size_t k) {
        return std::min(1.0, static_cast<double>(mesh.colors[channels * v + k]) / mesh.peak);
    };
    std::array<double, 4> rgba{share(0), share(0), share(0), channels % 2 == 0 ? share(channels - 1) : 1};
    if (channels > 2) rgba[1] = share(1), rgba[2] = share(2);
    for (std::size_t k = 0; k < 3 && channels % 2 == 0; ++k) {
        if (options.alpha == GpuAlpha::premultiplied && !mesh.premultiplied) rgba.at(k) *= rgba[3];
        if (options.alpha == GpuAlpha::straight && mesh.premultiplied) rgba.at(k) /= rgba[3];  // NaN if it has none
    }
    if (hmesh::components_of(options.color) == 2) return {rgba[0], rgba[3], 0, 0};
    return rgba;
}

void check_buffers(const hmesh::Mesh& mesh, const GpuOptions& options) {
    const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view(), options);
    REQUIRE(buffers.status);
    const auto& layout = buffers.layout;
    CHECK(layout.position.format == options.position);
    CHECK(layout.color.format == options.color);
    CHECK(layout.index == options.index);
    CHECK(layout.topology == options.topology);
    CHECK(layout.has_alpha == (mesh.channels % 2 == 0));
    const std::uint32_t most = options.index == GpuIndexFormat::uint16 ? 65535 : 0x80000000U;
    for (const auto& chunk : buffers.chunks)
        CHECK(chunk.vertex_count <= (options.chunk_vertices == 0 ? most : options.chunk_vertices));
    // Each vertex of the buffer is one of the mesh, moved by the rounding alone.
    const auto cells = by_cell(mesh);
    std::vector<std::uint32_t> source(buffers.vertex_count());
    const double step = options.position == GpuFormat::unorm16x2 ? std::max(mesh.width, mesh.height) / 131070.0 + 1e-9 : 0;
    const bool is_wide = options.color == GpuFormat::unorm16x2 || options.color == GpuFormat::unorm16x4;
    int faults = 0;
    for (std::size_t v = 0; v < source.size(); ++v) {
        const Fetched vertex = fetch_vertex(buffers, v);
        source[v] = vertex_at(mesh, cells, vertex);
        for (std::size_t k = 0; k < 2; ++k) {
            const auto at = static_cast<double>(mesh.positions[2 * std::size_t{source[v]} + k]);
            faults += std::abs(vertex.at.at(k) - at) <= step ? 0 : 1;
        }
        const auto color = expected_color(mesh, source[v], options);
        const double half = (is_wide ? 0.5 / 65535 : 0.5 / 255) + 1e-6;
        for (std::size_t k = 0; k < 4; ++k)
            if (color.at(k) <= 1) faults += std::abs(vertex.color.at(k) - color.at(k)) <= half ? 0 : 1;
    }
    CHECK(faults == 0);
    auto faces = drawn(buffers);
    for (auto& face : faces)
        for (std::uint32_t& v : face) v = source[v];
    CHECK(sorted(faces) == sorted(mesh.faces));
}

void check_refused(const hmesh::MeshView& mesh, const GpuOptions& options, const std::string& words, hmesh::Errc code,
                   double value, double limit) {
    const GpuBuffers buffers = hmesh::pack_for_gpu(mesh, options);
    CHECK(buffers.status.code == code);
    CHECK_MESSAGE(std::string(buffers.status.what).find(words) != std::string::npos, buffers.status.what);
    CHECK(buffers.status.value == value);
    CHECK(buffers.status.limit == limit);
    CHECK(buffers.vertices.empty());
    CHECK(buffers.indices.empty());
    CHECK(buffers.chunks.empty());
    CHECK(buffers.vertex_count() == 0);
}

}  // namespace

TEST_CASE("a mesh of two faces becomes these bytes") {
    hmesh::Mesh mesh = hmesh_test::two_faces(3);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 1};
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 99.5F, 99.4F, 0.4F, 254.6F};
    const GpuBuffers list = hmesh::pack_for_gpu(mesh.view());
    REQUIRE(list.status);
    CHECK(list.layout.stride == 8);
    CHECK(list.layout.position.offset == 0);
    CHECK(list.layout.color.offset == 4);
    CHECK(list.layout.scale == std::array<float, 2>{3, 2});
    CHECK(list.layout.offset == std::array<float, 2>{0, 0});
    CHECK(list.layout.width == 3);
    CHECK(list.layout.height == 2);
    CHECK(!list.layout.has_alpha);
    CHECK(list.vertices == Bytes{0,    0,    0,    0,    0,  128, 255, 255,  //
                                 0xff, 0xff, 0,    0,    1,  2,   3,   255,  //
                                 0xff, 0xff, 0xff, 0xff, 0,  255, 100, 255,  //
                                 0,    0,    0,    0x80, 99, 0,   255, 255});
    CHECK(list.indices == Bytes{0, 0, 1, 0, 2, 0, 0, 0, 2, 0, 3, 0});
    REQUIRE(list.chunks.size() == 1);
    CHECK(list.chunks[0].index_count == 6);
    CHECK(list.chunks[0].vertex_count == 4);
    GpuOptions options;
    options.topology = GpuTopology::triangle_strip;
    options.index = GpuIndexFormat::uint32;
    options.position = GpuFormat::float32x2;
    options.color = GpuFormat::unorm16x4;
    const GpuBuffers strip = hmesh::pack_for_gpu(mesh.view(), options);
    CHECK(strip.layout.stride == 16);
    CHECK(strip.layout.restart == 0xffffffffU);
    CHECK(strip.chunks[0].index_count == 4);
    CHECK(Bytes(strip.vertices.begin(), strip.vertices.begin() + 16) ==
          Bytes{0, 0, 0x40, 0x40, 0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 0xff, 0xff});  // (3, 0), for the strip begins beside the diagonal
}

TEST_CASE("every layout holds the mesh's vertices and draws its faces, each once and turned as it was") {
    for (const int channels : {1, 2, 3, 4})
        for (const bool premultiplied : {false, true}) {
            const hmesh::Mesh mesh = disordered(9, 7, channels, premultiplied, static_cast<std::uint64_t>(channels));
            for (const GpuFormat position : {GpuFormat::float32x2, GpuFormat::unorm16x2})
                for (const GpuFormat color :
                     {GpuFormat::unorm8x2, GpuFormat::unorm8x4, GpuFormat::unorm16x2, GpuFormat::unorm16x4})
                    for (const GpuAlpha alpha : {GpuAlpha::as_stored, GpuAlpha::straight, GpuAlpha::premultiplied})
                        for (const GpuTopology topology : {GpuTopology::triangle_list, GpuTopology::triangle_strip})
                            for (const GpuIndexFormat index : {GpuIndexFormat::uint16, GpuIndexFormat::uint32})
                                for (const std::uint32_t chunk : {0U, 25U}) {
                                    if (channels > 2 && hmesh::components_of(color) == 2) continue;
                                    check_buffers(mesh, {position, color, alpha, topology, index, chunk});
                                }
        }
}

// Of a million where HMESH_TEST_ROUNDS is in the environment: they take as long as all else.
TEST_CASE("meshes of 4 to a million vertices are drawn whole, in chunks of any size") {
    for (const int side : {1, 2, 3, 5, 8, 40})
        for (const std::uint32_t chunk : {0U, 3U, 4U, 17U, 1000U})
            for (const GpuTopology topology : {GpuTopology::triangle_list, GpuTopology::triangle_strip}) {
                GpuOptions options;
                options.topology = topology;
                options.chunk_vertices = chunk;
                check_buffers(disordered(side, side + 1, 3, false, chunk), options);
            }
    for (const auto& [side, topology] : {std::pair{300, GpuTopology::triangle_list}, std::pair{300, GpuTopology::triangle_strip},
                                         std::pair{999, GpuTopology::triangle_strip}}) {
        if (std::getenv("HMESH_TEST_ROUNDS") == nullptr && side > 300) continue;
        if (hmesh_test::sanitized && topology == GpuTopology::triangle_list) continue;
        const hmesh::Mesh large = disordered(side, side + 33, 3, false, 9);
        GpuOptions options;
        options.topology = topology;
        check_buffers(large, options);
        const GpuBuffers buffers = hmesh::pack_for_gpu(large.view(), options);
        CHECK(buffers.chunks.size() > large.vertex_count() / 65535);
        CHECK(buffers.vertex_count() == large.vertex_count());  // none is stored twice
        const auto bytes = static_cast<double>(buffers.vertices.size() + buffers.indices.size());
        const double per_vertex = bytes / static_cast<double>(large.vertex_count());
        CHECK(per_vertex < (topology == GpuTopology::triangle_list ? 20 : 14.5));
    }
}

TEST_CASE("vertices are in the order in which they are drawn first, and those of no face are left out") {
    hmesh::Mesh mesh = disordered(20, 20, 3, false, 4);
    mesh.positions.insert(mesh.positions.end(), {1, 1});
    mesh.colors.insert(mesh.colors.end(), {0, 0, 0});
    const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view());
    CHECK(buffers.vertex_count() == 441);
    std::uint32_t next = 0;
    for (const auto& face : drawn(buffers))
        for (const std::uint32_t v : face) {
            if (v > next) FAIL("vertex ", v, " comes before ", next);
            next = std::max(next, v + 1);
        }
    CHECK(next == 441);
}

TEST_CASE("faces with a corner twice are left out, and a mesh of none but them is refused") {
    hmesh::Mesh mesh = hmesh_test::two_faces(3);
    mesh.faces.insert(mesh.faces.begin() + 1, {1, 1, 2});
    mesh.faces.push_back({3, 2, 3});
    for (const GpuTopology topology : {GpuTopology::triangle_list, GpuTopology::triangle_strip}) {
        GpuOptions options;
        options.topology = topology;
        const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view(), options);
        CHECK(drawn(buffers).size() == 2);
        CHECK(buffers.vertex_count() == 4);
    }
    mesh.faces = {{1, 1, 2}};
    check_refused(mesh.view(), {}, "no face of three different corners", hmesh::Errc::invalid_argument, 0, 1);
}

TEST_CASE("the box of the positions is the image, and larger where vertices lie beyond it") {
    hmesh::Mesh mesh = hmesh_test::two_faces(3);
    mesh.positions = {-1, 0, 3, 0, 3, 7, 0, 2};
    const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view());
    CHECK(buffers.layout.offset == std::array<float, 2>{-1, 0});
    CHECK(buffers.layout.scale == std::array<float, 2>{4, 7});
    for (const float far : {3e38F, -3e38F}) {
        mesh.positions = {0, 0, far, 0, far, far, -far, 2};
        const GpuBuffers huge = hmesh::pack_for_gpu(mesh.view());
        CHECK(huge.status);
        CHECK(hmesh::kit::is_finite(huge.layout.scale[0]));
        CHECK(drawn(huge).size() == 2);
    }
}

TEST_CASE("copies of a vertex on the jagged border of a periodic mesh are a whole period apart after rounding") {
    hmesh::kit::Random random(5);
    for (const int width : {7, 100, 257, 1021}) {
        // Pairs of vertices a period apart, the first of each from 0.4 of it left of the image on.
        hmesh::Mesh mesh;
        mesh.channels = 1;
        mesh.width = width, mesh.height = 16;
        mesh.peak = 255;
        mesh.periodic = hmesh::Periodic::x;
        for (int k = 0; k < 400; ++k) {
            const double x = std::floor((random.uniform() * 1.3 - 0.4) * 256 * width) / 256, y = k % 16;
            for (const double turn : {0.0, 1.0}) {
                mesh.positions.insert(mesh.positions.end(), {static_cast<float>(x + turn * width), static_cast<float>(y)});
                mesh.colors.push_back(1);
            }
        }
        for (std::uint32_t v = 0; v + 2 < 800; ++v) mesh.faces.push_back({v, v + 1, v + 2});
        GpuOptions options;
        options.index = GpuIndexFormat::uint32;
        const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view(), options);
        REQUIRE(buffers.status);
        REQUIRE(buffers.vertex_count() == 800);
        std::vector<std::pair<double, std::uint32_t>> found;
        for (std::size_t v = 0; v < 800; ++v)
            found.emplace_back(fetch_vertex(buffers, v).at[0], little_endian(buffers.vertices, v * buffers.layout.stride, 2));
        const double step = static_cast<double>(buffers.layout.scale[0]) / 65535, period = width / step;
        CHECK(period == doctest::Approx(std::floor(period + 0.5)).epsilon(1e-6));
        for (std::uint32_t k = 0; k < 400; ++k) {
            const auto place = [&](std::uint32_t v) { return static_cast<double>(mesh.positions[2 * std::size_t{v}]); };
            const auto stored = [&](double x) {
                const auto best = std::min_element(found.begin(), found.end(), [&](const auto& a, const auto& b) {
                    return std::abs(a.first - x) < std::abs(b.first - x);
                });
                CHECK(std::abs(best->first - x) < 0.51 * step);
                return best->second;
            };
            CHECK(stored(place(2 * k + 1)) - stored(place(2 * k)) == static_cast<std::uint32_t>(period + 0.5));
        }
    }
}

TEST_CASE("the box of a mesh that says it is periodic holds its vertices, however many periods they are away") {
    for (const float x : {-300.0F, -30000.0F, 32800.0F, -65600.0F, 70000.0F, -1e9F, 3e38F})
        for (const int width : {1, 2, 300}) {
            CAPTURE(x);
            CAPTURE(width);
            hmesh::Mesh mesh = hmesh_test::two_faces(1);
            mesh.width = width;
            mesh.periodic = hmesh::Periodic::xy;
            for (const std::size_t v : {1U, 2U}) mesh.positions[2 * v] = x;
            const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view());
            REQUIRE(buffers.status);
            REQUIRE(buffers.vertex_count() == 4);
            const auto scale = static_cast<double>(buffers.layout.scale[0]);
            CHECK(std::isfinite(scale));
            CHECK(std::isfinite(buffers.layout.offset[0]));
            for (std::size_t v = 0; v < 4; ++v) {
                double least = std::numeric_limits<double>::max();
                for (std::size_t u = 0; u < 4; ++u)
                    least =
                        std::min(least, std::abs(static_cast<double>(mesh.positions[2 * u]) - fetch_vertex(buffers, v).at[0]));
                CHECK(least <= 1.001 / 131070 * scale);
            }
        }
}

TEST_CASE("vertices without alpha take the colours around them when colours become straight") {
    hmesh::Mesh mesh = hmesh_test::two_faces(4);
    mesh.premultiplied = true;
    mesh.colors = {100, 50, 0, 200, 0, 0, 0, 0, 100, 50, 0, 200, 100, 50, 0, 200};
    GpuOptions options;
    options.alpha = GpuAlpha::straight;
    const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view(), options);
    CHECK(buffers.layout.has_alpha);
    CHECK(!buffers.layout.premultiplied);
    for (std::size_t v = 0; v < 4; ++v) {
        const Fetched vertex = fetch_vertex(buffers, v);
        CHECK(vertex.color[0] == doctest::Approx(128.0 / 255));
        CHECK(vertex.color[1] == doctest::Approx(64.0 / 255));
    }
    options.alpha = GpuAlpha::as_stored;
    CHECK(hmesh::pack_for_gpu(mesh.view(), options).layout.premultiplied);
    mesh.premultiplied = false;
    CHECK(!hmesh::pack_for_gpu(mesh.view(), options).layout.premultiplied);
    options.alpha = GpuAlpha::premultiplied;
    CHECK(hmesh::pack_for_gpu(mesh.view(), options).layout.premultiplied);
}

TEST_CASE("the same mesh gives the same bytes") {
    const hmesh::Mesh mesh = disordered(40, 30, 4, true, 7);
    GpuOptions options;
    for (const GpuTopology topology : {GpuTopology::triangle_list, GpuTopology::triangle_strip}) {
        options.topology = topology;
        const GpuBuffers one = hmesh::pack_for_gpu(mesh.view(), options), other = hmesh::pack_for_gpu(mesh.view(), options);
        CHECK(one.vertices == other.vertices);
        CHECK(one.indices == other.indices);
    }
}

TEST_CASE("a mesh that buffers cannot hold gives a Status and no buffers") {
    using hmesh::Errc;
    const hmesh::Mesh good = hmesh_test::two_faces(3);
    check_refused(hmesh::MeshView{}, {}, "width", Errc::invalid_argument, 0, 1);
    hmesh::Mesh mesh = good;
    mesh.positions.clear(), mesh.colors.clear();
    check_refused(mesh.view(), {}, "no vertices", Errc::invalid_argument, 0, 1);
    mesh = good;
    mesh.faces.clear();
    check_refused(mesh.view(), {}, "no faces", Errc::invalid_argument, 0, 1);
    check_refused(hmesh_test::two_faces(5).view(), {}, "channels", Errc::invalid_argument, 5, 4);
    mesh = good;
    mesh.faces[1][2] = 4;
    check_refused(mesh.view(), {}, "names no vertex", Errc::invalid_argument, 1, 3);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        mesh = good;
        mesh.colors[10] = bad;
        check_refused(mesh.view(), {}, "a colour that is NaN", Errc::not_finite, 3, 0);
        mesh = good;
        mesh.positions[2] = bad;
        check_refused(mesh.view(), {}, "a position that is NaN", Errc::not_finite, 1, 0);
    }
    hmesh::MeshView huge = good.view();
    huge.face_count = (std::size_t{1} << 30U) + 1;
    check_refused(huge, {}, "more vertices or faces", Errc::invalid_argument, 1073741825, 1073741824);
}

TEST_CASE("options out of their range give a Status that names value and bound") {
    using hmesh::Errc;
    const hmesh::Mesh mesh = hmesh_test::two_faces(3);
    const auto refuse = [&](const GpuOptions& options, const char* words, double value, double limit) {
        check_refused(mesh.view(), options, words, Errc::invalid_argument, value, limit);
    };
    GpuOptions options;
    options.chunk_vertices = 2;
    refuse(options, "at least 3", 2, 3);
    options.chunk_vertices = 65536;
    refuse(options, "more vertices than its indices", 65536, 65535);
    options.index = GpuIndexFormat::uint32;
    CHECK(hmesh::pack_for_gpu(mesh.view(), options).status);
    options.chunk_vertices = 0x80000001U;
    refuse(options, "more vertices than its indices", 2147483649.0, 2147483648.0);
    options = {};
    options.position = GpuFormat::unorm8x4;
    refuse(options, "positions' format", 4, 1);
    for (const int color : {0, 5}) {
        options = {};
        options.color = static_cast<GpuFormat>(color);
        refuse(options, "colours' format", color, 4);
    }
    for (const GpuFormat color : {GpuFormat::unorm8x2, GpuFormat::unorm16x2}) {
        options = {};
        options.color = color;
        refuse(options, "grey and alpha", 3, 2);
    }
    options = {};
    options.alpha = static_cast<GpuAlpha>(3);
    refuse(options, "alpha", 3, 2);
    options = {};
    options.topology = static_cast<GpuTopology>(2);
    refuse(options, "topology", 2, 1);
    options = {};
    options.index = static_cast<GpuIndexFormat>(2);
    refuse(options, "indices' format", 2, 1);
}

TEST_CASE("a mesh put into order has the same faces, used vertices alone, and numbers them as files name them") {
    for (const int channels : {1, 4, 16}) {
        CAPTURE(channels);
        hmesh::Mesh mesh = hmesh_test::square_grid(40, 30);
        hmesh::kit::Random random(3);
        for (std::size_t i = mesh.faces.size(); i > 1; --i) std::swap(mesh.faces[i - 1], mesh.faces[random.below(i)]);
        mesh.positions.insert(mesh.positions.begin(), {5, 5});  // of no face
        for (hmesh::Triangle& face : mesh.faces)
            for (std::uint32_t& v : face) ++v;
        mesh.faces.push_back({1, 2, 2});
        mesh.channels = channels;
        mesh.colors.clear();
        for (std::size_t i = 0; i < mesh.vertex_count() * static_cast<std::size_t>(channels); ++i)
            mesh.colors.push_back(static_cast<float>(random.uniform()));
        // A face as its corners' numbers, in their order.
        const auto faces_of = [&](const hmesh::Mesh& from) {
            std::vector<std::vector<float>> out;
            for (const hmesh::Triangle& face : from.faces) {
                if (face[1] == face[2]) continue;
                std::vector<float> numbers;
                for (const std::uint32_t v : face) {
                    numbers.insert(numbers.end(), {from.positions[2 * std::size_t{v}], from.positions[2 * std::size_t{v} + 1]});
                    for (std::size_t k = 0, c = static_cast<std::size_t>(channels); k < c; ++k)
                        numbers.push_back(from.colors[c * v + k]);
                }
                out.push_back(numbers);
            }
            std::sort(out.begin(), out.end());
            return out;
        };
        hmesh::Mesh ordered = mesh;
        REQUIRE(order_for_gpu(ordered));
        CHECK(faces_of(ordered) == faces_of(mesh));
        CHECK(ordered.vertex_count() == mesh.vertex_count() - 1);
        std::uint32_t next = 0;
        std::vector<std::uint32_t> indices;
        for (const hmesh::Triangle& face : ordered.faces)
            for (const std::uint32_t v : {face[0], face[2], face[1]}) {
                CHECK(v <= next);
                next += v == next ? 1 : 0;
                indices.push_back(v);
            }
        CHECK(hmesh::kit::vertex_cache_use(indices.data(), indices.size(), indices.size() / 3, next).acmr < 0.68);
        hmesh::Mesh again = ordered;
        REQUIRE(order_for_gpu(again));
        CHECK(faces_of(again) == faces_of(mesh));
    }
}

TEST_CASE("the parts of a mesh have its faces, each once, and no more vertices than they may") {
    // Corners as positions and colours, in their order.
    const auto faces_of = [](const hmesh::Mesh& from, std::vector<std::array<float, 9>>& out) {
        for (const hmesh::Triangle& face : from.faces) {
            std::array<float, 9> numbers{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t v = face[k];
                numbers[3 * k] = from.positions[2 * v], numbers[3 * k + 1] = from.positions[2 * v + 1];
                numbers[3 * k + 2] = from.colors[3 * v];
            }
            out.push_back(numbers);
        }
    };
    const hmesh::Mesh mesh = hmesh_test::square_grid(300, 230);  // 69,531 vertices
    std::vector<std::array<float, 9>> wanted;
    faces_of(mesh, wanted);
    std::sort(wanted.begin(), wanted.end());
    for (const std::size_t most : {hmesh_test::sanitized ? 100U : 3U, 1000U, 65535U, 69531U}) {
        CAPTURE(most);
        std::vector<hmesh::Mesh> parts;
        REQUIRE(hmesh::cut_for_gpu(mesh.view(), parts, most));
        std::vector<std::array<float, 9>> found;
        std::size_t vertices = 0;
        for (const hmesh::Mesh& part : parts) {
            CHECK(part.vertex_count() <= most);
            CHECK(hmesh::check(part.view(), 3));
            CHECK((part.width == 300 && part.height == 230 && part.peak == mesh.peak && part.channels == 3));
            vertices += part.vertex_count();
            faces_of(part, found);
        }
        std::sort(found.begin(), found.end());
        CHECK(found == wanted);
        if (most == 65535) CHECK((parts.size() == 2 && vertices <= mesh.vertex_count() + 2 * 231));
        if (most == 69531) CHECK((parts.size() == 1 && parts[0].positions == mesh.positions && parts[0].faces == mesh.faces));
    }
    std::vector<hmesh::Mesh> parts(1);
    CHECK(hmesh::cut_for_gpu(hmesh::Mesh{}.view(), parts).code == hmesh::Errc::invalid_argument);
    CHECK(parts.empty());
}

TEST_CASE("a mesh that cannot be ordered stays as it is") {
    hmesh::Mesh mesh = hmesh_test::two_faces(3);
    mesh.faces = {{0, 1, 1}, {2, 2, 2}};
    const hmesh::Mesh before = mesh;
    CHECK(order_for_gpu(mesh).code == hmesh::Errc::invalid_argument);
    CHECK(mesh.faces == before.faces);
    mesh.faces = {{0, 1, 4}};
    CHECK(order_for_gpu(mesh).code == hmesh::Errc::invalid_argument);
    CHECK(mesh.faces[0][2] == 4);
    mesh = hmesh_test::two_faces(3);
    mesh.colors[4] = std::numeric_limits<float>::infinity();
    CHECK(order_for_gpu(mesh).code == hmesh::Errc::not_finite);
    mesh = hmesh_test::two_faces(3);
    mesh.colors.pop_back();
    CHECK(order_for_gpu(mesh).code == hmesh::Errc::invalid_argument);
    mesh = {};
    CHECK(order_for_gpu(mesh).code == hmesh::Errc::invalid_argument);
}

TEST_CASE("a mesh of nothing gives buffers of no bytes, and a layout") {
    hmesh::Mesh mesh = hmesh_test::two_faces(4);
    mesh.positions.clear(), mesh.colors.clear(), mesh.faces.clear();
    const GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view());
    CHECK(buffers.status);
    CHECK(buffers.vertices.empty());
    CHECK(buffers.indices.empty());
    CHECK(buffers.chunks.empty());
    CHECK(buffers.layout.stride == 8);
    CHECK(buffers.layout.width == 3);
    mesh.width = 0;
    CHECK_FALSE(hmesh::pack_for_gpu(mesh.view()).status);
}
