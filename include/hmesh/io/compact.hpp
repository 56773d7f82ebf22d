/// \file
/// write_compact() and read_compact(): a mesh in a file that is smaller than any other of it, and back.
///
/// Points come first, in no order of their own; then the flips that lead from their Delaunay triangulation to the mesh's; then
/// colours, each foretold by its neighbours: adaptive binary contexts, mixed, in an arithmetic code. docs/compact.md describes
/// every bit. What is read back has the same positions, faces and colours, but in the file's order of vertices and faces, which
/// depends on the mesh alone and not on how it was kept; written again with the same options it gives the same bytes, unless
/// CompactOptions::color_step makes its colours coarse once more.
///
/// Kept are meshes on the 1/256 px grid, as all of hmesh's are, of 1 to 4 channels: the whole picture or with holes, of periodic
/// images and of points. Colours are integers of 8 or 16 bits, or the very floats.
///
/// The reader is made for files of strangers: it allocates nothing before limits were checked, its work is bounded by the number
/// of vertices, O(n log n), whatever the bytes, and whatever passes is a mesh whose faces do not overlap. Cost: some 2 us a
/// vertex.
#ifndef HMESH_IO_COMPACT_HPP
#define HMESH_IO_COMPACT_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/body.hpp"
#include "hmesh/io/compact/container.hpp"
#include "hmesh/io/compact/options.hpp"
#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/start_table.hpp"
#include "hmesh/io/detail/compact_writer.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// What read_compact() returns.
struct [[nodiscard]] CompactMesh {
    Mesh mesh;                                    ///< the mesh, or an empty one
    bool linear = false;                          ///< whether its colours are for renderers that interpolate linear light
    CompactColors colors = CompactColors::bits8;  ///< how the file holds its colours
    Status status;                                ///< ok, or why there is none
};

namespace detail {

/// The float of an integer of the same order, as CompactWriter makes them.
[[nodiscard]] inline float float_of_ordered(std::uint32_t bits) noexcept {
    bits = (bits & 0x80000000U) != 0 ? bits & 0x7fffffffU : ~bits;
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
}

/// The mesh of a head and a body. Not finite colours, which floats can be, are refused.
[[nodiscard]] inline Status to_mesh(const CompactHead& head, const CompactBody& body, Mesh& mesh) {
    const auto channels = static_cast<std::size_t>(head.channels);
    const std::vector<GridPoint> points = points_of(head, body);
    constexpr auto highest = static_cast<double>(std::numeric_limits<float>::max());  // peaks may be above it
    std::vector<std::uint32_t> vertex_of(points.size());
    std::uint32_t next = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
        vertex_of[p] = next;
        if (!body.used[p]) continue;
        ++next;
        mesh.positions.push_back(static_cast<float>(points[p].x + head.left) / 256);
        mesh.positions.push_back(static_cast<float>(points[p].y + head.top) / 256);
        for (std::size_t k = 0; k < channels; ++k) {
            const std::uint32_t number = body.colors[channels * p + k];
            float value = 0;
            if (head.colors == CompactColors::floats) value = float_of_ordered(number);
            else value = static_cast<float>(std::min(number * head.peak / head.most_color(), highest));
            if (!kit::is_finite(value))
                return {Errc::not_finite, "the compact mesh has a colour that is not finite, or is damaged"};
            mesh.colors.push_back(value);
        }
    }
    for (std::size_t f = 0; f < body.faces.size(); ++f)
        if (body.shown[f])
            mesh.faces.push_back({vertex_of[body.faces[f][0]], vertex_of[body.faces[f][1]], vertex_of[body.faces[f][2]]});
    mesh.channels = head.channels;
    mesh.width = head.width;
    mesh.height = head.height;
    mesh.peak = head.peak;
    mesh.premultiplied = head.premultiplied;
    mesh.periodic = head.periodic;
    mesh.samples = head.samples;
    return {};
}

/// Reads what follows the magic and the checksum. `head` has the number of the table, where it is not bare.
[[nodiscard]] inline Status get_compact(ByteReader& in, CompactHead head, const ToldSize* bare, const CompactLimits& limits,
                                        const CompactTable* table, CompactMesh& out) {
    if (const Status status = bare != nullptr ? get_bare_head(in, *bare, head) : get_head(in, head); !status) return status;
    const CompactTable* const own = head.table == 0 || table == nullptr ? nullptr : table->find(head.table);
    if (head.table != 0 && own == nullptr)
        return {Errc::invalid_argument, "the compact mesh begins with a start table that its reader was not given, number",
                head.table, table == nullptr ? 0 : table->number};
    const std::int64_t pixels = std::int64_t{head.width} * head.height;
    if (pixels > limits.max_pixels)
        return {Errc::image_too_large, "the compact mesh's image has more pixels than are allowed", pixels, limits.max_pixels};
    ArithmeticCoder coder(in.next(), in.left());
    CompactBody body;
    const auto most = static_cast<std::size_t>(limits.max_vertices);
    if (const Status status = code_of(own)(coder, head, body, most, own, {}); !status) return status;
    if (!coder.is_at_end()) return {Errc::invalid_argument, "the compact mesh does not end where its bytes do: it is damaged"};
    out.linear = head.linear;
    out.colors = head.colors;
    if (const Status status = to_mesh(head, body, out.mesh); !status) return status;
    return head.periodic == Periodic::none ? Status() : kit::check_periodic(out.mesh.view());
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as a compact file. A mesh that has no size, numbers that are not finite, positions off the
/// 1/256 px grid, two colours at one place, vertices without faces, faces that overlap, turn the other way or meet otherwise
/// than edge to edge give a Status that says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
/// Vertices of one place and one colour become one.
inline Status write_compact(const MeshView& mesh, Sink sink, const CompactOptions& options = {}) {
    constexpr std::uint64_t most = detail::CompactHead::widest / 2;
    if (const Status status =
            detail::check_counts(mesh, most, 2 * most, "the mesh has more vertices or faces than a compact file holds");
        !status)
        return status;
    if (const Status status = detail::check_for_export(mesh, 4); !status) return status;
    for (const int side : {mesh.width, mesh.height})
        if (side > 65536) return {Errc::image_too_large, "a compact file holds images of sides up to 65536 px", side, 65536};
    if (const Status status = detail::check(options); !status) return status;
    detail::CompactWriter writer(mesh);
    if (const Status status = writer.prepare(options); !status) return status;
    std::vector<std::uint8_t> bytes;
    if (const Status status = writer.put(options, bytes); !status) return status;
    detail::Writer out(sink);
    out.bytes(bytes.data(), bytes.size());
    return out.finish();
}

/// Reads a compact file of `size` bytes. What is no such file, of another version, damaged, cut off or too large gives a Status
/// that says so, and an empty mesh. `table`, where not null, is the one that files may begin with: CompactOptions::table.
inline CompactMesh read_compact(const void* bytes, std::size_t size, const CompactLimits& limits = {},
                                const CompactTable* table = nullptr) {
    CompactMesh out;
    out.status = detail::check(limits);
    if (!out.status) return out;
    const auto* const from = static_cast<const std::uint8_t*>(bytes);
    const auto refuse = [&](const char* what, double value = 0, double limit = 0) {
        out.status = {Errc::invalid_argument, what, value, limit};
        return out;
    };
    if (size < detail::compact_checked || !std::equal(detail::compact_magic.begin(), detail::compact_magic.end(), from))
        return refuse("these bytes are no compact mesh");
    detail::CompactHead head;
    head.table = from[5];
    if (from[4] != detail::compact_version || head.table > detail::CompactHead::last_table)
        return refuse("the compact mesh is of a version that is not known", from[4], detail::compact_version);
    detail::ByteReader in(from + 6, size - 6);
    if (const std::uint32_t said = in.u32(); said != size)
        return refuse("the compact mesh has another size than it says", static_cast<double>(size), said);
    if (in.u32() != detail::crc32(in.next(), in.left(), detail::crc32(from, 10)))
        return refuse("the compact mesh is damaged: its checksum does not fit");
    out.status = detail::get_compact(in, head, nullptr, limits, table, out);
    if (!out.status) out.mesh = {};
    return out;
}

namespace detail {

[[nodiscard]] inline CompactMesh read_bare(const void* bytes, std::size_t size, const ToldSize& told, const CompactLimits& limits,
                                           const CompactTable* table) {
    CompactMesh out;
    out.status = check(limits);
    if (!out.status) return out;
    ByteReader in(static_cast<const std::uint8_t*>(bytes), size);
    out.status = get_compact(in, {}, &told, limits, table, out);
    if (!out.status) out.mesh = {};
    return out;
}

}  // namespace detail

/// Reads the bare profile, which has no checksum: damage is found where it shows, and else gives another mesh. `table`: as of
/// read_compact().
inline CompactMesh read_bare_compact(const void* bytes, std::size_t size, const CompactLimits& limits = {},
                                     const CompactTable* table = nullptr) {
    return detail::read_bare(bytes, size, {}, limits, table);
}
/// Reads the bare profile of an image of width x height px, in [1, 65536], which the bytes do not tell.
inline CompactMesh read_bare_compact(const void* bytes, std::size_t size, int width, int height, const CompactLimits& limits = {},
                                     const CompactTable* table = nullptr) {
    if (width >= 1 && height >= 1) return detail::read_bare(bytes, size, {width, height}, limits, table);
    CompactMesh out;
    out.status = {Errc::invalid_argument, "the image of a compact mesh must have sides of 1 to 65536 px",
                  static_cast<std::int64_t>(width < 1 ? width : height), 1};
    return out;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_HPP
