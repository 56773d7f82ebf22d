// Fuzzes the command's reader of PNG files. Most are given the check sums that they should have, behind which nothing would be
// reached otherwise.
#include "fuzz_reading.hpp"

namespace {

void mend_sums(std::vector<std::uint8_t>& file) {
    for (std::size_t at = 8; at + 12 <= file.size();) {
        const std::size_t size = tool::Bytes{file.data(), file.size()}.be32(at);
        if (size > file.size() - at - 12) return;
        std::uint32_t crc = 0xffffffffU;
        for (std::size_t k = at + 4; k < at + 8 + size; ++k) {
            crc ^= file[k];
            for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xedb88320U ^ crc >> 1U : crc >> 1U;
        }
        for (std::size_t k = 0; k < 4; ++k) file[at + 8 + size + k] = static_cast<std::uint8_t>(~crc >> (24 - 8 * k));
        at += size + 12;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    std::vector<std::uint8_t> file(bytes, bytes + size);
    if (size % 8 != 0) mend_sums(file);
    hmesh_test::fuzz_reader(file.data(), file.size(), tool::read_png);
    return 0;
}
