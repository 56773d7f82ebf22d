// The single header is the first and only header of hmesh here: it brings all that it needs, and it works. mesh_image() is called
// with it in tests/package.
#include "../../single_include/hmesh.hpp"

#include <cstddef>
#include <cstring>
#include <string>

bool paper_is_there();                                 // paper.cpp
bool gpu_is_there();                                   // gpu.cpp
bool lods_are_there();                                 // lods.cpp
bool terrain_is_there();                               // terrain.cpp
bool large_is_there();                                 // large.cpp
std::size_t size_as_svg(const hmesh::MeshView& mesh);  // both.cpp

int main() {
    hmesh::Mesh mesh;
    mesh.positions = {0, 0, 24, 0, 24, 16, 0, 16};
    mesh.colors = {40, 200, 200, 40};
    mesh.faces = {{0, 1, 3}, {1, 2, 3}};
    mesh.channels = 1;
    mesh.width = 24, mesh.height = 16, mesh.peak = 255;
    if (!hmesh::render<1>(mesh.view()).status) return 1;

    std::string ply;
    const auto sink = [&ply](const void* bytes, std::size_t size) {
        ply.append(static_cast<const char*>(bytes), size);
        return true;
    };
    if (!hmesh::write_ply(mesh.view(), sink)) return 2;
    if (std::strncmp(ply.c_str(), "ply\n", 4) != 0 || ply.find("element vertex 4\n") == std::string::npos) return 3;
    if (size_as_svg(mesh.view()) == 0) return 4;
    if (!gpu_is_there()) return 6;
    if (!lods_are_there()) return 7;
    if (!terrain_is_there()) return 8;
    if (!large_is_there()) return 9;
    return paper_is_there() ? 0 : 5;
}
