// hmesh-terrain - the vertices of a tile's sides, by which neighbours meet.
#ifndef HMESH_TERRAIN_JOB_SIDES_HPP
#define HMESH_TERRAIN_JOB_SIDES_HPP

#include <array>
#include <cstdint>
#include <vector>

#include "terrain/job/plan.hpp"
#include "terrain/written/surface.hpp"

namespace terrain {

enum class Side : std::uint8_t { west, east, north, south };

// A vertex as both tiles of a seam have it: its place along the seam, its height and its normal, as they stand in the files.
struct SideVertex {
    std::array<double, 5> key{};
    std::uint32_t vertex = 0;

    friend bool operator<(const SideVertex& a, const SideVertex& b) noexcept { return a.key < b.key; }
};

// The vertices of the file of a tile in its outermost row or column of samples, sorted.
[[nodiscard]] std::vector<SideVertex> vertices_of(const Plan& plan, const TaskName& task, const Model& model, Side side);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_SIDES_HPP
