// The pages of a memory that several instances share, one a thread.
#ifndef HMESH_BINDING_PAGES_HPP
#define HMESH_BINDING_PAGES_HPP

#include <atomic>
#include <cstddef>

namespace binding {

// How many there are, as the last instance that took memory knows them.
inline std::atomic<std::size_t> pages{0};

// Makes the instance that calls know all pages. Engines tell an instance late that another one has grown the memory (V8, seen
// in node 20): until then memory.copy traps beyond the size that it knows, and it grows memory that has grown.
inline void catch_up() noexcept {
    if (__builtin_wasm_memory_size(0) != pages) __builtin_wasm_memory_grow(0, 0);
}

}  // namespace binding

#endif  // HMESH_BINDING_PAGES_HPP
