#include "hmesh/image/image_reader.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageReader;
using hmesh::ImageView;
using hmesh::kit::Rect;

TEST_CASE("a reader is valid with a function and sides up to the longest, however many pixels that are") {
    const auto read = [](const Rect&, float*, std::ptrdiff_t) { return true; };
    const auto code_of = [&](int width, int height) { return check(ImageReader<float, 2>{width, height, read}).code; };
    CHECK(code_of(1, 1) == Errc::ok);
    CHECK(code_of(65536, 65536) == Errc::ok);
    CHECK(code_of(65537, 1) == Errc::image_too_large);
    CHECK(code_of(1, 65537) == Errc::image_too_large);
    CHECK(code_of(0, 1) == Errc::invalid_argument);
    CHECK(code_of(1, -1) == Errc::invalid_argument);
    CHECK(check(ImageReader<float, 2>{3, 3}).code == Errc::invalid_argument);
}

TEST_CASE("a rectangle of a view is copied, whatever its stride and that of where it goes, and nothing beside it is written") {
    const auto image = hmesh_test::noise<std::uint16_t, 3>(9, 7, 1);
    const hmesh_test::PaddedCopy<std::uint16_t, 3> padded(image, 5, false, 0), upside_down(image, 3, true, 0);
    for (const ImageView<std::uint16_t, 3>& view : {image.view(), padded.view(), upside_down.view()}) {
        const hmesh::ViewReader<std::uint16_t, 3> views(view);
        const ImageReader<std::uint16_t, 3> reader = views.reader();
        CHECK(reader.is_concurrent);
        REQUIRE(check(reader));
        for (const Rect& rect : {Rect{0, 0, 9, 7}, Rect{2, 3, 4, 2}, Rect{8, 6, 1, 1}, Rect{0, 5, 9, 1}}) {
            constexpr int room = 40;  // samples from row to row
            std::vector<std::uint16_t> to(room * 8, 7777);
            CHECK(reader.read(rect, to.data(), room * 2));
            for (int y = 0; y < 8; ++y)
                for (int k = 0; k < room; ++k) {
                    const bool inside = y < rect.height && k < 3 * rect.width;
                    REQUIRE(to[static_cast<std::size_t>(y * room + k)] == (inside ? image.pixel(rect.x, rect.y + y)[k] : 7777));
                }
        }
    }
}

TEST_CASE("a rectangle that could not be read is named by its columns and rows, up to the last of the largest image") {
    const auto words = [](const Rect& rect) { return std::string(message(hmesh::kit::unread(rect)).c_str()); };
    CHECK(words({256, 512, 256, 1}) == "the image could not be read (columns 256 to 511 of rows 512 to 512)");
    CHECK(words({0, 0, 1, 1}) == "the image could not be read (columns 0 to 0 of rows 0 to 0)");
    CHECK(words({0, 0, 65536, 65536}) == "the image could not be read (columns 0 to 65535 of rows 0 to 65535)");
    CHECK(words({65535, 65535, 1, 1}) == "the image could not be read (columns 65535 to 65535 of rows 65535 to 65535)");
}
