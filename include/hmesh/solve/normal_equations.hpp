// hmesh - barycentric: the sparse matrix K of the paper, and its normal equations.
//
// Column p of K holds the barycentric coordinates of pixel p's centre in the face that owns it, so the picture that a
// mesh shows is I(V) K (the paper's section 3), and V K is the pixels' positions P exactly. K itself serves tests and
// what wants to see single pixels; K K^T, K I^T and K P^T are never multiplied out but follow from moments of faces.
//
// Rows of K are the mesh's vertices, row r the r-th of topology().vertices(); columns are the pixels of the table's
// rectangle, row after row. Cost: K about 20 ns a pixel and 40 bytes of memory; the normal equations 0.4 us a vertex,
// whatever the number of pixels.
#ifndef HMESH_SOLVE_NORMAL_EQUATIONS_HPP
#define HMESH_SOLVE_NORMAL_EQUATIONS_HPP

#include <Eigen/SparseCore>
#if !EIGEN_VERSION_AT_LEAST(3, 4, 0)
#error "hmesh needs Eigen 3.4 or newer"
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/raster.hpp"

namespace hmesh::kit {

// The row of each vertex, by slot; -1 for deleted slots.
[[nodiscard]] inline std::vector<int> vertex_rows(const HalfedgeMesh& topology) {
    std::vector<int> rows(topology.vertex_slots(), -1);
    int row = 0;
    for (const Vertex v : topology.vertices()) rows[v.index()] = row++;
    return rows;
}

// V: n_v by 2, where the vertices are.
template <int C>
[[nodiscard]] Eigen::MatrixXd position_matrix(const ImageMesh<C>& mesh) {
    Eigen::MatrixXd positions(static_cast<Eigen::Index>(mesh.vertex_count()), 2);
    Eigen::Index row = 0;
    for (const Vertex v : mesh.topology().vertices()) positions.row(row++) << mesh.position(v).x, mesh.position(v).y;
    return positions;
}
// I(V): n_v by C, their colours.
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

// K: n_v by n_p, columns of 3 entries (some may be 0) that sum to 1. Faces are independent pieces of work, because each
// pixel has one owner. The mesh must tile its rectangle, as check() proves.
template <int C>
[[nodiscard]] Eigen::SparseMatrix<double> barycentric_matrix(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    const HalfedgeMesh& topology = mesh.topology();
    const std::vector<int> rows = vertex_rows(topology);
    const auto width = static_cast<std::size_t>(mesh.width()), pixels = width * static_cast<std::size_t>(mesh.height());
    Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(mesh.vertex_count()), static_cast<Eigen::Index>(pixels));
    matrix.resizeNonZeros(static_cast<Eigen::Index>(3 * pixels));
    for (std::size_t p = 0; p <= pixels; ++p) matrix.outerIndexPtr()[p] = static_cast<int>(3 * p);
    for_each_chunk(parallel_for, topology.face_slots(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            if (topology.is_deleted(Face(f))) continue;
            std::array<Vertex, 3> v = topology.vertices(Face(f));
            if (v[1] < v[0]) std::swap(v[0], v[1]);  // rows rise down a column; the weights do not mind
            if (v[2] < v[1]) std::swap(v[1], v[2]);
            if (v[1] < v[0]) std::swap(v[0], v[1]);
            const Point a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
            for_each_span(a, b, c, {}, [&](int j, int begin, int end) {
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

// What one corner of a face adds to the normal equations. It goes with the half-edge that leaves the corner within the
// face; lambda is the corner's hat function, sums are over the face's pixels.
template <int C>
struct CornerSums {
    double square = 0;                  // lambda^2
    double coupling = 0;                // lambda times that of the half-edge's other end
    double x = 0, y = 0;                // lambda (x, y), plane coordinates of the pixel's centre
    Color<C> image = Color<C>::zero();  // lambda I; lane C: lambda
};

namespace detail {

// The corners of face (v0, v1, v2) with moments m. With the origin in v0, lambda_1 = u / area and lambda_2 = w / area
// for u = b_y x - b_x y and w = a_x y - a_y x. Dividing last and nesting sums of products as below keeps all before it
// exact on the 1/256 px grid for faces of common size: slivers, where terms of 1e8 cancel, lose nothing.
template <int C>
void sum_corners(const Moments<C>& m, Point v0, Point v1, Point v2, CornerSums<C>& out0, CornerSums<C>& out1,
                 CornerSums<C>& out2) {
    const double n = m.s[C];
    if (!(n > least_weight)) return;  // sums of float samples and of weights leave rounding where there is no pixel
    const double ax = v1.x - v0.x, ay = v1.y - v0.y, bx = v2.x - v0.x, by = v2.y - v0.y;
    const double inverse = 1 / (ax * by - ay * bx), inverse2 = inverse * inverse;
    const double ox = v0.x - 0.5, oy = v0.y - 0.5;  // the origin in pixel coordinates
    const Color<C> mx = m.sx - ox * m.s, my = m.sy - oy * m.s;
    const double sx = mx[C], sy = my[C];
    const double sxx = m.q[0] - ox * (m.sx[C] + sx), syy = m.q[2] - oy * (m.sy[C] + sy);
    const double sxy = m.q[1] - ox * m.sy[C] - oy * sx;
    const double ux = by * sxx - bx * sxy, uy = by * sxy - bx * syy;
    const double wx = ax * sxy - ay * sxx, wy = ax * syy - ay * sxy;
    const double l1 = (by * sx - bx * sy) * inverse, l2 = (ax * sy - ay * sx) * inverse;
    const double l11 = (by * ux - bx * uy) * inverse2, l22 = (ax * wy - ay * wx) * inverse2;
    const double l12 = (ax * uy - ay * ux) * inverse2;
    out1.square = l11;
    out1.coupling = l12;
    out1.image = (by * mx - bx * my) * inverse;
    out1.x = v0.x * l1 + ux * inverse;
    out1.y = v0.y * l1 + uy * inverse;
    out2.square = l22;
    out2.coupling = l2 - l12 - l22;
    out2.image = (ax * my - ay * mx) * inverse;
    out2.x = v0.x * l2 + wx * inverse;
    out2.y = v0.y * l2 + wy * inverse;
    out0.square = n - 2 * (l1 + l2) + l11 + 2 * l12 + l22;
    out0.coupling = l1 - l11 - l12;
    out0.image = m.s - out1.image - out2.image;
    out0.x = n * v0.x + sx - out1.x - out2.x;
    out0.y = n * v0.y + sy - out1.y - out2.y;
    // Rounding of weighted sums may have made squares negative.
    out0.square = std::max(0.0, out0.square);
    out1.square = std::max(0.0, out1.square);
    out2.square = std::max(0.0, out2.square);
}

// The corners of face f, the first being that which topology().halfedge(f) leaves.
template <int C>
void sum_face(const ImageMesh<C>& mesh, Face f, CornerSums<C>& out0, CornerSums<C>& out1, CornerSums<C>& out2) {
    const auto v = mesh.topology().vertices(f);
    Moments<C> m;
    mesh.face_moments(f, m);
    sum_corners(m, mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2]), out0, out1, out2);
}

// Calls body(v) for all live vertices, in pieces.
template <class Body>
void for_each_vertex(const HalfedgeMesh& topology, const ParallelFor& parallel_for, Body&& body) {
    for_each_chunk(parallel_for, topology.vertex_slots(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            if (!topology.is_deleted(Vertex(v))) body(Vertex(v));
    });
}

}  // namespace detail

// The corners of all faces, by the index of their half-edge; zero at half-edges without a face.
template <int C>
[[nodiscard]] std::vector<CornerSums<C>> corner_sums(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    const HalfedgeMesh& topology = mesh.topology();
    std::vector<CornerSums<C>> corners(2 * topology.edge_slots());
    for_each_chunk(parallel_for, topology.face_slots(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            if (topology.is_deleted(Face(f))) continue;
            const Halfedge h0 = topology.halfedge(Face(f)), h1 = topology.next(h0), h2 = topology.next(h1);
            detail::sum_face(mesh, Face(f), corners[h0.index()], corners[h1.index()], corners[h2.index()]);
        }
    });
    return corners;
}

// K K^T: n_v by n_v, symmetric to the bit, both triangles stored; an entry for each vertex and each edge either way,
// even where no pixel makes it differ from 0. From the corners of the mesh with this topology, or from the mesh.
template <int C>
[[nodiscard]] Eigen::SparseMatrix<double> gram_matrix(const HalfedgeMesh& topology, const std::vector<CornerSums<C>>& corners,
                                                      const ParallelFor& parallel_for = {}) {
    const std::vector<int> rows = vertex_rows(topology);
    const auto n = static_cast<Eigen::Index>(topology.vertex_count());
    Eigen::SparseMatrix<double> matrix(n, n);
    int* const starts = matrix.outerIndexPtr();
    starts[0] = 0;
    for (const Vertex v : topology.vertices()) {
        const int row = rows[v.index()];
        starts[row + 1] = starts[row] + topology.valence(v) + 1;
    }
    matrix.resizeNonZeros(starts[n]);
    detail::for_each_vertex(topology, parallel_for, [&](Vertex v) {
        const int column = rows[v.index()];
        int* const inner = matrix.innerIndexPtr() + starts[column];
        double* const values = matrix.valuePtr() + starts[column];
        int count = 0;
        const auto insert = [&](int row, double value) {  // keeps rows rising
            int at = count++;
            for (; at > 0 && inner[at - 1] > row; --at) {
                inner[at] = inner[at - 1];
                values[at] = values[at - 1];
            }
            inner[at] = row;
            values[at] = value;
        };
        double diagonal = 0;
        for (const Halfedge h : topology.outgoing(v)) {
            diagonal += corners[h.index()].square;
            insert(rows[topology.to_vertex(h).index()],
                   corners[h.index()].coupling + corners[HalfedgeMesh::opposite(h).index()].coupling);
        }
        insert(column, diagonal);
    });
    return matrix;
}
template <int C>
[[nodiscard]] Eigen::SparseMatrix<double> gram_matrix(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    return gram_matrix(mesh.topology(), corner_sums(mesh, parallel_for), parallel_for);
}

// K I^T: n_v by C, where I is C by n_p, the image.
template <int C>
[[nodiscard]] Eigen::MatrixXd image_rhs(const HalfedgeMesh& topology, const std::vector<CornerSums<C>>& corners,
                                        const ParallelFor& parallel_for = {}) {
    const std::vector<int> rows = vertex_rows(topology);
    Eigen::MatrixXd rhs(static_cast<Eigen::Index>(topology.vertex_count()), C);
    detail::for_each_vertex(topology, parallel_for, [&](Vertex v) {
        Color<C> sum = Color<C>::zero();
        for (const Halfedge h : topology.outgoing(v)) sum += corners[h.index()].image;
        for (int k = 0; k < C; ++k) rhs(rows[v.index()], k) = sum[k];
    });
    return rhs;
}
template <int C>
[[nodiscard]] Eigen::MatrixXd image_rhs(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    return image_rhs(mesh.topology(), corner_sums(mesh, parallel_for), parallel_for);
}

// K P^T: n_v by 2, where P is 2 by n_p, the centres of the pixels.
template <int C>
[[nodiscard]] Eigen::MatrixXd position_rhs(const HalfedgeMesh& topology, const std::vector<CornerSums<C>>& corners,
                                           const ParallelFor& parallel_for = {}) {
    const std::vector<int> rows = vertex_rows(topology);
    Eigen::MatrixXd rhs(static_cast<Eigen::Index>(topology.vertex_count()), 2);
    detail::for_each_vertex(topology, parallel_for, [&](Vertex v) {
        double x = 0, y = 0;
        for (const Halfedge h : topology.outgoing(v)) {
            x += corners[h.index()].x;
            y += corners[h.index()].y;
        }
        rhs.row(rows[v.index()]) << x, y;
    });
    return rhs;
}
template <int C>
[[nodiscard]] Eigen::MatrixXd position_rhs(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    return position_rhs(mesh.topology(), corner_sums(mesh, parallel_for), parallel_for);
}

}  // namespace hmesh::kit

#endif  // HMESH_SOLVE_NORMAL_EQUATIONS_HPP
