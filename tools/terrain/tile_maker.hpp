// hmesh-terrain - TileMaker: a tile as the bytes of its file, meshed, written, read back and proved. What a run of all tiles and
// a task of a job do alike, hence with the same bytes.
#ifndef HMESH_TERRAIN_TILE_MAKER_HPP
#define HMESH_TERRAIN_TILE_MAKER_HPP

#include <mutex>
#include <string>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"
#include "terrain/frame.hpp"
#include "terrain/model_file.hpp"
#include "terrain/report.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// The lowest and the highest height of the whole file, read strip by strip; 0 and 0 where it has none. Returns "" or what is
// wrong, as Dem::read() does.
[[nodiscard]] std::string find_heights(Dem& dem, HeightRange& heights);

// How far from a sample a border may be that runs through it, in samples: what floats of local metres keep of 65536, or half a
// step of 15 bits, either way with as much again.
[[nodiscard]] double slack_of(const Arguments& arguments, const Tile& tile);

class TileMaker {
  public:
    // Of what outlives this object.
    TileMaker(const Arguments& arguments, Dem& dem) : arguments_(arguments), dem_(dem) {}

    // What all tiles have in common: the frame and, of quantized-mesh, the heights that all of them are within, for which the
    // file is read unless the arguments say them. Returns "" or what is wrong, a sentence.
    [[nodiscard]] std::string prepare();
    // The same in a frame that is known.
    [[nodiscard]] std::string prepare(const Frame& known);

    // The bytes of the tile's file, none where it has no data; `end` says which, and all else but the seconds. Returns "" or what
    // is wrong, a sentence. May be called from several threads at once.
    [[nodiscard]] std::string make(const Tile& tile, hmesh::Progress progress, const hmesh::ParallelFor& parallel_for,
                                   TileEnd& end, std::vector<unsigned char>& bytes);

    Frame frame;
    HeightRange range;

  private:
    [[nodiscard]] std::string find_range();
    [[nodiscard]] std::string make_file(const Tile& tile, const Window& window, hmesh::Progress progress,
                                        const hmesh::ParallelFor& parallel_for, TileEnd& end, std::vector<unsigned char>& bytes);
    [[nodiscard]] std::string read(const Tile& tile, Window& window);

    const Arguments& arguments_;
    Dem& dem_;
    std::mutex reading_;
};

}  // namespace terrain

#endif  // HMESH_TERRAIN_TILE_MAKER_HPP
