// What a project that has just found hmesh might write first: it meets all headers and, but WITHOUT_PAPER, Eigen behind them.
//
// usage: consumer VERSION        exit status 1: hmesh is of another version, or does not work
#include <hmesh/hmesh.hpp>
#ifndef WITHOUT_PAPER
#include <hmesh/paper.hpp>
#endif

#include <cstddef>
#include <cstdio>
#include <cstring>
#include <numeric>

int main(int argc, char** argv) {
    hmesh::Mesh mesh;  // a square that is dark at the left and bright at the right
    mesh.positions = {0, 0, 8, 0, 8, 8, 0, 8};
    mesh.colors = {0, 255, 255, 0};
    mesh.faces = {{0, 1, 3}, {1, 2, 3}};
    mesh.channels = 1;
    mesh.width = mesh.height = 8;
    mesh.peak = 255;

    std::size_t bytes = 0;
    const auto sink = [&](const void*, std::size_t size) { return bytes += size, true; };
    const auto [picture, status] = hmesh::render<1>(mesh.view());
    if (!status || !hmesh::write_ply(mesh.view(), sink)) return 1;
#ifndef WITHOUT_PAPER
    const float mean = Eigen::Map<const Eigen::ArrayXf>(picture.data(), 64).mean();
#else
    const float mean = std::accumulate(picture.data(), picture.data() + 64, 0.0F) / 64;
#endif
    std::printf("hmesh %s: a PLY file of %zu bytes, the mean of its picture is %.1f\n", HMESH_VERSION_STRING, bytes,
                static_cast<double>(mean));
    return argc == 2 && std::strcmp(argv[1], HMESH_VERSION_STRING) == 0 && bytes > 0 && mean == 127.5F ? 0 : 1;
}
