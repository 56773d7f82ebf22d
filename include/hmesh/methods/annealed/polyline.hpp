/// \file
/// Polylines with the fewest nodes that pass all samples of a row within a tolerance.
///
/// Which samples may follow each other: those whose chord passes all between them within the tolerance. From each sample on,
/// the slopes that do are a range that shrinks with each sample passed (J. O'Rourke, "An on-line algorithm for fitting straight
/// lines between data ranges", 1981); the fewest chords are the shortest way, found from the first sample on as far as one chord
/// reaches, then two, and so on. Cost, for each sample and channel: some ns for one in 32 of those that its chords pass, 1,024
/// at most, and for each of them that no fewer chords reach.
#ifndef HMESH_METHODS_ANNEALED_POLYLINE_HPP
#define HMESH_METHODS_ANNEALED_POLYLINE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The longest chord between vertices of a side, in samples.
inline constexpr std::size_t longest_chord = 1024;

/// Finds polylines through a row of samples, with numbers of one or more channels each.
class PolylineFinder {
  public:
    /// Of the numbers of one sample after the other; there are 2 samples or more. Keeps them.
    HMESH_COLD PolylineFinder(Array<double> samples, std::size_t channels)
        : samples_(std::move(samples)), channels_(channels), low_(channels), high_(channels) {
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const std::size_t b = k / channels / block, c = k % channels;
            if (k / channels % block == 0) {
                least_.push_back(samples_[k]);
                most_.push_back(samples_[k]);
            }
            least_[channels * b + c] = std::min(least_[channels * b + c], samples_[k]);
            most_[channels * b + c] = std::max(most_[channels * b + c], samples_[k]);
        }
    }

    /// The fewest samples, the first and the last among them, whose polyline passes all others within a tolerance >= 0 in each
    /// channel; chords are of longest_chord samples at most. In rising order. NaN and infinities are passed, or nodes.
    [[nodiscard]] HMESH_PATCHWISE Array<std::uint32_t> nodes(double tolerance) {
        constexpr std::uint32_t unknown = std::numeric_limits<std::uint32_t>::max();
        const std::size_t count = samples_.size() / channels_;
        tolerance_ = tolerance;
        Array<std::uint32_t> chords(count, unknown), before(count, 0);  // on the shortest way to each sample
        chords.front() = 0;
        // Those that one chord reaches, then two, and so on: each time from where those are that one less reaches.
        std::size_t first = 0, last = 0;
        for (std::uint32_t reached = 0; chords.back() == unknown; ++reached) {
            const std::size_t begin = std::exchange(first, count), end = std::exchange(last, 0);
            std::size_t next = 0;  // all between a sample and this one are reached
            for (std::size_t i = begin; i <= end && chords.back() == unknown; ++i) {
                if (chords[i] != reached) continue;
                next = std::max(next, i + 1);
                while (chords[next] != unknown) ++next;
                low_.assign(channels_, std::numeric_limits<double>::lowest());
                high_.assign(channels_, std::numeric_limits<double>::max());
                std::size_t passed = i + 1;
                for (std::size_t k = next; k < std::min(count, i + longest_chord + 1); ++k) {
                    if (chords[k] != unknown) continue;
                    if (!pass_all(i, std::exchange(passed, k), k)) break;
                    if (k > i + 1 && !ends_at(i, k)) continue;  // the next one is reached, NaN or not
                    chords[k] = reached + 1;
                    before[k] = static_cast<std::uint32_t>(i);
                    first = std::min(first, k);
                    last = std::max(last, k);
                }
            }
        }
        Array<std::uint32_t> nodes{static_cast<std::uint32_t>(count - 1)};
        while (nodes.back() != 0) nodes.push_back(before[nodes.back()]);
        std::reverse(nodes.begin(), nodes.end());
        return nodes;
    }

  private:
    static constexpr std::size_t block = 32, few = 8;

    // Narrows the slopes of chords from sample i to those that pass sample k too, in channel c.
    void pass(std::size_t i, std::size_t k, std::size_t c) {
        const double rise = samples_[channels_ * k + c] - samples_[channels_ * i + c], length = static_cast<double>(k - i);
        low_[c] = std::max(low_[c], (rise - tolerance_) / length);
        high_[c] = std::min(high_[c], (rise + tolerance_) / length);
    }
    // The same for samples begin <= k < end and all channels. Whether there are any slopes.
    [[nodiscard]] HMESH_PATCHWISE bool pass_all(std::size_t i, std::size_t begin, std::size_t end) {
        // The furthest first: it leaves the fewest slopes, and blocks nearer by then change nothing.
        const bool is_long = end - begin > few;
        for (std::size_t c = 0; is_long && c < channels_; ++c) pass(i, end - 1, c);
        while (end > begin) {
            const std::size_t from = std::max(begin, (end - 1) / block * block);
            for (std::size_t c = 0; c < channels_; ++c) {
                if (end - from > few && changes_nothing(i, from, end, c)) continue;
                for (std::size_t k = from; k < end; ++k) pass(i, k, c);
                if (low_[c] > high_[c]) return false;
            }
            end = from;
        }
        return true;
    }
    // Whether all slopes of chords from sample i pass these samples of one block in this channel.
    [[nodiscard]] bool changes_nothing(std::size_t i, std::size_t from, std::size_t end, std::size_t c) const {
        const double start = samples_[channels_ * i + c];
        const double low = most_[channels_ * (from / block) + c] - start - tolerance_;
        const double high = least_[channels_ * (from / block) + c] - start + tolerance_;
        const auto nearest = static_cast<double>(from - i), furthest = static_cast<double>(end - 1 - i);
        return low / (low < 0 ? furthest : nearest) <= low_[c] && high / (high < 0 ? nearest : furthest) >= high_[c];
    }
    [[nodiscard]] bool ends_at(std::size_t i, std::size_t k) const {
        const auto length = static_cast<double>(k - i);
        for (std::size_t c = 0; c < channels_; ++c) {
            const double rise = samples_[channels_ * k + c] - samples_[channels_ * i + c];
            if (!(rise >= low_[c] * length && rise <= high_[c] * length)) return false;
        }
        return true;
    }

    Array<double> samples_;
    std::size_t channels_;
    double tolerance_ = 0;
    Array<double> low_, high_;    // slopes of chords from a sample on, of each channel
    Array<double> least_, most_;  // of each block of samples, of each channel
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_POLYLINE_HPP
