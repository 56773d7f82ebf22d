#include "hmesh/methods/hierarchical/footpoints.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/solve/eigen.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"
#include "test_weighted.hpp"

namespace kit = hmesh::kit;
using Eigen::Index;
using Eigen::MatrixXd;
using hmesh::kit::Barycentric;
using hmesh::kit::Face;
using hmesh::kit::FootSearch;
using hmesh::kit::ImageMesh;
using hmesh::kit::LiftedFace;
using hmesh::kit::LiftedPoint;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Subject;
using hmesh_test::Weighted;

namespace {

// --- the nearest point of a triangle in long doubles, from the vectors themselves ---

template <int C>
using Vector = Eigen::Matrix<long double, 2 + C, 1>;
using Weights = std::array<long double, 3>;

template <int C>
struct Foot {
    Weights weights{};
    long double distance = std::numeric_limits<long double>::infinity();
};

template <int C>
Vector<C> vector_of(const LiftedPoint<C>& p) {
    Vector<C> v;
    v[0] = p.position.x, v[1] = p.position.y;
    for (int k = 0; k < C; ++k) v[2 + k] = p.color[k];
    return v;
}

template <int C>
using Corners = std::array<Vector<C>, 3>;

template <int C>
long double distance_to(const Corners<C>& corners, const Weights& w, const Vector<C>& p) {
    return (p - w[0] * corners[0] - w[1] * corners[1] - w[2] * corners[2]).norm();
}

// The least of: the three corners, the nearest points on the lines of the three sides and the one in the plane, as far as
// they belong to the triangle. No regions, no signs.
template <int C>
Foot<C> exhaustive_foot(const Corners<C>& corners, const Vector<C>& p) {
    Foot<C> best;
    const auto consider = [&](const Weights& w) {
        if (!(w[0] >= 0 && w[1] >= 0 && w[2] >= 0)) return;
        const long double distance = distance_to<C>(corners, w, p);
        if (distance < best.distance) best = {w, distance};
    };
    for (std::size_t k = 0; k < 3; ++k) {
        Weights w{};
        w[k] = 1;
        consider(w);
        const std::size_t next = (k + 1) % 3;
        const Vector<C> side = corners[next] - corners[k];
        const long double t = side.dot(p - corners[k]) / side.squaredNorm();
        w[k] = 1 - t;
        w[next] = t;
        consider(w);
    }
    // Gram and Schmidt, the longer of two sides first: normal equations would square the condition of slivers.
    const Vector<C> sides[3] = {corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (sides[k].norm() > sides[longest].norm()) longest = k;
    const std::size_t from = longest, to = (longest + 1) % 3, apex = (longest + 2) % 3;
    const Vector<C> along = sides[longest], other = corners[apex] - corners[from];
    const long double share = along.dot(other) / along.squaredNorm();
    const Vector<C> height = other - share * along, q = p - corners[from];
    const long double h = height.dot(q) / height.squaredNorm(), t = along.dot(q) / along.squaredNorm() - share * h;
    Weights w{};
    w[from] = 1 - t - h;
    w[to] = t;
    w[apex] = h;
    consider(w);
    return best;
}

// By search: the best of a grid on the triangle, then of finer ones around the best. Distances fall off convexly.
template <int C>
long double searched_distance(const Corners<C>& corners, const Vector<C>& p) {
    long double best = std::numeric_limits<long double>::infinity(), b0 = 0.5L, c0 = 0.5L, step = 0.125L;
    for (int level = 0; level < 24; ++level, step /= 2) {
        long double best_b = b0, best_c = c0;
        for (int i = -4; i <= 4; ++i)
            for (int j = -4; j <= 4; ++j) {
                const long double b = std::clamp(b0 + i * step, 0.0L, 1.0L), c = std::clamp(c0 + j * step, 0.0L, 1 - b);
                const long double distance = distance_to<C>(corners, {1 - b - c, b, c}, p);
                if (distance < best) best = distance, best_b = b, best_c = c;
            }
        b0 = best_b;
        c0 = best_c;
    }
    return best;
}

template <int C>
LiftedPoint<C> random_point(Random& random, double extent, double color_extent) {
    LiftedPoint<C> p{{extent * random.uniform(), extent * random.uniform()}, kit::Color<C>::zero()};
    for (int k = 0; k < C; ++k) p.color.set(k, color_extent * random.uniform());
    return p;
}

template <int C>
LiftedPoint<C> between(const LiftedPoint<C>& a, const LiftedPoint<C>& b, double t) {
    return {{a.position.x + t * (b.position.x - a.position.x), a.position.y + t * (b.position.y - a.position.y)},
            a.color + t * (b.color - a.color)};
}

// foot() is what the exhaustive search finds, up to `slack` of the size of what it is computed from.
template <int C>
void check_foot(const std::array<LiftedPoint<C>, 3>& face, const LiftedPoint<C>& pixel, long double slack) {
    const Corners<C> corners = {vector_of<C>(face[0]), vector_of<C>(face[1]), vector_of<C>(face[2])};
    const Vector<C> p = vector_of<C>(pixel);
    long double size = 0;
    for (const Vector<C>& corner : corners) size = std::max({size, (corner - p).norm(), (corner - corners[0]).norm()});
    double distance2 = -1;
    const Barycentric w = LiftedFace<C>(face[0], face[1], face[2]).foot(pixel, distance2);
    REQUIRE(w.a >= 0);
    REQUIRE(w.b >= 0);
    REQUIRE(w.c >= 0);
    REQUIRE(std::abs(w.a + w.b + w.c - 1) <= 1e-15);
    const long double distance = distance_to<C>(corners, {w.a, w.b, w.c}, p);
    REQUIRE(distance2 >= 0);
    REQUIRE(std::abs(distance2 - distance * distance) <= 1e-14L * size * size);
    const Foot<C> expected = exhaustive_foot<C>(corners, p);
    REQUIRE(distance - expected.distance <= slack * size);
}

struct Seen {
    int corners = 0, sides = 0, inside = 0;
};

template <int C>
void check_feet(double color_extent, std::uint64_t seed, Seen& seen) {
    CAPTURE(C);
    Random random(seed);
    for (int k = 0; k < 1500; ++k) {
        const std::array<LiftedPoint<C>, 3> face = {random_point<C>(random, 10, color_extent),
                                                    random_point<C>(random, 10, color_extent),
                                                    random_point<C>(random, 10, color_extent)};
        LiftedPoint<C> pixel = random_point<C>(random, 10, color_extent);
        if (k % 3 == 0) pixel = between(between(face[0], face[1], random.uniform()), face[2], random.uniform());
        check_foot<C>(face, pixel, 1e-14L);
        double distance2 = 0;
        const Barycentric w = LiftedFace<C>(face[0], face[1], face[2]).foot(pixel, distance2);
        const int zeros = (w.a == 0) + (w.b == 0) + (w.c == 0);
        ++(zeros == 2 ? seen.corners : zeros == 1 ? seen.sides : seen.inside);
    }
}

}  // namespace

TEST_CASE("the exhaustive search that the tests compare with finds what a plain search on a grid finds") {
    Random random(1);
    for (int k = 0; k < 30; ++k) {
        const Corners<3> corners = {vector_of<3>(random_point<3>(random, 10, 10)), vector_of<3>(random_point<3>(random, 10, 10)),
                                    vector_of<3>(random_point<3>(random, 10, 10))};
        const Vector<3> p = vector_of<3>(random_point<3>(random, 10, 10));
        CHECK(std::abs(exhaustive_foot<3>(corners, p).distance - searched_distance<3>(corners, p)) < 1e-5L);
    }
}

TEST_CASE("a foot point is the nearest point of the triangle, in 3, 5 and 6 dimensions, near and far from it") {
    Seen seen;
    for (const double color_extent : {0.0, 1.0, 10.0, 1000.0}) {
        check_feet<1>(color_extent, 1, seen);
        check_feet<3>(color_extent, 2, seen);
        check_feet<4>(color_extent, 3, seen);
    }
    CHECK(seen.corners > 1000);
    CHECK(seen.sides > 1000);
    CHECK(seen.inside > 1000);
}

TEST_CASE("a foot point on a sliver is the nearest point too") {
    Random random(5);
    for (int k = 0; k < 4000; ++k) {
        const double extent = k % 2 == 0 ? 255 : 10;
        const LiftedPoint<3> a = random_point<3>(random, 300, extent), b = random_point<3>(random, 300, extent);
        LiftedPoint<3> c = between(a, b, 1.5 * random.uniform() - 0.25);
        const double off = std::pow(10, -1 - 8 * random.uniform());
        c.position.x += off * random.uniform();
        c.color.set(1, c.color[1] + off * random.uniform());
        LiftedPoint<3> pixel = random_point<3>(random, 300, extent);
        if (k % 3 == 0) pixel = between(a, b, random.uniform());
        if (k % 3 == 1) pixel = between(a, c, 1.5 * random.uniform());
        const std::array<std::array<LiftedPoint<3>, 3>, 3> turns = {{{a, b, c}, {b, c, a}, {c, a, b}}};
        for (const auto& face : turns) check_foot<3>(face, pixel, 1e-14L);
    }
}

TEST_CASE("a triangle without area has a nearest point as well: of a segment, or of a point") {
    Random random(6);
    for (int k = 0; k < 500; ++k) {
        const LiftedPoint<3> a = random_point<3>(random, 10, 255), b = random_point<3>(random, 10, 255),
                             pixel = random_point<3>(random, 10, 255);
        check_foot<3>({a, a, a}, pixel, 1e-14L);
        check_foot<3>({a, a, b}, pixel, 1e-14L);
        check_foot<3>({a, b, a}, pixel, 1e-14L);
        check_foot<3>({b, a, a}, pixel, 1e-14L);
        const LiftedPoint<3> middle = between(a, b, 0.5);
        check_foot<3>({a, b, middle}, pixel, 1e-14L);
        check_foot<3>({a, middle, b}, pixel, 1e-14L);
        check_foot<3>({middle, a, b}, pixel, 1e-14L);
        check_foot<3>({a, b, middle}, a, 1e-14L);
    }
}

TEST_CASE("colours as large as floats go, in whatever scale, leave weights that are weights") {
    Random random(7);
    for (const double extent : {1e10, 1e20, 3.4e38, 1e44}) {
        for (int k = 0; k < 500; ++k) {
            const LiftedPoint<3> a = random_point<3>(random, 10, extent), b = random_point<3>(random, 10, extent);
            const LiftedPoint<3> c = k % 2 == 0 ? random_point<3>(random, 10, extent) : between(a, b, random.uniform());
            check_foot<3>({a, b, c}, random_point<3>(random, 10, extent), 1e-14L);
            LiftedPoint<3> d = a;  // constant, but for one channel
            d.position = b.position;
            d.color.set(2, 0);
            check_foot<3>({a, d, c}, random_point<3>(random, 10, extent), 1e-14L);
        }
    }
}

// --- sums over the pixels of a mesh ---

namespace {

// The K of foot points, an entry a corner, with what tells how near these are.
struct Columns {
    Eigen::SparseMatrix<double> k;      // n_v by n_p
    Eigen::VectorXd weight, distance2;  // by pixel
    MatrixXd image, centers;            // n_p by C, n_p by 2
};

enum class Reach { own, ring, all };

// Pixel by pixel, by the definitions: the owner, the faces within reach, the exhaustive search in each.
template <int C>
Columns naive_columns(const ImageMesh<C>& mesh, Reach reach, double color_scale) {
    const kit::HalfedgeMesh& topology = mesh.topology();
    const std::vector<int> rows = kit::vertex_rows(topology);
    const int width = mesh.width(), height = mesh.height();
    const auto lifted = [&](Vertex v) { return LiftedPoint<C>{mesh.position(v), mesh.color(v) * color_scale}; };
    const auto share_vertex = [&](Face f, Face g) {
        const auto a = topology.vertices(f), b = topology.vertices(g);
        return std::any_of(a.begin(), a.end(), [&](Vertex v) { return std::find(b.begin(), b.end(), v) != b.end(); });
    };
    Columns columns;
    const Index pixels = width * height;
    columns.weight.resize(pixels);
    columns.distance2.resize(pixels);
    columns.image.resize(pixels, C);
    columns.centers.resize(pixels, 2);
    std::vector<Eigen::Triplet<double>> entries;
    for (const Face f : topology.faces()) {
        std::vector<Face> within;
        for (const Face g : topology.faces())
            if (reach == Reach::all || g == f || (reach == Reach::ring && share_vertex(f, g))) within.push_back(g);
        const auto owner = topology.vertices(f);
        hmesh_test::for_each_pixel(
            width, height, mesh.position(owner[0]), mesh.position(owner[1]), mesh.position(owner[2]), [&](int i, int j) {
                kit::Color<C> image;
                mesh.table().pixel(i, j, image);
                const LiftedPoint<C> pixel{{i + 0.5, j + 0.5}, image * color_scale};
                Foot<C> best;
                std::array<Vertex, 3> at{};
                for (const Face g : within) {
                    const auto v = topology.vertices(g);
                    const Foot<C> foot =
                        exhaustive_foot<C>({vector_of<C>(lifted(v[0])), vector_of<C>(lifted(v[1])), vector_of<C>(lifted(v[2]))},
                                           vector_of<C>(pixel));
                    if (foot.distance < best.distance) best = foot, at = v;
                }
                const Index p = j * width + i;
                for (std::size_t k = 0; k < 3; ++k)
                    entries.emplace_back(rows[at[k].index()], static_cast<int>(p), static_cast<double>(best.weights[k]));
                columns.weight[p] = mesh.table().weight(i, j);
                columns.distance2[p] = static_cast<double>(best.distance * best.distance);
                for (int k = 0; k < C; ++k) columns.image(p, k) = image[k];
                columns.centers.row(p) << i + 0.5, j + 0.5;
            });
    }
    columns.k.resize(static_cast<Index>(mesh.vertex_count()), pixels);
    columns.k.setFromTriplets(entries.begin(), entries.end());
    return columns;
}

double largest(const MatrixXd& m) { return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff(); }

template <int C>
struct Sums {
    MatrixXd gram, positions, image;
    Sums(const ImageMesh<C>& mesh, const kit::Array<kit::CornerSums<C>>& corners)
        : gram(kit::gram_matrix(mesh.topology(), corners)), positions(kit::position_rhs<C>(mesh.topology(), corners)),
          image(kit::image_rhs<C>(mesh.topology(), corners)) {}
};

// The squared distances of all pixels to their foot points, by weight, as the sums have it.
template <int C>
double distances(const ImageMesh<C>& mesh, const Columns& pixels, const Sums<C>& sums, double scale) {
    const MatrixXd v = kit::position_matrix(mesh), c = kit::color_matrix(mesh);
    const MatrixXd weighted_centers = pixels.weight.asDiagonal() * pixels.centers,
                   weighted_image = pixels.weight.asDiagonal() * pixels.image;
    const double positions = weighted_centers.cwiseProduct(pixels.centers).sum() - 2 * v.cwiseProduct(sums.positions).sum() +
                             v.cwiseProduct(sums.gram * v).sum();
    const double colors = weighted_image.cwiseProduct(pixels.image).sum() - 2 * c.cwiseProduct(sums.image).sum() +
                          c.cwiseProduct(sums.gram * c).sum();
    return positions + scale * scale * colors;
}

template <int C>
void check_sums(const ImageMesh<C>& mesh, double scale) {
    CAPTURE(C);
    double before = std::numeric_limits<double>::infinity();
    for (const FootSearch search : {FootSearch::plane, FootSearch::own_face, FootSearch::one_ring}) {
        const Columns columns = naive_columns(mesh, search == FootSearch::one_ring ? Reach::ring : Reach::own, scale);
        const Sums<C> sums(mesh, kit::foot_sums(mesh, search, scale));
        const double total = distances(mesh, columns, sums, scale);
        if (search != FootSearch::plane) {
            const Eigen::SparseMatrix<double> weighted = columns.k * columns.weight.asDiagonal();
            const MatrixXd gram = MatrixXd(weighted * columns.k.transpose()), positions = weighted * columns.centers,
                           image = weighted * columns.image;
            CHECK(largest(sums.gram - gram) <= 1e-9 * largest(gram));
            CHECK(largest(sums.positions - positions) <= 1e-9 * largest(positions));
            CHECK(largest(sums.image - image) <= 1e-9 * largest(image));
            CHECK(total == doctest::Approx(columns.weight.dot(columns.distance2)).epsilon(1e-6));
        }
        CHECK(total < before);
        before = total;
    }
    const Columns all = naive_columns(mesh, Reach::all, scale);
    CHECK(before >= all.weight.dot(all.distance2) * (1 - 1e-9));
}

template <int C>
bool same_bytes(const kit::Array<kit::CornerSums<C>>& a, const kit::Array<kit::CornerSums<C>>& b) {
    bool same = a.size() == b.size();
    for (std::size_t i = 0; same && i < a.size(); ++i) {
        const double x[4] = {a[i].square, a[i].coupling, a[i].x, a[i].y}, y[4] = {b[i].square, b[i].coupling, b[i].x, b[i].y};
        same = std::memcmp(x, y, sizeof x) == 0 && std::memcmp(&a[i].image, &b[i].image, sizeof a[i].image) == 0;
    }
    return same;
}

}  // namespace

TEST_CASE("foot_sums are those of a K made pixel by pixel, and wider searches find nearer points") {
    Subject<std::uint8_t, 1> gray(hmesh_test::scene<std::uint8_t, 1>(21, 17, 1), hmesh_test::jittered_grid(21, 17, 4, 3, 1));
    check_sums(gray.mesh, 0.2);
    Subject<std::uint8_t, 3> rgb(hmesh_test::noise<std::uint8_t, 3>(15, 18, 2), hmesh_test::jittered_grid(15, 18, 3, 4, 2));
    hmesh_test::wear(rgb.mesh, 40, 255, 2);
    REQUIRE(rgb.mesh.topology().vertex_slots() > rgb.mesh.vertex_count());
    check_sums(rgb.mesh, 0.05);
    check_sums(rgb.mesh, 1);
    Subject<float, 4> floats(hmesh_test::scene<float, 4>(18, 15, 3), hmesh_test::jittered_grid(18, 15, 4, 4, 3));
    check_sums(floats.mesh, 30);
}

TEST_CASE("foot_sums over a weighted table count each pixel as often as its weight says") {
    Weighted<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(19, 16, 4), hmesh_test::random_weights(19, 16, 4),
                                      hmesh_test::jittered_grid(19, 16, 4, 3, 4));
    check_sums(subject.mesh, 0.2);
}

TEST_CASE("foot_sums count each sample that is a point once, on the far sides of the mesh too") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(12, 9, 3);
    const auto source = kit::ImageSource<1>(image.view()).with_samples(hmesh::Samples::points);
    const kit::MomentTable<1> table = source.table({0, 0, 12, 9});
    kit::Delaunay delaunay(12, 9, hmesh::Samples::points);
    for (const auto& [x, y] : {std::pair(3.5, 2.25), std::pair(11.5, 4.0), std::pair(7.0, 8.5), std::pair(6.5, 4.5)})
        delaunay.insert({x, y});
    ImageMesh<1> mesh(table, 0, 255);
    REQUIRE(mesh.assign(delaunay.positions(), delaunay.topology().triangles()));
    for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring})
        CHECK(Sums<1>(mesh, kit::foot_sums(mesh, search, 0.2)).gram.sum() == doctest::Approx(12 * 9).epsilon(1e-9));
}

TEST_CASE("foot_sums without a search are corner_sums") {
    Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(40, 30, 5), hmesh_test::jittered_grid(40, 30, 5, 4, 5));
    CHECK(same_bytes(kit::foot_sums(subject.mesh, FootSearch::plane, 1), kit::corner_sums(subject.mesh)));
}

TEST_CASE("where the mesh shows the image exactly, pixels are their own foot points") {
    Subject<float, 3> subject(hmesh_test::affine_image<float, 3>(30, 24), hmesh_test::jittered_grid(30, 24, 4, 4, 6));
    std::vector<kit::Color<3>> colors(subject.mesh.topology().vertex_slots(), kit::Color<3>::zero());
    for (const Vertex v : subject.mesh.topology().vertices())
        for (int c = 0; c < 3; ++c) {  // as affine_image has it
            const kit::Point p = subject.mesh.position(v);
            const double weight = (c + 1) / 4.0, level = weight * p.x / 30 + (1 - weight) * (1 - p.y / 24);
            colors[v.index()].set(c, c % 2 == 0 ? level : 1 - level);
        }
    subject.mesh.set_colors(colors);
    const Sums<3> plane(subject.mesh, kit::corner_sums(subject.mesh));
    for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring}) {
        const Sums<3> sums(subject.mesh, kit::foot_sums(subject.mesh, search, 255));
        CHECK(largest(sums.gram - plane.gram) <= 1e-4 * largest(plane.gram));  // samples are floats: 1e-7 of 255 px
        CHECK(largest(sums.positions - plane.positions) <= 1e-4 * largest(plane.positions));
        CHECK(largest(sums.image - plane.image) <= 1e-4 * largest(plane.image));
    }
}

TEST_CASE("foot_sums of samples as large as floats go are finite") {
    Subject<float, 3> subject(hmesh_test::scaled(hmesh_test::noise<float, 3>(30, 24, 7), 3.4e38),
                              hmesh_test::jittered_grid(30, 24, 4, 4, 7));
    for (const FootSearch search : {FootSearch::own_face, FootSearch::one_ring}) {
        const Sums<3> sums(subject.mesh, kit::foot_sums(subject.mesh, search, 255e3));
        CHECK((sums.gram.allFinite() && sums.positions.allFinite() && sums.image.allFinite()));
        CHECK(sums.gram.sum() == doctest::Approx(30 * 24).epsilon(1e-9));  // weights sum to 1 at each pixel
    }
}

TEST_CASE("foot_sums have the same bytes with any executor") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(90, 70, 8), hmesh_test::jittered_grid(90, 70, 20, 18, 8));
    REQUIRE(subject.mesh.topology().face_slots() > 512);
    for (const FootSearch search : {FootSearch::plane, FootSearch::own_face, FootSearch::one_ring}) {
        const auto serial = kit::foot_sums(subject.mesh, search, 0.5);
        CHECK(same_bytes(serial, kit::foot_sums(subject.mesh, search, 0.5, hmesh_test::ThreadFor{3})));
        CHECK(same_bytes(serial, kit::foot_sums(subject.mesh, search, 0.5, hmesh_test::ReverseFor())));
    }
}
