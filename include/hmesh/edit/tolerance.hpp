/// \file
/// Tolerance and Relaxation: how small a gain operators still go after.
#ifndef HMESH_EDIT_TOLERANCE_HPP
#define HMESH_EDIT_TOLERANCE_HPP

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Tolerances of a stage, in units of the mean energy of a vertex.
struct Tolerance {
    double propagate_above = 1e-3;  ///< a visit or flip that gained more makes its neighbours due
    double min_gain = 0;            ///< predicted gains below this are not tried
};

/// How much work goes into the surroundings of a change.
struct Relaxation {
    int rounds = 2;          ///< a round that gains less than 1e-3 of a vertex's mean energy is the last
    double min_gain = 5e-3;  ///< steps that promise less are not tried, in mean energies of a vertex
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_TOLERANCE_HPP
