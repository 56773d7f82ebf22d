/// \file
/// A binary glTF file (.glb) as what it is made of: nodes, meshes, materials, and arrays of numbers in one buffer.
///
/// The head and the JSON follow from the list of arrays, whose sizes are known before a number is written: so the JSON is written
/// twice, the first time to be counted, and the numbers go to the sink as they are made. Where arrays are compressed
/// (EXT_meshopt_compression) they are made and compressed first, one after another, and kept. Buffer 1 then stands for what they
/// are when they have been decompressed, and holds nothing.
///
/// Source: Khronos, glTF 2.0 specification, sections 3.6 and 4.4; EXT_meshopt_compression.
#ifndef HMESH_IO_DETAIL_GLB_FILE_HPP
#define HMESH_IO_DETAIL_GLB_FILE_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/sink.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// An array of numbers in a .glb file, to be compressed: the indices of a primitive, or all attributes of its vertices, one
/// vertex after another.
struct GltfArray {
    const unsigned char* bytes = nullptr;  ///< `count` elements of `stride` bytes
    std::size_t count = 0,                 ///< elements: vertices, or three indices a face
        stride = 0;                        ///< bytes of an element: 2 or 4 of an index, else a multiple of 4 up to 252
    bool is_indices = false;               ///< of faces, mode TRIANGLES of EXT_meshopt_compression; else mode ATTRIBUTES
};

/// A compressor that the program brings, since the library has none: it puts what EXT_meshopt_compression asks for into `out`,
/// which is empty, by meshoptimizer's meshopt_encodeVertexBuffer() of version 0 and meshopt_encodeIndexBuffer() of version 1. It
/// says whether it could; false or an empty `out` is a failure.
using GltfCompress = FunctionRef<bool(const GltfArray& array, std::vector<unsigned char>& out)>;

namespace detail {

/// What an element of an array is made of, with glTF's numbers for it.
enum class GlbNumber : std::uint16_t {
    i8 = 5120,   ///< 1 byte, with a sign
    u8 = 5121,   ///< 1 byte
    i16 = 5122,  ///< 2 bytes, with a sign
    u16 = 5123,  ///< 2 bytes
    u32 = 5125,  ///< 4 bytes
    f32 = 5126,  ///< 4 bytes, IEEE 754 binary32
};

/// The bytes of a number.
[[nodiscard]] constexpr std::uint32_t size_of(GlbNumber number) noexcept {
    switch (number) {
        case GlbNumber::i8:
        case GlbNumber::u8: return 1;
        case GlbNumber::i16:
        case GlbNumber::u16: return 2;
        case GlbNumber::u32:
        case GlbNumber::f32: break;
    }
    return 4;
}

/// An array of the buffer: an accessor and its buffer view. Of vertices, or of the indices of a primitive.
struct GlbArray {
    GlbNumber number = GlbNumber::f32;    ///< what an element is made of
    std::uint32_t components = 1;         ///< numbers of an element, 1 to 4
    bool is_normalized = false;           ///< integers stand for shares of the largest
    bool is_indices = false;              ///< of faces, three corners each
    bool has_bounds = false;              ///< of a VEC3
    std::array<double, 3> low{}, high{};  ///< its bounds
    std::uint64_t count = 0;              ///< elements

    /// Bytes from one element to the next: of vertices a multiple of 4.
    [[nodiscard]] std::uint64_t stride() const noexcept {
        const std::uint64_t size = std::uint64_t{size_of(number)} * components;
        return is_indices ? size : (size + 3) / 4 * 4;
    }
    /// All of its bytes.
    [[nodiscard]] std::uint64_t bytes() const noexcept { return stride() * count; }
};

/// Consecutive arrays of a file that are one buffer view.
struct GlbView {
    std::size_t first = 0, end = 0;  ///< the arrays [first, end)
    std::uint64_t stride = 0;        ///< bytes from one element to the next, of all of them
};

/// A vertex attribute of a primitive.
struct GlbAttribute {
    const char* name = "";    ///< "POSITION"; lives as long as the file
    std::uint32_t array = 0;  ///< which of the file's arrays
    int set = -1;             ///< the number after it, as of COLOR_0; below 0: none
    bool is_custom = false;   ///< of no meaning to glTF: written in capitals behind an underscore
};

/// Faces that are drawn with one material.
struct GlbPrimitive {
    kit::Array<GlbAttribute> attributes;  ///< all of one length
    std::uint32_t indices = 0,            ///< which of the file's arrays
        material = 0;                     ///< which of the file's materials
};

/// A node of the scene, which places a mesh in the plane.
struct GlbNode {
    std::array<double, 2> translation{};  ///< units
    double scale = 1;                     ///< units for one of the mesh
    std::uint32_t mesh = 0;               ///< which of the file's meshes
};

/// How faces are shaded.
struct GlbMaterial {
    bool is_lit = false;            ///< by lamps, as a rough surface; else the colours are what is seen
    bool blends = false;            ///< there is alpha
    const char* texture = nullptr;  ///< the path of an image to be shown by TEXCOORD_0; lives as long as the file
};

/// All of a file but the numbers of its arrays.
struct GlbFile {
    kit::Array<GlbNode> nodes;                      ///< of the scene
    std::vector<std::vector<GlbPrimitive>> meshes;  ///< the primitives of each
    kit::Array<GlbMaterial> materials;              ///< at least one
    kit::Array<GlbArray> arrays;                    ///< in the order of the buffer
    /// Of each node, where they are levels of detail of one thing, the finest first (MSFT_lod): down to which share of the
    /// screen, in [0, 1], it is drawn. Else empty: all nodes are drawn.
    kit::Array<double> coverages{};
    /// Of each buffer view, where they are compressed; else empty.
    std::vector<std::vector<unsigned char>> compressed{};
    bool is_quantized = false;     ///< arrays have numbers that KHR_mesh_quantization allows
    std::uint64_t json_bytes = 0;  ///< without padding

    /// A size with the padding that makes it a multiple of 4.
    [[nodiscard]] static std::uint64_t padded(std::uint64_t size) noexcept { return (size + 3) / 4 * 4; }
    /// The arrays as they are read, each from a multiple of 4 on, without padding behind the last.
    [[nodiscard]] std::uint64_t array_bytes() const noexcept {
        std::uint64_t sum = 0;
        for (const GlbArray& array : arrays) sum = padded(sum) + array.bytes();
        return sum;
    }
    /// All buffer views, in the order of the buffer. Where they are compressed, attributes of vertices are interleaved, as far as
    /// strides go in glTF: a stream of its own and the words about it take some 250 bytes.
    [[nodiscard]] kit::Array<GlbView> views(bool is_compressed) const {
        constexpr std::uint64_t longest = 252;
        kit::Array<GlbView> all;
        for (std::size_t i = 0; i < arrays.size(); ++i) {
            const GlbArray& array = arrays[i];
            const bool joins = is_compressed && !all.empty() && !array.is_indices && !arrays[i - 1].is_indices &&
                               array.count == arrays[i - 1].count && all.back().stride + array.stride() <= longest;
            if (!joins) all.push_back({i, i, 0});
            ++all.back().end;
            all.back().stride += array.stride();
        }
        return all;
    }
    /// The buffer that the file holds, without padding behind it.
    [[nodiscard]] std::uint64_t binary_bytes() const noexcept {
        if (compressed.empty()) return array_bytes();
        std::uint64_t sum = 0;
        for (const std::vector<unsigned char>& bytes : compressed) sum += padded(bytes.size());
        return sum;
    }
    /// All of the file.
    [[nodiscard]] std::uint64_t file_bytes() const noexcept { return 28 + padded(json_bytes) + padded(binary_bytes()); }
    /// Whether the first node stands for all, as levels of detail.
    [[nodiscard]] bool has_levels() const noexcept { return coverages.size() > 1; }
    /// Whether a material is not lit.
    [[nodiscard]] bool has_unlit() const noexcept {
        for (const GlbMaterial& material : materials)
            if (!material.is_lit) return true;
        return false;
    }
};

/// A word or a number of JSON.
class GlbWord {
  public:
    GlbWord(const char* words) noexcept : words_(words) {}          // NOLINT(google-explicit-constructor): part of a list
    GlbWord(std::uint64_t count) noexcept : count_(count) {}        // NOLINT(google-explicit-constructor)
    GlbWord(double real) noexcept : real_(real), is_real_(true) {}  // NOLINT(google-explicit-constructor)

    /// Puts it into a writer.
    void put(Writer& writer) const {
        if (words_ != nullptr) writer.text(words_);
        else if (is_real_) writer.real(real_);
        else writer.decimal(static_cast<std::int64_t>(count_));
    }

  private:
    const char* words_ = nullptr;
    std::uint64_t count_ = 0;
    double real_ = 0;
    bool is_real_ = false;
};

/// Words and numbers of JSON, one after the other.
class GlbJson {
  public:
    /// Puts them into a writer, which outlives this object.
    explicit GlbJson(Writer& writer) noexcept : writer_(&writer) {}

    /// Puts words and numbers.
    HMESH_COLD void put(std::initializer_list<GlbWord> words) {
        for (const GlbWord& word : words) word.put(*writer_);
    }
    /// Puts words.
    void put(const char* words) { writer_->text(words); }
    /// Puts a path as a URI: other bytes than letters, digits and -._~/ as % and two digits, and so no quotation mark.
    HMESH_COLD void uri(const char* path) {
        for (; *path != '\0'; ++path) {
            const char c = *path;
            const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                                  c == '.' || c == '_' || c == '~' || c == '/';
            const auto byte = static_cast<unsigned char>(c);
            const std::array<char, 3> digits = {'%', "0123456789ABCDEF"[byte >> 4U], "0123456789ABCDEF"[byte & 15U]};
            writer_->bytes(is_plain ? &c : digits.data(), is_plain ? 1 : 3);
        }
    }
    /// Puts two words, letters of the second as capitals.
    HMESH_COLD void capitals(const char* first, const char* word) {
        put(first);
        for (; *word != '\0'; ++word)
            writer_->u8(static_cast<std::uint8_t>(*word >= 'a' && *word <= 'z' ? *word - 'a' + 'A' : *word));
    }
    /// Puts "NAME":[ and what put_one puts for each of `count` entries, with commas between them, and ].
    HMESH_COLD void list(const char* name, std::size_t count, FunctionRef<void(std::size_t i)> put_one) {
        put({"\"", name, "\":["});
        for (std::size_t i = 0; i < count; ++i) {
            if (i > 0) put(",");
            put_one(i);
        }
        put("]");
    }

  private:
    Writer* writer_;
};

/// Writes the names of the extensions.
HMESH_COLD inline void write_glb_extensions(GlbJson& json, const GlbFile& file) {
    std::array<const char*, 4> names{};
    std::size_t used = 0;
    if (file.has_unlit()) names[used++] = "KHR_materials_unlit";
    if (file.has_levels()) names[used++] = "MSFT_lod";
    const std::size_t optional = used;
    if (file.is_quantized) names[used++] = "KHR_mesh_quantization";
    if (!file.compressed.empty()) names[used++] = "EXT_meshopt_compression";
    const auto write = [&](const char* list, std::size_t first) {
        if (first == used) return;
        json.list(list, used - first, [&](std::size_t i) { json.put({"\"", names[first + i], "\""}); });
        json.put(",");
    };
    write("extensionsUsed", 0);
    write("extensionsRequired", optional);
}

/// Writes a primitive.
HMESH_COLD inline void write_glb_primitive(GlbJson& json, const GlbPrimitive& primitive) {
    json.put("{\"attributes\":{");
    for (std::size_t i = 0; i < primitive.attributes.size(); ++i) {
        const GlbAttribute& attribute = primitive.attributes[i];
        json.put(i > 0 ? ",\"" : "\"");
        if (attribute.is_custom) json.capitals("_", attribute.name);
        else json.put(attribute.name);
        if (attribute.set >= 0) json.put({"_", static_cast<std::uint64_t>(attribute.set)});
        json.put({"\":", std::uint64_t{attribute.array}});
    }
    json.put({"},\"indices\":", std::uint64_t{primitive.indices}, ",\"material\":", std::uint64_t{primitive.material}, "}"});
}

/// Writes what a first node of levels of detail says of the others.
HMESH_COLD inline void write_glb_levels(GlbJson& json, const GlbFile& file) {
    json.put(",\"extensions\":{\"MSFT_lod\":{");
    json.list("ids", file.coverages.size() - 1, [&](std::size_t i) { json.put({std::uint64_t{i + 1}}); });
    json.put("}},\"extras\":{");
    json.list("MSFT_screencoverage", file.coverages.size(), [&](std::size_t i) { json.put({file.coverages[i]}); });
    json.put("}");
}

/// Writes materials, and the textures that they show: with linear filters, without mipmaps, clamped to the edge.
HMESH_COLD inline void write_glb_materials(GlbJson& json, const GlbFile& file) {
    kit::Array<const char*> textures;
    json.list("materials", file.materials.size(), [&](std::size_t i) {
        const GlbMaterial& material = file.materials[i];
        json.put("{\"pbrMetallicRoughness\":{");
        if (material.texture != nullptr) {
            json.put({"\"baseColorTexture\":{\"index\":", std::uint64_t{textures.size()}, "},"});
            textures.push_back(material.texture);
        }
        json.put({"\"metallicFactor\":0,\"roughnessFactor\":1}", material.blends ? ",\"alphaMode\":\"BLEND\"" : "",
                  material.is_lit ? "}" : ",\"extensions\":{\"KHR_materials_unlit\":{}}}"});
    });
    if (textures.empty()) return;
    json.put(",\"samplers\":[{\"magFilter\":9729,\"minFilter\":9729,\"wrapS\":33071,\"wrapT\":33071}],");
    json.list("textures", textures.size(), [&](std::size_t i) {
        json.put({"{\"sampler\":0,\"source\":", std::uint64_t{i}, "}"});
    });
    json.put(",");
    json.list("images", textures.size(), [&](std::size_t i) {
        json.put("{\"uri\":\"");
        json.uri(textures[i]);
        json.put("\"}");
    });
}

/// Writes scene, nodes and meshes.
HMESH_COLD inline void write_glb_scene(GlbJson& json, const GlbFile& file) {
    json.put("\"scene\":0,\"scenes\":[{");
    json.list("nodes", file.has_levels() ? 1 : file.nodes.size(), [&](std::size_t i) { json.put({std::uint64_t{i}}); });
    json.put("}],");
    json.list("nodes", file.nodes.size(), [&](std::size_t i) {
        const GlbNode& node = file.nodes[i];
        json.put({"{\"mesh\":", std::uint64_t{node.mesh}, ",\"translation\":[", node.translation[0], ",", node.translation[1],
                  ",0],\"scale\":[", node.scale, ",", node.scale, ",", node.scale, "]"});
        if (i == 0 && file.has_levels()) write_glb_levels(json, file);
        json.put("}");
    });
    json.put(",");
    json.list("meshes", file.meshes.size(), [&](std::size_t i) {
        const std::vector<GlbPrimitive>& primitives = file.meshes[i];
        json.put("{");
        json.list("primitives", primitives.size(), [&](std::size_t k) { write_glb_primitive(json, primitives[k]); });
        json.put("}");
    });
}

/// Writes accessors, buffer views and buffers.
HMESH_COLD inline void write_glb_arrays(GlbJson& json, const GlbFile& file) {
    constexpr std::array<const char*, 4> types{"SCALAR", "VEC2", "VEC3", "VEC4"};
    const bool is_compressed = !file.compressed.empty();
    const kit::Array<GlbView> views = file.views(is_compressed);
    std::uint64_t view = 0, offset = 0, place = 0;
    json.list("accessors", file.arrays.size(), [&](std::size_t i) {
        const GlbArray& array = file.arrays[i];
        if (i == views[static_cast<std::size_t>(view)].end) ++view, offset = 0;
        json.put({"{\"bufferView\":", view});
        if (offset > 0) json.put({",\"byteOffset\":", offset});
        offset += array.stride();
        json.put({",\"componentType\":", static_cast<std::uint64_t>(array.number),
                  array.is_normalized ? ",\"normalized\":true" : "", ",\"count\":", array.count, ",\"type\":\"",
                  types[array.components - 1], "\""});
        if (array.has_bounds)
            json.put({",\"min\":[", array.low[0], ",", array.low[1], ",", array.low[2], "],\"max\":[", array.high[0], ",",
                      array.high[1], ",", array.high[2], "]"});
        json.put("}");
    });
    json.put(",");
    offset = 0;
    json.list("bufferViews", views.size(), [&](std::size_t i) {
        const GlbArray& array = file.arrays[views[i].first];
        const std::uint64_t stride = views[i].stride, bytes = stride * array.count;
        json.put(is_compressed ? "{\"buffer\":1" : "{\"buffer\":0");
        if (offset > 0) json.put({",\"byteOffset\":", offset});
        json.put({",\"byteLength\":", bytes});
        if (!array.is_indices) json.put({",\"byteStride\":", stride});
        json.put(array.is_indices ? ",\"target\":34963" : ",\"target\":34962");  // ELEMENT_ARRAY_BUFFER and ARRAY_BUFFER
        offset += GlbFile::padded(bytes);
        if (is_compressed) {
            const std::uint64_t size = file.compressed[i].size();
            json.put({",\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":", place,
                      ",\"byteLength\":", size, ",\"byteStride\":", stride, ",\"count\":", array.count,
                      array.is_indices ? ",\"mode\":\"TRIANGLES\"}}" : ",\"mode\":\"ATTRIBUTES\"}}"});
            place += GlbFile::padded(size);
        }
        json.put("}");
    });
    json.put({",\"buffers\":[{\"byteLength\":", file.binary_bytes(), "}"});
    if (is_compressed)
        json.put({",{\"byteLength\":", file.array_bytes(), ",\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}}"});
    json.put("]");
}

/// Writes the JSON chunk without padding.
HMESH_COLD inline void write_glb_json(Writer& writer, const GlbFile& file) {
    GlbJson json(writer);
    json.put("{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING "\"},");
    write_glb_extensions(json, file);
    write_glb_scene(json, file);
    json.put(",");
    write_glb_materials(json, file);
    json.put(",");
    write_glb_arrays(json, file);
    json.put("}");
}

/// Refuses a file of 4 GiB or more.
[[nodiscard]] inline Status check_glb_size(const GlbFile& file) noexcept {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (file.file_bytes() <= most) return {};
    return {Errc::invalid_argument, "the mesh needs more bytes than the head of a .glb file counts",
            static_cast<std::int64_t>(file.file_bytes()), static_cast<std::int64_t>(most)};
}

/// Fills a chunk of this size up to a multiple of 4.
inline void pad(Writer& writer, std::uint64_t size, char with) {
    for (; size % 4 != 0; ++size) writer.u8(static_cast<std::uint8_t>(with));
}

/// Puts the elements of an array, each filled up to its stride.
using FillGlbArray = FunctionRef<void(Writer& writer, std::size_t array)>;

/// Makes all arrays and compresses them, view by view. Errc::write_failed where that fails.
[[nodiscard]] HMESH_COLD inline Status compress_arrays(GlbFile& file, FillGlbArray fill, GltfCompress compress) {
    std::vector<unsigned char> bytes, woven;
    const auto keep = kit::append_to(bytes);
    for (const GlbView& view : file.views(true)) {
        const GlbArray& head = file.arrays[view.first];
        const auto count = static_cast<std::size_t>(head.count), stride = static_cast<std::size_t>(view.stride);
        woven.resize(count * stride);
        std::size_t offset = 0;
        for (std::size_t i = view.first; i < view.end; ++i) {
            bytes.clear();
            bytes.reserve(static_cast<std::size_t>(file.arrays[i].bytes()));
            Writer writer(keep);
            fill(writer, i);
            if (const Status status = writer.finish(); !status) return status;
            const auto size = static_cast<std::size_t>(file.arrays[i].stride());
            for (std::size_t k = 0; k < count; ++k)
                std::copy_n(bytes.data() + k * size, size, woven.data() + k * stride + offset);
            offset += size;
        }
        std::vector<unsigned char>& out = file.compressed.emplace_back();
        if (!compress({woven.data(), count, stride, head.is_indices}, out) || out.empty())
            return {Errc::write_failed, "the compressor failed, before the first byte was written"};
    }
    return {};
}

/// Counts the JSON and refuses a file of 4 GiB or more.
[[nodiscard]] HMESH_COLD inline Status count_glb_json(GlbFile& file) {
    const auto nowhere = [](const void*, std::size_t) { return true; };
    Writer counter(nowhere);
    write_glb_json(counter, file);
    file.json_bytes = static_cast<std::uint64_t>(counter.position());
    return check_glb_size(file);
}

/// Writes the whole file, whose JSON has been counted.
HMESH_COLD inline Status write_glb_file(const GlbFile& file, Sink sink, FillGlbArray fill) {
    Writer writer(sink);
    writer.text("glTF");
    writer.u32(2);
    writer.u32(static_cast<std::uint32_t>(file.file_bytes()));
    writer.u32(static_cast<std::uint32_t>(GlbFile::padded(file.json_bytes)));
    writer.text("JSON");
    write_glb_json(writer, file);
    pad(writer, file.json_bytes, ' ');
    writer.u32(static_cast<std::uint32_t>(GlbFile::padded(file.binary_bytes())));
    writer.bytes("BIN", 4);  // with its zero
    for (const std::vector<unsigned char>& bytes : file.compressed) {
        writer.bytes(bytes.data(), bytes.size());
        pad(writer, bytes.size(), '\0');
    }
    for (std::size_t i = 0; i < file.arrays.size() && file.compressed.empty(); ++i) {
        fill(writer, i);
        pad(writer, file.arrays[i].bytes(), '\0');
    }
    return writer.finish();
}

/// Writes the file of a mesh without vertices: an array has at least one element, so there is no mesh but an empty scene.
HMESH_COLD inline Status write_empty_glb(Sink sink) {
    static constexpr char json[] =
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING "\"},\"scene\":0,\"scenes\":[{}]}";
    constexpr std::uint32_t size = sizeof json - 1;
    const auto padded = static_cast<std::uint32_t>(GlbFile::padded(size));
    Writer writer(sink);
    writer.text("glTF");
    writer.u32(2);
    writer.u32(20 + padded);
    writer.u32(padded);
    writer.text("JSON");
    writer.text(json);
    pad(writer, size, ' ');
    return writer.finish();
}

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_GLB_FILE_HPP
