#include "hmesh/mesh/undo_array.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

#include "hmesh/core/random.hpp"

using Array = hmesh::kit::UndoArray<int>;

namespace {

void edit_at_random(Array& array, hmesh::kit::Random& random, int count) {
    for (int i = 0; i < count; ++i) {
        if (array.size() == 0 || random.below(4) == 0) array.push_back(static_cast<int>(random.below(1000)));
        else array.edit(random.below(array.size())) = static_cast<int>(random.below(1000));
    }
}

}  // namespace

TEST_CASE("UndoArray: rollback restores every element and the size, commit keeps them, at any depth") {
    hmesh::kit::Random random(2);
    Array array;
    for (int round = 0; round < 300; ++round) {
        edit_at_random(array, random, 5);
        // A stack of transactions; each ends by keeping or by rolling back, the inner first.
        std::vector<Array::Mark> marks;
        std::vector<std::vector<int>> states;
        for (std::size_t depth = random.below(4) + 1; depth > 0; --depth) {
            marks.push_back(array.mark());
            states.push_back(array.values());
            edit_at_random(array, random, static_cast<int>(random.below(30)));
        }
        while (!marks.empty()) {
            if (random.below(2) == 0) {
                array.rollback(marks.back());
                CHECK(array.values() == states.back());
            }
            marks.pop_back();
            states.pop_back();
            if (!marks.empty()) edit_at_random(array, random, static_cast<int>(random.below(10)));
        }
        array.stop_recording();
        if (array.size() > 200) array = Array();
    }
}

TEST_CASE("UndoArray: the outermost rollback undoes what inner transactions kept") {
    Array array;
    for (int i = 0; i < 4; ++i) array.push_back(i);
    const std::vector<int> before = array.values();
    const Array::Mark outer = array.mark();
    array.edit(1) = 10;
    const Array::Mark inner = array.mark();
    array.edit(1) = 20;
    array.push_back(30);
    array.edit(4) = 31;
    CHECK(inner.size == 4);
    CHECK(array.values() == std::vector<int>{0, 20, 2, 3, 31});
    array.rollback(outer);
    array.stop_recording();
    CHECK(array.values() == before);
}

TEST_CASE("UndoArray: edits made outside a transaction stay") {
    Array array;
    array.resize(3);
    CHECK(array.values() == std::vector<int>{0, 0, 0});
    array.edit(0) = 1;
    array.raw(1) = 2;
    const Array::Mark mark = array.mark();
    array.edit(2) = 3;
    array.rollback(mark);
    array.stop_recording();
    array.edit(2) = 4;
    const Array::Mark later = array.mark();
    array.rollback(later);
    array.stop_recording();
    CHECK(array.values() == std::vector<int>{1, 2, 4});
    CHECK(array[2] == 4);
}
