/// \file
/// Fans: which faces around a vertex hang together.
///
/// Where a mesh is cut, several fans of the faces that are left may meet in one vertex, edge to edge within each. A half-edge
/// mesh wants a vertex for each of them.
#ifndef HMESH_TILES_FANS_HPP
#define HMESH_TILES_FANS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A corner of a face, at a vertex in which fans may meet.
struct FanCorner {
    std::uint32_t vertex,  ///< which
        face,              ///< of which face
        corner;            ///< its place in the face, 0 to 2
    std::uint32_t next,    ///< the face's next vertex
        previous;          ///< and the one before
    std::uint32_t fan;     ///< the place of the first corner of the vertex that is of the same fan
};

/// Sorts corners by vertex and face, finds their fans, and calls body(begin, end) for those of each vertex. O(corners); of each
/// vertex the square of its corners, times as many passes as its fans take, of which there is one more than corners at most.
HMESH_COLD inline void find_fans(Array<FanCorner>& corners, FunctionRef<void(std::size_t begin, std::size_t end)> body) {
    corners = in_order(
        corners, sorted_numbers(corners.size(), [&](std::uint32_t k) { return code_of(corners[k].vertex, corners[k].face); }));
    for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
        while (end < corners.size() && corners[end].vertex == corners[begin].vertex) ++end;
        // Faces that share an edge at this vertex are of one fan: the first corner of a fan spreads over it.
        for (std::size_t i = begin; i < end; ++i) corners[i].fan = static_cast<std::uint32_t>(i);
        for (bool changed = true; changed;) {
            changed = false;
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t k = begin; k < end; ++k)
                    if (corners[i].previous == corners[k].next && corners[i].fan != corners[k].fan) {
                        corners[i].fan = corners[k].fan = std::min(corners[i].fan, corners[k].fan);
                        changed = true;
                    }
        }
        body(begin, end);
    }
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_FANS_HPP
