// hmesh - the definition of compact_image(). Included by compact_image.hpp only; empty where a program compiles it in another file.
#ifndef HMESH_RATE_COMPACT_IMAGE_IPP
#define HMESH_RATE_COMPACT_IMAGE_IPP
#if !defined(HMESH_COMPILED) || defined(HMESH_IMPLEMENTATION)

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/options.hpp"
#include "hmesh/rate/compact_lattice.hpp"
#include "hmesh/rate/compact_search.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// What a lattice promises, with the vertices and the step of colours that its bytes pay for.
struct CompactGuess {
    double promise;
    CompactLattice lattice;
    std::int64_t n;
    std::uint32_t color_step;
};

/// How many pixels are as those to their right, as a share of all: of photographs up to 0.2, of drawings 0.9.
template <int C>
[[nodiscard]] double flat_share(const ImageView<std::uint8_t, C>& view) {
    std::int64_t flat = 0;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x + 1 < view.width; ++x) {
            const std::uint8_t* const pixel = view.pixel(x, y);
            flat += std::equal(pixel, pixel + C, view.pixel(x + 1, y)) ? 1 : 0;
        }
    return static_cast<double>(flat) / (static_cast<double>(view.width) * view.height);
}

/// The search of compact_image() over lattices.
template <int C>
class CompactChoice {
  public:
    /// For a file of an image, with about so many vertices; all outlive it.
    CompactChoice(const CompactReference<C>& image, std::int64_t expected, const CompactImageOptions& options,
                  const Annealed& recipe, const ParallelFor& parallel_for)
        : image_(&image), expected_(expected), options_(&options), recipe_(&recipe), parallel_for_(&parallel_for),
          runs_(options.progress), tries_(expected < 600 ? 4 : 1), lattices_(tries_ > 1 ? 2 : 1),
          is_compared_(lattices_ > 1 || flat_share<C>(image.view) > 0.4),
          is_rough_(!is_compared_ && recipe.effort <= Effort::normal) {}

    /// The best file found, with its PSNR but without its mesh; or its status, and no bytes.
    [[nodiscard]] CompactImage run() {
        Annealed quick = *recipe_;
        quick.effort = std::min(recipe_->effort, is_rough_ ? Effort::draft : Effort::fast);
        if (!search(lattice(0.2)).begin(quick, best_)) return std::move(best_);
        if (best_.psnr < Target::invisible) {  // an image of one colour needs no more
            look_at_lattices(quick);
            if (!best_.status || !fill_lattices() || !try_seeds()) best_.bytes.clear();
        }
        return std::move(best_);
    }

  private:
    /// A lattice whose sites are this share of the vertices' distance from each other.
    [[nodiscard]] CompactLattice lattice(double share) const {
        const double pixels = static_cast<double>(image_->width) * image_->height;
        return find_lattice(image_->width, image_->height, image_->view.width, image_->view.height,
                            share * std::sqrt(pixels / static_cast<double>(expected_)), options_->bare);
    }
    /// The search on a lattice: that of the last time, where it was on the same.
    [[nodiscard]] CompactSearch<C>& search(const CompactLattice& lattice) {
        if (!search_ || !search_->is_on(lattice)) search_.emplace(*image_, *options_, lattice, runs_, *parallel_for_);
        return *search_;
    }
    /// What a lattice promises by quick meshes, which found_ has then; 0 if it is that of the last time.
    double look(double share, const Annealed& quick) {
        CompactGuess next{0, lattice(share), 0, 0};
        if (!found_.empty() && next.lattice == found_.back().lattice) return 0;
        const std::int64_t likely = found_.empty() ? expected_ : found_.back().n;
        // Of some numbers of vertices, few, there is no mesh on a lattice.
        for (int percent = 100; percent > 90 && next.color_step == 0 && best_.status; percent -= 3) {
            next.n = std::max<std::int64_t>(4, likely * percent / 100);
            next.promise = search(next.lattice).guess(next.n, next.color_step, quick, is_rough_ ? 0 : 3, best_.status);
        }
        if (next.color_step > 0) found_.push_back(next);
        return next.promise;
    }
    /// Looks at the lattice that is best for photographs, and at finer ones for as long as they promise more. Drawings promise
    /// decibels more on them, and chance alone up to 0.3.
    void look_at_lattices(const Annealed& quick) {
        double most = look(0.07, quick) + 0.3;
        if (!found_.empty()) found_.front().promise = most;
        for (const double share : {0.045, 0.03, 0.02}) {
            if (!is_compared_) break;
            const double promise = look(share, quick);
            if (!(promise > most)) break;
            most = promise;
            if (share == 0.045) most = std::max(most, look(0.06, quick));
        }
    }
    /// Fills the bytes on the lattices that promise most. Whether to go on.
    [[nodiscard]] bool fill_lattices() {
        const kit::Array<kit::Coded> order =
            kit::sorted_numbers(found_.size(), [&](std::uint32_t k) { return kit::code_of(-found_[k].promise); });
        const double begun = best_.psnr;
        double before = begun;
        std::size_t filled = 0;
        chosen_ = order.empty() ? 0 : order.front().number;
        for (const kit::Coded& item : order) {  // the best first
            if (filled == lattices_) break;
            CompactGuess& guess = found_[item.number];
            if (!search(guess.lattice).fill(guess.n, guess.color_step, *recipe_, best_)) return false;
            if (best_.psnr > before) before = best_.psnr, chosen_ = item.number;
            if (before > begun) ++filled;  // on a lattice without a mesh, none is
        }
        return true;
    }
    /// Fills them again on the best lattice, with other seeds. Whether to go on.
    [[nodiscard]] bool try_seeds() {
        Annealed again = *recipe_;
        for (std::size_t k = 1; k < tries_ && chosen_ < found_.size(); ++k) {
            ++again.seed;
            CompactGuess& guess = found_[chosen_];
            if (!search(guess.lattice).fill(guess.n, guess.color_step, again, best_)) return false;
        }
        return true;
    }

    const CompactReference<C>* image_;
    std::int64_t expected_;
    const CompactImageOptions* options_;
    const Annealed* recipe_;
    const ParallelFor* parallel_for_;
    CompactRuns runs_;
    std::size_t tries_, lattices_;  ///< meshes on the best lattice, lattices that are filled: few vertices are a matter of luck
    bool is_compared_;              ///< whether it may not be a photograph, so that lattices are compared
    /// Whether quick meshes tell numbers alone. Where lattices are compared, or time counts less than 0.03 dB, they must be worth
    /// their promise.
    bool is_rough_;
    std::optional<CompactSearch<C>> search_;
    std::vector<CompactGuess> found_;
    std::size_t chosen_ = 0;  ///< of found_, the best one filled
    CompactImage best_;
};

/// What compact_image() looks at of a view, of which about so many vertices are expected: 80 px a vertex are enough to judge by.
template <class T, int C>
[[nodiscard]] CompactReference<C> compact_reference(const ImageView<T, C>& view, std::int64_t expected,
                                                    const ParallelFor& parallel_for) {
    const std::int64_t pixels = std::int64_t{view.width} * view.height;
    const std::int64_t enough = std::max<std::int64_t>(524288, 80 * expected);
    int shrink = 1;
    while (pixels / (std::int64_t{shrink + 1} * (shrink + 1)) >= enough) ++shrink;
    CompactReference<C> out{{}, {}, {}, view.width, view.height};
    if constexpr (std::is_same_v<T, std::uint8_t>)
        if (shrink == 1) out.view = view;
    if (out.view.data == nullptr) {
        const auto shorter = [&](int side) { return (side + shrink - 1) / shrink; };
        out.pixels = shrunk(view, shorter(view.width), shorter(view.height), shrink, shrink, parallel_for);
        out.view = out.pixels.view();
    }
    out.table = kit::MomentTable<C>(out.view, out.view.bounds(), parallel_for);
    return out;
}

/// compact_image() of a valid view, whose colours are premultiplied already where they are to be.
template <class T, int C>
[[nodiscard]] CompactImage find_compact_image(const ImageView<T, C>& view, const CompactImageOptions& options,
                                              const Annealed& recipe, const ParallelFor& parallel_for) {
    const std::int64_t pixels = std::int64_t{view.width} * view.height;
    const auto bytes = static_cast<std::int64_t>(std::min<std::uint64_t>(options.bytes, std::uint64_t{1} << 40U));
    const std::int64_t expected = std::max<std::int64_t>(4, std::min(pixels, bytes * 2 / 5));  // 20 bits a vertex
    const CompactReference<C> image = compact_reference(view, expected, parallel_for);
    CompactImage out = CompactChoice<C>(image, expected, options, recipe, parallel_for).run();
    if (!out.status) return out;
    out.mesh = read_file(out.bytes, options).mesh;
    if (options.progress && !options.progress({"compact image", 1, out.mesh.vertex_count(), 0, 1, {}})) {
        out = {};
        out.status = kit::cancelled_by_callback();
        return out;
    }
    const bool is_view = image.pixels.size() == 0;  // that was drawn already
    if (!is_view) out.psnr = drawn_psnr(out.mesh, view, parallel_for);
    return out;
}

}  // namespace hmesh::detail

namespace hmesh {

template <class T, int C>
CompactImage compact_image(const ImageView<T, C>& view, const CompactImageOptions& options, const Annealed& recipe,
                           const ParallelFor& parallel_for) {
    static_assert(C <= 4, "a compact file holds 1 to 4 channels");
    CompactImage out;
    out.status = check(view);
    if (out.status) out.status = detail::check(detail::compact_options(options));
    if (out.status && options.premultiplied) out.status = kit::check_premultiplied(C);
    if (out.status && recipe.start != nullptr)
        out.status = {Errc::invalid_argument, "an image in so many bytes is meshed anew: there is no mesh to start from"};
    if (out.status) out.status = kit::check_finite(view, parallel_for);
    if (!out.status) return out;
    if constexpr (kit::has_alpha(C)) {
        if (options.premultiplied) {
            const Image<T, C> copy = kit::premultiply(view, parallel_for);
            return detail::find_compact_image(copy.view(), options, recipe, parallel_for);
        }
    }
    return detail::find_compact_image(view, options, recipe, parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_COMPILED
#endif  // HMESH_RATE_COMPACT_IMAGE_IPP
