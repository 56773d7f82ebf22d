/// \file
/// UndoArray: an array that can return to an earlier state.
///
/// The building block of transactions: while recording, edit(i) first notes the old value of element i; rollback() restores the
/// noted values in reverse order and drops elements added since the mark, so that every byte is as it was. A note costs one
/// copy of the element; outside a transaction edit() is a plain access. Marks nest: the latest is rolled back or kept first.
#ifndef HMESH_MESH_UNDO_ARRAY_HPP
#define HMESH_MESH_UNDO_ARRAY_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// An array of trivially copyable elements that can return to an earlier state.
template <class T>
class UndoArray {
  public:
    /// A state to return to, made by mark().
    struct Mark {
        std::size_t notes = 0;  ///< number of notes
        std::size_t size = 0;   ///< number of elements
    };

    [[nodiscard]] std::size_t size() const noexcept { return values_.size(); }              ///< number of elements
    [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return values_[i]; }  ///< element i, for reading

    [[nodiscard]] const Array<T>& values() const noexcept { return values_; }  ///< all elements, for reading

    /// Element i for writing; its old value is noted while recording. The reference is valid until the next push_back().
    [[nodiscard]] T& edit(std::size_t i) {
        if (recording_) note(i);
        return values_[i];
    }
    /// Element i for writing, never undone: for building a mesh, or for writing distinct elements from many threads.
    [[nodiscard]] T& raw(std::size_t i) noexcept { return values_[i]; }

    void push_back(const T& value) { values_.push_back(value); }  ///< adds an element; undone by dropping it
    void reserve(std::size_t n) { values_.reserve(n); }           ///< memory for n elements
    /// Sets the number of elements, outside a transaction only. Memory is kept.
    void resize(std::size_t n) {
        HMESH_ASSERT(!recording_);
        values_.resize(n);
    }
    /// The same; new elements must be written, by raw(), before they are read.
    void resize_raw(std::size_t n) {
        HMESH_ASSERT(!recording_);
        values_.resize_raw(n);
    }

    /// Begins a transaction, or one within it: from here on old values are noted.
    [[nodiscard]] Mark mark() noexcept {
        recording_ = true;
        return {notes_.size(), values_.size()};
    }
    /// Returns all elements and the size to what they were at that mark. O(edits since).
    HMESH_NEVER_INLINE void rollback(const Mark& to) {
        while (notes_.size() > to.notes) {
            values_[notes_.back().index] = notes_.back().old;
            notes_.pop_back();
        }
        values_.resize(to.size);
    }
    /// Ends the outermost transaction: forgets all notes. The elements stay as they are.
    void stop_recording() noexcept {
        notes_.clear();
        recording_ = false;
    }

  private:
    struct Note {
        T old;
        std::uint32_t index;
    };
    // Written where it stays: a copy of all its bytes would wait for those of the index to be stored.
    HMESH_NEVER_INLINE void note(std::size_t i) {
        Note& to = notes_.push_raw();
        to.old = values_[i];
        to.index = static_cast<std::uint32_t>(i);
    }

    Array<T> values_;
    Array<Note> notes_;
    bool recording_ = false;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_UNDO_ARRAY_HPP
