#include "hmesh/edit/indexed_heap.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "hmesh/core/random.hpp"

using hmesh::kit::IndexedHeap;

namespace {

// The same behaviour from two ordered containers.
struct Model {
    std::map<IndexedHeap::Id, double> key_of;
    std::set<std::pair<double, IndexedHeap::Id>> order;

    void put(IndexedHeap::Id id, double key) {
        erase(id);
        key_of[id] = key;
        order.insert({key, id});
    }
    void erase(IndexedHeap::Id id) {
        const auto found = key_of.find(id);
        if (found == key_of.end()) return;
        order.erase({found->second, id});
        key_of.erase(found);
    }
};

bool agree(const IndexedHeap& heap, const Model& model, std::size_t ids) {
    if (heap.size() != model.key_of.size() || heap.empty() != model.key_of.empty()) return false;
    for (std::size_t i = 0; i < ids; ++i) {
        const auto id = static_cast<IndexedHeap::Id>(i);
        const auto found = model.key_of.find(id);
        if (heap.contains(id) != (found != model.key_of.end())) return false;
        if (heap.contains(id) && heap.key(id) != found->second) return false;
    }
    return heap.empty() || (heap.top().key == model.order.begin()->first && heap.top().id == model.order.begin()->second);
}

}  // namespace

TEST_CASE("IndexedHeap does what an ordered set does, on random operations with many equal keys") {
    constexpr std::size_t ids = 40;
    hmesh::kit::Random random(11);
    IndexedHeap heap;
    Model model;
    int disagreements = 0;
    for (int step = 0; step < 40000; ++step) {
        const auto id = static_cast<IndexedHeap::Id>(random.below(ids));
        // Long stretches of keys that all differ, others of ten different ones.
        const double key = step / 5000 % 2 == 0 ? static_cast<double>(random.below(10)) - 5 : random.uniform();
        switch (random.below(8)) {
            case 0:
            case 1:
            case 2:
                heap.push(id, key);
                model.put(id, key);
                break;
            case 3:
            case 4:
                if (!heap.contains(id)) break;
                heap.update(id, key);
                model.put(id, key);
                break;
            case 5:
                if (!heap.contains(id)) break;
                heap.erase(id);
                model.erase(id);
                break;
            case 6: {
                if (heap.empty()) break;
                const IndexedHeap::Entry least = heap.pop();
                disagreements += std::make_pair(least.key, least.id) != *model.order.begin();
                model.erase(least.id);
                break;
            }
            default:
                if (random.below(200) != 0) break;
                heap.clear();
                model = Model();
        }
        disagreements += !agree(heap, model, ids + 5);
    }
    CHECK(disagreements == 0);
}

TEST_CASE("IndexedHeap empties in the order of keys, equal keys in the order of ids, whatever its history") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        hmesh::kit::Random random(seed);
        IndexedHeap heap;
        for (int i = 0; i < 300; ++i) heap.push(static_cast<IndexedHeap::Id>(random.below(100)), random.uniform());
        for (IndexedHeap::Id id = 0; id < 100; ++id) heap.push(id, id % 7);
        IndexedHeap::Entry last{-1, 0};
        int popped = 0, misplaced = 0;
        for (; !heap.empty(); ++popped) {
            const IndexedHeap::Entry entry = heap.pop();
            misplaced += !(last.key < entry.key || (last.key == entry.key && last.id < entry.id));
            last = entry;
        }
        CHECK(popped == 100);
        CHECK(misplaced == 0);
    }
}

TEST_CASE("IndexedHeap takes infinite keys and large ids") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    IndexedHeap heap;
    CHECK(heap.empty());
    CHECK_FALSE(heap.contains(0));
    heap.push(100000, infinity);
    heap.push(3, -infinity);
    heap.push(5, 0);
    CHECK_FALSE(heap.contains(100001));
    CHECK(heap.pop().id == 3);
    CHECK(heap.pop().id == 5);
    CHECK(heap.pop().id == 100000);
    CHECK(heap.empty());
}
