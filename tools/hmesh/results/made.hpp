// tools - all that is made of one image, as it is written and reported.
#ifndef HMESH_TOOLS_RESULTS_MADE_HPP
#define HMESH_TOOLS_RESULTS_MADE_HPP

#include <optional>
#include <vector>

#include "hmesh/result.hpp"
#include "hmesh/sprite.hpp"
#include "meshing.hpp"
#include "results/maps.hpp"
#include "results/written_psnr.hpp"

namespace tool {

// A level of detail.
struct Level {
    hmesh::Result outcome;
    std::optional<LightMesh> light;  // in linear light, where a .glb file is written: of the finest, or for --fit-space each
    std::optional<hmesh::SpriteReport> sprite;  // what was dropped of it, with --sprite
};

struct Made {
    std::vector<Level> levels;         // the finest first, which alone there is without --lods
    std::vector<Map> maps;             // measured, where there are several
    std::vector<WrittenPsnr> written;  // of the files that hold the finest level
    double seconds = 0;                // of wall-clock time, for all levels
    std::vector<unsigned char> file;   // that .hmc is to be, with --bytes

    [[nodiscard]] const Level& finest() const noexcept { return levels.front(); }
};

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_MADE_HPP
