// tools - FileSet: which file is one that was named before, by whatever name.
#ifndef HMESH_TOOLS_WRITERS_FILE_SET_HPP
#define HMESH_TOOLS_WRITERS_FILE_SET_HPP

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "writers/output_file.hpp"

namespace tool {

// Files by any of their names. In a run of thousands of images each is looked up among all: hence by its full name, and where it
// is there already among those of its size and age alone, one of which may be the same by another link.
class FileSet {
  public:
    // The number under which this file was added, or that of no file.
    [[nodiscard]] std::size_t find(const std::string& name) const {
        if (const auto found = by_name_.find(full_name(name)); found != by_name_.end()) return found->second;
        std::error_code none;
        const auto [first, last] = by_look_.equal_range(look(name));
        for (auto other = first; other != last; ++other)
            if (std::filesystem::equivalent(name, other->second.first, none)) return other->second.second;
        return no_file;
    }
    void add(const std::string& name, std::size_t number) {
        by_name_.emplace(full_name(name), number);
        std::error_code none;
        if (std::filesystem::exists(name, none)) by_look_.emplace(look(name), std::make_pair(name, number));
    }

    static constexpr auto no_file = static_cast<std::size_t>(-1);

  private:
    using Look = std::pair<std::uintmax_t, std::filesystem::file_time_type>;

    static Look look(const std::string& name) {
        std::error_code none;
        const std::uintmax_t size = std::filesystem::file_size(name, none);
        return {size, std::filesystem::last_write_time(name, none)};
    }

    std::map<std::string, std::size_t> by_name_;
    std::multimap<Look, std::pair<std::string, std::size_t>> by_look_;
};

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_FILE_SET_HPP
