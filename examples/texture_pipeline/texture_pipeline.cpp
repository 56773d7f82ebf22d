// texture_pipeline - what a game does with the meshes that its build has made: it loads them and is ready to draw.
//
// usage: texture_pipeline FILE.ply...
//
// The binary PLY files of hmesh hold what a GPU wants: the vertices, 15 bytes each (x, y, z as floats, then red, green and
// blue) or with alpha 16, are a vertex buffer as they are; of each face's 13 bytes the last 12 are its indices.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

struct MeshBuffers {
    std::size_t stride = 0;               // bytes of a vertex: 15, or 16 with alpha
    std::vector<unsigned char> vertices;  // as the file has them
    std::vector<std::uint32_t> indices;   // 3 a face
};

// The number behind `words` in the header, or 0.
std::size_t count_of(const std::string& header, const std::string& words) {
    const std::size_t at = header.find(words);
    return at == std::string::npos ? 0 : std::strtoul(header.c_str() + at + words.size(), nullptr, 10);
}

bool load(const std::string& path, MeshBuffers& mesh) {
    std::ifstream stream(path, std::ios::binary);
    const std::string file{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    static constexpr char end[] = "end_header\n";
    const std::size_t header_size = file.find(end) + sizeof end - 1;
    if (header_size < sizeof end) return false;
    const std::string header = file.substr(0, header_size);
    const std::size_t vertices = count_of(header, "element vertex "), faces = count_of(header, "element face ");
    mesh.stride = header.find("property uchar alpha\n") == std::string::npos ? 15 : 16;
    if (file.size() != header_size + mesh.stride * vertices + 13 * faces) return false;

    const char* at = file.data() + header_size;
    mesh.vertices.assign(at, at + mesh.stride * vertices);
    mesh.indices.resize(3 * faces);
    at += mesh.stride * vertices;
    for (std::size_t f = 0; f < faces; ++f) std::memcpy(&mesh.indices[3 * f], at + 13 * f + 1, 12);
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    std::printf("%10s %10s %14s  %s\n", "vertices", "faces", "bytes to draw", "mesh");
    for (int i = 1; i < argc; ++i) {
        MeshBuffers mesh;
        if (!load(argv[i], mesh)) {
            std::fprintf(stderr, "texture_pipeline: '%s' is not a mesh of three or four channels\n", argv[i]);
            return 1;
        }
        std::printf("%10zu %10zu %14zu  %s\n", mesh.vertices.size() / mesh.stride, mesh.indices.size() / 3,
                    mesh.vertices.size() + 4 * mesh.indices.size(), argv[i]);
    }
    return 0;
}
