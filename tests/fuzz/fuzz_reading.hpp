// hmesh tests - what the fuzzers of readers share: a file is read twice, with other bytes on the stack, and has to be the same
// picture or the same refusal.
#ifndef HMESH_TESTS_FUZZ_FUZZ_READING_HPP
#define HMESH_TESTS_FUZZ_FUZZ_READING_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz_input.hpp"
#include "readers/readers.hpp"
#include "same_bytes.hpp"

namespace hmesh_test {

using Reader = std::string (*)(tool::Bytes file, tool::ImageFile& image);

inline void fill_stack(unsigned char with) {
    volatile unsigned char stack[1U << 16U];
    for (volatile unsigned char& byte : stack) byte = with;
}

// The memory ends with the file.
inline void fuzz_reader(const std::uint8_t* bytes, std::size_t size, Reader reader) {
    const std::vector<unsigned char> file(bytes, bytes + size);
    // Larger ones take seconds under the sanitizers, and are read alike.
    if (std::string why = tool::check_beginning({file.data(), size}); !why.empty()) return;
    tool::ImageFile image, again;
    fill_stack(0x55);
    const std::string why = reader({file.data(), size}, image);
    fill_stack(0xaa);
    demand(reader({file.data(), size}, again) == why, "a file is refused twice, or never");
    if (!why.empty()) {
        demand(why.find('\n') == std::string::npos && why.size() > 9, "a refusal is a sentence");
        return;
    }
    const std::size_t samples =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * static_cast<std::size_t>(image.channels);
    demand(tool::check_size(image.width, image.height).empty(), "the picture is one that hmesh takes");
    demand(image.channels >= 1 && image.channels <= 4, "it has 1 to 4 channels");
    demand(image.samples8.size() == (image.bits == 8 ? samples : 0) &&
               image.samples16.size() == (image.bits == 16 ? samples : 0) &&
               image.samples32.size() == (image.bits == 32 ? samples : 0),
           "its samples are there, and of one kind");
    demand(image.width == again.width && image.channels == again.channels && same_bytes(image.samples8, again.samples8) &&
               same_bytes(image.samples16, again.samples16) && same_bytes(image.samples32, again.samples32),
           "a file is the same picture twice");
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_READING_HPP
