/// \file
/// write_height_glb(): a mesh of heights as a model for glTF's viewers, with smooth normals and texture coordinates.
///
/// Faces are counter-clockwise seen from above and face up, and the map is not mirrored: y is up and north is -z. Normals are
/// those of the samples (see HeightSamples), or, without samples, of the faces around a vertex. Texture coordinates, as Drape
/// has them, begin at the upper left corner of the image.
///
/// Coordinates are floats, with 24 bits: to a centimetre up to 130 km from the origin. Of what grows with the mesh 24 bytes a
/// vertex are allocated without samples, and with a skirt some for each vertex in the sides. O(n).
/// Source: Khronos, glTF 2.0, sections 3.6 to 3.9.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_GLB_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_GLB_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/glb_file.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/heights/detail/relief.hpp"
#include "hmesh/io/heights/detail/skirt.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/heights/height_samples.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace detail {

/// Finds the bounds as floats of so many positions. O(n).
inline void bound_heights(std::size_t count, FunctionRef<Vector3(std::size_t vertex)> position, GlbArray& array) noexcept {
    array.has_bounds = true;
    array.low.fill(std::numeric_limits<double>::max());
    array.high.fill(std::numeric_limits<double>::lowest());
    for (std::size_t v = 0; v < count; ++v) {
        const Vector3 at = position(v);
        for (std::size_t k = 0; k < 3; ++k) {
            const double stored = kit::as_float(at[k]);
            array.low[k] = std::min(array.low[k], stored);
            array.high[k] = std::max(array.high[k], stored);
        }
    }
}

/// A model of heights as a .glb file: a primitive for the surface and, where walls hang from its sides, one for these. Each has
/// arrays of positions, normals, texture coordinates and indices, in this order, of those that are wanted.
class HeightScene {
  public:
    /// Lays out the file of a mesh with vertices. All must outlive the scene.
    HeightScene(const MeshView& mesh, const Relief& relief, const HeightOptions& options)
        : mesh_(&mesh), relief_(&relief), options_(&options) {
        if (options.skirt > 0) skirt_ = Skirt(mesh);
        out_.file.nodes.emplace_back();
        out_.file.meshes.emplace_back();
        add(mesh.vertex_count, mesh.face_count);
        bound_heights(
            mesh.vertex_count, [&](std::size_t v) { return relief.position(v); }, out_.file.arrays[0]);
        per_primitive_ = out_.file.arrays.size();
        if (skirt_.face_count() > 0) {
            add(skirt_.vertex_count(), skirt_.face_count());
            bound_heights(
                skirt_.vertex_count(), [&](std::size_t v) { return hung(v); }, out_.file.arrays[per_primitive_]);
        }
        GlbMaterial material;
        material.is_lit = options.has_normals;
        material.texture = options.drape != Drape::none ? options.texture : nullptr;
        out_.file.materials.push_back(material);
    }

    [[nodiscard]] GlbFile& file() noexcept { return out_.file; }  ///< what write_glb_file() takes
    /// Writes the numbers of an array.
    void write_array(Writer& writer, std::size_t i) const {
        const bool is_hung = i >= per_primitive_;
        const std::size_t array = i % per_primitive_;
        const GlbNumber number = out_.file.arrays[i].number;
        if (array == per_primitive_ - 1) {
            if (!is_hung) return write_glb_indices(writer, *mesh_, number);
            return skirt_.for_corners([&](std::uint32_t v) { write_glb_index(writer, v, number); });
        }
        const auto put = [&](const auto& numbers) {
            for (const double coordinate : numbers) writer.f32(static_cast<float>(coordinate));
        };
        const std::size_t count = is_hung ? skirt_.vertex_count() : mesh_->vertex_count;
        for (std::size_t v = 0; v < count; ++v) {
            const std::size_t vertex = is_hung ? skirt_.above(v) : v;
            if (array == 0) put(is_hung ? hung(v) : relief_->position(v));
            else if (array == 1 && options_->has_normals) put(relief_->normal(vertex));
            else put(relief_->texture_place(vertex));
        }
    }

  private:
    void add(std::size_t vertices, std::size_t faces) {
        GlbPrimitive primitive;
        const auto floats = [&](std::uint32_t components) { return out_.add({}, GlbNumber::f32, components, vertices); };
        primitive.attributes = {{"POSITION", floats(3)}};
        if (options_->has_normals) primitive.attributes.push_back({"NORMAL", floats(3)});
        if (options_->drape != Drape::none) primitive.attributes.push_back({"TEXCOORD", floats(2), 0});
        primitive.indices = add_indices(out_, vertices, faces);
        out_.file.meshes[0].push_back(primitive);
    }
    /// Where a vertex of the skirt is.
    [[nodiscard]] Vector3 hung(std::size_t vertex) const {
        const std::size_t above = skirt_.above(vertex);
        const double below = relief_->height(above) - options_->skirt;
        return relief_->position(above, {}, vertex % 2 == 0 ? nullptr : &below);
    }

    const MeshView* mesh_;
    const Relief* relief_;
    const HeightOptions* options_;
    Skirt skirt_;
    GlbMesh out_;
    std::size_t per_primitive_ = 0;  ///< arrays
};

}  // namespace detail

/// Writes a mesh as a .glb file with POSITION, NORMAL and TEXCOORD_0, y up, of one rough material, white or of the texture, lit
/// by lamps; where there are no normals it is not lit. Walls that hang from its sides are a second primitive. A mesh without
/// vertices is a scene of nothing. Refuses what write_height_ply() does, a skirt that reaches below all floats, and more than 44
/// million vertices or faces.
inline Status write_height_glb(const MeshView& mesh, const HeightSamples& samples, Sink sink, const HeightOptions& options = {}) {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max() / 48;  // so that the whole file is below 4 GiB
    if (const Status status = detail::check_height_model(mesh, samples, options, most); !status) return status;
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
    detail::HeightScene scene(mesh, relief, options);
    if (const Status status = detail::count_glb_json(scene.file()); !status) return status;
    return detail::write_glb_file(scene.file(), sink,
                                  [&](detail::Writer& writer, std::size_t i) { scene.write_array(writer, i); });
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_GLB_HPP
