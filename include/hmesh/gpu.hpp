/// \file
/// What programs that draw meshes themselves add to hmesh/hmesh.hpp: pack_for_gpu(), buffers for OpenGL, Vulkan, Direct3D 12,
/// Metal and WebGPU; drop_transparent(), sprites without the faces that show nothing; outline(), few vertices around
/// a texture's pixels, and its exporters.
///
/// This header defines nothing itself. It stands beside hmesh/hmesh.hpp, which it would make take 5 % longer to compile.
#ifndef HMESH_GPU_HPP
#define HMESH_GPU_HPP

#include "hmesh/io/gpu.hpp"
#include "hmesh/io/textured.hpp"
#include "hmesh/outline.hpp"
#include "hmesh/sprite.hpp"

#endif  // HMESH_GPU_HPP
