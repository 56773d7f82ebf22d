/// \file
/// The methods of the paper "Image meshing via hierarchical optimization" and the baselines that it is compared with, as
/// recipes for mesh_image(): Hierarchical, Xie, Adams and AdaptiveThinning; and the matrices behind them as Eigen's types
/// (solve/eigen.hpp).
///
/// Apart from hmesh/hmesh.hpp, so that a program that does not use these methods neither parses nor compiles them. Needs Eigen
/// 3.4 or newer.
#ifndef HMESH_PAPER_HPP
#define HMESH_PAPER_HPP

#include "hmesh/hmesh.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/adaptive_thinning.hpp"
#include "hmesh/methods/baselines/xie.hpp"
#include "hmesh/methods/hierarchical/hierarchical.hpp"
#include "hmesh/solve/eigen.hpp"

#endif  // HMESH_PAPER_HPP
