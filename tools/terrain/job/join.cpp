#include "terrain/job/join.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "hmesh/core/version.hpp"
#include "job/sha256.hpp"
#include "job/work.hpp"
#include "terrain/job/sides.hpp"
#include "terrain/job/tasks.hpp"
#include "writers/output_file.hpp"
#include "writers/write_file.hpp"

namespace terrain {
namespace {

using job::Json;

// A tile with the numbers that its vertices have in the whole.
struct Numbered {
    const Model& model;
    const std::vector<std::uint32_t>& numbers;  // of each vertex
    std::uint32_t first;                        // the least that no tile before it has
    [[nodiscard]] bool is_new(std::size_t v) const { return numbers[v] >= first; }
};

// The tiles one after another, row after row from the north: what stands in the west or in the north has the numbers of the tiles
// there. Each walk gives the same numbers.
class Walk {
  public:
    explicit Walk(const Plan& plan) : plan_(plan) {}

    // visit() returns "" or what is wrong, a sentence, and so does this.
    [[nodiscard]] std::string all(const std::function<std::string(const Numbered& tile)>& visit) {
        const int across = plan_.level(0).across, down = plan_.level(0).down;
        south_.assign(static_cast<std::size_t>(across), {});
        vertices = faces = 0;
        for (int y = 0; y < down; ++y) {
            east_.clear();
            for (int x = 0; x < across; ++x)
                if (std::string why = one({TaskKind::tile, 0, x, y}, visit); !why.empty()) return why;
        }
        return {};
    }

    std::uint64_t vertices = 0, faces = 0;

  private:
    using Known = std::vector<std::pair<std::array<double, 5>, std::uint32_t>>;  // sorted: the number of a vertex of a side

    [[nodiscard]] std::string one(const TaskName& task, const std::function<std::string(const Numbered& tile)>& visit) {
        if (tool::interrupted) return "interrupted; nothing is written";
        TileFacts facts;
        Model model;
        if (std::string why = read_tile(plan_, task, facts, model); !why.empty()) return why;
        constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
        std::vector<std::uint32_t> numbers(model.vertices.size(), none);
        const auto take = [&](Side side, const Known& known) {
            for (const SideVertex& vertex : vertices_of(plan_, task, model, side)) {
                const auto at = std::lower_bound(known.begin(), known.end(), vertex.key,
                                                 [](const auto& entry, const auto& key) { return entry.first < key; });
                if (at != known.end() && at->first == vertex.key && numbers[vertex.vertex] == none)
                    numbers[vertex.vertex] = at->second;
            }
        };
        Known& south = south_[static_cast<std::size_t>(task.x)];
        take(Side::west, east_);
        take(Side::north, south);
        if (vertices + model.vertices.size() >= none)
            return "the whole has more vertices than 32 bits number: join it into a folder";
        const auto first = static_cast<std::uint32_t>(vertices);
        for (std::uint32_t& number : numbers)
            if (number == none) number = static_cast<std::uint32_t>(vertices++);
        faces += model.faces.size();
        const auto give = [&](Side side, Known& known) {
            known.clear();
            for (const SideVertex& vertex : vertices_of(plan_, task, model, side))
                known.emplace_back(vertex.key, numbers[vertex.vertex]);
        };
        give(Side::east, east_);
        give(Side::south, south);
        return visit({model, numbers, first});
    }

    const Plan& plan_;
    Known east_;                // of the tile before this one
    std::vector<Known> south_;  // of the row before this one
};

// Bytes that go to a file as they are made.
class Out {
  public:
    explicit Out(tool::OutputFile& file) : file_(file) { bytes_.reserve(size); }
    void text(const std::string& words) { put(words.data(), words.size()); }
    void u8(unsigned value) {
        const auto byte = static_cast<unsigned char>(value);
        put(&byte, 1);
    }
    void u32(std::uint32_t value) {
        for (unsigned k = 0; k < 4; ++k) u8(value >> (8 * k) & 0xffU);
    }
    void f32(double value) {
        const auto number = static_cast<float>(value);
        std::uint32_t word = 0;
        std::memcpy(&word, &number, 4);
        u32(word);
    }
    // Nine digits say a float, in any locale alike.
    void line(const char* word, std::initializer_list<double> numbers) {
        std::string words = word;
        for (const double number : numbers) {
            char digits[40];
            std::snprintf(digits, sizeof digits, " %.9g", number);
            std::replace(digits, digits + std::strlen(digits), ',', '.');
            words += digits;
        }
        text(words + "\n");
    }
    [[nodiscard]] std::string flush() {
        if (is_whole_) is_whole_ = file_(bytes_.data(), bytes_.size());
        bytes_.clear();
        return is_whole_ ? "" : "the disk refused it";
    }

  private:
    static constexpr std::size_t size = std::size_t{1} << 18U;
    void put(const void* from, std::size_t count) {
        const auto* const first = static_cast<const unsigned char*>(from);
        bytes_.insert(bytes_.end(), first, first + count);
        if (bytes_.size() >= size) static_cast<void>(flush());
    }

    tool::OutputFile& file_;
    std::vector<unsigned char> bytes_;
    bool is_whole_ = true;
};

// What is written of all vertices, or of all faces.
class Joined {
  public:
    Joined(const Plan& plan, Walk& walk, Out& out) : plan_(plan), walk_(walk), out_(out) {}

    using Vertex = std::function<void(const std::array<double, 3>& at, const std::array<double, 3>& normal)>;
    [[nodiscard]] std::string vertices(const Vertex& put) {
        return walk_.all([&](const Numbered& tile) {
            for (std::size_t v = 0; v < tile.model.vertices.size(); ++v)
                if (tile.is_new(v)) put(tile.model.vertices[v], tile.model.normals.empty() ? up : tile.model.normals[v]);
            return out_.flush();
        });
    }
    using Face = std::function<void(std::uint32_t a, std::uint32_t b, std::uint32_t c)>;
    [[nodiscard]] std::string faces(const Face& put) {
        return walk_.all([&](const Numbered& tile) {
            for (const auto& [a, b, c] : tile.model.faces) put(tile.numbers[a], tile.numbers[b], tile.numbers[c]);
            return out_.flush();
        });
    }
    // Where a vertex is in an image whose pixels are the samples, to the right and down.
    [[nodiscard]] std::array<double, 2> place(const std::array<double, 3>& at) const {
        const Frame& frame = plan_.frame;
        return {((at[0] - frame.x_origin) / frame.x_step + 0.5) / plan_.width,
                ((frame.y_origin - at[1]) / frame.y_step + 0.5) / plan_.height};
    }
    [[nodiscard]] bool has_normals() const { return plan_.arguments.has_normals; }

  private:
    static constexpr std::array<double, 3> up = {0, 0, 1};
    const Plan& plan_;
    Walk& walk_;
    Out& out_;
};

std::string write_ply(Joined& joined, Out& out, std::uint64_t vertices, std::uint64_t faces) {
    out.text("ply\nformat binary_little_endian 1.0\ncomment made by hmesh " HMESH_VERSION_STRING "\nelement vertex " +
             std::to_string(vertices) + "\nproperty float x\nproperty float y\nproperty float z\n");
    if (joined.has_normals()) out.text("property float nx\nproperty float ny\nproperty float nz\n");
    out.text("property float s\nproperty float t\nelement face " + std::to_string(faces) +
             "\nproperty list uchar int vertex_indices\nend_header\n");
    if (std::string why = joined.vertices([&](const auto& at, const auto& normal) {
            for (const double number : at) out.f32(number);
            if (joined.has_normals())
                for (const double number : normal) out.f32(number);
            const auto [u, v] = joined.place(at);
            out.f32(u);
            out.f32(1 - v);
        });
        !why.empty())
        return why;
    return joined.faces([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        out.u8(3);
        for (const std::uint32_t corner : {a, b, c}) out.u32(corner);
    });
}

std::string write_obj(Joined& joined, Out& out) {
    out.text("# made by hmesh " HMESH_VERSION_STRING "\n");
    if (std::string why = joined.vertices([&](const auto& at, const auto& normal) {
            out.line("v", {at[0], at[1], at[2]});
            const auto [u, v] = joined.place(at);
            out.line("vt", {u, 1 - v});
            if (joined.has_normals()) out.line("vn", {normal[0], normal[1], normal[2]});
        });
        !why.empty())
        return why;
    return joined.faces([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        std::string line = "f";
        for (const std::uint32_t corner : {a, b, c}) {
            const std::string number = std::to_string(std::uint64_t{corner} + 1);
            line += " " + number + "/" + number + (joined.has_normals() ? "/" + number : "");
        }
        out.text(line + "\n");
    });
}

// glTF 2.0, y up, of one node that is not moved: as the tiles are.
std::string write_glb(Joined& joined, Out& out, std::uint64_t vertices, std::uint64_t faces, const std::array<double, 6>& box) {
    const std::uint64_t bytes = (joined.has_normals() ? 32 : 20) * vertices + 12 * faces;
    Json views = Json::array(), accessors = Json::array();
    std::uint64_t at = 0;
    const auto add = [&](const char* type, int number, std::uint64_t count, std::uint64_t size, int target) {
        accessors.push_back({{"bufferView", views.size()}, {"componentType", number}, {"count", count}, {"type", type}});
        views.push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", count * size}, {"target", target}});
        at += count * size;
        return accessors.size() - 1;
    };
    constexpr int of_floats = 5126, of_u32 = 5125, of_vertices = 34962, of_indices = 34963;
    Json attributes;
    attributes["POSITION"] = add("VEC3", of_floats, vertices, 12, of_vertices);
    accessors[0]["min"] = {box[0], box[2], 0 - box[4]};
    accessors[0]["max"] = {box[3], box[5], 0 - box[1]};
    if (joined.has_normals()) attributes["NORMAL"] = add("VEC3", of_floats, vertices, 12, of_vertices);
    attributes["TEXCOORD_0"] = add("VEC2", of_floats, vertices, 8, of_vertices);
    const std::size_t corners = add("SCALAR", of_u32, 3 * faces, 4, of_indices);
    Json material = {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
    Json json = {{"asset", {{"version", "2.0"}, {"generator", "hmesh " HMESH_VERSION_STRING}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}},
                 {"meshes", {{{"primitives", {{{"attributes", attributes}, {"indices", corners}, {"material", 0}}}}}}},
                 {"materials", {material}},
                 {"accessors", accessors},
                 {"bufferViews", views},
                 {"buffers", {{{"byteLength", bytes}}}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t size = 12 + 8 + text.size() + 8 + bytes;
    if (size > std::numeric_limits<std::uint32_t>::max()) return "a .glb file has less than 4 GiB: take .ply, or a folder";
    out.text("glTF");
    out.u32(2);
    out.u32(static_cast<std::uint32_t>(size));
    out.u32(static_cast<std::uint32_t>(text.size()));
    out.text("JSON" + text);
    out.u32(static_cast<std::uint32_t>(bytes));
    out.text(std::string("BIN\0", 4));
    const auto put = [&](const std::array<double, 3>& a) {
        out.f32(a[0]);
        out.f32(a[2]);
        out.f32(0 - a[1]);
    };
    if (std::string why = joined.vertices([&](const auto& place, const auto& /*normal*/) { put(place); }); !why.empty())
        return why;
    if (joined.has_normals())
        if (std::string why = joined.vertices([&](const auto& /*place*/, const auto& normal) { put(normal); }); !why.empty())
            return why;
    if (std::string why = joined.vertices([&](const auto& place, const auto& /*normal*/) {
            const auto [u, v] = joined.place(place);
            out.f32(u);
            out.f32(v);
        });
        !why.empty())
        return why;
    return joined.faces([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        for (const std::uint32_t corner : {a, b, c}) out.u32(corner);
    });
}

}  // namespace

std::string join_into_file(const Plan& plan, const std::string& output, std::string& said) {
    if (plan.arguments.format == Format::quantized_mesh)
        return "the tiles of '" + plan.folder.path() + "' are quantized, each in its own degrees: join them into a folder";
    const Format format = format_of(output);
    Walk walk(plan);
    std::array<double, 6> box{};
    bool has_vertex = false;
    if (std::string why = walk.all([&](const Numbered& tile) {
            for (const std::array<double, 3>& at : tile.model.vertices) {
                for (std::size_t k = 0; k < 3; ++k) {
                    box[k] = has_vertex ? std::min(box[k], at[k]) : at[k];
                    box[k + 3] = has_vertex ? std::max(box[k + 3], at[k]) : at[k];
                }
                has_vertex = true;
            }
            return std::string();
        });
        !why.empty())
        return why;
    const std::uint64_t vertices = walk.vertices, faces = walk.faces;
    if (faces == 0) return "'" + plan.folder.path() + "' has no tile with data";
    said = std::to_string(vertices) + " vertices, " + std::to_string(faces) + " triangles";
    return tool::write_file(output, [&](tool::OutputFile& file) {
        Out out(file);
        Joined joined(plan, walk, out);
        std::string why = format == Format::ply   ? write_ply(joined, out, vertices, faces)
                          : format == Format::obj ? write_obj(joined, out)
                                                  : write_glb(joined, out, vertices, faces, box);
        return why.empty() ? out.flush() : why;
    });
}

std::string join_into_folder(const Plan& plan, const std::string& output, std::string& said) {
    const job::Folder to(output);
    std::size_t copied = 0, left = 0;
    const auto copy = [&](const job::Made& made) -> std::string {
        job::Made there = made;
        there.name = made.name.substr(std::string("tiles/").size());
        std::vector<unsigned char> bytes;
        std::error_code code;
        if (tool::interrupted) return "interrupted; '" + output + "' has no index yet";
        if (std::filesystem::file_size(to.path(there.name), code) == made.bytes && !code) {
            if (job::read_made(to, there, bytes).empty()) {
                ++left;
                return {};
            }
        }
        if (std::string why = job::read_made(plan.folder, made, bytes); !why.empty()) return why;
        ++copied;
        return to.write(there.name, bytes.data(), bytes.size());
    };
    for (const job::Phase& phase : phases_of(plan))  // the index is the last
        for (const job::Task& task : phase.tasks) {
            Json facts;
            const job::Done done = job::find_done(plan.folder, plan.identity, task.name, job::Look::sizes, facts);
            if (done.found != job::Found::whole) return done.why;
            for (const job::Made& made : done.made)
                if (std::string why = copy(made); !why.empty()) return why;
        }
    said = job::count_of(copied, "file") + " copied";
    if (left > 0) said += ", " + std::to_string(left) + " were there";
    return {};
}

}  // namespace terrain
