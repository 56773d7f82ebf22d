// examples - ThreadPool: an executor for hmesh (core/parallel.hpp) that runs the pieces of a stage on several threads.
//
//     const example::ThreadPool pool;                                   // all cores
//     const auto result = hmesh::mesh_image(view, options, pool);       // the same bytes as without it
//
// The calling thread works too; the others live as long as the pool and sleep between calls. Indices are handed out one
// by one as threads get free, so that pieces may differ in size. A call costs microseconds and allocates nothing.
#ifndef HMESH_EXAMPLES_THREAD_POOL_HPP
#define HMESH_EXAMPLES_THREAD_POOL_HPP

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

#include "hmesh/core/parallel.hpp"

namespace example {

class ThreadPool {
  public:
    // `threads` counts the calling one; 0: as many as the processor runs at once. Throws std::system_error where the
    // system has no more threads.
    explicit ThreadPool(unsigned threads = 0) : ThreadPool(Empty{}) {
        if (threads == 0) threads = std::thread::hardware_concurrency();  // 0 where unknown
        for (unsigned k = 1; k < threads; ++k) workers_.emplace_back([this] { serve(); });
    }
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;
    ~ThreadPool() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            ends_ = true;
        }
        wake_.notify_all();
        for (std::thread& worker : workers_) worker.join();
    }

    // The calling one included.
    [[nodiscard]] std::size_t threads() const noexcept { return workers_.size() + 1; }

    // Calls piece(i) once for each i in [0, n) and returns when all calls have returned. One call at a time has the
    // workers: a call from within a piece, or from another thread meanwhile, runs on its own thread alone. A single
    // piece leaves them to the calls within it. A piece that throws on several threads ends the program.
    void operator()(std::size_t n, hmesh::Piece piece) const {
        if (n < 2 || workers_.empty() || busy_.exchange(true, std::memory_order_acquire)) {
            for (std::size_t i = 0; i < n; ++i) piece(i);
            return;
        }
        share({piece, n});
        busy_.store(false, std::memory_order_release);
    }

  private:
    // The private constructor ends before threads are started: if one cannot be, the destructor joins the others.
    struct Empty {};
    explicit ThreadPool(Empty) {}

    struct Job {
        hmesh::Piece piece;
        std::size_t n = 0;
    };

    void share(const Job& job) const noexcept {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            job_ = job;
            next_.store(0, std::memory_order_relaxed);
        }
        if (job.n > workers_.size()) wake_.notify_all();
        else
            for (std::size_t k = 1; k < job.n; ++k) wake_.notify_one();
        work(job);
        // All pieces are handed out. Workers that wake up from now on find none, hence are not waited for.
        std::unique_lock<std::mutex> lock(mutex_);
        idle_.wait(lock, [this] { return helpers_ == 0; });
    }

    void work(const Job& job) const noexcept {
        for (std::size_t i = 0; (i = next_.fetch_add(1, std::memory_order_relaxed)) < job.n;) job.piece(i);
    }

    void serve() const noexcept {
        std::unique_lock<std::mutex> lock(mutex_);
        for (;;) {
            wake_.wait(lock, [this] { return ends_ || next_.load(std::memory_order_relaxed) < job_.n; });
            if (ends_) return;
            const Job job = job_;
            ++helpers_;
            lock.unlock();
            work(job);
            lock.lock();
            if (--helpers_ == 0) idle_.notify_one();
        }
    }

    std::vector<std::thread> workers_;
    mutable std::atomic<bool> busy_{false};  // whether a call has the workers
    mutable std::atomic<std::size_t> next_{0};
    mutable std::mutex mutex_;  // guards all below, and that next_ starts anew
    mutable std::condition_variable wake_, idle_;
    mutable Job job_;
    mutable std::size_t helpers_ = 0;  // workers that took the job and have not left it
    bool ends_ = false;
};

}  // namespace example

#endif  // HMESH_EXAMPLES_THREAD_POOL_HPP
