/// \file
/// LatticeMesh: a fitted mesh on its way to the sites of a compact file's lattice.
///
/// A mesh is fitted by steps that are right for small ones, and on a lattice as coarse as those of compact files most of them end
/// where they began. So it is fitted to few pixels a site first (CompactLattice), and then goes on here: vertices go from site to
/// site and edges flip by Metropolis' rule, each tried with the colours that are best after it, on the image itself. That gains
/// 0.2 to 0.4 dB. Vertices that are on no site go to the one of least energy near them; the few that find none are removed.
///
/// Cost: a round takes some 9 us a vertex of 3 channels.
#ifndef HMESH_RATE_LATTICE_MESH_HPP
#define HMESH_RATE_LATTICE_MESH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/handles.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/rate/compact_lattice.hpp"
#include "hmesh/solve/bounded_colors.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A mesh of C channels that is moved to a lattice.
template <int C>
class LatticeMesh {
  public:
    /// Over the table of an image, as the lattice knows it; all outlive it.
    LatticeMesh(const kit::MomentTable<C>& table, const CompactLattice& lattice, std::uint64_t seed)
        : mesh_(table, 0, 255), lattice_(&lattice), random_(seed) {}

    /// Moves a mesh of the first image to the lattice, and works on it for so many rounds as long as go_on(), which is told what
    /// share of them is done; with none also on the way there no more than it must. Whether it got there.
    [[nodiscard]] bool settle(const Mesh& first, int rounds, FunctionRef<bool(double)> go_on) {
        if (!mesh_.assign(in_second_image(first))) return false;
        sites_.assign(mesh_.topology().vertex_slots(), {-1, -1});
        temperature_ = 0;
        for (int reach = 1; reach <= 4 && snap_all(reach) > 0; ++reach) {
            if (rounds == 0) continue;
            move_round();
            flip_round();
        }
        for (int k = 0; k < 40; ++k) {  // all but a few meshes are there after two
            for (const kit::Vertex v : kit::spatial_vertices(mesh_))
                if (!topology().is_deleted(v) && !is_on_site(v) && !snap(v, 4) && !remove(v) && !loosen(v) && k > 1)
                    remove_neighbor(v);
            if (left() == 0) break;
            temperature_ = 0.03 * mesh_.mean_energy();
            move_round();
            flip_round();
        }
        if (left() > 0 || !is_valid()) return false;
        // The mesh was annealed before: from 0.08, files of 150 to 1,200 bytes lose 0.01 to 0.04 dB; from 0.015, larger ones lose
        // 0.015 with `fine`.
        const double hottest = 0.03 * mesh_.mean_energy();
        for (int round = 0; round < rounds; ++round) {
            if (!go_on(static_cast<double>(round) / rounds)) break;
            temperature_ = hottest * std::max(0.0, 1 - round / (0.85 * rounds));
            move_round();
            flip_round();
        }
        (void)kit::bounded_colors(mesh_, {0, 255});
        return true;
    }
    /// The mesh as the file has it.
    [[nodiscard]] Mesh mesh() const {
        Mesh out = to_mesh(mesh_, 255);
        out.width = static_cast<int>(static_cast<double>(lattice_->x.end) / lattice_->units);
        out.height = static_cast<int>(static_cast<double>(lattice_->y.end) / lattice_->units);
        std::size_t i = 0;
        for (const kit::Vertex v : mesh_.topology().vertices()) {
            const Site site = sites_[v.index()];
            out.positions[i++] = static_cast<float>(static_cast<double>(lattice_->x.at(site.x)) / lattice_->units);
            out.positions[i++] = static_cast<float>(static_cast<double>(lattice_->y.at(site.y)) / lattice_->units);
        }
        return out;
    }

  private:
    struct Site {
        int x, y;
    };

    // A mesh of the first image in px of the second. Rounding may turn slivers over; vertices on them come to sites all the same
    // or are removed, but until then the far corners of a convex quadrilateral may have an edge in common: is_flip_ok().
    [[nodiscard]] Mesh in_second_image(Mesh mesh) const {
        if (lattice_->has_one_image) return mesh;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            const LatticeAxis& axis = i % 2 == 0 ? lattice_->x : lattice_->y;
            // The last pixel may stand for less than others.
            const auto end_of = [&](double pixel) {
                return std::min(pixel * static_cast<double>(axis.step) / lattice_->per_site, static_cast<double>(axis.end));
            };
            const double at = static_cast<double>(mesh.positions[i]), pixel = std::floor(at);
            const double units = end_of(pixel) + (at - pixel) * (end_of(pixel + 1) - end_of(pixel));
            const double place = units / static_cast<double>(axis.end) * axis.size;
            mesh.positions[i] = static_cast<float>(std::floor(256 * place + 0.5) / 256);
        }
        mesh.width = lattice_->x.size;
        mesh.height = lattice_->y.size;
        return mesh;
    }
    [[nodiscard]] const kit::HalfedgeMesh& topology() const noexcept { return mesh_.topology(); }
    [[nodiscard]] bool is_on_site(kit::Vertex v) const noexcept { return sites_[v.index()].x >= 0; }
    [[nodiscard]] std::size_t left() const noexcept {
        std::size_t count = 0;
        for (const kit::Vertex v : topology().vertices()) count += is_on_site(v) ? 0U : 1U;
        return count;
    }
    [[nodiscard]] kit::Point place(Site s) const noexcept { return {lattice_->x.place(s.x), lattice_->y.place(s.y)}; }
    // Whether three sites turn as faces do.
    [[nodiscard]] bool turns(Site a, Site b, Site c) const noexcept {
        if (a.x < 0 || b.x < 0 || c.x < 0) return true;
        const auto& x = lattice_->x;
        const auto& y = lattice_->y;
        return (x.at(b.x) - x.at(a.x)) * (y.at(c.y) - y.at(a.y)) - (x.at(c.x) - x.at(a.x)) * (y.at(b.y) - y.at(a.y)) > 0;
    }
    [[nodiscard]] bool is_valid() const {
        for (const kit::Face f : topology().faces()) {
            const auto v = topology().vertices(f);
            if (!turns(sites_[v[0].index()], sites_[v[1].index()], sites_[v[2].index()])) return false;
        }
        return true;
    }
    // Whether the ring's faces stay as they lie with its centre at a site.
    [[nodiscard]] bool accepts(Site s) const noexcept {
        const kit::Ring<C>& ring = scratch_.ring;
        if (!ring.accepts(place(s), mesh_.limits().min_double_area)) return false;
        for (int i = ring.first_face(); i < ring.size; ++i)
            if (!turns(s, sites_[topology().to_vertex(ring.halfedge[i]).index()],
                       sites_[topology().to_vertex(ring.halfedge[ring.before(i)]).index()]))
                return false;
        return true;
    }
    // Which sites a vertex may go to: from the first to the last along each axis.
    struct Room {
        Site first, last;
    };
    [[nodiscard]] Room room_of(kit::Vertex v) const noexcept {
        const kit::Mobility mobility = mesh_.vertex(v).mobility;
        const kit::Point p = mesh_.position(v);
        Room room{{1, 1}, {lattice_->x.sites - 1, lattice_->y.sites - 1}};
        if (mobility == kit::Mobility::along_y || mobility == kit::Mobility::corner)
            room.first.x = room.last.x = p.x > 0 ? lattice_->x.sites : 0;
        if (mobility == kit::Mobility::along_x || mobility == kit::Mobility::corner)
            room.first.y = room.last.y = p.y > 0 ? lattice_->y.sites : 0;
        return room;
    }
    // The energy of the gathered ring with its centre at a site, in the best colour; trial_spokes and trial_faces become those.
    [[nodiscard]] double energy_at(Site s, const kit::Color<C>& before, kit::Color<C>& color) {
        kit::RingCenter<C> center;
        if (!kit::fit_center(mesh_, scratch_.ring, place(s), before, scratch_.trial_spokes, scratch_.trial_faces, center))
            return std::numeric_limits<double>::max();
        color = center.color;
        return center.energy;
    }
    void put(kit::Vertex v, Site s, const kit::Color<C>& color) {
        mesh_.apply_fit(v, scratch_.ring, place(s), color, scratch_.trial_faces, &scratch_.trial_spokes);
    }
    // Moves a vertex to the best site near it.
    bool snap(kit::Vertex v, int reach) {
        mesh_.gather(v, scratch_.ring, scratch_.spokes);
        const kit::Point p = mesh_.position(v);
        const Room room = room_of(v);
        const Site nearest{lattice_->x.nearest(p.x), lattice_->y.nearest(p.y)};
        Site best{-1, -1};
        double least = std::numeric_limits<double>::max();
        kit::Color<C> color = mesh_.color(v), best_color = color;
        for (int y = std::max(room.first.y, nearest.y - reach); y <= std::min(room.last.y, nearest.y + reach); ++y)
            for (int x = std::max(room.first.x, nearest.x - reach); x <= std::min(room.last.x, nearest.x + reach); ++x) {
                if (!accepts({x, y})) continue;
                const double energy = energy_at({x, y}, mesh_.color(v), color);
                if (energy < least) least = energy, best = {x, y}, best_color = color;
            }
        if (best.x < 0) return false;
        (void)energy_at(best, mesh_.color(v), color);
        put(v, best, best_color);
        sites_[v.index()] = best;
        return true;
    }
    std::size_t snap_all(int reach) {
        std::size_t missing = 0;
        for (const kit::Vertex v : kit::spatial_vertices(mesh_))
            if (!is_on_site(v) && !snap(v, reach)) ++missing;
        return missing;
    }
    // Removes a vertex: merges it into that neighbour for which the energy rises least. False: there is none.
    bool remove(kit::Vertex v) {
        const kit::Mobility mobility = mesh_.vertex(v).mobility;
        if (mobility == kit::Mobility::corner) return false;
        kit::Ring<C>& ring = scratch_.ring;
        mesh_.gather(v, ring, scratch_.spokes);
        kit::Halfedge best;
        double least = std::numeric_limits<double>::max();
        for (int j = 0; j < ring.size; ++j) {
            if (ring.open && j != 0 && j != ring.size - 1) continue;
            const kit::Halfedge to = ring.halfedge[j];
            const kit::Vertex u = topology().to_vertex(to);
            bool fits =
                topology().is_collapse_ok(to) && topology().valence(u) + ring.size - (ring.open ? 3 : 4) <= kit::max_valence;
            for (int i = ring.first_face(); i < ring.size && fits; ++i) {
                const int k = ring.before(i);
                if (i == j || k == j) continue;
                fits = kit::orient2d(mesh_.position(u), ring.neighbor[i]->position, ring.neighbor[k]->position) >=
                           mesh_.limits().min_double_area &&
                       turns(sites_[u.index()], sites_[topology().to_vertex(ring.halfedge[i]).index()],
                             sites_[topology().to_vertex(ring.halfedge[k]).index()]);
            }
            if (!fits) continue;
            const auto mark = mesh_.begin();
            mesh_.collapse(to);
            if (mesh_.energy() < least) least = mesh_.energy(), best = to;
            mesh_.rollback(mark);
        }
        if (!best.is_valid()) return false;
        mesh_.collapse(best);
        return true;
    }
    // Flips edges of a vertex away from it, where they can be. Whether it could be removed then.
    bool loosen(kit::Vertex v) {
        kit::Array<kit::Edge> spokes;
        for (const kit::Halfedge h : topology().outgoing(v)) spokes.push_back(kit::HalfedgeMesh::edge(h));
        kit::FlipTrial<C> trial;
        for (const kit::Edge e : spokes) {
            if (!kit::can_flip(mesh_, e) || !do_turn(e) || !topology().is_flip_ok(e)) continue;
            kit::evaluate_flip(mesh_, e, trial);
            mesh_.flip(e, trial.moments, trial.own, trial.opposite);
            if (remove(v)) return true;
        }
        return false;
    }
    // Removes one of a vertex's neighbours, where one can be.
    void remove_neighbor(kit::Vertex v) {
        around_.clear();
        for (const kit::Halfedge h : topology().outgoing(v)) around_.push_back(topology().to_vertex(h));
        for (const kit::Vertex u : around_)
            if (remove(u)) return;
    }
    // Gives a vertex its best colour.
    void recolor(kit::Vertex v) {
        mesh_.gather(v, other_.ring, other_.spokes);
        const kit::VertexState<C>& state = mesh_.vertex(v);
        const double before = mesh_.energy(other_.ring);
        kit::RingCenter<C> center{state.position, state.color, 0};
        if (kit::optimize_center(mesh_, other_, state.mobility, 0.0, false, center) == kit::RingOutcome::degenerate) return;
        if (center.energy < before) mesh_.apply_fit(v, other_.ring, center.position, center.color, other_.faces, nullptr);
    }
    [[nodiscard]] double allowed() { return temperature_ > 0 ? -temperature_ * std::log(random_.uniform()) : 0; }

    // Tries to move a vertex to a site beside its own.
    bool try_move(kit::Vertex v, Site s) {
        const double before_all = mesh_.energy(), before = mesh_.energy(scratch_.ring);
        if (!accepts(s)) return false;
        kit::Color<C> color = mesh_.color(v);
        const double after = energy_at(s, color, color), most = allowed();
        // Colours around it win back little: a screen of a mean energy takes 1.3 of the time for no more dB, and 0 loses 0.01 dB.
        if (!(after - before < most + 0.02 * mesh_.mean_energy())) return false;
        const auto mark = mesh_.begin();
        put(v, s, color);
        around_.clear();
        for (int i = 0; i < scratch_.ring.size; ++i) around_.push_back(topology().to_vertex(scratch_.ring.halfedge[i]));
        for (const kit::Vertex u : around_) recolor(u);
        recolor(v);
        if (!(mesh_.energy() - before_all < most)) return mesh_.rollback(mark), false;
        mesh_.commit(mark);
        sites_[v.index()] = s;
        return true;
    }
    void move_round() {
        static constexpr std::array<Site, 8> ways{{{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
        kit::Array<kit::Vertex> all = kit::spatial_vertices(mesh_);
        // In no order, but near those before and after: what they read is in the cache, which takes 0.8 to 0.9 of the time.
        for (std::size_t k = all.size(); k > 1; --k)
            std::swap(all[k - 1], all[k - 1 - random_.below(std::min<std::size_t>(k, 256))]);
        for (const kit::Vertex v : all) {
            const Room room = room_of(v);
            if (!is_on_site(v)) continue;
            if (room.first.x == room.last.x && room.first.y == room.last.y) continue;
            const std::size_t first = random_.below(8);
            mesh_.gather(v, scratch_.ring, scratch_.spokes);
            for (std::size_t k = 0; k < ways.size(); ++k) {
                const Site way = ways[(first + k) % ways.size()];
                for (int step = 0; step < 5; ++step) {
                    const Site at = sites_[v.index()], s{at.x + way.x, at.y + way.y};
                    if (s.x < room.first.x || s.y < room.first.y || s.x > room.last.x || s.y > room.last.y || !try_move(v, s))
                        break;
                    mesh_.gather(v, scratch_.ring, scratch_.spokes);
                }
            }
        }
    }
    // Whether the faces that a flip makes turn as faces do, on their sites.
    [[nodiscard]] bool do_turn(kit::Edge e) const {
        const kit::Halfedge a = kit::HalfedgeMesh::halfedge(e), b = kit::HalfedgeMesh::opposite(a);
        const Site p = sites_[topology().to_vertex(b).index()], q = sites_[topology().to_vertex(a).index()];
        const Site c = sites_[topology().to_vertex(topology().next(a)).index()],
                   d = sites_[topology().to_vertex(topology().next(b)).index()];
        return turns(p, d, c) && turns(d, q, c);
    }
    bool try_flip(kit::Edge e) {
        if (!kit::can_flip(mesh_, e)) return false;
        const kit::Halfedge a = kit::HalfedgeMesh::halfedge(e), b = kit::HalfedgeMesh::opposite(a);
        const kit::Vertex v0 = topology().to_vertex(b), v1 = topology().to_vertex(a);
        const kit::Vertex v2 = topology().to_vertex(topology().next(a)), v3 = topology().to_vertex(topology().next(b));
        if (!do_turn(e)) return false;
        kit::FlipTrial<C> trial;
        kit::evaluate_flip(mesh_, e, trial);
        const double most = allowed();
        if (!(-trial.decrease < most + 0.05 * mesh_.mean_energy()) || !topology().is_flip_ok(e)) return false;
        const double before = mesh_.energy();
        const auto mark = mesh_.begin();
        mesh_.flip(e, trial.moments, trial.own, trial.opposite);
        for (int round = 0; round < 2; ++round)
            for (const kit::Vertex v : {v0, v1, v2, v3}) recolor(v);
        if (!(mesh_.energy() - before < most - 1e-6 * mesh_.mean_energy())) return mesh_.rollback(mark), false;
        mesh_.commit(mark);
        return true;
    }
    void flip_round() {
        for (const kit::Edge e : kit::spatial_edges(mesh_)) (void)try_flip(e);
    }

    kit::ImageMesh<C> mesh_;
    const CompactLattice* lattice_;
    kit::Random random_;
    std::vector<Site> sites_;
    kit::RingScratch<C> scratch_, other_;
    kit::Array<kit::Vertex> around_;
    double temperature_ = 0;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RATE_LATTICE_MESH_HPP
