#include "hmesh/core/status.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "comma_locale.hpp"
#include "hmesh/core/random.hpp"

using hmesh::Errc;
using hmesh::Message;
using hmesh::Status;

namespace {

std::string text_of(double number) { return (Message() << number).c_str(); }
std::string text_of(const Status& status) { return message(status).c_str(); }

// Digits before the exponent, without zeros at either end.
std::size_t significant_digits(const std::string& text) {
    std::string digits;
    for (const char c : text.substr(0, text.find('e')))
        if (c >= '0' && c <= '9') digits += c;
    const std::size_t first = digits.find_first_not_of('0'), last = digits.find_last_not_of('0');
    return first == std::string::npos ? 0 : last - first + 1;
}

}  // namespace

TEST_CASE("a Status is a sentence with its value and its limit, as far as it has them") {
    CHECK(text_of(Status()) == "ok");
    CHECK(text_of(Status{Errc::image_too_large, "the image is too wide", 70000, 65536}) ==
          "the image is too wide (70000, limit 65536)");
    CHECK(text_of(Status{Errc::invalid_argument, "the image's data pointer is null"}) == "the image's data pointer is null");
    CHECK(text_of(Status{Errc::not_finite, "the mesh has a position that is NaN or infinite, at vertex", 3}) ==
          "the mesh has a position that is NaN or infinite, at vertex (3)");
    CHECK(text_of(Status{Errc::invalid_argument, "the mesh has no faces", 0, 1}) == "the mesh has no faces (0, limit 1)");
    CHECK(text_of(Status{Errc::target_out_of_range, "the target must be below", -0.125, 100}) ==
          "the target must be below (-0.125, limit 100)");
}

TEST_CASE("numbers that are not finite are there, and are said to be so") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
        CHECK(text_of(Status{Errc::invalid_argument, "a", bad}) == "a (a number that is not finite)");
        CHECK(text_of(Status{Errc::invalid_argument, "a", 2, bad}) == "a (2, limit a number that is not finite)");
    }
}

TEST_CASE("whole numbers below 1e15 have all their digits") {
    CHECK(text_of(0.0) == "0");
    CHECK(text_of(-0.0) == "0");
    CHECK(text_of(7) == "7");
    CHECK(text_of(-65537) == "-65537");
    CHECK(text_of(268435456) == "268435456");
    CHECK(text_of(999999999999999.0) == "999999999999999");
    CHECK(text_of(1e15) == "1e15");
    hmesh::kit::Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t number =
            (std::uint64_t{random.next()} << 32U | random.next()) % 1000000000000000U >> random.below(50);
        REQUIRE(text_of(static_cast<double>(number)) == std::to_string(number));
        if (number > 0) REQUIRE(text_of(-static_cast<double>(number)) == "-" + std::to_string(number));
    }
}

TEST_CASE("other numbers have six significant digits, without zeros at the end") {
    CHECK(text_of(0.5) == "0.5");
    CHECK(text_of(-1.25) == "-1.25");
    CHECK(text_of(3.14159265) == "3.14159");
    CHECK(text_of(1.0 / 3) == "0.333333");
    CHECK(text_of(123456.5) == "123457");
    CHECK(text_of(100000.25) == "100000");
    CHECK(text_of(1234567.5) == "1.23457e6");
    CHECK(text_of(0.9999999) == "1");
    CHECK(text_of(99.99999) == "100");
    CHECK(text_of(1e-3) == "0.001");
    CHECK(text_of(1.5e-5) == "0.000015");
    CHECK(text_of(1e-6) == "1e-6");
    CHECK(text_of(1e-9) == "1e-9");
    CHECK(text_of(2.5e-7) == "2.5e-7");
    CHECK(text_of(1.0 / 256) == "0.00390625");
    CHECK(text_of(1e300) == "1e300");
    CHECK(text_of(-6.02214076e23) == "-6.02214e23");
}

TEST_CASE("every number reads back to six digits, from the smallest to the largest double") {
    hmesh::kit::Random random(2);
    double worst = 0;
    for (int i = 0; i < 50000; ++i) {
        const std::uint64_t bits = std::uint64_t{random.next()} << 32U | random.next();
        double number = 0;
        std::memcpy(&number, &bits, sizeof number);
        if (i % 2 == 0) number = (random.uniform() - 0.5) * std::pow(10.0, static_cast<double>(random.below(40)) - 20);
        if (!std::isfinite(number) || number == 0) continue;
        const std::string text = text_of(number);
        // Subnormal numbers have fewer digits than six.
        const double step = std::numeric_limits<double>::denorm_min(), size = std::abs(number);
        worst = std::max(worst, (std::abs(std::strtod(text.c_str(), nullptr) - number) - step) / size);
        if (!(size < 1e15 && size == std::floor(size))) REQUIRE(significant_digits(text) <= 6);
    }
    CHECK(worst <= 5.0001e-6);
    using Limits = std::numeric_limits<double>;
    CHECK(text_of(Limits::max()) == "1.79769e308");
    CHECK(text_of(Limits::min()) == "2.22507e-308");
    CHECK(text_of(1e-305) == "1e-305");
    CHECK(std::strtod(text_of(Limits::denorm_min()).c_str(), nullptr) == Limits::denorm_min());
}

TEST_CASE("numbers are the same in a locale with commas") {
    const hmesh_test::CommaLocale locale;
    CHECK(text_of(1234567) == "1234567");
    CHECK(text_of(0.5) == "0.5");
}

TEST_CASE("what is longer than 255 bytes is cut, and still ends with a zero") {
    const std::string sentence(300, 'x');
    const Message cut = message(Status{Errc::invalid_argument, sentence.c_str(), 5, 6});
    CHECK(cut.size() == 255);
    CHECK(cut.c_str() == sentence.substr(0, 255));
    for (std::size_t length = 230; length < 260; ++length) {  // where numbers and commas are cut
        const std::string start(length, 'y'), whole = start + " (-0.125, limit 1234567)";
        const Message text = message(Status{Errc::invalid_argument, start.c_str(), -0.125, 1234567});
        REQUIRE(text.size() == std::min<std::size_t>(255, whole.size()));
        REQUIRE(std::strlen(text.c_str()) == text.size());
        REQUIRE(whole.compare(0, text.size(), text.c_str()) == 0);
    }
    CHECK(Message().size() == 0);
    CHECK(std::string(Message().c_str()).empty());
}
