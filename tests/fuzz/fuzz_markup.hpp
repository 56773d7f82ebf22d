// hmesh tests - reads XML, or the HTML that write_html() writes, tag by tag, and ends the program where it is not well formed.
#ifndef HMESH_TESTS_FUZZ_FUZZ_MARKUP_HPP
#define HMESH_TESTS_FUZZ_FUZZ_MARKUP_HPP

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "fuzz_input.hpp"
#include "fuzz_text.hpp"

namespace hmesh_test {

struct Tag {
    std::string name;
    std::vector<std::pair<std::string, std::string>> attributes;
    std::string content;  // of <script> and <style>

    [[nodiscard]] std::string attribute(const char* which) const {
        for (const auto& [key, value] : attributes)
            if (key == which) return value;
        return {};
    }
};

namespace detail {

[[nodiscard]] inline bool is_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == ':';
}

inline std::string read_name(FuzzText& text) {
    std::string name;
    for (; is_name(text.next()); text.skip(1)) name += text.next();
    demand(!name.empty(), "a name");
    return name;
}

// Text between tags or in quotes: what means something is written as an entity.
inline void demand_escaped(const std::string& text) {
    demand(text.find('<') == std::string::npos, "< is escaped");
    for (std::size_t at = text.find('&'); at != std::string::npos; at = text.find('&', at + 1)) {
        std::size_t end = at + 1;
        if (end < text.size() && text[end] == '#') ++end;
        while (end < text.size() && is_name(text[end])) ++end;
        demand(end > at + 1 && end < text.size() && text[end] == ';', "& is escaped");
    }
}

}  // namespace detail

// Calls on_tag(const Tag&) for each start tag, in order. Returns the text outside of tags.
template <class OnTag>
std::string read_markup(const std::string& file, bool is_html, const OnTag& on_tag) {
    FuzzText text(file);
    std::vector<std::string> open;
    std::string outside;
    while (text.left() > 0) {
        if (text.next() != '<') {
            const std::size_t end = std::min(file.size(), file.find('<', text.at()));
            outside.append(file, text.at(), end - text.at());
            text.skip(end - text.at());
            continue;
        }
        text.expect("<");
        if (text.accept("!--")) {
            static_cast<void>(text.until("-->"));
        } else if (text.accept("!")) {
            static_cast<void>(text.until(">"));
        } else if (text.accept("/")) {
            const std::string name = detail::read_name(text);
            demand(!open.empty() && open.back() == name, "tags are closed in turn");
            open.pop_back();
            text.expect(">");
        } else {
            Tag tag;
            tag.name = detail::read_name(text);
            bool is_closed = false;
            for (;;) {
                while (text.next() == ' ' || text.next() == '\n') text.skip(1);
                is_closed = text.accept("/>");
                if (is_closed || text.accept(">")) break;
                auto& [key, value] = tag.attributes.emplace_back(detail::read_name(text), "");
                for (const auto& other : tag.attributes) demand(&other.first == &key || other.first != key, "an attribute once");
                if (is_html && text.next() != '=') continue;
                if (is_html && !text.accept("=\"")) {
                    text.expect("=");
                    value = detail::read_name(text);
                    continue;
                }
                if (!is_html) text.expect("=\"");
                value = text.until("\"");
                detail::demand_escaped(value);
            }
            if (is_html && (tag.name == "script" || tag.name == "style")) {
                tag.content = text.until(("</" + tag.name + ">").c_str());
            } else if (!is_closed && !(is_html && (tag.name == "meta" || tag.name == "img" || tag.name == "input"))) {
                open.push_back(tag.name);
            }
            on_tag(tag);
        }
    }
    demand(open.empty(), "all tags are closed");
    detail::demand_escaped(outside);
    return outside;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_MARKUP_HPP
