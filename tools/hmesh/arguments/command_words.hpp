// tools - what a command line offers, as data: help, manual page and completions are made of it, so that they say the same.
#ifndef HMESH_TOOLS_ARGUMENTS_COMMAND_WORDS_HPP
#define HMESH_TOOLS_ARGUMENTS_COMMAND_WORDS_HPP

#include <string>
#include <vector>

namespace tool {

struct OptionWords {
    std::string group;                 // "Mesh files"
    std::vector<std::string> names;    // "-o", "--output"; none: the images
    std::string value;                 // "FILE", "FILE.png", "N"; empty: it takes none
    std::vector<std::string> choices;  // the values that there are; empty: any
    std::string description;           // lines
    bool may_repeat = false;

    [[nodiscard]] bool takes_file() const { return value.compare(0, 4, "FILE") == 0; }
};

// What is said after the options, under headings that the manual page has.
struct Note {
    const char* heading;
    const char* text;  // lines
};

struct CommandWords {
    std::string name;     // "hmesh"
    std::string version;  // "0.1.0"
    std::string summary;  // a line
    std::vector<Note> notes;
    std::vector<OptionWords> options;  // empty until they are asked for
};

// The notes as help ends with them.
[[nodiscard]] inline std::string footer(const std::vector<Note>& notes) {
    std::string out;
    for (const Note& note : notes)
        out += (out.empty() ? "" : "\n") + std::string(note.heading) + (note.text[0] == ' ' ? ":\n" : ": ") + note.text;
    return out;
}

// The description in one line, up to its first semicolon or colon outside parentheses: for completions.
[[nodiscard]] inline std::string brief(const OptionWords& option) {
    std::string out;
    int depth = 0;
    for (const char c : option.description) {
        depth += c == '(' ? 1 : c == ')' ? -1 : 0;
        if (depth == 0 && (c == ';' || c == ':')) break;
        out += c == '\n' ? ' ' : c;
    }
    return out;
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_COMMAND_WORDS_HPP
