// The single header survives macros with the names of things in it, and leaves them as they were.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define Status int

#include "../../single_include/hmesh.hpp"

Status macros_are_back();
Status macros_are_back() { return max(min(3, 4), 1); }
static_assert(std::is_same_v<decltype(macros_are_back()), int>, "Status is the macro");
