/// \file
/// Linear light: vertex colours for renderers that interpolate linear light, not stored values.
///
/// A renderer that interpolates linear light shows in each pixel the stored value peak * e(sum over v of lambda_v l_v), where
/// l_v in [0, 1] is the linear light of vertex v, lambda_v are the pixel's barycentric coordinates, and e is the sRGB encoding.
/// A mesh whose colours were fitted for interpolation between stored values looks brighter inside faces there.
/// fit_linear_light() finds the l_v of least squared error in stored values; the geometry stays. With r the residual of a pixel,
/// the Gauss-Newton step d solves, for each channel,
///
///     sum of e'^2 lambda_v lambda_w d_w  =  - sum of e' r lambda_v
///
/// with a sparse matrix of one entry for each vertex and edge. The step is halved until the error falls. Lights stay in [0, 1]:
/// those on a bound whose step would leave it are held in the system (Bertsekas 1982), the others are clamped. Alpha is not
/// encoded: e is the identity for it.
///
/// Cost: about 35 ns a pixel and channel for each evaluation of the error: one at the start, one or more a step, one for rounded
/// colours; some 5 in all. Memory: about 0.5 KB a vertex, since channels are fitted one after the other.
#ifndef HMESH_SOLVE_LINEAR_LIGHT_HPP
#define HMESH_SOLVE_LINEAR_LIGHT_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/read_samples.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/limits.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/torus.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/normal_equations.hpp"
#include "hmesh/solve/pcg.hpp"
#include "hmesh/solve/tied_colors.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of fit_linear_light().
struct LinearLightOptions {
    /// Gauss-Newton steps a channel at most, >= 0. 0: colours are held to [0, peak] and to the grid, and the error is measured.
    int iterations = 6;
    /// A channel is done when a step lowers its error by this share of it or less, finite and >= 0; 1e-4 is 4e-4 dB.
    double min_gain = 1e-4;
    double ridge = MeshLimits().ridge;  ///< weight of the current colour against a step, in pixels; see MeshLimits::ridge
    double grid = 0;                    ///< colours become multiples of this, in stored values, finite; 0: any value
    ImageView<float, 1> weights;        ///< per-pixel weights >= 0 of the image's size (Options::weights); empty: all 1
    /// How much each channel counts in the report (Options::channel_weights); empty: all the same. Colours do not depend on it.
    std::vector<double> channel_weights{};
};

/// The report of fit_linear_light(). Energies are sums of squared differences in stored values over pixels and channels, times
/// the weights where there are any (of pixels and channels, each by its largest), for a renderer that interpolates linear light.
struct [[nodiscard]] LinearLightReport {
    double converted = 0;       ///< energy with the colours that the mesh came with, held to [0, peak] and to the grid
    double energy = 0;          ///< energy with the colours that the mesh has now; at most `converted`
    int iterations = 0;         ///< Gauss-Newton steps of the channel that took most
    int solver_iterations = 0;  ///< iterations of conjugate gradients, over all steps and channels
    double residual = 0;        ///< the largest residual of a linear system, relative to its right-hand side
    double psnr = 0;            ///< dB, of `energy`, the MSE being the mean over pixels and channels, by their weights
    Status status;              ///< not ok: the mesh is as it was, all figures are 0
};

namespace kit::detail {

/// One channel of all vertices.
struct ChannelLight {
    Array<float> stored;  ///< stored values, in [0, peak]
    Array<double> light;  ///< the linear light that they decode to, in [0, 1]; for alpha the share of the peak
};

/// The error of a mesh against the image of its size and channels, and its Gauss-Newton system, for one channel k at a time.
class LinearLight {
  public:
    LinearLight(const Mesh& mesh, const HalfedgeMesh& topology, ReadSamples read, const LinearLightOptions& options,
                const ParallelFor& parallel_for)
        : mesh_(mesh), topology_(topology), read_(read), options_(options), parallel_for_(parallel_for),
          scale_(weight_unit(options.weights, parallel_for), mesh.width, mesh.height), corners_(2 * topology.edge_slots()) {
        if (mesh.periodic != Periodic::none) tie_copies();
    }

    /// Channel k of the mesh's colours, held to [0, peak] and to the grid.
    [[nodiscard]] ChannelLight start(std::size_t k) const {
        ChannelLight out;
        for (std::size_t v = 0; v < mesh_.vertex_count(); ++v)
            add(out, k, static_cast<double>(mesh_.colors[channels() * v + k]), options_.grid);
        return out;
    }
    /// Channel k with the lights `step` times `direction` further on, clamped to [0, 1].
    [[nodiscard]] ChannelLight moved(const ChannelLight& from, std::size_t k, const DenseMatrix& direction, double step) const {
        ChannelLight out;
        for (std::size_t v = 0; v < from.light.size(); ++v) {
            const double light = from.light[v] + step * direction(v, 0);
            add(out, k, encode(k, std::max(0.0, std::min(1.0, light))) * mesh_.peak, 0);
        }
        return out;
    }
    /// Channel k with stored values rounded to the grid.
    [[nodiscard]] ChannelLight rounded(const ChannelLight& from, std::size_t k) const {
        ChannelLight out;
        for (const float stored : from.stored) add(out, k, static_cast<double>(stored), options_.grid);
        return out;
    }

    /// The error of channel k, in squared shares of the peak. Leaves the sums of the faces for direction().
    [[nodiscard]] double measure(const ChannelLight& at, std::size_t k) {
        return ordered_sum(parallel_for_, mesh_.faces.size(), 256, [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t f = begin; f < end; ++f) sum += face(at, f, k);
            return sum;
        });
    }
    /// Solves for the Gauss-Newton step `out`, n_v by 1, from `at`, for which measure() must have been called last.
    [[nodiscard]] PcgReport direction(const ChannelLight& at, std::size_t k, DenseMatrix& out) const {
        const bool is_tied = !tied_.rows.empty();
        SymmetricMatrix matrix = is_tied ? tied_matrix() : normal_matrix(topology_, corners_, parallel_for_);
        const DenseMatrix rhs = is_tied ? tied_sums() : image_sums(topology_, corners_, parallel_for_);
        std::vector<HeldEntry> held;
        for (std::size_t v = 0; v < rhs.rows; ++v) {
            const double light = at.light[is_tied ? tied_.vertices[v] : v];
            const double slope = is_encoded(k) ? linear_to_srgb_slope(light, linear_to_srgb(light)) : 1;
            matrix.add_to_diagonal(v, options_.ridge * slope * slope);
            if ((light <= 0 && rhs(v, 0) < 0) || (light >= 1 && rhs(v, 0) > 0)) held.push_back({v, 0});
        }
        out = DenseMatrix(rhs.rows, 1);
        PcgOptions exactness;
        exactness.tolerance = 1e-6;  // the encoding's curvature makes steps less exact than this
        const PcgReport report = solve_pcg(matrix, rhs, out, exactness, held);
        if (!is_tied) return report;
        DenseMatrix all(tied_.rows.size(), 1);
        for (std::size_t v = 0; v < all.rows; ++v) all(v, 0) = out(tied_.rows[v], 0);
        out = std::move(all);
        return report;
    }

  private:
    [[nodiscard]] std::size_t channels() const noexcept { return static_cast<std::size_t>(mesh_.channels); }
    [[nodiscard]] bool is_encoded(std::size_t k) const noexcept { return is_light(static_cast<int>(k), mesh_.channels); }
    [[nodiscard]] double encode(std::size_t k, double light) const noexcept {
        return is_encoded(k) ? linear_to_srgb(light) : light;
    }

    /// Makes one unknown of a vertex and its copies.
    HMESH_COLD void tie_copies() {
        tied_ = tied_rows(tied_vertices(positions_of(mesh_.view()), {mesh_.width, mesh_.height, mesh_.periodic}));
    }
    /// normal_matrix() with the rows of copies added up.
    [[nodiscard]] HMESH_COLD SymmetricMatrix tied_matrix() const {
        TiedMatrix matrix(tied_.vertices.size(), 3 * topology_.face_count());
        for_each_corner([&](Halfedge h, std::uint32_t a, std::uint32_t b) {
            matrix.add_corner(a, b, corners_[h.index()].square, corners_[h.index()].coupling);
        });
        return matrix.sum();
    }
    /// image_sums() likewise.
    [[nodiscard]] HMESH_COLD DenseMatrix tied_sums() const {
        DenseMatrix sums(tied_.vertices.size(), 1);
        for_each_corner([&](Halfedge h, std::uint32_t a, std::uint32_t) { sums(a, 0) += corners_[h.index()].image[0]; });
        return sums;
    }
    /// Calls body(h, row of its vertex, row of the next) for all half-edges with a face.
    void for_each_corner(FunctionRef<void(Halfedge h, std::uint32_t from, std::uint32_t to)> body) const {
        for (const Face f : topology_.faces()) {
            Halfedge h = topology_.halfedge(f);
            for (int k = 0; k < 3; ++k, h = topology_.next(h))
                body(h, tied_.rows[topology_.from_vertex(h).index()], tied_.rows[topology_.to_vertex(h).index()]);
        }
    }

    /// Appends a vertex with this stored value, held to [0, peak] and, where grid > 0, to the grid.
    void add(ChannelLight& to, std::size_t k, double stored, double grid) const {
        stored = std::max(0.0, std::min(mesh_.peak, stored));
        if (grid > 0) stored = GridRange({0, mesh_.peak, grid}).nearest(stored);
        to.stored.push_back(static_cast<float>(stored));
        const double share = static_cast<double>(to.stored.back()) / mesh_.peak;
        to.light.push_back(is_encoded(k) ? srgb_to_linear(share) : share);
    }

    /// The error of face f, in squared shares of the peak; its sums go to corners_.
    [[nodiscard]] double face(const ChannelLight& at, std::size_t f, std::size_t k) {
        const std::array<Vertex, 3> v = topology_.vertices(Face(f));
        Point a = position(mesh_, v[0].index()), b = position(mesh_, v[1].index()), c = position(mesh_, v[2].index());
        const bool wraps = mesh_.periodic != Periodic::none;
        if (wraps) {  // to where no pixel has a negative place
            const Torus torus{mesh_.width, mesh_.height, mesh_.periodic};
            const Turns turns = turns_into({std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})}, 0, 0, torus);
            a = turned(a, turns, torus), b = turned(b, turns, torus), c = turned(c, turns, torus);
        }
        const PixelBarycentric weights_at(a, b, c);
        const double per_peak = 1 / mesh_.peak;
        const double la = at.light[v[0].index()], lb = at.light[v[1].index()] - la, lc = at.light[v[2].index()] - la;
        // A face of one colour shows exactly that colour. Stored values are compared, not shares of the peak: these are exact,
        // also where the processor keeps more digits of some products than of others.
        const bool is_plain = lb == 0 && lc == 0;
        const auto plain = static_cast<double>(at.stored[v[0].index()]);
        double energy = 0, s00 = 0, s11 = 0, s22 = 0, s01 = 0, s12 = 0, s20 = 0, rhs0 = 0, rhs1 = 0, rhs2 = 0;
        const bool encoded = is_encoded(k);
        const auto add_pixels = [&](int j, int begin, int end) {
            std::array<double, block> samples;
            const int left = wraps ? begin % mesh_.width : begin, row = wraps ? j % mesh_.height : j;
            read_(static_cast<int>(k), row, left, left + end - begin, samples.data());
            const float* weights = options_.weights.data != nullptr ? options_.weights.pixel(left, row) : nullptr;
            for (int i = begin; i < end; ++i) {
                const Barycentric w = weights_at(i, j);
                const double light = la + w.b * lb + w.c * lc;
                const double share = encoded ? linear_to_srgb(light) : light;
                const double slope = encoded ? linear_to_srgb_slope(light, share) : 1;
                const double shown = is_plain ? plain : share * mesh_.peak;
                const double difference = (shown - samples[static_cast<std::size_t>(i - begin)]) * per_peak;
                const double weight = weights != nullptr ? scale_(weights[i - begin]) : 1;
                const double square = weight * slope * slope, rhs = -weight * slope * difference;
                energy += weight * difference * difference;
                const double qa = square * w.a, qb = square * w.b, qc = square * w.c;
                s00 += qa * w.a;
                s11 += qb * w.b;
                s22 += qc * w.c;
                s01 += qa * w.b;
                s12 += qb * w.c;
                s20 += qc * w.a;
                rhs0 += rhs * w.a;
                rhs1 += rhs * w.b;
                rhs2 += rhs * w.c;
            }
        };
        ClipRect clip;
        clip.sides = far_sides(mesh_.width, mesh_.height, mesh_.samples);
        for_each_span(a, b, c, clip, [&](int j, int begin, int end) {
            for (int next = 0; begin < end; begin = next) {
                next = std::min(end, begin + block);
                if (wraps) next = std::min(next, (begin / mesh_.width + 1) * mesh_.width);
                add_pixels(j, begin, next);
            }
        });
        const auto sums = [](double square, double coupling, double rhs) {
            CornerSums<1> out;
            out.square = square;
            out.coupling = coupling;
            out.image.set(0, rhs);
            return out;
        };
        const Halfedge h0 = topology_.halfedge(Face(f)), h1 = topology_.next(h0), h2 = topology_.next(h1);
        corners_[h0.index()] = sums(s00, s01, rhs0);
        corners_[h1.index()] = sums(s11, s12, rhs1);
        corners_[h2.index()] = sums(s22, s20, rhs2);
        return energy;
    }

    static constexpr int block = 64;  ///< pixels of a row that are read at once
    const Mesh& mesh_;
    const HalfedgeMesh& topology_;
    ReadSamples read_;
    const LinearLightOptions& options_;
    ParallelFor parallel_for_;
    WeightScale scale_;
    TiedRows tied_;                 ///< the unknowns of a periodic mesh, else none
    Array<CornerSums<1>> corners_;  ///< of the last measure(); `image` holds sums of - e' r lambda
};

/// Whether the options are in range, for an image of this size: invalid_argument with the first that is not, or what
/// check_weights() says.
[[nodiscard]] HMESH_COLD inline Status check_options(const LinearLightOptions& options, int channels, int width, int height,
                                                     const ParallelFor& parallel_for) {
    if (const Status status = check_channel_weights(options.channel_weights, channels); !status) return status;
    constexpr double any = std::numeric_limits<double>::max();
    const Status status =
        check_ranges({{"the steps of a fit to linear light must be at least 0", static_cast<double>(options.iterations), 0, any},
                      {"min_gain of a fit to linear light must be finite and at least 0", options.min_gain, 0, any},
                      {"ridge of a fit to linear light must be finite and at least 0", options.ridge, 0, any},
                      {"the grid of a fit to linear light must be finite and at least 0", options.grid, 0, any}});
    return status ? check_weights(options.weights, width, height, parallel_for) : status;
}

/// Whether the mesh fits the image: channels, size, arrays of one length, positions inside, faces of positive area; so that
/// for_each_span() stays within the image. Fills `topology` with the mesh's connectivity.
[[nodiscard]] HMESH_COLD inline Status check_fit(const Mesh& mesh, int channels, int width, int height, HalfedgeMesh& topology) {
    if (mesh.channels != channels)
        return {Errc::invalid_argument, "the mesh has not the image's number of channels", mesh.channels, channels};
    if (const Status status = check(mesh, channels); !status) return status;
    if (mesh.faces.empty()) return {Errc::invalid_argument, "the mesh has no faces", 0, 1};
    if (mesh.premultiplied)
        return {Errc::invalid_argument, "linear light is fitted to straight colours, and the mesh's are premultiplied"};
    if (mesh.width != width) return {Errc::invalid_argument, "the mesh is not as wide as the image", mesh.width, width};
    if (mesh.height != height) return {Errc::invalid_argument, "the mesh is not as high as the image", mesh.height, height};
    const auto at = [&](std::uint32_t v) { return position(mesh, v); };
    if (mesh.periodic != Periodic::none)
        if (const Status status = kit::check_periodic(mesh.view()); !status) return status;
    for (std::uint32_t v = 0; v < mesh.vertex_count() && mesh.periodic == Periodic::none; ++v)
        if (!is_inside(mesh, v)) return {Errc::invalid_argument, "the mesh has a position outside its image, at vertex", v, 0};
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (!(orient2d(at(mesh.faces[f][0]), at(mesh.faces[f][1]), at(mesh.faces[f][2])) > 0))
            return {Errc::invalid_argument, "the mesh has a face that is flipped or has no area, at face",
                    static_cast<std::int64_t>(f), 0};
    return topology.assign(mesh.vertex_count(), mesh.faces);
}

/// fit_linear_light() for a mesh that check_fit() accepted, with that connectivity.
[[nodiscard]] inline LinearLightReport fit_light(Mesh& mesh, const HalfedgeMesh& topology, ReadSamples read,
                                                 const LinearLightOptions& options, const ParallelFor& parallel_for,
                                                 FunctionRef<bool(double share)> go_on) {
    LinearLightReport report;
    const auto channels = static_cast<std::size_t>(mesh.channels);
    LinearLight scene(mesh, topology, read, options, parallel_for);
    double counted = 0;  // channels, by their weights
    bool is_stopped = false;
    for (std::size_t k = 0; k < channels; ++k) {
        const double share = weight_share(options.channel_weights, k), unit = share * mesh.peak * mesh.peak;
        counted += share;
        const ChannelLight start = scene.start(k);
        ChannelLight now = start;
        const double converted = scene.measure(now, k);
        double energy = converted;
        DenseMatrix direction;
        int steps = 0;
        for (bool gains = true; gains && energy > 0 && steps < options.iterations && !is_stopped;) {
            is_stopped =
                go_on && !go_on((static_cast<double>(k) + static_cast<double>(steps) / options.iterations) / mesh.channels);
            if (is_stopped) break;
            const PcgReport solve = scene.direction(now, k, direction);
            report.solver_iterations += solve.iterations;
            report.residual = std::max(report.residual, solve.residual);
            gains = false;
            for (double step = 1; step > 0.01; step /= 2) {  // seven tries
                ChannelLight next = scene.moved(now, k, direction, step);
                const double after = scene.measure(next, k);
                if (!(after < energy)) continue;
                gains = energy - after > options.min_gain * energy;
                now = std::move(next);
                energy = after;
                ++steps;
                break;
            }
        }
        if (options.grid > 0 && steps > 0) {
            now = scene.rounded(now, k);
            energy = scene.measure(now, k);
            if (energy > converted) now = start, energy = converted;
        }
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.colors[channels * v + k] = now.stored[v];
        report.converted += unit * converted;
        report.energy += unit * energy;
        report.iterations = std::max(report.iterations, steps);
    }
    const double weight = weight_unit(options.weights, parallel_for);
    const double samples = counted * weight_sum(options.weights, weight, mesh.width, mesh.height, parallel_for);
    report.psnr = psnr_of_energy(report.energy, samples, mesh.peak);
    return report;
}

}  // namespace kit::detail

/// Fits the colours of a finished mesh for renderers that interpolate linear light: those of least squared error to the image in
/// stored values. Call it after mesh_image() and before write_glb(), say: renderers of glTF interpolate linear light.
/// Positions and faces stay, and the copies of a vertex on the border of a periodic mesh keep one colour. Colours remain stored
/// values, in [0, peak]; the current ones, held to that range, are the start, and the error never rises. The peak is the mesh's:
/// where an image's is not that of its type, as of 12 bits in words of 16, set Mesh::peak before the call.
///
/// `view`: the image that was meshed, of the mesh's size and channels. `go_on(share)`, where given, is called before each step
/// with the share of the work done, in [0, 1); false stops the fit, and the report is still true of the mesh.
///
/// Status, with the mesh unchanged: what mesh_image() says of an image and of weights that it refuses; Errc::invalid_argument
/// for an option out of range, and where the mesh is not one of this image (channels, size, a position outside, a face without
/// positive area), is premultiplied, or has a vertex without a face; not_finite for a position or a colour that is not. About
/// 35 ns a pixel and channel for each of some 5 passes; 0.5 KB a vertex.
template <class T, int C>
LinearLightReport fit_linear_light(Mesh& mesh, const ImageView<T, C>& view, const LinearLightOptions& options = {},
                                   const ParallelFor& parallel_for = {}, FunctionRef<bool(double share)> go_on = {}) {
    LinearLightReport report;
    kit::HalfedgeMesh topology;
    report.status = check(view);
    if (report.status) report.status = kit::detail::check_fit(mesh, C, view.width, view.height, topology);
    if (report.status) report.status = kit::detail::check_options(options, C, view.width, view.height, parallel_for);
    if (report.status) report.status = kit::check_finite(view, parallel_for);
    if (!report.status) return report;
    const kit::ViewSamples<T, C> read{view};
    return kit::detail::fit_light(mesh, topology, read, options, parallel_for, go_on);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_LINEAR_LIGHT_HPP
