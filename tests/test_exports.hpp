// hmesh tests - what the tests of all exporters share: tiny meshes, and what every exporter has to refuse.
#ifndef HMESH_TESTS_TEST_EXPORTS_HPP
#define HMESH_TESTS_TEST_EXPORTS_HPP

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "comma_locale.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace hmesh_test {

using Bytes = std::vector<unsigned char>;

// An exporter with its options.
using Write = hmesh::FunctionRef<hmesh::Status(const hmesh::MeshView& mesh, hmesh::Sink sink)>;

inline Bytes exported(const hmesh::MeshView& mesh, Write write) {
    Bytes bytes;
    const auto sink = hmesh::kit::append_to(bytes);
    REQUIRE(write(mesh, sink));
    return bytes;
}

// A number of 1 to 8 bytes at a place of a file, the lowest byte first, on any machine.
template <class T>
T number_at(const Bytes& bytes, std::size_t at) {
    if (at + sizeof(T) > bytes.size()) FAIL("the file is too short");
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < sizeof(T); ++k) bits |= std::uint64_t{bytes[at + k]} << 8 * k;
    if constexpr (std::is_integral_v<T>) {
        return static_cast<T>(bits);
    } else {
        const auto word = static_cast<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>(bits);
        T value = 0;
        std::memcpy(&value, &word, sizeof value);
        return value;
    }
}

inline std::string as_text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

// The rectangle [0, 3] x [0, 2] cut from its upper left to its lower right corner; channels are `step` apart.
inline hmesh::Mesh two_faces(int channels, int step = 1) {
    hmesh::Mesh mesh;
    mesh.channels = channels;
    mesh.width = 3, mesh.height = 2, mesh.peak = 255;
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 2};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    for (int v = 0; v < 4; ++v)
        for (int k = 0; k < channels; ++k) mesh.colors.push_back(static_cast<float>(10 * v + step * k));
    return mesh;
}

// A regular grid of columns x rows squares of two faces each, with three channels.
inline hmesh::Mesh square_grid(int columns, int rows) {
    hmesh::Mesh mesh;
    mesh.channels = 3;
    mesh.width = columns, mesh.height = rows, mesh.peak = 1;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            mesh.positions.insert(mesh.positions.end(), {static_cast<float>(x), static_cast<float>(y)});
            mesh.colors.insert(mesh.colors.end(), {static_cast<float>(x) / static_cast<float>(columns), 0.5F, 1});
        }
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x), b = a + 1,
                       c = a + static_cast<std::uint32_t>(columns) + 1, d = c + 1;
            mesh.faces.push_back({a, b, d});
            mesh.faces.push_back({a, d, c});
        }
    return mesh;
}

inline void check_refused(const hmesh::MeshView& mesh, hmesh::Errc code, Write write) {
    Bytes bytes;
    const hmesh::Status status = write(mesh, hmesh::kit::append_to(bytes));
    CHECK(status.code == code);
    CHECK(std::strlen(status.what) > 0);
    CHECK(bytes.empty());
}

// Meshes that no exporter can write give a Status and no byte.
inline void check_bad_meshes_are_refused(Write write) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const hmesh::Mesh good = two_faces(3);
    check_refused(hmesh::MeshView{}, hmesh::Errc::invalid_argument, write);
    for (const float bad : {nan, inf, -inf}) {
        hmesh::Mesh mesh = good;
        mesh.positions[7] = bad;
        check_refused(mesh.view(), hmesh::Errc::not_finite, write);
        mesh = good;
        mesh.colors[11] = bad;
        check_refused(mesh.view(), hmesh::Errc::not_finite, write);
    }
    hmesh::Mesh mesh = good;
    mesh.faces[1][2] = 4;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    mesh = good;
    mesh.faces.clear();
    check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    for (const double peak : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        mesh = good;
        mesh.peak = peak;
        check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    }
    for (const int size : {0, -1}) {
        mesh = good;
        mesh.height = size;
        check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    }
    check_refused(two_faces(5).view(), hmesh::Errc::invalid_argument, write);
}

// The file of a mesh of nothing, as a sprite of transparent pixels is, of 1 to 4 channels.
template <class Prove>
void check_empty_meshes(Write write, Prove&& prove) {
    for (int channels = 1; channels <= 4; ++channels) {
        CAPTURE(channels);
        hmesh::Mesh mesh = two_faces(channels);
        mesh.positions.clear(), mesh.colors.clear(), mesh.faces.clear();
        prove(exported(mesh.view(), write));
        mesh.width = 0;
        check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
        mesh.width = 3, mesh.peak = 0;
        check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    }
    hmesh::MeshView faces_alone = two_faces(3).view();
    faces_alone.vertex_count = 0;
    check_refused(faces_alone, hmesh::Errc::invalid_argument, write);
}

// A sink that refuses after k bytes gets no more and is reported. The mesh must take some writes of 4096 bytes. All k around
// the ends of writes, where the sink's answers change, and every 397th of the others.
inline void check_refusing_sinks(const hmesh::MeshView& mesh, Write write) {
    constexpr std::size_t stride = 397;
    const std::size_t size = exported(mesh, write).size();
    REQUIRE(size > 8192);
    for (std::size_t k = 0; k <= size; ++k) {
        if (k % 4096 > 2 && k % 4096 < 4094 && k + 3 < size && k % stride != 0) continue;
        std::size_t taken = 0;
        int refusals = 0;
        const hmesh::Status status = write(mesh, [&](const void*, std::size_t bytes) {
            const bool fits = taken + bytes <= k;
            if (fits) taken += bytes;
            else ++refusals;
            return fits;
        });
        const bool all = k == size;
        if (static_cast<bool>(status) != all || refusals != (all ? 0 : 1) || taken > k) FAIL("k = ", k);
        if (!all && (status.code != hmesh::Errc::write_failed || status.value != static_cast<double>(taken))) FAIL("k = ", k);
    }
}

// The bytes are the same where streams and the C library write a comma before decimals.
inline void check_locale_makes_no_difference(const hmesh::MeshView& mesh, Write write) {
    const Bytes expected = exported(mesh, write);
    const CommaLocale foreign;
    CHECK(exported(mesh, write) == expected);
    if (!CommaLocale::is_known_to_c())
        MESSAGE("no locale with a decimal comma is installed: that of the C library was not changed");
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_EXPORTS_HPP
