/// \file
/// The proof: whether a finished mesh keeps its bound and covers what it must, from the very floats that are returned.
///
/// Nothing that was known while the mesh was made is used. Each face is held against all samples of its closed triangle in
/// double (methods/bounded/face_error.hpp), as whoever reads the mesh may do. Some 3 ns a sample.
#ifndef HMESH_METHODS_BOUNDED_PROOF_HPP
#define HMESH_METHODS_BOUNDED_PROOF_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/bounded/face_error.hpp"
#include "hmesh/methods/bounded/height_field.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What a mesh is, measured.
struct Proof {
    double max_error = 0;     ///< largest |mesh - sample|, in stored values
    double energy = 0;        ///< sum of squared differences; of a sample on an edge that of the first face counts
    std::size_t samples = 0;  ///< how many samples the mesh covers
    bool is_cover = true;     ///< whether it covers all that it must and nothing without data, with faces that do not overlap
};

/// Reads samples [begin, end) of row j of a channel into `values`.
using ReadSamples = FunctionRef<void(int channel, int j, int begin, int end, double* values)>;

/// Measures a mesh against samples; where they stand and which have data the field says.
[[nodiscard]] HMESH_COLD inline Proof prove(const MeshView& mesh, const HeightField& field, ReadSamples read) {
    Proof proof;
    const auto width = static_cast<std::size_t>(field.width);
    Array<std::uint8_t> covered(width * static_cast<std::size_t>(field.height), 0);
    Array<double> values(width);
    const double offset = field.offset();
    double area_sum = 0;
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        Corner corner[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = mesh.faces[f][k];
            corner[k].position = {static_cast<double>(mesh.positions[2 * v]), static_cast<double>(mesh.positions[2 * v + 1])};
            for (std::size_t c = 0; c < static_cast<std::size_t>(field.channels); ++c)
                corner[k].heights[c] = mesh.colors[v * static_cast<std::size_t>(field.channels) + c];
        }
        const Point a = corner[0].position, b = corner[1].position, c = corner[2].position;
        const double area = orient2d(a, b, c);
        if (!(area > 0)) {
            proof.is_cover = false;
            continue;
        }
        area_sum += area;
        for (int channel = 0; channel < field.channels; ++channel) {
            const ScaledPlane plane(corner[0], corner[1], corner[2], area, channel);
            const bool is_last = channel + 1 == field.channels, has_holes = !field.data.empty();
            double most = 0, squares = 0;  // times `area` and its square
            const double nothing = plane.slack * area;
            for_each_closed_span(field, a, b, c, [&](int j, int begin, int end) {
                read(channel, j, begin, end, values.data());
                std::uint8_t* const seen = covered.data() + static_cast<std::size_t>(j) * width;
                const double from = plane.at(begin, j, offset);
                for (int i = begin; i < end; ++i) {
                    if (has_holes && !field.has_data(i, j)) {
                        proof.is_cover = false;
                        continue;
                    }
                    const double value = values[static_cast<std::size_t>(i - begin)];
                    const double off = std::abs(from + (i - begin) * plane.dx - area * (value - plane.base));
                    most = std::max(most, off);
                    if (seen[i] != 0) continue;
                    squares += off > nothing ? off * off : 0;
                    if (is_last) seen[i] = 1, ++proof.samples;
                }
            });
            proof.max_error = std::max(proof.max_error, most / area - plane.slack);
            proof.energy += squares / (area * area);
        }
    }
    if (field.data.empty()) {
        // Sums of multiples of 2^-16 below 2^37 are exact. Faces that all turn one way within the rectangle and have its area
        // cover it once, since they hang together along edges.
        proof.is_cover = proof.is_cover && proof.samples == covered.size() && area_sum == 2.0 * field.right() * field.bottom();
        return proof;
    }
    for (int j = 0; j < field.height && proof.is_cover; ++j)
        for (int i = 0; i < field.width; ++i)
            if (covered[static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)] == 0 && field.is_wanted(i, j))
                proof.is_cover = false;
    return proof;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_PROOF_HPP
