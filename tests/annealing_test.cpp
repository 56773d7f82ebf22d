#include "hmesh/methods/annealed/annealing.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::AnnealingCounts;
using hmesh::kit::AnnealingOptions;
using hmesh::kit::AnnealingSchedule;
using hmesh::kit::AnnealingSweep;
using hmesh::kit::CountRange;
using hmesh::kit::Face;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

struct Totals {
    std::size_t removed = 0, inserted = 0;
    void operator+=(const AnnealingCounts& c) { removed += c.removed, inserted += c.inserted; }
    [[nodiscard]] std::size_t moves() const { return removed + inserted; }
};

// Faces of the areas, valences and colours that the limits allow.
template <int C>
void check_limits(const kit::ImageMesh<C>& mesh) {
    bool large = true, in_range = true;
    int valence = 0;
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        large = large &&
                kit::orient2d(mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2])) >= mesh.limits().min_double_area;
    }
    for (const Vertex v : mesh.topology().vertices()) {
        valence = std::max(valence, mesh.topology().valence(v));
        for (int k = 0; k < C; ++k)
            in_range = in_range && mesh.color(v)[k] >= mesh.color_low() && mesh.color(v)[k] <= mesh.color_high();
    }
    CHECK(large);
    CHECK(in_range);
    CHECK(valence <= kit::max_valence);
}

// Sweeps of a mesh that is one patch, at a price steered in between.
template <int C>
class Annealing {
  public:
    Annealing(kit::ImageMesh<C>& mesh, std::size_t target, const AnnealingOptions& options, std::uint64_t seed)
        : mesh_(&mesh), options_(options), target_(static_cast<double>(target)), seed_(seed),
          schedule_(options, target, mesh.mean_energy()) {}
    [[nodiscard]] double price() const { return schedule_.price(); }
    AnnealingCounts sweep(int k) {
        const CountRange range{(1 - options_.count_tolerance) * target_, (1 + options_.count_tolerance) * target_};
        AnnealingSweep<C> sweep(*mesh_, options_, price(), schedule_.temperature(k), range,
                                Random(seed_, static_cast<std::uint64_t>(k)));
        const AnnealingCounts counts = sweep.run(kit::spatial_vertices(*mesh_));
        steer(counts);
        return counts;
    }
    void steer(const AnnealingCounts& counts) { schedule_.steer(counts, mesh_->vertex_count(), mesh_->mean_energy()); }

  private:
    kit::ImageMesh<C>* mesh_;
    AnnealingOptions options_;
    double target_;
    std::uint64_t seed_;
    AnnealingSchedule schedule_;
};

// Sweeps, each followed by proof of all that the mesh promises and that its vertices are those the counts tell of.
template <class T, int C>
Totals anneal(Subject<T, C>& subject, std::size_t target, const AnnealingOptions& options, std::uint64_t seed) {
    Annealing<C> annealing(subject.mesh, target, options, seed);
    Totals totals;
    for (int k = 0; k < options.sweeps; ++k) {
        const std::size_t before = subject.mesh.vertex_count();
        const AnnealingCounts counts = annealing.sweep(k);
        CHECK(subject.mesh.vertex_count() + counts.removed == before + counts.inserted);
        CHECK(std::isfinite(annealing.price()));
        CHECK(annealing.price() >= 0);
        hmesh_test::prove(subject);
        check_limits(subject.mesh);
        totals += counts;
    }
    return totals;
}

template <class T, int C>
Totals anneal_grid(hmesh::Image<T, C> image, int columns, int rows, int sweeps, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, columns, rows, seed));
    AnnealingOptions options;
    options.sweeps = sweeps;
    options.jump = 0.1;
    return anneal(subject, subject.mesh.vertex_count(), options, seed);
}

}  // namespace

TEST_CASE("after every sweep, over hundreds of moves, the mesh is valid and its energy that of its pixels") {
    Totals totals = anneal_grid(hmesh_test::scene<std::uint8_t, 3>(60, 52, 1), 11, 10, 50, 1);
    CHECK(totals.removed > 50);
    CHECK(totals.inserted > 50);
    std::size_t moves = totals.moves();
    moves += anneal_grid(hmesh_test::noise<std::uint8_t, 1>(33, 29, 2), 7, 7, 30, 2).moves();
    moves += anneal_grid(hmesh_test::checkerboard<std::uint16_t, 2>(40, 37, 6), 6, 6, 30, 3).moves();
    moves += anneal_grid(hmesh_test::scene<float, 5>(36, 32, 4), 6, 6, 20, 4).moves();
    CHECK(moves > 600);  // removals and insertions alone
}

TEST_CASE("pictures without error, images of a row, a column or a pixel, and floats of any size go through unharmed") {
    anneal_grid(hmesh_test::constant_image<std::uint8_t, 3>(20, 18, 0.7), 5, 5, 6, 1);
    anneal_grid(hmesh_test::affine_image<float, 2>(20, 18), 5, 5, 6, 2);
    anneal_grid(hmesh_test::noise<std::uint8_t, 1>(1, 1, 3), 1, 1, 6, 3);
    anneal_grid(hmesh_test::noise<std::uint8_t, 3>(1, 25, 4), 1, 6, 12, 4);
    anneal_grid(hmesh_test::noise<float, 1>(25, 1, 5), 6, 1, 12, 5);
    anneal_grid(hmesh_test::noise<std::uint8_t, 1>(2, 2, 6), 1, 1, 12, 6);
    anneal_grid(hmesh_test::scaled(hmesh_test::scene<float, 3>(24, 22, 7), 1e6), 5, 5, 8, 7);
    anneal_grid(hmesh_test::scaled(hmesh_test::scene<float, 3>(24, 22, 8), 1e-6), 5, 5, 8, 8);
}

TEST_CASE("the price steers the count to the target, from above and from below") {
    for (const std::size_t target : {90U, 121U, 150U}) {
        CAPTURE(target);
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 52, 5),
                                         hmesh_test::jittered_grid(60, 52, 10, 10, 5));
        AnnealingOptions options;
        options.sweeps = 15;
        anneal(subject, target, options, 5);
        CHECK(static_cast<double>(subject.mesh.vertex_count()) >=
              (1 - options.count_tolerance) * static_cast<double>(target) - 1);
        CHECK(static_cast<double>(subject.mesh.vertex_count()) <=
              (1 + options.count_tolerance) * static_cast<double>(target) + 1);
    }
}

TEST_CASE("the price rises while there are too many vertices and falls while there are too few") {
    const auto change_of_price = [](std::size_t target) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 52, 5),
                                         hmesh_test::jittered_grid(60, 52, 10, 10, 5));
        AnnealingOptions options;
        options.try_probability = 0.1;  // or one sweep would be enough
        Annealing<3> annealing(subject.mesh, target, options, 5);
        const double before = annealing.price();
        annealing.sweep(0);
        return annealing.price() / before;
    };
    CHECK(change_of_price(40) > 1.1);
    CHECK(change_of_price(400) < 0.9);
}

TEST_CASE("the price starts as asked for and stays between 0.15 and 100 mean energies, whatever the counts") {
    AnnealingOptions options;
    options.start_price = 0.7;
    AnnealingSchedule schedule(options, 100, 50);
    CHECK(schedule.price() == 35);
    // A balance keeps it.
    schedule.steer({3, 3}, 100, 50);
    CHECK(schedule.price() == doctest::Approx(35));
    // Vertices that come raise it, vertices that go lower it, by at most a fifth.
    schedule.steer({0, 2}, 100, 50);
    CHECK(schedule.price() == doctest::Approx(35 * std::exp(0.04)));
    schedule.steer({0, 90}, 190, 50);
    CHECK(schedule.price() == doctest::Approx(35 * std::exp(0.24)));
    for (int k = 0; k < 40; ++k) schedule.steer({0, 90}, 1000, 50);
    CHECK(schedule.price() == 5000);
    for (int k = 0; k < 60; ++k) schedule.steer({90, 0}, 4, 50);
    CHECK(schedule.price() == 7.5);
    schedule.steer({}, 100, 0);  // a picture without error
    CHECK(schedule.price() == 0);
}

TEST_CASE("the temperature is a share of the price that falls to 0 as (1 - t) to the power asked for") {
    for (const double cooling : {0.5, 1.0, 2.0}) {
        AnnealingOptions options;
        options.sweeps = 8;
        options.temperature = 0.4;
        options.cooling = cooling;
        const AnnealingSchedule schedule(options, 100, 50);
        for (int k = 0; k < 8; ++k)
            CHECK(schedule.temperature(k) == doctest::Approx(0.4 * std::pow(1 - k / 8.0, cooling) * schedule.price()));
        CHECK(schedule.temperature(8) == 0);
    }
}

TEST_CASE("a sweep leaves no more and no fewer vertices than its range says, but one") {
    const auto count_after = [](const CountRange& range, double price) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 52, 5),
                                         hmesh_test::jittered_grid(60, 52, 10, 10, 5));
        const double unit = subject.mesh.mean_energy();
        AnnealingSweep<3>(subject.mesh, {}, price * unit, 0, range, Random(5)).run(kit::spatial_vertices(subject.mesh));
        hmesh_test::prove(subject);
        return subject.mesh.vertex_count();
    };
    CHECK(count_after({110, 1000}, 100) == 109);  // the price would have them all removed
    CHECK(count_after({0, 1000}, 100) < 100);
    CHECK(count_after({0, 130}, 1e-6) == 131);  // hardly a price: all come that can
    CHECK(count_after({0, 1000}, 1e-6) > 140);
}

TEST_CASE("without temperature no sweep raises energy plus price times vertices") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 52, seed),
                                         hmesh_test::jittered_grid(60, 52, 11, 10, seed));
        AnnealingOptions options;
        options.sweeps = 12;
        options.temperature = 0;
        Annealing<3> annealing(subject.mesh, subject.mesh.vertex_count(), options, seed);
        for (int k = 0; k < options.sweeps; ++k) {
            const double price = annealing.price();
            const auto total = [&] { return subject.mesh.energy() + price * static_cast<double>(subject.mesh.vertex_count()); };
            const double before = total();
            annealing.sweep(k);
            CHECK(total() <= before + hmesh_test::rounding(subject));
        }
    }
}

TEST_CASE("annealing lowers the energy at the same number of vertices") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(60, 52, 6), hmesh_test::jittered_grid(60, 52, 10, 10, 6));
    for (int k = 0; k < 5; ++k) {  // what visits and flips alone can do
        kit::sweep(subject.mesh);
        kit::flip_edges(subject.mesh);
    }
    const double before = subject.mesh.energy();
    anneal(subject, subject.mesh.vertex_count(), {}, 6);
    CHECK(subject.mesh.vertex_count() <= 126);
    CHECK(subject.mesh.energy() < 0.6 * before);
}

TEST_CASE("a kind of move with probability 0 or screened off does not happen, and each of the five does by itself") {
    struct Outcome {
        Totals totals;
        hmesh_test::Snapshot mesh;
    };
    const auto start = [] {
        return std::make_unique<Subject<std::uint8_t, 1>>(hmesh_test::scene<std::uint8_t, 1>(40, 36, 3),
                                                          hmesh_test::jittered_grid(40, 36, 7, 7, 3));
    };
    const auto outcome_of = [&](const AnnealingOptions& options) {
        const auto subject = start();
        const Totals totals = anneal(*subject, subject->mesh.vertex_count(), options, 3);
        return Outcome{totals, hmesh_test::snapshot(subject->mesh)};
    };
    AnnealingOptions none;
    none.sweeps = 3;
    none.try_probability = none.jump = 0;
    none.flip_screen = -1e9;
    none.nudges = 0;
    const Outcome still = outcome_of(none);
    CHECK(still.totals.moves() == 0);
    // What is left of a sweep: visits, flips that gain, visits.
    const auto plain = start();
    Annealing<1> annealing(plain->mesh, plain->mesh.vertex_count(), none, 3);
    for (int k = 0; k < none.sweeps; ++k) {
        const kit::Tolerance tolerance{1e-2, 5e-3 * annealing.price() / plain->mesh.mean_energy()};
        const std::vector<Vertex> vertices = kit::spatial_vertices(plain->mesh);  // one block
        kit::sweep(plain->mesh, vertices, tolerance);
        kit::flip_edges(plain->mesh, kit::own_edges(plain->mesh, vertices), 1e-4);
        kit::sweep(plain->mesh, vertices, tolerance);
        annealing.steer({});
    }
    CHECK(hmesh_test::snapshot(plain->mesh) == still.mesh);

    AnnealingOptions options = none;
    options.flip_screen = AnnealingOptions().flip_screen;
    const Outcome flips = outcome_of(options);
    CHECK(flips.totals.moves() == 0);
    CHECK_FALSE(flips.mesh == still.mesh);
    options = none;
    options.jump = 0.1;
    const Outcome jumps = outcome_of(options);
    CHECK(jumps.totals.moves() == 0);
    CHECK_FALSE(jumps.mesh == still.mesh);
    options = none;
    options.nudges = 1;
    const Outcome nudges = outcome_of(options);
    CHECK(nudges.totals.moves() == 0);
    CHECK_FALSE(nudges.mesh == still.mesh);
    options = none;
    options.try_probability = 1;
    options.insertion_screen = 1e9;
    const Outcome removals = outcome_of(options);
    CHECK(removals.totals.inserted == 0);
    CHECK(removals.totals.removed > 0);
    options.insertion_screen = AnnealingOptions().insertion_screen;
    options.removal_screen = -1e9;
    const Outcome insertions = outcome_of(options);
    CHECK(insertions.totals.removed == 0);
    CHECK(insertions.totals.inserted > 0);
}

TEST_CASE("nudges find places that steps do not, along the border too, and leave in peace what has no error") {
    AnnealingOptions still;
    still.sweeps = 4;
    still.temperature = still.try_probability = 0;
    still.flip_screen = -1e9;
    still.nudges = 0;
    AnnealingOptions nudges = still;
    nudges.nudges = 20;
    const auto mesh = [] { return hmesh_test::jittered_grid(48, 40, 12, 10, 3); };
    Subject<std::uint8_t, 3> plain(hmesh_test::scene<std::uint8_t, 3>(48, 40, 8), mesh());
    Subject<std::uint8_t, 3> nudged(hmesh_test::scene<std::uint8_t, 3>(48, 40, 8), mesh());
    anneal(plain, plain.mesh.vertex_count(), still, 5);
    anneal(nudged, nudged.mesh.vertex_count(), nudges, 5);
    CHECK(nudged.mesh.energy() < 0.98 * plain.mesh.energy());

    // The left half is of one colour. Warm nudges go anywhere but where they cannot gain, and keep the border.
    const auto half = [] {
        auto image = hmesh_test::noise<std::uint8_t, 1>(48, 40, 8);
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 24; ++x) image.pixel(x, y)[0] = 90;
        return image;
    };
    nudges.temperature = 2;
    Subject<std::uint8_t, 1> warm(half(), mesh());
    const hmesh_test::Snapshot before = hmesh_test::snapshot(warm.mesh);
    const std::vector<Vertex> vertices = kit::spatial_vertices(warm.mesh);
    std::vector<kit::Point> positions;
    for (const Vertex v : vertices) positions.push_back(warm.mesh.position(v));
    anneal(warm, warm.mesh.vertex_count(), nudges, 5);
    int flat = 0, border = 0;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const kit::Point now = warm.mesh.position(vertices[k]);
        if (positions[k].x < 10) {
            ++flat;
            CHECK(now == positions[k]);
        } else if (positions[k].y == 0 && positions[k].x > 30 && positions[k].x < 48) {
            ++border;
            CHECK(now.x != positions[k].x);
            CHECK(now.y == 0);
        }
    }
    CHECK(flat > 8);
    CHECK(border > 0);
    CHECK_FALSE(hmesh_test::snapshot(warm.mesh) == before);
}

TEST_CASE("the same seed gives the same bytes, another seed another mesh") {
    const auto snapshot_of = [](std::uint64_t seed) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(40, 36, 3),
                                         hmesh_test::jittered_grid(40, 36, 7, 7, 3));
        AnnealingOptions options;
        options.sweeps = 4;
        anneal(subject, subject.mesh.vertex_count(), options, seed);
        return hmesh_test::snapshot(subject.mesh);
    };
    CHECK(snapshot_of(9) == snapshot_of(9));
    CHECK_FALSE(snapshot_of(9) == snapshot_of(10));
}
