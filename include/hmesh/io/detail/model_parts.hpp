/// \file
/// What exporters of models have in common: lines of OBJ, the head and the faces of PLY, names of files.
///
/// Source: Wavefront, Object files; Greg Turk, The PLY Polygon File Format, 1994.
#ifndef HMESH_IO_DETAIL_MODEL_PARTS_HPP
#define HMESH_IO_DETAIL_MODEL_PARTS_HPP

#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// Refuses a name that is none, or that would end a line.
[[nodiscard]] inline Status check_file_name(const char* name) noexcept {
    if (name == nullptr || *name == 0) return {Errc::invalid_argument, "the texture needs a name"};
    for (const char* c = name; *c != 0; ++c)
        if (static_cast<unsigned char>(*c) < 32)
            return {Errc::invalid_argument, "the texture's name must not have control characters",
                    static_cast<int>(static_cast<unsigned char>(*c)), 32};
    return {};
}

/// Writes the first lines of an OBJ file, whose faces have the material `image` of this file, if it is not nullptr.
inline void write_obj_head(Writer& writer, const char* material_file) {
    writer.text("# made by hmesh " HMESH_VERSION_STRING "\n");
    if (material_file == nullptr) return;
    writer.text("mtllib ");
    writer.text(material_file);
    writer.text("\nusemtl image\n");
}

/// Writes a line of an OBJ file: a word and numbers.
inline void write_obj_line(Writer& writer, const char* word, std::initializer_list<double> numbers) {
    writer.text(word);
    for (const double number : numbers) {
        writer.text(" ");
        writer.real(number);
    }
    writer.text("\n");
}

/// Writes the faces of an OBJ file. A corner is the number of its vertex and, behind each of these words, that of its texture
/// coordinates or its normal, which is the same.
inline void write_obj_faces(Writer& writer, const MeshView& mesh, std::initializer_list<const char*> before_others = {}) {
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        writer.text("f");
        for (const std::uint32_t v : turned(mesh.faces[f])) {
            const auto number = static_cast<std::int64_t>(v) + 1;  // vertices count from 1
            writer.text(" ");
            writer.decimal(number);
            for (const char* before : before_others) {
                writer.text(before);
                writer.decimal(number);
            }
        }
        writer.text("\n");
    }
}

/// Writes the first lines of a PLY file, before the properties of its vertices. `texture`, if it is not nullptr, is named as
/// MeshLab reads it.
HMESH_COLD inline void begin_ply(Writer& writer, const MeshView& mesh, const char* texture = nullptr, bool is_ascii = false) {
    writer.text(is_ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    writer.text("comment made by hmesh " HMESH_VERSION_STRING "\n");
    if (texture != nullptr) {
        writer.text("comment TextureFile ");
        writer.text(texture);
        writer.text("\n");
    }
    writer.text("element vertex ");
    writer.decimal(static_cast<std::int64_t>(mesh.vertex_count));
    writer.text("\n");
}

/// Writes the lines of properties of vertices that are floats.
inline void write_ply_floats(Writer& writer, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        writer.text("property float ");
        writer.text(name);
        writer.text("\n");
    }
}

/// Writes the last lines of a PLY file's head, which say of the faces.
inline void end_ply_head(Writer& writer, const MeshView& mesh) {
    writer.text("element face ");
    writer.decimal(static_cast<std::int64_t>(mesh.face_count));
    writer.text("\nproperty list uchar int vertex_indices\nend_header\n");
}

/// Writes the faces of a binary PLY file.
inline void write_ply_faces(Writer& writer, const MeshView& mesh) {
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        writer.u8(3);
        for (const std::uint32_t v : turned(mesh.faces[f])) writer.u32(v);
    }
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_MODEL_PARTS_HPP
