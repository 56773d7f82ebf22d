// quantized-mesh 1.0 (Cesium): a head of 88 bytes; u, v and height of 15 bits as zig-zag differences; indices by their high
// watermark, of 16 bits up to 65536 vertices.
#include <cstring>

#include "terrain/written/surface.hpp"

namespace terrain {

std::string read_quantized_mesh(tool::Bytes file, Model& model) {
    const auto f32 = [&](std::size_t at) {
        const std::uint32_t word = file.le32(at);
        float value = 0;
        std::memcpy(&value, &word, 4);
        return static_cast<double>(value);
    };
    const double low = f32(24), high = f32(28);
    const std::size_t vertices = file.le32(88);
    std::size_t at = 92;
    if (!file.has(at, 6 * vertices)) return "it is too short";
    model.vertices.resize(vertices);
    for (std::size_t k = 0; k < 3; ++k) {
        int value = 0;
        for (std::size_t v = 0; v < vertices; ++v, at += 2) {
            const auto word = static_cast<int>(file.le16(at));
            value += (word >> 1) ^ -(word & 1);
            const double share = value / 32767.0;
            model.vertices[v][k] = k < 2 ? share : low + (high - low) * share;
        }
    }
    const bool is_wide = vertices > 65536;
    const std::size_t size = is_wide ? 4 : 2;
    while (at % size != 0) ++at;
    const std::size_t faces = file.le32(at);
    at += 4;
    if (!file.has(at, 3 * faces * size)) return "it is too short";
    std::uint32_t highest = 0;
    for (std::size_t f = 0; f < faces; ++f) {
        std::array<std::uint32_t, 3> face{};
        for (std::uint32_t& corner : face) {
            const std::uint32_t code = is_wide ? file.le32(at) : file.le16(at);
            at += size;
            corner = highest - code;
            if (code == 0) ++highest;
        }
        model.faces.push_back(face);
    }
    for (int side = 0; side < 4; ++side) at += 4 + file.le32(at) * size;
    constexpr std::uint32_t normals = 1;  // extensions: a number, so many bytes, these
    for (; file.has(at, 5); at += 5 + file.le32(at + 1)) {
        if (file.u8(at) != normals) continue;
        if (!file.has(at + 5, 2 * vertices)) return "its normals are too few";
        for (std::size_t v = 0; v < vertices; ++v)
            model.normals.push_back(
                {static_cast<double>(file.u8(at + 5 + 2 * v)), static_cast<double>(file.u8(at + 6 + 2 * v)), 0});
    }
    return {};
}

}  // namespace terrain
