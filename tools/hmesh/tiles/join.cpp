#include "tiles/join.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "hmesh/mesh/mesh.hpp"
#include "job/work.hpp"
#include "results/mesh_file.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/words.hpp"
#include "tiles/sides.hpp"
#include "tiles/tasks.hpp"
#include "writers/formats.hpp"
#include "writers/write_file.hpp"

namespace tool {
namespace {

using job::Json;

// Moves a tile's mesh to its place in the whole. Positions are multiples of 1/256 sample up to 65536 px: floats hold them.
void place(const TilePlan& plan, const TileTask& tile, hmesh::Mesh& mesh) {
    const hmesh::kit::Rect rect = rect_of(plan, tile);
    const auto step = static_cast<float>(plan.level(tile.level).step);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        mesh.positions[2 * v] = step * (mesh.positions[2 * v] + static_cast<float>(rect.x));
        mesh.positions[2 * v + 1] = step * (mesh.positions[2 * v + 1] + static_cast<float>(rect.y));
    }
    mesh.width = plan.width;
    mesh.height = plan.height;
}

// Puts tiles of the finest level together, row after row: vertices of seams are those of the tile in the west or above.
class Joiner {
  public:
    explicit Joiner(const TilePlan& plan) : plan_(plan), south_(static_cast<std::size_t>(plan.level(0).across())) {}

    [[nodiscard]] std::string add(const TileTask& tile) {
        TileFacts facts;
        hmesh::Mesh mesh;
        if (std::string why = read_tile(plan_, tile, facts, mesh); !why.empty()) return why;
        constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
        if (whole.vertex_count() + mesh.vertex_count() >= none)
            return "the whole has more vertices than 32 bits number: join it into a folder";
        std::vector<std::uint32_t> numbers(mesh.vertex_count(), none);
        Known& south = south_[static_cast<std::size_t>(tile.x)];
        if (tile.x > 0) take(east_, side_vertices(mesh, TileSide::west), numbers);
        if (tile.y > 0) take(south, side_vertices(mesh, TileSide::north), numbers);
        const std::vector<SideVertex> east = side_vertices(mesh, TileSide::east), below = side_vertices(mesh, TileSide::south);
        place(plan_, tile, mesh);
        const auto channels = static_cast<std::size_t>(mesh.channels);
        for (std::size_t v = 0; v < numbers.size(); ++v) {
            if (numbers[v] != none) continue;
            numbers[v] = static_cast<std::uint32_t>(whole.vertex_count());
            whole.positions.insert(whole.positions.end(), &mesh.positions[2 * v], &mesh.positions[2 * v] + 2);
            whole.colors.insert(whole.colors.end(), &mesh.colors[channels * v], &mesh.colors[channels * v] + channels);
        }
        for (const auto& [a, b, c] : mesh.faces) whole.faces.push_back({numbers[a], numbers[b], numbers[c]});
        whole.channels = mesh.channels;
        whole.width = mesh.width;
        whole.height = mesh.height;
        whole.peak = mesh.peak;
        whole.samples = mesh.samples;
        give(east, numbers, east_);
        give(below, numbers, south);
        return {};
    }

    hmesh::Mesh whole;

  private:
    struct Numbered {
        SideVertex vertex;
        std::uint32_t number;  // in the whole
    };
    using Known = std::vector<Numbered>;  // by their places

    static void take(const Known& known, const std::vector<SideVertex>& side, std::vector<std::uint32_t>& numbers) {
        std::size_t at = 0;
        for (const SideVertex& vertex : side) {
            while (at < known.size() && known[at].vertex.along < vertex.along) ++at;
            if (at < known.size() && known[at].vertex.is_same(vertex)) numbers[vertex.vertex] = known[at].number;
        }
    }
    static void give(const std::vector<SideVertex>& side, const std::vector<std::uint32_t>& numbers, Known& known) {
        known.clear();
        for (const SideVertex& vertex : side) known.push_back({vertex, numbers[vertex.vertex]});
    }

    const TilePlan& plan_;
    Known east_;                // of the tile before this one
    std::vector<Known> south_;  // of the row before this one
};

std::string in_words(std::size_t vertices, std::size_t faces) {
    return std::to_string(vertices) + " vertices, " + std::to_string(faces) + " triangles";
}

// A tile's file in a folder of tiles, by its ending.
std::string bytes_of_tile(const TilePlan& plan, const TileTask& tile, const std::string& ending,
                          std::vector<unsigned char>& bytes) {
    TileFacts facts;
    if (ending == ".hmc") {
        if (std::string why = find_tile(plan, tile, facts); !why.empty()) return why;
        return job::read_made(plan.folder, facts.file, bytes);
    }
    hmesh::Mesh mesh;
    if (std::string why = read_tile(plan, tile, facts, mesh); !why.empty()) return why;
    place(plan, tile, mesh);
    const hmesh::Status status = write_mesh(mesh.view(), ending, {}, bytes);
    return status ? "" : "cannot make " + file_of(plan, tile) + ending + ": " + tool::in_words(status);
}

}  // namespace

std::string join_into_file(const TilePlan& plan, const std::string& output, std::string& said) {
    Joiner joiner(plan);
    for (int y = 0; y < plan.level(0).down(); ++y)
        for (int x = 0; x < plan.level(0).across(); ++x) {
            if (interrupted) return "interrupted; nothing is written";
            if (std::string why = joiner.add({TileTaskKind::tile, 0, x, y}); !why.empty()) return why;
        }
    const hmesh::Mesh& whole = joiner.whole;
    said = in_words(whole.vertex_count(), whole.face_count());
    FormatOptions format;
    format.compact.colors = compact_colors(plan.bits);
    return write_file(output, [&](OutputFile& file) {
        const hmesh::Status status = write_mesh(whole.view(), format_ending(output), format, file);
        return status || !file.error().empty() ? std::string() : tool::in_words(status);
    });
}

std::string join_into_folder(const TilePlan& plan, const std::string& output, const std::string& ending, std::string& said) {
    Json facts;
    const job::Done receipt = job::find_done(plan.folder, plan.identity, "index", job::Look::sizes, facts);
    if (!receipt.why.empty()) return receipt.why;
    std::vector<unsigned char> bytes;
    if (std::string why = job::read_made(plan.folder, receipt.made.front(), bytes); !why.empty()) return why;
    Json index = Json::parse(bytes.begin(), bytes.end());
    const job::Folder to(output);
    std::size_t number = 0;
    for (int level = 0; level < static_cast<int>(plan.levels.size()); ++level)
        for (int y = 0; y < plan.level(level).down(); ++y)
            for (int x = 0; x < plan.level(level).across(); ++x) {
                if (interrupted) return "interrupted; '" + output + "' has no index yet";
                const TileTask tile{TileTaskKind::tile, level, x, y};
                if (std::string why = bytes_of_tile(plan, tile, ending, bytes); !why.empty()) return why;
                job::Made made;
                if (std::string why = job::write_made(to, file_of(plan, tile) + ending, bytes.data(), bytes.size(), made);
                    !why.empty())
                    return why;
                Json& entry = index["tiles"][number++];
                entry["file"] = made.name;
                entry["bytes"] = made.bytes;
                entry["sha256"] = made.sha256;
            }
    said = job::count_of(number, "tile");
    const std::string text = index.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    return to.write("index.json", text);
}

}  // namespace tool
