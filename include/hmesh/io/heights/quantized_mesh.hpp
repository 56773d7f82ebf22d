/// \file
/// write_quantized_mesh(): a mesh of heights as a tile of the globe, quantized-mesh 1.0, for Cesium and others.
#ifndef HMESH_IO_HEIGHTS_QUANTIZED_MESH_HPP
#define HMESH_IO_HEIGHTS_QUANTIZED_MESH_HPP

#include "hmesh/core/status.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/heights/height_samples.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_quantized_mesh(). The mesh's sides are the tile's.
struct QuantizedMeshOptions {
    double west = 0,   ///< degrees of longitude of the left side, -180 to 180
        south = 0,     ///< degrees of latitude of the lower side, -90 to 90
        east = 0,      ///< degrees, beyond `west` by at most 180
        north = 0;     ///< degrees, beyond `south`
    HeightChannel z{};  ///< the heights, in metres above the ellipsoid WGS 84
    /// Metres: the heights that 0 and 32767 stand for. Neighbouring tiles that are given the same ones have the same heights on their
    /// common border. low == high: the lowest and the highest vertex.
    double low = 0, high = 0;
    bool has_normals = true;  ///< extension 1, a normal of 2 bytes for each vertex
};

/// A mesh with positions and heights rounded to the 15 bits of a tile.
struct TileRounding {
    Mesh mesh;         ///< the mesh as a reader of the tile has it, in its plane and its stored values; same vertices, same faces
    double error = 0;  ///< stored values: how far the rounded surface is from the one that was, at most; to ask for so much less
    Status status;     ///< what write_quantized_mesh() would say
};

/// The mesh that readers of write_quantized_mesh()'s file have: what a bound has to be proved on. (Signature; the body follows.)
[[nodiscard]] inline TileRounding rounded_to_tile(const MeshView& mesh, const QuantizedMeshOptions& options);

/// Writes a mesh as a tile, not compressed by gzip. (Signature; the body follows.)
inline Status write_quantized_mesh(const MeshView& mesh, const HeightSamples& samples, Sink sink, const QuantizedMeshOptions& options);

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_QUANTIZED_MESH_HPP
