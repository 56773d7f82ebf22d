// tools - the standard streams as files: a name that is "-" is the standard input, of what is read, or the standard output.
#ifndef HMESH_TOOLS_TERMINAL_STANDARD_STREAMS_HPP
#define HMESH_TOOLS_TERMINAL_STANDARD_STREAMS_HPP

#include <csignal>
#include <cstdio>
#include <string>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#else
#include <unistd.h>
#endif

namespace tool {

[[nodiscard]] inline bool is_standard(const std::string& name) { return name == "-"; }

// As sentences have them: 'photo.png' or the standard input, 'mesh.ply' or the standard output.
[[nodiscard]] inline std::string input_words(const std::string& name) {
    return is_standard(name) ? "the standard input" : "'" + name + "'";
}
[[nodiscard]] inline std::string output_words(const std::string& name) {
    return is_standard(name) ? "the standard output" : "'" + name + "'";
}

// As lists of files have an output, without quotes.
[[nodiscard]] inline std::string output_name(const std::string& name) { return is_standard(name) ? "the standard output" : name; }

[[nodiscard]] inline bool is_terminal(std::FILE* file) {
#ifdef _WIN32
    return _isatty(_fileno(file)) != 0;
#else
    return isatty(fileno(file)) != 0;
#endif
}

// Bytes as they are, where a system knows text as something else.
inline void set_binary([[maybe_unused]] std::FILE* file) {
#ifdef _WIN32
    static_cast<void>(_setmode(_fileno(file), _O_BINARY));
#endif
}

// From now on a reader that goes away, as head does, and a file that may not grow, by ulimit, are failures to write like any
// other, and do not end the program.
inline void outlive_readers() {
#ifndef _WIN32
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
#endif
}

// After catch_interrupt(): a wait for the standard input ends with the first interrupt, not the second.
inline void let_interrupts_end_waiting() {
#ifndef _WIN32
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action;
        if (::sigaction(signal, nullptr, &action) != 0) continue;
        action.sa_flags &= ~SA_RESTART;
        static_cast<void>(::sigaction(signal, &action, nullptr));
    }
#endif
}

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_STANDARD_STREAMS_HPP
