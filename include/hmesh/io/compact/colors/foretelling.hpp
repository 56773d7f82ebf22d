/// \file
/// DistanceForetelling and AreaForetelling: what the next colour of a triangulation is foretold as, from those coded before it.
///
/// Both are means of neighbours. Of an annealed mesh the near ones are no better guides than those far away: triangles are long
/// along the edges of an image, and two ends of a short side lie on both sides of one. By the area that two vertices share, the
/// differences of a photograph's colours take a tenth fewer bits than by the reciprocal of their distance; which of them a file
/// has goes with its start table (CompactTable).
///
/// Cost: O(n); by area some 40 ns a number more than by distance.
#ifndef HMESH_IO_COMPACT_COLORS_FORETELLING_HPP
#define HMESH_IO_COMPACT_COLORS_FORETELLING_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/sites.hpp"
#include "hmesh/io/compact/triangulation.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// What a number is foretold as, and by how much it may be missed.
struct Foretold {
    std::int64_t guess = 0,  ///< the number
        weights = 0,         ///< sum of the neighbours' weights; 0: there is none, the guess says nothing
        spread = 0,          ///< sum of weight times what a neighbour is off the guess
        missed = 0;          ///< sum of weight times by what a neighbour was missed itself
};

/// What colours are made of: numbers from 0 to `most` a channel.
struct ColorNumbers {
    std::size_t channels;     ///< 1 to 4
    std::int64_t most;        ///< of exact colours; of coarse ones 255
    bool is_coarse;           ///< whether numbers are coarse planes, in 16ths of a 255th
    bool is_luma;             ///< whether the first is a luma, and the next two differences
    std::int64_t frame_area;  ///< twice that of the frame, in squared units of points
};

/// How far away a point is: within 7 % of Euclid's distance.
[[nodiscard]] inline std::int64_t distance_of(GridPoint p, GridPoint q) noexcept {
    const std::int64_t dx = std::int64_t{p.x} - q.x, dy = std::int64_t{p.y} - q.y;
    const std::int64_t x = dx < 0 ? -dx : dx, y = dy < 0 ? -dy : dy;
    return std::max(x, y) + 3 * std::min(x, y) / 8;
}

/// The neighbours of a vertex that were coded before it.
class CodedNeighbors {
  public:
    static constexpr std::int64_t farthest = std::int64_t{1} << 26;  ///< as far as none is
    /// One more, so far away.
    void add(std::int64_t distance) noexcept {
        nearest_ = std::min(nearest_, distance);
        ++count_;
    }
    [[nodiscard]] std::int64_t nearest() const noexcept { return nearest_; }  ///< how far the nearest is
    /// Binary digits of that, at most 19.
    [[nodiscard]] std::size_t digits() const noexcept {
        return static_cast<std::size_t>(std::min(digits_of(static_cast<std::uint64_t>(nearest_)), 19));
    }
    [[nodiscard]] std::size_t count() const noexcept { return std::min<std::size_t>(count_, 7); }  ///< how many, at most 7

  private:
    std::int64_t nearest_ = farthest;
    std::size_t count_ = 0;
};

/// Foretells by the mean of the neighbours coded before, each as the distance's reciprocal.
class DistanceForetelling {
  public:
    /// Of a triangulation of n points.
    DistanceForetelling(std::size_t n, const ColorNumbers& numbers)
        : channels_(numbers.channels), one_(numbers.most < 131072 ? 4096 : 64), planes_(n * channels_, 0),
          missed_(n * channels_, 0) {}

    /// Looks around a vertex, the next to be coded; `last` is the one before it, or not below v.
    void look(const Triangulation& mesh, const std::vector<bool>& used, std::size_t v, std::size_t last) {
        using Index = Triangulation::Index;
        neighbors_.clear();
        coded_ = {};
        at_ = v;
        const auto at = static_cast<Index>(v);
        const GridPoint p = mesh.point(at);
        Index e = mesh.first(at);
        for (Index k = 0; k < mesh.degree(at); ++k, e = mesh.next(e)) {
            const std::size_t u = mesh.to(e);
            if (u >= v || !used[u]) continue;
            const std::int64_t distance = distance_of(p, mesh.point(static_cast<Index>(u)));
            coded_.add(distance);
            neighbors_.push_back({u, distance});
        }
        // Of up to 2^24 neighbours sums stay below 2^62.
        for (Neighbor& neighbor : neighbors_)
            neighbor.weight = std::max<std::int64_t>(1, coded_.nearest() * one_ / neighbor.weight);
        if (neighbors_.empty() && last < v) {
            coded_.add(CodedNeighbors::farthest);
            neighbors_.push_back({last, 1});
        }
    }
    /// The neighbours of the vertex looked at that were coded before it.
    [[nodiscard]] const CodedNeighbors& coded() const noexcept { return coded_; }
    /// Twice the area of the faces around the vertex looked at.
    [[nodiscard]] std::int64_t area(const Triangulation& mesh) const noexcept {
        return area_around(mesh, static_cast<Triangulation::Index>(at_));
    }

    /// Foretells the number of a channel, in [0, most]; `first` where nothing is known.
    [[nodiscard]] Foretold foretell(std::size_t channel, std::int64_t first, std::int64_t /*most*/) const noexcept {
        Foretold out;
        std::int64_t sum = 0;
        for (const Neighbor& neighbor : neighbors_) {
            const std::size_t i = neighbor.vertex * channels_ + channel;
            sum += neighbor.weight * std::int64_t{planes_[i]};
            out.missed += neighbor.weight * std::int64_t{missed_[i]};
            out.weights += neighbor.weight;
        }
        out.guess = out.weights == 0 ? first : (sum + out.weights / 2) / out.weights;
        for (const Neighbor& neighbor : neighbors_) {
            const std::int64_t off = std::int64_t{planes_[neighbor.vertex * channels_ + channel]} - out.guess;
            out.spread += neighbor.weight * (off < 0 ? -off : off);
        }
        return out;
    }
    /// Notes what a channel's number is, and by how much it was missed.
    void note(std::size_t channel, std::int64_t number, std::int64_t missed) noexcept {
        planes_[at_ * channels_ + channel] = static_cast<std::uint32_t>(number);
        missed_[at_ * channels_ + channel] = static_cast<std::uint32_t>(missed);
    }
    /// All channels of the vertex are coded.
    void close() noexcept {}

  private:
    struct Neighbor {
        std::size_t vertex;
        std::int64_t weight;
    };

    std::size_t channels_;
    std::int64_t one_;
    std::vector<std::uint32_t> planes_, missed_;
    std::vector<Neighbor> neighbors_;
    CodedNeighbors coded_;
    std::size_t at_ = 0;
};

/// Foretells by the mean of all neighbours, each as the area of the triangles that it shares with the vertex; those not coded yet
/// are taken for the mean of their own neighbours that are. Differences of colour go by neighbours of like luma, and by what the
/// channels before were off, as far as that has told of them so far.
class AreaForetelling {
  public:
    /// Of a triangulation of n points.
    AreaForetelling(std::size_t n, const ColorNumbers& numbers)
        : channels_(numbers.channels), has_luma_(numbers.is_luma), unit_(numbers.frame_area / most_area + 1), known_of_(n),
          likeness_(std::max<std::int64_t>(1, (numbers.is_coarse ? 4080 : numbers.most) / 64)) {
        const std::int64_t usual = (numbers.is_coarse ? 4080 : numbers.most) / 13;  // off by so much, a luma tells something
        for (auto& of : slopes_) of.fill({0, std::max<std::int64_t>(1, usual * usual)});
    }

    /// As of DistanceForetelling.
    void look(const Triangulation& mesh, const std::vector<bool>& used, std::size_t v, std::size_t last) {
        using Index = Triangulation::Index;
        neighbors_.clear();
        later_.clear();
        coded_ = {};
        at_ = v;
        area_ = 0;
        const auto at = static_cast<Index>(v);
        Index e = mesh.first(at);
        std::int64_t before = area_beside(mesh, mesh.previous(e));
        for (Index k = 0; k < mesh.degree(at); ++k, e = mesh.next(e)) {
            const std::int64_t area = area_beside(mesh, e), shared = (before + area) / unit_ + 1;
            area_ += area;
            before = area;
            const std::size_t u = mesh.to(e);
            if (!used[u]) continue;
            if (u < v) {
                coded_.add(distance_of(mesh.point(at), mesh.point(static_cast<Index>(u))));
                add_neighbor(shared, known_of_[u], 1);
            } else {
                later_.push_back({u, shared});
                if (known_of_[u].weights > 0) add_neighbor(shared, known_of_[u], known_of_[u].weights);
            }
        }
        if (neighbors_.empty() && last < v) add_neighbor(1, known_of_[last], 1);
    }
    /// As of DistanceForetelling.
    [[nodiscard]] const CodedNeighbors& coded() const noexcept { return coded_; }
    /// As of DistanceForetelling.
    [[nodiscard]] std::int64_t area(const Triangulation& /*mesh*/) const noexcept { return area_; }

    /// As of DistanceForetelling.
    [[nodiscard]] Foretold foretell(std::size_t channel, std::int64_t first, std::int64_t most) noexcept {
        Foretold out;
        const bool is_difference = has_luma_ && (channel == 1 || channel == 2);
        if (channel == 1 && has_luma_) weigh_by_luma();
        for (const Neighbor& neighbor : neighbors_) {
            out.missed += neighbor.weight * neighbor.missed[channel];
            out.weights += neighbor.weight;
        }
        if (out.weights == 0) return out.guess = mean_ = first, out;
        if (channel == 1 && has_luma_) off_[0] = now_[0] - mean(0, out.weights);
        mean_ = out.guess = mean(channel, out.weights);
        if (is_difference)
            for (std::size_t k = 0; k < channel; ++k) {
                const Slope slope = slopes_[channel - 1][k];
                told_[k] = slope.both * off_[k] / slope.square;
                out.guess += told_[k];
            }
        out.guess = std::max<std::int64_t>(0, std::min(out.guess, most));
        for (const Neighbor& neighbor : neighbors_) {
            const std::int64_t off = neighbor.planes[channel] - out.guess;
            out.spread += neighbor.weight * (off < 0 ? -off : off);
        }
        return out;
    }
    /// As of DistanceForetelling.
    void note(std::size_t channel, std::int64_t number, std::int64_t missed) noexcept {
        now_[channel] = number;
        missed_[channel] = missed;
        if (!has_luma_ || channel == 0 || channel > 2 || neighbors_.empty()) return;
        std::int64_t off = off_[channel] = number - mean_;
        for (std::size_t k = 0; k < channel; ++k) {
            Slope& slope = slopes_[channel - 1][k];
            slope.both += off_[k] * off - slope.both / 512;
            slope.square += off_[k] * off_[k] - slope.square / 512;
            off -= told_[k];
        }
    }
    /// All channels of the vertex are coded: its neighbours that come later know of it.
    void close() noexcept {
        known_of_[at_] = {now_, missed_, 0};
        for (const Later& later : later_) {
            Known& known = known_of_[later.vertex];
            for (std::size_t k = 0; k < channels_; ++k) {
                known.planes[k] += later.shared * now_[k];
                known.missed[k] += later.shared * missed_[k];
            }
            known.weights += later.shared;
        }
    }

  private:
    // Twice the area of the frame, in units of what is shared: of the largest numbers, 2^32, sums stay below 2^63.
    static constexpr std::int64_t most_area = std::int64_t{1} << 29;

    using Numbers = std::array<std::int64_t, 4>;
    // What is known of a vertex: of a coded one its numbers, of others the weighted sums over their coded neighbours.
    struct Known {
        Numbers planes{}, missed{};
        std::int64_t weights = 0;
    };
    struct Neighbor {
        std::int64_t shared, weight;
        Numbers planes, missed;
    };
    struct Later {
        std::size_t vertex;
        std::int64_t shared;
    };
    // Of what two numbers were off: the sum of their products, and of the first one's squares.
    struct Slope {
        std::int64_t both, square;
    };

    void add_neighbor(std::int64_t shared, const Known& known, std::int64_t weights) {
        Neighbor neighbor{shared, shared, known.planes, known.missed};
        if (weights > 1)
            for (std::size_t k = 0; k < channels_; ++k) neighbor.planes[k] /= weights, neighbor.missed[k] /= weights;
        neighbors_.push_back(neighbor);
    }
    void weigh_by_luma() noexcept {
        for (Neighbor& neighbor : neighbors_) {
            const std::int64_t off = neighbor.planes[0] - now_[0];
            neighbor.weight = std::max<std::int64_t>(1, 16 * neighbor.shared * likeness_ / (likeness_ + (off < 0 ? -off : off)));
        }
    }
    [[nodiscard]] std::int64_t mean(std::size_t channel, std::int64_t weights) const noexcept {
        std::int64_t sum = 0;
        for (const Neighbor& neighbor : neighbors_) sum += neighbor.weight * neighbor.planes[channel];
        return (sum + weights / 2) / weights;
    }

    std::size_t channels_;
    bool has_luma_;
    std::int64_t unit_;
    std::vector<Known> known_of_;
    std::int64_t likeness_;                         // lumas that differ by so much count half
    std::array<std::array<Slope, 2>, 2> slopes_{};  // of the second and third channel by those before
    std::vector<Neighbor> neighbors_;
    std::vector<Later> later_;
    Numbers now_{}, missed_{};
    Numbers off_{};                       // of a luma and differences, what the number is off the mean by like luma
    std::array<std::int64_t, 2> told_{};  // of a difference, what the channels before tell of it
    CodedNeighbors coded_;
    std::int64_t mean_ = 0, area_ = 0;
    std::size_t at_ = 0;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_COLORS_FORETELLING_HPP
