// tools - draws the edges of a mesh over a picture, with thin anti-aliased lines.
//
// The mesh is scaled to the picture's size. Lines are first collected as coverage, 8 bits a pixel, and blended once:
// edges shared by two faces and places where many edges meet come out no stronger than others.
#ifndef HMESH_TOOLS_WRITERS_WIREFRAME_HPP
#define HMESH_TOOLS_WRITERS_WIREFRAME_HPP

#include <array>
#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace tool {

struct WireframeOptions {
    std::array<std::uint8_t, 3> color = {255, 255, 255};
    double opacity = 0.6;  // in [0, 1]
    double width = 1;      // px of the picture
};

// How many times as large as an image of this size, in px, a picture is in which its mesh's edges are seen.
[[nodiscard]] constexpr int wireframe_scale(int width, int height) noexcept { return width <= 2048 && height <= 2048 ? 2 : 1; }

// Draws the edges over `picture`. A mesh that cannot be drawn gives a Status and leaves the picture as it was.
[[nodiscard]] hmesh::Status draw_wireframe(const hmesh::MeshView& mesh, hmesh::Image<std::uint8_t, 3>& picture,
                                           const WireframeOptions& options = {});

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_WIREFRAME_HPP
