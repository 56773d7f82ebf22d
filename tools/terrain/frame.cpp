#include "terrain/frame.hpp"

#include <cmath>

namespace terrain {
namespace {

constexpr double pi = 3.14159265358979323846;

// Metres in a degree of longitude and of latitude at this latitude: by the radii of curvature of the ellipsoid along the
// parallel and the meridian.
std::array<double, 2> metres_of_degrees(const Georeference& place, double latitude) {
    const double flattening = place.inverse_flattening > 0 ? 1 / place.inverse_flattening : 0;
    const double square = flattening * (2 - flattening);  // of the eccentricity
    const double sine = std::sin(latitude * pi / 180), cosine = std::cos(latitude * pi / 180);
    const double part = 1 - square * sine * sine;
    const double across = place.semi_major / std::sqrt(part), along = across * (1 - square) / part;
    return {across * cosine * pi / 180, along * pi / 180};
}

}  // namespace

std::string find_frame(const Arguments& arguments, const Dem& dem, Frame& frame) {
    const Georeference& place = dem.place;
    const auto& t = place.transform;
    const double columns = dem.width - 1, rows = dem.height - 1;
    frame = {};
    frame.origin = {t[0], t[3] + t[5] * rows};
    const double middle = t[3] + t[5] * rows / 2;
    if (place.is_geographic) {
        const bool has_metres = !arguments.spacing && arguments.format != Format::quantized_mesh;  // of degrees
        if (has_metres && std::fabs(middle) > 89.99)
            return "'" + arguments.input + "' lies around a pole: reproject it with gdalwarp";
        if (has_metres) frame.metres = metres_of_degrees(place, middle);
        frame.extent = Extent{t[0], t[3] + t[5] * rows, t[0] + t[1] * columns, t[3]};
    } else {
        frame.metres = {place.unit, place.unit};
    }
    if (arguments.extent) frame.extent = arguments.extent;
    if (arguments.spacing) frame.metres = {*arguments.spacing / t[1], *arguments.spacing / -t[5]};
    frame.x_step = arguments.scale * t[1] * frame.metres[0];
    frame.y_step = arguments.scale * -t[5] * frame.metres[1];
    if (!(frame.x_step > 0) || !(frame.y_step > 0) || !std::isfinite(frame.x_step * columns) ||
        !std::isfinite(frame.y_step * rows))
        return "'" + arguments.input + "' has samples that are no metres apart, or too many";
    frame.y_origin = frame.y_step * rows;
    frame.z_scale = arguments.z_scale * (arguments.format == Format::quantized_mesh ? 1 : arguments.scale);
    if (!(frame.z_scale > 0)) return "--scale and --z-scale make 0 of all heights";
    frame.z_offset = arguments.offset * frame.z_scale;
    if (arguments.format == Format::quantized_mesh && !frame.extent)
        return "'" + arguments.input + "' does not say its degrees: --extent does, or gdalwarp -t_srs EPSG:4326 makes it";
    return {};
}

Extent extent_of(const Frame& frame, int width, int height, const Tile& tile) {
    const Extent& all = *frame.extent;
    // Whole where they are whole: neighbours get the same degrees, as these follow from the sample alone.
    const auto between = [](double a, double b, int k, int n) { return k == 0 ? a : k == n ? b : a + (b - a) * k / n; };
    const int columns = width - 1, rows = height - 1;
    return {between(all[0], all[2], tile.column, columns), between(all[3], all[1], tile.row + tile.height - 1, rows),
            between(all[0], all[2], tile.column + tile.width - 1, columns), between(all[3], all[1], tile.row, rows)};
}

}  // namespace terrain
