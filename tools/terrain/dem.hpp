// hmesh-terrain - Dem: a digital elevation model, heights as points of a grid, and where on the Earth they stand.
//
// Sample (i, j) stands at column i from the west and row j from the north. Whether the file has it as a point or as an area of
// which the height is the mean, its place is the one that `transform` gives: of an area the centre.
#ifndef HMESH_TERRAIN_DEM_HPP
#define HMESH_TERRAIN_DEM_HPP

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace terrain {

struct Georeference {
    bool is_known = false;  // else samples stand one unit apart, and `transform` says so
    // x = t[0] + t[1] i + t[2] j and y = t[3] + t[4] i + t[5] j of sample (i, j), in units of the map, y to the north.
    std::array<double, 6> transform{0, 1, 0, 0, 0, -1};
    std::string crs;                                                  // as WKT; empty: not known
    bool is_geographic = false;                                       // x and y are degrees of longitude and latitude
    double unit = 1;                                                  // metres in a unit of the map, where these are not degrees
    double semi_major = 6378137, inverse_flattening = 298.257223563;  // of the ellipsoid, in metres: that of WGS 84

    // Makes degrees of angles of so many radians, which are degrees already where ten digits say so.
    void make_degrees(double radians) noexcept {
        const double degrees = radians * 180 / 3.14159265358979323846;
        if (degrees > 0 && !(degrees > 1 - 1e-8 && degrees < 1 + 1e-8))
            for (double& number : transform) number *= degrees;
    }
};

class Dem {
  public:
    Dem() = default;
    Dem(const Dem&) = delete;
    Dem& operator=(const Dem&) = delete;
    virtual ~Dem() = default;

    int width = 0, height = 0;  // samples
    Georeference place;
    std::optional<double> no_data;               // the height that stands for none; NaN always does
    bool has_mask = false;                       // something else than that says which samples have data
    double height_scale = 1, height_offset = 0;  // heights are so many times the numbers of the file, and so much more
    std::string reader;                          // "GDAL 3.6.2, GTiff", "hmesh"

    // Reads the samples [x, x + columns) x [y, y + rows) into `heights`, row after row, NaN where there is no data. `rounding`
    // becomes the most by which one differs from what the file says: files of more bits than a float has are rounded. Returns ""
    // or what is wrong, as the end of a sentence that begins with the file's name. From one thread at a time.
    [[nodiscard]] virtual std::string read(int x, int y, int columns, int rows, float* heights, double& rounding) = 0;
};

}  // namespace terrain

#endif  // HMESH_TERRAIN_DEM_HPP
