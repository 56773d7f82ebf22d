// hmesh tests - sizes and samples of images drawn from the bytes of a fuzzer.
#ifndef HMESH_TESTS_FUZZ_FUZZ_IMAGES_HPP
#define HMESH_TESTS_FUZZ_FUZZ_IMAGES_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "fuzz_input.hpp"

namespace hmesh_test {

struct Size {
    int width = 1, height = 1;
};

// Mostly small, so that many are meshed in a second; some thin and some of several tiles.
inline Size draw_size(FuzzInput& input) {
    switch (input.byte() % 16) {
        case 12: return {input.within(1, 3), input.within(1, 600)};
        case 13: return {input.within(1, 600), input.within(1, 3)};
        case 14: return {input.within(1, 40), input.within(1, 40)};
        case 15: return {input.within(1, 130), input.within(1, 130)};
        default: return {input.within(1, 10), input.within(1, 10)};
    }
}

// The samples of a picture, which repeats what bytes are left.
template <class T>
class FuzzSamples {
  public:
    explicit FuzzSamples(FuzzInput& input) : kind_(input.byte() % 4), gain_(kind_ == 3 ? input.wild_real() : 1) {
        while (input.left() > 0) bytes_.push_back(input.byte());
        if (bytes_.empty()) bytes_.push_back(0);
    }
    [[nodiscard]] T operator()(std::size_t k) const {
        if constexpr (std::is_same_v<T, float>) {
            if (kind_ < 2) return static_cast<float>(byte(k)) / 255;
            if (kind_ == 3) {
                const double value = byte(k) * gain_;  // a float holds it, or it is none
                return std::abs(value) <= std::numeric_limits<float>::max() || !std::isfinite(value) ? static_cast<float>(value)
                                                                                                     : 1.0F;
            }
        }
        std::array<unsigned char, sizeof(T)> bytes{};
        for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<unsigned char>(byte(k * sizeof(T) + i));
        T value{};
        std::memcpy(&value, bytes.data(), sizeof(T));
        return value;
    }

  private:
    // Of the kind 1, bytes that repeat themselves are disturbed.
    [[nodiscard]] int byte(std::size_t k) const {
        const std::size_t round = kind_ == 1 ? k / bytes_.size() : 0;
        return static_cast<int>((bytes_[k % bytes_.size()] + 37 * round * round) & 255U);
    }

    int kind_;
    double gain_;
    std::vector<unsigned char> bytes_;
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_IMAGES_HPP
