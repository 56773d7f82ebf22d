#include "terrain/job/tasks.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "job/work.hpp"
#include "terminal/progress_watch.hpp"
#include "terrain/job/places.hpp"

namespace terrain {
namespace {

using job::Json;
using Kind = TileEnd::Kind;

constexpr char index_file[] = "tiles/index.json";

Json value_of(const TileFacts& tile) {
    const TileEnd& end = tile.end;
    return {{"is", end.kind == Kind::empty ? "empty" : "made"},
            {"vertices", end.vertices},
            {"triangles", end.triangles},
            {"samples", end.samples},
            {"no_data", end.no_data},
            {"own_no_data", end.own_no_data},
            {"max_error", end.max_error},
            {"input_error", tile.input_error},
            {"skirt", tile.skirt},
            {"sum_of_squares", end.sum_of_squares},
            {"measured", end.measured},
            {"asked", end.asked},
            {"is_tighter", end.is_tighter},
            {"box", tile.box}};
}

TileFacts facts_of(const Json& facts) {
    TileFacts tile;
    tile.end.kind = facts["is"] == "empty" ? Kind::empty : Kind::made;
    const auto count = [&](const char* name) { return facts[name].get<std::size_t>(); };
    tile.end.vertices = count("vertices");
    tile.end.triangles = count("triangles");
    tile.end.samples = count("samples");
    tile.end.no_data = count("no_data");
    tile.end.own_no_data = count("own_no_data");
    tile.end.measured = count("measured");
    tile.end.max_error = facts["max_error"].get<double>();
    tile.input_error = facts["input_error"].get<double>();
    tile.skirt = facts["skirt"].get<double>();
    tile.end.sum_of_squares = facts["sum_of_squares"].get<double>();
    tile.end.asked = facts["asked"].get<double>();
    tile.end.is_tighter = facts["is_tighter"].get<bool>();
    tile.box = facts["box"].get<std::array<double, 6>>();
    return tile;
}

std::array<double, 6> box_of(const Model& model) {
    std::array<double, 6> box{};
    bool is_first = true;
    for (const auto* const vertices : {&model.vertices, &model.skirt})
        for (const std::array<double, 3>& vertex : *vertices) {
            for (std::size_t k = 0; k < 3; ++k) {
                box[k] = is_first ? vertex[k] : std::min(box[k], vertex[k]);
                box[k + 3] = is_first ? vertex[k] : std::max(box[k + 3], vertex[k]);
            }
            is_first = false;
        }
    return box;
}

std::string parse_tile(Format format, const std::vector<unsigned char>& bytes, Model& model) {
    const tool::Bytes file{bytes.data(), bytes.size()};
    return format == Format::quantized_mesh ? read_quantized_mesh(file, model) : read_glb(file, model);
}

// A task that another one needs.
std::string find_needed(const Plan& plan, const TaskName& task, job::Look look, job::Done& done, Json& facts) {
    done = job::find_done(plan.folder, plan.identity, name_of(plan, task), look, facts);
    return done.why;
}

std::string in_words(const Seams& seams) {
    std::string text = std::to_string(seams.pairs) + " pairs, " + std::to_string(seams.shared) + " vertices shared";
    if (seams.open > 0) text += ", " + std::to_string(seams.open) + " that the other has not";
    if (seams.no_data > 0) text += ", " + std::to_string(seams.no_data) + " beside samples without data";
    return text;
}

}  // namespace

std::string find_tile(const Plan& plan, const TaskName& task, TileFacts& facts) {
    job::Done done;
    Json found;
    if (std::string why = find_needed(plan, task, job::Look::sizes, done, found); !why.empty()) return why;
    facts = facts_of(found);
    if (!done.made.empty()) facts.file = done.made.front();
    return {};
}

std::string read_tile(const Plan& plan, const TaskName& task, TileFacts& facts, Model& model) {
    model = {};
    if (std::string why = find_tile(plan, task, facts); !why.empty()) return why;
    if (facts.end.kind == Kind::empty) return {};
    std::vector<unsigned char> bytes;
    if (std::string why = job::read_made(plan.folder, facts.file, bytes); !why.empty()) return why;
    const std::string why = parse_tile(plan.arguments.format, bytes, model);
    return why.empty() ? "" : "'" + plan.folder.path(facts.file.name) + "' cannot be read: " + why;
}

std::string Worker::open() {
    if (dem_) return {};
    return open_input(plan_, dem_);
}

std::string Worker::open(int level) {
    if (std::string why = open(); !why.empty()) return why;
    sources_.resize(plan_.levels.size());
    Source& source = sources_[static_cast<std::size_t>(level)];
    if (source.maker) return {};
    const Level& size = plan_.level(level);
    if (level > 0) source.thinned = thinned(*dem_, size);
    source.maker = std::make_unique<TileMaker>(size.arguments, level > 0 ? *source.thinned : *dem_);
    return source.maker->prepare(size.frame);
}

std::string Worker::make_tile(const TaskName& task, const hmesh::ParallelFor& parallel_for, std::vector<job::Made>& made,
                              Json& facts) {
    if (std::string why = open(task.level); !why.empty()) return why;
    const Level& level = plan_.level(task.level);
    const auto unread = [&](const std::string& why) {
        return why.empty() ? "" : "cannot read '" + plan_.arguments.input + "': " + why;
    };
    Tile tile = tile_of(plan_, task);
    if (plan_.has_skirts)
        if (std::string why = unread(find_skirt(plan_.levels, task.level, tile, *dem_, tile.skirt)); !why.empty()) return why;
    TileFacts found;
    found.skirt = tile.skirt;
    std::vector<unsigned char> bytes;
    const auto progress = [](const hmesh::ProgressInfo& /*info*/) { return !tool::interrupted; };
    TileMaker& maker = *sources_[static_cast<std::size_t>(task.level)].maker;
    if (std::string why = maker.make(tile, progress, parallel_for, found.end, bytes); !why.empty()) return why;
    found.input_error = found.end.max_error;
    if (found.end.kind == Kind::made) {
        if (task.level > 0) {
            Surface surface;
            if (std::string why = read_back(level.arguments.format, {bytes.data(), bytes.size()}, level.frame, tile, surface);
                !why.empty())
                return why;
            if (std::string why = unread(measure_all(level, tile, std::move(surface), *dem_, found.input_error)); !why.empty())
                return why;
        }
        Model model;
        if (std::string why = parse_tile(plan_.arguments.format, bytes, model); !why.empty()) return why;
        found.box = box_of(model);
        made.emplace_back();
        if (std::string why =
                job::write_made(plan_.folder, "tiles/" + tile_file(plan_, task), bytes.data(), bytes.size(), made.back());
            !why.empty())
            return why;
    }
    facts = value_of(found);
    return {};
}

std::string Worker::make_index(std::vector<job::Made>& made, Json& facts) {
    if (std::string why = open(); !why.empty()) return why;
    std::vector<PlacedTile> placed;
    Seams all;
    Json index, levels = Json::array(), values = Json::array();
    for (int level = 0; level < static_cast<int>(plan_.levels.size()); ++level) {
        const Level& size = plan_.level(level);
        std::vector<Tile> tiles;
        std::vector<TileEnd> ends;
        double input_error = 0;
        const std::size_t first = placed.size();
        for (int y = 0; y < size.down; ++y) {
            job::Done done;
            Json row;
            if (std::string why = find_needed(plan_, {TaskKind::seams, level, 0, y}, job::Look::sizes, done, row); !why.empty())
                return why;
            const Seams seams = seams_of(row);
            all.pairs += seams.pairs;
            all.shared += seams.shared;
            all.open += seams.open;
            all.no_data += seams.no_data;
            if (all.first.empty()) all.first = seams.first;
            for (int x = 0; x < size.across; ++x) {
                const TaskName task{TaskKind::tile, level, x, y};
                TileFacts found;
                if (std::string why = find_tile(plan_, task, found); !why.empty()) return why;
                tiles.push_back(tile_of(plan_, task));
                tiles.back().file = tile_file(plan_, task);
                ends.push_back(found.end);
                input_error = std::max(input_error, found.input_error);
                placed.push_back({task, tiles.back().file, found});
            }
        }
        Json report = report_value(size.arguments, *dem_, size.frame, tiles, ends);
        for (std::size_t k = 0; k < tiles.size(); ++k) {
            const TileFacts& facts_of_tile = placed[first + k].facts;
            Json value = {{"level", level}};
            value.update(report["tiles"][k]);
            if (facts_of_tile.end.kind == Kind::made) {
                value["input_error"] = facts_of_tile.input_error;
                if (plan_.has_skirts) value["skirt"] = facts_of_tile.skirt;
            }
            value["bytes"] = facts_of_tile.file.bytes;
            value["sha256"] = facts_of_tile.file.sha256;
            values.push_back(std::move(value));
        }
        Json sums = {{"step", size.step}, {"column", size.column}, {"row", size.row}};
        for (const char* const name : {"samples", "bound", "vertices", "triangles", "max_error", "rms_error"})
            sums[name] = report[name];
        sums["input_error"] = input_error;
        levels.push_back(std::move(sums));
        if (level == 0) index = std::move(report);
    }
    index["input"] = plan_.input.path;  // on whatever machine this is
    index["reader"] = plan_.reader;
    index["plan"] = plan_.identity;
    index.erase("tiles");
    index["seams"] = terrain::value_of(all);
    index["levels"] = std::move(levels);
    index["tiles"] = std::move(values);
    const auto write = [&](const std::string& name, const Json& value) {
        const std::string text = value.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
        made.emplace_back();
        return job::write_made(plan_.folder, name, text.data(), text.size(), made.back());
    };
    if (plan_.arguments.format == Format::glb) {
        if (std::string why = write("tiles/tileset.json", tileset_value(plan_, dem_->place, placed)); !why.empty()) return why;
    } else if (plan_.globe) {
        if (std::string why = write("tiles/layer.json", layer_value(plan_, placed)); !why.empty()) return why;
    }
    if (std::string why = write(index_file, index); !why.empty()) return why;
    facts = terrain::value_of(all);
    return {};
}

std::string Worker::run(const TaskName& task, const hmesh::ParallelFor& parallel_for, std::string& said) {
    const auto work = [&](std::vector<job::Made>& made, Json& facts, std::string& told) -> std::string {
        switch (task.kind) {
            case TaskKind::tile: {
                if (std::string why = make_tile(task, parallel_for, made, facts); !why.empty()) return why;
                const TileEnd end = facts_of(facts).end;
                char text[64];
                std::snprintf(text, sizeof text, "off by at most %.6g", end.max_error);
                told = end.kind == Kind::empty ? "no data, no file" : std::to_string(end.triangles) + " triangles, " + text;
                return {};
            }
            case TaskKind::seams: {
                Seams seams;
                if (std::string why = find_seams(plan_, task.level, task.y, seams); !why.empty()) return why;
                facts = terrain::value_of(seams);
                told = in_words(seams);
                return {};
            }
            case TaskKind::index: break;
        }
        if (std::string why = make_index(made, facts); !why.empty()) return why;
        told = in_words(seams_of(facts));
        return {};
    };
    return job::do_task(plan_.folder, plan_.identity, name_of(plan_, task), said, work);
}

}  // namespace terrain
