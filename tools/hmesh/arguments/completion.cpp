#include "arguments/completion.hpp"

#include <algorithm>
#include <vector>

#include "arguments/named.hpp"

namespace tool {
namespace {

// With a backslash before each of `special`.
std::string escaped(const std::string& text, const char* special) {
    std::string out;
    for (const char c : text) {
        if (std::string(special).find(c) != std::string::npos) out += '\\';
        out += c;
    }
    return out;
}

// Between single quotes of a shell in which nothing but a quote means anything there: it ends, is told, and begins again.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return text;
}

std::string first_line(const CommandWords& words, const std::string& shell) {
    return "# Completion of " + words.name + " for " + shell + ": the output of `" + words.name + " --completion " + shell +
           "`.\n";
}

// A name that any shell takes for a function.
std::string function_of(const CommandWords& words) {
    std::string name = "_" + words.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

// Bash makes --effort=dr three words. Where nothing is offered and readline may, it completes names of files.
std::string bash(const CommandWords& words) {
    std::string names, choices, numbers, files;
    for (const OptionWords& option : words.options) {
        if (option.names.empty()) continue;
        names += (names.empty() ? "" : " ") + joined(option.names, " ");
        const std::string either = joined(option.names, "|");
        if (!option.choices.empty())
            choices += "    " + either + ") COMPREPLY=($(compgen -W " + quoted(joined(option.choices, " ")) +
                       " -- \"$word\")); compopt +o default 2>/dev/null; return ;;\n";
        else if (option.takes_file()) files += (files.empty() ? "" : "|") + either;
        else if (!option.value.empty()) numbers += (numbers.empty() ? "" : "|") + either;
    }
    const std::string function = function_of(words);
    return first_line(words, "bash") + function +
           "() {\n"
           "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
           "    COMPREPLY=()\n"
           "    if [[ $word == = ]]; then\n"
           "        word=\n"
           "    elif [[ $before == = ]]; then\n"
           "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
           "    fi\n"
           "    case $before in\n" +
           choices + "    " + numbers + ") compopt +o default 2>/dev/null; return ;;\n    " + files +
           ") return ;;\n"
           "    esac\n"
           "    if [[ $word == -* ]]; then\n"
           "        COMPREPLY=($(compgen -W " +
           quoted(names) +
           " -- \"$word\"))\n"
           "    fi\n"
           "}\n"
           "complete -o default -F " +
           function + " " + words.name + "\n";
}

std::string zsh(const CommandWords& words) {
    std::string specs, inputs;
    for (const OptionWords& option : words.options) {
        const std::string what = escaped(brief(option), "[]:\\");
        std::string action;
        if (!option.value.empty()) action = ":" + escaped(option.value, ":\\") + ":";
        if (!option.choices.empty()) action += "(" + joined(option.choices, " ") + ")";
        else if (option.takes_file()) action += "_files";
        else if (!option.value.empty()) action += " ";
        if (option.names.empty()) {
            inputs = "    " + quoted((option.may_repeat ? "*:" : "1:") + lower(option.value) + ":_files") + "\n";
            continue;
        }
        // An option that was given is offered no more, under none of its names.
        const std::string others = option.may_repeat ? "*" : "(" + joined(option.names, " ") + ")";
        for (const std::string& name : option.names) {
            const bool is_long = name.size() > 2;
            const std::string tie = option.value.empty() ? "" : is_long ? "=" : "+";
            specs += "    " + quoted(others + name + tie + "[" + what + "]" + action) + " \\\n";
        }
    }
    return "#compdef " + words.name + "\n" + first_line(words, "zsh") + "_arguments -S -s \\\n" + specs + inputs;
}

std::string fish(const CommandWords& words) {
    std::string out = first_line(words, "fish");
    const auto in_quotes = [](const std::string& text) { return "'" + escaped(text, "'\\") + "'"; };
    for (const OptionWords& option : words.options) {
        if (option.names.empty()) continue;
        out += "complete -c " + words.name;
        for (const std::string& name : option.names) out += name.size() > 2 ? " -l " + name.substr(2) : " -s " + name.substr(1);
        if (!option.choices.empty()) out += " -x -a " + in_quotes(joined(option.choices, " "));
        else if (option.takes_file()) out += " -r -F";
        else if (!option.value.empty()) out += " -x";
        out += " -d " + in_quotes(brief(option)) + "\n";
    }
    return out;
}

}  // namespace

std::string completion(const CommandWords& words, Shell shell) {
    switch (shell) {
        case Shell::bash: return bash(words);
        case Shell::zsh: return zsh(words);
        case Shell::fish: break;
    }
    return fish(words);
}

}  // namespace tool
