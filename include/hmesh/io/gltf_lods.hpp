/// \file
/// write_glb_lods(): levels of detail as one binary glTF file, with the extension MSFT_lod.
///
/// The scene has one node, the finest level, which names the nodes of the others: readers that do not know MSFT_lod show the
/// finest level. A level is drawn until the image covers a smaller share of the screen than the vertices of the next one are of
/// the finest's: half of the screen, a quarter, and so on (MSFT_screencoverage); the last one down to nothing. All levels are
/// laid out as write_glb() does (io/gltf.hpp), with one material. Levels over one vertex buffer, as those of a ProgressiveMesh
/// (lods/progressive_mesh.hpp), share its arrays. write_glb_parts() takes each level in parts, which are primitives of one mesh.
///
/// Sources: Microsoft, MSFT_lod (Khronos, glTF extensions, vendor); what io/gltf.hpp names. Babylon.js loads the levels one after
/// another, the coarsest first.
#ifndef HMESH_IO_GLTF_LODS_HPP
#define HMESH_IO_GLTF_LODS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/glb_file.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace detail {

/// Where an array of the file comes from.
struct GlbSource {
    std::size_t mesh;    ///< which of all meshes
    GlbContent content;  ///< what of it
};

/// All that is written of levels.
struct GlbLevels {
    GlbFile file;
    std::vector<GlbSource> sources;  ///< of each array
    std::vector<GlbGrid> grids;      ///< of each mesh
    std::vector<MeshView> meshes;    ///< of all levels

    /// Moves the arrays of a mesh's own file behind the others; `vertices`, if it is not nullptr, has its attributes already. The
    /// material is that of the first mesh.
    [[nodiscard]] GlbPrimitive take(const GlbMesh& mesh, const GlbPrimitive* vertices) {
        GlbPrimitive primitive = mesh.file.meshes.front().front();
        const auto move_array = [&](std::uint32_t& array) {
            sources.push_back({meshes.size() - 1, mesh.contents[array]});
            file.arrays.push_back(mesh.file.arrays[array]);
            array = static_cast<std::uint32_t>(file.arrays.size() - 1);
        };
        if (vertices != nullptr) primitive.attributes = vertices->attributes;
        else
            for (GlbAttribute& attribute : primitive.attributes) move_array(attribute.array);
        move_array(primitive.indices);
        if (file.materials.empty()) file.materials = mesh.file.materials;
        file.is_quantized = mesh.file.is_quantized;
        return primitive;
    }

    /// Appends a level that has these parts, at least one; where it has the vertices of the first level, only its indices.
    [[nodiscard]] Status append(const std::vector<MeshView>& parts, const GltfOptions& options) {
        std::vector<GlbMesh> laid_out(parts.size());
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (const Status status = lay_out_glb(parts[i], options, laid_out[i]); !status) return status;
        GlbGrid grid = laid_out.front().grid;
        if (parts.size() > 1 && options.quantized_positions) grid = quantized_grid(parts.data(), parts.size());
        const bool is_shared = !meshes.empty() && parts.size() == 1 && file.meshes.front().size() == 1 &&
                               parts.front().positions == meshes.front().positions &&
                               parts.front().colors == meshes.front().colors;
        std::vector<GlbPrimitive> primitives;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            GlbMesh& mesh = laid_out[i];
            if (parts.size() > 1) bound_positions(parts[i], grid, mesh.file.arrays.front());
            meshes.push_back(parts[i]);
            grids.push_back(grid);
            primitives.push_back(take(mesh, is_shared ? &file.meshes.front().front() : nullptr));
        }
        GlbNode node = is_shared ? file.nodes.front() : node_of(parts.front(), grid, options.longer_side);
        node.mesh = static_cast<std::uint32_t>(file.meshes.size());
        file.nodes.push_back(node);
        file.meshes.push_back(std::move(primitives));
        return {};
    }
};

/// The vertices of a level's parts.
[[nodiscard]] inline std::size_t vertices_of(const std::vector<MeshView>& parts) noexcept {
    std::size_t sum = 0;
    for (const MeshView& part : parts) sum += part.vertex_count;
    return sum;
}

/// Refuses levels that are none of one image, the finest first.
[[nodiscard]] inline Status check_levels(const std::vector<std::vector<MeshView>>& levels) noexcept {
    if (levels.empty()) return {Errc::invalid_argument, "there are no levels of detail to be written", 0, 1};
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const auto number = static_cast<std::int64_t>(k);
        if (levels[k].empty()) return {Errc::invalid_argument, "a level of detail has no mesh, number", number, number};
        const MeshView& first = levels.front().front();
        for (const MeshView& part : levels[k]) {
            if (part.vertex_count == 0)
                return {Errc::invalid_argument, "a level of detail has a mesh without vertices, number", number, number};
            if (part.width != first.width || part.height != first.height || part.samples != first.samples ||
                part.channels != first.channels || part.premultiplied != first.premultiplied)
                return {Errc::invalid_argument,
                        "a level of detail has another size or other channels than the one before, number", number, number};
        }
        if (k > 0 && vertices_of(levels[k]) >= vertices_of(levels[k - 1]))
            return {Errc::invalid_argument, "a level of detail has not fewer vertices than the one before",
                    static_cast<std::int64_t>(vertices_of(levels[k])), static_cast<std::int64_t>(vertices_of(levels[k - 1]))};
    }
    return {};
}

}  // namespace detail

/// write_glb_lods() of levels in parts, such as those of cut_for_gpu(): each part becomes a primitive with indices of its own, of
/// 16 bits up to 65,535 vertices. The parts of a level have one grid of quantised positions, so that equal positions stay equal.
inline Status write_glb_parts(const std::vector<std::vector<MeshView>>& levels, Sink sink, const GltfOptions& options = {}) {
    if (levels.size() == 1 && levels.front().size() == 1 && levels.front().front().vertex_count == 0)
        return write_glb(levels.front().front(), sink, options);  // a sprite of nothing
    if (const Status status = detail::check_levels(levels); !status) return status;
    detail::GlbLevels out;
    detail::GlbFile& file = out.file;
    for (std::size_t k = 0; k < levels.size(); ++k) {
        if (const Status status = out.append(levels[k], options); !status) return status;
        const double next = k + 1 < levels.size() ? static_cast<double>(detail::vertices_of(levels[k + 1])) : 0;
        file.coverages.push_back(next / static_cast<double>(detail::vertices_of(levels.front())));
    }
    std::deque<detail::ExportMesh> exported;  // where they stay
    for (const MeshView& mesh : out.meshes) exported.emplace_back(mesh, detail::wanted_colors(options));

    const auto fill = [&](detail::Writer& writer, std::size_t i) {
        const auto& [k, content] = out.sources[i];
        detail::write_glb_array(writer, exported[k].view(), content, file.arrays[i], out.grids[k], options);
    };
    if (options.compress)
        if (const Status status = compress_arrays(file, fill, options.compress); !status) return status;
    if (const Status status = count_glb_json(file); !status) return status;
    return write_glb_file(file, sink, fill);
}

/// Writes levels of detail as a .glb file, the finest first: meshes of one image, each with fewer vertices than the one before.
/// Refuses, before the first byte is written, what write_glb() refuses of any of them, and levels of different size or channels,
/// in another order, or none, or without vertices. One level alone without vertices gives the empty scene of write_glb().
inline Status write_glb_lods(const std::vector<MeshView>& levels, Sink sink, const GltfOptions& options = {}) {
    std::vector<std::vector<MeshView>> whole;
    whole.reserve(levels.size());
    for (const MeshView& level : levels) whole.push_back({level});
    return write_glb_parts(whole, sink, options);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GLTF_LODS_HPP
