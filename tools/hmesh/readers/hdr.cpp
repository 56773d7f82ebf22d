// Radiance files (.hdr): colours with a common exponent, "32-bit_rle_rgbe", of Greg Ward, "Real Pixels", Graphics Gems II, 1991.
#include <cmath>
#include <cstdio>
#include <cstring>

#include "readers/readers.hpp"

namespace tool {
namespace {

// A line of the header without its end, which some programs make "\r\n", and `at` behind it. False where the file ends before, or
// the line is longer than any is.
bool next_line(Bytes file, std::size_t& at, std::string& line) {
    line.clear();
    for (; at < file.size && line.size() < 4096; ++at) {
        if (file.u8(at) == '\n') {
            ++at;
            if (!line.empty() && line.back() == '\r') line.pop_back();
            return true;
        }
        line += static_cast<char>(file.u8(at));
    }
    return false;
}

struct Layout {
    int width = 0, height = 0;
    unsigned orientation = 1;
};

// "-Y 480 +X 640": of rows from the top, from the left; what comes first runs slower.
bool read_layout(const std::string& line, Layout& layout) {
    char first_sign = 0, first = 0, second_sign = 0, second = 0;
    int lines = 0, columns = 0, end = 0;
    if (std::sscanf(line.c_str(), "%c%c %9d %c%c %9d%n", &first_sign, &first, &lines, &second_sign, &second, &columns, &end) !=
            6 ||
        static_cast<std::size_t>(end) != line.size())
        return false;
    const bool rows = first == 'Y' && second == 'X', turned = first == 'X' && second == 'Y';
    if ((!rows && !turned) || (first_sign != '+' && first_sign != '-') || (second_sign != '+' && second_sign != '-'))
        return false;
    layout.width = columns;
    layout.height = lines;
    const bool x_runs_left = (rows ? second_sign : first_sign) == '-', y_runs_up = (rows ? first_sign : second_sign) == '+';
    constexpr unsigned of_rows[] = {1, 2, 4, 3}, of_columns[] = {5, 6, 8, 7};
    layout.orientation = (rows ? of_rows : of_columns)[(y_runs_up ? 2 : 0) + (x_runs_left ? 1 : 0)];
    return true;
}

// One component of a row in runs, and `at` behind it.
bool read_runs(Bytes file, std::size_t& at, unsigned char* row, std::size_t width) {
    for (std::size_t x = 0; x < width;) {
        const std::uint32_t code = file.u8(at++);
        const std::size_t count = code > 128 ? code - 128 : code;
        if (count == 0 || count > width - x || !file.has(at, code > 128 ? 1 : count)) return false;
        if (code > 128) std::memset(row + x, file.data[at], count);
        else std::memcpy(row + x, file.data + at, count);
        at += code > 128 ? 1 : count;
        x += count;
    }
    return true;
}

// A row of `width` pixels, as four planes, and `at` behind it.
bool read_row(Bytes file, std::size_t& at, std::vector<unsigned char>& planes, std::size_t width) {
    const bool has_runs = width >= 8 && width < 32768 && file.u8(at) == 2 && file.u8(at + 1) == 2 && file.be16(at + 2) == width;
    if (!has_runs) {
        // Of the oldest kind, whose runs begin with 1 1 1: not seen since 1991.
        if (!file.has(at, 4 * width)) return false;
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < 4; ++c) planes[c * width + x] = file.data[at + 4 * x + c];
        at += 4 * width;
        return true;
    }
    at += 4;
    for (std::size_t c = 0; c < 4; ++c)
        if (!read_runs(file, at, planes.data() + c * width, width)) return false;
    return true;
}

// The header's lines, and `at` behind them. Returns "" or what is wrong.
std::string read_header(Bytes file, std::size_t& at, Layout& layout) {
    std::string line, format;
    do {
        if (!next_line(file, at, line)) return "its Radiance header has no end";
        if (line.compare(0, 7, "FORMAT=") == 0) format = line.substr(7);
    } while (!line.empty());
    if (!format.empty() && format != "32-bit_rle_rgbe")
        return "its Radiance format is '" + format + "', and hmesh reads 32-bit_rle_rgbe";
    return next_line(file, at, line) && read_layout(line, layout) ? "" : "its Radiance header has no valid size";
}

}  // namespace

void find_hdr_size(Bytes file, std::int64_t& width, std::int64_t& height) {
    std::size_t at = 0;
    Layout layout;
    if (!read_header(file, at, layout).empty()) return;
    width = layout.width;
    height = layout.height;
}

std::string read_hdr(Bytes file, ImageFile& image) {
    std::size_t at = 0;
    Layout layout;
    if (std::string why = read_header(file, at, layout); !why.empty()) return why;
    if (std::string why = check_size(layout.width, layout.height); !why.empty()) return why;
    const auto width = static_cast<std::size_t>(layout.width), height = static_cast<std::size_t>(layout.height);
    // A run of 127 samples takes two bytes.
    if (std::string why = check_ratio(4 * width * height, file.size, 64); !why.empty()) return why;
    if (std::string why = start_image(image, layout.width, layout.height, 3, 32); !why.empty()) return why;
    std::vector<unsigned char> planes(4 * width);
    float* to = image.samples32.data();
    for (std::size_t y = 0; y < height; ++y) {
        if (!read_row(file, at, planes, width))
            return "its row " + std::to_string(y) + " of " + std::to_string(height) + " is cut off or has a run that is too long";
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                const int exponent = planes[3 * width + x];
                *to++ = exponent == 0 ? 0.0F : std::ldexp(static_cast<float>(planes[c * width + x]), exponent - 136);
            }
    }
    turn_upright(layout.orientation, image);
    return {};
}

}  // namespace tool
