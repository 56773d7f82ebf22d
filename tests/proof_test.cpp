// hmesh tests - what the proof says of a mesh, by holding each sample against each face.
#include "hmesh/methods/bounded/proof.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"
#include "test_executors.hpp"

namespace {

using hmesh::Samples;
using hmesh::kit::HeightField;
using hmesh::kit::Proof;
using hmesh::kit::Random;

constexpr int channels = 2;

struct Terrain {
    int width = 37, height = 150;  // more rows than one piece of work has
    std::vector<float> samples;
    HeightField field;

    Terrain(Samples where, bool has_holes, Random& random) {
        for (int k = 0; k < width * height * channels; ++k) samples.push_back(static_cast<float>(random.below(1000)));
        std::vector<std::uint8_t> mask(static_cast<std::size_t>(width * height), 1);
        for (int j = 60; has_holes && j < 70; ++j)
            for (int i = 10; i < 20; ++i) mask[static_cast<std::size_t>(j * width + i)] = 0;
        field = hmesh::kit::height_field(view(), where, {mask.data(), width, height, 0}, false, {});
    }
    [[nodiscard]] hmesh::ImageView<float, channels> view() const { return {samples.data(), width, height, 0}; }
    [[nodiscard]] double at(int i, int j, int c) const {
        return static_cast<double>(samples[static_cast<std::size_t>((j * width + i) * channels + c)]);
    }
};

// Squares of 1 to 8 px, cut in two, but those on cells without data.
hmesh::Mesh mesh_of(const Terrain& terrain, Random& random) {
    hmesh::Mesh mesh;
    mesh.channels = channels;
    mesh.width = terrain.width, mesh.height = terrain.height;
    mesh.samples = terrain.field.samples;
    mesh.peak = 1;
    const auto cut = [&](int length) {
        std::vector<int> places{0};
        while (places.back() < length) places.push_back(std::min(length, places.back() + 1 + static_cast<int>(random.below(8))));
        return places;
    };
    std::vector<int> columns = cut(terrain.field.right()), rows = cut(terrain.field.bottom());
    if (!terrain.field.data.empty()) {  // along the hole of rows 60 to 69 and columns 10 to 19
        const int wider = terrain.field.samples == Samples::points ? 1 : 0;
        for (const int x : {10 - wider, 20}) columns.push_back(x);
        for (const int y : {60 - wider, 70}) rows.push_back(y);
    }
    for (std::vector<int>* places : {&columns, &rows}) {
        std::sort(places->begin(), places->end());
        places->erase(std::unique(places->begin(), places->end()), places->end());
    }
    for (const int y : rows)
        for (const int x : columns) {
            mesh.positions.push_back(static_cast<float>(x));
            mesh.positions.push_back(static_cast<float>(y));
            for (int c = 0; c < channels; ++c) mesh.colors.push_back(static_cast<float>(random.below(1000)));
        }
    const auto wide = static_cast<std::uint32_t>(columns.size());
    for (std::uint32_t r = 0; r + 1 < rows.size(); ++r)
        for (std::uint32_t k = 0; k + 1 < columns.size(); ++k) {
            if (!terrain.field.is_cell(columns[k], rows[r])) continue;
            const std::uint32_t v = r * wide + k;
            mesh.faces.push_back({v, v + 1, v + wide});
            mesh.faces.push_back({v + 1, v + wide + 1, v + wide});
        }
    return mesh;
}

Proof proof_of(const hmesh::Mesh& mesh, const Terrain& terrain, const hmesh::ParallelFor& parallel_for = {}) {
    const auto read = [&](int channel, int j, int begin, int end, double* to) {
        for (int i = begin; i < end; ++i) *to++ = terrain.at(i, j, channel);
    };
    return prove(mesh.view(), terrain.field, read, parallel_for);
}

// The same by going through all samples for each face.
Proof measured(const hmesh::Mesh& mesh, const Terrain& terrain) {
    Proof proof;
    std::vector<bool> seen(static_cast<std::size_t>(terrain.width * terrain.height));
    const double offset = terrain.field.offset();
    for (const hmesh::Triangle& face : mesh.faces) {
        std::array<double, 3> x{}, y{};
        for (std::size_t k = 0; k < 3; ++k) {
            x[k] = static_cast<double>(mesh.positions[2 * std::size_t{face[k]}]);
            y[k] = static_cast<double>(mesh.positions[2 * std::size_t{face[k]} + 1]);
        }
        const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        const auto least = [](const std::array<double, 3>& v) {
            return std::max(0, static_cast<int>(std::min({v[0], v[1], v[2]})) - 1);
        };
        const auto most = [](const std::array<double, 3>& v) { return static_cast<int>(std::max({v[0], v[1], v[2]})) + 1; };
        for (int j = least(y); j < std::min(terrain.height, most(y)); ++j)
            for (int i = least(x); i < std::min(terrain.width, most(x)); ++i) {
                std::array<double, 3> at{};
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t b = (k + 1) % 3, c = (k + 2) % 3;
                    at[k] = ((x[c] - x[b]) * (j + offset - y[b]) - (i + offset - x[b]) * (y[c] - y[b])) / area;
                }
                if (std::min({at[0], at[1], at[2]}) < 0) continue;
                const auto sample = static_cast<std::size_t>(j * terrain.width + i);
                for (std::size_t channel = 0; channel < channels; ++channel) {
                    double off = -terrain.at(i, j, static_cast<int>(channel));
                    for (std::size_t k = 0; k < 3; ++k)
                        off += at[k] * static_cast<double>(mesh.colors[std::size_t{face[k]} * channels + channel]);
                    proof.max_error = std::max(proof.max_error, std::abs(off));
                    proof.energy += seen[sample] ? 0 : off * off;
                }
                proof.samples += seen[sample] ? 0 : 1;
                seen[sample] = true;
            }
    }
    return proof;
}

}  // namespace

TEST_CASE("the proof measures what each sample is off, with holes and without, on any number of threads") {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Random random(seed);
        const Terrain terrain(seed % 2 == 0 ? Samples::points : Samples::squares, seed % 3 == 0, random);
        const hmesh::Mesh mesh = mesh_of(terrain, random);
        const Proof proof = proof_of(mesh, terrain), wanted = measured(mesh, terrain);
        CHECK(proof.is_cover);
        CHECK(proof.samples == wanted.samples);
        CHECK(proof.max_error == doctest::Approx(wanted.max_error).epsilon(1e-12));
        // A sample on an edge counts once, of the face that comes first in its band of rows.
        CHECK(proof.energy == doctest::Approx(wanted.energy).epsilon(1e-12));
        const Proof again = proof_of(mesh, terrain, hmesh_test::ReverseFor());
        CHECK(again.energy == proof.energy);
        CHECK(again.max_error == proof.max_error);
    }
}

TEST_CASE("a mesh with a gap, a face over another, a face turned over, or one on what has no data is no cover") {
    for (const bool has_holes : {false, true}) {
        Random random(5);
        const Terrain terrain(Samples::points, has_holes, random);
        const hmesh::Mesh whole = mesh_of(terrain, random);
        REQUIRE(proof_of(whole, terrain).is_cover);
        int missed = 0;
        for (std::size_t f = 0; f < whole.faces.size(); f += 11) {
            hmesh::Mesh mesh = whole;
            mesh.faces.erase(mesh.faces.begin() + static_cast<std::ptrdiff_t>(f));
            // With holes what counts is whether a sample is left out, and those on edges are of the faces beside.
            if (has_holes)
                CHECK(proof_of(mesh, terrain).is_cover == (measured(mesh, terrain).samples == measured(whole, terrain).samples));
            else CHECK_FALSE(proof_of(mesh, terrain).is_cover);
            missed += proof_of(mesh, terrain).is_cover ? 0 : 1;

            mesh = whole;
            std::swap(mesh.faces[f][0], mesh.faces[f][1]);
            CHECK_FALSE(proof_of(mesh, terrain).is_cover);

            mesh = whole;
            mesh.faces.push_back(mesh.faces[f]);
            if (!has_holes) CHECK_FALSE(proof_of(mesh, terrain).is_cover);
        }
        CHECK(missed > 10);
    }
    Random random(6);
    const Terrain terrain(Samples::squares, true, random);
    hmesh::Mesh mesh = mesh_of(terrain, random);
    REQUIRE(proof_of(mesh, terrain).is_cover);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 2);
    for (const std::pair<float, float>& place : {std::pair{12.0F, 62.0F}, {14.0F, 62.0F}, {12.0F, 64.0F}}) {
        mesh.positions.push_back(place.first);
        mesh.positions.push_back(place.second);
        for (int c = 0; c < channels; ++c) mesh.colors.push_back(0);
    }
    mesh.faces.push_back({first, first + 1, first + 2});
    CHECK_FALSE(proof_of(mesh, terrain).is_cover);
}
