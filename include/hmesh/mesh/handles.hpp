/// \file
/// Handles: Vertex, Halfedge, Edge and Face, indices of 4 bytes that do not mix.
#ifndef HMESH_MESH_HANDLES_HPP
#define HMESH_MESH_HANDLES_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// An index into one kind of element; default-constructed it names none. No implicit conversion, in or out.
template <class Kind>
class Handle {
  public:
    constexpr Handle() noexcept = default;
    constexpr explicit Handle(std::size_t index) noexcept : index_(static_cast<std::uint32_t>(index)) {}
    [[nodiscard]] constexpr std::size_t index() const noexcept { return index_; }
    [[nodiscard]] constexpr bool is_valid() const noexcept { return index_ != none; }
    friend constexpr bool operator==(Handle a, Handle b) noexcept { return a.index_ == b.index_; }
    friend constexpr bool operator!=(Handle a, Handle b) noexcept { return a.index_ != b.index_; }
    friend constexpr bool operator<(Handle a, Handle b) noexcept { return a.index_ < b.index_; }

  private:
    static constexpr std::uint32_t none = 0xffffffffU;
    std::uint32_t index_ = none;
};

/// A vertex of a mesh.
using Vertex = Handle<struct VertexKind>;
/// One of the two directions of an edge.
using Halfedge = Handle<struct HalfedgeKind>;
/// An edge of a mesh: two half-edges.
using Edge = Handle<struct EdgeKind>;
/// A triangle of a mesh.
using Face = Handle<struct FaceKind>;

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_HANDLES_HPP
