#include "hmesh/core/progress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/paper.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Options;
using hmesh::ProgressInfo;
using hmesh::Target;
using hmesh::kit::PollingExecutor;
using hmesh::kit::ProgressReporter;
using hmesh::kit::psnr_of_energy;
using hmesh::kit::TaskProgress;

namespace {

// Notes every call; says stop at call number `stop_at`, counted from 0.
struct Recorder {
    struct Call {
        std::string stage;
        double fraction;
        std::size_t vertices;
        double energy;
        double total;
    };
    std::vector<Call> calls;
    std::size_t stop_at = std::numeric_limits<std::size_t>::max();

    bool operator()(const ProgressInfo& info) {
        calls.push_back({info.stage, info.fraction, info.vertices, info.energy, info.total});
        return calls.size() <= stop_at;
    }
};

// Stages one after another, each from fraction 0 to 1 without a step back; returns their names.
std::vector<std::string> check_calls(const std::vector<Recorder::Call>& calls) {
    std::vector<std::string> stages;
    bool open = false;
    double last = 0, total = 0;
    for (const Recorder::Call& call : calls) {
        CAPTURE(call.stage);
        CHECK(call.fraction >= 0);
        CHECK(call.fraction <= 1);
        CHECK(call.vertices >= 4);
        CHECK(std::isfinite(call.energy));
        CHECK(call.total >= total);
        CHECK(call.total <= 1);
        total = call.total;
        if (!open) {
            CHECK(call.fraction == 0);
            stages.push_back(call.stage);
            open = true;
        } else {
            CHECK(call.stage == stages.back());
            CHECK(call.fraction >= last);
        }
        last = call.fraction;
        // The last call of a stage: fraction 1, and then comes another stage or nothing.
        const auto k = static_cast<std::size_t>(&call - calls.data());
        if (k + 1 == calls.size() || calls[k + 1].stage != call.stage) {
            CHECK(call.fraction == 1);
            open = false;
        }
    }
    CHECK(total == 1);
    return stages;
}

// What a callback is told of a mesh that is finished.
template <class T, int C>
std::vector<Recorder::Call> calls_of(const hmesh::Image<T, C>& image, Target target, const Annealed& recipe) {
    Recorder recorder;
    Options options;
    options.target = target;
    options.progress = recorder;
    CHECK(hmesh::mesh_image(image.view(), options, recipe).status);
    return recorder.calls;
}

template <class T, int C, class Recipe>
void cancel_everywhere(const hmesh::Image<T, C>& image, Target target, const Recipe& recipe, std::size_t stride = 1) {
    Options options;
    options.target = target;
    Recorder all;
    options.progress = all;
    const hmesh::Result finished = hmesh::mesh_image(image.view(), options, recipe);
    REQUIRE(finished.status);
    double first = 0;
    for (std::size_t k = 0; k < all.calls.size(); k += stride * hmesh_test::stride_if_sanitized(11)) {
        CAPTURE(k);
        Recorder recorder;
        recorder.stop_at = k;
        options.progress = recorder;
        const hmesh::Result result = hmesh::mesh_image(image.view(), options, recipe);
        CHECK(result.status.code == Errc::cancelled);
        CHECK(std::string(result.status.what).size() > 8);
        CHECK(recorder.calls.size() == k + 1);  // never called again
        hmesh_test::prove_report(image, result);
        // Never worse than what there is at the first call: the four corners.
        CHECK(result.report.vertices >= 4);
        if (k == 0) first = result.report.energy;
        CHECK(result.report.energy <= 1.2 * first);
    }
}

Annealed annealed(Effort effort, int tile = 0) {
    Annealed recipe;
    recipe.effort = effort;
    recipe.tile = tile;
    return recipe;
}

// Runs body(recipe) for each of the methods that annealed is compared with, with a little of everything they can do.
template <class Body>
void for_each_other_method(Body&& body) {
    hmesh::Hierarchical recipe;
    recipe.levels = 3;
    body(recipe);
    recipe.start_filtered = false;
    recipe.geometry.rule = hmesh::kit::StepRule::literal;
    body(recipe);
    body(hmesh::Xie());
    body(hmesh::Adams());
    body(hmesh::AdaptiveThinning());
}

}  // namespace

TEST_CASE("a reporter without a callback goes on and notes what each stage left") {
    ProgressReporter reporter({}, 1000, 255);
    CHECK(reporter.begin("first", 4, 900));
    CHECK(reporter.update(0.5, 10, 500));
    CHECK(reporter.end(20, 100));
    CHECK(reporter.begin("second", 20, 100));
    CHECK(reporter.end(30, 0));
    CHECK_FALSE(reporter.stopped());
    REQUIRE(reporter.stages().size() == 2);
    CHECK(std::string(reporter.stages()[0].name) == "first");
    CHECK(reporter.stages()[0].vertices == 20);
    CHECK(reporter.stages()[0].energy == 100);
    CHECK(reporter.stages()[0].psnr == psnr_of_energy(100, 1000, 255));
    CHECK(reporter.stages()[1].psnr == std::numeric_limits<double>::infinity());
}

TEST_CASE("a stage reports the iterations of all its solves and the largest residual; the next begins with none") {
    ProgressReporter reporter({}, 1000, 255);
    reporter.begin("first", 4, 900);
    reporter.note_solve(7, 1e-7);
    reporter.update(0.5, 10, 500);
    reporter.note_solve(5, 3e-6);
    reporter.note_solve(0, 0);
    reporter.note_solve(11, 2e-6);
    reporter.end(20, 100);
    reporter.begin("second", 20, 100);
    reporter.end(20, 100);
    reporter.begin("third", 20, 100);
    reporter.note_solve(3, 1e-9);
    reporter.end(20, 100);
    reporter.begin("given up", 20, 100);
    reporter.note_solve(100, 1);
    reporter.begin("fourth", 20, 100);
    reporter.end(20, 100);
    REQUIRE(reporter.stages().size() == 4);
    CHECK(reporter.stages()[0].iterations == 23);
    CHECK(reporter.stages()[0].residual == 3e-6);
    CHECK(reporter.stages()[1].iterations == 0);
    CHECK(reporter.stages()[1].residual == 0);
    CHECK(reporter.stages()[2].iterations == 3);
    CHECK(reporter.stages()[2].residual == 1e-9);
    CHECK(reporter.stages()[3].iterations == 0);
    CHECK(reporter.stages()[3].residual == 0);
}

TEST_CASE("a reporter hands on stage, fraction in [0, 1], vertices and energy") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255);
    reporter.begin("work", 4, 900);
    for (const double fraction : {-3.0, 0.25, 7.0}) reporter.update(fraction, 10, 500);
    reporter.end(20, 100);
    REQUIRE(recorder.calls.size() == 5);
    CHECK(recorder.calls[0].fraction == 0);
    CHECK(recorder.calls[0].vertices == 4);
    CHECK(recorder.calls[0].energy == 900);
    CHECK(recorder.calls[1].fraction == 0);
    CHECK(recorder.calls[2].fraction == 0.25);
    CHECK(recorder.calls[3].fraction < 1);  // the stage has not ended
    CHECK(recorder.calls[3].fraction > 0.999999);
    CHECK(recorder.calls[4].fraction == 1);
    CHECK(recorder.calls[4].vertices == 20);
    for (const auto& call : recorder.calls) CHECK(call.stage == "work");
}

TEST_CASE("an energy that rounding made negative is handed on as 0") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255);
    reporter.begin("work", 4, -1e-12);
    reporter.update(0.5, 4, -1e-9);
    reporter.end(4, -1e-12);
    REQUIRE(recorder.calls.size() == 3);
    for (const auto& call : recorder.calls) CHECK(call.energy == 0);
    CHECK(reporter.stages()[0].energy == 0);
}

TEST_CASE("once told to stop a reporter stays stopped and calls no more") {
    Recorder recorder;
    recorder.stop_at = 1;
    ProgressReporter reporter(recorder, 1000, 255);
    CHECK(reporter.begin("work", 4, 900));
    CHECK_FALSE(reporter.update(0.5, 10, 500));
    CHECK(reporter.stopped());
    CHECK_FALSE(reporter.update(0.7, 10, 500));
    CHECK_FALSE(reporter.end(20, 100));
    CHECK_FALSE(reporter.begin("next", 20, 100));
    CHECK(recorder.calls.size() == 2);
}

TEST_CASE("polled from several threads a reporter never calls twice at a time, and says stop to all once told so") {
    struct Shared {
        std::atomic<int> inside{0}, most{0}, calls{0};
        int plain = 0;  // what a race would spoil
    } shared;
    constexpr int last = 2000;
    const auto callback = [&](const ProgressInfo&) {
        const int inside = ++shared.inside;
        if (inside > shared.most) shared.most = inside;
        ++shared.plain;
        const bool go_on = ++shared.calls < last;
        --shared.inside;
        return go_on;
    };
    ProgressReporter reporter(callback, 1000, 255);
    std::atomic<int> taken_back{0};
    std::vector<std::thread> threads;
    for (int k = 0; k < 4; ++k)
        threads.emplace_back([&] {
            while (reporter.poll()) reporter.add(1e-6);
            for (int i = 0; i < 100; ++i) taken_back += reporter.poll() ? 1 : 0;
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(shared.most == 1);
    CHECK(shared.calls == last);
    CHECK(shared.plain == last);
    CHECK(taken_back == 0);
    CHECK(reporter.stopped());
}

TEST_CASE("a reporter does not call from within its call") {
    ProgressReporter* self = nullptr;
    int calls = 0;
    bool inner = false;
    const auto callback = [&](const ProgressInfo&) {
        ++calls;
        inner = self->poll();
        return true;
    };
    ProgressReporter reporter(callback, 1000, 255);
    self = &reporter;
    CHECK(reporter.poll());
    CHECK(calls == 1);
    CHECK(inner);
}

TEST_CASE("the fractions of pieces at work add up to the range expected, rise only and never exceed it") {
    for (const auto& [from, to] : {std::pair{0.0, 1.0}, {0.25, 0.5}, {0.5, 0.5}, {-3.0, 7.0}}) {
        const double first = std::max(0.0, from), end = std::min(1.0, to);
        Recorder recorder;
        ProgressReporter reporter(recorder, 1000, 255);
        reporter.begin("work", 4, 900);
        reporter.set_range(from, to);
        hmesh::kit::Random random(3);
        {
            std::vector<std::unique_ptr<TaskProgress>> tasks;
            std::vector<double> shares(7);
            double sum = 0, expected = 0;
            for (double& share : shares) sum += share = random.uniform();
            std::vector<double> reached(shares.size(), 0.0);
            for (double& share : shares) tasks.push_back(std::make_unique<TaskProgress>(reporter, share /= sum));
            for (int k = 0; k < 300; ++k) {
                const std::size_t i = random.below(tasks.size());
                const double odd[] = {-1, 0, 0.3, 0.7, 1, 2, std::numeric_limits<double>::quiet_NaN()};
                const double fraction = odd[random.below(k < 200 ? 4U : 7U)] * (k < 200 ? random.uniform() : 1);
                tasks[i]->set_fraction(fraction);
                if (fraction > reached[i]) reached[i] = std::min(1.0, fraction);
                reporter.poll();
                expected = 0;
                for (std::size_t j = 0; j < shares.size(); ++j) expected += shares[j] * reached[j];
                CHECK(recorder.calls.back().fraction == doctest::Approx(first + expected * (end - first)).epsilon(1e-9));
            }
        }
        reporter.poll();
        CHECK(recorder.calls.back().fraction == doctest::Approx(end).epsilon(1e-9));
        double last = 0;
        for (const Recorder::Call& call : recorder.calls) {
            CHECK(call.fraction >= (&call == recorder.calls.data() ? 0 : last));
            CHECK(call.fraction <= end);
            last = call.fraction;
        }
    }
}

TEST_CASE("a piece that ends is done, whether it said so or not") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255);
    reporter.begin("work", 4, 900);
    reporter.set_range(0.2, 0.6);
    { const TaskProgress task(reporter, 0.25); }
    reporter.poll();
    CHECK(recorder.calls.back().fraction == doctest::Approx(0.3));
    reporter.set_range(0.6, 1);  // starts anew
    reporter.poll();
    CHECK(recorder.calls.back().fraction == 0.6);
}

TEST_CASE("keep_going asks the callback every 256th time, and not at all once the work is to stop") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255);
    TaskProgress task(reporter, 1);
    for (std::size_t k = 1; k <= 3000; ++k) {
        CHECK(task.keep_going());
        REQUIRE(recorder.calls.size() == k / 256);
    }
    recorder.stop_at = 12;
    std::size_t beats = 0;
    while (task.keep_going()) ++beats;
    CHECK(beats < 2 * 256);
    CHECK(recorder.calls.size() == 13);
    CHECK(task.stopped());
    TaskProgress other(reporter, 0.5);
    for (int k = 0; k < 1000; ++k) REQUIRE_FALSE((task.keep_going() || other.keep_going()));
    CHECK(recorder.calls.size() == 13);
}

TEST_CASE("an executor that polls asks before each piece, does all of them though told to stop, and turns to another reporter") {
    Recorder recorder, other;
    recorder.stop_at = 2;
    ProgressReporter reporter(recorder, 1000, 255), next(other, 1000, 255);
    PollingExecutor executor(reporter, {});
    std::vector<std::size_t> pieces, asked;
    executor(5, [&](std::size_t i) {
        pieces.push_back(i);
        asked.push_back(recorder.calls.size());
    });
    CHECK(pieces == std::vector<std::size_t>{0, 1, 2, 3, 4});
    CHECK(asked == std::vector<std::size_t>{1, 2, 3, 3, 3});
    CHECK(reporter.stopped());
    executor.report_to(next);
    executor(7, [](std::size_t) {});
    CHECK(recorder.calls.size() == 3);
    CHECK(other.calls.size() == 7);
}

TEST_CASE("passes over all pixels, edges and faces tell of themselves: a callback waits for no stage to end") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(200, 640, 2);
    std::size_t points = 0, colors = 0;
    for (const Recorder::Call& call : calls_of(image, Target::vertices(3000), annealed(Effort::draft))) {
        points += call.stage == "points" ? 1 : 0;
        colors += call.stage == "colors" ? 1 : 0;
    }
    CHECK(points > 20 + 20 + 10);     // 20 bands have densities and ranks, 10 are parts of the table
    CHECK(colors > 6000 / 1024 * 3);  // faces have corners, sums and largest errors
}

TEST_CASE("mesh_image reports each stage from 0 to 1 without a step back, and its report lists the same stages") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::fine, Effort::best}) {
        Recorder recorder;
        Options options;
        options.target = Target::vertices(60);
        options.progress = recorder;
        const hmesh::Result result = hmesh::mesh_image(image.view(), options, annealed(effort));
        hmesh_test::prove_result(image, result, 60);
        const std::vector<std::string> stages = check_calls(recorder.calls);
        REQUIRE(stages.size() == result.report.stages.size());
        for (std::size_t k = 0; k < stages.size(); ++k) CHECK(stages[k] == result.report.stages[k].name);
        CHECK(stages.back() == "colors");
        CHECK(result.report.stages.back().energy == result.report.energy);
        CHECK(result.report.stages.back().vertices == result.report.vertices);
        CHECK(result.report.stages.back().psnr == result.report.psnr);
        CHECK(recorder.calls.back().energy == result.report.energy);
    }
}

TEST_CASE("the methods that annealed is compared with report their stages alike") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    for_each_other_method([&](const auto& recipe) {
        Recorder recorder;
        Options options;
        options.target = Target::vertices(60);
        options.progress = recorder;
        const hmesh::Result result = hmesh::mesh_image(image.view(), options, recipe);
        hmesh_test::prove_result(image, result, 60);
        const std::vector<std::string> stages = check_calls(recorder.calls);
        REQUIRE(stages.size() == result.report.stages.size());
        for (std::size_t k = 0; k < stages.size(); ++k) {
            const hmesh::StageReport& stage = result.report.stages[k];
            CHECK(stages[k] == stage.name);
            CHECK(stage.psnr == psnr_of_energy(stage.energy, 40 * 36 * 3, 255));
            CHECK(stage.energy > 0);
        }
        CHECK(stages.back() == "colors");
        CHECK(result.report.stages.back().energy == result.report.energy);
        options.progress = {};
        CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options, recipe), result));
    });
}

TEST_CASE("pictures without error, one vertex a pixel and the smallest images report their stages alike") {
    const auto check_image = [](const auto& image, std::int64_t vertices) {
        for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
            Recorder recorder;
            Options options;
            options.target = Target::vertices(vertices);
            options.progress = recorder;
            CHECK(hmesh::mesh_image(image.view(), options, annealed(effort)).status);
            check_calls(recorder.calls);
        }
    };
    check_image(hmesh_test::noise<std::uint8_t, 1>(1, 1, 1), 4);
    check_image(hmesh_test::noise<std::uint8_t, 1>(3, 2, 1), 6);
    check_image(hmesh_test::constant_image<std::uint8_t, 3>(12, 9, 0.5), 40);
    check_image(hmesh_test::affine_image<float, 1>(12, 9), 108);
}

TEST_CASE("a search for a PSNR reports the stages of each of its runs") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    CHECK(check_calls(calls_of(image, Target::psnr(30), annealed(Effort::fast))).size() > 10);
}

TEST_CASE("a search for a PSNR that none reaches, or that needs all pixels, ends with a total of 1 too") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(6, 5, 1);
    for (const double psnr : {200.0, 2.0}) {
        Recorder recorder;
        Options options;
        options.target = Target::psnr(psnr);
        options.progress = recorder;
        const hmesh::Result result = hmesh::mesh_image(image.view(), options, annealed(Effort::draft));
        CHECK(result.status.code == (psnr > 100 ? Errc::target_out_of_range : Errc::ok));
        check_calls(recorder.calls);
        CHECK(recorder.calls.back().energy == result.report.energy);
    }
    Recorder recorder;
    Options options;
    options.target = Target::psnr(20);
    options.progress = recorder;
    const auto scene = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    CHECK(hmesh::mesh_image(scene.view(), options, hmesh::Adams()).status);
    check_calls(recorder.calls);
}

TEST_CASE("the stages of a plan take their shares of the run's span, whatever follows or is missing") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255, {0.2, 0.7});
    reporter.plan({1, 4, 3, 2});
    reporter.plan({1, 1});  // of a method within: no heed is taken
    const auto total = [&] { return recorder.calls.back().total; };
    reporter.begin("first", 4, 900);
    CHECK(total() == doctest::Approx(0.2));
    reporter.end(4, 900);
    CHECK(total() == doctest::Approx(0.25));
    reporter.begin("second", 4, 900);
    reporter.update(0.5, 4, 900);
    CHECK(total() == doctest::Approx(0.35));
    reporter.update(0.25, 4, 900);  // never falls
    CHECK(total() == doctest::Approx(0.35));
    SUBCASE("a stage is left out") {
        reporter.begin_colors(4, 900);
        CHECK(total() == doctest::Approx(0.6));
    }
    SUBCASE("two come that are not in the plan") {
        reporter.begin("third", 4, 900);
        CHECK(total() == doctest::Approx(0.45));
        reporter.end(4, 900);
        CHECK(total() == doctest::Approx(0.6));
        for (const char* more : {"fourth", "fifth"}) {
            reporter.begin(more, 4, 900);
            reporter.end(4, 900);
            CHECK(total() == doctest::Approx(0.6));
        }
        reporter.begin_colors(4, 900);
    }
    CHECK(recorder.calls.back().stage == "colors");
    reporter.end(4, 900);
    CHECK(total() == 0.7);
}

TEST_CASE("stages without a plan take half of what is left each") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255);
    for (const double expected : {0.5, 0.75, 0.875}) {
        reporter.begin("own", 4, 900);
        reporter.end(4, 900);
        CHECK(recorder.calls.back().total == expected);
    }
    reporter.begin_colors(4, 900);
    reporter.end(4, 900);
    CHECK(recorder.calls.back().total == 1);
}

TEST_CASE("a task that expects a number of beats moves on with them, as far as it said and no further") {
    Recorder recorder;
    ProgressReporter reporter(recorder, 1000, 255);
    reporter.begin("work", 4, 900);
    reporter.set_range(0, 1);
    TaskProgress task(reporter, 1);
    task.expect(0.5, 1024);
    for (const double expected : {0.125, 0.25, 0.375, 0.5, 0.5, 0.5}) {
        for (int k = 0; k < 256; ++k) CHECK(task.keep_going());
        CHECK(recorder.calls.back().fraction == doctest::Approx(expected));
    }
    task.expect(0.3, 1000);  // never falls
    for (int k = 0; k < 256; ++k) CHECK(task.keep_going());
    CHECK(recorder.calls.back().fraction == doctest::Approx(0.5));
    task.expect(1, 3);
    for (int k = 0; k < 256; ++k) CHECK(task.keep_going());
    CHECK(recorder.calls.back().fraction == doctest::Approx(1));
}

TEST_CASE("the work of a run is that of the stages it has, and less from a mesh than from the start") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::fine, Effort::best}) {
        const hmesh::kit::AnnealedSteps steps = hmesh::kit::annealed_steps(effort);
        const hmesh::kit::AnnealedWork work = hmesh::kit::annealed_work(steps, 262144, 2621, 0);
        CHECK(work.collapse > 0);
        CHECK((work.anneal > 0) == (effort >= Effort::fast));
        CHECK(work.sum() > work.settle + work.collapse + work.anneal);
        Annealed recipe = annealed(effort);
        CHECK(recipe.work(512, 512, 2621) == work.sum());
        hmesh::Mesh any;  // as searches ask what it will take to go on from a mesh that is not there yet
        recipe.start = &any;
        const double as_many = recipe.work(512, 512, 2621);
        CHECK(as_many == hmesh::kit::annealed_work(steps, 262144, 2621, 2621).sum());
        CHECK(as_many < work.sum());
        any.positions.resize(2 * std::size_t{2621});
        CHECK(recipe.work(512, 512, 2621) == as_many);
        any.positions.resize(2 * std::size_t{26210});
        CHECK(recipe.work(512, 512, 2621) == hmesh::kit::annealed_work(steps, 262144, 2621, 26210).sum());
        CHECK(recipe.work(512, 512, 2621) > as_many + work.collapse);
    }
}

TEST_CASE("a progress callback changes no byte of the result") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    Recorder recorder;
    Options options;
    options.target = Target::vertices(60);
    const hmesh::Result silent = hmesh::mesh_image(image.view(), options);
    options.progress = recorder;
    CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options), silent));
}

TEST_CASE("cancelled where a target is out of range, mesh_image says cancelled and does not call again") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(7, 5, 1);
    for (const hmesh::Target& target : {hmesh::Target::vertices(5), hmesh::Target::psnr(37)})
        for (int stop = 1; stop < 60; ++stop) {
            int calls = 0;
            const auto progress = [&](const hmesh::ProgressInfo&) { return ++calls < stop; };
            hmesh::Options options;
            options.samples = hmesh::Samples::points;
            options.target = target;
            options.progress = progress;
            hmesh::Annealed recipe;
            recipe.border_tolerance = 0;
            const hmesh::Result result = hmesh::mesh_image(image.view(), options, recipe);
            CHECK(calls <= stop);
            if (calls == stop) CHECK(result.status.code == Errc::cancelled);
        }
}

TEST_CASE("cancelled at any call, mesh_image returns a valid mesh and a report that is true of it") {
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(40, 36, 2), Target::vertices(60), annealed(Effort::draft));
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(40, 36, 2), Target::vertices(60), annealed(Effort::fast));
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::vertices(40), annealed(Effort::normal));
    cancel_everywhere(hmesh_test::scene<float, 1>(32, 28, 3), Target::vertices(40), annealed(Effort::normal));
    cancel_everywhere(hmesh_test::noise<std::uint8_t, 1>(1, 1, 1), Target::vertices(4), annealed(Effort::normal));
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::vertices(40), annealed(Effort::best), 499);
}

TEST_CASE("cancelled at any call, the methods that annealed is compared with return a valid mesh and a true report") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(26, 22, 3);
    for_each_other_method([&](const auto& recipe) { cancel_everywhere(image, Target::vertices(30), recipe); });
    const auto floats = hmesh_test::scene<float, 1>(24, 20, 3);
    for_each_other_method([&](const auto& recipe) { cancel_everywhere(floats, Target::vertices(150), recipe, 5); });
    const auto pixel = hmesh_test::noise<std::uint8_t, 1>(1, 1, 1);
    for_each_other_method([&](const auto& recipe) { cancel_everywhere(pixel, Target::vertices(4), recipe); });
}

TEST_CASE("cancelled at any call of work in tiles, mesh_image returns a valid mesh and a report that is true of it") {
    for (const auto& [effort, stride] : {std::pair{Effort::draft, 5U}, {Effort::fast, 29U}, {Effort::normal, 173U}})
        cancel_everywhere(hmesh_test::scene<std::uint8_t, 1>(98, 96, 3), Target::vertices(700), annealed(effort, 64), stride);
}

TEST_CASE("cancelled at any call of a search, mesh_image returns a valid mesh and a report that is true of it") {
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::psnr(28), annealed(Effort::draft), 3);
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::psnr(28), annealed(Effort::fast), 7);
}
