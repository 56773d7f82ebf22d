// Fuzzes the command's readers of PGM, PPM and PFM files.
#include "fuzz_reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const tool::FileKind kind = tool::kind_of({bytes, size});
    if (kind == tool::FileKind::pnm) hmesh_test::fuzz_reader(bytes, size, tool::read_pnm);
    if (kind == tool::FileKind::pfm) hmesh_test::fuzz_reader(bytes, size, tool::read_pfm);
    return 0;
}
