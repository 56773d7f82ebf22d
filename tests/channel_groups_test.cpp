#include "hmesh/io/channel_groups.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/gltf_lods.hpp"
#include "hmesh/io/ply.hpp"
#include "test_exports.hpp"

namespace {

using hmesh::ChannelGroup;
using hmesh::ChannelGroups;
using hmesh_test::Bytes;
using hmesh_test::number_at;

// Albedo with alpha, normal, roughness, two numbers, a second colour: 13 channels.
constexpr std::array<ChannelGroup, 5> material = {{{"albedo", ChannelGroup::Meaning::color, 4},
                                                   {"normal", ChannelGroup::Meaning::normal, 3},
                                                   {"rough", ChannelGroup::Meaning::data, 1},
                                                   {"Flow", ChannelGroup::Meaning::data, 2},
                                                   {"glow", ChannelGroup::Meaning::color, 3}}};

template <std::size_t n>
ChannelGroups view(const std::array<ChannelGroup, n>& groups) {
    return {groups.data(), n};
}

// Two faces, and channels of any values, of which some are beyond the range.
hmesh::Mesh random_mesh(int channels) {
    hmesh::Mesh mesh = hmesh_test::two_faces(channels);
    hmesh::kit::Random random(7);
    for (float& value : mesh.colors) value = static_cast<float>(random.uniform() * 270 - 7);
    return mesh;
}

double share(const hmesh::Mesh& mesh, std::size_t v, std::size_t channel) {
    const auto value = static_cast<double>(mesh.colors[static_cast<std::size_t>(mesh.channels) * v + channel]) / mesh.peak;
    return std::fmax(0, std::fmin(1, value));
}

std::array<double, 3> normal(const hmesh::Mesh& mesh, std::size_t v, std::size_t channel) {
    const double x = 2 * share(mesh, v, channel) - 1, y = 2 * share(mesh, v, channel + 1) - 1,
                 z = 2 * share(mesh, v, channel + 2) - 1, length = std::hypot(x, y, z);
    return {x / length, y / length, z / length};
}

// Attributes of a .glb, by the glTF specification alone.
class GlbAttributes {
  public:
    explicit GlbAttributes(const Bytes& bytes) : bytes_(bytes) {
        const std::size_t size = number_at<std::uint32_t>(bytes, 12);
        json.assign(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(size));
        buffer_ = 28 + size;
    }
    // The numbers of an attribute, `components` a vertex; integers as shares.
    [[nodiscard]] std::vector<double> values(const std::string& name) const {
        const std::string key = "\"" + name + "\":";
        const std::size_t at = json.find(key);
        REQUIRE(at != std::string::npos);
        const std::size_t accessor = std::stoul(json.substr(at + key.size()));
        const std::string entry = entry_of("accessors", accessor), view = entry_of("bufferViews", integer(entry, "bufferView"));
        const std::size_t type = integer(entry, "componentType"), count = integer(entry, "count");
        const std::size_t kind = entry.find("\"type\":\""), stride = integer(view, "byteStride");
        const std::size_t components = entry[kind + 8] == 'S' ? 1 : static_cast<std::size_t>(entry[kind + 11] - '0');
        CHECK(stride % 4 == 0);
        CHECK(integer(view, "byteOffset") % 4 == 0);
        CHECK((entry.find("\"normalized\":true") != std::string::npos) == (type != 5126));
        std::vector<double> out;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < components; ++k) {
                const std::size_t from = buffer_ + integer(view, "byteOffset") + i * stride;
                switch (type) {
                    case 5120: out.push_back(number_at<std::int8_t>(bytes_, from + k) / 127.0); break;
                    case 5121: out.push_back(number_at<std::uint8_t>(bytes_, from + k) / 255.0); break;
                    case 5122: out.push_back(number_at<std::int16_t>(bytes_, from + 2 * k) / 32767.0); break;
                    case 5123: out.push_back(number_at<std::uint16_t>(bytes_, from + 2 * k) / 65535.0); break;
                    case 5126: out.push_back(static_cast<double>(number_at<float>(bytes_, from + 4 * k))); break;
                    default: FAIL("an attribute of an unknown type");
                }
            }
        return out;
    }

    std::string json;

  private:
    static std::size_t integer(const std::string& entry, const std::string& key) {
        const std::size_t at = entry.find("\"" + key + "\":");
        return at == std::string::npos ? 0 : std::stoul(entry.substr(at + key.size() + 3));
    }
    // The n-th object of a list; objects in it are passed over.
    [[nodiscard]] std::string entry_of(const std::string& list, std::size_t n) const {
        std::size_t at = json.find("\"" + list + "\":[") + list.size() + 4;
        for (;;) {
            const std::size_t begin = at;
            int depth = 0;
            do depth += json[at] == '{' ? 1 : json[at] == '}' ? -1 : 0;
            while (depth > 0 && ++at < json.size());
            if (n-- == 0) return json.substr(begin, at + 1 - begin);
            at += 2;  // a comma
        }
    }

    const Bytes& bytes_;
    std::size_t buffer_ = 0;
};

Bytes written(const hmesh::Mesh& mesh, const hmesh::GltfOptions& options) {
    return hmesh_test::exported(
        mesh.view(), [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_glb(view, sink, options); });
}

}  // namespace

TEST_CASE("groups of channels become attributes of glTF, as many bits as they are given") {
    const hmesh::Mesh mesh = random_mesh(16);  // three channels are left out
    for (const bool is_quantized : {false, true})
        for (const int bits : {8, 16}) {
            CAPTURE(is_quantized);
            CAPTURE(bits);
            hmesh::GltfOptions options;
            options.groups = view(material);
            options.color_bits = bits;
            options.quantized_positions = is_quantized;
            const Bytes bytes = written(mesh, options);
            const GlbAttributes file(bytes);
            const double half = 0.5 / (bits == 8 ? 255 : 65535) + 1e-12;
            const double unit = is_quantized ? 0.5 / (bits == 8 ? 127 : 32767) + 1e-12 : 1e-7;
            const std::vector<double> albedo = file.values("COLOR_0"), glow = file.values("COLOR_1"),
                                      rough = file.values("_ROUGH"), flow = file.values("_FLOW"), n = file.values("NORMAL"),
                                      tangent = file.values("TANGENT");
            REQUIRE(albedo.size() == 16);
            REQUIRE(glow.size() == 16);
            REQUIRE(rough.size() == 4);
            REQUIRE(flow.size() == 8);
            REQUIRE(n.size() == 12);
            REQUIRE(tangent.size() == 16);
            for (std::size_t v = 0; v < 4; ++v) {
                for (std::size_t k = 0; k < 3; ++k) {
                    CHECK(std::abs(albedo[4 * v + k] - hmesh::kit::srgb_to_linear(share(mesh, v, k))) <= half);
                    CHECK(std::abs(glow[4 * v + k] - hmesh::kit::srgb_to_linear(share(mesh, v, 10 + k))) <= half);
                    CHECK(std::abs(n[3 * v + k] - normal(mesh, v, 4)[k]) <= unit);
                    CHECK(tangent[4 * v + k] == (k == 0 ? 1 : 0));
                }
                CHECK(std::abs(albedo[4 * v + 3] - share(mesh, v, 3)) <= half);
                CHECK(glow[4 * v + 3] == 1);
                CHECK(tangent[4 * v + 3] == 1);
                CHECK(std::abs(rough[v] - share(mesh, v, 7)) <= half);
                CHECK(std::abs(flow[2 * v] - share(mesh, v, 8)) <= half);
                CHECK(std::abs(flow[2 * v + 1] - share(mesh, v, 9)) <= half);
            }
            CHECK(file.json.find("KHR_materials_unlit") == std::string::npos);  // what has a normal is lit
            CHECK(file.json.find("\"alphaMode\":\"BLEND\"") != std::string::npos);
        }
}

TEST_CASE("a normal without direction looks to the viewer") {
    hmesh::Mesh mesh = hmesh_test::two_faces(3);
    for (float& value : mesh.colors) value = 127.5F;
    const std::array<ChannelGroup, 1> groups = {{{"normal", ChannelGroup::Meaning::normal, 3}}};
    hmesh::GltfOptions options;
    options.groups = view(groups);
    const Bytes bytes = written(mesh, options);
    const GlbAttributes file(bytes);
    CHECK(file.values("NORMAL") == std::vector<double>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    CHECK(file.json.find("COLOR") == std::string::npos);
    CHECK(file.json.find("extensionsUsed") == std::string::npos);  // an empty list would be no glTF
}

TEST_CASE("one group that is a colour writes what no groups write") {
    for (const int channels : {1, 3, 4}) {
        const hmesh::Mesh mesh = random_mesh(channels);
        const std::array<ChannelGroup, 1> groups = {{{"any", ChannelGroup::Meaning::color, channels}}};
        hmesh::GltfOptions glb;
        hmesh::PlyOptions ply;
        const Bytes plain = written(mesh, glb);
        glb.groups = ply.groups = view(groups);
        CHECK(written(mesh, glb) == plain);
        const auto with = [&](const hmesh::PlyOptions& options) {
            return hmesh_test::exported(mesh.view(), [&](const hmesh::MeshView& from, hmesh::Sink sink) {
                return hmesh::write_ply(from, sink, options);
            });
        };
        CHECK(with(ply) == with({}));
    }
}

TEST_CASE("of a mesh of two channels each is of its own group, and a group of both is grey with alpha") {
    const hmesh::Mesh mesh = random_mesh(2);
    const std::array<ChannelGroup, 2> apart = {
        {{"rough", ChannelGroup::Meaning::data, 1}, {"metal", ChannelGroup::Meaning::data, 1}}};
    hmesh::GltfOptions glb;
    glb.groups = view(apart);
    const Bytes bytes = written(mesh, glb);
    const std::vector<double> rough = GlbAttributes(bytes).values("_ROUGH"), metal = GlbAttributes(bytes).values("_METAL");
    REQUIRE(rough.size() == 4);
    REQUIRE(metal.size() == 4);
    for (std::size_t v = 0; v < 4; ++v) {
        CHECK(std::abs(rough[v] - share(mesh, v, 0)) < 1e-5);
        CHECK(std::abs(metal[v] - share(mesh, v, 1)) < 1e-5);
    }
    hmesh::Mesh coarse = mesh;  // one face, and a level of detail of the first
    coarse.positions.resize(6), coarse.colors.resize(6), coarse.faces.resize(1);
    const Bytes lods = hmesh_test::exported(mesh.view(), [&](const hmesh::MeshView& from, hmesh::Sink sink) {
        return hmesh::write_glb_lods({from, coarse.view()}, sink, glb);
    });
    CHECK(GlbAttributes(lods).values("_METAL") == metal);  // of the finest, which comes first

    const std::array<ChannelGroup, 1> both = {{{"albedo", ChannelGroup::Meaning::color, 2}}};
    const Bytes plain = written(mesh, {});
    glb.groups = view(both);
    CHECK(written(mesh, glb) == plain);
    hmesh::PlyOptions ply;
    ply.ascii = true;
    for (const ChannelGroups& groups : {view(apart), view(both)}) {
        ply.groups = groups;
        const std::string text = hmesh_test::as_text(hmesh_test::exported(
            mesh.view(), [&](const hmesh::MeshView& from, hmesh::Sink sink) { return hmesh::write_ply(from, sink, ply); }));
        const char* const properties = groups.count == 1 ? "property uchar intensity\nproperty uchar alpha\n"
                                                         : "property uchar rough\nproperty uchar metal\n";
        CHECK(text.find(properties) != std::string::npos);
        const auto byte = [&](std::size_t channel) { return std::to_string(std::lround(255 * share(mesh, 0, channel))); };
        CHECK(text.find("end_header\n0 2 0 " + byte(0) + " " + byte(1) + "\n") != std::string::npos);
    }
}

TEST_CASE("groups of channels become properties of PLY, in their order") {
    const hmesh::Mesh mesh = random_mesh(13);
    hmesh::PlyOptions options;
    options.groups = view(material);
    for (const bool are_floats : {false, true}) {
        options.float_colors = are_floats;
        const Bytes bytes = hmesh_test::exported(
            mesh.view(), [&](const hmesh::MeshView& from, hmesh::Sink sink) { return hmesh::write_ply(from, sink, options); });
        const std::string text = hmesh_test::as_text(bytes);
        const std::string type = are_floats ? "float " : "uchar ";
        std::string header;
        for (const char* name :
             {"red", "green", "blue", "alpha", "nx", "ny", "nz", "rough", "Flow_0", "Flow_1", "glow_0", "glow_1", "glow_2"})
            header += "property " + (name[0] == 'n' ? "float " : type) + name + "\n";
        CHECK(text.find("property float z\n" + header + "element face 2\n") != std::string::npos);
        std::size_t at = text.find("end_header\n") + 11;
        const double half = are_floats ? 1e-7 : 0.5 / 255 + 1e-12;
        for (std::size_t v = 0; v < 4; ++v) {
            at += 12;
            for (std::size_t channel = 0; channel < 13; ++channel) {
                const bool is_normal = channel >= 4 && channel < 7;
                double value = 0;
                if (are_floats || is_normal) value = static_cast<double>(number_at<float>(bytes, at)), at += 4;
                else value = number_at<std::uint8_t>(bytes, at) / 255.0, ++at;
                if (is_normal) CHECK(std::abs(value - normal(mesh, v, 4)[channel - 4]) < 1e-7);
                else if (!are_floats) CHECK(std::abs(value - share(mesh, v, channel)) <= half);
                else CHECK(value == doctest::Approx(static_cast<double>(mesh.colors[13 * v + channel]) / 255).epsilon(1e-7));
            }
        }
        CHECK(bytes.size() == at + 26);
    }
}

TEST_CASE("the first colour of PLY has the names that viewers know, wherever it stands") {
    const std::array<ChannelGroup, 3> groups = {{{"rough", ChannelGroup::Meaning::data, 1},
                                                 {"albedo", ChannelGroup::Meaning::color, 3},
                                                 {"glow", ChannelGroup::Meaning::color, 1}}};
    hmesh::PlyOptions options;
    options.groups = view(groups);
    const std::string text =
        hmesh_test::as_text(hmesh_test::exported(random_mesh(5).view(), [&](const hmesh::MeshView& from, hmesh::Sink sink) {
            return hmesh::write_ply(from, sink, options);
        }));
    CHECK(text.find("property float z\nproperty uchar rough\nproperty uchar red\nproperty uchar green\n"
                    "property uchar blue\nproperty uchar glow\nelement face 2\n") != std::string::npos);
}

TEST_CASE("groups that do not describe the mesh are refused with their number, and no byte is written") {
    const hmesh::Mesh mesh = random_mesh(13);
    const auto refuse = [&](std::size_t group, double value, auto&& change) {
        std::array<ChannelGroup, 5> groups = material;
        change(groups[group]);
        const hmesh::Status status = check(view(groups), mesh.view());
        CHECK(status.code == hmesh::Errc::invalid_argument);
        CHECK(status.value == value);
        hmesh::GltfOptions glb;
        hmesh::PlyOptions ply;
        glb.groups = ply.groups = view(groups);
        const auto no_bytes = [](const void*, std::size_t) {
            FAIL("a byte is written");
            return false;
        };
        CHECK(hmesh::write_glb(mesh.view(), no_bytes, glb).code == hmesh::Errc::invalid_argument);
        CHECK(hmesh::write_ply(mesh.view(), no_bytes, ply).code == hmesh::Errc::invalid_argument);
    };
    CHECK(check(view(material), mesh.view()));
    CHECK(check(ChannelGroups(), mesh.view()));
    for (const int channels : {0, -1, 5, 1 << 30}) refuse(2, 2, [&](ChannelGroup& group) { group.channels = channels; });
    refuse(1, 1, [](ChannelGroup& group) { group.channels = 4; });                             // of a normal
    refuse(4, 4, [](ChannelGroup& group) { group.meaning = ChannelGroup::Meaning::normal; });  // a second one
    refuse(0, 0, [](ChannelGroup& group) { group.meaning = static_cast<ChannelGroup::Meaning>(3); });
    for (const char* name : {"", "a b", "a\"", "\xc3\xa4", "a-b", "a/", "a:", "a@", "a[", "a`", "a{", "a\x7f"})
        refuse(3, 3, [&](ChannelGroup& group) { group.name = name; });
    refuse(3, 3, [](ChannelGroup& group) { group.name = nullptr; });
    for (const char* name : {"x", "NZ", "Red", "alpha", "intensity"})
        refuse(2, 2, [&](ChannelGroup& group) { group.name = name; });
    refuse(3, 3, [](ChannelGroup& group) { group.name = "ROUGH"; });
    refuse(3, 3, [](ChannelGroup& group) { group.name = "ALBEDO_3"; });  // as PLY calls channels
    refuse(2, 3, [](ChannelGroup& group) { group.name = "flow_1"; });
    refuse(2, 14, [](ChannelGroup& group) { group.channels = 2; });  // channels of all
    const auto accept = [&](std::size_t group, const char* name) {
        std::array<ChannelGroup, 5> groups = material;
        groups[group].name = name;
        CAPTURE(name);
        CHECK(check(view(groups), mesh.view()));
    };
    for (const char* name : {"azAZ_09", "rough_0", "flow_", "flow_4", "flow_a", "flow_10", "flow0", "flow01", "flux_1"})
        accept(4, name);
    hmesh::MeshView multiplied = mesh.view();
    multiplied.premultiplied = true;
    CHECK(check(view(material), multiplied).code == hmesh::Errc::invalid_argument);
    CHECK(!check(view(material), multiplied).has_value);  // it is no group's fault
    CHECK(check(ChannelGroups{nullptr, 2}, mesh.view()).value == 2);
    hmesh::Mesh broken = mesh;
    broken.colors[5] = std::numeric_limits<float>::quiet_NaN();
    hmesh::GltfOptions options;
    options.groups = view(material);
    CHECK(hmesh::write_glb(
              broken.view(), [](const void*, std::size_t) { return true; }, options)
              .code == hmesh::Errc::not_finite);
}
