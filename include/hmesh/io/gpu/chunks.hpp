/// \file
/// Chunks: the faces of a mesh in parts of so few vertices that 16 bits number them, which share the vertices between them.
///
/// A chunk is a slab across the mesh's longer side, and what it draws lies in a window of consecutive vertices: those that it
/// shares with the chunk before, its own, and those that it shares with the next. So windows overlap, no vertex is stored twice,
/// and there is no crack between chunks whatever the vertices are rounded to. Only a face so long that it reaches over a whole
/// slab brings a copy of a vertex, equal to the bit. Cost: O(n), some 40 ns a face.
/// Within its own, the vertices are in the order in which they are drawn first, so that each is read from memory once.
#ifndef HMESH_IO_GPU_CHUNKS_HPP
#define HMESH_IO_GPU_CHUNKS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/gpu/vertex_cache.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Some faces of a mesh and the vertices that they use.
struct Slab {
    std::vector<Triangle> faces;          ///< of indices into `vertices`
    std::vector<std::uint32_t> vertices;  ///< of the mesh, each once
};

namespace detail {

/// The numbers of faces by where their centroids lie along the longer side of the mesh, in 65536 steps; in their order within a
/// step. A sort by counting.
[[nodiscard]] inline std::vector<std::uint32_t> order_along(const MeshView& mesh, const std::vector<Triangle>& faces) {
    std::array<double, 2> low{}, extent{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        float least = mesh.positions[axis], most = least;
        for (std::size_t v = 1; v < mesh.vertex_count; ++v) {
            least = std::min(least, mesh.positions[2 * v + axis]);
            most = std::max(most, mesh.positions[2 * v + axis]);
        }
        low[axis] = static_cast<double>(least);
        extent[axis] = static_cast<double>(most) - low[axis];
    }
    const std::size_t axis = extent[0] >= extent[1] ? 0 : 1;
    constexpr std::size_t steps = 65536;
    const double per_px = extent[axis] > 0 ? (steps - 1) / (3 * extent[axis]) : 0;
    std::vector<std::uint16_t> step(faces.size());
    std::vector<std::size_t> start(steps + 1, 0);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        double sum = 0;
        for (const std::uint32_t v : faces[f]) sum += static_cast<double>(mesh.positions[2 * std::size_t{v} + axis]) - low[axis];
        step[f] = static_cast<std::uint16_t>(std::min(steps - 1.0, sum * per_px));
        ++start[step[f] + std::size_t{1}];
    }
    for (std::size_t i = 0; i < steps; ++i) start[i + 1] += start[i];
    std::vector<std::uint32_t> order(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) order[start[step[f]]++] = static_cast<std::uint32_t>(f);
    return order;
}

/// The part of each face, where they are cut in this order into parts of at most `most` vertices each.
[[nodiscard]] inline std::vector<std::uint32_t> parts_of(const std::vector<Triangle>& faces,
                                                         const std::vector<std::uint32_t>& order, std::size_t vertices,
                                                         std::size_t most) {
    std::vector<std::uint32_t> part_of(faces.size(), 0), last_user(vertices, no_index);
    std::uint32_t part = 0;
    std::size_t used = 0;
    for (const std::uint32_t f : order) {
        std::size_t fresh = 0;
        for (const std::uint32_t v : faces[f]) fresh += last_user[v] != part ? 1U : 0U;
        if (used + fresh > most) {
            ++part;
            used = 0;
            fresh = 3;
        }
        used += fresh;
        for (const std::uint32_t v : faces[f]) last_user[v] = part;
        part_of[f] = part;
    }
    return part_of;
}

/// Faces in the parts that they are said to be of, 0 at least, in their order within each.
[[nodiscard]] inline std::vector<Slab> distribute(const std::vector<Triangle>& faces, const std::vector<std::uint32_t>& part_of,
                                                  std::size_t vertices) {
    std::vector<std::size_t> sizes;
    for (const std::uint32_t part : part_of) {
        if (part >= sizes.size()) sizes.resize(part + std::size_t{1}, 0);
        ++sizes[part];
    }
    std::vector<Slab> slabs(sizes.size());
    for (std::size_t i = 0; i < slabs.size(); ++i) slabs[i].faces.reserve(sizes[i]);
    for (std::size_t f = 0; f < faces.size(); ++f) slabs[part_of[f]].faces.push_back(faces[f]);
    std::vector<std::uint32_t> place(vertices, no_index);
    for (Slab& slab : slabs) {
        for (Triangle& face : slab.faces)
            for (std::uint32_t& v : face) {
                if (place[v] == no_index) {
                    place[v] = static_cast<std::uint32_t>(slab.vertices.size());
                    slab.vertices.push_back(v);
                }
                v = place[v];
            }
        for (const std::uint32_t v : slab.vertices) place[v] = no_index;
    }
    return slabs;
}

}  // namespace detail

/// Cuts faces of a mesh, at least one, each of three different corners, into slabs of at most `most` >= 3 vertices: one if they
/// have no more; else by where they lie along the longer side. Within a slab they keep their order, which in meshes of this
/// library is one in which neighbours are close in memory. Of the mesh, only positions are read.
[[nodiscard]] inline std::vector<Slab> cut_into_slabs(const MeshView& mesh, const std::vector<Triangle>& faces,
                                                      std::size_t most) {
    std::vector<std::uint8_t> is_used(mesh.vertex_count, 0);
    for (const Triangle& face : faces)
        for (const std::uint32_t v : face) is_used[v] = 1;
    const auto used = static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), std::uint8_t{1}));
    std::vector<std::uint32_t> part_of(faces.size(), 0);
    if (used > most) part_of = detail::parts_of(faces, detail::order_along(mesh, faces), mesh.vertex_count, most);
    return detail::distribute(faces, part_of, mesh.vertex_count);
}

/// Which vertices of a mesh go into a buffer, in which order, and where the windows of its chunks lie.
class ChunkWindows {
  public:
    /// For a mesh of this number of vertices.
    explicit ChunkWindows(std::size_t vertices) : slots_(vertices, none), next_user_(vertices, 0) {}

    /// Adds a chunk: makes the vertices of the mesh that are drawn, in this order, ones of its window. `next` has all those of
    /// the chunk after it, or none. no_index stays.
    void add(std::vector<std::uint32_t>& indices, const std::vector<std::uint32_t>& next) {
        ++chunk_;
        for (const std::uint32_t v : next) next_user_[v] = chunk_;
        first_ = shared_;
        std::vector<std::uint32_t> last;  // shared with the next chunk, and new
        for (const std::uint32_t v : indices) {
            if (v == no_index || is_in_window(v)) continue;
            if (next_user_[v] == chunk_) {
                slots_[v] = waiting;
                last.push_back(v);
            } else {
                place(v);
            }
        }
        shared_ = sources_.size();
        for (const std::uint32_t v : last) place(v);
        for (std::uint32_t& v : indices)
            if (v != no_index) v = slots_[v] - static_cast<std::uint32_t>(first_);
    }

    /// The first vertex of the last chunk's window, which ends with the buffer.
    [[nodiscard]] std::size_t first() const noexcept { return first_; }
    /// The vertex of the mesh that each one of the buffer is.
    [[nodiscard]] const std::vector<std::uint32_t>& sources() const noexcept { return sources_; }

  private:
    static constexpr std::uint32_t none = no_index, waiting = none - 1;

    [[nodiscard]] bool is_in_window(std::uint32_t v) const noexcept { return slots_[v] != none && slots_[v] >= first_; }
    void place(std::uint32_t v) {
        slots_[v] = static_cast<std::uint32_t>(sources_.size());
        sources_.push_back(v);
    }

    std::vector<std::uint32_t> slots_;      // where the last copy of a vertex is
    std::vector<std::uint32_t> next_user_;  // the last chunk, counted from 1, whose successor uses a vertex
    std::vector<std::uint32_t> sources_;
    std::size_t first_ = 0, shared_ = 0;
    std::uint32_t chunk_ = 0;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GPU_CHUNKS_HPP
