/// \file
/// What compact_image() is asked for, and what it returns.
#ifndef HMESH_RATE_OPTIONS_HPP
#define HMESH_RATE_OPTIONS_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of compact_image().
struct CompactImageOptions {
    std::size_t bytes = 300;              ///< the most that the file may have
    bool bare = false;                    ///< whether to write the bare profile: CompactOptions::bare
    const CompactTable* table = nullptr;  ///< what contexts begin with: CompactOptions::table
    bool premultiplied = false;  ///< whether colours of 2 or 4 channels are multiplied by alpha first: Options::premultiplied
    Progress progress{};         ///< is told how far the work is and may cancel it; its callable must outlive the call
};

/// What compact_image() returns.
struct [[nodiscard]] CompactImage {
    std::vector<std::uint8_t> bytes;  ///< the file, for read_compact() or read_bare_compact(); or none
    Mesh mesh;                        ///< what it holds; of a bare one as large as its lattice
    std::uint32_t color_step = 0;     ///< of its colours, see CompactOptions
    double psnr = 0;                  ///< of the mesh drawn at the image's size and rounded to its samples, in dB: hmesh::psnr()
    Status status;                    ///< ok, or why there are no bytes
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RATE_OPTIONS_HPP
