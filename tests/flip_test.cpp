#include "hmesh/edit/flip.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::FlipTrial;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::ImageMesh;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

Face own_face(const HalfedgeMesh& topology, Edge e) { return topology.face(HalfedgeMesh::halfedge(e)); }
Face opposite_face(const HalfedgeMesh& topology, Edge e) {
    return topology.face(HalfedgeMesh::opposite(HalfedgeMesh::halfedge(e)));
}

// Each face by its corners, smallest first, and its energy; sorted.
template <int C>
std::vector<std::pair<std::array<std::size_t, 3>, double>> triangles(const ImageMesh<C>& mesh) {
    std::vector<std::pair<std::array<std::size_t, 3>, double>> all;
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        std::array<std::size_t, 3> corners = {v[0].index(), v[1].index(), v[2].index()};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        all.emplace_back(corners, mesh.energy(f));
    }
    std::sort(all.begin(), all.end());
    return all;
}

template <class T, int C>
void check_turns(hmesh::Image<T, C> image, double range, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, 5, 4, seed));
    ImageMesh<C>& mesh = subject.mesh;
    hmesh_test::wear(mesh, 80, range, seed);
    int turned = 0, stiff = 0;
    for (const Edge e : mesh.topology().edges()) {
        const HalfedgeMesh& topology = mesh.topology();
        // The test by hand: two faces, both faces after the turn large enough.
        bool can_turn = !topology.is_boundary(e);
        if (can_turn) {
            const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
            const auto p = [&](Halfedge h) { return mesh.position(topology.to_vertex(h)); };
            const double least = mesh.limits().min_double_area;
            can_turn = hmesh::kit::orient2d(p(topology.next(b)), p(topology.next(a)), p(b)) >= least &&
                       hmesh::kit::orient2d(p(topology.next(a)), p(topology.next(b)), p(a)) >= least;
            if (can_turn) REQUIRE(topology.is_flip_ok(e));
        }
        REQUIRE(hmesh::kit::can_flip(mesh, e) == can_turn);
        if (!can_turn) {
            ++stiff;
            const auto before = hmesh_test::snapshot(mesh);
            REQUIRE(hmesh::kit::improve_edge(mesh, e, 0) == 0);
            REQUIRE(hmesh_test::snapshot(mesh) == before);
            continue;
        }
        ++turned;
        const double slack = hmesh_test::rounding(subject), before = mesh.energy();
        const auto faces_before = triangles(mesh);
        FlipTrial<C> trial, back;
        hmesh::kit::evaluate_flip(mesh, e, trial);
        mesh.flip(e, trial.moments, trial.own, trial.opposite);
        REQUIRE(std::abs(trial.own - hmesh_test::brute_energy(subject, own_face(topology, e))) <= slack);
        REQUIRE(std::abs(trial.opposite - hmesh_test::brute_energy(subject, opposite_face(topology, e))) <= slack);
        REQUIRE(std::abs(before - mesh.energy() - trial.decrease) <= slack);
        hmesh_test::prove(subject);

        REQUIRE(hmesh::kit::can_flip(mesh, e));
        hmesh::kit::evaluate_flip(mesh, e, back);
        REQUIRE(std::abs(back.decrease + trial.decrease) <= slack);
        mesh.flip(e, back.moments, back.own, back.opposite);
        hmesh_test::prove(subject);
        const auto faces_after = triangles(mesh);
        REQUIRE(faces_after.size() == faces_before.size());
        for (std::size_t k = 0; k < faces_after.size(); ++k) {
            REQUIRE(faces_after[k].first == faces_before[k].first);
            REQUIRE(std::abs(faces_after[k].second - faces_before[k].second) <= slack);
        }

        // improve_edge turns the edge exactly if that gains more than asked for.
        if (trial.decrease > 1e-6 * before) {
            const auto unturned = hmesh_test::snapshot(mesh);
            REQUIRE(hmesh::kit::improve_edge(mesh, e, 1.001 * trial.decrease) == 0);
            REQUIRE(hmesh_test::snapshot(mesh) == unturned);
            const double start = mesh.energy(), decrease = hmesh::kit::improve_edge(mesh, e, 0.999 * trial.decrease);
            REQUIRE(std::abs(decrease - trial.decrease) <= slack);
            REQUIRE(std::abs(start - mesh.energy() - decrease) <= slack);
        } else if (trial.decrease < -1e-6 * before) {
            const auto unturned = hmesh_test::snapshot(mesh);
            REQUIRE(hmesh::kit::improve_edge(mesh, e, 0) == 0);
            REQUIRE(hmesh_test::snapshot(mesh) == unturned);
        }
    }
    CHECK(turned > 20);
    CHECK(stiff > 20);
}

template <class T, int C>
void check_queue(hmesh::Image<T, C> image, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, 8, 7, seed));
    ImageMesh<C>& mesh = subject.mesh;
    for (const Vertex v : mesh.topology().vertices()) mesh.set_dirty(v, false);
    std::vector<int> valences;
    for (const Vertex v : mesh.topology().vertices()) valences.push_back(mesh.topology().valence(v));
    const double before = mesh.energy(), least = 1e-4 * mesh.mean_energy();
    const std::size_t flips = hmesh::kit::flip_edges(mesh);
    CHECK(flips > 0);
    CHECK(before - mesh.energy() >= static_cast<double>(flips) * least);
    hmesh_test::prove(subject);
    // What is left gains nothing, and who has other neighbours now is due.
    for (const Edge e : mesh.topology().edges()) {
        if (!hmesh::kit::can_flip(mesh, e)) continue;
        FlipTrial<C> trial;
        hmesh::kit::evaluate_flip(mesh, e, trial);
        CHECK(trial.decrease <= least + hmesh_test::rounding(subject));
    }
    int due = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        due += mesh.is_dirty(v) ? 1 : 0;
        if (mesh.topology().valence(v) != valences[v.index()]) CHECK(mesh.is_dirty(v));
    }
    CHECK(due > 0);
    CHECK(due < static_cast<int>(mesh.vertex_count()));
    CHECK(hmesh::kit::flip_edges(mesh, 0) < 100 * mesh.topology().edge_count());
    CHECK(mesh.energy() <= before);
    hmesh_test::prove(subject);
}

}  // namespace

TEST_CASE("what a turn would do is what it does, twice is not at all, and only turns that gain enough are kept") {
    check_turns(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), 255, 1);
    check_turns(hmesh_test::noise<std::uint16_t, 1>(29, 25, 2), 65535, 2);
    check_turns(hmesh_test::scene<float, 4>(27, 28, 3), 1, 3);
    check_turns(hmesh_test::checkerboard<std::uint8_t, 2>(28, 24, 5), 255, 4);
}

TEST_CASE("turning edges until none gains more ends, lowers the energy by each turn, and makes those around it due") {
    check_queue(hmesh_test::scene<std::uint8_t, 3>(61, 50, 1), 1);
    check_queue(hmesh_test::noise<std::uint16_t, 2>(60, 55, 2), 2);
    check_queue(hmesh_test::scene<float, 1>(57, 52, 3), 3);
}

TEST_CASE("a constant picture turns no edge") {
    Subject<std::uint8_t, 3> subject(hmesh_test::constant_image<std::uint8_t, 3>(61, 50, 0.3),
                                     hmesh_test::jittered_grid(61, 50, 8, 7, 1));
    const auto before = hmesh_test::snapshot(subject.mesh);
    CHECK(hmesh::kit::flip_edges(subject.mesh) == 0);
    CHECK(hmesh::kit::flip_edges(subject.mesh, 0) == 0);
    CHECK(hmesh_test::snapshot(subject.mesh) == before);
}

TEST_CASE("an edge does not turn into a vertex that has as many neighbors as it may") {
    for (const int spokes : {hmesh::kit::max_valence - 4, hmesh::kit::max_valence}) {
        Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(64, 64, 1), hmesh_test::wheel(64, spokes));
        hmesh_test::prove(subject);
        const HalfedgeMesh& topology = subject.mesh.topology();
        const Vertex hub(0);
        REQUIRE(topology.valence(hub) == spokes);
        int turned = 0;
        for (const Halfedge h : topology.outgoing(hub)) {  // the chords
            const Edge chord = HalfedgeMesh::edge(topology.next(h));
            turned += hmesh::kit::can_flip(subject.mesh, chord) ? 1 : 0;
        }
        CHECK(turned == (spokes < hmesh::kit::max_valence ? 4 : 0));
    }
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(64, 64, 1),
                                     hmesh_test::wheel(64, hmesh::kit::max_valence - 4));
    Random random(1);
    for (int k = 0; k < 2000; ++k) {
        const Edge e = hmesh_test::any_edge(subject.mesh, random);
        if (!hmesh::kit::can_flip(subject.mesh, e)) continue;
        FlipTrial<1> trial;
        hmesh::kit::evaluate_flip(subject.mesh, e, trial);
        subject.mesh.flip(e, trial.moments, trial.own, trial.opposite);
        for (const Vertex v : subject.mesh.topology().vertices())
            REQUIRE(subject.mesh.topology().valence(v) <= hmesh::kit::max_valence);
    }
    hmesh_test::prove(subject);
}
