// hmesh - the executor: how per-pixel and per-face stages run, on one thread or on the user's.
//
// hmesh starts no thread. A stage hands `n` independent pieces of work to an executor, any const callable object or pointer to a
// function
//
//     parallel_for(std::size_t n, body)      // calls body(i) once for each i in [0, n), in any order, on any thread,
//                                            // and returns when all calls have returned
//
// and the pieces follow from the problem alone, never from the number of threads. Sums are added in index order. Stages see
// every executor as a ParallelFor, so that each is compiled once: in two copies of the same source a compiler may round
// differently, as where it contracts a product and a sum into one instruction. Hence the same bits for any executor. What
// it costs is an indirect call a piece, and pieces take microseconds.
#ifndef HMESH_CORE_PARALLEL_HPP
#define HMESH_CORE_PARALLEL_HPP

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace hmesh {

// The default executor: the calling thread, in index order.
struct SerialFor {
    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        for (std::size_t i = 0; i < n; ++i) body(i);
    }
};

// What an executor is given to call: the body of a stage, by reference. Copies call the same body.
class PieceOfWork {
  public:
    template <class Body>
    [[nodiscard]] static PieceOfWork of(Body& body) noexcept {
        return {const_cast<void*>(static_cast<const void*>(std::addressof(body))),
                [](void* callable, std::size_t i) { (*static_cast<Body*>(callable))(i); }};
    }
    void operator()(std::size_t i) const { call_(body_, i); }

  private:
    PieceOfWork(void* body, void (*call)(void*, std::size_t)) noexcept : body_(body), call_(call) {}

    void* body_;
    void (*call_)(void* body, std::size_t i);
};

// Any executor, by reference: it outlives this. By default a SerialFor.
class ParallelFor {
  public:
    ParallelFor() noexcept : ParallelFor(serial) {}
    template <class Executor, class = std::enable_if_t<!std::is_same_v<Executor, ParallelFor> && std::is_object_v<Executor> &&
                                                       std::is_invocable_v<const Executor&, std::size_t, const PieceOfWork&>>>
    ParallelFor(const Executor& executor) noexcept  // NOLINT(google-explicit-constructor): so that functions take any executor
        : executor_(std::addressof(executor)), run_(run<Executor>) {}

    template <class Body>
    void operator()(std::size_t n, Body&& body) const {
        run_(executor_, n, PieceOfWork::of(body));
    }

  private:
    static constexpr SerialFor serial{};

    template <class Executor>
    static void run(const void* executor, std::size_t n, const PieceOfWork& body) {
        (*static_cast<const Executor*>(executor))(n, body);
    }

    const void* executor_;
    void (*run_)(const void* executor, std::size_t n, const PieceOfWork& body);
};

namespace kit {

// Calls body(begin, end) for consecutive ranges of at most `grain` >= 1 indices that together are [0, n).
template <class Body>
void for_each_chunk(const ParallelFor& parallel_for, std::size_t n, std::size_t grain, Body&& body) {
    const std::size_t chunks = n / grain + (n % grain != 0);
    parallel_for(chunks, [&](std::size_t i) { body(i * grain, std::min(n, (i + 1) * grain)); });
}

// The sum of body(begin, end) over the same ranges, added in index order.
template <class Body>
[[nodiscard]] double ordered_sum(const ParallelFor& parallel_for, std::size_t n, std::size_t grain, Body&& body) {
    std::vector<double> parts(n / grain + (n % grain != 0), 0.0);
    for_each_chunk(parallel_for, n, grain, [&](std::size_t begin, std::size_t end) { parts[begin / grain] = body(begin, end); });
    double sum = 0;
    for (const double part : parts) sum += part;
    return sum;
}

}  // namespace kit
}  // namespace hmesh

#endif  // HMESH_CORE_PARALLEL_HPP
