#include "terrain/run.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "terrain/frame.hpp"
#include "terrain/report.hpp"
#include "terrain/tile_maker.hpp"
#include "terrain/tiles.hpp"
#include "thread_pool.hpp"
#include "writers/file_set.hpp"
#include "writers/output_file.hpp"
#include "writers/write_file.hpp"

namespace terrain {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// Whether an output would overwrite the input or another output, or the input is one that was not finished. Devices may be named
// twice. Returns "" or a sentence.
std::string find_clash(const Arguments& arguments, const std::vector<Tile>& tiles) {
    if (tool::is_part(arguments.input)) return tool::unfinished(arguments.input);
    std::vector<std::string> outputs;
    tool::FileSet known;  // their places there
    const auto add = [&](const std::string& file) -> std::string {
        std::error_code none;
        if (tool::is_standard(file) || (fs::exists(file, none) && !fs::is_regular_file(file, none))) return {};
        if (fs::equivalent(arguments.input, file, none))
            return "'" + file + "' would overwrite the input '" + arguments.input + "'";
        if (const std::size_t other = known.find(file); other != tool::FileSet::no_file)
            return (outputs[other] == file ? "'" + file + "' is"
                                           : "'" + outputs[other] + "' and '" + file + "' are one file, which is") +
                   " named for two outputs";
        known.add(file, outputs.size());
        outputs.push_back(file);
        return {};
    };
    for (const Tile& tile : tiles)
        if (std::string why = add(tile.file); !why.empty()) return why;
    return arguments.report.empty() ? "" : add(arguments.report);
}

// Of a tile that has no data now, what a run before this one left there. Returns "" or what went wrong, a sentence.
std::string remove_former(const std::string& file) {
    std::error_code none, code;
    if (!fs::is_regular_file(file, none)) return {};
    fs::remove(file, code);
    return code ? "cannot remove '" + file + "', which has no data now: " + code.message() : "";
}

// What the threads of a run share.
class Run {
  public:
    Run(const Arguments& arguments, Dem& dem, tool::ProgressWatch& watch)
        : arguments_(arguments), watch_(watch), maker_(arguments, dem) {}

    // Returns "" or what went wrong, a sentence.
    [[nodiscard]] std::string prepare();
    [[nodiscard]] std::string mesh_all(unsigned jobs);

    [[nodiscard]] const Frame& frame() const noexcept { return maker_.frame; }

    std::vector<Tile> tiles;
    std::vector<TileEnd> ends;

  private:
    [[nodiscard]] std::string find_unwritable() const;
    [[nodiscard]] std::string mesh_tile(std::size_t k, const hmesh::ParallelFor& parallel_for);
    [[nodiscard]] bool is_newer(const std::string& file) const;
    [[nodiscard]] bool tell(hmesh::ProgressInfo info);
    void tell_done(std::size_t vertices);

    const Arguments& arguments_;
    tool::ProgressWatch& watch_;
    TileMaker maker_;
    std::mutex telling_;
    std::size_t finished_ = 0, vertices_ = 0;
};

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
    const auto input = fs::last_write_time(arguments_.input, none);
    const auto output = fs::last_write_time(file, there);
    return !none && !there && output > input;
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
    if (std::string why = find_unwritable(); !why.empty()) return why;
    ends.resize(tiles.size());
    return maker_.prepare();
}

std::string Run::mesh_tile(std::size_t k, const hmesh::ParallelFor& parallel_for) {
    const Tile& tile = tiles[k];
    TileEnd& end = ends[k];
    const Clock::time_point begin = Clock::now();
    end.samples = own_samples(tile);
    if (arguments_.resumes && is_newer(tile.file)) {
        end.kind = TileEnd::Kind::kept;
        return {};
    }
    std::vector<unsigned char> bytes;
    const auto progress = [&](const hmesh::ProgressInfo& info) { return tell(info); };
    if (std::string why = maker_.make(tile, progress, parallel_for, end, bytes); !why.empty()) return why;
    if (end.kind == TileEnd::Kind::empty) return remove_former(tile.file);
    end.kind = TileEnd::Kind::failed;
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
    if (const std::string why = find_tiles(arguments, *dem, run.tiles); !why.empty()) return tool::fail(tool::failed, why);
    if (arguments.lists_tiles) return list(run.tiles);
    if (const std::string clash = find_clash(arguments, run.tiles); !clash.empty()) return tool::fail(tool::wrong_usage, clash);
    if (const std::string why = run.prepare(); !why.empty()) return tool::fail(tool::failed, why);
    watch.begin_mesh(0.02, 1, 0.05);
    if (const std::string why = run.mesh_all(arguments.jobs); !why.empty()) return tool::fail(tool::failed, why);
    watch.end_mesh();
    const double seconds = seconds_since(begin);
    if (!arguments.report.empty())
        if (const std::string why =
                tool::write_text(arguments.report, report_json(arguments, *dem, run.frame(), run.tiles, run.ends, seconds));
            !why.empty())
            return tool::fail(tool::failed, why);
    watch.finish();
    if (arguments.quiet) return tool::done;
    std::FILE* const to = tool::is_standard(arguments.report) ? stderr : stdout;
    print_summary(to, arguments, *dem, run.tiles, run.ends, seconds);
    if (std::fflush(to) == 0 || to == stderr) return tool::done;
    return tool::fail(tool::failed, "cannot write to the standard output");
}

}  // namespace terrain
