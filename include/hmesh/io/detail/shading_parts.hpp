/// \file
/// Parts of a mesh that PDF viewers draw one after another: what makes poppler fast, and thin faces better to see everywhere.
///
/// poppler (Splash: pdftoppm, Okular) halves a face of a shading until no side's ends differ by more than 3/256 in any component,
/// at most 6 times, and fills every piece as a path, 0.4 us each on a fast core; it does not look how small a face is
/// (Gfx::gouraudFillTriangle; measured with poppler 22.12). A mesh of 100,000 vertices of photographs becomes 271 million
/// pieces on a page of 3 million px.
///
/// A shading's components may belong to a colour space that multiplies them (DeviceN with a tint transform): stored as a 16th,
/// a face's colours differ by a 16th and it is halved 4 times less, while the colour that is shown stays what it was, and linear.
/// Each face gets the largest factor of those that still makes `pieces_per_px` pieces, or a smaller one where most of its
/// neighbours have that; faces of one factor are a part.
///
/// Parts go from the largest factor, that is the smallest and steepest faces, to factor 1: viewers paint pixels that a face
/// only touches, and large faces that come later restore theirs. At 72 dpi this is worth 1 dB in poppler and 0.5 dB in
/// Ghostscript.
#ifndef HMESH_IO_DETAIL_SHADING_PARTS_HPP
#define HMESH_IO_DETAIL_SHADING_PARTS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// The factors by which parts' colours may be stored smaller, in the order in which parts are drawn.
inline constexpr std::array<int, 5> color_factors = {16, 8, 4, 2, 1};

/// The least that a px of a face gets of pieces where its factor is not 1. At 288 dpi poppler's picture of a grid without thin
/// faces then is 48.5 dB near to the mesh, in plain colours 49.1; with 4 a px it is 47.4 and takes two thirds of the time. That
/// of a fitted mesh of 3 % is 40.8 dB, in plain colours 40.4.
inline constexpr double pieces_per_px = 8;

/// Meshes of fewer pieces are one part in plain colours: poppler takes less than a second for them.
inline constexpr double most_plain_pieces = 2000000;

/// What it may cost, in pieces, that two neighbours are of one part, so that one strip goes on and the second time that a
/// vertex is stored is the same bytes again to a compressor. Of the mesh of 16,000 vertices of docs/formats.md, with 4 pieces a
/// px, 0 makes 2.2 times the deflated bytes of one part and takes poppler 4.1 s, 200 makes 1.9 and takes 4.3 s, 800 makes 1.6
/// and takes 5.1 s, 3000 makes 1.6 and takes 5.7 s; one part takes 21 s.
inline constexpr double pieces_per_cut = 800;

/// How often all faces choose again; the fourth time changes next to nothing.
inline constexpr int choices = 4;

/// Faces that are stored with their colours divided by a factor.
struct ShadingPart {
    int factor = 1;                    ///< one of color_factors
    kit::Array<StripVertex> vertices;  ///< in strips
};

/// Into how many pieces poppler cuts a face whose corners differ by `range` of full intensity, stored divided by `factor`.
[[nodiscard]] inline double shading_pieces(double range, int factor) noexcept {
    constexpr double least = 3.0 / 256;
    constexpr int deepest = 6;
    double pieces = 1;
    range /= factor;
    for (int depth = 0; depth < deepest && range > least; ++depth, range /= 2) pieces *= 4;
    return pieces;
}

/// Divides the faces of a mesh into parts.
class ShadingDivision {
  public:
    /// Of a mesh that check() accepts. Component k of vertex v is shares[components * v + k], a share of full intensity. All
    /// must outlive this object.
    ShadingDivision(const MeshView& mesh, int components, const kit::Array<double>& shares) noexcept
        : mesh_(mesh), components_(static_cast<std::size_t>(components)), shares_(shares) {}

    /// The parts, none of them empty, in the order in which they are drawn; their faces are the mesh's, each once. To be called
    /// once. As long as finding the strips, twice; 30 bytes a face more.
    [[nodiscard]] std::vector<ShadingPart> run() {
        std::vector<ShadingPart> parts;
        if (plain_pieces() <= most_plain_pieces) {
            parts.push_back({1, strip_vertices(mesh_, true)});
            return parts;
        }
        choose();
        kit::Array<Triangle> faces;
        for (std::size_t w = 0; w < ways; ++w) {
            faces.clear();
            for (std::size_t f = 0; f < mesh_.face_count; ++f)
                if (chosen_[f] == w) faces.push_back(mesh_.faces[f]);
            if (faces.empty()) continue;
            MeshView part = mesh_;
            part.faces = faces.data();
            part.face_count = faces.size();
            parts.push_back({color_factors[w], strip_vertices(part, true)});
        }
        return parts;
    }

  private:
    static constexpr std::size_t ways = color_factors.size();

    [[nodiscard]] double plain_pieces() const {
        double sum = 0;
        for (std::size_t f = 0; f < mesh_.face_count; ++f) sum += shading_pieces(range(mesh_.faces[f]), 1);
        return sum;
    }
    // The largest difference of corners in a component.
    [[nodiscard]] double range(const Triangle& face) const {
        double most = 0;
        for (std::size_t k = 0; k < components_; ++k) {
            const auto share = [&](std::size_t corner) { return shares_[components_ * face[corner] + k]; };
            const auto [low, high] = std::minmax({share(0), share(1), share(2)});
            most = std::max(most, std::min(1.0, high) - std::max(0.0, low));
        }
        return most;
    }
    [[nodiscard]] double area(const Triangle& face) const {
        const auto at = [&](std::size_t corner, std::size_t axis) {
            return static_cast<double>(mesh_.positions[2 * std::size_t{face[corner]} + axis]);
        };
        return std::abs((at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(1, 1) - at(0, 1)) * (at(2, 0) - at(0, 0))) / 2;
    }
    // Which factors faces get: first the largest that makes pieces enough, then, a few times over, the one for which pieces and
    // neighbours of another factor cost least (iterated conditional modes; Besag 1986).
    void choose() {
        const kit::Array<Triangle> across = face_neighbors(mesh_);
        chosen_.assign(mesh_.face_count, static_cast<std::uint8_t>(ways - 1));
        for (int sweep = 0; sweep <= choices; ++sweep)
            for (std::size_t f = 0; f < mesh_.face_count; ++f) {
                const double face_range = range(mesh_.faces[f]), wanted = pieces_per_px * area(mesh_.faces[f]);
                double least = 0;
                std::size_t best = ways;
                for (std::size_t w = 0; w < ways; ++w) {
                    double cost = shading_pieces(face_range, color_factors[w]);
                    if (cost < wanted && w + 1 < ways) continue;
                    if (sweep > 0)
                        for (const std::uint32_t g : across[f])
                            if (g != no_face && chosen_[g] != w) cost += pieces_per_cut;
                    if (best == ways || cost < least) least = cost, best = w;
                }
                chosen_[f] = static_cast<std::uint8_t>(best);
            }
    }

    const MeshView& mesh_;
    const std::size_t components_;
    const kit::Array<double>& shares_;
    kit::Array<std::uint8_t> chosen_;  // of each face, an index of color_factors
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_SHADING_PARTS_HPP
