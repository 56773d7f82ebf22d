// Fuzzes outline(): any small mask with any options; the outline must have every pixel that counts inside, no two sides that meet
// and faces that divide the inside between them, in no more vertices and no more area than it was told.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz_input.hpp"
#include "hmesh/outline.hpp"
#include "test_outlines.hpp"

namespace {

using hmesh_test::demand;

// Runs of pixels in and out.
hmesh_test::AlphaImage draw_mask(hmesh_test::FuzzInput& input) {
    hmesh_test::AlphaImage image(input.within(1, 40), input.within(1, 40));
    const bool is_noise = input.one_in(3);
    unsigned run = 0;
    bool is_in = false;
    for (std::size_t k = 1; k < image.size(); k += 2) {
        if (is_noise) {
            if (run == 0) run = 0x100U | input.byte();
            image.data()[k] = (run & 1U) != 0 ? 255 : 0;
            run = run == 1 ? 0 : run >> 1U;
            if (run == 1) run = 0;
        } else {
            if (run == 0) is_in = !is_in, run = 1U + input.byte() % 50U;
            image.data()[k] = is_in ? 255 : 0;
            --run;
        }
    }
    return image;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::OutlineOptions options;
    options.margin = input.one_of<double>({0, 0.5, 0.5, 1, 0.3, 0.75, 3, 64});
    options.tolerance = input.one_of<double>({0, 0.2, 1, 1, 5, 1000});
    options.holes = !input.one_in(4);
    if (input.flag()) options.max_vertices = input.within(4, 60);
    const bool is_wild = input.one_in(8);
    if (is_wild) {
        options.margin = input.wild_real();
        options.tolerance = input.wild_real();
        options.threshold = input.wild_real();
        options.max_vertices = input.wild_int();
    }
    const hmesh_test::AlphaImage image = draw_mask(input);
    const hmesh::Outline outline = hmesh::outline(image.view(), options);
    demand(static_cast<bool>(outline.status) == (*outline.status.what == 0), "a status has a sentence if and only if it is bad");
    demand(outline.status || is_wild, "good options are taken");
    if (!outline.status) {
        demand(outline.mesh.faces.empty() && outline.loops.empty(), "what is refused has no outline");
        return 0;
    }
    hmesh_test::UnitLoops loops;
    const auto unit = [&](std::size_t i) {
        return static_cast<std::int64_t>(256 * static_cast<double>(outline.mesh.positions[i]));
    };
    for (const auto& loop : outline.loops) {
        loops.emplace_back();
        for (const std::size_t v : loop) loops.back().push_back({unit(2 * v), unit(2 * v + 1)});
    }
    const auto counts = [&](int x, int y) { return image.pixel(x, y)[1] > options.threshold; };
    const std::int64_t margin = std::lround(256 * options.margin);
    demand(hmesh_test::flaw_of_loops(loops, image.width(), image.height(), margin, counts).empty(), "an outline covers");
    demand(hmesh_test::flaw_of_faces(loops, outline.mesh.faces).empty(), "faces divide the inside");
    if (options.max_vertices != 0)
        demand(outline.mesh.vertex_count() <= static_cast<std::size_t>(options.max_vertices), "no more vertices than asked for");
    else
        demand(outline.area <= (outline.covered + options.tolerance * outline.length) * (1 + 1e-12), "no more area than allowed");
    return 0;
}
