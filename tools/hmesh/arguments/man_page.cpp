#include "arguments/man_page.hpp"

#include <algorithm>

namespace tool {
namespace {

// Text that means nothing to roff: a hyphen is a minus, to be copied, and no line begins with a request.
std::string plain(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const bool begins_line = out.empty() || out.back() == '\n';
        if (begins_line && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\') out += "\\e";
        else if (c == '-') out += "\\-";
        else if (c == '\'') out += "\\(aq";
        else if (c == '^') out += "\\(ha";
        else if (c == '~') out += "\\(ti";
        else if (c == '`') out += "\\(ga";
        else out += c;
    }
    return out;
}

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
    return text;
}

// Help has it behind a colon, the page under a heading.
std::string as_sentence(const std::string& text) { return upper(text.substr(0, 1)) + text.substr(1); }

// As whatis has it: no sentence.
std::string in_list(std::string text) {
    if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') text[0] = static_cast<char>(text[0] + 32);
    return text;
}

// Lines that are indented stay as they are, others are filled.
std::string paragraphs(const std::string& text) {
    std::string out;
    bool is_verbatim = false;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::size_t first = std::min(text.find_first_not_of(' ', at), end);
        const bool is_indented = first != at;
        if (is_indented != is_verbatim) out += is_indented ? ".PP\n.nf\n.RS 4\n" : ".RE\n.fi\n.PP\n";
        is_verbatim = is_indented;
        out += plain(text.substr(first, end - first)) + "\n";
        at = end + 1;
    }
    return is_verbatim ? out + ".RE\n.fi\n" : out;
}

std::string option_entry(const OptionWords& option) {
    std::string head;
    for (const std::string& name : option.names) head += (head.empty() ? "\\fB" : ", \\fB") + plain(name) + "\\fR";
    if (option.names.empty()) head = "\\fI" + plain(option.value) + "\\fR";
    else if (!option.value.empty()) head += " \\fI" + plain(option.value) + "\\fR";
    return ".TP\n" + head + "\n" + plain(option.description) + "\n";
}

}  // namespace

std::string man_page(const CommandWords& words) {
    const std::string name = plain(words.name);
    std::string inputs, group;
    for (const OptionWords& option : words.options)
        if (option.names.empty()) inputs += ".IR " + plain(option.value) + (option.may_repeat ? " ...\n" : "\n");
    std::string out = ".TH " + upper(name) + " 1 \"\" \"hmesh " + plain(words.version) + "\" \"User Commands\"\n.SH NAME\n" +
                      name + " \\- " + plain(in_list(words.summary)) + "\n.SH SYNOPSIS\n.B " + name + "\n.RI [ OPTION ...]\n" +
                      inputs + ".SH DESCRIPTION\n";
    for (const OptionWords& option : words.options) {
        if (option.names.empty()) {
            out += option_entry(option) + ".SH OPTIONS\n";
            continue;
        }
        if (option.group != group) out += ".SS " + plain(option.group) + "\n";
        group = option.group;
        out += option_entry(option);
    }
    for (const Note& note : words.notes) out += ".SH " + plain(upper(note.heading)) + "\n" + paragraphs(as_sentence(note.text));
    return out;
}

}  // namespace tool
