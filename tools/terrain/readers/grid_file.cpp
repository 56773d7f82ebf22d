#include "terrain/readers/grid_file.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>

#include "readers/bytes.hpp"
#include "readers/readers.hpp"

namespace terrain {
namespace {

bool seek(std::FILE* file, std::int64_t at) {
#ifdef _WIN32
    return _fseeki64(file, at, SEEK_SET) == 0;
#else
    return ::fseeko(file, static_cast<off_t>(at), SEEK_SET) == 0;
#endif
}

float sample(const tool::Bytes& row, std::size_t k, SampleType type) {
    switch (type) {
        case SampleType::u8: return static_cast<float>(row.u8(k));
        case SampleType::u16_big: return static_cast<float>(row.be16(2 * k));
        case SampleType::u16_little: return static_cast<float>(row.le16(2 * k));
        case SampleType::i16_big: return static_cast<float>(static_cast<std::int16_t>(row.be16(2 * k)));
        case SampleType::i16_little: return static_cast<float>(static_cast<std::int16_t>(row.le16(2 * k)));
        case SampleType::f32_little: break;
    }
    const std::uint32_t word = row.le32(4 * k);
    float value = 0;
    std::memcpy(&value, &word, 4);
    return value;
}

}  // namespace

std::string GridFile::open(const std::string& path) {
    errno = 0;
    file_.reset(std::fopen(path.c_str(), "rb"));
    if (!file_) return std::strerror(errno);
    std::error_code code;
    const std::uintmax_t bytes = std::filesystem::file_size(path, code);
    if (code) return code.message();
    if (bytes == 0) return "the file is empty";
    size_ = static_cast<std::int64_t>(bytes);
    reader = "hmesh";
    return {};
}

std::string GridFile::check() const {
    const std::int64_t needs = offset + bytes_of(type) * width * height;
    return size_ < needs ? tool::too_short(static_cast<std::size_t>(size_), static_cast<std::size_t>(needs)) : "";
}

std::string GridFile::begin(std::size_t count, std::vector<unsigned char>& bytes) {
    bytes.resize(static_cast<std::size_t>(std::min<std::int64_t>(static_cast<std::int64_t>(count), size_)));
    return read_bytes(0, bytes.size(), bytes.data());
}

std::string GridFile::read(int x, int y, int columns, int rows, float* heights, double& rounding) {
    rounding = 0;
    const std::int64_t each = bytes_of(type);
    std::vector<unsigned char> bytes(static_cast<std::size_t>(each * columns));
    const bool has_maximum = type == SampleType::u8 || type == SampleType::u16_big;
    for (int j = y; j < y + rows; ++j) {
        const std::int64_t at = offset + each * (static_cast<std::int64_t>(width) * j + x);
        if (std::string why = read_bytes(at, bytes.size(), bytes.data()); !why.empty()) return why;
        const tool::Bytes row{bytes.data(), bytes.size()};
        for (std::size_t k = 0; k < static_cast<std::size_t>(columns); ++k) {
            const float value = sample(row, k, type);
            if (has_maximum && value > static_cast<float>(maximum))
                return "it has a sample above the maximum of its header (" + std::to_string(static_cast<int>(value)) +
                       ", limit " + std::to_string(maximum) + ")";
            const bool is_none = !std::isfinite(value) || is_no_data(static_cast<double>(value), no_data);
            *heights++ = is_none ? std::numeric_limits<float>::quiet_NaN() : value;
        }
    }
    return {};
}

std::string GridFile::read_bytes(std::int64_t at, std::size_t count, unsigned char* bytes) {
    errno = 0;
    if (!seek(file_.get(), at)) return std::strerror(errno);
    if (std::fread(bytes, 1, count, file_.get()) == count) return {};
    return std::ferror(file_.get()) != 0 ? std::string(std::strerror(errno))
                                         : tool::too_short(static_cast<std::size_t>(size_), static_cast<std::size_t>(at) + count);
}

}  // namespace terrain
