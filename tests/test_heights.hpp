// hmesh tests - what the tests of exporters of heights share: terrains made of a function, and small readers of their files.
#ifndef HMESH_TESTS_TEST_HEIGHTS_HPP
#define HMESH_TESTS_TEST_HEIGHTS_HPP

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "test_exports.hpp"

namespace hmesh_test {

using Point3 = std::array<double, 3>;

inline Point3 minus(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point3 cross_product(const Point3& a, const Point3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double inner(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double size_of_vector(const Point3& a) { return std::sqrt(inner(a, a)); }
// Degrees between two vectors.
inline double angle_between(const Point3& a, const Point3& b) {
    return std::atan2(size_of_vector(cross_product(a, b)), inner(a, b)) * 180 / 3.14159265358979;
}

// A regular mesh and the samples that it is of.
struct Terrain {
    hmesh::Mesh mesh;
    hmesh::Image<float, 1> samples;
};

using Height = std::function<double(double x, double y)>;
using Hole = std::function<bool(int column, int row)>;

// Columns x rows cells of two faces each, `step` samples wide, but for those that are holes; heights are those of the function
// of the plane, y down, at vertices and at samples.
inline Terrain terrain(int columns, int rows, hmesh::Samples kind, const Height& height, const Hole& hole = {}, int step = 1) {
    const bool are_points = kind == hmesh::Samples::points;
    Terrain out;
    hmesh::Mesh& mesh = out.mesh;
    mesh.channels = 1;
    mesh.peak = 1;
    mesh.samples = kind;
    mesh.width = columns * step + (are_points ? 1 : 0), mesh.height = rows * step + (are_points ? 1 : 0);
    std::vector<std::uint32_t> numbers(static_cast<std::size_t>((columns + 1) * (rows + 1)), ~0U);
    const auto vertex = [&](int x, int y) {
        std::uint32_t& number = numbers[static_cast<std::size_t>(y * (columns + 1) + x)];
        if (number == ~0U) {
            number = static_cast<std::uint32_t>(mesh.vertex_count());
            mesh.positions.insert(mesh.positions.end(), {static_cast<float>(x * step), static_cast<float>(y * step)});
            mesh.colors.push_back(static_cast<float>(height(x * step, y * step)));
        }
        return number;
    };
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            if (hole && hole(x, y)) continue;
            const std::uint32_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x, y + 1), d = vertex(x + 1, y + 1);
            mesh.faces.push_back({a, b, d});
            mesh.faces.push_back({a, d, c});
        }
    out.samples = hmesh::Image<float, 1>(mesh.width, mesh.height);
    const double half = are_points ? 0 : 0.5;
    for (int y = 0; y < mesh.height; ++y)
        for (int x = 0; x < mesh.width; ++x) *out.samples.pixel(x, y) = static_cast<float>(height(x + half, y + half));
    return out;
}

// A file as numbers.
struct Model {
    std::vector<Point3> positions, normals;
    std::vector<std::array<double, 2>> places;  // texture coordinates, as the file has them
    std::vector<hmesh::Triangle> faces;
};

template <class T>
T number_in(const Bytes& bytes, std::size_t& at) {
    const T value = number_at<T>(bytes, at);
    at += sizeof value;
    return value;
}

template <std::size_t Size>
std::array<double, Size> floats_in(const Bytes& bytes, std::size_t& at) {
    std::array<double, Size> out{};
    for (double& value : out) value = static_cast<double>(number_in<float>(bytes, at));
    return out;
}

inline Model read_height_ply(const Bytes& bytes) {
    const std::string text = as_text(bytes), end = "\nend_header\n";
    std::size_t at = text.find(end);
    REQUIRE(at != std::string::npos);
    at += end.size();
    const std::string head = text.substr(0, at);
    REQUIRE(head.rfind("ply\nformat binary_little_endian 1.0\n", 0) == 0);
    REQUIRE(head.find("\nproperty float x\nproperty float y\nproperty float z\n") != std::string::npos);
    const auto count = [&](const std::string& word) {
        const std::size_t place = head.find("\nelement " + word + " ");
        REQUIRE(place != std::string::npos);
        return static_cast<std::size_t>(std::strtoll(head.c_str() + place + 10 + word.size(), nullptr, 10));
    };
    const bool has_normals = head.find("\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n") !=
                             std::string::npos,
               has_places = head.find("\nproperty float s\nproperty float t\nelement") != std::string::npos;
    Model out;
    for (std::size_t v = count("vertex"); v > 0; --v) {
        out.positions.push_back(floats_in<3>(bytes, at));
        if (has_normals) out.normals.push_back(floats_in<3>(bytes, at));
        if (has_places) out.places.push_back(floats_in<2>(bytes, at));
    }
    for (std::size_t f = count("face"); f > 0; --f) {
        if (number_in<std::uint8_t>(bytes, at) != 3) FAIL("a face of other than three corners");
        hmesh::Triangle face{};
        for (std::uint32_t& v : face) v = number_in<std::uint32_t>(bytes, at);
        out.faces.push_back(face);
    }
    REQUIRE(at == bytes.size());
    return out;
}

// Corners whose numbers behind slashes are other than the first fail.
inline Model read_height_obj(const Bytes& bytes) {
    Model out;
    std::istringstream lines(as_text(bytes));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v" || word == "vn") {
            Point3 at{};
            for (double& value : at) words >> value;
            REQUIRE(words);
            (word == "v" ? out.positions : out.normals).push_back(at);
        } else if (word == "vt") {
            std::array<double, 2> at{};
            words >> at[0] >> at[1];
            REQUIRE(words);
            out.places.push_back(at);
        } else if (word == "f") {
            hmesh::Triangle face{};
            for (std::uint32_t& v : face) {
                std::string corner;
                words >> corner;
                const auto number = std::strtoul(corner.c_str(), nullptr, 10);
                REQUIRE(number >= 1);
                v = static_cast<std::uint32_t>(number - 1);
                const std::string same = std::to_string(number);
                const std::string expected = !out.places.empty() && !out.normals.empty() ? same + "/" + same + "/" + same
                                             : !out.places.empty()                       ? same + "/" + same
                                             : !out.normals.empty()                      ? same + "//" + same
                                                                                         : same;
                REQUIRE(corner == expected);
            }
            out.faces.push_back(face);
        } else REQUIRE((word == "#" || word == "mtllib" || word == "usemtl"));
    }
    return out;
}

// The first number after "key": and an open bracket, if there is one, the n-th time that it comes.
inline std::vector<double> numbers_of(const std::string& json, const std::string& key, std::size_t n, std::size_t count) {
    std::size_t at = json.find("\"" + key + "\":");
    for (; n > 0 && at != std::string::npos; --n) at = json.find("\"" + key + "\":", at + 1);
    REQUIRE(at != std::string::npos);
    const char* from = json.c_str() + at + key.size() + 3;
    std::vector<double> out;
    for (; out.size() < count; ++from) {
        if (*from == '[') ++from;
        char* end = nullptr;
        out.push_back(std::strtod(from, &end));
        REQUIRE(end != from);
        from = end;
    }
    return out;
}

inline std::string json_of(const Bytes& bytes) {
    std::size_t at = 12;
    const auto size = number_in<std::uint32_t>(bytes, at);
    REQUIRE(bytes.size() >= 20 + size);
    return {bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(size)};
}

// Arrays come in the order positions, normals, places, indices; what there is of them the JSON says.
inline Model read_height_glb(const Bytes& bytes) {
    REQUIRE(std::memcmp(bytes.data(), "glTF", 4) == 0);
    std::size_t at = 8;
    REQUIRE(number_in<std::uint32_t>(bytes, at) == bytes.size());
    const std::string json = json_of(bytes);
    at = 28 + json.size();
    const auto has = [&](const char* word) { return json.find(word) != std::string::npos; };
    const auto vertices = static_cast<std::size_t>(numbers_of(json, "count", 0, 1)[0]);
    Model out;
    for (std::size_t v = 0; v < vertices; ++v) out.positions.push_back(floats_in<3>(bytes, at));
    for (std::size_t v = 0; v < vertices && has("\"NORMAL\""); ++v) out.normals.push_back(floats_in<3>(bytes, at));
    for (std::size_t v = 0; v < vertices && has("\"TEXCOORD_0\""); ++v) out.places.push_back(floats_in<2>(bytes, at));
    const std::size_t arrays = 2 + (out.normals.empty() ? 0 : 1) + (out.places.empty() ? 0 : 1);
    const auto indices = static_cast<std::size_t>(numbers_of(json, "count", arrays - 1, 1)[0]);
    const bool is_wide = has("\"componentType\":5125");
    for (std::size_t i = 0; i < indices; ++i) {
        if (i % 3 == 0) out.faces.emplace_back();
        out.faces.back()[i % 3] = is_wide ? number_in<std::uint32_t>(bytes, at) : number_in<std::uint16_t>(bytes, at);
    }
    REQUIRE((at + 3) / 4 * 4 == bytes.size());
    const std::vector<double> low = numbers_of(json, "min", 0, 3), high = numbers_of(json, "max", 0, 3);
    for (std::size_t k = 0; k < 3; ++k) {
        double least = out.positions[0][k], most = least;
        for (const Point3& point : out.positions) least = std::min(least, point[k]), most = std::max(most, point[k]);
        CHECK(static_cast<float>(low[k]) == static_cast<float>(least));  // nine digits
        CHECK(static_cast<float>(high[k]) == static_cast<float>(most));
    }
    return out;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_HEIGHTS_HPP
