#include "hmesh/core/status.hpp"

#include <doctest/doctest.h>

#include <string>
#include <type_traits>

using hmesh::Errc;
using hmesh::Status;

static_assert(sizeof(Status) <= 32, "as promised");
static_assert(std::is_trivially_copyable_v<Status> && std::is_aggregate_v<Status>);
static_assert(!std::is_convertible_v<Status, bool>, "bool only where it is asked for");
static_assert(std::is_constructible_v<bool, Status>);
static_assert(static_cast<bool>(Status{}));
static_assert(!std::is_convertible_v<Errc, int>);

TEST_CASE("a Status is true exactly when its code is ok") {
    CHECK(Status{});
    CHECK(Status{}.code == Errc::ok);
    CHECK(std::string(Status{}.what).empty());
    for (const Errc code : {Errc::invalid_argument, Errc::image_too_large, Errc::target_out_of_range, Errc::not_finite,
                            Errc::write_failed, Errc::cancelled})
        CHECK_FALSE(Status{code});
}

TEST_CASE("a Status carries its sentence, the offending value and the bound") {
    const Status status{Errc::image_too_large, "the image is too wide", 70000, 65536};
    CHECK(std::string(status.what) == "the image is too wide");
    CHECK(status.value == 70000);
    CHECK(status.limit == 65536);
}
