// Fuzzes the command's reader of WebP files.
#include "fuzz_reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::fuzz_reader(bytes, size, tool::read_webp);
    return 0;
}
