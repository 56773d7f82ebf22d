/// \file
/// largest_error(): how far a fitted mesh is from a sample at most.
///
/// A difference squared is at most the energy of its face, which is known but for rounding: only faces with more than the square
/// of the largest difference so far are looked at, the one with the most energy first. Cost: 6 ns a pixel of these faces. Of
/// photographs of 3 channels that is 1 to 2 ns for each pixel of the image at 1 % of vertices, 4 at 0.1 % and 0.5 at 4 %
/// (kodim03, Lena). Over a weighted table, where a pixel of small weight adds little to the energy, all faces are looked at.
#ifndef HMESH_FIT_LARGEST_ERROR_HPP
#define HMESH_FIT_LARGEST_ERROR_HPP

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/edge_moments.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/handles.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// The largest difference of a sample in face f, and `least` at least.
template <int C>
[[nodiscard]] double largest_error(const ImageMesh<C>& mesh, Face f, double least) {
    const MomentTable<C>& table = mesh.table();
    const auto v = mesh.topology().vertices(f);
    const Point a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
    const PixelBarycentric weights_at(a, b, c);
    const Color<C> at_a = mesh.color(v[0]), to_b = mesh.color(v[1]) - at_a, to_c = mesh.color(v[2]) - at_a;
    Color<C> largest = Color<C>::zero();
    const ClipRect clip{table.width(), 0, table.height(), table.far_sides()};
    for_each_span(a, b, c, clip, [&](int j, int begin, int end) {
        Color<C> sample = Color<C>::zero();
        for (int i = begin; i < end; ++i) {
            if (!(table.weight(i, j) > least_weight)) continue;
            table.pixel(i, j, sample);
            const Barycentric w = weights_at(i, j);
            largest = max(largest, abs(at_a + w.b * to_b + w.c * to_c - sample));  // the lanes above the channels mean nothing
        }
    });
    for (int k = 0; k < C; ++k) least = std::max(least, largest[k]);
    return least;
}

/// What rounding may take of the energy of a face: it is a difference of sums along three edges, which are rounded once a row,
/// and some dozen times after that, each time to 2^-53 of at most the sum of all squares. Of a photograph of a megapixel that is
/// 0.02 for 8 bits and 1e3 for 16 bits: next to the square of the largest difference little, unless the mesh nearly is the image.
template <int C>
[[nodiscard]] HMESH_COLD double lost_energy(const MomentTable<C>& table) {
    double squares = 0;
    for (int y = 0; y < table.height(); ++y) squares += table.squares(y);
    return (3.0 * table.height() + 64) * squares / 9007199254740992.0;
}

}  // namespace detail

/// The largest difference between the mesh and a sample of its pixels and channels, in stored values; pixels of weight 0 do not
/// count. Samples are those of the table, exact for integers. The executor looks at 1024 faces a piece; which of them are passed
/// over depends on who comes first, the largest difference of all does not.
template <int C>
[[nodiscard]] HMESH_COLD double largest_error(const ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    double least = 0;
    Face first;
    for (const Face f : mesh.topology().faces())
        if (!first.is_valid() || mesh.energy(f) > mesh.energy(first)) first = f;
    if (first.is_valid()) least = detail::largest_error(mesh, first, least);
    const MomentTable<C>& table = mesh.table();
    const double lost = detail::lost_energy(table);
    std::atomic<double> largest{least};
    for_each_chunk(parallel_for, mesh.topology().face_slots(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Face f(k);
            double known = largest.load(std::memory_order_relaxed);
            if (mesh.topology().is_deleted(f) || !(table.is_weighted() || mesh.energy(f) + lost > known * known)) continue;
            const double found = detail::largest_error(mesh, f, known);
            while (found > known && !largest.compare_exchange_weak(known, found, std::memory_order_relaxed)) continue;
        }
    });
    return largest.load(std::memory_order_relaxed);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_LARGEST_ERROR_HPP
