// hmesh - check_ranges(): options held against their bounds, in one table.
#ifndef HMESH_CORE_RANGE_HPP
#define HMESH_CORE_RANGE_HPP

#include <initializer_list>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

// An option: the sentence that says what it must be, its value, and the least and the largest that are allowed.
struct Range {
    const char* what;
    double value, low, high;
};

// The first option that is out of its range as invalid_argument with the bound that it missed; what is not finite missed the upper.
[[nodiscard]] inline Status check_ranges(std::initializer_list<Range> ranges) noexcept {
    for (const Range& range : ranges)
        if (!is_within(range.value, range.low, range.high)) {
            const bool is_low = is_finite(range.value) && range.value < range.low;
            return {Errc::invalid_argument, range.what, range.value, is_low ? range.low : range.high};
        }
    return {};
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_RANGE_HPP
