// A heap for threads: Emscripten's own, which is of one thread, behind a lock. All of hmesh's memory comes from operator new.
#ifndef HMESH_BINDING_HEAP_HPP
#define HMESH_BINDING_HEAP_HPP

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "module.hpp"
#include "pages.hpp"

namespace binding {

// Held for less than a microsecond, hence no waiting but turning. Whoever holds it knows all pages.
class HeapLock {
  public:
    HeapLock() noexcept {
        while (flag_.test_and_set(std::memory_order_acquire)) {
        }
        catch_up();
    }
    HeapLock(const HeapLock&) = delete;
    HeapLock& operator=(const HeapLock&) = delete;
    ~HeapLock() { flag_.clear(std::memory_order_release); }

  private:
    static inline std::atomic_flag flag_ = ATOMIC_FLAG_INIT;
};

inline void* allocate(std::size_t size, std::size_t alignment) noexcept {
    const HeapLock lock;
    void* const bytes = std::aligned_alloc(alignment, (size + alignment) / alignment * alignment);
    pages = __builtin_wasm_memory_size(0);
    return bytes;
}
inline void release(void* bytes) noexcept {
    const HeapLock lock;
    std::free(bytes);
}
inline void* allocate_or_throw(std::size_t size, std::size_t alignment) {
    void* const bytes = allocate(size, alignment);
    if (bytes == nullptr) hmesh_out_of_memory();
    return bytes;
}

}  // namespace binding

void* operator new(std::size_t size) { return binding::allocate_or_throw(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return binding::allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* bytes) noexcept { binding::release(bytes); }
void operator delete(void* bytes, std::size_t) noexcept { binding::release(bytes); }
void operator delete(void* bytes, std::align_val_t) noexcept { binding::release(bytes); }
void operator delete(void* bytes, std::size_t, std::align_val_t) noexcept { binding::release(bytes); }

#endif  // HMESH_BINDING_HEAP_HPP
