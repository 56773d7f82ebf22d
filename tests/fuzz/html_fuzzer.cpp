// Fuzzes write_html(). Tags have to be balanced whatever the texts hold, the texts have to be what was asked for, and the data
// as long as the counts say.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_markup.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/html.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzInput;
using hmesh_test::FuzzText;
using hmesh_test::Tag;

void check_base64(const std::string& text, std::size_t bytes) {
    demand(text.size() == (bytes + 2) / 3 * 4, "base64 is as long as its bytes");
    const std::size_t digits = text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/");
    demand(digits == std::string::npos || text.substr(digits) == (bytes % 3 == 1 ? "==" : "="), "base64 has its letters");
}

void check_data(const std::string& data, const hmesh::MeshView& mesh) {
    FuzzText text(data);
    text.expect("{\"width\":");
    demand(text.whole() == mesh.width, "the page knows the width");
    text.expect(",\"height\":");
    demand(text.whole() == mesh.height, "the page knows the height");
    text.expect(",\"channels\":");
    demand(text.whole() == hmesh_test::channels_written(mesh), "the page knows the channels");
    text.expect(",\"vertices\":");
    demand(text.whole() == static_cast<std::int64_t>(mesh.vertex_count), "the page counts the vertices");
    text.expect(",\"faces\":");
    demand(text.whole() == static_cast<std::int64_t>(mesh.face_count), "the page counts the faces");
    static_cast<void>(text.until(",\"data\":\""));
    const std::size_t vertex = 8 + static_cast<std::size_t>(hmesh_test::channels_written(mesh)),
                      index = mesh.vertex_count <= 65535 ? 2 : 4;
    check_base64(text.until("\"}"), vertex * mesh.vertex_count + 3 * index * mesh.face_count);
}

// Twice, the entities of the other texts of the page aside.
std::string without_entities(const std::string& text) {
    std::string out;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const std::pair<const char*, char> known[] = {
            {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&#39;", '\''}};
        char c = text[at];
        for (const auto& [entity, meant] : known)
            if (c == '&' && text.compare(at, std::char_traits<char>::length(entity), entity) == 0) {
                c = meant;
                at += std::char_traits<char>::length(entity) - 1;
                break;
            }
        out += c;
    }
    return out;
}

void check_file(const std::string& file, const hmesh::MeshView& mesh, const hmesh::HtmlOptions& options) {
    demand(file.compare(0, 16, "<!DOCTYPE html>\n") == 0, "the page says that it is HTML");
    std::size_t scripts = 0, meshes = 0, pictures = 0;
    const std::string words = hmesh_test::read_markup(file, true, [&](const Tag& tag) {
        if (tag.name == "script" && tag.attribute("id") == "data") ++meshes, check_data(tag.content, mesh);
        if (tag.name == "script" && tag.attribute("type") == "module") ++scripts;
        if (tag.name != "img") return;
        ++pictures;
        const std::string source = tag.attribute("src");
        FuzzText text(source);
        text.expect("data:");
        text.expect(options.original_type);
        text.expect(";base64,");
        check_base64(source.substr(text.at()), options.original_size);
    });
    demand(scripts == 1 && meshes == 1, "the page has a mesh and a script that draws it");
    demand(pictures == (options.original != nullptr && options.original_size > 0 ? 1U : 0U), "the page shows the original");
    const std::string shown = without_entities(words), title = options.title;
    const std::size_t first = shown.find(title);
    demand(first != std::string::npos && shown.find(title, first + title.size()) != std::string::npos,
           "the title is there twice");
    demand(shown.find(options.figures) != std::string::npos, "the figures are shown");
    demand(shown.find(options.notes) != std::string::npos, "the notes are shown");
}

std::string draw_text(FuzzInput& input) {
    std::string text;
    for (int count = input.within(0, 30); count > 0; --count) {
        const auto c = static_cast<char>(input.byte());
        text += c == 0 ? '<' : c;
    }
    return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    FuzzInput input(bytes, size);
    hmesh::HtmlOptions options;
    const std::string title = draw_text(input), figures = draw_text(input), type = draw_text(input);
    const bool has_texts = !input.one_in(32), has_type = !input.one_in(4);
    options.title = has_texts ? title.c_str() : nullptr;
    options.notes = type.c_str();
    options.figures = input.one_in(64) ? nullptr : figures.c_str();
    if (has_type) options.original_type = "image/webp";
    else options.original_type = input.one_in(16) ? nullptr : type.c_str();
    std::vector<unsigned char> original;
    if (input.one_in(3)) {
        original.resize(static_cast<std::size_t>(input.within(1, 40)));
        for (unsigned char& b : original) b = input.byte();
        options.original = original.data();
        options.original_size = original.size() - (input.one_in(8) ? original.size() : 0);
        options.original_orientation = input.one_in(16) ? 0 : input.within(1, 8);
    }
    hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    mesh.is_good = mesh.is_good && has_texts && has_type && options.figures != nullptr && options.original_orientation > 0;
    hmesh_test::fuzz_exporter(
        input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_html(view, sink, options); },
        [&](const std::string& file, const hmesh::MeshView& view) { check_file(file, view, options); });
    return 0;
}
