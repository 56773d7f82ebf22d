#include "hmesh/core/function_ref.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

using hmesh::FunctionRef;

namespace {

int twice(int x) { return 2 * x; }
int thrice(int x) noexcept { return 3 * x; }

// What it gives for 5, or -1 where it refers to nothing.
int of_five(FunctionRef<int(int)> function) { return function ? function(5) : -1; }

struct Counter {
    int calls = 0;
    int operator()(int x) { return calls += x; }
};

// A FunctionRef by another name, as ParallelFor is.
struct Named : FunctionRef<int(int)> {
    using FunctionRef::FunctionRef;
};

template <class From, class Signature>
inline constexpr bool becomes = std::is_convertible_v<From, FunctionRef<Signature>>;
template <class From, class Signature>
inline constexpr bool is_assigned = std::is_assignable_v<FunctionRef<Signature>&, From>;

}  // namespace

TEST_CASE("a FunctionRef calls the lambda, object, std::function or function that it was made of") {
    int factor = 7;
    CHECK(of_five([&](int x) { return factor * x; }) == 35);
    const auto stored = [factor](int x) { return factor + x; };
    CHECK(of_five(stored) == 12);
    const std::function<int(int)> function = stored;
    CHECK(of_five(function) == 12);
    CHECK(of_five(twice) == 10);
    CHECK(of_five(&twice) == 10);
    CHECK(of_five(thrice) == 15);
    CHECK(of_five([](auto x) { return static_cast<int>(sizeof x); }) == static_cast<int>(sizeof(int)));
}

TEST_CASE("a FunctionRef made of nothing or of a null pointer says so") {
    CHECK(of_five({}) == -1);
    int (*null)(int) = nullptr;
    CHECK(of_five(null) == -1);
    CHECK_FALSE(FunctionRef<void()>());
    FunctionRef<int(int)> reference = twice;
    CHECK(reference);
    reference = {};
    CHECK_FALSE(reference);
}

TEST_CASE("a FunctionRef refers to the object and not to a copy, and so do copies of it") {
    Counter counter;
    FunctionRef<int(int)> first = counter, second = first;
    CHECK(first(2) == 2);
    CHECK(second(3) == 5);
    CHECK(counter.calls == 5);
    first = {};
    CHECK(second(1) == 6);  // it refers to the counter, not to the other reference
    Counter other;
    second = other;
    CHECK(second(4) == 4);
    CHECK(counter.calls == 6);
}

TEST_CASE("a class derived from FunctionRef is copied as one, not called through") {
    Counter counter;
    FunctionRef<int(int)> reference;
    {
        const Named named = counter;
        reference = named;
        CHECK(of_five(named) == 5);
    }
    CHECK(reference(1) == 6);
    CHECK(of_five(Named()) == -1);
}

TEST_CASE("arguments and results pass through as they are: by reference, and moved where they cannot be copied") {
    int value = 1;
    const auto same = [](int& x) -> int& { return x; };
    const FunctionRef<int&(int&)> reference = same;
    CHECK(&reference(value) == &value);
    const auto open = [](std::unique_ptr<int> box) { return std::make_unique<int>(*box + 1); };
    const FunctionRef<std::unique_ptr<int>(std::unique_ptr<int>)> moved = open;
    CHECK(*moved(std::make_unique<int>(41)) == 42);
}

TEST_CASE("where nothing is to be returned, what the callable returns is dropped") {
    Counter counter;
    const FunctionRef<void(int)> reference = counter;
    reference(3);
    CHECK(counter.calls == 3);
}

TEST_CASE("what gives another type than was asked for, takes other arguments or is no callable is refused") {
    const auto counts = [](int) { return std::size_t{1}; };
    const auto says = [](int) { return true; };
    static_assert(becomes<decltype(says), bool(int)>);
    static_assert(!becomes<decltype(counts), bool(int)>, "a count is not a yes or no");
    static_assert(!becomes<decltype(says), int(int)>);
    static_assert(becomes<decltype(counts), void(int)>);
    static_assert(!becomes<decltype(says), bool(const char*)>);
    static_assert(!becomes<decltype(says), bool(int, int)>);
    static_assert(!becomes<const Counter&, int(int)>, "its call is not const");
    static_assert(!becomes<int, int(int)> && !becomes<void*, int(int)>);
    static_assert(becomes<int (*)(int), int(int)> && becomes<int (&)(int), int(int)> && becomes<int (*)(int) noexcept, int(int)>);
    static_assert(!becomes<std::int64_t (*)(int), int(int)> && !becomes<int (*)(std::int64_t), int(int)>);
    static_assert(!becomes<FunctionRef<bool(int)>, int(int)>);
    CHECK(counts(0) == (says(0) ? 1 : 0));
}

TEST_CASE("a temporary can be passed, but not assigned: it would be gone after the statement") {
    static_assert(becomes<Counter, int(int)>);
    static_assert(!is_assigned<Counter, int(int)> && !is_assigned<const Counter, int(int)>);
    static_assert(!is_assigned<std::function<int(int)>, int(int)>);
    static_assert(is_assigned<Counter&, int(int)> && is_assigned<const std::function<int(int)>&, int(int)>);
    static_assert(is_assigned<int (*)(int), int(int)> && is_assigned<int (&)(int), int(int)>);
    static_assert(is_assigned<FunctionRef<int(int)>, int(int)> && is_assigned<const FunctionRef<int(int)>&, int(int)>);
    FunctionRef<int(int)> reference = twice;
    reference = thrice;
    CHECK(reference(2) == 6);
}

TEST_CASE("a FunctionRef is two words that are copied as bytes, and is no bool unless asked") {
    static_assert(sizeof(FunctionRef<int(int)>) == 2 * sizeof(void*));
    static_assert(std::is_trivially_copyable_v<FunctionRef<int(int)>>);
    static_assert(std::is_nothrow_default_constructible_v<FunctionRef<int(int)>>);
    static_assert(!std::is_convertible_v<FunctionRef<int(int)>, bool>);
    CHECK(std::is_constructible_v<bool, FunctionRef<int(int)>>);
}
