// The one file of the program that compiles mesh_image() for compiled.cpp.
#define HMESH_IMPLEMENTATION
#include <hmesh/hmesh.hpp>

#include <cstdint>

HMESH_INSTANTIATE(std::uint8_t, 1)
