/// \file
/// write_height_ply(), _obj(), _glb(): a mesh of heights as a model in space, with smooth normals and texture coordinates.
///
/// Faces are counter-clockwise seen from above and face up, and the map is not mirrored: north is y in files with z up, and -z
/// in glTF, where y is up. Normals are those of the samples (see HeightSamples), or, without samples, of the faces around a
/// vertex. Texture coordinates, as Drape has them, begin at the lower left corner of the image in PLY and OBJ, at its upper
/// left one in glTF.
///
/// Coordinates are floats in PLY and glTF, with 24 bits: to a centimetre up to 130 km from the origin. OBJ has nine digits.
/// Of what grows with the mesh nothing is allocated with samples, and 24 bytes a vertex without. O(n).
/// Sources: Greg Turk, The PLY Polygon File Format, 1994; Wavefront, Object and Material files; Khronos, glTF 2.0, sections 3.6
/// to 3.9.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_MODELS_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_MODELS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/glb_file.hpp"
#include "hmesh/io/detail/model_parts.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/heights/detail/relief.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/heights/height_samples.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace detail {

/// Refuses what no file of a model of heights holds. O(n).
[[nodiscard]] inline Status check_height_model(const MeshView& mesh, const HeightSamples& samples, const HeightOptions& options) {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max() / 48;  // so that all of a .glb is below 4 GiB
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a model of heights holds");
        !status)
        return status;
    if (options.texture != nullptr && options.drape == Drape::none)
        return {Errc::invalid_argument, "a texture is named, but Drape::none leaves no coordinates to show it by"};
    return check_relief(mesh, samples, options);
}

/// Finds the bounds as floats of so many positions. O(n).
inline void bound_heights(std::size_t count, FunctionRef<Vector3(std::size_t vertex)> position, GlbArray& array) noexcept {
    array.has_bounds = true;
    array.low.fill(std::numeric_limits<double>::max());
    array.high.fill(std::numeric_limits<double>::lowest());
    for (std::size_t v = 0; v < count; ++v) {
        const Vector3 at = position(v);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto stored = static_cast<double>(static_cast<float>(at[k]));
            array.low[k] = std::min(array.low[k], stored);
            array.high[k] = std::max(array.high[k], stored);
        }
    }
}

/// The walls that hang from the sides of a mesh: two vertices for each of its vertices there, the one that it is and one below,
/// with its normal and its place in the image, so that they are shaded as the surface they hang from.
class Skirt {
  public:
    /// Of nothing.
    Skirt() = default;
    /// Finds the vertices and the edges in the sides. O(n).
    explicit Skirt(const MeshView& mesh) {
        const std::array<double, 2> size = plane_size(mesh);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v)
            if (sides_of(mesh, size, v) != 0) vertices_.push_back(static_cast<std::uint32_t>(v));
        for (std::size_t f = 0; f < mesh.face_count; ++f) {
            const Triangle face = turned(mesh.faces[f]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t from = face[k], to = face[(k + 1) % 3];
                if ((sides_of(mesh, size, from) & sides_of(mesh, size, to)) != 0)
                    edges_.push_back({number_of(from), number_of(to)});
            }
        }
    }

    /// Vertices, twice as many as the mesh has in its sides.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return 2 * vertices_.size(); }
    /// Faces.
    [[nodiscard]] std::size_t face_count() const noexcept { return 2 * edges_.size(); }
    /// Which of the mesh's vertices one is, or is below: those with odd numbers are.
    [[nodiscard]] std::size_t above(std::size_t vertex) const noexcept { return vertices_[vertex / 2]; }
    /// Calls put(v) for the corners of all faces, counter-clockwise seen from outside.
    template <class Put>
    void for_corners(Put&& put) const {
        for (const auto& [from, to] : edges_)
            for (const std::uint32_t v : {2 * to, 2 * from, 2 * from + 1, 2 * to, 2 * from + 1, 2 * to + 1}) put(v);
    }

  private:
    // A bit for each side of the plane.
    [[nodiscard]] static unsigned sides_of(const MeshView& mesh, const std::array<double, 2>& size, std::size_t vertex) noexcept {
        unsigned sides = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto at = static_cast<double>(mesh.positions[2 * vertex + k]);
            sides |= (at <= 0 ? 1U : 0U) << 2 * k | (at >= size[k] ? 2U : 0U) << 2 * k;
        }
        return sides;
    }
    [[nodiscard]] std::uint32_t number_of(std::uint32_t vertex) const noexcept {
        return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) - vertices_.begin());
    }

    std::vector<std::uint32_t> vertices_;              // of the mesh, ascending
    std::vector<std::array<std::uint32_t, 2>> edges_;  // as their faces go along them, by numbers in vertices_
};

}  // namespace detail

/// Writes a mesh as a binary PLY file: vertices `float x y z`, `nx ny nz` with normals and `s t` with texture coordinates, z
/// up. A texture is named in a comment, as MeshLab reads it. A mesh that has no size, numbers that are not finite, faces
/// without their vertices or not the channel of heights, samples that are fewer than the mesh's, options outside their range
/// and coordinates beyond all floats give a Status that says so, and no byte is written; a sink that refuses bytes gives
/// Errc::write_failed.
inline Status write_height_ply(const MeshView& mesh, const HeightSamples& samples, Sink sink, const HeightOptions& options = {}) {
    if (const Status status = detail::check_height_model(mesh, samples, options); !status) return status;
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
    if (const Status status = detail::check_height_model(mesh, samples, options); !status) return status;
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

/// Writes a mesh as a .glb file with POSITION, NORMAL and TEXCOORD_0, y up, of one rough material, white or of the texture, lit
/// by lamps; where there are no normals it is not lit. Walls that hang from its sides are a second primitive. A mesh without
/// vertices is a scene of nothing. Refuses what write_height_ply() does, and a skirt that reaches below all floats.
inline Status write_height_glb(const MeshView& mesh, const HeightSamples& samples, Sink sink, const HeightOptions& options = {}) {
    if (const Status status = detail::check_height_model(mesh, samples, options); !status) return status;
    constexpr auto deepest = static_cast<double>(std::numeric_limits<float>::max());
    if (!kit::is_within(options.skirt, 0, deepest))
        return {Errc::invalid_argument, "a skirt must have a depth of 0 or more that a float holds", options.skirt, deepest};
    if (mesh.vertex_count == 0) return detail::write_empty_glb(sink);
    detail::Relief relief(mesh, samples, options, detail::is_y_up(options, true));
    if (options.has_normals) relief.find_normals();
    for (std::size_t v = 0; v < mesh.vertex_count && options.skirt > 0; ++v)
        if (relief.height(v) - options.skirt < -deepest)
            return {Errc::not_finite, "the skirt of the model reaches below what a float holds, at vertex",
                    static_cast<std::int64_t>(v), 0};
    const detail::Skirt skirt = options.skirt > 0 ? detail::Skirt(mesh) : detail::Skirt();
    const auto hung = [&](std::size_t v) {
        const std::size_t above = skirt.above(v);
        const double below = relief.height(above) - options.skirt;
        return relief.position(above, {}, v % 2 == 0 ? nullptr : &below);
    };
    detail::GlbMesh out;
    detail::GlbFile& file = out.file;
    // The arrays of a primitive, in this order: positions, normals, places and indices.
    struct Part {
        std::uint32_t normals, places, indices, end;
    };
    const auto add = [&](std::size_t vertices, std::size_t faces) {
        detail::GlbPrimitive primitive;
        const auto floats = [&](std::uint32_t components) { return out.add({}, detail::GlbNumber::f32, components, vertices); };
        primitive.attributes = {{"POSITION", floats(3)}};
        Part part{};
        part.normals = static_cast<std::uint32_t>(file.arrays.size());
        if (options.has_normals) primitive.attributes.push_back({"NORMAL", floats(3)});
        part.places = static_cast<std::uint32_t>(file.arrays.size());
        if (options.drape != Drape::none) primitive.attributes.push_back({"TEXCOORD", floats(2), 0});
        part.indices = primitive.indices = detail::add_indices(out, vertices, faces);
        part.end = part.indices + 1;
        file.meshes[0].push_back(primitive);
        return part;
    };
    file.nodes.emplace_back();
    file.meshes.emplace_back();
    const Part surface = add(mesh.vertex_count, mesh.face_count);
    detail::bound_heights(
        mesh.vertex_count, [&](std::size_t v) { return relief.position(v); }, file.arrays[0]);
    if (skirt.face_count() > 0) {
        add(skirt.vertex_count(), skirt.face_count());
        detail::bound_heights(skirt.vertex_count(), hung, file.arrays[surface.end]);
    }
    detail::GlbMaterial material;
    material.is_lit = options.has_normals;
    material.texture = options.drape != Drape::none ? options.texture : nullptr;
    file.materials.push_back(material);
    if (const Status status = detail::count_glb_json(file); !status) return status;
    return detail::write_glb_file(file, sink, [&](detail::Writer& writer, std::size_t i) {
        const bool is_hung = i >= surface.end;
        const std::size_t array = is_hung ? i - surface.end : i;
        if (array == surface.indices) {
            if (!is_hung) return detail::write_glb_indices(writer, mesh, file.arrays[i].number);
            return skirt.for_corners([&](std::uint32_t v) { detail::write_glb_index(writer, v, file.arrays[i].number); });
        }
        const auto put = [&](const auto& numbers) {
            for (const double number : numbers) writer.f32(static_cast<float>(number));
        };
        const std::size_t count = is_hung ? skirt.vertex_count() : mesh.vertex_count;
        for (std::size_t v = 0; v < count; ++v) {
            const std::size_t vertex = is_hung ? skirt.above(v) : v;
            if (array == 0) put(is_hung ? hung(v) : relief.position(v));
            else if (array < surface.places) put(relief.normal(vertex));
            else put(relief.texture_place(vertex));
        }
    });
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_MODELS_HPP
