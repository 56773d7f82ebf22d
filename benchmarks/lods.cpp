// lods: levels of detail by mesh_lods() and progressive_mesh() beside meshes of their own, as a Markdown table for each image.
//
//     lods [--vertices 8192] [--levels 5] [--effort normal] [--seeds 3] IMAGE...
//
// A row is a level: PSNR in dB of a mesh of its own, of the chain's level and by how much that is better, of the nested one, all
// means over the seeds; then processor seconds of meshes of their own. The last line has processor time of all coarser levels:
// of the chain, of meshes of their own, and their ratio. Runs are interleaved: of each seed first all meshes of their own, then
// the chain, of which the time counts from the end of the first level on, then the nested levels.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <hmesh/hmesh.hpp>
#include <hmesh/lods.hpp>

#include "common.hpp"

namespace {

struct Row {
    std::size_t vertices = 0;
    double own = 0, chain = 0, nested = 0;  // dB, sums over the seeds
    double seconds = 0;                     // of processor time, of meshes of their own
};

struct Times {
    double chain = 0, nested = 0;
};

bool add_seed(const hmesh::ImageView<std::uint8_t, 3>& view, std::int64_t n, int levels, const hmesh::Annealed& recipe,
              std::vector<Row>& rows, Times& times) {
    hmesh::Options options;
    for (std::size_t k = 0; k < static_cast<std::size_t>(levels); ++k) {
        options.target = hmesh::Target::vertices(n >> k);
        const double begin = bench::processor_seconds();
        const hmesh::Result own = hmesh::mesh_image(view, options, recipe);
        if (!own.status) return false;
        rows.resize(std::max(rows.size(), k + 1));
        rows[k].seconds += bench::processor_seconds() - begin;
        rows[k].vertices = own.report.vertices;
        rows[k].own += own.report.psnr;
    }
    double first_end = -1;
    const auto note = [&](const hmesh::ProgressInfo& info) {
        if (first_end < 0 && info.fraction >= 1 && std::strcmp(info.stage, "colors") == 0) first_end = bench::processor_seconds();
        return true;
    };
    options.target = hmesh::Target::vertices(n);
    options.progress = note;
    hmesh::LodOptions lod_options;
    lod_options.levels = levels;
    const hmesh::Lods lods = hmesh::mesh_lods(view, options, lod_options, recipe);
    times.chain += bench::processor_seconds() - first_end;
    if (!lods.status || lods.levels.size() != rows.size()) return false;
    options.progress = {};
    hmesh::ProgressiveOptions nested_options;
    nested_options.levels = levels;
    const double begin = bench::processor_seconds();
    const hmesh::ProgressiveMesh nested = hmesh::progressive_mesh(view, lods.levels[0].mesh, options, nested_options);
    times.nested += bench::processor_seconds() - begin;
    if (!nested.status || nested.levels.size() != rows.size()) return false;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows[k].chain += lods.levels[k].report.psnr;
        rows[k].nested += nested.levels[k].psnr;
    }
    return true;
}

void print(const std::string& name, const std::vector<Row>& rows, const Times& times, int seeds) {
    std::printf("\n%s\n\n| vertices | own dB | chain dB | gain | nested dB | own s |\n|---|---|---|---|---|---|\n", name.c_str());
    double own = 0;
    for (const Row& row : rows) {
        if (&row != rows.data()) own += row.seconds;
        std::printf("| %zu | %.2f | %.2f | %+.3f | %.2f | %.3f |\n", row.vertices, row.own / seeds, row.chain / seeds,
                    (row.chain - row.own) / seeds, row.nested / seeds, row.seconds / seeds);
    }
    std::printf("\ncoarser levels: chain %.3f s, own %.3f s, ratio %.3f; nested %.3f s\n", times.chain / seeds, own / seeds,
                times.chain / own, times.nested / seeds);
}

}  // namespace

int main(int argc, char** argv) {
    std::int64_t vertices = 8192;
    int levels = 5, seeds = 3;
    hmesh::Annealed recipe;
    std::vector<std::string> files;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool has_value = i + 1 < argc;
        if (word == "--vertices" && has_value) vertices = std::atoll(argv[++i]);
        else if (word == "--levels" && has_value) levels = std::atoi(argv[++i]);
        else if (word == "--seeds" && has_value) seeds = std::atoi(argv[++i]);
        else if (word == "--effort" && has_value && bench::effort_of(argv[i + 1], recipe.effort)) ++i;
        else files.push_back(word);
    }
    if (files.empty() || files[0].rfind("--", 0) == 0 || seeds < 1 || levels < 1 || levels > 32 ||
        (vertices >> (levels - 1)) < 4) {
        std::fprintf(stderr, "usage: lods [--vertices 8192] [--levels 5] [--effort normal] [--seeds 3] IMAGE...\n");
        return 2;
    }
    for (const std::string& file : files) {
        const auto picture = bench::read("lods", file);
        if (!picture) return 1;
        std::vector<Row> rows;
        Times times;
        for (int seed = 1; seed <= seeds; ++seed) {
            recipe.seed = static_cast<std::uint64_t>(seed);
            if (add_seed(picture->view(), vertices, levels, recipe, rows, times)) continue;
            std::fprintf(stderr, "lods: %s: not so many vertices\n", file.c_str());
            return 1;
        }
        print(bench::file_name(file), rows, times, seeds);
    }
}
