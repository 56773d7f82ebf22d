/// \file
/// IndexedHeap: a binary min-heap of ids whose keys can change.
///
/// Ids are small integers, each at most once in the heap. push, update, pop and erase cost O(log n); contains and top O(1).
/// Memory follows the largest id. Equal keys leave in the order of their ids, so that results never depend on the history of
/// the heap.
#ifndef HMESH_EDIT_INDEXED_HEAP_HPP
#define HMESH_EDIT_INDEXED_HEAP_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A binary min-heap of ids whose keys can change.
class IndexedHeap {
  public:
    using Id = std::uint32_t;  ///< a small integer
    /// An id with its key.
    struct Entry {
        double key;  ///< not NaN
        Id id;       ///< breaks ties between equal keys
    };

    [[nodiscard]] bool empty() const noexcept { return heap_.empty(); }       ///< whether no id is in the heap
    [[nodiscard]] std::size_t size() const noexcept { return heap_.size(); }  ///< number of ids in the heap
    [[nodiscard]] bool contains(Id id) const noexcept { return id < slot_of_.size() && slot_of_[id] != absent; }  ///< O(1)
    /// The key of an id that is in the heap.
    [[nodiscard]] double key(Id id) const noexcept {
        HMESH_ASSERT(contains(id));
        return heap_[slot_of_[id]].key;
    }
    /// The entry with the smallest key; the heap must not be empty.
    [[nodiscard]] Entry top() const noexcept {
        HMESH_ASSERT(!empty());
        return heap_.front();
    }

    /// Inserts `id`, or changes its key when it is in the heap already. The key must not be NaN.
    void push(Id id, double key) {
        HMESH_ASSERT(key == key);
        while (id >= slot_of_.size()) slot_of_.push_back(absent);
        if (slot_of_[id] == absent) {
            slot_of_[id] = static_cast<Slot>(heap_.size());
            heap_.push_back({key, id});
            sift_up(heap_.size() - 1);
        } else {
            update(id, key);
        }
    }

    /// Changes the key of an id that is in the heap. The key must not be NaN.
    void update(Id id, double key) {
        HMESH_ASSERT(contains(id) && key == key);
        const std::size_t slot = slot_of_[id];
        heap_[slot].key = key;
        sift_down(sift_up(slot));
    }

    /// Removes and returns top().
    Entry pop() {
        const Entry first = top();
        erase(first.id);
        return first;
    }

    /// Removes an id that is in the heap.
    void erase(Id id) {
        HMESH_ASSERT(contains(id));
        const std::size_t slot = slot_of_[id];
        slot_of_[id] = absent;
        const Entry last = heap_.back();
        heap_.pop_back();
        if (slot == heap_.size()) return;
        place(slot, last);
        sift_down(sift_up(slot));
    }

    /// Removes all ids. O(size()), whatever ids were in the heap before.
    void clear() noexcept {
        for (const Entry& entry : heap_) slot_of_[entry.id] = absent;
        heap_.clear();
    }

  private:
    using Slot = std::uint32_t;
    static constexpr Slot absent = 0xffffffffU;

    static bool before(const Entry& a, const Entry& b) noexcept { return a.key < b.key || (a.key == b.key && a.id < b.id); }
    void place(std::size_t slot, Entry entry) noexcept {
        heap_[slot] = entry;
        slot_of_[entry.id] = static_cast<Slot>(slot);
    }
    std::size_t sift_up(std::size_t slot) noexcept {
        const Entry entry = heap_[slot];
        while (slot > 0 && before(entry, heap_[(slot - 1) / 2])) {
            place(slot, heap_[(slot - 1) / 2]);
            slot = (slot - 1) / 2;
        }
        place(slot, entry);
        return slot;
    }
    void sift_down(std::size_t slot) noexcept {
        const Entry entry = heap_[slot];
        for (;;) {
            std::size_t child = 2 * slot + 1;
            if (child >= heap_.size()) break;
            if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
            if (!before(heap_[child], entry)) break;
            place(slot, heap_[child]);
            slot = child;
        }
        place(slot, entry);
    }

    Array<Entry> heap_;
    Array<Slot> slot_of_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_INDEXED_HEAP_HPP
