// hmesh tests - images made in code, the same for every sample type and number of channels, deterministic from a seed.
//
// A picture is a function (x, y, channel) with values in [0, 1], where 1 is the peak; draw() samples it at the pixels.
#ifndef HMESH_TESTS_TEST_IMAGES_HPP
#define HMESH_TESTS_TEST_IMAGES_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"

namespace hmesh_test {

template <class T, int C, class Picture>
[[nodiscard]] hmesh::Image<T, C> draw(int width, int height, Picture&& picture) {
    using Traits = hmesh::PixelTraits<T>;
    hmesh::Image<T, C> image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < C; ++c) image.pixel(x, y)[c] = Traits::from_real(picture(x, y, c) * Traits::peak);
    return image;
}

template <class T, int C>
[[nodiscard]] hmesh::Image<T, C> constant_image(int width, int height, double level) {
    return draw<T, C>(width, height, [level](int, int, int) { return level; });
}

// Rises along x and falls along y, or the other way round in odd channels, by the whole peak from corner to corner. For
// integers the samples are rounded: use float where the picture must be affine to the last bits.
template <class T, int C>
[[nodiscard]] hmesh::Image<T, C> affine_image(int width, int height) {
    return draw<T, C>(width, height, [width, height](int x, int y, int c) {
        const double right = (x + 0.5) / width, up = 1 - (y + 0.5) / height;
        const double weight = (c + 1.0) / (C + 1.0), level = weight * right + (1 - weight) * up;
        return c % 2 == 0 ? level : 1 - level;
    });
}

// Squares of `cell` px that are black and white, the other way round in odd channels.
template <class T, int C>
[[nodiscard]] hmesh::Image<T, C> checkerboard(int width, int height, int cell) {
    return draw<T, C>(width, height, [cell](int x, int y, int c) { return (x / cell + y / cell + c) % 2 == 0 ? 0.0 : 1.0; });
}

// Each sample uniform over the whole range and independent: the worst case for a mesh, and for sums.
template <class T, int C>
[[nodiscard]] hmesh::Image<T, C> noise(int width, int height, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    return draw<T, C>(width, height, [&random](int, int, int) { return random.uniform(); });
}

// Weights of pixels: random, of very different sizes, and 0 in single pixels and in a block that touches no border.
[[nodiscard]] inline hmesh::Image<float, 1> random_weights(int width, int height, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    return draw<float, 1>(width, height, [&](int x, int y, int) {
        const double weight = random.uniform(), shrink = random.below(4) == 0 ? 1e-3 : 1;
        const bool in_block = 4 * x > width && 4 * x < 3 * width && 4 * y > height && 4 * y < 3 * height;
        return in_block || random.below(10) == 0 ? 0.0 : 37 * weight * shrink;
    });
}

// What a photograph is made of: smooth shading, objects with sharp and with soft edges, a little texture.
class Scene {
  public:
    Scene(int width, int height, std::uint64_t seed) : size_(std::max(width, height)), random_(seed) {
        for (double& value : lattice_) value = random_.uniform();
        for (Object& object : objects_) {
            object.x = random_.uniform() * width;
            object.y = random_.uniform() * height;
            object.radius = (0.05 + 0.2 * random_.uniform()) * size_;
            object.softness = random_.below(3) == 0 ? 0.3 * object.radius : 0.5;
            object.is_square = random_.below(2) == 0;
            for (double& color : object.colors) color = random_.uniform();
        }
    }

    [[nodiscard]] double operator()(int x, int y, int channel) const {
        const double u = (x + 0.5) / size_, v = (y + 0.5) / size_;
        double level = shade(3 * u, 3 * v, channel);
        for (const Object& object : objects_) {
            const double dx = std::abs(x + 0.5 - object.x), dy = std::abs(y + 0.5 - object.y);
            const double distance = object.is_square ? std::max(0.8 * dx + 0.6 * dy, 0.8 * dy) : std::sqrt(dx * dx + dy * dy);
            const double cover = std::clamp(0.5 + (object.radius - distance) / object.softness, 0.0, 1.0);
            level += cover * (object.colors[static_cast<std::size_t>(channel)] - level);
        }
        level += 0.04 * (shade(40 * u, 40 * v, channel) - 0.5);
        return std::clamp(level, 0.0, 1.0);
    }

  private:
    static constexpr int lattice_side = 16;
    struct Object {
        double x = 0, y = 0, radius = 0, softness = 0;
        bool is_square = false;
        std::array<double, hmesh::kit::max_channels> colors{};
    };

    // Random numbers on a lattice, blended smoothly in between; its period is lattice_side.
    [[nodiscard]] double shade(double x, double y, int channel) const {
        const int i = static_cast<int>(x), j = static_cast<int>(y);
        const double tx = x - i, ty = y - j, sx = tx * tx * (3 - 2 * tx), sy = ty * ty * (3 - 2 * ty);
        const double top = at(i, j, channel) + sx * (at(i + 1, j, channel) - at(i, j, channel));
        const double bottom = at(i, j + 1, channel) + sx * (at(i + 1, j + 1, channel) - at(i, j + 1, channel));
        return top + sy * (bottom - top);
    }
    [[nodiscard]] double at(int i, int j, int channel) const {
        return lattice_[static_cast<std::size_t>(((j + 5 * channel) % lattice_side) * lattice_side +
                                                 (i + channel) % lattice_side)];
    }

    double size_;
    hmesh::kit::Random random_;
    std::array<double, lattice_side * lattice_side> lattice_{};
    std::array<Object, 12> objects_{};
};

// A Scene in steps of 1/255 of the peak, so that 8-bit, 16-bit and float images of it hold the very same picture.
template <class T, int C>
[[nodiscard]] hmesh::Image<T, C> scene(int width, int height, std::uint64_t seed) {
    const Scene picture(width, height, seed);
    return draw<T, C>(width, height, [&picture](int x, int y, int c) { return std::floor(picture(x, y, c) * 255 + 0.5) / 255; });
}

// All samples of an image, pixel after pixel, to be compared and looped over.
template <class T, int C>
[[nodiscard]] std::vector<T> samples_of(const hmesh::Image<T, C>& image) {
    return std::vector<T>(image.data(), image.data() + image.size());
}
// Calls change(sample) for each, in that order.
template <class T, int C, class Change>
void for_each_sample(hmesh::Image<T, C>& image, Change&& change) {
    for (std::size_t k = 0; k < image.size(); ++k) change(image.data()[k]);
}

// The image's samples again, `padding` samples further apart from row to row, and stored bottom up if asked for.
template <class T, int C>
class PaddedCopy {
  public:
    PaddedCopy(const hmesh::Image<T, C>& image, int padding, bool bottom_up, T filler)
        : width_(image.width()), height_(image.height()), bottom_up_(bottom_up),
          row_(static_cast<std::size_t>(width_ * C + padding)), samples_(row_ * static_cast<std::size_t>(height_), filler) {
        for (int y = 0; y < height_; ++y) std::copy_n(image.pixel(0, y), width_ * C, samples_.data() + start_of(y));
    }
    [[nodiscard]] hmesh::ImageView<T, C> view() const {
        const auto stride = static_cast<std::ptrdiff_t>(row_ * sizeof(T));
        return {samples_.data() + start_of(0), width_, height_, bottom_up_ ? -stride : stride};
    }

  private:
    [[nodiscard]] std::size_t start_of(int y) const { return row_ * static_cast<std::size_t>(bottom_up_ ? height_ - 1 - y : y); }
    int width_, height_;
    bool bottom_up_;
    std::size_t row_;
    std::vector<T> samples_;
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_IMAGES_HPP
