/// \file
/// HMESH_ASSERT: the check for wrong use of the library by its caller.
///
/// Wrong *input* (sizes, targets, pixels) never asserts: it is reported by a Status. Define HMESH_ASSERT before the first
/// include of hmesh to send failures elsewhere; that changes no type and no layout.
#ifndef HMESH_CORE_ASSERT_HPP
#define HMESH_CORE_ASSERT_HPP

#ifndef HMESH_ASSERT
#include <cassert>
/// Fails where the condition is false, which is a mistake of the caller. By default it is assert(), hence nothing with NDEBUG.
#define HMESH_ASSERT(condition) assert(condition)
#endif

#endif  // HMESH_CORE_ASSERT_HPP
