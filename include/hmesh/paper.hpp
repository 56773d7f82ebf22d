/// \file
/// The methods of "Image meshing via hierarchical optimization" and those that it is compared with, as recipes for mesh_image():
/// Hierarchical, Xie, Adams and AdaptiveThinning; and the linear algebra behind them as Eigen's matrices (solve/eigen.hpp).
///
/// Beside hmesh/hmesh.hpp, so that programs that do not ask for them neither parse nor compile them. Needs Eigen 3.4 or newer.
#ifndef HMESH_PAPER_HPP
#define HMESH_PAPER_HPP

#include "hmesh/hmesh.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/adaptive_thinning.hpp"
#include "hmesh/methods/baselines/xie.hpp"
#include "hmesh/methods/hierarchical/hierarchical.hpp"
#include "hmesh/solve/eigen.hpp"

#endif  // HMESH_PAPER_HPP
