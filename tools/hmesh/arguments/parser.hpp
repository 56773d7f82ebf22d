// tools - options of a command line as CLI11 parses them, every refusal a sentence that names the value. Included by the files
// alone that compile CLI11, one a command.
#ifndef HMESH_TOOLS_ARGUMENTS_PARSER_HPP
#define HMESH_TOOLS_ARGUMENTS_PARSER_HPP

#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "arguments/command_words.hpp"
#include "arguments/completion.hpp"
#include "arguments/man_page.hpp"
#include "arguments/named.hpp"

namespace tool {

// Takes the text of an option. Returns "" or what is wrong with it, as the end of a sentence.
using Set = std::function<std::string(const std::string& text)>;

// Adds an option with a value, which `set` takes; `choices` are all values that there are, if they are few. Where `set` finds
// something wrong, the parser throws it as a sentence. One that may repeat is set for each value in turn.
inline CLI::Option* add(CLI::App& app, const std::string& names, const char* value, const char* description, Set set,
                        const std::string& choices = {}, bool may_repeat = false) {
    const std::string name = names.substr(names.find(',') + 1);
    const auto set_all = [name, set = std::move(set), may_repeat](const CLI::results_t& texts) {
        if (texts.size() > 1 && !may_repeat) throw CLI::ValidationError(name + " is given twice");
        for (const std::string& text : texts) {
            if (text.empty()) throw CLI::ValidationError(name + " needs a value that is not empty");
            if (const std::string why = set(text); !why.empty()) throw CLI::ValidationError(name + " '" + text + "' " + why);
        }
        return true;
    };
    // The text is what help shows in place of the type: so the type's name is where the choices are kept.
    return app.add_option(names, set_all, description)->option_text(value)->type_name(choices)->take_all();
}

// The same of an option that may be given more than once.
inline CLI::Option* add_list(CLI::App& app, const std::string& names, const char* value, const char* description, Set set) {
    return add(app, names, value, description, std::move(set), {}, true);
}

// The same of an option that takes a name of the table.
template <class Value, std::size_t n, class Name>
CLI::Option* add_name(CLI::App& app, const char* option, const char* description, const Named<Value> (&table)[n], Name set) {
    return add(
        app, option, "NAME", description,
        [&table, set](const std::string& text) {
            Value value = table[0].value;
            std::string why = find_name(table, text, value);
            if (why.empty()) set(value);
            return why;
        },
        joined(names_of(table), " "));
}

// What is asked for instead of a run. Thrown by the option at once, whatever is wrong with the rest of the command line.
struct Question {
    enum class Kind : std::uint8_t { help, version, man, completion } kind;
    Shell shell = Shell::bash;
};

// --help and --version; `version_words` say what the latter prints.
inline void add_help(CLI::App& app, const char* version_words) {
    app.set_help_flag();
    app.add_flag_callback(
           "-h,--help", [] { throw Question{Question::Kind::help}; }, "print this text")
        ->trigger_on_parse();
    app.add_flag_callback(
           "--version", [] { throw Question{Question::Kind::version}; }, version_words)
        ->trigger_on_parse();
}

// --man and --completion, of a command.
inline void add_words(CLI::App& app) {
    app.add_flag_callback(
           "--man", [] { throw Question{Question::Kind::man}; }, "print the manual page, for man -l")
        ->trigger_on_parse();
    add_name(app, "--completion", "print what makes bash, zsh or fish complete command lines of this command", shells,
             [](Shell shell) {
                 throw Question{Question::Kind::completion, shell};
             })
        ->option_text("SHELL")
        ->trigger_on_parse();
}

// How help is laid out, and that what is unknown is left to parse_words().
inline void lay_out(CLI::App& app, const char* inputs) {
    app.get_formatter()->column_width(24);
    app.get_formatter()->label("Positionals", inputs);
    app.get_formatter()->label("OPTIONS", "OPTION...");
    app.get_formatter()->label("REQUIRED", "");
    app.allow_extras();
    app.option_defaults()->disable_flag_override();
}

// The help, with one empty line between groups.
[[nodiscard]] inline std::string help_of(const CLI::App& app) {
    return CLI::detail::find_and_replace(app.help(), "\n\n\n", "\n\n");
}

// The options as CLI11 has them; `repeat` are long names of those that may be given more than once, and of the inputs.
[[nodiscard]] inline std::vector<OptionWords> words_of(const CLI::App& app, const std::vector<std::string>& repeat) {
    std::vector<OptionWords> words;
    for (const CLI::Option* option : app.get_options()) {
        OptionWords entry;
        entry.group = option->get_group();
        for (const std::string& name : option->get_snames()) entry.names.push_back("-" + name);
        for (const std::string& name : option->get_lnames()) entry.names.push_back("--" + name);
        entry.value = entry.names.empty() ? option->get_name() : option->get_option_text();
        for (const std::string& choice : CLI::detail::split(option->get_type_name(), ' '))
            if (!choice.empty() && !entry.names.empty()) entry.choices.push_back(choice);
        entry.description = option->get_description();
        for (const std::string& name : repeat)
            entry.may_repeat = entry.may_repeat || option->check_lname(name) || entry.value == name;
        words.push_back(std::move(entry));
    }
    return words;
}

// The answer to a question, for which `version` is what --version prints; `repeat` as words_of() takes it.
[[nodiscard]] inline std::string answer(const CLI::App& app, const Question& question, const std::string& version,
                                        CommandWords words, const std::vector<std::string>& repeat) {
    words.options = words_of(app, repeat);
    switch (question.kind) {
        case Question::Kind::help: return help_of(app);
        case Question::Kind::version: return version;
        case Question::Kind::man: return man_page(words);
        case Question::Kind::completion: break;
    }
    return completion(words, question.shell);
}

// Parses the words after the program's name. Returns "" or what is wrong with them, a sentence: `no_input` where nothing is named
// that is to be read. What options throw that is no CLI::Error passes through.
[[nodiscard]] inline std::string parse_words(CLI::App& app, const std::vector<std::string>& words, const char* no_input) {
    // The last word first, as CLI11 takes them. It would take an input [a] for a list of one, a: ./[a] it does not.
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    for (std::string& word : reversed)
        if (word.size() > 1 && word.front() == '[' && word.back() == ']') word.insert(0, "./");
    std::string wrong;
    try {
        app.parse(reversed);
    } catch (const CLI::RequiredError&) {
        wrong = no_input;
    } catch (const CLI::ArgumentMismatch& error) {  // says "--rate: 1 required  missing" or "quiet was given a disallowed ..."
        const std::string what = error.what();
        const std::size_t colon = what.find(':');
        wrong = colon == std::string::npos ? "--" + what.substr(0, what.find(' ')) + " takes no value"
                                           : what.substr(0, colon) + " needs a value";
    } catch (const CLI::ParseError& error) {
        wrong = error.what();
    }
    for (const std::string& word : app.remaining())
        if (word != "--") wrong = "unknown option '" + word + "'";
    return wrong;
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_PARSER_HPP
