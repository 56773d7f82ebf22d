/// \file
/// Annealing: simulated annealing with a variable number of vertices.
///
/// The annealing minimises energy + mu n, n being the number of vertices and mu a Lagrange multiplier, the price of a vertex:
/// vertices leave places where they are worth less than mu and come where they are worth more. (Physicists call this a grand
/// canonical ensemble.) A move removes, inserts or displaces a vertex or flips an edge. Each move is a transaction: change the
/// mesh, relax the surroundings, read the exact energy, then accept by Metropolis' rule at temperature T or roll back to the
/// last byte. Nudges are smaller, and many: a vertex is displaced, and nothing around it relaxed. Between sweeps mu is steered so
/// that n meets the target, and T falls to 0. All patches of a mesh share mu, so that vertices flow between them too.
///
/// Cost: a sweep takes 15 to 25 us a vertex for 3 channels.
#ifndef HMESH_METHODS_ANNEALED_ANNEALING_HPP
#define HMESH_METHODS_ANNEALED_ANNEALING_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/edit/blocks.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/relax.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/methods/annealed/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The numbers of removals and of insertions that a sweep accepted.
struct AnnealingCounts {
    std::size_t removed = 0;   ///< vertices removed
    std::size_t inserted = 0;  ///< vertices inserted
};

/// The price mu of a vertex and the temperature T, which all patches of a mesh share; set between sweeps.
class AnnealingSchedule {
  public:
    /// Starts an annealing toward `target` vertices, of a mesh whose first_price() is `price`, an energy.
    AnnealingSchedule(const AnnealingOptions& options, std::size_t target, double price) noexcept
        : options_(options), target_(static_cast<double>(target)), price_(options.start_price * price) {}

    /// mu for the next sweep, an energy.
    [[nodiscard]] double price() const noexcept { return price_; }
    /// T of sweep 0, 1, .., an energy.
    [[nodiscard]] double temperature(int sweep) const noexcept {
        const double left = 1 - static_cast<double>(sweep) / options_.sweeps;
        return options_.temperature * std::exp(options_.cooling * std::log(left)) * price_;  // no pow(): core/status.hpp
    }
    /// Steers mu after a sweep: it rises with the surplus of vertices over the target and with the rate at which vertices come.
    ///
    /// `counts`: moves accepted in all patches; `vertices` and `mean_energy`: of the mesh now. The gains 3 and 2 and the limits
    /// are found by trial. On a mosaic of photographs in tiles of 256 px (as benchmarks/table --mosaic makes them), the weaker
    /// gains (1, 0.5), (1, 0) and (0.5, 0) lost 0.04 to 0.08 dB. A change is at most a factor exp(0.2) a sweep. mu stays in
    /// [0.15, 100] mean energies of a vertex, to keep a start that is far off from running away; kodim23 needs 1.1 in its first
    /// sweeps.
    void steer(const AnnealingCounts& counts, std::size_t vertices, double mean_energy) noexcept {
        const double deviation = (static_cast<double>(vertices) - target_) / target_;
        const double rate = (static_cast<double>(counts.inserted) - static_cast<double>(counts.removed)) / target_;
        price_ *= std::exp(std::max(-0.2, std::min(0.2, 3 * deviation + 2 * rate)));
        price_ = std::max(0.15 * mean_energy, std::min(100 * mean_energy, price_));
    }

  private:
    AnnealingOptions options_;
    double target_, price_;
};

/// The range in which the number of vertices stays during a sweep.
struct CountRange {
    double low = 0;   ///< with fewer vertices, none is removed
    double high = 0;  ///< with more vertices, none is inserted
};

/// One sweep of annealing over a mesh or a patch.
template <int C>
class AnnealingSweep {
  public:
    /// A sweep at this price and temperature, both energies. The mesh must outlive the sweep.
    AnnealingSweep(ImageMesh<C>& mesh, const AnnealingOptions& options, double price, double temperature, const CountRange& range,
                   const Random& random)
        : mesh_(&mesh), options_(options), price_(price), temperature_(temperature), min_gain_(least_gain * price), range_(range),
          random_(random) {}

    /// Works on these vertices, in spatial order, and on what belongs to them. Block by block: tries removals, insertions, flips,
    /// jumps and nudges, then visits dirty vertices twice with flips in between. Begins at a random block: a CountRange that ends
    /// it early would else favour the top of the image. Ends early where mesh.keep_going() says stop.
    AnnealingCounts run(const Array<Vertex>& all) {
        AnnealingCounts counts;
        for_each_block(*mesh_, all, random_.below(std::size_t{1} << 30U), [&](Array<Vertex>& vertices) {
            counts.removed += remove_moves(vertices);
            counts.inserted += insert_moves(vertices);
            flip_moves(vertices);
            jump_moves(vertices);
            nudge_moves(vertices);
            const double mean = mesh_->mean_energy();
            const Tolerance tolerance{sweep_propagates, mean > 0 ? min_gain_ / mean : 0};
            sweep(*mesh_, vertices, tolerance);
            flip_edges(*mesh_, own_edges(*mesh_, vertices), sweep_flip_gain);
            sweep(*mesh_, vertices, tolerance);
        });
        return counts;
    }

  private:
    // Found by trial, and flat: half or twice of any changes the mean of Lena, Fruits, kodim03, 05 and 08 at 1 or 3 % (effort
    // normal, which does not jump; two seeds) by less than 0.01 dB where nothing else is said.
    static constexpr double least_gain = 5e-3;  ///< mu, of a step or flip of a relaxation. Twice: -0.02 dB; half: +0.01 at 3 %
    static constexpr double sweep_propagates = 1e-2;    ///< Tolerance::propagate_above of the visits after the moves
    static constexpr double sweep_flip_gain = 1e-4;     ///< mean energies of a vertex, of a flip after the moves
    static constexpr int most_rounds = 2;               ///< of relaxation around a move. One: -0.035 dB; four: nothing
    static constexpr double least_round_gain = 6e-2;    ///< mean energies, of a round that is worth another one
    static constexpr double hopeless_above = 0.25;      ///< mu beyond what is allowed: no further round. Half: -0.015 dB at 1 %
    static constexpr double half_hopeless_above = 0.7;  ///< the same after two of a flip's four vertices. Half: -0.01 dB at 1 %
    static constexpr double warm_screen = 3;            ///< T by which a removal may cost more and is tried
    static constexpr double flip_cost = 1e-4, jump_cost = 1e-3;  ///< mu, lest moves of no gain go on for ever
    static constexpr double longest_nudge = 2;                   ///< px, along each axis. Half or twice: nothing
    static constexpr int nudge_octaves = 6;                      ///< of lengths of nudges. Half: nothing

    /// Ends the transaction of a move that began at `mark` with the energy `before`. round(allowed) relaxes the surroundings; it
    /// is called up to twice, once if it gains little or if the move is hopeless after it. Metropolis' rule then keeps the move,
    /// if the energy is below `allowed`, or undoes it; `cost` is the price of the move beside the energy: mu for an insertion,
    /// -mu for a removal, a little for others. Returns whether the move was kept.
    bool accept_or_roll_back(const typename ImageMesh<C>::Mark& mark, double before, double cost,
                             FunctionRef<void(double allowed)> round) {
        const double allowed = before - cost - temperature_ * std::log(random_.uniform());
        const double min_round_gain = least_round_gain * mesh_->mean_energy(), hopeless = allowed + hopeless_above * price_;
        for (int k = 0; k < most_rounds; ++k) {
            const double start = mesh_->energy();
            round(allowed);
            if (start - mesh_->energy() < min_round_gain || mesh_->energy() > hopeless) break;
        }
        const bool keep = mesh_->energy() < allowed;
        if (keep) {
            mesh_->commit(mark);
            for (const Vertex v : around_) mesh_->set_dirty(v, true);
        } else {
            mesh_->rollback(mark);
        }
        return keep;
    }
    /// Sets around_ to the neighbours of v.
    void collect(Vertex v) {
        around_.clear();
        for (const Halfedge h : topology().outgoing(v)) around_.push_back(topology().to_vertex(h));
    }

    /// Tries to collapse each vertex, and drops those that went. Returns how many went.
    std::size_t remove_moves(Array<Vertex>& vertices) {
        const std::size_t before_all = vertices.size();
        for (const Vertex v : vertices) {
            if (static_cast<double>(mesh_->vertex_count()) < range_.low || !mesh_->keep_going()) break;
            if (random_.uniform() > options_.try_probability) continue;
            const CollapseCandidate candidate = cheapest_collapse(*mesh_, scratch_, v);
            if (!candidate.halfedge.is_valid() ||
                !(candidate.cost <= options_.removal_screen * price_ + warm_screen * temperature_))
                continue;
            const auto mark = mesh_->begin();
            const double before = mesh_->energy();
            collect(v);
            mesh_->collapse(candidate.halfedge);
            accept_or_roll_back(mark, before, -price_, [&](double) { relax(*mesh_, around_, 1, min_gain_); });
        }
        vertices.erase(std::remove_if(vertices.begin(), vertices.end(), [&](Vertex v) { return topology().is_deleted(v); }),
                       vertices.end());
        return before_all - vertices.size();
    }

    /// Tries to insert a vertex on each edge and face, and adds those that came. Returns how many came.
    std::size_t insert_moves(Array<Vertex>& vertices) {
        std::size_t inserted = 0;
        const double min_gain = options_.insertion_screen * price_;
        for (const InsertionSite site : own_sites(*mesh_, vertices)) {
            if (static_cast<double>(mesh_->vertex_count()) > range_.high || !mesh_->keep_going()) break;
            if (random_.uniform() > options_.try_probability) continue;
            if (site.is_edge() ? topology().is_deleted(site.edge()) : topology().is_deleted(site.face())) continue;
            if (!(max_gain(*mesh_, site) > min_gain)) continue;
            const InsertionCandidate<C> candidate = candidate_at(*mesh_, scratch_, site, true, min_gain);
            if (!candidate.fits || !(candidate.gain > min_gain) || !can_gain_edge(*mesh_, candidate)) continue;
            const auto mark = mesh_->begin();
            const double before = mesh_->energy();
            const Vertex v = insert(*mesh_, candidate);
            collect(v);
            around_.push_back(v);
            if (accept_or_roll_back(mark, before, price_, [&](double) { relax(*mesh_, around_, 1, min_gain_); })) {
                vertices.push_back(v);
                ++inserted;
            }
        }
        return inserted;
    }

    /// Tries to flip each edge.
    void flip_moves(const Array<Vertex>& vertices) {
        for (const Edge e : own_edges(*mesh_, vertices)) {
            if (!mesh_->keep_going()) break;
            if (!is_flippable(*mesh_, e)) continue;
            FlipTrial<C> trial;
            evaluate_flip(*mesh_, e, trial);
            if (!(-trial.decrease < options_.flip_screen * price_) || !can_flip(*mesh_, e)) continue;
            const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
            around_ = {topology().to_vertex(topology().next(a)), topology().to_vertex(topology().next(b)),
                       topology().from_vertex(a), topology().to_vertex(a)};
            const auto mark = mesh_->begin();
            const double before = mesh_->energy();
            mesh_->flip(e, trial.moments, trial.own, trial.opposite);
            // No flips in the relaxation, which would turn the edge back. The far corners come first: where the energy is still
            // much too high after them, the other two do not help.
            const auto round = [&](double allowed) {
                for (std::size_t i = 0; i < 4; ++i) {
                    if (i == 2 && mesh_->energy() > allowed + half_hopeless_above * price_) break;
                    improve_vertex(*mesh_, around_[i], min_gain_);
                }
            };
            accept_or_roll_back(mark, before, flip_cost * price_, round);
        }
    }

    /// Displaces some free vertices at random, and keeps those displacements that are accepted.
    void jump_moves(const Array<Vertex>& vertices) {
        for (const Vertex v : vertices) {
            if (!mesh_->keep_going()) break;
            const VertexState<C> state = mesh_->vertex(v);
            if (state.mobility != Mobility::free || random_.uniform() > options_.jump) continue;
            mesh_->gather(v, scratch_.ring, scratch_.spokes);
            double mean = 0;
            for (int i = 0; i < scratch_.ring.size; ++i) {
                const Point p = scratch_.ring.neighbor[i]->position;
                mean += std::sqrt((p.x - state.position.x) * (p.x - state.position.x) +
                                  (p.y - state.position.y) * (p.y - state.position.y));
            }
            mean /= scratch_.ring.size;
            const double angle = 6.283185307179586 * random_.uniform();
            const double length = options_.jump_reach * mean * std::sqrt(random_.uniform());
            const Point target = mesh_->clamp(
                {state.position.x + length * std::cos(angle), state.position.y + length * std::sin(angle)}, Mobility::free);
            if (!scratch_.ring.accepts(target, 2 * mesh_->limits().min_double_area)) continue;
            const auto mark = mesh_->begin();
            const double before = mesh_->energy();
            collect(v);
            around_.insert(around_.begin(), v);
            mesh_->place(v, target, state.color);
            accept_or_roll_back(mark, before, jump_cost * price_, [&](double) { relax(*mesh_, around_, 1, min_gain_); });
        }
    }

    /// Nudges each vertex.
    void nudge_moves(const Array<Vertex>& vertices) {
        if (options_.nudges == 0) return;
        for (const Vertex v : vertices) {
            if (!mesh_->keep_going()) break;
            nudge(v);
        }
    }

    /// Displaces a vertex a little at random, options_.nudges times, with the best colour for each place and its neighbours
    /// held, by Metropolis' rule. The energy is rough where pixels change sides, of which a step of Gauss-Newton sees nothing.
    /// Where the ring has next to no energy, nothing is to be gained. 0.15 us, and 0.35 us a nudge.
    void nudge(Vertex v) {
        const Mobility mobility = mesh_->vertex(v).mobility;
        if (mobility == Mobility::corner || mobility == Mobility::locked) return;
        const Ring<C>& ring = scratch_.ring;
        mesh_->gather(v, scratch_.ring, scratch_.spokes);
        RingCenter<C> center{mesh_->position(v), mesh_->color(v), mesh_->energy(ring)};
        if (!(center.energy > min_gain_)) return;
        Spokes<C>*spokes = &scratch_.spokes, *trial_spokes = &scratch_.trial_spokes;
        FaceFit<C>*faces = scratch_.faces, *trial_faces = scratch_.trial_faces;
        bool moved = false;
        for (int k = 0; k < options_.nudges; ++k) {
            const Point trial = nudged(center.position, mobility);
            const double allowed = center.energy - flip_cost * price_ - temperature_ * std::log(random_.uniform());
            if (trial == center.position || !ring.accepts(trial, mesh_->limits().min_double_area)) continue;
            RingCenter<C> nudged_center;
            if (!fit_center(*mesh_, ring, trial, center.color, *trial_spokes, trial_faces, nudged_center)) continue;
            if (!(nudged_center.energy < allowed)) continue;
            center = nudged_center;
            std::swap(spokes, trial_spokes);
            std::swap(faces, trial_faces);
            moved = true;
        }
        if (!moved) return;
        mesh_->apply_fit(v, ring, center.position, center.color, faces, spokes);
        mesh_->set_ring_dirty(v);
    }
    /// A place near p for a vertex of this mobility, at lengths of all octaves alike.
    [[nodiscard]] Point nudged(Point p, Mobility mobility) {
        const double reach = longest_nudge / static_cast<double>(1U << random_.below(nudge_octaves));
        const double dx = reach * (2 * random_.uniform() - 1), dy = reach * (2 * random_.uniform() - 1);
        if (mobility != Mobility::along_y) p.x += dx;
        if (mobility != Mobility::along_x) p.y += dy;
        return mesh_->clamp(p, mobility);
    }

    [[nodiscard]] const HalfedgeMesh& topology() const noexcept { return mesh_->topology(); }

    ImageMesh<C>* mesh_;
    AnnealingOptions options_;
    double price_, temperature_;
    double min_gain_;  ///< steps and flips that gain up to this energy are not tried in relaxations
    CountRange range_;
    Random random_;
    RingScratch<C> scratch_;
    Array<Vertex> around_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_ANNEALING_HPP
