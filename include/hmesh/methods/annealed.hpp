// hmesh - annealed: the method of best fidelity, and the default.
//
//     grid -> greedy insertion to o n vertices -> collapse to n -> s sweeps of priced moves -> exactly n -> polish
//
// Too many vertices are placed where each lowers the energy most, then those that are missed least go; vertices move and
// edges turn all along. Annealing (fit/annealing.hpp) then exchanges vertices between places at one common price. Colours
// are least-squares optimal throughout. Each stage is left out where its options say 0 or 1.
#ifndef HMESH_METHODS_ANNEALED_HPP
#define HMESH_METHODS_ANNEALED_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/annealing.hpp"
#include "hmesh/fit/collapse.hpp"
#include "hmesh/fit/flips.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/insertion.hpp"
#include "hmesh/fit/subdivision.hpp"
#include "hmesh/fit/vertices.hpp"

namespace hmesh {

// How much work goes into a mesh, counted in steps, never in seconds.
enum class Effort : std::uint8_t {
    draft,   // greedy insertion
    fast,    // insertion of twice as many, then removal: about +2 dB
    normal,  // then 12 sweeps of annealing: about +1 dB
    best,    // 400 sweeps
};

struct AnnealedOptions {
    double overshoot = 2;     // o: vertices placed before the collapse, in units of the target; 1 for none
    double start = 0.3;       // vertices of the first grid, share of those placed
    double growth = 0.2;      // vertices inserted at a time, share of those there
    double shrinkage = 0.15;  // vertices removed at a time, share of those there
    int growth_sweeps = 2;    // after each insertion
    int polish_rounds = 2;    // flips and a sweep, at the end
    // While the mesh grows, small gains wait: the next insertion changes the neighbourhood anyway. Against the tight
    // {1e-3, 0} this buys a second sweep for the time of one, +0.2 dB.
    Tolerance growth_flips{3e-2, 0};
    Tolerance growth_visits{5e-2, 5e-3};
    Tolerance polish{1e-3, 5e-3};
    Relaxation relaxation{1, 1e-3};  // around each removal
    AnnealingOptions annealing;      // sweeps = 0: none
    std::uint64_t seed = 1;          // of the annealing
};

namespace detail {

// A regular grid of at most `count` >= 4 vertices over the rectangle, its diagonals alternating.
struct Grid {
    std::vector<Point> positions;
    std::vector<Triangle> triangles;
};
[[nodiscard]] inline Grid regular_grid(int width, int height, double count) {
    const auto cells = [&](double side, double other, int pixels) {
        const double n = std::floor(std::sqrt(count * side / other)) - 1;
        return static_cast<std::uint32_t>(std::max(1.0, std::min(n, static_cast<double>(pixels))));
    };
    std::uint32_t nx = cells(width, height, width), ny = cells(height, width, height);
    while (nx > 1 && (nx + 1.0) * (ny + 1.0) > count) --nx;
    while (ny > 1 && (nx + 1.0) * (ny + 1.0) > count) --ny;
    Grid grid;
    for (std::uint32_t j = 0; j <= ny; ++j)
        for (std::uint32_t i = 0; i <= nx; ++i)
            grid.positions.push_back(snap(Point{static_cast<double>(width) * i / nx, static_cast<double>(height) * j / ny}));
    for (std::uint32_t j = 0; j < ny; ++j)
        for (std::uint32_t i = 0; i < nx; ++i) {
            const std::uint32_t a = j * (nx + 1) + i, b = a + 1, d = a + nx + 1, c = d + 1;
            if ((i + j) % 2 != 0) {
                grid.triangles.push_back({a, b, c});
                grid.triangles.push_back({a, c, d});
            } else {
                grid.triangles.push_back({a, b, d});
                grid.triangles.push_back({b, c, d});
            }
        }
    return grid;
}

// Greedy insertion until the mesh has n vertices.
template <int C, class ParallelFor>
bool grow(ImageMesh<C>& mesh, std::size_t n, const AnnealedOptions& options, Monitor& monitor, const ParallelFor& parallel_for) {
    const std::size_t first = mesh.vertex_count();
    while (mesh.vertex_count() < n) {
        const std::size_t count = mesh.vertex_count(), missing = n - count;
        std::size_t batch = std::min(missing, static_cast<std::size_t>(std::ceil(static_cast<double>(count) * options.growth)));
        if (missing - batch < batch / 2) batch = missing;  // no small last batch
        if (insert_batch(mesh, batch, {}, parallel_for) == 0) break;
        flip_edges(mesh, options.growth_flips);
        for (int i = 0; i < options.growth_sweeps; ++i) sweep(mesh, options.growth_visits);
        const double done = static_cast<double>(mesh.vertex_count() - first) / static_cast<double>(n - first);
        if (!monitor.update(done, mesh.vertex_count(), mesh.energy())) return false;
    }
    if (mesh.vertex_count() < n) subdivide(mesh, n - mesh.vertex_count());
    return true;
}

// Removes the cheapest vertices until n are left. May stop early where no vertex can go.
template <int C, class ParallelFor>
bool shrink(ImageMesh<C>& mesh, std::size_t n, const AnnealedOptions& options, Monitor& monitor, const ParallelFor& parallel_for) {
    const std::size_t first = mesh.vertex_count();
    while (mesh.vertex_count() > n) {
        const std::size_t count = mesh.vertex_count(), surplus = count - n;
        const auto batch = static_cast<std::size_t>(std::ceil(static_cast<double>(count) * options.shrinkage));
        if (remove_batch(mesh, std::min(surplus, batch), options.relaxation, parallel_for) == 0) break;
        const double done = static_cast<double>(first - mesh.vertex_count()) / static_cast<double>(first - n);
        if (!monitor.update(done, mesh.vertex_count(), mesh.energy())) return false;
    }
    return true;
}

// Priced moves around n vertices, then exactly n.
template <int C, class ParallelFor>
bool anneal(ImageMesh<C>& mesh, std::size_t n, const AnnealedOptions& options, Monitor& monitor, const ParallelFor& parallel_for) {
    Annealer<C> annealer(mesh, n, options.annealing, Random(options.seed));
    for (int k = 0; k < options.annealing.sweeps; ++k) {
        annealer.sweep(k);
        if (!monitor.update((k + 1.0) / options.annealing.sweeps, mesh.vertex_count(), mesh.energy())) return false;
    }
    while (mesh.vertex_count() > n && remove_batch(mesh, mesh.vertex_count() - n, options.relaxation, parallel_for) > 0) {}
    const InsertionOptions insertion{true, true, 0};
    while (mesh.vertex_count() < n && insert_batch(mesh, n - mesh.vertex_count(), insertion, parallel_for) > 0) {}
    if (mesh.vertex_count() < n) subdivide(mesh, n - mesh.vertex_count());
    return true;
}

// The recipe. The mesh may keep more than n vertices where none can go.
template <int C, class ParallelFor>
[[nodiscard]] Status follow(ImageMesh<C>& mesh, std::size_t n, const AnnealedOptions& options, Monitor& monitor,
                            const ParallelFor& parallel_for) {
    const Status cancelled{Errc::cancelled, "cancelled by the progress callback", 0, 0};
    const auto begin = [&](const char* stage) { return monitor.begin(stage, mesh.vertex_count(), mesh.energy()); };
    const auto end = [&] { return monitor.end(mesh.vertex_count(), mesh.energy()); };
    const double most = std::max(4.0, static_cast<double>(mesh.width()) * mesh.height());
    const auto placed = static_cast<std::size_t>(std::min(most, std::round(static_cast<double>(n) * options.overshoot)));

    const Grid grid = regular_grid(mesh.width(), mesh.height(), std::max(4.0, static_cast<double>(placed) * options.start));
    mesh.reserve(placed);
    if (const Status status = mesh.assign(grid.positions, grid.triangles, parallel_for); !status) return status;
    if (!begin("grid")) return cancelled;
    for (int i = 0; i < 2; ++i) sweep(mesh, options.polish);
    if (!end()) return cancelled;

    if (!begin("insert") || !grow(mesh, placed, options, monitor, parallel_for) || !end()) return cancelled;
    if (placed > n) {
        if (!begin("collapse") || !shrink(mesh, n, options, monitor, parallel_for) || !end()) return cancelled;
        mesh.compact(options.annealing.sweeps > 0 ? n + n / 16 : n, parallel_for);
    }
    if (options.annealing.sweeps > 0)
        if (!begin("anneal") || !anneal(mesh, n, options, monitor, parallel_for) || !end()) return cancelled;

    if (!begin("polish")) return cancelled;
    for (int i = 0; i < options.polish_rounds; ++i) {
        flip_edges(mesh, options.polish);
        sweep(mesh, options.polish);
        if (!monitor.update((i + 1.0) / options.polish_rounds, mesh.vertex_count(), mesh.energy())) return cancelled;
    }
    return end() ? Status{} : cancelled;
}

}  // namespace detail

// The options that make an effort.
[[nodiscard]] inline AnnealedOptions annealed_options(Effort effort) noexcept {
    AnnealedOptions options;
    switch (effort) {
        case Effort::draft:
            options.overshoot = 1;
            options.growth = 0.3;
            options.polish_rounds = 0;
            options.annealing.sweeps = 0;
            break;
        case Effort::fast:
            options.polish_rounds = 3;
            options.annealing.sweeps = 0;
            break;
        case Effort::normal: break;
        case Effort::best:
            options.overshoot = 4;
            options.annealing.sweeps = 400;
            options.annealing.temperature = 0.5;
            options.annealing.cooling = 2;
            options.annealing.exchange = 0.3;
            break;
    }
    return options;
}

// Whether the options mean something; the sentence names the first that does not.
[[nodiscard]] inline Status check(const AnnealedOptions& options) noexcept {
    const auto bad = [](const char* what) -> Status { return {Errc::invalid_argument, what, 0, 0}; };
    const auto within = [](double value, double low, double high) { return value >= low && value <= high; };  // false for NaN
    const AnnealingOptions& annealing = options.annealing;
    if (!within(options.overshoot, 1, 100)) return bad("annealed.overshoot must be in [1, 100]");
    if (!within(options.start, 0, 1)) return bad("annealed.start must be in [0, 1]");
    if (!within(options.growth, 1e-3, 10)) return bad("annealed.growth must be in [0.001, 10]");
    if (!within(options.shrinkage, 1e-3, 1)) return bad("annealed.shrinkage must be in [0.001, 1]");
    if (!within(options.growth_sweeps, 0, 1000)) return bad("annealed.growth_sweeps must be in [0, 1000]");
    if (!within(options.polish_rounds, 0, 1000)) return bad("annealed.polish_rounds must be in [0, 1000]");
    if (!within(options.relaxation.rounds, 0, 100)) return bad("annealed.relaxation.rounds must be in [0, 100]");
    for (const Tolerance& t : {options.growth_flips, options.growth_visits, options.polish})
        if (!within(t.spread, 0, 1e6) || !within(t.least, 0, 1e6)) return bad("annealed tolerances must be in [0, 1e6]");
    if (!within(annealing.sweeps, 0, 1e6)) return bad("annealing.sweeps must be in [0, 1e6]");
    if (!within(annealing.temperature, 0, 1e3)) return bad("annealing.temperature must be in [0, 1000]");
    if (!within(annealing.cooling, 0, 100)) return bad("annealing.cooling must be in [0, 100]");
    if (!within(annealing.exchange, 0, 1) || !within(annealing.jump, 0, 1)) return bad("annealing probabilities must be in [0, 1]");
    if (!within(annealing.jump_reach, 0, 1)) return bad("annealing.jump_reach must be in [0, 1]");
    if (!within(annealing.start_price, 1e-6, 1e6)) return bad("annealing.start_price must be in [1e-6, 1e6]");
    for (const double screen : {annealing.removal_screen, annealing.insertion_screen, annealing.flip_screen})
        if (!within(screen, 0, 1e6)) return bad("annealing screens must be in [0, 1e6]");
    if (!within(annealing.band, 0, 1)) return bad("annealing.band must be in [0, 1]");
    return {};
}

// Fills `mesh` with n vertices, 4 <= n <= max(4, pixels). Cancelled: the mesh is valid but may have another count.
template <int C, class ParallelFor = SerialFor>
[[nodiscard]] Status annealed(ImageMesh<C>& mesh, std::size_t n, const AnnealedOptions& options, Monitor& monitor,
                              const ParallelFor& parallel_for = {}) {
    const Status status = detail::follow(mesh, n, options, monitor, parallel_for);
    if (!status || mesh.vertex_count() == n) return status;
    // Too many slivers that min_cross protects: growing to n alone always gets there.
    AnnealedOptions plain = options;
    plain.overshoot = 1;
    plain.annealing.sweeps = 0;
    return detail::follow(mesh, n, plain, monitor, parallel_for);
}

}  // namespace hmesh

#endif  // HMESH_METHODS_ANNEALED_HPP
