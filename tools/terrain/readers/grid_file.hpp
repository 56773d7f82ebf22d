// hmesh-terrain - GridFile: a file that holds samples of one type row after row, from some byte on; windows are read from it.
// What raw files, .hgt and .pgm are.
#ifndef HMESH_TERRAIN_READERS_GRID_FILE_HPP
#define HMESH_TERRAIN_READERS_GRID_FILE_HPP

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "terrain/dem.hpp"

namespace terrain {

enum class SampleType : std::uint8_t { u8, u16_big, u16_little, i16_big, i16_little, f32_little };

[[nodiscard]] constexpr std::int64_t bytes_of(SampleType type) noexcept {
    return type == SampleType::u8 ? 1 : type == SampleType::f32_little ? 4 : 2;
}

class GridFile : public Dem {
  public:
    // Opens it and takes its size. The caller says then what it holds, all that is public here and in Dem.
    [[nodiscard]] std::string open(const std::string& path);
    // Whether it has all samples.
    [[nodiscard]] std::string check() const;

    [[nodiscard]] std::int64_t size() const noexcept { return size_; }
    // The first bytes, so many at most.
    [[nodiscard]] std::string begin(std::size_t count, std::vector<unsigned char>& bytes);

    [[nodiscard]] std::string read(int x, int y, int columns, int rows, float* heights, double& rounding) override;

    SampleType type = SampleType::u8;
    std::int64_t offset = 0;        // of the first sample, in bytes
    std::uint32_t maximum = 65535;  // of u8 and u16_big: larger samples are damage

  private:
    [[nodiscard]] std::string read_bytes(std::int64_t at, std::size_t count, unsigned char* bytes);

    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, std::fclose};
    std::int64_t size_ = 0;
};

// Whether the height stands for none. Both as floats too, for a file's text may say -3.4e38 in few digits. NaN equals no height,
// and readers take it for none in any case.
[[nodiscard]] inline bool is_no_data(double height, const std::optional<double>& no_data) noexcept {
    if (!no_data || std::isnan(*no_data)) return false;
    const auto equal = [](auto a, auto b) { return !(a < b) && !(b < a); };
    return equal(height, *no_data) || equal(static_cast<float>(height), static_cast<float>(*no_data));
}

}  // namespace terrain

#endif  // HMESH_TERRAIN_READERS_GRID_FILE_HPP
