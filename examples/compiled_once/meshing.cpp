// compiled_once - the one file of the program that compiles mesh_image(): some ten seconds, once.
#define HMESH_IMPLEMENTATION
#include <hmesh/hmesh.hpp>

#include <cstdint>

// One line for each kind of image in use. What is used and not listed here is missed by the linker, which names it.
HMESH_INSTANTIATE(std::uint8_t, 3)
