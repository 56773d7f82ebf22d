/// \file
/// Covering: polygons with few corners around contours, of nearly the least area.
///
/// Corners are removed one by one, the cheapest first by the area that it adds (remove_corners.hpp). Then sides are turned around
/// what they touch as long as that leaves less area (turn_sides.hpp). All tests are made in whole numbers, so that contours stay
/// inside and sides never meet, however positions were rounded. Cost: removals some 2 us for each corner of the contours, and
/// turning as much again for each time that all sides are looked at.
#ifndef HMESH_OUTLINE_COVERING_HPP
#define HMESH_OUTLINE_COVERING_HPP

#include <cstddef>
#include <vector>

#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/polygons.hpp"
#include "hmesh/outline/remove_corners.hpp"
#include "hmesh/outline/turn_sides.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Polygons that begin as contours and lose corners. The contours are inside at all times, and no two sides meet.
class Covering {
  public:
    /// Of contours_of() an image of this size in px, or polygons like them.
    Covering(const std::vector<Loop>& contours, int width, int height) : polygons_(contours, width, height) {}

    [[nodiscard]] std::size_t corners() const noexcept { return polygons_.corners(); }  ///< of all polygons that are left
    /// The area of the polygons, px^2.
    [[nodiscard]] double area() const noexcept {
        return static_cast<double>(polygons_.double_area()) * (0.5 / (units_per_px * units_per_px));
    }

    /// Removes corners until at most `count` are left, the cheapest first, then turns sides. Whether any could be removed: there
    /// may be more left where none can go.
    bool remove_to(std::size_t count) {
        const std::size_t before = corners();
        remove_corners(polygons_, count);
        turn_sides(polygons_);
        return corners() != before;
    }

    /// The polygons that are left: outer borders and holes.
    [[nodiscard]] std::vector<Loop> loops() const { return polygons_.loops(); }

  private:
    Polygons polygons_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_COVERING_HPP
