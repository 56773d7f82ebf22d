// What JavaScript calls to make a mesh, and to hand one in.
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>

#include "calls.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh_image.hpp"
#include "module.hpp"
#ifdef __wasm_atomics__
#include "crew.hpp"
#include "heap.hpp"
#endif

// Is handed the mesh so far, as an answer.
HMESH_IMPORT(show) void hmesh_show(const void* answer);

namespace {

#ifdef __wasm_atomics__
binding::Crew crew;
const auto executor = [](std::size_t n, hmesh::Piece piece) {
    const binding::Failure failure = crew.run(n, piece);
    if (failure == binding::Failure::none) return;
    if (failure == binding::Failure::out_of_memory) hmesh_out_of_memory();
    __builtin_trap();
};
#else
[[maybe_unused]] const std::new_handler previous_handler = std::set_new_handler(hmesh_out_of_memory);
const hmesh::ParallelFor executor;
#endif

}  // namespace

HMESH_EXPORT(hmesh_allocate) void* hmesh_allocate(std::size_t size) { return ::operator new(size); }
HMESH_EXPORT(hmesh_release) void hmesh_release(void* bytes) { ::operator delete(bytes); }

#ifdef __wasm_atomics__
// A helper's life, on a stack of its own in an instance of its own; and its end, where that threw.
HMESH_EXPORT(hmesh_help) void hmesh_help() { crew.help(); }
HMESH_EXPORT(hmesh_fail) void hmesh_fail(binding::Failure failure) { crew.fail(failure); }
#endif

// Meshes an image of 3 or 4 channels. `kind`: Target::Kind; `weights`: one a pixel, or null.
HMESH_EXPORT(hmesh_mesh_image)
const void* hmesh_mesh_image(const std::uint8_t* pixels, int width, int height, int channels, int premultiplied, int kind,
                             double value, int effort, double seed, const float* weights) {
    binding::Module& module = binding::module();
    hmesh::Options options;
    options.target = {static_cast<hmesh::Target::Kind>(kind), value, {}, {}};
    options.premultiplied = premultiplied != 0;
    if (weights != nullptr) options.weights = {weights, width, height};
    double samples = 0;  // that count, of which only checked weights can tell
    const auto progress = [&](const hmesh::ProgressInfo& info) {
        const int answer = binding::tell(info);
        if (answer == 2 && info.mesh_so_far) {
            if (samples == 0)
                samples =
                    channels * hmesh::kit::weight_sum(options.weights, hmesh::kit::weight_unit(options.weights), width, height);
            module.hold(info.mesh_so_far());
            module.psnr = hmesh::kit::psnr_of_energy(info.energy, samples, 255);
            hmesh_show(module.reply({}));
        }
        return answer != 0;
    };
    options.progress = progress;
    const hmesh::Annealed recipe = binding::recipe_of(effort, seed);
    module.mesh = {};
    hmesh::Result result = binding::with_view(
        pixels, width, height, channels, [&](const auto& view) { return hmesh::mesh_image(view, options, recipe, executor); });
    module.hold(std::move(result.mesh));
    module.psnr = result.report.psnr;
    return module.reply(result.status);
}

// Makes room for a mesh whose arrays JavaScript then writes to where the answer says.
HMESH_EXPORT(hmesh_hold)
const void* hmesh_hold(int width, int height, int channels, int premultiplied, std::size_t vertices, std::size_t faces) {
    binding::Module& module = binding::module();
    module.mesh = {};
    module.mesh.width = width;
    module.mesh.height = height;
    module.mesh.channels = channels;
    module.mesh.peak = 255;
    module.mesh.premultiplied = premultiplied != 0;
    module.mesh.positions.resize(2 * vertices);
    module.mesh.faces.resize(faces);
    module.colors.resize(static_cast<std::size_t>(channels) * vertices);
    return module.reply({});
}
