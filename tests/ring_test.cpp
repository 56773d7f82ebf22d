#include "hmesh/fit/ring.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::PixelTraits;
using hmesh::kit::Color;
using hmesh::kit::Face;
using hmesh::kit::Mobility;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh::kit::VertexState;
using hmesh_test::Subject;

namespace {

constexpr double unlimited = 1e300;

// The energy of the ring's faces with its centre in another state.
template <class T, int C>
double brute_ring(const hmesh::Image<T, C>& image, const hmesh::kit::Ring<C>& ring, const VertexState<C>& center) {
    double energy = 0;
    for (int i = ring.first_face(); i < ring.size; ++i)
        energy += hmesh_test::brute_energy(image, center, *ring.neighbor[i], *ring.neighbor[ring.before(i)]);
    return energy;
}

// The pixels of the ring's faces with the centre at p, each with its face.
struct OwnedPixel {
    int face, i, j;
    friend bool operator==(const OwnedPixel& a, const OwnedPixel& b) { return a.face == b.face && a.i == b.i && a.j == b.j; }
};
template <int C>
std::vector<OwnedPixel> pixels_of(const hmesh::kit::ImageMesh<C>& mesh, const hmesh::kit::Ring<C>& ring, Point p) {
    std::vector<OwnedPixel> pixels;
    for (int t = ring.first_face(); t < ring.size; ++t)
        hmesh_test::for_each_pixel(mesh.width(), mesh.height(), p, ring.neighbor[t]->position,
                                   ring.neighbor[ring.before(t)]->position, [&](int i, int j) {
                                       pixels.push_back({t, i, j});
                                   });
    return pixels;
}

template <class T, int C>
void check_energy(std::uint64_t seed) {
    Subject<T, C> subject(hmesh_test::scene<T, C>(31, 26, seed), hmesh_test::jittered_grid(31, 26, 5, 4, seed));
    hmesh_test::wear(subject.mesh, 60, PixelTraits<T>::peak, seed);
    const double peak = PixelTraits<T>::peak, slack = 1e-11 * hmesh_test::squares(subject.image);
    Random random(seed);
    hmesh::kit::RingScratch<C> work;
    int accepted = 0, refused = 0;
    for (const Vertex v : subject.mesh.topology().vertices()) {
        subject.mesh.gather(v, work.ring, work.spokes);
        VertexState<C> center = subject.mesh.vertex(v);
        for (int tries = 0; tries < 8; ++tries) {
            if (tries > 0) {  // anywhere, not only on the grid
                if (center.mobility == Mobility::corner) break;
                if (center.mobility != Mobility::along_y)
                    center.position.x = subject.mesh.position(v).x + 4 * random.uniform() - 2;
                if (center.mobility != Mobility::along_x)
                    center.position.y = subject.mesh.position(v).y + 4 * random.uniform() - 2;
                center.position.x = std::min(31.0, std::max(0.0, center.position.x));
                center.position.y = std::min(26.0, std::max(0.0, center.position.y));
                center.color = hmesh_test::any_color(subject.mesh, v, peak, random);
                hmesh::kit::walk_spokes(subject.table, work.ring, center.position, work.spokes);
            }
            hmesh::kit::RingFit<C> fit;
            const bool fits = hmesh::kit::fit_ring(work.ring, work.spokes, center.position, 0.02, work.faces, fit);
            REQUIRE(fits == work.ring.accepts(center.position, 0.02));
            if (!fits) {
                ++refused;
                continue;
            }
            ++accepted;
            const double truth = brute_ring(subject.image, work.ring, center);
            REQUIRE(fit.energy(center.color) == doctest::Approx(truth).epsilon(1e-8).scale(slack * 1e8));
            double sum = 0;
            for (int i = work.ring.first_face(); i < work.ring.size; ++i) {
                const double face = work.faces[i].energy(center.color);
                REQUIRE(std::abs(face - hmesh_test::brute_energy(subject.image, center, *work.ring.neighbor[i],
                                                                 *work.ring.neighbor[work.ring.before(i)])) <=
                        1e-8 * truth + slack);
                sum += face;
            }
            REQUIRE(std::abs(sum - truth) <= 1e-8 * truth + slack);
        }
    }
    CHECK(accepted > 100);
    CHECK(refused > 5);
}

template <class T, int C>
void check_best_color(std::uint64_t seed) {
    Subject<T, C> subject(hmesh_test::scene<T, C>(30, 25, seed), hmesh_test::jittered_grid(30, 25, 4, 4, seed));
    const double peak = PixelTraits<T>::peak;
    Random random(seed);
    hmesh::kit::RingScratch<C> work;
    for (const Vertex v : subject.mesh.topology().vertices()) {
        subject.mesh.gather(v, work.ring, work.spokes);
        VertexState<C> center = subject.mesh.vertex(v);
        hmesh::kit::RingFit<C> fit;
        REQUIRE(hmesh::kit::fit_ring(work.ring, work.spokes, center.position, 0.02, work.faces, fit));
        center.color = hmesh::kit::best_color(fit, center.color, 0, -unlimited, unlimited);
        const Color<C> best = center.color;
        for (int k = C; k < hmesh::kit::lanes_for(C + 1); ++k) REQUIRE(best[k] == 0);
        const double least = brute_ring(subject.image, work.ring, center), h = 0.01 * peak;
        for (int k = 0; k < C; ++k) {
            center.color = best;
            center.color.set(k, best[k] + h);
            const double above = brute_ring(subject.image, work.ring, center);
            center.color.set(k, best[k] - h);
            const double below = brute_ring(subject.image, work.ring, center);
            // A quadratic with its minimum in the middle: both rise by A h^2.
            const double rise = fit.a * h * h;
            REQUIRE(above - least == doctest::Approx(rise).epsilon(1e-6));
            REQUIRE(below - least == doctest::Approx(rise).epsilon(1e-6));
        }
        // The ridge counts as so many pixels of the current colour.
        const Color<C> current = hmesh_test::any_color(subject.mesh, v, peak, random);
        const Color<C> held = hmesh::kit::best_color(fit, current, fit.a, -unlimited, unlimited);
        for (int k = 0; k < C; ++k) REQUIRE(held[k] == doctest::Approx(0.5 * (best[k] + current[k])).epsilon(1e-9));
        const Color<C> bounded = hmesh::kit::best_color(fit, current, 0, 0.4 * peak, 0.5 * peak);
        for (int k = 0; k < C; ++k) REQUIRE(bounded[k] == std::min(0.5 * peak, std::max(0.4 * peak, best[k])));
    }
}

// Normal equations of the residuals (picture - image) at the ring's pixels in the centre's position and colour: J from
// differences of the interpolated picture, pixels held in their faces.
struct NormalEquations {
    double gx = 0, gy = 0;          // J' r
    double xx = 0, xy = 0, yy = 0;  // J' J of the position with the colour eliminated
    double length = 0;              // |J' r|, before signs cancel
};
template <class T, int C>
NormalEquations brute_equations(const Subject<T, C>& subject, const hmesh::kit::Ring<C>& ring, const VertexState<C>& center,
                                double ridge) {
    constexpr double h = 1e-4;
    NormalEquations n;
    const std::vector<OwnedPixel> pixels = pixels_of(subject.mesh, ring, center.position);
    for (int k = 0; k < C; ++k) {
        double cc = ridge, cx = 0, cy = 0;
        for (const OwnedPixel& pixel : pixels) {
            const VertexState<C>&a = *ring.neighbor[pixel.face], &b = *ring.neighbor[ring.before(pixel.face)];
            const auto picture = [&](double dx, double dy, double dc) {
                VertexState<C> moved = center;
                moved.position = {center.position.x + dx, center.position.y + dy};
                moved.color.set(k, center.color[k] + dc);
                return hmesh_test::interpolate(moved, a, b, pixel.i + 0.5, pixel.j + 0.5, k);
            };
            const double jx = (picture(h, 0, 0) - picture(-h, 0, 0)) / (2 * h);
            const double jy = (picture(0, h, 0) - picture(0, -h, 0)) / (2 * h);
            const double jc = picture(0, 0, 1) - picture(0, 0, 0);
            const double r = picture(0, 0, 0) - static_cast<double>(subject.image.pixel(pixel.i, pixel.j)[k]);
            n.gx += jx * r, n.gy += jy * r;
            n.length += std::abs(jx * r) + std::abs(jy * r);
            n.xx += jx * jx, n.xy += jx * jy, n.yy += jy * jy;
            cc += jc * jc, cx += jc * jx, cy += jc * jy;
        }
        n.xx -= cx * cx / cc, n.xy -= cx * cy / cc, n.yy -= cy * cy / cc;
    }
    return n;
}

template <class T, int C>
void check_gradient(std::uint64_t seed) {
    Subject<T, C> subject(hmesh_test::scene<T, C>(48, 44, seed), hmesh_test::jittered_grid(48, 44, 7, 6, seed));
    hmesh_test::wear(subject.mesh, 40, PixelTraits<T>::peak, seed);
    hmesh::kit::RingScratch<C> work;
    constexpr double h = 1e-5;
    int compared = 0, all = 0;
    for (const Vertex v : subject.mesh.topology().vertices()) {
        ++all;
        subject.mesh.gather(v, work.ring, work.spokes);
        const VertexState<C> center = subject.mesh.vertex(v);
        const auto here = pixels_of(subject.mesh, work.ring, center.position);
        double difference[2];
        bool same_pixels = true;
        for (int axis = 0; axis < 2; ++axis) {
            double energy[2];
            for (int side = 0; side < 2; ++side) {
                VertexState<C> moved = center;
                (axis == 0 ? moved.position.x : moved.position.y) += side == 0 ? h : -h;
                // A border vertex off its side would uncover pixels.
                same_pixels = same_pixels && moved.position.x >= 0 && moved.position.y >= 0 && moved.position.x <= 48 &&
                              moved.position.y <= 44 && pixels_of(subject.mesh, work.ring, moved.position) == here;
                if (!same_pixels) break;
                hmesh::kit::walk_spokes(subject.table, work.ring, moved.position, work.spokes);
                hmesh::kit::RingFit<C> fit;
                REQUIRE(hmesh::kit::fit_ring(work.ring, work.spokes, moved.position, 0.01, work.faces, fit));
                energy[side] = fit.energy(center.color);
            }
            if (!same_pixels) break;
            difference[axis] = (energy[0] - energy[1]) / (2 * h);
        }
        if (!same_pixels) continue;
        ++compared;
        const NormalEquations n = brute_equations(subject, work.ring, center, 0);
        REQUIRE(std::abs(2 * n.gx - difference[0]) <= 1e-4 * n.length + 1e-9);
        REQUIRE(std::abs(2 * n.gy - difference[1]) <= 1e-4 * n.length + 1e-9);
    }
    CHECK(compared >= all / 2);
}

template <class T, int C>
void check_step(std::uint64_t seed, hmesh::Image<T, C> image) {
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(48, 44, 7, 6, seed));
    hmesh::kit::RingScratch<C> work;
    for (const Vertex v : subject.mesh.topology().vertices()) {
        subject.mesh.gather(v, work.ring, work.spokes);
        VertexState<C> center = subject.mesh.vertex(v);
        hmesh::kit::RingFit<C> fit;
        REQUIRE(hmesh::kit::fit_ring(work.ring, work.spokes, center.position, 0.02, work.faces, fit));
        center.color = hmesh::kit::best_color(fit, center.color, 0, -unlimited, unlimited);
        NormalEquations n = brute_equations(subject, work.ring, center, 1e-3);
        const double damping = 0.02 * (n.xx + n.yy);
        n.xx += damping, n.yy += damping;
        const double det = n.xx * n.yy - n.xy * n.xy;
        const auto close = [](double got, double want, double scale) { return std::abs(got - want) <= 1e-5 * scale; };
        const auto step_for = [&](Mobility mobility) {
            return hmesh::kit::gauss_newton_step(work.ring, work.faces, fit, center.color, mobility);
        };

        const hmesh::kit::RingStep free = step_for(Mobility::free);
        const double dx = -(n.yy * n.gx - n.xy * n.gy) / det, dy = -(n.xx * n.gy - n.xy * n.gx) / det;
        const double scale = n.length * (n.xx + n.yy) / det;
        CHECK(close(free.dx, dx, scale));
        CHECK(close(free.dy, dy, scale));
        CHECK(close(free.predicted, -(n.gx * dx + n.gy * dy), n.length * scale));
        CHECK(free.predicted >= 0);

        const hmesh::kit::RingStep x = step_for(Mobility::along_x), y = step_for(Mobility::along_y),
                                   none = step_for(Mobility::corner);
        CHECK(close(x.dx, -n.gx / n.xx, n.length / n.xx));
        CHECK(close(x.predicted, n.gx * n.gx / n.xx, n.length * n.length / n.xx));
        CHECK(x.dy == 0);
        CHECK(close(y.dy, -n.gy / n.yy, n.length / n.yy));
        CHECK(close(y.predicted, n.gy * n.gy / n.yy, n.length * n.length / n.yy));
        CHECK(y.dx == 0);
        CHECK((none.dx == 0 && none.dy == 0 && none.predicted == 0));
    }
}

}  // namespace

TEST_CASE("the energy of a ring is that of its pixels, wherever its centre is and whatever its colour") {
    check_energy<std::uint8_t, 1>(1);
    check_energy<std::uint8_t, 3>(2);
    check_energy<std::uint16_t, 2>(3);
    check_energy<float, 4>(4);
    check_energy<float, 7>(5);
    check_energy<std::uint8_t, 16>(6);
}

TEST_CASE("the best colour has no gradient, the ridge draws it to the current one, and bounds hold") {
    check_best_color<std::uint8_t, 3>(21);
    check_best_color<std::uint16_t, 4>(22);
    check_best_color<float, 1>(23);
}

TEST_CASE("the derivative of a ring's energy by its position is J' r of the pixels' residuals: none move between faces") {
    check_gradient<std::uint8_t, 3>(31);
    check_gradient<std::uint16_t, 1>(32);
    check_gradient<float, 4>(33);
}

TEST_CASE(
    "the Gauss-Newton step solves the normal equations of the pixels' residuals, damped, within the vertex's "
    "mobility") {
    check_step(41, hmesh_test::scene<std::uint8_t, 3>(48, 44, 41));
    check_step(42, hmesh_test::scene<std::uint16_t, 1>(48, 44, 42));
    check_step(43, hmesh_test::scaled(hmesh_test::scene<float, 2>(48, 44, 43), 255));
    check_step(44, hmesh_test::scene<std::uint8_t, 7>(48, 44, 44));
}

TEST_CASE("a flat picture gives a step of no length") {
    Subject<float, 1> subject(hmesh_test::constant_image<float, 1>(20, 20, 0.5), hmesh_test::jittered_grid(20, 20, 3, 3, 1));
    hmesh::kit::RingScratch<1> work;
    for (const Vertex v : subject.mesh.topology().vertices()) {
        subject.mesh.gather(v, work.ring, work.spokes);
        hmesh::kit::RingFit<1> fit;
        REQUIRE(hmesh::kit::fit_ring(work.ring, work.spokes, subject.mesh.position(v), 0.02, work.faces, fit));
        for (const Mobility mobility : {Mobility::free, Mobility::along_x, Mobility::along_y}) {
            const hmesh::kit::RingStep step =
                hmesh::kit::gauss_newton_step(work.ring, work.faces, fit, subject.mesh.color(v), mobility);
            CHECK(std::abs(step.dx) < 1e-6);
            CHECK(std::abs(step.dy) < 1e-6);
            CHECK(std::abs(step.predicted) < 1e-6);
        }
    }
}

TEST_CASE("an open ring has one face fewer than neighbors, a closed one as many, and each follows the orientation") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(20, 16, 1), hmesh_test::jittered_grid(20, 16, 4, 3, 1));
    hmesh::kit::RingScratch<1> work;
    const hmesh::kit::HalfedgeMesh& topology = subject.mesh.topology();
    for (const Vertex v : topology.vertices()) {
        subject.mesh.gather(v, work.ring, work.spokes);
        CHECK(work.ring.size == topology.valence(v));
        CHECK(work.ring.open == topology.is_boundary(v));
        CHECK(work.ring.accepts(subject.mesh.position(v), 0.02));
        for (int i = work.ring.first_face(); i < work.ring.size; ++i) {
            const hmesh::kit::Halfedge h = work.ring.halfedge[i];
            CHECK(topology.from_vertex(h) == v);
            CHECK(work.ring.neighbor[i] == &subject.mesh.vertex(topology.to_vertex(h)));
            CHECK(work.ring.neighbor[work.ring.before(i)] == &subject.mesh.vertex(topology.to_vertex(topology.next(h))));
        }
    }
}
