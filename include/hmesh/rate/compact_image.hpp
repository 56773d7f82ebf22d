/// \file
/// compact_image(): an image in a given number of bytes, as a compact file.
///
/// Nothing is rounded but what was meshed for it: the mesh is annealed with its vertices on the lattice of the file. How coarse
/// that lattice is and the steps of colours are, and with it how many vertices the bytes pay for, is tried: first one mesh of
/// each lattice, at all steps of colours; then the pair of both that promises most, with more vertices or fewer until the bytes
/// are used; what is left of them goes into finer colours.
#ifndef HMESH_RATE_COMPACT_IMAGE_HPP
#define HMESH_RATE_COMPACT_IMAGE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/options.hpp"
#include "hmesh/rate/compact_lattice.hpp"
#include "hmesh/render.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of compact_image().
struct CompactImageOptions {
    std::size_t bytes = 300;              ///< the most that the file may have
    bool bare = false;                    ///< whether to write the bare profile: CompactOptions::bare
    const CompactTable* table = nullptr;  ///< what contexts begin with: CompactOptions::table
    bool premultiplied = false;  ///< whether colours of 2 or 4 channels are multiplied by alpha first: Options::premultiplied
    Progress progress{};         ///< is told how far the work is and may cancel it; its callable must outlive the call
};

/// What compact_image() returns.
struct [[nodiscard]] CompactImage {
    std::vector<std::uint8_t> bytes;  ///< the file, for read_compact() or read_bare_compact(); or none
    Mesh mesh;                        ///< what it holds; of a bare one as large as its lattice
    std::uint32_t color_step = 0;     ///< of its colours, see CompactOptions
    double psnr = 0;                  ///< of the mesh drawn at the image's size and rounded to 8 bits, in dB: hmesh::psnr()
    Status status;                    ///< ok, or why there are no bytes
};

namespace detail {

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

/// The image that compact_image() works with: `width` x `height` px shrunk by `shrink` to what is enough to judge by.
template <int C>
struct CompactReference {
    Image<std::uint8_t, C> pixels;
    int width, height, shrink;
};

/// Removes a vertex where triangles of one of its neighbours can take the place of its own: of that with the largest least area.
/// False, and nothing happens, where there is none, as of corners.
[[nodiscard]] HMESH_COLD inline bool remove_vertex(Mesh& mesh, std::uint32_t v) {
    std::vector<std::array<std::uint32_t, 2>> ring;  // the edges across from v
    for (const std::array<std::uint32_t, 3>& face : mesh.faces)
        for (std::size_t k = 0; k < 3; ++k)
            if (face[k] == v) ring.push_back({face[(k + 1) % 3], face[(k + 2) % 3]});
    const auto place = [&](std::uint32_t u) {
        return kit::Point{static_cast<double>(mesh.positions[std::size_t{2} * u]),
                          static_cast<double>(mesh.positions[std::size_t{2} * u + 1])};
    };
    const auto count = [&](std::size_t end, std::uint32_t u) {
        return std::count_if(ring.begin(), ring.end(), [&](const auto& edge) { return edge[end] == u; });
    };
    // On the mesh's border the ring is open, and its ends are the neighbours along the border; corners stay.
    std::vector<std::uint32_t> ends;
    for (const auto& [a, b] : ring) {
        if (count(1, a) == 0) ends.push_back(a);
        if (count(0, b) == 0) ends.push_back(b);
    }
    const bool is_open = !ends.empty();
    if (is_open && (ends.size() != 2 || kit::orient2d(place(ends[0]), place(v), place(ends[1])) != 0)) return false;
    std::uint32_t best = v;
    double largest = 0;
    for (const auto& edge : ring)
        for (const std::uint32_t u : edge) {
            if (is_open && u != ends[0] && u != ends[1]) continue;
            double least = std::numeric_limits<double>::infinity();
            for (const auto& [a, b] : ring)
                if (a != u && b != u) least = std::min(least, kit::orient2d(place(u), place(a), place(b)));
            if (least > largest && std::isfinite(least)) largest = least, best = u;
        }
    if (best == v) return false;
    const auto is_beside = [&](const std::array<std::uint32_t, 3>& face) {
        return std::find(face.begin(), face.end(), v) != face.end();
    };
    mesh.faces.erase(std::remove_if(mesh.faces.begin(), mesh.faces.end(), is_beside), mesh.faces.end());
    for (const auto& [a, b] : ring)
        if (a != best && b != best) mesh.faces.push_back({best, a, b});
    for (std::array<std::uint32_t, 3>& face : mesh.faces)
        for (std::uint32_t& u : face) u -= u > v ? 1 : 0;
    const auto begin = [v](auto& numbers, std::size_t each) { return numbers.begin() + static_cast<std::ptrdiff_t>(each * v); };
    mesh.positions.erase(begin(mesh.positions, 2), begin(mesh.positions, 2) + 2);
    mesh.colors.erase(begin(mesh.colors, static_cast<std::size_t>(mesh.channels)),
                      begin(mesh.colors, static_cast<std::size_t>(mesh.channels)) + mesh.channels);
    return true;
}

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
    void add() noexcept { ++done_; }  ///< a run has ended
    /// Whether anybody listens.
    [[nodiscard]] bool are_heard() const noexcept { return static_cast<bool>(*progress_); }

  private:
    const Progress* progress_;
    double done_ = 0;
};

/// The search of compact_image() on one lattice.
template <int C>
class CompactSearch {
  public:
    /// For a file of an image, all of which outlive it.
    CompactSearch(const CompactReference<C>& image, const CompactImageOptions& options, const CompactLattice& lattice,
                  CompactRuns& runs, const ParallelFor& parallel_for)
        : image_(&image), options_(&options), lattice_(lattice), runs_(&runs), parallel_for_(&parallel_for),
          pixels_(shrunk(image.pixels.view(), lattice.columns, lattice.rows, lattice.step_x / image.shrink,
                         lattice.step_y / image.shrink, parallel_for)) {}

    /// Which steps of colours promise most for a mesh of n vertices, and how many of them the bytes pay for then. False: there is
    /// no such mesh on the lattice or, where `status` is not ok, none at all.
    [[nodiscard]] bool guess(std::int64_t& n, std::uint32_t& color_step, const Annealed& recipe, Status& status) {
        if (!mesh(n, recipe, status)) return false;
        double most = -1e300;
        for (const std::uint32_t step : {48U, 68U, 96U, 136U, 192U, 272U, 384U}) {
            const std::vector<std::uint8_t> file = write(step);
            const double share = static_cast<double>(file.size()) / static_cast<double>(options_->bytes);
            // Of photographs and drawings alike some 2 dB for twice the bytes.
            const double promise = psnr_of(file) - 6.6 * std::log10(share);
            if (promise <= most) continue;
            most = promise;
            color_step = step;
            n = static_cast<std::int64_t>(static_cast<double>(mesh_.vertex_count()) / share);
        }
        return true;
    }

    /// Looks for the number of vertices, n to begin with, that the bytes pay for with these steps of colours, or somewhat finer
    /// ones. `best` becomes the file of least error found, if that is less than its own. Returns whether to go on.
    [[nodiscard]] bool fill(std::int64_t n, std::uint32_t color_step, const Annealed& recipe, CompactImage& best) {
        const auto budget = static_cast<double>(options_->bytes);
        std::int64_t below = 3, above = std::max<std::int64_t>(4, std::int64_t{pixels_.width()} * pixels_.height()) + 1;
        for (int run = 0; run < 8 && above - below > 1; ++run) {
            n = std::max(below + 1, std::min(above - 1, n));
            std::vector<std::uint8_t> file;
            if (mesh(n, recipe, best.status)) file = write(color_step);
            if (!best.status) return false;
            if (file.empty()) {  // there are too few sites
                above = n;
                n = n * 9 / 10;
                continue;
            }
            const auto size = static_cast<double>(file.size());
            if (file.size() > options_->bytes) {
                above = n;
            } else {
                below = n;
                keep(std::move(file), color_step, best);
                if (size > 0.985 * budget) break;
            }
            n = static_cast<std::int64_t>(static_cast<double>(n) * 0.994 * budget / size);
        }
        return true;
    }

    /// The file of a mesh of 4 vertices becomes `best`, or target_out_of_range its status. Returns whether to go on.
    [[nodiscard]] bool begin(const Annealed& recipe, CompactImage& best) {
        if (!mesh(4, recipe, best.status)) return false;
        std::vector<std::uint8_t> file = write(CompactHead::coarsest);
        if (file.size() <= options_->bytes) return keep(std::move(file), CompactHead::coarsest, best), true;
        best.status = {Errc::target_out_of_range, "a compact file of the image has more bytes, even of 4 vertices", file.size(),
                       options_->bytes};
        return false;
    }

  private:
    /// Meshes the image with n vertices, less those that find no site on the lattice. Whether there is such a mesh.
    [[nodiscard]] bool mesh(std::int64_t n, const Annealed& recipe, Status& status) {
        const ImageView<std::uint8_t, C> pixels = pixels_.view();
        const std::int64_t most = std::max<std::int64_t>(4, std::int64_t{pixels.width} * pixels.height);
        Options options;
        options.target = Target::vertices(std::min(n, most));
        options.limits.position_step = lattice_.per_site;
        if (runs_->are_heard()) options.progress = *runs_;
        Result result = mesh_image(pixels, options, recipe, *parallel_for_);
        runs_->add();
        status = result.status;
        if (!status) return false;
        mesh_ = std::move(result.mesh);
        mesh_.premultiplied = options_->premultiplied;
        for (std::int64_t left = 4 + n / 8; left > 0; --left) {
            std::vector<std::uint8_t> file;
            const Status written = write(CompactHead::coarsest, file);
            if (written) return true;
            if (written.what != lattice_has_no_site || !remove_vertex(mesh_, static_cast<std::uint32_t>(written.value)))
                return false;
        }
        return false;
    }
    /// The file of the mesh, for which there are sites.
    [[nodiscard]] std::vector<std::uint8_t> write(std::uint32_t color_step) const {
        std::vector<std::uint8_t> file;
        const Status status = write(color_step, file);
        HMESH_ASSERT(status);
        return status ? file : std::vector<std::uint8_t>();
    }
    [[nodiscard]] Status write(std::uint32_t color_step, std::vector<std::uint8_t>& file) const {
        Mesh moved = mesh_;
        const auto per_site = static_cast<float>(lattice_.per_site);
        CompactOptions options;
        options.color_step = color_step;
        options.bare = options_->bare;
        options.table = options_->table;
        if (options_->bare) {
            moved.width = lattice_.columns / lattice_.per_site;
            moved.height = lattice_.rows / lattice_.per_site;
            for (float& place : moved.positions) place = std::floor(place / per_site * 256 + 0.5F) / 256;
            options.lattice = 256;
        } else {
            const auto scale = static_cast<float>(lattice_.shrink);
            moved.width = image_->width;
            moved.height = image_->height;
            for (std::size_t i = 0; i < moved.positions.size(); ++i)
                moved.positions[i] =
                    std::min(moved.positions[i] * scale, static_cast<float>(i % 2 == 0 ? moved.width : moved.height));
            options.lattice = static_cast<std::uint32_t>(256 * lattice_.shrink * lattice_.per_site);
        }
        const auto sink = [&](const void* from, std::size_t size) {
            const auto* const begin = static_cast<const std::uint8_t*>(from);
            file.insert(file.end(), begin, begin + size);
            return true;
        };
        return write_compact(moved.view(), sink, options);
    }

    /// Puts the bytes that a file leaves into finer colours. It becomes `best` if its error is less.
    void keep(std::vector<std::uint8_t> file, std::uint32_t color_step, CompactImage& best) const {
        for (std::uint32_t less = 2048; less > 0; less /= 2) {
            if (color_step <= less) continue;
            std::vector<std::uint8_t> finer = write(color_step - less);
            if (finer.size() > options_->bytes) continue;
            file = std::move(finer);
            color_step -= less;
        }
        const double reached = psnr_of(file);
        if (!best.bytes.empty() && !(reached > best.psnr)) return;
        best.bytes = std::move(file);
        best.color_step = color_step;
        best.psnr = reached;
    }
    /// The PSNR of the mesh that bytes hold, drawn as large as the reference.
    [[nodiscard]] double psnr_of(const std::vector<std::uint8_t>& bytes) const {
        return drawn_psnr(read_file(bytes, *options_).mesh, image_->pixels.view(), *parallel_for_);
    }
    const CompactReference<C>* image_;
    const CompactImageOptions* options_;
    CompactLattice lattice_;
    CompactRuns* runs_;
    const ParallelFor* parallel_for_;
    Image<std::uint8_t, C> pixels_;
    Mesh mesh_;
};

/// compact_image() of a valid view, whose colours are premultiplied already where they are to be.
template <class T, int C>
[[nodiscard]] CompactImage find_compact_image(const ImageView<T, C>& view, const CompactImageOptions& options,
                                              const Annealed& recipe, const ParallelFor& parallel_for) {
    CompactImage out;
    Annealed quick = recipe;
    quick.effort = std::min(recipe.effort, Effort::normal);
    const std::int64_t pixels = std::int64_t{view.width} * view.height;
    const std::int64_t expected =
        std::max<std::int64_t>(4, std::min(pixels, static_cast<std::int64_t>(options.bytes) * 2 / 5));  // 20 bits a vertex
    const double distance = std::sqrt(static_cast<double>(pixels) / static_cast<double>(expected));     // between these
    // 80 px a vertex are enough to judge by.
    const std::int64_t enough = std::max<std::int64_t>(524288, 80 * expected);
    int shrink = 1;
    while (pixels / (std::int64_t{shrink + 1} * (shrink + 1)) >= enough) ++shrink;
    const CompactReference<C> image{
        shrunk(view, (view.width + shrink - 1) / shrink, (view.height + shrink - 1) / shrink, shrink, shrink, parallel_for),
        view.width, view.height, shrink};
    struct Found {
        CompactLattice lattice;
        std::int64_t n;
        std::uint32_t color_step;
    };
    CompactRuns runs(options.progress);
    Found best{find_lattice(view.width, view.height, 0.2 * distance, options.bare), 0, 0}, last{};
    if (!CompactSearch<C>(image, options, best.lattice, runs, parallel_for).begin(quick, out)) return out;
    // An image of one colour needs no more.
    for (const double share : {0.2, 0.15, 0.115, 0.085, 0.065}) {
        if (out.psnr >= Target::invisible) break;
        Found next{find_lattice(view.width, view.height, share * distance, options.bare), expected, 0};
        if (next.lattice == last.lattice) continue;
        last = next;
        CompactSearch<C> search(image, options, next.lattice, runs, parallel_for);
        const double before = out.psnr;
        const bool is_good =
            search.guess(next.n, next.color_step, quick, out.status) && search.fill(next.n, next.color_step, recipe, out);
        if (!is_good && !out.status) return out.bytes.clear(), out;
        if (out.psnr > before) best = next;
    }
    // So few vertices are a matter of luck.
    Annealed again = recipe;
    CompactSearch<C> search(image, options, best.lattice, runs, parallel_for);
    for (int k = 0; k < 3 && best.n > 4; ++k) {
        ++again.seed;
        if (!search.fill(best.n, best.color_step, again, out)) return out.bytes.clear(), out;
    }
    out.mesh = read_file(out.bytes, options).mesh;
    if (runs.are_heard()) (void)options.progress({"compact image", 1, out.mesh.vertex_count(), 0, 1, {}});
    out.psnr = drawn_psnr(out.mesh, view, parallel_for);
    return out;
}

}  // namespace detail

/// An image as a compact file of at most options.bytes bytes: vertices, lattice and steps of colours are chosen together, for the
/// least error found, as the image is drawn from the file. Of the bytes all but 2 % are used, unless fewer give a PSNR of 55 dB
/// or all pixels are vertices. Same bytes for any executor. Takes some 40 runs of mesh_image() on an image shrunk to some 65,536
/// pixels, on larger ones where a vertex would have fewer than some dozens of them: 0.5 s for 300 bytes with Effort::normal, 2 s
/// with Effort::fine, which is 0.2 dB better.
///
/// \param view          the image, of 1 to 4 channels; those of more than 8 bits keep 8
/// \param options       how many bytes, and which profile
/// \param recipe        how much work goes into the last meshes, and all else about them
/// \param parallel_for  executor
/// \return              the file and its mesh; or no bytes and the status of mesh_image(), cancelled among them, or
///                      target_out_of_range with the number of bytes that 4 vertices take
template <class T, int C>
[[nodiscard]] CompactImage compact_image(const ImageView<T, C>& view, const CompactImageOptions& options = {},
                                         const Annealed& recipe = {}, const ParallelFor& parallel_for = {}) {
    static_assert(C <= 4, "a compact file holds 1 to 4 channels");
    CompactImage out;
    out.status = check(view);
    if (out.status) out.status = kit::check_finite(view, parallel_for);
    if (!out.status) return out;
    if constexpr (C % 2 == 0) {
        if (options.premultiplied) {
            const Image<T, C> copy = kit::premultiply(view, parallel_for);
            return detail::find_compact_image(copy.view(), options, recipe, parallel_for);
        }
    }
    return detail::find_compact_image(view, options, recipe, parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RATE_COMPACT_IMAGE_HPP
