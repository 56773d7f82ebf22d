/// \file
/// Bounded: the recipe for a mesh that differs from no sample by more than a bound, with as few triangles as its effort finds.
///
/// What it does is told in docs/terrain.md; mesh_image() with it is declared by methods/bounded/bounded.hpp.
#ifndef HMESH_METHODS_BOUNDED_OPTIONS_HPP
#define HMESH_METHODS_BOUNDED_OPTIONS_HPP

#include <cstdint>
#include <limits>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// A mesh within a bound: |mesh - sample| <= max_error at every sample, in each channel.
struct Bounded {
    /// How much work is spent on having few triangles. Shares of triangles are of draft's, times those of one core, a sample,
    /// for elevation data and bounds of 10 to 1 % of their range.
    enum class Effort : std::uint8_t {
        draft,   ///< greedy insertion: vertices are samples, the worst sample first; 0.1 to 0.9 us
        fast,    ///< then vertices are removed while the bound holds; 0.45 to 0.57 of the triangles, 0.1 to 6 us
        normal,  ///< then heights are free: 0.28 to 0.41 of the triangles, 1 to 15 us
        best,    ///< then positions are free too: 0.21 to 0.27 of the triangles, 5 to 32 us
    };
    /// The largest difference allowed between mesh and samples, in stored values, finite and >= 0. 0: none at all.
    double max_error = 0;
    Effort effort = Effort::normal;  ///< how much work is spent
    /// Whether the vertices on the sides of the image are chosen by what is inside, too. By default they follow from the row of
    /// samples along the side, the bound and the effort alone: meshes of two tiles that share this row have the same border
    /// vertices and heights, to the last bit. Free borders take 1 % fewer triangles at 10,000, 10 % at 500.
    bool free_borders = false;
    /// The largest difference allowed along the sides of the image, in stored values, >= 0, where that is to be less than
    /// max_error; nothing with free_borders. Tiles of different max_error meet if this is the same for them, and at most the
    /// smallest of these.
    double border_error = std::numeric_limits<double>::max();
    /// The largest difference allowed at samples that are not along the sides of the image, in stored values, >= 0, where that
    /// is to be less than max_error; with free_borders at all samples. Borders stay what they are without it. 0: the inside is
    /// made by insertion alone, whatever the effort: where samples lie in planes removal leaves slivers, which bear no rounding.
    double inside_error = std::numeric_limits<double>::max();
};

/// Whether the options are in their ranges; otherwise invalid_argument with a sentence about the first that is not.
[[nodiscard]] inline Status check(const Bounded& recipe) noexcept {
    if (!kit::is_finite(recipe.max_error) || recipe.max_error < 0)
        return {Errc::invalid_argument, "max_error must be finite and at least 0, in stored values", recipe.max_error};
    if (kit::is_nan(recipe.border_error) || kit::nearest_finite(recipe.border_error) < 0)
        return {Errc::invalid_argument, "border_error must be at least 0, in stored values", recipe.border_error};
    if (kit::is_nan(recipe.inside_error) || kit::nearest_finite(recipe.inside_error) < 0)
        return {Errc::invalid_argument, "inside_error must be at least 0, in stored values", recipe.inside_error};
    if (recipe.effort > Bounded::Effort::best)
        return {Errc::invalid_argument, "the effort is none of those known", static_cast<int>(recipe.effort), 3};
    return {};
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_OPTIONS_HPP
