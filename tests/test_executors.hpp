// hmesh tests - executors that run the pieces of a stage in unusual orders.
#ifndef HMESH_TESTS_TEST_EXECUTORS_HPP
#define HMESH_TESTS_TEST_EXECUTORS_HPP

#include <cstddef>
#include <cstdint>
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
        hmesh::Random random(seed);
        std::vector<std::size_t> order(n);
        for (std::size_t i = 0; i < n; ++i) order[i] = i;
        for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
        for (const std::size_t i : order) body(i);
    }
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_EXECUTORS_HPP
