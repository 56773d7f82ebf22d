/// \file
/// MeshLimits: bounds on faces, positions and colours while a mesh is fitted.
#ifndef HMESH_MESH_LIMITS_HPP
#define HMESH_MESH_LIMITS_HPP

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Bounds on faces, positions and colours while a mesh is fitted.
struct MeshLimits {
    /// Twice the smallest area of a face, in px^2, in [1e-4, 0.25]. Slivers that hold no pixel cost no energy but are ugly when
    /// enlarged; no bound in this range costs anything measurable (Lena, 1 %).
    double min_double_area = 0.02;
    /// Smallest distance of a free vertex from the image's border, in px, in [1/256, 1/4].
    double border_gap = 1.0 / 32;
    /// How far colours may leave the pixel type's range while fitting, as a share of that range, in [0, 100]. Final colours are
    /// in range. A large value costs up to 0.4 dB, because the geometry relied on colours that are then clamped (kodim03 at
    /// 1.2); 0 makes the fit get stuck a little earlier (0.03 dB, Lena).
    double color_overshoot = 0.02;
    /// Weight of a vertex's current colour in the choice of a new one, in pixels, in [1e-9, 1]. It determines the colours of
    /// corners whose faces hold no pixel.
    double ridge = 1e-3;
    /// Step of the grid to which vertices move, in px: a power of two in [1/256, 16]. 1/256 px is what GPUs tell apart. A
    /// coarser one is for files and buffers that keep fewer bits of a position: the mesh is fitted to what they hold. Down to
    /// 1/16 px that costs a photograph nothing measurable, down to 1/32 px a drawing of panels; rounding afterwards would cost
    /// the latter 1 to 10 dB, since faces turn over. Above 1/4 px, where vertices are but few steps apart, some find no
    /// place and stay off that grid, on the one of 1/256 px.
    double position_step = 1.0 / 256;
};

/// Whether the limits are in their ranges; otherwise invalid_argument with a sentence about the first that is not.
[[nodiscard]] HMESH_COLD inline Status check(const MeshLimits& limits) noexcept {
    const Status ranges =
        kit::check_ranges({{"limits.min_double_area must be in [1e-4, 0.25] px^2", limits.min_double_area, 1e-4, 0.25},
                           {"limits.border_gap must be in [1/256, 1/4] px", limits.border_gap, 1.0 / 256, 0.25},
                           {"limits.color_overshoot must be in [0, 100] ranges", limits.color_overshoot, 0, 100},
                           {"limits.ridge must be in [1e-9, 1] pixels", limits.ridge, 1e-9, 1},
                           {"limits.position_step must be in [1/256, 16] px", limits.position_step, 1.0 / 256, 16}});
    double step = 1.0 / 256;
    while (step < limits.position_step) step *= 2;
    if (ranges && step != limits.position_step)
        return {Errc::invalid_argument, "limits.position_step must be a power of two, in px", limits.position_step, step};
    return ranges;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_LIMITS_HPP
