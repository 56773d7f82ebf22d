/// \file
/// ParallelFor: the executor, by which stages share out their work on one thread or on the user's threads.
///
/// hmesh starts no thread. A stage hands `n` independent pieces of work to an executor, which is any const callable
///
///     void parallel_for(std::size_t n, hmesh::Piece piece)   // calls piece(i) once for each i in [0, n), in any order, on any
///                                                            // thread, and returns when all calls have returned
///
/// Any executor gives the same bits: the pieces follow from the problem alone, never from the number of threads, and sums are
/// added in index order. A stage sees every executor as a ParallelFor, so that it is compiled once: in two copies of one source
/// a compiler may round differently, as where it contracts a product and a sum into one instruction. This costs an indirect
/// call a piece; pieces take microseconds or more. hmesh never hands pieces to an executor from within a piece, so an executor
/// need not allow that.
#ifndef HMESH_CORE_PARALLEL_HPP
#define HMESH_CORE_PARALLEL_HPP

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// The work that an executor calls: piece(index) does one piece of it. Valid until the executor returns.
using Piece = FunctionRef<void(std::size_t index)>;

/// Non-owning reference to an executor, which must outlive it; a lambda written in the call does. Default-constructed it runs
/// the pieces on the calling thread, in index order.
class ParallelFor : public FunctionRef<void(std::size_t n, Piece piece)> {
  public:
    using FunctionRef::FunctionRef;
    /// The executor that runs the pieces on the calling thread, in index order.
    ParallelFor() noexcept : FunctionRef(&serial) {}

  private:
    static void serial(std::size_t n, Piece piece) {
        for (std::size_t i = 0; i < n; ++i) piece(i);
    }
};

namespace kit {

/// Splits [0, n) into consecutive ranges [begin, end) of `grain` >= 1 indices (the last may be shorter) and calls body(begin,
/// end) for each.
inline void for_each_chunk(const ParallelFor& parallel_for, std::size_t n, std::size_t grain,
                           FunctionRef<void(std::size_t begin, std::size_t end)> body) {
    const std::size_t chunks = n / grain + (n % grain != 0);
    parallel_for(chunks, [&](std::size_t i) { body(i * grain, std::min(n, (i + 1) * grain)); });
}

/// The same for what must be done in order: calls body(begin, end) for one range after the other. Where there are several, each
/// is a call of the executor, which may then ask whether to go on (PollingExecutor).
HMESH_COLD inline void for_each_in_turn(const ParallelFor& parallel_for, std::size_t n, std::size_t grain,
                                        FunctionRef<void(std::size_t begin, std::size_t end)> body) {
    if (n <= grain) return body(0, n);
    for (std::size_t begin = 0; begin < n; begin += grain)
        parallel_for(1, [&](std::size_t) { body(begin, std::min(n, begin + grain)); });
}

/// Sets fresh memory to 0, in pieces of work: where the system has to find its pages, that takes 2.5 ms a megabyte.
HMESH_COLD inline void clear(const ParallelFor& parallel_for, void* memory, std::size_t bytes) {
    for_each_chunk(parallel_for, bytes, 1U << 21,
                   [&](std::size_t begin, std::size_t end) { std::memset(static_cast<char*>(memory) + begin, 0, end - begin); });
}

/// The sum of body(begin, end) over the ranges of for_each_chunk(), added in index order.
[[nodiscard]] inline double ordered_sum(const ParallelFor& parallel_for, std::size_t n, std::size_t grain,
                                        FunctionRef<double(std::size_t begin, std::size_t end)> body) {
    Array<double> parts(n / grain + (n % grain != 0), 0.0);
    for_each_chunk(parallel_for, n, grain, [&](std::size_t begin, std::size_t end) { parts[begin / grain] = body(begin, end); });
    double sum = 0;
    for (const double part : parts) sum += part;
    return sum;
}

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_PARALLEL_HPP
