/// \file
/// vertex_cache_strips(): the faces of a mesh as triangle strips that are good for the vertex cache.
///
/// In a strip each index makes a face with the two before it, and every other face is turned: here 1.6 indices a face, of 3 as a
/// list. From a face a strip goes on over one of two sides: over that of the last two indices for one index, or over the other
/// for two, of which the first makes a face of no area (a swap). A strip that ends costs the restart index and two more.
///
/// Each strip begins where vertex_cache_order() would go on. Of the two ways it takes the one that fetches no vertex, needs no
/// swap, leads to a face with few neighbours left and finishes a vertex; and it ends after 11 vertices that were not in the
/// cache, so that the next strip finds them there. The weights were tried on meshes of photographs. Strips come to 6.3 bytes of
/// 16-bit indices a vertex, ACMR 0.73 and ATVR 1.46, where lists have 12, 0.635 and 1.27. Cost: O(n), some 0.22 us and 69 bytes
/// a face.
#ifndef HMESH_IO_GPU_CACHED_STRIPS_HPP
#define HMESH_IO_GPU_CACHED_STRIPS_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/io/gpu/vertex_cache.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// The face across each side of each face that runs along it the other way, or no_index; side k runs from corner k to the next.
/// Each side leads to one face at most, and back. Of faces as vertex_cache_strips() takes them.
///
/// A side waits in a list of its end of fewer faces until its opposite comes. Where more than 64 wait, some are not found.
[[nodiscard]] inline std::vector<Triangle> faces_across(const std::vector<Triangle>& faces, std::size_t vertices) {
    std::vector<std::uint32_t> valence(vertices, 0), waiting(vertices, no_index), after(4 * faces.size());
    for (const Triangle& face : faces)
        for (const std::uint32_t v : face) ++valence[v];
    std::vector<Triangle> across(faces.size(), {no_index, no_index, no_index});
    constexpr std::array<std::size_t, 3> next{1, 2, 0};
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = faces[f][k], to = faces[f][next[k]];
            const bool is_at_from = valence[from] != valence[to] ? valence[from] < valence[to] : from < to;
            std::uint32_t* link = &waiting[is_at_from ? from : to];
            std::size_t face = 0, side = 0;
            int steps = 64;
            for (; *link != no_index && steps > 0; link = &after[*link], --steps) {
                face = *link / 4, side = *link % 4;
                if (faces[face][side] == to && faces[face][next[side]] == from) break;
            }
            if (*link != no_index && steps > 0) {
                *link = after[*link];
                across[f][k] = static_cast<std::uint32_t>(face);
                across[face][side] = static_cast<std::uint32_t>(f);
            } else {
                std::uint32_t& first = waiting[is_at_from ? from : to];
                const auto here = static_cast<std::uint32_t>(4 * f + k);
                after[here] = first;
                first = here;
            }
        }
    return across;
}

/// A walk over faces that writes strips.
class CachedStrips {
  public:
    /// As DrawFront has it; faces are below 2^30.
    CachedStrips(const std::vector<Triangle>& faces, std::size_t vertices)
        : faces_(&faces), front_(faces, vertices), across_(faces_across(faces, vertices)) {}

    /// All strips, with no_index between them. To be called once.
    [[nodiscard]] std::vector<std::uint32_t> run() {
        out_.reserve(faces_->size() + faces_->size() * 2 / 3 + 3);
        while (!front_.is_done()) {
            if (!out_.empty()) out_.push_back(no_index);
            walk(start());
        }
        return std::move(out_);
    }

  private:
    // In quarters of a miss.
    static constexpr int miss = 4, swap = 2, way = 1, finish = 2;
    // What a step may cost: beyond it, beginning anew is as good.
    static constexpr int most = 7;
    // Misses of a strip: less than the cache holds, for the next strip brings its own.
    static constexpr std::uint32_t longest = 11;

    // A side of a face, the third corner of the face on its other side, and that face, if it is left.
    struct Step {
        std::uint32_t face = no_index, corner = no_index;
        int cost = std::numeric_limits<int>::max();
    };

    [[nodiscard]] int ways_from(std::uint32_t f) const {
        int ways = 0;
        for (const std::uint32_t g : across_[f]) ways += g != no_index && !front_.is_taken(g) ? 1 : 0;
        return ways;
    }
    [[nodiscard]] Step step_over(std::uint32_t f, std::size_t side) const {
        const std::uint32_t g = across_[f][side];
        if (g == no_index || front_.is_taken(g)) return {};
        const std::uint32_t a = (*faces_)[f][side], b = (*faces_)[f][(side + 1) % 3];
        Step step;
        step.face = g;
        for (const std::uint32_t v : (*faces_)[g])
            if (v != a && v != b) step.corner = v;
        step.cost = (front_.is_cached(step.corner) ? 0 : miss) + way * ways_from(g);
        for (const std::uint32_t v : {a, b}) step.cost -= front_.left(v) == 1 ? finish : 0;
        return step;
    }
    // The side of f between two of its corners.
    [[nodiscard]] std::size_t side(std::uint32_t f, std::uint32_t a, std::uint32_t b) const {
        for (std::size_t k = 0; k < 2; ++k)
            if ((*faces_)[f][(k + 2) % 3] != a && (*faces_)[f][(k + 2) % 3] != b) return k;
        return 2;
    }

    [[nodiscard]] std::uint32_t start() {
        const std::uint32_t v = front_.next_vertex();
        std::uint32_t best = no_index;
        int least = std::numeric_limits<int>::max();
        front_.for_each_left(v, [&](std::uint32_t f) {
            int cost = way * ways_from(f);
            for (const std::uint32_t u : (*faces_)[f]) cost += front_.is_cached(u) ? 0 : miss;
            if (cost < least) least = cost, best = f;
        });
        return best;
    }

    void walk(std::uint32_t f) {
        std::size_t exit = 0;  // the side to leave by
        int least = std::numeric_limits<int>::max();
        for (std::size_t k = 0; k < 3; ++k)
            if (const int cost = step_over(f, k).cost; cost < least) least = cost, exit = k;
        const Triangle& face = (*faces_)[f];
        std::uint32_t a = face[(exit + 2) % 3], b = face[exit], c = face[(exit + 1) % 3];
        front_.take(f);
        const std::uint32_t begin = front_.clock();
        out_.push_back(a);
        out_.push_back(b);
        while (front_.clock() - begin < longest) {  // c is still to be written
            const Step ahead = step_over(f, side(f, b, c));
            Step aside = step_over(f, side(f, a, c));
            if (aside.face != no_index) aside.cost += swap;
            const Step& step = aside.cost < ahead.cost ? aside : ahead;
            if (step.cost > most) break;
            if (&step == &aside) {
                out_.push_back(a);  // a face a b a of no area, which turns the next
                b = a;
            }
            out_.push_back(c);
            a = b, b = c, c = step.corner, f = step.face;
            front_.take(f);
        }
        out_.push_back(c);
    }

    const std::vector<Triangle>* faces_;
    DrawFront front_;
    std::vector<Triangle> across_;
    std::vector<std::uint32_t> out_;
};

}  // namespace detail

/// The faces as strips with no_index between them: of each strip, face i joins its indices i, i + 1 and i + 2, the first two of
/// them in turn for odd i, and those with two equal corners are none. Each face is there once, with its orientation. Faces have
/// three different corners each, below `vertices`, and are at most 2^30.
[[nodiscard]] inline std::vector<std::uint32_t> vertex_cache_strips(const std::vector<Triangle>& faces, std::size_t vertices) {
    return detail::CachedStrips(faces, vertices).run();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GPU_CACHED_STRIPS_HPP
