#include "tiles/tasks.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "arguments/arguments.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/version.hpp"
#include "job/work.hpp"
#include "meshing.hpp"
#include "results/mesh_file.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/words.hpp"
#include "writers/formats.hpp"

namespace tool {
namespace {

using job::Json;

// Of a task that must be done.
std::string find_facts(const TilePlan& plan, const TileTask& task, job::Done& receipt, Json& facts) {
    receipt = job::find_done(plan.folder, plan.identity, name_of(plan, task), job::Look::sizes, facts);
    return receipt.why;
}

MeshingOptions meshing_of(const TilePlan& plan, std::size_t vertices, hmesh::Progress progress) {
    MeshingOptions options;
    options.target = hmesh::Target::vertices(static_cast<std::int64_t>(vertices));
    options.effort = plan.options.effort;
    options.seed = plan.options.seed;
    options.samples = hmesh::Samples::points;
    options.progress = progress;
    return options;
}

std::vector<double> tolerances_of(const TilePlan& plan) {
    if (plan.options.border_tolerance) return {*plan.options.border_tolerance};
    ImageFile like;
    like.bits = plan.bits;
    return side_tolerances(peak_of(like), plan.bits == 32);
}

Json value_of(const TileSeams& seams) {
    return {{"pairs", seams.pairs}, {"shared", seams.shared}, {"open", seams.open}, {"first", seams.first}};
}

void add(const TileSeams& seams, TileSeams& all) {
    all.pairs += seams.pairs;
    all.shared += seams.shared;
    all.open += seams.open;
    if (all.first.empty()) all.first = seams.first;
}

std::string in_words(const TileSeams& seams) {
    std::string text = std::to_string(seams.pairs) + " pairs, " + std::to_string(seams.shared) + " vertices shared";
    if (seams.open > 0) text += ", " + std::to_string(seams.open) + " that the other has not";
    return text;
}

}  // namespace

std::string find_tile(const TilePlan& plan, const TileTask& tile, TileFacts& facts) {
    job::Done receipt;
    Json found;
    if (std::string why = find_facts(plan, tile, receipt, found); !why.empty()) return why;
    facts.vertices = found["vertices"].get<std::size_t>();
    facts.faces = found["faces"].get<std::size_t>();
    facts.energy = found["energy"].get<double>();
    facts.max_error = found["max_error"].get<double>();
    facts.file = receipt.made.front();
    if (!found.contains("sides")) return {};
    facts.sides_of = found["sides_of"].get<std::string>();
    for (std::size_t k = 0; k < facts.sides.size(); ++k)
        facts.sides[k] = {found["sides"][k]["vertices"].get<std::size_t>(), found["sides"][k]["sha256"].get<std::string>()};
    return {};
}

std::string decode_tile(const TilePlan& plan, const TileFacts& facts, const std::vector<unsigned char>& bytes,
                        hmesh::Mesh& mesh) {
    hmesh::CompactMesh read = read_mesh_file(bytes);
    if (!read.status) return "'" + plan.folder.path(facts.file.name) + "' cannot be read: " + in_words(read.status);
    mesh = std::move(read.mesh);
    return {};
}

std::string read_tile(const TilePlan& plan, const TileTask& tile, TileFacts& facts, hmesh::Mesh& mesh) {
    if (std::string why = find_tile(plan, tile, facts); !why.empty()) return why;
    std::vector<unsigned char> bytes;
    if (std::string why = job::read_made(plan.folder, facts.file, bytes); !why.empty()) return why;
    return decode_tile(plan, facts, bytes, mesh);
}

std::string TileWorker::read(const TileTask& task, ImageFile& tile) {
    if (!image_)
        if (std::string why = open_planned(plan_, image_.emplace()); !why.empty()) {
            image_.reset();
            return why;
        }
    const std::string why = image_->read(rect_of(plan_, task), plan_.level(task.level).step, tile);
    return why.empty() ? "" : "cannot read '" + plan_.path + "': " + why;
}

std::string TileWorker::look(const TileTask& task, const hmesh::ParallelFor& parallel_for, Json& facts) {
    ImageFile tile;
    if (std::string why = read(task, tile); !why.empty()) return why;
    // Half as many vertices as its pixels would get, and down to an eighth: cheap, and near enough. So is half the size
    // where vertices are some pixels apart in it, and of large tiles half or a quarter of that, with vertices in proportion.
    const TileLevel& level = plan_.level(task.level);
    const double pixels = static_cast<double>(tile.width) * tile.height, all = static_cast<double>(level.width) * level.height;
    const double rate = static_cast<double>(level.vertices) / all;
    double count = std::max(4.0, std::floor(0.5 * rate * pixels)), area = 1, lost = 0;  // area of a pixel that is tried
    const auto shrink = [&] {
        ImageFile half;
        lost += area * halve(tile, half);
        tile = std::move(half);
        area *= 4;
    };
    const std::vector<SideCounts> sides = count_side_vertices(tile, tolerances_of(plan_));
    if (rate < 1.0 / 32 && std::min(tile.width, tile.height) >= 64) {
        shrink();
        const double first = count;
        for (const double large : {10000.0, 11000.0})
            if (first >= large) {
                shrink();
                count /= 4;
            }
    }
    const auto progress = [](const hmesh::ProgressInfo& /*info*/) { return !interrupted; };
    MeshingOptions options = meshing_of(plan_, static_cast<std::size_t>(std::min(pixels, count)), progress);
    options.effort = hmesh::Effort::draft;
    for (double n = count; options.levels < 3 && n >= 16; n /= 2) ++options.levels;
    const hmesh::Lods lods = mesh_levels(tile, options, parallel_for);
    if (!lods.status) return "'" + plan_.path + "' as " + name_of(plan_, task) + ": " + tool::in_words(lods.status);
    Json trials = Json::array();
    for (const hmesh::Result& trial : lods.levels) trials.push_back({trial.report.vertices, area * trial.report.energy});
    facts = {{"trials", trials}, {"lost", lost}, {"pixels", static_cast<std::int64_t>(pixels)}, {"sides", sides}};
    return {};
}

std::string TileWorker::share(int number, Json& facts) {
    const TileLevel& level = plan_.level(number);
    const std::vector<double> tolerances = tolerances_of(plan_);
    std::vector<Look> looks;
    for (int y = 0; y < level.down(); ++y)
        for (int x = 0; x < level.across(); ++x) {
            const TileTask task{TileTaskKind::look, number, x, y};
            job::Done receipt;
            Json found;
            if (std::string why = find_facts(plan_, task, receipt, found); !why.empty()) return why;
            Look& look = looks.emplace_back();
            look.lost = found["lost"].get<double>();
            look.pixels = found["pixels"].get<std::size_t>();
            look.sides = found["sides"].get<std::vector<SideCounts>>();
            if (look.sides.size() != tolerances.size())
                return "the receipt of " + name_of(plan_, task) + " counts sides by " + std::to_string(look.sides.size()) +
                       " tolerances and not by " + std::to_string(tolerances.size()) +
                       ": another hmesh made it, plan the job anew";
            for (const Json& trial : found["trials"])
                look.trials.push_back({trial[0].get<std::size_t>(), trial[1].get<double>()});
        }
    Shares shares;
    if (const std::string why = find_shares(looks, level.across(), plan_.channels, level.vertices, tolerances, shares);
        !why.empty()) {
        const char* const other = looks.size() > 1 ? "larger tiles by --tile, or "
                                  : number > 0     ? "fewer levels by --levels, or "
                                                   : "";
        return why + ": take " + other + "more vertices";
    }
    facts = {{"tolerance", shares.tolerance}, {"vertices", shares.vertices}};
    return {};
}

std::string TileWorker::make_tile(const TileTask& task, const hmesh::ParallelFor& parallel_for, std::vector<job::Made>& made,
                                  Json& facts) {
    job::Done receipt;
    Json shares;
    if (std::string why = find_facts(plan_, {TileTaskKind::shares, task.level, 0, 0}, receipt, shares); !why.empty()) return why;
    ImageFile tile;
    if (std::string why = read(task, tile); !why.empty()) return why;
    const auto across = static_cast<std::size_t>(plan_.level(task.level).across());
    const std::size_t number = static_cast<std::size_t>(task.y) * across + static_cast<std::size_t>(task.x);
    const auto progress = [](const hmesh::ProgressInfo& /*info*/) { return !interrupted; };
    MeshingOptions options = meshing_of(plan_, shares["vertices"][number].get<std::size_t>(), progress);
    options.border_tolerance = shares["tolerance"].get<double>();
    const hmesh::Result result = mesh_file(tile, options, parallel_for);
    if (!result.status) return "'" + plan_.path + "' as " + name_of(plan_, task) + ": " + tool::in_words(result.status);
    std::vector<unsigned char> bytes;
    FormatOptions format;
    format.compact.colors = compact_colors(plan_.bits);
    const std::string name = "tiles/" + file_of(plan_, task) + ".hmc";
    if (const hmesh::Status status = write_mesh(result.mesh.view(), ".hmc", format, bytes); !status)
        return "cannot make '" + plan_.folder.path(name) + "': " + tool::in_words(status);
    made.emplace_back();
    if (std::string why = job::write_made(plan_.folder, name, bytes.data(), bytes.size(), made.back()); !why.empty()) return why;
    Json sides = Json::array();
    for (const TileSide side : all_sides) {
        const SideDigest digest = digest_of(side_vertices(result.mesh, side));
        sides.push_back({{"vertices", digest.vertices}, {"sha256", digest.sha256}});
    }
    facts = {{"vertices", result.mesh.vertex_count()}, {"faces", result.mesh.face_count()}, {"energy", result.report.energy},
             {"max_error", result.report.max_error},   {"sides_of", made.back().sha256},    {"sides", std::move(sides)}};
    return {};
}

std::string TileWorker::add_level(int number, Json& facts, Json& tiles, TileSeams& seams) {
    const TileLevel& level = plan_.level(number);
    std::size_t vertices = 0, faces = 0;
    double energy = 0, samples = 0, max_error = 0;
    ImageFile like;
    like.bits = plan_.bits;
    const auto psnr_of = [&](double error, double count) -> Json {
        const double psnr = hmesh::kit::psnr_of_energy(error, count, peak_of(like));
        return std::isfinite(psnr) ? Json(psnr) : Json("inf");
    };
    for (int y = 0; y < level.down(); ++y) {
        job::Done receipt;
        Json row;
        if (std::string why = find_facts(plan_, {TileTaskKind::seams, number, 0, y}, receipt, row); !why.empty()) return why;
        add({row["pairs"].get<std::int64_t>(), row["shared"].get<std::int64_t>(), row["open"].get<std::int64_t>(),
             row["first"].get<std::string>()},
            seams);
        for (int x = 0; x < level.across(); ++x) {
            const TileTask tile{TileTaskKind::tile, number, x, y};
            TileFacts of_tile;
            if (std::string why = find_tile(plan_, tile, of_tile); !why.empty()) return why;
            const hmesh::kit::Rect rect = rect_of(plan_, tile);
            const double count = static_cast<double>(rect.width) * rect.height * plan_.channels;
            tiles.push_back({{"level", number},
                             {"file", file_of(plan_, tile) + ".hmc"},
                             {"x", rect.x},
                             {"y", rect.y},
                             {"width", rect.width},
                             {"height", rect.height},
                             {"vertices", of_tile.vertices},
                             {"faces", of_tile.faces},
                             {"psnr", psnr_of(of_tile.energy, count)},
                             {"max_error", of_tile.max_error},
                             {"bytes", of_tile.file.bytes},
                             {"sha256", of_tile.file.sha256}});
            vertices += of_tile.vertices;
            faces += of_tile.faces;
            energy += of_tile.energy;
            samples += count;
            max_error = std::max(max_error, of_tile.max_error);
        }
    }
    job::Done receipt;
    Json shares;
    if (std::string why = find_facts(plan_, {TileTaskKind::shares, number, 0, 0}, receipt, shares); !why.empty()) return why;
    // Of a crossing of seams two pairs side by side and two one above the other tell, and four tiles have it.
    const auto crossings = static_cast<std::size_t>(level.across() - 1) * static_cast<std::size_t>(level.down() - 1);
    facts = {{"step", level.step},
             {"width", level.width},
             {"height", level.height},
             {"border_tolerance", shares["tolerance"]},
             {"vertices", vertices + crossings - static_cast<std::size_t>(seams.shared)},
             {"faces", faces},
             {"psnr", psnr_of(energy, samples)},
             {"max_error", max_error},
             {"shared", seams.shared}};
    return {};
}

std::string TileWorker::make_index(std::vector<job::Made>& made, Json& facts) {
    Json levels = Json::array(), tiles = Json::array();
    TileSeams all;
    for (int number = 0; number < static_cast<int>(plan_.levels.size()); ++number) {
        TileSeams seams;
        Json& level = levels.emplace_back();
        if (std::string why = add_level(number, level, tiles, seams); !why.empty()) return why;
        if (number == 0) facts = level;
        add(seams, all);
    }
    facts["open"] = all.open;
    facts["first"] = all.first;
    const Json& finest = levels[0];
    const Json index = {{"made_by", "hmesh " HMESH_VERSION_STRING},
                        {"plan", plan_.identity},
                        {"input", plan_.input.path},
                        {"width", plan_.width},
                        {"height", plan_.height},
                        {"channels", plan_.channels},
                        {"bits", plan_.bits},
                        {"samples", "points"},
                        {"effort", name_of(efforts, plan_.options.effort)},
                        {"seed", plan_.options.seed},
                        {"border_tolerance", finest["border_tolerance"]},
                        {"vertices", finest["vertices"]},
                        {"faces", finest["faces"]},
                        {"psnr", finest["psnr"]},
                        {"max_error", finest["max_error"]},
                        {"seams", value_of(all)},
                        {"levels", levels},
                        {"tiles", tiles}};
    const std::string text = index.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    made.emplace_back();
    return job::write_made(plan_.folder, "tiles/index.json", text.data(), text.size(), made.back());
}

std::string TileWorker::run(const TileTask& task, const hmesh::ParallelFor& parallel_for, std::string& said) {
    const auto work = [&](std::vector<job::Made>& made, Json& facts, std::string& told) -> std::string {
        const auto ended = [&](const std::string& why, const std::string& words) {
            told = why.empty() ? words : "";
            return why;
        };
        switch (task.kind) {
            case TileTaskKind::look: {
                const std::string why = look(task, parallel_for, facts);
                return ended(why, why.empty() ? facts["trials"][0][0].dump() + " vertices tried" : "");
            }
            case TileTaskKind::shares: {
                const std::string why = share(task.level, facts);
                return ended(why, why.empty() ? "sides within " + facts["tolerance"].dump() : "");
            }
            case TileTaskKind::tile: {
                const std::string why = make_tile(task, parallel_for, made, facts);
                return ended(why, why.empty() ? facts["vertices"].dump() + " vertices" : "");
            }
            case TileTaskKind::seams: {
                TileSeams seams;
                const std::string why = find_seams(plan_, task.level, task.y, seams);
                facts = value_of(seams);
                return ended(why, in_words(seams));
            }
            case TileTaskKind::index: break;
        }
        const std::string why = make_index(made, facts);
        return ended(why,
                     why.empty() ? job::words_of(facts["vertices"]) + " vertices, PSNR " + job::words_of(facts["psnr"]) : "");
    };
    return job::do_task(plan_.folder, plan_.identity, name_of(plan_, task), said, work);
}

}  // namespace tool
