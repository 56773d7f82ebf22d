#include "hmesh/methods/baselines/flip_queue.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::Edge;
using hmesh::kit::FlipTrial;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::ImageMesh;
using hmesh::kit::run_flip_queue;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

template <int C>
double pair_energy(const ImageMesh<C>& mesh, Edge e) {
    const Halfedge h = HalfedgeMesh::halfedge(e);
    return mesh.energy(mesh.topology().face(h)) + mesh.energy(mesh.topology().face(HalfedgeMesh::opposite(h)));
}

// The queue as a list that is searched from end to end. Returns what each flip gained.
template <int C>
std::vector<double> naive_flips(ImageMesh<C>& mesh, int visits) {
    const HalfedgeMesh& topology = mesh.topology();
    std::vector<bool> is_suspect(topology.edge_slots(), false);
    std::vector<int> count(topology.edge_slots(), 0);
    for (const Edge e : topology.edges()) is_suspect[e.index()] = !topology.is_boundary(e);
    std::vector<double> gains;
    for (;;) {
        Edge worst;
        for (const Edge e : topology.edges())
            if (is_suspect[e.index()] && (!worst.is_valid() || pair_energy(mesh, e) > pair_energy(mesh, worst))) worst = e;
        if (!worst.is_valid()) return gains;
        is_suspect[worst.index()] = false;
        ++count[worst.index()];
        if (!kit::can_flip(mesh, worst)) continue;
        FlipTrial<C> trial;
        kit::evaluate_flip(mesh, worst, trial);
        if (!(trial.decrease > 1e-9 * pair_energy(mesh, worst))) continue;
        mesh.flip(worst, trial.moments, trial.own, trial.opposite);
        gains.push_back(trial.decrease);
        for (const Halfedge h : {HalfedgeMesh::halfedge(worst), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(worst))})
            for (const Halfedge side : {topology.next(h), topology.next(topology.next(h))}) {
                const Edge e = HalfedgeMesh::edge(side);
                if (!topology.is_boundary(e) && count[e.index()] < visits) is_suspect[e.index()] = true;
            }
    }
}

// The best flip that is left, as a share of what its faces cost.
template <int C>
double largest_gain(const ImageMesh<C>& mesh) {
    double largest = 0;
    for (const Edge e : mesh.topology().edges()) {
        if (!kit::can_flip(mesh, e)) continue;
        FlipTrial<C> trial;
        kit::evaluate_flip(mesh, e, trial);
        if (trial.decrease > 1e-9 * pair_energy(mesh, e)) largest = std::max(largest, trial.decrease / pair_energy(mesh, e));
    }
    return largest;
}

template <class T, int C>
void check_suspects(const hmesh::Image<T, C>& image, std::uint64_t seed) {
    const auto grid = hmesh_test::jittered_grid(image.width(), image.height(), 9, 8, seed);
    for (const int visits : {1, 2, 8, 1000000}) {
        Subject<T, C> subject(image, grid), naive(image, grid);
        hmesh_test::wear(subject.mesh, 60, hmesh::PixelTraits<T>::peak, seed);
        hmesh_test::wear(naive.mesh, 60, hmesh::PixelTraits<T>::peak, seed);
        ImageMesh<C>& mesh = subject.mesh;
        std::vector<int> valences(mesh.topology().vertex_slots(), 0);
        for (const Vertex v : mesh.topology().vertices()) {
            mesh.set_dirty(v, false);
            valences[v.index()] = mesh.topology().valence(v);
        }
        const double before = mesh.energy(), slack = hmesh_test::rounding(subject);
        const std::size_t flips = run_flip_queue(mesh, visits);
        hmesh_test::prove(subject);
        CHECK(flips > 5);
        CHECK(mesh.energy() < before);
        for (const Vertex v : mesh.topology().vertices())
            if (mesh.topology().valence(v) != valences[v.index()]) REQUIRE(mesh.is_dirty(v));
        // The same flips in the same order.
        const std::vector<double> gains = naive_flips(naive.mesh, visits);
        CHECK(gains.size() == flips);
        CHECK(hmesh_test::snapshot(mesh) == hmesh_test::snapshot(naive.mesh));
        double sum = 0;
        for (const double gain : gains) {
            CHECK(gain > 0);
            sum += gain;
        }
        CHECK(std::abs(before - mesh.energy() - sum) <= slack);
        if (visits > 1000) {
            CHECK(largest_gain(mesh) == 0);
            const auto still = hmesh_test::snapshot(mesh);
            CHECK(run_flip_queue(mesh, visits) == 0);
            CHECK(hmesh_test::snapshot(mesh) == still);
        }
    }
}

}  // namespace

TEST_CASE("suspects turn the worst pair of faces first, lower the energy by each turn, and leave none that would gain") {
    check_suspects(hmesh_test::scene<std::uint8_t, 3>(61, 50, 1), 1);
    check_suspects(hmesh_test::noise<std::uint16_t, 2>(60, 55, 2), 2);
    check_suspects(hmesh_test::scene<float, 1>(57, 52, 3), 3);
    check_suspects(hmesh_test::checkerboard<std::uint8_t, 1>(56, 48, 5), 4);
}

TEST_CASE("each suspect comes up once where it may no more often, which leaves flips that would gain") {
    std::size_t once = 0, often = 0;
    double left = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        for (const int visits : {1, 1000}) {
            Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(61, 50, seed),
                                             hmesh_test::jittered_grid(61, 50, 9, 8, seed));
            const std::size_t flips = run_flip_queue(subject.mesh, visits);
            CHECK(flips < subject.mesh.topology().edge_count() * static_cast<std::size_t>(visits));
            (visits == 1 ? once : often) += flips;
            if (visits == 1) left = std::max(left, largest_gain(subject.mesh));
        }
    CHECK(once < often);
    CHECK(left > 0);
}

TEST_CASE("a constant picture turns no suspect") {
    Subject<std::uint8_t, 3> subject(hmesh_test::constant_image<std::uint8_t, 3>(61, 50, 0.3),
                                     hmesh_test::jittered_grid(61, 50, 8, 7, 1));
    const auto before = hmesh_test::snapshot(subject.mesh);
    CHECK(run_flip_queue(subject.mesh, 100) == 0);
    CHECK(hmesh_test::snapshot(subject.mesh) == before);
    for (const int side : {1, 2, 9}) {
        Subject<std::uint8_t, 1> two(hmesh_test::constant_image<std::uint8_t, 1>(side, side, 0.3),
                                     hmesh_test::jittered_grid(side, side, 1, 1, 1));
        CHECK(run_flip_queue(two.mesh, 100) == 0);
        hmesh_test::prove(two);
    }
}

TEST_CASE("suspects do not turn into a vertex that has as many neighbors as it may") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(64, 64, 1), hmesh_test::wheel(64, kit::max_valence));
    CHECK(run_flip_queue(subject.mesh, 1000) > 0);
    for (const Vertex v : subject.mesh.topology().vertices()) CHECK(subject.mesh.topology().valence(v) <= kit::max_valence);
    hmesh_test::prove(subject);
}

TEST_CASE("work that is told to stop turns no more suspects") {
    Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(61, 50, 1), hmesh_test::jittered_grid(61, 50, 9, 8, 1));
    const auto stop = [](const hmesh::ProgressInfo&) { return false; };
    kit::ProgressReporter progress(stop, 1, 255);
    kit::TaskProgress task(progress, 1);
    subject.mesh.set_task(&task);
    const auto before = hmesh_test::snapshot(subject.mesh);
    (void)progress.poll();
    CHECK(run_flip_queue(subject.mesh, 8) == 0);
    CHECK(hmesh_test::snapshot(subject.mesh) == before);
    subject.mesh.set_task(nullptr);
    CHECK(run_flip_queue(subject.mesh, 8) > 0);
}
