#include "hmesh/solve/tied_colors.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/random.hpp"

using hmesh::kit::Color;
using hmesh::kit::ColorTie;
using hmesh::kit::CornerSums;
using hmesh::kit::SymmetricMatrix;

namespace {

double entry(const SymmetricMatrix& matrix, std::size_t row, int column) {
    double sum = 0;
    int count = 0;
    for (int k = matrix.starts[row]; k < matrix.starts[row + 1]; ++k)
        if (matrix.columns[static_cast<std::size_t>(k)] == column) sum += matrix.values[static_cast<std::size_t>(k)], ++count;
    CHECK(count <= 1);
    return sum;
}

}  // namespace

TEST_CASE("entries of one place add up, and columns of a row rise") {
    hmesh::kit::TiedMatrix sums(4, 2);
    sums.add_corner(2, 1, 3, 1);
    sums.add_corner(1, 2, 0.25, 0.5);
    sums.add_to_diagonal(0, 7);
    const SymmetricMatrix matrix = sums.sum();
    CHECK((matrix.starts == std::vector<int>{0, 1, 3, 5, 6}));
    CHECK((matrix.columns == std::vector<int>{0, 1, 2, 1, 2, 3}));
    CHECK((matrix.values == std::vector<double>{7, 0.25, 1.5, 1.5, 3, 0}));
}

TEST_CASE("a matrix of many corners has at each place the sum in their order, to the bit, on any executor") {
    constexpr std::uint32_t size = 30;
    hmesh::kit::Random random(7);
    hmesh::kit::TiedMatrix sums(size, 100);
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> expected;
    for (int corner = 0; corner < 2000; ++corner) {
        // Of very different sizes: any other order of addition would give another sum.
        const auto a = static_cast<std::uint32_t>(random.uniform() * size),
                   b = static_cast<std::uint32_t>(random.uniform() * size);
        const double square = random.uniform() * std::ldexp(1.0, corner % 60), coupling = square * random.uniform();
        sums.add_corner(a, b, square, coupling);
        expected[{a, a}] += square;
        if (a != b) expected[{std::min(a, b), std::max(a, b)}] += coupling;
        else expected[{a, a}] += coupling, expected[{a, a}] += coupling;
    }
    int calls = 0;
    const SymmetricMatrix matrix = sums.sum([&](std::size_t n, hmesh::Piece piece) {
        ++calls;
        for (std::size_t i = n; i-- > 0;) piece(i);
    });
    CHECK(calls > 1);
    std::size_t found = 0;
    for (std::uint32_t row = 0; row < size; ++row)
        for (std::uint32_t column = 0; column < size; ++column) {
            const auto at = expected.find({std::min(row, column), std::max(row, column)});
            CHECK(entry(matrix, row, static_cast<int>(column)) == (at == expected.end() ? 0 : at->second));
            found += at == expected.end() ? 0 : 1;
        }
    CHECK(matrix.values.size() == found);
}

TEST_CASE("vertices that are their own root have an unknown each, and copies that of their root, wherever it stands") {
    const hmesh::kit::TiedRows tied = hmesh::kit::tied_rows({4, 1, 1, 3, 4});
    CHECK((tied.vertices == std::vector<std::uint32_t>{1, 3, 4}));
    CHECK((tied.rows == std::vector<std::uint32_t>{2, 0, 0, 1, 2}));
}

TEST_CASE("the system of tied colours is the sum over faces of what their corners are, copies being one unknown") {
    // A torus of three unknowns and faces that name some of them twice, with random sums.
    hmesh::kit::Random random(3);
    const std::vector<std::uint32_t> rows{0, 1, 2, 1, 0, 0, 2, 2, 2};
    hmesh::kit::Array<CornerSums<2>> corners(rows.size());
    for (CornerSums<2>& corner : corners) {
        corner.square = random.uniform();
        corner.coupling = random.uniform();
        corner.image.set(0, random.uniform());
        corner.image.set(1, random.uniform());
        corner.image.set(2, 99);  // lane of the constant 1
    }
    Color<2> sample = Color<2>::zero();
    sample.set(0, 10);
    const hmesh::kit::Array<ColorTie<2>> ties{{1, 0.25, sample}};
    const hmesh::kit::Array<Color<2>> colors(3, Color<2>::zero());
    const auto system = hmesh::kit::tied_color_system(rows, corners, ties, colors, 0.5);
    // As the quadratic form c' M c - 2 c' r with c of random numbers: face by face, and from the system.
    for (int round = 0; round < 10; ++round) {
        const double c[3] = {random.uniform(), random.uniform(), random.uniform()};
        double expected = 0.25 * (c[1] - 10) * (c[1] - 10) - 0.25 * 100, found = 0;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double a = c[rows[k]], b = c[rows[k % 3 == 2 ? k - 2 : k + 1]];
            expected += corners[k].square * a * a + 2 * corners[k].coupling * a * b - 2 * corners[k].image[0] * a;
        }
        for (std::size_t row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) found += entry(system.gram, row, column) * c[row] * c[column];
            found -= 2 * system.rhs[row][0] * c[row];
            CHECK(system.rhs[row][2] == 0);
            CHECK(system.inverse[row] == doctest::Approx(1 / (system.gram.diagonal(row) + 0.5)));
        }
        CHECK(found == doctest::Approx(expected));
    }
}

TEST_CASE("tied colours are held to what they are, and one that has neither pixels nor ridge is left out of all steps") {
    hmesh::kit::Array<CornerSums<1>> corners(6);
    for (std::size_t k = 0; k < 3; ++k) corners[k].square = 2;
    hmesh::kit::Array<Color<1>> colors(5, Color<1>::zero());
    for (std::size_t row = 0; row < colors.size(); ++row) colors[row].set(0, 3.0 + static_cast<double>(row));
    for (const double ridge : {0.0, 0.5}) {
        // Unknown 0 is of no face, and those of the second face have no pixels.
        const auto system = hmesh::kit::tied_color_system<1>({1, 2, 1, 3, 4, 3}, corners, {}, colors, ridge);
        CHECK(system.ridge == ridge);
        REQUIRE(system.anchor.size() == colors.size());
        for (std::size_t row = 0; row < colors.size(); ++row) {
            CAPTURE(row);
            const double square = row == 1 ? 4 : row == 2 ? 2 : 0;
            CHECK(system.anchor[row][0] == colors[row][0]);
            CHECK(system.gram.starts[row] < system.gram.starts[row + 1]);  // a diagonal is stored, if it is 0, too
            CHECK(system.gram.diagonal(row) == square);
            CHECK(system.inverse[row] == (square + ridge > 0 ? 1 / (square + ridge) : 0));
        }
    }
}
