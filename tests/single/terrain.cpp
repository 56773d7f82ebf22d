// The single header of terrain is the first and only one here: it brings the other.
#include "../../single_include/hmesh_terrain.hpp"

#include <cstddef>

bool terrain_is_there();  // alone.cpp

bool terrain_is_there() {
    std::size_t bytes = 0;
    const auto sink = [&bytes](const void*, std::size_t size) {
        bytes += size;
        return true;
    };
    return !hmesh::write_height_stl({}, sink) && bytes == 0;
}
