// Compiled twice into one program, for any processor and for one with wider vectors: what both have under one name the linker
// takes from either.
#include <cstddef>
#include <cstdint>

#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/methods/hierarchical/bilateral.hpp"
#include "hmesh/solve/sampled_colors.hpp"

double HMESH_TEST_PART() {
    hmesh::Image<std::uint8_t, 3> image(37, 29);
    for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = static_cast<std::uint8_t>(i * 7 % 256);
    const hmesh::kit::ImageSource<3> source(image.view());
    const hmesh::kit::MomentTable<3> table = source.table({0, 0, 37, 29});
    const hmesh::Image<std::uint8_t, 3> filtered = hmesh::kit::bilateral_filter(image.view());
    double sum = 0;
    for (int y = 0; y < 29; ++y)
        for (int x = 0; x < 37; ++x) {
            sum += (source.pixel(x, y) * (1.0 + x)).sum();
            sum += hmesh::kit::sampled_color(table, {x + 0.25, y + 0.75}).sum();
            for (int c = 0; c < 3; ++c) sum += filtered.pixel(x, y)[c];
        }
    return sum;
}
