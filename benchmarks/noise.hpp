// benchmarks - textures made by code: smooth noise that repeats, and what samples of a pixel make of it.
#ifndef HMESH_BENCHMARKS_NOISE_HPP
#define HMESH_BENCHMARKS_NOISE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <hmesh/core/random.hpp>

namespace bench {

inline double clamp01(double x) { return std::max(0.0, std::min(1.0, x)); }

// Smooth noise that repeats after `size` px, in [0, 1), of so many cells along each axis.
class Noise {
  public:
    Noise(int size, int columns, int rows, std::uint64_t seed) : size_(size), columns_(columns), rows_(rows) {
        hmesh::kit::Random random(seed);
        for (int i = 0; i < columns * rows; ++i) values_.push_back(random.uniform());
    }
    [[nodiscard]] double operator()(double x, double y) const {
        const double u = x * columns_ / size_, v = y * rows_ / size_;
        const double left = std::floor(u), top = std::floor(v);
        const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
        const double a = smooth(u - left), b = smooth(v - top);
        const auto at = [&](int i, int j) {
            const int column = (static_cast<int>(left) + i + 8 * columns_) % columns_;
            const int row = (static_cast<int>(top) + j + 8 * rows_) % rows_;
            return values_[static_cast<std::size_t>(row * columns_ + column)];
        };
        return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
    }

  private:
    int size_, columns_, rows_;
    std::vector<double> values_;
};

}  // namespace bench

#endif  // HMESH_BENCHMARKS_NOISE_HPP
