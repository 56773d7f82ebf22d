// hmesh tests - same_bytes(): whether two rows of elements, meshes, reports or results are the same to the bit.
#ifndef HMESH_TESTS_SAME_BYTES_HPP
#define HMESH_TESTS_SAME_BYTES_HPP

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hmesh/mesh/mesh.hpp"
#include "hmesh/result.hpp"

namespace hmesh_test {

template <class Row, class Element = typename Row::value_type>
bool same_bytes(const Row& a, const Row& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Element)) == 0);
}

inline bool same_bytes(const hmesh::Mesh& a, const hmesh::Mesh& b) {
    return a.channels == b.channels && a.width == b.width && a.height == b.height && a.peak == b.peak &&
           a.premultiplied == b.premultiplied && a.samples == b.samples && same_bytes(a.positions, b.positions) &&
           same_bytes(a.colors, b.colors) && a.faces == b.faces;
}

inline bool same_bytes(const hmesh::Report& a, const hmesh::Report& b) {
    const auto number = [](double x) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &x, sizeof bits);
        return bits;
    };
    bool same = a.vertices == b.vertices && a.faces == b.faces && number(a.energy) == number(b.energy) &&
                number(a.psnr) == number(b.psnr) && number(a.max_error) == number(b.max_error) &&
                a.stages.size() == b.stages.size();
    for (std::size_t k = 0; same && k < a.stages.size(); ++k)
        same = std::strcmp(a.stages[k].name, b.stages[k].name) == 0 && a.stages[k].vertices == b.stages[k].vertices &&
               number(a.stages[k].energy) == number(b.stages[k].energy) && number(a.stages[k].psnr) == number(b.stages[k].psnr) &&
               a.stages[k].iterations == b.stages[k].iterations && number(a.stages[k].residual) == number(b.stages[k].residual);
    return same;
}

inline bool same_bytes(const hmesh::Result& a, const hmesh::Result& b) {
    return a.status.code == b.status.code && same_bytes(a.mesh, b.mesh) && same_bytes(a.report, b.report);
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_SAME_BYTES_HPP
