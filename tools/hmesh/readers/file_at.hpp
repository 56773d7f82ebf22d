// tools - FileAt: bytes of a file from any place in it, by several threads at once.
#ifndef HMESH_TOOLS_READERS_FILE_AT_HPP
#define HMESH_TOOLS_READERS_FILE_AT_HPP

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <mutex>
#include <string>

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <unistd.h>
#endif

namespace tool {

class FileAt {
  public:
    FileAt() = default;
    FileAt(const FileAt&) = delete;
    FileAt& operator=(const FileAt&) = delete;

#if defined(__unix__) || defined(__APPLE__)
    ~FileAt() {
        if (file_ >= 0) ::close(file_);
    }
    // Returns "" or why the file cannot be opened.
    [[nodiscard]] std::string open(const std::string& path) {
        file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        if (file_ < 0) return std::strerror(errno);
        const off_t end = ::lseek(file_, 0, SEEK_END);
        if (end < 0) return std::strerror(errno);
        size_ = static_cast<std::uint64_t>(end);
        return {};
    }
    // Reads `count` bytes from `place` on, or says why it cannot.
    [[nodiscard]] std::string read(std::uint64_t place, std::size_t count, void* to) const {
        auto* at = static_cast<unsigned char*>(to);
        while (count > 0) {
            const ssize_t got = ::pread(file_, at, count, static_cast<off_t>(place));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) return got < 0 ? std::strerror(errno) : "the file has become shorter";
            at += got;
            place += static_cast<std::uint64_t>(got);
            count -= static_cast<std::size_t>(got);
        }
        return {};
    }
#else
    [[nodiscard]] std::string open(const std::string& path) {
        errno = 0;
        file_.open(path, std::ios::binary);
        if (!file_) return std::strerror(errno != 0 ? errno : ENOENT);
        file_.seekg(0, std::ios::end);
        size_ = static_cast<std::uint64_t>(file_.tellg());
        return {};
    }
    [[nodiscard]] std::string read(std::uint64_t place, std::size_t count, void* to) const {
        const std::lock_guard<std::mutex> lock(mutex_);
        errno = 0;
        file_.clear();
        file_.seekg(static_cast<std::streamoff>(place));
        if (file_.read(static_cast<char*>(to), static_cast<std::streamsize>(count))) return {};
        return file_.eof() ? "the file has become shorter" : std::strerror(errno != 0 ? errno : EIO);
    }
#endif
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }  // bytes, when it was opened

  private:
#if defined(__unix__) || defined(__APPLE__)
    int file_ = -1;
#else
    mutable std::mutex mutex_;
    mutable std::ifstream file_;
#endif
    std::uint64_t size_ = 0;
};

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_FILE_AT_HPP
