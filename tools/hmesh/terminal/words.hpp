// tools - how the command says a Status and a PSNR.
#ifndef HMESH_TOOLS_TERMINAL_WORDS_HPP
#define HMESH_TOOLS_TERMINAL_WORDS_HPP

#include <cmath>
#include <cstdio>
#include <string>

#include "hmesh/core/status.hpp"

namespace tool {

// What a status says, with the offending value and its bound, where it has them. The command's progress callback returns false
// after Ctrl-C alone.
[[nodiscard]] inline std::string in_words(const hmesh::Status& status) {
    return status.code == hmesh::Errc::cancelled ? "interrupted" : hmesh::message(status).c_str();
}

// "31.83 dB" or "inf".
[[nodiscard]] inline std::string psnr_text(double psnr) {
    if (!std::isfinite(psnr)) return "inf";
    char text[64];
    std::snprintf(text, sizeof text, "%.2f dB", psnr);
    return text;
}

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_WORDS_HPP
