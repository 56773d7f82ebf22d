#include "hmesh/core/status.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

using hmesh::Errc;
using hmesh::Status;

static_assert(sizeof(Status) <= 32, "as promised");
static_assert(std::is_trivially_copyable_v<Status>);
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
        CHECK_FALSE(Status{code, "said"});
}

TEST_CASE("a Status carries its sentence, the offending value and the bound") {
    const Status status{Errc::image_too_large, "the image is too wide", 70000, 65536};
    CHECK(std::string(status.what) == "the image is too wide");
    CHECK(status.value == 70000);
    CHECK(status.limit == 65536);
}

TEST_CASE("a Status holds numbers of every arithmetic type as doubles, and 0 where none are given") {
    const Status bare{Errc::invalid_argument, "the image's data pointer is null"};
    CHECK(bare.value == 0);
    CHECK(bare.limit == 0);
    const Status mixed{Errc::target_out_of_range, "the rate is too large", 0.25F, std::uint64_t{1} << 53U};
    CHECK(mixed.value == 0.25);
    CHECK(mixed.limit == 9007199254740992.0);
    const Status negative{Errc::invalid_argument, "the width must be at least 1", std::int64_t{-7}, 1};
    CHECK(negative.value == -7);
    constexpr Status known{Errc::not_finite, "a constant", -1.5};
    static_assert(!known && known.value == -1.5 && known.limit == 0, "usable at compile time");
}

TEST_CASE("what the progress callback cancels has one status, and is ok where it was finished all the same") {
    using hmesh::kit::cancelled_by_callback;
    CHECK(cancelled_by_callback().code == Errc::cancelled);
    CHECK(std::string(hmesh::message(cancelled_by_callback()).c_str()) == "cancelled by the progress callback");
    CHECK(hmesh::kit::finished_or_cancelled(true));
    CHECK(hmesh::kit::finished_or_cancelled(false).code == Errc::cancelled);
}

TEST_CASE("a sentence has its number also where that is 0, and none where none was given") {
    CHECK(std::string(hmesh::message(Status(Errc::not_finite, "the image has a sample that is NaN, in row", 0)).c_str()) ==
          "the image has a sample that is NaN, in row (0)");
    CHECK(std::string(hmesh::message(Status(Errc::invalid_argument, "the mesh is not periodic")).c_str()) ==
          "the mesh is not periodic");
}
