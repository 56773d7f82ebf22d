/// \file
/// Array: a row of plain elements that grows, as std::vector is one.
///
/// A std::vector is compiled for each type of elements, some 40 functions of it, and a call of mesh_image() takes 50 types.
/// Elements that are copied as bytes need not be known to what makes room for them: an Array leaves that to one class, which
/// takes a sixth off the compile time of the call. It has those of std::vector's members that are used here, and converts from
/// and to a std::vector, by a copy.
///
/// The largest are read at random, as tables of moments are, 16 bytes for each of up to 2^22 px of 8-bit RGB. In pages of 4 KiB
/// the processor knows where few of them are, and the system hands out each by itself at its first use. Linux has pages of 2 MiB
/// where it is asked for them (madvise(2)), unless /sys/kernel/mm/transparent_hugepage/enabled is "never".
#ifndef HMESH_CORE_ARRAY_HPP
#define HMESH_CORE_ARRAY_HPP

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// The memory of an Array, in bytes, for elements of this alignment.
template <std::size_t alignment>
class ArrayMemory {
  public:
    ArrayMemory() noexcept = default;
    HMESH_PATCHWISE ArrayMemory(const ArrayMemory& other) { append(other.data_, other.used_); }
    ArrayMemory(ArrayMemory&& other) noexcept { swap(other); }
    HMESH_PATCHWISE ArrayMemory& operator=(const ArrayMemory& other) {
        if (this != &other) *this = ArrayMemory(other);
        return *this;
    }
    HMESH_PATCHWISE ArrayMemory& operator=(ArrayMemory&& other) noexcept {
        ArrayMemory moved(std::move(other));
        swap(moved);
        return *this;
    }
    HMESH_PATCHWISE ~ArrayMemory() { free(data_, room_); }

  protected:
    /// Makes room for so many bytes in all, or for twice as many as there were.
    HMESH_NEVER_INLINE HMESH_PATCHWISE void make_room(std::size_t bytes) {
        if (bytes <= room_) return;
        std::size_t room = std::max(bytes, 2 * room_);
        if constexpr (large_page > 0) {  // whole ones, for what is beyond the last would be handed out in small ones
            if (room >= large_page) room = std::max(room, (room + large_page - 1) / large_page * large_page);
        }
        void* const data = allocate(room);
        if (used_ > 0) std::memcpy(data, data_, used_);
        free(std::exchange(data_, static_cast<unsigned char*>(data)), std::exchange(room_, room));
    }
    /// Puts a copy of bytes that are not of this memory in at a place, and moves what follows.
    HMESH_NEVER_INLINE HMESH_PATCHWISE void put_in(std::size_t place, const void* from, std::size_t bytes) {
        if (bytes == 0) return;
        make_room(used_ + bytes);
        std::memmove(data_ + place + bytes, data_ + place, used_ - place);
        std::memcpy(data_ + place, from, bytes);
        used_ += bytes;
    }
    void append(const void* from, std::size_t bytes) { put_in(used_, from, bytes); }
    void swap(ArrayMemory& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(used_, other.used_);
        std::swap(room_, other.room_);
    }

    unsigned char* data_ = nullptr;
    std::size_t used_ = 0, room_ = 0;  ///< bytes

  private:
    // Memory of this size is aligned to it, so that Linux may have pages of this size there; 0: of no size.
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    static constexpr std::size_t large_page = std::size_t{1} << 21;
    static_assert(alignment <= large_page);
#else
    static constexpr std::size_t large_page = 0;
#endif

    static void* allocate(std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
        if (bytes >= large_page) {
            void* const data = ::operator new (bytes, std::align_val_t{large_page});
            static_cast<void>(::madvise(data, bytes, MADV_HUGEPAGE));  // advice: none may be taken
            return data;
        }
#endif
        if constexpr (alignment > __STDCPP_DEFAULT_NEW_ALIGNMENT__) return ::operator new (bytes, std::align_val_t{alignment});
        else return ::operator new(bytes);  // aligned memory costs more, where it is not needed
    }
    static void free(void* data, [[maybe_unused]] std::size_t bytes) noexcept {
        if constexpr (large_page > 0) {
            if (bytes >= large_page) return ::operator delete (data, std::align_val_t{large_page});
        }
        if constexpr (alignment > __STDCPP_DEFAULT_NEW_ALIGNMENT__) ::operator delete (data, std::align_val_t{alignment});
        else ::operator delete(data);
    }
};

}  // namespace detail

/// Says of elements that they are not initialised: they are to be written before they are read.
struct Raw {
    constexpr explicit Raw(int) noexcept {}  ///< not from {}, which is a value of elements
};
inline constexpr Raw raw{0};  ///< the only value of Raw

/// A row of trivially copyable elements that grows. Members are those of std::vector, but that iterators are pointers, that
/// erase() takes the last elements only, and that insert() takes none of the array's own.
template <class T>
class Array : private detail::ArrayMemory<(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__ ? 1 : alignof(T))> {
    static_assert(std::is_trivially_copyable_v<T>, "elements are copied as bytes");
    using Memory = detail::ArrayMemory<(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__ ? 1 : alignof(T))>;
    using Memory::append, Memory::data_, Memory::make_room, Memory::put_in, Memory::room_, Memory::used_;

  public:
    /// The type of the elements.
    using value_type = T;  // NOLINT(readability-identifier-naming): std's name

    /// No elements.
    Array() noexcept = default;
    /// n elements T().
    explicit Array(std::size_t n) { resize(n); }
    /// n elements that are not initialised.
    Array(std::size_t n, Raw) { resize_raw(n); }
    /// n times a value.
    Array(std::size_t n, const T& value) { resize(n, value); }
    /// These values.
    Array(std::initializer_list<T> values) { append(values.begin(), values.size() * sizeof(T)); }
    /// Copies of [first, last).
    Array(const T* first, const T* last) { assign(first, last); }
    /// The elements of a vector.
    Array(const std::vector<T>& values)  // NOLINT(google-explicit-constructor)
        : Array(values.data(), values.data() + values.size()) {}
    /// A vector of the elements.
    operator std::vector<T>() const { return std::vector<T>(begin(), end()); }  // NOLINT(google-explicit-constructor)

    [[nodiscard]] std::size_t size() const noexcept { return used_ / sizeof(T); }               ///< number of elements
    [[nodiscard]] bool empty() const noexcept { return used_ == 0; }                            ///< whether there are none
    [[nodiscard]] T* data() noexcept { return reinterpret_cast<T*>(data_); }                    ///< the first element
    [[nodiscard]] const T* data() const noexcept { return reinterpret_cast<const T*>(data_); }  ///< the first element
    [[nodiscard]] T* begin() noexcept { return data(); }                                        ///< the first element
    [[nodiscard]] const T* begin() const noexcept { return data(); }                            ///< the first element
    [[nodiscard]] T* end() noexcept { return reinterpret_cast<T*>(data_ + used_); }             ///< behind the last element
    /// Behind the last element.
    [[nodiscard]] const T* end() const noexcept { return reinterpret_cast<const T*>(data_ + used_); }
    /// Element i < size(), which is checked where std::vector's are.
    [[nodiscard]] T& operator[](std::size_t i) noexcept {
#if defined(_GLIBCXX_ASSERTIONS)
        HMESH_ASSERT(i < size());
#endif
        return data()[i];
    }
    /// Element i < size(), likewise.
    [[nodiscard]] const T& operator[](std::size_t i) const noexcept {
#if defined(_GLIBCXX_ASSERTIONS)
        HMESH_ASSERT(i < size());
#endif
        return data()[i];
    }
    [[nodiscard]] T& front() noexcept { return (*this)[0]; }                      ///< the first element
    [[nodiscard]] const T& front() const noexcept { return (*this)[0]; }          ///< the first element
    [[nodiscard]] T& back() noexcept { return (*this)[size() - 1]; }              ///< the last element
    [[nodiscard]] const T& back() const noexcept { return (*this)[size() - 1]; }  ///< the last element

    /// Adds an element.
    void push_back(const T& value) {
        if (used_ + sizeof(T) <= room_) {
            new (data_ + used_) T(value);
            used_ += sizeof(T);
            return;
        }
        const T copy = value;  // which may be one of the elements
        append(&copy, sizeof(T));
    }
    /// Adds an element that is not initialised, to be written before it is read.
    [[nodiscard]] T& push_raw() {
        if (used_ + sizeof(T) > room_) make_room(used_ + sizeof(T));
        used_ += sizeof(T);
        return end()[-1];
    }
    /// Adds an element made of these parts.
    template <class... Parts>
    void emplace_back(const Parts&... parts) {
        push_back(T(parts...));
    }
    void pop_back() noexcept { used_ -= sizeof(T); }           ///< drops the last element
    void reserve(std::size_t n) { make_room(n * sizeof(T)); }  ///< makes room for n elements
    /// n elements; new ones are T().
    void resize(std::size_t n) {
        reserve(n);
        if constexpr (std::is_arithmetic_v<T>) {  // in one call, for many arrays are made where compilers go by size
            if (n > size()) std::memset(data_ + used_, 0, n * sizeof(T) - used_);
        } else {
            for (std::size_t i = size(); i < n; ++i) new (data() + i) T();
        }
        used_ = n * sizeof(T);
    }
    /// n elements; new ones are not initialised: to be written before they are read.
    void resize_raw(std::size_t n) {
        reserve(n);
        used_ = n * sizeof(T);
    }
    /// n elements; new ones have this value, which is none of the elements.
    void resize(std::size_t n, const T& value) {
        reserve(n);
        for (std::size_t i = size(); i < n; ++i) new (data() + i) T(value);
        used_ = n * sizeof(T);
    }
    /// n times a value, which is none of the elements.
    void assign(std::size_t n, const T& value) {
        used_ = 0;
        resize(n, value);
    }
    /// Copies of [first, last).
    void assign(const T* first, const T* last) {
        used_ = 0;
        append(first, static_cast<std::size_t>(last - first) * sizeof(T));
    }
    /// Copies of [first, last) before a place.
    void insert(const T* place, const T* first, const T* last) {
        put_in(static_cast<std::size_t>(place - begin()) * sizeof(T), first, static_cast<std::size_t>(last - first) * sizeof(T));
    }
    /// A value before a place.
    void insert(const T* place, const T& value) { insert(place, &value, &value + 1); }
    /// Drops the elements from `first` to the last one.
    void erase(const T* first, [[maybe_unused]] const T* last) noexcept {
        HMESH_ASSERT(last == end());
        used_ = static_cast<std::size_t>(first - begin()) * sizeof(T);
    }
    void clear() noexcept { used_ = 0; }                       ///< drops all elements; memory is kept
    void swap(Array& other) noexcept { Memory::swap(other); }  ///< exchanges the elements

    /// The same elements.
    [[nodiscard]] friend bool operator==(const Array& a, const Array& b) {
        return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
    }
    /// Other elements.
    [[nodiscard]] friend bool operator!=(const Array& a, const Array& b) { return !(a == b); }
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_ARRAY_HPP
