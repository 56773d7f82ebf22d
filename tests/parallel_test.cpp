#include "hmesh/core/parallel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_executors.hpp"

using namespace hmesh_test;

namespace {

bool chunks_are_right(const hmesh::ParallelFor& parallel_for, std::size_t n, std::size_t grain) {
    std::vector<int> visits(n, 0);
    bool good = true;
    hmesh::kit::for_each_chunk(parallel_for, n, grain, [&](std::size_t begin, std::size_t end) {
        good = good && begin < end && end <= n && end - begin <= grain && begin % grain == 0;
        for (std::size_t i = begin; i < end && i < n; ++i) ++visits[i];
    });
    for (const int count : visits) good = good && count == 1;
    return good;
}

void last_first(std::size_t n, hmesh::Piece piece) {
    while (n > 0) piece(--n);
}

}  // namespace

TEST_CASE("a ParallelFor made of nothing calls the body once for each index, in order, on the calling thread") {
    std::vector<std::size_t> seen;
    bool elsewhere = false;
    hmesh::ParallelFor()(5, [&, caller = std::this_thread::get_id()](std::size_t i) {
        seen.push_back(i);
        elsewhere = elsewhere || std::this_thread::get_id() != caller;
    });
    CHECK(seen == std::vector<std::size_t>{0, 1, 2, 3, 4});
    CHECK_FALSE(elsewhere);
    hmesh::ParallelFor()(0, [&](std::size_t) { seen.clear(); });
    CHECK(seen.size() == 5);
}

TEST_CASE("for_each_chunk covers [0, n) exactly once with ranges of at most `grain`, in any order") {
    for (std::size_t n = 0; n <= 40; ++n)
        for (std::size_t grain = 1; grain <= 45; ++grain) {
            CHECK(chunks_are_right(hmesh::ParallelFor(), n, grain));
            CHECK(chunks_are_right(ReverseFor(), n, grain));
            CHECK(chunks_are_right(ShuffledFor(), n, grain));
        }
}

TEST_CASE("for_each_in_turn goes through [0, n) in order on any executor, which is given each of several ranges as a call") {
    for (std::size_t n = 0; n <= 40; ++n)
        for (std::size_t grain = 1; grain <= 45; ++grain) {
            std::size_t calls = 0, reached = 0;
            bool good = true;
            const auto count = [&](std::size_t pieces, hmesh::Piece piece) {
                ++calls;
                last_first(pieces, piece);
            };
            hmesh::kit::for_each_in_turn(count, n, grain, [&](std::size_t begin, std::size_t end) {
                good = good && begin == reached && end >= begin && end - begin <= grain;
                reached = end;
            });
            CHECK((good && reached == n));
            CHECK(calls == (n <= grain ? 0 : (n + grain - 1) / grain));
        }
}

TEST_CASE("memory is cleared from its first byte to its last, and no further") {
    constexpr std::size_t piece = std::size_t{1} << 21;
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, piece, piece + 1, 2 * piece - 1}) {
        std::vector<unsigned char> memory(bytes + 2, 7);
        hmesh::kit::clear(ReverseFor(), memory.data() + 1, bytes);
        CHECK(std::count(memory.begin(), memory.end(), 0) == static_cast<std::ptrdiff_t>(bytes));
        CHECK((memory.front() == 7 && memory.back() == 7));
    }
}

TEST_CASE("for_each_chunk cuts by the problem and not by the executor") {
    using Ranges = std::vector<std::pair<std::size_t, std::size_t>>;
    const auto record = [](const hmesh::ParallelFor& parallel_for) {
        Ranges ranges(4);
        hmesh::kit::for_each_chunk(parallel_for, 35, 10, [&](std::size_t begin, std::size_t end) {
            ranges[begin / 10] = {begin, end};
        });
        return ranges;
    };
    const Ranges expected{{0, 10}, {10, 20}, {20, 30}, {30, 35}};
    CHECK(record(hmesh::ParallelFor()) == expected);
    CHECK(record(ReverseFor()) == expected);
    CHECK(record(ShuffledFor()) == expected);
}

TEST_CASE("ordered_sum gives the same bits whatever order the executor uses") {
    // Terms of very different size: any other order of addition gives another sum.
    hmesh::kit::Random random(3);
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
    const double serial = hmesh::kit::ordered_sum(hmesh::ParallelFor(), terms.size(), 7, body);
    CHECK(hmesh::kit::ordered_sum(ReverseFor(), terms.size(), 7, body) == serial);
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        CHECK(hmesh::kit::ordered_sum(ShuffledFor{seed}, terms.size(), 7, body) == serial);

    double in_chunks = 0;
    for (std::size_t begin = 0; begin < terms.size(); begin += 7)
        in_chunks += body(begin, begin + 7 < terms.size() ? begin + 7 : terms.size());
    CHECK(serial == in_chunks);
    CHECK(hmesh::kit::ordered_sum(hmesh::ParallelFor(), 0, 7, body) == 0);
}

TEST_CASE("a ParallelFor runs pieces on the executor that it was made of, and on the calling thread without one") {
    const auto indices = [](const hmesh::ParallelFor& parallel_for) {
        std::vector<std::size_t> seen;
        parallel_for(4, [&](std::size_t i) { seen.push_back(i); });
        return seen;
    };
    const std::vector<std::size_t> forwards{0, 1, 2, 3}, backwards{3, 2, 1, 0};
    CHECK(indices({}) == forwards);
    CHECK(indices(ReverseFor()) == backwards);
    const ReverseFor executor;
    const hmesh::ParallelFor first = executor, copy = first;
    CHECK(indices(copy) == backwards);
}

TEST_CASE("executors take a piece of work as a template parameter, as std::function and by value, and may copy it") {
    std::vector<int> visits(6, 0);
    const auto body = [&](std::size_t i) { ++visits[i]; };
    const auto as_function = [](std::size_t n, const std::function<void(std::size_t)>& piece) {
        for (std::size_t i = 0; i < n; ++i) piece(i);
    };
    const auto by_value = [](std::size_t n, auto piece) {
        const auto copy = piece;
        for (std::size_t i = 0; i < n; ++i) copy(i);
    };
    const std::function<void(std::size_t, const std::function<void(std::size_t)>&)> any = as_function;
    hmesh::ParallelFor{as_function}(6, body);
    hmesh::ParallelFor{by_value}(6, body);
    hmesh::ParallelFor{any}(6, body);
    hmesh::ParallelFor(ThreadFor{3})(6, body);
    CHECK(visits == std::vector<int>(6, 4));
}

TEST_CASE("executors are objects, which may be const, and functions") {
    std::vector<std::size_t> seen;
    const auto note = [&](std::size_t i) { seen.push_back(i); };
    const std::vector<std::size_t> expected{2, 1, 0, 2, 1, 0, 2, 1, 0};
    const ReverseFor object;
    hmesh::ParallelFor{object}(3, note);
    hmesh::ParallelFor{last_first}(3, note);
    hmesh::ParallelFor{&last_first}(3, note);
    CHECK(seen == expected);
    static_assert(std::is_convertible_v<ThreadFor, hmesh::ParallelFor>);
    static_assert(std::is_convertible_v<const ThreadFor&, hmesh::ParallelFor>);
    static_assert(std::is_convertible_v<void (*)(std::size_t, hmesh::Piece), hmesh::ParallelFor>);
    static_assert(std::is_convertible_v<void (&)(std::size_t, hmesh::Piece), hmesh::ParallelFor>);
}

TEST_CASE("only what can run pieces becomes a ParallelFor") {
    static_assert(!std::is_convertible_v<int, hmesh::ParallelFor>);
    static_assert(!std::is_convertible_v<std::vector<double>, hmesh::ParallelFor>);
    static_assert(!std::is_convertible_v<void (*)(std::size_t), hmesh::ParallelFor>);
    static_assert(!std::is_convertible_v<void (*)(hmesh::Piece), hmesh::ParallelFor>);
}
