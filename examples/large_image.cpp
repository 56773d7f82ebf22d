// large_image - a picture that need not fit memory becomes a mesh: large_image photo.ppm mesh.ply [PERCENT]
//
// Reads rectangles of a PPM file of 8 bits (P6) where they are needed. docs/scale.md says what else can be read so, and what it
// costs.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "hmesh/io/ply.hpp"
#include "hmesh/large.hpp"
#include "thread_pool.hpp"

namespace {

// The next whole number of a PPM's header; -1: there is none.
int read_number(std::istream& file) {
    while ((file >> std::ws).peek() == '#') file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    int number = -1;
    return file >> number ? number : -1;
}

int fail(const char* what, const char* why) {
    std::fprintf(stderr, "%s: %s\n", what, why);
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3 && argc != 4) {
        std::fprintf(stderr, "usage: large_image IMAGE.ppm MESH.ply [PERCENT]\n");
        return 2;
    }
    std::ifstream file(argv[1], std::ios::binary);
    if (!file) return fail(argv[1], "cannot be opened");
    const bool is_ppm = file.get() == 'P' && file.get() == '6';
    const int width = read_number(file), height = read_number(file), most = read_number(file);
    if (!is_ppm || width < 1 || height < 1 || most != 255) return fail(argv[1], "no PPM file of 8 bits");
    const std::streamoff first = std::streamoff{file.tellg()} + 1;

    // One thread at a time reads, since the file has one place where it is read.
    const auto read = [&](const hmesh::kit::Rect& rect, std::uint8_t* samples, std::ptrdiff_t row_stride) {
        for (int y = 0; y < rect.height; ++y, samples += row_stride) {
            file.seekg(first + 3 * (std::streamoff{rect.y + y} * width + rect.x));
            if (!file.read(reinterpret_cast<char*>(samples), std::streamsize{3} * rect.width)) return false;
        }
        return true;
    };
    const hmesh::ImageReader<std::uint8_t, 3> reader{width, height, read};

    hmesh::Options options;
    if (argc == 4) options.target = hmesh::Target::percent(std::atof(argv[3]));
    const hmesh::Result result = hmesh::mesh_image(reader, options, {hmesh::Effort::draft}, example::ThreadPool());
    if (!result.has_mesh()) return fail(argv[1], hmesh::message(result.status).c_str());
    std::printf("%zu vertices, %zu faces, PSNR %.2f dB\n", result.report.vertices, result.report.faces, result.report.psnr);

    std::ofstream out(argv[2], std::ios::binary);
    const auto sink = [&](const void* bytes, std::size_t size) {
        return bool(out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size)));
    };
    if (!hmesh::write_ply(result.mesh.view(), sink) || !out.flush()) return fail(argv[2], "cannot be written");
    return 0;
}
