#include "job/receipt.hpp"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "job/sha256.hpp"

namespace job {
namespace {

// Values in the order and layout of the file, without `check`.
std::string text_of(const Json& values) { return values.dump(1, ' ', false, Json::error_handler_t::replace); }

std::string size_fault(const std::string& path, std::uint64_t has, std::uint64_t wants) {
    return "'" + path + "' is damaged: it has " + std::to_string(has) + " bytes of " + std::to_string(wants);
}

std::string sum_fault(const std::string& path) { return "'" + path + "' is damaged: its bytes are not those that were written"; }

}  // namespace

std::string receipt_of(const std::string& task) { return "done/" + task + ".json"; }

std::string checked_text(const Json& values) {
    Json all = values;
    const std::string text = text_of(values);
    all["check"] = sha256_of(text.data(), text.size());
    return text_of(all) + "\n";
}

bool parse_checked(const std::vector<unsigned char>& text, Json& values) {
    values = Json::parse(text.begin(), text.end(), nullptr, false);
    if (!values.is_object() || !values.contains("check") || !values["check"].is_string()) return false;
    const auto check = values["check"].get<std::string>();
    values.erase("check");
    const std::string rest = text_of(values);
    return check == sha256_of(rest.data(), rest.size());
}

std::string words_of(const Json& fact) {
    if (fact.is_string()) return fact.get<std::string>();
    if (!fact.is_number_float()) return fact.dump();
    char text[512];  // 1.8e308 has 309 digits
    std::snprintf(text, sizeof text, "%.2f", fact.get<double>());
    return text;
}

std::string write_receipt(const Folder& folder, const std::string& plan, const std::string& task, const std::vector<Made>& made,
                          const Json& facts) {
    Json files = Json::array();
    for (const Made& file : made) files.push_back({{"name", file.name}, {"bytes", file.bytes}, {"sha256", file.sha256}});
    return folder.write(receipt_of(task), checked_text({{"plan", plan}, {"task", task}, {"files", files}, {"facts", facts}}));
}

Done find_done(const Folder& folder, const std::string& plan, const std::string& task, Look look, Json& facts) {
    Done done;
    facts = Json();
    const std::string path = folder.path(receipt_of(task));
    const auto is = [&](Found found, const std::string& why) {
        done.found = found;
        done.why = why;
        return done;
    };
    if (!folder.has(receipt_of(task))) return is(Found::nothing, "'" + path + "' is missing: the task " + task + " is not done");
    std::vector<unsigned char> text;
    if (const std::string why = folder.read(receipt_of(task), text); !why.empty()) return is(Found::damaged, why);
    Json receipt;
    // Of a receipt that is as it was written, all values are of their kinds.
    if (!parse_checked(text, receipt) || !receipt.contains("plan") || !receipt.contains("files"))
        return is(Found::damaged, "'" + path + "' is damaged");
    if (receipt["plan"] != plan) return is(Found::foreign, "'" + path + "' is of another plan");
    if (receipt["task"] != task) return is(Found::foreign, "'" + path + "' is of another task");
    for (const Json& file : receipt["files"]) {
        done.made.push_back(
            {file["name"].get<std::string>(), file["sha256"].get<std::string>(), file["bytes"].get<std::uint64_t>()});
        const Made& made = done.made.back();
        std::error_code code;
        const std::string name = folder.path(made.name);
        const std::uintmax_t bytes = std::filesystem::file_size(name, code);
        if (code) return is(Found::damaged, "'" + name + "' is missing, which the task " + task + " made");
        if (bytes != made.bytes) return is(Found::damaged, size_fault(name, bytes, made.bytes));
        if (look == Look::sizes) continue;
        std::string sum;
        if (const std::string why = sha256_of_file(name, sum); !why.empty())
            return is(Found::damaged, "cannot read '" + name + "': " + why);
        if (sum != made.sha256) return is(Found::damaged, sum_fault(name));
    }
    facts = receipt["facts"];
    return is(Found::whole, "");
}

std::string read_made(const Folder& folder, const Made& made, std::vector<unsigned char>& bytes) {
    if (std::string why = folder.read(made.name, bytes); !why.empty()) return why;
    if (bytes.size() != made.bytes) return size_fault(folder.path(made.name), bytes.size(), made.bytes);
    return sha256_of(bytes.data(), bytes.size()) == made.sha256 ? "" : sum_fault(folder.path(made.name));
}

std::string write_made(const Folder& folder, const std::string& name, const void* bytes, std::size_t size, Made& made) {
    made = {name, sha256_of(bytes, size), size};
    return folder.write(name, bytes, size);
}

}  // namespace job
