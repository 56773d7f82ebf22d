// hmesh tests - whether sanitizers watch, under which all takes ten to twenty times as long. They look for wrong accesses and not
// for wrong results, so that tests that try each of thousands of places, or many seeds, then try some, and those that do nothing
// but weigh the quality of many meshes are skipped.
#ifndef HMESH_TESTS_TEST_SANITIZED_HPP
#define HMESH_TESTS_TEST_SANITIZED_HPP

#include <cstddef>

namespace hmesh_test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
#else
inline constexpr bool sanitized = false;
#endif

// Every how many of its places such a test tries: all or, under sanitizers, every n-th.
inline constexpr std::size_t stride_if_sanitized(std::size_t n) { return sanitized ? n : 1; }

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_SANITIZED_HPP
