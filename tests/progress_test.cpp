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
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::kit::Effort;
using hmesh::Errc;
using hmesh::kit::ProgressReporter;
using hmesh::Options;
using hmesh::Progress;
using hmesh::kit::psnr_of_energy;
using hmesh::kit::TaskProgress;
using hmesh::ProgressInfo;
using hmesh::Target;

namespace {

// Notes every call; says stop at call number `stop_at`, counted from 0.
struct Recorder {
    struct Call {
        std::string stage;
        double fraction;
        std::size_t vertices;
        double energy;
    };
    std::vector<Call> calls;
    std::size_t stop_at = std::numeric_limits<std::size_t>::max();

    [[nodiscard]] Progress progress() {
        return {[](void* user, const ProgressInfo& info) {
                    Recorder& self = *static_cast<Recorder*>(user);
                    self.calls.push_back({info.stage, info.fraction, info.vertices, info.energy});
                    return self.calls.size() <= self.stop_at;
                },
                this};
    }
};

// Stages one after another, each from fraction 0 to 1 without a step back; returns their names.
std::vector<std::string> check_calls(const std::vector<Recorder::Call>& calls) {
    std::vector<std::string> stages;
    bool open = false;
    double last = 0;
    for (const Recorder::Call& call : calls) {
        CAPTURE(call.stage);
        CHECK(call.fraction >= 0);
        CHECK(call.fraction <= 1);
        CHECK(call.vertices >= 4);
        CHECK(std::isfinite(call.energy));
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
    return stages;
}

template <class T, int C>
void cancel_everywhere(const hmesh::Image<T, C>& image, Options options, std::size_t stride = 1) {
    Recorder all;
    options.progress = all.progress();
    const auto whole = hmesh::mesh_image(image.view(), options);
    REQUIRE(whole.status);
    double first = 0;
    for (std::size_t k = 0; k < all.calls.size(); k += stride) {
        CAPTURE(k);
        Recorder recorder;
        recorder.stop_at = k;
        options.progress = recorder.progress();
        const auto result = hmesh::mesh_image(image.view(), options);
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
template <class T, int C>
void cancel_everywhere(const hmesh::Image<T, C>& image, Target target, Effort effort, std::size_t stride = 1, int tile = 0) {
    Options options;
    options.target = target;
    options.effort = effort;
    options.tile = tile;
    cancel_everywhere(image, options, stride);
}

// Runs body(options) for each of the methods that annealed is compared with, with a little of everything they can do.
template <class Body>
void for_each_other_method(std::int64_t vertices, Body&& body) {
    using hmesh::Method;
    for (const Method method : {Method::hierarchical, Method::xie, Method::adams, Method::adaptive_thinning}) {
        CAPTURE(static_cast<int>(method));
        Options options;
        options.target = Target::vertices(vertices);
        options.method = method;
        options.hierarchical.levels = 3;
        body(options);
        if (method != Method::hierarchical) continue;
        options.hierarchical.start_filtered = false;
        options.hierarchical.geometry.rule = hmesh::kit::StepRule::literal;
        body(options);
    }
}

}  // namespace

TEST_CASE("a monitor without a callback goes on and notes what each stage left") {
    ProgressReporter monitor({}, 1000, 255);
    CHECK(monitor.begin("first", 4, 900));
    CHECK(monitor.update(0.5, 10, 500));
    CHECK(monitor.end(20, 100));
    CHECK(monitor.begin("second", 20, 100));
    CHECK(monitor.end(30, 0));
    CHECK_FALSE(monitor.stopped());
    REQUIRE(monitor.stages().size() == 2);
    CHECK(std::string(monitor.stages()[0].name) == "first");
    CHECK(monitor.stages()[0].vertices == 20);
    CHECK(monitor.stages()[0].energy == 100);
    CHECK(monitor.stages()[0].psnr == psnr_of_energy(100, 1000, 255));
    CHECK(monitor.stages()[1].psnr == std::numeric_limits<double>::infinity());
}

TEST_CASE("a stage reports the iterations of all its solves and the largest residual; the next begins with none") {
    ProgressReporter monitor({}, 1000, 255);
    monitor.begin("first", 4, 900);
    monitor.note_solve(7, 1e-7);
    monitor.update(0.5, 10, 500);
    monitor.note_solve(5, 3e-6);
    monitor.note_solve(0, 0);
    monitor.note_solve(11, 2e-6);
    monitor.end(20, 100);
    monitor.begin("second", 20, 100);
    monitor.end(20, 100);
    monitor.begin("third", 20, 100);
    monitor.note_solve(3, 1e-9);
    monitor.end(20, 100);
    monitor.begin("given up", 20, 100);
    monitor.note_solve(100, 1);
    monitor.begin("fourth", 20, 100);
    monitor.end(20, 100);
    REQUIRE(monitor.stages().size() == 4);
    CHECK(monitor.stages()[0].iterations == 23);
    CHECK(monitor.stages()[0].residual == 3e-6);
    CHECK(monitor.stages()[1].iterations == 0);
    CHECK(monitor.stages()[1].residual == 0);
    CHECK(monitor.stages()[2].iterations == 3);
    CHECK(monitor.stages()[2].residual == 1e-9);
    CHECK(monitor.stages()[3].iterations == 0);
    CHECK(monitor.stages()[3].residual == 0);
}

TEST_CASE("a monitor hands on stage, fraction in [0, 1], vertices and energy") {
    Recorder recorder;
    ProgressReporter monitor(recorder.progress(), 1000, 255);
    monitor.begin("work", 4, 900);
    for (const double fraction : {-3.0, 0.25, 7.0}) monitor.update(fraction, 10, 500);
    monitor.end(20, 100);
    REQUIRE(recorder.calls.size() == 5);
    CHECK(recorder.calls[0].fraction == 0);
    CHECK(recorder.calls[0].vertices == 4);
    CHECK(recorder.calls[0].energy == 900);
    CHECK(recorder.calls[1].fraction == 0);
    CHECK(recorder.calls[2].fraction == 0.25);
    CHECK(recorder.calls[3].fraction == 1);
    CHECK(recorder.calls[4].fraction == 1);
    CHECK(recorder.calls[4].vertices == 20);
    for (const auto& call : recorder.calls) CHECK(call.stage == "work");
}

TEST_CASE("an energy that rounding made negative is handed on as 0") {
    Recorder recorder;
    ProgressReporter monitor(recorder.progress(), 1000, 255);
    monitor.begin("work", 4, -1e-12);
    monitor.update(0.5, 4, -1e-9);
    monitor.end(4, -1e-12);
    REQUIRE(recorder.calls.size() == 3);
    for (const auto& call : recorder.calls) CHECK(call.energy == 0);
    CHECK(monitor.stages()[0].energy == 0);
}

TEST_CASE("once told to stop a monitor stays stopped and calls no more") {
    Recorder recorder;
    recorder.stop_at = 1;
    ProgressReporter monitor(recorder.progress(), 1000, 255);
    CHECK(monitor.begin("work", 4, 900));
    CHECK_FALSE(monitor.update(0.5, 10, 500));
    CHECK(monitor.stopped());
    CHECK_FALSE(monitor.update(0.7, 10, 500));
    CHECK_FALSE(monitor.end(20, 100));
    CHECK_FALSE(monitor.begin("next", 20, 100));
    CHECK(recorder.calls.size() == 2);
}

TEST_CASE("polled from several threads a monitor never calls twice at a time, and says stop to all once told so") {
    struct Shared {
        std::atomic<int> inside{0}, most{0}, calls{0};
        int plain = 0;  // what a race would spoil
    } shared;
    constexpr int last = 2000;
    const Progress progress{[](void* user, const ProgressInfo&) {
                                Shared& s = *static_cast<Shared*>(user);
                                const int inside = ++s.inside;
                                if (inside > s.most) s.most = inside;
                                ++s.plain;
                                const bool go_on = ++s.calls < last;
                                --s.inside;
                                return go_on;
                            },
                            &shared};
    ProgressReporter monitor(progress, 1000, 255);
    std::atomic<int> taken_back{0};
    std::vector<std::thread> threads;
    for (int k = 0; k < 4; ++k)
        threads.emplace_back([&] {
            while (monitor.poll()) monitor.add(1e-6);
            for (int i = 0; i < 100; ++i) taken_back += monitor.poll() ? 1 : 0;
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(shared.most == 1);
    CHECK(shared.calls == last);
    CHECK(shared.plain == last);
    CHECK(taken_back == 0);
    CHECK(monitor.stopped());
}

TEST_CASE("a monitor does not call from within its call") {
    struct Nested {
        ProgressReporter* monitor = nullptr;
        int calls = 0;
        bool inner = false;
    } nested;
    ProgressReporter monitor({[](void* user, const ProgressInfo&) {
                         Nested& n = *static_cast<Nested*>(user);
                         ++n.calls;
                         n.inner = n.monitor->poll();
                         return true;
                     },
                     &nested},
                    1000, 255);
    nested.monitor = &monitor;
    CHECK(monitor.poll());
    CHECK(nested.calls == 1);
    CHECK(nested.inner);
}

TEST_CASE("the fractions of pieces at work add up to the range expected, rise only and never exceed it") {
    for (const auto& [from, to] : {std::pair{0.0, 1.0}, {0.25, 0.5}, {0.5, 0.5}, {-3.0, 7.0}}) {
        const double first = std::max(0.0, from), end = std::min(1.0, to);
        Recorder recorder;
        ProgressReporter monitor(recorder.progress(), 1000, 255);
        monitor.begin("work", 4, 900);
        monitor.set_range(from, to);
        hmesh::kit::Random random(3);
        {
            std::vector<std::unique_ptr<TaskProgress>> pulses;
            std::vector<double> apportion(7);
            double sum = 0, expected = 0;
            for (double& share : shares) sum += share = random.uniform();
            std::vector<double> reached(shares.size(), 0.0);
            for (double& share : shares) pulses.push_back(std::make_unique<TaskProgress>(monitor, share /= sum));
            for (int k = 0; k < 300; ++k) {
                const std::size_t i = random.below(pulses.size());
                const double odd[] = {-1, 0, 0.3, 0.7, 1, 2, std::numeric_limits<double>::quiet_NaN()};
                const double fraction = odd[random.below(k < 200 ? 4U : 7U)] * (k < 200 ? random.uniform() : 1);
                pulses[i]->set_fraction(fraction);
                if (fraction > reached[i]) reached[i] = std::min(1.0, fraction);
                monitor.poll();
                expected = 0;
                for (std::size_t j = 0; j < shares.size(); ++j) expected += shares[j] * reached[j];
                CHECK(recorder.calls.back().fraction == doctest::Approx(first + expected * (end - first)).epsilon(1e-9));
            }
        }
        monitor.poll();
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
    ProgressReporter monitor(recorder.progress(), 1000, 255);
    monitor.begin("work", 4, 900);
    monitor.set_range(0.2, 0.6);
    { const TaskProgress task(monitor, 0.25); }
    monitor.poll();
    CHECK(recorder.calls.back().fraction == doctest::Approx(0.3));
    monitor.set_range(0.6, 1);  // starts anew
    monitor.poll();
    CHECK(recorder.calls.back().fraction == 0.6);
}

TEST_CASE("a beat asks the callback every 256th time, and not at all once the work is to stop") {
    Recorder recorder;
    ProgressReporter monitor(recorder.progress(), 1000, 255);
    TaskProgress task(monitor, 1);
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
    TaskProgress other(monitor, 0.5);
    for (int k = 0; k < 1000; ++k) REQUIRE_FALSE((task.keep_going() || other.keep_going()));
    CHECK(recorder.calls.size() == 13);
}

TEST_CASE("mesh_image reports each stage from 0 to 1 without a step back, and its report lists the same stages") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::best}) {
        Recorder recorder;
        Options options;
        options.target = Target::vertices(60);
        options.effort = effort;
        options.progress = recorder.progress();
        const auto result = hmesh::mesh_image(image.view(), options);
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
    for_each_other_method(60, [&](Options& options) {
        Recorder recorder;
        options.progress = recorder.progress();
        const auto result = hmesh::mesh_image(image.view(), options);
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
        CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options), result));
    });
}

TEST_CASE("pictures without error, one vertex a pixel and the smallest images report their stages alike") {
    const auto check_image = [](const auto& image, std::int64_t vertices) {
        for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
            Recorder recorder;
            Options options;
            options.target = Target::vertices(vertices);
            options.effort = effort;
            options.progress = recorder.progress();
            CHECK(hmesh::mesh_image(image.view(), options).status);
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
    Recorder recorder;
    Options options;
    options.target = Target::psnr(30);
    options.effort = Effort::fast;
    options.progress = recorder.progress();
    CHECK(hmesh::mesh_image(image.view(), options).status);
    CHECK(check_calls(recorder.calls).size() > 10);
}

TEST_CASE("a progress callback changes no byte of the result") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 2);
    Recorder recorder;
    Options options;
    options.target = Target::vertices(60);
    const auto silent = hmesh::mesh_image(image.view(), options);
    options.progress = recorder.progress();
    CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options), silent));
}

TEST_CASE("cancelled at any call, mesh_image returns a valid mesh and a report that is true of it") {
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(40, 36, 2), Target::vertices(60), Effort::draft);
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(40, 36, 2), Target::vertices(60), Effort::fast);
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::vertices(40), Effort::normal);
    cancel_everywhere(hmesh_test::scene<float, 1>(32, 28, 3), Target::vertices(40), Effort::normal);
    cancel_everywhere(hmesh_test::noise<std::uint8_t, 1>(1, 1, 1), Target::vertices(4), Effort::normal);
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::vertices(40), Effort::best, 499);
}

TEST_CASE("cancelled at any call, the methods that annealed is compared with return a valid mesh and a true report") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(26, 22, 3);
    for_each_other_method(30, [&](const Options& options) { cancel_everywhere(image, options); });
    const auto floats = hmesh_test::scene<float, 1>(24, 20, 3);
    for_each_other_method(150, [&](const Options& options) { cancel_everywhere(floats, options, 5); });
    for_each_other_method(
        4, [&](const Options& options) { cancel_everywhere(hmesh_test::noise<std::uint8_t, 1>(1, 1, 1), options); });
}

TEST_CASE("cancelled at any call of work in tiles, mesh_image returns a valid mesh and a report that is true of it") {
    for (const auto& [effort, stride] : {std::pair{Effort::draft, 5U}, {Effort::fast, 29U}, {Effort::normal, 173U}})
        cancel_everywhere(hmesh_test::scene<std::uint8_t, 1>(98, 96, 3), Target::vertices(700), effort, stride, 64);
}

TEST_CASE("cancelled at any call of a search, mesh_image returns a valid mesh and a report that is true of it") {
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::psnr(28), Effort::draft);
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::psnr(28), Effort::fast, 7);
}
