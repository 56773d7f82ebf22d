#include "hmesh/methods/psnr_search_going_on.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/result.hpp"

namespace {

using hmesh::Errc;
using hmesh::Result;
using hmesh::kit::fewest_vertices_going_on;

// A method that goes on: whole runs and refined meshes follow the curve; drafts and sketches need more vertices for as much.
struct Goer {
    double draft = 0.5, sketch = 0.8, slope = 1.6, at_1000 = 30;
    double bend = 0;  // by which the slope grows with each doubling
    double won = 0;   // dB by each run that goes on from a mesh, at most three times
    double cost = 0;  // in whole runs of the final number of vertices, once divided by it
    int went_on = 0;
    std::vector<std::size_t> asked;
    std::vector<hmesh::kit::Work> works;
    int cancel_at = -1;
    std::size_t places = std::numeric_limits<std::size_t>::max();  // for vertices: a run of more of them has so many and fails

    [[nodiscard]] double psnr_of(double n) const {
        const double doublings = std::log2(n / 1000);
        return at_1000 + (slope + bend * doublings / 2) * doublings;
    }
    Result operator()(std::size_t n, const hmesh::kit::Beginning& from) {
        using hmesh::kit::Work;
        const double work[] = {from.mesh != nullptr ? 0.65 : 1, 0.375, 0.2, 0.07, 0.4, 0.15};
        const auto count = static_cast<double>(n);
        cost += work[static_cast<int>(from.work)] * count;
        if (from.mesh != nullptr) {
            CHECK(static_cast<double>(from.mesh->vertex_count()) >= 0.8 * count);
            CHECK(static_cast<double>(from.mesh->vertex_count()) <= 2.02 * count);
        }
        Result result;
        result.report.psnr = psnr_of((from.work == Work::sketch ? sketch : from.work == Work::draft ? draft : 1) * count);
        went_on = from.mesh == nullptr ? 0 : std::min(3, went_on + 1);
        result.report.psnr += won * went_on;
        result.report.vertices = std::min(n, places);
        result.mesh.positions.resize(2 * result.report.vertices);
        result.mesh.faces.resize(1);
        if (n > places) result.status = {Errc::target_out_of_range, "no places"};
        if (static_cast<int>(asked.size()) == cancel_at) result.status = {Errc::cancelled, "cancelled"};
        asked.push_back(n);
        works.push_back(from.work);
        return result;
    }
};

}  // namespace

TEST_CASE("a search that goes on reaches the PSNR within 1 to 2 % of the fewest vertices, mostly for less than 2.5 whole runs") {
    using hmesh::kit::Work;
    int searches = 0, dear = 0;
    for (const double draft : {0.3, 0.4, 0.5, 0.6, 0.75})  // as of photographs, where 0.5 is expected
        for (const double slope : {1.2, 1.6, 3.0})
            for (const double bend : {-0.1, 0.0, 0.15})
                for (const double sketch : {0.0, 0.8})
                    for (const double psnr : {27.0, 30.0, 33.5}) {
                        CAPTURE(draft);
                        CAPTURE(slope);
                        CAPTURE(bend);
                        CAPTURE(sketch);
                        CAPTURE(psnr);
                        Goer goer;
                        goer.draft = draft;
                        goer.slope = slope;
                        goer.bend = bend;
                        const Result result = fewest_vertices_going_on(psnr, {0.5, sketch}, 250, 100000, 100000, goer);
                        CHECK(result.status);
                        CHECK(result.report.psnr >= psnr);
                        CHECK(goer.psnr_of(static_cast<double>(result.report.vertices) / 1.025 - 1) < psnr);
                        const bool sketched = std::find(goer.works.begin(), goer.works.end(), Work::sketch) != goer.works.end();
                        CHECK(sketched == (sketch > 0));
                        const double cost = goer.cost / static_cast<double>(result.report.vertices);
                        CHECK(cost <= 3.2);
                        ++searches;
                        dear += cost > 2.5 ? 1 : 0;
                    }
    MESSAGE(dear, " of ", searches, " searches take more than 2.5 whole runs");
    CHECK(10 * dear <= searches);
}

TEST_CASE(
    "a search that goes on ends with the best mesh where the PSNR is out of reach, and with that so far where it is cancelled") {
    const hmesh::kit::Trials trials{0.5, 0.8};
    Goer poor;
    const Result result = fewest_vertices_going_on(60, trials, 250, 4000, 4000, poor);
    CHECK(result.status.code == Errc::target_out_of_range);
    CHECK(result.report.vertices == 4000);
    CHECK(std::string(result.status.what) == "no mesh of this image reached the PSNR asked for, in dB");
    for (int k = 0; k < 6; ++k) {
        Goer goer;
        goer.cancel_at = k;
        const Result cut = fewest_vertices_going_on(33.0, trials, 250, 100000, 100000, goer);
        if (goer.asked.size() > static_cast<std::size_t>(k) + 1) continue;  // only a sketch was cut: the next run says so itself
        CHECK((cut.status.code == Errc::cancelled || goer.asked.size() <= static_cast<std::size_t>(k)));
    }
    // A PSNR below 0, as of floats far off their peak, is better than no mesh.
    for (int k = 0; k < 4; ++k) {
        Goer goer;
        goer.at_1000 = -200;
        goer.cancel_at = k;
        const Result cut = fewest_vertices_going_on(33.0, trials, 250, 100000, 100000, goer);
        CHECK(cut.status.code == Errc::cancelled);
        CHECK(cut.has_mesh());
    }
    Goer flat;
    flat.slope = 0;
    flat.at_1000 = std::numeric_limits<double>::infinity();
    const Result constant = fewest_vertices_going_on(40, trials, 250, 100000, 100000, flat);
    CHECK(constant.status);
    CHECK(constant.report.vertices == 4);
}

TEST_CASE(
    "a limit of the vertices that a search takes without one is met, whether going on wins or not, and so is a larger one") {
    for (const double won : {0.0, 0.1, 0.3})  // a run, up to three of them: in all 0.9 dB, where twice the vertices win 1.6
        for (const double draft : {0.5, 1.0})
            for (const double psnr : {26.0, 30.0, 33.5}) {
                CAPTURE(won);
                CAPTURE(draft);
                CAPTURE(psnr);
                const auto search = [d = draft](double wanted, double wins, std::size_t most) {
                    Goer goer;
                    goer.won = wins;
                    goer.draft = d;
                    return fewest_vertices_going_on(wanted, {d, 0}, std::min<std::size_t>(250, most), most, 100000, goer);
                };
                const Result free = search(psnr, won, 100000);
                REQUIRE(free.status);
                for (const double more : {1.0, 1.03, 1.2}) {
                    const auto most = static_cast<std::size_t>(more * static_cast<double>(free.report.vertices));
                    const Result bound = search(psnr, won, most);
                    CHECK(bound.status);
                    CHECK(bound.report.vertices <= most);
                }
                // Half of them do not do, and the best mesh of so many is told.
                const std::size_t half = free.report.vertices / 2;
                const Result missed = search(psnr + 4, 0, half);
                CHECK(missed.status.code == Errc::target_out_of_range);
                CHECK(missed.report.vertices == half);
                CHECK(std::string(missed.status.what) == "no mesh of so few vertices reached the PSNR asked for, in dB");
            }
}

TEST_CASE("where going on from mesh to mesh is stuck below the PSNR, whole runs reach it") {
    Goer stuck;
    stuck.won = -3;
    const Result result = fewest_vertices_going_on(33.0, {0.3, 0}, 250, 6000, 6000, stuck);
    CHECK(result.status);
    CHECK(result.report.psnr >= 33);
}

TEST_CASE("where a run finds no places for more vertices than are allowed, the mesh of the search has no more than these") {
    for (const double draft : {0.5, 1.0})
        for (const double psnr : {31.0, 33.0, 60.0}) {
            Goer goer;
            goer.places = 1300;
            const Result result = fewest_vertices_going_on(psnr, {draft, 0.8}, 250, 1000, 4000, goer);
            CHECK(result.status.code == Errc::target_out_of_range);
            CHECK(result.has_mesh());
            CHECK(result.report.vertices == 1000);
        }
}
