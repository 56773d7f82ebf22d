// critical_path: how much faster more threads than a machine has would make mesh_image(), from measured pieces, as a Markdown
// table.
//
//     critical_path [--rates 1,3] [--efforts fast,normal] [--repeat 3] [--tile 256] IMAGE...
//
// The executor runs all pieces on one thread and notes how long each takes. For each of its calls the pieces are then handed, in
// their order, to whichever of N threads is free first; what lies between the calls is serial, and so is a piece that is alone in
// its call. The speedup on N threads is the time on one over the sum of the serial time and of the longest thread of each call.
// Memory is as fast for all threads here as for one, and handing out costs nothing: real threads come to a little less. The least
// of the repeats is shown.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include <hmesh/hmesh.hpp>

#include "common.hpp"

namespace {

constexpr std::array<std::size_t, 4> thread_counts{2, 4, 8, 16};

// What a run takes, seconds.
struct Times {
    double whole = 0, in_pieces = 0;
    std::array<double, thread_counts.size()> on_threads{};  // of the pieces alone

    [[nodiscard]] double speedup(std::size_t k) const { return whole / (whole - in_pieces + on_threads[k]); }
};

// When the last of `threads` threads is done with pieces that take so long.
double makespan(const std::vector<double>& pieces, std::size_t threads) {
    std::vector<double> busy(threads, 0.0);
    for (const double piece : pieces) *std::min_element(busy.begin(), busy.end()) += piece;
    return *std::max_element(busy.begin(), busy.end());
}

Times measure(const bench::Picture& picture, const hmesh::Options& options, const hmesh::Annealed& recipe) {
    Times times;
    const auto executor = [&](std::size_t n, hmesh::Piece piece) {
        if (n == 1) return piece(0);
        std::vector<double> taken(n);
        for (std::size_t i = 0; i < n; ++i) {
            const double start = bench::wall_seconds();
            piece(i);
            taken[i] = bench::wall_seconds() - start;
            times.in_pieces += taken[i];
        }
        for (std::size_t k = 0; k < thread_counts.size() && n > 0; ++k) times.on_threads[k] += makespan(taken, thread_counts[k]);
    };
    const double start = bench::wall_seconds();
    const hmesh::Result result = hmesh::mesh_image(picture.view(), options, recipe, executor);
    times.whole = bench::wall_seconds() - start;
    if (!result.status) {
        std::fprintf(stderr, "critical_path: %s\n", result.status.what);
        std::exit(1);
    }
    return times;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> rates{"1", "3"}, efforts{"draft", "fast", "normal"}, paths;
    int repeat = 3, tile = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool has_value = i + 1 < argc;
        if (argument == "--rates" && has_value) rates = bench::split(argv[++i]);
        else if (argument == "--efforts" && has_value) efforts = bench::split(argv[++i]);
        else if (argument == "--repeat" && has_value) repeat = std::atoi(argv[++i]);
        else if (argument == "--tile" && has_value) tile = std::atoi(argv[++i]);
        else if (argument[0] != '-') paths.push_back(argument);
        else paths.clear(), i = argc;
    }
    if (paths.empty() || repeat < 1) {
        std::fputs("usage: critical_path [--rates 1,3] [--efforts fast,normal] [--repeat 3] [--tile 256] IMAGE...\n", stderr);
        return 2;
    }
    std::puts("| image | Mpx | % | effort | s | serial % | 2 threads | 4 | 8 | 16 |\n|---|---|---|---|---|---|---|---|---|---|");
    for (const std::string& path : paths) {
        const std::optional<bench::Picture> picture = bench::read("critical_path", path);
        if (!picture) return 1;
        const double pixels = static_cast<double>(picture->width()) * picture->height();
        for (const std::string& rate : rates)
            for (const std::string& name : efforts) {
                hmesh::Options options;
                options.target = hmesh::Target::percent(std::atof(rate.c_str()));
                hmesh::Annealed recipe;
                recipe.tile = tile;
                if (!bench::effort_of(name, recipe.effort)) {
                    std::fprintf(stderr, "critical_path: %s is no effort\n", name.c_str());
                    return 2;
                }
                Times best = measure(*picture, options, recipe);
                for (int k = 1; k < repeat; ++k)
                    if (const Times again = measure(*picture, options, recipe); again.whole < best.whole) best = again;
                std::printf("| %s | %.2f | %s | %s | %.3f | %.1f |", bench::file_name(path).c_str(), 1e-6 * pixels, rate.c_str(),
                            name.c_str(), best.whole, 100 * (1 - best.in_pieces / best.whole));
                for (std::size_t k = 0; k < thread_counts.size(); ++k) std::printf(" %.2f |", best.speedup(k));
                std::puts("");
                std::fflush(stdout);
            }
    }
    return 0;
}
