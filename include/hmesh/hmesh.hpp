/// \file
/// hmesh - turns a raster image into a triangle mesh with one colour a vertex. What most programs need in one include:
/// mesh_image() with the default recipe (Annealed), render(), psnr(), colours for linear light, and the exporters.
///
/// This header defines nothing itself. The methods of the paper and the baselines are in hmesh/paper.hpp, buffers for GPUs in
/// hmesh/gpu.hpp.
#ifndef HMESH_HMESH_HPP
#define HMESH_HMESH_HPP

#include "hmesh/core/version.hpp"
#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"
#include "hmesh/solve/linear_light.hpp"

#endif  // HMESH_HMESH_HPP
