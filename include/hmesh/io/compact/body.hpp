/// \file
/// CompactBody: the arithmetic code of a compact file, written and read by the same function.
#ifndef HMESH_IO_COMPACT_BODY_HPP
#define HMESH_IO_COMPACT_BODY_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/colors/color_coder.hpp"
#include "hmesh/io/compact/colors/foretelling.hpp"
#include "hmesh/io/compact/container.hpp"
#include "hmesh/io/compact/faces.hpp"
#include "hmesh/io/compact/flips.hpp"
#include "hmesh/io/compact/mixer.hpp"
#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/sites.hpp"
#include "hmesh/io/compact/start_table.hpp"
#include "hmesh/io/compact/triangulation.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// What the arithmetic code holds. Points are the corners of the frame, clockwise on the screen from the upper left one, those on
/// its upper, right, lower and left side between them, to the right or down, and those inside in the order of SiteCoder.
struct CompactBody {
    std::array<std::vector<Site>, 5> sites;  ///< between the corners: of the four sides, whose y is 0, and inside; from 0 on
    std::vector<Flip> flips;                 ///< where it is written: see FlipCoder
    std::vector<Triangle> faces;             ///< all of them
    std::vector<bool> shown;                 ///< which of them the mesh has
    std::vector<bool> used;                  ///< which points are corners of such
    std::vector<std::uint32_t> colors;       ///< of all points, `channels` numbers each, of those that are not used any
    CoarseColors coarse;                     ///< how colours are told that are not exact
    std::array<std::size_t, 5> ends{};       ///< bytes so far after the numbers of points, points, flips, mask and colours

    /// The number of points.
    [[nodiscard]] std::size_t point_count() const noexcept {
        std::size_t count = 4;
        for (const std::vector<Site>& part : sites) count += part.size();
        return count;
    }
};

/// The sites along the sides of a frame, that at its beginning not counted.
[[nodiscard]] inline std::array<std::uint32_t, 2> lattice_of(const CompactHead& head) noexcept {
    return {CompactHead::sites(head.frame_width, head.step), CompactHead::sites(head.frame_height, head.step)};
}

/// All points of a body, from the frame's upper left corner on, in 1/256 px. The last sites of a lattice are on the frame's side,
/// nearer than a step where the side is no multiple of it.
[[nodiscard]] inline std::vector<GridPoint> points_of(const CompactHead& head, const CompactBody& body) {
    const auto [columns, rows] = lattice_of(head);
    std::vector<GridPoint> points;
    points.reserve(body.point_count());
    const auto put = [&, step = std::uint64_t{head.step}](std::uint32_t x, std::uint32_t y) {
        points.push_back({static_cast<std::int32_t>(std::min<std::uint64_t>(step * x, head.frame_width)),
                          static_cast<std::int32_t>(std::min<std::uint64_t>(step * y, head.frame_height))});
    };
    put(0, 0);
    put(columns, 0);
    put(columns, rows);
    put(0, rows);
    for (const Site site : body.sites[0]) put(site.x + 1, 0);
    for (const Site site : body.sites[1]) put(columns, site.x + 1);
    for (const Site site : body.sites[2]) put(site.x + 1, rows);
    for (const Site site : body.sites[3]) put(0, site.x + 1);
    for (const Site site : body.sites[4]) put(site.x + 1, site.y + 1);
    return points;
}

/// Codes how many points are on the four sides and inside: the number of binary digits, and these.
inline void code_counts(ArithmeticCoder& coder, std::array<std::uint32_t, 5>& counts) {
    const auto rest = [&](std::uint32_t value, int digits) {
        return digits == 0 ? 0U : std::uint32_t{1} << (digits - 1) | coder.bits(value, digits - 1);
    };
    counts[4] = rest(counts[4], static_cast<int>(coder.bits(static_cast<std::uint32_t>(digits_of(counts[4])), 5)));
    std::array<AdaptiveBit, 32> longer{};
    for (std::size_t k = 0; k < 4; ++k) {
        int digits = 0;
        while (digits < 31 && longer[static_cast<std::size_t>(digits)].code(coder, digits_of(counts[k]) > digits)) ++digits;
        counts[k] = rest(counts[k], digits);
    }
}

/// Writes or reads a body, from the Start that `table` gives, its colours by this Foretelling. Where it is read, more points than
/// `most_points` are refused before there is memory for them; what passes are the faces of a triangulation and colours that there
/// are.
/// hear(), where set, is called with what each coder knows when all is coded, in the order of the table.
template <class Start = EmptyStart, class Foretelling = DistanceForetelling>
[[nodiscard]] Status code_body(ArithmeticCoder& coder, const CompactHead& head, CompactBody& body, std::size_t most_points,
                               const CompactTable* table, HearLearnt hear) {
    const Status early(Errc::invalid_argument, "the compact mesh ends early or is damaged");
    const auto lattice = lattice_of(head);
    std::array<std::uint32_t, 5> counts{};
    for (std::size_t k = 0; k < 5; ++k) counts[k] = static_cast<std::uint32_t>(body.sites[k].size());
    code_counts(coder, counts);
    std::uint64_t total = 4;
    for (std::size_t k = 0; k < 5; ++k) {
        const std::uint64_t room = k < 4 ? lattice[k % 2] - 1 : std::uint64_t{lattice[0] - 1} * std::uint64_t{lattice[1] - 1};
        if (counts[k] > room)
            return {Errc::invalid_argument, "the compact mesh has more vertices than its lattice has sites, or is damaged",
                    counts[k], room};
        total += counts[k];
    }
    if (total > most_points)
        return {Errc::invalid_argument, "the compact mesh has more vertices than are allowed", total, most_points};

    body.ends[0] = coder.position();
    const Logistic logistic;
    Start start(table, hear);
    {
        SiteCoder sites(coder, logistic);
        start.begin(sites);
        for (std::size_t k = 0; k < 5; ++k) {
            const std::uint32_t width = k < 4 ? lattice[k % 2] - 1 : lattice[0] - 1, height = k < 4 ? 1 : lattice[1] - 1;
            if (!sites.code(width, height, counts[k], body.sites[k])) return early;
        }
        start.end(sites);
    }
    body.ends[1] = coder.position();
    const std::vector<GridPoint> points = points_of(head, body);
    Triangulation mesh(points);
    {
        FlipCoder flips(coder, logistic);
        start.begin(flips);
        if (!flips.code(mesh, body.flips)) return early;
        start.end(flips);
    }
    body.ends[2] = coder.position();
    body.faces = all_faces(mesh);
    if (!coder.writes()) body.shown.assign(body.faces.size(), true);
    if (head.is_masked && !MaskCoder(coder).code(mesh, body.faces, body.shown)) return early;
    body.used.assign(points.size(), !head.is_masked);
    if (head.is_masked)
        for (std::size_t f = 0; f < body.faces.size(); ++f)
            for (const std::uint32_t v : body.faces[f])
                if (body.shown[f]) body.used[v] = true;
    body.ends[3] = coder.position();
    const auto channels = static_cast<std::size_t>(head.channels);
    body.colors.resize(channels * points.size());
    body.coarse.step = head.color_step;
    body.coarse.mean_area = std::int64_t{head.frame_width} * head.frame_height * 1536 / static_cast<std::int64_t>(points.size());
    const std::int64_t most = head.most_color();
    const ColorNumbers numbers{channels, most, head.color_step > 0, channels >= 3 && most < 65536,
                               2 * std::int64_t{head.frame_width} * head.frame_height};
    ColorCoder<Foretelling> colors(coder, logistic, points.size(), numbers, body.coarse);
    start.begin(colors);
    if (!colors.code(mesh, body.used, body.colors)) return early;
    start.end(colors);
    body.ends[4] = coder.position();
    return {};
}

/// How files with a table are coded; null: without one.
[[nodiscard]] inline CompactTable::Code* code_of(const CompactTable* table) noexcept {
    return table == nullptr ? &code_body<> : table->code;
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_BODY_HPP
