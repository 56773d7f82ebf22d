#include <nlohmann/json.hpp>

#include "terrain/job/sides.hpp"
#include "terrain/job/tasks.hpp"

namespace terrain {
namespace {

// What is left of a tile when it has been read.
struct Sides {
    TaskName task;
    bool is_made = false, has_no_data = false;
    std::vector<SideVertex> west, east, north, south;
};

std::string read_sides(const Plan& plan, const TaskName& task, Sides& sides) {
    TileFacts facts;
    Model model;
    if (std::string why = read_tile(plan, task, facts, model); !why.empty()) return why;
    sides = {};
    sides.task = task;
    sides.is_made = facts.end.kind == TileEnd::Kind::made;
    sides.has_no_data = facts.end.no_data > 0;
    sides.west = vertices_of(plan, task, model, Side::west);
    sides.east = vertices_of(plan, task, model, Side::east);
    sides.north = vertices_of(plan, task, model, Side::north);
    sides.south = vertices_of(plan, task, model, Side::south);
    return {};
}

void compare(const Plan& plan, const Sides& a, const std::vector<SideVertex>& one, const Sides& b,
             const std::vector<SideVertex>& other, Seams& seams) {
    if (!a.is_made || !b.is_made) return;
    std::int64_t open = 0;
    std::size_t i = 0, j = 0;
    while (i < one.size() || j < other.size()) {
        const bool is_first = j == other.size() || (i < one.size() && one[i] < other[j]);
        const bool is_second = !is_first && (i == one.size() || other[j] < one[i]);
        if (is_first || is_second) ++open;
        else ++seams.shared;
        if (!is_second) ++i;
        if (!is_first) ++j;
    }
    ++seams.pairs;
    const bool is_excused = a.has_no_data || b.has_no_data;  // one side may have no cell where the other has
    (is_excused ? seams.no_data : seams.open) += open;
    if (open > 0 && !is_excused && seams.first.empty()) seams.first = name_of(plan, a.task) + " and " + name_of(plan, b.task);
}

}  // namespace

std::string find_seams(const Plan& plan, int level, int y, Seams& seams) {
    const Level& size = plan.level(level);
    seams = {};
    Sides before, here, below;
    for (int x = 0; x < size.across; ++x) {
        if (std::string why = read_sides(plan, {TaskKind::tile, level, x, y}, here); !why.empty()) return why;
        if (x > 0) compare(plan, before, before.east, here, here.west, seams);
        if (y + 1 < size.down) {
            if (std::string why = read_sides(plan, {TaskKind::tile, level, x, y + 1}, below); !why.empty()) return why;
            compare(plan, here, here.south, below, below.north, seams);
        }
        std::swap(before, here);
    }
    return {};
}

job::Json value_of(const Seams& seams) {
    return {{"pairs", seams.pairs},
            {"shared", seams.shared},
            {"open", seams.open},
            {"no_data", seams.no_data},
            {"first", seams.first}};
}

Seams seams_of(const job::Json& facts) {
    Seams seams;
    seams.pairs = facts["pairs"].get<std::int64_t>();
    seams.shared = facts["shared"].get<std::int64_t>();
    seams.open = facts["open"].get<std::int64_t>();
    seams.no_data = facts["no_data"].get<std::int64_t>();
    seams.first = facts["first"].get<std::string>();
    return seams;
}

}  // namespace terrain
