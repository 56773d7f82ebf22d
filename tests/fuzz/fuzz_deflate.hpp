// hmesh tests - a compressor for the fuzzers of shadings that compresses nothing, and one that fails.
#ifndef HMESH_TESTS_FUZZ_FUZZ_DEFLATE_HPP
#define HMESH_TESTS_FUZZ_FUZZ_DEFLATE_HPP

#include <cstddef>
#include <vector>

#include "fuzz_input.hpp"
#include "hmesh/io/shading_stream.hpp"

namespace hmesh_test {

enum class Deflating { none, works, says_no, gives_nothing };

inline bool fake_deflate(void* user, const unsigned char* bytes, std::size_t size, std::vector<unsigned char>& out) {
    const Deflating how = *static_cast<const Deflating*>(user);
    demand(out.empty(), "a compressor is given an empty vector");
    if (how == Deflating::works) out.assign(bytes, bytes + size);
    return how != Deflating::says_no;
}

// `how` outlives the options.
template <class Options>
void set_deflate(Options& options, Deflating& how) {
    if (how == Deflating::none) return;
    options.deflate = fake_deflate;
    options.deflate_user = &how;
}

[[nodiscard]] inline Deflating draw_deflating(FuzzInput& input) {
    const unsigned which = input.byte() % 8;
    return which < 4    ? Deflating::none
           : which == 7 ? Deflating::gives_nothing
           : which == 6 ? Deflating::says_no
                        : Deflating::works;
}

// How many faces the bytes of a shading join; all of it must be read, and no flag be another than 0, 1 or 2.
[[nodiscard]] inline std::size_t shading_faces(const std::string& bytes, std::size_t vertex_bytes) {
    demand(bytes.size() % vertex_bytes == 0, "a shading holds whole vertices");
    std::size_t faces = 0;
    for (std::size_t at = 0; at < bytes.size(); ++faces) {
        const int flag = static_cast<unsigned char>(bytes[at]);
        demand(flag <= 2 && (flag == 0 || faces > 0), "a flag says how a face goes on");
        at += (flag == 0 ? 3 : 1) * vertex_bytes;
        demand(at <= bytes.size(), "a face has its corners");
    }
    return faces;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_DEFLATE_HPP
