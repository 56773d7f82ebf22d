// table: fidelity, time and memory of mesh_image() over images, sizes and efforts, as a Markdown table.
//
//     table [--rates 1,2,3 | --vertices 1000,2000] [--efforts draft,fast] [--seeds 1,2,3] [--repeat 5] [--threads 2]
//           [--mosaic COLUMNSxROWS] IMAGE...
//
// PSNR is that of the report (mean over seeds): 10 log10(255^2 / MSE), MSE over pixels and channels of the final mesh.
// Seconds are from decoded pixels to finished mesh, the least of the repeats: CPU s is processor time of the whole
// process, all threads together, as are us a vertex and ns a pixel; wall s is what one waits. Memory is the most that
// was allocated at once beyond the image itself. The hash is FNV-1a of 64 bits over positions, colours and faces, for
// all seeds one after another: where it is the same, the meshes are. Repeats that differ are an error.
//
// --mosaic meshes one large image in place of the single ones: those of the first one's size, and those of its
// transpose's size turned by 90 degrees, laid out row by row and over again until the grid is full. Others are left
// out.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/hmesh.hpp>

#include "common.hpp"
#include "thread_pool.hpp"

#include <malloc.h>

namespace {

using bench::Picture;

// --- memory: every allocation of the program is counted, on any thread ---
std::atomic<std::size_t> allocated{0}, most_allocated{0};

void* count_in(void* p) {
    if (p == nullptr) std::abort();
    const std::size_t size = malloc_usable_size(p), now = allocated.fetch_add(size) + size;
    for (std::size_t most = most_allocated; most < now && !most_allocated.compare_exchange_weak(most, now);) {
    }
    return p;
}
void count_out(void* p) {
    if (p == nullptr) return;
    allocated -= malloc_usable_size(p);
    std::free(p);
}

// --- what to measure ---
struct Plan {
    std::vector<std::string> sizes{"1", "2", "3"};  // percent, or numbers of vertices
    bool by_vertices = false;
    std::vector<std::string> efforts{"draft", "fast"}, seeds{"1"}, images;
    int repeats = 3;
    unsigned threads = 1;
    int columns = 0, rows = 0;  // of a mosaic; 0: none
};

int to_int(const std::string& text) { return std::atoi(text.c_str()); }

bool parse_grid(const std::string& text, int& columns, int& rows) {
    int read = 0;
    const bool good = std::sscanf(text.c_str(), "%4dx%4d%n", &columns, &rows, &read) == 2;
    return good && text.c_str()[read] == '\0' && columns > 0 && rows > 0;
}

// Reads the command line. False where it is wrong.
bool parse(int argc, char** argv, Plan& plan) {
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.compare(0, 2, "--") != 0) {
            plan.images.push_back(argument);
            continue;
        }
        if (i + 1 == argc) return false;
        const std::string value = argv[++i];
        if (argument == "--rates" || argument == "--vertices") {
            plan.sizes = bench::split(value);
            plan.by_vertices = argument == "--vertices";
        } else if (argument == "--efforts") plan.efforts = bench::split(value);
        else if (argument == "--seeds") plan.seeds = bench::split(value);
        else if (argument == "--repeat") plan.repeats = std::max(1, to_int(value));
        else if (argument == "--threads") plan.threads = static_cast<unsigned>(std::clamp(to_int(value), 0, 1024));
        else if (argument != "--mosaic" || !parse_grid(value, plan.columns, plan.rows)) return false;
    }
    return !plan.images.empty();
}

// --- images ---
// By 90 degrees, clockwise.
Picture turned(const Picture& from) {
    Picture to(from.height(), from.width());
    for (int y = 0; y < to.height(); ++y)
        for (int x = 0; x < to.width(); ++x) std::copy_n(from.pixel(y, from.height() - 1 - x), 3, to.pixel(x, y));
    return to;
}

// The mosaic of the plan's images. Says why not.
std::optional<Picture> read_mosaic(const Plan& plan) {
    std::vector<Picture> tiles;
    for (const std::string& path : plan.images) {
        std::optional<Picture> picture = bench::read("table", path);
        if (!picture) return {};
        const int width = tiles.empty() ? picture->width() : tiles[0].width();
        const int height = tiles.empty() ? picture->height() : tiles[0].height();
        if (picture->width() == width && picture->height() == height) tiles.push_back(std::move(*picture));
        else if (picture->width() == height && picture->height() == width) tiles.push_back(turned(*picture));
        else std::fprintf(stderr, "table: %s is left out: not %d x %d px\n", path.c_str(), width, height);
    }
    const hmesh::ImageView<std::uint8_t, 3> view = tiles[0].view();
    const std::int64_t width = std::int64_t{view.width} * plan.columns, height = std::int64_t{view.height} * plan.rows;
    if (width > hmesh::kit::max_side || height > hmesh::kit::max_side || width * height > hmesh::kit::max_pixels) {
        std::fprintf(stderr, "table: the mosaic would be too large\n");
        return {};
    }
    return bench::mosaic_of(tiles, plan.columns, plan.rows);
}

// --- measuring ---
struct Row {
    std::size_t vertices = 0, bytes = 0;
    double psnr = 0, cpu_seconds = 1e300, wall_seconds = 1e300;
    std::uint64_t hash = bench::empty_hash;
    const char* fault = nullptr;  // why there are no figures
};

// Meshes the image for all seeds and repeats.
Row measure(const Picture& image, const hmesh::Options& options, hmesh::Annealed recipe, const Plan& plan,
            const example::ThreadPool& pool) {
    Row row;
    for (const std::string& seed : plan.seeds) {
        recipe.seed = static_cast<std::uint64_t>(std::atoll(seed.c_str()));
        std::uint64_t first = 0;
        for (int k = 0; k < plan.repeats; ++k) {
            const std::size_t before = allocated;
            most_allocated = before;
            const double cpu_start = bench::processor_seconds(), wall_start = bench::wall_seconds();
            const hmesh::Result result = hmesh::mesh_image(image.view(), options, recipe, pool);
            row.wall_seconds = std::min(row.wall_seconds, bench::wall_seconds() - wall_start);
            row.cpu_seconds = std::min(row.cpu_seconds, bench::processor_seconds() - cpu_start);
            row.bytes = std::max(row.bytes, most_allocated - before);
            const std::uint64_t hash = bench::hash_of(result.mesh);
            if (!result.status) row.fault = result.status.what;
            else if (k > 0 && hash != first) row.fault = "two runs gave different meshes";
            if (row.fault != nullptr) return row;
            first = hash;
            if (k > 0) continue;
            row.vertices = result.report.vertices;
            row.psnr += result.report.psnr / static_cast<double>(plan.seeds.size());
            row.hash = bench::hash_of(result.mesh, row.hash);
        }
    }
    return row;
}

// Prints the rows of one image. The exit status.
int tabulate(const std::string& name, const Picture& image, const Plan& plan, const example::ThreadPool& pool) {
    const double pixels = static_cast<double>(image.width()) * image.height();
    for (const std::string& size : plan.sizes)
        for (const std::string& effort : plan.efforts) {
            hmesh::Options options;
            options.target = plan.by_vertices ? hmesh::Target::vertices(std::atoll(size.c_str()))
                                              : hmesh::Target::percent(std::atof(size.c_str()));
            hmesh::Annealed recipe;
            if (!bench::effort_of(effort, recipe.effort)) {
                std::fprintf(stderr, "table: no effort is called %s\n", effort.c_str());
                return 2;
            }
            const Row row = measure(image, options, recipe, plan, pool);
            if (row.fault != nullptr) {
                std::fprintf(stderr, "table: %s: %s\n", name.c_str(), row.fault);
                return 1;
            }
            const auto vertices = static_cast<double>(row.vertices);
            std::printf("| %s | %.3g | %s | %zu | %zu | %.3f | %.4f | %.4f | %.1f | %.0f | %.1f | %016llx |\n", name.c_str(),
                        100 * vertices / pixels, effort.c_str(), pool.threads(), row.vertices, row.psnr, row.cpu_seconds,
                        row.wall_seconds, 1e6 * row.cpu_seconds / vertices, 1e9 * row.cpu_seconds / pixels,
                        1e-6 * static_cast<double>(row.bytes), static_cast<unsigned long long>(row.hash));
            std::fflush(stdout);
        }
    return 0;
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
    Plan plan;
    if (!parse(argc, argv, plan)) {
        std::fprintf(stderr,
                     "usage: table [--rates 1,2,3 | --vertices N,...] [--efforts draft,fast] [--seeds 1]\n"
                     "             [--repeat 3] [--threads 1] [--mosaic COLUMNSxROWS] IMAGE...\n");
        return 2;
    }
    const example::ThreadPool pool(plan.threads);
    std::printf(
        "| image | %% | effort | threads | vertices | PSNR dB | CPU s | wall s | us a vertex | ns a pixel |"
        " MB at most | hash |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    if (plan.columns > 0) {
        const std::optional<Picture> image = read_mosaic(plan);
        if (!image) return 1;
        const std::string size = std::to_string(image->width()) + " x " + std::to_string(image->height());
        return tabulate("mosaic of " + size, *image, plan, pool);
    }
    for (const std::string& path : plan.images) {
        const std::optional<Picture> image = bench::read("table", path);
        if (!image) return 1;
        if (const int status = tabulate(bench::file_name(path), *image, plan, pool); status != 0) return status;
    }
    return 0;
}
