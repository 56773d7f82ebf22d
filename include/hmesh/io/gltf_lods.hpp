/// \file
/// write_glb_lods(): levels of detail as one binary glTF file, with the extension MSFT_lod.
///
/// The scene has one node, the finest level, which names the nodes of the others: readers that do not know MSFT_lod show the
/// finest level. A level is drawn until the image covers a smaller share of the screen than the vertices of the next one are of
/// the finest's: half of the screen, a quarter, and so on (MSFT_screencoverage); the last one down to nothing. All levels are
/// laid out as write_glb() does (io/gltf.hpp), with one material. Levels over one vertex buffer, as those of a ProgressiveMesh
/// (lods/progressive_mesh.hpp), share its arrays.
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
    std::size_t level;   ///< which level
    GlbContent content;  ///< what of it
};

/// Moves the arrays of a level's own file behind those of `file`, with node and mesh. Where its vertices are those of the first
/// level, only its indices. The material is that of the first level.
inline void append_level(GlbMesh&& level, std::size_t number, bool shares_vertices, GlbFile& file,
                         std::vector<GlbSource>& sources) {
    std::vector<GlbPrimitive>& primitives = level.file.meshes.front();
    GlbPrimitive& primitive = primitives.front();
    const auto move_array = [&](std::uint32_t& array) {
        sources.push_back({number, level.contents[array]});
        file.arrays.push_back(level.file.arrays[array]);
        array = static_cast<std::uint32_t>(file.arrays.size() - 1);
    };
    GlbNode node = level.file.nodes.front();
    if (shares_vertices) {
        primitive.attributes = file.meshes.front().front().attributes;
        node = file.nodes.front();
    } else {
        for (GlbAttribute& attribute : primitive.attributes) move_array(attribute.array);
    }
    move_array(primitive.indices);
    node.mesh = static_cast<std::uint32_t>(file.meshes.size());
    file.nodes.push_back(node);
    file.meshes.push_back(std::move(primitives));
    if (file.materials.empty()) file.materials = level.file.materials;
    file.is_quantized = level.file.is_quantized;
}

}  // namespace detail

/// Writes levels of detail as a .glb file, the finest first: meshes of one image, each with fewer vertices than the one before.
/// Refuses, before the first byte is written, what write_glb() refuses of any of them, and levels of different size or channels,
/// in another order, or none.
inline Status write_glb_lods(const std::vector<MeshView>& levels, Sink sink, const GltfOptions& options = {}) {
    if (levels.empty()) return {Errc::invalid_argument, "there are no levels of detail to be written", 0, 1};
    for (std::size_t k = 1; k < levels.size(); ++k) {
        const MeshView &level = levels[k], &before = levels[k - 1];
        const auto number = static_cast<std::int64_t>(k);
        if (level.width != before.width || level.height != before.height || level.channels != before.channels ||
            level.premultiplied != before.premultiplied)
            return {Errc::invalid_argument, "a level of detail has another size or other channels than the one before, number",
                    number, number};
        if (level.vertex_count >= before.vertex_count)
            return {Errc::invalid_argument, "a level of detail has not fewer vertices than the one before",
                    static_cast<std::int64_t>(level.vertex_count), static_cast<std::int64_t>(before.vertex_count)};
    }

    detail::GlbFile file;
    std::vector<detail::GlbSource> sources;
    std::vector<detail::GlbGrid> grids;
    const MeshView& finest = levels.front();
    for (std::size_t k = 0; k < levels.size(); ++k) {
        detail::GlbMesh level;
        if (const Status status = detail::lay_out_glb(levels[k], options, level); !status) return status;
        const bool is_shared = k > 0 && levels[k].positions == finest.positions && levels[k].colors == finest.colors;
        grids.push_back(level.grid);
        detail::append_level(std::move(level), k, is_shared, file, sources);
        const double next = k + 1 < levels.size() ? static_cast<double>(levels[k + 1].vertex_count) : 0;
        file.coverages.push_back(next / static_cast<double>(finest.vertex_count));
    }
    std::deque<detail::ExportMesh> exported;  // where they stay
    for (const MeshView& level : levels) exported.emplace_back(level, detail::Premultiplied::divided);

    const auto fill = [&](detail::Writer& writer, std::size_t i) {
        const auto& [k, content] = sources[i];
        const MeshView& mesh = exported[k].view();
        detail::write_glb_array(writer, mesh, content, file.arrays[i], grids[k], options);
    };
    if (options.compress)
        if (const Status status = compress_arrays(file, fill, options.compress); !status) return status;
    if (const Status status = count_glb_json(file); !status) return status;
    return write_glb_file(file, sink, fill);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GLTF_LODS_HPP
