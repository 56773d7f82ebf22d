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
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/read_samples.hpp"
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

namespace detail {

/// Rows of samples that are a piece of work.
inline constexpr int proof_band = 64;

/// The faces of a mesh by the bands of rows that they reach: those of band k are faces[begin[k]], .., faces[begin[k + 1] - 1], in
/// rising order.
struct FacesOfBands {
    Array<std::size_t> begin;
    Array<std::uint32_t> faces;

    FacesOfBands(const MeshView& mesh, const HeightField& field) : begin(static_cast<std::size_t>(bands(field)) + 1, 0) {
        const int last = bands(field) - 1;
        const auto for_each_band = [&](std::size_t f, auto&& body) {
            float low = mesh.positions[2 * std::size_t{mesh.faces[f][0]} + 1], high = low;
            for (const std::uint32_t v : mesh.faces[f]) {
                low = std::min(low, mesh.positions[2 * std::size_t{v} + 1]);
                high = std::max(high, mesh.positions[2 * std::size_t{v} + 1]);
            }
            const auto band = [&](float y) { return std::max(0, std::min(last, static_cast<int>(y) / proof_band)); };
            for (int k = band(low - 1); k <= band(high + 1); ++k) body(static_cast<std::size_t>(k));
        };
        for (std::size_t f = 0; f < mesh.face_count; ++f) for_each_band(f, [&](std::size_t k) { ++begin[k + 1]; });
        for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
        faces.resize(begin.back());
        Array<std::size_t> next = begin;
        for (std::size_t f = 0; f < mesh.face_count; ++f)
            for_each_band(f, [&](std::size_t k) { faces[next[k]++] = static_cast<std::uint32_t>(f); });
    }
    /// How many bands there are.
    [[nodiscard]] static int bands(const HeightField& field) noexcept { return (field.height + proof_band - 1) / proof_band; }
};

/// What the proof needs of a face.
struct ProvedFace {
    Corner corner[3];
    double area;  ///< twice that, px^2

    ProvedFace(const MeshView& mesh, int channels, std::size_t f) noexcept {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = mesh.faces[f][k];
            corner[k].position = {static_cast<double>(mesh.positions[2 * v]), static_cast<double>(mesh.positions[2 * v + 1])};
            for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c)
                corner[k].heights[c] = mesh.colors[v * static_cast<std::size_t>(channels) + c];
        }
        area = orient2d(corner[0].position, corner[1].position, corner[2].position);
    }
};

/// Measures one channel of a face at the samples of rows [first, last). `covered`: rows of the image, of samples seen before.
inline void prove_face(const ProvedFace& face, const HeightField& field, int channel, int first, int last, ReadSamples read,
                       Array<double>& values, std::uint8_t* covered, Proof& proof) {
    const ScaledPlane plane(face.corner[0], face.corner[1], face.corner[2], face.area, channel);
    const bool is_last = channel + 1 == field.channels, has_holes = !field.data.empty();
    double most = 0, squares = 0;  // times the area and its square
    const double nothing = plane.slack * face.area, offset = field.offset();
    for_each_closed_span(
        field, face.corner[0].position, face.corner[1].position, face.corner[2].position, [&](int j, int begin, int end) {
            if (j < first || j >= last) return;
            read(channel, j, begin, end, values.data());
            std::uint8_t* const seen = covered + static_cast<std::size_t>(j) * static_cast<std::size_t>(field.width);
            const double from = plane.at(begin, j, offset);
            for (int i = begin; i < end; ++i) {
                if (has_holes && !field.has_data(i, j)) {
                    proof.is_cover = false;
                    continue;
                }
                const double value = values[static_cast<std::size_t>(i - begin)];
                const double off = std::abs(from + (i - begin) * plane.dx - face.area * (value - plane.base));
                most = std::max(most, off);
                if (seen[i] != 0) continue;
                squares += off > nothing ? off * off : 0;
                if (is_last) seen[i] = 1, ++proof.samples;
            }
        });
    proof.max_error = std::max(proof.max_error, most / face.area - plane.slack);
    proof.energy += squares / (face.area * face.area);
}

}  // namespace detail

/// Measures a mesh against samples; where they stand and which have data the field says. Bands of 64 rows are pieces of work,
/// whose sums are added in their order; `read` is called on any thread.
[[nodiscard]] HMESH_COLD inline Proof prove(const MeshView& mesh, const HeightField& field, ReadSamples read,
                                            const ParallelFor& parallel_for = {}) {
    const auto width = static_cast<std::size_t>(field.width);
    Array<std::uint8_t> covered(width * static_cast<std::size_t>(field.height), 0);
    const detail::FacesOfBands by_band(mesh, field);
    Array<Proof> proofs(by_band.begin.size() - 1);
    parallel_for(proofs.size(), [&](std::size_t k) {
        Proof proof;
        Array<double> values(width);
        const int first = static_cast<int>(k) * detail::proof_band, last = std::min(field.height, first + detail::proof_band);
        for (std::size_t at = by_band.begin[k]; at < by_band.begin[k + 1]; ++at) {
            const detail::ProvedFace face(mesh, field.channels, by_band.faces[at]);
            if (!(face.area > 0)) continue;
            for (int channel = 0; channel < field.channels; ++channel)
                detail::prove_face(face, field, channel, first, last, read, values, covered.data(), proof);
        }
        for (int j = first; j < last && proof.is_cover && !field.data.empty(); ++j)
            for (int i = 0; i < field.width; ++i)
                if (covered[static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)] == 0 && field.is_wanted(i, j))
                    proof.is_cover = false;
        proofs[k] = proof;
    });
    Proof all;
    for (const Proof& proof : proofs) {
        all.max_error = std::max(all.max_error, proof.max_error);
        all.energy += proof.energy;
        all.samples += proof.samples;
        all.is_cover = all.is_cover && proof.is_cover;
    }
    // Sums of multiples of 2^-16 below 2^37 are exact. Faces that all turn one way within the rectangle and have its area cover
    // it once, since they hang together along edges.
    double area = 0;
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const double of_face = detail::ProvedFace(mesh, 0, f).area;
        all.is_cover = all.is_cover && of_face > 0;
        area += of_face;
    }
    if (field.data.empty())
        all.is_cover = all.is_cover && all.samples == covered.size() && area == 2.0 * field.right() * field.bottom();
    return all;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_PROOF_HPP
