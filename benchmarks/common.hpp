// benchmarks - what the tables share: images, names, clocks, and a hash by which meshes are told apart.
#ifndef HMESH_BENCHMARKS_COMMON_HPP
#define HMESH_BENCHMARKS_COMMON_HPP

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/hmesh.hpp>

#include "readers/image_file.hpp"
#include "writers/picture_file.hpp"

namespace bench {

// Of all threads together, as POSIX says.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
// What one waits.
inline double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// --- FNV-1a, 64 bits: http://www.isthe.com/chongo/tech/comp/fnv/ ---
inline constexpr std::uint64_t empty_hash = 0xcbf29ce484222325U;

template <class Value>
void add_to_hash(const std::vector<Value>& values, std::uint64_t& hash) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(Value); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3U;
}

inline std::uint64_t hash_of(const hmesh::Mesh& mesh, std::uint64_t hash = empty_hash) {
    add_to_hash(mesh.positions, hash);
    add_to_hash(mesh.colors, hash);
    add_to_hash(mesh.faces, hash);
    return hash;
}

// --- the command line ---
inline std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> parts;
    std::size_t start = 0;
    for (std::size_t comma = 0; (comma = list.find(',', start)) != std::string::npos; start = comma + 1)
        parts.push_back(list.substr(start, comma - start));
    parts.push_back(list.substr(start));
    return parts;
}

inline bool effort_of(const std::string& name, hmesh::Effort& effort) {
    const std::pair<const char*, hmesh::Effort> names[] = {{"draft", hmesh::Effort::draft},
                                                           {"fast", hmesh::Effort::fast},
                                                           {"normal", hmesh::Effort::normal},
                                                           {"fine", hmesh::Effort::fine},
                                                           {"best", hmesh::Effort::best}};
    for (const auto& [known, value] : names)
        if (name == known) {
            effort = value;
            return true;
        }
    return false;
}

// --- images ---
using Picture = hmesh::Image<std::uint8_t, 3>;

// Reads 3 channels of 8 bits. Says why not, in the name of `program`.
inline std::optional<Picture> read(const char* program, const std::string& path) {
    tool::ImageFile file;
    const std::string why = tool::read_image(path, file);
    if (!why.empty() || file.channels != 3 || file.bits != 8) {
        std::fprintf(stderr, "%s: %s: %s\n", program, path.c_str(), why.empty() ? "not 3 channels of 8 bits" : why.c_str());
        return {};
    }
    Picture picture(file.width, file.height);
    std::copy(file.samples8.begin(), file.samples8.end(), picture.data());
    return picture;
}

// `tiles` of one size, row by row, over again until the grid is full.
inline Picture mosaic_of(const std::vector<Picture>& tiles, int columns, int rows) {
    const int width = tiles[0].width(), height = tiles[0].height();
    Picture mosaic(columns * width, rows * height);
    for (int y = 0; y < mosaic.height(); ++y)
        for (int column = 0; column < columns; ++column) {
            const auto place = static_cast<std::size_t>(y / height) * static_cast<std::size_t>(columns);
            const Picture& tile = tiles[(place + static_cast<std::size_t>(column)) % tiles.size()];
            std::copy_n(tile.pixel(0, y % height), 3 * width, mosaic.pixel(column * width, y));
        }
    return mosaic;
}

inline std::string file_name(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return path.substr(slash == std::string::npos ? 0 : slash + 1);
}

}  // namespace bench

#endif  // HMESH_BENCHMARKS_COMMON_HPP
