#include "hmesh/io/sink.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace {

using Bytes = std::vector<unsigned char>;

// A sink that takes whole calls until `limit` bytes would be exceeded.
struct LimitedSink {
    std::size_t limit = std::numeric_limits<std::size_t>::max();
    Bytes taken;
    int refusals = 0;
    bool empty_call = false;

    bool operator()(const void* bytes, std::size_t size) {
        empty_call = empty_call || size == 0;
        if (size > limit - taken.size()) {
            ++refusals;
            return false;
        }
        const auto* from = static_cast<const unsigned char*>(bytes);
        taken.insert(taken.end(), from, from + size);
        return true;
    }
};

// What is not to be taken for a sink: it says how many bytes it took, as fwrite does, or nothing.
struct CountingSink {
    std::size_t operator()(const void*, std::size_t size) { return size; }
};
struct MuteSink {
    void operator()(const void*, std::size_t) {}
};

std::string printed(std::int64_t value) {
    LimitedSink sink;
    hmesh::detail::Writer writer(sink);
    writer.decimal(value);
    CHECK(writer.finish());
    return {sink.taken.begin(), sink.taken.end()};
}

std::string printed(double value, int places) {
    LimitedSink sink;
    hmesh::detail::Writer writer(sink);
    writer.fixed(value, places);
    CHECK(writer.finish());
    return {sink.taken.begin(), sink.taken.end()};
}

std::string printed_real(double value) {
    LimitedSink sink;
    hmesh::detail::Writer writer(sink);
    writer.real(value);
    CHECK(writer.finish());
    return {sink.taken.begin(), sink.taken.end()};
}

}  // namespace

TEST_CASE("binary numbers are little-endian") {
    LimitedSink sink;
    hmesh::detail::Writer writer(sink);
    writer.u8(0xfe);
    writer.u16(0x1234);
    writer.u32(0x89abcdef);
    writer.f32(1.0F);
    writer.f32(-0.15625F);
    REQUIRE(writer.finish());
    CHECK(sink.taken == Bytes{0xfe, 0x34, 0x12, 0xef, 0xcd, 0xab, 0x89, 0, 0, 0x80, 0x3f, 0, 0, 0x20, 0xbe});
}

TEST_CASE("decimal prints every integer of 64 bits") {
    CHECK(printed(0) == "0");
    CHECK(printed(7) == "7");
    CHECK(printed(-1) == "-1");
    CHECK(printed(1000) == "1000");
    CHECK(printed(-90210) == "-90210");
    CHECK(printed(std::numeric_limits<std::int64_t>::max()) == "9223372036854775807");
    CHECK(printed(std::numeric_limits<std::int64_t>::min()) == "-9223372036854775808");
}

TEST_CASE("fixed rounds to the places asked for and leaves out zeros at the end") {
    CHECK(printed(0.0, 3) == "0");
    CHECK(printed(-0.0, 3) == "0");
    CHECK(printed(1.5, 0) == "2");
    CHECK(printed(0.25, 6) == "0.25");
    CHECK(printed(-0.0625, 3) == "-0.063");
    CHECK(printed(-0.0004, 3) == "0");
    CHECK(printed(1.0000001, 6) == "1");
    CHECK(printed(0.000001, 6) == "0.000001");
    CHECK(printed(65535.99609375, 8) == "65535.99609375");
    CHECK(printed(9.999, 2) == "10");
    CHECK(printed(1e300, 2) == "90071992547409.92");
    // What strtod reads back is off by at most half a unit of the last place.
    for (int i = 0; i < 20000; ++i) {
        const double value = (i - 10000) * 0.7310585786;
        const double read = std::strtod(printed(value, 6).c_str(), nullptr);
        CHECK(std::abs(read - value) <= 0.5e-6 + 1e-12);
    }
}

TEST_CASE("real writes every float so that it is read back as itself, and the 1/256 grid plainly") {
    CHECK(printed_real(0.0) == "0");
    CHECK(printed_real(-0.0) == "0");
    CHECK(printed_real(12.5) == "12.5");
    CHECK(printed_real(-0.00390625) == "-0.00390625");
    CHECK(printed_real(65535.99609375) == "65535.99609375");
    CHECK(printed_real(4194303.99609375) == "4194303.99609375");
    CHECK(printed_real(4194304) == "4.194304e6");
    CHECK(printed_real(1.0F / 3) == "0.333333343");
    CHECK(printed_real(-0.01) == "-1e-2");
    CHECK(printed_real(static_cast<double>(std::numeric_limits<float>::max())) == "3.40282347e38");
    const auto is_read_back = [](float value) {
        return std::strtof(printed_real(static_cast<double>(value)).c_str(), nullptr) == value;
    };
    CHECK(is_read_back(std::numeric_limits<float>::min()));
    CHECK(is_read_back(std::numeric_limits<float>::denorm_min()));
    // 2^32 / 429497 floats of both signs, evenly over all bit patterns.
    std::uint32_t bits = 0;
    for (int i = 0; i < 10000; ++i, bits += 429497) {
        float value = 0;
        std::memcpy(&value, &bits, sizeof value);
        if (std::isfinite(value) && !is_read_back(value)) FAIL(value);
    }
    for (int k = 0; k <= 65535; k += 5)
        if (!is_read_back(static_cast<float>(k) / 65535)) FAIL(k);
}

TEST_CASE("bytes arrive whole and in order, however they are cut into writes") {
    Bytes sent(20000);
    for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<unsigned char>(i * 7 + i / 251);
    for (const std::size_t step :
         {std::size_t{1}, std::size_t{7}, std::size_t{4095}, std::size_t{4096}, std::size_t{4097}, sent.size()}) {
        LimitedSink sink;
        hmesh::detail::Writer writer(sink);
        for (std::size_t i = 0; i < sent.size(); i += step) writer.bytes(sent.data() + i, std::min(step, sent.size() - i));
        REQUIRE(writer.finish());
        CHECK(sink.taken == sent);
        CHECK_FALSE(sink.empty_call);
    }
}

TEST_CASE("a sink is what returns a bool: one that returns a count or nothing does not compile") {
    CHECK(std::is_convertible_v<LimitedSink&, hmesh::Sink>);
    CHECK(std::is_convertible_v<bool (*)(const void*, std::size_t), hmesh::Sink>);
    CHECK(!std::is_convertible_v<CountingSink&, hmesh::Sink>);
    CHECK(!std::is_convertible_v<std::size_t (*)(const void*, std::size_t), hmesh::Sink>);
    CHECK(!std::is_convertible_v<MuteSink&, hmesh::Sink>);
}

TEST_CASE("append_to() appends all bytes to a string or a vector, behind those it holds") {
    std::string text = "a";
    std::vector<unsigned char> bytes{7};
    const auto to_text = hmesh::kit::append_to(text);
    const auto to_bytes = hmesh::kit::append_to(bytes);
    const std::string sent("b\0c", 3);
    for (const hmesh::Sink sink : {hmesh::Sink(to_text), hmesh::Sink(to_bytes)})
        for (int call = 0; call < 2; ++call) CHECK(sink(sent.data(), sent.size()));
    CHECK(text == "a" + sent + sent);
    CHECK(bytes == std::vector<unsigned char>{7, 'b', 0, 'c', 'b', 0, 'c'});
}

TEST_CASE("the writer says where the next byte stands in the file, whatever the sink took") {
    for (const std::size_t limit : {0U, 4096U, 100000U}) {
        LimitedSink sink;
        sink.limit = limit;
        hmesh::detail::Writer writer(sink);
        CHECK(writer.position() == 0);
        const Bytes sent(10000, 7);
        writer.bytes(sent.data(), sent.size());
        CHECK(writer.position() == 10000);
        writer.decimal(-5);
        CHECK(writer.position() == 10002);
        CHECK(static_cast<bool>(writer.finish()) == (limit == 100000));
        CHECK(writer.position() == 10002);
    }
}

TEST_CASE("a writer that was given nothing does not call its sink") {
    LimitedSink sink;
    sink.limit = 0;
    hmesh::detail::Writer writer(sink);
    writer.text("");
    CHECK(writer.finish());
    CHECK(sink.refusals == 0);
    CHECK_FALSE(sink.empty_call);
}

TEST_CASE("the writer stops at the first refusal and says how many bytes were taken") {
    const Bytes sent(20000, 42);
    for (const std::size_t limit : {0U, 1U, 4095U, 4096U, 4097U, 8192U, 10000U, 19999U}) {
        LimitedSink sink;
        sink.limit = limit;
        hmesh::detail::Writer writer(sink);
        for (const unsigned char byte : sent) writer.u8(byte);
        const hmesh::Status status = writer.finish();
        CHECK(status.code == hmesh::Errc::write_failed);
        CHECK(status.value == static_cast<double>(sink.taken.size()));
        CHECK(sink.taken.size() == limit / 4096 * 4096);
        CHECK(sink.refusals == 1);
    }
}
