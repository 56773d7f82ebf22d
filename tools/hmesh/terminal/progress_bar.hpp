// tools - the progress bar on the standard error: one line at any width of the terminal, wiped when it is done.
#ifndef HMESH_TOOLS_TERMINAL_PROGRESS_BAR_HPP
#define HMESH_TOOLS_TERMINAL_PROGRESS_BAR_HPP

#include <cstddef>
#include <string>

namespace tool {

// What the bar shows.
struct BarState {
    double fraction = 0;       // of the whole run, in [0, 1]
    double seconds_left = -1;  // below 0: not known
    const char* stage = "";    // of plain ASCII
    std::size_t vertices = 0;  // 0: none yet
};

// The line for a terminal of so many columns, the last of which stays free, as some terminals begin a new line there. Where not
// all fits, first the stage is left out, then the vertices, the time to go, the bar, and what is left of the percentage.
[[nodiscard]] std::string bar_line(int columns, const BarState& state);

// Draws the line over the one that is there. From one thread at a time.
void draw_bar(const BarState& state);

// Wipes the line, if there is one.
void wipe_bar();

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_PROGRESS_BAR_HPP
