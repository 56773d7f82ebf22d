/// \file
/// write_quantized_mesh(): a mesh of heights as a tile of the globe, quantized-mesh 1.0, for Cesium and others.
///
/// The mesh's sides are the tile's: longitude and latitude are linear in its plane, and heights are metres above the ellipsoid
/// WGS 84. Positions and heights have 15 bits each. Between 256 steps a position is off by 1/256 of a step at most, a height by
/// a 65534th of the tile's range: rounded_to_tile() gives the mesh as a reader has it, to prove a bound on. Vertices come in
/// the order in which faces name them first, and those that none names are left out. The vertices of a side, and no others,
/// have the coordinate 0 or 32767, and are listed from west to east and from south to north. The bounding sphere is that around
/// the box of the vertices, seen from the middle of the tile. The horizon occlusion point of a tile that is half the globe, as
/// the two at the root are, leaves out the mountains on its rim. Servers send tiles compressed by gzip, which is left to the
/// program.
///
/// Bytes: 112, 6 a vertex, 6 a face and 2 for each vertex of a side; 12 and 4 from 65,536 vertices on; 5 and 2 a vertex more with
/// normals. O(n), 8 bytes a vertex, and 24 more for normals without samples.
/// Source: quantized-mesh-1.0, github.com/CesiumGS/quantized-mesh; Z. H. Cigolle et al., A Survey of Efficient Representations
/// for Independent Unit Vectors, JCGT 3(2), 2014.
#ifndef HMESH_IO_HEIGHTS_QUANTIZED_MESH_HPP
#define HMESH_IO_HEIGHTS_QUANTIZED_MESH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/heights/detail/relief.hpp"
#include "hmesh/io/heights/detail/wgs84.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/heights/height_samples.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_quantized_mesh().
struct QuantizedMeshOptions {
    double west = 0,    ///< degrees of longitude of the mesh's left side, -180 to 180
        south = 0,      ///< degrees of latitude of its lower side, -90 to 90
        east = 0,       ///< degrees of longitude of its right side, more than `west`, by 180 at most
        north = 0;      ///< degrees of latitude of its upper side, more than `south`, 90 at most
    HeightChannel z{};  ///< the heights, in metres
    /// Metres: the heights that 0 and 32767 stand for, rounded to floats downward and upward. Neighbouring tiles that are given
    /// the same ones have the same heights on their common side. low == high: those of the lowest and the highest vertex.
    double low = 0,
           high = 0;          ///< metres: see `low`
    bool has_normals = true;  ///< extension 1 (octvertexnormals): 2 bytes a vertex
};

/// A mesh with its positions and heights rounded to the 15 bits of a tile. Faces thinner than that may have turned over.
struct [[nodiscard]] TileRounding {
    Mesh mesh;      ///< the mesh as a reader of the tile has it, in its plane and its stored values: same vertices, same faces
    Status status;  ///< what write_quantized_mesh() would say; if it is bad there is no mesh
};

namespace detail {

/// The largest coordinate in a tile.
inline constexpr int tile_most = 32767;

/// The float next below or above a number, or it itself if it is one; of numbers that floats hold.
[[nodiscard]] inline double float_around(double number, bool is_above) noexcept {
    const auto nearest = static_cast<float>(number);
    const auto rounded = static_cast<double>(nearest);
    if (is_above ? rounded >= number : rounded <= number) return rounded;
    constexpr float most = std::numeric_limits<float>::max();
    return static_cast<double>(std::nextafter(nearest, is_above ? most : -most));
}

/// Refuses what no tile holds. O(n).
[[nodiscard]] inline Status check_for_tile(const MeshView& mesh, const HeightSamples& samples,
                                           const QuantizedMeshOptions& tile) noexcept {
    constexpr double radius = 6e6;  // m, less than any of the Earth's: nothing is on the other side of its centre
    if (const Status status =
            check_counts(mesh, most_numbered, most_numbered, "the mesh has more vertices or faces than a tile numbers");
        !status)
        return status;
    if (const Status status = check_height_mesh(mesh, samples, tile.z); !status) return status;
    if (mesh.face_count == 0) return {Errc::invalid_argument, "a tile needs a mesh of at least one face", 0, 1};
    if (const Status status = kit::check_ranges(
            {{"a tile's west must be -180 to 180 degrees", tile.west, -180, 180},
             {"a tile's south must be -90 to 90 degrees", tile.south, -90, 90},
             {"a tile's north must be -90 to 90 degrees", tile.north, -90, 90},
             {"a tile's east must be at most 180 degrees east of its west", tile.east, tile.west, tile.west + 180},
             {"a tile's lowest height must be metres near the globe", tile.low, -radius, 1e9},
             {"a tile's highest height must be metres near the globe", tile.high, tile.low, 1e9}});
        !status)
        return status;
    if (!(tile.west < tile.east))
        return {Errc::invalid_argument, "a tile's east must be more than its west, in degrees", tile.east, tile.west};
    if (!(tile.south < tile.north))
        return {Errc::invalid_argument, "a tile's north must be more than its south, in degrees", tile.north, tile.south};
    const std::array<double, 2> size = plane_size(mesh);
    const bool is_free = !(tile.low < tile.high);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        for (std::size_t k = 0; k < 2; ++k) {
            const auto at = static_cast<double>(mesh.positions[2 * v + k]);
            if (at < 0 || at > size[k])
                return {Errc::invalid_argument,
                        "a tile's mesh must not reach beyond its image, as it does at the place, in samples", at,
                        at < 0 ? 0 : size[k]};
        }
        const double height = height_of(mesh, tile.z, v);
        const double low = is_free ? -radius : tile.low, high = is_free ? 1e9 : tile.high;
        if (!kit::is_within(height, low, high))
            return {Errc::invalid_argument, "a tile has a height beyond those that it may have, in metres", height,
                    height < low ? low : high};
    }
    return {};
}

/// A mesh in the coordinates of a tile.
class TileGrid {
  public:
    /// Of what check_for_tile() accepts, and of a mesh that outlives it. O(n).
    TileGrid(const MeshView& mesh, const QuantizedMeshOptions& tile) noexcept
        : mesh_(mesh), tile_(tile), size_(plane_size(mesh)), low_(tile.low), high_(tile.high) {
        if (!(low_ < high_)) {
            low_ = high_ = height_of(mesh, tile.z, 0);
            for (std::size_t v = 1; v < mesh.vertex_count; ++v) {
                const double height = height_of(mesh, tile.z, v);
                low_ = std::min(low_, height), high_ = std::max(high_, height);
            }
        }
        low_ = float_around(low_, false);
        high_ = float_around(high_, true);
    }

    [[nodiscard]] double low() const noexcept { return low_; }    ///< metres, a float: the height 0
    [[nodiscard]] double high() const noexcept { return high_; }  ///< metres, a float: the height 32767

    /// u, v and height of a vertex, 0 to 32767; v to the north.
    [[nodiscard]] std::array<int, 3> rounded(std::size_t vertex) const noexcept {
        const auto x = static_cast<double>(mesh_.positions[2 * vertex]), y = static_cast<double>(mesh_.positions[2 * vertex + 1]);
        const double range = high_ - low_;
        const double share = range > 0 ? (height_of(mesh_, tile_.z, vertex) - low_) / range : 0;
        return {inside(x, size_[0]), tile_most - inside(y, size_[1]), static_cast<int>(share * tile_most + 0.5)};
    }
    /// Where a vertex is for a reader.
    [[nodiscard]] GeodeticPlace place(const std::array<int, 3>& at) const noexcept {
        return {between(tile_.west, tile_.east, at[0]), between(tile_.south, tile_.north, at[1])};
    }
    /// The height of a vertex for a reader, in metres.
    [[nodiscard]] double height(const std::array<int, 3>& at) const noexcept { return between(low_, high_, at[2]); }
    /// The same in ECEF.
    [[nodiscard]] Vector3 ecef(std::size_t vertex) const noexcept {
        const std::array<int, 3> at = rounded(vertex);
        return place(at).at(height(at));
    }
    /// The same in the mesh's plane, in samples, y down, and its height in metres.
    [[nodiscard]] Vector3 in_plane(std::size_t vertex) const noexcept {
        const std::array<int, 3> at = rounded(vertex);
        return {between(0, size_[0], at[0]), between(0, size_[1], tile_most - at[1]), height(at)};
    }
    /// Degrees from one sample to the next, to the east and to the north.
    [[nodiscard]] std::array<double, 2> degrees_per_sample() const noexcept {
        return {(tile_.east - tile_.west) / size_[0], (tile_.north - tile_.south) / size_[1]};
    }

  private:
    // Vertices of the sides alone are at the ends.
    [[nodiscard]] static int inside(double place, double size) noexcept {
        if (place <= 0) return 0;
        if (place >= size) return tile_most;
        return std::max(1, std::min(tile_most - 1, static_cast<int>(place / size * tile_most + 0.5)));
    }
    // As readers do it: exact at both ends.
    [[nodiscard]] static double between(double low, double high, int at) noexcept {
        const double share = static_cast<double>(at) / tile_most;
        return (1 - share) * low + share * high;
    }

    MeshView mesh_;
    QuantizedMeshOptions tile_;
    std::array<double, 2> size_;
    double low_, high_;
};

/// The vertices of a tile in the order in which faces name them.
struct TileOrder {
    std::vector<std::uint32_t> vertices;  ///< of the mesh
    std::vector<std::uint32_t> ranks;     ///< of each vertex of the mesh that a face names: its place among `vertices`
    std::size_t named = 0;                ///< how many of `vertices` faces name

    /// O(n).
    explicit TileOrder(const MeshView& mesh) {
        constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
        ranks.resize(mesh.vertex_count, none);
        vertices.reserve(mesh.vertex_count);
        for (std::size_t f = 0; f < mesh.face_count; ++f)
            for (const std::uint32_t v : turned(mesh.faces[f])) {
                if (ranks[v] != none) continue;
                ranks[v] = static_cast<std::uint32_t>(vertices.size());
                vertices.push_back(v);
            }
        named = vertices.size();
        // Indices of 16 bits are for up to 65,536 vertices, of which the first could no longer be named once all have been: its
        // distance from the next new one is 65,536. A vertex that no face has makes it 32 bits.
        if (named == 65536) vertices.push_back(vertices.back());
    }
    /// Whether indices have 32 bits.
    [[nodiscard]] bool is_wide() const noexcept { return vertices.size() > 65536; }
    /// Puts an index.
    void put(Writer& writer, std::uint32_t index) const {
        if (is_wide()) writer.u32(index);
        else writer.u16(static_cast<std::uint16_t>(index));
    }
};

/// Puts a float of 64 bits.
inline void put_f64(Writer& writer, double value) {
    static_assert(std::numeric_limits<double>::is_iec559 && sizeof(double) == 8, "double is IEEE 754 binary64");
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, 8);
    writer.u32(static_cast<std::uint32_t>(bits & 0xFFFFFFFFU));
    writer.u32(static_cast<std::uint32_t>(bits >> 32U));
}

/// Writes the header: centre, heights, bounding sphere and horizon occlusion point. O(n).
inline void write_tile_head(Writer& writer, const TileGrid& grid, const TileOrder& order, const QuantizedMeshOptions& tile) {
    const GeodeticPlace middle((tile.west + tile.east) / 2, (tile.south + tile.north) / 2);
    const Vector3 origin = middle.at((grid.low() + grid.high()) / 2);
    Vector3 low{}, high{};
    for (const std::uint32_t v : order.vertices) {
        const Vector3 from = difference(grid.ecef(v), origin);
        const Vector3 local = {dot(from, middle.east), dot(from, middle.north), dot(from, middle.up)};
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = v == order.vertices.front() ? local[k] : std::min(low[k], local[k]);
            high[k] = v == order.vertices.front() ? local[k] : std::max(high[k], local[k]);
        }
    }
    Vector3 center = middle.to_ecef({(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2});
    for (std::size_t k = 0; k < 3; ++k) center[k] += origin[k];
    double radius = 0;
    OcclusionPoint occlusion(center);
    for (const std::uint32_t v : order.vertices) {
        const Vector3 at = grid.ecef(v);
        radius = std::max(radius, length(difference(at, center)));
        occlusion.add(at);
    }
    // Of tiles as large as continents: seen from nearer to the equator, no place is a quarter of the globe away.
    for (int quarters = 3; quarters >= 0 && !occlusion.is_there(); --quarters) {
        const double latitude = (tile.south + tile.north) / 8 * quarters;
        occlusion = OcclusionPoint(GeodeticPlace((tile.west + tile.east) / 2, latitude).up);
        for (const std::uint32_t v : order.vertices) occlusion.add(grid.ecef(v));
    }
    const auto put = [&](const Vector3& point) {
        for (const double coordinate : point) put_f64(writer, coordinate);
    };
    put(center);
    writer.f32(static_cast<float>(grid.low()));
    writer.f32(static_cast<float>(grid.high()));
    put(center);
    put_f64(writer, radius + 0.001);  // m: readers may round otherwise
    put(occlusion.point());
}

/// Writes the vertices: u, v and height, each as its distance from the one before, with the sign in the lowest bit.
inline void write_tile_vertices(Writer& writer, const TileGrid& grid, const TileOrder& order) {
    writer.u32(static_cast<std::uint32_t>(order.vertices.size()));
    for (std::size_t k = 0; k < 3; ++k) {
        int before = 0;
        for (const std::uint32_t v : order.vertices) {
            const int value = grid.rounded(v)[k], step = value - before;
            writer.u16(static_cast<std::uint16_t>(step < 0 ? -2 * step - 1 : 2 * step));
            before = value;
        }
    }
}

/// Writes the faces, each corner as its distance from the highest index so far, or the next one if it is new; and the sides.
inline void write_tile_indices(Writer& writer, const MeshView& mesh, const TileGrid& grid, const TileOrder& order) {
    if (order.is_wide() && writer.position() % 4 != 0) writer.u16(0);
    writer.u32(static_cast<std::uint32_t>(mesh.face_count));
    std::uint32_t next = 0;
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : turned(mesh.faces[f])) {
            const std::uint32_t rank = order.ranks[v];
            order.put(writer, next - rank);
            if (rank == next) ++next;
        }
    struct Side {
        std::size_t fixed;  // u or v
        int at;
    };
    for (const Side side : {Side{0, 0}, Side{1, 0}, Side{0, tile_most}, Side{1, tile_most}}) {  // west, south, east, north
        std::vector<std::array<std::uint32_t, 2>> found;
        for (std::size_t i = 0; i < order.named; ++i) {
            const std::array<int, 3> at = grid.rounded(order.vertices[i]);
            if (at[side.fixed] == side.at)
                found.push_back({static_cast<std::uint32_t>(at[1 - side.fixed]), static_cast<std::uint32_t>(i)});
        }
        std::sort(found.begin(), found.end());
        writer.u32(static_cast<std::uint32_t>(found.size()));
        for (const auto& [along, index] : found) order.put(writer, index);
    }
}

/// A unit vector as two bytes: where it meets the octahedron, whose lower half is folded over the upper one.
[[nodiscard]] inline std::array<std::uint8_t, 2> oct_encoded(const Vector3& normal) noexcept {
    const double sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
    std::array<double, 2> at = {normal[0] / sum, normal[1] / sum};
    if (normal[2] < 0) at = {(1 - std::abs(at[1])) * (at[0] < 0 ? -1 : 1), (1 - std::abs(at[0])) * (at[1] < 0 ? -1 : 1)};
    return {to_u8(std::max(0.0, std::min(1.0, at[0] / 2 + 0.5))), to_u8(std::max(0.0, std::min(1.0, at[1] / 2 + 0.5)))};
}

/// Writes the extension of normals.
inline void write_tile_normals(Writer& writer, const MeshView& mesh, const HeightSamples& samples, const TileGrid& grid,
                               const TileOrder& order, const HeightChannel& z) {
    std::vector<Vector3> sums;
    if (samples.is_empty()) sums = face_normals(mesh, [&](std::size_t vertex) { return grid.ecef(vertex); });
    const std::array<double, 2> degrees = grid.degrees_per_sample();
    writer.u8(1);
    writer.u32(static_cast<std::uint32_t>(2 * order.vertices.size()));
    for (const std::uint32_t v : order.vertices) {
        const std::array<int, 3> at = grid.rounded(v);
        const GeodeticPlace place = grid.place(at);
        Vector3 normal = place.up;
        std::array<double, 2> slope{};
        if (samples.is_empty()) normal = unit(sums[v], place.up);
        else if (slope_at(samples, mesh.samples, z.channel,
                          {static_cast<double>(mesh.positions[2 * std::size_t{v}]),
                           static_cast<double>(mesh.positions[2 * std::size_t{v} + 1])},
                          slope)) {
            const double height = grid.height(at);
            const double east = (place.across + height) * place.cos_latitude * degrees[0] * radians_per_degree,
                         north = (place.along + height) * degrees[1] * radians_per_degree;
            const double to_east = east > 0.001 ? z.scale * slope[0] / east : 0;  // m: all samples of a row are one at a pole
            normal = place.to_ecef(unit({0 - to_east, z.scale * slope[1] / north, 1}, {0, 0, 1}));
        }
        for (const std::uint8_t byte : oct_encoded(normal)) writer.u8(byte);
    }
}

}  // namespace detail

/// The mesh that readers of the tile have, which write_quantized_mesh() would write of this one: what a bound is to be proved
/// on. O(n).
[[nodiscard]] inline TileRounding rounded_to_tile(const MeshView& mesh, const QuantizedMeshOptions& tile) {
    TileRounding out;
    out.status = detail::check_for_tile(mesh, {}, tile);
    if (!out.status) return out;
    const detail::TileGrid grid(mesh, tile);
    const auto channels = static_cast<std::size_t>(mesh.channels);
    Mesh& to = out.mesh;
    to.positions.resize(2 * mesh.vertex_count);
    to.colors.assign(mesh.colors, mesh.colors + channels * mesh.vertex_count);
    to.faces.assign(mesh.faces, mesh.faces + mesh.face_count);
    to.channels = mesh.channels, to.width = mesh.width, to.height = mesh.height, to.peak = mesh.peak;
    to.premultiplied = mesh.premultiplied, to.periodic = mesh.periodic, to.samples = mesh.samples;
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const detail::Vector3 at = grid.in_plane(v);
        for (std::size_t k = 0; k < 2; ++k) to.positions[2 * v + k] = static_cast<float>(at[k]);
        if (tile.z.scale == 0) continue;
        constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
        const double value = std::max(-most, std::min(most, (at[2] - tile.z.offset) / tile.z.scale));
        to.colors[channels * v + static_cast<std::size_t>(tile.z.channel)] = static_cast<float>(value);
    }
    return out;
}

/// Writes a mesh as a tile of quantized-mesh 1.0. A mesh that write_height_ply() refuses, that reaches beyond its image or has no
/// faces, sides that are no degrees, no distance or more than half the globe apart, and heights beyond `low` and `high` give a
/// Status that says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_quantized_mesh(const MeshView& mesh, const HeightSamples& samples, Sink sink,
                                   const QuantizedMeshOptions& tile) {
    if (const Status status = detail::check_for_tile(mesh, samples, tile); !status) return status;
    const detail::TileGrid grid(mesh, tile);
    const detail::TileOrder order(mesh);
    detail::Writer writer(sink);
    detail::write_tile_head(writer, grid, order, tile);
    detail::write_tile_vertices(writer, grid, order);
    detail::write_tile_indices(writer, mesh, grid, order);
    if (tile.has_normals) detail::write_tile_normals(writer, mesh, samples, grid, order, tile.z);
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_QUANTIZED_MESH_HPP
