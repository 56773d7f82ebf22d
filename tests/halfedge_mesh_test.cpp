#include "hmesh/mesh/halfedge_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"

using hmesh::Errc;
using hmesh::Triangle;
using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::Random;
using hmesh::kit::Vertex;

namespace {

using Triangles = std::vector<Triangle>;

// --- meshes to start from ---

struct Input {
    std::size_t vertices = 0;
    Triangles triangles;
};

// Rectangles cut by diagonals that alternate; `hole` leaves out the middle one.
Input grid(std::uint32_t columns, std::uint32_t rows, bool hole = false) {
    Input input{(columns + 1) * (rows + 1), {}};
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            if (hole && i == columns / 2 && j == rows / 2) continue;
            const std::uint32_t a = j * (columns + 1) + i, b = a + 1, d = a + columns + 1, c = d + 1;
            const bool rises = (i + j) % 2 != 0;
            input.triangles.push_back({a, b, rises ? d : c});
            input.triangles.push_back({rises ? b : a, c, d});
        }
    return input;
}

Input octahedron() { return {6, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {5, 2, 1}, {5, 3, 2}, {5, 4, 3}, {5, 1, 4}}}; }

HalfedgeMesh mesh_of(const Input& input) {
    HalfedgeMesh mesh;
    REQUIRE(mesh.assign(input.vertices, input.triangles));
    return mesh;
}

// --- the same mesh as a list of triangles, and the edits by search and replacement ---

Triangle canonical(Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

Triangles canonical(Triangles list) {
    for (Triangle& t : list) t = canonical(t);
    std::sort(list.begin(), list.end());
    return list;
}

std::uint32_t id(Vertex v) { return static_cast<std::uint32_t>(v.index()); }

Triangles triangles_of(const HalfedgeMesh& mesh) {
    Triangles list;
    for (const Face f : mesh.faces()) {
        const std::array<Vertex, 3> v = mesh.vertices(f);
        list.push_back({id(v[0]), id(v[1]), id(v[2])});
    }
    return canonical(list);
}

// Where the side from a to b is: its triangle turned so that it begins with a, b. The end of the list if nowhere.
Triangles::iterator find_side(Triangles& list, std::uint32_t a, std::uint32_t b) {
    for (auto t = list.begin(); t != list.end(); ++t)
        for (int turn = 0; turn < 3; ++turn) {
            if ((*t)[0] == a && (*t)[1] == b) return t;
            std::rotate(t->begin(), t->begin() + 1, t->end());
        }
    return list.end();
}

void model_flip(Triangles& list, std::uint32_t a, std::uint32_t b) {
    Triangle& own = *find_side(list, a, b);
    const std::uint32_t c = own[2];
    Triangle& other = *find_side(list, b, a);
    const std::uint32_t d = other[2];
    // References stay: only the order of corners changes within find_side.
    own = {d, c, a};
    other = {c, d, b};
}

void model_split_edge(Triangles& list, std::uint32_t a, std::uint32_t b, std::uint32_t m) {
    for (int side = 0; side < 2; ++side, std::swap(a, b)) {
        const auto t = find_side(list, a, b);
        if (t == list.end()) continue;
        const std::uint32_t c = (*t)[2];
        *t = {a, m, c};
        list.push_back({m, b, c});
    }
}

void model_split_face(Triangles& list, Triangle t, std::uint32_t m) {
    list.erase(std::find(list.begin(), list.end(), canonical(t)));
    list.insert(list.end(), {{t[0], t[1], m}, {t[1], t[2], m}, {t[2], t[0], m}});
}

void model_collapse(Triangles& list, std::uint32_t v, std::uint32_t u) {
    for (Triangle& t : list) std::replace(t.begin(), t.end(), v, u);
    list.erase(
        std::remove_if(list.begin(), list.end(), [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }),
        list.end());
}

bool model_has_edge(Triangles list, std::uint32_t a, std::uint32_t b) {
    return find_side(list, a, b) != list.end() || find_side(list, b, a) != list.end();
}

// The link condition: with every boundary closed by a fan to an extra vertex, the links of v and u meet in the far
// corners of their edge and nothing else. A boundary vertex moves along the boundary only.
bool model_collapse_ok(Triangles list, std::uint32_t v, std::uint32_t u) {
    constexpr std::uint32_t outside = 0xffffffffU;
    const Triangles faces = list;
    const bool open_edge = find_side(list, v, u) == list.end() || find_side(list, u, v) == list.end();
    bool v_on_boundary = false;
    for (const Triangle& t : faces)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            if (find_side(list, b, a) != list.end()) continue;
            v_on_boundary = v_on_boundary || a == v || b == v;
            list.push_back({b, a, outside});
        }
    if (v_on_boundary && !open_edge) return false;

    using Link = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    const auto link = [&list](std::uint32_t center) {
        Link sides;
        for (Triangle t : list) {
            const auto found = std::find(t.begin(), t.end(), center);
            if (found == t.end()) continue;
            std::rotate(t.begin(), found, t.end());
            sides.emplace_back(std::min(t[1], t[2]), std::max(t[1], t[2]));
        }
        return sides;
    };
    const auto has_vertex = [](const Link& sides, std::uint32_t x) {
        return std::any_of(sides.begin(), sides.end(), [x](const auto& side) { return side.first == x || side.second == x; });
    };
    const Link of_v = link(v), of_u = link(u);
    for (const auto& side : of_v) {
        if (std::find(of_u.begin(), of_u.end(), side) != of_u.end()) return false;
        for (const std::uint32_t x : {side.first, side.second}) {
            const bool far_corner = std::any_of(of_u.begin(), of_u.end(), [&](const auto& other) {
                return (other.first == x && other.second == v) || (other.second == x && other.first == v);
            });
            if (x != u && has_vertex(of_u, x) && !far_corner) return false;
        }
    }
    return true;
}

// --- random edits ---

enum class Kind { flip, split_edge, split_face, collapse };
struct Edit {
    Kind kind = Kind::flip;
    std::size_t element = 0;
};

// An edit that its predicate allows. Small meshes grow more often than they shrink, large ones the other way round.
Edit draw(const HalfedgeMesh& mesh, Random& random, std::size_t usual_size) {
    for (;;) {
        const std::size_t dice = random.below(8);
        const bool grow = random.below(2 * usual_size) >= mesh.vertex_count();
        if (dice < 3) {
            const Edge e(random.below(mesh.edge_slots()));
            if (!mesh.is_deleted(e) && mesh.is_flip_ok(e)) return {Kind::flip, e.index()};
        } else if (!grow) {
            const Halfedge h(random.below(2 * mesh.edge_slots()));
            if (!mesh.is_deleted(HalfedgeMesh::edge(h)) && mesh.is_collapse_ok(h)) return {Kind::collapse, h.index()};
        } else if (dice < 6) {
            const Edge e(random.below(mesh.edge_slots()));
            if (!mesh.is_deleted(e)) return {Kind::split_edge, e.index()};
        } else {
            const Face f(random.below(mesh.face_slots()));
            if (!mesh.is_deleted(f)) return {Kind::split_face, f.index()};
        }
    }
}

// The vertex that a split made.
Vertex apply(HalfedgeMesh& mesh, Edit edit) {
    switch (edit.kind) {
        case Kind::flip: mesh.flip(Edge(edit.element)); return {};
        case Kind::split_edge: return mesh.split(Edge(edit.element));
        case Kind::split_face: return mesh.split(Face(edit.element));
        default: mesh.collapse(Halfedge(edit.element)); return {};
    }
}

void apply_random_edits(HalfedgeMesh& mesh, Random& random, std::size_t usual_size, int count) {
    for (int i = 0; i < count; ++i) apply(mesh, draw(mesh, random, usual_size));
}

// Whether all slots, deleted ones too, hold the same.
bool same_state(const HalfedgeMesh& a, const HalfedgeMesh& b) {
    if (a.vertex_slots() != b.vertex_slots() || a.edge_slots() != b.edge_slots() || a.face_slots() != b.face_slots() ||
        a.vertex_count() != b.vertex_count() || a.edge_count() != b.edge_count() || a.face_count() != b.face_count())
        return false;
    for (std::size_t i = 0; i < a.vertex_slots(); ++i)
        if (a.halfedge(Vertex(i)) != b.halfedge(Vertex(i))) return false;
    for (std::size_t i = 0; i < a.face_slots(); ++i)
        if (a.halfedge(Face(i)) != b.halfedge(Face(i))) return false;
    for (std::size_t i = 0; i < 2 * a.edge_slots(); ++i) {
        const Halfedge h(i);
        if (a.next(h) != b.next(h) || a.to_vertex(h) != b.to_vertex(h) || a.face(h) != b.face(h)) return false;
    }
    return true;
}

std::ptrdiff_t euler(const HalfedgeMesh& mesh) {
    return static_cast<std::ptrdiff_t>(mesh.vertex_count()) - static_cast<std::ptrdiff_t>(mesh.edge_count()) +
           static_cast<std::ptrdiff_t>(mesh.face_count());
}

}  // namespace

TEST_CASE("HalfedgeMesh: after each of thousands of random edits check() passes and the triangles are the right ones") {
    for (const Input& input : {grid(4, 3), grid(1, 1), grid(5, 3, true), octahedron()}) {
        HalfedgeMesh mesh = mesh_of(input);
        Triangles model = canonical(input.triangles);
        Random random(1);
        int kinds[4] = {}, broken = 0, different = 0;
        for (int step = 0; step < 2500 && broken == 0; ++step) {
            const Edit edit = draw(mesh, random, 30);
            ++kinds[static_cast<int>(edit.kind)];
            const Halfedge h = edit.kind == Kind::collapse ? Halfedge(edit.element) : HalfedgeMesh::halfedge(Edge(edit.element));
            const bool on_edge = edit.kind != Kind::split_face;
            const std::uint32_t a = on_edge ? id(mesh.from_vertex(h)) : 0, b = on_edge ? id(mesh.to_vertex(h)) : 0;
            const std::array<Vertex, 3> corners = on_edge ? std::array<Vertex, 3>() : mesh.vertices(Face(edit.element));
            const Vertex m = apply(mesh, edit);
            switch (edit.kind) {
                case Kind::flip: model_flip(model, a, b); break;
                case Kind::split_edge: model_split_edge(model, a, b, id(m)); break;
                case Kind::split_face: model_split_face(model, {id(corners[0]), id(corners[1]), id(corners[2])}, id(m)); break;
                case Kind::collapse: model_collapse(model, a, b); break;
            }
            model = canonical(model);
            broken += !mesh.check();
            different += triangles_of(mesh) != model;
        }
        CHECK(broken == 0);
        CHECK(different == 0);
        for (const int count : kinds) CHECK(count > 300);
    }
}

TEST_CASE("HalfedgeMesh: two flips of an edge give the same triangles with the edge reversed, four the same mesh") {
    HalfedgeMesh mesh = mesh_of(grid(5, 4));
    Random random(2);
    int flipped = 0;
    for (int round = 0; round < 30; ++round, apply_random_edits(mesh, random, 25, 20))
        for (const Edge e : mesh.edges()) {
            if (!mesh.is_flip_ok(e)) continue;
            ++flipped;
            const Triangles before = triangles_of(mesh);
            const Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
            const Vertex from = mesh.from_vertex(h), to = mesh.to_vertex(h);
            const Vertex own_far = mesh.to_vertex(mesh.next(h)), other_far = mesh.to_vertex(mesh.next(o));
            mesh.flip(e);
            CHECK(mesh.from_vertex(h) == other_far);
            CHECK(mesh.to_vertex(h) == own_far);
            CHECK(triangles_of(mesh) != before);
            mesh.flip(e);
            CHECK(mesh.from_vertex(h) == to);
            CHECK(mesh.to_vertex(h) == from);
            CHECK(triangles_of(mesh) == before);
            mesh.flip(e);
            mesh.flip(e);
            CHECK(mesh.from_vertex(h) == from);
            CHECK(triangles_of(mesh) == before);
        }
    CHECK(flipped > 1000);
}

TEST_CASE("HalfedgeMesh: is_flip_ok allows exactly the edges with two faces whose far corners are no neighbors") {
    Random random(3);
    int allowed = 0, refused = 0, wrong = 0;
    for (const Input& input : {grid(1, 1), grid(2, 2), octahedron(), grid(3, 3, true)}) {
        HalfedgeMesh mesh = mesh_of(input);
        for (int round = 0; round < 60; ++round, apply_random_edits(mesh, random, 8, 5))
            for (const Edge e : mesh.edges()) {
                Triangles list = triangles_of(mesh);
                const std::uint32_t a = id(mesh.from_vertex(HalfedgeMesh::halfedge(e))),
                                    b = id(mesh.to_vertex(HalfedgeMesh::halfedge(e)));
                const auto own = find_side(list, a, b);
                const std::uint32_t c = own == list.end() ? a : (*own)[2];
                const auto other = find_side(list, b, a);
                const std::uint32_t d = other == list.end() ? a : (*other)[2];
                const bool ok = own != list.end() && other != list.end() && !model_has_edge(list, c, d);
                wrong += mesh.is_flip_ok(e) != ok;
                (ok ? allowed : refused) += 1;
            }
    }
    CHECK(wrong == 0);
    CHECK(allowed > 100);
    CHECK(refused > 100);
}

TEST_CASE("HalfedgeMesh: is_collapse_ok is the link condition, and what it allows leaves a valid mesh") {
    Random random(4);
    int allowed = 0, refused = 0, wrong = 0, broken = 0;
    for (const Input& input : {grid(1, 1), grid(2, 1), grid(2, 2), grid(3, 3, true), octahedron()}) {
        HalfedgeMesh mesh = mesh_of(input);
        // Ends at the first mistake: edits of a mesh that is broken may never end.
        for (int round = 0; round < 120 && wrong + broken == 0; ++round, apply_random_edits(mesh, random, 7, 1)) {
            const Triangles list = triangles_of(mesh);
            for (const Edge e : mesh.edges())
                for (const Halfedge h : {HalfedgeMesh::halfedge(e), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(e))}) {
                    const std::uint32_t v = id(mesh.from_vertex(h)), u = id(mesh.to_vertex(h));
                    const bool ok = mesh.is_collapse_ok(h);
                    (ok ? allowed : refused) += 1;
                    wrong += ok != model_collapse_ok(list, v, u);
                    if (!ok) continue;
                    HalfedgeMesh after = mesh;
                    after.collapse(h);
                    Triangles expected = list;
                    model_collapse(expected, v, u);
                    broken += !after.check() || triangles_of(after) != canonical(expected);
                }
        }
    }
    CHECK(wrong == 0);
    CHECK(broken == 0);
    CHECK(allowed > 1000);
    CHECK(refused > 1000);
}

TEST_CASE("HalfedgeMesh: the last triangle of a component and the last tetrahedron do not collapse") {
    const Input triangle{3, {{0, 1, 2}}}, tetrahedron{4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
    for (const Input& input : {triangle, tetrahedron}) {
        const HalfedgeMesh mesh = mesh_of(input);
        int allowed = 0;
        for (std::size_t i = 0; i < 2 * mesh.edge_slots(); ++i) allowed += mesh.is_collapse_ok(Halfedge(i));
        CHECK(allowed == 0);
    }
}

TEST_CASE("HalfedgeMesh: split and collapse change the counts by Euler's formula") {
    Random random(5);
    for (const Input& input : {grid(4, 4), grid(5, 5, true), octahedron()}) {
        HalfedgeMesh mesh = mesh_of(input);
        const std::ptrdiff_t characteristic = euler(mesh);
        int wrong = 0;
        for (int step = 0; step < 2000; ++step) {
            const std::size_t vertices = mesh.vertex_count(), edges = mesh.edge_count(), faces = mesh.face_count();
            const Edit edit = draw(mesh, random, 40);
            bool open = false;
            if (edit.kind == Kind::collapse) open = mesh.is_boundary(HalfedgeMesh::edge(Halfedge(edit.element)));
            if (edit.kind == Kind::split_edge) open = mesh.is_boundary(Edge(edit.element));
            const bool adds = edit.kind == Kind::split_edge || edit.kind == Kind::split_face;
            const std::size_t dv = edit.kind == Kind::flip ? 0 : 1, df = dv * (open ? 1 : 2), de = df + dv;
            apply(mesh, edit);
            wrong += mesh.vertex_count() != (adds ? vertices + dv : vertices - dv);
            wrong += mesh.edge_count() != (adds ? edges + de : edges - de);
            wrong += mesh.face_count() != (adds ? faces + df : faces - df);
            wrong += euler(mesh) != characteristic;
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("HalfedgeMesh: a split edge keeps its origin and ends at the new vertex, which has the far corners as neighbors") {
    HalfedgeMesh mesh = mesh_of(grid(4, 4));
    Random random(6);
    for (int step = 0; step < 500; ++step, apply_random_edits(mesh, random, 25, 3)) {
        const Edge e(draw(mesh, random, 25).element % mesh.edge_slots());
        if (mesh.is_deleted(e)) continue;
        const Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
        const Vertex from = mesh.from_vertex(h), to = mesh.to_vertex(h);
        std::vector<Vertex> expected{from, to};
        for (const Halfedge side : {h, o})
            if (!mesh.is_boundary(side)) expected.push_back(mesh.to_vertex(mesh.next(side)));
        const bool open = mesh.is_boundary(e);
        const Vertex m = mesh.split(e);
        CHECK(mesh.from_vertex(h) == from);
        CHECK(mesh.to_vertex(h) == m);
        CHECK(mesh.is_boundary(m) == open);
        std::vector<Vertex> neighbors;
        for (const Halfedge spoke : mesh.outgoing(m)) neighbors.push_back(mesh.to_vertex(spoke));
        std::sort(neighbors.begin(), neighbors.end());
        std::sort(expected.begin(), expected.end());
        CHECK(neighbors == expected);
    }
}

TEST_CASE("HalfedgeMesh: a collapse deletes three edges, or two on the boundary, and keeps the others") {
    HalfedgeMesh mesh = mesh_of(grid(5, 5));
    Random random(7);
    int collapsed = 0, wrong = 0;
    for (int step = 0; step < 3000; ++step) {
        const Edit edit = draw(mesh, random, 30);
        if (edit.kind != Kind::collapse) {
            apply(mesh, edit);
            continue;
        }
        ++collapsed;
        const Halfedge h(edit.element), o = HalfedgeMesh::opposite(h);
        const Vertex v = mesh.from_vertex(h), u = mesh.to_vertex(h);
        const HalfedgeMesh before = mesh;
        std::vector<Edge> goes{HalfedgeMesh::edge(h)};
        if (!mesh.is_boundary(h)) goes.push_back(HalfedgeMesh::edge(mesh.next(mesh.next(h))));
        if (!mesh.is_boundary(o)) goes.push_back(HalfedgeMesh::edge(mesh.next(o)));
        mesh.collapse(h);
        wrong += !mesh.is_deleted(v) || mesh.is_deleted(u);
        for (const Edge e : before.edges()) {
            const bool is_gone = std::find(goes.begin(), goes.end(), e) != goes.end();
            wrong += mesh.is_deleted(e) != is_gone;
            if (is_gone) continue;
            for (const Halfedge side : {HalfedgeMesh::halfedge(e), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(e))}) {
                const Vertex end = before.to_vertex(side);
                wrong += mesh.to_vertex(side) != (end == v ? u : end);
            }
        }
    }
    CHECK(collapsed > 300);
    CHECK(wrong == 0);
}

TEST_CASE("HalfedgeMesh: a rollback restores every slot and count, and the handles that come next") {
    for (const Input& input : {grid(4, 3), grid(5, 3, true), octahedron()}) {
        HalfedgeMesh mesh = mesh_of(input);
        Random random(8);
        int different = 0, later_different = 0;
        for (int round = 0; round < 300; ++round) {
            HalfedgeMesh before = mesh;
            const HalfedgeMesh::Mark mark = mesh.begin();
            apply_random_edits(mesh, random, 25, 1 + static_cast<int>(random.below(30)));
            mesh.rollback(mark);
            different += !same_state(mesh, before) || !mesh.check();
            // The same edits from here on give the same handles.
            for (int i = 0; i < 15; ++i) {
                const Edit edit = draw(before, random, 25);
                later_different += apply(mesh, edit) != apply(before, edit);
            }
            later_different += !same_state(mesh, before);
        }
        CHECK(different == 0);
        CHECK(later_different == 0);
    }
}

TEST_CASE("HalfedgeMesh: transactions nest; what the inner one keeps the outer one can still undo") {
    HalfedgeMesh mesh = mesh_of(grid(4, 4));
    Random random(9);
    int different = 0;
    for (int round = 0; round < 300; ++round) {
        std::vector<HalfedgeMesh::Mark> marks;
        std::vector<HalfedgeMesh> states;
        for (std::size_t depth = 1 + random.below(4); depth > 0; --depth) {
            states.push_back(mesh);
            marks.push_back(mesh.begin());
            apply_random_edits(mesh, random, 25, static_cast<int>(random.below(8)));
        }
        while (!marks.empty()) {
            const HalfedgeMesh now = mesh;
            const bool keep = random.below(2) == 0;
            if (keep) mesh.commit(marks.back());
            else mesh.rollback(marks.back());
            different += !same_state(mesh, keep ? now : states.back()) || !mesh.check();
            marks.pop_back();
            states.pop_back();
            if (!marks.empty()) apply_random_edits(mesh, random, 25, static_cast<int>(random.below(4)));
        }
    }
    CHECK(different == 0);
}

TEST_CASE("HalfedgeMesh: the ranges visit the live elements once, in order") {
    HalfedgeMesh mesh = mesh_of(grid(4, 4));
    Random random(10);
    const auto count = [](const auto& range, const auto& is_deleted) {
        std::size_t visited = 0;
        std::ptrdiff_t last = -1;
        for (const auto element : range) {
            const auto index = static_cast<std::ptrdiff_t>(element.index());
            if (index <= last || is_deleted(element)) return std::size_t{0};
            last = index;
            ++visited;
        }
        return visited;
    };
    for (int round = 0; round < 100; ++round, apply_random_edits(mesh, random, 20, 10)) {
        const auto is_deleted = [&mesh](auto element) { return mesh.is_deleted(element); };
        CHECK(count(mesh.vertices(), is_deleted) == mesh.vertex_count());
        CHECK(count(mesh.edges(), is_deleted) == mesh.edge_count());
        CHECK(count(mesh.faces(), is_deleted) == mesh.face_count());
    }
    const HalfedgeMesh empty;
    CHECK_FALSE(empty.vertices().begin() != empty.vertices().end());
}

TEST_CASE("HalfedgeMesh: a one-ring holds each neighbor once, against the orientation of the faces, the boundary first") {
    HalfedgeMesh mesh = mesh_of(grid(4, 4, true));
    Random random(11);
    int wrong = 0;
    for (int round = 0; round < 60; ++round, apply_random_edits(mesh, random, 25, 10))
        for (const Vertex v : mesh.vertices()) {
            Triangles list = triangles_of(mesh);
            std::vector<std::uint32_t> ring, expected;
            for (const Halfedge h : mesh.outgoing(v)) {
                wrong += mesh.from_vertex(h) != v;
                wrong += mesh.find_halfedge(v, mesh.to_vertex(h)) != h;
                // Face i joins the centre, neighbour i and neighbour i - 1.
                if (!ring.empty()) wrong += find_side(list, id(v), id(mesh.to_vertex(h))) == list.end();
                if (!ring.empty()) wrong += (*find_side(list, id(v), id(mesh.to_vertex(h))))[2] != ring.back();
                wrong += mesh.is_boundary(h) && !ring.empty();
                ring.push_back(id(mesh.to_vertex(h)));
            }
            wrong += mesh.is_boundary(v) != mesh.is_boundary(mesh.halfedge(v));
            wrong += mesh.valence(v) != static_cast<int>(ring.size());
            for (const Triangle& t : list)
                if (std::find(t.begin(), t.end(), id(v)) != t.end())
                    for (const std::uint32_t corner : t)
                        if (corner != id(v)) expected.push_back(corner);
            std::sort(expected.begin(), expected.end());
            expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
            std::sort(ring.begin(), ring.end());
            wrong += ring != expected;
            for (const Vertex other : mesh.vertices())
                if (!std::binary_search(expected.begin(), expected.end(), id(other)))
                    wrong += mesh.find_halfedge(v, other).is_valid();
        }
    CHECK(wrong == 0);
}

TEST_CASE("HalfedgeMesh: previous undoes next, and boundary half-edges run around the boundary against the faces") {
    HalfedgeMesh mesh = mesh_of(grid(5, 5, true));
    Random random(12);
    int wrong = 0;
    for (int round = 0; round < 60; ++round, apply_random_edits(mesh, random, 30, 10)) {
        std::size_t open = 0;
        for (const Edge e : mesh.edges())
            for (const Halfedge h : {HalfedgeMesh::halfedge(e), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(e))}) {
                wrong += mesh.previous(mesh.next(h)) != h || mesh.next(mesh.previous(h)) != h;
                wrong += HalfedgeMesh::edge(h) != e;
                if (!mesh.is_boundary(h)) continue;
                ++open;
                wrong += !mesh.is_boundary(mesh.next(h)) || !mesh.is_boundary(e) || mesh.is_boundary(HalfedgeMesh::opposite(h));
                wrong += mesh.halfedge(mesh.from_vertex(h)) != h;
            }
        CHECK(open >= 6);  // two loops of three at the least
    }
    CHECK(wrong == 0);
}

TEST_CASE("HalfedgeMesh: assign builds the triangles it is given, replaces what was there, and takes the empty mesh") {
    HalfedgeMesh mesh;
    for (const Input& input : {grid(6, 3), octahedron(), grid(4, 4, true), Input{3, {{2, 0, 1}}}, Input{}}) {
        CHECK(mesh.assign(input.vertices, input.triangles));
        CHECK(mesh.check());
        CHECK(triangles_of(mesh) == canonical(input.triangles));
        CHECK(mesh.vertex_count() == input.vertices);
        // Faces keep the order of the triangles and begin with their first corner.
        for (const Face f : mesh.faces()) CHECK(id(mesh.vertices(f)[0]) == input.triangles[f.index()][0]);
    }
    CHECK(mesh.edge_slots() == 0);
}

TEST_CASE("HalfedgeMesh: triangles() is what assign() was given, and after edits a list over the vertices that are left") {
    for (const Input& input : {grid(4, 3), grid(3, 3, true), octahedron(), Input{}})
        CHECK(mesh_of(input).triangles() == input.triangles);
    HalfedgeMesh mesh = mesh_of(grid(4, 4));
    // The vertex in the middle goes: those after it move up by one.
    const Vertex middle(12), neighbor(11);
    mesh.collapse(mesh.find_halfedge(middle, neighbor));
    const Triangles list = mesh.triangles();
    REQUIRE(list.size() == mesh.face_count());
    std::size_t k = 0;
    for (const Face f : mesh.faces()) {
        const std::array<Vertex, 3> v = mesh.vertices(f);
        for (std::size_t c = 0; c < 3; ++c) CHECK(list[k][c] == v[c].index() - (v[c].index() > 12 ? 1 : 0));
        ++k;
    }
    CHECK(mesh_of({mesh.vertex_count(), list}).edge_count() == mesh.edge_count());
}

TEST_CASE("HalfedgeMesh: clear forgets everything, deleted slots too") {
    HalfedgeMesh mesh = mesh_of(grid(4, 4));
    Random random(13);
    apply_random_edits(mesh, random, 10, 100);
    mesh.clear();
    CHECK(same_state(mesh, HalfedgeMesh()));
    CHECK(mesh.check());
    CHECK(mesh.assign(9, grid(2, 2).triangles));
    CHECK(same_state(mesh, mesh_of(grid(2, 2))));
}

TEST_CASE("HalfedgeMesh: assign refuses each kind of bad input, says where, and leaves the mesh empty") {
    struct Bad {
        Input input;
        const char* word;
        double value;
    };
    const Input tetrahedron{4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
    Input touching = tetrahedron;  // two tetrahedra that share vertex 0
    touching.vertices = 7;
    touching.triangles.insert(touching.triangles.end(), {{0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}});
    Input mixed = tetrahedron;  // a tetrahedron and a triangle that share vertex 0
    mixed.vertices = 6;
    mixed.triangles.push_back({0, 4, 5});
    const Bad cases[] = {
        {{4, {{0, 1, 2}, {0, 2, 4}}}, "does not exist", 1},
        {{4, {{0, 1, 0xffffffffU}, {0, 2, 3}}}, "does not exist", 0},
        {{0, {{0, 1, 2}}}, "does not exist", 0},
        {{3, {{0, 1, 2}, {0, 1, 1}}}, "twice", 1},
        {{3, {{2, 1, 2}}}, "twice", 0},
        {{3, {{0, 1, 2}, {0, 1, 2}}}, "twice in one direction", 0},
        {{4, {{0, 1, 2}, {0, 3, 2}, {0, 1, 3}}}, "twice in one direction", 0},
        {{4, {{0, 1, 2}, {1, 2, 3}}}, "twice in one direction", 0},             // turns the other way
        {{5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}}, "twice in one direction", 0},  // three faces at an edge
        {{4, {{0, 1, 2}}}, "no triangle", 3},
        {{4, {{1, 2, 3}}}, "no triangle", 0},
        {{2, {}}, "no triangle", 0},
        {{5, {{0, 1, 2}, {0, 3, 4}}}, "two fans", 0},
        {touching, "two fans", 0},
        {mixed, "two fans", 0},
        {{3, {{0, 1, 2}, {2, 1, 0}}}, "same corners", 0},  // of which edits make no mesh
        {{6, {{0, 1, 2}, {3, 4, 5}, {3, 5, 4}}}, "same corners", 3},
    };
    for (const Bad& bad : cases) {
        HalfedgeMesh mesh = mesh_of(grid(2, 2));
        const hmesh::Status status = mesh.assign(bad.input.vertices, bad.input.triangles);
        CHECK(status.code == Errc::invalid_argument);
        CHECK_MESSAGE(std::string(status.what).find(bad.word) != std::string::npos, status.what);
        CHECK(status.value == bad.value);
        CHECK(mesh.vertex_slots() + mesh.edge_slots() + mesh.face_slots() == 0);
        CHECK(mesh.vertex_count() + mesh.edge_count() + mesh.face_count() == 0);
        // The mesh is usable again.
        CHECK(mesh.assign(3, {{0, 1, 2}}));
    }
    HalfedgeMesh mesh;
    CHECK(mesh.assign(std::numeric_limits<std::size_t>::max() / 2, {}).code == Errc::image_too_large);
}

TEST_CASE("HalfedgeMesh: check() refuses a mesh put together from two states") {
    const auto sentence = [](const auto& edit, const auto& tamper) {
        HalfedgeMesh mesh = mesh_of(grid(3, 3));
        HalfedgeMesh::Mark mark = mesh.begin();
        edit(mesh);
        tamper(mark, mesh);
        mesh.rollback(mark);
        return std::string(mesh.check().what);
    };
    // A rollback to a mark that was tampered with restores a part of the mesh only.
    const auto nothing = [](HalfedgeMesh&) {};
    const auto split = [](HalfedgeMesh& mesh) { mesh.split(Face(4)); };
    const auto keep_halfedges = [](HalfedgeMesh::Mark& mark, HalfedgeMesh& mesh) { mark.halfedges = mesh.begin().halfedges; };
    const auto keep_vertices = [](HalfedgeMesh::Mark& mark, HalfedgeMesh& mesh) { mark.vertices = mesh.begin().vertices; };
    const auto keep_faces = [](HalfedgeMesh::Mark& mark, HalfedgeMesh& mesh) { mark.faces = mesh.begin().faces; };
    CHECK(sentence(nothing, [](HalfedgeMesh::Mark&, HalfedgeMesh&) {}).empty());
    CHECK(sentence(split, [](HalfedgeMesh::Mark&, HalfedgeMesh&) {}).empty());
    CHECK(sentence(split, keep_halfedges) == "a half-edge's face is none");
    CHECK(sentence(split, keep_vertices) == "a vertex's half-edge does not leave it");
    CHECK(sentence(split, keep_faces) == "a face's half-edge does not bound it");
    CHECK(sentence(nothing, [](HalfedgeMesh::Mark& mark, HalfedgeMesh&) { mark.counts.faces += 1; }) ==
          "a count of live elements is wrong");
    CHECK(sentence(nothing, [](HalfedgeMesh::Mark& mark, HalfedgeMesh&) { mark.counts.edges -= 1; }) ==
          "a count of live elements is wrong");
    CHECK(sentence(nothing, [](HalfedgeMesh::Mark& mark, HalfedgeMesh&) { mark.faces.size -= 1; }) ==
          "a half-edge's face is none");
    CHECK(sentence(nothing, [](HalfedgeMesh::Mark& mark, HalfedgeMesh&) { mark.vertices.size -= 1; }) ==
          "a half-edge points to no vertex");
}
