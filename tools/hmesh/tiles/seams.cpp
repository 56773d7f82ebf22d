#include "tiles/seams.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tiles/sides.hpp"
#include "tiles/tasks.hpp"

namespace tool {
namespace {

// A tile's file, whose sides are those that the tile's task has summed up where it is the file of that task, or are read.
class SidesOfTile {
  public:
    [[nodiscard]] std::string open(const TilePlan& plan, const TileTask& tile) {
        *this = {};
        plan_ = &plan;
        name_ = name_of(plan, tile);
        if (std::string why = find_tile(plan, tile, facts_); !why.empty()) return why;
        return job::read_made(plan.folder, facts_.file, bytes_);
    }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    // Null where only reading tells.
    [[nodiscard]] const SideDigest* digest(TileSide side) const noexcept {
        return facts_.sides_of == facts_.file.sha256 ? &facts_.sides[static_cast<std::size_t>(side)] : nullptr;
    }
    [[nodiscard]] std::string read(TileSide side, std::vector<SideVertex>& vertices) {
        if (!mesh_)
            if (std::string why = decode_tile(*plan_, facts_, bytes_, mesh_.emplace()); !why.empty()) return why;
        vertices = side_vertices(*mesh_, side);
        return {};
    }

  private:
    const TilePlan* plan_ = nullptr;
    std::string name_;
    TileFacts facts_;
    std::vector<unsigned char> bytes_;
    std::optional<hmesh::Mesh> mesh_;
};

std::string compare(SidesOfTile& tile, TileSide side, SidesOfTile& neighbor, TileSide its_side, TileSeams& seams) {
    ++seams.pairs;
    const SideDigest *const a = tile.digest(side), *const b = neighbor.digest(its_side);
    if (a != nullptr && b != nullptr && a->is_same(*b)) {
        seams.shared += static_cast<std::int64_t>(a->vertices);
        return {};
    }
    std::vector<SideVertex> first, second;
    if (std::string why = tile.read(side, first); !why.empty()) return why;
    if (std::string why = neighbor.read(its_side, second); !why.empty()) return why;
    const std::int64_t before = seams.open;
    std::size_t i = 0, j = 0;
    while (i < first.size() && j < second.size()) {
        if (first[i].is_same(second[j])) {
            ++seams.shared;
            ++i;
            ++j;
            continue;
        }
        ++seams.open;
        if (first[i].along < second[j].along) ++i;
        else ++j;
    }
    seams.open += static_cast<std::int64_t>(first.size() - i + second.size() - j);
    if (seams.open > before && seams.first.empty()) seams.first = tile.name() + " and " + neighbor.name();
    return {};
}

}  // namespace

std::string find_seams(const TilePlan& plan, int level, int y, TileSeams& seams) {
    seams = {};
    SidesOfTile before, here, below;
    for (int x = 0; x < plan.level(level).across(); ++x) {
        if (std::string why = here.open(plan, {TileTaskKind::tile, level, x, y}); !why.empty()) return why;
        if (x > 0)
            if (std::string why = compare(before, TileSide::east, here, TileSide::west, seams); !why.empty()) return why;
        if (y + 1 < plan.level(level).down()) {
            if (std::string why = below.open(plan, {TileTaskKind::tile, level, x, y + 1}); !why.empty()) return why;
            if (std::string why = compare(here, TileSide::south, below, TileSide::north, seams); !why.empty()) return why;
        }
        std::swap(before, here);
    }
    return {};
}

}  // namespace tool
