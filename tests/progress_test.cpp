#include "hmesh/core/progress.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "test_images.hpp"
#include "test_results.hpp"

using hmesh::Effort;
using hmesh::Errc;
using hmesh::Monitor;
using hmesh::Options;
using hmesh::Progress;
using hmesh::psnr_of_energy;
using hmesh::StageInfo;
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
        return {[](void* user, const StageInfo& info) {
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
        const std::size_t k = static_cast<std::size_t>(&call - calls.data());
        if (k + 1 == calls.size() || calls[k + 1].fraction == 0) {
            CHECK(call.fraction == 1);
            open = false;
        }
    }
    return stages;
}

template <class T, int C>
void cancel_everywhere(const hmesh::Image<T, C>& image, Target target, Effort effort, std::size_t stride = 1) {
    Options options;
    options.target = target;
    options.effort = effort;
    Recorder all;
    options.progress = all.progress();
    const auto whole = hmesh::mesh_image(image.view(), options);
    REQUIRE(whole.status);
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
        // The mesh is the one told of last, or later by the little that was under way; never worse than the first grid.
        CHECK(result.report.vertices >= 4);
        CHECK(result.report.energy <= 1.2 * all.calls.front().energy);
    }
}

}  // namespace

TEST_CASE("PSNR is 10 log10(peak^2 / MSE) over pixels and channels, infinite without error") {
    CHECK(psnr_of_energy(300.0, 300, 255) == doctest::Approx(20 * std::log10(255.0)));
    CHECK(psnr_of_energy(0.01, 1, 1) == doctest::Approx(20));
    CHECK(psnr_of_energy(100, 1, 1) == doctest::Approx(-20));
    CHECK(psnr_of_energy(65535.0 * 65535.0, 1, 65535) == doctest::Approx(0));
    CHECK(psnr_of_energy(0, 300, 255) == std::numeric_limits<double>::infinity());
    CHECK(psnr_of_energy(-1e-12, 300, 255) == std::numeric_limits<double>::infinity());  // rounding
}

TEST_CASE("a monitor without a callback goes on and notes what each stage left") {
    Monitor monitor({}, 1000, 255);
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

TEST_CASE("a monitor hands on stage, fraction in [0, 1], vertices and energy") {
    Recorder recorder;
    Monitor monitor(recorder.progress(), 1000, 255);
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

TEST_CASE("once told to stop a monitor stays stopped and calls no more") {
    Recorder recorder;
    recorder.stop_at = 1;
    Monitor monitor(recorder.progress(), 1000, 255);
    CHECK(monitor.begin("work", 4, 900));
    CHECK_FALSE(monitor.update(0.5, 10, 500));
    CHECK(monitor.stopped());
    CHECK_FALSE(monitor.update(0.7, 10, 500));
    CHECK_FALSE(monitor.end(20, 100));
    CHECK_FALSE(monitor.begin("next", 20, 100));
    CHECK(recorder.calls.size() == 2);
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
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::vertices(40), Effort::best, 97);
}

TEST_CASE("cancelled at any call of a search, mesh_image returns a valid mesh and a report that is true of it") {
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::psnr(28), Effort::draft);
    cancel_everywhere(hmesh_test::scene<std::uint8_t, 3>(32, 28, 3), Target::psnr(28), Effort::fast, 7);
}
