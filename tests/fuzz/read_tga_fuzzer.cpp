// Fuzzes the command's reader of TGA files.
#include "fuzz_reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    // What begins as another format does never comes to this reader: stb_image would take it for that.
    if (tool::kind_of({bytes, size}) == tool::FileKind::tga) hmesh_test::fuzz_reader(bytes, size, tool::read_tga);
    return 0;
}
