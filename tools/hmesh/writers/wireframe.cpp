#include "writers/wireframe.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/unrolled.hpp"

namespace tool {
namespace {

struct Coverage {
    int width, height;
    std::vector<std::uint8_t> share;  // 255: wholly under a line

    void add(int x, int y, double amount) {
        if (x < 0 || x >= width || y < 0 || y >= height || amount <= 0) return;
        std::uint8_t& pixel = share[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        pixel = std::max(pixel, static_cast<std::uint8_t>(std::min(1.0, amount) * 255 + 0.5));
    }
};

// Walks along the axis in which the line is longer; a pixel's share is one less its distance beyond the line's edge.
void draw_line(hmesh::kit::Point a, hmesh::kit::Point b, double line_width, Coverage& coverage) {
    const bool steep = std::abs(b.y - a.y) > std::abs(b.x - a.x);
    if (steep) {
        std::swap(a.x, a.y);
        std::swap(b.x, b.y);
    }
    if (b.x < a.x) std::swap(a, b);
    const double slope = b.x > a.x ? (b.y - a.y) / (b.x - a.x) : 0;
    const double cosine = 1 / std::sqrt(1 + slope * slope), reach = (0.5 * line_width + 0.5) / cosine;
    const int size = steep ? coverage.height : coverage.width, across = steep ? coverage.width : coverage.height;
    const int first = static_cast<int>(std::max(0.0, std::min<double>(size, std::floor(a.x))));
    const int last = static_cast<int>(std::max(-1.0, std::min<double>(size - 1, std::floor(b.x))));
    for (int i = first; i <= last; ++i) {
        const double center = a.y + (std::max(a.x, std::min(b.x, i + 0.5)) - a.x) * slope;
        const int low = static_cast<int>(std::max(0.0, std::min<double>(across, std::floor(center - reach))));
        const int high = static_cast<int>(std::max(-1.0, std::min<double>(across - 1, std::floor(center + reach))));
        for (int j = low; j <= high; ++j) {
            const double amount = 0.5 * line_width + 0.5 - std::abs(j + 0.5 - center) * cosine;
            coverage.add(steep ? j : i, steep ? i : j, amount);
        }
    }
}

}  // namespace

hmesh::Status draw_wireframe(const hmesh::MeshView& mesh, hmesh::Image<std::uint8_t, 3>& picture,
                             const WireframeOptions& options) {
    if (const hmesh::Status status = hmesh::check(mesh, hmesh::kit::max_channels); !status) return status;
    if (mesh.right() < 1 || mesh.bottom() < 1)
        return {hmesh::Errc::invalid_argument, "the mesh's size must be at least 1", std::min(mesh.width, mesh.height), 1};
    if (mesh.periodic != hmesh::Periodic::none) {
        const hmesh::Mesh whole = hmesh::kit::unrolled(mesh);
        return draw_wireframe(whole.view(), picture, options);
    }
    Coverage coverage{picture.width(), picture.height(), std::vector<std::uint8_t>(picture.size() / 3)};
    // As render() places them.
    const double scale_x = static_cast<double>(hmesh::kit::extent(picture.width(), mesh.samples)) / mesh.right();
    const double scale_y = static_cast<double>(hmesh::kit::extent(picture.height(), mesh.samples)) / mesh.bottom();
    const double shift = hmesh::kit::inset(mesh.samples);
    const auto place = [&](std::uint32_t v) {
        const float* at = mesh.positions + 2 * std::size_t{v};
        return hmesh::kit::Point{static_cast<double>(at[0]) * scale_x + shift, static_cast<double>(at[1]) * scale_y + shift};
    };
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (std::size_t k = 0; k < 3; ++k)
            draw_line(place(mesh.faces[f][k]), place(mesh.faces[f][(k + 1) % 3]), options.width, coverage);
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double share = coverage.share[i / 3] * (options.opacity / 255);
        const auto old = static_cast<double>(picture.data()[i]);
        picture.data()[i] = hmesh::PixelTraits<std::uint8_t>::from_real(old + share * (options.color[i % 3] - old));
    }
    return {};
}

}  // namespace tool
