// tools - values of options that have names, as tables, and lists of names.
#ifndef HMESH_TOOLS_ARGUMENTS_NAMED_HPP
#define HMESH_TOOLS_ARGUMENTS_NAMED_HPP

#include <cstddef>
#include <string>
#include <vector>

namespace tool {

template <class Value>
struct Named {
    const char* name;
    Value value;
};

template <class Value, std::size_t n>
[[nodiscard]] const char* name_of(const Named<Value> (&table)[n], Value value) {
    for (const Named<Value>& entry : table)
        if (entry.value == value) return entry.name;
    return "?";
}

[[nodiscard]] inline std::string joined(const std::vector<std::string>& names, const char* between) {
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? "" : between) + name;
    return out;
}

template <class Value, std::size_t n>
[[nodiscard]] std::vector<std::string> names_of(const Named<Value> (&table)[n]) {
    std::vector<std::string> names;
    for (const Named<Value>& entry : table) names.emplace_back(entry.name);
    return names;
}

// Returns "" or what is wrong with the text, as the end of a sentence.
template <class Value, std::size_t n>
[[nodiscard]] std::string find_name(const Named<Value> (&table)[n], const std::string& text, Value& value) {
    for (const Named<Value>& entry : table)
        if (text == entry.name) {
            value = entry.value;
            return {};
        }
    return "is not one of: " + joined(names_of(table), ", ");
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_NAMED_HPP
