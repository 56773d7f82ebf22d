// hmesh tests - executors that run the pieces of a stage in unusual orders and on threads.
#ifndef HMESH_TESTS_TEST_EXECUTORS_HPP
#define HMESH_TESTS_TEST_EXECUTORS_HPP

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"

namespace hmesh_test {

struct ReverseFor {
    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        while (n > 0) body(--n);
    }
};

struct ShuffledFor {
    std::uint64_t seed = 1;
    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        hmesh::kit::Random random(seed);
        std::vector<std::size_t> order(n);
        for (std::size_t i = 0; i < n; ++i) order[i] = i;
        for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
        for (const std::size_t i : order) body(i);
    }
};

// Real threads that take the next piece as they get free. With HMESH_TEST_ONE_THREAD only the calling one: gcov's counters lose
// counts among threads, unless they are atomic and then four times as slow.
struct ThreadFor {
    unsigned threads = 2;
    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        std::atomic<std::size_t> next{0};
        const auto work = [&] {
            for (std::size_t i = 0; (i = next.fetch_add(1)) < n;) body(i);
        };
        std::vector<std::thread> others;
#ifndef HMESH_TEST_ONE_THREAD
        for (unsigned k = 1; k < threads; ++k) others.emplace_back(work);
#endif
        work();
        for (std::thread& thread : others) thread.join();
    }
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_EXECUTORS_HPP
