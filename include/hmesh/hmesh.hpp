// hmesh - the whole library in one include. Defines nothing itself.
//
// Raster image to triangle mesh with one colour a vertex: hmesh::mesh_image() in mesh_image.hpp is the place to begin.
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
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"

#endif  // HMESH_HMESH_HPP
