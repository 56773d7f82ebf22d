// Fuzzes write_svg(). The file has to be XML in which every number is one, every gradient that is used is there, and every
// face is drawn.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_markup.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/svg.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzText;
using hmesh_test::Tag;

// Letters and numbers by turns.
void check_outline(const std::string& outline) {
    FuzzText text(outline);
    demand(text.next() == 'M', "an outline begins with M");
    while (text.left() > 0)
        if (!text.accept("M") && !text.accept("H") && !text.accept("V") && !text.accept("z") && !text.accept(" "))
            static_cast<void>(text.number());
}

void check_color(const std::string& color) {
    demand(color.size() == 7 && color[0] == '#' && color.find_first_not_of("0123456789abcdef", 1) == std::string::npos,
           "a colour has six digits");
}

void check_file(const std::string& file, const hmesh::MeshView& mesh, const hmesh::SvgOptions& options) {
    std::set<std::string> ids;
    std::size_t faces = 0, wires = 0;
    bool is_masked = false;
    double last_offset = 0;
    hmesh_test::read_markup(file, false, [&](const Tag& tag) {
        const std::string id = tag.attribute("id");
        if (!id.empty()) demand(ids.insert(id).second, "an id is there once");
        is_masked = is_masked || tag.name == "mask";
        for (const auto& [key, value] : tag.attributes)
            if (key == "x1" || key == "y1" || key == "x2" || key == "y2" || key == "offset" || key == "width" ||
                key == "height") {
                FuzzText text(value);
                static_cast<void>(text.number());
                text.expect_end();
            }
        if (tag.name == "linearGradient") last_offset = 0;
        if (tag.name == "stop") {
            check_color(tag.attribute("stop-color"));
            const std::string words = tag.attribute("offset");
            FuzzText text(words);
            const double offset = text.number();
            demand(offset >= last_offset && offset <= 1, "stops follow one another");
            last_offset = offset;
        }
        if (tag.name != "path") return;
        check_outline(tag.attribute("d"));
        const std::string fill = tag.attribute("fill");
        if (fill == "none") ++wires;
        else if (!fill.empty()) {
            ++faces;
            if (fill[0] == '#') check_color(fill);
            else demand(ids.count(fill.substr(5, fill.size() - 6)) == 1, "a fill is a gradient above it");
        }
    });
    const std::size_t layers = mesh.channels > 1 && options.kind == hmesh::SvgOptions::Kind::exact ? 3 : 1;
    demand(faces == mesh.face_count * (layers + (is_masked ? 1 : 0)), "every face is drawn in every layer");
    demand(wires == (options.wireframe && mesh.face_count > 0 ? 1 : 0), "the wireframe is drawn if it is wanted");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::SvgOptions options;
    const unsigned kind = input.byte();
    const bool is_known = kind < 200;
    options.kind = static_cast<hmesh::SvgOptions::Kind>(is_known ? kind % 3 : kind);
    options.wireframe = input.one_in(3);
    hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    mesh.is_good = mesh.is_good && is_known;
    hmesh_test::fuzz_exporter(
        input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_svg(view, sink, options); },
        [&](const std::string& file, const hmesh::MeshView& view) {
            demand(is_known, "a kind that means nothing is refused");
            check_file(file, view, options);
        });
    return 0;
}
