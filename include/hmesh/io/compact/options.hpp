/// \file
/// What a compact file is to be, and what a reader takes of one.
#ifndef HMESH_IO_COMPACT_OPTIONS_HPP
#define HMESH_IO_COMPACT_OPTIONS_HPP

#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/io/compact/container.hpp"
#include "hmesh/io/compact/start_table.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_compact().
struct CompactOptions {
    /// How colours are held. A mesh whose colours are whole 255ths or 65535ths of its peak comes back as it was from integers
    /// too.
    CompactColors colors = CompactColors::bits8;
    /// Whether colours are for renderers that interpolate linear light, as fit_linear_light() makes them. The file keeps it.
    bool linear = false;
    /// Step of the lattice to which vertices are moved first, in 1/256 px, in [0, 2^25]; 0: they stay. Each goes to the nearest
    /// site that leaves all faces as they lie; where it finds none, Errc::invalid_argument names it, and a finer lattice helps.
    /// Meshes of photographs have faces too thin for more than some 8 (2 of 8,000 vertices of Lena), which saves 6 bits a vertex:
    /// for a coarser lattice fit them with MeshLimits::position_step. On one of 64 that costs 0.05 dB and saves 12 bits. Not of
    /// periodic meshes.
    std::uint32_t lattice = 0;
    /// Step of coarse colours, in 16ths of a 255th of the peak, in [1, 4095], for vertices around which faces have the mean area;
    /// others have steps by one over the root of theirs, within four times. 0: colours are exact. Of 8 bits alone, and not of
    /// periodic meshes.
    std::uint32_t color_step = 0;
    /// Whether to write the bare profile: a head of a few bytes and no checksum, for data in a page. Of meshes with peak 255,
    /// colours of 8 bits, a lattice of whole px and no holes, that are not periodic and whose samples are squares.
    bool bare = false;
    /// Of the bare profile: whether the image's size is left out, as the reader is told it.
    bool size_is_told = false;
    /// What contexts begin with, of files of some hundred vertices; null: nothing. It must outlive the call, and who reads the
    /// file needs it too: that of hmesh/io/compact/photographs.hpp saves 12 % of 300 bytes and 8 % of 3,000.
    const CompactTable* table = nullptr;
};

/// What read_compact() takes at most; what is more is refused before there is memory for it.
struct CompactLimits {
    std::int64_t max_vertices = 1048576;              ///< vertices, in [4, 2^24]; the corners of the frame among them
    std::int64_t max_pixels = std::int64_t{1} << 32;  ///< width times height of the image, px
};

namespace detail {

/// Whether all options are in range.
[[nodiscard]] inline Status check(const CompactOptions& options) noexcept {
    if (options.colors > CompactColors::floats)
        return {Errc::invalid_argument, "the colours of a compact file are none of those known", static_cast<int>(options.colors),
                2};
    if (options.color_step > 0 && options.colors != CompactColors::bits8)
        return {Errc::invalid_argument, "a compact file has coarse colours of 8 bits alone, not with a step", options.color_step,
                0};
    if (options.table != nullptr && (options.table->number < 1 || options.table->number > CompactHead::last_table))
        return {Errc::invalid_argument, "the start table of a compact file must have a number in [1, 6]", options.table->number,
                CompactHead::last_table};
    if (options.size_is_told && !options.bare)
        return {Errc::invalid_argument, "only the bare profile of a compact file leaves out the image's size"};
    return kit::check_ranges({{"the lattice of a compact file must be in [0, 2^25], in 1/256 px",
                               static_cast<double>(options.lattice), 0, static_cast<double>(CompactHead::widest)},
                              {"color_step of a compact file must be in [0, 4095]", static_cast<double>(options.color_step), 0,
                               static_cast<double>(CompactHead::coarsest)}});
}

/// Whether all limits are in range.
[[nodiscard]] inline Status check(const CompactLimits& limits) noexcept {
    return kit::check_ranges(
        {{"limits.max_vertices must be in [4, 2^24]", static_cast<double>(limits.max_vertices), 4, 16777216},
         {"limits.max_pixels must be in [1, 2^32]", static_cast<double>(limits.max_pixels), 1, 4294967296.0}});
}

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_OPTIONS_HPP
