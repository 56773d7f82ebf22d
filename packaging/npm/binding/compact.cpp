// What JavaScript calls to make a compact file of so many bytes.
#include <cstddef>
#include <cstdint>
#include <utility>

#include "calls.hpp"
#include "hmesh/rate/compact_image.hpp"
#include "module.hpp"

// Makes a compact file of at most so many bytes of an image of 3 or 4 channels, or one of the bare profile, and its mesh.
HMESH_EXPORT(hmesh_compact_image)
const void* hmesh_compact_image(const std::uint8_t* pixels, int width, int height, int channels, int premultiplied, double bytes,
                                int effort, double seed, int is_bare) {
    binding::Module& module = binding::module();
    hmesh::CompactImageOptions options;
    options.bytes = static_cast<std::size_t>(bytes);
    options.bare = is_bare != 0;
    options.premultiplied = premultiplied != 0;
    const auto progress = [](const hmesh::ProgressInfo& info) { return binding::tell(info) != 0; };
    options.progress = progress;
    const hmesh::Annealed recipe = binding::recipe_of(effort, seed);
    module.mesh = {};
    hmesh::CompactImage made = binding::with_view(pixels, width, height, channels,
                                                  [&](const auto& view) { return hmesh::compact_image(view, options, recipe); });
    module.hold(std::move(made.mesh));
    module.psnr = made.psnr;
    module.bytes = std::move(made.bytes);
    return module.reply(made.status);
}
