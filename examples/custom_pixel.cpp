// custom_pixel - meshes an image whose samples are of a type of its own: 10 bits in the upper bits of a 16-bit word, as
// many video frames store them (P010). All that hmesh must know is in one specialisation of PixelTraits.
#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "hmesh/mesh_image.hpp"

struct Video10 {
    std::uint16_t word = 0;
};

template <>
struct hmesh::PixelTraits<Video10> {
    static constexpr double peak = 1023;  // full intensity
    static constexpr double lowest = 0, highest = 1023;
    static constexpr bool is_integer = true;  // to_real yields whole numbers: moments are exact
    static double to_real(Video10 sample) noexcept { return sample.word >> 6; }
    static Video10 from_real(double value) noexcept {
        const double held = value > lowest ? (value < highest ? value : highest) : lowest;
        return {static_cast<std::uint16_t>(static_cast<unsigned>(held + 0.5) << 6)};
    }
};

namespace {

// A bright disc on a dark slope.
hmesh::Image<Video10, 1> draw_frame(int width, int height) {
    hmesh::Image<Video10, 1> frame(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int dx = x - width / 3, dy = y - height / 2;
            const bool inside = dx * dx + dy * dy < height * height / 9;
            *frame.pixel(x, y) = hmesh::PixelTraits<Video10>::from_real(inside ? 900 - y : 100 + 300.0 * x / width);
        }
    return frame;
}

}  // namespace

int main() {
    const hmesh::Image<Video10, 1> frame = draw_frame(320, 180);
    hmesh::Options options;
    options.target = hmesh::Target::vertices(400);
    const hmesh::Result result = hmesh::mesh_image(frame.view(), options);
    if (!result.has_mesh()) {
        std::fprintf(stderr, "custom_pixel: %s\n", hmesh::message(result.status).c_str());
        return 1;
    }
    const float darkest = *std::min_element(result.mesh.colors.begin(), result.mesh.colors.end());
    const float brightest = *std::max_element(result.mesh.colors.begin(), result.mesh.colors.end());
    std::printf("%zu vertices, %zu faces, PSNR %.2f dB, colours from %.0f to %.0f of %.0f\n", result.report.vertices,
                result.report.faces, result.report.psnr, static_cast<double>(darkest), static_cast<double>(brightest),
                result.mesh.peak);
    return 0;
}
