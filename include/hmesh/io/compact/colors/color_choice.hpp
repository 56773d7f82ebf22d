/// \file
/// ColorChoice: which coarse colours a mesh is written with, for the least error and bits together.
///
/// A mesh whose colours are the best for its image, but for an error of each vertex, is off by a square of these errors that
/// triangles tell: of two vertices, an integral of both their linear functions. Of what one vertex is off those not yet
/// written make good what they can, so what is wanted of them is kept at the best that those before them leave.
#ifndef HMESH_IO_COMPACT_COLORS_COLOR_CHOICE_HPP
#define HMESH_IO_COMPACT_COLORS_COLOR_CHOICE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/triangulation.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// What is wanted of each plane of each vertex, as vertices are written one after the other.
class ColorChoice {
  public:
    /// Of none.
    ColorChoice() = default;
    /// Of the vertices of a mesh that are `used`, with what is wanted of their planes, `channels` each.
    ColorChoice(const Triangulation& mesh, const std::vector<bool>& used, std::vector<double> wanted, std::size_t channels)
        : channels_(channels), wanted_(std::move(wanted)), off_(wanted_.size(), 0), own_(mesh.point_count(), 0),
          begin_(mesh.point_count() + 1, 0), is_written_(mesh.point_count(), false) {
        for (std::size_t v = 0; v < mesh.point_count(); ++v) {
            const auto at = static_cast<Triangulation::Index>(v);
            std::int64_t around = 0;
            Triangulation::Index e = mesh.first(at);
            for (Triangulation::Index k = 0; k < mesh.degree(at); ++k, e = mesh.next(e)) {
                const std::int64_t area = area_beside(mesh, e);
                around += area;
                if (used[v] && used[mesh.to(e)])
                    shared_.push_back({mesh.to(e), static_cast<double>(area + area_beside(mesh, Triangulation::opposite(e)))});
            }
            own_[v] = 2 * static_cast<double>(around);
            begin_[v + 1] = shared_.size();
        }
    }

    /// What is best now for a plane of a vertex.
    [[nodiscard]] double wanted(std::size_t v, std::size_t channel) const noexcept {
        return wanted_[v * channels_ + channel] + off_[v * channels_ + channel];
    }
    /// What a unit off that costs, squared, when those not yet written have made good of it what they can; of a vertex between
    /// triangles of the area a, 4 a and less.
    [[nodiscard]] double price(std::size_t v) const noexcept {
        double left = own_[v];
        for (std::size_t k = begin_[v]; k < begin_[v + 1]; ++k)
            if (!is_written_[shared_[k].vertex]) left -= shared_[k].mass * shared_[k].mass / own_[shared_[k].vertex];
        return std::max(left, 0.15 * own_[v]);
    }
    /// Notes what a plane of a vertex has become.
    void set(std::size_t v, std::size_t channel, double plane) noexcept {
        off_[v * channels_ + channel] = plane - wanted_[v * channels_ + channel];
    }
    /// Notes that all planes of a vertex are written.
    void close(std::size_t v) noexcept {
        is_written_[v] = true;
        for (int round = 0; round < 2; ++round)
            for (std::size_t k = begin_[v]; k < begin_[v + 1]; ++k)
                if (!is_written_[shared_[k].vertex]) relax(shared_[k].vertex);
    }

  private:
    struct Shared {
        std::size_t vertex;
        double mass;
    };

    void relax(std::size_t v) noexcept {
        for (std::size_t channel = 0; channel < channels_; ++channel) {
            double sum = 0;
            for (std::size_t k = begin_[v]; k < begin_[v + 1]; ++k)
                sum += shared_[k].mass * off_[shared_[k].vertex * channels_ + channel];
            off_[v * channels_ + channel] = -sum / own_[v];
        }
    }

    std::size_t channels_ = 0;
    std::vector<double> wanted_, off_;  // from what is wanted to what is written or best
    std::vector<double> own_;           // of each vertex, 24 times the integral of its function's square
    std::vector<std::size_t> begin_;    // in shared_
    std::vector<Shared> shared_;        // of each vertex, its neighbours and the integrals of both functions
    std::vector<bool> is_written_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_COLORS_COLOR_CHOICE_HPP
