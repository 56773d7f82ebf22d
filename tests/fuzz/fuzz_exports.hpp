// hmesh tests - what the fuzzers of all exporters share: meshes from bytes, good ones and bad ones, and what has to come of
// them whatever the format.
#ifndef HMESH_TESTS_FUZZ_FUZZ_EXPORTS_HPP
#define HMESH_TESTS_FUZZ_FUZZ_EXPORTS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fuzz_input.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace hmesh_test {

// The view is one of the arrays, which end where it ends, or of none.
struct FuzzMesh {
    std::vector<float> positions, colors;
    std::vector<hmesh::Triangle> faces;
    hmesh::MeshView view;
    bool is_good = false;  // every exporter writes it
};

// How many channels files have of a mesh: grey with alpha is written as red, green, blue and alpha.
[[nodiscard]] inline int channels_written(const hmesh::MeshView& mesh) { return mesh.channels == 2 ? 4 : mesh.channels; }

// Fills the arrays of a mesh that has its size, its channels and its peak.
class FuzzMeshDraw {
  public:
    explicit FuzzMeshDraw(FuzzInput& input) : input_(&input) {}

    [[nodiscard]] FuzzMesh mesh() {
        const bool is_any = input_->one_in(3);
        mesh_.view.channels = input_->one_of<int>({3, 4, 1, 2});
        mesh_.view.premultiplied = input_->one_in(3);
        mesh_.view.peak = input_->one_of<double>({255, 1, 65535, 1000});
        mesh_.view.width = input_->within(1, 300);
        mesh_.view.height = input_->within(1, 300);
        mesh_.is_good = !is_any;
        if (is_any) any_faces();
        else tiling();
        if (input_->one_in(4)) stretch();
        colors();
        if (is_any && input_->one_in(4)) spoil();
        mesh_.view.positions = mesh_.positions.data();
        mesh_.view.colors = mesh_.colors.data();
        mesh_.view.faces = mesh_.faces.data();
        mesh_.view.vertex_count = mesh_.positions.size() / 2;
        mesh_.view.face_count = mesh_.faces.size();
        return std::move(mesh_);
    }

  private:
    // Faces that join any vertices, vertices anywhere.
    void any_faces() {
        const int vertices = input_->one_in(250) ? 65530 + input_->within(0, 9) : input_->within(0, 40);
        const int faces = input_->within(0, 60);
        const bool wild = input_->flag(), strays = input_->one_in(8);
        for (int i = 0; i < 2 * vertices; ++i) mesh_.positions.push_back(wild && i < 80 ? any_float() : input_->byte());
        for (int f = 0; f < 3 * faces; ++f) {
            if (f % 3 == 0) mesh_.faces.emplace_back();
            const unsigned number = vertices > 255 ? input_->bits<std::uint16_t>() : input_->byte();
            mesh_.faces.back()[static_cast<std::size_t>(f % 3)] =
                strays ? input_->bits<std::uint32_t>() : number % std::max(1U, static_cast<unsigned>(vertices));
        }
        mesh_.positions.shrink_to_fit();
        mesh_.faces.shrink_to_fit();
    }
    // A triangulation of the image: a face is split in three over and over, at places on the grid or off it.
    void tiling() {
        const auto w = static_cast<float>(mesh_.view.width), h = static_cast<float>(mesh_.view.height);
        mesh_.positions = {0, 0, w, 0, w, h, 0, h};
        mesh_.faces = {{0, 1, 2}, {0, 2, 3}};
        const bool on_grid = !input_->flag();
        for (int splits = input_->within(0, 60); splits > 0; --splits) {
            const std::size_t f = input_->byte() % mesh_.faces.size();
            const double a = 1 + input_->byte() % 64, b = 1 + input_->byte() % 64, c = 1 + input_->byte() % 64;
            const hmesh::Triangle face = mesh_.faces[f];
            std::array<float, 2> place{};
            for (std::size_t k = 0; k < 2; ++k) {
                const double at =
                    (a * coordinate(face[0], k) + b * coordinate(face[1], k) + c * coordinate(face[2], k)) / (a + b + c);
                place[k] = static_cast<float>(on_grid ? std::floor(at * 256) / 256 : at);
            }
            const auto v = static_cast<std::uint32_t>(mesh_.positions.size() / 2);
            mesh_.positions.insert(mesh_.positions.end(), place.begin(), place.end());
            const std::array<hmesh::Triangle, 3> parts = {{{face[0], face[1], v}, {face[1], face[2], v}, {face[2], face[0], v}}};
            if (!std::all_of(parts.begin(), parts.end(), [&](const auto& part) { return twice_area(part) > 0; })) {
                mesh_.positions.resize(2 * std::size_t{v});
                continue;
            }
            mesh_.faces[f] = parts[0];
            mesh_.faces.push_back(parts[1]);
            mesh_.faces.push_back(parts[2]);
        }
        mesh_.positions.shrink_to_fit();
        mesh_.faces.shrink_to_fit();
    }
    [[nodiscard]] double coordinate(std::uint32_t v, std::size_t k) const {
        return static_cast<double>(mesh_.positions[2 * std::size_t{v} + k]);
    }
    [[nodiscard]] double twice_area(const hmesh::Triangle& face) const {
        const auto [a, b, c] = face;
        return (coordinate(b, 0) - coordinate(a, 0)) * (coordinate(c, 1) - coordinate(a, 1)) -
               (coordinate(b, 1) - coordinate(a, 1)) * (coordinate(c, 0) - coordinate(a, 0));
    }
    // As large or as small as floats go, or elsewhere.
    void stretch() {
        mesh_.is_good = false;
        const double scale = std::ldexp(1.0, input_->within(-150, 120)), left = input_->wild_real(), top = input_->wild_real();
        for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
            const double place = static_cast<double>(mesh_.positions[i]) * scale + (i % 2 == 0 ? left : top);
            if (std::abs(place) <= std::numeric_limits<float>::max()) mesh_.positions[i] = static_cast<float>(place);
        }
    }
    void colors() {
        const unsigned kind = input_->byte() % 4;
        mesh_.colors.resize(static_cast<std::size_t>(mesh_.view.channels) * mesh_.positions.size() / 2);
        for (std::size_t k = 0; k < mesh_.colors.size(); ++k) {
            float& color = mesh_.colors[k];
            if (kind == 3 && k < 200) color = any_float();
            else if (kind == 2) color = static_cast<float>(mesh_.view.peak * (3 * input_->share() - 1));
            else color = static_cast<float>(mesh_.view.peak / 255 * input_->byte());
            if (!std::isfinite(color)) mesh_.is_good = false;
        }
    }
    // What a view may say besides.
    void spoil() {
        switch (input_->byte() % 6) {
            case 0: mesh_.view.width = input_->wild_int(); break;
            case 1: mesh_.view.height = input_->wild_int(); break;
            case 2: mesh_.view.peak = input_->wild_real(); break;
            case 3: mesh_.colors.assign(16 * mesh_.positions.size() / 2, 1), mesh_.view.channels = input_->within(-1, 16); break;
            case 4: mesh_.view.peak = std::numeric_limits<double>::denorm_min(); break;
            default: mesh_.faces.clear(), mesh_.faces.shrink_to_fit();
        }
    }
    [[nodiscard]] float any_float() {
        if (input_->flag()) return input_->bits<float>();
        return input_->one_of<float>(
            {0.0F, -0.0F, -1.0F, 1e-45F, 1e-38F, 1e-30F, 0.1F, 1e7F, 4194304.0F, 1e30F, 3.4e38F, -3.4e38F});
    }

    FuzzInput* input_;
    FuzzMesh mesh_;
};

// An exporter with its options, and what ends the program unless the file is one of that mesh.
using Write = hmesh::FunctionRef<hmesh::Status(const hmesh::MeshView& mesh, hmesh::Sink sink)>;
using Check = hmesh::FunctionRef<void(const std::string& file, const hmesh::MeshView& mesh)>;

// Writes a mesh to a sink that takes all, and to one that refuses after some bytes.
inline void fuzz_exporter(FuzzInput& input, const FuzzMesh& mesh, Write write, Check check) {
    const double patience = input.share();
    std::string file;
    const hmesh::Status status = write(mesh.view, [&](const void* bytes, std::size_t size) {
        demand(bytes != nullptr && size > 0, "a sink is given bytes");
        file.append(static_cast<const char*>(bytes), size);
        return true;
    });
    demand((status.code == hmesh::Errc::ok) == (*status.what == 0), "a status has a sentence if and only if it is bad");
    demand(status.code != hmesh::Errc::cancelled, "nobody cancelled");
    demand(status || file.empty(), "what is refused gives no byte");
    demand(status || !mesh.is_good, "a good mesh is written");
    if (!status) return;
    check(file, mesh.view);

    const auto most = static_cast<std::size_t>(static_cast<double>(file.size()) * patience);
    std::string part;
    bool is_refused = false;
    const hmesh::Status cut = write(mesh.view, [&](const void* bytes, std::size_t size) {
        demand(!is_refused, "a sink that refused is given nothing more");
        is_refused = part.size() + size > most;
        if (!is_refused) part.append(static_cast<const char*>(bytes), size);
        return !is_refused;
    });
    demand(file.compare(0, part.size(), part) == 0, "the same mesh gives the same bytes");
    if (most == file.size()) demand(cut && part == file, "a sink that takes all makes a success");
    else
        demand(cut.code == hmesh::Errc::write_failed && *cut.what != 0 && cut.value == static_cast<double>(part.size()),
               "a refusal is reported with the bytes taken");
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_EXPORTS_HPP
