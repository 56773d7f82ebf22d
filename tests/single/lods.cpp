// The single header of levels of detail is the first and only one here: it brings the other.
#include "../../single_include/hmesh_lods.hpp"

#include <cstddef>
#include <cstdint>

bool lods_are_there();  // alone.cpp

bool lods_are_there() {
    hmesh::LodOptions options;
    options.levels = 0;
    const std::uint8_t pixel = 7;
    const hmesh::Lods none = hmesh::mesh_lods(hmesh::ImageView<std::uint8_t, 1>{&pixel, 1, 1, 0}, {}, options);
    std::size_t bytes = 0;
    const auto sink = [&bytes](const void*, std::size_t size) {
        bytes += size;
        return true;
    };
    return !none.status && !hmesh::write_glb_lods({}, sink) && bytes == 0;
}
