#include "hmesh/io/gpu/cached_strips.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"

namespace {

using Faces = std::vector<hmesh::Triangle>;

// The least corner first, in the same sense; then the faces in order.
Faces sorted(Faces faces) {
    for (auto& face : faces) std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    std::sort(faces.begin(), faces.end());
    return faces;
}

// What the specification of OpenGL 4.6, section 10.1.8, makes of the indices of strips; faces without area are left out.
Faces drawn(const std::vector<std::uint32_t>& indices) {
    Faces faces;
    std::vector<std::uint32_t> strip;
    for (const std::uint32_t v : indices) {
        if (v == hmesh::kit::no_index) {
            strip.clear();
            continue;
        }
        strip.push_back(v);
        const std::size_t n = strip.size();
        if (n < 3) continue;
        hmesh::Triangle face{strip[n - 3], strip[n - 2], strip[n - 1]};
        if (n % 2 == 0) std::swap(face[0], face[1]);
        if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) faces.push_back(face);
    }
    return faces;
}

// The number of indices, of faces that are drawn as they are.
std::size_t size_of_strips(const Faces& faces, std::size_t vertices) {
    const auto strips = hmesh::kit::vertex_cache_strips(faces, vertices);
    CHECK(sorted(drawn(strips)) == sorted(faces));
    return strips.size();
}

}  // namespace

TEST_CASE("a band of faces is one strip, a fan one with a swap for each other face, until they are as long as the cache") {
    Faces band, fan;
    for (std::uint32_t i = 0; i < 8; ++i) {
        band.push_back(i % 2 == 0 ? hmesh::Triangle{i, i + 1, i + 2} : hmesh::Triangle{i + 1, i, i + 2});
        fan.push_back({0, i + 1, i + 2});
    }
    CHECK(size_of_strips(band, 10) == 10);
    CHECK(size_of_strips(fan, 10) <= 19);
    CHECK(size_of_strips({{0, 1, 2}}, 3) == 3);
    CHECK(size_of_strips({{0, 1, 2}, {2, 3, 4}, {4, 5, 0}}, 6) == 11);  // they touch in vertices alone
    CHECK(size_of_strips({}, 0) == 0);
}

TEST_CASE("any list of faces is drawn face by face, turned as they were: sides of many faces, faces on each other") {
    CHECK(size_of_strips({{0, 1, 2}, {0, 1, 2}, {0, 2, 1}, {1, 0, 3}, {0, 1, 4}}, 5) <= 19);
    hmesh::kit::Random random(1);
    for (int i = 0; i < 600; ++i) {
        const auto vertices = 3 + random.below(i % 2 == 0 ? 6 : 30);
        Faces faces(1 + random.below(200));
        for (auto& face : faces) do
                for (std::uint32_t& v : face) v = static_cast<std::uint32_t>(random.below(vertices));
            while (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]);
        (void)size_of_strips(faces, vertices);
    }
}

TEST_CASE("strips of a grid take 1.6 indices and 0.75 misses a face at most, from whatever order it comes") {
    Faces faces = hmesh_test::square_grid(60, 40).faces;
    hmesh::kit::Random random(2);
    for (int i = 0; i < 2; ++i) {
        const auto strips = hmesh::kit::vertex_cache_strips(faces, 61 * 41);
        CHECK(sorted(drawn(strips)) == sorted(faces));
        CHECK(strips.size() < faces.size() * 8 / 5);
        CHECK(hmesh::kit::vertex_cache_use(strips.data(), strips.size(), faces.size(), 61 * 41).acmr < 0.75);
        for (std::size_t k = faces.size(); k > 1; --k) std::swap(faces[k - 1], faces[random.below(k)]);
    }
}

TEST_CASE("vertices of very many faces take no longer than others in strips") {
    constexpr std::uint32_t spokes = 100000;
    Faces fan, book;
    for (std::uint32_t i = 0; i < spokes; ++i) {
        fan.push_back({0, i + 1, (i + 1) % spokes + 1});
        book.push_back(i % 2 == 0 ? hmesh::Triangle{0, 1, i + 2} : hmesh::Triangle{1, 0, i + 2});
    }
    CHECK(size_of_strips(fan, spokes + 1) < 3 * spokes);
    CHECK(size_of_strips(book, spokes + 2) <= 4 * spokes);
}
