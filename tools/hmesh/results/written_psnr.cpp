#include "results/written_psnr.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "arguments/files.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "results/psnr_between.hpp"

namespace tool {
namespace {

// Readers sum in other orders, and with floats.
constexpr double margin = 1e-4;  // dB

// How a format keeps shares of full intensity.
enum class Keeps : std::uint8_t { all, bytes, shorts, six_decimals, linear_shorts, linear_bytes };

Keeps kept_by(const std::string& ending, double peak, int glb_color_bits) {
    if (ending == ".obj") return Keeps::six_decimals;
    if (ending == ".glb") return glb_color_bits == 8 ? Keeps::linear_bytes : Keeps::linear_shorts;
    if (ending == ".hmc") return peak == 255 ? Keeps::bytes : peak == 65535 ? Keeps::shorts : Keeps::all;
    const bool is_page = ending == ".pdf" || ending == ".eps";
    return is_page && peak != 255 ? Keeps::shorts : Keeps::bytes;
}

double kept(Keeps keeps, double share, bool is_alpha) {
    switch (keeps) {
        case Keeps::all: return share;
        case Keeps::bytes: return hmesh::detail::to_u8(share) / 255.0;
        case Keeps::shorts: return hmesh::detail::to_u16(share) / 65535.0;
        case Keeps::six_decimals: return std::floor(share * 1e6 + 0.5) / 1e6;
        case Keeps::linear_bytes:
            if (is_alpha) return hmesh::detail::to_u8(share) / 255.0;
            return hmesh::kit::linear_to_srgb(hmesh::detail::to_u8(hmesh::kit::srgb_to_linear(share)) / 255.0);
        case Keeps::linear_shorts: break;
    }
    if (is_alpha) return hmesh::detail::to_u16(share) / 65535.0;
    return hmesh::kit::linear_to_srgb(hmesh::detail::to_u16(hmesh::kit::srgb_to_linear(share)) / 65535.0);
}

bool holds_the_mesh(const std::string& ending, const Arguments& arguments, int channels) {
    if (ending == ".svg") return arguments.svg == hmesh::SvgOptions::Kind::exact;
    return !hmesh::kit::has_alpha(channels) || (ending != ".obj" && ending != ".eps");
}

// The mesh that a reader of a file of this format has, with as many channels.
hmesh::Mesh as_kept(const hmesh::Mesh& mesh, const std::string& ending, int glb_color_bits) {
    using hmesh::detail::Premultiplied;
    const bool is_kept = ending == ".html" || ending == ".hmc";
    const hmesh::detail::ExportMesh exported(mesh.view(), is_kept ? Premultiplied::kept : Premultiplied::divided);
    const hmesh::MeshView& view = exported.view();
    const Keeps keeps = kept_by(ending, mesh.peak, glb_color_bits);
    if (keeps == Keeps::all) return mesh;
    hmesh::Mesh out = mesh;
    out.premultiplied = view.premultiplied;
    const auto channels = static_cast<std::size_t>(mesh.channels), given = static_cast<std::size_t>(view.channels);
    for (std::size_t i = 0; i < out.colors.size(); ++i) {
        const std::size_t v = i / channels, c = i % channels;
        const bool is_alpha = !hmesh::kit::is_light(static_cast<int>(c), mesh.channels);
        const float color = view.colors[given * v + (is_alpha ? given - 1 : c)];
        const double share = kept(keeps, hmesh::detail::share_of_peak(color, mesh.peak), is_alpha);
        // The stored value itself where it is kept, as bytes are.
        const double steps = keeps == Keeps::bytes ? std::floor(share * 255 + 0.5) * (mesh.peak / 255) : share * mesh.peak;
        out.colors[i] = static_cast<float>(steps);
    }
    return out;
}

}  // namespace

std::vector<WrittenPsnr> WrittenFiles::measure(const hmesh::Mesh& mesh, double psnr,
                                               const std::optional<LightMesh>& light) const {
    std::vector<WrittenPsnr> out;
    hmesh::Mesh own = mesh;
    own.premultiplied = options_.premultiplied;
    const auto channels = static_cast<std::size_t>(image_.channels);
    const auto measured = [&](const std::vector<float>& drawn, bool is_premultiplied) {
        if (wanted_.empty()) wanted_ = wanted_samples(image_, options_.premultiplied, parallel_for_);
        return psnr_between(wanted_, drawn, channels, own.peak, {options_.weights, options_.channel_weights},
                            options_.premultiplied && !is_premultiplied);
    };
    std::vector<float> drawn;
    for (const MeshFile& wanted : arguments_.meshes) {
        const std::string &name = wanted.name, &ending = wanted.ending;
        if (!holds_the_mesh(ending, arguments_, image_.channels)) continue;
        const bool is_light = light && options_.fit_space == FitSpace::each && ending == ".glb";
        const hmesh::Mesh& from = is_light ? light->mesh : own;
        const hmesh::Mesh read = as_kept(from, ending, arguments_.glb_color_bits);
        if (read.colors == from.colors && read.premultiplied == from.premultiplied) {
            out.push_back({name, ending, is_light ? light->psnr : psnr});
        } else if (draw_samples(read.view(), is_light || options_.fit_space == FitSpace::linear, drawn)) {
            out.push_back({name, ending, measured(drawn, read.premultiplied)});
        }
    }
    if (arguments_.render.empty() || arguments_.render_scale != 1) return out;
    Picture picture;
    if (!draw(own.view(), {1, options_.fit_space == FitSpace::linear}, picture)) return out;
    drawn.clear();
    for (const std::uint8_t sample : picture.samples) drawn.push_back(static_cast<float>(sample * (own.peak / 255)));
    out.push_back({arguments_.render, ".png", measured(drawn, false)});
    return out;
}

double WrittenFiles::operator()(const hmesh::Mesh& mesh, double psnr) const {
    std::optional<LightMesh> light;
    const bool is_linear = options_.fit_space == FitSpace::linear;
    if (is_linear || (options_.fit_space == FitSpace::each && has_output(arguments_, ".glb")))
        light = light_mesh(image_, options_, mesh, parallel_for_);
    double least = is_linear ? light->psnr : psnr;
    for (const WrittenPsnr& file : measure(is_linear ? light->mesh : mesh, least, light)) least = std::min(least, file.psnr);
    return least - margin;
}

}  // namespace tool
