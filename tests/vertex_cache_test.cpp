#include "hmesh/io/gpu/vertex_cache.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <numeric>
#include <set>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"

namespace {

using Faces = std::vector<hmesh::Triangle>;

std::vector<std::uint32_t> indices_of(const Faces& faces) {
    std::vector<std::uint32_t> indices;
    for (const auto& face : faces) indices.insert(indices.end(), face.begin(), face.end());
    return indices;
}

// The misses of a queue that is a queue.
std::size_t misses_of_queue(const std::vector<std::uint32_t>& indices, std::size_t entries, std::deque<std::uint32_t>& queue) {
    std::size_t misses = 0;
    for (const std::uint32_t v : indices) {
        if (v == hmesh::kit::no_index || std::find(queue.begin(), queue.end(), v) != queue.end()) continue;
        ++misses;
        queue.push_back(v);
        if (queue.size() > entries) queue.pop_front();
    }
    return misses;
}

std::size_t misses_of_queue(const std::vector<std::uint32_t>& indices, std::size_t entries) {
    std::deque<std::uint32_t> queue;
    return misses_of_queue(indices, entries, queue);
}

hmesh::kit::VertexCacheUse use_of(const Faces& faces, std::size_t vertices) {
    const std::vector<std::uint32_t> indices = indices_of(faces);
    return hmesh::kit::vertex_cache_use(indices.data(), indices.size(), faces.size(), vertices);
}

Faces ordered(const Faces& faces, std::size_t vertices) {
    const std::vector<std::uint32_t> order = hmesh::kit::vertex_cache_order(faces, vertices);
    std::vector<std::uint32_t> sorted = order, all(faces.size());
    std::iota(all.begin(), all.end(), 0U);
    std::sort(sorted.begin(), sorted.end());
    CHECK(sorted == all);
    Faces out;
    for (const std::uint32_t f : order) out.push_back(faces[f]);
    return out;
}

// Faces without order or shape, three different corners each.
Faces random_faces(hmesh::kit::Random& random, std::size_t count, std::size_t vertices) {
    Faces faces(count);
    for (auto& face : faces) do
            for (std::uint32_t& v : face) v = static_cast<std::uint32_t>(random.below(vertices));
        while (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]);
    return faces;
}

}  // namespace

TEST_CASE("misses are those of a queue of so many vertices") {
    const Faces faces = hmesh_test::square_grid(9, 7).faces;
    const auto use = use_of(faces, 100);  // 80 are used
    CHECK(use.misses == misses_of_queue(indices_of(faces), 16));
    CHECK(use.acmr == doctest::Approx(static_cast<double>(use.misses) / 126));
    CHECK(use.atvr == doctest::Approx(static_cast<double>(use.misses) / 80));
    hmesh::kit::Random random(3);
    for (int i = 0; i < 100; ++i) {
        std::vector<std::uint32_t> indices(1 + random.below(90));
        for (std::uint32_t& v : indices)
            v = random.below(9) == 0 ? hmesh::kit::no_index : static_cast<std::uint32_t>(random.below(30));
        for (const std::size_t entries : {3U, 4U, 16U, 40U})
            CHECK(hmesh::kit::vertex_cache_use(indices.data(), indices.size(), 1, 30, entries).misses ==
                  misses_of_queue(indices, entries));
    }
    const auto nothing = hmesh::kit::vertex_cache_use(nullptr, 0, 0, 0);
    CHECK(nothing.misses == 0);
    CHECK(nothing.acmr == 0);
    CHECK(nothing.atvr == 0);
}

TEST_CASE("what the front counts is what is there: faces left and vertices cached, in any mesh") {
    hmesh::kit::Random random(5);
    for (int i = 0; i < 24; ++i) {
        const std::size_t vertices = 4 + random.below(30);
        const Faces faces = random_faces(random, 1 + random.below(i == 0 ? 400 : 80), vertices);  // some have hubs
        hmesh::kit::detail::DrawFront front(faces, vertices);
        std::vector<std::uint32_t> drawn;
        std::set<std::uint32_t> left;
        for (std::uint32_t f = 0; f < faces.size(); ++f) left.insert(f);
        while (!front.is_done()) {
            const std::uint32_t v = front.next_vertex();
            REQUIRE(front.left(v) > 0);
            std::uint32_t next = hmesh::kit::no_index;
            std::size_t seen = 0;
            front.for_each_left(v, [&](std::uint32_t f) {
                if (left.count(f) != 1 || std::count(faces[f].begin(), faces[f].end(), v) != 1) FAIL("face ", f, " at ", v);
                if (seen++ == 0 || random.below(3) == 0) next = f;
            });
            REQUIRE(seen > 0);
            REQUIRE(seen <= 64);
            front.take(next);
            left.erase(next);
            drawn.insert(drawn.end(), faces[next].begin(), faces[next].end());
            std::deque<std::uint32_t> queue;
            const std::size_t misses = misses_of_queue(drawn, 16, queue);
            REQUIRE(front.clock() == misses + 17);
            for (std::uint32_t u = 0; u < vertices; ++u) {
                const auto around = [&](std::uint32_t f) { return std::count(faces[f].begin(), faces[f].end(), u) == 1; };
                if (front.left(u) != static_cast<std::uint32_t>(std::count_if(left.begin(), left.end(), around)))
                    FAIL("left of ", u);
                if (front.is_cached(u) != (std::find(queue.begin(), queue.end(), u) != queue.end())) FAIL("cached ", u);
            }
        }
        CHECK(left.empty());
    }
}

TEST_CASE("each face is there once, in any list of faces") {
    hmesh::kit::Random random(1);
    for (int i = 0; i < 200; ++i) {
        const std::size_t vertices = 3 + random.below(20);
        const Faces faces = random_faces(random, random.below(200), vertices);
        (void)ordered(faces, vertices);
    }
    (void)ordered({}, 0);
}

TEST_CASE("the order of a grid misses 0.66 vertices a face at most, from whatever order it comes") {
    Faces faces = hmesh_test::square_grid(60, 40).faces;
    const std::size_t vertices = 61 * 41;
    CHECK(use_of(faces, vertices).acmr > 0.9);
    CHECK(use_of(ordered(faces, vertices), vertices).acmr < 0.66);
    hmesh::kit::Random random(2);
    for (std::size_t i = faces.size(); i > 1; --i) std::swap(faces[i - 1], faces[random.below(i)]);
    CHECK(use_of(faces, vertices).acmr > 2.5);
    CHECK(use_of(ordered(faces, vertices), vertices).acmr < 0.66);
    CHECK(ordered(faces, vertices) == ordered(faces, vertices));
}

TEST_CASE("vertices of very many faces take no longer than others") {
    constexpr std::uint32_t spokes = 100000;  // times themselves they would take minutes
    Faces fan, book;
    for (std::uint32_t i = 0; i < spokes; ++i) {
        fan.push_back({0, i + 1, (i + 1) % spokes + 1});
        book.push_back({0, 1, i + 2});
    }
    CHECK(use_of(ordered(fan, spokes + 1), spokes + 1).acmr < 1.2);
    CHECK(use_of(ordered(book, spokes + 2), spokes + 2).acmr < 1.3);
}
