#include "job/input.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "job/sha256.hpp"
#include "writers/output_file.hpp"

namespace job {
namespace {

namespace fs = std::filesystem;

bool is_utf8(const std::string& text) {
    try {
        return !Json(text).dump().empty();
    } catch (const Json::type_error&) {
        return false;
    }
}

std::string find_identity(const std::string& path, bool hashes, std::optional<InputIdentity>& identity) {
    std::error_code code;
    identity.reset();
    if (!fs::is_regular_file(path, code)) return hashes ? "'" + path + "' is no plain file, which --hash could sum up" : "";
    identity.emplace();
    identity->bytes = fs::file_size(path, code);
    if (!code) identity->modified = static_cast<std::int64_t>(fs::last_write_time(path, code).time_since_epoch().count());
    if (code) return "cannot read '" + path + "': " + code.message();
    if (!hashes) return {};
    const std::string why = sha256_of_file(path, identity->sha256);
    return why.empty() ? "" : "cannot read '" + path + "': " + why;
}

}  // namespace

std::string find_input(const std::string& path, bool hashes, Input& input) {
    std::error_code code;
    input.path = fs::exists(path, code) ? fs::absolute(path).lexically_normal().string() : path;
    if (tool::is_part(path)) return tool::unfinished(path);
    if (!is_utf8(input.path)) return "'" + input.path + "' is no name in UTF-8, which plans are written in";
    return find_identity(input.path, hashes, input.identity);
}

std::string check_input(const std::string& path, const Input& planned) {
    if (!planned.identity) return {};
    const std::string other = not_as_planned(path);
    std::optional<InputIdentity> now;
    std::error_code code;
    if (!fs::exists(path, code)) return "cannot read '" + path + "': there is no such file" + (code ? ": " + code.message() : "");
    if (std::string why = find_identity(path, false, now); !why.empty()) return why;
    if (!now) return other + "it is no plain file";
    if (now->bytes != planned.identity->bytes)
        return other + "it has " + std::to_string(now->bytes) + " bytes, and had " + std::to_string(planned.identity->bytes);
    if (now->modified == planned.identity->modified) return {};
    if (planned.identity->sha256.empty()) return other + "it has been written since; with --hash a plan goes by its bytes";
    if (std::string why = find_identity(path, true, now); !why.empty()) return why;
    return now->sha256 == planned.identity->sha256 ? "" : other + "its bytes are others";
}

Json value_of(const Input& input) {
    Json value = {{"path", input.path}, {"bytes", nullptr}, {"modified", nullptr}, {"sha256", nullptr}};
    if (!input.identity) return value;
    value["bytes"] = input.identity->bytes;
    value["modified"] = input.identity->modified;
    if (!input.identity->sha256.empty()) value["sha256"] = input.identity->sha256;
    return value;
}

Input input_of(const Json& value) {
    Input input;
    input.path = value["path"].get<std::string>();
    if (value["bytes"].is_null()) return input;
    input.identity = InputIdentity{value["bytes"].get<std::uint64_t>(), value["modified"].get<std::int64_t>(), ""};
    if (!value["sha256"].is_null()) input.identity->sha256 = value["sha256"].get<std::string>();
    return input;
}

}  // namespace job
