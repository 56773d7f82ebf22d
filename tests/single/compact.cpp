// The single header of compact files is the first and only one here: it brings the other.
#include "../../single_include/hmesh_compact.hpp"

#include <vector>

bool compact_is_there();  // alone.cpp

bool compact_is_there() {
    hmesh::Mesh mesh;
    mesh.positions = {0, 0, 2, 0, 2, 1, 0, 1};
    mesh.colors = {1, 2, 3, 4};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    mesh.channels = 1;
    mesh.width = 2, mesh.height = 1, mesh.peak = 255;
    std::vector<unsigned char> file;
    if (!hmesh::write_compact(mesh.view(), hmesh::kit::append_to(file))) return false;
    const hmesh::CompactMesh back = hmesh::read_compact(file.data(), file.size());
    return back.status && back.mesh.colors == mesh.colors && back.mesh.faces == mesh.faces;
}
