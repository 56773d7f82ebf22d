/// \file
/// Offers: what can be done at corners, the cheapest first, while prices change. O(log n) for each.
#ifndef HMESH_OUTLINE_OFFERS_HPP
#define HMESH_OUTLINE_OFFERS_HPP

#include <cstdint>
#include <limits>
#include <optional>
#include <queue>
#include <vector>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit::detail {

/// Offers by their prices. Of a corner, the last one counts, and no more once it is taken back or taken out.
class Offers {
  public:
    /// That of one corner.
    struct Offer {
        double price;          ///< the least comes first, and of equal ones the least corner
        std::uint32_t corner,  ///< its number
            stamp;             ///< which one of that corner's it is
        /// The best one is the last.
        bool operator<(const Offer& other) const noexcept {
            return price != other.price ? price > other.price : corner > other.corner;
        }
    };

    /// For corners with numbers below this.
    explicit Offers(std::uint32_t numbers) : stamp_(numbers, 0) {}

    /// Offers what can be done at a corner, in place of what was before.
    void add(std::uint32_t corner, double price) { waiting_.push({price, corner, ++stamp_[corner]}); }
    /// Takes back what was offered there.
    void take_back(std::uint32_t corner) { ++stamp_[corner]; }
    /// Takes out the cheapest one, if there is any.
    std::optional<Offer> take_out() {
        while (!waiting_.empty()) {
            const Offer best = waiting_.top();
            waiting_.pop();
            if (best.stamp == stamp_[best.corner]) return best;
        }
        return {};
    }
    /// None that waits is cheaper than this, the largest double where none waits; it may be the price of one that counts no more.
    [[nodiscard]] double least_price() const {
        return waiting_.empty() ? std::numeric_limits<double>::max() : waiting_.top().price;
    }

  private:
    std::priority_queue<Offer> waiting_;
    std::vector<std::uint32_t> stamp_;  // of a corner's last offer
};

}  // namespace hmesh::kit::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_OFFERS_HPP
