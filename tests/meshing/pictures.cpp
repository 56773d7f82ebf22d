// hmesh tests - what is done for each pixel of images that are drawn, and of sums by brute force. Tests compile it too, not
// optimised; of two inline functions the linker takes those of this library.
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace hmesh_test {

/// A function whose address is told is compiled.
extern double (Scene::*const draw_pixel)(int, int, int) const = &Scene::operator();
extern bool (*const owns_pixel)(hmesh::kit::Point, hmesh::kit::Point, hmesh::kit::Point, int, int) = &owns;

}  // namespace hmesh_test
