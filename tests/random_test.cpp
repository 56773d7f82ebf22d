#include "hmesh/core/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

using hmesh::kit::Random;

TEST_CASE("Random gives the numbers published with PCG32 for seed 42 and stream 54") {
    Random random(42, 54);
    for (const std::uint32_t expected : {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU})
        CHECK(random.next() == expected);
}

TEST_CASE("Random repeats itself for one seed and stream, and differs for any other") {
    const auto numbers = [](Random random) {
        std::vector<std::uint32_t> list(100);
        for (std::uint32_t& number : list) number = random.next();
        return list;
    };
    CHECK(numbers(Random(7, 3)) == numbers(Random(7, 3)));
    CHECK(numbers(Random(7)) == numbers(Random(7, 0)));
    std::vector<std::vector<std::uint32_t>> sequences;
    for (std::uint64_t seed = 0; seed < 10; ++seed)
        for (std::uint64_t stream = 0; stream < 10; ++stream) sequences.push_back(numbers(Random(seed, stream)));
    std::sort(sequences.begin(), sequences.end());
    CHECK(std::adjacent_find(sequences.begin(), sequences.end()) == sequences.end());
}

TEST_CASE("uniform() stays strictly inside (0, 1) with the mean and the variance of the uniform distribution") {
    Random random(1);
    double sum = 0, squares = 0, least = 1, largest = 0;
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i) {
        const double value = random.uniform();
        least = std::min(least, value);
        largest = std::max(largest, value);
        sum += value;
        squares += value * value;
    }
    CHECK(least > 0);
    CHECK(largest < 1);
    // Five standard deviations of each mean: 0.289 and 0.298 over the root of the count.
    CHECK(sum / count == doctest::Approx(0.5).epsilon(0.0065));
    CHECK(squares / count == doctest::Approx(1.0 / 3).epsilon(0.01));
}

TEST_CASE("below(n) reaches every number of [0, n) equally often and no other") {
    Random random(5);
    for (std::size_t n = 1; n <= 20; ++n) {
        std::vector<int> hits(n + 1, 0);
        for (std::size_t i = 0; i < 2000 * n; ++i) ++hits[std::min(random.below(n), n)];
        CHECK(hits[n] == 0);
        hits.pop_back();
        CHECK(*std::min_element(hits.begin(), hits.end()) > 1760);  // 2000 less more than five standard deviations
        CHECK(*std::max_element(hits.begin(), hits.end()) < 2240);
    }
    constexpr std::size_t most = 0xffffffffU;
    std::size_t largest = 0;
    for (int i = 0; i < 1000; ++i) largest = std::max(largest, random.below(most));
    CHECK(largest < most);
    CHECK(largest > most / 100 * 98);
}
