#include "hmesh/tiles/fans.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

using hmesh::kit::FanCorner;

TEST_CASE("faces that share an edge at a vertex are of one fan, whatever their order, and vertices come by their number") {
    // Around vertex 7: faces 5, 1, 3 from neighbour 10 to 13, and face 2 between 20 and 21. Around vertex 4: face 0.
    hmesh::kit::Array<FanCorner> corners{
        {7, 5, 0, 10, 11, 0}, {7, 2, 1, 20, 21, 0}, {4, 0, 2, 1, 2, 0}, {7, 3, 0, 12, 13, 0}, {7, 1, 0, 11, 12, 0}};
    std::vector<std::pair<std::size_t, std::size_t>> ranges;
    hmesh::kit::find_fans(corners, [&](std::size_t begin, std::size_t end) { ranges.emplace_back(begin, end); });
    CHECK((ranges == std::vector<std::pair<std::size_t, std::size_t>>{{0, 1}, {1, 5}}));
    std::vector<std::uint32_t> faces, fans;
    for (const FanCorner& corner : corners) {
        faces.push_back(corner.face);
        fans.push_back(corner.fan);
    }
    CHECK((faces == std::vector<std::uint32_t>{0, 1, 2, 3, 5}));
    CHECK((fans == std::vector<std::uint32_t>{0, 1, 2, 1, 1}));
}

TEST_CASE("no corners, no fans") {
    hmesh::kit::Array<FanCorner> none;
    hmesh::kit::find_fans(none, [](std::size_t, std::size_t) { FAIL("called"); });
    CHECK(none.empty());
}
