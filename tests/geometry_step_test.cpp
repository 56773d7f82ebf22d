#include "hmesh/methods/hierarchical/geometry_step.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/random.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"
#include "test_weighted.hpp"

namespace kit = hmesh::kit;
using Eigen::Index;
using Eigen::MatrixXd;
using hmesh::kit::FootSearch;
using hmesh::kit::GeometryStep;
using hmesh::kit::GeometrySystem;
using hmesh::kit::ImageMesh;
using hmesh::kit::Mobility;
using hmesh::kit::PcgReport;
using hmesh::kit::Point;
using hmesh::kit::StepRule;
using hmesh::kit::Vertex;
using hmesh_test::Subject;
using hmesh_test::Triangulation;
using hmesh_test::Weighted;

namespace {

bool is_held(const GeometrySystem& system, Index row, Index column) {
    return std::any_of(system.held.begin(), system.held.end(), [&](const kit::HeldEntry& entry) {
        return static_cast<Index>(entry.row) == row && static_cast<Index>(entry.column) == column;
    });
}

// The solution with what is held taken out of the system as known, factorised column by column; and in `residual` that of
// `solution` in the same systems, relative to their right-hand sides.
MatrixXd factorised(const GeometrySystem& system, const MatrixXd& solution, double& residual) {
    const Index n = system.gram.rows(), columns = system.rhs.cols();
    MatrixXd result = system.solution;
    residual = 0;
    for (Index k = 0; k < columns; ++k) {
        std::vector<int> place(static_cast<std::size_t>(n), -1);
        std::vector<Index> rows;
        for (Index i = 0; i < n; ++i) {
            if (is_held(system, i, k)) continue;
            place[static_cast<std::size_t>(i)] = static_cast<int>(rows.size());
            rows.push_back(i);
        }
        const auto count = static_cast<Index>(rows.size());
        if (count == 0) continue;
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd rhs(count), actual(count);
        for (Index r = 0; r < count; ++r) {
            const Index i = rows[static_cast<std::size_t>(r)];
            rhs[r] = system.rhs(i, k);
            actual[r] = solution(i, k);
            for (Eigen::SparseMatrix<double>::InnerIterator entry(system.gram, i); entry; ++entry) {
                const int column = place[static_cast<std::size_t>(entry.index())];
                if (column >= 0) entries.emplace_back(static_cast<int>(r), column, entry.value());
                else rhs[r] -= entry.value() * system.solution(entry.index(), k);
            }
        }
        Eigen::SparseMatrix<double> matrix(count, count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
        REQUIRE(solver.info() == Eigen::Success);
        const Eigen::VectorXd exact = solver.solve(rhs);
        for (Index r = 0; r < count; ++r) result(rows[static_cast<std::size_t>(r)], k) = exact[r];
        if (rhs.norm() > 0) residual = std::max(residual, (rhs - matrix * actual).norm() / rhs.norm());
    }
    return result;
}

template <int C>
void check_system(const ImageMesh<C>& mesh, FootSearch search, double color_scale) {
    GeometrySystem system = kit::geometry_system(mesh, search, color_scale, 1e-3);
    MatrixXd solution = system.solution;
    const PcgReport report = kit::solve_pcg(system.gram, system.rhs, solution, {500, 1e-9}, system.held);
    double residual = 0;
    const MatrixXd expected = factorised(system, solution, residual);
    CHECK(report.converged);
    for (Index k = 0; k < expected.cols(); ++k)
        CHECK((solution.col(k) - expected.col(k)).norm() <= 1e-6 * expected.col(k).norm());
    CHECK(std::abs(report.residual - residual) <= 1e-12);
    // What is held are the corners, and border vertices across their side.
    std::size_t held = 0;
    Index row = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        const Point p = mesh.position(v);
        const bool on_x = p.x == 0 || p.x == mesh.width(), on_y = p.y == 0 || p.y == mesh.height();
        CHECK(is_held(system, row, 0) == on_x);
        CHECK(is_held(system, row, 1) == on_y);
        held += static_cast<std::size_t>(on_x) + static_cast<std::size_t>(on_y);
        if (on_x) CHECK(solution(row, 0) == p.x);
        if (on_y) CHECK(solution(row, 1) == p.y);
        ++row;
    }
    CHECK(system.held.size() == held);
}

template <int C>
void require_valid(const ImageMesh<C>& mesh) {
    const hmesh::Status status = mesh.check();
    REQUIRE_MESSAGE(status, std::string(status.what) << " at " << status.value);
}

template <int C>
std::vector<Point> positions_of(const ImageMesh<C>& mesh) {
    std::vector<Point> positions;
    for (const Vertex v : mesh.topology().vertices()) positions.push_back(mesh.position(v));
    return positions;
}

template <int C>
std::size_t moved(const ImageMesh<C>& mesh, const std::vector<Point>& before) {
    const std::vector<Point> now = positions_of(mesh);
    std::size_t count = 0;
    for (std::size_t i = 0; i < now.size(); ++i) count += now[i] != before[i];
    return count;
}

// Steps keep the mesh valid and its border in place; with a safeguard the energy never rises. `slack`: what rounding may do.
// Returns how many vertices moved, in all steps together.
template <int C>
std::size_t check_steps(ImageMesh<C>& mesh, const GeometryStep& options, double peak, double slack) {
    std::size_t sum = 0;
    for (int round = 0; round < 3; ++round) {
        const std::vector<Point> before = positions_of(mesh);
        const double energy = mesh.energy();
        const PcgReport report = kit::geometry_step(mesh, options, peak);
        CHECK(std::isfinite(report.residual));
        require_valid(mesh);
        if (options.rule == StepRule::safeguarded) CHECK(mesh.energy() <= energy + slack);
        const std::vector<Point> after = positions_of(mesh);
        for (std::size_t i = 0; i < after.size(); ++i) {
            const Point from = before[i], to = after[i];
            if (from.x == 0 || from.x == mesh.width()) REQUIRE(to.x == from.x);
            else REQUIRE((to.x > 0 && to.x < mesh.width()));
            if (from.y == 0 || from.y == mesh.height()) REQUIRE(to.y == from.y);
            else REQUIRE((to.y > 0 && to.y < mesh.height()));
        }
        for (const Vertex v : mesh.topology().vertices())
            for (int k = 0; k < C; ++k) {
                REQUIRE(mesh.color(v)[k] >= mesh.color_low());
                REQUIRE(mesh.color(v)[k] <= mesh.color_high());
            }
        sum += moved(mesh, before);
    }
    return sum;
}

template <class T, int C>
void check_steps_on(const hmesh::Image<T, C>& image, int columns, int rows, std::uint64_t seed) {
    const Triangulation grid = hmesh_test::jittered_grid(image.width(), image.height(), columns, rows, seed);
    for (const FootSearch search : {FootSearch::plane, FootSearch::own_face, FootSearch::one_ring})
        for (const StepRule rule : {StepRule::safeguarded, StepRule::literal}) {
            CAPTURE(static_cast<int>(search));
            CAPTURE(static_cast<int>(rule));
            Subject<T, C> subject(image, grid);
            GeometryStep options;
            options.search = search;
            options.rule = rule;
            const double peak = hmesh::PixelTraits<T>::peak,
                         slack = 1e-9 * subject.mesh.energy() + 1e-12 * hmesh_test::squares(image);
            const std::size_t count = check_steps(subject.mesh, options, peak, slack);
            if (search == FootSearch::plane) CHECK(count == 0);
            hmesh_test::prove(subject);
        }
}

// The squared distances of the pixels to their foot points, in px^2, from the sums of their K.
template <int C>
double lifted_distance(const ImageMesh<C>& mesh, FootSearch search, double scale) {
    const auto corners = kit::foot_sums(mesh, search, scale);
    const MatrixXd gram(kit::gram_matrix(mesh.topology(), corners)), v = kit::position_matrix(mesh), c = kit::color_matrix(mesh);
    double sum = v.cwiseProduct(gram * v - 2 * kit::position_rhs<C>(mesh.topology(), corners)).sum() +
                 scale * scale * c.cwiseProduct(gram * c - 2 * kit::image_rhs<C>(mesh.topology(), corners)).sum();
    for (int y = 0; y < mesh.height(); ++y)
        for (int x = 0; x < mesh.width(); ++x) {
            kit::Color<C> image;
            mesh.table().pixel(x, y, image);
            sum += (x + 0.5) * (x + 0.5) + (y + 0.5) * (y + 0.5) + scale * scale * (image * image).sum();
        }
    return sum;
}

}  // namespace

TEST_CASE("a geometry system is solved as by a factorisation of what is free, column by column, and its residual is true") {
    Subject<std::uint8_t, 3> rgb(hmesh_test::scene<std::uint8_t, 3>(60, 50, 1), hmesh_test::jittered_grid(60, 50, 8, 7, 1));
    Subject<float, 1> gray(hmesh_test::scene<float, 1>(40, 50, 2), hmesh_test::jittered_grid(40, 50, 7, 8, 2));
    hmesh_test::wear(gray.mesh, 60, 1, 2);
    Subject<std::uint16_t, 4> deep(hmesh_test::noise<std::uint16_t, 4>(40, 30, 3), hmesh_test::jittered_grid(40, 30, 5, 5, 3));
    for (const FootSearch search : {FootSearch::plane, FootSearch::own_face, FootSearch::one_ring}) {
        check_system(rgb.mesh, search, 1);
        check_system(gray.mesh, search, 255);
        check_system(deep.mesh, search, 255.0 / 65535);
    }
    Weighted<std::uint8_t, 3> weighted(hmesh_test::scene<std::uint8_t, 3>(40, 36, 4), hmesh_test::random_weights(40, 36, 4),
                                       hmesh_test::jittered_grid(40, 36, 6, 6, 4));
    check_system(weighted.mesh, FootSearch::own_face, 1);
}

TEST_CASE("a pixel more of pull keeps the solution nearer to where the vertices are") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 50, 5), hmesh_test::jittered_grid(60, 50, 8, 7, 5));
    double before = 0;
    for (const double pull : {1e9, 1.0, 1e-3}) {
        const GeometrySystem system = kit::geometry_system(subject.mesh, FootSearch::own_face, 1, pull);
        double residual = 0;
        const double change = (factorised(system, system.solution, residual) - system.solution).norm();
        CHECK(change > before);
        if (pull > 1e6) CHECK(change < 1e-3);
        before = change;
    }
}

TEST_CASE("without foot points nothing moves: only colours are solved for") {
    Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(60, 50, 6), hmesh_test::jittered_grid(60, 50, 8, 7, 6)),
        expected(hmesh_test::noise<std::uint8_t, 3>(60, 50, 6), hmesh_test::jittered_grid(60, 50, 8, 7, 6));
    GeometrySystem system = kit::geometry_system(subject.mesh, FootSearch::plane, 1, 1e-3);
    double residual = 0;
    const MatrixXd solution = factorised(system, system.solution, residual);
    CHECK((solution - system.solution).leftCols(2).cwiseAbs().maxCoeff() < 1e-9);
    GeometryStep options;
    options.search = FootSearch::plane;
    options.rule = StepRule::literal;
    const std::vector<Point> before = positions_of(subject.mesh);
    kit::geometry_step(subject.mesh, options, 255);
    kit::optimal_colors(expected.mesh, options.pcg);
    CHECK(moved(subject.mesh, before) == 0);
    CHECK(subject.mesh.energy() == doctest::Approx(expected.mesh.energy()).epsilon(1e-6));
}

TEST_CASE("steps keep the mesh valid and the border in place, and with the safeguard the energy never rises") {
    check_steps_on(hmesh_test::scene<std::uint8_t, 3>(44, 36, 11), 6, 5, 11);
    check_steps_on(hmesh_test::noise<std::uint8_t, 3>(40, 30, 12), 6, 5, 12);
    check_steps_on(hmesh_test::noise<std::uint8_t, 1>(24, 24, 13), 9, 9, 13);  // hardly a pixel a vertex
    check_steps_on(hmesh_test::checkerboard<std::uint8_t, 3>(32, 32, 1), 7, 7, 14);
    check_steps_on(hmesh_test::checkerboard<std::uint16_t, 1>(36, 30, 5), 6, 5, 15);
    check_steps_on(hmesh_test::scene<float, 3>(36, 36, 16), 5, 6, 16);
}

TEST_CASE("steps do no harm where there is little to do: constant and affine pictures, single lines, images of one row") {
    check_steps_on(hmesh_test::constant_image<std::uint8_t, 3>(30, 24, 0.5), 5, 4, 21);
    check_steps_on(hmesh_test::constant_image<std::uint8_t, 1>(30, 24, 0), 5, 4, 22);
    check_steps_on(hmesh_test::affine_image<float, 3>(30, 24), 5, 4, 23);
    check_steps_on(hmesh_test::draw<std::uint8_t, 1>(30, 24, [](int x, int, int) { return x == 13 ? 1.0 : 0.0; }), 5, 4, 24);
    check_steps_on(hmesh_test::noise<std::uint8_t, 3>(30, 1, 25), 8, 1, 25);
    check_steps_on(hmesh_test::noise<std::uint8_t, 1>(1, 30, 26), 1, 8, 26);
    check_steps_on(hmesh_test::noise<std::uint8_t, 1>(1, 1, 27), 1, 1, 27);
    check_steps_on(hmesh_test::noise<std::uint8_t, 1>(2, 2, 28), 4, 4, 28);  // most faces own no pixel
}

TEST_CASE("a picture that the mesh shows exactly moves no vertex") {
    Subject<float, 3> affine(hmesh_test::affine_image<float, 3>(40, 30), hmesh_test::jittered_grid(40, 30, 6, 5, 29));
    Subject<std::uint8_t, 3> constant(hmesh_test::constant_image<std::uint8_t, 3>(40, 30, 0.8),
                                      hmesh_test::jittered_grid(40, 30, 6, 5, 30));
    for (int k = 0; k < 3; ++k) kit::optimal_colors(affine.mesh, {500, 1e-13});
    for (const StepRule rule : {StepRule::safeguarded, StepRule::literal})
        for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring}) {
            GeometryStep options;
            options.search = search;
            options.rule = rule;
            CHECK(check_steps(affine.mesh, options, 1, 1e-9) == 0);
            CHECK(check_steps(constant.mesh, options, 255, 1e-3) == 0);
        }
}

TEST_CASE("steps bear samples as large as floats go") {
    check_steps_on(hmesh_test::scaled(hmesh_test::noise<float, 3>(30, 24, 31), 3.4e38), 5, 4, 31);
    check_steps_on(hmesh_test::scaled(hmesh_test::noise<float, 1>(30, 24, 32), 1e-30), 5, 4, 32);
}

TEST_CASE("steps over weighted tables lower the weighted energy") {
    for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring})
        for (const StepRule rule : {StepRule::safeguarded, StepRule::literal}) {
            Weighted<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(44, 36, 41),
                                              hmesh_test::random_weights(44, 36, 41),
                                              hmesh_test::jittered_grid(44, 36, 8, 7, 41));
            GeometryStep options;
            options.search = search;
            options.rule = rule;
            const double slack = 1e-9 * subject.mesh.energy() + 1e-12 * hmesh_test::squares(subject.image),
                         before = subject.mesh.energy();
            CHECK(check_steps(subject.mesh, options, 255, slack) > 20);
            CHECK(std::abs(subject.mesh.energy() - hmesh_test::weighted_energy(subject)) <= slack);
            if (rule == StepRule::safeguarded) CHECK(subject.mesh.energy() < 0.8 * before);
        }
}

TEST_CASE("vertices among pixels that do not count stay where they are") {
    auto weights = hmesh_test::random_weights(48, 40, 42);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 24; ++x) *weights.pixel(x, y) = 0;
    for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring}) {
        Weighted<float, 3> subject(hmesh_test::noise<float, 3>(48, 40, 42), weights,
                                   hmesh_test::jittered_grid(48, 40, 12, 10, 42));
        const ImageMesh<3>& mesh = subject.mesh;
        const auto is_blind = [&](Vertex v) {
            kit::RingScratch<3> work;
            mesh.gather(v, work.ring, work.spokes);
            return !(kit::ring_weight(work.ring, work.spokes) > kit::least_weight);
        };
        std::vector<Vertex> blind;
        for (const Vertex v : mesh.topology().vertices())
            if (is_blind(v)) blind.push_back(v);
        CHECK(blind.size() > 40);
        const std::vector<Point> before = positions_of(mesh);
        GeometryStep options;
        options.search = search;
        kit::geometry_step(subject.mesh, options, 1);
        require_valid(mesh);
        CHECK(moved(mesh, before) > 20);
        const auto stayed = [&](Vertex v) { return mesh.position(v) == before[v.index()]; };
        for (const Vertex v : blind) {
            bool still = true;  // where a neighbour moves, a vertex may come to see
            for (const kit::Halfedge h : mesh.topology().outgoing(v)) still = still && stayed(mesh.topology().to_vertex(h));
            if (still) CHECK(stayed(v));
        }
    }
}

TEST_CASE("the safeguard gains more than colours alone do") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(80, 64, 51);
    const Triangulation grid = hmesh_test::jittered_grid(80, 64, 9, 7, 51);
    Subject<std::uint8_t, 3> subject(image, grid), colored(image, grid);
    kit::optimal_colors(colored.mesh);
    kit::optimal_colors(subject.mesh);
    for (int round = 0; round < 3; ++round) kit::geometry_step(subject.mesh, GeometryStep(), 255);
    CHECK(subject.mesh.energy() < 0.8 * colored.mesh.energy());
}

TEST_CASE("taken literally, a step brings the mesh nearer to the pixels in position and colour") {
    for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring})
        for (const double scale : {0.05, 0.3, 1.0}) {
            Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 48, 52),
                                             hmesh_test::jittered_grid(60, 48, 7, 6, 52));
            GeometryStep options;
            options.search = search;
            options.rule = StepRule::literal;
            options.color_scale = scale;
            const double before = lifted_distance(subject.mesh, search, scale);
            const std::vector<Point> from = positions_of(subject.mesh);
            kit::geometry_step(subject.mesh, options, 255);
            CHECK(lifted_distance(subject.mesh, search, scale) < before);
            CHECK(moved(subject.mesh, from) > 20);
            require_valid(subject.mesh);
        }
}

TEST_CASE("a vertex with too many neighbors for a ring keeps its place, and the others move") {
    const Triangulation wheel = hmesh_test::wheel(60, kit::ring_capacity + 8);
    for (const StepRule rule : {StepRule::safeguarded, StepRule::literal}) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 60, 61), wheel);
        const Vertex hub(0);
        REQUIRE(subject.mesh.topology().valence(hub) > kit::ring_capacity);
        GeometryStep options;
        options.rule = rule;
        const Point place = subject.mesh.position(hub);
        const double slack = hmesh_test::rounding(subject);
        CHECK(check_steps(subject.mesh, options, 255, slack) > 10);
        CHECK(subject.mesh.position(hub) == place);
        hmesh_test::prove(subject);
    }
}

TEST_CASE("told to stop while it looks for the nearest faces, a step changes nothing") {
    for (const StepRule rule : {StepRule::safeguarded, StepRule::literal}) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(90, 70, 71),
                                         hmesh_test::jittered_grid(90, 70, 20, 18, 71));
        const auto before = hmesh_test::snapshot(subject.mesh);
        const auto stop = [](const hmesh::ProgressInfo&) { return false; };
        kit::ProgressReporter progress(stop, 1, 255);
        kit::TaskProgress task(progress, 1);
        subject.mesh.set_task(&task);
        GeometryStep options;
        options.search = FootSearch::one_ring;
        options.rule = rule;
        CHECK(kit::geometry_step(subject.mesh, options, 255).iterations == 0);
        CHECK(progress.stopped());
        CHECK(hmesh_test::snapshot(subject.mesh) == before);
    }
}

TEST_CASE("steps have the same bytes with any executor") {
    for (const StepRule rule : {StepRule::safeguarded, StepRule::literal}) {
        const auto image = hmesh_test::scene<std::uint8_t, 3>(90, 70, 71);
        const Triangulation grid = hmesh_test::jittered_grid(90, 70, 20, 18, 71);
        Subject<std::uint8_t, 3> serial(image, grid), threaded(image, grid);
        GeometryStep options;
        options.rule = rule;
        const PcgReport one = kit::geometry_step(serial.mesh, options, 255),
                        other = kit::geometry_step(threaded.mesh, options, 255, hmesh_test::ThreadFor{3});
        CHECK(one.iterations == other.iterations);
        CHECK(one.residual == other.residual);
        CHECK(hmesh_test::snapshot(serial.mesh) == hmesh_test::snapshot(threaded.mesh));
    }
}
