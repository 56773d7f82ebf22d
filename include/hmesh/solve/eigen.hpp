/// \file
/// The linear algebra of a mesh in Eigen's matrices: K itself, the normal equations, and PCG over them.
///
/// K is the paper's sparse matrix of barycentric coordinates, n_v by n_p; it is the reference for tests, and for programs that
/// want to see single pixels. V K are the pixels' positions P exactly. All else here converts the plain arrays of
/// solve/normal_equations.hpp and solve/pcg.hpp. Rows are the mesh's vertices, row r the r-th of topology().vertices(); columns
/// of K are the pixels of the table's rectangle, row after row.
///
/// Cost of K: about 20 ns and 40 bytes a pixel.
#ifndef HMESH_SOLVE_EIGEN_HPP
#define HMESH_SOLVE_EIGEN_HPP

#include <Eigen/Core>
#include <Eigen/SparseCore>
#if !EIGEN_VERSION_AT_LEAST(3, 4, 0)
#error "hmesh needs Eigen 3.4 or newer"
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/solve/normal_equations.hpp"
#include "hmesh/solve/pcg.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The symmetric matrix in Eigen's compressed storage, both triangles stored.
[[nodiscard]] inline Eigen::SparseMatrix<double> to_eigen(const SymmetricMatrix& from) {
    const auto n = static_cast<Eigen::Index>(from.size());
    Eigen::SparseMatrix<double> to(n, n);
    std::copy(from.starts.begin(), from.starts.end(), to.outerIndexPtr());
    to.resizeNonZeros(static_cast<Eigen::Index>(from.values.size()));
    std::copy(from.columns.begin(), from.columns.end(), to.innerIndexPtr());
    std::copy(from.values.begin(), from.values.end(), to.valuePtr());
    return to;
}
/// The dense matrix in Eigen's type.
[[nodiscard]] inline Eigen::MatrixXd to_eigen(const DenseMatrix& from) {
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        from.values.data(), static_cast<Eigen::Index>(from.rows), static_cast<Eigen::Index>(from.columns));
}
/// An Eigen matrix that is symmetric, with both triangles stored, as plain arrays.
[[nodiscard]] inline SymmetricMatrix from_eigen(Eigen::SparseMatrix<double> from) {
    from.makeCompressed();
    SymmetricMatrix to;
    to.starts.assign(from.outerIndexPtr(), from.outerIndexPtr() + from.outerSize() + 1);
    to.columns.assign(from.innerIndexPtr(), from.innerIndexPtr() + from.nonZeros());
    to.values.assign(from.valuePtr(), from.valuePtr() + from.nonZeros());
    return to;
}
/// A dense Eigen matrix as a plain array.
[[nodiscard]] inline DenseMatrix from_eigen(const Eigen::MatrixXd& from) {
    DenseMatrix to(static_cast<std::size_t>(from.rows()), static_cast<std::size_t>(from.cols()));
    for (std::size_t i = 0; i < to.rows; ++i)
        for (std::size_t k = 0; k < to.columns; ++k) to(i, k) = from(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
    return to;
}

/// V: n_v by 2, the positions of the vertices in px.
template <int C>
[[nodiscard]] Eigen::MatrixXd position_matrix(const ImageMesh<C>& mesh) {
    Eigen::MatrixXd positions(static_cast<Eigen::Index>(mesh.vertex_count()), 2);
    Eigen::Index row = 0;
    for (const Vertex v : mesh.topology().vertices()) positions.row(row++) << mesh.position(v).x, mesh.position(v).y;
    return positions;
}
/// I(V): n_v by C, the colours of the vertices in stored values.
template <int C>
[[nodiscard]] Eigen::MatrixXd color_matrix(const ImageMesh<C>& mesh) {
    Eigen::MatrixXd colors(static_cast<Eigen::Index>(mesh.vertex_count()), C);
    Eigen::Index row = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        for (int k = 0; k < C; ++k) colors(row, k) = mesh.color(v)[k];
        ++row;
    }
    return colors;
}

/// Gives all vertices the colours in the rows of `colors`, n_v by C, as color_matrix() returns them; the energy follows.
template <int C>
void set_colors(ImageMesh<C>& mesh, const Eigen::MatrixXd& colors, const ParallelFor& parallel_for = {}) {
    HMESH_ASSERT(colors.rows() == static_cast<Eigen::Index>(mesh.vertex_count()) && colors.cols() == C);
    Array<Color<C>> by_slot(mesh.topology().vertex_slots(), Color<C>::zero());
    Eigen::Index row = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        for (int k = 0; k < C; ++k) by_slot[v.index()].set(k, colors(row, k));
        ++row;
    }
    mesh.set_colors(by_slot, parallel_for);
}

/// K: n_v by n_p, the barycentric coordinates of pixel p's centre in column p: 3 entries, of which some may be 0, with sum 1.
/// Faces are independent pieces of work, because each pixel belongs to one face. The mesh must tile its rectangle, as
/// ImageMesh::check() proves.
template <int C>
[[nodiscard]] Eigen::SparseMatrix<double> barycentric_matrix(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    const HalfedgeMesh& topology = mesh.topology();
    const Array<int> rows = vertex_rows(topology);
    const auto width = static_cast<std::size_t>(mesh.width()), pixels = width * static_cast<std::size_t>(mesh.height());
    Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(mesh.vertex_count()), static_cast<Eigen::Index>(pixels));
    matrix.resizeNonZeros(static_cast<Eigen::Index>(3 * pixels));
    ClipRect clip;
    clip.sides = mesh.table().far_sides();
    for (std::size_t p = 0; p <= pixels; ++p) matrix.outerIndexPtr()[p] = static_cast<int>(3 * p);
    for_each_chunk(parallel_for, topology.face_slots(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            if (topology.is_deleted(Face(f))) continue;
            std::array<Vertex, 3> v = topology.vertices(Face(f));
            if (v[1] < v[0]) std::swap(v[0], v[1]);  // rows rise down a column; the weights are found for this order
            if (v[2] < v[1]) std::swap(v[1], v[2]);
            if (v[1] < v[0]) std::swap(v[0], v[1]);
            const Point a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
            for_each_span(a, b, c, clip, [&](int j, int begin, int end) {
                std::size_t entry = 3 * (static_cast<std::size_t>(j) * width + static_cast<std::size_t>(begin));
                for (int i = begin; i < end; ++i, entry += 3) {
                    const Barycentric weights = barycentric(a, b, c, {i + 0.5, j + 0.5});
                    for (std::size_t k = 0; k < 3; ++k) matrix.innerIndexPtr()[entry + k] = rows[v[k].index()];
                    matrix.valuePtr()[entry] = weights.a;
                    matrix.valuePtr()[entry + 1] = weights.b;
                    matrix.valuePtr()[entry + 2] = weights.c;
                }
            });
        }
    });
    return matrix;
}

/// K K^T, n_v by n_v, of a mesh with this topology and these corner sums: normal_matrix().
template <int C>
[[nodiscard]] Eigen::SparseMatrix<double> gram_matrix(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                                      const ParallelFor& parallel_for = {}) {
    return to_eigen(normal_matrix(topology, corners, parallel_for));
}
/// K K^T of a mesh, n_v by n_v.
template <int C>
[[nodiscard]] Eigen::SparseMatrix<double> gram_matrix(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    return gram_matrix(mesh.topology(), corner_sums(mesh, parallel_for), parallel_for);
}
/// K I^T, n_v by C, of a mesh with this topology and these corner sums: image_sums().
template <int C>
[[nodiscard]] Eigen::MatrixXd image_rhs(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                        const ParallelFor& parallel_for = {}) {
    return to_eigen(image_sums(topology, corners, parallel_for));
}
/// K I^T of a mesh, n_v by C.
template <int C>
[[nodiscard]] Eigen::MatrixXd image_rhs(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    return image_rhs(mesh.topology(), corner_sums(mesh, parallel_for), parallel_for);
}
/// K P^T, n_v by 2, of a mesh with this topology and these corner sums: position_sums().
template <int C>
[[nodiscard]] Eigen::MatrixXd position_rhs(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                           const ParallelFor& parallel_for = {}) {
    return to_eigen(position_sums(topology, corners, parallel_for));
}
/// K P^T of a mesh, n_v by 2.
template <int C>
[[nodiscard]] Eigen::MatrixXd position_rhs(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    return position_rhs(mesh.topology(), corner_sums(mesh, parallel_for), parallel_for);
}

/// Solves A X = B for Eigen's matrices, which are copied; contract and report are those of solve_pcg() in solve/pcg.hpp.
inline PcgReport solve_pcg(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b, Eigen::MatrixXd& x,
                           const PcgOptions& options = {}, const std::vector<HeldEntry>& held = {}) {
    DenseMatrix solution = from_eigen(x);
    const PcgReport report = solve_pcg(from_eigen(a), from_eigen(b), solution, options, held);
    x = to_eigen(solution);
    return report;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_EIGEN_HPP
