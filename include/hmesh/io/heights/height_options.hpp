/// \file
/// HeightOptions: how the plane and the heights of a mesh become a model in space.
///
/// The map: x points east, y north and z up, in units of the caller's, metres as a rule. A vertex (x, y) of the mesh, y down,
/// is at
///
///     ( x_origin + x_step (first_column + x),  y_origin - y_step (first_row + y),  z.offset + z.scale value )
///
/// so that (0, 0) of a map's plane, its north-western corner, is at the origin, and the map lies south and east of it. Tiles of a
/// map that differ by first_column and first_row alone get common vertices bit for bit.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_OPTIONS_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_OPTIONS_HPP

#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Which channel of a mesh is height, and in which units: offset + scale * value.
struct HeightChannel {
    int channel = 0;    ///< 0 to the mesh's channels - 1; the other channels are not written
    double scale = 1;   ///< units for one of the stored values; a number that a float holds
    double offset = 0;  ///< units where the stored value is 0; a number that a float holds
};

/// Which way is up in the file.
enum class UpAxis : std::uint8_t {
    usual,  ///< z in PLY, OBJ and STL, y in glTF
    z,      ///< (east, north, up)
    y,      ///< (east, up, south), which is no mirror image either
};

/// Where the image lies that is draped over the terrain: the texture coordinates.
enum class Drape : std::uint8_t {
    none,  ///< there are no texture coordinates
    /// The image has the extent of the raster, whose samples are squares of one step: of as many pixels as there are samples,
    /// pixel (i, j) lies on sample (i, j), and its sides half a step outside of a mesh of Samples::points: u = (x + 1/2) / W.
    /// As maps of the same bounds and another resolution do, and all that is computed from the heightmap itself.
    raster,
    /// The image ends where the mesh does: u = x / (W - 1) with Samples::points. With Samples::squares this is the same as
    /// raster.
    mesh,
};

/// Options of all exporters of heights. Steps and origins are numbers that a float holds, steps no denormal ones.
struct HeightOptions {
    HeightChannel z{};              ///< the heights
    double x_step = 1,              ///< units from one sample to the next one east, > 0
        y_step = 1;                 ///< units from one sample to the next one south, > 0
    double x_origin = 0,            ///< units: x of (0, 0) of the map's plane
        y_origin = 0;               ///< units: y of (0, 0) of the map's plane
    std::int32_t first_column = 0,  ///< samples from the map's plane to that of the mesh, a tile of it, to the east
        first_row = 0;              ///< samples, to the south
    UpAxis up = UpAxis::usual;      ///< which way is up
    bool has_normals = true;        ///< a smooth normal for each vertex
    Drape drape = Drape::raster;    ///< the texture coordinates
    /// The name of the image that is draped over the terrain, a path as seen from the file: in glTF, where it is a URI, and
    /// PLY. In OBJ that of the material file, which write_material() writes. nullptr: none is named, as those three want
    /// it with Drape::none.
    const char* texture = nullptr;
    /// Units, at least 0: how deep walls hang from the four sides of the mesh, in glTF alone; 0: there are none. They hide cracks
    /// between tiles of different levels of detail.
    double skirt = 0;
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_OPTIONS_HPP
