// glTF 2.0, binary: the positions, normals and indices of one mesh, y up: its first primitive. What follows hangs from its sides.
#include <nlohmann/json.hpp>

#include <cstring>

#include "terrain/written/surface.hpp"

namespace terrain {
namespace {

using Json = nlohmann::json;

// The bytes of an accessor, from its first number on.
tool::Bytes bytes_of(const Json& json, const Json& accessor, tool::Bytes buffer) {
    const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    return buffer.part(view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0}),
                       view["byteLength"].get<std::size_t>());
}

// Three floats with y up, as three with z up.
std::array<double, 3> upright(tool::Bytes numbers, std::size_t v) {
    float at[3] = {};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t word = numbers.le32(12 * v + 4 * k);
        std::memcpy(&at[k], &word, 4);
    }
    return {static_cast<double>(at[0]), 0 - static_cast<double>(at[2]), static_cast<double>(at[1])};
}

}  // namespace

std::string read_glb(tool::Bytes file, Model& model) {
    if (!file.says(0, "glTF") || !file.says(16, "JSON")) return "it is no .glb file";
    const tool::Bytes text = file.part(20, file.le32(12));
    const Json json = Json::parse(text.data, text.data + text.size, nullptr, false);
    if (json.is_discarded() || json["meshes"].size() != 1) return "its JSON has not one mesh";
    const tool::Bytes buffer = file.part(20 + text.size + 8);
    for (const Json& primitive : json["meshes"][0]["primitives"]) {
        const Json& places = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
        const Json& indices = json["accessors"][primitive["indices"].get<std::size_t>()];
        const auto vertices = places["count"].get<std::size_t>(), corners = indices["count"].get<std::size_t>();
        const tool::Bytes numbers = bytes_of(json, places, buffer), names = bytes_of(json, indices, buffer);
        const int kind = indices["componentType"].get<int>();
        const std::size_t size = kind == 5121 ? 1 : kind == 5123 ? 2 : 4;
        if (places["componentType"] != 5126 || !numbers.has(0, 12 * vertices) || !names.has(0, size * corners))
            return "its positions are no floats, or too few";
        if (!model.vertices.empty()) {
            for (std::size_t v = 0; v < vertices; ++v) model.skirt.push_back(upright(numbers, v));
            continue;
        }
        for (std::size_t v = 0; v < vertices; ++v) model.vertices.push_back(upright(numbers, v));
        if (primitive["attributes"].contains("NORMAL")) {
            const Json& normals = json["accessors"][primitive["attributes"]["NORMAL"].get<std::size_t>()];
            const tool::Bytes directions = bytes_of(json, normals, buffer);
            if (normals["count"] != vertices || !directions.has(0, 12 * vertices)) return "its normals are too few";
            for (std::size_t v = 0; v < vertices; ++v) model.normals.push_back(upright(directions, v));
        }
        const auto corner = [&](std::size_t k) {
            return size == 1 ? names.u8(k) : size == 2 ? names.le16(2 * k) : names.le32(4 * k);
        };
        for (std::size_t k = 0; k + 2 < corners; k += 3) model.faces.push_back({corner(k), corner(k + 1), corner(k + 2)});
    }
    return {};
}

}  // namespace terrain
