#include "terrain/tile_maker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "terminal/progress_watch.hpp"
#include "terminal/words.hpp"
#include "terrain/meshing.hpp"
#include "terrain/written/measure.hpp"
#include "terrain/written/surface.hpp"

namespace terrain {
namespace {

// Of the bound what is asked of the mesh, so that the file keeps the rest when its numbers are rounded: first the most, then less
// where that was not enough. With the last, 0, the inside is made by insertion alone, as Delaunay has it, without slivers.
constexpr std::array<double, 9> shares = {0.999, 0.98, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2, 0};

// And of its borders, which all tiles have in common whatever their insides need. Local metres are floats, and the first share is
// enough for all but bounds that hardly are; 15 bits take more.
constexpr double share_of_borders = 0.999, share_of_borders_of_globe = 0.8;

struct Attempt {
    double share, of_borders;
    Effort effort;
};

// What is tried until a file keeps the bound. Faces of `best` may be steep where no sample is, and there rounding a place is
// an error of heights that a tighter bound hardly makes smaller: of 15 bits, and of floats far from the origin, it takes
// `normal` then, whose borders are the same. The last attempt has borders of its own and is the same for all bounds: what it
// is off by is the smallest that surely is kept.
std::vector<Attempt> attempts(Effort effort, bool is_globe, bool is_hopeless) {
    const double of_borders = is_globe ? share_of_borders_of_globe : share_of_borders;
    std::vector<Attempt> all;
    if (!is_hopeless) {
        if (effort == Effort::best) {
            for (const double share : shares)
                if (share >= share_of_borders_of_globe) all.push_back({share, of_borders, effort});
            effort = Effort::normal;
        }
        for (const double share : shares) all.push_back({share, of_borders, effort});
    }
    all.push_back({0, 0, effort});
    return all;
}

// A bit more than a bound: numbers of 15 bits are spread over the heights and the bound.
std::string more_than(double bound) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", bound * (1 + 1e-4));
    return text;
}

// Keeps the heights of a mesh within the range of all tiles, where the samples of this one are: a number of vertices puts some as
// far beyond the samples as the least error asks for. Neighbours do the same with the vertices that they share.
void keep_within(const HeightRange& range, const Window& window, hmesh::Mesh& mesh) {
    if (!(range.low < range.high) || window.low < range.low || window.high > range.high) return;
    const float low = std::nextafter(static_cast<float>(range.low), std::numeric_limits<float>::max());
    const float high = std::nextafter(static_cast<float>(range.high), std::numeric_limits<float>::lowest());
    if (low < high)
        for (float& height : mesh.colors) height = std::clamp(height, low, high);
}

}  // namespace

double slack_of(const Arguments& arguments, const Tile& tile) {
    if (arguments.format != Format::quantized_mesh)
        return 1.0 / 32;  // the solid of an STL file has vertices of its own a 64th apart where two holes meet
    return 1e-6 + std::max(tile.width, tile.height) / 32767.0;
}

std::string find_heights(Dem& dem, HeightRange& heights) {
    heights = {};
    bool has_height = false;
    const int step = std::clamp((1 << 22) / dem.width, 1, dem.height);
    std::vector<float> samples(static_cast<std::size_t>(dem.width) * static_cast<std::size_t>(step));
    for (int row = 0; row < dem.height && !tool::interrupted; row += step) {
        const int rows = std::min(step, dem.height - row);
        double rounding = 0;
        if (std::string why = dem.read(0, row, dem.width, rows, samples.data(), rounding); !why.empty()) return why;
        const std::size_t count = static_cast<std::size_t>(dem.width) * static_cast<std::size_t>(rows);
        for (std::size_t k = 0; k < count; ++k) {
            if (std::isnan(samples[k])) continue;
            const auto height = static_cast<double>(samples[k]);
            heights.low = has_height ? std::min(heights.low, height) : height;
            heights.high = has_height ? std::max(heights.high, height) : height;
            has_height = true;
        }
    }
    return {};
}

std::string TileMaker::prepare() {
    if (std::string why = find_frame(arguments_, dem_, frame); !why.empty()) return why;
    return find_range();
}

std::string TileMaker::prepare(const Frame& known) {
    frame = known;
    return find_range();
}

// The heights of the whole file, for tiles that are to say them alike.
std::string TileMaker::find_range() {
    if (arguments_.format != Format::quantized_mesh || (arguments_.tile == 0 && !arguments_.heights)) return {};
    if (arguments_.heights) range = {(*arguments_.heights)[0], (*arguments_.heights)[1]};
    else if (const std::string why = find_heights(dem_, range); !why.empty())
        return "cannot read '" + arguments_.input + "': " + why;
    // Vertices may be above and below all samples, by the bound.
    const double more = arguments_.max_error.value_or(0.05 * (range.high - range.low));
    range.low -= more;
    range.high += more;
    return {};
}

std::string TileMaker::read(const Tile& tile, Window& window) {
    const std::lock_guard<std::mutex> lock(reading_);
    const std::string why = read_window(dem_, tile, window);
    return why.empty() ? "" : "cannot read '" + arguments_.input + "': " + why;
}

// A mesh and its file, proved.
std::string TileMaker::make_file(const Tile& tile, const Window& window, hmesh::Progress progress,
                                 const hmesh::ParallelFor& parallel_for, TileEnd& end, std::vector<unsigned char>& bytes) {
    const bool is_globe = arguments_.format == Format::quantized_mesh;
    const double wanted = arguments_.max_error.value_or(0);
    // Half a step of the 15 bits.
    const double low = is_globe && !(range.low < range.high) ? window.low - wanted : range.low;
    const double high = is_globe && !(range.low < range.high) ? window.high + wanted : range.high;
    const double step = is_globe && arguments_.max_error ? (high - low) / 65534 : 0;
    const double room = std::max(0.0, wanted - step);
    Measured found;
    for (const Attempt& attempt : attempts(arguments_.effort, is_globe, !(room > 0))) {
        if (tool::interrupted) return "interrupted; '" + tile.file + "' is not written";
        const Within within{shares.front() * room, attempt.share * room, attempt.of_borders * room, attempt.effort};
        end.asked = within.inside;
        end.is_tighter = room > 0 && attempt.of_borders == 0;
        hmesh::Result result = arguments_.max_error ? mesh_within(arguments_, window, within, progress, parallel_for)
                                                    : mesh_with_vertices(arguments_, window, progress, parallel_for);
        if (!result.status || !result.has_mesh())
            return "'" + arguments_.input + "' as '" + tile.file + "': " + tool::in_words(result.status) +
                   (tool::interrupted ? "; it is not written" : "");
        if (is_globe && !arguments_.max_error) keep_within(range, window, result.mesh);
        end.vertices = result.mesh.vertex_count();
        end.triangles = result.mesh.face_count();
        if (const hmesh::Status status = write_model(arguments_, dem_, frame, range, tile, window, result.mesh.view(), bytes);
            !status)
            return "cannot make '" + tile.file + "': " + tool::in_words(status);
        Surface surface;
        if (std::string why = read_back(arguments_.format, {bytes.data(), bytes.size()}, frame, tile, surface); !why.empty())
            return "'" + tile.file + "' cannot be read back: " + why;
        found = measure(surface, window.tile(), slack_of(arguments_, tile));
        end.max_error = found.max_error + window.rounding;
        end.sum_of_squares = found.sum_of_squares;
        end.measured = found.samples;
        if (!arguments_.max_error) return {};
        if (end.max_error <= wanted && found.left_out == 0 && found.outside == 0) return {};
    }
    if (found.left_out > 0 || found.outside > 0)
        return "'" + tile.file + "' leaves " + std::to_string(found.left_out) + " samples out and covers " +
               std::to_string(found.outside) + " without data; it is not written";
    char text[96];
    std::snprintf(text, sizeof text, "--max-error %.9g: its numbers, as it rounds them, are off by %.9g", wanted, end.max_error);
    // On a globe what rounding does to a mesh changes with the bound, by some per cent.
    return "'" + tile.file + "' cannot keep " + text + ", and the smallest that it keeps is " + (is_globe ? "about " : "") +
           more_than(end.max_error);
}

std::string TileMaker::make(const Tile& tile, hmesh::Progress progress, const hmesh::ParallelFor& parallel_for, TileEnd& end,
                            std::vector<unsigned char>& bytes) {
    bytes.clear();
    end.samples = own_samples(tile);
    Window window;
    if (std::string why = read(tile, window); !why.empty()) return why;
    end.no_data = window.no_data;
    end.own_no_data = window.own_no_data;
    if (!window.has_cell) {
        if (arguments_.tile == 0) return "'" + arguments_.input + "' has no data in any four samples that are neighbours";
        end.kind = TileEnd::Kind::empty;
        return {};
    }
    if (!arguments_.max_error && window.no_data > 0)
        return "'" + arguments_.input + "' has samples without data: --max-error leaves holes, and numbers of vertices do not";
    if (std::string why = make_file(tile, window, progress, parallel_for, end, bytes); !why.empty()) return why;
    end.kind = TileEnd::Kind::made;
    return {};
}

}  // namespace terrain
