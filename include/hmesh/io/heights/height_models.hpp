/// \file
/// write_height_ply(), _obj(): a mesh of heights as a model in space, with smooth normals and texture coordinates.
///
/// Faces are counter-clockwise seen from above and face up, and the map is not mirrored: north is y where z is up. Normals are
/// those of the samples (see HeightSamples), or, without samples, of the faces around a vertex. Texture coordinates, as Drape
/// has them, begin at the lower left corner of the image.
///
/// Coordinates are floats in PLY, with 24 bits: to a centimetre up to 130 km from the origin. OBJ has nine digits.
/// Of what grows with the mesh nothing is allocated with samples, and 24 bytes a vertex without. O(n).
/// Sources: Greg Turk, The PLY Polygon File Format, 1994; Wavefront, Object and Material files.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_MODELS_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_MODELS_HPP

#include <array>
#include <cstddef>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/model_parts.hpp"
#include "hmesh/io/heights/detail/relief.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/heights/height_samples.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Writes a mesh as a binary PLY file: vertices `float x y z`, `nx ny nz` with normals and `s t` with texture coordinates, z
/// up. A texture is named in a comment, as MeshLab reads it. A mesh that has no size, numbers that are not finite, faces
/// without their vertices or not the channel of heights, samples that are fewer than the mesh's, options outside their range
/// and coordinates beyond all floats give a Status that says so, and no byte is written; a sink that refuses bytes gives
/// Errc::write_failed.
inline Status write_height_ply(const MeshView& mesh, const HeightSamples& samples, Sink sink, const HeightOptions& options = {}) {
    if (const Status status = detail::check_height_model(mesh, samples, options, detail::most_numbered); !status) return status;
    detail::Relief relief(mesh, samples, options, detail::is_y_up(options, false));
    if (options.has_normals) relief.find_normals();
    detail::Writer writer(sink);
    const auto put = [&](const auto& numbers) {
        for (const double number : numbers) writer.f32(static_cast<float>(number));
    };
    detail::begin_ply(writer, mesh, options.texture);
    detail::write_ply_floats(writer, {"x", "y", "z"});
    if (options.has_normals) detail::write_ply_floats(writer, {"nx", "ny", "nz"});
    if (options.drape != Drape::none) detail::write_ply_floats(writer, {"s", "t"});
    detail::end_ply_head(writer, mesh);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        put(relief.position(v));
        if (options.has_normals) put(relief.normal(v));
        if (options.drape == Drape::none) continue;
        const std::array<double, 2> at = relief.texture_place(v);
        put(std::array<double, 2>{at[0], 1 - at[1]});
    }
    detail::write_ply_faces(writer, mesh);
    return writer.finish();
}

/// Writes a mesh as an OBJ file: lines `v x y z`, `vt u v` and `vn x y z`, and faces `f a/a/a b/b/b c/c/c`, z up. `texture`
/// names the material file that write_material() writes. Refuses what write_height_ply() does.
inline Status write_height_obj(const MeshView& mesh, const HeightSamples& samples, Sink sink, const HeightOptions& options = {}) {
    if (const Status status = detail::check_height_model(mesh, samples, options, detail::most_numbered); !status) return status;
    detail::Relief relief(mesh, samples, options, detail::is_y_up(options, false));
    if (options.has_normals) relief.find_normals();
    const bool has_places = options.drape != Drape::none;
    detail::Writer writer(sink);
    detail::write_obj_head(writer, options.texture);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const detail::Vector3 at = relief.position(v);
        detail::write_obj_line(writer, "v", {at[0], at[1], at[2]});
    }
    for (std::size_t v = 0; v < mesh.vertex_count && has_places; ++v) {
        const std::array<double, 2> at = relief.texture_place(v);
        detail::write_obj_line(writer, "vt", {at[0], 1 - at[1]});
    }
    for (std::size_t v = 0; v < mesh.vertex_count && options.has_normals; ++v) {
        const detail::Vector3 normal = relief.normal(v);
        detail::write_obj_line(writer, "vn", {normal[0], normal[1], normal[2]});
    }
    if (has_places && options.has_normals) detail::write_obj_faces(writer, mesh, {"/", "/"});
    else if (has_places) detail::write_obj_faces(writer, mesh, {"/"});
    else if (options.has_normals) detail::write_obj_faces(writer, mesh, {"//"});
    else detail::write_obj_faces(writer, mesh);
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_MODELS_HPP
