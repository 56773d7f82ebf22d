#include "terrain/run.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"
#include "terrain/frame.hpp"
#include "terrain/meshing.hpp"
#include "terrain/model_file.hpp"
#include "terrain/report.hpp"
#include "terrain/tiles.hpp"
#include "terrain/written/measure.hpp"
#include "terrain/written/surface.hpp"
#include "thread_pool.hpp"
#include "writers/output_file.hpp"
#include "writers/write_file.hpp"

namespace terrain {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// Of the bound what is asked of the mesh, so that the file keeps the rest when its numbers are rounded: first the share that all
// tiles have in common, whose borders follow from it, then less where that was not enough.
constexpr std::array<double, 6> shares = {0.999, 0.98, 0.95, 0.9, 0.8, 0.6};

// How far from a sample a border may be that runs through it, in samples: what floats of local metres keep of 65536, or half a
// step of 15 bits, either way with as much again.
double slack_of(const Arguments& arguments, const Tile& tile) {
    if (arguments.format != Format::quantized_mesh)
        return 1.0 / 32;  // the solid of an STL file has vertices of its own a 64th apart where two holes meet
    return 1e-6 + std::max(tile.width, tile.height) / 32767.0;
}

// What the threads of a run share.
class Run {
  public:
    Run(const Arguments& arguments, Dem& dem, tool::ProgressWatch& watch) : arguments_(arguments), dem_(dem), watch_(watch) {}

    // Returns "" or what went wrong, a sentence.
    [[nodiscard]] std::string prepare();
    [[nodiscard]] std::string mesh_all(unsigned jobs);

    Frame frame;
    HeightRange range;
    std::vector<Tile> tiles;
    std::vector<TileEnd> ends;

  private:
    [[nodiscard]] std::string find_range();
    [[nodiscard]] std::string find_unwritable() const;
    [[nodiscard]] std::string mesh_tile(std::size_t k, const hmesh::ParallelFor& parallel_for);
    [[nodiscard]] std::string make_file(const Tile& tile, const Window& window, const hmesh::ParallelFor& parallel_for,
                                        TileEnd& end, std::vector<unsigned char>& bytes);
    [[nodiscard]] std::string read(const Tile& tile, Window& window);
    [[nodiscard]] bool is_newer(const std::string& file) const;
    [[nodiscard]] bool tell(hmesh::ProgressInfo info);
    void tell_done(std::size_t vertices);

    const Arguments& arguments_;
    Dem& dem_;
    tool::ProgressWatch& watch_;
    std::mutex reading_, telling_;
    std::size_t finished_ = 0, vertices_ = 0;
};

std::string Run::read(const Tile& tile, Window& window) {
    const std::lock_guard<std::mutex> lock(reading_);
    const std::string why = read_window(dem_, tile, window);
    return why.empty() ? "" : "cannot read '" + arguments_.input + "': " + why;
}

// Of one tile in the works; of several, those that are done count.
bool Run::tell(hmesh::ProgressInfo info) {
    if (tiles.size() == 1) {
        info.total = 0.95 * info.total;
        return watch_(info);
    }
    return !tool::interrupted;
}

void Run::tell_done(std::size_t vertices) {
    const std::lock_guard<std::mutex> lock(telling_);
    vertices_ += vertices;
    const double share = static_cast<double>(++finished_) / static_cast<double>(tiles.size());
    static_cast<void>(watch_({"tiles", share, vertices_, 0, share}));
}

bool Run::is_newer(const std::string& file) const {
    std::error_code none, there;
    const auto input = std::filesystem::last_write_time(arguments_.input, none);
    const auto output = std::filesystem::last_write_time(file, there);
    return !none && !there && output > input;
}

// The heights of the whole file, for tiles that are to say them alike.
std::string Run::find_range() {
    if (arguments_.format != Format::quantized_mesh || (arguments_.tile == 0 && !arguments_.heights)) return {};
    if (arguments_.heights) {
        range = {(*arguments_.heights)[0], (*arguments_.heights)[1]};
    } else {
        Tile strip{{}, 0, 0, dem_.width, 0, {}};
        bool has_height = false;
        const int step = std::clamp((1 << 22) / dem_.width, 1, dem_.height);
        std::vector<float> heights(static_cast<std::size_t>(dem_.width) * static_cast<std::size_t>(step));
        for (int row = 0; row < dem_.height && !tool::interrupted; row += step) {
            const int rows = std::min(step, dem_.height - row);
            double rounding = 0;
            if (const std::string why = dem_.read(0, row, dem_.width, rows, heights.data(), rounding); !why.empty())
                return "cannot read '" + arguments_.input + "': " + why;
            const std::size_t count = static_cast<std::size_t>(dem_.width) * static_cast<std::size_t>(rows);
            for (std::size_t k = 0; k < count; ++k) {
                if (std::isnan(heights[k])) continue;
                const auto height = static_cast<double>(heights[k]);
                range.low = has_height ? std::min(range.low, height) : height;
                range.high = has_height ? std::max(range.high, height) : height;
                has_height = true;
            }
        }
    }
    // Vertices may be above and below all samples, by the bound.
    const double more = arguments_.max_error.value_or(0.05 * (range.high - range.low));
    range.low -= more;
    range.high += more;
    return {};
}

std::string Run::find_unwritable() const {
    for (const std::string& name : {tiles.front().file, arguments_.report}) {
        if (name.empty()) continue;
        tool::OutputFile file(name);
        if (!file.is_writable()) return "cannot write '" + name + "': " + file.error();
    }
    return {};
}

std::string Run::prepare() {
    if (std::string why = find_tiles(arguments_, dem_, tiles); !why.empty()) return why;
    if (arguments_.lists_tiles) return {};
    if (std::string why = find_frame(arguments_, dem_, frame); !why.empty()) return why;
    if (std::string why = find_unwritable(); !why.empty()) return why;
    ends.resize(tiles.size());
    return find_range();
}

// A mesh and its file, proved.
std::string Run::make_file(const Tile& tile, const Window& window, const hmesh::ParallelFor& parallel_for, TileEnd& end,
                           std::vector<unsigned char>& bytes) {
    const bool is_globe = arguments_.format == Format::quantized_mesh;
    const double wanted = arguments_.max_error.value_or(0);
    // Half a step of the 15 bits.
    const double low = is_globe && !(range.low < range.high) ? window.low - wanted : range.low;
    const double high = is_globe && !(range.low < range.high) ? window.high + wanted : range.high;
    const double step = is_globe && arguments_.max_error ? (high - low) / 65534 : 0;
    if (step > 0 && wanted <= step)
        return "'" + tile.file + "' cannot keep --max-error " + std::to_string(wanted) +
               ": the 15 bits of its heights are off by up to " + std::to_string(step);
    Measured found;
    for (const double share : shares) {
        if (tool::interrupted) return "interrupted; '" + tile.file + "' is not written";
        end.asked = share * (wanted - step);
        end.is_tighter = share < shares.front();
        const auto progress = [&](const hmesh::ProgressInfo& info) { return tell(info); };
        const hmesh::Result result = arguments_.max_error ? mesh_within(arguments_, window, end.asked, progress, parallel_for)
                                                          : mesh_with_vertices(arguments_, window, progress, parallel_for);
        if (!result.status || !result.has_mesh())
            return "'" + arguments_.input + "' as '" + tile.file + "': " + tool::in_words(result.status) +
                   (tool::interrupted ? "; it is not written" : "");
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
        if (!(wanted > 0)) break;
    }
    if (found.left_out > 0 || found.outside > 0)
        return "'" + tile.file + "' leaves " + std::to_string(found.left_out) + " samples out and covers " +
               std::to_string(found.outside) + " without data; it is not written";
    char text[96];
    std::snprintf(text, sizeof text, "--max-error %.9g: its numbers, as it rounds them, are off by %.9g", wanted, end.max_error);
    return "'" + tile.file + "' cannot keep " + text;
}

std::string Run::mesh_tile(std::size_t k, const hmesh::ParallelFor& parallel_for) {
    const Tile& tile = tiles[k];
    TileEnd& end = ends[k];
    const Clock::time_point begin = Clock::now();
    end.samples = static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height);
    if (arguments_.resumes && is_newer(tile.file)) {
        end.kind = TileEnd::Kind::kept;
        return {};
    }
    Window window;
    if (std::string why = read(tile, window); !why.empty()) return why;
    end.no_data = window.no_data;
    if (!window.has_cell) {
        if (arguments_.tile == 0) return "'" + arguments_.input + "' has no data in any four samples that are neighbours";
        end.kind = TileEnd::Kind::empty;
        return {};
    }
    if (!arguments_.max_error && window.no_data > 0)
        return "'" + arguments_.input + "' has samples without data: --max-error leaves holes, and numbers of vertices do not";
    std::vector<unsigned char> bytes;
    if (std::string why = make_file(tile, window, parallel_for, end, bytes); !why.empty()) return why;
    if (std::string why = tool::write_file(
            tile.file, [&](tool::OutputFile& file) { return file(bytes.data(), bytes.size()) ? "" : "the disk refused it"; });
        !why.empty())
        return why;
    end.kind = TileEnd::Kind::made;
    end.seconds = seconds_since(begin);
    return {};
}

std::string Run::mesh_all(unsigned jobs) {
    std::optional<example::ThreadPool> pool;
    try {
        pool.emplace(jobs);
    } catch (const std::system_error& error) {
        return "cannot start the threads: " + error.code().message();
    }
    std::vector<std::string> failures(tiles.size());
    std::atomic<bool> has_failed{false};
    // Of several tiles each is the work of one thread; of one all threads work on it.
    (*pool)(tiles.size(), [&](std::size_t k) {
        if (has_failed || tool::interrupted) return;
        failures[k] = mesh_tile(k, *pool);
        if (!failures[k].empty()) has_failed = true;
        else tell_done(ends[k].vertices);
    });
    for (std::string& why : failures)
        if (!why.empty()) return std::move(why);
    return tool::interrupted ? "interrupted" : "";
}

int list(const std::vector<Tile>& tiles) {
    std::string text;
    for (const Tile& tile : tiles) text += std::to_string(tile.name.x) + "_" + std::to_string(tile.name.y) + "\n";
    return tool::print(text);
}

}  // namespace

int run(const Arguments& arguments) {
    tool::catch_interrupt();
    tool::let_interrupts_end_waiting();
    tool::outlive_readers();
    const Clock::time_point begin = Clock::now();
    tool::ProgressWatch watch(!arguments.quiet && !arguments.lists_tiles && tool::is_terminal(stderr));
    DemPointer dem;
    if (const std::string why = open_dem(arguments.input, arguments.reading, dem); !why.empty())
        return tool::fail(tool::failed, "cannot read '" + arguments.input + "': " + why);
    Run run(arguments, *dem, watch);
    if (const std::string why = run.prepare(); !why.empty()) return tool::fail(tool::failed, why);
    if (arguments.lists_tiles) return list(run.tiles);
    watch.begin_mesh(0.02, 1, 0.05);
    if (const std::string why = run.mesh_all(arguments.jobs); !why.empty()) return tool::fail(tool::failed, why);
    watch.end_mesh();
    const double seconds = seconds_since(begin);
    if (!arguments.report.empty())
        if (const std::string why =
                tool::write_text(arguments.report, report_json(arguments, *dem, run.frame, run.tiles, run.ends, seconds));
            !why.empty())
            return tool::fail(tool::failed, why);
    watch.finish();
    if (arguments.quiet) return tool::done;
    print_summary(stdout, arguments, *dem, run.tiles, run.ends, seconds);
    return std::fflush(stdout) == 0 ? tool::done : tool::fail(tool::failed, "cannot write to the standard output");
}

}  // namespace terrain
