#include "terrain/job/places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "hmesh/core/version.hpp"

namespace terrain {
namespace {

using job::Json;
using Box = std::array<double, 6>;  // least, then greatest x, y and z

constexpr double radians = 3.14159265358979323846 / 180;

Box around(const Box& a, const Box& b) {
    Box box{};
    for (std::size_t k = 0; k < 3; ++k) {
        box[k] = std::min(a[k], b[k]);
        box[k + 3] = std::max(a[k + 3], b[k + 3]);
    }
    return box;
}

// A centre and three half axes.
Json box_value(const Box& box) {
    const auto middle = [&](std::size_t k) { return (box[k] + box[k + 3]) / 2; };
    const auto half = [&](std::size_t k) { return (box[k + 3] - box[k]) / 2; };
    return {{"box", {middle(0), middle(1), middle(2), half(0), 0.0, 0.0, 0.0, half(1), 0.0, 0.0, 0.0, half(2)}}};
}

double diagonal(const Box& box) { return std::hypot(box[3] - box[0], box[4] - box[1], box[5] - box[2]); }

// From local coordinates of the files to the Earth's: 16 numbers, column after column.
Json transform_value(const Plan& plan, const Georeference& place) {
    const Frame& frame = plan.frame;
    const double scale = 1 / plan.arguments.scale;
    const double x = frame.x_step * (plan.width - 1) / 2,
                 y = frame.y_step * (plan.height - 1) / 2;  // of the middle, in the files
    const auto& t = place.transform;
    const double longitude = (t[0] + t[1] * (plan.width - 1) / 2) * radians,
                 latitude = (t[3] + t[5] * (plan.height - 1) / 2) * radians;
    const double sin_long = std::sin(longitude), cos_long = std::cos(longitude);
    const double sin_lat = std::sin(latitude), cos_lat = std::cos(latitude);
    const double flattening = place.inverse_flattening > 0 ? 1 / place.inverse_flattening : 0;
    const double square = flattening * (2 - flattening), normal = place.semi_major / std::sqrt(1 - square * sin_lat * sin_lat);
    const std::array<double, 3> east = {-sin_long, cos_long, 0}, north = {-sin_lat * cos_long, -sin_lat * sin_long, cos_lat},
                                up = {cos_lat * cos_long, cos_lat * sin_long, sin_lat},
                                middle = {normal * up[0], normal * up[1], (1 - square) * normal * up[2]};
    Json value = Json::array();
    for (const std::array<double, 3>& axis : {east, north, up}) {
        for (const double number : axis) value.push_back(scale * number);
        value.push_back(0.0);
    }
    for (std::size_t k = 0; k < 3; ++k) value.push_back(middle[k] - scale * (x * east[k] + y * north[k]));
    value.push_back(1.0);
    return value;
}

// The tiles of all levels as a tree: those of the coarsest level in boxes of boxes, and in each the four of the next level.
class Tree {
  public:
    Tree(const Plan& plan, const std::vector<PlacedTile>& tiles) : plan_(plan), top_(static_cast<int>(plan.levels.size()) - 1) {
        for (const PlacedTile& tile : tiles) {
            if (tile.facts.end.kind != TileEnd::Kind::made) continue;
            found_[{tile.task.level, tile.task.x, tile.task.y}] = &tile;
        }
    }

    // null: there is none.
    [[nodiscard]] Json root(Box& box) const {
        // Tiles that stand on a part of one, since the coarsest level ends before the others do.
        int columns = 0, rows = 0;
        for (int level = 0; level <= top_; ++level) {
            const int step = 1 << (top_ - level);
            columns = std::max(columns, (plan_.level(level).across + step - 1) / step);
            rows = std::max(rows, (plan_.level(level).down + step - 1) / step);
        }
        return group(0, 0, columns, rows, box);
    }

  private:
    // Nodes, and the box around them.
    struct Nodes {
        void add(Json node, const Box& part) {
            if (node.is_null()) return;
            box = all.empty() ? part : around(box, part);
            all.push_back(std::move(node));
        }
        Json all = Json::array();
        Box box{};
    };

    // Of tiles of the coarsest level.
    [[nodiscard]] Json group(int x, int y, int columns, int rows, Box& box) const {
        if (columns == 1 && rows == 1) return tile(top_, x, y, box);
        // Cut where halves are powers of two.
        const auto half = [](int count) {
            int part = 1;
            while (2 * part < count) part *= 2;
            return std::min(part, count);
        };
        const int side = half(std::max(columns, rows));
        Nodes children;
        for (const int top : {0, side})
            for (const int left : {0, side}) {
                if (left >= columns || top >= rows) continue;
                Box part{};
                Json child = group(x + left, y + top, std::min(columns - left, left > 0 ? columns : side),
                                   std::min(rows - top, top > 0 ? rows : side), part);
                children.add(std::move(child), part);
            }
        return without_mesh(std::move(children), box);
    }

    [[nodiscard]] Json tile(int level, int x, int y, Box& box) const {
        Nodes children;
        if (level > 0)
            for (const int down : {0, 1})
                for (const int right : {0, 1}) {
                    Box part{};
                    Json child = tile(level - 1, 2 * x + right, 2 * y + down, part);
                    children.add(std::move(child), part);
                }
        const auto at = found_.find({level, x, y});
        if (at == found_.end()) return without_mesh(std::move(children), box);
        const TileFacts& facts = at->second->facts;
        box = children.all.empty() ? facts.box : around(facts.box, children.box);
        double error = 0;  // there is nothing finer
        if (!children.all.empty()) {
            error = facts.input_error * plan_.frame.z_scale;
            for (const Json& child : children.all) error = std::max(error, child["geometricError"].get<double>());
        }
        Json node = {{"boundingVolume", box_value(box)}, {"geometricError", error}, {"content", {{"uri", at->second->file}}}};
        if (!children.all.empty()) node["children"] = std::move(children.all);
        return node;
    }

    // All of it is missing.
    [[nodiscard]] static Json without_mesh(Nodes children, Box& box) {
        if (children.all.empty()) return nullptr;
        box = children.box;
        return {{"boundingVolume", box_value(box)}, {"geometricError", diagonal(box)}, {"children", std::move(children.all)}};
    }

    const Plan& plan_;
    int top_;  // the coarsest level
    std::map<std::array<int, 3>, const PlacedTile*> found_;
};

}  // namespace

Json tileset_value(const Plan& plan, const Georeference& place, const std::vector<PlacedTile>& tiles) {
    Box box{};
    Json root = Tree(plan, tiles).root(box);
    if (root.is_null()) root = {{"boundingVolume", box_value(box)}, {"geometricError", 0}};
    root["refine"] = "REPLACE";
    if (place.is_geographic) root["transform"] = transform_value(plan, place);
    const double unit = place.is_geographic ? plan.arguments.scale : 1;  // viewers scale errors of the tree by its transform
    return {{"asset", {{"version", "1.1"}, {"generator", "hmesh " HMESH_VERSION_STRING}}},
            {"geometricError", diagonal(box) / unit},
            {"root", std::move(root)}};
}

Json layer_value(const Plan& plan, const std::vector<PlacedTile>& tiles) {
    const GlobeGrid& grid = *plan.globe;
    // Rows of tiles from the south, of which runs are there.
    Json available = Json::array();
    for (int zoom = 0; zoom <= grid.zoom; ++zoom) available.push_back(Json::array());
    std::map<std::array<int, 3>, int> runs;  // zoom, y and first x; the last x
    for (const PlacedTile& tile : tiles) {
        if (tile.facts.end.kind != TileEnd::Kind::made) continue;
        const auto [zoom, x, y] = globe_tile(plan, tile.task);
        const auto next = runs.upper_bound({zoom, y, x});
        if (next != runs.begin()) {
            const auto run = std::prev(next);
            if (run->first[0] == zoom && run->first[1] == y && run->second == x - 1) {
                run->second = x;
                continue;
            }
        }
        runs[{zoom, y, x}] = x;
    }
    for (const auto& [first, last] : runs)
        available[static_cast<std::size_t>(first[0])].push_back(
            {{"startX", first[2]}, {"startY", first[1]}, {"endX", last}, {"endY", first[1]}});
    Json extensions = Json::array();
    if (plan.arguments.has_normals) extensions.push_back("octvertexnormals");
    return {{"tilejson", "2.1.0"},
            {"format", "quantized-mesh-1.0"},
            {"version", "1.0.0"},
            {"scheme", "tms"},
            {"projection", "EPSG:4326"},
            {"extensions", std::move(extensions)},
            {"tiles", {"{z}/{x}/{y}.terrain"}},
            {"bounds", *plan.frame.extent},
            {"minzoom", 0},
            {"maxzoom", grid.zoom},
            {"available", std::move(available)}};
}

}  // namespace terrain
