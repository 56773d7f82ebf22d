#include "terminal/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <sys/ioctl.h>
#include <unistd.h>
#endif

namespace tool {
namespace {

bool is_drawn = false;
std::size_t on_line = 0;  // characters on the line

// The columns of the terminal now, which may change at any time.
int terminal_columns() {
    int columns = 0;
#ifdef _WIN32
    CONSOLE_SCREEN_BUFFER_INFO info;
    if (GetConsoleScreenBufferInfo(GetStdHandle(STD_ERROR_HANDLE), &info) != 0)
        columns = info.srWindow.Right - info.srWindow.Left + 1;
#else
    winsize size{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
#endif
    if (columns > 0) return columns;
    const char* const set = std::getenv("COLUMNS");
    columns = set != nullptr ? static_cast<int>(std::strtol(set, nullptr, 10)) : 0;
    return columns > 0 && columns <= 10000 ? columns : 80;
}

std::size_t usable(int columns) { return static_cast<std::size_t>(std::max(1, columns) - 1); }

// "0:07", "12:34" or "1:02:03".
std::string clock_text(double seconds) {
    const auto whole = static_cast<int>(std::min(3.6e6, std::ceil(seconds)));
    char text[32];
    if (whole < 3600) std::snprintf(text, sizeof text, "%d:%02d", whole / 60, whole % 60);
    else std::snprintf(text, sizeof text, "%d:%02d:%02d", whole / 3600, whole / 60 % 60, whole % 60);
    return text;
}

}  // namespace

std::string bar_line(int columns, const BarState& state) {
    const std::size_t width = usable(columns);
    const double fraction = std::max(0.0, std::min(1.0, state.fraction));
    const int percent = static_cast<int>(fraction * 100);
    char number[16];
    std::snprintf(number, sizeof number, "%3d %%", percent);
    std::string line = number;
    if (width < line.size()) {
        line = std::to_string(percent);
        return line.size() <= width ? line : "";
    }
    // The bar's length follows from the width alone, so that it stays as it is while the rest changes.
    const std::size_t length = std::max<std::size_t>(10, std::min<std::size_t>(30, width / 3));
    if (width >= length + 3 + line.size()) {
        const auto done = static_cast<std::size_t>(fraction * static_cast<double>(length));
        line = "[" + std::string(done, '#') + std::string(length - done, '.') + "] " + line;
    }
    const auto fits = [&](const std::string& more) { return line.size() + more.size() <= width; };
    const std::string time = state.seconds_left >= 0 ? ", " + clock_text(state.seconds_left) + " to go" : "";
    const std::string vertices = state.vertices > 0 ? ", " + std::to_string(state.vertices) + " vertices" : "";
    const std::string stage = *state.stage != '\0' ? ", " + std::string(state.stage).substr(0, 24) : "";
    if (!fits(time)) return line;
    line += time;
    if (!fits(vertices)) return line;
    return fits(stage + vertices) ? line + stage + vertices : line + vertices;
}

void draw_bar(const BarState& state) {
    const int columns = terminal_columns();
    std::string line = bar_line(columns, state);
    const std::size_t written = line.size();
    line.resize(std::max(written, std::min(on_line, usable(columns))), ' ');
    on_line = written;
    is_drawn = true;
    std::fprintf(stderr, "\r%s", line.c_str());
    std::fflush(stderr);
}

void wipe_bar() {
    if (!is_drawn) return;
    const std::string blank(std::min(on_line, usable(terminal_columns())), ' ');
    on_line = 0;
    is_drawn = false;
    std::fprintf(stderr, "\r%s\r", blank.c_str());
    std::fflush(stderr);
}

}  // namespace tool
