// sprites: what drop_transparent() and outline() make of icons, as Markdown tables.
//
//     sprites [--vertices 500] [--threshold 2] [--margin 0.5] IMAGE...
//
// Images have 4 channels of 8 bits. Meshes are those of the effort normal, fitted to colours times alpha. PSNR is of the three
// colours, laid over black, grey and white, peak 255, the mean over pixels and channels; "area" is a share of the rectangle, and
// "least" that of the pixels whose alpha is above 0.
//
// Outlines are compared with two other ways, which are made to keep the same pixels with the same margin:
// - marching squares and Douglas-Peucker: the border of the pixels above alpha 0, half way between centres, thinned out with a
//   tolerance, and moved outward as far as it takes to have all inside (bisection to 1/16 px);
// - AutoPolygon of cocos2d-x 3 (2d/CCAutoPolygon.cpp), as published: the border along the pixels' corners, thinned out with a
//   tolerance and moved outward by as much, then cut to the rectangle; here of all islands, and further outward where that
//   keeps not all inside.
// Both move borders by Clipper with mitred corners. These lines are there if it was found when this was built (Debian:
// libpolyclipping-dev). Beside each stands outline() with as many vertices, and with as large an area.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>

#include "common.hpp"

#ifdef HMESH_HAS_CLIPPER
#include <polyclipping/clipper.hpp>
#endif

namespace {

using Sprite = hmesh::ImageView<std::uint8_t, 4>;

// --- meshes ---
using Drawn = hmesh::Image<float, 4>;

// Colours of a premultiplied picture over a grey of this level.
double psnr_over(const Drawn& picture, const hmesh::Image<std::uint8_t, 4>& wanted, double ground) {
    double energy = 0;
    const std::size_t pixels = picture.size() / 4;
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const double is = picture.data()[4 * i + k] + (1 - picture.data()[4 * i + 3] / 255.0) * ground;
            const double was = wanted.data()[4 * i + k] + (1 - wanted.data()[4 * i + 3] / 255.0) * ground;
            energy += (is - was) * (is - was);
        }
    return hmesh::kit::psnr_of_energy(energy, 3.0 * static_cast<double>(pixels), 255);
}

std::array<double, 3> psnr_over_grounds(const hmesh::Mesh& mesh, const hmesh::Image<std::uint8_t, 4>& wanted) {
    const hmesh::RenderResult<4> drawn = hmesh::render<4>(mesh.view());
    return {psnr_over(drawn.image, wanted, 0), psnr_over(drawn.image, wanted, 128), psnr_over(drawn.image, wanted, 255)};
}

double share_above(const Sprite& view, double threshold) {
    std::size_t count = 0;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) count += view.pixel(x, y)[3] > threshold ? 1 : 0;
    return static_cast<double>(count) / (static_cast<double>(view.width) * view.height);
}

void print_mesh(const std::string& name, const Sprite& view, std::int64_t vertices, double threshold) {
    hmesh::Options options;
    options.premultiplied = true;
    options.target = hmesh::Target::at_most(vertices);
    hmesh::Result result = hmesh::mesh_image(view, options);
    if (!result.has_mesh()) return;
    const hmesh::Image<std::uint8_t, 4> wanted = hmesh::kit::premultiply(view);
    const double all = static_cast<double>(view.width) * view.height;
    const auto before = psnr_over_grounds(result.mesh, wanted);
    std::printf("| %s | as meshed | %zu | %zu | | 1.0000 | %.4f | %.2f | %.2f | %.2f | %.3f |\n", name.c_str(),
                result.report.vertices, result.report.faces, share_above(view, 0), before[0], before[1], before[2],
                result.report.psnr);
    const hmesh::SpriteReport report = hmesh::drop_transparent(result, view, options, threshold);
    const auto after = psnr_over_grounds(result.mesh, wanted);
    std::printf("| | dropped | %zu | %zu | %zu | %.4f | %.4f | %+.3f | %+.3f | %+.3f | %.3f |\n", result.report.vertices,
                result.report.faces, report.opaque_faces, report.area / all, share_above(view, 0), after[0] - before[0],
                after[1] - before[1], after[2] - before[2], result.report.psnr);
}

// --- outlines ---
#ifdef HMESH_HAS_CLIPPER
using ClipperLib::Path;
using ClipperLib::Paths;
constexpr double unit = 1024;  // of Clipper's whole numbers, a px

ClipperLib::IntPoint clipper_point(double x, double y) {
    return {static_cast<ClipperLib::cInt>(std::llround(x * unit)), static_cast<ClipperLib::cInt>(std::llround(y * unit))};
}

// The border of the pixels along their corners.
std::vector<hmesh::kit::Loop> pixel_borders(const hmesh::kit::Mask& mask) { return hmesh::kit::contours_of(mask, 0, true).loops; }

// That of marching squares: half way between the centres of pixels inside and outside, which is where the middles of the sides
// of the pixels' border are.
Path marching_squares(const hmesh::kit::Loop& border) {
    Path path;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const auto a = border[i], b = border[(i + 1) % border.size()];
        const int steps = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y)) / hmesh::kit::units_per_px;
        for (int k = 0; k < steps; ++k) {
            const double t = (k + 0.5) / steps;
            path.push_back(clipper_point((a.x + t * (b.x - a.x)) / 256, (a.y + t * (b.y - a.y)) / 256));
        }
    }
    return path;
}
Path pixel_corners(const hmesh::kit::Loop& border) {
    Path path;
    for (const auto p : border) path.push_back(clipper_point(p.x / 256.0, p.y / 256.0));
    return path;
}

double distance(const ClipperLib::IntPoint& p, const ClipperLib::IntPoint& a, const ClipperLib::IntPoint& b) {
    const double ux = static_cast<double>(b.X - a.X), uy = static_cast<double>(b.Y - a.Y);
    const double px = static_cast<double>(p.X - a.X), py = static_cast<double>(p.Y - a.Y), size = std::hypot(ux, uy);
    return (size > 0 ? std::abs(ux * py - uy * px) / size : std::hypot(px, py)) / unit;
}
void douglas_peucker(const Path& path, std::size_t first, std::size_t last, double tolerance, Path& out) {
    double most = 0;
    std::size_t split = first;
    for (std::size_t i = first + 1; i < last; ++i)
        if (const double d = distance(path[i], path[first], path[last]); d > most) most = d, split = i;
    if (most <= tolerance) return out.push_back(path[first]);
    douglas_peucker(path, first, split, tolerance, out);
    douglas_peucker(path, split, last, tolerance, out);
}
// A closed path, from its first point and the one that is farthest from it.
Path thinned(Path path, double tolerance) {
    std::size_t farthest = 0;
    const auto far = [&](std::size_t i) {
        return std::hypot(static_cast<double>(path[i].X - path[0].X), static_cast<double>(path[i].Y - path[0].Y));
    };
    for (std::size_t i = 1; i < path.size(); ++i)
        if (far(i) > far(farthest)) farthest = i;
    path.push_back(path.front());
    Path out;
    douglas_peucker(path, 0, farthest, tolerance, out);
    douglas_peucker(path, farthest, path.size() - 1, tolerance, out);
    return out;
}

Paths moved_out(const Paths& paths, double by, const hmesh::kit::Mask& mask) {
    ClipperLib::ClipperOffset offset(10);
    offset.AddPaths(paths, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    Paths moved, cut;
    offset.Execute(moved, by * unit);
    ClipperLib::Clipper clipper;
    clipper.AddPaths(moved, ClipperLib::ptSubject, true);
    clipper.AddPath({clipper_point(0, 0), clipper_point(mask.width, 0), clipper_point(mask.width, mask.height),
                     clipper_point(0, mask.height)},
                    ClipperLib::ptClip, true);
    clipper.Execute(ClipperLib::ctIntersection, cut, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    return cut;
}
double area_of(const Paths& paths) {
    double sum = 0;
    for (const Path& path : paths) sum += ClipperLib::Area(path);
    return sum / (unit * unit);
}
std::size_t vertices_of(const Paths& paths) {
    std::size_t sum = 0;
    for (const Path& path : paths) sum += path.size();
    return sum;
}
// Whether all that has to be inside is, but for what rounding takes.
bool covers(const Paths& paths, const Paths& needed) {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(needed, ClipperLib::ptSubject, true);
    clipper.AddPaths(paths, ClipperLib::ptClip, true);
    Paths missing;
    clipper.Execute(ClipperLib::ctDifference, missing, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    return area_of(missing) < 0.01;
}
// Moved out as little as covers, from `least` on.
Paths covering(const Paths& paths, double least, const Paths& needed, const hmesh::kit::Mask& mask) {
    Paths out = moved_out(paths, least, mask);
    if (covers(out, needed)) return out;
    double low = least, high = least + 0.5;
    while (!covers(moved_out(paths, high, mask), needed)) low = high, high += 1;
    while (high - low > 1.0 / 16) (covers(moved_out(paths, 0.5 * (low + high), mask), needed) ? high : low) = 0.5 * (low + high);
    return moved_out(paths, high, mask);
}
#endif

hmesh::Outline outline_with(const Sprite& view, double margin, int most, double tolerance) {
    hmesh::OutlineOptions options;
    options.margin = margin;
    options.max_vertices = most;
    options.tolerance = tolerance;
    return hmesh::outline(view, options);
}

void print_outlines(const std::string& name, const Sprite& view, double margin) {
    const double begin = bench::wall_seconds();
    const hmesh::Outline own = outline_with(view, margin, 0, hmesh::OutlineOptions().tolerance);
    const double seconds = bench::wall_seconds() - begin;
    std::printf("| %s | outline(), default | %zu | %+.2f %% | | | %.1f |\n", name.c_str(), own.mesh.vertex_count(),
                100 * (own.area / own.covered - 1), 1e3 * seconds);
#ifdef HMESH_HAS_CLIPPER
    const hmesh::kit::Mask mask = hmesh::detail::mask_above(view, 0);
    const auto borders = pixel_borders(mask);
    Paths needed;
    for (const auto& loop : hmesh::kit::contours_of(mask, static_cast<int>(std::lround(256 * margin)), true).loops)
        needed.push_back(pixel_corners(loop));
    const auto print = [&](const char* method, double tolerance, const Paths& paths) {
        const auto count = vertices_of(paths);
        const double more = area_of(paths) / own.covered - 1;
        const hmesh::Outline same = outline_with(view, margin, static_cast<int>(count), 0);
        const hmesh::Outline as_large = outline_with(view, margin, 0, std::max(0.0, more) * own.covered / own.length);
        std::printf("| | %s, %g px | %zu | %+.2f %% | %+.2f %% with %zu | %zu | |\n", method, tolerance, count, 100 * more,
                    100 * (same.area / same.covered - 1), same.mesh.vertex_count(), as_large.mesh.vertex_count());
    };
    for (const double tolerance : {1.0, 2.0, 4.0}) {
        Paths squares, corners;
        for (const auto& border : borders) {
            const Path one = thinned(marching_squares(border), tolerance), other = thinned(pixel_corners(border), tolerance);
            if (one.size() > 2) squares.push_back(one);
            if (other.size() > 2) corners.push_back(other);
        }
        print("marching squares + Douglas-Peucker", tolerance, covering(squares, 0, needed, mask));
        print("AutoPolygon", tolerance, covering(corners, tolerance, needed, mask));
    }
#endif
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> images;
    double vertices = 500, threshold = 2, margin = 0.5;
    bool is_good = true;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.compare(0, 2, "--") != 0) images.push_back(argument);
        else if (++i == argc) is_good = false;
        else if (argument == "--vertices") vertices = std::atof(argv[i]);
        else if (argument == "--threshold") threshold = std::atof(argv[i]);
        else if (argument == "--margin") margin = std::atof(argv[i]);
        else is_good = false;
    }
    if (!is_good || images.empty()) {
        std::fprintf(stderr, "usage: sprites [--vertices 500] [--threshold 2] [--margin 0.5] IMAGE...\n");
        return 2;
    }
    std::vector<tool::ImageFile> files;
    for (const std::string& path : images) {
        tool::ImageFile file;
        const std::string why = tool::read_image(path, file);
        if (!why.empty() || file.channels != 4 || file.bits != 8) {
            std::fprintf(stderr, "sprites: %s: %s\n", path.c_str(), why.empty() ? "not 4 channels of 8 bits" : why.c_str());
            return 1;
        }
        files.push_back(std::move(file));
    }
    const auto view_of = [](const tool::ImageFile& file) { return Sprite{file.samples8.data(), file.width, file.height, 0}; };
    std::puts("| image | mesh | vertices | faces | opaque | area | least | PSNR black | grey | white | report |");
    std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
    for (std::size_t i = 0; i < files.size(); ++i)
        print_mesh(bench::file_name(images[i]), view_of(files[i]), static_cast<std::int64_t>(vertices), threshold);
    std::puts("\n| image | method | vertices | area over what has to be inside | outline() with as many | as large | ms |");
    std::puts("|---|---|---|---|---|---|---|");
    for (std::size_t i = 0; i < files.size(); ++i) print_outlines(bench::file_name(images[i]), view_of(files[i]), margin);
    return 0;
}
