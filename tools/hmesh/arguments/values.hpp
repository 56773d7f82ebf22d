// tools - numbers of the command line, strictly, in any locale alike. What returns a string returns "" or what is wrong with the
// text, as the end of a sentence.
#ifndef HMESH_TOOLS_ARGUMENTS_VALUES_HPP
#define HMESH_TOOLS_ARGUMENTS_VALUES_HPP

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace tool {

[[nodiscard]] inline bool is_integer(const std::string& text) {
    const std::size_t sign = !text.empty() && text[0] == '-' ? 1 : 0;
    return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string::npos;
}

[[nodiscard]] inline std::string parse_integer(const std::string& text, std::int64_t& value) {
    errno = 0;
    value = is_integer(text) ? std::strtoll(text.c_str(), nullptr, 10) : 0;
    if (!is_integer(text)) return "is not a whole number";
    return errno == 0 ? "" : "is a larger number than any image has pixels";
}

template <class Integer>
[[nodiscard]] std::string parse_in_range(const std::string& text, std::int64_t least, std::int64_t most, Integer& value) {
    std::int64_t number = 0;
    if (std::string why = parse_integer(text, number); !why.empty()) return why;
    value = static_cast<Integer>(number);
    if (number >= least && number <= most) return {};
    return "must be from " + std::to_string(least) + " to " + std::to_string(most);
}

[[nodiscard]] inline std::string parse_seed(const std::string& text, std::uint64_t& value) {
    errno = 0;
    value = is_integer(text) ? std::strtoull(text.c_str(), nullptr, 10) : 0;
    return is_integer(text) && text[0] != '-' && errno == 0 ? "" : "is not a whole number from 0 to 2^64 - 1";
}

// A decimal number.
[[nodiscard]] inline std::string parse_number(const std::string& text, double& value) {
    char* end = nullptr;
    const bool is_plain = !text.empty() && text.find_first_not_of("0123456789.eE+-") == std::string::npos;
    value = is_plain ? std::strtod(text.c_str(), &end) : 0;
    return is_plain && *end == '\0' ? "" : "is not a number";
}

// A decimal number in (0, most].
[[nodiscard]] inline std::string parse_positive(const std::string& text, int most, double& value) {
    if (std::string why = parse_number(text, value); !why.empty()) return why;
    return value > 0 && value <= most ? "" : "must be above 0 and at most " + std::to_string(most);
}

// A decimal number in [0, most].
[[nodiscard]] inline std::string parse_at_least_0(const std::string& text, int most, double& value) {
    if (std::string why = parse_number(text, value); !why.empty()) return why;
    return value >= 0 && value <= most ? "" : "must be from 0 to " + std::to_string(most);
}

// Numbers >= 0 between commas.
[[nodiscard]] inline std::string parse_weights(const std::string& text, std::vector<double>& values) {
    values.clear();
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t comma = text.find(',', from), end = comma == std::string::npos ? text.size() : comma;
        const std::string number = text.substr(from, end - from);
        double value = 0;
        if (const std::string why = parse_at_least_0(number, 1000000, value); !why.empty())
            return number == text ? why : "has '" + number + "', which " + why;
        values.push_back(value);
        from = end + 1;
    }
    const auto is_zero = [](double value) { return value == 0; };
    return std::all_of(values.begin(), values.end(), is_zero) ? "has no weight above 0" : "";
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_VALUES_HPP
