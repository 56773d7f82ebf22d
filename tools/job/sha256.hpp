// job - Sha256: the checksum of a job's files, FIPS 180-4: what sha256sum prints.
//
// Some 200 MB a second: less than a thousandth of what it takes to mesh what is summed up.
#ifndef HMESH_JOB_SHA256_HPP
#define HMESH_JOB_SHA256_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace job {

class Sha256 {
  public:
    void add(const void* bytes, std::size_t size);
    // The sum of all that was added, as 64 hexadecimal digits. Ends the sum: nothing may be added after it.
    [[nodiscard]] std::string hex();

  private:
    void add_block(const unsigned char* block);

    std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<unsigned char, 64> block_{};
    std::uint64_t size_ = 0;  // bytes added
};

[[nodiscard]] inline std::string sha256_of(const void* bytes, std::size_t size) {
    Sha256 sum;
    sum.add(bytes, size);
    return sum.hex();
}

// Of a file as it is. Returns "" or why it cannot be read, as the end of a sentence.
[[nodiscard]] std::string sha256_of_file(const std::string& path, std::string& hex);

}  // namespace job

#endif  // HMESH_JOB_SHA256_HPP
