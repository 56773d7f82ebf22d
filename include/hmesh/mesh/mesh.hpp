/// \file
/// Mesh, a triangle mesh as plain arrays, and MeshView, the pointers and counts that exporters and render() read.
///
/// Vertex i is at (positions[2i], positions[2i + 1]) in the plane of the image, [0, width] x [0, height] in px (of samples that
/// are points [0, width - 1] x [0, height - 1]), y down. Its colour is colors[C i] .. colors[C i + C - 1], in the image's stored
/// values; `peak` is full intensity. Face f joins the vertices faces[f][0], faces[f][1] and faces[f][2], positively oriented:
/// clockwise on the screen.
#ifndef HMESH_MESH_MESH_HPP
#define HMESH_MESH_MESH_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// A face: the indices of its three vertices.
using Triangle = std::array<std::uint32_t, 3>;

/// A non-owning view of a mesh, whose arrays must outlive it.
struct MeshView {
    const float* positions = nullptr;  ///< x and y of each vertex, in px: 2 * vertex_count numbers
    const float* colors = nullptr;     ///< colour of each vertex, in stored values: channels * vertex_count numbers
    const Triangle* faces = nullptr;   ///< the faces: face_count triples of indices
    std::size_t vertex_count = 0,      ///< number of vertices
        face_count = 0;                ///< number of faces
    int channels = 0;                  ///< samples of a colour, 1 to 16; of 2 or 4 the last is alpha
    int width = 0,                     ///< px of the image
        height = 0;                    ///< px of the image
    double peak = 0;                   ///< colour value of full intensity, > 0
    /// Whether the colours, of 2 or 4 channels, are stored multiplied by alpha / peak. Exporters to formats that want straight
    /// colours divide by it.
    bool premultiplied = false;
    Periodic periodic = Periodic::none;  ///< along which axes copies of the mesh, shifted by its size, go on from it
    Samples samples = Samples::squares;  ///< where the image's samples stand in the plane

    /// The x of the right side of the rectangle that a mesh of the image covers, in px; its left side is 0.
    [[nodiscard]] constexpr int right() const noexcept { return kit::extent(width, samples); }
    /// The y of the lower side, in px; the upper one is 0.
    [[nodiscard]] constexpr int bottom() const noexcept { return kit::extent(height, samples); }
};

/// A triangle mesh that owns its arrays. Those that mesh_image() makes tile the rectangle of their image.
struct Mesh {
    std::vector<float> positions;  ///< x and y of each vertex, in px
    std::vector<float> colors;     ///< colour of each vertex, `channels` numbers in stored values
    std::vector<Triangle> faces;   ///< the three vertices of each face
    int channels = 0;              ///< samples of a colour, 1 to 16; of 2 or 4 the last is alpha
    int width = 0,                 ///< px of the image
        height = 0;                ///< px of the image
    double peak = 0;               ///< colour value of full intensity, > 0
    bool premultiplied = false;    ///< whether colours are stored multiplied by alpha / peak
    /// Along which axes the mesh is that of a torus or cylinder, cut open: copies of it, shifted by `width` or `height`, join it
    /// without a gap or an overlap, and each vertex of the cut has a copy of the same colour on the other side. The cut may be
    /// jagged: then faces stand out of the image's rectangle. See mesh/torus.hpp.
    Periodic periodic = Periodic::none;
    Samples samples = Samples::squares;  ///< where the image's samples stand in the plane

    /// The number of vertices.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size() / 2; }
    /// The number of faces.
    [[nodiscard]] std::size_t face_count() const noexcept { return faces.size(); }
    /// A view of the mesh, valid until its arrays change.
    [[nodiscard]] MeshView view() const noexcept {
        return {positions.data(), colors.data(), faces.data(),  vertex_count(), face_count(), channels, width,
                height,           peak,          premultiplied, periodic,       samples};
    }
};

/// Whether a mesh can be drawn and written: it has 1 to `most_channels` channels, finite numbers, a positive peak, and every
/// index in range. It need not cover its image, and may have no vertices and no faces at all, as a sprite of nothing has, but
/// not one of the two. Otherwise invalid_argument or not_finite. O(vertices + faces).
[[nodiscard]] inline Status check(const MeshView& mesh, int most_channels) noexcept {
    const bool is_empty = mesh.vertex_count == 0 && mesh.face_count == 0;
    if (mesh.vertex_count == 0 && !is_empty) return {Errc::invalid_argument, "the mesh has no vertices", 0, 1};
    if (mesh.face_count == 0 && !is_empty) return {Errc::invalid_argument, "the mesh has no faces", 0, 1};
    if (!is_empty && (mesh.positions == nullptr || mesh.colors == nullptr || mesh.faces == nullptr))
        return {Errc::invalid_argument, "the mesh has a null pointer for its positions, colours or faces"};
    if (mesh.channels < 1 || mesh.channels > most_channels)
        return {Errc::invalid_argument, "the mesh has a number of channels that this use cannot hold", mesh.channels,
                most_channels};
    if (!kit::is_finite(mesh.peak) || mesh.peak <= 0)
        return {Errc::invalid_argument, "the mesh's peak must be positive and finite"};
    for (std::size_t i = 0; i < 2 * mesh.vertex_count; ++i)
        if (!kit::is_finite(mesh.positions[i]))
            return {Errc::not_finite, "the mesh has a position that is NaN or infinite, at vertex",
                    static_cast<std::int64_t>(i / 2), 0};
    const auto channels = static_cast<std::size_t>(mesh.channels);
    for (std::size_t i = 0; i < channels * mesh.vertex_count; ++i)
        if (!kit::is_finite(mesh.colors[i]))
            return {Errc::not_finite, "the mesh has a colour that is NaN or infinite, at vertex",
                    static_cast<std::int64_t>(i / channels), 0};
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : mesh.faces[f])
            if (v >= mesh.vertex_count)
                return {Errc::invalid_argument, "the mesh has a face that names no vertex, at face", static_cast<std::int64_t>(f),
                        static_cast<std::int64_t>(mesh.vertex_count) - 1};
    return {};
}

/// The same of a mesh that owns its arrays, which must be of one number of vertices besides.
[[nodiscard]] inline Status check(const Mesh& mesh, int most_channels) noexcept {
    // First, since a view says that there is so much to read.
    if (mesh.positions.size() % 2 != 0 || mesh.channels < 0 ||
        mesh.colors.size() != static_cast<std::size_t>(mesh.channels) * mesh.vertex_count())
        return {Errc::invalid_argument, "the mesh's arrays are not of one number of vertices"};
    return check(mesh.view(), most_channels);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_MESH_HPP
