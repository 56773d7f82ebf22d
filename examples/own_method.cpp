// own_method - a method of one's own, made of hmesh's building blocks: own_method [MESH.ply]
//
// A recipe is a struct of options with the few members that hmesh/methods/recipe.hpp lists. mesh_image() takes it like those of
// hmesh and does the rest: checks, weights, the search for a PSNR, final colours, the report. This one scatters points over the
// image, more where it is busy, joins them by Delaunay's triangulation, turns edges and moves vertices, and removes those that
// are missed least. Its PSNR is printed beside that of the default recipe's quickest effort.
#include <hmesh/hmesh.hpp>

#include <hmesh/core/random.hpp>
#include <hmesh/core/status.hpp>
#include <hmesh/edit/flip.hpp>
#include <hmesh/edit/move.hpp>
#include <hmesh/mesh/delaunay.hpp>
#include <hmesh/methods/annealed/budget.hpp>
#include <hmesh/methods/stage.hpp>
#include <hmesh/tiles/delaunay_mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace kit = hmesh::kit;

struct Scattered {
    double surplus = 4;      // points scattered, in units of the target, in [1, 10]
    int rounds = 3;          // of flips and moves, before and after the removal, in [0, 100]
    std::uint64_t seed = 1;  // of the random numbers

    static constexpr const char* name = "scattered";
    static constexpr hmesh::Colors colors = hmesh::Colors::optimal;

    [[nodiscard]] hmesh::Status check(int /*width*/, int /*height*/) const {
        return kit::check_ranges({{"scattered surplus must be in [1, 10]", surplus, 1, 10},
                                  {"scattered rounds must be in [0, 100]", static_cast<double>(rounds), 0, 100}});
    }
    [[nodiscard]] double tile_size(int width, int height, std::size_t /*n*/) const { return std::max(width, height); }

    template <int C>
    [[nodiscard]] hmesh::Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        const kit::ImageSource<C>& image = mesh.source();
        mesh.indexed() = kit::corner_mesh(image);  // what a cancellation finds
        const auto improve = [&](kit::ImageMesh<C>& whole) {
            for (int round = 0; round < rounds; ++round) {
                kit::flip_edges(whole);  // turns edges where that lowers the error
                kit::sweep(whole);       // gives each vertex its best colour, and moves it
            }
        };
        const auto scatter = [&] {
            const double count = std::min(image.pixels(), surplus * static_cast<double>(n));
            const kit::Delaunay delaunay = kit::triangulate(image.width(), image.height(), points(image, count));
            mesh.indexed() = kit::delaunay_mesh(image, delaunay);
            mesh.measure(kit::one_tile(image));  // for the report
            return !mesh.progress().stopped();
        };
        const auto remove = [&] {
            const double tile = tile_size(image.width(), image.height(), n);
            const bool is_reached = kit::reach_vertex_count(mesh, n, tile);
            if (is_reached || mesh.progress().stopped()) return is_reached;
            mesh.indexed() = kit::corner_mesh(image);  // more than n thin faces, none of which can go: grow to n instead
            return kit::reach_vertex_count(mesh, n, tile);
        };
        // Stages have names for progress and report, and say whether to go on.
        return kit::finished_or_cancelled(
            kit::run_stage(mesh, "scatter", scatter) && kit::run_one_tile_stage(mesh, "improve", improve) &&
            kit::run_stage(mesh, "remove", remove) && kit::run_one_tile_stage(mesh, "polish", improve));
    }

  private:
    // Each the place of most contrast among three at random, on the grid of 1/256 px that positions are on.
    template <int C>
    [[nodiscard]] std::vector<kit::Point> points(const kit::ImageSource<C>& image, double count) const {
        const auto contrast = [&](kit::Point p) {  // to the pixels four to the right and four below
            const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
            const kit::Color<C> here = image.pixel(x, y);
            const kit::Color<C> across = image.pixel(x + 4, y) - here, down = image.pixel(x, y + 4) - here;
            return (across * across + down * down).sum();
        };
        kit::Random random(seed);
        const auto place = [&] { return kit::snap({random.uniform() * image.width(), random.uniform() * image.height()}); };
        std::vector<kit::Point> out;
        while (static_cast<double>(out.size()) < count)
            out.push_back(
                std::max({place(), place(), place()}, [&](kit::Point a, kit::Point b) { return contrast(a) < contrast(b); }));
        return out;
    }
};

namespace {

// A sun over waves that shrink towards the horizon.
hmesh::Image<std::uint8_t, 3> draw_sea(int width, int height) {
    hmesh::Image<std::uint8_t, 3> image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width, v = (y + 0.5) / height, depth = v - 0.5;
            const double sun = std::hypot(u - 0.68, 0.7 * (v - 0.25)) < 0.11 ? 1 : 0;
            const double wave = depth > 0 ? 0.5 + 0.5 * std::sin(6 * u / (depth + 0.05) + 9 * std::sin(3 / (depth + 0.1))) : 0;
            const double sky[3] = {0.9 - 0.5 * v + 0.6 * sun, 0.5 + 0.3 * v + 0.4 * sun, 0.4 + 0.5 * v - 0.2 * sun};
            const double sea[3] = {0.1 + 0.4 * wave * depth, 0.25 + 0.6 * wave * depth, 0.35 + 0.5 * wave * depth};
            for (int c = 0; c < 3; ++c)
                image.pixel(x, y)[c] = hmesh::PixelTraits<std::uint8_t>::from_real(255 * (depth > 0 ? sea[c] : sky[c]));
        }
    return image;
}

}  // namespace

int main(int argc, char** argv) {
    const hmesh::Image<std::uint8_t, 3> image = draw_sea(384, 256);
    const hmesh::Result mine = hmesh::mesh_image(image.view(), {}, Scattered{});
    const hmesh::Result draft = hmesh::mesh_image(image.view(), {}, hmesh::Annealed{hmesh::Effort::draft});
    if (!mine.status || !draft.status) {
        std::fprintf(stderr, "own_method: %s\n", hmesh::message(mine.status ? draft.status : mine.status).c_str());
        return 1;
    }
    std::printf("PSNR = 10 log10(255^2 / MSE) in dB, MSE the mean over pixels and channels\n");
    for (const hmesh::StageReport& stage : mine.report.stages)
        std::printf("  after %-8s %5zu vertices %8.2f\n", stage.name, stage.vertices, stage.psnr);
    std::printf("%-14s %5zu vertices %8.2f\n", Scattered::name, mine.report.vertices, mine.report.psnr);
    std::printf("%-14s %5zu vertices %8.2f\n", "annealed draft", draft.report.vertices, draft.report.psnr);

    if (argc < 2) return 0;
    std::FILE* file = std::fopen(argv[1], "wb");
    const auto sink = [&](const void* bytes, std::size_t size) { return std::fwrite(bytes, 1, size, file) == size; };
    if (file == nullptr || !hmesh::write_ply(mine.mesh.view(), sink) || std::fclose(file) != 0) {
        std::fprintf(stderr, "own_method: cannot write '%s'\n", argv[1]);
        return 1;
    }
    return 0;
}
