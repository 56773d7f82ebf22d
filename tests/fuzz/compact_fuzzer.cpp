// Fuzzes read_compact(), read_bare_compact() and write_compact(). What is read of any bytes is a valid mesh or none; what is
// written is read as it was, and what was read is written and read as it is.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/io/compact/photographs.hpp"

namespace {

using hmesh::CompactMesh;
using hmesh_test::demand;

// Writes the bytes of a head that a reader looks behind: magic, version, size and checksum.
void seal(std::string& file) {
    const auto put = [&](std::size_t at, std::size_t value) {
        for (std::size_t k = 0; k < 4; ++k) file[at + k] = static_cast<char>(value >> (8 * k) & 0xffU);
    };
    file.replace(0, 6, std::string("\x9dHMC\x01\x00", 6));
    put(6, file.size());
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    put(10, hmesh::detail::crc32(bytes + 14, file.size() - 14, hmesh::detail::crc32(bytes, 10)));
}

void check_mesh(const hmesh::Mesh& mesh) {
    demand(hmesh::check(mesh, 4).code == hmesh::Errc::ok, "what is read can be drawn");
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    double area = 0;
    for (const hmesh::Triangle& face : mesh.faces) {
        const auto at = [&](std::size_t k, std::size_t axis) { return static_cast<double>(mesh.positions[2 * face[k] + axis]); };
        const double twice = (at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(2, 0) - at(0, 0)) * (at(1, 1) - at(0, 1));
        demand(twice > 0, "a face has an area, and turns as it should");
        area += twice / 2;
        for (std::size_t k = 0; k < 3; ++k)
            demand(sides.insert({face[k], face[(k + 1) % 3]}).second, "a side is that of one face");
    }
    demand(mesh.periodic != hmesh::Periodic::none || area <= static_cast<double>(mesh.view().right()) * mesh.view().bottom(),
           "faces do not overlap");
}

std::string written(const hmesh::MeshView& mesh, const hmesh::CompactOptions& options, hmesh::Status& status) {
    std::string file;
    status = hmesh::write_compact(mesh, hmesh::kit::append_to(file), options);
    return file;
}

void check_read(const CompactMesh& got) {
    demand((got.status.code == hmesh::Errc::ok) == (*got.status.what == 0), "a status has a sentence if and only if it is bad");
    if (!got.status) {
        demand(got.mesh.faces.empty() && got.mesh.positions.empty(), "what is refused gives no mesh");
        return;
    }
    check_mesh(got.mesh);
    hmesh::CompactOptions options;
    options.colors = hmesh::CompactColors::floats;
    hmesh::Status status;
    const std::string file = written(got.mesh.view(), options, status);
    if (!status) return;  // more flips than a file holds
    const CompactMesh again = hmesh::read_compact(file.data(), file.size());
    demand(again.status.code == hmesh::Errc::ok, "what is written is read");
    demand(
        again.mesh.positions == got.mesh.positions && again.mesh.colors == got.mesh.colors && again.mesh.faces == got.mesh.faces,
        "what was read comes back, in its order");
}

// Positions of corners, whatever the order of vertices and faces.
std::vector<std::array<float, 6>> corners_of(const hmesh::Triangle* faces, std::size_t count, const float* positions) {
    std::vector<std::array<float, 6>> corners(count);
    for (std::size_t f = 0; f < count; ++f) {
        std::array<std::pair<float, float>, 3> at{};
        for (std::size_t k = 0; k < 3; ++k) at[k] = {positions[2 * faces[f][k]], positions[2 * faces[f][k] + 1]};
        std::rotate(at.begin(), std::min_element(at.begin(), at.end()), at.end());
        for (std::size_t k = 0; k < 3; ++k) corners[f][2 * k] = at[k].first, corners[f][2 * k + 1] = at[k].second;
    }
    std::sort(corners.begin(), corners.end());
    return corners;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::CompactLimits limits;
    limits.max_vertices = 20000;
    const std::uint8_t kind = input.byte();
    const hmesh::CompactTable* const table = &hmesh::compact_photographs;
    if (kind % 4 == 0 && size > 15) {
        std::string file(14, 0);
        file.append(reinterpret_cast<const char*>(bytes) + 1, size - 1);
        seal(file);
        check_read(hmesh::read_compact(file.data(), file.size(), limits, table));
    } else if (kind % 4 == 1) {
        const std::vector<std::uint8_t> copy(bytes + 1, bytes + size);
        check_read(hmesh::read_bare_compact(copy.data(), copy.size(), limits, table));
        check_read(hmesh::read_compact(copy.data(), copy.size(), limits, table));
    } else if (size > 0) {
        hmesh::CompactOptions options;
        options.colors = input.one_of<hmesh::CompactColors>(
            {hmesh::CompactColors::bits8, hmesh::CompactColors::bits16, hmesh::CompactColors::floats});
        options.linear = input.flag();
        options.bare = input.one_in(8);
        if (kind % 8 == 7) options.table = kind % 16 == 15 ? &hmesh::compact_photographs_1 : table;
        if (options.colors == hmesh::CompactColors::bits8) options.color_step = 16U * input.byte();
        hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
        mesh.is_good = false;  // it may be off the grid, or have flaws that other formats do not mind
        hmesh_test::fuzz_exporter(
            input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_compact(view, sink, options); },
            [&](const std::string& file, const hmesh::MeshView& view) {
                const CompactMesh got = options.bare ? hmesh::read_bare_compact(file.data(), file.size(), {}, table)
                                                     : hmesh::read_compact(file.data(), file.size(), {}, table);
                demand(got.status.code == hmesh::Errc::ok, "what is written is read");
                demand(got.mesh.vertex_count() == view.vertex_count, "there are as many vertices");
                demand(corners_of(got.mesh.faces.data(), got.mesh.face_count(), got.mesh.positions.data()) ==
                           corners_of(view.faces, view.face_count, view.positions),
                       "faces are where they were");
                if (options.colors != hmesh::CompactColors::floats) return;
                std::vector<float> before(view.colors, view.colors + static_cast<std::size_t>(view.channels) * view.vertex_count);
                std::vector<float> after = got.mesh.colors;
                std::sort(before.begin(), before.end());
                std::sort(after.begin(), after.end());
                demand(options.bare || before == after, "colours are what they were");
            });
    }
    return 0;
}
