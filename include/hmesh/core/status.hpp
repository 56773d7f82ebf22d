/// \file
/// Status: how every function that can meet bad input says so.
///
/// hmesh throws nothing of its own, prints nothing and aborts nothing; std::bad_alloc passes through (without exceptions, no
/// memory ends the program). A Status is a small value that allocates nothing; message() (core/message.hpp)
/// makes a sentence of it.
#ifndef HMESH_CORE_STATUS_HPP
#define HMESH_CORE_STATUS_HPP

#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// What kind of thing went wrong.
enum class Errc : std::uint8_t {
    ok,                   ///< all is well
    invalid_argument,     ///< a pointer, size, stride or option that means nothing
    image_too_large,      ///< more pixels or a longer side than the library addresses
    target_out_of_range,  ///< a target that the image cannot hold, or a PSNR that no mesh of it reached
    not_finite,           ///< NaN or infinity where a number is needed
    write_failed,         ///< a sink refused bytes
    cancelled,            ///< the progress callback said stop
};

/// The outcome of a function that checks its input. Converts to true when all is well.
struct [[nodiscard]] Status {
    Errc code = Errc::ok;   ///< the kind of failure
    const char* what = "";  ///< a sentence without numbers, in static memory
    double value = 0;       ///< the number that offended
    double limit = 0;       ///< the bound that it missed; both 0 where the sentence says it all

    /// All is well.
    constexpr Status() noexcept = default;
    /// A failure; numbers of any arithmetic type, of which 64-bit integers keep 53 bits.
    template <class Value = int, class Limit = int>
    constexpr Status(Errc kind, const char* sentence, Value offending = 0, Limit bound = 0) noexcept
        : code(kind), what(sentence), value(static_cast<double>(offending)), limit(static_cast<double>(bound)) {}

    constexpr explicit operator bool() const noexcept { return code == Errc::ok; }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_STATUS_HPP
