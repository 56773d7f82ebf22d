// Fuzzes the command's reader of BMP files.
#include "fuzz_reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::fuzz_reader(bytes, size, tool::read_bmp);
    return 0;
}
