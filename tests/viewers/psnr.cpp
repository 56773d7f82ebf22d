// psnr - how alike two pictures of the same size are: psnr FILE REFERENCE [LEAST]
//
// Prints 10 log10(255^2 / MSE) in dB, MSE the mean over pixels and channels of the squared differences of the 8-bit values,
// and exits with 1 below LEAST. Pictures with alpha are compared as seen over mid grey.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

namespace {

struct Picture {
    int width = 0, height = 0;
    std::unique_ptr<stbi_uc, void (*)(void*)> pixels{nullptr, stbi_image_free};  // RGBA

    explicit Picture(const char* path) {
        int channels = 0;
        pixels.reset(stbi_load(path, &width, &height, &channels, 4));
        if (!pixels) std::fprintf(stderr, "psnr: cannot read '%s'\n", path);
    }
    [[nodiscard]] double seen(std::size_t pixel, std::size_t channel) const {
        const stbi_uc* at = pixels.get() + 4 * pixel;
        const double alpha = at[3] / 255.0;
        return alpha * at[channel] + (1 - alpha) * 128;
    }
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3 && argc != 4) {
        std::fprintf(stderr, "usage: psnr FILE REFERENCE [LEAST]\n");
        return 2;
    }
    const Picture a(argv[1]), b(argv[2]);
    if (!a.pixels || !b.pixels) return 2;
    if (a.width != b.width || a.height != b.height) {
        std::fprintf(stderr, "psnr: the sizes differ: %d x %d and %d x %d\n", a.width, a.height, b.width, b.height);
        return 1;
    }
    const std::size_t count = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k) sum += std::pow(a.seen(i, k) - b.seen(i, k), 2);
    const double psnr = 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(count) / sum);  // infinity for 0
    std::printf("%.2f dB\n", psnr);
    return argc == 4 && !(psnr >= std::atof(argv[3])) ? 1 : 0;
}
