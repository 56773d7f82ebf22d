#include "hmesh/mesh/handles.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <type_traits>
#include <utility>

using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::Vertex;

namespace {

template <class A, class B, class = void>
struct Comparable : std::false_type {};
template <class A, class B>
struct Comparable<A, B, std::void_t<decltype(std::declval<A>() == std::declval<B>())>> : std::true_type {};

template <class A, class B>
constexpr bool mix = std::is_constructible_v<A, B> || std::is_assignable_v<A&, B> || Comparable<A, B>::value;

template <class Handle>
constexpr bool is_plain_index = sizeof(Handle) == 4 && std::is_trivially_copyable_v<Handle> &&
                                !std::is_convertible_v<Handle, std::size_t> && !std::is_convertible_v<Handle, bool> &&
                                !std::is_convertible_v<std::size_t, Handle> && !std::is_convertible_v<int, Handle> &&
                                !std::is_assignable_v<Handle&, std::size_t> && !Comparable<Handle, std::size_t>::value
                                && Comparable<Handle, Handle>::value;

static_assert(is_plain_index<Vertex> && is_plain_index<Halfedge> && is_plain_index<Edge> && is_plain_index<Face>);
static_assert(!mix<Vertex, Halfedge> && !mix<Vertex, Edge> && !mix<Vertex, Face>);
static_assert(!mix<Halfedge, Vertex> && !mix<Halfedge, Edge> && !mix<Halfedge, Face>);
static_assert(!mix<Edge, Vertex> && !mix<Edge, Halfedge> && !mix<Edge, Face>);
static_assert(!mix<Face, Vertex> && !mix<Face, Halfedge> && !mix<Face, Edge>);
static_assert(!Vertex().is_valid() && Vertex(0).is_valid() && Vertex(7).index() == 7, "usable in constant expressions");

}  // namespace

TEST_CASE("handles compare by index, and one that names none equals only its like") {
    CHECK(Face(3) == Face(3));
    CHECK(Face(3) != Face(4));
    CHECK(Face(3) < Face(4));
    CHECK_FALSE(Face(4) < Face(4));
    CHECK(Edge() == Edge());
    CHECK(Edge() != Edge(0));
    CHECK(Vertex(0xfffffffeU).is_valid());
    CHECK(Vertex(0xfffffffeU).index() == 0xfffffffeU);
}
