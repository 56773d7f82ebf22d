#include "hmesh/io/compact/arithmetic_coder.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/io/compact/mixer.hpp"

using hmesh::detail::ArithmeticCoder;

TEST_CASE("bits of any probability come back, and cost what they should") {
    hmesh::kit::Random random(3);
    for (const std::uint32_t p : {1U, 300U, 32768U, 65000U, 65535U}) {
        std::vector<bool> bits;
        for (int k = 0; k < 4000; ++k) bits.push_back(random.below(65536) < p);
        std::vector<std::uint8_t> bytes;
        ArithmeticCoder writer(bytes);
        for (const bool bit : bits) writer.bit(bit, p);
        writer.finish();
        if (p == 32768) CHECK(bytes.size() <= 4000 / 8 + 4);
        if (p == 300) CHECK(bytes.size() < 4000 / 8 / 15);
        ArithmeticCoder reader(bytes.data(), bytes.size());
        bool is_same = true;
        for (const bool bit : bits) is_same = reader.bit(false, p) == bit && is_same;
        CHECK(is_same);
        CHECK(reader.is_at_end());
        CHECK(!reader.is_exhausted());
        bytes.push_back(0);
        ArithmeticCoder longer(bytes.data(), bytes.size());
        for (std::size_t k = 0; k < bits.size(); ++k) longer.bit(false, p);
        CHECK(!longer.is_at_end());
    }
}

TEST_CASE("numbers of many bits mix with others, and reading on is told of") {
    std::vector<std::uint8_t> bytes;
    ArithmeticCoder writer(bytes);
    for (std::uint32_t k = 0; k < 40; ++k) {
        writer.bits(0xdeadbeefU >> (k % 32), static_cast<int>(32 - k % 32));
        writer.bit(k % 3 == 0, 20000);
    }
    writer.finish();
    ArithmeticCoder reader(bytes.data(), bytes.size());
    for (std::uint32_t k = 0; k < 40; ++k) {
        CHECK(reader.bits(0, static_cast<int>(32 - k % 32)) == 0xdeadbeefU >> (k % 32));
        CHECK(reader.bit(false, 20000) == (k % 3 == 0));
    }
    CHECK(reader.is_at_end());
    reader.bits(0, 32);
    reader.bits(0, 32);
    CHECK(reader.is_exhausted());
}

TEST_CASE("the logistic function is odd around a half, rises, and its inverse undoes it") {
    using hmesh::detail::Logistic;
    const Logistic logistic;
    std::uint32_t before = 0;
    for (int s = -3000; s <= 3000; ++s) {
        const std::uint32_t p = Logistic::probability(s);
        CHECK(p >= before);
        if (s > -Logistic::limit && s < Logistic::limit) CHECK(p + Logistic::probability(-s) == 65536);
        before = p;
    }
    for (std::uint32_t k = 1; k < 4096; k += 13) {
        const auto p = static_cast<double>(Logistic::probability(logistic.logarithm(k)));
        CHECK(p == doctest::Approx(16.0 * k + 8).epsilon(0.02));
    }
}

TEST_CASE("what is mixed learns which context knows") {
    const hmesh::detail::Logistic logistic;
    hmesh::detail::Mixer<2> mixer(logistic, 1, 32768);
    std::vector<hmesh::detail::AdaptiveBit> knows(2), guesses(2);
    hmesh::kit::Random random(4);
    std::vector<std::uint8_t> bytes;
    ArithmeticCoder writer(bytes);
    for (int k = 0; k < 4000; ++k) {
        const bool bit = random.below(2) == 1;
        mixer.code(writer, bit, {&knows[bit ? 1 : 0], &guesses[random.below(2)]}, 0);
    }
    CHECK(bytes.size() < 40);
}
