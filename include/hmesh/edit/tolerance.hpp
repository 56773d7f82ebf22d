/// \file
/// Tolerance and Relaxation: the smallest gains that the edits of a mesh still pursue.
///
/// All gains are decreases of the energy in units of ImageMesh::mean_energy(), so that one number fits images of any size, peak
/// and difficulty.
#ifndef HMESH_EDIT_TOLERANCE_HPP
#define HMESH_EDIT_TOLERANCE_HPP

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Thresholds of sweep() (edit/move.hpp) and of stages made of sweeps and flips; in units of the mean energy of a vertex.
struct Tolerance {
    double propagate_above = 1e-3;  ///< a visit that gained more than this marks the vertex and its neighbours dirty
    double min_gain = 0;            ///< Gauss-Newton steps with a predicted gain up to this are not tried
};

/// Thresholds of relax() (edit/relax.hpp): how much work the surroundings of a change get.
struct Relaxation {
    int rounds = 2;          ///< at most; one that gains less than 1e-3 mean energies of a vertex is the last
    double min_gain = 5e-3;  ///< steps and flips that gain up to this are not tried, in mean energies of a vertex
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_TOLERANCE_HPP
