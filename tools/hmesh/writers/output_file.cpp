#include "writers/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "terminal/standard_streams.hpp"

#ifndef _WIN32
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace tool {

namespace fs = std::filesystem;

namespace {

#ifdef _WIN32
// A new file of this name; else null, errno EEXIST where there is one.
std::FILE* open_part(const std::string& name) { return std::fopen(name.c_str(), "wbx"); }
#else
// Whether `file` is a plain file of this user's, of that name and no other.
bool is_ours(int file, const std::string& name) {
    struct stat opened, named;
    return ::fstat(file, &opened) == 0 && ::lstat(name.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino && S_ISREG(opened.st_mode) && opened.st_nlink == 1 && opened.st_uid == ::geteuid();
}

// A new file of this name, or one that a program left behind which was killed; else null, errno EEXIST where another program
// writes it now. Who writes holds the file's lock, which ends with the program, however it ends.
std::FILE* open_part(const std::string& name) {
    int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    const bool is_new = file >= 0, is_taken = !is_new && errno == EEXIST;
    if (is_taken) file = ::open(name.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) {
        if (is_taken && (errno == ENOENT || errno == ELOOP || errno == EACCES)) errno = EEXIST;
        return nullptr;
    }
    const bool is_locked = ::flock(file, LOCK_EX | LOCK_NB) == 0;
    // Where there are no locks, as on some network drives, a new file is safe enough. One that another program has just renamed
    // or removed is not of this name any more.
    const bool is_free = is_locked || (is_new && errno != EWOULDBLOCK);
    if (is_free && is_ours(file, name) && ::ftruncate(file, 0) == 0)
        if (std::FILE* const stream = ::fdopen(file, "wb"); stream != nullptr) return stream;
    ::close(file);
    errno = EEXIST;
    return nullptr;
}
#endif

// Keeps the lock of a file that is closed, while this stands: until the file has its name or is gone, no other program may take
// it for one that was left behind.
class KeptLock {
  public:
#ifdef _WIN32
    explicit KeptLock(std::FILE* /*file*/) {}  // there are none
#else
    explicit KeptLock(std::FILE* file) : lock_(file != nullptr ? ::fcntl(::fileno(file), F_DUPFD_CLOEXEC, 0) : -1) {}
    ~KeptLock() {
        if (lock_ >= 0) ::close(lock_);
    }
#endif
    KeptLock(const KeptLock&) = delete;
    KeptLock& operator=(const KeptLock&) = delete;

  private:
#ifndef _WIN32
    int lock_;
#endif
};

// Has the disk take all that was written to the file.
bool put_on_disk([[maybe_unused]] std::FILE* file) {
#ifdef _WIN32
    return std::fflush(file) == 0;
#else
    return std::fflush(file) == 0 && ::fsync(::fileno(file)) == 0;
#endif
}

// The same of the names in the folder of a file, where the system lets a program ask for it: what it refuses is no failure, for
// the file is there.
void put_names_on_disk([[maybe_unused]] const std::string& file) {
#ifndef _WIN32
    const std::string folder = fs::path(file).parent_path().string();
    const int names = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
    if (names < 0) return;
    static_cast<void>(::fsync(names));
    ::close(names);
#endif
}

// Whether it is a link, but not to a file.
bool leads_nowhere(const std::string& path) {
    std::error_code none;
    return !fs::exists(path, none) && fs::is_symlink(fs::symlink_status(path, none));
}

constexpr char part_ending[] = ".hmesh-part";

// The file beside a target: as names have at most 255 bytes, that of a longer one begins with its first characters.
std::string part_name(const std::string& target, int number) {
    const fs::path path(target);
    std::string name = path.filename().string();
    constexpr std::size_t most = 240;
    if (name.size() > most) {
        std::size_t end = most;
        while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0U) == 0x80U) --end;  // within a character of UTF-8
        name.resize(end);
    }
    return (path.parent_path() / (name + part_ending + std::to_string(number))).string();
}

}  // namespace

bool is_part(const std::string& name) {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    const std::size_t length = sizeof part_ending - 1;
    return digits != 0 && digits < name.size() && digits >= length && name.compare(digits - length, length, part_ending) == 0;
}

std::string end_of_links(std::string path) {
    std::error_code none;
    for (int links = 0; links < 40 && leads_nowhere(path); ++links)
        path = (fs::path(path).parent_path() / fs::read_symlink(path, none)).string();
    return path;
}

std::string full_name(const std::string& path) {
    std::error_code none;
    const std::string found = fs::weakly_canonical(fs::absolute(end_of_links(path), none), none).string();
    return found.empty() ? path : found;
}

OutputFile::OutputFile(std::string path) : target_(std::move(path)), is_standard_(is_standard(target_)) {
    if (is_standard_) return;
    std::error_code none;
    target_ = end_of_links(std::move(target_));
    const fs::file_status status = fs::status(target_, none);
    if (leads_nowhere(target_)) refusal_ = ELOOP;
    if (fs::is_directory(status)) refusal_ = EISDIR;
    in_place_ = fs::exists(status) && !fs::is_regular_file(status);
    if (fs::is_regular_file(status)) {
        const fs::path real = fs::canonical(target_, none);
        if (!none) target_ = real.string();
    }
}

bool OutputFile::is_writable() {
    if (is_standard_ || (in_place_ && refusal_ == 0)) return true;
    const bool opened = open();
    discard();
    return opened;
}

bool OutputFile::open() {
    error_.clear();
    reason_ = 0;
    if (refusal_ != 0) return fail(refusal_);
    errno = 0;
    if (is_standard_) {
        set_binary(stdout);
        file_ = stdout;
        return true;
    }
    if (in_place_) {
        file_ = std::fopen(target_.c_str(), "wb");
        return file_ != nullptr || fail(errno);
    }
    if (!may_replace()) return fail(errno);
    for (int number = 0; number < 100 && file_ == nullptr; ++number) {
        const std::string name = part_name(target_, number);
        errno = 0;
        file_ = open_part(name);
        if (file_ != nullptr) temporary_ = name;
        if (file_ == nullptr && errno != EEXIST) break;
    }
    return file_ != nullptr || fail(errno);
}

bool OutputFile::operator()(const void* bytes, std::size_t size) {
    if (size == 0) return true;
    errno = 0;
    return std::fwrite(bytes, 1, size, file_) == size || fail(errno);
}

bool OutputFile::flush() {
    errno = 0;
    return std::fflush(file_) == 0 || fail(errno);
}

bool OutputFile::commit(bool is_lasting, bool replaces) {
    errno = 0;
    std::FILE* file = file_;
    file_ = nullptr;
    if (is_standard_) return std::fflush(file) == 0 || fail(errno);
    const bool is_kept = !is_lasting || in_place_ || put_on_disk(file);
    const int refused = errno;
    [[maybe_unused]] const KeptLock lock(file);
    if (std::fclose(file) != 0 || !is_kept) {
        const int why = is_kept ? errno : refused;
        discard();
        return fail(why);
    }
    if (in_place_) return true;
    std::error_code code;
    const fs::file_status replaced = fs::status(target_, code);
    if (fs::exists(replaced)) fs::permissions(temporary_, replaced.permissions(), code);
    if (!replaces) {
        fs::create_hard_link(temporary_, target_, code);
        if (!code || code == std::errc::file_exists) {
            discard();
            put_names_on_disk(target_);
            return true;
        }
    }  // elsewhere there are no such links
    fs::rename(temporary_, target_, code);
    if (!code) {
        temporary_.clear();
        if (is_lasting) put_names_on_disk(target_);
        return true;
    }
    discard();
    return fail(code.value());
}

// A target that exists is replaced only if it could be written.
bool OutputFile::may_replace() const {
    std::error_code none;
    if (!fs::exists(target_, none)) return true;
    std::FILE* existing = std::fopen(target_.c_str(), "r+b");
    if (existing == nullptr) return false;
    std::fclose(existing);
    return true;
}

void OutputFile::discard() {
    [[maybe_unused]] const KeptLock lock(is_standard_ ? nullptr : file_);
    if (file_ != nullptr && !is_standard_) std::fclose(file_);
    if (!temporary_.empty()) static_cast<void>(std::remove(temporary_.c_str()));
    file_ = nullptr;
    temporary_.clear();
}

bool OutputFile::fail(int why) {
    reason_ = why;
    error_ = why != 0 ? std::strerror(why) : "unknown error";
    return false;
}

}  // namespace tool
