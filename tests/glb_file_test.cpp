#include "hmesh/io/detail/glb_file.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh::detail::GlbArray;
using hmesh::detail::GlbFile;
using hmesh::detail::GlbNumber;

// `count` elements of this kind; of indices three a face.
GlbArray array_of(GlbNumber number, std::uint32_t components, std::uint64_t count, bool is_indices = false) {
    GlbArray array;
    array.number = number;
    array.components = components;
    array.count = count;
    array.is_indices = is_indices;
    return array;
}

}  // namespace

TEST_CASE("several meshes, primitives and materials are one file, whose arrays begin at multiples of 4") {
    GlbFile file;
    file.arrays = {array_of(GlbNumber::f32, 3, 4), array_of(GlbNumber::u16, 1, 3, true),
                   array_of(GlbNumber::u16, 3, 3), array_of(GlbNumber::u16, 1, 9, true),
                   array_of(GlbNumber::u8, 1, 5),  array_of(GlbNumber::u32, 1, 3, true)};
    file.meshes = {{{{{"POSITION", 0}}, 1, 0}, {{{"POSITION", 0}}, 3, 1}}, {{{{"POSITION", 2}, {"rough", 4, -1, true}}, 5, 0}}};
    file.materials = {{false, false}, {true, true}};
    file.nodes = {{{0, 0}, 1, 0}, {{2, 0}, 0.5, 1}};
    REQUIRE(count_glb_json(file));
    hmesh_test::Bytes bytes;
    const auto fill = [&](hmesh::detail::Writer& writer, std::size_t i) {
        for (std::uint64_t k = 0; k < file.arrays[i].bytes(); ++k) writer.u8(static_cast<std::uint8_t>(i + 1));
    };
    REQUIRE(write_glb_file(file, hmesh::kit::append_to(bytes), fill));
    REQUIRE(bytes.size() == file.file_bytes());
    const std::string text = hmesh_test::as_text(bytes);
    for (const char* part :
         {"\"extensionsUsed\":[\"KHR_materials_unlit\"],\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}]",
          "\"nodes\":[{\"mesh\":0,\"translation\":[0,0,0],\"scale\":[1,1,1]},"
          "{\"mesh\":1,\"translation\":[2,0,0],\"scale\":[0.5,0.5,0.5]}]",
          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0},"
          "{\"attributes\":{\"POSITION\":0},\"indices\":3,\"material\":1}]},"
          "{\"primitives\":[{\"attributes\":{\"POSITION\":2,\"_ROUGH\":4},\"indices\":5,\"material\":0}]}]",
          "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":1},\"alphaMode\":\"BLEND\"}]",
          "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48,\"byteStride\":12,\"target\":34962},"
          "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6,\"target\":34963},"
          "{\"buffer\":0,\"byteOffset\":56,\"byteLength\":24,\"byteStride\":8,\"target\":34962},"
          "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":18,\"target\":34963},"
          "{\"buffer\":0,\"byteOffset\":100,\"byteLength\":20,\"byteStride\":4,\"target\":34962},"
          "{\"buffer\":0,\"byteOffset\":120,\"byteLength\":12,\"target\":34963}],\"buffers\":[{\"byteLength\":132}]"}) {
        CAPTURE(part);
        CHECK(text.find(part) != std::string::npos);
    }
    const std::size_t at = bytes.size() - 132;
    CHECK(bytes[at - 2] == 'N');
    std::array<std::size_t, 7> counts{};
    for (std::size_t i = at; i < bytes.size(); ++i) ++counts.at(bytes[i]);
    CHECK(counts == std::array<std::size_t, 7>{4, 48, 6, 24, 18, 20, 12});
    CHECK(bytes[at + 56] == 3);
    CHECK(bytes[at + 100] == 5);
}

TEST_CASE("views interleave attributes where they are compressed, up to the longest stride of glTF") {
    GlbFile file;
    for (int i = 0; i < 70; ++i) file.arrays.push_back(array_of(GlbNumber::u8, 4, i < 65 ? 7 : 8));
    file.arrays.push_back(array_of(GlbNumber::u16, 1, 8, true));
    file.arrays.push_back(array_of(GlbNumber::f32, 3, 8));
    CHECK(file.views(false).size() == 72);
    const auto views = file.views(true);
    REQUIRE(views.size() == 5);
    const std::array<std::array<std::size_t, 3>, 5> wanted{{{0, 63, 252}, {63, 65, 8}, {65, 70, 20}, {70, 71, 2}, {71, 72, 12}}};
    for (std::size_t i = 0; i < 5; ++i)
        CHECK(std::array<std::size_t, 3>{views[i].first, views[i].end, static_cast<std::size_t>(views[i].stride)} == wanted[i]);
}
