#include "terrain/job/sides.hpp"

#include <algorithm>

#include <hmesh/core/finite.hpp>

namespace terrain {
namespace {

// The coordinate of the side in the tile's file: local metres as the float that the exporter makes of them, or a share of the
// tile.
double place_of(const Plan& plan, const TaskName& task, Side side) {
    const bool is_far = side == Side::east || side == Side::north;
    if (plan.arguments.format == Format::quantized_mesh) return is_far ? 1 : 0;
    const Frame& frame = plan.level(task.level).frame;
    const Tile tile = tile_of(plan, task);
    if (side == Side::west || side == Side::east) {
        const int column = tile.column + (is_far ? tile.width - 1 : 0);
        return hmesh::kit::as_float(frame.x_origin + frame.x_step * column);
    }
    const int row = tile.row + (is_far ? 0 : tile.height - 1);
    return hmesh::kit::as_float(frame.y_origin - frame.y_step * row);
}

}  // namespace

std::vector<SideVertex> vertices_of(const Plan& plan, const TaskName& task, const Model& model, Side side) {
    const double place = place_of(plan, task, side);
    const std::size_t across = side == Side::west || side == Side::east ? 0 : 1;
    const auto equal = [](double a, double b) { return !(a < b) && !(b < a); };
    std::vector<SideVertex> found;
    for (std::size_t v = 0; v < model.vertices.size(); ++v) {
        const std::array<double, 3>& at = model.vertices[v];
        if (!equal(at[across], place)) continue;
        SideVertex vertex{{at[1 - across], at[2], 0, 0, 0}, static_cast<std::uint32_t>(v)};
        if (!model.normals.empty()) std::copy(model.normals[v].begin(), model.normals[v].end(), vertex.key.begin() + 2);
        found.push_back(vertex);
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace terrain
