// terrain: meshes within a bound by each effort of Bounded, as a Markdown table for each heightmap.
//
//     terrain [--percent 10,5,2,1,0.5] [--effort draft,fast,normal,best] [--samples points|squares] [--free-borders]
//             [--mosaic COLUMNSxROWS] [--repeat 1] FILE.pgm...
//
// Files are binary PGM of 8 or 16 bits. A row is a bound, in percent of the range of the heightmap, and in stored values; columns
// are for each effort the triangles, their ratio to those of greedy insertion (draft), and processor seconds and microseconds a
// sample, the least of `repeat` runs. All four come from one run in turn; the last column says whether each kept its bound.
//
// --mosaic meshes so many copies of the heightmap in its place, every second one mirrored, so that no cliff is between them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/hmesh.hpp>
#include <hmesh/terrain.hpp>

#include "common.hpp"

namespace {

bool read(const std::string& name, hmesh::Image<std::uint16_t, 1>& image) {
    std::ifstream in(name, std::ios::binary);
    std::string magic;
    int width = 0, height = 0, most = 0;
    in >> magic >> width >> height >> most;
    in.get();
    if (!in || magic != "P5" || width < 2 || height < 2) return false;
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    image = hmesh::Image<std::uint16_t, 1>(width, height);
    const std::size_t size = most > 255 ? 2 : 1;
    if (bytes.size() < size * image.size()) return false;
    for (std::size_t k = 0; k < image.size(); ++k) {
        const auto byte = [&](std::size_t at) { return static_cast<unsigned>(static_cast<unsigned char>(bytes[at])); };
        image.data()[k] = static_cast<std::uint16_t>(size == 1 ? byte(k) : byte(2 * k) * 256 + byte(2 * k + 1));
    }
    return true;
}

// Copies of a heightmap side by side, every second one mirrored.
hmesh::Image<std::uint16_t, 1> mosaic_of(const hmesh::Image<std::uint16_t, 1>& tile, int columns, int rows) {
    hmesh::Image<std::uint16_t, 1> mosaic(columns * tile.width(), rows * tile.height());
    const auto place = [](int k, int size) { return k / size % 2 == 0 ? k % size : size - 1 - k % size; };
    for (int y = 0; y < mosaic.height(); ++y)
        for (int x = 0; x < mosaic.width(); ++x)
            *mosaic.pixel(x, y) = *tile.pixel(place(x, tile.width()), place(y, tile.height()));
    return mosaic;
}

}  // namespace

int main(int argc, char** argv) {
    using Effort = hmesh::Bounded::Effort;
    const std::pair<const char*, Effort> names[] = {
        {"draft", Effort::draft}, {"fast", Effort::fast}, {"normal", Effort::normal}, {"best", Effort::best}};
    std::string percents = "10,5,2,1,0.5", wanted = "draft,fast,normal,best";
    hmesh::Options options;
    options.samples = hmesh::Samples::points;
    hmesh::Bounded recipe;
    int repeat = 1, columns = 1, rows = 1;
    std::vector<std::string> files;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool has_value = i + 1 < argc;
        if (word == "--percent" && has_value) percents = argv[++i];
        else if (word == "--effort" && has_value) wanted = argv[++i];
        else if (word == "--samples" && has_value)
            options.samples = std::string(argv[++i]) == "squares" ? hmesh::Samples::squares : hmesh::Samples::points;
        else if (word == "--repeat" && has_value) repeat = std::max(1, std::atoi(argv[++i]));
        else if (word == "--mosaic" && has_value && std::sscanf(argv[++i], "%4dx%4d", &columns, &rows) == 2)
            columns = std::max(1, columns), rows = std::max(1, rows);
        else if (word == "--free-borders") recipe.free_borders = true;
        else files.push_back(word);
    }
    if (files.empty() || files[0].rfind("--", 0) == 0) {
        std::fprintf(stderr,
                     "usage: terrain [--percent 10,5,2,1,0.5] [--effort draft,fast,normal,best] [--samples points] "
                     "[--free-borders] [--mosaic 1x1] [--repeat 1] FILE.pgm...\n");
        return 2;
    }
    const std::vector<std::string> efforts = bench::split(wanted);
    for (const std::string& file : files) {
        hmesh::Image<std::uint16_t, 1> image;
        if (!read(file, image)) {
            std::fprintf(stderr, "terrain: %s: not a binary PGM\n", file.c_str());
            return 1;
        }
        if (columns > 1 || rows > 1) image = mosaic_of(image, columns, rows);
        const auto [low, high] = std::minmax_element(image.data(), image.data() + image.size());
        const double range = *high - *low;
        std::printf("\n%s, %d x %d, range %g\n\n| %% | bound |", file.c_str(), image.width(), image.height(), range);
        for (const std::string& effort : efforts) std::printf(" %s | ratio | s | us |", effort.c_str());
        std::printf(" kept |\n|---|---|");
        for (std::size_t k = 0; k < efforts.size(); ++k) std::printf("---|---|---|---|");
        std::printf("---|\n");
        for (const std::string& percent : bench::split(percents)) {
            recipe.max_error = range * std::atof(percent.c_str()) / 100;
            std::printf("| %s | %g |", percent.c_str(), recipe.max_error);
            bool kept = true;
            recipe.effort = Effort::draft;
            const auto base = static_cast<double>(hmesh::mesh_image(image.view(), options, recipe).report.faces);
            for (const std::string& effort : efforts) {
                for (const auto& [name, value] : names)
                    if (effort == name) recipe.effort = value;
                double seconds = 1e300;
                std::size_t faces = 0;
                for (int run = 0; run < repeat; ++run) {
                    const double begin = bench::processor_seconds();
                    const hmesh::Result result = hmesh::mesh_image(image.view(), options, recipe);
                    seconds = std::min(seconds, bench::processor_seconds() - begin);
                    kept = kept && result.status && result.report.max_error <= recipe.max_error;
                    faces = result.report.faces;
                }
                std::printf(" %zu | %.3f | %.3f | %.2f |", faces, static_cast<double>(faces) / base, seconds,
                            1e6 * seconds / static_cast<double>(image.size()));
            }
            std::printf(" %s |\n", kept ? "yes" : "no");
            std::fflush(stdout);
        }
    }
    return 0;
}
