// hmesh tests - meshes for exporters, sinks, and a reader of free-form Gouraud shadings that knows their format alone.
#ifndef HMESH_TESTS_TEST_SHADINGS_HPP
#define HMESH_TESTS_TEST_SHADINGS_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "test_exports.hpp"

namespace hmesh_test {

// --- meshes ---

// columns x rows squares of two faces each over width x height, diagonals, inner positions (on the 1/256 px grid) and
// colours at random, faces shuffled and turned.
inline hmesh::Mesh random_grid(int channels, int width, int height, int columns, int rows, double peak, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    hmesh::Mesh mesh;
    mesh.channels = channels;
    mesh.width = width, mesh.height = height, mesh.peak = peak;
    const auto along = [&](int i, int n, int size) {
        const double jitter = i == 0 || i == n ? 0 : 0.4 * (random.uniform() - 0.5);
        return static_cast<float>(std::floor((i + jitter) * size / n * 256) / 256);
    };
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const float x = along(i, columns, width), y = along(j, rows, height);
            mesh.positions.insert(mesh.positions.end(), {x, y});
            for (int k = 0; k < channels; ++k) mesh.colors.push_back(static_cast<float>(peak * random.uniform()));
        }
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i), b = a + 1,
                       d = a + static_cast<std::uint32_t>(columns) + 1, c = d + 1;
            if (random.below(2) == 0) mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
            else mesh.faces.insert(mesh.faces.end(), {{a, b, d}, {b, c, d}});
        }
    for (std::size_t f = mesh.faces.size(); f-- > 1;)
        std::swap(mesh.faces[f], mesh.faces[random.below(static_cast<std::uint32_t>(f + 1))]);
    for (auto& face : mesh.faces) std::rotate(face.begin(), face.begin() + random.below(3), face.end());
    return mesh;
}

// --- reading ---

// The numbers between the brackets after `name`, or the number after it.
inline std::vector<double> numbers_after(const std::string& text, const std::string& name) {
    std::size_t at = text.find(name);
    REQUIRE(at != std::string::npos);
    at += name.size();
    while (text[at] == ' ' || text[at] == '[') ++at;
    std::vector<double> numbers;
    const char* from = text.c_str() + at;
    for (char* end = nullptr;; from = end) {
        const double number = std::strtod(from, &end);
        if (end == from) return numbers;
        numbers.push_back(number);
    }
}

struct Corner {
    double x = 0, y = 0;
    std::array<double, 3> color{};  // shares of full intensity
    bool operator<(const Corner& other) const { return x != other.x ? x < other.x : y < other.y; }
};
using Drawn = std::array<Corner, 3>;

// The triangles of a shading of type 4: ISO 32000-1, 8.7.4.5.5. `entries` is its dictionary. Colours are those of the shading's
// space, which may be DeviceN.
inline std::vector<Drawn> read_shading(const std::string& entries, const std::string& data) {
    CHECK(numbers_after(entries, "/ShadingType")[0] == 4);
    const auto has_space = [&](const char* space) { return entries.find(space) != std::string::npos; };
    const bool gray = has_space("/ColorSpace /DeviceGray") || has_space("/ColorSpace [/DeviceN [/Gray] /DeviceGray ");
    REQUIRE((gray || has_space("/ColorSpace /DeviceRGB") || has_space("/ColorSpace [/DeviceN [/Red /Green /Blue] /DeviceRGB ")));
    const std::vector<double> decode = numbers_after(entries, "/Decode");
    const std::size_t components = gray ? 1 : 3;
    REQUIRE(decode.size() == 4 + 2 * components);
    std::size_t bit = 0;
    const auto number = [&](double bits) {
        const std::size_t end = bit + static_cast<std::size_t>(bits);
        REQUIRE(end <= 8 * data.size());
        std::uint64_t value = 0;
        for (; bit < end; ++bit) value = 2 * value + ((static_cast<unsigned char>(data[bit / 8]) >> (7 - bit % 8)) & 1U);
        return static_cast<double>(value);
    };
    const auto decoded = [&](std::size_t i, double bits) {
        return decode[2 * i] + number(bits) * (decode[2 * i + 1] - decode[2 * i]) / (std::exp2(bits) - 1);
    };
    const double flag_bits = numbers_after(entries, "/BitsPerFlag")[0];
    const double coordinate_bits = numbers_after(entries, "/BitsPerCoordinate")[0];
    const double component_bits = numbers_after(entries, "/BitsPerComponent")[0];
    const auto vertex = [&](double& flag) {
        Corner corner;
        flag = number(flag_bits);
        // 1e-9 px is far more than what double loses here, and far less than the grid's 1/256.
        for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
            const double at = decoded(i, coordinate_bits), on_grid = std::round(256 * at) / 256;
            (i == 0 ? corner.x : corner.y) = std::abs(at - on_grid) < 1e-9 ? on_grid : at;
        }
        for (std::size_t k = 0; k < components; ++k) corner.color[k] = decoded(2 + k, component_bits);
        bit = (bit + 7) / 8 * 8;
        return corner;
    };
    std::vector<Drawn> drawn;
    while (bit / 8 < data.size()) {
        double flag = 0, ignored = 0;
        const Corner next = vertex(flag);
        if (flag == 0) {
            const Corner b = vertex(ignored), c = vertex(ignored);
            drawn.push_back({next, b, c});
        } else {
            REQUIRE((flag == 1 || flag == 2));
            REQUIRE(!drawn.empty());
            const Drawn last = drawn.back();
            drawn.push_back({last[flag == 1 ? 1 : 0], last[2], next});
        }
    }
    return drawn;
}

inline bool before(const Drawn& a, const Drawn& b) {
    for (std::size_t i = 0; i < 3; ++i)
        if (a[i] < b[i] || b[i] < a[i]) return a[i] < b[i];
    return false;
}
inline void sort_triangles(std::vector<Drawn>& triangles) {
    for (Drawn& t : triangles) std::sort(t.begin(), t.end());
    std::sort(triangles.begin(), triangles.end(), before);
}

// That the triangles are the mesh's faces, each once, y up, positions exact; `share(v, k)` says the colours, which may be
// off by `tolerance`.
template <class Share>
void check_drawn(std::vector<Drawn> drawn, const hmesh::MeshView& mesh, std::size_t components, double tolerance,
                 const Share& share) {
    std::vector<Drawn> expected;
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        Drawn t;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t v = mesh.faces[f][i];
            t[i].x = static_cast<double>(mesh.positions[2 * v]);
            t[i].y = mesh.height - static_cast<double>(mesh.positions[2 * v + 1]);
            for (std::size_t k = 0; k < components; ++k) t[i].color[k] = share(v, k);
        }
        expected.push_back(t);
    }
    sort_triangles(drawn);
    sort_triangles(expected);
    REQUIRE(drawn.size() == expected.size());
    for (std::size_t f = 0; f < drawn.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i) {
            const Corner &a = drawn[f][i], &b = expected[f][i];
            if (a.x != b.x || a.y != b.y) FAIL("face ", f, ": (", a.x, ", ", a.y, "), not (", b.x, ", ", b.y, ")");
            for (std::size_t k = 0; k < components; ++k)
                if (!(std::abs(a.color[k] - b.color[k]) <= tolerance)) FAIL("colour ", a.color[k], ", not ", b.color[k]);
        }
}

// --- what both exporters refuse ---

// `write(view, sink)` writes.
inline void check_refusals(Write write) {
    check_bad_meshes_are_refused(write);
    const hmesh::Mesh good = two_faces(3);
    for (const float far : {5e6F, -3e38F, 3e38F})
        for (const std::size_t coordinate : {6U, 7U}) {
            hmesh::Mesh mesh = good;
            mesh.positions[coordinate] = far;
            check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
        }
    for (const int size : {0, -1, 4194305, std::numeric_limits<int>::max()}) {
        hmesh::Mesh mesh = good;
        mesh.width = size;
        check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    }
    hmesh::Mesh wide = good;
    wide.width = 4194304;
    (void)exported(wide.view(), write);
    hmesh::MeshView huge = good.view();
    for (const std::size_t count : {std::size_t{47721859}, std::size_t{1} << 31U}) {
        huge.face_count = count;  // of two that are there: the number alone is why
        Bytes bytes;
        const hmesh::Status status = write(huge, hmesh::kit::append_to(bytes));
        CHECK(status.code == hmesh::Errc::invalid_argument);
        CHECK(status.limit == 47721858);
        CHECK(bytes.empty());
    }
}

// --- compressors ---

// Adler-32 and stored blocks (RFC 1950 and 1951): a zlib stream that compresses nothing.
inline bool store(const unsigned char* bytes, std::size_t size, Bytes& out) {
    out = {0x78, 0x01};
    std::uint32_t a = 1, b = 0;
    for (std::size_t i = 0; i < size;) {
        const std::size_t part = std::min<std::size_t>(65535, size - i);
        out.push_back(i + part == size ? 1 : 0);
        for (const std::size_t n : {part, part ^ 0xffffU}) {
            out.push_back(static_cast<unsigned char>(n & 0xffU));
            out.push_back(static_cast<unsigned char>(n >> 8U));
        }
        for (const std::size_t end = i + part; i < end; ++i) {
            out.push_back(bytes[i]);
            a = (a + bytes[i]) % 65521;
            b = (b + a) % 65521;
        }
    }
    for (const std::uint32_t n : {b, a})
        for (const unsigned shift : {8U, 0U}) out.push_back(static_cast<unsigned char>((n >> shift) & 0xffU));
    return true;
}
inline std::string unstored(const std::string& stream) {
    std::string out;
    for (std::size_t i = 2; i + 4 < stream.size();) {
        const bool last = stream[i] == 1;
        const std::size_t part = static_cast<unsigned char>(stream[i + 1]) + 256U * static_cast<unsigned char>(stream[i + 2]);
        out += stream.substr(i + 5, part);
        i += 5 + part;
        if (last) return out;
    }
    FAIL("no last block");
    return out;
}
inline bool fail_to_compress(const unsigned char*, std::size_t, Bytes& out) {
    out.push_back(1);
    return false;
}
inline bool compress_to_nothing(const unsigned char*, std::size_t, Bytes&) { return true; }

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_SHADINGS_HPP
