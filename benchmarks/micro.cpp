// micro: what the hot operators cost, one by one, on the library's own scene meshed at 1 % by a draft.
//
// The counter `each` is the time of one of what the comment beside a benchmark names.
//
//     micro [--benchmark_filter=REGEX]        (Google Benchmark)
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <hmesh/compact.hpp>
#include <hmesh/hmesh.hpp>
#include <hmesh/methods/hierarchical/bilateral.hpp>

#include "scene.hpp"

namespace {

using hmesh::kit::ImageMesh;
constexpr int channels = 3;

struct Fixture {
    hmesh::Image<std::uint8_t, channels> image;
    hmesh::kit::MomentTable<channels> table;
    hmesh::kit::IndexedMesh<channels> whole;
    ImageMesh<channels> mesh;
    std::vector<hmesh::kit::Vertex> vertices;  // in spatial order
    std::vector<hmesh::kit::Edge> edges;

    explicit Fixture(int width, int height)
        : image(tool::draw_scene(width, height)), table(image.view(), image.view().bounds()), mesh(table, 0, 255) {
        hmesh::kit::ProgressReporter progress({}, 1, 255);
        const hmesh::kit::ImageSource<channels> source(image.view());
        hmesh::kit::TiledMesh<channels> tiled(source, {}, progress);
        const auto n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) / 100;
        if (!hmesh::Annealed{hmesh::Effort::draft}.run(tiled, n)) std::abort();
        whole = tiled.indexed();
        if (!mesh.assign(whole.positions, whole.faces, whole.colors, {})) std::abort();
        vertices = hmesh::kit::spatial_vertices(mesh);
        for (const hmesh::kit::InsertionSite site : hmesh::kit::insertion_sites(mesh, false)) edges.push_back(site.edge());
    }
};

Fixture& fixture() {
    static Fixture f(384, 256);
    return f;
}

void per_item(benchmark::State& state, std::size_t items) {
    const auto seconds_each = benchmark::Counter::kIsRate | benchmark::Counter::kInvert;
    state.SetItemsProcessed(static_cast<std::int64_t>(items));
    state.counters["each"] = benchmark::Counter(static_cast<double>(items), seconds_each);
}

void moment_table(benchmark::State& state) {  // a pixel
    const auto view = fixture().image.view();
    std::size_t pixels = 0;
    for (auto _ : state) {
        const hmesh::kit::MomentTable<channels> table(view, view.bounds());
        benchmark::DoNotOptimize(table.bytes());
        pixels += static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    }
    per_item(state, pixels);
}

void bilateral(benchmark::State& state) {  // a pixel; the argument is the diameter
    const auto view = fixture().image.view();
    hmesh::kit::BilateralOptions options;
    options.diameter = static_cast<int>(state.range(0));
    std::size_t pixels = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(hmesh::kit::bilateral_filter(view, options).data());
        pixels += static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    }
    per_item(state, pixels);
}

void edge_walk(benchmark::State& state) {  // a row; the argument is the edge's rows
    const Fixture& f = fixture();
    const auto rows = static_cast<double>(state.range(0));
    hmesh::kit::Random random(1);
    std::vector<hmesh::kit::Point> starts;
    starts.reserve(256);
    for (int k = 0; k < 256; ++k) starts.push_back({40 + 300 * random.uniform(), (255 - rows) * random.uniform()});
    std::size_t walked = 0;
    for (auto _ : state)
        for (const hmesh::kit::Point a : starts) {
            hmesh::kit::Moments<channels> m;
            hmesh::kit::edge_moments(f.table, a, {a.x + 0.4 * rows - 20 * (rows > 50), a.y + rows}, m);
            benchmark::DoNotOptimize(m);
            walked += static_cast<std::size_t>(rows);
        }
    per_item(state, walked);
}

void ring_fit(benchmark::State& state) {  // a face of a ring, from moments in the cache
    const Fixture& f = fixture();
    std::vector<hmesh::kit::RingScratch<channels>> works(16);
    for (std::size_t k = 0; k < works.size(); ++k) {
        const hmesh::kit::Vertex v = f.vertices[k * f.vertices.size() / works.size()];
        f.mesh.gather(v, works[k].ring, works[k].spokes);
    }
    std::size_t faces = 0;
    for (auto _ : state)
        for (std::size_t k = 0; k < works.size(); ++k) {
            hmesh::kit::RingScratch<channels>& work = works[k];
            const hmesh::kit::Point at = f.mesh.position(f.vertices[k * f.vertices.size() / works.size()]);
            hmesh::kit::RingFit<channels> fit;
            benchmark::DoNotOptimize(hmesh::kit::fit_ring(work.ring, work.spokes, at, 0, work.faces, fit));
            benchmark::DoNotOptimize(fit);
            faces += static_cast<std::size_t>(work.ring.size - work.ring.first_face());
        }
    per_item(state, faces);
}

void vertex_visit(benchmark::State& state) {  // one Gauss-Newton step, undone
    Fixture& f = fixture();
    std::size_t visits = 0;
    for (auto _ : state)
        for (const hmesh::kit::Vertex v : f.vertices) {
            const auto mark = f.mesh.begin();
            benchmark::DoNotOptimize(hmesh::kit::improve_vertex(f.mesh, v, 0));
            f.mesh.rollback(mark);
            ++visits;
        }
    per_item(state, visits);
}

void flip_trial(benchmark::State& state) {  // an edge that can turn
    const Fixture& f = fixture();
    std::size_t trials = 0;
    for (auto _ : state)
        for (const hmesh::kit::Edge e : f.edges) {
            if (!hmesh::kit::is_flippable(f.mesh, e)) continue;
            hmesh::kit::FlipTrial<channels> trial;
            hmesh::kit::evaluate_flip(f.mesh, e, trial);
            benchmark::DoNotOptimize(trial);
            ++trials;
        }
    per_item(state, trials);
}

void insertion_candidate(benchmark::State& state) {  // an edge
    const Fixture& f = fixture();
    hmesh::kit::RingScratch<channels> work;
    std::size_t candidates = 0;
    for (auto _ : state)
        for (const hmesh::kit::Edge e : f.edges) {
            benchmark::DoNotOptimize(hmesh::kit::edge_candidate(f.mesh, work, e, false).gain);
            ++candidates;
        }
    per_item(state, candidates);
}

void collapse_candidate(benchmark::State& state) {  // a vertex
    const Fixture& f = fixture();
    hmesh::kit::RingScratch<channels> work;
    std::size_t candidates = 0;
    for (auto _ : state)
        for (const hmesh::kit::Vertex v : f.vertices) {
            benchmark::DoNotOptimize(hmesh::kit::cheapest_collapse(f.mesh, work, v).cost);
            ++candidates;
        }
    per_item(state, candidates);
}

// The cheapest collapses, known beforehand, each undone: alone, and with the relaxation of a trial of the annealing.
void collapse_undone(benchmark::State& state, bool relaxed) {  // a transaction
    Fixture& f = fixture();
    const hmesh::kit::HalfedgeMesh& topology = f.mesh.topology();
    hmesh::kit::RingScratch<channels> work;
    std::vector<std::pair<hmesh::kit::Vertex, hmesh::kit::Halfedge>> collapses;
    for (const hmesh::kit::Vertex v : f.vertices) {
        const auto candidate = hmesh::kit::cheapest_collapse(f.mesh, work, v);
        if (candidate.halfedge.is_valid()) collapses.emplace_back(v, candidate.halfedge);
    }
    std::vector<hmesh::kit::Vertex> ring;
    std::size_t transactions = 0;
    for (auto _ : state)
        for (const auto& [v, h] : collapses) {
            ring.clear();
            for (const hmesh::kit::Halfedge s : topology.outgoing(v)) ring.push_back(topology.to_vertex(s));
            const auto mark = f.mesh.begin();
            f.mesh.collapse(h);
            if (relaxed) hmesh::kit::relax(f.mesh, ring, {});
            f.mesh.rollback(mark);
            ++transactions;
        }
    per_item(state, transactions);
}

// Runs stage(mesh) on copies of the mesh with all vertices due.
template <class Stage>
void on_copies(benchmark::State& state, Stage&& stage) {
    const Fixture& f = fixture();
    for (auto _ : state) {
        state.PauseTiming();
        ImageMesh<channels> mesh = f.mesh;
        for (const hmesh::kit::Vertex v : f.vertices) mesh.set_dirty(v, true);
        state.ResumeTiming();
        stage(mesh);
    }
}

void sweep(benchmark::State& state) {  // a vertex, its place in the order and marking its neighbours included
    on_copies(state, [](ImageMesh<channels>& mesh) { benchmark::DoNotOptimize(hmesh::kit::sweep(mesh)); });
    per_item(state, static_cast<std::size_t>(state.iterations()) * fixture().vertices.size());
}

void flip_edges(benchmark::State& state) {  // an edge of the mesh
    on_copies(state, [](ImageMesh<channels>& mesh) { benchmark::DoNotOptimize(hmesh::kit::flip_edges(mesh)); });
    per_item(state, static_cast<std::size_t>(state.iterations()) * fixture().edges.size());
}

void bounded_colors(benchmark::State& state) {  // a vertex
    on_copies(state, [](ImageMesh<channels>& mesh) { hmesh::kit::bounded_colors(mesh, {0, 255, 1}); });
    per_item(state, static_cast<std::size_t>(state.iterations()) * fixture().vertices.size());
}

void annealing_sweep(benchmark::State& state) {  // a vertex
    on_copies(state, [](ImageMesh<channels>& mesh) {
        const double price = 0.3 * mesh.mean_energy(), n = static_cast<double>(mesh.vertex_count());
        hmesh::kit::AnnealingSweep<channels> sweep(mesh, {}, price, 0.3 * price, {0.9 * n, 1.1 * n}, hmesh::kit::Random(1));
        benchmark::DoNotOptimize(sweep.run(hmesh::kit::spatial_vertices(mesh)));
    });
    per_item(state, static_cast<std::size_t>(state.iterations()) * fixture().vertices.size());
}

// A mesh cut into patches of about this many px, their tables included, and put together again.
void patches(benchmark::State& state) {  // a vertex, with its 100 pixels
    const Fixture& f = fixture();
    hmesh::kit::ProgressReporter progress({}, 1, 255);
    const hmesh::kit::ImageSource<channels> source(f.image.view());
    hmesh::kit::TiledMesh<channels> tiled(source, {}, progress);
    tiled.indexed() = f.whole;
    const hmesh::kit::Tiling tiling(f.image.width(), f.image.height(), static_cast<double>(state.range(0)));
    for (auto _ : state) tiled.for_each(tiling, [](hmesh::kit::Patch<channels>&, std::size_t) {});
    per_item(state, static_cast<std::size_t>(state.iterations()) * f.vertices.size());
}

void draw(benchmark::State& state) {  // a pixel
    const Fixture& f = fixture();
    const auto mesh = hmesh::kit::to_mesh(f.whole, 255);
    std::size_t pixels = 0;
    for (auto _ : state) {
        const hmesh::RenderResult<channels> picture = hmesh::render<channels>(mesh.view());
        if (!picture.status) std::abort();
        pixels += picture.image.size() / channels;
    }
    per_item(state, pixels);
}

// A compact file of exact positions and colours of 8 bits.
std::vector<unsigned char> write_file(const hmesh::Mesh& mesh) {
    std::vector<unsigned char> file;
    const auto sink = [&](const void* bytes, std::size_t size) {
        const auto* const from = static_cast<const unsigned char*>(bytes);
        file.insert(file.end(), from, from + size);
        return true;
    };
    if (!hmesh::write_compact(mesh.view(), sink)) std::abort();
    return file;
}
void write_compact(benchmark::State& state) {  // a vertex
    const auto mesh = hmesh::kit::to_mesh(fixture().whole, 255);
    for (auto _ : state) benchmark::DoNotOptimize(write_file(mesh).size());
    per_item(state, static_cast<std::size_t>(state.iterations()) * mesh.vertex_count());
}
void read_compact(benchmark::State& state) {  // a vertex
    const auto file = write_file(hmesh::kit::to_mesh(fixture().whole, 255));
    std::size_t vertices = 0;
    for (auto _ : state) {
        const hmesh::CompactMesh read = hmesh::read_compact(file.data(), file.size());
        if (!read.status) std::abort();
        vertices += read.mesh.vertex_count();
    }
    per_item(state, vertices);
}

}  // namespace

BENCHMARK(moment_table)->Unit(benchmark::kMicrosecond);
BENCHMARK(bilateral)->Arg(5)->Arg(9)->Arg(15)->Unit(benchmark::kMicrosecond);
BENCHMARK(edge_walk)->Arg(4)->Arg(12)->Arg(40)->Arg(120);
BENCHMARK(ring_fit);
BENCHMARK(vertex_visit)->Unit(benchmark::kMicrosecond);
BENCHMARK(flip_trial)->Unit(benchmark::kMicrosecond);
BENCHMARK(insertion_candidate)->Unit(benchmark::kMicrosecond);
BENCHMARK(collapse_candidate)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(collapse_undone, alone, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(collapse_undone, relaxed, true)->Unit(benchmark::kMicrosecond);
BENCHMARK(sweep)->Unit(benchmark::kMicrosecond);
BENCHMARK(flip_edges)->Unit(benchmark::kMicrosecond);
BENCHMARK(annealing_sweep)->Unit(benchmark::kMicrosecond);
BENCHMARK(patches)->Arg(128)->Arg(64)->Unit(benchmark::kMicrosecond);
BENCHMARK(bounded_colors)->Unit(benchmark::kMicrosecond);
BENCHMARK(draw)->Unit(benchmark::kMicrosecond);
BENCHMARK(write_compact)->Unit(benchmark::kMicrosecond);
BENCHMARK(read_compact)->Unit(benchmark::kMicrosecond);
BENCHMARK_MAIN();
