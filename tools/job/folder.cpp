#include "job/folder.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "terminal/progress_watch.hpp"
#include "writers/output_file.hpp"

namespace job {

namespace fs = std::filesystem;

std::string Folder::path(const std::string& name) const { return (fs::path(path_) / name).string(); }

bool Folder::has(const std::string& name) const {
    std::error_code none;
    return fs::exists(path(name), none);
}

std::string Folder::write(const std::string& name, const void* bytes, std::size_t size, bool replaces) const {
    const std::string file = path(name), begin = "cannot write '" + file + "': ";
    std::error_code code;
    // Of the file and of the folders around it, those of the job alone: the job itself may be a link.
    fs::path part(path_);
    for (const fs::path& word : fs::path(name)) {
        part /= word;
        if (fs::is_symlink(fs::symlink_status(part, code))) return begin + "'" + part.string() + "' is a link";
    }
    fs::create_directories(part.parent_path(), code);
    if (code) return begin + code.message();
    tool::OutputFile out(file);
    if (!out.open() || !out(bytes, size)) return begin + out.error();
    if (tool::interrupted) return "interrupted; '" + file + "' is not written";
    return (replaces ? out.commit(true) : out.commit_new()) ? "" : begin + out.error();
}

std::string Folder::read(const std::string& name, std::vector<unsigned char>& bytes) const {
    const std::string file = path(name);
    bytes.clear();
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "rb"), std::fclose);
    if (!in) return "cannot read '" + file + "': " + std::strerror(errno);
    constexpr std::size_t step = std::size_t{1} << 16U;
    for (std::size_t got = step; got == step;) {
        const std::size_t before = bytes.size();
        bytes.resize(before + step);
        got = std::fread(bytes.data() + before, 1, step, in.get());
        bytes.resize(before + got);
    }
    if (std::ferror(in.get()) != 0) return "cannot read '" + file + "': " + std::strerror(errno);
    return {};
}

std::string Folder::remove(const std::string& name) const {
    std::error_code code;
    fs::remove(path(name), code);
    return code ? "cannot remove '" + path(name) + "': " + code.message() : "";
}

}  // namespace job
