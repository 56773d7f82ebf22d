#include "hmesh/methods/psnr_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/result.hpp"

namespace {

using hmesh::Errc;
using hmesh::Result;
using hmesh::kit::fewest_vertices;

// Makes results after a curve n -> dB and remembers for which n.
template <class Curve>
class FakeMesher {
  public:
    explicit FakeMesher(Curve curve) : curve_(std::move(curve)) {}
    Result operator()(std::size_t n) {
        asked_.push_back(n);
        Result result;
        result.report.psnr = curve_(n);
        result.report.vertices = n;
        return result;
    }
    [[nodiscard]] const std::vector<std::size_t>& asked() const { return asked_; }
    [[nodiscard]] std::size_t least_asked() const {
        std::size_t least = asked_.front();
        for (const std::size_t n : asked_) least = n < least ? n : least;
        return least;
    }

  private:
    Curve curve_;
    std::vector<std::size_t> asked_;
};
template <class Curve>
FakeMesher(Curve) -> FakeMesher<Curve>;

// The fewest vertices with curve(n) >= psnr, for a rising curve; most + 1 when there are none.
template <class Curve>
std::size_t fewest(const Curve& curve, double psnr, std::size_t most) {
    std::size_t low = 4, high = most + 1;
    while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        if (curve(middle) >= psnr) high = middle;
        else low = middle + 1;
    }
    return low;
}

// The answer reaches the target with at most 0.5 % (or one vertex) more than the fewest, every question was allowed and
// asked once, and there were few.
template <class Curve>
void check_search(const Curve& curve, double psnr, std::size_t first, std::size_t most, std::size_t runs) {
    CAPTURE(psnr);
    CAPTURE(first);
    CAPTURE(most);
    FakeMesher mesher(curve);
    const Result result = fewest_vertices(psnr, first, most, mesher);
    const std::size_t best = fewest(curve, psnr, most);
    CHECK(mesher.asked().size() <= runs);
    for (std::size_t k = 0; k < mesher.asked().size(); ++k) {
        CHECK(mesher.asked()[k] >= 4);
        CHECK(mesher.asked()[k] <= most);
        for (std::size_t i = 0; i < k; ++i) CHECK(mesher.asked()[i] != mesher.asked()[k]);
    }
    if (best > most) {
        CHECK(result.status.code == Errc::target_out_of_range);
        CHECK(std::string(result.status.what).size() > 15);
        CHECK(result.report.psnr == curve(most));  // of a rising curve the best
    } else {
        CHECK(result.status.code == Errc::ok);
        CHECK(result.report.psnr >= psnr);
        CHECK(result.report.vertices >= best);
        CHECK(static_cast<double>(result.report.vertices - best) <=
              std::max(1.0, 0.005 * static_cast<double>(result.report.vertices)));
    }
}

}  // namespace

TEST_CASE("the fewest vertices are found on curves of any slope, from any start, in few runs") {
    for (const double slope : {0.2, 0.8, 1.6, 3.0, 9.0})
        for (const std::size_t first : {4U, 100U, 2500U, 250000U})
            for (const double psnr : {12.0, 24.0, 30.5, 37.0, 55.0})
                check_search([slope](std::size_t n) { return 14 + slope * std::log2(static_cast<double>(n)); }, psnr, first,
                             262144, 20);
}

TEST_CASE("curves that bend, jump or are flat for long are searched to the end") {
    const auto log2 = [](std::size_t n) { return std::log2(static_cast<double>(n)); };
    for (const std::size_t first : {4U, 60U, 4000U})
        for (const double psnr : {20.5, 25.0, 29.99, 30.0, 41.0}) {
            check_search([&](std::size_t n) { return 10 + 0.12 * log2(n) * log2(n); }, psnr, first, 100000, 40);
            check_search([&](std::size_t n) { return n < 700 ? 20.0 : 30.0; }, psnr, first, 100000, 40);
            check_search([&](std::size_t n) { return n < 99999 ? 20.0 : 30.0; }, psnr, first, 100000, 40);
            if (psnr < 29) check_search([&](std::size_t n) { return n < 5 ? 20.0 : 30.0; }, psnr, first, 100000, 40);
            check_search([&](std::size_t n) { return 20 + std::floor(log2(n)); }, psnr, first, 100000, 40);
        }
}

TEST_CASE("a curve that is flat for long, as that of noise, is searched to the end all the same") {
    for (const std::size_t first : {4U, 60U, 4000U}) {
        check_search([](std::size_t) { return 25.0; }, 25, first, 100000, 40);
        check_search([](std::size_t) { return 25.0; }, 24.99, first, 100000, 40);
        check_search([](std::size_t) { return 25.0; }, 25.01, first, 100000, 40);
        check_search([](std::size_t n) { return 25 + 0.01 * std::log2(static_cast<double>(n)); }, 25.11, first, 100000, 40);
        check_search([](std::size_t n) { return n < 5 ? 20.0 : 30.0; }, 30, first, 100000, 40);
    }
}

TEST_CASE("a target that many numbers of vertices reach exactly takes hardly more runs than one that they exceed") {
    for (const std::size_t jump : {70U, 700U, 7000U})
        for (const std::size_t first : {4U, 60U, 4000U, 90000U}) {
            const auto runs = [&](double psnr) {
                FakeMesher mesher([&](std::size_t n) { return n < jump ? 20.0 : 30.0; });
                (void)fewest_vertices(psnr, first, 100000, mesher);
                return mesher.asked().size();
            };
            CAPTURE(jump);
            CAPTURE(first);
            CHECK(runs(30) <= runs(30 - 1e-9) + 2);
        }
}

TEST_CASE("a target that four vertices reach ends with four") {
    for (const std::size_t first : {4U, 5U, 70U, 5000U}) {
        check_search([](std::size_t n) { return 40 + std::log2(static_cast<double>(n)); }, 30, first, 10000, 20);
        check_search([](std::size_t) { return std::numeric_limits<double>::infinity(); }, 30, first, 10000, 20);
    }
}

TEST_CASE("a target that nothing reaches ends with the best mesh there was and says so with both numbers") {
    const auto curve = [](std::size_t n) { return 20 + std::log2(static_cast<double>(n)); };
    FakeMesher mesher(curve);
    const Result result = fewest_vertices(99.125, 10, 1024, mesher);
    CHECK(result.status.code == Errc::target_out_of_range);
    CHECK(result.report.vertices == 1024);
    CHECK(result.status.value == 30);
    CHECK(result.status.limit == 99.125);
    CHECK(std::string(result.status.what) == "no mesh of this image reached the PSNR asked for, in dB");
    const auto mesh_from = [&](std::size_t n, const hmesh::kit::Beginning&) { return mesher(n); };
    const Result bounded = hmesh::kit::fewest_vertices_anew(99.125, {}, 10, 1024, 1025, mesh_from);
    CHECK(bounded.status.value == 30);
    CHECK(std::string(bounded.status.what) == "no mesh of so few vertices reached the PSNR asked for, in dB");

    // The best one need not be the last.
    FakeMesher bent([](std::size_t n) { return n <= 100 ? 20 + 0.01 * static_cast<double>(n) : 20.5; });
    const Result best = fewest_vertices(99, 100, 1024, bent);
    CHECK(best.status.code == Errc::target_out_of_range);
    CHECK(best.report.vertices == 100);
}

TEST_CASE("an image that holds four vertices only is asked once") {
    FakeMesher mesher([](std::size_t) { return 30.0; });
    CHECK(fewest_vertices(25, 4, 4, mesher).status);
    CHECK(fewest_vertices(35, 4, 4, mesher).status.code == Errc::target_out_of_range);
    CHECK(mesher.asked().size() == 2);
}

TEST_CASE("energy 0 does not mislead the search: an infinite PSNR counts as reached, whatever is next") {
    // Exact from 300 vertices on, as on a picture of a few flat shapes.
    const auto curve = [](std::size_t n) {
        return n >= 300 ? std::numeric_limits<double>::infinity() : 15 + std::log2(static_cast<double>(n));
    };
    for (const std::size_t first : {4U, 299U, 300U, 301U, 5000U}) {
        check_search(curve, 20.3, first, 5000, 40);
        check_search(curve, 60, first, 5000, 40);
        check_search(curve, 23.228, first, 5000, 40);
    }
}

TEST_CASE("noise does not keep the search from ending with a mesh that reaches the target, near the fewest") {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const double noise = seed % 2 == 0 ? 0.05 : 0.4;  // dB, to both sides
        const auto clean = [](std::size_t n) { return 18 + 1.4 * std::log2(static_cast<double>(n)); };
        FakeMesher mesher([&](std::size_t n) { return clean(n) + noise * (2 * hmesh::kit::Random(seed, n).uniform() - 1); });
        const double psnr = 24 + 0.05 * static_cast<double>(seed);
        const Result result = fewest_vertices(psnr, 400, 200000, mesher);
        CHECK(mesher.asked().size() <= 40);
        CHECK(result.status);
        CHECK(result.report.psnr >= psnr);
        // Some run failed with 0.5 % fewer vertices or one.
        const auto fewer = static_cast<std::size_t>(std::floor(0.995 * static_cast<double>(result.report.vertices))) - 1;
        CHECK(clean(fewer) < psnr + noise);
        for (const std::size_t n : mesher.asked())  // nothing better was thrown away
            if (n < result.report.vertices) CHECK(clean(n) + noise * (2 * hmesh::kit::Random(seed, n).uniform() - 1) < psnr);
    }
}

TEST_CASE("a curve that falls in places still ends, with a mesh that is told truly") {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        FakeMesher mesher([&](std::size_t n) { return 20 + 20 * hmesh::kit::Random(seed, n).uniform(); });
        const Result result = fewest_vertices(38.5, 50, 3000, mesher);
        CHECK(mesher.asked().size() <= 40);
        CHECK((result.status.code == Errc::ok) == (result.report.psnr >= 38.5));
    }
}

TEST_CASE("a run that fails at once is handed on; one that is cancelled leaves what was reached before") {
    const auto fails_from = [](std::size_t runs, double level) {
        return [runs, level, k = std::size_t{0}](std::size_t n) mutable {
            Result result;
            result.report.vertices = n;
            result.report.psnr = level + std::log2(static_cast<double>(n));
            if (++k >= runs) result.status = hmesh::kit::cancelled_by_callback();
            return result;
        };
    };
    const Result at_once = fewest_vertices(30, 64, 100000, fails_from(1, 20));
    CHECK(at_once.status.code == Errc::cancelled);
    CHECK(at_once.report.vertices == 64);
    const Result reached = fewest_vertices(30, 2048, 100000, fails_from(2, 20));  // the first run reached it
    CHECK(reached.status.code == Errc::cancelled);
    CHECK(reached.report.vertices == 2048);
    CHECK(reached.report.psnr >= 30);
    const Result not_reached = fewest_vertices(30, 64, 100000, fails_from(2, 20));
    CHECK(not_reached.status.code == Errc::cancelled);
    CHECK(not_reached.report.vertices > 64);
    // The run that was cancelled had just begun.
    const Result begun = fewest_vertices(30, 64, 100000, [k = 0](std::size_t n) mutable {
        Result result;
        result.report.vertices = n;
        result.report.psnr = k == 0 ? 26 : 10;
        if (k++ != 0) result.status = hmesh::kit::cancelled_by_callback();
        return result;
    });
    CHECK(begun.status.code == Errc::cancelled);
    CHECK(begun.report.vertices == 64);
    CHECK(begun.report.psnr == 26);
}
