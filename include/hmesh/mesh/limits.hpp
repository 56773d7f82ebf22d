/// \file
/// MeshLimits: bounds that keep a mesh sane while it is fitted.
#ifndef HMESH_MESH_LIMITS_HPP
#define HMESH_MESH_LIMITS_HPP

#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Bounds that keep a mesh sane.
struct MeshLimits {
    /// Least twice the area of a face, in px^2. Slivers that hold no pixel are free for the energy but ugly when enlarged;
    /// 0.02 costs nothing measurable, 1 costs 0.03 dB (Lena, 1 %).
    double min_double_area = 0.02;
    /// A free vertex keeps this distance from the image's border, in px.
    double border_gap = 1.0 / 32;
    /// Colours may leave the pixel type's range while optimising, but not by more than this many ranges. The final colours
    /// are in range: geometry that counted on others loses up to 0.4 dB then (kodim03 at 1.2), geometry that never may
    /// leave it gets stuck a little earlier (Lena: 0.03 dB at 0).
    double color_overshoot = 0.02;
    /// Faces without a pixel leave the colour of their corners undetermined: a pull toward the current colour, in pixels.
    double ridge = 1e-3;
};

/// Whether the limits mean something; the sentence names the first that does not.
[[nodiscard]] inline Status check(const MeshLimits& limits) noexcept {
    return kit::check_ranges({{"limits.min_double_area must be in [1e-4, 0.25] px^2", limits.min_double_area, 1e-4, 0.25},
                              {"limits.border_gap must be in [1/256, 1/4] px", limits.border_gap, 1.0 / 256, 0.25},
                              {"limits.color_overshoot must be in [0, 100] ranges", limits.color_overshoot, 0, 100},
                              {"limits.ridge must be in [1e-9, 1] pixels", limits.ridge, 1e-9, 1}});
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_LIMITS_HPP
