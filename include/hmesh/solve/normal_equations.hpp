/// \file
/// Normal equations of all vertices at once: K K^T, sparse and symmetric, and the right-hand sides K I^T and K P^T.
///
/// Column p of the paper's matrix K holds the barycentric coordinates of pixel p's centre in the face that the pixel belongs to,
/// so the picture that a mesh shows is I(V) K (section 3). K K^T and the right-hand sides are never multiplied out: they follow
/// from the moments of the faces, corner by corner. Rows are the mesh's vertices, row r the r-th of topology().vertices().
/// Matrices are plain arrays; solve/eigen.hpp converts them to Eigen's, and has K itself.
///
/// Cost: 0.4 us a vertex, whatever the number of pixels.
#ifndef HMESH_SOLVE_NORMAL_EQUATIONS_HPP
#define HMESH_SOLVE_NORMAL_EQUATIONS_HPP

#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A sparse symmetric matrix of n rows in compressed row storage, both triangles stored: row i has the entries
/// [starts[i], starts[i + 1]) of `columns`, which rise, and of `values`.
struct SymmetricMatrix {
    Array<int> starts{0};  ///< n + 1 offsets
    Array<int> columns;    ///< of each entry
    Array<double> values;  ///< of each entry

    /// The number of rows, which is that of columns.
    [[nodiscard]] std::size_t size() const noexcept { return starts.size() - 1; }
    /// The value on the diagonal of row i, 0 where none is stored.
    [[nodiscard]] double diagonal(std::size_t i) const noexcept {
        const int at = find_diagonal(i);
        return at < 0 ? 0 : values[static_cast<std::size_t>(at)];
    }
    /// Adds to the diagonal of row i, which must be stored.
    void add_to_diagonal(std::size_t i, double value) noexcept { values[static_cast<std::size_t>(find_diagonal(i))] += value; }

  private:
    [[nodiscard]] int find_diagonal(std::size_t i) const noexcept {
        for (int at = starts[i]; at < starts[i + 1]; ++at)
            if (columns[static_cast<std::size_t>(at)] == static_cast<int>(i)) return at;
        return -1;
    }
};

/// A dense matrix in row-major order.
struct DenseMatrix {
    std::size_t rows = 0;     ///< number of rows
    std::size_t columns = 0;  ///< number of columns
    Array<double> values;     ///< rows * columns numbers, row after row

    /// The empty matrix.
    DenseMatrix() = default;
    /// A matrix of zeros.
    DenseMatrix(std::size_t row_count, std::size_t column_count)
        : rows(row_count), columns(column_count), values(row_count * column_count, 0.0) {}
    /// The entry at a row and column, unchecked.
    [[nodiscard]] double& operator()(std::size_t row, std::size_t column) noexcept { return values[row * columns + column]; }
    /// The entry at a row and column, unchecked.
    [[nodiscard]] double operator()(std::size_t row, std::size_t column) const noexcept { return values[row * columns + column]; }
};

/// The row of each vertex in the matrices, indexed by the vertex's slot; -1 for deleted slots.
[[nodiscard]] inline Array<int> vertex_rows(const HalfedgeMesh& topology) {
    Array<int> rows(topology.vertex_slots(), -1);
    int row = 0;
    for (const Vertex v : topology.vertices()) rows[v.index()] = row++;
    return rows;
}

namespace detail {

/// The corner sums of face f; out0 is the corner that topology().halfedge(f) leaves, then follow those of its next half-edges.
template <int C>
void sum_face(const ImageMesh<C>& mesh, Face f, CornerSums<C>& out0, CornerSums<C>& out1, CornerSums<C>& out2) {
    const auto v = mesh.topology().vertices(f);
    Moments<C> m;
    mesh.face_moments(f, m);
    sum_corners(m, mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2]), out0, out1, out2);
}

/// Calls body(v) for all live vertices, in chunks of 1024 slots as pieces of work; compiled once.
inline void for_each_vertex(const HalfedgeMesh& topology, const ParallelFor& parallel_for, FunctionRef<void(Vertex)> body) {
    for_each_chunk(parallel_for, topology.vertex_slots(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            if (!topology.is_deleted(Vertex(v))) body(Vertex(v));
    });
}

/// Writes colours[r] to vertex r of topology().vertices().
template <int C>
void write_colors(ImageMesh<C>& mesh, const Array<Color<C>>& colors, const ParallelFor& parallel_for) {
    Array<Color<C>> by_slot(mesh.topology().vertex_slots(), Color<C>::zero());
    std::size_t row = 0;
    for (const Vertex v : mesh.topology().vertices()) by_slot[v.index()] = colors[row++];
    mesh.set_colors(by_slot, parallel_for);
}

}  // namespace detail

/// The corner sums of all faces, indexed by the half-edge that leaves the corner; zero for half-edges without a face.
template <int C>
[[nodiscard]] Array<CornerSums<C>> corner_sums(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    const HalfedgeMesh& topology = mesh.topology();
    Array<CornerSums<C>> corners(2 * topology.edge_slots());
    for_each_chunk(parallel_for, topology.face_slots(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            if (topology.is_deleted(Face(f))) continue;
            const Halfedge h0 = topology.halfedge(Face(f)), h1 = topology.next(h0), h2 = topology.next(h1);
            detail::sum_face(mesh, Face(f), corners[h0.index()], corners[h1.index()], corners[h2.index()]);
        }
    });
    return corners;
}

/// K K^T, n_v by n_v, of a mesh with this topology and these corner sums. Symmetric to the bit; one entry for each vertex and
/// two for each edge, also where no pixel makes them differ from 0.
template <int C>
[[nodiscard]] HMESH_COLD SymmetricMatrix normal_matrix(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                                       const ParallelFor& parallel_for = {}) {
    const Array<int> rows = vertex_rows(topology);
    SymmetricMatrix matrix;
    matrix.starts.reserve(topology.vertex_count() + 1);
    for (const Vertex v : topology.vertices()) matrix.starts.push_back(matrix.starts.back() + topology.valence(v) + 1);
    matrix.columns.resize(static_cast<std::size_t>(matrix.starts.back()));
    matrix.values.resize(matrix.columns.size());
    detail::for_each_vertex(topology, parallel_for, [&](Vertex v) {
        const int row = rows[v.index()], start = matrix.starts[static_cast<std::size_t>(row)];
        int* const columns = matrix.columns.data() + start;
        double* const values = matrix.values.data() + start;
        int count = 0;
        const auto insert = [&](int column, double value) {  // keeps columns rising
            int at = count++;
            for (; at > 0 && columns[at - 1] > column; --at) {
                columns[at] = columns[at - 1];
                values[at] = values[at - 1];
            }
            columns[at] = column;
            values[at] = value;
        };
        double diagonal = 0;
        for (const Halfedge h : topology.outgoing(v)) {
            diagonal += corners[h.index()].square;
            insert(rows[topology.to_vertex(h).index()],
                   corners[h.index()].coupling + corners[HalfedgeMesh::opposite(h).index()].coupling);
        }
        insert(row, diagonal);
    });
    return matrix;
}

/// K I^T, n_v by C, of a mesh with this topology and these corner sums; I, C by n_p, is the image.
template <int C>
[[nodiscard]] DenseMatrix image_sums(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                     const ParallelFor& parallel_for = {}) {
    const Array<int> rows = vertex_rows(topology);
    DenseMatrix sums(topology.vertex_count(), C);
    detail::for_each_vertex(topology, parallel_for, [&](Vertex v) {
        Color<C> sum = Color<C>::zero();
        for (const Halfedge h : topology.outgoing(v)) sum += corners[h.index()].image;
        for (int k = 0; k < C; ++k) sums(static_cast<std::size_t>(rows[v.index()]), static_cast<std::size_t>(k)) = sum[k];
    });
    return sums;
}

/// K P^T, n_v by 2, of a mesh with this topology and these corner sums; P, 2 by n_p, are the centres of the pixels.
template <int C>
[[nodiscard]] DenseMatrix position_sums(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                        const ParallelFor& parallel_for = {}) {
    const Array<int> rows = vertex_rows(topology);
    DenseMatrix sums(topology.vertex_count(), 2);
    detail::for_each_vertex(topology, parallel_for, [&](Vertex v) {
        const auto row = static_cast<std::size_t>(rows[v.index()]);
        for (const Halfedge h : topology.outgoing(v)) {
            sums(row, 0) += corners[h.index()].x;
            sums(row, 1) += corners[h.index()].y;
        }
    });
    return sums;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_NORMAL_EQUATIONS_HPP
