/// \file
/// Faces of a triangulation in an order of their own, and MaskCoder: which of them a mesh has.
#ifndef HMESH_IO_COMPACT_FACES_HPP
#define HMESH_IO_COMPACT_FACES_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/mixer.hpp"
#include "hmesh/io/compact/triangulation.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// All faces of a triangulation: each begins with its least point, and they are sorted by it, then by their second point.
[[nodiscard]] inline std::vector<Triangle> all_faces(const Triangulation& mesh) {
    using Index = Triangulation::Index;
    std::vector<Triangle> faces;
    faces.reserve(2 * mesh.point_count());
    for (Index v = 0; v < mesh.point_count(); ++v) {
        const std::size_t begin = faces.size();
        Index e = mesh.first(v);
        for (Index k = 0; k < mesh.degree(v); ++k, e = mesh.next(e)) {
            const Index second = mesh.to(e), third = second > v ? mesh.apex(e) : Triangulation::none;
            if (third != Triangulation::none && third > v) faces.push_back({v, second, third});
        }
        std::sort(faces.begin() + static_cast<std::ptrdiff_t>(begin), faces.end());
    }
    return faces;
}

/// Codes which faces are shown, of those that all_faces() gives, in this order: each in the context of what is known of the faces
/// beside it.
class MaskCoder {
  public:
    /// With the coder that it writes to or reads from, which outlives it.
    explicit MaskCoder(ArithmeticCoder& coder) noexcept : coder_(&coder) {}

    /// `shown` has a place for each face. False: what is read ended before.
    bool code(const Triangulation& mesh, const std::vector<Triangle>& faces, std::vector<bool>& shown) {
        using Index = Triangulation::Index;
        enum : std::uint8_t { unknown, hidden, seen };
        std::vector<std::uint8_t> left_of(mesh.edge_slots(), unknown);
        for (std::size_t f = 0; f < faces.size(); ++f) {
            std::array<Index, 3> sides{};
            sides[0] = mesh.find(faces[f][0], faces[f][1]);
            for (std::size_t k = 1; k < 3; ++k) sides[k] = mesh.previous(Triangulation::opposite(sides[k - 1]));
            std::array<std::size_t, 3> count{};
            for (const Index side : sides) ++count[left_of[Triangulation::opposite(side)]];
            shown[f] = contexts_[count[hidden] * 4 + count[seen]].code(*coder_, shown[f]);
            for (const Index side : sides) left_of[side] = shown[f] ? seen : hidden;
            if (coder_->is_exhausted()) return false;
        }
        return true;
    }

  private:
    ArithmeticCoder* coder_;
    std::array<AdaptiveBit, 16> contexts_{};
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_FACES_HPP
