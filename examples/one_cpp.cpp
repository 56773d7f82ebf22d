// one_cpp - keeps Eigen, and 1.4 s of compile time a file, out of the rest of a code base.
//
// mesh_image.hpp is included in ONE .cpp, which defines one plain function. Its declaration needs image_view.hpp and
// mesh_view.hpp only; everybody else includes that declaration. Here the three files of such a code base stand one
// after another.

// ---- picture_mesh.hpp: what the code base includes ------------------------------------------------------------------
#include <cstddef>
#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"

// Meshes the picture with this many vertices. When the status says no, the mesh that is left is the last valid one, or
// empty.
[[nodiscard]] hmesh::Mesh<3> mesh_picture(const hmesh::ImageView<std::uint8_t, 3>& picture, std::int64_t vertices,
                                          hmesh::Status& status);

// ---- game.cpp: any of the files that use it; no Eigen so far --------------------------------------------------------
#ifdef EIGEN_CORE_H
#error "image_view.hpp and mesh_view.hpp must not include Eigen"
#endif
#include <cstdio>

int main() {
    hmesh::Image<std::uint8_t, 3> picture(256, 256);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 256; ++x) {
            std::uint8_t* pixel = picture.pixel(x, y);
            pixel[0] = static_cast<std::uint8_t>(x);
            pixel[1] = static_cast<std::uint8_t>(y);
            pixel[2] = (x - 128) * (x - 128) + (y - 128) * (y - 128) < 6400 ? 230 : 40;
        }
    hmesh::Status status;
    const hmesh::Mesh<3> mesh = mesh_picture(picture.view(), 300, status);
    if (!status) {
        std::fprintf(stderr, "one_cpp: %s\n", status.what);
        return 1;
    }
    std::printf("%zu vertices, %zu faces\n", mesh.vertex_count(), mesh.face_count());
    return 0;
}

// ---- picture_mesh.cpp: the one file that compiles Eigen -------------------------------------------------------------
#include <utility>

#include "hmesh/mesh_image.hpp"

hmesh::Mesh<3> mesh_picture(const hmesh::ImageView<std::uint8_t, 3>& picture, std::int64_t vertices, hmesh::Status& status) {
    hmesh::Options options;
    options.target = hmesh::Target::vertices(vertices);
    hmesh::Result<3> result = hmesh::mesh_image(picture, options);
    status = result.status;
    return std::move(result.mesh);
}
