// material_sets: one mesh of a material's maps beside a mesh for each of them, as a Markdown table.
//
//     material_sets [--vertices 2621,5242] [--effort normal] [--size 512]
//
// Two materials are made by code, bricks and rock, SIZE px wide and high: albedo, normal (y up) and roughness, 7 channels of 8
// bits. Of n vertices "three meshes" have n / 3 each; the others are one mesh of n, with one weight for the channels of each map.
// "balanced" weights are 1 over the squared error that a map has as a mesh of its own, the sum over its channels: so each map
// counts the same in dB. The largest is written as 1.
//
// PSNR: 10 log10(255^2 / MSE) of each map, the mean over its pixels and channels, values drawn not rounded. "gain" is the mean
// of the three maps' differences to the three meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/core/random.hpp>
#include <hmesh/hmesh.hpp>

#include "common.hpp"
#include "noise.hpp"

namespace {

using bench::clamp01;
using bench::Noise;
constexpr int channels = 7;
using Set = hmesh::Image<std::uint8_t, channels>;

// The channels of each map.
struct Map {
    const char* name;
    int first, count;
};
constexpr std::array<Map, 3> maps{{{"albedo", 0, 3}, {"normal", 3, 3}, {"rough", 6, 1}}};

// What a material is at a place.
struct Point {
    std::array<double, 3> albedo{};
    double rough = 0,
           height = 0;  // px
};

// Means of 16 samples a pixel; normals of the mean heights around it.
Set draw(int size, const std::function<Point(double x, double y)>& material) {
    Set out(size, size);
    const auto wide = static_cast<std::size_t>(size);
    std::vector<double> heights(wide * wide);
    const auto byte = [](double share) { return static_cast<std::uint8_t>(255 * clamp01(share) + 0.5); };
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            Point mean;
            for (int k = 0; k < 16; ++k) {
                const int column = k % 4, row = k / 4;
                const Point at = material(x + (column + 0.5) / 4, y + (row + 0.5) / 4);
                for (std::size_t i = 0; i < 3; ++i) mean.albedo[i] += clamp01(at.albedo[i]) / 16;
                mean.rough += clamp01(at.rough) / 16;
                mean.height += at.height / 16;
            }
            for (std::size_t i = 0; i < 3; ++i) out.pixel(x, y)[i] = byte(mean.albedo[i]);
            out.pixel(x, y)[6] = byte(mean.rough);
            heights[static_cast<std::size_t>(y) * wide + static_cast<std::size_t>(x)] = mean.height;
        }
    const auto height = [&](int x, int y) {
        return heights[static_cast<std::size_t>((y + size) % size) * wide + static_cast<std::size_t>((x + size) % size)];
    };
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const std::array<double, 3> n{(height(x - 1, y) - height(x + 1, y)) / 2, (height(x, y + 1) - height(x, y - 1)) / 2,
                                          1};
            const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + 1);
            for (std::size_t i = 0; i < 3; ++i) out.pixel(x, y)[3 + i] = byte(0.5 + 0.5 * n[i] / length);
        }
    return out;
}

Set bricks(int size) {
    const Noise wobble_x(size, 16, 16, 1), wobble_y(size, 16, 16, 2), grain(size, 48, 48, 3);
    hmesh::kit::Random random(4);
    std::vector<double> tints(32);
    for (double& tint : tints) tint = random.uniform();
    const double wide = size / 4.0, high = size / 8.0, bevel = size / 128.0;
    return draw(size, [=](double x, double y) {
        const double v = std::fmod(y + bevel * wobble_y(x, y) + size, size), row = std::floor(v / high);
        const double shift = static_cast<int>(row) % 2 == 1 ? wide / 2 : 0;
        const double u = std::fmod(x + bevel * wobble_x(x, y) + shift + size, size), column = std::floor(u / wide);
        const double in_x = u - wide * column, in_y = v - high * row;
        const double depth = std::min({in_x, wide - in_x, in_y, high - in_y});
        const double brick = clamp01((depth - bevel) / bevel), tint = tints[static_cast<std::size_t>(row * 4 + column)];
        const std::array<double, 3> of_brick{0.5 + 0.2 * tint, 0.22 + 0.1 * tint, 0.16 + 0.06 * tint};
        Point out;
        for (std::size_t i = 0; i < 3; ++i)
            out.albedo[i] = brick * of_brick[i] * (0.9 + 0.1 * grain(x, y)) + (1 - brick) * (0.62 + 0.06 * grain(x, y));
        out.rough = brick * (0.55 + 0.2 * tint) + (1 - brick) * 0.9;
        out.height = bevel * brick + 0.5 * grain(x, y);
        return out;
    });
}

Set rock(int size) {
    std::vector<Noise> octaves;
    octaves.reserve(5);
    for (int k = 0; k < 5; ++k) octaves.emplace_back(size, 4 << k, 4 << k, 10 + static_cast<std::uint64_t>(k));
    return draw(size, [=](double x, double y) {
        double sum = 0, weight = 0.5;
        for (const Noise& octave : octaves) sum += weight * octave(x, y), weight *= 0.5;
        const double ridge = std::abs(2 * sum - 1);
        Point out;
        out.albedo = {0.25 + 0.5 * sum, 0.25 + 0.45 * sum + 0.05 * ridge, 0.24 + 0.38 * sum + 0.1 * ridge};
        out.rough = 0.5 + 0.5 * ridge;
        out.height = size / 8.0 * sum;
        return out;
    });
}

// Some channels of a set.
template <int C>
hmesh::Image<std::uint8_t, C> channels_of(const Set& set, int first) {
    hmesh::Image<std::uint8_t, C> out(set.width(), set.height());
    for (int y = 0; y < set.height(); ++y)
        for (int x = 0; x < set.width(); ++x) std::copy_n(set.pixel(x, y) + first, C, out.pixel(x, y));
    return out;
}

double psnr_of(double mean_square) { return 10 * std::log10(255.0 * 255.0 / mean_square); }

struct Job {
    std::int64_t vertices = 0;
    hmesh::Annealed recipe;
    bool failed = false;
};

template <int C>
double error_alone(const Set& set, const Map& map, Job& job) {
    const auto image = channels_of<C>(set, map.first);
    hmesh::Options options;
    options.target = hmesh::Target::vertices(job.vertices / 3);
    const hmesh::Result result = hmesh::mesh_image(image.view(), options, job.recipe);
    job.failed |= !result.status;
    return 255.0 * 255.0 / std::pow(10, result.report.psnr / 10);
}

// The mean squared error of each map.
std::array<double, 3> errors_together(const Set& set, const std::array<double, 3>& weights, Job& job) {
    hmesh::Options options;
    options.target = hmesh::Target::vertices(job.vertices);
    for (std::size_t m = 0; m < maps.size(); ++m)
        for (int c = 0; c < maps[m].count; ++c) options.channel_weights.push_back(weights[m]);
    const hmesh::Result result = hmesh::mesh_image(set.view(), options, job.recipe);
    const auto drawn = hmesh::render<channels>(result.mesh.view());
    std::array<double, 3> errors{};
    job.failed |= !result.status || !drawn.status;
    if (job.failed) return errors;
    for (std::size_t m = 0; m < maps.size(); ++m) {
        for (int y = 0; y < set.height(); ++y)
            for (int x = 0; x < set.width(); ++x)
                for (int c = maps[m].first; c < maps[m].first + maps[m].count; ++c) {
                    const double d = static_cast<double>(drawn.image.pixel(x, y)[c]) - set.pixel(x, y)[c];
                    errors[m] += d * d;
                }
        errors[m] /= static_cast<double>(set.width()) * set.height() * maps[m].count;
    }
    return errors;
}

void print_row(const char* material, const Job& job, const std::string& name, const std::array<double, 3>& errors,
               const std::array<double, 3>& alone) {
    double gain = 0;
    std::printf("| %s | %lld | %s |", material, static_cast<long long>(job.vertices), name.c_str());
    for (std::size_t m = 0; m < maps.size(); ++m) {
        std::printf(" %.2f |", psnr_of(errors[m]));
        gain += (psnr_of(errors[m]) - psnr_of(alone[m])) / 3;
    }
    std::printf(" %+.2f |\n", gain);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> counts{"2621", "5242"};
    Job job;
    int size = 512;
    bool is_good = true;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (++i == argc) is_good = false;
        else if (word == "--vertices") counts = bench::split(argv[i]);
        else if (word == "--effort") is_good &= bench::effort_of(argv[i], job.recipe.effort);
        else if (word == "--size") size = std::clamp(std::atoi(argv[i]), 64, 4096);
        else is_good = false;
    }
    if (!is_good) {
        std::fprintf(stderr, "usage: material_sets [--vertices 2621,5242] [--effort normal] [--size 512]\n");
        return 2;
    }
    const std::array<std::pair<const char*, Set>, 2> materials{{{"bricks", bricks(size)}, {"rock", rock(size)}}};
    std::puts("| material | vertices | weights | albedo | normal | rough | gain |\n|---|---|---|---|---|---|---|");
    for (const auto& [name, set] : materials)
        for (const std::string& count : counts) {
            job.vertices = std::atoll(count.c_str());
            const std::array<double, 3> alone{error_alone<3>(set, maps[0], job), error_alone<3>(set, maps[1], job),
                                              error_alone<1>(set, maps[2], job)};
            print_row(name, job, "three meshes", alone, alone);
            std::array<double, 3> balanced{};
            for (std::size_t m = 0; m < 3; ++m) balanced[m] = 1 / (alone[m] * maps[m].count);
            const double largest = *std::max_element(balanced.begin(), balanced.end());
            for (double& weight : balanced) weight /= largest;
            using Weights = std::array<double, 3>;
            for (const auto& [word, weights] :
                 {std::pair{"", Weights{1, 1, 1}}, std::pair{"", Weights{1, 0.25, 0.25}}, std::pair{"balanced ", balanced}}) {
                const auto errors = errors_together(set, weights, job);
                if (job.failed) return 1;
                char text[64];
                std::snprintf(text, sizeof text, "%s%.2g,%.2g,%.2g", word, weights[0], weights[1], weights[2]);
                print_row(name, job, text, errors, alone);
            }
        }
}
