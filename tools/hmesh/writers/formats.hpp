// tools - the mesh formats that the command writes, known by the endings of files' names. A new format is a line in
// the table of formats.cpp.
#ifndef HMESH_TOOLS_WRITERS_FORMATS_HPP
#define HMESH_TOOLS_WRITERS_FORMATS_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/io/channel_groups.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace tool {

// How .glb files hold the mesh.
enum class GlbForm : std::uint8_t {
    exact,    // positions are floats, faces in the mesh's order
    packed,   // positions of 16 bits, faces and vertices in an order that is good for GPUs
    meshopt,  // the same, compressed
};

// What some formats are told beside the mesh.
struct FormatOptions {
    hmesh::SvgOptions svg;
    hmesh::HtmlOptions html;
    GlbForm glb = GlbForm::exact;
    int glb_color_bits = 16;
    hmesh::CompactOptions compact;
    hmesh::ChannelGroups groups;  // of .glb and .ply
};

// The format of a file of this name, as its ending in lower case: ".ply"; empty: none.
[[nodiscard]] std::string format_ending(const std::string& name);

// ".ply, .obj" and so on.
[[nodiscard]] std::string format_endings();

// Their names: "ply", "obj" and so on.
[[nodiscard]] std::vector<std::string> format_names();

// Writes the mesh in the format of files that end so, for which there is one.
[[nodiscard]] hmesh::Status write_mesh(const hmesh::MeshView& mesh, const std::string& ending, const FormatOptions& options,
                                       hmesh::Sink sink);
// The same as bytes of memory, in place of what is there.
[[nodiscard]] hmesh::Status write_mesh(const hmesh::MeshView& mesh, const std::string& ending, const FormatOptions& options,
                                       std::vector<unsigned char>& bytes);

// Writes levels of detail, the finest first, as one .glb file. Of `all` those that have fewer vertices than the one before.
[[nodiscard]] hmesh::Status write_glb_levels(const std::vector<hmesh::MeshView>& all, const FormatOptions& options,
                                             hmesh::Sink sink);

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_FORMATS_HPP
