// table: fidelity, time and memory of mesh_image over images, rates and efforts, as a Markdown table.
//
//     table [--rates 1,2,3] [--efforts draft,fast] [--seeds 1,2,3] [--repeat 5] IMAGE...
//
// PSNR is that of the report (mean over seeds): 10 log10(255^2 / MSE), MSE over pixels and channels of the final mesh.
// Seconds are processor time of one thread from decoded pixels to finished mesh, the least of the repeats; memory is the
// most that was allocated at once beyond the image itself.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/hmesh.hpp>

#include "image_file.hpp"

#include <malloc.h>

namespace {

// --- memory: every allocation of the program is counted ---
std::size_t allocated = 0, most_allocated = 0;

void* count_in(void* p) {
    if (p == nullptr) std::abort();
    allocated += malloc_usable_size(p);
    most_allocated = std::max(most_allocated, allocated);
    return p;
}
void count_out(void* p) {
    if (p == nullptr) return;
    allocated -= malloc_usable_size(p);
    std::free(p);
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> parts;
    std::size_t start = 0;
    for (std::size_t comma; (comma = list.find(',', start)) != std::string::npos; start = comma + 1)
        parts.push_back(list.substr(start, comma - start));
    parts.push_back(list.substr(start));
    return parts;
}

bool effort_of(const std::string& name, hmesh::Effort& effort) {
    const std::pair<const char*, hmesh::Effort> names[] = {{"draft", hmesh::Effort::draft},
                                                           {"fast", hmesh::Effort::fast},
                                                           {"normal", hmesh::Effort::normal},
                                                           {"best", hmesh::Effort::best}};
    for (const auto& [known, value] : names)
        if (name == known) {
            effort = value;
            return true;
        }
    return false;
}

}  // namespace

void* operator new(std::size_t size) { return count_in(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    const auto a = static_cast<std::size_t>(alignment);
    return count_in(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* p) noexcept { count_out(p); }
void operator delete(void* p, std::size_t) noexcept { count_out(p); }
void operator delete(void* p, std::align_val_t) noexcept { count_out(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { count_out(p); }

int main(int argc, char** argv) {
    std::vector<std::string> rates{"1", "2", "3"}, efforts{"draft", "fast"}, seeds{"1"}, images;
    int repeats = 3;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool has_value = i + 1 < argc;
        if (argument == "--rates" && has_value) rates = split(argv[++i]);
        else if (argument == "--efforts" && has_value) efforts = split(argv[++i]);
        else if (argument == "--seeds" && has_value) seeds = split(argv[++i]);
        else if (argument == "--repeat" && has_value) repeats = std::max(1, std::atoi(argv[++i]));
        else images.push_back(argument);
    }
    if (images.empty()) {
        std::fprintf(stderr, "usage: table [--rates 1,2,3] [--efforts draft,fast] [--seeds 1] [--repeat 3] IMAGE...\n");
        return 2;
    }
    std::printf("| image | %% | effort | vertices | PSNR dB | s | us a vertex | ns a pixel | MB at most |\n|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& path : images) {
        example::ImageFile image;
        const std::string why = example::read_image(path, image);
        if (!why.empty() || image.channels != 3 || image.bits != 8) {
            std::fprintf(stderr, "table: %s: %s\n", path.c_str(), why.empty() ? "not 3 channels of 8 bits" : why.c_str());
            return 1;
        }
        const int width = image.width, height = image.height;
        const hmesh::ImageView<std::uint8_t, 3> view{image.samples8.data(), width, height, 0};
        for (const std::string& rate : rates)
            for (const std::string& name : efforts) {
                hmesh::Options options;
                options.target = hmesh::Target::rate(std::atof(rate.c_str()));
                if (!effort_of(name, options.effort)) {
                    std::fprintf(stderr, "table: no effort is called %s\n", name.c_str());
                    return 2;
                }
                double psnr = 0, seconds = 1e300;
                std::size_t vertices = 0, bytes = 0;
                for (const std::string& seed : seeds) {
                    options.seed = static_cast<std::uint64_t>(std::atoll(seed.c_str()));
                    for (int k = 0; k < repeats; ++k) {
                        const std::size_t before = allocated;
                        most_allocated = allocated;
                        const double start = processor_seconds();
                        const auto result = hmesh::mesh_image(view, options);
                        seconds = std::min(seconds, processor_seconds() - start);
                        if (!result.status) {
                            std::fprintf(stderr, "table: %s: %s\n", path.c_str(), result.status.what);
                            return 1;
                        }
                        bytes = std::max(bytes, most_allocated - before);
                        vertices = result.report.vertices;
                        if (k == 0) psnr += result.report.psnr / static_cast<double>(seeds.size());
                    }
                }
                const std::size_t slash = path.find_last_of('/');
                std::printf("| %s | %s | %s | %zu | %.3f | %.4f | %.1f | %.0f | %.1f |\n",
                            path.substr(slash == std::string::npos ? 0 : slash + 1).c_str(), rate.c_str(), name.c_str(), vertices,
                            psnr, seconds, 1e6 * seconds / static_cast<double>(vertices),
                            1e9 * seconds / (static_cast<double>(width) * height), 1e-6 * static_cast<double>(bytes));
                std::fflush(stdout);
            }
    }
    return 0;
}
