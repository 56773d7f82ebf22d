// scene - draws hmesh's own photo-like picture into a PNG file: scene FILE.png [WIDTH HEIGHT]
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "scene.hpp"
#include "thread_pool.hpp"
#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"

namespace {

// 1 to 16384, or 0.
int parse_side(const std::string& text) {
    const bool is_number = !text.empty() && text.size() <= 5 && text.find_first_not_of("0123456789") == std::string::npos;
    const int side = is_number ? std::atoi(text.c_str()) : 0;
    return side <= 16384 ? side : 0;
}

}  // namespace

int main(int argc, char** argv) {
    const int width = argc == 4 ? parse_side(argv[2]) : 768, height = argc == 4 ? parse_side(argv[3]) : 512;
    if ((argc != 2 && argc != 4) || width == 0 || height == 0) {
        std::fprintf(stderr, "usage: scene FILE.png [WIDTH HEIGHT]   (768 512; each 1 to 16384)\n");
        return 2;
    }
    tool::OutputFile file(argv[1]);
    if (file.open()) {
        hmesh::Image<std::uint8_t, 3> image = tool::draw_scene(width, height, example::ThreadPool());
        const tool::Picture picture{width, height, 3, {image.data(), image.data() + image.size()}};
        if (tool::write_png(picture, file) && file.commit()) return 0;
    }
    std::fprintf(stderr, "scene: cannot write '%s': %s\n", argv[1],
                 file.error().empty() ? "out of memory" : file.error().c_str());
    return 1;
}
