// threads - meshes a picture on one thread and on all cores: what each takes, and that the bytes are equal.
//
// Threads share out the tiles of an image. By default these have 128 to 256 px; Annealed::tile says another size.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "thread_pool.hpp"

namespace {

// Rings that become finer to the right, each colour shifted against the others.
hmesh::Image<std::uint8_t, 3> draw_rings(int width, int height) {
    hmesh::Image<std::uint8_t, 3> image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double radius = std::hypot(x - 60 * c, y - height / 2.0);
                image.pixel(x, y)[c] = static_cast<std::uint8_t>(127.5 + 127 * std::sin(radius * radius / 4000));
            }
    return image;
}

// What mesh_image() returns, the wall-clock seconds it took printed.
hmesh::Result mesh_on(const example::ThreadPool& pool, const hmesh::Image<std::uint8_t, 3>& image) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    hmesh::Annealed recipe;
    recipe.tile = 160;  // px
    hmesh::Result result = hmesh::mesh_image(image.view(), {}, recipe, pool);
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    std::printf("%3zu thread%s %6.2f s, %zu vertices, PSNR %.2f dB\n", pool.threads(), pool.threads() == 1 ? " " : "s", seconds,
                result.report.vertices, result.report.psnr);
    return result;
}

template <class Value>
bool same_bytes(const std::vector<Value>& a, const std::vector<Value>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0;
}

}  // namespace

int main() {
    const hmesh::Image<std::uint8_t, 3> image = draw_rings(512, 384);
    const hmesh::Result one = mesh_on(example::ThreadPool(1), image), all = mesh_on(example::ThreadPool(), image);
    if (!one.status || !all.status) {
        std::fprintf(stderr, "threads: %s\n", hmesh::message(one.status ? all.status : one.status).c_str());
        return 1;
    }
    const bool equal = same_bytes(one.mesh.positions, all.mesh.positions) && same_bytes(one.mesh.colors, all.mesh.colors) &&
                       same_bytes(one.mesh.faces, all.mesh.faces);
    std::printf("the bytes are %s\n", equal ? "equal" : "NOT equal");
    return equal ? 0 : 1;
}
