/// \file
/// Handles: Vertex, Halfedge, Edge and Face, 4-byte indices of different types, so that they cannot be mixed up.
#ifndef HMESH_MESH_HANDLES_HPP
#define HMESH_MESH_HANDLES_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The index of an element of one kind. Default-constructed it refers to no element. No implicit conversion, in or out.
template <class Kind>
class Handle {
  public:
    /// Refers to no element.
    constexpr Handle() noexcept = default;
    /// Refers to the element at this index, below 2^32 - 1.
    constexpr explicit Handle(std::size_t index) noexcept : index_(static_cast<std::uint32_t>(index)) {}
    [[nodiscard]] constexpr std::size_t index() const noexcept { return index_; }      ///< the index
    [[nodiscard]] constexpr bool is_valid() const noexcept { return index_ != none; }  ///< whether it refers to an element
    friend constexpr bool operator==(Handle a, Handle b) noexcept { return a.index_ == b.index_; }  ///< same index
    friend constexpr bool operator!=(Handle a, Handle b) noexcept { return a.index_ != b.index_; }  ///< other index
    friend constexpr bool operator<(Handle a, Handle b) noexcept { return a.index_ < b.index_; }    ///< smaller index

  private:
    static constexpr std::uint32_t none = 0xffffffffU;
    std::uint32_t index_ = none;
};

/// A vertex of a mesh.
using Vertex = Handle<struct VertexKind>;
/// A half-edge: one of the two directions of an edge.
using Halfedge = Handle<struct HalfedgeKind>;
/// An edge of a mesh: two half-edges.
using Edge = Handle<struct EdgeKind>;
/// A face (triangle) of a mesh.
using Face = Handle<struct FaceKind>;

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_HANDLES_HPP
