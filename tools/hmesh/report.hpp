// tools - the command's report as JSON (RFC 8259). An infinite PSNR is the string "inf"; seconds that were not
// measured are null.
#ifndef HMESH_TOOLS_REPORT_HPP
#define HMESH_TOOLS_REPORT_HPP

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

#include "arguments.hpp"
#include "hmesh/core/version.hpp"
#include "meshing.hpp"
#include "progress_watch.hpp"

namespace tool {

// What the PSNR of a mesh made with these arguments is, for people.
[[nodiscard]] inline std::string psnr_formula(const Arguments& arguments) {
    return std::string("10 log10(peak^2 / MSE), MSE over ") + (arguments.weights.empty() ? "" : "weighted ") +
           "pixels and channels" + (arguments.options.premultiplied ? ", colours times alpha" : "") +
           (arguments.options.fit_space == hmesh::FitSpace::linear_light ? ", drawn in linear light" : "");
}
// The same for programs, without anything left to guess.
[[nodiscard]] inline std::string psnr_convention(const Arguments& arguments) {
    return std::string("10 log10(peak^2 / MSE) in dB, MSE the mean over pixels") +
           (arguments.weights.empty() ? "" : ", each as often as its weight over the largest says,") +
           " and channels of the image's stored values" + (arguments.options.premultiplied ? ", colours times alpha" : "") +
           (arguments.options.fit_space == hmesh::FitSpace::linear_light ? ", the mesh drawn in linear light" : "");
}

namespace detail {

[[nodiscard]] inline std::string format(const char* pattern, double value) {
    char text[64];
    std::snprintf(text, sizeof text, pattern, value);
    return text;
}

// The bytes of the UTF-8 character at text[i], or 0 when there is none.
[[nodiscard]] inline std::size_t utf8_length(const std::string& text, std::size_t i) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
    const unsigned first = byte(i), second = byte(i + 1);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4) return 0;
    if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f)) return 0;
    if ((first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) return 0;
    for (std::size_t k = 1; k < length; ++k)
        if ((byte(i + k) & 0xc0) != 0x80) return 0;
    return length;
}

[[nodiscard]] inline std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(text, i);
        const auto byte = static_cast<unsigned char>(text[i]);
        if (length == 0) {
            out += "\\ufffd";
        } else if (byte < 0x20) {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(byte));
            out += escape;
        } else {
            if (byte == '"' || byte == '\\') out += '\\';
            out.append(text, i, length);
        }
        i += length == 0 ? 1 : length;
    }
    return out + '"';
}

[[nodiscard]] inline std::string json_number(double value) {
    if (std::isfinite(value)) return format("%.12g", value);
    return value > 0 ? "\"inf\"" : "null";
}

[[nodiscard]] inline std::string json_seconds(double value) { return value < 0 ? "null" : format("%.6f", value); }

[[nodiscard]] inline std::string json_stages(const hmesh::Report& report, const ProgressWatch& watch) {
    std::string out = "[";
    for (const hmesh::StageReport& stage : report.stages) {
        out += out.size() > 1 ? ",\n    " : "\n    ";
        out += "{\"name\": " + quoted(stage.name) + ", \"vertices\": " + std::to_string(stage.vertices) +
               ", \"energy\": " + json_number(stage.energy) + ", \"psnr\": " + json_number(stage.psnr) +
               ", \"seconds\": " + json_seconds(watch.seconds_of(stage));
        if (stage.iterations > 0)
            out += ", \"iterations\": " + std::to_string(stage.iterations) + ", \"residual\": " + json_number(stage.residual);
        out += "}";
    }
    return out + (report.stages.empty() ? "]" : "\n  ]");
}

}  // namespace detail

// What a status says, in words of the command, whose progress callback returns false after Ctrl-C alone.
[[nodiscard]] inline std::string what_of(const hmesh::Status& status) {
    return status.code == hmesh::Errc::cancelled ? "interrupted" : status.what;
}

// A PSNR for people: "31.83 dB" or "inf".
[[nodiscard]] inline std::string psnr_text(double psnr) { return std::isfinite(psnr) ? detail::format("%.2f dB", psnr) : "inf"; }

[[nodiscard]] inline std::string report_json(const Arguments& arguments, const ImageFile& image, const Outcome& outcome,
                                             double seconds, const ProgressWatch& watch) {
    std::string out = "{\n";
    const auto line = [&](const char* name, const std::string& value) {
        out += std::string("  \"") + name + "\": " + value + ",\n";
    };
    line("version", detail::quoted(HMESH_VERSION_STRING));
    line("input", detail::quoted(arguments.input));
    line("width", std::to_string(image.width));
    line("height", std::to_string(image.height));
    line("channels", std::to_string(image.channels));
    line("bits", std::to_string(image.bits));
    line("method", detail::quoted(name_of(methods, arguments.options.method)));
    line("effort", detail::quoted(name_of(efforts, arguments.options.effort)));
    line("colors", detail::quoted(name_of(colors, hmesh::final_colors(arguments.options))));
    line("fit_space", detail::quoted(name_of(fit_spaces, arguments.options.fit_space)));
    line("premultiplied", arguments.options.premultiplied ? "true" : "false");
    line("seed", std::to_string(arguments.options.seed));
    line("weights", arguments.weights.empty() ? "null" : detail::quoted(arguments.weights));
    line("tile", std::to_string(arguments.options.tile));
    line("target", detail::quoted(arguments.target));
    line("status", detail::quoted(outcome.status ? "ok" : what_of(outcome.status)));
    line("vertices", std::to_string(outcome.report.vertices));
    line("faces", std::to_string(outcome.report.faces));
    line("psnr", detail::json_number(outcome.report.psnr));
    line("psnr_convention", detail::quoted(psnr_convention(arguments)));
    line("energy", detail::json_number(outcome.report.energy));
    line("seconds", detail::json_seconds(seconds));
    return out + "  \"stages\": " + detail::json_stages(outcome.report, watch) + "\n}\n";
}

}  // namespace tool

#endif  // HMESH_TOOLS_REPORT_HPP
