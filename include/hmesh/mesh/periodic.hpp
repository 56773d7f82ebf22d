/// \file
/// Periodic: along which axes an image repeats, as a texture does that tiles a wall or a panorama that closes around.
#ifndef HMESH_MESH_PERIODIC_HPP
#define HMESH_MESH_PERIODIC_HPP

#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Along which axes an image and its mesh go on from the opposite side: beyond x = width comes x = 0 again.
enum class Periodic : std::uint8_t {
    none = 0,  ///< along none
    x = 1,     ///< from left to right, as a panorama does
    y = 2,     ///< from top to bottom
    xy = 3,    ///< along both, as a texture does
};

namespace kit {

/// Whether the image repeats from left to right.
[[nodiscard]] constexpr bool wraps_x(Periodic periodic) noexcept { return (static_cast<unsigned>(periodic) & 1U) != 0; }
/// Whether the image repeats from top to bottom.
[[nodiscard]] constexpr bool wraps_y(Periodic periodic) noexcept { return (static_cast<unsigned>(periodic) & 2U) != 0; }
/// The longest side, in px, along which an image may repeat: half of what an image may have, since the faces that stand out of it
/// are to have the same exact coordinates.
inline constexpr int max_period = 32768;

/// x modulo n, in [0, n), n > 0.
[[nodiscard]] constexpr int modulo(int x, int n) noexcept {
    const int rest = x % n;
    return rest < 0 ? rest + n : rest;
}

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_PERIODIC_HPP
