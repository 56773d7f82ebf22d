// tools - the tasks of `hmesh job`: each reads and writes files of the job alone, but for the image that it reads.
#ifndef HMESH_TOOLS_TILES_TASKS_HPP
#define HMESH_TOOLS_TILES_TASKS_HPP

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "job/receipt.hpp"
#include "tiles/plan.hpp"
#include "tiles/seams.hpp"
#include "tiles/shares.hpp"
#include "tiles/sides.hpp"
#include "tiles/tile_image.hpp"

namespace tool {

// What tasks of one process share: the image is opened by the first that needs it.
class TileWorker {
  public:
    // Of a plan that outlives this object.
    explicit TileWorker(const TilePlan& plan) : plan_(plan) {}

    // Does a task, unless it is done. `said` becomes what is to be said of it. Returns "" or what is wrong, a sentence: then
    // nothing is written.
    [[nodiscard]] std::string run(const TileTask& task, const hmesh::ParallelFor& parallel_for, std::string& said);

  private:
    [[nodiscard]] std::string read(const TileTask& task, ImageFile& tile);
    [[nodiscard]] std::string look(const TileTask& task, const hmesh::ParallelFor& parallel_for, job::Json& facts);
    [[nodiscard]] std::string share(int number, job::Json& facts);
    [[nodiscard]] std::string make_tile(const TileTask& task, const hmesh::ParallelFor& parallel_for,
                                        std::vector<job::Made>& made, job::Json& facts);
    // What a level is as a whole, and its tiles.
    [[nodiscard]] std::string add_level(int number, job::Json& facts, job::Json& tiles, TileSeams& seams);
    [[nodiscard]] std::string make_index(std::vector<job::Made>& made, job::Json& facts);

    const TilePlan& plan_;
    std::optional<TileImage> image_;
};

// What a finished tile's receipt says.
struct TileFacts {
    std::size_t vertices = 0, faces = 0;
    double energy = 0, psnr = 0, max_error = 0;
    job::Made file;
    std::string sides_of;             // sha256 of the file whose mesh had these sides, or empty
    std::array<SideDigest, 4> sides;  // as all_sides has them
};

// What a returns a string returns "" or what is wrong, a sentence.

// Of a tile that must be done.
[[nodiscard]] std::string find_tile(const TilePlan& plan, const TileTask& tile, TileFacts& facts);
// Its mesh, as its file has it.
[[nodiscard]] std::string read_tile(const TilePlan& plan, const TileTask& tile, TileFacts& facts, hmesh::Mesh& mesh);
// The mesh of its file's bytes.
[[nodiscard]] std::string decode_tile(const TilePlan& plan, const TileFacts& facts, const std::vector<unsigned char>& bytes,
                                      hmesh::Mesh& mesh);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_TASKS_HPP
