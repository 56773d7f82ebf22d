/// \file
/// CompactWriter: a mesh on its way to a compact file, what it is before a bit is coded.
///
/// Vertices become points of a frame of 1/256 px, moved to a lattice where one is asked for, one for each place and colour; faces
/// become those of a tiling of the frame, of which some are shown; colours become whole numbers.
#ifndef HMESH_IO_DETAIL_COMPACT_WRITER_HPP
#define HMESH_IO_DETAIL_COMPACT_WRITER_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/body.hpp"
#include "hmesh/io/compact/container.hpp"
#include "hmesh/io/compact/options.hpp"
#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/sites.hpp"
#include "hmesh/io/compact/triangulation.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/torus.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A float as an integer of the same order.
[[nodiscard]] inline std::uint32_t ordered_bits(float value) noexcept {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, 4);
    return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

/// What write_compact() says of a vertex that cannot be moved to the lattice.
inline constexpr const char* lattice_has_no_site = "the lattice is too coarse for the mesh: it has no site for vertex";

/// A mesh on its way to a compact file: what it is, before a bit is coded.
class CompactWriter {
  public:
    /// Of a mesh that outlives it.
    explicit CompactWriter(const MeshView& mesh) noexcept : mesh_(&mesh) {}

    /// Finds all that is to be written, or why the mesh cannot be.
    [[nodiscard]] Status prepare(const CompactOptions& options) {
        head_.channels = mesh_->channels;
        head_.colors = options.colors;
        head_.premultiplied = mesh_->premultiplied;
        head_.linear = options.linear;
        head_.periodic = mesh_->periodic;
        head_.samples = mesh_->samples;
        head_.width = mesh_->width;
        head_.height = mesh_->height;
        head_.peak = mesh_->peak;
        head_.color_step = options.color_step;
        head_.table = options.table == nullptr ? 0 : options.table->number;
        if (const Status status = find_places(); !status) return status;
        if (options.lattice > 0) {
            head_.step = options.lattice;
            if (const Status status = move_to_lattice(); !status) return status;
        } else {
            find_lattice(options.bare);
        }
        if (const Status status = find_points(); !status) return status;
        if (const Status status = find_faces(); !status) return status;
        find_colors();
        if (head_.periodic != Periodic::none) {
            if (head_.color_step > 0)
                return {Errc::invalid_argument, "periodic meshes have exact colours, as copies on the cut have the same ones",
                        head_.color_step, 0};
            if (const Status status = kit::check_periodic(*mesh_); !status) return status;
        }
        if (options.bare && !is_bare(head_))
            return {Errc::invalid_argument,
                    "a bare compact mesh must have peak 255, 8 bits, positions of whole px, no holes, square samples and no "
                    "period"};
        return {};
    }

    /// The bytes, which are left as they are where it fails.
    [[nodiscard]] Status put(const CompactOptions& options, std::vector<std::uint8_t>& out) {
        const std::vector<Triangle> wanted = body_.faces;
        if (options.bare) {
            put_bare_head(out, head_, options.size_is_told);
        } else {
            out.assign(compact_magic.begin(), compact_magic.end());
            out.push_back(compact_version);
            out.push_back(static_cast<std::uint8_t>(head_.table));
            out.resize(compact_checked);
            put_head(out, head_);
        }
        ArithmeticCoder coder(out);
        constexpr std::size_t any = std::numeric_limits<std::size_t>::max();
        if (const Status status = code_of(options.table)(coder, head_, body_, any, options.table, {}); !status) return status;
        // Points and colours are what they are; the flips were found elsewhere than they were told.
        HMESH_ASSERT(body_.faces == wanted);
        if (body_.faces != wanted) return {Errc::invalid_argument, "the flips of a compact file do not lead to the mesh"};
        coder.finish();
        if (options.bare) return {};
        const auto put_at = [&](std::size_t at, std::uint32_t value) {
            for (std::size_t k = 0; k < 4; ++k) out[at + k] = static_cast<std::uint8_t>(value >> (8 * k) & 0xffU);
        };
        put_at(6, static_cast<std::uint32_t>(out.size()));
        put_at(10, crc32(out.data() + compact_checked, out.size() - compact_checked, crc32(out.data(), 10)));
        return {};
    }

  private:
    using Index = Triangulation::Index;

    // Positions in 1/256 px, and the rectangle that holds all.
    [[nodiscard]] Status find_places() {
        places_.reserve(mesh_->vertex_count);
        GridPoint low{0, 0}, high{256 * mesh_->right(), 256 * mesh_->bottom()};
        for (std::size_t v = 0; v < mesh_->vertex_count; ++v) {
            std::array<std::int32_t, 2> at{};
            for (std::size_t k = 0; k < 2; ++k) {
                const double place = 256 * static_cast<double>(mesh_->positions[2 * v + k]);
                if (place != std::floor(place) || std::abs(place) > 16777216)
                    return {Errc::invalid_argument,
                            "a compact file holds positions of whole 1/256 px up to 65536 px, not that of vertex",
                            static_cast<std::int64_t>(v)};
                at[k] = static_cast<std::int32_t>(place);
            }
            if (mesh_->periodic == Periodic::none &&
                (at[0] < 0 || at[1] < 0 || at[0] > 256 * mesh_->right() || at[1] > 256 * mesh_->bottom()))
                return {Errc::invalid_argument, "a compact file holds positions inside of the image, not that of vertex",
                        static_cast<std::int64_t>(v)};
            places_.push_back({at[0], at[1]});
            low = {std::min(low.x, at[0]), std::min(low.y, at[1])};
            high = {std::max(high.x, at[0]), std::max(high.y, at[1])};
        }
        head_.left = low.x;
        head_.top = low.y;
        head_.frame_width = static_cast<std::uint32_t>(high.x - low.x);
        head_.frame_height = static_cast<std::uint32_t>(high.y - low.y);
        for (GridPoint& place : places_) place = {place.x - low.x, place.y - low.y};
        return {};
    }
    // The coarsest lattice that holds all positions.
    void find_lattice(bool is_bare_wanted) noexcept {
        std::uint32_t step = 0;
        for (const GridPoint place : places_) {
            if (place.x != static_cast<std::int32_t>(head_.frame_width))
                step = std::gcd(step, static_cast<std::uint32_t>(place.x));
            if (place.y != static_cast<std::int32_t>(head_.frame_height))
                step = std::gcd(step, static_cast<std::uint32_t>(place.y));
        }
        if (step == 0) step = std::max(head_.frame_width, head_.frame_height);
        head_.step = is_bare_wanted && step % 256 == 0 ? 256 : step;
    }
    // Points of the lattice around one that need not be on it.
    struct NearbySites {
        std::array<std::vector<std::int32_t>, 2> along;  // their coordinates on either axis
        std::vector<GridPoint> points;
        kit::Array<kit::Coded> nearest;  // their numbers by distance; of those equally far the one further left, then up
    };
    // Those within `reach` steps on both axes; what is on a side stays there.
    void find_sites(GridPoint from, std::int64_t reach, NearbySites& out) const {
        const std::int64_t step = head_.step;
        const auto find_along = [&](std::int32_t place, std::int64_t side, std::vector<std::int32_t>& along) {
            along.clear();
            if (place == 0 || place == side) return along.push_back(place);
            for (std::int64_t k = place / step - reach + 1; k <= place / step + reach; ++k)
                if (k > 0 && k * step < side) along.push_back(static_cast<std::int32_t>(k * step));
        };
        find_along(from.x, head_.frame_width, out.along[0]);
        find_along(from.y, head_.frame_height, out.along[1]);
        out.points.clear();
        out.nearest.clear();
        for (const std::int32_t x : out.along[0])
            for (const std::int32_t y : out.along[1]) {
                const std::int64_t dx = x - from.x, dy = y - from.y;
                out.nearest.push_back(
                    {static_cast<std::uint64_t>(dx * dx + dy * dy), static_cast<std::uint32_t>(out.points.size())});
                out.points.push_back({x, y});
            }
        kit::sort_by_code(out.nearest);
    }
    // Moves all vertices to the lattice, one after the other, so that the mesh is one at any time.
    [[nodiscard]] Status move_to_lattice() {
        if (head_.periodic != Periodic::none)
            return {Errc::invalid_argument, "periodic meshes are not moved to a lattice", head_.step, 0};
        const auto area = [&](const Triangle& face) { return orient2d(places_[face[0]], places_[face[1]], places_[face[2]]); };
        std::vector<std::vector<std::uint32_t>> faces_at(places_.size());
        for (std::size_t f = 0; f < mesh_->face_count; ++f) {
            if (area(mesh_->faces[f]) <= 0)
                return {Errc::invalid_argument, "a compact file holds faces that are positively oriented, not face",
                        static_cast<std::int64_t>(f)};
            for (const std::uint32_t v : mesh_->faces[f]) faces_at[v].push_back(static_cast<std::uint32_t>(f));
        }
        const auto is_free = [&](std::size_t v) {
            return std::all_of(faces_at[v].begin(), faces_at[v].end(),
                               [&](std::uint32_t f) { return area(mesh_->faces[f]) > 0; });
        };
        NearbySites sites;
        std::vector<std::size_t> left(places_.size()), still;
        std::iota(left.begin(), left.end(), std::size_t{0});
        for (std::int64_t reach = 1; !left.empty(); reach *= 2) {
            if (reach > 8) return {Errc::invalid_argument, lattice_has_no_site, static_cast<std::int64_t>(left[0]), head_.step};
            still.clear();
            for (const std::size_t v : left) {
                const GridPoint from = places_[v];
                find_sites(from, reach, sites);
                bool is_found = false;
                for (const kit::Coded& choice : sites.nearest) {
                    places_[v] = sites.points[choice.number];
                    is_found = is_free(v);
                    if (is_found) break;
                }
                if (is_found) continue;
                places_[v] = from;
                still.push_back(v);
            }
            left.swap(still);
        }
        return {};
    }
    // The points in the file's order, and which of them each vertex is.
    [[nodiscard]] Status find_points() {
        const auto [columns, rows] = lattice_of(head_);
        std::array<kit::Array<kit::Coded>, 5> parts;  // vertices by the way to their site
        const Halving inside(std::max(columns, 2U) - 1, std::max(rows, 2U) - 1);
        point_of_.assign(places_.size(), Triangulation::none);
        // Of vertices at one place, as cuts of periodic images have where they meet themselves, those of one colour become one.
        bool has_twins = false;
        std::array<std::size_t, 4> corners{};
        corners.fill(places_.size());
        const auto is_same = [&](std::size_t v, std::size_t w) {
            const auto channels = static_cast<std::size_t>(head_.channels);
            const float* const colors = mesh_->colors;
            return std::equal(colors + channels * v, colors + channels * (v + 1), colors + channels * w);
        };
        for (std::size_t v = 0; v < places_.size(); ++v) {
            const auto site = [&](std::int32_t place, std::uint32_t side) {
                const auto at = static_cast<std::uint32_t>(place);
                return at == side ? CompactHead::sites(side, head_.step) : at / head_.step;
            };
            const std::uint32_t x = site(places_[v].x, head_.frame_width), y = site(places_[v].y, head_.frame_height);
            const bool on_side = y == 0 || y == rows, on_end = x == 0 || x == columns;
            if (on_side && on_end) {
                const std::size_t corner = y == 0 ? (x == 0 ? 0 : 1) : (x == 0 ? 3 : 2);
                if (corners[corner] == places_.size()) corners[corner] = v;
                has_twins = has_twins || !is_same(corners[corner], v);
                point_of_[v] = static_cast<Index>(corner);
                continue;
            }
            const std::size_t part = y == 0 ? 0 : x == columns ? 1 : y == rows ? 2 : x == 0 ? 3 : 4;
            parts[part].push_back({part == 4 ? inside.way({x - 1, y - 1}) : on_side ? x - 1 : y - 1, static_cast<Index>(v)});
        }
        Index next = 4;
        for (std::size_t part = 0; part < 5; ++part) {
            kit::sort_by_code(parts[part]);
            for (std::size_t k = 0; k < parts[part].size(); ++k) {
                const auto& [way, v] = parts[part][k];
                if (k > 0 && parts[part][k - 1].code == way) {
                    has_twins = has_twins || !is_same(parts[part][k - 1].number, v);
                    point_of_[v] = next - 1;
                    continue;
                }
                point_of_[v] = next++;
                body_.sites[part].push_back(part == 4 ? inside.first(way, inside.levels())
                                                      : Site{static_cast<std::uint32_t>(way), 0});
            }
        }
        if (has_twins)
            return {Errc::invalid_argument, "a compact file holds one colour at a place, and the mesh has two somewhere"};
        if (next > CompactHead::widest / 2)
            return {Errc::invalid_argument, "a compact file holds at most 2^24 vertices", next, CompactHead::widest / 2};
        is_vertex_.assign(next, false);
        for (const Index point : point_of_) is_vertex_[point] = true;
        return {};
    }
    // The flips that make the mesh's faces, and which faces these are.
    [[nodiscard]] Status find_faces() {
        const std::vector<GridPoint> points = points_of(head_, body_);
        std::vector<Triangle> faces(mesh_->face_count);
        kit::Array<kit::Coded> sides;
        sides.reserve(3 * faces.size());
        std::vector<bool> is_corner(points.size(), false);
        for (std::size_t f = 0; f < faces.size(); ++f) {
            for (std::size_t k = 0; k < 3; ++k) faces[f][k] = point_of_[mesh_->faces[f][k]];
            if (orient2d(points[faces[f][0]], points[faces[f][1]], points[faces[f][2]]) <= 0)
                return {Errc::invalid_argument, "a compact file holds faces that are positively oriented, not face",
                        static_cast<std::int64_t>(f)};
            std::rotate(faces[f].begin(), std::min_element(faces[f].begin(), faces[f].end()), faces[f].end());
            for (std::size_t k = 0; k < 3; ++k) {
                const Index a = faces[f][k], b = faces[f][(k + 1) % 3];
                sides.push_back({kit::code_of(std::min(a, b), std::max(a, b)), 0});
                is_corner[a] = true;
            }
        }
        for (std::size_t v = 0; v < point_of_.size(); ++v)
            if (!is_corner[point_of_[v]])
                return {Errc::invalid_argument, "a compact file holds vertices that are corners of faces, not vertex",
                        static_cast<std::int64_t>(v)};
        kit::sort_by_code(sides);
        std::vector<std::array<Index, 2>> edges;
        edges.reserve(sides.size() / 2);
        for (std::size_t k = 0; k < sides.size(); ++k)
            if (k == 0 || sides[k].code != sides[k - 1].code)
                edges.push_back({static_cast<Index>(sides[k].code >> 32U), static_cast<Index>(sides[k].code)});
        Triangulation whole(points);
        FlipFinder finder(whole);
        const Status overlap(Errc::invalid_argument, "a compact file holds faces that meet in whole edges and do not overlap");
        const bool are_there = finder.insert(edges);  // not, where they take too many flips
        body_.flips = finder.flips();
        if (body_.flips.size() > FlipCoder::most_flips(points.size()))
            return {Errc::invalid_argument,
                    "the mesh's triangles are too unlike Delaunay's for a compact file: it takes more flips", body_.flips.size(),
                    FlipCoder::most_flips(points.size())};
        if (!are_there) return overlap;
        // Its edges are there, unless some cross, so that each of its faces is, unless something lies in it.
        body_.faces = all_faces(whole);
        const std::vector<Triangle>& all = body_.faces;
        std::sort(faces.begin(), faces.end());
        body_.shown.assign(all.size(), false);
        std::size_t found = 0;
        for (std::size_t f = 0; f < all.size(); ++f)
            if (found < faces.size() && all[f] == faces[found]) {
                body_.shown[f] = true;
                ++found;
            }
        if (found < faces.size()) return overlap;
        head_.is_masked = found < all.size();
        return {};
    }
    void find_colors() {
        const auto channels = static_cast<std::size_t>(head_.channels);
        body_.colors.assign(channels * is_vertex_.size(), 0);
        if (head_.color_step > 0) {
            body_.coarse.wanted.assign(channels * is_vertex_.size(), 0);
            for (std::size_t v = 0; v < point_of_.size(); ++v) {
                std::array<double, 4> color{};
                for (std::size_t k = 0; k < channels; ++k)
                    color[k] = 255 * static_cast<double>(share_of_peak(mesh_->colors[channels * v + k], mesh_->peak));
                color = CoarseColors::planes(color, channels >= 3);
                for (std::size_t k = 0; k < channels; ++k) body_.coarse.wanted[channels * point_of_[v] + k] = color[k];
            }
            return;
        }
        for (std::size_t v = 0; v < point_of_.size(); ++v)
            for (std::size_t k = 0; k < channels; ++k) {
                const float value = mesh_->colors[channels * v + k];
                std::uint32_t& number = body_.colors[channels * point_of_[v] + k];
                if (head_.colors == CompactColors::floats) number = ordered_bits(value);
                else if (head_.colors == CompactColors::bits8) number = to_u8(share_of_peak(value, mesh_->peak));
                else number = to_u16(share_of_peak(value, mesh_->peak));
            }
    }

    const MeshView* mesh_;
    CompactHead head_;
    CompactBody body_;
    std::vector<GridPoint> places_;
    std::vector<Index> point_of_;  // of each vertex
    std::vector<bool> is_vertex_;  // of each point
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_COMPACT_WRITER_HPP
