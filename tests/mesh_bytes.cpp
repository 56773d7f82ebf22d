// Prints a number for the bytes of an image and of its meshes, to compare compilers and flags with: scripts/matrix.sh. What is
// promised is the same bytes from one program; between programs only the image's are.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "test_images.hpp"
#include "test_meshing.hpp"

namespace {

// FNV-1a of 64 bits.
template <class Values>
void add(std::uint64_t& hash, const Values& values) {
    for (const auto& value : values) {
        unsigned char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3U;
    }
}

}  // namespace

int main() {
    constexpr std::uint64_t seed = 0xcbf29ce484222325U;
    const auto image = hmesh_test::scene<std::uint8_t, 3>(80, 70, 1);
    std::uint64_t hash = seed;
    add(hash, image.samples());
    const auto print = [&hash](const char* what) {
        std::printf("%s %08lx", what, static_cast<unsigned long>(hash >> 32U & 0xffffffffU));
    };
    print("mesh bytes: image");
    for (const auto& [name, effort] : {std::pair("draft", hmesh::Effort::draft), std::pair("fast", hmesh::Effort::fast),
                                       std::pair("normal", hmesh::Effort::normal)}) {
        hmesh::Options options;
        options.target = hmesh::Target::vertices(420);
        options.effort = effort;
        const auto result = hmesh::mesh_image(image.view(), options);
        if (!result.status || result.mesh.vertex_count() != 420) return 1;
        hash = seed;
        add(hash, result.mesh.positions);
        add(hash, result.mesh.colors);
        add(hash, result.mesh.faces);
        std::printf(", ");
        print(name);
        std::printf(" (%.3f dB)", result.report.psnr);
    }
    std::printf("\n");
    return 0;
}
