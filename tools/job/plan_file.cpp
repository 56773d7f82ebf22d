#include "job/plan_file.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "arguments/values.hpp"
#include "hmesh/core/version.hpp"
#include "job/sha256.hpp"
#include "writers/output_file.hpp"

namespace job {
namespace {

constexpr char plan_file[] = "plan.json";

// Whose bits are whose: another compiler may round otherwise, and tiles would not meet.
std::string builder() {
#if defined(__clang__)
    const std::string name = "clang " __clang_version__;
#elif defined(__GNUC__)
    const std::string name = "g++ " __VERSION__;
#elif defined(_MSC_VER)
    const std::string name = "MSVC " + std::to_string(_MSC_FULL_VER);
#else
    const std::string name = "an unknown compiler";
#endif
#ifdef __FMA__
    return name + " with FMA";
#else
    return name;
#endif
}

std::string kind_of(const std::string& program) { return "job of " + program; }

}  // namespace

std::string check_new(const Folder& folder) {
    std::error_code code;
    const std::filesystem::path path(folder.path());
    if (!std::filesystem::exists(path, code)) return {};
    if (!std::filesystem::is_directory(path, code)) return "'" + folder.path() + "' is no folder";
    // Parts are of plans that were not finished. Files are looked at first, as plan.json is the first that another plan writes.
    bool is_new = true;
    std::filesystem::directory_iterator file(path, code);
    for (; !code && file != std::filesystem::directory_iterator(); file.increment(code))
        is_new = is_new && tool::is_part(file->path().string());
    if ((!code && is_new) || folder.has(plan_file)) return {};
    return "'" + folder.path() + "' is not empty, and no job: name a new folder";
}

Json begin_plan(const std::string& program) {
    return {{"is", kind_of(program)}, {"version", HMESH_VERSION_STRING}, {"compiler", builder()}};
}

std::string write_plan(const Folder& folder, const Json& values) {
    const std::string text = checked_text(values);
    if (!folder.has(plan_file))
        if (std::string why = folder.write_new(plan_file, text); !why.empty()) return why;
    std::vector<unsigned char> before;
    if (std::string why = folder.read(plan_file, before); !why.empty()) return why;
    if (std::string(before.begin(), before.end()) == text) return {};
    return "'" + folder.path() + "' holds another plan, or its input has changed: name a new folder, or remove it";
}

std::string read_plan(const Folder& folder, const std::string& program, Json& values, std::string& identity) {
    const std::string path = folder.path(plan_file);
    std::vector<unsigned char> text;
    if (!folder.has(plan_file)) return "'" + folder.path() + "' is no job: '" + path + "' is missing";
    if (std::string why = folder.read(plan_file, text); !why.empty()) return why;
    if (!parse_checked(text, values)) return "'" + path + "' is damaged: its checksum is not that of its words";
    if (!values.contains("is") || values["is"] != kind_of(program)) return "'" + path + "' is no plan of " + program + "'s";
    const std::string made = "'" + path + "' was made by ";
    if (const std::string version = values["version"]; version != HMESH_VERSION_STRING)
        return made + program + " " + version + ", and this is " HMESH_VERSION_STRING;
    if (const std::string compiler = values["compiler"]; compiler != builder())
        return made + "an " + program + " of " + compiler + ", and this is one of " + builder() +
               ", whose tiles need not meet those of that";
    identity = sha256_of(text.data(), text.size());
    return {};
}

std::string check_output(const Folder& folder, const Input& input, const std::string& output) {
    std::error_code none;
    if (std::filesystem::equivalent(input.path, output, none)) return "'" + output + "' would overwrite the input of the job";
    const std::filesystem::path own(tool::full_name(folder.path())), to(tool::full_name(output));
    if (std::mismatch(own.begin(), own.end(), to.begin(), to.end()).first == own.end())
        return "'" + output + "' is within the job, whose files are its own: join into another place";
    for (std::filesystem::path at = to; at.has_relative_path(); at = at.parent_path()) {
        const Folder other(at.string());  // plans of other programs have no lists for engines
        if (other.has(plan_file) && other.has("parallel.sh"))
            return "'" + output + "' is within another job, '" + other.path() + "', whose files are its own";
    }
    return {};
}

std::string digits(int number, int most) {
    const std::string text = std::to_string(number);
    const std::size_t length = std::to_string(std::max(9999, most)).size();
    return std::string(length - std::min(length, text.size()), '0') + text;
}

NameParts parts_of(const std::string& name) {
    NameParts parts;
    const std::size_t first = name.find('_');
    parts.kind = name.substr(0, first);
    for (std::size_t from = first; from != std::string::npos;) {
        const std::size_t to = name.find('_', from + 1);
        const std::string text = name.substr(from + 1, to == std::string::npos ? to : to - from - 1);
        std::int64_t number = 0;
        if (!tool::parse_in_range(text, 0, 1000000000, number).empty()) return {};
        parts.numbers.push_back(static_cast<int>(number));
        from = to;
    }
    return parts;
}

}  // namespace job
