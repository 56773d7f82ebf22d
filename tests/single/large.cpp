// The single header of images that are not in memory is the first and only one here: it brings the other.
#include "../../single_include/hmesh_large.hpp"

#include <cstddef>
#include <cstdint>

bool large_is_there();  // alone.cpp

bool large_is_there() {
    const std::uint8_t samples[] = {1, 2, 3, 4};
    const hmesh::ViewReader<std::uint8_t, 1> view(hmesh::ImageView<std::uint8_t, 1>{samples, 2, 2, 0});
    std::uint8_t last = 0;
    return view({1, 1, 1, 1}, &last, std::ptrdiff_t{1}) && last == 4 && check(view.reader());
}
