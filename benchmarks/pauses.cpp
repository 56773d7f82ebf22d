// pauses: for how long mesh_image() does not ask its progress callback, as a Markdown table with a row for each image.
//
//     pauses [--effort draft] [--rate 1] [--repeat 1] [--threads 1] [--periodic] [--weighted] IMAGE...
//
// The image is laid out --repeat times along each axis. "longest" is the longest time between two calls of the callback, or
// between one of them and the begin or end of mesh_image(), in wall time; under the table are all those above 50 ms, each with
// the stages and their fractions that the calls before and after it told, and when it began, on the clock that `perf record -k
// CLOCK_MONOTONIC` keeps. --weighted: the pixels have weights of 1 and 2.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <hmesh/hmesh.hpp>

#include "common.hpp"
#include "thread_pool.hpp"

namespace {

constexpr double long_pause = 0.05;  // s

// What the callback was told, and when; the begin and the end of the call are such calls too.
struct Call {
    double time = 0;  // s
    const char* stage = "";
    double fraction = 0;
};

struct Plan {
    hmesh::Annealed recipe{hmesh::Effort::draft};
    double rate = 1;  // vertices for 100 pixels
    int repeat = 1, threads = 1;
    bool is_periodic = false, is_weighted = false;
    std::vector<std::string> files;
};

bool parse(int argc, char** argv, Plan& plan) {
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool has_value = i + 1 < argc;
        if (word == "--periodic") plan.is_periodic = true;
        else if (word == "--weighted") plan.is_weighted = true;
        else if (word == "--rate" && has_value) plan.rate = std::atof(argv[++i]);
        else if (word == "--repeat" && has_value) plan.repeat = std::atoi(argv[++i]);
        else if (word == "--threads" && has_value) plan.threads = std::atoi(argv[++i]);
        else if (word == "--effort" && has_value && bench::effort_of(argv[i + 1], plan.recipe.effort)) ++i;
        else if (word.rfind("--", 0) == 0) return false;
        else plan.files.push_back(word);
    }
    return !plan.files.empty() && plan.rate > 0 && plan.repeat > 0 && plan.threads > 0;
}

bool measure(const std::string& name, const bench::Picture& picture, const Plan& plan, const example::ThreadPool& pool) {
    hmesh::Options options;
    options.target = hmesh::Target::percent(plan.rate);
    if (plan.is_periodic) options.periodic = hmesh::Periodic::xy;
    hmesh::Image<float, 1> weights;
    if (plan.is_weighted) {
        weights = hmesh::Image<float, 1>(picture.width(), picture.height());
        for (int y = 0; y < weights.height(); ++y)
            for (int x = 0; x < weights.width(); ++x) *weights.pixel(x, y) = x < weights.width() / 2 ? 1 : 2;
        options.weights = weights.view();
    }
    std::vector<Call> calls{{bench::wall_seconds(), "begin", 0}};
    const auto listen = [&](const hmesh::ProgressInfo& info) {
        calls.push_back({bench::wall_seconds(), info.stage, info.fraction});
        return true;
    };
    options.progress = listen;
    const hmesh::Result result = hmesh::mesh_image(picture.view(), options, plan.recipe, pool);
    calls.push_back({bench::wall_seconds(), "end", 1});
    if (!result.status) {
        std::fprintf(stderr, "pauses: %s: %s\n", name.c_str(), hmesh::message(result.status).c_str());
        return false;
    }
    double longest = 0;
    std::string list;
    for (std::size_t k = 1; k < calls.size(); ++k) {
        const Call &from = calls[k - 1], &to = calls[k];
        const double pause = to.time - from.time;
        longest = std::max(longest, pause);
        if (!(pause > long_pause)) continue;
        char line[200];
        std::snprintf(line, sizeof line, "  %.3f s from %s %.3f to %s %.3f, at %.3f\n", pause, from.stage, from.fraction,
                      to.stage, to.fraction, from.time);
        list += line;
    }
    std::printf("| %s | %d x %d | %zu | %.2f | %zu | %.3f |\n%s", name.c_str(), picture.width(), picture.height(),
                result.report.vertices, calls.back().time - calls.front().time, calls.size() - 2, longest, list.c_str());
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    Plan plan;
    if (!parse(argc, argv, plan)) {
        std::fprintf(stderr,
                     "usage: pauses [--effort draft] [--rate 1] [--repeat 1] [--threads 1] [--periodic] [--weighted] "
                     "IMAGE...\n");
        return 2;
    }
    const example::ThreadPool pool(static_cast<unsigned>(plan.threads));
    std::printf("| image | px | vertices | s | calls | longest, s |\n|---|---|---|---|---|---|\n");
    for (const std::string& file : plan.files) {
        const auto picture = bench::read("pauses", file);
        if (!picture) return 1;
        if (!measure(bench::file_name(file), bench::mosaic_of({*picture}, plan.repeat, plan.repeat), plan, pool)) return 1;
    }
}
