// hmesh-terrain - the tasks of a job: each reads and writes files of the job alone, but for the input that it reads.
#ifndef HMESH_TERRAIN_JOB_TASKS_HPP
#define HMESH_TERRAIN_JOB_TASKS_HPP

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "job/receipt.hpp"
#include "terrain/job/plan.hpp"
#include "terrain/report.hpp"
#include "terrain/tile_maker.hpp"
#include "terrain/written/surface.hpp"

namespace terrain {

// What tasks of one process share: the input is opened by the first that needs it.
class Worker {
  public:
    // Of a plan that outlives this object.
    explicit Worker(const Plan& plan) : plan_(plan) {}

    // Does a task, unless it is done. `said` becomes what is to be said of it. Returns "" or what is wrong, a sentence: then
    // nothing is written.
    [[nodiscard]] std::string run(const TaskName& task, const hmesh::ParallelFor& parallel_for, std::string& said);

  private:
    // A level's samples, and what makes tiles of them.
    struct Source {
        std::unique_ptr<Dem> thinned;  // null: those of the input itself
        std::unique_ptr<TileMaker> maker;
    };

    [[nodiscard]] std::string open();
    [[nodiscard]] std::string open(int level);
    [[nodiscard]] std::string make_tile(const TaskName& task, const hmesh::ParallelFor& parallel_for,
                                        std::vector<job::Made>& made, job::Json& facts);
    [[nodiscard]] std::string make_index(std::vector<job::Made>& made, job::Json& facts);

    const Plan& plan_;
    DemPointer dem_;
    std::vector<Source> sources_;  // of the levels
};

// What a finished tile's receipt says.
struct TileFacts {
    TileEnd end;
    double input_error = 0;       // the most by which it is off a sample of the input; max_error is that of its level's samples
    double skirt = 0;             // how deep it hangs, in heights of the input
    job::Made file;               // of a tile that is made
    std::array<double, 6> box{};  // of its vertices: least, then greatest x, y and z of the file
};

// Of a task that must be done: returns "" or what is wrong, a sentence.
[[nodiscard]] std::string find_tile(const Plan& plan, const TaskName& task, TileFacts& facts);

// The tile's file as it was written: vertices, faces and normals, nothing where it is empty. Returns "" or what is wrong, a
// sentence.
[[nodiscard]] std::string read_tile(const Plan& plan, const TaskName& task, TileFacts& facts, Model& model);

// How tiles meet. Two neighbours with data on both sides of their common row have the same vertices in it.
struct Seams {
    std::int64_t pairs = 0;    // of neighbours, both with a mesh
    std::int64_t shared = 0;   // vertices that are the same bit for bit, normals too, of all pairs
    std::int64_t open = 0;     // vertices of a pair that the other has not
    std::int64_t no_data = 0;  // the same where one of the two has samples without data
    std::string first;         // "tile_0_0000_0000 and tile_0_0001_0000": the first open pair
};

// Of the row's tiles from west to east and with the row south of it. Returns "" or what is wrong, a sentence.
[[nodiscard]] std::string find_seams(const Plan& plan, int level, int y, Seams& seams);

[[nodiscard]] job::Json value_of(const Seams& seams);
[[nodiscard]] Seams seams_of(const job::Json& facts);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_TASKS_HPP
