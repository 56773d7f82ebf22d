/// \file
/// CompactSearch: the mesh on one lattice of whose file the bytes asked for are nearly used.
///
/// The number of vertices and the steps of colours are what a lattice leaves to be chosen: a quick mesh tells about which
/// (guess()), meshes that are made as well as they shall be then have more vertices or fewer until the bytes are nearly used, and
/// colours as fine as the rest of them pays for (fill()).
#ifndef HMESH_RATE_COMPACT_SEARCH_HPP
#define HMESH_RATE_COMPACT_SEARCH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/options.hpp"
#include "hmesh/rate/compact_lattice.hpp"
#include "hmesh/rate/lattice_mesh.hpp"
#include "hmesh/rate/options.hpp"
#include "hmesh/render.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// How compact_image() writes a mesh, but for its lattice and colours.
[[nodiscard]] inline CompactOptions compact_options(const CompactImageOptions& options) {
    CompactOptions out;
    out.bare = options.bare;
    out.table = options.table;
    return out;
}

/// What compact_image() has written.
[[nodiscard]] inline CompactMesh read_file(const std::vector<std::uint8_t>& bytes, const CompactImageOptions& options) {
    return options.bare ? read_bare_compact(bytes.data(), bytes.size(), {}, options.table)
                        : read_compact(bytes.data(), bytes.size(), {}, options.table);
}

/// The PSNR of a mesh with peak 255, drawn as large as an image and rounded to its pixels.
template <class T, int C>
[[nodiscard]] double drawn_psnr(Mesh mesh, const ImageView<T, C>& view, const ParallelFor& parallel_for) {
    mesh.peak = PixelTraits<T>::peak;
    for (float& value : mesh.colors) value = static_cast<float>(static_cast<double>(value) / 255 * mesh.peak);
    RenderOptions size;
    size.width = view.width;
    size.height = view.height;
    const RenderResult<C> drawn = render<C>(mesh.view(), size, parallel_for);
    return psnr(view, to_pixels<T>(drawn.image, parallel_for).view(), parallel_for);
}

/// The image that compact_image() works with, shrunk to what is enough to judge by, and its moments.
template <int C>
struct CompactReference {
    Image<std::uint8_t, C> pixels;      ///< none where the image itself serves
    ImageView<std::uint8_t, C> view{};  ///< of these, or of the image
    kit::MomentTable<C> table;
    int width, height;  ///< px, before it was shrunk
};

/// Tells of the runs of mesh_image() as of one piece of work. How many there will be is not known: each takes a twelfth of what
/// is left.
class CompactRuns {
  public:
    explicit CompactRuns(const Progress& progress) noexcept : progress_(&progress) {}
    /// What a run reports to.
    bool operator()(const ProgressInfo& info) const {
        ProgressInfo of_all = info;
        of_all.total = 1 - 1 / (1 + (done_ + info.total) / 12);
        of_all.mesh_so_far = {};
        return (*progress_)(of_all);
    }
    /// Tells of a share of the work behind a run. Whether to go on.
    [[nodiscard]] bool tell(double share, std::size_t vertices) const {
        return !are_heard() || (*this)({"compact image", share, vertices, 0, share, {}});
    }
    void add() noexcept { ++done_; }  ///< a run has ended
    /// Whether anybody listens.
    [[nodiscard]] bool are_heard() const noexcept { return static_cast<bool>(*progress_); }

  private:
    const Progress* progress_;
    double done_ = 0;
};

/// How many rounds a mesh takes on the lattice. With `normal` 8 would gain 0.01 dB in 1.04 of all time, 16 rounds 0.03; with
/// `fine` 80 would gain 0.004.
[[nodiscard]] inline int lattice_rounds(Effort effort) noexcept {
    switch (effort) {
        case Effort::draft: return 2;
        case Effort::fast: return 4;
        case Effort::normal: return 6;
        case Effort::fine: return 40;
        case Effort::best: return 300;
    }
    return 6;
}

/// The search of compact_image() on one lattice.
template <int C>
class CompactSearch {
  public:
    /// For a file of an image, all of which outlive it.
    CompactSearch(const CompactReference<C>& image, const CompactImageOptions& options, const CompactLattice& lattice,
                  CompactRuns& runs, const ParallelFor& parallel_for)
        : image_(&image), options_(&options), lattice_(lattice), runs_(&runs), parallel_for_(&parallel_for) {
        if (lattice.has_one_image) return;
        const double per_site = lattice.per_site;
        const auto step = [&](const LatticeAxis& axis) {
            return static_cast<double>(axis.step) / per_site * axis.size / static_cast<double>(axis.end);
        };
        pixels_ = shrunk(image.view, lattice.x.pixels, lattice.y.pixels, step(lattice.x), step(lattice.y), parallel_for);
    }

    /// Whether it is the search on this lattice, by the same pixels.
    [[nodiscard]] bool is_on(const CompactLattice& lattice) const noexcept {
        return lattice == lattice_ && lattice.per_site == lattice_.per_site && lattice.has_one_image == lattice_.has_one_image;
    }

    /// Which steps of colours promise most for a mesh of n vertices, by one with so many rounds on the lattice, and how many of
    /// them the bytes pay for then. Returns what they promise, a PSNR; the lowest double where there is no such mesh on the
    /// lattice or, where `status` is not ok, none at all.
    [[nodiscard]] double guess(std::int64_t& n, std::uint32_t& color_step, const Annealed& recipe, int rounds, Status& status) {
        static constexpr std::array<std::uint32_t, 11> steps{16, 23, 32, 45, 64, 90, 128, 180, 256, 362, 512};
        double most = std::numeric_limits<double>::lowest();
        if (!mesh(n, recipe, rounds, status)) return most;
        const auto is_better = [&](std::size_t k) {
            const std::vector<std::uint8_t> file = write(steps[k]);
            const double share = share_of(file);
            // Of photographs and drawings alike some 1.7 dB for twice the bytes.
            const double promise = about_psnr_of(file) - 5.5 * std::log10(share);
            if (promise <= most) return false;
            most = promise;
            color_step = steps[k];
            n = paid_for(mesh_.vertex_count(), rounds > 0 ? share : 1.015 * share);  // those to come take some bytes
            return true;
        };
        std::size_t down = 7, up = down;
        while (up < steps.size() && is_better(up)) ++up;
        if (up == down + 1)
            while (down > 0 && is_better(down - 1)) --down;
        return most;
    }

    /// Looks for the number of vertices, n to begin with, that the bytes pay for with these steps of colours or nearly so; n
    /// becomes that. `best` becomes the file of least error found, if that is less than its own. Returns whether to go on.
    [[nodiscard]] bool fill(std::int64_t& n, std::uint32_t color_step, const Annealed& recipe, CompactImage& best) {
        // Steps of colours that make good 3 % cost some 0.01 dB, another run as much time as the first.
        const double enough = recipe.effort <= Effort::normal ? 1.03 : 1.02;
        std::int64_t below = 3, above = most_vertices() + 1;
        for (int run = 0; run < 8 && above - below > 1; ++run) {
            n = std::max(below + 1, std::min(above - 1, n));
            std::vector<std::uint8_t> file;
            if (mesh(n, recipe, lattice_rounds(recipe.effort), best.status)) file = write(color_step);
            if (!best.status) return false;
            if (file.empty()) {  // there are too few sites
                above = n;
                n = n * 9 / 10;
                continue;
            }
            const double share = share_of(file);
            const bool fits = share <= 1.05 && keep(color_step, std::move(file), best);
            if (share > 1) above = n;
            else below = n;
            if (fits && share > 0.96 && share <= enough) break;
            n = paid_for(static_cast<std::size_t>(n), share);
        }
        return true;
    }

    /// The file of a mesh of 4 vertices becomes `best`, or target_out_of_range its status. Returns whether to go on.
    [[nodiscard]] bool begin(const Annealed& recipe, CompactImage& best) {
        if (!mesh(4, recipe, 1, best.status)) return false;
        std::vector<std::uint8_t> file = write(CompactHead::coarsest);
        const std::size_t least = file.size();
        if (least <= options_->bytes) return keep(CompactHead::coarsest, std::move(file), best);
        best.status = {Errc::target_out_of_range, "a compact file of the image has more bytes, even of 4 vertices", least,
                       options_->bytes};
        return false;
    }

  private:
    [[nodiscard]] ImageView<std::uint8_t, C> first_image() const noexcept {
        return lattice_.has_one_image ? image_->view : pixels_.view();
    }
    // What share of the bytes a file takes.
    [[nodiscard]] double share_of(const std::vector<std::uint8_t>& file) const noexcept {
        return static_cast<double>(file.size()) / static_cast<double>(options_->bytes);
    }
    // How many vertices all bytes pay for, where so many take a share of them: that may be any number.
    [[nodiscard]] static std::int64_t paid_for(std::size_t vertices, double share) noexcept {
        return static_cast<std::int64_t>(std::min(static_cast<double>(vertices) / share, 1e15));
    }
    [[nodiscard]] std::int64_t most_vertices() const noexcept {
        const std::int64_t pixels = std::int64_t{first_image().width} * first_image().height;
        return std::max<std::int64_t>(4, std::min(pixels, CompactLimits{}.max_vertices));  // as its own files are read
    }
    /// Meshes the image with n vertices, less those that find no site on the lattice, with so many rounds there. Whether there is
    /// such a mesh.
    [[nodiscard]] bool mesh(std::int64_t n, const Annealed& recipe, int rounds, Status& status) {
        Options options;
        options.target = Target::vertices(std::min(n, most_vertices()));
        options.limits.position_step = lattice_.has_one_image ? 0.25 : lattice_.per_site;
        options.round_colors = false;
        if (runs_->are_heard()) options.progress = *runs_;
        const Result result = mesh_image(first_image(), options, recipe, *parallel_for_);
        runs_->add();
        status = result.status;
        if (status.code == Errc::target_out_of_range) return status = {}, false;  // a line of pixels has not places for all
        if (!status) return false;
        LatticeMesh<C> settled(image_->table, lattice_, recipe.seed);
        bool goes_on = true;
        const bool is_there = settled.settle(result.mesh, rounds, [&](double share) {
            return goes_on = goes_on && runs_->tell(share, result.mesh.vertex_count());
        });
        runs_->add();
        if (!goes_on) status = kit::cancelled_by_callback();
        if (!goes_on || !is_there) return false;
        mesh_ = settled.mesh();
        mesh_.premultiplied = options_->premultiplied;
        return true;
    }
    /// The file of the mesh.
    [[nodiscard]] std::vector<std::uint8_t> write(std::uint32_t color_step) const {
        CompactOptions options = compact_options(*options_);
        options.color_step = color_step;
        options.lattice = static_cast<std::uint32_t>(options_->bare ? 256 : lattice_.x.step);
        std::vector<std::uint8_t> file;
        if (!write_compact(mesh_.view(), kit::append_to(file), options)) file.clear();
        return file;
    }

    /// `file` has colours of this step. The one of the finest that the bytes pay for, or nearly so, becomes `best` if its error
    /// is less. Whether there is one.
    bool keep(std::uint32_t color_step, std::vector<std::uint8_t> file, CompactImage& best) const {
        std::vector<std::uint8_t> trial = std::move(file);
        std::uint32_t over = 0, within = CompactHead::coarsest + 1;  // the coarsest step of too many bytes, the finest of not
        double share_over = 0, share_within = 0;
        file.clear();
        for (int tries = 0; !trial.empty(); ++tries) {
            const double share = share_of(trial);
            if (share > 1) over = color_step, share_over = share;
            else within = color_step, share_within = share, file = std::move(trial);
            if (within - over <= 1 || tries == 6 || (share <= 1 && share > 0.998)) break;
            // Of photographs twice the step saves a ninth; of gradients more, so that this alone would go to and fro. Between two
            // steps the share falls evenly but for leaps, where the middle comes closer.
            double next = color_step * std::exp2(9 * (share - 1));
            if (over > 0 && within <= CompactHead::coarsest) {
                const double part = tries > 3 ? 0.5 : (share_over - 0.9993) / (share_over - share_within);
                next = over + part * (within - over);
            }
            color_step = static_cast<std::uint32_t>(std::max(over + 1.0, std::min(within - 1.0, std::round(next))));
            trial = write(color_step);
        }
        if (file.empty()) return false;
        const double reached = psnr_of(file);
        if (!best.bytes.empty() && !(reached > best.psnr)) return true;
        best.bytes = std::move(file);
        best.color_step = within;
        best.psnr = reached;
        return true;
    }
    /// The PSNR of the mesh that bytes hold, drawn as large as the reference.
    [[nodiscard]] double psnr_of(const std::vector<std::uint8_t>& bytes) const {
        return drawn_psnr(read_file(bytes, *options_).mesh, image_->view, *parallel_for_);
    }
    /// The same of the mesh as it is drawn without rounding, in a quarter of the time.
    [[nodiscard]] double about_psnr_of(const std::vector<std::uint8_t>& bytes) const {
        const ImageView<std::uint8_t, C>& view = image_->view;
        Mesh mesh = read_file(bytes, *options_).mesh;
        const double scale[2] = {static_cast<double>(view.width) / mesh.width, static_cast<double>(view.height) / mesh.height};
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            mesh.positions[i] = static_cast<float>(scale[i % 2] * static_cast<double>(mesh.positions[i]));
        mesh.width = view.width, mesh.height = view.height;
        const double energy = kit::rendered_errors(mesh, view, {}, 1, *parallel_for_).energy;
        return kit::psnr_of_energy(energy, static_cast<double>(view.width) * view.height * C, 255);
    }
    const CompactReference<C>* image_;
    const CompactImageOptions* options_;
    CompactLattice lattice_;
    CompactRuns* runs_;
    const ParallelFor* parallel_for_;
    Image<std::uint8_t, C> pixels_;  // of the first image, where it is not the second
    Mesh mesh_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RATE_COMPACT_SEARCH_HPP
