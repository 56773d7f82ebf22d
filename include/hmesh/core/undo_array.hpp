/// \file
/// UndoArray: an array that can return to an earlier state.
///
/// The building block of transactions: while recording, edit(i) first notes the old value of element i. rollback() undoes
/// the notes in reverse order and drops elements added since the mark, so every byte is as it was. A note costs one copy
/// of the element; outside a transaction edit() is a plain access. Marks nest: roll back or keep the latest first.
#ifndef HMESH_CORE_UNDO_ARRAY_HPP
#define HMESH_CORE_UNDO_ARRAY_HPP

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "hmesh/core/assert.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

template <class T>
class UndoArray {
    static_assert(std::is_trivially_copyable_v<T>, "old values are restored by plain copies");

  public:
    struct Mark {
        std::size_t notes = 0;
        std::size_t size = 0;
    };

    [[nodiscard]] std::size_t size() const noexcept { return values_.size(); }
    [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return values_[i]; }
    [[nodiscard]] const std::vector<T>& values() const noexcept { return values_; }

    /// Element i for writing. The reference holds until the next push_back.
    [[nodiscard]] T& edit(std::size_t i) {
        if (recording_) notes_.push_back({values_[i], static_cast<std::uint32_t>(i)});
        return values_[i];
    }
    /// Element i for writing where nothing will ever be undone (building a mesh, distinct elements from many threads).
    [[nodiscard]] T& raw(std::size_t i) noexcept { return values_[i]; }

    void push_back(const T& value) { values_.push_back(value); }
    void reserve(std::size_t n) { values_.reserve(n); }
    /// Outside a transaction only; what was reserved stays.
    void resize(std::size_t n) {
        HMESH_ASSERT(!recording_);
        values_.resize(n);
    }

    /// Begins a transaction, or one within it: from here on old values are noted.
    [[nodiscard]] Mark mark() noexcept {
        recording_ = true;
        return {notes_.size(), values_.size()};
    }
    /// Brings all elements and the size back to what they were at that mark. O(edits since).
    void rollback(const Mark& to) {
        while (notes_.size() > to.notes) {
            values_[notes_.back().index] = notes_.back().old;
            notes_.pop_back();
        }
        values_.resize(to.size);
    }
    /// Forgets all notes: the outermost transaction is over, whatever became of it.
    void stop_recording() noexcept {
        notes_.clear();
        recording_ = false;
    }

  private:
    struct Note {
        T old;
        std::uint32_t index;
    };
    std::vector<T> values_;
    std::vector<Note> notes_;
    bool recording_ = false;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_UNDO_ARRAY_HPP
