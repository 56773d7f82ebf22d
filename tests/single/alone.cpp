// The single header is the first and only header of hmesh here: it brings all that it needs, and it works.
#include "../../single_include/hmesh.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

bool paper_is_there();                                 // paper.cpp
std::size_t size_as_svg(const hmesh::MeshView& mesh);  // both.cpp

int main() {
    std::uint8_t pixels[24 * 16];
    for (int i = 0; i < 24 * 16; ++i) pixels[i] = i % 24 < 9 ? 40 : 200;

    hmesh::Options options;
    options.target = hmesh::Target::vertices(20);
    const hmesh::Result result = hmesh::mesh_image(hmesh::ImageView<std::uint8_t, 1>{pixels, 24, 16}, options);
    if (!result.status || result.report.vertices != 20) return 1;

    std::string ply;
    const auto sink = [&ply](const void* bytes, std::size_t size) {
        ply.append(static_cast<const char*>(bytes), size);
        return true;
    };
    if (!hmesh::write_ply(result.mesh.view(), sink)) return 2;
    if (std::strncmp(ply.c_str(), "ply\n", 4) != 0 || ply.find("element vertex 20\n") == std::string::npos) return 3;
    if (size_as_svg(result.mesh.view()) == 0) return 4;
    return paper_is_there() ? 0 : 5;
}
