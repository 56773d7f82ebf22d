/// \file
/// Annealed: the method behind the default recipe (methods/annealed/options.hpp).
///
///    o n points -> settle -> collapse to n -> s sweeps of priced moves -> exactly n -> polish
///
/// More points than wanted are drawn, with the density that the image asks for (methods/annealed/first_points.hpp), and
/// triangulated; vertices move and edges flip until little is gained; then the vertices whose loss raises the energy least are
/// removed. Annealing (methods/annealed/annealing.hpp) moves vertices between places at one common price, which starts where the
/// mesh will grow a little (methods/annealed/first_price.hpp). Whenever a vertex is visited, its colour becomes the
/// least-squares one. o and s are AnnealedSteps::points and annealing.sweeps; collapse is left out where o = 1, annealing where
/// s = 0.
///
/// A mesh to go on from (Annealed::start) takes the place of the points: the cheapest vertices are removed, or the best ones
/// inserted, until there are n.
///
/// All stages but the triangulation, whose pieces are bands of rows (tiles/delaunay_mesh.hpp), work in patches
/// (tiles/patch.hpp), whose tiling shifts from phase to phase, so that no trace of their seams remains; in a patch, block by
/// block (edit/blocks.hpp).
#ifndef HMESH_METHODS_ANNEALED_ANNEALED_HPP
#define HMESH_METHODS_ANNEALED_ANNEALED_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/edit/blocks.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/annealed/annealing.hpp"
#include "hmesh/methods/annealed/border.hpp"
#include "hmesh/methods/annealed/budget.hpp"
#include "hmesh/methods/annealed/first_points.hpp"
#include "hmesh/methods/annealed/first_price.hpp"
#include "hmesh/methods/annealed/line_points.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/tiles/delaunay_mesh.hpp"
#include "hmesh/tiles/recut.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace kit::detail {

/// Whether `given`, of which to_indexed_mesh() made `mesh`, is a mesh of the image, with finite colours; else
/// Errc::invalid_argument.
template <int C>
[[nodiscard]] HMESH_COLD Status check_start(const Mesh& given, const IndexedMesh<C>& mesh, const ImageSource<C>& source) {
    if (given.channels != C)
        return {Errc::invalid_argument, "the mesh to start from has not the image's channels", given.channels, C};
    if (given.positions.empty()) return {Errc::invalid_argument, "the mesh to start from has no vertices"};
    if (mesh.vertex_count() == 0)
        return {Errc::invalid_argument, "the mesh to start from has arrays that are not of one number of vertices"};
    if (mesh.width != source.width())
        return {Errc::invalid_argument, "the mesh to start from is not as wide as the image", mesh.width, source.width()};
    if (mesh.height != source.height())
        return {Errc::invalid_argument, "the mesh to start from is not as high as the image", mesh.height, source.height()};
    if (mesh.periodic != source.periodic())
        return {Errc::invalid_argument, "the mesh to start from is not periodic along the axes asked for",
                static_cast<int>(mesh.periodic), static_cast<int>(source.periodic())};
    if (mesh.samples != source.samples())
        return {Errc::invalid_argument, "the mesh to start from is of other samples, squares or points, than the image",
                static_cast<int>(mesh.samples), static_cast<int>(source.samples())};
    for (std::size_t v = 0; source.has_straight_seams() && v < mesh.vertex_count(); ++v)
        if (const Point p = mesh.positions[v]; !(p.x >= 0 && p.x <= mesh.width && p.y >= 0 && p.y <= mesh.height))
            return {Errc::invalid_argument, "the mesh to start from has no straight border, at vertex", v};
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        for (int c = 0; c < C; ++c)
            if (!is_finite(mesh.colors[v][c]))
                return {Errc::invalid_argument, "the mesh to start from has a colour that is not finite, at vertex",
                        static_cast<std::int64_t>(v), 0};
    if (const Status status = check(mesh); !status) return status;
    constexpr std::uint32_t most = ring_capacity - 1;  // a vertex on the border has one edge more than faces
    Array<std::uint32_t> faces(mesh.vertex_count(), 0);
    for (const Triangle& face : mesh.faces)
        for (const std::uint32_t v : face)
            if (++faces[mesh.roots.empty() ? v : mesh.roots[v]] > most)
                return {Errc::invalid_argument, "the mesh to start from has too many faces around vertex", v, most};
    return {};
}

/// Whether these are the vertices on the border of a mesh.
template <int C>
[[nodiscard]] HMESH_COLD bool has_border(const IndexedMesh<C>& mesh, const Array<Point>& border) {
    Array<Point> its;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        if (mesh.is_on_border(v)) its.push_back(mesh.positions[v]);
    const auto sorted = [](const Array<Point>& points) {
        return in_order(points, sorted_numbers(
                                    points.size(), [&](std::uint32_t k) { return code_of(points[k].y); },
                                    [&](std::uint32_t k) { return code_of(points[k].x); }));
    };
    return sorted(its) == sorted(border);
}

/// Finds the vertices of the border that follows from Annealed::border_tolerance, or none where that is not set.
template <int C>
[[nodiscard]] HMESH_COLD Status find_border(const ImageSource<C>& source, std::optional<double> tolerance, std::size_t n,
                                            Array<Point>& border) {
    if (!tolerance) return {};
    if (source.samples() != Samples::points)
        return {Errc::invalid_argument, "border_tolerance is for samples that are points, and they are squares"};
    if (source.scale() != nullptr) return {Errc::invalid_argument, "border_tolerance knows no channel_weights"};
    border = border_vertices(source, *tolerance);
    if (n >= border.size()) return {};
    return {Errc::target_out_of_range, "the sides of the mesh have, by border_tolerance, more vertices than it may have",
            static_cast<std::int64_t>(border.size()), static_cast<std::int64_t>(n)};
}

/// Tells progress of the stages of a run from a mesh of `from` vertices; 0: from points.
HMESH_COLD inline void plan_stages(ProgressReporter& progress, const AnnealedSteps& steps, double pixels, std::size_t n,
                                   std::size_t from) {
    const AnnealedWork work = annealed_work(steps, pixels, static_cast<double>(n), static_cast<double>(from));
    const bool collapses = work.collapse > 0, anneals = work.anneal > 0;
    if (from > 0 && anneals) progress.plan({work.start, work.anneal, work.polish, work.colors});
    else if (from > 0) progress.plan({work.start, work.polish, work.colors});
    else if (collapses && anneals) progress.plan({work.start, work.settle, work.collapse, work.anneal, work.polish, work.colors});
    else if (collapses || anneals)
        progress.plan({work.start, work.settle, work.collapse + work.anneal, work.polish, work.colors});
    else progress.plan({work.start, work.settle, work.polish, work.colors});
}

/// One run of the method for n vertices: the stages, and what they know of the tiles.
template <int C>
class AnnealedRun {
  public:
    /// `tile`: the side of tiles, px; `is_equal`: whether all have it, or hold as many vertices each. `border`: the vertices of a
    /// border that stays as it is, and that a mesh to start from has; empty: none.
    AnnealedRun(TiledMesh<C>& tiled, std::size_t n, const AnnealedSteps& steps, std::uint64_t seed, double tile, bool is_equal,
                const Array<Point>& border)
        : tiled_(&tiled), n_(n), steps_(steps), seed_(seed), tile_(tile), is_equal_(is_equal), border_(&border),
          tilings_(tiled.source().width(), tiled.source().height(), tile, tiled.source().periodic()),
          has_seams_(tiled.has_seams(tilings_[0])) {}

    /// Runs all stages. False: cancelled, or more than n vertices are left and none of them can be removed.
    bool run() {
        plan_stages(progress(), steps_, tiled_->source().pixels(), n_, 0);
        tiled_->indexed() = tied_corner_mesh(tiled_->source());  // the mesh after a cancellation in the first stage
        return stage("points", [&] { return draw_points(); }) && stage("settle", [&] { return settle(); }) &&
               (steps_.points <= 1 || stage("collapse", [&] { return collapse(n_, true); })) && finish();
    }
    /// The same from `mesh` on, which check_start() accepts.
    bool run_from(IndexedMesh<C> mesh) {
        plan_stages(progress(), steps_, tiled_->source().pixels(), n_, mesh.positions.size());
        tiled_->indexed() = std::move(mesh);
        tiled_->indexed().has_fixed_border = !border_->empty();
        return stage("start",
                     [&] {
                         lay_tiles();
                         tiled_->measure(tilings_[0]);
                         return come_near() && reach();
                     }) &&
               finish();
    }

    /// The same from the mesh of more than n vertices that `tiled` holds, whose energy is known.
    bool run_on() {
        const AnnealedWork work =
            coarser_work(steps_, tiled_->source().pixels(), static_cast<double>(tiled_->vertex_count()), static_cast<double>(n_));
        if (work.anneal > 0) progress().plan({work.collapse, work.anneal, work.polish, work.colors});
        else progress().plan({work.collapse, work.polish, work.colors});
        tiled_->indexed().has_fixed_border = !border_->empty();
        return stage("collapse", [&] { return collapse(n_, false); }) && finish();
    }

  private:
    bool finish() {
        return (steps_.annealing.sweeps == 0 || stage("anneal", [&] { return anneal(); })) && stage("polish", [&] {
                   progress().set_range(0, 0.35);
                   return reach() && polish(0.35);
               });
    }
    bool reach() {
        const int first = phase_;
        return reach_vertex_count(*tiled_, n_, steps_.relaxation,
                                  [&](int k) -> const Tiling& { return tilings_[phase_ = first + k]; });
    }
    /// Removes most of what a mesh to start from has too much. reach() alone, in batches of 1/32, takes two to four times as long
    /// from 16 n vertices. What large batches spoil annealing mends; without it half of n more are left to the small ones.
    HMESH_COLD bool come_near() {
        const std::size_t more = n_ + n_ / 2;
        if (tiled_->vertex_count() <= more) return true;
        const bool go_on = collapse(steps_.annealing.sweeps > 0 ? n_ : more, false, 0.8);
        progress().set_range(0.8, 1);
        return go_on;
    }
    [[nodiscard]] ProgressReporter& progress() noexcept { return tiled_->progress(); }
    /// Lays all tilings by the vertices of indexed(), unless tiles are equal.
    HMESH_COLD void lay_tiles() {
        const ImageSource<C>& source = tiled_->source();
        if (!is_equal_) tilings_ = Tilings(TileGrid(source.width(), source.height(), tile_, tiled_->indexed().positions));
    }
    bool stage(const char* name, FunctionRef<bool()> body) { return run_stage<C>(*tiled_, name, body); }

    /// Makes the mesh of these points and those of the border. False: cancelled.
    HMESH_COLD bool triangulate(Array<std::uint32_t>& pixels, const Array<Point>& on_lines) {
        const ImageSource<C>& source = tiled_->source();
        {
            Delaunay delaunay(source.width(), source.height(), source.samples());
            const auto go_on = [&] { return progress().poll(); };
            const bool has_own_sides =
                source.samples() == Samples::points || source.periodic() != Periodic::none || !border_->empty();
            if (!(has_own_sides ? insert_pixels(delaunay, pixels, go_on)
                                : triangulate_pixels(delaunay, pixels, tiled_->parallel_for(), go_on)))
                return false;
            if (border_->empty()) pixels = {};  // not needed again
            for (const Point p : on_lines) (void)delaunay.insert(p);
            for (const Point p : *border_) (void)delaunay.insert(p);
            pair_sides(delaunay, source.periodic());
            tiled_->indexed() = uncolored_mesh(source, delaunay, tiled_->parallel_for());
        }
        (void)progress().poll();
        take_colors(tiled_->indexed(), source, tiled_->parallel_for());
        return true;
    }

    /// The `count` pixels where the image asks for points, of which those that have to stand on lines are taken off. Meaningless
    /// once progress has stopped.
    HMESH_COLD Array<std::uint32_t> first_pixels(double count, Array<Point>& on_lines) {
        const ImageSource<C>& source = tiled_->source();
        const auto go_on = [&] { return !progress().stopped(); };
        const auto left = [&] { return static_cast<std::size_t>(std::max(0.0, count - static_cast<double>(on_lines.size()))); };
        if (source.is_read() && source.periodic() == Periodic::none)
            return source.calls().points(source, left(), tiled_->parallel_for(), go_on);
        Image<float, 1> ranks = std::move(tiled_->notes().point_ranks), density;
        if (ranks.size() == 0) density = point_density(source, tiled_->parallel_for(), go_on);
        if (progress().stopped()) return {};
        // Twice the density where points cannot leave the seam: 0.3 dB beside it (benchmarks/periodic, wood).
        if (source.periodic() != Periodic::none)
            on_lines = seam_points(density, (source.has_straight_seams() ? 2 : 1) * count, source.periodic());
        if (ranks.size() == 0) ranks = point_ranks(std::move(density), tiled_->parallel_for());
        Array<std::uint32_t> pixels = first_points(ranks, left(), tiled_->parallel_for());
        if (tiled_->is_small() && source.periodic() == Periodic::none) tiled_->notes().point_ranks = std::move(ranks);
        return pixels;
    }

    HMESH_COLD bool draw_points() {
        const ImageSource<C>& source = tiled_->source();
        // The corners come by themselves.
        const auto given = static_cast<double>(std::max<std::size_t>(4, border_->size()));
        const double wanted = std::max(0.0, std::ceil(static_cast<double>(n_) * steps_.points) - given);
        const double most = std::min(source.pixels(), static_cast<double>(max_pixels));
        const double count = std::min(most, wanted);
        Array<Point> on_lines;
        const bool has_sides = source.samples() == Samples::points && source.periodic() == Periodic::none && border_->empty();
        if (has_sides) on_lines = side_points(source, count);
        Array<std::uint32_t> pixels = first_pixels(count, on_lines);
        if (!progress().poll()) return false;
        if (source.periodic() != Periodic::none) leave_out_sides(pixels, source.width(), source.height(), source.periodic());
        if (has_sides || !border_->empty()) leave_out_sides(pixels, source.width(), source.height(), Periodic::xy);
        // Few points of a row follow more of it from its middle: 100 vertices of 20,000 px of a wave by 9 dB.
        constexpr std::size_t few = 300;
        const bool is_row = source.height() == 1 && !wraps_y(source.periodic());
        if (pixels.size() > few && (is_row || (source.width() == 1 && !wraps_x(source.periodic())))) {
            for (const Point p : points_by_turns(pixels, is_row)) on_lines.push_back(p);
            pixels = {};
        }
        if (!triangulate_within_valence(pixels, on_lines)) return false;
        tiled_->indexed().has_fixed_border = !border_->empty();
        tie(tiled_->indexed(), source.periodic());
        lay_tiles();
        progress().set_range(0.9, 0.9);
        return tiled_->estimate_energy(tilings_[0]);  // the end of a stage tells 1
    }
    /// triangulate(), with vertices that leave room for flips up to max_valence. False: cancelled.
    HMESH_COLD bool triangulate_within_valence(Array<std::uint32_t>& pixels, const Array<Point>& on_lines) {
        const ImageSource<C>& source = tiled_->source();
        // 32 leaves room, as 16 does where up to four copies make one vertex. The mesh of two faces, which grows to n, is for
        // shapes nobody has seen. A border stays, and there are fewer points along its longest edges.
        const int limit = source.periodic() == Periodic::none ? 32 : 16;
        while (true) {
            if (!triangulate(pixels, on_lines)) return false;
            IndexedMesh<C>& mesh = tiled_->indexed();
            if (bound_valence(mesh, limit)) return true;
            if (border_->empty()) {
                mesh = corner_mesh(source);
                return true;
            }
            if (!leave_out_crowd(pixels, mesh.positions, mesh.faces, mesh.width, mesh.height, limit)) return false;
        }
    }

    /// A piece of work on a patch.
    struct Piece {
        std::size_t number;  ///< < piece_count() of the phase, another one for each piece
        double share;        ///< of the patch in the vertices of the whole mesh, when the phase began
    };
    /// What is done in a patch to some of its vertices, in spatial order.
    using PieceWork = FunctionRef<void(ImageMesh<C>& mesh, const Array<Vertex>& vertices, const Piece& piece)>;
    /// The pieces of a phase are numbered from 0 to this.
    [[nodiscard]] std::size_t piece_count(int phase) const { return 2 * tilings_[phase].size(); }

    /// Calls body() for the free vertices of each patch of this phase, which is this part of the stage; before that, where
    /// `has_missed`, for those of them that were locked in the phase before, which did the same.
    bool for_each_piece(bool has_missed, double from, double to, PieceWork body) {
        const auto count = static_cast<double>(tiled_->vertex_count());
        progress().set_range(from, to);
        return tiled_->for_each(tilings_[phase_], [&](Patch<C>& patch, std::size_t tile) {
            const double share = static_cast<double>(patch.vertex_count()) / count;
            if (const Array<Vertex> missed = patch.take_hindered(); has_missed && !missed.empty())
                body(patch.mesh(), missed, {2 * tile, share});
            body(patch.mesh(), patch.free_vertices(), {2 * tile + 1, share});
        });
    }
    /// Calls body() for the vertices that were locked in this phase, in the patches of the next.
    bool for_each_seam(double from, double to, PieceWork body) {
        if (!has_seams_) return true;
        const auto count = static_cast<double>(tiled_->vertex_count());
        progress().set_range(from, to);
        phase_ ^= 1;
        return tiled_->for_each_seam(tilings_[phase_], [&](Patch<C>& patch, std::size_t tile) {
            const double share = static_cast<double>(patch.vertex_count()) / count;
            body(patch.mesh(), patch.take_hindered(), {tile, share});
        });
    }

    /// The visits of the first mesh, as work on its pieces.
    [[nodiscard]] auto visits() const {
        return [this](ImageMesh<C>& mesh, const Array<Vertex>& all, const Piece&) {
            for_each_block(mesh, all, 0, [&](Array<Vertex>& vertices) {
                for (int round = 0; round < steps_.settle_rounds; ++round) {
                    sweep(mesh, vertices, steps_.settle);
                    flip_edges(mesh, own_edges(mesh, vertices), steps_.settle_flip_gain);
                }
            });
        };
    }
    HMESH_COLD bool settle() { return for_each_piece(false, 0, 1, visits()); }

    /// Removes the cheapest vertices until there are n, which is `end` of the stage; `has_settled`: after settle(), which left
    /// vertices at seams.
    HMESH_COLD bool collapse(std::size_t n, bool has_settled, double end = 1) {
        const std::size_t first = tiled_->vertex_count();
        const bool has_seams = has_seams_;
        const double begin = has_seams && has_settled ? 0.05 : 0;
        if (has_settled && !for_each_seam(0, begin, visits())) return false;
        double reached = begin;
        // Annealing does not mind a few more.
        const std::size_t most = n + (steps_.annealing.sweeps > 0 ? n / 1000 : 0);
        for (int stuck = 0; tiled_->vertex_count() > most && stuck < 4;) {
            const std::size_t before = tiled_->vertex_count();
            const auto largest = static_cast<std::size_t>(std::ceil(static_cast<double>(before) * steps_.collapse_batch));
            const std::size_t batch = std::min(before - n, largest);
            const auto done = [&](std::size_t count) {
                return begin + (end - begin) * static_cast<double>(first - count) / static_cast<double>(first - n);
            };
            // A batch may have fallen short of what was expected.
            const double from = reached, to = std::max(from, done(before - batch));
            reached = to;
            progress().set_range(from, to);
            // The locked vertices have a share in the batch, which is taken from the patches of the next phase.
            const bool some = do_some_suffice(*tiled_, tilings_[phase_], batch);
            const double free = some ? 1 : 1 - static_cast<double>(tiled_->locked_count()) / static_cast<double>(before);
            const auto share = static_cast<std::size_t>(std::max(0.0, std::ceil(free * static_cast<double>(batch))));
            remove_cheapest(*tiled_, tilings_[phase_], share, steps_.relaxation, some ? Removals::from_some : Removals::about);
            if (progress().stopped()) return false;
            if (has_seams) {
                phase_ ^= 1;
                // Where the seams can end it they do; else their vertices come with all others of the next batch.
                const std::size_t count = tiled_->vertex_count(), left = count - std::min(count, n);
                if (left > 0 && !do_some_suffice(*tiled_, tilings_[phase_], left) && 3 * left < tiled_->locked_count()) {
                    progress().set_range(to, to);
                    remove_cheapest(*tiled_, tilings_[phase_], left, steps_.relaxation, Removals::at_seams);
                    if (progress().stopped()) return false;
                }
            }
            stuck = tiled_->vertex_count() < before ? 0 : stuck + 1;
        }
        if (!has_seams) (void)tiled_->indexed();  // renumbers the vertices without their many deleted slots
        return true;
    }

    /// first_price() of the whole mesh, from some thousand vertices.
    [[nodiscard]] HMESH_COLD double measured_price() {
        const Tiling& tiles = tilings_[phase_];
        const std::size_t most = std::max<std::size_t>(1, std::min<std::size_t>(16, tiled_->vertex_count() / 1024));
        const std::size_t step = std::max<std::size_t>(1, most / tiled_->sample_step(tiles));
        std::vector<VertexWorths> of_tile(tiles.size());
        progress().set_range(0, 0);
        const auto sample = [&](Patch<C>& patch, std::size_t tile) {
            sample_worths(patch.mesh(), patch.free_vertices(), step, of_tile[tile]);
        };
        tiled_->look_at_each(tiles, sample, tiled_->sample_step(tiles));
        VertexWorths worths;
        for (const VertexWorths& some : of_tile) {
            worths.gains.insert(worths.gains.end(), some.gains.begin(), some.gains.end());
            worths.costs.insert(worths.costs.end(), some.costs.begin(), some.costs.end());
        }
        return first_price(worths);
    }

    HMESH_COLD bool anneal() {
        const AnnealingOptions& annealing = steps_.annealing;
        AnnealingSchedule schedule(annealing, n_, measured_price());
        if (progress().stopped()) return false;
        // Sweeps take less and less time; the first one, in which the mesh grows, a half more.
        const auto done = [&](int k) {
            const double sweeps = annealing.sweeps, t = k / sweeps;
            return k == 0 ? 0 : (0.4 + sweeps * t * (1.08 - 0.15 * t)) / (0.4 + 0.93 * sweeps);
        };
        Array<AnnealingCounts> counts;
        const auto steer = [&] {
            AnnealingCounts sum;
            for (const AnnealingCounts& c : counts) {
                sum.removed += c.removed;
                sum.inserted += c.inserted;
            }
            counts.clear();
            schedule.steer(sum, tiled_->vertex_count(), tiled_->mean_energy());
        };
        for (int k = 0; k < annealing.sweeps; ++k) {
            const double tolerance = annealing.count_tolerance * (1 - static_cast<double>(k) / annealing.sweeps);
            const auto body = [&](ImageMesh<C>& mesh, const Array<Vertex>& vertices, const Piece& piece) {
                const double share = piece.share * static_cast<double>(n_);
                const CountRange range{(1 - tolerance) * share, (1 + tolerance) * share};
                const Random random(seed_, (static_cast<std::uint64_t>(k) << 32U) + piece.number);
                counts[piece.number] =
                    AnnealingSweep<C>(mesh, annealing, schedule.price(), schedule.temperature(k), range, random).run(vertices);
            };
            if (k > 0) ++phase_;
            const bool ends_at_seams = k + 1 == annealing.sweeps && has_seams_;
            const double end = ends_at_seams ? done(k) + 0.9 * (done(k + 1) - done(k)) : done(k + 1);
            counts.resize(piece_count(phase_));
            if (!for_each_piece(k > 0, done(k), end, body)) return false;
            steer();
            if (ends_at_seams) {
                counts.resize(piece_count(phase_ ^ 1));
                if (!for_each_seam(end, done(k + 1), body)) return false;
            }
            if (!progress().update(done(k + 1), tiled_->vertex_count(), tiled_->energy(), tiled_->mesh_so_far())) return false;
        }
        return true;
    }

    /// Begins where this fraction of the stage is done.
    HMESH_COLD bool polish(double from) {
        const int rounds = steps_.polish_rounds;
        const auto body = [&](ImageMesh<C>& mesh, const Array<Vertex>& all, const Piece&) {
            for_each_block(mesh, all, 0, [&](Array<Vertex>& vertices) {
                flip_edges(mesh, own_edges(mesh, vertices), steps_.polish.propagate_above);
                sweep(mesh, vertices, steps_.polish);
            });
        };
        const auto begin = [&](int k) { return from + (0.95 - from) * k / rounds; };
        for (int k = 0; k < rounds; ++k) {
            if (k > 0) ++phase_;
            if (!for_each_piece(k > 0, begin(k), begin(k + 1), body)) return false;
        }
        return true;
    }

    TiledMesh<C>* tiled_;
    std::size_t n_;
    AnnealedSteps steps_;
    std::uint64_t seed_;
    double tile_;
    bool is_equal_;
    const Array<Point>* border_;
    Tilings tilings_;
    bool has_seams_;  ///< whether vertices are locked in some phases
    int phase_ = 0;   ///< the tiling of the last patches, and of the next
};

}  // namespace kit::detail

/// run(first) runs the stages of a run as planned.
template <int C, class Run>
HMESH_COLD Status Annealed::run_or_grow(kit::TiledMesh<C>& mesh, std::size_t n, Run&& run) const {
    kit::Array<kit::Point> border;
    if (const Status status = kit::detail::find_border(mesh.source(), border_tolerance, n, border); !status) return status;
    const int width = mesh.source().width(), height = mesh.source().height();
    kit::AnnealedSteps plan = steps.value_or(kit::annealed_steps(effort));
    const bool has_equal_tiles = tile != 0 || plan.annealing.sweeps == 0 || mesh.source().periodic() != Periodic::none ||
                                 mesh.source().pixels() > most_balanced;
    kit::detail::AnnealedRun<C> first(mesh, n, plan, seed, tile_size(width, height, n), has_equal_tiles, border);
    if (run(first)) return {};
    if (mesh.progress().stopped()) return kit::cancelled_by_callback();
    // More than n vertices are left, each of whose collapses would make a face below min_double_area. Growing to n in one piece,
    // without a collapse, ends at n wherever there are n places.
    plan.points = 1;
    plan.annealing.sweeps = 0;
    const bool is_done = kit::detail::AnnealedRun<C>(mesh, n, plan, seed, std::max(width, height), true, border).run();
    if (is_done || mesh.progress().stopped()) return kit::finished_or_cancelled(is_done);
    if (!border.empty())
        return {Errc::target_out_of_range, "the sides of the mesh, by border_tolerance, need more vertices between them",
                static_cast<std::int64_t>(n), static_cast<std::int64_t>(border.size())};
    return {Errc::target_out_of_range, "position_step leaves no places for so many vertices", static_cast<std::int64_t>(n),
            static_cast<std::int64_t>(mesh.vertex_count())};
}

template <int C>
Status Annealed::run(kit::TiledMesh<C>& mesh, std::size_t n) const {
    kit::IndexedMesh<C> from;
    if (start != nullptr) {
        from = kit::to_indexed_mesh<C>(*start);
        if (const kit::ChannelScale<C>* const scale = mesh.source().scale())
            for (kit::Color<C>& color : from.colors) scale->to_scaled(color);
        if (const Status status = kit::detail::check_start(*start, from, mesh.source()); !status) return status;
        kit::Array<kit::Point> border;
        if (const Status status = kit::detail::find_border(mesh.source(), border_tolerance, n, border); !status) return status;
        if (border_tolerance && !kit::detail::has_border(from, border))
            return {Errc::invalid_argument, "the mesh to start from has not the sides that border_tolerance asks for"};
    }
    return run_or_grow(mesh, n, [&](kit::detail::AnnealedRun<C>& first) {
        return start != nullptr ? first.run_from(std::move(from)) : first.run();
    });
}

template <int C>
Status Annealed::coarsen(kit::TiledMesh<C>& mesh, std::size_t n) const {
    return run_or_grow(mesh, n, [](kit::detail::AnnealedRun<C>& first) { return first.run_on(); });
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_ANNEALED_HPP
