#include "hmesh/core/lanes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>

#include "hmesh/core/random.hpp"

using hmesh::kit::Lanes;

namespace {

template <int N>
struct Size {
    static constexpr int lanes = N;
};

template <int N>
struct Values {
    double value[N];
};

// Small integers, so that sums and products are exact in any order.
template <int N>
Values<N> random_values(hmesh::kit::Random& random) {
    Values<N> values;
    for (double& value : values.value) value = static_cast<double>(random.below(2001)) - 1000;
    return values;
}

template <int N, class Expected>
bool equal(const Lanes<N>& lanes, Expected&& expected) {
    for (int i = 0; i < N; ++i)
        if (lanes[i] != expected(i)) return false;
    return true;
}

}  // namespace

TEST_CASE("lanes_for gives 1, 2 or the next multiple of 4") {
    static_assert(hmesh::kit::lanes_for(1) == 1 && hmesh::kit::lanes_for(2) == 2);
    static_assert(hmesh::kit::lanes_for(3) == 4 && hmesh::kit::lanes_for(4) == 4 && hmesh::kit::lanes_for(5) == 8);
    static_assert(hmesh::kit::lanes_for(8) == 8 && hmesh::kit::lanes_for(9) == 12 && hmesh::kit::lanes_for(17) == 20);
    for (int n = 1; n <= 64; ++n) {
        CHECK(hmesh::kit::lanes_for(n) >= n);
        CHECK(hmesh::kit::lanes_for(n) < n + 4);
    }
}

TEST_CASE_TEMPLATE("Lanes: every operation does to each lane what it does to a double", S, Size<1>, Size<2>, Size<4>, Size<8>,
                   Size<12>, Size<16>, Size<20>) {
    constexpr int n = S::lanes;
    static_assert(sizeof(Lanes<n>) == n * sizeof(double));
    hmesh::kit::Random random(n);
    for (int round = 0; round < 100; ++round) {
        const Values<n> x = random_values<n>(random), y = random_values<n>(random);
        const double s = static_cast<double>(random.below(100)) - 50;
        const Lanes<n> a = Lanes<n>::load(x.value), b = Lanes<n>::load(y.value);
        CHECK(equal(a, [&](int i) { return x.value[i]; }));
        CHECK(equal(Lanes<n>::zero(), [&](int) { return 0.0; }));
        CHECK(equal(Lanes<n>::all(s), [&](int) { return s; }));
        CHECK(equal(a + b, [&](int i) { return x.value[i] + y.value[i]; }));
        CHECK(equal(a - b, [&](int i) { return x.value[i] - y.value[i]; }));
        CHECK(equal(a * b, [&](int i) { return x.value[i] * y.value[i]; }));
        CHECK(equal(a * s, [&](int i) { return x.value[i] * s; }));
        CHECK(equal(s * a, [&](int i) { return x.value[i] * s; }));
        CHECK(equal(-a, [&](int i) { return -x.value[i]; }));

        Lanes<n> c = a;
        c += b;
        CHECK(equal(c, [&](int i) { return x.value[i] + y.value[i]; }));
        c -= b;
        c -= b;
        CHECK(equal(c, [&](int i) { return x.value[i] - y.value[i]; }));
        c *= s;
        CHECK(equal(c, [&](int i) { return (x.value[i] - y.value[i]) * s; }));

        double sum = 0, product = 0;
        for (int i = 0; i < n; ++i) {
            sum += x.value[i];
            product += x.value[i] * y.value[i];
        }
        CHECK(a.sum() == sum);
        CHECK(dot(a, b) == product);
    }
}

TEST_CASE_TEMPLATE("Lanes: set changes one lane, store writes what load reads, 32-bit integers too", S, Size<1>, Size<2>, Size<4>,
                   Size<8>, Size<12>, Size<16>, Size<20>) {
    constexpr int n = S::lanes;
    hmesh::kit::Random random(n);
    // Offset by one number, so that nothing may rely on alignment.
    std::int32_t integers[n + 1] = {};
    for (std::int32_t& value : integers) value = static_cast<std::int32_t>(random.next());
    integers[1] = INT32_MAX;
    integers[n] = n == 1 ? INT32_MAX : INT32_MIN;
    const Lanes<n> a = Lanes<n>::load(integers + 1);
    CHECK(equal(a, [&](int i) { return static_cast<double>(integers[i + 1]); }));

    double stored[n + 2] = {};
    stored[0] = stored[n + 1] = 7;
    a.store(stored + 1);
    CHECK(stored[0] == 7);
    CHECK(stored[n + 1] == 7);
    CHECK(equal(Lanes<n>::load(stored + 1), [&](int i) { return a[i]; }));
    std::int32_t back[n + 2] = {};
    back[0] = back[n + 1] = 7;
    a.store(back + 1);
    CHECK(back[0] == 7);
    CHECK(back[n + 1] == 7);
    for (int i = 1; i <= n; ++i) CHECK(back[i] == integers[i]);

    for (int k = 0; k < n; ++k) {
        Lanes<n> b = a;
        b.set(k, 0.25);
        CHECK(equal(b, [&](int i) { return i == k ? 0.25 : a[i]; }));
    }
    const Lanes<n> others = Lanes<n>::all(0.25);
    CHECK(equal(a.template with<0>(others), [&](int i) { return i == 0 ? 0.25 : a[i]; }));
    CHECK(equal(a.template with<n / 2>(others), [&](int i) { return i == n / 2 ? 0.25 : a[i]; }));
    CHECK(equal(a.template with<n - 1>(others), [&](int i) { return i == n - 1 ? 0.25 : a[i]; }));
    for (int k = 0; k < n; ++k) CHECK(std::signbit(Lanes<n>::all(-0.0)[k]));
}

TEST_CASE_TEMPLATE("Lanes: extended keeps all lanes and has 0 above them", S, Size<1>, Size<2>, Size<4>, Size<8>, Size<12>,
                   Size<16>) {
    constexpr int n = S::lanes, next = hmesh::kit::lanes_for(n + 1);
    hmesh::kit::Random random(n);
    const Values<n> x = random_values<n>(random);
    const Lanes<n> a = Lanes<n>::load(x.value);
    CHECK(equal(Lanes<n>::extended(a), [&](int i) { return x.value[i]; }));
    CHECK(equal(Lanes<next>::extended(a), [&](int i) { return i < n ? x.value[i] : 0.0; }));
    CHECK(equal(Lanes<20>::extended(a), [&](int i) { return i < n ? x.value[i] : 0.0; }));
}

TEST_CASE_TEMPLATE("Lanes: clamp brings each lane into the range and leaves those inside alone", S, Size<1>, Size<2>, Size<4>,
                   Size<8>, Size<12>, Size<16>, Size<20>) {
    constexpr int n = S::lanes;
    hmesh::kit::Random random(n);
    for (int round = 0; round < 100; ++round) {
        const Values<n> x = random_values<n>(random);
        Lanes<n> a = Lanes<n>::load(x.value);
        a.clamp(-300, 500);
        CHECK(equal(a, [&](int i) { return x.value[i] < -300 ? -300 : (x.value[i] > 500 ? 500 : x.value[i]); }));
    }
}

TEST_CASE_TEMPLATE("Lanes: abs, max and sqrt are those of single numbers, to the last bit", S, Size<1>, Size<2>, Size<4>, Size<8>,
                   Size<12>, Size<16>, Size<20>) {
    constexpr int n = S::lanes;
    hmesh::kit::Random random(n);
    for (int round = 0; round < 100; ++round) {
        const Values<n> x = random_values<n>(random);
        const Lanes<n> a = abs(Lanes<n>::load(x.value)), root = sqrt(a);
        CHECK(equal(a, [&](int i) { return std::abs(x.value[i]); }));
        const Lanes<n> larger = max(Lanes<n>::load(x.value), root);
        CHECK(equal(larger, [&](int i) { return std::max(x.value[i], root[i]); }));
        CHECK(equal(root, [&](int i) { return std::sqrt(std::abs(x.value[i])); }));
    }
    for (const double value : {0.0, 5e-324, 1e-310, 1e308})
        CHECK(equal(sqrt(Lanes<n>::all(value)), [&](int) { return std::sqrt(value); }));
}

TEST_CASE("IntLanes: every operation does to each lane what it does to an integer of 32 bits") {
    using hmesh::kit::IntLanes;
    hmesh::kit::Random random(32);
    const auto any = [&] { return static_cast<std::int32_t>(static_cast<std::uint32_t>(random.next())); };
    const auto wrapped = [](std::int64_t x) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(x)); };
    for (int round = 0; round < 1000; ++round) {
        const std::int32_t x[5] = {0, any(), any(), any(), any()}, y[4] = {any(), any(), any(), any()};
        std::int32_t small[4]{}, other[4]{};
        for (int i = 0; i < 4; ++i) {
            small[i] = static_cast<std::int32_t>(random.below(32768));
            other[i] = small[i] == 0 ? any() : static_cast<std::int32_t>(random.below(32768));
        }
        const IntLanes a = IntLanes::load(x + 1), b = IntLanes::load(y), sum = a + b, bytes = IntLanes::bytes(x[1]);
        const IntLanes product = product_of_halves(IntLanes::load(small), IntLanes::load(other));
        const IntLanes common = a & b;
        const Lanes<4> doubles = a.doubles();
        std::int16_t lower[5], upper[5];  // loaded at odd places
        for (int i = 0; i < 5; ++i) lower[i] = static_cast<std::int16_t>(any()), upper[i] = static_cast<std::int16_t>(any());
        const IntLanes halves = IntLanes::halves(lower + 1, upper + 1), constant = IntLanes::halves(lower[0], upper[0]);
        const IntLanes sums = product_of_halves(halves, constant);
        std::int32_t stored[5] = {};
        sum.store(stored + 1);
        for (int i = 0; i < 4; ++i) {
            CHECK(halves[i] ==
                  wrapped(lower[i + 1] + std::int64_t{65536} * (lower[i + 1] < 0 ? upper[i + 1] + 1 : upper[i + 1])));
            CHECK(constant[i] == wrapped(lower[0] + std::int64_t{65536} * (lower[0] < 0 ? upper[0] + 1 : upper[0])));
            CHECK(sums[i] == wrapped(std::int64_t{lower[i + 1]} * lower[0] + std::int64_t{upper[i + 1]} * upper[0]));
            CHECK(stored[i + 1] == sum[i]);
            CHECK(a[i] == x[i + 1]);
            CHECK(sum[i] == wrapped(std::int64_t{x[i + 1]} + y[i]));
            CHECK(bytes[i] == static_cast<std::int32_t>(static_cast<std::uint32_t>(x[1]) >> (8 * i) & 255U));
            CHECK(product[i] == small[i] * std::int64_t{other[i]});
            CHECK(common[i] == (x[i + 1] & y[i]));
            CHECK(doubles[i] == x[i + 1]);
            CHECK(IntLanes::all(y[0])[i] == y[0]);
            CHECK(IntLanes::zero()[i] == 0);
        }
    }
    const std::int32_t most[4] = {32767, 0, 1, 32767}, of[4] = {32767, -1, 32767, 0};
    const IntLanes product = product_of_halves(IntLanes::load(most), IntLanes::load(of));
    CHECK(product[0] == 32767 * 32767);
    CHECK(product[1] == 0);
    CHECK(product[2] == 32767);
    CHECK(product[3] == 0);
}

TEST_CASE("widen() writes the 16 bytes from any place on, and nothing beyond them") {
    std::uint8_t bytes[256];
    for (int i = 0; i < 256; ++i) bytes[i] = static_cast<std::uint8_t>(i * 167 + 3);  // all of them
    for (int at = 0; at + 16 <= 256; ++at) {
        std::int16_t to[19];
        for (std::int16_t& number : to) number = -1;
        hmesh::kit::widen(bytes + at, to + 1 + at % 2);
        for (int i = 0; i < 19; ++i) {
            const int k = i - 1 - at % 2;
            CHECK(to[i] == (k >= 0 && k < 16 ? bytes[at + k] : -1));
        }
    }
}
