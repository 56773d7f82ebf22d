// hmesh - Status: how every function that can meet bad input says so.
//
// hmesh throws nothing, prints nothing and never aborts; a Status is a small value that allocates nothing.
#ifndef HMESH_CORE_STATUS_HPP
#define HMESH_CORE_STATUS_HPP

#include <cstdint>

namespace hmesh {

// What kind of thing went wrong.
enum class Errc : std::uint8_t {
    ok,
    invalid_argument,     // a pointer, size, stride or option that means nothing
    image_too_large,      // more pixels or a longer side than the library addresses
    target_out_of_range,  // a target that the image cannot hold, or a PSNR that no mesh of it reached
    not_finite,           // NaN or infinity where a number is needed
    write_failed,         // a sink refused bytes
    cancelled,            // the progress callback said stop
};

// What happened: `what` is a static sentence, `value` the offending value and `limit` the bound that it missed (0 where
// the sentence says it all, as that of a fraction, which an integer would not tell). Converts to true when all is well.
struct [[nodiscard]] Status {
    Errc code = Errc::ok;
    const char* what = "";
    std::int64_t value = 0;
    std::int64_t limit = 0;

    constexpr explicit operator bool() const noexcept { return code == Errc::ok; }
};

}  // namespace hmesh

#endif  // HMESH_CORE_STATUS_HPP
