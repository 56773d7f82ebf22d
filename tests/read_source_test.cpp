#include "hmesh/fit/read_source.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <thread>
#include <vector>

#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/weights.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageReader;
using hmesh::Periodic;
using hmesh::kit::ImageSource;
using hmesh::kit::MomentTable;
using hmesh::kit::Point;
using hmesh::kit::ReadImage;
using hmesh::kit::Rect;
using hmesh::kit::SourceWindow;

namespace {

template <int C>
bool same_bits(const MomentTable<C>& a, const MomentTable<C>& b) {
    bool same = a.width() == b.width() && a.height() == b.height() && a.bytes() == b.bytes();
    for (int y = 0; same && y < a.height(); ++y)
        for (int x = 0; x <= a.width(); ++x) {
            const auto of_a = a.entry(x, y), of_b = b.entry(x, y);
            for (int k = 0; k < MomentTable<C>::lanes; ++k)
                same = same && of_a.of_samples[k] == of_b.of_samples[k] && of_a.by_column[k] == of_b.by_column[k];
            const std::size_t at = a.offset(x, y);
            for (int k = 0; a.is_weighted() && k < 2; ++k) same = same && a.x_moments(at)[k] == b.x_moments(at)[k];
        }
    return same;
}

// Pixels around points are those of the view, each point is visited once, and squares are read once.
template <class T, int C>
void check_visits(const ImageSource<C>& of_view, const ImageSource<C>& read, const std::atomic<int>& calls, int squares) {
    const int width = of_view.width(), height = of_view.height();
    std::vector<Point> points;
    for (int y = 0; y <= height; y += 3)
        for (int x = width; x >= 0; x -= 5) points.push_back({x - (x == width || x == 0 ? 0.0 : 0.25), static_cast<double>(y)});
    std::vector<int> visits(points.size(), 0);
    const int before = calls;
    bool same = true;
    read.visit(
        points.size(), [&](std::size_t k) { return points[k]; },
        [&](const SourceWindow<C>& window, std::size_t k) {
            ++visits[k];
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int x = static_cast<int>(points[k].x) + dx, y = static_cast<int>(points[k].y) + dy;
                    for (int c = 0; c < C; ++c) same = same && window.pixel(x, y)[c] == of_view.pixel(x, y)[c];
                }
        });
    CHECK(same);
    for (const int count : visits) REQUIRE(count == 1);
    CHECK(calls - before <= squares);
}

template <class T, int C>
void check_read(const Image<T, C>& image, Periodic periodic) {
    const int width = image.width(), height = image.height();
    const Image<float, 1> weights = hmesh_test::random_weights(width, height, 3);
    const double unit = hmesh::kit::weight_unit(weights.view());
    const hmesh::ViewReader<T, C> view(image.view());
    std::atomic<int> calls{0};
    const auto read = [&](const Rect& rect, T* to, std::ptrdiff_t stride) {
        ++calls;
        CHECK((rect.x >= 0 && rect.y >= 0 && rect.width > 0 && rect.height > 0));
        CHECK((rect.x + rect.width <= width && rect.y + rect.height <= height));
        return view(rect, to, stride);
    };
    const ImageReader<T, C> reader{width, height, read};
    const ReadImage<T, C> pixels(reader);
    std::vector<Rect> rects = {{0, 0, width, height}, {1, 2, width - 3, height - 4}, {width - 1, height - 1, 1, 1}};
    if (hmesh::kit::wraps_x(periodic)) rects.push_back({-5, 0, width + 9, height});
    if (hmesh::kit::wraps_y(periodic)) rects.push_back({3, -height, 4, 3 * height});
    for (const bool is_weighted : {false, true}) {
        const auto own = is_weighted ? weights.view() : hmesh::ImageView<float, 1>();
        const auto of_view = ImageSource<C>(image.view(), own, unit).with_periodic(periodic, false);
        const auto source = hmesh::kit::read_source(pixels, own, unit).with_periodic(periodic, false);
        CHECK(source.is_read());
        CHECK(!of_view.is_read());
        CHECK((source.peak() == of_view.peak() && source.is_integer() == of_view.is_integer()));
        for (const Rect& rect : rects) CHECK(same_bits(source.table(rect), of_view.table(rect)));
        if (is_weighted) continue;
        const int tiles = (width / 256 + 1) * (height / 256 + 1);
        check_visits<T>(of_view, source, calls, periodic == Periodic::none ? tiles : 9 * tiles);  // in parts where it repeats
    }
    CHECK(pixels.status());
}

}  // namespace

TEST_CASE("tables and the pixels around points are those of a view, of images that repeat too") {
    for (const Periodic periodic : {Periodic::none, Periodic::x, Periodic::y, Periodic::xy}) {
        check_read(hmesh_test::noise<std::uint8_t, 3>(23, 19, 1), periodic);
        check_read(hmesh_test::noise<float, 2>(17, 31, 2), periodic);
    }
    check_read(hmesh_test::noise<std::uint16_t, 1>(530, 300, 3), Periodic::none);
    check_read(hmesh_test::noise<std::uint8_t, 4>(6, 530, 4), Periodic::xy);
}

TEST_CASE("what is read is premultiplied and scaled as a whole image is") {
    const auto image = hmesh_test::noise<std::uint8_t, 4>(21, 18, 5);
    const hmesh::ViewReader<std::uint8_t, 4> view(image.view());
    const ImageReader<std::uint8_t, 4> reader = view.reader();
    const ReadImage<std::uint8_t, 4> pixels(reader, true);
    const auto premultiplied = hmesh::kit::premultiply(image.view());
    const auto source = hmesh::kit::read_source(pixels);
    const ImageSource<4> of_view(premultiplied.view());
    const Rect rect{3, 4, 17, 12};
    CHECK(same_bits(source.table(rect), of_view.table(rect)));
    const auto scale = hmesh::kit::channel_scale<4>(hmesh::kit::sample_range(premultiplied.view()), {1, 2, 0, 5});
    const auto scaled_source = source.with_scale(scale), scaled_view = of_view.with_scale(scale);
    CHECK(scaled_source.scale() == &scale);
    CHECK(scaled_source.peak() == 65535);
    CHECK(same_bits(scaled_source.table(rect), scaled_view.table(rect)));
    scaled_source.with_window(rect, [&](const SourceWindow<4>& window) {
        for (int c = 0; c < 4; ++c) CHECK(window.pixel(5, 6)[c] == scaled_view.pixel(5, 6)[c]);
    });
}

TEST_CASE("after a rectangle that cannot be read, or has a sample that is not finite, all is black and nothing more is read") {
    auto image = hmesh_test::noise<float, 2>(40, 30, 6);
    const hmesh::ViewReader<float, 2> view(image.view());
    int calls = 0;
    const auto read = [&](const Rect& rect, float* to, std::ptrdiff_t stride) {
        ++calls;
        (void)view(rect, to, stride);
        return rect.y != 7;
    };
    const ImageReader<float, 2> reader{40, 30, read};
    const ReadImage<float, 2> pixels(reader);
    CHECK(pixels.fetch({1, 2, 3, 4}).pixel(0, 0)[1] == image.pixel(1, 2)[1]);
    CHECK(pixels.status());
    for (int k = 0; k < 3; ++k) {
        const Image<float, 2> black = pixels.fetch({5, 7, 2, 9});
        for (std::size_t i = 0; i < black.size(); ++i) REQUIRE(black.data()[i] == 0);
    }
    CHECK(calls == 2);
    CHECK(pixels.has_failed());
    CHECK(pixels.status().code == Errc::read_failed);
    CHECK(hmesh::kit::span_first(pixels.status().value) == 5);
    CHECK(hmesh::kit::span_count(pixels.status().value) == 2);
    CHECK(hmesh::kit::span_first(pixels.status().limit) == 7);
    CHECK(hmesh::kit::span_count(pixels.status().limit) == 9);

    image.pixel(11, 13)[1] = std::numeric_limits<float>::infinity();
    const ImageReader<float, 2> whole = view.reader();
    const ReadImage<float, 2> wild(whole);
    hmesh::Status status;
    CHECK(wild.fetch({10, 12, 4, 4}, status).pixel(0, 0)[0] == 0);
    CHECK(status.code == Errc::not_finite);
    CHECK(status.value == 13);
    CHECK(wild.status());
    (void)wild.fetch({10, 12, 4, 4});
    CHECK(wild.status().code == Errc::not_finite);
}

TEST_CASE("a reader that is not concurrent is called by one thread at a time") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(64, 64, 7);
    const hmesh::ViewReader<std::uint8_t, 1> view(image.view());
    std::atomic<int> inside{0}, most{0};
    const auto read = [&](const Rect& rect, std::uint8_t* to, std::ptrdiff_t stride) {
        const int now = ++inside;
        if (now > most) most = now;
        std::this_thread::sleep_for(std::chrono::microseconds(20));  // others come meanwhile, where they can
        const bool done = view(rect, to, stride);
        --inside;
        return done;
    };
    const ImageReader<std::uint8_t, 1> reader{64, 64, read};
    const ReadImage<std::uint8_t, 1> pixels(reader);
    std::atomic<int> wrong{0};
    hmesh_test::ThreadFor{4}(400, [&](std::size_t i) {
        const int x = static_cast<int>(i % 60);
        if (*pixels.fetch({x, 5, 3, 40}).pixel(0, 2) != *image.pixel(x, 7)) ++wrong;
    });
    CHECK(most == 1);
    CHECK(wrong == 0);
}
