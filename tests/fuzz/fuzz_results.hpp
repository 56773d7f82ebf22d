// hmesh tests - demand_same(): whether two runs of mesh_image() came to the same, for fuzzers.
#ifndef HMESH_TESTS_FUZZ_FUZZ_RESULTS_HPP
#define HMESH_TESTS_FUZZ_FUZZ_RESULTS_HPP

#include <cmath>
#include <cstring>
#include <vector>

#include "fuzz_input.hpp"
#include "hmesh/result.hpp"

namespace hmesh_test {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Or neither is a number, as in a status that refuses one.
inline bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

inline void demand_same(const hmesh::Result& a, const hmesh::Result& b) {
    demand(a.status.code == b.status.code && a.status.what == b.status.what && same_number(a.status.value, b.status.value) &&
               same_number(a.status.limit, b.status.limit),
           "the same input gives the same status");
    demand(same_bytes(a.mesh.positions, b.mesh.positions) && same_bytes(a.mesh.colors, b.mesh.colors) &&
               a.mesh.faces == b.mesh.faces,
           "the same input gives the same mesh");
    demand(a.report.energy == b.report.energy && a.report.psnr == b.report.psnr, "the same input gives the same report");
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_RESULTS_HPP
