#include "hmesh/io/eps.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "test_shadings.hpp"

using namespace hmesh_test;

namespace {

const auto to_sink = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_eps(mesh, sink); };

std::string written(const hmesh::MeshView& mesh, const hmesh::PageOptions& options = {}) {
    std::string text;
    REQUIRE(hmesh::write_eps(mesh, hmesh::kit::append_to(text), options));
    return text;
}

// What the PostScript filter ASCII85Decode makes of the text (PLRM 3, 3.13.3).
std::string decode_ascii85(const std::string& text) {
    std::string out;
    std::uint64_t word = 0;
    std::size_t digits = 0;
    const auto put = [&](std::size_t bytes) {
        REQUIRE(word <= 0xffffffffU);
        for (std::size_t k = 0; k < bytes; ++k) out += static_cast<char>((word >> (24 - 8 * k)) & 0xffU);
        word = 0, digits = 0;
    };
    for (const char c : text) {
        if (c == ' ' || c == '\n') continue;
        if (c == 'z' && digits == 0) {
            put(4);
            continue;
        }
        REQUIRE((c >= '!' && c <= 'u'));
        word = 85 * word + static_cast<std::uint64_t>(c - '!');
        if (++digits == 5) put(4);
    }
    if (digits > 0) {
        REQUIRE(digits > 1);
        const std::size_t bytes = digits - 1;
        for (; digits < 5; ++digits) word = 85 * word + 84;
        put(bytes);
    }
    return out;
}

struct Picture {
    std::string entries, data;
};

Picture read_eps(const std::string& file) {
    const std::string mark = " exec\n";
    const std::size_t start = file.find(mark), end = file.find("~>\n");
    REQUIRE(start != std::string::npos);
    REQUIRE(end != std::string::npos);
    return {file.substr(0, start), decode_ascii85(file.substr(start + mark.size(), end - start - mark.size()))};
}

void check_read_back(const hmesh::Mesh& mesh, double tolerance, const hmesh::PageOptions& options = {}) {
    const Picture picture = read_eps(written(mesh.view(), options));
    CHECK(numbers_after(picture.entries, "%%BoundingBox:") ==
          std::vector<double>{0, 0, static_cast<double>(mesh.width), static_cast<double>(mesh.height)});
    const auto channels = static_cast<std::size_t>(mesh.channels);
    check_drawn(read_shading(picture.entries, picture.data), mesh.view(), channels, tolerance,
                [&](std::size_t v, std::size_t k) { return static_cast<double>(mesh.colors[channels * v + k]) / mesh.peak; });
}

constexpr double half_of_8 = 0.5 / 255 + 1e-9, half_of_16 = 0.5 / 65535 + 1e-9;

}  // namespace

TEST_CASE("a mesh of two faces is written as these bytes") {
    hmesh::Mesh mesh = two_faces(1);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 1.5F};
    mesh.colors = {-1, 128, 300, 99};
    // Flag, x, y and colour: 00 0300 0200 80, 00 0300 0000 FF, 00 0000 0200 00, 01 0000 0080 63.
    const std::string data = "!!<3&!.Y%O!!!$!!!!!#!!!$\"!!%OZ\n~>\n";
    const std::string head =
        "%!PS-Adobe-3.0 EPSF-3.0\n"
        "%%Creator: hmesh " HMESH_VERSION_STRING
        "\n"
        "%%BoundingBox: 0 0 3 2\n"
        "%%HiResBoundingBox: 0 0 3 2\n"
        "%%LanguageLevel: 3\n"
        "%%DocumentData: Clean7Bit\n"
        "%%Pages: 1\n"
        "%%EndComments\n"
        "%%Page: 1 1\n"
        "gsave\n"
        "0 0 3 2 rectclip\n"
        "{ currentfile /ASCII85Decode filter dup\n"
        "<< /DataSource 3 -1 roll\n"
        "/ShadingType 4 /ColorSpace /DeviceGray\n"
        "/BitsPerCoordinate 16 /BitsPerComponent 8 /BitsPerFlag 8\n"
        "/Decode [0 255.99609375 0 255.99609375 0 1] >> shfill flushfile } exec\n";
    const std::string file = written(mesh.view());
    CHECK(file == head + data + "grestore\nshowpage\n%%Trailer\n%%EOF\n");
}

TEST_CASE("the triangles read back are the faces of the mesh, in strips and without") {
    for (const bool strips : {true, false}) {
        hmesh::PageOptions options;
        options.strips = strips;
        check_read_back(two_faces(3), half_of_8, options);
        check_read_back(two_faces(1), half_of_8, options);
        hmesh::Mesh single = two_faces(3);
        single.faces.pop_back();
        check_read_back(single, half_of_8, options);
        check_read_back(random_grid(3, 512, 384, 30, 20, 255, 2), half_of_8, options);
        check_read_back(random_grid(1, 600, 30, 25, 12, 255, 3), half_of_8, options);
        check_read_back(random_grid(3, 300, 200, 12, 8, 65535, 4), half_of_16, options);
    }
}

TEST_CASE("all is printable ASCII in lines of at most 255 characters, and no line of the data looks like a comment") {
    const hmesh::Mesh mesh = random_grid(3, 512, 384, 60, 40, 255, 5);
    const std::string file = written(mesh.view());
    std::size_t length = 0;
    for (const char c : file) {
        if (c != '\n' && (c < ' ' || c > '~')) FAIL("byte ", static_cast<int>(c));
        length = c == '\n' ? 0 : length + 1;
        if (length > 255) FAIL("a long line");
    }
    const std::size_t start = file.find(" exec\n") + 6;
    CHECK(file.substr(start, file.find("~>") - start).find("\n%") == std::string::npos);
    // The data is made so that lines would begin with a comment.
    std::string text;
    const auto sink = hmesh::kit::append_to(text);
    hmesh::detail::Writer writer(sink);
    hmesh::detail::write_ascii85(writer, Bytes(1000, 13));  // 0x0d0d0d0d begins with the digit %
    REQUIRE(writer.finish());
    CHECK(text.substr(0, 2) == " %");
    CHECK(text.find("\n%") == std::string::npos);
    CHECK(decode_ascii85(text.substr(0, text.find("~>"))) == std::string(1000, '\r'));
}

TEST_CASE("data of every length is encoded and decoded") {
    for (std::size_t size = 1; size < 200; ++size) {
        std::string bytes, text;
        for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(i % 7 < 4 ? 0 : 37 * i);
        const auto sink = hmesh::kit::append_to(text);
        hmesh::detail::Writer writer(sink);
        hmesh::detail::write_ascii85(writer, Bytes(bytes.begin(), bytes.end()));
        REQUIRE(writer.finish());
        CHECK(decode_ascii85(text.substr(0, text.find("~>"))) == bytes);
    }
}

TEST_CASE("4 channels are laid over white") {
    hmesh::Mesh mesh = random_grid(4, 300, 200, 12, 8, 255, 9);
    mesh.colors[3] = -20, mesh.colors[7] = 300;
    const Picture picture = read_eps(written(mesh.view()));
    check_drawn(read_shading(picture.entries, picture.data), mesh.view(), 3, half_of_8, [&](std::size_t v, std::size_t k) {
        const double alpha = std::clamp(static_cast<double>(mesh.colors[4 * v + 3]) / 255, 0.0, 1.0);
        return alpha * static_cast<double>(mesh.colors[4 * v + k]) / 255 + (1 - alpha);
    });
}

TEST_CASE("a compressor is used for the mesh, and where it fails there is a Status and no byte") {
    const hmesh::Mesh mesh = random_grid(3, 400, 300, 12, 10, 255, 10);
    int calls = 0;
    hmesh::PageOptions options;
    const auto count = [&](const unsigned char* bytes, std::size_t size, Bytes& out) {
        ++calls;
        return store(bytes, size, out);
    };
    options.deflate = count;
    const Picture stored = read_eps(written(mesh.view(), options)), plain = read_eps(written(mesh.view()));
    CHECK(calls == 1);
    CHECK(stored.entries.find("/ASCII85Decode filter dup /FlateDecode filter\n") != std::string::npos);
    CHECK(plain.entries.find("FlateDecode") == std::string::npos);
    CHECK(unstored(stored.data) == plain.data);
    for (const hmesh::PageOptions::Deflate bad : {fail_to_compress, compress_to_nothing}) {
        options.deflate = bad;
        std::string text;
        const hmesh::Status status = hmesh::write_eps(mesh.view(), hmesh::kit::append_to(text), options);
        CHECK(status.code == hmesh::Errc::write_failed);
        CHECK(status.value == 0);
        CHECK(text.empty());
    }
}

TEST_CASE("a sink that refuses after some bytes gets no more and is reported, wherever that is") {
    check_refusing_sinks(random_grid(4, 64, 48, 22, 17, 255, 11).view(), to_sink);
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") { check_refusals(to_sink); }

TEST_CASE("the bytes do not depend on the locale") {
    const hmesh::Mesh mesh = random_grid(3, 300, 200, 12, 8, 255, 12);
    hmesh_test::check_locale_makes_no_difference(mesh.view(), to_sink);
}

TEST_CASE("a mesh of nothing is a page on which nothing is drawn") {
    check_empty_meshes(to_sink, [](const Bytes& bytes) {
        const std::string text = as_text(bytes);
        CHECK(text.find("%%BoundingBox: 0 0 3 2\n") != std::string::npos);
        CHECK(text.find("shfill") == std::string::npos);
        CHECK(text.find("~>") == std::string::npos);
        CHECK(text.find("showpage\n%%Trailer\n%%EOF\n") != std::string::npos);
    });
}
