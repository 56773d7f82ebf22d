// tools - which of the files written are slow to look at, and what to take instead.
#ifndef HMESH_TOOLS_RESULTS_ADVICE_HPP
#define HMESH_TOOLS_RESULTS_ADVICE_HPP

#include <cstddef>
#include <cstdio>
#include <string>

#include "arguments/arguments.hpp"
#include "terminal/standard_streams.hpp"

namespace tool {

// What draws a kind of file slowly: `from` so many vertices on it takes some ten seconds, which a reader takes for a fault of
// the file. Seconds are a straight line through those that docs/formats.md measures on a picture of 2048 x 1536 px.
struct SlowViewer {
    const char* who;
    std::size_t from;                 // vertices
    double seconds, seconds_of_1000;  // of the picture, and of 1,000 vertices
};
inline constexpr SlowViewer slow_gradient_svg = {"browsers take", 20000, 2, 0.4};
inline constexpr SlowViewer slow_exact_svg = {"browsers take", 6000, 3, 1.2};
inline constexpr SlowViewer slow_flat_svg = {"browsers take", 40000, 1, 0.2};
inline constexpr SlowViewer slow_pdf = {"poppler (Okular, pdftoppm) takes", 50000, 5, 0.1};

// The number in groups of three digits: 94,372.
[[nodiscard]] inline std::string in_groups(std::size_t number) {
    std::string digits = std::to_string(number);
    for (std::size_t i = digits.size(); i > 3;) digits.insert(i -= 3, ",");
    return digits;
}

// What to say of a file that holds so many vertices; empty: nothing.
[[nodiscard]] inline std::string advice(const MeshFile& file, std::size_t vertices, hmesh::SvgOptions::Kind svg) {
    const SlowViewer* viewer = nullptr;
    if (file.ending == ".pdf") viewer = &slow_pdf;
    if (file.ending == ".svg")
        viewer = svg == hmesh::SvgOptions::Kind::exact  ? &slow_exact_svg
                 : svg == hmesh::SvgOptions::Kind::flat ? &slow_flat_svg
                                                        : &slow_gradient_svg;
    if (viewer == nullptr || vertices < viewer->from) return {};
    const double seconds = viewer->seconds + viewer->seconds_of_1000 * static_cast<double>(vertices) / 1000;
    return output_name(file.name) + " has " + in_groups(vertices) + " vertices: " + viewer->who + " about " +
           in_groups(static_cast<std::size_t>(seconds + 0.5)) + " s to draw it; .html or .glb draw at once";
}

// Says so of each mesh that was written.
inline void print_advice(std::FILE* to, const Arguments& arguments, std::size_t vertices) {
    for (const MeshFile& file : arguments.meshes)
        if (const std::string words = advice(file, vertices, arguments.svg); !words.empty())
            std::fprintf(to, "note      %s\n", words.c_str());
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_ADVICE_HPP
