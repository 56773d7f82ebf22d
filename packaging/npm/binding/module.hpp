// Module: the mesh that hmesh.wasm holds, and how JavaScript hears of it.
//
// The module holds one mesh, that which was made, read or handed in last, with colours of 8 bits and 3 or 4 channels. Functions
// that can fail return an Answer, which src/engine.js reads: a status, where the mesh lies, and the bytes of a file or a picture.
// Pointers are addresses in the module's memory, valid until the next call. One thread calls. Running out of memory leaves by a
// JavaScript exception, after which the instance is to be thrown away.
#ifndef HMESH_BINDING_MODULE_HPP
#define HMESH_BINDING_MODULE_HPP

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#define HMESH_EXPORT(name) extern "C" __attribute__((export_name(#name), used))
#define HMESH_IMPORT(name) extern "C" __attribute__((import_module("hmesh"), import_name(#name)))

// Throws.
HMESH_IMPORT(out_of_memory) void hmesh_out_of_memory();

namespace binding {

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
    hmesh::Mesh mesh;  // whose colours are
    Bytes colors;
    double psnr = 0;  // dB
    Bytes bytes;      // of the file or the picture that was made last

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
    // Appends what is written to `bytes`.
    [[nodiscard]] auto sink() noexcept { return hmesh::kit::append_to(bytes); }
    const Answer* reply(const hmesh::Status& status) {
        message_ = hmesh::message(status);
        const auto word = [](auto number) { return static_cast<std::uint32_t>(number); };
        answer_ = {psnr,
                   word(status.code),
                   message_.c_str(),
                   word(mesh.width),
                   word(mesh.height),
                   word(mesh.channels),
                   word(mesh.premultiplied),
                   word(mesh.vertex_count()),
                   word(mesh.face_count()),
                   mesh.positions.data(),
                   colors.data(),
                   mesh.faces.data(),
                   bytes.data(),
                   word(bytes.size())};
        return &answer_;
    }

  private:
    Answer answer_;
    hmesh::Message message_;
};

// The one that there is.
inline Module& module() {
    static Module one;
    return one;
}

}  // namespace binding

#endif  // HMESH_BINDING_MODULE_HPP
