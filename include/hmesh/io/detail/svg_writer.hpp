// hmesh - the numbers, colours and names in write_svg()'s files, in as few bytes as they need.
#ifndef HMESH_IO_DETAIL_SVG_WRITER_HPP
#define HMESH_IO_DETAIL_SVG_WRITER_HPP

#include <array>
#include <cstddef>

#include "hmesh/io/detail/svg_gradient.hpp"
#include "hmesh/io/sink.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

template <class Sink>
class SvgWriter : public Writer<Sink> {
  public:
    using Writer<Sink>::Writer;

    void size(int width, int height) {
        this->text("width=\"");
        this->decimal(width);
        this->text("\" height=\"");
        this->decimal(height);
        this->text("\"");
    }
    // Three decimals are enough to tell the units of 1/256 px of which meshes are made, and many viewers' pictures too.
    void point(double x, double y) {
        this->fixed(x, 3);
        this->text(" ");
        this->fixed(y, 3);
    }
    void ends(const GradientLine& line) {
        const std::array<double, 4> values = {line.from.x, line.from.y, line.to.x, line.to.y};
        static constexpr std::array<const char*, 4> names = {"x1=\"", "\" y1=\"", "\" x2=\"", "\" y2=\""};
        for (std::size_t i = 0; i < 4; ++i) {
            this->text(names[i]);
            this->fixed(values[i], line.places);
        }
        this->text("\"");
    }
    void stop(double offset, const Color4& color) {
        this->text("<stop offset=\"");
        this->fixed(offset, 4);
        this->text("\" stop-color=\"");
        hex(color);
        this->text("\"/>");
    }
    void hex(const Color4& color) {
        std::array<char, 8> out{'#'};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = static_cast<std::size_t>(color[k] + 0.5);
            out[1 + 2 * k] = "0123456789abcdef"[byte >> 4U];
            out[2 + 2 * k] = "0123456789abcdef"[byte & 15U];
        }
        this->text(out.data());
    }
    // Letters alone: the ids of other things have an underscore.
    void id(std::size_t number) {
        std::array<char, 14> letters{};  // 52^12 > 2^64
        std::size_t at = letters.size() - 1;
        do {
            letters[--at] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"[number % 52];
            number /= 52;
        } while (number != 0);
        this->text(letters.data() + at);
    }
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_SVG_WRITER_HPP
