// paper_table: Tables 1 and 2 of "Image meshing via hierarchical optimization" by the methods here, as Markdown.
//
//     paper_table [--rates 1,2,3] [--methods adams,xie,hierarchical,draft,fast,normal] [--repeat 3] [--seed 1]
//                 [--crop 256] [--variants] IMAGE...
//
// What is printed: PSNR of each method's mesh, once with the colours of the image under its vertices and once with those
// of least squares; processor seconds; adaptive thinning beside Adams' method on five parts of `--crop` pixels a side, the
// centre and the corners; how the linear solver did. --variants prints one table instead: what each part of the methods
// is worth.
//
// PSNR = 10 log10(255^2 / MSE), MSE the mean over pixels and channels of the final mesh, as it would be in a file:
// positions on the 1/256 px grid, 8-bit colours. Seconds are from decoded pixels to finished mesh with the method's own
// colours, on one thread, the least of the repeats; these go through all meshes over and over again, so that they are far
// apart. Repeats that differ are an error.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <hmesh/paper.hpp>

#include "common.hpp"

namespace {

using bench::Picture;
using View = hmesh::ImageView<std::uint8_t, 3>;
using Recipe = std::variant<hmesh::Annealed, hmesh::Hierarchical, hmesh::Xie, hmesh::Adams, hmesh::AdaptiveThinning>;

// --- what to measure ---
struct Plan {
    std::vector<std::string> rates{"1", "2", "3"};  // percent
    std::vector<std::string> methods{"adams", "xie", "hierarchical", "draft", "fast", "normal"}, images;
    std::uint64_t seed = 1;
    int repeats = 3, crop = 256;  // px; 0: no crops
    bool variants = false;
};

// Reads the command line. False where it is wrong.
bool parse(int argc, char** argv, Plan& plan) {
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--variants") plan.variants = true;
        else if (argument.compare(0, 2, "--") != 0) plan.images.push_back(argument);
        else if (i + 1 == argc) return false;
        else if (const std::string value = argv[++i]; argument == "--rates") plan.rates = bench::split(value);
        else if (argument == "--methods") plan.methods = value.empty() ? std::vector<std::string>{} : bench::split(value);
        else if (argument == "--repeat") plan.repeats = std::max(1, std::atoi(value.c_str()));
        else if (argument == "--seed") plan.seed = static_cast<std::uint64_t>(std::atoll(value.c_str()));
        else if (argument == "--crop") plan.crop = std::max(0, std::atoi(value.c_str()));
        else return false;
    }
    return !plan.images.empty();
}

// --- a mesh to be made and what came of it ---
struct Run {
    View image;
    hmesh::Options options;
    Recipe recipe;
    bool timed = true;  // else it is made once only

    double psnr = 0, seconds = 1e300;
    std::uint64_t hash = 0;
    std::vector<hmesh::StageReport> stages{};
    std::vector<float> positions{};
};

// Makes all meshes, `repeats` times. False, with a message: one could not be made.
bool measure(std::vector<Run>& runs, int repeats) {
    for (int k = 0; k < repeats; ++k)
        for (Run& run : runs) {
            if (k > 0 && !run.timed) continue;
            const double start = bench::processor_seconds();
            hmesh::Result result =
                std::visit([&](const auto& recipe) { return hmesh::mesh_image(run.image, run.options, recipe); }, run.recipe);
            run.seconds = std::min(run.seconds, bench::processor_seconds() - start);
            const std::uint64_t hash = bench::hash_of(result.mesh);
            const bool differs = k > 0 && hash != run.hash;
            if (!result.status || differs) {
                std::fprintf(stderr, "paper_table: %s\n", differs ? "two runs gave different meshes" : result.status.what);
                return false;
            }
            run.psnr = result.report.psnr;
            run.hash = hash;
            run.stages = std::move(result.report.stages);
            run.positions = std::move(result.mesh.positions);
        }
    return true;
}

// A method, or Annealed with an effort. Says if there is none of that name.
std::optional<Recipe> recipe_of(const std::string& name, std::uint64_t seed) {
    hmesh::Annealed annealed;
    annealed.seed = seed;
    if (bench::effort_of(name, annealed.effort)) return annealed;
    for (const Recipe& recipe :
         {Recipe(hmesh::Hierarchical()), Recipe(hmesh::Xie()), Recipe(hmesh::Adams()), Recipe(hmesh::AdaptiveThinning())})
        if (std::visit([&](const auto& method) { return name == method.name; }, recipe)) return recipe;
    std::fprintf(stderr, "paper_table: no method or effort is called %s\n", name.c_str());
    return {};
}

// Whether a method's own colors are sampled ones.
bool is_sampled(const Recipe& recipe) {
    return std::visit([](const auto& method) { return method.colors == hmesh::Colors::sampled; }, recipe);
}

hmesh::Options options_of(const std::string& rate) {
    hmesh::Options options;
    options.target = hmesh::Target::percent(std::atof(rate.c_str()));
    return options;
}
hmesh::Options with_colors(hmesh::Options options, hmesh::Colors colors) {
    options.colors = colors;
    return options;
}

// --- images ---
struct Named {
    std::string name;  // of the file, without its ending
    Picture picture;
};

std::string resolution(const View& view) { return std::to_string(view.width) + " x " + std::to_string(view.height); }

// The part of a packed `view` of at most `side` x `side` pixels that is nearest to its centre, 0, or to corner 1 to 4.
View part(const View& view, int side, int which) {
    const int width = std::min(side, view.width), height = std::min(side, view.height);
    const int x = which == 0 ? (view.width - width) / 2 : which % 2 == 1 ? 0 : view.width - width;
    const int y = which == 0 ? (view.height - height) / 2 : which <= 2 ? 0 : view.height - height;
    return {view.pixel(x, y), width, height, std::ptrdiff_t{3} * view.width};
}

constexpr const char* part_names[] = {"centre", "top left", "top right", "bottom left", "bottom right"};

// --- tables ---
void print_header(const std::vector<std::string>& columns) {
    for (const std::string& column : columns) std::printf("| %s ", column.c_str());
    std::printf("|\n");
    for (std::size_t i = 0; i < columns.size(); ++i) std::printf("|---");
    std::printf("|\n");
}

// Tables 1 and 2, and the linear solver. The exit status.
int tabulate_methods(const std::vector<Named>& images, const Plan& plan) {
    std::vector<Run> runs;  // by image, rate, method: with its own colours, then with the others
    for (const Named& image : images)
        for (const std::string& rate : plan.rates)
            for (const std::string& method : plan.methods) {
                const std::optional<Recipe> recipe = recipe_of(method, plan.seed);
                if (!recipe) return 2;
                const hmesh::Colors others = is_sampled(*recipe) ? hmesh::Colors::optimal : hmesh::Colors::sampled;
                runs.push_back({image.picture.view(), options_of(rate), *recipe});
                runs.push_back({image.picture.view(), with_colors(options_of(rate), others), *recipe});
                runs.back().timed = false;
            }
    if (!measure(runs, plan.repeats)) return 1;

    const auto for_each_row = [&](auto&& body) {
        std::size_t first = 0;
        for (const Named& image : images)
            for (const std::string& rate : plan.rates) {
                body(image, rate, first);
                first += 2 * plan.methods.size();
            }
    };
    std::printf("Table 1: PSNR in dB, with sampled / optimal colours.\n\n");
    std::vector<std::string> columns{"image", "SR (%)"};
    columns.insert(columns.end(), plan.methods.begin(), plan.methods.end());
    print_header(columns);
    for_each_row([&](const Named& image, const std::string& rate, std::size_t first) {
        std::printf("| %s | %s |", image.name.c_str(), rate.c_str());
        for (std::size_t i = first; i < first + 2 * plan.methods.size(); i += 2) {
            const bool own_sampled = is_sampled(runs[i].recipe);
            std::printf(" %.2f / %.2f |", runs[own_sampled ? i : i + 1].psnr, runs[own_sampled ? i + 1 : i].psnr);
        }
        std::printf("\n");
    });
    std::printf("\nTable 2: processor seconds.\n\n");
    columns.insert(columns.begin() + 1, "resolution");
    print_header(columns);
    for_each_row([&](const Named& image, const std::string& rate, std::size_t first) {
        std::printf("| %s | %s | %s |", image.name.c_str(), resolution(image.picture.view()).c_str(), rate.c_str());
        for (std::size_t i = first; i < first + 2 * plan.methods.size(); i += 2) std::printf(" %.2f |", runs[i].seconds);
        std::printf("\n");
    });
    if (std::find(plan.methods.begin(), plan.methods.end(), "hierarchical") == plan.methods.end()) return 0;
    std::printf(
        "\nThe geometry steps of hierarchical, coarse to fine: iterations of the solver (largest residual relative to "
        "the right-hand side).\n\n");
    print_header({"image", "SR (%)", "steps"});
    for_each_row([&](const Named& image, const std::string& rate, std::size_t first) {
        for (std::size_t i = first; i < first + 2 * plan.methods.size(); i += 2) {
            if (!std::holds_alternative<hmesh::Hierarchical>(runs[i].recipe)) continue;
            std::printf("| %s | %s |", image.name.c_str(), rate.c_str());
            const char* separator = " ";
            for (const hmesh::StageReport& stage : runs[i].stages) {
                if (std::string(stage.name) != "geometry") continue;
                std::printf("%s%d (%.1e)", separator, stage.iterations, stage.residual);
                separator = ", ";
            }
            std::printf(" |\n");
        }
    });
    return 0;
}

// Adaptive thinning beside Adams' method. The exit status.
int tabulate_crops(const std::vector<Named>& images, const Plan& plan) {
    std::vector<Run> runs;  // by image, part, rate: adams and adaptive_thinning, each with sampled and optimal colours
    for (const Named& image : images)
        for (int which = 0; which < 5; ++which)
            for (const std::string& rate : plan.rates)
                for (const Recipe& recipe : {Recipe(hmesh::Adams()), Recipe(hmesh::AdaptiveThinning())})
                    for (const hmesh::Colors colors : {hmesh::Colors::sampled, hmesh::Colors::optimal}) {
                        const View view = part(image.picture.view(), plan.crop, which);
                        runs.push_back({view, with_colors(options_of(rate), colors), recipe});
                        runs.back().timed = which == 0 && colors == hmesh::Colors::sampled;
                    }
    if (!measure(runs, plan.repeats)) return 1;
    std::printf("\nParts of at most %d x %d pixels: PSNR in dB, with sampled / optimal colours; processor seconds.\n\n",
                plan.crop, plan.crop);
    print_header({"image", "part", "SR (%)", "adams", "adaptive_thinning", "adams, s", "adaptive_thinning, s"});
    const Run* run = runs.data();
    for (const Named& image : images)
        for (const char* name : part_names)
            for (const std::string& rate : plan.rates) {
                std::printf("| %s | %s | %s | %.2f / %.2f | %.2f / %.2f | %.2f | %.2f |\n", image.name.c_str(), name,
                            rate.c_str(), run[0].psnr, run[1].psnr, run[2].psnr, run[3].psnr, run[0].seconds, run[2].seconds);
                run += 4;
            }
    return 0;
}

// --- what each part of the methods is worth ---
struct Variant {
    std::string name;
    Recipe recipe;
    std::optional<hmesh::Colors> colors{};  // none: the method's own
    bool as_solved = false;                 // measured before the final colours
};

std::vector<Variant> all_variants() {
    using hmesh::Colors;
    using hmesh::kit::FootSearch;
    using hmesh::kit::StepRule;
    std::vector<Variant> variants;
    const auto adams = [&](const char* name, double density, int smoothing, Colors colors) {
        variants.push_back({name, hmesh::Adams{density, smoothing}, colors});
    };
    adams("adams: density 2", 2, 3, Colors::sampled);
    adams("adams: as it is (density 4.5)", 4.5, 3, Colors::sampled);
    adams("adams: density 6", 6, 3, Colors::sampled);
    adams("adams: density 8", 8, 3, Colors::sampled);
    adams("adams: no smoothing", 4.5, 0, Colors::sampled);
    adams("adams: optimal colours", 4.5, 3, Colors::optimal);
    adams("adams: density 6, optimal colours", 6, 3, Colors::optimal);

    const auto xie = [&](const char* name, auto&& change) {
        hmesh::Xie recipe;
        change(recipe);
        variants.push_back({name, recipe});
    };
    xie("xie: as it is", [](hmesh::Xie&) {});
    xie("xie: 1 round", [](hmesh::Xie& o) { o.rounds = 1; });
    xie("xie: 1 round, 1 visit a vertex", [](hmesh::Xie& o) { o.rounds = o.search.visits = 1; });
    xie("xie: 1 round, 1 visit, steps of 1 px", [](hmesh::Xie& o) { o.rounds = o.search.visits = o.search.first_step = 1; });
    xie("xie: density 6", [](hmesh::Xie& o) { o.start.density = 6; });
    variants.push_back({"xie: optimal colours", hmesh::Xie(), Colors::optimal});

    using Paper = hmesh::Hierarchical;
    const auto paper = [&](const char* name, auto&& change) {
        Paper recipe;
        change(recipe);
        variants.push_back({name, recipe});
    };
    paper("hierarchical: as it is (2 levels, 2 rounds, density 6)", [](Paper&) {});
    variants.push_back({"hierarchical: sampled colours", Paper(), Colors::sampled});
    paper("hierarchical: the start alone, optimal colours", [](Paper& r) { r.rounds = 0; });
    paper("hierarchical: density 4.5", [](Paper& r) { r.start.density = 4.5; });
    paper("hierarchical: K under the pixels", [](Paper& r) { r.geometry.search = FootSearch::plane; });
    paper("hierarchical: K under the pixels, 1 level", [](Paper& r) {
        r.geometry.search = FootSearch::plane;
        r.levels = 1;
    });
    const auto literal = [&](const std::string& name, FootSearch search, double color_scale) {
        for (const bool as_solved : {true, false}) {
            paper((name + (as_solved ? ", colours as solved" : "")).c_str(), [&](Paper& r) {
                r.geometry.rule = StepRule::literal;
                r.geometry.search = search;
                r.geometry.color_scale = color_scale;
            });
            variants.back().as_solved = as_solved;
        }
    };
    literal("hierarchical: literal step, foot points in the one-ring", FootSearch::one_ring, 1);
    literal("hierarchical: literal step, foot points in the own face", FootSearch::own_face, 1);
    literal("hierarchical: literal step, one-ring, colour scale 0.1", FootSearch::one_ring, 0.1);
    paper("hierarchical: foot points in the one-ring", [](Paper& r) { r.geometry.search = FootSearch::one_ring; });
    paper("hierarchical: colour scale 0.1", [](Paper& r) { r.geometry.color_scale = 0.1; });
    paper("hierarchical: colour scale 0.3", [](Paper& r) { r.geometry.color_scale = 0.3; });
    paper("hierarchical: colour scale 3", [](Paper& r) { r.geometry.color_scale = 3; });
    paper("hierarchical: the whole step or none", [](Paper& r) { r.geometry.halvings = 0; });
    paper("hierarchical: 1 level", [](Paper& r) { r.levels = 1; });
    paper("hierarchical: 3 levels", [](Paper& r) { r.levels = 3; });
    paper("hierarchical: 2 levels, start on the image", [](Paper& r) { r.start_filtered = false; });
    paper("hierarchical: 3 levels, start on the image", [](Paper& r) {
        r.start_filtered = false;
        r.levels = 3;
    });
    paper("hierarchical: 1 round", [](Paper& r) { r.rounds = 1; });
    paper("hierarchical: 4 rounds", [](Paper& r) { r.rounds = 4; });
    paper("hierarchical: 4 rounds, 1 level", [](Paper& r) {
        r.rounds = 4;
        r.levels = 1;
    });
    paper("hierarchical: 8 rounds", [](Paper& r) { r.rounds = 8; });
    return variants;
}

// The share of b's positions, in percent, where a has no vertex.
double moved_percent(const std::vector<float>& a, const std::vector<float>& b) {
    std::set<std::pair<float, float>> places;
    for (std::size_t i = 0; i + 1 < a.size(); i += 2) places.insert({a[i], a[i + 1]});
    std::size_t moved = 0;
    for (std::size_t i = 0; i + 1 < b.size(); i += 2) moved += 1 - places.count({b[i], b[i + 1]});
    return 200.0 * static_cast<double>(moved) / static_cast<double>(b.size());
}

// The exit status.
int tabulate_variants(const std::vector<Named>& images, const Plan& plan) {
    const std::vector<Variant> variants = all_variants();
    const std::size_t cells = images.size() * plan.rates.size();
    std::vector<Run> runs, starts;  // by variant, image, rate; by variant, of the first image and rate only
    for (const Variant& variant : variants) {
        for (const Named& image : images)
            for (const std::string& rate : plan.rates) {
                runs.push_back({image.picture.view(), options_of(rate), variant.recipe});
                runs.back().options.colors = variant.colors;
            }
        starts.push_back(runs[runs.size() - cells]);
        if (auto* const xie = std::get_if<hmesh::Xie>(&starts.back().recipe)) xie->rounds = 0;
        if (auto* const paper = std::get_if<hmesh::Hierarchical>(&starts.back().recipe)) paper->rounds = 0;
    }
    if (!measure(runs, plan.repeats) || !measure(starts, 1)) return 1;
    std::printf(
        "PSNR in dB. s: processor seconds, the sum of the row. moved: the share of vertices of the first mesh of the "
        "row that are not where the start had any.\n\n");
    std::vector<std::string> columns{"variant"};
    for (const Named& image : images)
        for (const std::string& rate : plan.rates) columns.push_back(image.name + " " + rate + " %");
    columns.insert(columns.end(), {"s", "moved (%)"});
    print_header(columns);
    for (std::size_t i = 0; i < variants.size(); ++i) {
        std::printf("| %s |", variants[i].name.c_str());
        double seconds = 0;
        for (std::size_t k = i * cells; k < (i + 1) * cells; ++k) {
            const std::vector<hmesh::StageReport>& stages = runs[k].stages;  // the last is that of the final colours
            std::printf(" %.2f |", variants[i].as_solved ? stages[stages.size() - 2].psnr : runs[k].psnr);
            seconds += runs[k].seconds;
        }
        std::printf(" %.1f | %.0f |\n", seconds, moved_percent(starts[i].positions, runs[i * cells].positions));
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Plan plan;
    if (!parse(argc, argv, plan)) {
        std::fprintf(stderr,
                     "usage: paper_table [--rates 1,2,3] [--methods adams,xie,hierarchical,draft,fast,normal]\n"
                     "                   [--repeat 3] [--seed 1] [--crop 256] [--variants] IMAGE...\n");
        return 2;
    }
    std::vector<Named> images;
    for (const std::string& path : plan.images) {
        std::optional<Picture> picture = bench::read("paper_table", path);
        if (!picture) return 1;
        const std::string name = bench::file_name(path);
        images.push_back({name.substr(0, name.find_last_of('.')), std::move(*picture)});
    }
    std::printf(
        "PSNR = 10 log10(255^2 / MSE), MSE the mean over pixels and channels; positions on the 1/256 px grid, 8-bit "
        "colours.\n\n");
    if (plan.variants) return tabulate_variants(images, plan);
    if (const int status = plan.methods.empty() ? 0 : tabulate_methods(images, plan); status != 0) return status;
    return plan.crop > 0 ? tabulate_crops(images, plan) : 0;
}
