#include "thread_pool.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <set>
#include <thread>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using example::ThreadPool;

namespace {

// Whether the pool calls the body once for each index of [0, n), and all calls have returned.
bool each_once(const ThreadPool& pool, std::size_t n) {
    std::vector<int> visits(n, 0);
    pool(n, [&](std::size_t i) { ++visits[i]; });
    return std::all_of(visits.begin(), visits.end(), [](int count) { return count == 1; });
}

}  // namespace

TEST_CASE("a pool has the number of threads asked for, the calling one included; 0 asks for all cores") {
    CHECK(ThreadPool(1).threads() == 1);
    CHECK(ThreadPool(3).threads() == 3);
    CHECK(ThreadPool(0).threads() == std::max(1U, std::thread::hardware_concurrency()));
}

TEST_CASE("every index is handed out once, whether there is more or less work than threads") {
    for (const unsigned threads : {1U, 2U, 3U, 16U}) {
        const ThreadPool pool(threads);
        for (std::size_t n = 0; n <= 40; ++n) CHECK(each_once(pool, n));
        CHECK(each_once(pool, 100000));
    }
}

TEST_CASE("what the body wrote is there when the call returns, over many rounds of one pool") {
    const ThreadPool pool(4);
    std::vector<std::size_t> values(13, 0);
    bool good = true;
    for (std::size_t round = 1; round <= 20000; ++round) {
        const std::size_t n = 2 + round % 12;
        pool(n, [&](std::size_t i) { values[i] = round + i; });
        for (std::size_t i = 0; i < n; ++i) good = good && values[i] == round + i;
    }
    CHECK(good);
}

TEST_CASE("several threads work at a time: each of four bodies waits for the other three") {
    const ThreadPool pool(4);
    std::atomic<int> arrived{0};
    pool(4, [&](std::size_t) {
        ++arrived;
        while (arrived < 4) std::this_thread::yield();
    });
    CHECK(arrived == 4);
}

TEST_CASE("a single piece, or a pool of one thread, runs on the caller in index order") {
    const std::thread::id caller = std::this_thread::get_id();
    bool good = true;
    ThreadPool(4)(1, [&](std::size_t) { good = std::this_thread::get_id() == caller; });
    CHECK(good);
    std::vector<std::size_t> seen;
    ThreadPool(1)(5, [&](std::size_t i) {
        good = good && std::this_thread::get_id() == caller;
        seen.push_back(i);
    });
    CHECK(good);
    CHECK(seen == std::vector<std::size_t>{0, 1, 2, 3, 4});
}

TEST_CASE("a body may call the pool again: the pieces within run once each, on that body's thread") {
    const ThreadPool pool(4);
    std::vector<std::vector<std::size_t>> seen(50);
    std::atomic<bool> same_thread{true};
    pool(seen.size(), [&](std::size_t i) {
        const std::thread::id outer = std::this_thread::get_id();
        pool(10, [&](std::size_t k) {
            if (std::this_thread::get_id() != outer) same_thread = false;
            pool(2, [&](std::size_t m) { seen[i].push_back(2 * k + m); });
        });
    });
    CHECK(same_thread);
    for (const auto& indices : seen) {
        CHECK(indices.size() == 20);
        CHECK(std::is_sorted(indices.begin(), indices.end()));
        CHECK(std::set<std::size_t>(indices.begin(), indices.end()).size() == 20);
    }
}

TEST_CASE("a pool may be called from several threads at once") {
    const ThreadPool pool(3);
    std::atomic<bool> good{true};
    std::vector<std::thread> callers;
    for (int k = 0; k < 3; ++k)
        callers.emplace_back([&] {
            for (int round = 0; round < 500; ++round)
                if (!each_once(pool, 20)) good = false;
        });
    for (std::thread& caller : callers) caller.join();
    CHECK(good);
}

TEST_CASE("bodies may be const, and may be given as lvalues and rvalues") {
    const ThreadPool pool(2);
    std::atomic<std::size_t> sum{0};
    const auto fixed = [&](std::size_t i) { sum += i; };
    auto counting = [&](std::size_t i) mutable { sum += i; };
    pool(10, fixed);
    pool(10, counting);
    pool(10, [&](std::size_t i) { sum += i; });
    CHECK(sum == 3 * 45);
}

TEST_CASE("mesh_image gives the same bytes on 1, 2 and 7 threads as without a pool, in one tile and in several") {
    const auto check_same = [](int width, int height, std::int64_t vertices, hmesh::Effort effort, int tile) {
        const auto image = hmesh_test::scene<std::uint8_t, 3>(width, height, 1);
        hmesh::Options options;
        options.target = hmesh::Target::vertices(vertices);
        hmesh::Annealed recipe;
        recipe.effort = effort;
        recipe.tile = tile;
        const hmesh::Result first = hmesh::mesh_image(image.view(), options, recipe);
        REQUIRE(first.mesh.vertex_count() == static_cast<std::size_t>(vertices));
        for (const unsigned threads : {1U, 2U, 7U})
            CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options, recipe, ThreadPool(threads)), first));
    };
    check_same(80, 70, 300, hmesh::Effort::draft, 0);
    check_same(80, 70, 300, hmesh::Effort::normal, 0);
    check_same(160, 140, 1400, hmesh::Effort::fast, 64);
}
