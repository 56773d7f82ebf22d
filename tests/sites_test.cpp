#include "hmesh/io/compact/sites.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"

using hmesh::detail::ArithmeticCoder;
using hmesh::detail::Logistic;
using hmesh::detail::Site;
using hmesh::detail::SiteCoder;

namespace {

using Set = std::set<std::pair<std::uint32_t, std::uint32_t>>;

// Bytes that some sets take one after the other; checks that they come back in the order in which they were left.
std::size_t size_of(std::uint32_t width, std::uint32_t height, const std::vector<Set>& sets) {
    const Logistic logistic;
    std::vector<std::uint8_t> bytes;
    ArithmeticCoder to(bytes);
    SiteCoder writer(to, logistic);
    std::vector<std::vector<Site>> written;
    for (const Set& set : sets) {
        std::vector<Site> sites;
        for (const auto& [x, y] : set) sites.push_back({x, y});
        REQUIRE(writer.code(width, height, sites.size(), sites));
        written.push_back(sites);
    }
    to.finish();
    ArithmeticCoder from(bytes.data(), bytes.size());
    SiteCoder reader(from, logistic);
    for (std::size_t k = 0; k < sets.size(); ++k) {
        std::vector<Site> sites;
        REQUIRE(reader.code(width, height, sets[k].size(), sites));
        Set got;
        bool is_same = sites.size() == written[k].size();
        for (std::size_t i = 0; is_same && i < sites.size(); ++i) {
            got.insert({sites[i].x, sites[i].y});
            is_same = sites[i].x == written[k][i].x && sites[i].y == written[k][i].y;
        }
        CHECK(is_same);
        CHECK(got == sets[k]);
    }
    CHECK(from.is_at_end());
    return bytes.size();
}

}  // namespace

TEST_CASE("every subset of a small lattice comes back") {
    for (const auto& [width, height] :
         std::vector<std::pair<std::uint32_t, std::uint32_t>>{{3, 3}, {7, 1}, {1, 5}, {1, 1}, {5, 2}}) {
        std::vector<Set> sets;
        for (std::uint32_t bits = 0; bits < 1U << (width * height); ++bits) {
            sets.emplace_back();
            for (std::uint32_t k = 0; k < width * height; ++k)
                if ((bits >> k & 1U) != 0) sets.back().insert({k % width, k / width});
        }
        size_of(width, height, sets);
    }
}

TEST_CASE("a lattice that is full costs nothing") {
    Set all;
    for (std::uint32_t y = 0; y < 37; ++y)
        for (std::uint32_t x = 0; x < 50; ++x) all.insert({x, y});
    CHECK(size_of(50, 37, {all}) == 0);
}

TEST_CASE("points anywhere cost what their number of sets says, and clusters less") {
    hmesh::kit::Random random(2);
    Set even, clusters;
    while (even.size() < 4000)
        even.insert({static_cast<std::uint32_t>(random.below(3000)), static_cast<std::uint32_t>(random.below(5000))});
    while (clusters.size() < 4000)
        clusters.insert({static_cast<std::uint32_t>(1000 + random.below(500)), static_cast<std::uint32_t>(random.below(300))});
    // log2 of 15,000,000 sites over 4,000 points.
    const double bits = 4000 * (std::log2(15e6 / 4000) + 1.4427);
    CHECK(static_cast<double>(size_of(3000, 5000, {even})) < 1.02 * bits / 8);
    CHECK(static_cast<double>(size_of(3000, 5000, {clusters})) < 0.6 * bits / 8);
}
