// hmesh tests - what tests ask for each pixel or each face: pictures that are drawn, sums by brute force, whether a mesh is one.
// Tests compile it too, not optimised; of two inline functions the linker takes those of this library.
#include <cstdint>
#include <string>
#include <vector>

#include "mesh_flaws.hpp"
#include "periodic_sheets.hpp"
#include "point_colors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"
#include "test_outlines.hpp"

namespace hmesh_test {

// A function whose address is told is compiled.
extern double (Scene::*const draw_pixel)(int, int, int) const = &Scene::operator();
extern bool (*const owns_pixel)(hmesh::kit::Point, hmesh::kit::Point, hmesh::kit::Point, int, int) = &owns;
extern std::string (*const mesh_flaw)(const hmesh::MeshView&, int, int) = &flaw_of;
extern std::string (*const periodic_flaw)(const hmesh::Mesh&, int) = &sheet_flaw;
extern std::vector<double> (*const point_color)(const hmesh::Mesh&, int, int) = &color_at;
extern bool (*const within_loops)(const UnitLoops&, UnitPoint) = &is_within;

template double brute_energy(const Subject<std::uint8_t, 1>&);
template double brute_energy(const Subject<std::uint8_t, 3>&);
template std::vector<int> owners(const hmesh::kit::ImageMesh<1>&);
template std::vector<int> owners(const hmesh::kit::ImageMesh<3>&);
template Snapshot snapshot(const hmesh::kit::ImageMesh<1>&);
template Snapshot snapshot(const hmesh::kit::ImageMesh<2>&);
template Snapshot snapshot(const hmesh::kit::ImageMesh<3>&);
template Snapshot snapshot(const hmesh::kit::ImageMesh<4>&);

}  // namespace hmesh_test
