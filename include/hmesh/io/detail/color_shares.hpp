// hmesh - colours on their way out: what exporters do alike with a vertex's stored values.
//
// Files hold shares of full intensity. Optimal colours may lie outside [0, peak]; formats with integers, and those that
// ask for [0, 1], get them held to that range. O(1) each.
#ifndef HMESH_IO_DETAIL_COLOR_SHARES_HPP
#define HMESH_IO_DETAIL_COLOR_SHARES_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

// Whether a mesh is one of grey, RGB or RGBA that fills a picture. O(n).
[[nodiscard]] inline Status check_for_export(const MeshView& mesh) noexcept {
    if (mesh.channels == 2) return {Errc::invalid_argument, "this format holds 1, 3 or 4 channels", 2, 0};
    if (mesh.width < 1) return {Errc::invalid_argument, "the mesh's width must be at least 1", mesh.width, 1};
    if (mesh.height < 1) return {Errc::invalid_argument, "the mesh's height must be at least 1", mesh.height, 1};
    return check(mesh, 4);
}

// A stored value as a share of the peak, held to [0, 1].
[[nodiscard]] inline double share_of_peak(float value, double peak) noexcept {
    return std::max(0.0, std::min(1.0, static_cast<double>(value) / peak));
}

// A share in [0, 1] as an integer, rounded: 255 or 65535 is all of it.
[[nodiscard]] inline std::uint8_t to_u8(double share) noexcept { return static_cast<std::uint8_t>(share * 255 + 0.5); }
[[nodiscard]] inline std::uint16_t to_u16(double share) noexcept { return static_cast<std::uint16_t>(share * 65535 + 0.5); }

// Red, green, blue and alpha of a vertex as shares: grey is all three, and what has no alpha is opaque.
[[nodiscard]] inline std::array<double, 4> rgba_shares(const MeshView& mesh, std::size_t vertex) noexcept {
    const float* color = mesh.colors + static_cast<std::size_t>(mesh.channels) * vertex;
    const auto share = [&](int k) { return share_of_peak(color[k], mesh.peak); };
    if (mesh.channels < 3) return {share(0), share(0), share(0), 1.0};
    return {share(0), share(1), share(2), mesh.channels == 4 ? share(3) : 1.0};
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_COLOR_SHARES_HPP
