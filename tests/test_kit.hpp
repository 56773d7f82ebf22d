// hmesh tests - the building blocks that take longest to compile, for up to 4 channels: compiled once for all tests.
#ifndef HMESH_TESTS_TEST_KIT_HPP
#define HMESH_TESTS_TEST_KIT_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/relax.hpp"
#include "hmesh/edit/subdivide.hpp"
#include "hmesh/fit/edge_moments.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/solve/normal_equations.hpp"

namespace hmesh::kit {

// NOLINTBEGIN(bugprone-macro-parentheses): these are declarations.
#define HMESH_TEST_KIT_PIXELS(PREFIX, T, C)                                                                              \
    PREFIX template MomentTable<C>::MomentTable(const ImageView<T, C>&, const ImageView<float, 1>&, double, const Rect&, \
                                                const ParallelFor&);                                                     \
    PREFIX template MomentTable<C>::MomentTable(const ImageView<T, C>&, const Rect&, const ParallelFor&);                \
    PREFIX template ImageSource<C>::ImageSource(const ImageView<T, C>&, const ImageView<float, 1>&, double) noexcept;
#define HMESH_TEST_KIT(PREFIX, C)                                                                                                \
    PREFIX template void edge_moments<C>(const MomentTable<C>&, Point, Point, Moments<C>&);                                      \
    PREFIX template bool fit_ring<C>(const Ring<C>&, const Spokes<C>&, Point, double, FaceFit<C>*, RingFit<C>&);                 \
    PREFIX template class ImageMesh<C>;                                                                                          \
    PREFIX template RingOutcome optimize_center<C>(const ImageMesh<C>&, RingScratch<C>&, Mobility, double, bool, RingCenter<C>&, \
                                                   double);                                                                      \
    PREFIX template double improve_vertex<C>(ImageMesh<C>&, Vertex, double);                                                     \
    PREFIX template double sweep<C>(ImageMesh<C>&, const Tolerance&);                                                            \
    PREFIX template void evaluate_flip<C>(const ImageMesh<C>&, Edge, FlipTrial<C>&);                                             \
    PREFIX template double improve_edge<C>(ImageMesh<C>&, Edge, double);                                                         \
    PREFIX template std::size_t flip_edges<C>(ImageMesh<C>&, double);                                                            \
    PREFIX template InsertionCandidate<C> edge_candidate<C>(const ImageMesh<C>&, RingScratch<C>&, Edge, bool, double);           \
    PREFIX template InsertionCandidate<C> face_candidate<C>(const ImageMesh<C>&, RingScratch<C>&, Face, bool, double);           \
    PREFIX template Array<InsertionSite> insertion_sites<C>(const ImageMesh<C>&, bool);                                          \
    PREFIX template Array<InsertionSite> best_sites<C>(const ImageMesh<C>&, std::size_t, const InsertionOptions&);               \
    PREFIX template std::size_t insert_batch<C>(ImageMesh<C>&, std::size_t, const InsertionOptions&);                            \
    PREFIX template std::size_t subdivide<C>(ImageMesh<C>&, std::size_t);                                                        \
    PREFIX template CollapseCandidate cheapest_collapse<C>(const ImageMesh<C>&, RingScratch<C>&, Vertex);                        \
    PREFIX template std::size_t remove_batch<C>(ImageMesh<C>&, std::size_t, const Relaxation&);                                  \
    PREFIX template void relax<C>(ImageMesh<C>&, const Array<Vertex>&, int, double);                                             \
    PREFIX template Array<CornerSums<C>> corner_sums<C>(const ImageMesh<C>&, const ParallelFor&);                                \
    PREFIX template SymmetricMatrix normal_matrix<C>(const HalfedgeMesh&, const Array<CornerSums<C>>&, const ParallelFor&);      \
    PREFIX template DenseMatrix image_sums<C>(const HalfedgeMesh&, const Array<CornerSums<C>>&, const ParallelFor&);             \
    HMESH_TEST_KIT_PIXELS(PREFIX, std::uint8_t, C)                                                                               \
    HMESH_TEST_KIT_PIXELS(PREFIX, std::uint16_t, C)                                                                              \
    HMESH_TEST_KIT_PIXELS(PREFIX, float, C)
// NOLINTEND(bugprone-macro-parentheses)

HMESH_TEST_KIT(extern, 1)
HMESH_TEST_KIT(extern, 2)
HMESH_TEST_KIT(extern, 3)
HMESH_TEST_KIT(extern, 4)

}  // namespace hmesh::kit

#endif  // HMESH_TESTS_TEST_KIT_HPP
