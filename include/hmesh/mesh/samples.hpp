/// \file
/// Samples: where in the plane the samples of an image stand.
#ifndef HMESH_MESH_SAMPLES_HPP
#define HMESH_MESH_SAMPLES_HPP

#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// What a sample of an image of W x H samples is, and with that where the mesh lies.
enum class Samples : std::uint8_t {
    /// A square, as in pictures: that of sample (i, j) has its centre at (i + 1/2, j + 1/2), and the mesh is [0, W] x [0, H].
    squares,
    /// A point, as in heightmaps: sample (i, j) stands at (i, j), and the mesh is [0, W - 1] x [0, H - 1], so that tiles that
    /// share a row of samples share their border. W and H are at least 2.
    points,
};

namespace kit {

/// How far the mesh of an image reaches along an axis with `size` samples, in px: it begins at 0.
[[nodiscard]] constexpr int extent(int size, Samples samples) noexcept { return samples == Samples::points ? size - 1 : size; }

/// How far inside of [0, W] x [0, H] the mesh of an image lies while it is fitted, in px. There the centre of sample (i, j) is
/// at (i + 1/2, j + 1/2) whatever it is, and a mesh of points is [1/2, W - 1/2] x [1/2, H - 1/2]: 1/2 px off where users have it,
/// which is exact on the grid of positions. Mesh has the users' positions; ImageMesh, IndexedMesh and Delaunay have these.
[[nodiscard]] constexpr double inset(Samples samples) noexcept { return samples == Samples::points ? 0.5 : 0; }

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_SAMPLES_HPP
