// Crew: an executor (hmesh/core/parallel.hpp) of the thread that calls and of helpers, which JavaScript starts: workers with
// instances of their own in the same shared memory, that call help(). None of Emscripten's threads and none of its JavaScript.
//
// A helper takes part while a call is open, from when it has counted itself in: so a call that is closed, and then waits until no
// one is in, has no one in its pieces. All counts are sequentially consistent.
#ifndef HMESH_BINDING_CREW_HPP
#define HMESH_BINDING_CREW_HPP

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/parallel.hpp"
#include "pages.hpp"

namespace binding {

// How a helper failed, with the numbers of help() in src/engine.js.
enum class Failure : std::uint32_t { none, out_of_memory, trap };

class Crew {
  public:
    // Runs the pieces, and returns none, or how a helper failed, so that some pieces were not done.
    Failure run(std::size_t n, hmesh::Piece piece) {
        if (n < 2) {
            for (std::size_t i = 0; i < n; ++i) piece(i);
            return Failure::none;
        }
        piece_ = &piece;
        count_ = n;
        next_ = 0;
        is_open_ = 1;
        ++calls_;
        wake(calls_);
        work();
        is_open_ = 0;
        for (std::uint32_t in = helpers_in_; in != 0; in = helpers_in_) wait(helpers_in_, in);
        catch_up();
        return failure_;
    }
    // Takes part in all calls to come. Never returns.
    [[noreturn]] void help() {
        while (true) {
            const std::uint32_t call = calls_;
            ++helpers_in_;
            catch_up();
            if (is_open_ != 0) work();
            leave();
            wait(calls_, call);
        }
    }
    // Says of the helper that calls that a piece threw.
    void fail(Failure failure) {
        failure_ = failure;
        leave();
    }

  private:
    using Word = std::atomic<std::uint32_t>;

    void work() {
        for (std::size_t i = next_++; i < count_; i = next_++) (*piece_)(i);
    }
    void leave() {
        --helpers_in_;
        wake(helpers_in_);
    }
    static void wait(Word& word, std::uint32_t value) {
        __builtin_wasm_memory_atomic_wait32(reinterpret_cast<int*>(&word), static_cast<int>(value), -1);
    }
    static void wake(Word& word) { __builtin_wasm_memory_atomic_notify(reinterpret_cast<int*>(&word), ~0U); }

    const hmesh::Piece* piece_ = nullptr;
    std::size_t count_ = 0;
    Word next_{0}, is_open_{0}, calls_{0}, helpers_in_{0};
    std::atomic<Failure> failure_{Failure::none};
};

}  // namespace binding

#endif  // HMESH_BINDING_CREW_HPP
