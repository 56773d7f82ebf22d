// hmesh tests - a mesh that looks nowhere in particular, for what needs one to begin with.
#ifndef HMESH_TESTS_EVEN_MESH_HPP
#define HMESH_TESTS_EVEN_MESH_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/methods/annealed/first_points.hpp"
#include "hmesh/tiles/delaunay_mesh.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"

namespace hmesh_test {

// The Delaunay triangulation of `count` pixels, evenly distributed, and of the corners.
template <int C>
[[nodiscard]] hmesh::kit::IndexedMesh<C> even_mesh(const hmesh::kit::ImageSource<C>& source, std::size_t count) {
    hmesh::Image<float, 1> density(source.width(), source.height());
    std::fill(density.data(), density.data() + density.size(), 1.0F);
    hmesh::kit::Delaunay delaunay(source.width(), source.height());
    (void)hmesh::kit::insert_pixels(delaunay, hmesh::kit::first_points(hmesh::kit::point_ranks(density), count),
                                    [] { return true; });
    return hmesh::kit::delaunay_mesh(source, delaunay);
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_EVEN_MESH_HPP
