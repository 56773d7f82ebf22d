#include "hmesh/core/array.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"

using hmesh::kit::Array;

namespace {

struct Place {
    double x = 7;
    std::uint32_t number = 9;
    friend bool operator==(const Place& a, const Place& b) { return a.x == b.x && a.number == b.number; }
};
struct alignas(64) Wide {
    double lanes[8] = {};
};

}  // namespace

TEST_CASE("an Array is a std::vector under all of its edits") {
    hmesh::kit::Random random(4);
    Array<std::uint32_t> array;
    std::vector<std::uint32_t> vector;
    for (int round = 0; round < 20000; ++round) {
        const auto value = static_cast<std::uint32_t>(random.below(1000));
        const std::size_t n = random.below(40), place = random.below(vector.size() + 1);
        const std::vector<std::uint32_t> some(random.below(5), value);
        const auto at = static_cast<std::ptrdiff_t>(place);
        switch (random.below(13)) {
            case 0: array.resize(n), vector.resize(n); break;
            case 1: array.resize(n, value), vector.resize(n, value); break;
            case 2: array.assign(n, value), vector.assign(n, value); break;
            case 3: array.assign(some.data(), some.data() + some.size()), vector.assign(some.begin(), some.end()); break;
            case 4: array.reserve(n), vector.reserve(n); break;
            case 5: array.insert(array.begin() + place, value), vector.insert(vector.begin() + at, value); break;
            case 6:
                array.insert(array.begin() + place, some.data(), some.data() + some.size());
                vector.insert(vector.begin() + at, some.begin(), some.end());
                break;
            case 7:
                array.erase(std::remove(array.begin(), array.end(), value), array.end());
                vector.erase(std::remove(vector.begin(), vector.end(), value), vector.end());
                break;
            case 8:
                if (random.below(9) == 0) array.clear(), vector.clear();
                break;
            case 9:
                if (!vector.empty()) array.pop_back(), vector.pop_back();
                break;
            case 10: array.emplace_back(value), vector.emplace_back(value); break;
            case 11: array.push_raw() = value, vector.push_back(value); break;
            default: array.push_back(value), vector.push_back(value);
        }
        REQUIRE(array == vector);
        REQUIRE(array.empty() == vector.empty());
        if (!vector.empty()) REQUIRE((array.front() == vector.front() && array.back() == vector.back()));
    }
}

TEST_CASE("an element that is added may be one of the Array's own") {
    Array<Place> array{{1, 2}};
    for (int k = 0; k < 100; ++k) array.push_back(array.front());
    CHECK((array.size() == 101 && array.back() == Place{1, 2}));
}

TEST_CASE("new elements have their type's default values, and stand where their type must stand") {
    CHECK((Array<Place>(3) == Array<Place>{{7, 9}, {7, 9}, {7, 9}}));
    Array<Wide> wide(1);
    for (int k = 0; k < 9; ++k) {
        REQUIRE(reinterpret_cast<std::uintptr_t>(wide.data()) % 64 == 0);
        wide.push_back(Wide());
    }
    CHECK((Array<Place>(3, {}) == Array<Place>(3)));  // {} is a value
    CHECK(Array<int>(3, hmesh::kit::raw).size() == 3);
}

TEST_CASE("copies are of their own, moves take all, and vectors become Arrays and come back") {
    static_assert(std::is_nothrow_move_assignable_v<Array<Place>> && std::is_nothrow_move_constructible_v<Array<Place>>);
    static_assert(!std::is_nothrow_copy_assignable_v<Array<Place>>);  // there may be no memory for it
    Array<int> array{1, 2, 3};
    Array<int> copy = array;
    copy[1] = 9;
    CHECK((array == Array<int>{1, 2, 3} && copy != array));
    const Array<int> moved = std::move(copy);
    CHECK((moved == Array<int>{1, 9, 3}));
    array = moved;
    array.swap(copy = Array<int>());
    CHECK((array.empty() && copy == moved));
    const std::vector<int> vector = moved;
    CHECK((vector == std::vector<int>{1, 9, 3}));
    CHECK(Array<int>(vector) == moved);
    const Array<int> none;
    CHECK((none.begin() == none.end() && Array<int>(none) == none && std::vector<int>(none).empty()));
}

TEST_CASE("memory that grows to large pages and on keeps the elements, and its size says how it is given back") {
    constexpr std::size_t page = std::size_t{1} << 21;
    for (const std::size_t first : {page / 4 - 1, page / 4, page / 4 + 1, page / 2}) {  // elements of 4 bytes
        Array<std::uint32_t> array(first);
        for (std::size_t i = 0; i < first; ++i) array[i] = static_cast<std::uint32_t>(i);
        array.push_back(7);
        const Array<std::uint32_t> copy = array;
        array.resize(3 * page / 4, 5);
        std::size_t other = 0;
        for (std::size_t i = 0; i < first; ++i) other += std::size_t{array[i] != i} + std::size_t{copy[i] != i};
        CHECK(other == 0);
        CHECK((array[first] == 7 && copy.back() == 7 && array.back() == 5 && copy.size() == first + 1));
#if defined(__linux__)
        CHECK(reinterpret_cast<std::uintptr_t>(array.data()) % page == 0);
#endif
        array = Array<std::uint32_t>{1};
        CHECK(array.size() == 1);
    }
    Array<Wide> wide(page / sizeof(Wide) - 1);
    for (int k = 0; k < 9; ++k) wide.push_back(Wide());
    CHECK(reinterpret_cast<std::uintptr_t>(wide.data()) % sizeof(Wide) == 0);
}
