// What JavaScript calls to write the mesh, to read one, and to draw it.
#include <cstddef>
#include <cstdint>

#include "hmesh/compact.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/render.hpp"
#include "module.hpp"

namespace {

// In the order of FORMATS in src/engine.js.
enum class Format : std::uint8_t { ply, glb, svg, html, pdf, obj, hmc };

// The mesh as RGBA, alpha straight.
template <int C>
hmesh::Status draw(const hmesh::MeshView& mesh, const hmesh::RenderOptions& options, binding::Bytes& to) {
    const hmesh::RenderResult<C> drawn = hmesh::render<C>(mesh, options);
    const std::size_t pixels = drawn.image.size() / C;
    const auto sample = [](float value) { return hmesh::PixelTraits<std::uint8_t>::from_real(static_cast<double>(value)); };
    to.resize(4 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* const from = drawn.image.data() + C * i;
        const float alpha = C == 4 ? from[3] : 255.0F;
        const float scale = mesh.premultiplied && alpha > 0 ? 255.0F / alpha : 1.0F;
        for (std::size_t k = 0; k < 3; ++k) to[4 * i + k] = sample(from[k] * scale);
        to[4 * i + 3] = sample(alpha);
    }
    return drawn.status;
}

}  // namespace

// Writes the mesh. Texts end with a zero; `kind` and `wireframe` are of SVG, the rest is of HTML, where `original` may be null.
HMESH_EXPORT(hmesh_write)
const void* hmesh_write(int format, int kind, int wireframe, const char* title, const unsigned char* original,
                        std::size_t original_size, const char* original_type) {
    binding::Module& module = binding::module();
    module.bytes.clear();
    const auto sink = module.sink();
    const hmesh::MeshView mesh = module.view();
    switch (static_cast<Format>(format)) {
        case Format::ply: return module.reply(hmesh::write_ply(mesh, sink));
        case Format::glb: return module.reply(hmesh::write_glb(mesh, sink));
        case Format::svg: {
            hmesh::SvgOptions options;
            options.kind = static_cast<hmesh::SvgOptions::Kind>(kind);
            options.wireframe = wireframe != 0;
            return module.reply(hmesh::write_svg(mesh, sink, options));
        }
        case Format::html: {
            hmesh::HtmlOptions options;
            options.title = title;
            options.original = original;
            options.original_size = original_size;
            options.original_type = original_type;
            return module.reply(hmesh::write_html(mesh, sink, options));
        }
        case Format::pdf: return module.reply(hmesh::write_pdf(mesh, sink));
        case Format::obj: return module.reply(hmesh::write_obj(mesh, sink));
        case Format::hmc: break;
    }
    return module.reply(hmesh::write_compact(mesh, sink));
}

// Writes the mesh as a compact file of the bare profile, with CompactOptions' steps.
HMESH_EXPORT(hmesh_write_bare) const void* hmesh_write_bare(std::uint32_t lattice, std::uint32_t color_step) {
    binding::Module& module = binding::module();
    module.bytes.clear();
    hmesh::CompactOptions options;
    options.bare = true;
    options.lattice = lattice;
    options.color_step = color_step;
    const auto sink = module.sink();
    return module.reply(hmesh::write_compact(module.view(), sink, options));
}

// Reads a compact file, or one of the bare profile. A periodic mesh becomes one that covers its picture; samples that are points
// are refused.
HMESH_EXPORT(hmesh_read) const void* hmesh_read(const void* bytes, std::size_t size, int is_bare) {
    hmesh::CompactMesh read = is_bare != 0 ? hmesh::read_bare_compact(bytes, size) : hmesh::read_compact(bytes, size);
    if (read.status && read.mesh.samples == hmesh::Samples::points)
        read.status = {hmesh::Errc::invalid_argument, "the compact mesh is of samples that are points, as heights are"};
    if (!read.status) read.mesh = {};
    if (read.mesh.periodic != hmesh::Periodic::none) read.mesh = hmesh::kit::unrolled(read.mesh.view());
    binding::Module& module = binding::module();
    module.hold(std::move(read.mesh));
    return module.reply(read.status);
}

// Draws the mesh as RGBA of width x height px.
HMESH_EXPORT(hmesh_render) const void* hmesh_render(int width, int height) {
    hmesh::RenderOptions options;
    options.width = width;
    options.height = height;
    binding::Module& module = binding::module();
    const hmesh::MeshView mesh = module.view();
    return module.reply(mesh.channels == 3 ? draw<3>(mesh, options, module.bytes) : draw<4>(mesh, options, module.bytes));
}
