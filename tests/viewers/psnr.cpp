// psnr - how far apart two pictures are: psnr REFERENCE PICTURE [LEAST]
//
// Prints 10 log10(255^2 / MSE) in dB, MSE the mean over pixels and channels; "inf" for equal pictures. The channels are
// those of the reference, to which the picture is converted. Exit status 0; 1 when the PSNR is below LEAST; 2 when a
// picture cannot be read or the sizes differ.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

int main(int argc, char** argv) {
    if (argc != 3 && argc != 4) return std::fprintf(stderr, "usage: psnr REFERENCE PICTURE [LEAST]\n"), 2;
    int width = 0, height = 0, channels = 0, other_width = 0, other_height = 0;
    const unsigned char* reference = stbi_load(argv[1], &width, &height, &channels, 0);
    if (reference == nullptr) return std::fprintf(stderr, "%s: %s\n", argv[1], stbi_failure_reason()), 2;
    const unsigned char* picture = stbi_load(argv[2], &other_width, &other_height, nullptr, channels);
    if (picture == nullptr) return std::fprintf(stderr, "%s: %s\n", argv[2], stbi_failure_reason()), 2;
    if (width != other_width || height != other_height)
        return std::fprintf(stderr, "%s: %d x %d, %s: %d x %d\n", argv[1], width, height, argv[2], other_width,
                            other_height),
               2;
    const long long samples = 1LL * width * height * channels;
    double energy = 0;
    for (long long i = 0; i < samples; ++i) {
        const double difference = static_cast<double>(reference[i]) - static_cast<double>(picture[i]);
        energy += difference * difference;
    }
    const double psnr = energy > 0 ? 10 * std::log10(255.0 * 255.0 * static_cast<double>(samples) / energy)
                                   : std::numeric_limits<double>::infinity();
    std::printf("%.2f\n", psnr);
    return argc == 4 && !(psnr >= std::atof(argv[3])) ? 1 : 0;
}
