#include "hmesh/io/html.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh::HtmlOptions;
using hmesh_test::two_faces;
using Bytes = std::vector<unsigned char>;

std::string written(const hmesh::MeshView& mesh, const HtmlOptions& options = {}) {
    std::string text;
    REQUIRE(hmesh::write_html(mesh, hmesh::kit::append_to(text), options));
    return text;
}

// A strip of `count` vertices, odd ones below, in colours below 0, within and above the peak of 1.
hmesh::Mesh strip(int channels, int count) {
    hmesh::Mesh mesh;
    mesh.channels = channels;
    mesh.width = count, mesh.height = 1, mesh.peak = 1;
    for (int v = 0; v < count; ++v) {
        mesh.positions.insert(mesh.positions.end(), {static_cast<float>(v) + 0.00390625F, static_cast<float>(v % 2)});
        for (int k = 0; k < channels; ++k) mesh.colors.push_back(static_cast<float>((7 * v + 3 * k) % 50) / 40 - 0.1F);
        const auto u = static_cast<std::uint32_t>(v);
        if (v >= 2) mesh.faces.push_back({u - 2, u - 1, u});
    }
    return mesh;
}

std::string between(const std::string& text, const std::string& before, const std::string& after) {
    const std::size_t at = text.find(before);
    REQUIRE(at != std::string::npos);
    const std::size_t begin = at + before.size(), end = text.find(after, begin);
    REQUIRE(end != std::string::npos);
    return text.substr(begin, end - begin);
}

// By RFC 4648 alone.
Bytes decoded(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    REQUIRE(text.size() % 4 == 0);
    Bytes bytes;
    for (std::size_t i = 0; i < text.size(); i += 4) {
        std::size_t bits = 0, padding = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t digit = digits.find(text[i + k]);
            if (text[i + k] == '=') ++padding;
            else REQUIRE(digit != std::string::npos);
            bits = bits << 6U | (text[i + k] == '=' ? 0 : digit);
        }
        REQUIRE((padding == 0 || (padding < 3 && i + 4 == text.size())));
        for (std::size_t k = 0; k + padding < 3; ++k) bytes.push_back(static_cast<unsigned char>((bits >> (16 - 8 * k)) & 255U));
    }
    return bytes;
}

void check_round_trip(const hmesh::Mesh& mesh) {
    const std::string text = written(mesh.view());
    const Bytes bytes = decoded(between(text, "\"data\":\"", "\"}"));
    const std::size_t n = mesh.vertex_count(), index_size = n <= 65535 ? 2 : 4;
    const auto channels = static_cast<std::size_t>(mesh.channels);
    REQUIRE(bytes.size() == 8 * n + 3 * index_size * mesh.face_count() + channels * n);
    std::size_t at = 0, wrong = 0;
    const auto number = [&](std::size_t size) {
        std::uint32_t value = 0;
        for (std::size_t k = 0; k < size; ++k) value |= static_cast<std::uint32_t>(bytes[at++]) << (8 * k);
        return value;
    };
    for (const float position : mesh.positions) {
        const std::uint32_t bits = number(4);
        float value = 0;
        std::memcpy(&value, &bits, 4);
        wrong += value != position ? 1U : 0U;
    }
    for (const auto& face : mesh.faces)
        for (const std::uint32_t v : face) wrong += number(index_size) != v ? 1U : 0U;
    for (const float color : mesh.colors) {
        const double share = std::fmin(1.0, std::fmax(0.0, static_cast<double>(color) / mesh.peak));
        wrong += std::abs(number(1) - 255 * share) > 0.5 + 1e-6 ? 1U : 0U;
    }
    CHECK(wrong == 0);
    CHECK(at == bytes.size());
}

void check_refused(const hmesh::MeshView& mesh, hmesh::Errc code, const HtmlOptions& options = {}) {
    std::string text;
    const hmesh::Status status = hmesh::write_html(mesh, hmesh::kit::append_to(text), options);
    CHECK(status.code == code);
    CHECK(std::strlen(status.what) > 0);
    CHECK(text.empty());
}

}  // namespace

TEST_CASE("a mesh of two faces is embedded as these bytes") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 99.5F, 99.4F, 0.4F, 254.6F};
    const std::string data = between(written(mesh.view()), "<script id=\"data\" type=\"application/json\">", "</script>");
    CHECK(
        data ==
        "{\"width\":3,\"height\":2,\"channels\":3,\"vertices\":4,\"faces\":2,\"points\":false,\"premultiplied\":false,\"data\":\""
        "AAAAAAAAAAAAAEBAAAAAAAAAQEAAAABAAAAAAAAAAEAAAAEAAgAAAAIAAwAAgP8BAgMA/2RjAP8=\"}");
}

TEST_CASE("a page of points says so, whose original reaches half a sample beyond the mesh") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.width = 4, mesh.height = 3;
    mesh.samples = hmesh::Samples::points;
    CHECK(between(written(mesh.view()), "<script id=\"data\" type=\"application/json\">{", ",\"premultiplied") ==
          "\"width\":3,\"height\":2,\"channels\":3,\"vertices\":4,\"faces\":2,\"points\":true");
}

TEST_CASE("the base64 text decodes to the mesh, for 1, 3 and 4 channels") {
    check_round_trip(strip(1, 101));
    check_round_trip(strip(3, 100));
    check_round_trip(strip(4, 99));
}

TEST_CASE("indices have 16 bits up to 65535 vertices, then 32") {
    hmesh::Mesh mesh = strip(1, 65535);
    mesh.faces = {{0, 1, 2}, {65532, 65533, 65534}};
    check_round_trip(mesh);
    mesh = strip(1, 65536);
    mesh.faces = {{0, 1, 2}, {65533, 65534, 65535}};
    check_round_trip(mesh);
}

TEST_CASE("the page is whole and asks for nothing") {
    const std::string text = written(two_faces(4).view());
    CHECK(text.compare(0, 15, "<!DOCTYPE html>") == 0);
    CHECK(text.substr(text.size() - 8) == "</html>\n");
    CHECK(text.find("http:") == std::string::npos);
    CHECK(text.find("https:") == std::string::npos);
    CHECK(text.find("url(") == std::string::npos);
    CHECK(text.find("@import") == std::string::npos);
    CHECK(text.find("default-src 'none'") != std::string::npos);
    CHECK(text.find("<canvas id=\"mesh\"") != std::string::npos);
    CHECK(text.find("<img") == std::string::npos);
    CHECK(text.find("<link") == std::string::npos);
    CHECK(text.find("src=") == std::string::npos);
    CHECK(text.size() < 24000);
}

TEST_CASE("the scripts are one module, and no place is left that something was to be put in") {
    const std::string text = written(two_faces(3).view());
    CHECK(text.find("\n<script type=\"module\">\n") != std::string::npos);
    for (const char* words : {"\nimport ", "\nexport ", "{{", "}}"}) CHECK(text.find(words) == std::string::npos);
}

TEST_CASE("title, figures and notes are shown as they are, whatever is in them") {
    HtmlOptions options;
    options.title = "a < b & \"c\" > 'd'</title>";
    options.figures = "1 %\n<script>alert(1)</script>\n\xc3\xa4";
    options.notes = "'b' & c";
    const std::string text = written(two_faces(3).view(), options);
    const std::string title = "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;&lt;/title&gt;";
    CHECK(between(text, "<title>", "</title>") == title);
    CHECK(between(text, "title=\"Figures (p)\">", "</button></h1>") == title);
    CHECK(between(text, "<p id=\"notes\">", "</p>") == "&#39;b&#39; &amp; c");
    CHECK(between(text, "<p id=\"figures\">", "</p>") == "1 %\n&lt;script&gt;alert(1)&lt;/script&gt;\n\xc3\xa4");
}

TEST_CASE("the original is embedded byte by byte") {
    Bytes file;
    for (std::size_t size = 1; size < 7; ++size) {
        file.push_back(static_cast<unsigned char>(251 * size));
        HtmlOptions options;
        options.original = file.data();
        options.original_size = file.size();
        options.original_type = "image/svg+xml";
        const std::string text = written(two_faces(3).view(), options);
        CHECK(decoded(between(text, "src=\"data:image/svg+xml;base64,", "\"")) == file);
    }
}

TEST_CASE("the page knows how to turn the original, and takes 1 to 8 for it") {
    const unsigned char byte = 0;
    HtmlOptions options;
    options.original = &byte;
    options.original_size = 1;
    CHECK(between(written(two_faces(3).view(), options), "data-turn=\"", "\"") == "1");
    options.original_orientation = 8;
    CHECK(between(written(two_faces(3).view(), options), "data-turn=\"", "\"") == "8");
    for (const int wrong : {-1, 0, 9}) {
        options.original_orientation = wrong;
        check_refused(two_faces(3).view(), hmesh::Errc::invalid_argument, options);
        const hmesh::Status status = hmesh::write_html(
            two_faces(3).view(), [](const void*, std::size_t) { return true; }, options);
        CHECK(status.value == wrong);
        CHECK(status.limit == (wrong < 1 ? 1 : 8));
    }
}

TEST_CASE("an original of no bytes is none, and where there is none nobody asks for its media type") {
    const unsigned char byte = 0;
    HtmlOptions options;
    options.original = &byte;
    CHECK(written(two_faces(3).view(), options) == written(two_faces(3).view()));
    options.original = nullptr;
    options.original_type = nullptr;
    CHECK(written(two_faces(3).view(), options) == written(two_faces(3).view()));
}

TEST_CASE("media types have small and capital letters, digits and a few signs") {
    const unsigned char byte = 0;
    HtmlOptions options;
    options.original = &byte;
    options.original_size = 1;
    for (const char* type : {"IMAGE/PNG", "image/AZaz09+-.", "a"}) {
        options.original_type = type;
        CHECK(between(written(two_faces(3).view(), options), "src=\"data:", ";base64,AA==\"") == type);
    }
    for (const char* type : {"image/png ", "image/[", "image/`", "image/@", "image/:", "image/,", "image/\xc3\xa4"}) {
        options.original_type = type;
        check_refused(two_faces(3).view(), hmesh::Errc::invalid_argument, options);
    }
}

TEST_CASE("the bytes do not depend on the locale") {
    const hmesh::Mesh mesh = strip(3, 2000);
    hmesh_test::check_locale_makes_no_difference(
        mesh.view(), [](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_html(view, sink); });
}

TEST_CASE("a sink that refuses after some bytes gets no more and is reported, wherever that is") {
    const hmesh::Mesh mesh = strip(3, 100);
    const std::size_t size = written(mesh.view()).size();
    for (std::size_t k = 0; k <= size; k += k + 211 > size && k < size ? size - k : 211) {
        std::size_t taken = 0;
        int refusals = 0;
        const hmesh::Status status = hmesh::write_html(mesh.view(), [&](const void*, std::size_t bytes) {
            const bool fits = taken + bytes <= k;
            if (fits) taken += bytes;
            else ++refusals;
            return fits;
        });
        if (static_cast<bool>(status) != (k == size) || refusals != (k == size ? 0 : 1) || taken > k) FAIL("k = ", k);
        if (k < size && (status.code != hmesh::Errc::write_failed || status.value != static_cast<double>(taken))) FAIL("k = ", k);
    }
}

TEST_CASE("a mesh or options that cannot be written give a Status and no byte") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const hmesh::Mesh good = two_faces(3);
    check_refused(hmesh::MeshView{}, hmesh::Errc::invalid_argument);
    hmesh::Mesh mesh = good;
    mesh.positions[7] = nan;
    check_refused(mesh.view(), hmesh::Errc::not_finite);
    mesh = good;
    mesh.colors[11] = nan;
    check_refused(mesh.view(), hmesh::Errc::not_finite);
    mesh = good;
    mesh.faces[1][2] = 4;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    mesh = good;
    mesh.width = 0;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    mesh = good;
    mesh.height = 0;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    check_refused(two_faces(5).view(), hmesh::Errc::invalid_argument);
    if constexpr (sizeof(std::size_t) > 4) {
        hmesh::MeshView huge = good.view();
        huge.vertex_count = std::numeric_limits<std::size_t>::max() / 2;
        check_refused(huge, hmesh::Errc::invalid_argument);
    }
    HtmlOptions options;
    options.title = nullptr;
    check_refused(good.view(), hmesh::Errc::invalid_argument, options);
    options = {};
    options.figures = nullptr;
    check_refused(good.view(), hmesh::Errc::invalid_argument, options);
    options = {};
    options.notes = nullptr;
    check_refused(good.view(), hmesh::Errc::invalid_argument, options);
    const unsigned char byte = 0;
    for (const char* type : {static_cast<const char*>(nullptr), "", "image/png\" onload=\"", "image/{"}) {
        options = {};
        options.original = &byte;
        options.original_size = 1;
        options.original_type = type;
        check_refused(good.view(), hmesh::Errc::invalid_argument, options);
    }
}

TEST_CASE("a mesh of nothing is a page with a mesh of no bytes") {
    hmesh_test::check_empty_meshes([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_html(mesh, sink); },
                                   [](const hmesh_test::Bytes& bytes) {
                                       const std::string text = hmesh_test::as_text(bytes);
                                       CHECK(text.find("\"vertices\":0,\"faces\":0") != std::string::npos);
                                       CHECK(text.find("\"data\":\"\"}") != std::string::npos);
                                   });
}
