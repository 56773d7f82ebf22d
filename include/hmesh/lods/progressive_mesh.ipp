// hmesh - the definition of progressive_mesh(). Included by progressive_mesh.hpp only; empty where a program compiles it in another
// file.
#ifndef HMESH_LODS_PROGRESSIVE_MESH_IPP
#define HMESH_LODS_PROGRESSIVE_MESH_IPP
#if !defined(HMESH_COMPILED) || defined(HMESH_IMPLEMENTATION)

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/methods/annealed/annealed.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace kit {

/// Optimises the colours of these vertices; positions stay.
template <int C>
void recolor(ImageMesh<C>& mesh, const kit::Array<Vertex>& vertices) {
    for (const Vertex v : vertices) improve_vertex(mesh, v, std::numeric_limits<double>::max());
}

/// Removes up to `count` vertices as remove_batch() of edit/collapse.hpp does, with all others in their places: after each
/// removal the colours around it are optimised, edges flipped, and colours optimised again. Returns how many went.
template <int C>
HMESH_COLD std::size_t thin_batch(ImageMesh<C>& mesh, std::size_t count) {
    const HalfedgeMesh& topology = mesh.topology();
    const kit::Array<Removal> removals = cheapest_removals(mesh, spatial_vertices(mesh), count);
    RingScratch<C> scratch;
    kit::Array<Vertex> ring;
    kit::Array<Edge> edges;
    const double min_gain = 1e-2 * mesh.mean_energy();
    std::size_t removed = 0;
    for (const Removal& removal : in_place_order(removals, count)) {
        const CollapseCandidate now = cheapest_collapse(mesh, scratch, removal.vertex);
        if (!now.halfedge.is_valid()) continue;
        ring.clear();
        for (const Halfedge h : topology.outgoing(removal.vertex)) ring.push_back(topology.to_vertex(h));
        mesh.collapse(now.halfedge);
        recolor(mesh, ring);
        for (const Vertex v : ring) {
            edges.clear();
            for (const Halfedge h : topology.outgoing(v)) edges.push_back(HalfedgeMesh::edge(h));
            for (const Edge e : edges) improve_edge(mesh, e, min_gain);
        }
        recolor(mesh, ring);
        ++removed;
    }
    return removed;
}

namespace detail {

/// A level before vertices have their order: those present, by their number in the finest mesh, and the faces between them.
struct ThinnedLevel {
    kit::Array<std::uint32_t> vertices;  ///< rising
    std::vector<Triangle> faces;          ///< of numbers in the finest mesh
};

/// The mesh as it is now.
template <int C>
[[nodiscard]] HMESH_COLD ThinnedLevel thinned_level(const ImageMesh<C>& mesh) {
    ThinnedLevel out;
    for (const Vertex v : mesh.topology().vertices()) out.vertices.push_back(static_cast<std::uint32_t>(v.index()));
    out.faces = mesh.topology().triangles();
    for (Triangle& face : out.faces)
        for (std::uint32_t& v : face) v = out.vertices[v];
    return out;
}

/// The levels of these numbers of vertices after the mesh, which is thinned to the last of them; fewer where no more vertices can
/// be removed. Asks progress after each batch, and ends early where that says stop.
template <int C>
[[nodiscard]] HMESH_COLD std::vector<ThinnedLevel> thin(ImageMesh<C>& mesh, const kit::Array<std::size_t>& counts,
                                                        ProgressReporter& progress) {
    std::vector<ThinnedLevel> levels{thinned_level(mesh)};
    const auto first = static_cast<double>(mesh.vertex_count());
    for (const std::size_t n : counts) {
        while (mesh.vertex_count() > n) {
            // Larger batches take vertices that are not cheap: 3 % is worth 0.1 dB over 15 %.
            const std::size_t most = mesh.vertex_count() / 32 + 1;
            if (thin_batch(mesh, std::min(mesh.vertex_count() - n, most)) == 0) return levels;
            if (!progress.update(1 - static_cast<double>(mesh.vertex_count()) / first, mesh.vertex_count(), mesh.energy()))
                return levels;
        }
        const kit::Array<Vertex> vertices = spatial_vertices(mesh);
        for (int round = 0; round < 2; ++round) {
            recolor(mesh, vertices);
            flip_edges(mesh);
        }
        levels.push_back(thinned_level(mesh));
    }
    return levels;
}

/// The new number of each vertex: those of the coarsest level come first, then those that the next finer one adds, and so on,
/// among themselves in their old order.
[[nodiscard]] HMESH_COLD inline kit::Array<std::uint32_t> nested_numbers(const std::vector<ThinnedLevel>& levels) {
    constexpr auto none = static_cast<std::uint32_t>(-1);
    kit::Array<std::uint32_t> numbers(levels.front().vertices.size(), none);
    std::uint32_t next = 0;
    for (auto level = levels.rbegin(); level != levels.rend(); ++level)
        for (const std::uint32_t v : level->vertices)
            if (numbers[v] == none) numbers[v] = next++;
    return numbers;
}

/// The sum of the systems, each times its weight; rows of vertices that a level does not have come after its own.
template <int C>
[[nodiscard]] HMESH_COLD ColorSystem<C> weighted_sum(const std::vector<ColorSystem<C>>& systems,
                                                     const kit::Array<double>& weights) {
    ColorSystem<C> sum;
    sum.anchor = systems.front().anchor;
    sum.ridge = systems.front().ridge;
    for (std::size_t row = 0; row < sum.anchor.size(); ++row) {
        Color<C> rhs = Color<C>::zero();
        double diagonal = sum.ridge;
        for (std::size_t k = 0; k < systems.size(); ++k) {
            const SymmetricMatrix& gram = systems[k].gram;
            if (row >= gram.size()) continue;
            rhs += systems[k].rhs[row] * weights[k];
            diagonal += weights[k] * gram.diagonal(row);
            for (int e = gram.starts[row]; e < gram.starts[row + 1]; ++e) {  // a column may come once for each level
                sum.gram.columns.push_back(gram.columns[static_cast<std::size_t>(e)]);
                sum.gram.values.push_back(weights[k] * gram.values[static_cast<std::size_t>(e)]);
            }
        }
        sum.gram.starts.push_back(static_cast<int>(sum.gram.columns.size()));
        sum.rhs.push_back(rhs);
        sum.inverse.push_back(diagonal > 0 ? 1 / diagonal : 0);
    }
    return sum;
}

/// The meshes of levels over one buffer of vertices: their errors as functions of its colours.
template <int C>
class NestedColors {
  public:
    /// faces[k] are those of level k, which uses the first counts[k] of the vertices.
    NestedColors(const MomentTable<C>& table, const ImageSource<C>& source, const MeshLimits& limits,
                 const kit::Array<Point>& positions, const std::vector<std::vector<Triangle>>& faces,
                 const kit::Array<std::size_t>& counts, kit::Array<Color<C>> colors, const ParallelFor& parallel_for)
        : colors_(std::move(colors)), parallel_for_(parallel_for) {
        for (Color<C>& c : colors_) clamp_channels<C>(c, source.low(), source.high());
        for (std::size_t k = 0; k < faces.size(); ++k) {
            const auto n = static_cast<std::ptrdiff_t>(counts[k]);
            ImageMesh<C> mesh(table, source.low(), source.high(), limits);
            const Status status = mesh.assign({positions.begin(), positions.begin() + n}, faces[k],
                                              {colors_.begin(), colors_.begin() + n}, parallel_for);
            HMESH_ASSERT(status);
            (void)status;
            systems_.push_back(color_system(mesh.topology(), corner_sums(mesh, parallel_for),
                                            kit::Array<Color<C>>(colors_.begin(), colors_.begin() + n), limits.ridge,
                                            parallel_for));
            meshes_.push_back(std::move(mesh));
        }
    }

    /// The colours.
    [[nodiscard]] const kit::Array<Color<C>>& colors() const noexcept { return colors_; }
    /// The squared error of each level.
    [[nodiscard]] HMESH_COLD kit::Array<double> energies() {
        kit::Array<double> out;
        for (ImageMesh<C>& mesh : meshes_) {
            mesh.set_colors({colors_.begin(), colors_.begin() + static_cast<std::ptrdiff_t>(mesh.vertex_count())}, parallel_for_);
            out.push_back(std::max(0.0, mesh.energy()));
        }
        return out;
    }
    /// Fits the colours, within a range, to all levels; each is weighted by its share coarser_weight^k over its error as it is now.
    /// Repeated, this makes the weighted sum of the errors' logarithms least. go_on() is asked between sweeps.
    HMESH_COLD void fit(ColorRange range, double coarser_weight, FunctionRef<bool()> go_on) {
        kit::Array<double> weights = energies();
        const double most = *std::max_element(weights.begin(), weights.end());
        double sum = 0, share = 1;
        // A level without error would take all: it counts a million times at most.
        for (double& weight : weights) {
            sum += weight = share / std::max(weight, most > 0 ? 1e-6 * most : 1);
            share *= coarser_weight;
        }
        for (double& weight : weights) weight *= static_cast<double>(weights.size()) / sum;
        (void)descend(weighted_sum(systems_, weights), range, colors_, go_on);
    }

  private:
    kit::Array<Color<C>> colors_;
    std::vector<ImageMesh<C>> meshes_;
    std::vector<ColorSystem<C>> systems_;
    ParallelFor parallel_for_;
};

}  // namespace detail
}  // namespace kit

namespace detail {

/// Levels whose vertices have the order that they share: level k has the first counts[k].
template <int C>
struct NestedLevels {
    kit::IndexedMesh<C> vertices;              ///< without faces of its own
    std::vector<std::vector<Triangle>> faces;  ///< of each level, the finest first
    kit::Array<std::size_t> counts;
};
/// Orders the vertices of the finest mesh as its levels ask for.
template <int C>
[[nodiscard]] HMESH_COLD NestedLevels<C> nested(const kit::IndexedMesh<C>& finest,
                                                std::vector<kit::detail::ThinnedLevel> levels) {
    const kit::Array<std::uint32_t> numbers = kit::detail::nested_numbers(levels);
    NestedLevels<C> out;
    out.vertices = finest;
    for (std::size_t v = 0; v < numbers.size(); ++v) {
        out.vertices.positions[numbers[v]] = finest.positions[v];
        out.vertices.colors[numbers[v]] = finest.colors[v];
    }
    for (kit::detail::ThinnedLevel& level : levels) {
        for (Triangle& face : level.faces)
            for (std::uint32_t& v : face) v = numbers[v];
        out.counts.push_back(level.vertices.size());
        out.faces.push_back(std::move(level.faces));
    }
    return out;
}

/// Says of each level how far it is off the image.
template <int C>
HMESH_COLD void tell_errors(const kit::ImageSource<C>& source, double samples, const kit::Array<double>& energies,
                            const ParallelFor& parallel_for, ProgressiveMesh& out) {
    for (std::size_t k = 0; k < out.levels.size(); ++k) {
        ProgressiveLevel& level = out.levels[k];
        level.energy = energies[k];
        if (!source.has_exact_sums(source.width())) {
            Mesh drawn = out.mesh;
            drawn.faces = level.faces;
            level.energy = kit::rendered_errors(drawn, source, parallel_for).energy;
        }
        level.psnr = kit::psnr_of_energy(level.energy, samples, source.peak());
    }
}

/// progressive_mesh() of an image that passed all checks.
template <int C>
HMESH_COLD void nest(const kit::ImageSource<C>& source, double samples, const Mesh& finest, const Options& options,
                     const ProgressiveOptions& nested_options, const ParallelFor& parallel_for, ProgressiveMesh& out) {
    const kit::IndexedMesh<C> start = kit::to_indexed_mesh<C>(finest);
    out.status = kit::detail::check_start(finest, start, source);
    if (out.status && finest.premultiplied != options.premultiplied)
        out.status = {Errc::invalid_argument, "the mesh and the options differ in whether colours are premultiplied",
                      finest.premultiplied ? 1 : 0, options.premultiplied ? 1 : 0};
    if (out.status) out.status = check_tables(source, std::max(source.width(), source.height()));
    if (!out.status) return;

    kit::ProgressReporter progress(options.progress, samples, source.peak());
    progress.plan({0.85, 0.15});
    const kit::PollingExecutor polling(progress, parallel_for);
    const kit::MomentTable<C> table = source.table({0, 0, source.width(), source.height()}, parallel_for);
    kit::ImageMesh<C> mesh(table, source.low(), source.high(), options.limits);
    out.status = mesh.assign(start.positions, start.faces, start.colors, parallel_for);
    if (!out.status) return;
    std::vector<kit::detail::ThinnedLevel> levels;
    if (progress.begin("thinning", mesh.vertex_count(), mesh.energy()))
        levels = kit::detail::thin(mesh, halves(start.vertex_count(), nested_options.levels - 1), progress);
    progress.end(mesh.vertex_count(), mesh.energy());
    progress.begin_colors(start.vertex_count(), mesh.energy());
    if (progress.stopped()) {
        out.status = kit::cancelled_by_callback();
        return;
    }

    NestedLevels<C> all = nested(start, std::move(levels));
    kit::detail::NestedColors<C> fit(table, source, options.limits, all.vertices.positions, all.faces, all.counts,
                                     std::move(all.vertices.colors), polling);
    const double grid = source.is_integer() && options.round_colors ? 1 : 0;
    for (int round = 0; round < 3; ++round) {
        fit.fit({source.low(), source.high(), round < 2 ? 0 : grid}, nested_options.coarser_weight, [&] { return progress.poll(); });
        if (!progress.stopped()) continue;
        out.status = kit::cancelled_by_callback();
        return;
    }
    const kit::Array<double> energies = fit.energies();
    all.vertices.colors = fit.colors();
    all.vertices.faces = all.faces.front();
    out.mesh = kit::to_mesh(all.vertices, source.peak());
    out.mesh.premultiplied = options.premultiplied;
    for (std::size_t k = 0; k < all.faces.size(); ++k) out.levels.push_back({all.counts[k], std::move(all.faces[k]), 0, 0});
    tell_errors(source, samples, energies, polling, out);
    progress.end(start.vertex_count(), out.levels.front().energy);
    if (!progress.stopped()) return;
    out = ProgressiveMesh();
    out.status = kit::cancelled_by_callback();
}

}  // namespace detail

template <class T, int C>
ProgressiveMesh progressive_mesh(const ImageView<T, C>& view, const Mesh& finest, const Options& options,
                                 const ProgressiveOptions& nested_options, const ParallelFor& parallel_for) {
    ProgressiveMesh out;
    out.status = check(nested_options);
    if (!out.status) return out;
    const auto accept = [&](int, int) -> Status {
        if (kit::differ(options.channel_weights))
            return {Errc::invalid_argument, "levels over one vertex buffer know no channel_weights"};
        if (options.periodic != Periodic::none || finest.periodic != Periodic::none)
            return {Errc::invalid_argument, "levels over one vertex buffer are of images that do not repeat"};
        return {};
    };
    const auto body = [&](const detail::Subject<C>& subject, const ImageView<T, C>&) {
        detail::nest(*subject.image, subject.samples, finest, options, nested_options, parallel_for, out);
    };
    if (const Status status = detail::with_subject<T, C>(view, options, accept, parallel_for, body); !status) out.status = status;
    return out;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_COMPILED
#endif  // HMESH_LODS_PROGRESSIVE_MESH_IPP
