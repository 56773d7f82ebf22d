#include "hmesh/mesh/samples.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/fit/edge_moments.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/gpu.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/io/textured.hpp"
#include "hmesh/lods.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/paper.hpp"
#include "hmesh/render.hpp"
#include "hmesh/solve/linear_light.hpp"
#include "hmesh/sprite.hpp"
#include "point_colors.hpp"
#include "test_executors.hpp"
#include "test_exports.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Image;
using hmesh::Mesh;
using hmesh::Options;
using hmesh::Result;
using hmesh::Samples;
using hmesh::Target;
using hmesh::kit::Delaunay;
using hmesh::kit::Point;
using hmesh::kit::Random;

namespace {

std::string text_of(const hmesh::Status& status) { return hmesh::message(status).c_str(); }

Options of_points(const Target& target) {
    Options options{target};
    options.samples = Samples::points;
    return options;
}

// --- told without the library: a search through all faces for each sample ---

struct Errors {
    double energy = 0, largest = 0;
};

template <class T, int C>
Errors errors_of(const Image<T, C>& image, const Mesh& mesh, const hmesh::ImageView<float, 1>& weights = {}) {
    Errors out;
    float heaviest = 0;
    for (int j = 0; j < image.height() && weights.data != nullptr; ++j)
        for (int i = 0; i < image.width(); ++i) heaviest = std::max(heaviest, *weights.pixel(i, j));
    for (int j = 0; j < image.height(); ++j)
        for (int i = 0; i < image.width(); ++i) {
            const std::vector<double> color = hmesh_test::color_at(mesh, i, j);
            const double weight =
                weights.data == nullptr ? 1 : static_cast<double>(*weights.pixel(i, j)) / static_cast<double>(heaviest);
            for (std::size_t k = 0; k < C; ++k) {
                const double off = color[k] - hmesh::PixelTraits<T>::to_real(image.pixel(i, j)[k]);
                out.energy += weight * off * off;
                if (weight > 0) out.largest = std::max(out.largest, std::abs(off));
            }
        }
    return out;
}

// The result is a mesh over [0, W - 1] x [0, H - 1] and its report is true.
template <class T, int C>
void prove_points(const Image<T, C>& image, const Result& result, const hmesh::ImageView<float, 1>& weights = {}) {
    REQUIRE_MESSAGE(result.has_mesh(), text_of(result.status));
    CHECK(result.mesh.samples == Samples::points);
    CHECK(hmesh_test::flaw_of(result.mesh.view(), image.width(), image.height()) == "");
    const Errors errors = errors_of(image, result.mesh, weights);
    const double rounding = hmesh_test::energy_rounding(image);
    CHECK(std::abs(result.report.energy - errors.energy) <= 1e-6 * errors.energy + rounding);
    CHECK(result.report.max_error == doctest::Approx(errors.largest).epsilon(1e-6).scale(hmesh_test::magnitude_of(image)));
}

// --- random meshes over [1/2, W - 1/2] x [1/2, H - 1/2] ---

// A third of the points on samples, many on the border, and then edges turned at random, so that there are slivers too.
Delaunay random_mesh(int width, int height, int count, std::uint64_t seed) {
    Random random(seed);
    Delaunay mesh(width, height, Samples::points);
    for (int k = 0; k < count; ++k) {
        const bool on_samples = random.below(3) == 0;
        const auto place = [&](int size) {
            const auto steps = static_cast<std::size_t>(on_samples ? size - 1 : 256 * (size - 1));
            return static_cast<double>(random.below(steps + 1)) / (on_samples ? 1 : 256) + 0.5;
        };
        Point p{place(width), place(height)};
        switch (random.below(8)) {
            case 0: p.x = 0.5; break;
            case 1: p.x = width - 0.5; break;
            case 2: p.y = 0.5; break;
            case 3: p.y = height - 0.5; break;
            default: break;
        }
        mesh.insert(p);
    }
    REQUIRE(mesh.check());
    return mesh;
}

template <class T, int C>
void prove_moments(int width, int height, int count, std::uint64_t seed, bool weighted) {
    CAPTURE(width);
    CAPTURE(height);
    CAPTURE(seed);
    const Image<T, C> image = hmesh_test::noise<T, C>(width, height, seed);
    const Image<float, 1> weights = hmesh_test::random_weights(width, height, seed);
    const auto source =
        weighted ? hmesh::kit::ImageSource<C>(image.view(), weights.view(), 1) : hmesh::kit::ImageSource<C>(image.view());
    const hmesh::kit::MomentTable<C> table = source.with_samples(Samples::points).table({0, 0, width, height});
    const Delaunay delaunay = random_mesh(width, height, count, seed);
    hmesh::kit::HalfedgeMesh topology = delaunay.topology();
    const std::vector<Point>& at = delaunay.positions();
    Random random(seed);
    for (const hmesh::kit::Edge e : delaunay.topology().edges()) {
        if (random.below(2) == 0 || !topology.is_flip_ok(e)) continue;
        const auto h = hmesh::kit::HalfedgeMesh::halfedge(e), o = hmesh::kit::HalfedgeMesh::opposite(h);
        const Point a = at[topology.from_vertex(h).index()], b = at[topology.to_vertex(h).index()];
        const Point left = at[topology.to_vertex(topology.next(h)).index()],
                    right = at[topology.to_vertex(topology.next(o)).index()];
        if (hmesh::kit::orient2d(a, right, left) > 0 && hmesh::kit::orient2d(right, b, left) > 0) topology.flip(e);
    }
    std::vector<int> owners(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    const hmesh::kit::WeightScale scale(1, width, height);
    const auto weight_of = [&](int i, int j) { return weighted ? scale(*weights.pixel(i, j)) : 1; };
    double count_of_all = 0, sum_of_all = 0;
    hmesh::kit::ClipRect clip;
    clip.sides = table.far_sides();
    bool is_inside = true, agree = true;
    for (const hmesh::Triangle& face : topology.triangles()) {
        const Point a = at[face[0]], b = at[face[1]], c = at[face[2]];
        double weight = 0, sum = 0, sum_x = 0, sum_y = 0, squares = 0;
        hmesh::kit::for_each_span(a, b, c, clip, [&](int j, int begin, int end) {
            REQUIRE(j < height);
            REQUIRE(end <= width);
            for (int i = begin; i < end; ++i) {
                ++owners[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
                const Point p{i + 0.5, j + 0.5};  // differences and products of these are exact
                is_inside = is_inside && hmesh::kit::orient2d(a, b, p) >= 0 && hmesh::kit::orient2d(b, c, p) >= 0 &&
                            hmesh::kit::orient2d(c, a, p) >= 0;
                const double w = weight_of(i, j);
                const double value = hmesh::PixelTraits<T>::to_real(image.pixel(i, j)[0]);
                weight += w, sum += w * value, sum_x += w * i, sum_y += w * j;
                for (int k = 0; k < C; ++k) {
                    const double sample = hmesh::PixelTraits<T>::to_real(image.pixel(i, j)[k]);
                    squares += w * sample * sample;
                }
            }
        });
        hmesh::kit::Moments<C> moments = hmesh::kit::Moments<C>::zero(), edge;
        for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
            hmesh::kit::edge_moments(table, from, to, edge);
            moments += edge;
        }
        const double exact = hmesh::PixelTraits<T>::is_integer && !weighted ? 0 : 1e-9;
        const auto is_near = [&](double x, double y) { return std::abs(x - y) <= exact * (1 + std::abs(y)) * width * height; };
        agree = agree && is_near(moments.s[C], weight) && is_near(moments.s[0], sum) && is_near(moments.sx[C], sum_x) &&
                is_near(moments.sy[C], sum_y) && is_near(moments.q[3], squares);
        count_of_all += weight, sum_of_all += sum;
    }
    CHECK(is_inside);
    CHECK(agree);
    CHECK(std::count(owners.begin(), owners.end(), 1) == static_cast<std::ptrdiff_t>(owners.size()));
    double all = 0, whole = 0;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double w = weight_of(i, j);
            all += w, whole += w * hmesh::PixelTraits<T>::to_real(image.pixel(i, j)[0]);
        }
    CHECK(count_of_all == doctest::Approx(all).epsilon(1e-12));
    CHECK(sum_of_all == doctest::Approx(whole).epsilon(1e-9));
}

constexpr std::pair<int, int> sizes[] = {{2, 2}, {2, 3}, {3, 2}, {2, 17}, {17, 2}, {3, 3}, {5, 4}, {16, 16}, {33, 21}};

}  // namespace

TEST_CASE("each sample that is a point is in one face, which holds it, and edges carry the moments of these faces") {
    for (const auto& [width, height] : sizes)
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            const int count = static_cast<int>(seed % 4) * width * height / 3;
            prove_moments<std::uint8_t, 3>(width, height, count, seed, false);
            prove_moments<std::uint16_t, 1>(width, height, count, seed, false);
            prove_moments<float, 1>(width, height, count, seed, false);
            prove_moments<std::uint8_t, 1>(width, height, count, seed, true);
        }
    prove_moments<std::uint16_t, 4>(65, 63, 700, 3, false);
}

TEST_CASE("the largest images of points are rasterized to their last sample") {
    constexpr int size = hmesh::kit::max_side;
    const hmesh::kit::FarSides sides = hmesh::kit::far_sides(size, size, Samples::points);
    CHECK(sides.first_row(size - 0.5) == size);
    CHECK(sides.first_row(size - 0.5 - 1.0 / 256) == size - 1);
    CHECK(sides.walker({size - 0.5, 0.5}, {size - 0.5, size - 0.5}).column(7) == size);
    CHECK(sides.walker({0.5, 0.5}, {size - 0.5, size - 0.5}).column(size - 1) == size - 1);
    CHECK(sides.walker({0.5, size - 0.5 - 1.0 / 256}, {size - 0.5, size - 0.5}).column(size - 1) == size - 1);
}

TEST_CASE("every method meshes points, from the smallest images on, and its report is true") {
    for (const auto& [columns, rows] : sizes) {
        const int width = columns, height = rows;
        CAPTURE(width);
        CAPTURE(height);
        const auto bytes = hmesh_test::scene<std::uint8_t, 1>(width, height, 7);
        const auto colors = hmesh_test::noise<std::uint8_t, 3>(width, height, 8);
        const auto floats = hmesh_test::scene<float, 1>(width, height, 9);
        const auto deep = hmesh_test::noise<std::uint16_t, 2>(width, height, 10);
        for (const int n : {4, width * height / 3, width * height}) {
            if (n < 4 || (hmesh_test::sanitized && n == width * height / 3)) continue;
            CAPTURE(n);
            const Options options = of_points(Target::vertices(n));
            const auto prove = [&](const auto& recipe) {
                const auto prove_one = [&](const auto& image) {
                    const Result result = hmesh::mesh_image(image.view(), options, recipe);
                    CHECK_MESSAGE(result.status, text_of(result.status));
                    CHECK(result.report.vertices == static_cast<std::size_t>(n));
                    prove_points(image, result);
                };
                prove_one(bytes);
                prove_one(colors);
                prove_one(floats);
                prove_one(deep);
            };
            prove(Annealed{Effort::draft});
            prove(Annealed{Effort::fast});
            prove(Annealed());
            prove(hmesh::Hierarchical());
            prove(hmesh::Xie());
            prove(hmesh::Adams());
            prove(hmesh::AdaptiveThinning());
        }
    }
}

TEST_CASE("a plane through points costs nothing, and one vertex a sample holds each of them") {
    const auto plane = hmesh_test::draw<float, 1>(23, 9, [](int x, int y, int) { return 0.25 + x / 64.0 + y / 32.0; });
    const Result flat = hmesh::mesh_image(plane.view(), of_points(Target::vertices(4)));
    CHECK(flat.report.max_error <= 1e-6);
    CHECK(hmesh_test::flaw_of(flat.mesh.view(), 23, 9) == "");  // which knows its corners
    const auto noise = hmesh_test::noise<std::uint8_t, 1>(12, 15, 3);
    const Result all = hmesh::mesh_image(noise.view(), of_points(Target::vertices(180)), hmesh::AdaptiveThinning());
    CHECK(all.report.energy == 0);
    CHECK(all.report.max_error == 0);
}

TEST_CASE("the sides of a mesh of points are fitted about as closely as its inside") {
    constexpr int width = 150, height = 110;
    Random random(5);
    std::array<std::array<double, 3>, 40> waves{};  // hills of 9 to 60 samples in all directions
    for (auto& [x, y, phase] : waves) {
        const double angle = 6.283 * random.uniform(), length = 6.283 / (9 + 51 * random.uniform());
        x = length * std::cos(angle), y = length * std::sin(angle), phase = 6.283 * random.uniform();
    }
    const auto hills = hmesh_test::draw<float, 1>(width, height, [&](int i, int j, int) {
        double sum = 0;
        for (const auto& [x, y, phase] : waves) sum += std::sin(x * i + y * j + phase);
        return 0.5 + sum / 80;
    });
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
        CAPTURE(static_cast<int>(effort));
        const Result result = hmesh::mesh_image(hills.view(), of_points(Target::percent(3)), Annealed{effort});
        REQUIRE(result.status);
        const hmesh::RenderResult<1> drawn = hmesh::render<1>(result.mesh.view());
        double on_sides = 0;
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i) {
                const double off = static_cast<double>(drawn.image.pixel(i, j)[0]) - static_cast<double>(hills.pixel(i, j)[0]);
                if (i == 0 || j == 0 || i == width - 1 || j == height - 1) on_sides += off * off;
            }
        // Mean squares. Without points of their own the sides had 5 to 20 times that of the mesh.
        CHECK(on_sides / (2 * (width + height) - 4) < 2.5 * result.report.energy / (width * height));
    }
}

TEST_CASE("weights of pixels and channels, tiles, executors and starts are for points too") {
    constexpr int width = 132, height = 70;
    const auto image = hmesh_test::scene<std::uint8_t, 3>(width, height, 4);
    const auto weights = hmesh_test::random_weights(width, height, 4);
    Options options = of_points(Target::vertices(240));
    options.weights = weights.view();
    for (const Effort effort : {Effort::draft, Effort::normal})
        prove_points(image, hmesh::mesh_image(image.view(), options, Annealed{effort}), weights.view());
    prove_points(image, hmesh::mesh_image(image.view(), options, hmesh::Hierarchical()), weights.view());

    options = of_points(Target::vertices(240));
    options.channel_weights = {1, 3, 0};
    const Result scaled = hmesh::mesh_image(image.view(), options);
    CHECK(hmesh_test::flaw_of(scaled.mesh.view(), width, height) == "");
    double largest = 0;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const std::vector<double> color = hmesh_test::color_at(scaled.mesh, i, j);
            for (std::size_t k = 0; k < 2; ++k) largest = std::max(largest, std::abs(color[k] - image.pixel(i, j)[k]));
        }
    CHECK(scaled.report.max_error == doctest::Approx(largest).epsilon(1e-6));

    options = of_points(Target::vertices(240));
    const Annealed in_tiles{Effort::normal, 1, 64};
    const Result tiles = hmesh::mesh_image(image.view(), options, in_tiles);
    prove_points(image, tiles);
    CHECK(hmesh_test::same_bytes(tiles, hmesh::mesh_image(image.view(), options, in_tiles, hmesh_test::ThreadFor{3})));
    CHECK(hmesh_test::same_bytes(tiles, hmesh::mesh_image(image.view(), options, in_tiles, hmesh_test::ShuffledFor{5})));

    Annealed on{Effort::fast};
    on.start = &tiles.mesh;
    options.target = Target::vertices(330);
    const Result more = hmesh::mesh_image(image.view(), options, on);
    CHECK_MESSAGE(more.status, text_of(more.status));
    prove_points(image, more);
    options.samples = Samples::squares;
    CHECK(std::string(hmesh::mesh_image(image.view(), options, on).status.what) ==
          "the mesh to start from is of other samples, squares or points, than the image");

    const Result search = hmesh::mesh_image(image.view(), of_points(Target::psnr(28)), Annealed{Effort::draft});
    CHECK(search.status);
    CHECK(search.report.psnr >= 28);
    prove_points(image, search);
}

TEST_CASE("points give meshes as good as squares do") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(160, 120, 2);
    Options options{Target::vertices(500)};
    const double squares = hmesh::mesh_image(image.view(), options).report.psnr;
    options.samples = Samples::points;
    const double points = hmesh::mesh_image(image.view(), options).report.psnr;
    CHECK(std::abs(points - squares) < 0.5);
}

TEST_CASE("render draws points into points: corners onto corners, at any size") {
    const auto plane = hmesh_test::draw<float, 1>(17, 9, [](int x, int y, int) { return x / 16.0 + y / 8.0; });
    const Mesh mesh = hmesh::mesh_image(plane.view(), of_points(Target::vertices(40))).mesh;
    for (const auto& [width, height] : {std::pair{17, 9}, {2, 2}, {3, 40}, {161, 7}, {33, 17}}) {
        hmesh::RenderOptions options;
        options.width = width, options.height = height;
        const Image<float, 1> picture = hmesh_test::drawn<1>(mesh, options);
        double worst = 0;
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i)
                worst = std::max(worst,
                                 std::abs(static_cast<double>(*picture.pixel(i, j)) - (i / (width - 1.0) + j / (height - 1.0))));
        CHECK(worst < 1e-5);
    }
    hmesh::RenderOptions options;
    options.width = 1;
    const hmesh::RenderResult<1> refused = hmesh::render<1>(mesh.view(), options);
    CHECK(refused.status.code == Errc::invalid_argument);
    CHECK(text_of(refused.status).find("1") != std::string::npos);
}

TEST_CASE("levels of detail, colours for linear light and sprites are for points too") {
    const auto image = hmesh_test::scene<std::uint8_t, 4>(60, 50, 5);
    Options options = of_points(Target::vertices(200));
    const hmesh::Lods lods = hmesh::mesh_lods(image.view(), options, hmesh::LodOptions{});
    REQUIRE(lods.status);
    CHECK(lods.levels.size() > 1);
    for (const Result& level : lods.levels) prove_points(image, level);

    const hmesh::ProgressiveMesh nested = hmesh::progressive_mesh(image.view(), lods.levels.front().mesh, options);
    REQUIRE(nested.status);
    for (const hmesh::ProgressiveLevel& level : nested.levels) {
        Mesh mesh = nested.mesh;
        mesh.faces = level.faces;
        mesh.positions.resize(2 * level.vertices);
        mesh.colors.resize(4 * level.vertices);
        CHECK(hmesh_test::flaw_of(mesh.view(), 60, 50) == "");
        CHECK(level.energy == doctest::Approx(errors_of(image, mesh).energy).epsilon(1e-6));
    }

    Mesh light = lods.levels.front().mesh;
    const hmesh::LinearLightReport report = hmesh::fit_linear_light(light, image.view());
    REQUIRE(report.status);
    hmesh::RenderOptions linear;
    linear.interpolation = hmesh::RenderOptions::Interpolation::linear;
    const Image<float, 4> picture = hmesh_test::drawn<4>(light, linear);
    double energy = 0;
    for (std::size_t k = 0; k < picture.size(); ++k)
        energy += std::pow(static_cast<double>(picture.data()[k]) - image.data()[k], 2);
    CHECK(report.energy == doctest::Approx(energy).epsilon(1e-5));

    auto sprite = hmesh_test::scene<std::uint8_t, 4>(60, 50, 6);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 60; ++x)
            if (std::hypot(x - 30, y - 25) > 15) std::fill_n(sprite.pixel(x, y), 4, std::uint8_t{0});
    options.premultiplied = true;
    Result cut = hmesh::mesh_image(sprite.view(), options);
    REQUIRE(hmesh::drop_transparent(cut, sprite.view(), options).dropped_faces > 0);
    const Image<float, 4> left = hmesh_test::drawn<4>(cut.mesh);
    double sum = 0, largest = 0;
    for (std::size_t k = 0; k < left.size(); ++k) {
        const std::size_t alpha = k / 4 * 4 + 3;
        const double wanted = k == alpha ? sprite.data()[k] : std::round(sprite.data()[k] * sprite.data()[alpha] / 255.0);
        const double off = static_cast<double>(left.data()[k]) - wanted;
        sum += off * off, largest = std::max(largest, std::abs(off));
    }
    CHECK(cut.report.energy == doctest::Approx(sum).epsilon(1e-5));
    CHECK(cut.report.max_error == doctest::Approx(largest).epsilon(1e-5));
}

TEST_CASE("what cannot be an image of points is refused with a sentence") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(8, 8, 1);
    const auto refused = [&](int width, int height, const Options& options) {
        const Result result = hmesh::mesh_image(hmesh::ImageView<std::uint8_t, 1>{image.data(), width, height, 8}, options);
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK_FALSE(result.has_mesh());
        return text_of(result.status);
    };
    const Options options = of_points(Target::vertices(4));
    CHECK(refused(1, 8, options).find("at least 2 samples wide (1, limit 2)") != std::string::npos);
    CHECK(refused(8, 1, options).find("at least 2 samples high (1, limit 2)") != std::string::npos);
    Options periodic = options;
    periodic.periodic = hmesh::Periodic::x;
    CHECK(refused(8, 8, periodic).find("periodic") != std::string::npos);
    Options unknown = options;
    unknown.samples = static_cast<Samples>(7);
    CHECK(refused(8, 8, unknown).find('7') != std::string::npos);
    Mesh mesh = hmesh::mesh_image(image.view(), options).mesh;
    CHECK(check(mesh.view(), 16));
    mesh.width = 1;
    std::string text;
    const auto sink = hmesh::kit::append_to(text);
    CHECK_FALSE(hmesh::write_svg(mesh.view(), sink));
    CHECK(text.empty());
}

TEST_CASE("files of points have the size of the mesh, y up from its lower side, and samples in the middle of texels") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(21, 11, 5);
    const Mesh mesh = hmesh::mesh_image(image.view(), of_points(Target::vertices(4))).mesh;
    const auto file = [&](hmesh_test::Write write) { return hmesh_test::as_text(hmesh_test::exported(mesh.view(), write)); };
    const auto has = [](const std::string& text, const std::string& part) {
        CAPTURE(part);
        CHECK(text.find(part) != std::string::npos);
    };
    using hmesh::MeshView;
    using hmesh::Sink;
    has(file([](const MeshView& from, Sink to) { return hmesh::write_svg(from, to); }),
        "width=\"20\" height=\"10\" viewBox=\"0 0 20 10\"");
    has(file([](const MeshView& from, Sink to) { return hmesh::write_pdf(from, to); }), "[0 0 20 10]");
    has(file([](const MeshView& from, Sink to) { return hmesh::write_eps(from, to); }), "%%BoundingBox: 0 0 20 10\n");
    has(file([](const MeshView& from, Sink to) { return hmesh::write_html(from, to); }), "\"width\":20,\"height\":10,");
    const std::string obj = file([](const MeshView& from, Sink to) { return hmesh::write_obj(from, to); });
    for (const char* corner : {"v 0 10 0 ", "v 20 10 0 ", "v 0 0 0 ", "v 20 0 0 "}) has(obj, corner);
    const std::string glb = file([](const MeshView& from, Sink to) {
        hmesh::GltfOptions options;
        options.longer_side = 5;
        return hmesh::write_glb(from, to, options);
    });
    has(glb, "0.25");  // m a px
    const std::string textured =
        file([](const MeshView& from, Sink to) { return hmesh::write_textured_obj(from, "image.mtl", to); });
    for (const char* corner : {"vt 2.38095238e-2 0.954", "vt 0.976190476 4.545"})
        has(textured, corner);  // 1/2 and 20 1/2 of 21 texels
    const hmesh::GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view());
    REQUIRE(buffers.status);
    CHECK(buffers.layout.width == 20);
    CHECK(buffers.layout.height == 10);
}
