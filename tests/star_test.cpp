// hmesh tests - what the samples around a vertex are off, by going through all samples of the image.
#include "hmesh/methods/bounded/star.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"

namespace {

using hmesh::kit::Corner;
using hmesh::kit::face_fit;
using hmesh::kit::Fit;
using hmesh::kit::HeightField;
using hmesh::kit::max_bounded_channels;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Star;

double between(Random& random, double low, double high) {
    return low + (high - low) * static_cast<double>(random.below(1 << 20)) / (1 << 20);
}

HeightField noise(int channels, hmesh::Samples samples, Random& random) {
    HeightField field;
    field.width = 40 + static_cast<int>(random.below(9)), field.height = 31;
    field.channels = channels;
    field.samples = samples;
    const auto plane = static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height);
    field.values.resize(plane * static_cast<std::size_t>(channels) + 16);
    for (float& value : field.values) value = static_cast<float>(between(random, 100, 108));
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) field.lowest[c] = 100, field.highest[c] = 108;
    return field;
}

// A fan around an apex within the image, in places at which no sample lies on an edge.
struct Fan {
    Corner apex;
    std::vector<Corner> ring;  // positively oriented

    Fan(const HeightField& field, Random& random) {
        const auto lift = [&](Corner& corner) {
            for (int c = 0; c < field.channels; ++c) corner.heights[c] = static_cast<float>(between(random, 101, 107));
        };
        apex.position = {between(random, 14, 25), between(random, 11, 19)};
        lift(apex);
        const int faces = 3 + static_cast<int>(random.below(5));
        for (int k = 0; k < faces; ++k) {
            const double angle = (k + between(random, -0.2, 0.2)) * 2 * 3.14159265358979 / faces, radius = between(random, 3, 10);
            Corner corner;
            corner.position = {apex.position.x + radius * std::cos(angle), apex.position.y + radius * std::sin(angle)};
            lift(corner);
            ring.push_back(corner);
        }
    }
    [[nodiscard]] std::array<Corner, 3> face(std::size_t k) const { return {apex, ring[k], ring[(k + 1) % ring.size()]}; }
    [[nodiscard]] bool add_to(Star& star, Point place) const {
        star.begin(apex, place);
        bool is_shaped = true;
        for (std::size_t k = 0; k < ring.size(); ++k) is_shaped = is_shaped && star.add(face(k)[1], face(k)[2]);
        return is_shaped;
    }
    // The heights, and the place, of the apex as a star has them.
    [[nodiscard]] Fan with(const double* heights, double per_unit, Point place, int channels) const {
        Fan fan = *this;
        fan.apex.position = place;
        for (int c = 0; c < channels; ++c)
            fan.apex.heights[c] = static_cast<float>(static_cast<double>(apex.heights[c]) + heights[c] / per_unit);
        return fan;
    }
};

// The same of one face, of all samples that it holds.
void measure(const HeightField& field, const std::array<Corner, 3>& face, double per_unit, Fit& fit) {
    const Point a = face[0].position, b = face[1].position, c = face[2].position;
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    const auto least = [](double u, double v, double w) { return static_cast<int>(std::floor(std::min({u, v, w}))) - 1; };
    const auto most = [](double u, double v, double w) { return static_cast<int>(std::ceil(std::max({u, v, w}))) + 1; };
    for (int channel = 0; channel < field.channels; ++channel)
        for (int j = std::max(0, least(a.y, b.y, c.y)); j < std::min(field.height, most(a.y, b.y, c.y)); ++j)
            for (int i = std::max(0, least(a.x, b.x, c.x)); i < std::min(field.width, most(a.x, b.x, c.x)); ++i) {
                const double x = i + field.offset(), y = j + field.offset();
                const double at_b = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
                const double at_c = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
                if (at_b < 0 || at_c < 0 || at_b + at_c > 1) continue;
                const double height = (1 - at_b - at_c) * static_cast<double>(face[0].heights[channel]) +
                                      at_b * static_cast<double>(face[1].heights[channel]) +
                                      at_c * static_cast<double>(face[2].heights[channel]);
                const double off = std::abs(height - static_cast<double>(field.row(channel, j)[i])) * per_unit;
                fit.most = std::max(fit.most, off);
                fit.energy += std::pow(std::min(off, 100.0), 16);
            }
}
Fit measured(const HeightField& field, const Fan& fan, double per_unit) {
    Fit fit;
    for (std::size_t k = 0; k < fan.ring.size(); ++k) measure(field, fan.face(k), per_unit, fit);
    return fit;
}

// Calls body(field, fan, random) for 300 of them: 1 to 4 channels, squares and points.
template <class Body>
void for_each_fan(Body&& body) {
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        Random random(seed);
        const HeightField field =
            noise(1 + static_cast<int>(seed % 4), seed % 3 == 0 ? hmesh::Samples::points : hmesh::Samples::squares, random);
        const Fan fan(field, random);
        body(field, fan, random);
    }
}

}  // namespace

TEST_CASE("a face is off by what its samples say, one by one") {
    for_each_fan([](const HeightField& field, const Fan& fan, Random& random) {
        const double per_unit = between(random, 0.05, 0.3);
        for (std::size_t k = 0; k < fan.ring.size(); ++k) {
            const auto face = fan.face(k);
            Fit wanted;
            measure(field, face, per_unit, wanted);
            const Fit fit = face_fit(field, face[0], face[1], face[2], static_cast<float>(per_unit));
            CHECK(fit.most == doctest::Approx(wanted.most).epsilon(2e-5));
            CHECK(fit.energy == doctest::Approx(wanted.energy).epsilon(5e-4));
        }
    });
}

TEST_CASE("a star is off by what the samples of its faces say, wherever its apex stands and however high") {
    int stars = 0;
    for_each_fan([&](const HeightField& field, const Fan& fan, Random& random) {
        const double per_unit = between(random, 0.05, 0.3);
        Star star(field, per_unit, 1000);
        const Point at = fan.apex.position, place{at.x + between(random, -1, 1), at.y + between(random, -1, 1)};
        if (!fan.add_to(star, place)) return;  // the apex has left its ring
        ++stars;
        double heights[max_bounded_channels] = {};
        for (int c = 0; c < field.channels; ++c) heights[c] = between(random, -1, 1);
        const Fit fit = star.fit(heights);
        const Fit wanted = measured(field, fan.with(heights, per_unit, place, field.channels), per_unit);
        CHECK(fit.most == doctest::Approx(wanted.most).epsilon(5e-5));
        CHECK(fit.energy == doctest::Approx(wanted.energy).epsilon(1e-3));

        const Corner apex = star.apex(heights);
        CHECK(apex.position.x == place.x);
        for (int c = 0; c < field.channels; ++c)
            CHECK(static_cast<double>(apex.heights[c]) ==
                  doctest::Approx(static_cast<double>(fan.apex.heights[c]) + heights[c] / per_unit).epsilon(1e-6));
    });
    CHECK(stars > 250);
}

TEST_CASE("a lifted apex has the least largest difference that its heights can give") {
    for_each_fan([](const HeightField& field, const Fan& fan, Random& random) {
        const double per_unit = between(random, 0.05, 0.3);
        Star star(field, per_unit, 1000);
        REQUIRE(fan.add_to(star, fan.apex.position));
        double lifted[max_bounded_channels] = {};
        const Fit fit = star.lift(lifted, 40);
        // Of each channel by itself the largest difference is convex in the height.
        double least = 0;
        for (int c = 0; c < field.channels; ++c) {
            HeightField one = field;
            one.channels = 1;
            std::copy(field.row(c, 0), field.row(c, 0) + static_cast<std::ptrdiff_t>(field.width) * field.height,
                      one.values.begin());
            Fan alone = fan;
            alone.apex.heights[0] = fan.apex.heights[c];
            for (std::size_t k = 0; k < fan.ring.size(); ++k) alone.ring[k].heights[0] = fan.ring[k].heights[c];
            double low = -10, high = 10;
            const auto most_at = [&](double z) {
                return measured(one, alone.with(&z, per_unit, fan.apex.position, 1), per_unit).most;
            };
            for (int step = 0; step < 30; ++step) {
                const double left = low + (high - low) / 3, right = high - (high - low) / 3;
                if (most_at(left) < most_at(right)) high = right;
                else low = left;
            }
            least = std::max(least, most_at(low));
        }
        CHECK(fit.most <= least * (1 + 1e-3) + 1e-3);
    });
}

TEST_CASE("the direction of a star goes down, and where the apex may not slide it is that of its heights") {
    int directions = 0;
    for_each_fan([&](const HeightField& field, const Fan& fan, Random& random) {
        const double per_unit = between(random, 0.05, 0.3);
        const Point place = fan.apex.position;
        Star star(field, per_unit, 1000);
        REQUIRE(fan.add_to(star, place));
        double heights[max_bounded_channels] = {};
        for (int c = 0; c < field.channels; ++c) heights[c] = between(random, -1, 1);
        const bool slides = random.below(2) == 0;
        double step[2 + max_bounded_channels] = {};
        if (!star.direction(heights, star.fit(heights), slides, slides, step)) return;
        ++directions;
        if (!slides) CHECK((step[0] == 0 && step[1] == 0));
        // A part of the way, by going through all samples: so small a one that few of them change faces.
        const auto energy_at = [&](double share) {
            double there[max_bounded_channels] = {};
            for (int c = 0; c < field.channels; ++c) there[c] = heights[c] + share * step[2 + c];
            const Point moved{place.x + share * step[0], place.y + share * step[1]};
            return measured(field, fan.with(there, per_unit, moved, field.channels), per_unit).energy;
        };
        CHECK(energy_at(0.01) < energy_at(0));
    });
    CHECK(directions > 290);
}

TEST_CASE("slivers and faces that are turned over are no part of a star") {
    Random random(1);
    const HeightField field = noise(1, hmesh::Samples::points, random);
    Star star(field, 1, 10);
    Corner apex, a, b;
    apex.position = {5, 5}, a.position = {15, 5}, b.position = {15, 5.01};
    star.begin(apex, apex.position);
    CHECK_FALSE(star.add(a, b));
    b.position = {15, 15};
    CHECK_FALSE(star.add(b, a));
    CHECK(star.add(a, b));
    const double height = 0;
    CHECK(star.fit(&height).most > 0);
    star.begin(apex, apex.position);
    CHECK(star.fit(&height).most == 0);  // nothing of the last one is left
}

TEST_CASE("heights stay within the limit of the samples' range") {
    Random random(2);
    const HeightField field = noise(2, hmesh::Samples::squares, random);
    const Fan fan(field, random);
    Star star(field, 2, 3);
    REQUIRE(fan.add_to(star, fan.apex.position));
    const double heights[] = {1e9, -1e9};
    CHECK(star.apex(heights).heights[0] == 111);
    CHECK(star.apex(heights).heights[1] == 97);
}
