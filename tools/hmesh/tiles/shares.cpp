#include "tiles/shares.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tool {
namespace {

// The error of a tile as a power of its vertices.
class Curve {
  public:
    explicit Curve(const Look& look) : first_(look.trials.front()) {
        if (look.trials.size() < 2 || !(look.trials[1].energy > first_.energy) || !(first_.energy > 0)) return;
        const TrialMesh& coarser = look.trials[1];
        const double ratio = static_cast<double>(first_.vertices) / static_cast<double>(coarser.vertices);
        power_ = std::clamp(std::log(coarser.energy / first_.energy) / std::log(ratio), 0.25, 3.0);
    }
    [[nodiscard]] double energy(double vertices) const {
        return first_.energy * std::pow(static_cast<double>(first_.vertices) / vertices, power_);
    }
    // The vertices at which one more gains this much.
    [[nodiscard]] double vertices_at(double price) const {
        const auto n = static_cast<double>(first_.vertices);
        return n * std::pow(power_ * first_.energy / (n * price), 1 / (power_ + 1));
    }

  private:
    TrialMesh first_;
    double power_ = 1;
};

// Numbers between bounds that are as prices want them, and whose sum is `sum`.
std::vector<std::size_t> share_out(const std::vector<Curve>& curves, const std::vector<std::size_t>& least,
                                   const std::vector<std::size_t>& most, std::size_t sum) {
    std::vector<double> wanted(curves.size());
    const auto set = [&](double price) {
        double total = 0;
        for (std::size_t k = 0; k < curves.size(); ++k) {
            wanted[k] = std::clamp(curves[k].vertices_at(price), static_cast<double>(least[k]), static_cast<double>(most[k]));
            total += wanted[k];
        }
        return total;
    };
    double low = -700, high = 700;  // logarithms of prices
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (set(std::exp(middle)) > static_cast<double>(sum) ? low : high) = middle;
    }
    set(std::exp(high));
    // Whole numbers: each at most as wanted, and what is then missing to those that lost most, as far as there is room.
    std::vector<std::size_t> out(curves.size()), order(curves.size());
    std::size_t given = 0;
    for (std::size_t k = 0; k < out.size(); ++k) given += out[k] = static_cast<std::size_t>(wanted[k]);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto rest = [&](std::size_t k) { return wanted[k] - static_cast<double>(out[k]); };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rest(a) > rest(b); });
    while (given < sum) {
        const std::size_t before = given;
        const std::size_t each = std::max<std::size_t>(1, (sum - given) / out.size());
        for (const std::size_t k : order) {
            const std::size_t more = std::min({each, most[k] - out[k], sum - given});
            out[k] += more;
            given += more;
        }
        if (given == before) break;  // each has all that it can have
    }
    return out;
}

}  // namespace

std::vector<double> side_tolerances(double peak) {
    std::vector<double> tolerances;
    for (int k = 2; k < 20; ++k) tolerances.push_back(peak * std::exp2(-0.5 * k));
    return tolerances;
}

std::string find_shares(const std::vector<Look>& looks, int across, int channels, std::size_t vertices,
                        const std::vector<double>& tolerances, Shares& shares) {
    std::vector<Curve> curves;
    std::vector<std::size_t> least(looks.size()), most;
    double samples = 0;
    for (const Look& look : looks) {
        curves.emplace_back(look);
        most.push_back(std::max<std::size_t>(4, look.pixels));
        samples += static_cast<double>(look.pixels) * channels;
    }
    // By one of the tolerances: what each tile needs, so that there is something between its sides, and the sum of it; and how
    // often vertices of seams are counted again.
    std::size_t sum = 0, again = 0;
    const auto look_at_sides = [&](std::size_t t) {
        sum = again = 0;
        for (std::size_t k = 0; k < looks.size(); ++k) {
            const auto [north, south, west, east] = looks[k].sides[t];
            least[k] = std::min(most[k], 2 * (north + south + west + east - 4));
            sum += least[k];
            const bool has_north = k >= static_cast<std::size_t>(across), has_west = k % static_cast<std::size_t>(across) > 0;
            again += (has_north ? north : 0) + (has_west ? west : 0);
            if (has_north && has_west) --again;  // four tiles have the corner, and two of their seams end there twice
        }
    };
    look_at_sides(0);
    const std::vector<std::size_t> first = share_out(curves, least, most, vertices);
    double energy = 0;
    for (std::size_t k = 0; k < first.size(); ++k) energy += curves[k].energy(static_cast<double>(first[k]));
    std::size_t t = 0;
    while (t + 1 < tolerances.size() && tolerances[t] > 2 * std::sqrt(energy / samples)) ++t;
    for (look_at_sides(t); t > 0 && 2 * (sum - again) > vertices; look_at_sides(t)) --t;
    if (sum > vertices + again)
        return "the sides of " + std::to_string(looks.size()) + " tiles need " + std::to_string(sum - again) +
               " vertices, more than " + std::to_string(vertices) + ": take larger tiles by --tile, or more vertices";
    shares.tolerance = tolerances[t];
    shares.vertices = share_out(curves, least, most, vertices + again);
    return {};
}

}  // namespace tool
