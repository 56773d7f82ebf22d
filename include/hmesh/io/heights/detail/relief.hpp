/// \file
/// Relief: a mesh as a surface in space, vertex after vertex: position, normal and place in the draped image.
///
/// Normals are those of the samples. The slope at a sample is the central difference of its neighbours, one-sided where one of
/// them has no data or is outside of the image; that at a vertex is interpolated bilinearly between the four samples around it
/// that have data. It follows from at most 12 samples, the outermost one step from those four: so tiles that are given as much
/// around them agree. Where there are no samples the normal is that of the faces around the vertex, weighted by their area.
///
/// 12 samples are read for a normal. Nothing is allocated unless normals come from faces: then 24 bytes a vertex.
#ifndef HMESH_IO_HEIGHTS_DETAIL_RELIEF_HPP
#define HMESH_IO_HEIGHTS_DETAIL_RELIEF_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/model_parts.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/heights/height_samples.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A point or a vector in space.
using Vector3 = std::array<double, 3>;

/// a - b.
[[nodiscard]] inline Vector3 difference(const Vector3& a, const Vector3& b) noexcept {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// The inner product.
[[nodiscard]] inline double dot(const Vector3& a, const Vector3& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/// The cross product.
[[nodiscard]] inline Vector3 cross(const Vector3& a, const Vector3& b) noexcept {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// The length.
[[nodiscard]] inline double length(const Vector3& a) noexcept { return std::sqrt(dot(a, a)); }
/// The vector with the length 1; `otherwise` where it has none.
[[nodiscard]] inline Vector3 unit(const Vector3& a, const Vector3& otherwise) noexcept {
    // Scaled first, since squares of numbers above 1e154 or below 1e-154 are no doubles.
    const double largest = std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
    if (!(largest > 0) || !kit::is_finite(largest)) return otherwise;
    const Vector3 scaled = {a[0] / largest, a[1] / largest, a[2] / largest};
    const double size = length(scaled);
    return {scaled[0] / size, scaled[1] / size, scaled[2] / size};
}
/// Twice the area of a triangle, along its normal: towards where it is counter-clockwise.
[[nodiscard]] inline Vector3 area_normal(const Vector3& a, const Vector3& b, const Vector3& c) noexcept {
    if (b == c) return {};  // contracted products leave rounding
    return cross(difference(b, a), difference(c, a));
}

/// The steps between samples of a mesh's width and height: W x H of squares, W - 1 x H - 1 of points.
[[nodiscard]] inline std::array<double, 2> plane_size(const MeshView& mesh) noexcept {
    return {static_cast<double>(mesh.right()), static_cast<double>(mesh.bottom())};
}

/// The sums of the normals of the faces around each vertex, as long as twice their area. O(vertices + faces).
[[nodiscard]] inline std::vector<Vector3> face_normals(const MeshView& mesh, FunctionRef<Vector3(std::size_t vertex)> position) {
    std::vector<Vector3> sums(mesh.vertex_count);
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const Triangle face = turned(mesh.faces[f]);
        const Vector3 normal = area_normal(position(face[0]), position(face[1]), position(face[2]));
        for (const std::uint32_t v : face)
            for (std::size_t k = 0; k < 3; ++k) sums[v][k] += normal[k];
    }
    return sums;
}

/// The slope of the samples at (x, y) of the mesh's plane, in stored values a step to the right and down; false where none of the
/// four samples around has data.
[[nodiscard]] inline bool slope_at(const HeightSamples& samples, Samples kind, int channel, const std::array<double, 2>& at,
                                   std::array<double, 2>& slope) noexcept {
    const std::array<int, 2> size = {samples.width(), samples.height()}, first = {samples.first_column(), samples.first_row()};
    std::array<int, 2> base{};
    std::array<double, 2> share{};  // of the samples behind base
    for (std::size_t k = 0; k < 2; ++k) {
        const double place = at[k] + first[k] - (kind == Samples::squares ? 0.5 : 0.0);
        const double held = std::max(0.0, std::min(place, size[k] - 1.0));
        base[k] = static_cast<int>(held);
        share[k] = held - base[k];
    }
    std::array<double, 2> sum{};
    double weights = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const std::array<int, 2> behind = {corner % 2, corner / 2};
        const double weight = (behind[0] != 0 ? share[0] : 1 - share[0]) * (behind[1] != 0 ? share[1] : 1 - share[1]);
        if (!(weight > 0)) continue;  // and perhaps outside
        const std::array<int, 2> place = {base[0] + behind[0], base[1] + behind[1]};
        const double middle = samples.value(place[0], place[1], channel);
        if (!kit::is_finite(middle)) continue;
        weights += weight;
        for (std::size_t k = 0; k < 2; ++k) {
            double low = middle, high = middle, steps = 0;
            const auto reach = [&](int by, double& value) {
                std::array<int, 2> next = place;
                next[k] += by;
                if (next[k] < 0 || next[k] >= size[k]) return;
                const double there = samples.value(next[0], next[1], channel);
                if (kit::is_finite(there)) value = there, ++steps;
            };
            reach(-1, low);
            reach(1, high);
            if (steps > 0) sum[k] += weight * ((high - low) / steps);
        }
    }
    if (!(weights > 0)) return false;
    for (std::size_t k = 0; k < 2; ++k) slope[k] = sum[k] / weights;
    return true;
}

/// Refuses a channel that the mesh does not have, and units that are none.
[[nodiscard]] inline Status check_height_channel(const MeshView& mesh, const HeightChannel& z) noexcept {
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    if (z.channel < 0) return {Errc::invalid_argument, "the channel of heights must be at least 0", z.channel, 0};
    if (z.channel >= mesh.channels)
        return {Errc::invalid_argument, "the channel of heights must be one of the mesh's", z.channel, mesh.channels - 1};
    return kit::check_ranges({{"the scale of heights must be a number that a float holds", z.scale, -most, most},
                              {"the offset of heights must be a number that a float holds", z.offset, -most, most}});
}

/// Refuses meshes of heights that no model holds. O(n).
[[nodiscard]] inline Status check_height_mesh(const MeshView& mesh, const HeightSamples& samples,
                                              const HeightChannel& z) noexcept {
    if (const Status status = check_for_export(mesh, 16); !status) return status;
    if (const Status status = check_height_channel(mesh, z); !status) return status;
    return samples.check_for(mesh, z.channel);
}

/// How high a vertex is, in units.
[[nodiscard]] inline double height_of(const MeshView& mesh, const HeightChannel& z, std::size_t vertex) noexcept {
    const float value = mesh.colors[static_cast<std::size_t>(mesh.channels) * vertex + static_cast<std::size_t>(z.channel)];
    return z.offset + z.scale * static_cast<double>(value);
}

/// A mesh as a surface in space. All functions of a vertex cost O(1).
class Relief {
  public:
    /// Of what check_relief() accepts, and of views that outlive this object. Call find_normals() before normal().
    Relief(const MeshView& mesh, const HeightSamples& samples, const HeightOptions& options, bool is_y_up) noexcept
        : mesh_(mesh), samples_(samples), options_(options), is_y_up_(is_y_up) {}

    /// Where a vertex is, in the axes of the file; moved in the mesh's plane by `shift` px, and at another height if there is
    /// one.
    [[nodiscard]] Vector3 position(std::size_t vertex, const std::array<double, 2>& shift = {},
                                   const double* height = nullptr) const noexcept {
        Vector3 at = on_map(vertex, shift);
        if (height != nullptr) at[2] = *height;
        return in_file(at);
    }
    /// How high a vertex is, in units.
    [[nodiscard]] double height(std::size_t vertex) const noexcept { return height_of(mesh_, options_.z, vertex); }

    /// Prepares normal(): sums up the normals of faces where there are no samples.
    void find_normals() {
        if (samples_.is_empty()) sums_ = face_normals(mesh_, [this](std::size_t vertex) { return on_map(vertex); });
    }
    /// The unit normal at a vertex, upward, in the axes of the file.
    [[nodiscard]] Vector3 normal(std::size_t vertex) const noexcept {
        constexpr Vector3 upward = {0, 0, 1};
        if (samples_.is_empty()) return in_file(unit(sums_[vertex], upward));
        std::array<double, 2> slope{};
        if (!slope_at(samples_, mesh_.samples, options_.z.channel, plane(vertex), slope)) return in_file(upward);
        const double scale = options_.z.scale;
        return in_file(unit({0 - scale * slope[0] / options_.x_step, scale * slope[1] / options_.y_step, 1}, upward));
    }

    /// u, to the right, and v, down, of a vertex in the image that is draped over the terrain: 0 to 1.
    [[nodiscard]] std::array<double, 2> texture_place(std::size_t vertex) const noexcept {
        std::array<double, 2> at = plane(vertex);
        if (options_.drape == Drape::raster) {
            const double half = mesh_.samples == Samples::points ? 0.5 : 0;
            return {(at[0] + half) / mesh_.width, (at[1] + half) / mesh_.height};
        }
        const std::array<double, 2> size = plane_size(mesh_);
        return {at[0] / size[0], at[1] / size[1]};
    }

  private:
    [[nodiscard]] std::array<double, 2> plane(std::size_t vertex) const noexcept {
        return {static_cast<double>(mesh_.positions[2 * vertex]), static_cast<double>(mesh_.positions[2 * vertex + 1])};
    }
    [[nodiscard]] Vector3 on_map(std::size_t vertex, const std::array<double, 2>& shift = {}) const noexcept {
        const std::array<double, 2> at = plane(vertex);
        // Sums of whole columns and of floats are exact, so that tiles round alike.
        return {options_.x_origin + options_.x_step * (options_.first_column + at[0] + shift[0]),
                options_.y_origin - options_.y_step * (options_.first_row + at[1] + shift[1]), height(vertex)};
    }
    [[nodiscard]] Vector3 in_file(const Vector3& a) const noexcept {
        if (!is_y_up_) return a;
        return {a[0], a[2], 0 - a[1]};  // not -0 for 0
    }

    MeshView mesh_;
    HeightSamples samples_;
    HeightOptions options_;
    bool is_y_up_;
    std::vector<Vector3> sums_;
};

/// Refuses what no file of a model holds: meshes that check_height_mesh() refuses, options outside their range, and coordinates
/// beyond all floats. O(n).
[[nodiscard]] inline Status check_relief(const MeshView& mesh, const HeightSamples& samples,
                                         const HeightOptions& options) noexcept {
    if (const Status status = check_height_mesh(mesh, samples, options.z); !status) return status;
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max()),
                   least = static_cast<double>(std::numeric_limits<float>::min());
    if (const Status status = kit::check_ranges(
            {{"the step to the east must be positive and a length that a float holds", options.x_step, least, most},
             {"the step to the south must be positive and a length that a float holds", options.y_step, least, most},
             {"the x of the origin must be a number that a float holds", options.x_origin, -most, most},
             {"the y of the origin must be a number that a float holds", options.y_origin, -most, most}});
        !status)
        return status;
    if (options.up > UpAxis::y)
        return {Errc::invalid_argument, "the axis that is up is none of those known", static_cast<int>(options.up), 2};
    if (options.drape > Drape::mesh)
        return {Errc::invalid_argument, "the kind of drape is none of those known", static_cast<int>(options.drape), 2};
    if (options.texture != nullptr)
        if (const Status status = check_file_name(options.texture); !status) return status;
    const Relief relief(mesh, {}, options, false);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v)
        for (const double coordinate : relief.position(v))
            if (!kit::is_within(coordinate, -most, most))
                return {Errc::not_finite, "the model has a coordinate that no float holds, at vertex",
                        static_cast<std::int64_t>(v), 0};
    return {};
}

/// Whether y is up in a file whose format has it so by itself, or not.
[[nodiscard]] inline bool is_y_up(const HeightOptions& options, bool is_usual) noexcept {
    return options.up == UpAxis::y || (options.up == UpAxis::usual && is_usual);
}

/// Refuses what no file of a model of heights holds, which has room for `most` vertices and as many faces. O(n).
[[nodiscard]] inline Status check_height_model(const MeshView& mesh, const HeightSamples& samples, const HeightOptions& options,
                                               std::uint64_t most) {
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a model of heights holds");
        !status)
        return status;
    if (options.texture != nullptr && options.drape == Drape::none)
        return {Errc::invalid_argument, "a texture is named, but Drape::none leaves no coordinates to show it by"};
    return check_relief(mesh, samples, options);
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_DETAIL_RELIEF_HPP
