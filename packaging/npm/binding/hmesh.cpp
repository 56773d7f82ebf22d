// What the package's JavaScript calls of hmesh: functions of C, exported by hmesh.wasm, for one thread that calls.
//
// The module holds one mesh, that which was made, read or handed in last, with colours of 8 bits and 3 or 4 channels. Functions
// that can fail return an Answer, which src/engine.js reads: a status, where the mesh lies, and the bytes of a file or a picture.
// Pointers are addresses in the module's memory, valid until the next call. Running out of memory leaves by a JavaScript
// exception, after which the instance is to be thrown away.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <optional>
#include <vector>

#include "hmesh/compact.hpp"
#include "hmesh/hmesh.hpp"

#define HMESH_EXPORT(name) extern "C" __attribute__((export_name(#name), used))
#define HMESH_IMPORT(name) extern "C" __attribute__((import_module("hmesh"), import_name(#name)))

// Whether to go on. `stage` ends with a zero; `total` is ProgressInfo's.
HMESH_IMPORT(progress) bool hmesh_progress(const char* stage, double fraction, double total, double vertices, double energy);
// Throws.
HMESH_IMPORT(out_of_memory) void hmesh_out_of_memory();

namespace {

using Bytes = std::vector<std::uint8_t>;

// 32-bit numbers after a double, in the order of ANSWER in src/engine.js.
struct Answer {
    double psnr = 0;  // dB, of a mesh that was made
    std::uint32_t code = 0;
    const char* message = "";
    std::uint32_t width = 0, height = 0, channels = 0, premultiplied = 0, vertices = 0, faces = 0;
    const float* positions = nullptr;
    const std::uint8_t* colors = nullptr;
    const hmesh::Triangle* indices = nullptr;
    const std::uint8_t* bytes = nullptr;
    std::uint32_t size = 0;
};

struct Module {
    Answer answer;
    hmesh::Message message;
    hmesh::Mesh mesh;  // its colours are stored, too, as
    Bytes colors;
    Bytes bytes;  // of the file or picture made last

    const Answer* reply(const hmesh::Status& status) {
        message = hmesh::message(status);
        answer.code = static_cast<std::uint32_t>(status.code);
        answer.message = message.c_str();
        answer.width = static_cast<std::uint32_t>(mesh.width);
        answer.height = static_cast<std::uint32_t>(mesh.height);
        answer.channels = static_cast<std::uint32_t>(mesh.channels);
        answer.premultiplied = mesh.premultiplied ? 1 : 0;
        answer.vertices = static_cast<std::uint32_t>(mesh.vertex_count());
        answer.faces = static_cast<std::uint32_t>(mesh.face_count());
        answer.positions = mesh.positions.data();
        answer.colors = colors.data();
        answer.indices = mesh.faces.data();
        answer.bytes = bytes.data();
        answer.size = static_cast<std::uint32_t>(bytes.size());
        return &answer;
    }
    // Takes a mesh of 1 to 4 channels: grey becomes RGB, and colours shares of 255.
    void hold(hmesh::Mesh other) {
        mesh = std::move(other);
        const auto from = static_cast<std::size_t>(mesh.channels);
        const std::size_t to = from <= 2 ? from + 2 : from;
        colors.resize(to * mesh.vertex_count());
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            for (std::size_t k = 0; k < to; ++k) {
                const std::size_t channel = from > 2 ? k : k < 3 ? 0 : 1;
                const double share = static_cast<double>(mesh.colors[from * v + channel]) / mesh.peak;
                colors[to * v + k] = hmesh::PixelTraits<std::uint8_t>::from_real(255 * share);
            }
        mesh.channels = static_cast<int>(to);
        mesh.peak = 255;
    }
    // The mesh, of which JavaScript may have written the arrays.
    [[nodiscard]] hmesh::MeshView view() {
        mesh.colors.assign(colors.begin(), colors.end());
        return mesh.view();
    }
};

Module& module() {
    static Module module;
    return module;
}

template <int C>
hmesh::Result make(const std::uint8_t* pixels, int width, int height, const hmesh::Options& options, const hmesh::Annealed& recipe) {
    return hmesh::mesh_image(hmesh::ImageView<std::uint8_t, C>{pixels, width, height}, options, recipe);
}

// The mesh as RGBA, alpha straight.
template <int C>
hmesh::Status draw(const hmesh::MeshView& mesh, const hmesh::RenderOptions& options, Bytes& to) {
    const hmesh::RenderResult<C> drawn = hmesh::render<C>(mesh, options);
    const auto pixels = drawn.image.size() / C;
    const auto sample = [](float value) { return hmesh::PixelTraits<std::uint8_t>::from_real(static_cast<double>(value)); };
    to.resize(4 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* from = drawn.image.data() + C * i;
        const float alpha = C == 4 ? from[3] : 255.0F;
        const float scale = mesh.premultiplied && alpha > 0 ? 255.0F / alpha : 1.0F;
        for (std::size_t k = 0; k < 3; ++k) to[4 * i + k] = sample(from[k] * scale);
        to[4 * i + 3] = sample(alpha);
    }
    return drawn.status;
}

// In the order of FORMATS in src/engine.js.
enum class Format : std::uint8_t { ply, glb, svg, html, pdf, obj, hmc };

}  // namespace

HMESH_EXPORT(hmesh_allocate) void* hmesh_allocate(std::size_t size) {
    std::set_new_handler(hmesh_out_of_memory);
    return ::operator new(size);
}
HMESH_EXPORT(hmesh_release) void hmesh_release(void* bytes) { ::operator delete(bytes); }

// Meshes an image of 3 or 4 channels. `kind`: Target::Kind; `weights`: one a pixel, or null.
HMESH_EXPORT(hmesh_mesh_image)
const void* hmesh_mesh_image(const std::uint8_t* pixels, int width, int height, int channels, int premultiplied, int kind, double value,
                             int effort, double seed, const float* weights) {
    Module& held = module();
    const auto progress = [](const hmesh::ProgressInfo& info) {
        return hmesh_progress(info.stage, info.fraction, info.total, static_cast<double>(info.vertices), info.energy);
    };
    hmesh::Options options;
    options.target = {static_cast<hmesh::Target::Kind>(kind), value, {}, {}};
    options.progress = progress;
    options.premultiplied = premultiplied != 0;
    if (weights != nullptr) options.weights = {weights, width, height};
    hmesh::Annealed recipe;
    recipe.effort = static_cast<hmesh::Effort>(effort);
    recipe.seed = static_cast<std::uint64_t>(seed);
    held.mesh = {};
    hmesh::Result result =
        channels == 3 ? make<3>(pixels, width, height, options, recipe) : make<4>(pixels, width, height, options, recipe);
    held.hold(std::move(result.mesh));
    held.answer.psnr = result.report.psnr;
    return held.reply(result.status);
}

// Makes room for a mesh whose arrays JavaScript then writes to where the answer says.
HMESH_EXPORT(hmesh_hold)
const void* hmesh_hold(int width, int height, int channels, int premultiplied, std::size_t vertices, std::size_t faces) {
    Module& held = module();
    held.mesh = {};
    held.mesh.width = width;
    held.mesh.height = height;
    held.mesh.channels = channels;
    held.mesh.peak = 255;
    held.mesh.premultiplied = premultiplied != 0;
    held.mesh.positions.resize(2 * vertices);
    held.mesh.faces.resize(faces);
    held.colors.resize(static_cast<std::size_t>(channels) * vertices);
    return held.reply({});
}

// Writes the mesh. Texts end with a zero; `kind` and `wireframe` are of SVG, the rest is of HTML, where `original` may be null.
HMESH_EXPORT(hmesh_write)
const void* hmesh_write(int format, int kind, int wireframe, const char* title, const unsigned char* original,
                        std::size_t original_size, const char* original_type) {
    Module& held = module();
    held.bytes.clear();
    const auto sink = [&](const void* bytes, std::size_t size) {
        const auto* const from = static_cast<const std::uint8_t*>(bytes);
        held.bytes.insert(held.bytes.end(), from, from + size);
        return true;
    };
    const hmesh::MeshView mesh = held.view();
    switch (static_cast<Format>(format)) {
        case Format::ply: return held.reply(hmesh::write_ply(mesh, sink));
        case Format::glb: return held.reply(hmesh::write_glb(mesh, sink));
        case Format::svg: {
            hmesh::SvgOptions options;
            options.kind = static_cast<hmesh::SvgKind>(kind);
            options.wireframe = wireframe != 0;
            return held.reply(hmesh::write_svg(mesh, sink, options));
        }
        case Format::html: {
            hmesh::HtmlOptions options;
            options.title = title;
            options.original = original;
            options.original_size = original_size;
            options.original_type = original_type;
            return held.reply(hmesh::write_html(mesh, sink, options));
        }
        case Format::pdf: return held.reply(hmesh::write_pdf(mesh, sink));
        case Format::obj: return held.reply(hmesh::write_obj(mesh, sink));
        case Format::hmc: break;
    }
    return held.reply(hmesh::write_compact(mesh, sink));
}

// Reads a compact file. A periodic mesh becomes one that covers its picture; samples that are points are refused.
HMESH_EXPORT(hmesh_read) const void* hmesh_read(const void* bytes, std::size_t size) {
    Module& held = module();
    hmesh::CompactMesh read = hmesh::read_compact(bytes, size);
    if (read.status && read.mesh.samples == hmesh::Samples::points)
        read.status = {hmesh::Errc::invalid_argument, "the compact mesh is of samples that are points, as heights are"};
    if (!read.status) read.mesh = {};
    if (read.mesh.periodic != hmesh::Periodic::none) read.mesh = hmesh::unrolled(read.mesh.view());
    held.hold(std::move(read.mesh));
    return held.reply(read.status);
}

// Draws the mesh as RGBA of width x height px.
HMESH_EXPORT(hmesh_render) const void* hmesh_render(int width, int height) {
    Module& held = module();
    hmesh::RenderOptions options;
    options.width = width;
    options.height = height;
    const hmesh::MeshView mesh = held.view();
    return held.reply(held.mesh.channels == 3 ? draw<3>(mesh, options, held.bytes) : draw<4>(mesh, options, held.bytes));
}
