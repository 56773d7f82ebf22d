// hmesh tests - demand_same(): whether two runs of mesh_image() came to the same, for fuzzers.
#ifndef HMESH_TESTS_FUZZ_FUZZ_RESULTS_HPP
#define HMESH_TESTS_FUZZ_FUZZ_RESULTS_HPP

#include <cmath>

#include "fuzz_input.hpp"
#include "hmesh/result.hpp"
#include "same_bytes.hpp"

namespace hmesh_test {

// Or neither is a number, as in a status that refuses one.
inline bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

inline void demand_same(const hmesh::Result& a, const hmesh::Result& b) {
    demand(a.status.code == b.status.code && a.status.what == b.status.what && same_number(a.status.value, b.status.value) &&
               same_number(a.status.limit, b.status.limit),
           "the same input gives the same status");
    demand(same_bytes(a.mesh, b.mesh), "the same input gives the same mesh");
    demand(same_bytes(a.report, b.report), "the same input gives the same report");
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_RESULTS_HPP
