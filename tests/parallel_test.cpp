#include "hmesh/core/parallel.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_executors.hpp"

using namespace hmesh_test;

namespace {

template <class ParallelFor>
bool chunks_are_right(const ParallelFor& parallel_for, std::size_t n, std::size_t grain) {
    std::vector<int> visits(n, 0);
    bool good = true;
    hmesh::for_each_chunk(parallel_for, n, grain, [&](std::size_t begin, std::size_t end) {
        good = good && begin < end && end <= n && end - begin <= grain && begin % grain == 0;
        for (std::size_t i = begin; i < end && i < n; ++i) ++visits[i];
    });
    for (const int count : visits) good = good && count == 1;
    return good;
}

}  // namespace

TEST_CASE("SerialFor calls the body once for each index, in order") {
    std::vector<std::size_t> seen;
    hmesh::SerialFor()(5, [&](std::size_t i) { seen.push_back(i); });
    CHECK(seen == std::vector<std::size_t>{0, 1, 2, 3, 4});
    hmesh::SerialFor()(0, [&](std::size_t) { seen.clear(); });
    CHECK(seen.size() == 5);
}

TEST_CASE("for_each_chunk covers [0, n) exactly once with ranges of at most `grain`, in any order") {
    for (std::size_t n = 0; n <= 40; ++n)
        for (std::size_t grain = 1; grain <= 45; ++grain) {
            CHECK(chunks_are_right(hmesh::SerialFor(), n, grain));
            CHECK(chunks_are_right(ReverseFor(), n, grain));
            CHECK(chunks_are_right(ShuffledFor(), n, grain));
        }
}

TEST_CASE("for_each_chunk cuts by the problem and not by the executor") {
    using Ranges = std::vector<std::pair<std::size_t, std::size_t>>;
    const auto record = [](auto&& parallel_for) {
        Ranges ranges(4);
        hmesh::for_each_chunk(parallel_for, 35, 10, [&](std::size_t begin, std::size_t end) {
            ranges[begin / 10] = {begin, end};
        });
        return ranges;
    };
    const Ranges expected{{0, 10}, {10, 20}, {20, 30}, {30, 35}};
    CHECK(record(hmesh::SerialFor()) == expected);
    CHECK(record(ReverseFor()) == expected);
    CHECK(record(ShuffledFor()) == expected);
}

TEST_CASE("ordered_sum gives the same bits whatever order the executor uses") {
    // Terms of very different size: any other order of addition gives another sum.
    hmesh::Random random(3);
    std::vector<double> terms(1000);
    for (double& term : terms) {
        term = random.uniform() - 0.5;
        for (std::size_t k = random.below(12); k > 0; --k) term *= 10;
    }
    const auto body = [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += terms[i];
        return sum;
    };
    const double serial = hmesh::ordered_sum(hmesh::SerialFor(), terms.size(), 7, body);
    CHECK(hmesh::ordered_sum(ReverseFor(), terms.size(), 7, body) == serial);
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        CHECK(hmesh::ordered_sum(ShuffledFor{seed}, terms.size(), 7, body) == serial);

    double in_chunks = 0;
    for (std::size_t begin = 0; begin < terms.size(); begin += 7)
        in_chunks += body(begin, begin + 7 < terms.size() ? begin + 7 : terms.size());
    CHECK(serial == in_chunks);
    CHECK(hmesh::ordered_sum(hmesh::SerialFor(), 0, 7, body) == 0);
}
