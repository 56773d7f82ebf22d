#include "hmesh/io/pdf.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "test_shadings.hpp"

using namespace hmesh_test;

namespace {

const auto to_sink = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink); };

std::string written(const hmesh::MeshView& mesh, const hmesh::PageOptions& options = {}) {
    std::string text;
    REQUIRE(hmesh::write_pdf(mesh, hmesh::kit::append_to(text), options));
    return text;
}

struct Object {
    std::string entries, data;
};

int times(const std::string& text, const std::string& word) {
    int count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + word.size())) ++count;
    return count;
}

// The objects of a file, found by its cross-reference table alone; [0] is the trailer.
std::vector<Object> read_pdf(const std::string& file) {
    REQUIRE(file.substr(0, 9) == "%PDF-1.4\n");
    REQUIRE(file.substr(file.size() - 6) == "%%EOF\n");
    const std::size_t start = file.rfind("startxref\n");
    const std::size_t table = std::stoul(file.substr(start + 10));
    REQUIRE(file.substr(table, 7) == "xref\n0 ");
    const std::size_t count = std::stoul(file.substr(table + 7));
    std::size_t entry = file.find('\n', table + 5) + 1;
    REQUIRE(file.substr(entry, 20) == "0000000000 65535 f \n");
    std::vector<Object> objects(1);
    for (std::size_t i = 1; i < count; ++i) {
        entry += 20;
        REQUIRE(file.substr(entry + 10, 10) == " 00000 n \n");
        const std::size_t at = std::stoul(file.substr(entry, 10));
        const std::string head = std::to_string(i) + " 0 obj\n";
        REQUIRE(file.substr(at, head.size()) == head);
        Object object;
        const std::size_t end = file.find("endobj\n", at), stream = file.find(">>\nstream\n", at);
        if (stream < end) {
            object.entries = file.substr(at, stream - at);
            const auto length = static_cast<std::size_t>(numbers_after(object.entries, "/Length")[0]);
            object.data = file.substr(stream + 10, length);
            REQUIRE(file.substr(stream + 10 + length, 18) == "\nendstream\nendobj\n");
        } else {
            object.entries = file.substr(at, end - at);
        }
        // Each dictionary that is begun is ended; that of a stream by what stands before its bytes.
        CHECK(times(object.entries, "<<") == times(object.entries, ">>") + (stream < end ? 1 : 0));
        objects.push_back(object);
    }
    REQUIRE(file.substr(entry + 20, 8) == "trailer\n");
    objects[0].entries = file.substr(entry + 20, start - entry - 20);
    CHECK(numbers_after(objects[0].entries, "/Size")[0] == static_cast<double>(count));
    return objects;
}

// The object that `entries` name as `/Key n 0 R`.
const Object& follow(const std::vector<Object>& objects, const std::string& entries, const std::string& key) {
    const std::vector<double> reference = numbers_after(entries, key);
    REQUIRE(reference.size() == 2);
    const auto number = static_cast<std::size_t>(reference[0]);
    REQUIRE(number > 0);
    REQUIRE(number < objects.size());
    return objects[number];
}

const Object& page_of(const std::vector<Object>& objects) {
    const Object& pages = follow(objects, follow(objects, objects[0].entries, "/Root").entries, "/Pages");
    CHECK(numbers_after(pages.entries, "/Count")[0] == 1);
    return follow(objects, pages.entries, "/Kids");
}

// What a function of type 4 (ISO 32000-1, 7.10.5) that knows `mul` and `roll` makes of a colour.
std::vector<double> calculated(const std::string& code, std::vector<double> stack) {
    REQUIRE(code.front() == '{');
    REQUIRE(code.back() == '}');
    std::istringstream words(code.substr(1, code.size() - 2));
    const auto pop = [&] {
        REQUIRE(!stack.empty());
        const double top = stack.back();
        stack.pop_back();
        return top;
    };
    for (std::string word; words >> word;) {
        if (word == "mul") {
            const double a = pop(), b = pop();
            stack.push_back(a * b);
        } else if (word == "roll") {
            const auto times = static_cast<std::ptrdiff_t>(pop()), count = static_cast<std::ptrdiff_t>(pop());
            REQUIRE(count >= times);
            REQUIRE(static_cast<std::ptrdiff_t>(stack.size()) >= count);
            std::rotate(stack.end() - count, stack.end() - times, stack.end());
        } else {
            stack.push_back(std::stod(word));
        }
    }
    return stack;
}

// What `contents` draw of the shadings that `entries` name, in colours as they are shown. `factors` become how much each
// shading's colours are multiplied.
std::vector<Drawn> read_shadings(const std::vector<Object>& objects, const std::string& entries, const std::string& contents,
                                 std::vector<double>& factors) {
    std::vector<Drawn> drawn;
    std::istringstream words(contents);
    factors.clear();
    for (std::string name, sh; words >> name;) {
        words >> sh;
        REQUIRE(sh == "sh");
        const Object& shading = follow(objects, entries, name);
        std::vector<Drawn> part = read_shading(shading.entries, shading.data);
        factors.push_back(1);
        if (shading.entries.find("/DeviceN") != std::string::npos) {
            const bool gray = shading.entries.find("/DeviceGray") != std::string::npos;
            const Object& function = follow(objects, shading.entries, gray ? "/DeviceGray" : "/DeviceRGB");
            CHECK(numbers_after(function.entries, "/FunctionType")[0] == 4);
            const std::size_t count = gray ? 1 : 3;
            CHECK(numbers_after(function.entries, "/Domain").size() == 2 * count);
            CHECK(numbers_after(function.entries, "/Range").size() == 2 * count);
            for (Drawn& face : part)
                for (Corner& corner : face) {
                    const std::vector<double> shown = calculated(
                        function.data, {corner.color.begin(), corner.color.begin() + static_cast<std::ptrdiff_t>(count)});
                    REQUIRE(shown.size() == count);
                    std::copy(shown.begin(), shown.end(), corner.color.begin());
                }
            factors.back() = calculated(function.data, std::vector<double>(count, 1)).back();
            CHECK(numbers_after(shading.entries, "/Decode")[5] * factors.back() == 1);
        }
        drawn.insert(drawn.end(), part.begin(), part.end());
    }
    return drawn;
}

// Returns the factors of the parts.
std::vector<double> check_read_back(const hmesh::Mesh& mesh, double tolerance, const hmesh::PageOptions& options = {}) {
    const std::vector<Object> objects = read_pdf(written(mesh.view(), options));
    const Object& page = page_of(objects);
    CHECK(numbers_after(page.entries, "/MediaBox") ==
          std::vector<double>{0, 0, static_cast<double>(mesh.width), static_cast<double>(mesh.height)});
    const auto channels = static_cast<std::size_t>(mesh.channels);
    std::vector<double> factors;
    check_drawn(read_shadings(objects, page.entries, follow(objects, page.entries, "/Contents").data, factors), mesh.view(),
                channels, tolerance,
                [&](std::size_t v, std::size_t k) { return static_cast<double>(mesh.colors[channels * v + k]) / mesh.peak; });
    return factors;
}

// Of faces of all sizes, and steps of colour from none to the largest.
hmesh::Mesh mesh_of_all_parts(int channels) {
    hmesh::Mesh mesh = random_grid(channels, 640, 400, 40, 40, 255, 21);
    const auto count = static_cast<std::size_t>(channels);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const auto bent = [](float at, float size) { return std::floor(at * at / size * 256) / 256; };
        mesh.positions[2 * v] = bent(mesh.positions[2 * v], 640);
        mesh.positions[2 * v + 1] = bent(mesh.positions[2 * v + 1], 400);
        for (std::size_t k = 0; k < count; ++k) mesh.colors[count * v + k] *= mesh.positions[2 * v] / 640;
    }
    return mesh;
}

constexpr double half_of_8 = 0.5 / 255 + 1e-9, half_of_16 = 0.5 / 65535 + 1e-9;

}  // namespace

TEST_CASE("a mesh of two faces is written as these bytes") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 1.5F};
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 99.5F, 99.4F, 0.4F, 254.6F};
    const std::string head =
        "%PDF-1.4\n%\xe2\xe3\xcf\xd3\n"
        "1 0 obj\n<< /Producer (hmesh " HMESH_VERSION_STRING
        ") >>\nendobj\n"
        "2 0 obj\n<< /Type /Catalog /Pages 3 0 R >>\nendobj\n"
        "3 0 obj\n<< /Type /Pages /Kids [4 0 R] /Count 1 >>\nendobj\n"
        "4 0 obj\n<< /Type /Page /Parent 3 0 R /MediaBox [0 0 3 2] /Contents 5 0 R\n"
        "/Resources << /Shading << /S0 6 0 R >> >> >>\nendobj\n"
        "5 0 obj\n<< \n/Length 6 >>\nstream\n/S0 sh\nendstream\nendobj\n"
        "6 0 obj\n<< /ShadingType 4 /ColorSpace /DeviceRGB\n"
        "/BitsPerCoordinate 16 /BitsPerComponent 8 /BitsPerFlag 8\n"
        "/Decode [0 255.99609375 0 255.99609375 0 1 0 1 0 1]\n/Length 32 >>\nstream\n";
    const Bytes vertices = {
        0, 3, 0, 2, 0,    1,  2,   3,    // (3, 2), opposite of the side that the two faces share
        0, 3, 0, 0, 0,    0,  255, 100,  // (3, 0)
        0, 0, 0, 2, 0,    0,  128, 255,  // (0, 2)
        1, 0, 0, 0, 0x80, 99, 0,   255,  // (0, 0.5)
    };
    std::string expected = head;
    for (const unsigned char byte : vertices) expected += static_cast<char>(byte);
    expected += "\nendstream\nendobj\n";
    const std::string file = written(mesh.view());
    REQUIRE(file.size() > expected.size());
    CHECK(file.substr(0, expected.size()) == expected);
    const std::string table = file.substr(expected.size());
    CHECK(table.substr(0, 70) == "xref\n0 7\n0000000000 65535 f \n0000000015 00000 n \n0000000060 00000 n \n0");
    CHECK(table.substr(table.find("trailer")) ==
          "trailer\n<< /Size 7 /Root 2 0 R /Info 1 0 R >>\nstartxref\n" + std::to_string(expected.size()) + "\n%%EOF\n");
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
        check_read_back(random_grid(3, 200, 150, 1, 30, 255, 1), half_of_8, options);
        check_read_back(random_grid(3, 512, 384, 30, 20, 255, 2), half_of_8, options);
        check_read_back(random_grid(1, 600, 30, 25, 12, 255, 3), half_of_8, options);
    }
}

TEST_CASE("colours whose peak is not 255 are written with 16 bits") {
    check_read_back(random_grid(3, 300, 200, 12, 8, 65535, 4), half_of_16);
    check_read_back(random_grid(1, 300, 200, 12, 8, 1, 5), half_of_16);
}

TEST_CASE("positions of the 1/256 px grid arrive exactly in images of every size and outside of them") {
    for (const int side : {1, 255, 256, 65535, 65536}) {
        hmesh::Mesh mesh = random_grid(1, side, side, 2, 2, 255, 6);
        check_read_back(mesh, half_of_8);
        const float x = mesh.positions[0];
        mesh.positions[0] = -1.25F;
        check_read_back(mesh, half_of_8);
        mesh.positions[1] = static_cast<float>(side) + 7.00390625F;
        check_read_back(mesh, half_of_8);
        mesh.positions[0] = x;
        check_read_back(mesh, half_of_8);
    }
    CHECK(written(random_grid(1, 255, 255, 1, 1, 255, 7).view()).find("/BitsPerCoordinate 16 ") != std::string::npos);
    CHECK(written(random_grid(1, 256, 9, 1, 1, 255, 7).view()).find("/BitsPerCoordinate 24 ") != std::string::npos);
    CHECK(written(random_grid(1, 9, 65536, 1, 1, 255, 7).view()).find("/BitsPerCoordinate 32 ") != std::string::npos);
}

TEST_CASE("strips need little more than one vertex a face") {
    const hmesh::Mesh mesh = random_grid(3, 512, 384, 40, 40, 255, 8);
    hmesh::PageOptions options;
    options.parts = false;
    const std::vector<Object> objects = read_pdf(written(mesh.view(), options));
    const std::size_t bytes = follow(objects, page_of(objects).entries, "/S0").data.size();
    CHECK(bytes < 10 * mesh.face_count() * 11 / 10);
    CHECK(bytes >= 10 * (mesh.face_count() + 2));
}

TEST_CASE("a mesh that poppler would cut into many pieces is drawn in parts that show the same, those stored smallest first") {
    for (const int channels : {1, 3}) {
        const hmesh::Mesh mesh = mesh_of_all_parts(channels);
        CHECK(check_read_back(mesh, half_of_8) == std::vector<double>{16, 8, 4, 2, 1});
        hmesh::PageOptions options;
        options.parts = false;
        CHECK(check_read_back(mesh, half_of_8, options) == std::vector<double>{1});
        options.parts = true;
        options.strips = false;
        CHECK(check_read_back(mesh, half_of_8, options) == std::vector<double>{1});
        hmesh::Mesh dim = mesh;
        dim.peak = 65535;
        for (float& color : dim.colors) color *= 257;
        CHECK(check_read_back(dim, half_of_16).front() == 16);
        for (float& color : dim.colors) color /= 25600;
        CHECK(check_read_back(dim, half_of_16) == std::vector<double>{1});
    }
}

TEST_CASE("4 channels are colours drawn straight, masked as a whole by a shading of the fourth, both in parts or not") {
    for (const bool is_large : {false, true}) {
        const hmesh::Mesh mesh = is_large ? mesh_of_all_parts(4) : random_grid(4, 300, 200, 12, 8, 255, 9);
        const std::vector<Object> objects = read_pdf(written(mesh.view()));
        const Object& page = page_of(objects);
        CHECK(follow(objects, page.entries, "/Contents").data == "/G0 gs /X0 Do");
        const Object& group = follow(objects, page.entries, "/X0");
        const Object& mask = follow(objects, follow(objects, page.entries, "/G0").entries, "/SMask << /S /Luminosity /G");
        CHECK(page.entries.find("/Group << /S /Transparency /CS /DeviceRGB >>") != std::string::npos);
        CHECK(group.entries.find("/Group << /S /Transparency /CS /DeviceRGB /I true >>") != std::string::npos);
        CHECK(mask.entries.find("/Group << /S /Transparency /CS /DeviceGray /I true >>") != std::string::npos);
        const auto share = [&](std::size_t v, std::size_t k) { return static_cast<double>(mesh.colors[4 * v + k]) / 255; };
        for (const Object* form : {&group, &mask}) {
            CHECK(form->entries.find("/Subtype /Form") != std::string::npos);
            CHECK(numbers_after(form->entries, "/BBox") ==
                  std::vector<double>{0, 0, static_cast<double>(mesh.width), static_cast<double>(mesh.height)});
        }
        std::vector<double> factors;
        check_drawn(read_shadings(objects, group.entries, group.data, factors), mesh.view(), 3, half_of_8, share);
        CHECK(factors.size() == (is_large ? 5 : 1));
        check_drawn(read_shadings(objects, mask.entries, mask.data, factors), mesh.view(), 1, half_of_8,
                    [&](std::size_t v, std::size_t) { return share(v, 3); });
        CHECK(factors.size() == (is_large ? 5 : 1));
    }
}

TEST_CASE("a compressor is used for the mesh, and where it fails there is a Status and no byte") {
    const hmesh::Mesh mesh = random_grid(4, 400, 300, 60, 40, 255, 10);  // more than one block of 65535 bytes
    hmesh::Mesh opaque = random_grid(3, 400, 300, 60, 40, 255, 10);
    int calls = 0;
    hmesh::PageOptions options;
    options.strips = false;
    const auto count = [&](const unsigned char* bytes, std::size_t size, Bytes& out) {
        ++calls;
        return store(bytes, size, out);
    };
    options.deflate = count;
    const std::vector<Object> objects = read_pdf(written(mesh.view(), options));
    CHECK(calls == 2);
    options.deflate = {};
    const std::vector<Object> plain = read_pdf(written(mesh.view(), options));
    for (const std::size_t i : {6U, 10U}) {
        CHECK(objects[i].entries.find("/Filter /FlateDecode") != std::string::npos);
        CHECK(plain[i].entries.find("/Filter") == std::string::npos);
        REQUIRE(plain[i].data.size() > 65535);
        CHECK(unstored(objects[i].data) == plain[i].data);
    }
    const auto fail_at_last = [&](const unsigned char* bytes, std::size_t size, Bytes& out) {
        return ++calls % 2 == 1 && store(bytes, size, out);  // the mask comes after the colours
    };
    options.deflate = fail_at_last;
    std::string none;
    CHECK(hmesh::write_pdf(mesh.view(), hmesh::kit::append_to(none), options).code == hmesh::Errc::write_failed);
    CHECK(none.empty());
    for (const hmesh::PageOptions::Deflate bad : {fail_to_compress, compress_to_nothing}) {
        options.deflate = bad;
        std::string text;
        for (const hmesh::MeshView& view : {mesh.view(), opaque.view()}) {
            const hmesh::Status status = hmesh::write_pdf(view, hmesh::kit::append_to(text), options);
            CHECK(status.code == hmesh::Errc::write_failed);
            CHECK(status.value == 0);
            CHECK(text.empty());
        }
    }
}

TEST_CASE("a sink that refuses after some bytes gets no more and is reported, wherever that is") {
    check_refusing_sinks(random_grid(4, 64, 48, 18, 14, 255, 11).view(), to_sink);
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") { check_refusals(to_sink); }

TEST_CASE("the bytes do not depend on the locale") {
    const hmesh::Mesh mesh = random_grid(3, 300, 200, 12, 8, 255, 12);
    hmesh_test::check_locale_makes_no_difference(mesh.view(), to_sink);
}

TEST_CASE("a mesh of nothing is a page on which nothing is drawn") {
    check_empty_meshes(to_sink, [](const Bytes& bytes) {
        const std::vector<Object> objects = read_pdf(as_text(bytes));
        const Object& page = page_of(objects);
        CHECK(numbers_after(page.entries, "/MediaBox") == std::vector<double>{0, 0, 3, 2});
        CHECK(follow(objects, page.entries, "/Contents").data.empty());
        for (const Object& object : objects) CHECK(object.entries.find("/ShadingType") == std::string::npos);
    });
}
