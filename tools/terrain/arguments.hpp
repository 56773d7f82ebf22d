// hmesh-terrain - its command line: parsed strictly, every refusal a sentence that names the value.
#ifndef HMESH_TERRAIN_ARGUMENTS_HPP
#define HMESH_TERRAIN_ARGUMENTS_HPP

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arguments/job_call.hpp"
#include "terrain/readers/readers.hpp"

namespace terrain {

enum class Effort : std::uint8_t { draft, fast, normal, best };

inline constexpr tool::Named<Effort> efforts[] = {
    {"draft", Effort::draft}, {"fast", Effort::fast}, {"normal", Effort::normal}, {"best", Effort::best}};
inline constexpr tool::Named<RawType> raw_types[] = {
    {"float32", RawType::float32}, {"int16", RawType::int16}, {"uint16", RawType::uint16}};

enum class Format : std::uint8_t { none, glb, ply, obj, stl, quantized_mesh };

inline constexpr tool::Named<Format> formats[] = {{".glb", Format::glb},
                                                  {".ply", Format::ply},
                                                  {".obj", Format::obj},
                                                  {".stl", Format::stl},
                                                  {".terrain", Format::quantized_mesh}};

// By the ending of the name.
[[nodiscard]] Format format_of(const std::string& name);

// West, south, east and north in degrees: of the outermost samples.
using Extent = std::array<double, 4>;

// Which tile: column from the west and row from the north.
struct TileName {
    int x = 0, y = 0;
};

struct Arguments {
    std::string input, output, report;
    ReadOptions reading;
    Format format = Format::none;
    // One of three.
    std::optional<double> max_error;       // in the file's heights
    std::optional<std::int64_t> vertices;  // of each tile
    std::optional<double> percent;         // of the samples
    Effort effort = Effort::normal;
    bool has_free_borders = false;           // nothing is to meet them
    std::optional<double> border_tolerance;  // of a number of vertices: borders from their rows alone
    int tile = 0;                            // cells of a side; 0: all in one piece
    std::vector<TileName> only;              // of the tiles; empty: all
    bool lists_tiles = false;                // and does nothing else
    bool resumes = false;
    double scale = 1, z_scale = 1, offset = 0;
    std::optional<double> spacing;  // metres from sample to sample
    bool has_normals = true;
    std::optional<double> base;  // of a closed model
    std::optional<Extent> extent;
    std::optional<std::array<double, 2>> heights;  // lowest and highest of all tiles
    unsigned jobs = 0;                             // 0: as many as cores
    bool quiet = false;
};

struct CommandLine {
    Arguments arguments;
    std::string wrong;   // what is wrong with the command line, a sentence; empty: nothing
    std::string answer;  // what is to be printed instead of running; empty: nothing
};

// The words after the program's name.
[[nodiscard]] CommandLine parse(const std::vector<std::string>& words);

// What `hmesh-terrain job` was asked for.
struct JobArguments : tool::JobCall {
    Arguments dem;                   // of plan: of all tiles
    std::vector<std::string> words;  // of plan: the options that say what is made, for parse()
    int levels = 1;                  // of plan: of detail
    bool has_skirts = false;         // of plan: of tiles
    bool takes_open_seams = false;   // of join
};

struct JobCommandLine {
    JobArguments arguments;
    std::string wrong;   // what is wrong with the command line, a sentence; empty: nothing
    std::string answer;  // what is to be printed instead of running; empty: nothing
};

// The words after `hmesh-terrain job`.
[[nodiscard]] JobCommandLine parse_job(const std::vector<std::string>& words);

}  // namespace terrain

#endif  // HMESH_TERRAIN_ARGUMENTS_HPP
