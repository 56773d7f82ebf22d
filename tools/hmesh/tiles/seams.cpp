#include "tiles/seams.hpp"

#include <utility>
#include <vector>

#include "tiles/sides.hpp"
#include "tiles/tasks.hpp"

namespace tool {
namespace {

// What is left of a tile when it has been read.
struct Sides {
    std::vector<SideVertex> west, east, north, south;
};

std::string read_sides(const TilePlan& plan, const TileTask& tile, Sides& sides) {
    TileFacts facts;
    hmesh::Mesh mesh;
    if (std::string why = read_tile(plan, tile, facts, mesh); !why.empty()) return why;
    sides = {side_vertices(mesh, TileSide::west), side_vertices(mesh, TileSide::east), side_vertices(mesh, TileSide::north),
             side_vertices(mesh, TileSide::south)};
    return {};
}

void compare(const std::vector<SideVertex>& one, const std::vector<SideVertex>& other, const std::string& pair,
             TileSeams& seams) {
    const std::int64_t before = seams.open;
    std::size_t i = 0, j = 0;
    while (i < one.size() && j < other.size()) {
        if (one[i].is_same(other[j])) {
            ++seams.shared;
            ++i;
            ++j;
            continue;
        }
        ++seams.open;
        if (one[i].along < other[j].along) ++i;
        else ++j;
    }
    seams.open += static_cast<std::int64_t>(one.size() - i + other.size() - j);
    ++seams.pairs;
    if (seams.open > before && seams.first.empty()) seams.first = pair;
}

}  // namespace

std::string find_seams(const TilePlan& plan, int level, int y, TileSeams& seams) {
    seams = {};
    Sides before, here, below;
    for (int x = 0; x < plan.level(level).across(); ++x) {
        const TileTask tile{TileTaskKind::tile, level, x, y};
        const auto with = [&](int i, int j) { return name_of(plan, {TileTaskKind::tile, level, i, j}) + " and "; };
        if (std::string why = read_sides(plan, tile, here); !why.empty()) return why;
        if (x > 0) compare(before.east, here.west, with(x - 1, y) + name_of(plan, tile), seams);
        if (y + 1 < plan.level(level).down()) {
            const TileTask next{TileTaskKind::tile, level, x, y + 1};
            if (std::string why = read_sides(plan, next, below); !why.empty()) return why;
            compare(here.south, below.north, with(x, y) + name_of(plan, next), seams);
        }
        std::swap(before, here);
    }
    return {};
}

}  // namespace tool
