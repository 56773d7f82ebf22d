// hmesh - the executor: how per-pixel and per-face stages run, on one thread or on the user's.
//
// hmesh starts no thread. A stage hands `n` independent pieces of work to an executor, any callable
//
//     parallel_for(std::size_t n, body)      // calls body(i) once for each i in [0, n), in any order, on any thread,
//                                            // and returns when all calls have returned
//
// and the pieces follow from the problem alone, never from the number of threads. Sums are added in index order. Hence
// the same bits for any executor.
#ifndef HMESH_CORE_PARALLEL_HPP
#define HMESH_CORE_PARALLEL_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hmesh {

// The default executor: the calling thread, in index order.
struct SerialFor {
    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        for (std::size_t i = 0; i < n; ++i) body(i);
    }
};

// Calls body(begin, end) for consecutive ranges of at most `grain` >= 1 indices that together are [0, n).
template <class ParallelFor, class Body>
void for_each_chunk(const ParallelFor& parallel_for, std::size_t n, std::size_t grain, Body&& body) {
    const std::size_t chunks = n / grain + (n % grain != 0);
    parallel_for(chunks, [&](std::size_t i) { body(i * grain, std::min(n, (i + 1) * grain)); });
}

// The sum of body(begin, end) over the same ranges, added in index order.
template <class ParallelFor, class Body>
[[nodiscard]] double ordered_sum(const ParallelFor& parallel_for, std::size_t n, std::size_t grain, Body&& body) {
    std::vector<double> parts(n / grain + (n % grain != 0), 0.0);
    for_each_chunk(parallel_for, n, grain, [&](std::size_t begin, std::size_t end) { parts[begin / grain] = body(begin, end); });
    double sum = 0;
    for (const double part : parts) sum += part;
    return sum;
}

}  // namespace hmesh

#endif  // HMESH_CORE_PARALLEL_HPP
