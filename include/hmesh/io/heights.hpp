/// \file
/// Heights as geometry: a mesh of a heightmap as a model in space. PLY, OBJ and glTF (io/heights/height_models.hpp), STL
/// (io/heights/height_stl.hpp) and quantized-mesh (io/heights/quantized_mesh.hpp).
///
/// This header defines nothing itself. hmesh/terrain.hpp reaches it.
#ifndef HMESH_IO_HEIGHTS_HPP
#define HMESH_IO_HEIGHTS_HPP

#include "hmesh/io/heights/height_models.hpp"
#include "hmesh/io/heights/height_stl.hpp"
#include "hmesh/io/heights/quantized_mesh.hpp"

#endif  // HMESH_IO_HEIGHTS_HPP
