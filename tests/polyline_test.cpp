#include "hmesh/methods/annealed/polyline.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/random.hpp"

namespace {

using Nodes = std::vector<std::uint32_t>;

struct Row {
    std::vector<double> samples;
    std::size_t channels = 1;

    [[nodiscard]] std::size_t size() const { return samples.size() / channels; }
    [[nodiscard]] double at(std::size_t k, std::size_t c) const { return samples[channels * k + c]; }
    [[nodiscard]] Nodes nodes(double tolerance) const { return hmesh::kit::PolylineFinder(samples, channels).nodes(tolerance); }
};

// A walk with steps of up to half of `step`, of which a third are none.
Row walk(std::uint64_t seed, std::size_t most, std::size_t channels, double step) {
    hmesh::kit::Random random(seed);
    Row row{{}, channels};
    std::vector<double> heights(channels, 0);
    for (std::size_t k = 2 + random.below(static_cast<std::uint32_t>(most)); k > 0; --k)
        for (double& height : heights)
            row.samples.push_back(height += random.below(3) == 0 ? 0 : step * (random.uniform() - 0.5));
    return row;
}

// Whether the chord from i to k passes what is between within the tolerance.
bool passes(const Row& row, std::size_t i, std::size_t k, double tolerance) {
    for (std::size_t j = i + 1; j < k; ++j) {
        const double share = static_cast<double>(j - i) / static_cast<double>(k - i);
        for (std::size_t c = 0; c < row.channels; ++c)
            if (std::abs(row.at(i, c) + share * (row.at(k, c) - row.at(i, c)) - row.at(j, c)) > tolerance + 1e-12) return false;
    }
    return true;
}

// The fewest chords, by trying all.
std::size_t fewest_chords(const Row& row, double tolerance) {
    std::vector<std::size_t> chords(row.size(), row.size());
    chords[0] = 0;
    for (std::size_t k = 1; k < row.size(); ++k)
        for (std::size_t i = 0; i < k; ++i)
            if (chords[i] + 1 < chords[k] && passes(row, i, k, tolerance)) chords[k] = chords[i] + 1;
    return chords.back();
}

}  // namespace

TEST_CASE("a polyline has the fewest nodes that all chords allow, and passes all samples") {
    for (const std::size_t channels : {std::size_t{1}, std::size_t{3}, std::size_t{16}}) {
        for (std::uint64_t seed = 1; seed <= 60; ++seed) {
            CAPTURE(channels);
            CAPTURE(seed);
            // Every tenth is of many blocks.
            const Row row = walk(seed, seed % 10 == 0 ? 300 : 60, channels, seed % 3 == 0 ? 0.05 : 1);
            for (const double tolerance : {0.0, 0.05, 0.3, 2.0, 100.0}) {
                const Nodes nodes = row.nodes(tolerance);
                CHECK(nodes.front() == 0);
                CHECK(nodes.back() == row.size() - 1);
                CHECK(nodes.size() == fewest_chords(row, tolerance) + 1);
                for (std::size_t k = 1; k < nodes.size(); ++k) CHECK(passes(row, nodes[k - 1], nodes[k], tolerance));
            }
        }
    }
}

TEST_CASE("chords end after 1,024 samples, and of the shortest ways that with the first nodes is taken") {
    CHECK(Row{std::vector<double>(5000, 7.0)}.nodes(0) == Nodes{0, 903, 1927, 2951, 3975, 4999});
}

TEST_CASE("a finder can be asked again, by other tolerances") {
    const Row row = walk(7, 500, 2, 1);
    hmesh::kit::PolylineFinder finder(row.samples, row.channels);
    for (const double tolerance : {2.0, 0.1, 0.7, 2.0}) CHECK(Nodes(finder.nodes(tolerance)) == row.nodes(tolerance));
}

TEST_CASE("rows with NaN and infinities have polylines from end to end") {
    const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const double value : {nan, infinity, -infinity})
        for (const std::size_t from : {std::size_t{0}, std::size_t{1}, std::size_t{50}, std::size_t{99}})
            for (const std::size_t to : {from + 1, from + 40}) {
                Row row{std::vector<double>(100, 1.0)};
                for (std::size_t k = from; k < std::min<std::size_t>(to, 100); ++k) row.samples[k] = value;
                const Nodes nodes = row.nodes(0.1);
                CHECK(nodes.front() == 0);
                CHECK(nodes.back() == 99);
                for (std::size_t k = 1; k < nodes.size(); ++k) CHECK(nodes[k - 1] < nodes[k]);
            }
}
