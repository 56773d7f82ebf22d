/// \file
/// The ellipsoid WGS 84: places on it in Earth-centred, Earth-fixed coordinates (ECEF), their axes, and what hides behind it.
///
/// ECEF: metres from the centre of the Earth, x towards longitude 0 on the equator, y towards 90 degrees east, z to the north
/// pole.
/// Sources: NIMA TR8350.2, World Geodetic System 1984; K. Ring, Computing the horizon occlusion point, cesium.com/blog, 2013.
#ifndef HMESH_IO_HEIGHTS_DETAIL_WGS84_HPP
#define HMESH_IO_HEIGHTS_DETAIL_WGS84_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hmesh/io/heights/detail/relief.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

inline constexpr double equatorial_radius = 6378137;                                       ///< m
inline constexpr double flattening = 1 / 298.257223563;                                    ///< of the ellipsoid
inline constexpr double polar_radius = equatorial_radius * (1 - flattening);               ///< m
inline constexpr double eccentricity_squared = flattening * (2 - flattening);              ///< of a meridian
inline constexpr double radians_per_degree = 3.14159265358979323846264338327950288 / 180;  ///< rad

/// A longitude and a latitude with all that follows from them.
struct GeodeticPlace {
    Vector3 east{}, north{}, up{};  ///< unit vectors in ECEF
    double across = 0,              ///< m: radius of the ellipsoid's curvature from east to west
        along = 0;                  ///< m: from north to south
    double cos_latitude = 0;        ///< 0 at the poles

    /// Of degrees.
    GeodeticPlace(double longitude, double latitude) noexcept {
        // Else a pole is a place for each longitude, and faces between two of these have an area.
        const double c = std::abs(latitude) < 90 ? std::cos(latitude * radians_per_degree) : 0;
        const double s = std::sin(latitude * radians_per_degree), cl = std::cos(longitude * radians_per_degree),
                     sl = std::sin(longitude * radians_per_degree);
        east = {-sl, cl, 0};
        north = {-s * cl, -s * sl, c};
        up = {c * cl, c * sl, s};
        const double squash = 1 - eccentricity_squared * s * s;
        across = equatorial_radius / std::sqrt(squash);
        along = across * (1 - eccentricity_squared) / squash;
        cos_latitude = c;
    }

    /// Where a point `height` m above the ellipsoid is, in ECEF.
    [[nodiscard]] Vector3 at(double height) const noexcept {
        return {(across + height) * up[0], (across + height) * up[1], (across * (1 - eccentricity_squared) + height) * up[2]};
    }
    /// A vector of this place's east, north and up in ECEF.
    [[nodiscard]] Vector3 to_ecef(const Vector3& local) const noexcept {
        Vector3 sum{};
        for (std::size_t k = 0; k < 3; ++k) sum[k] = local[0] * east[k] + local[1] * north[k] + local[2] * up[k];
        return sum;
    }
};

/// A point of ECEF in the frame in which the ellipsoid is the unit sphere.
[[nodiscard]] inline Vector3 scaled_to_sphere(const Vector3& point) noexcept {
    return {point[0] / equatorial_radius, point[1] / equatorial_radius, point[2] / polar_radius};
}

/// The horizon occlusion point of some points: the nearest one along a direction that is hidden behind the ellipsoid only where
/// all of them are. In the frame of the unit sphere.
class OcclusionPoint {
  public:
    /// In the direction from the centre of the Earth to a point, that of what is to be hidden, in ECEF.
    explicit OcclusionPoint(const Vector3& towards) noexcept : direction_(unit(scaled_to_sphere(towards), {0, 0, 1})) {}

    /// Takes a point in ECEF in. Below the ellipsoid it counts as a point on it.
    void add(const Vector3& point) noexcept {
        const Vector3 scaled = scaled_to_sphere(point), from_center = unit(scaled, direction_);
        const double distance = std::max(1.0, length(scaled));
        // From the direction to the point it is alpha; beta more and the tangent from the point touches the sphere. Where that
        // tangent meets the direction is what hides with the point.
        const double cos_alpha = dot(from_center, direction_), sin_alpha = length(cross(from_center, direction_)),
                     cos_beta = 1 / distance, sin_beta = std::sqrt(std::max(0.0, distance * distance - 1)) * cos_beta;
        const double cosine = cos_alpha * cos_beta - sin_alpha * sin_beta;
        // A tangent that leads away from the direction does not meet it: the point is more than a quarter of the globe away.
        farthest_ = std::max(farthest_, cosine * most > 1 ? 1 / cosine : most);
    }
    /// Whether there is one: all points are less than a quarter of the globe from the direction, mountains by so much less as
    /// they are seen from afar.
    [[nodiscard]] bool is_there() const noexcept { return farthest_ < most; }
    /// The occlusion point of all points taken in, at least one. Where there is none, a point farther than any eye.
    [[nodiscard]] Vector3 point() const noexcept {
        return {direction_[0] * farthest_, direction_[1] * farthest_, direction_[2] * farthest_};
    }

  private:
    static constexpr double most = 1e6;  // radii of the Earth

    Vector3 direction_;
    double farthest_ = 1;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_DETAIL_WGS84_HPP
