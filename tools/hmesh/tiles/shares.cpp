#include "tiles/shares.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tool {
namespace {

// The error of a tile over its vertices: a power of them between two meshes that were tried, which goes on beyond the first and
// the last.
class Curve {
  public:
    explicit Curve(const Look& look) {
        for (const TrialMesh& trial : look.trials) {
            const auto n = static_cast<double>(trial.vertices);
            if (!parts_.empty() && (!(n < parts_.back().vertices) || !(trial.energy > parts_.back().energy))) continue;
            if (!parts_.empty() && parts_.back().energy > 0)
                parts_.back().power =
                    std::clamp(std::log(trial.energy / parts_.back().energy) / std::log(parts_.back().vertices / n), 0.1, 3.0);
            parts_.push_back({n, trial.energy, 1});
        }
        if (parts_.size() > 1) parts_.pop_back();  // from the finer end of each
    }
    [[nodiscard]] double energy(double vertices) const {
        std::size_t k = 0;
        while (k + 1 < parts_.size() && vertices < parts_[k + 1].vertices) ++k;
        return parts_[k].energy * std::pow(parts_[k].vertices / vertices, parts_[k].power);
    }
    // The vertices at which one more gains this much: the lower the price the more.
    [[nodiscard]] double vertices_at(double price) const {
        for (std::size_t k = parts_.size(); k-- > 0;) {
            const auto& [n, energy, power] = parts_[k];
            const double wanted = n * std::pow(power * energy / (n * price), 1 / (power + 1));
            const double least = k + 1 < parts_.size() ? parts_[k + 1].vertices : 0;
            if (k == 0 || wanted <= n) return std::max(least, wanted);
        }
        return 0;
    }

  private:
    struct Part {
        double vertices, energy;  // at its finer end
        double power;
    };
    std::vector<Part> parts_;  // the finest first
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

std::vector<double> side_tolerances(double peak, bool is_open) {
    std::vector<double> tolerances;
    const double least = is_open ? std::exp2(-64) : 0.2;
    // Products and powers of two, which all machines round alike.
    for (int k = is_open ? -64 : 2; peak * std::exp2(-k) > least; ++k)
        for (const double step : {1.0, 0.7}) tolerances.push_back(step * (peak * std::exp2(-k)));
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
    for (std::size_t k = 0; k < first.size(); ++k) energy += looks[k].lost + curves[k].energy(static_cast<double>(first[k]));
    std::size_t t = 0;
    while (t + 1 < tolerances.size() && tolerances[t] > std::sqrt(energy / samples)) ++t;
    for (look_at_sides(t); t > 0 && 2 * (sum - again) > vertices; look_at_sides(t)) --t;
    if (sum > vertices + again)
        return "the sides of " + (looks.size() == 1 ? "the only tile" : std::to_string(looks.size()) + " tiles") + " need " +
               std::to_string(sum - again) + " vertices with those between them, more than " + std::to_string(vertices);
    shares.tolerance = tolerances[t];
    shares.vertices = share_out(curves, least, most, vertices + again);
    return {};
}

}  // namespace tool
