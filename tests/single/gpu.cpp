// The single header of buffers for GPUs is the first and only one here: it brings the other.
#include "../../single_include/hmesh_gpu.hpp"

bool gpu_is_there();  // alone.cpp

bool gpu_is_there() {
    hmesh::Mesh mesh;
    mesh.positions = {0, 0, 2, 0, 2, 1, 0, 1};
    mesh.colors = {1, 2, 3, 4};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    mesh.channels = 1;
    mesh.width = 2, mesh.height = 1, mesh.peak = 255;
    return hmesh::pack_for_gpu(mesh.view()).vertices.size() == 32;
}
