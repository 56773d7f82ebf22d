// Meshes have yesterday's bytes. A change that is meant to alter none is told by this test that it does; one that is meant to
// renews what is held, and its commit shows which meshes it reached:
//
//     HMESH_RENEW_GOLDEN=1 ctest --preset test -R golden_test
//
// tests/golden/ has a file for each platform, of lines `name hash`. What is promised is the same bytes from one program, whatever
// the executor; that programs agree is true where arithmetic is that of plain doubles. So files are compared with where products
// and sums are not contracted into one instruction: not with FMA or -ffast-math.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/outline.hpp"
#include "hmesh/paper.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_outlines.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Target;

#ifndef HMESH_TEST_SOURCE
#define HMESH_TEST_SOURCE "tests"  // seen from the repository's root
#endif

namespace {

// The file that this build is compared with; empty: none.
std::string golden_file() {
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__FMA__) && \
    !defined(__FAST_MATH__)
    return HMESH_TEST_SOURCE "/golden/x86_64-linux-gnu.txt";
#else
    return {};
#endif
}

// FNV-1a, 64 bits: http://www.isthe.com/chongo/tech/comp/fnv/
class Hash {
  public:
    template <class Value>
    Hash& operator<<(const std::vector<Value>& values) {
        for (const Value& value : values) {
            unsigned char bytes[sizeof value];
            std::memcpy(bytes, &value, sizeof value);
            for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001b3U;
        }
        return *this;
    }
    Hash& operator<<(const hmesh::Mesh& mesh) { return *this << mesh.positions << mesh.colors << mesh.faces; }
    [[nodiscard]] std::string text() const {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash_));
        return digits;
    }

  private:
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

// What was made, in this order: names without spaces, hashes, and PSNR where there is one.
struct Entry {
    std::string name, hash;
    double psnr = 0;
};

class Album {
  public:
    template <class T, int C>
    void add_image(const std::string& name, const Image<T, C>& image) {
        entries_.push_back({name, (Hash() << hmesh_test::samples_of(image)).text()});
    }
    template <class T, int C, class Recipe>
    void add(const std::string& name, const Image<T, C>& image, const Options& options, const Recipe& recipe) {
        CAPTURE(name);
        const Result result = hmesh::mesh_image(image.view(), options, recipe);
        CHECK(result.status);
        entries_.push_back({name, (Hash() << result.mesh).text(), result.report.psnr});
    }
    template <class T, int C>
    void add_all_recipes(const std::string& name, const Image<T, C>& image, const Options& options) {
        add(name + "/draft", image, options, Annealed{Effort::draft});
        add(name + "/fast", image, options, Annealed{Effort::fast});
        add(name + "/normal", image, options, Annealed{Effort::normal});
        add(name + "/hierarchical", image, options, hmesh::Hierarchical());
        add(name + "/xie", image, options, hmesh::Xie());
        add(name + "/adams", image, options, hmesh::Adams());
        add(name + "/adaptive_thinning", image, options, hmesh::AdaptiveThinning());
    }
    void add_mesh(const std::string& name, const hmesh::Mesh& mesh) { entries_.push_back({name, (Hash() << mesh).text()}); }
    [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  private:
    std::vector<Entry> entries_;
};

// Outlines of silhouettes of all kinds, close and of few vertices. Each change of a polygon that could be another one shows here:
// other tests ask whether outlines are right and good, not whether they are the best that was found.
void add_outlines(Album& album) {
    hmesh::kit::Random random(11);
    for (int kind = 0; kind < 16; ++kind) {
        const hmesh_test::AlphaImage image = hmesh_test::some_silhouette(kind, 70, 60, random);
        for (const double tolerance : {0.5, 3.0}) {
            hmesh::OutlineOptions options;
            options.tolerance = tolerance;
            options.max_vertices = kind < 8 ? 0 : 24;
            const hmesh::Outline outline = hmesh::outline(image.view(), options);
            CHECK(outline.status);
            album.add_mesh("outline/" + std::to_string(kind) + (tolerance < 1 ? "/close" : "/wide"), outline.mesh);
        }
    }
}

// The meshes that are held.
std::vector<Entry> make_entries() {
    Album album;
    const auto scene = hmesh_test::scene<std::uint8_t, 3>(80, 70, 1);
    album.add_image("scene", scene);
    Options options{Target::vertices(420)};
    album.add_all_recipes("scene", scene, options);
    const auto weights = hmesh_test::random_weights(80, 70, 1);
    album.add_image("weights", weights);
    options.weights = weights.view();
    album.add_all_recipes("weighted", scene, options);

    const auto grey = hmesh_test::scene<std::uint8_t, 1>(60, 50, 2);
    album.add_all_recipes("grey", grey, {Target::vertices(90)});
    album.add_all_recipes("sprite16", hmesh_test::scene<std::uint16_t, 4>(50, 60, 3), {Target::vertices(150)});
    album.add_all_recipes("floats", hmesh_test::scene<float, 2>(50, 60, 4), {Target::percent(5)});
    album.add_all_recipes("noise", hmesh_test::noise<std::uint8_t, 1>(40, 40, 5), {Target::vertices(800)});
    album.add_all_recipes("checkers", hmesh_test::checkerboard<std::uint8_t, 3>(40, 40, 5), {Target::vertices(100)});

    const auto wide = hmesh_test::scene<std::uint8_t, 3>(160, 140, 6);
    for (const auto& [name, effort] :
         {std::pair("tiles/draft", Effort::draft), {"tiles/fast", Effort::fast}, {"tiles/normal", Effort::normal}})
        album.add(name, wide, {Target::vertices(1400)}, Annealed{effort, 1, 64});
    const auto wide_weights = hmesh_test::random_weights(160, 140, 1);
    options = {Target::vertices(1400)};
    options.weights = wide_weights.view();
    album.add("tiles/weighted", wide, options, Annealed{Effort::normal, 1, 64});

    Annealed best{Effort::best, 7};
    best.steps = hmesh::kit::annealed_steps(Effort::best);
    best.steps->annealing.sweeps = 50;
    album.add("best", grey, {Target::vertices(90)}, best);
    album.add("psnr", grey, {Target::psnr(31)}, Annealed{Effort::fast});
    options = {Target::vertices(90)};
    options.round_colors = false;
    album.add("unrounded/normal", grey, options, Annealed());
    album.add("unrounded/hierarchical", grey, options, hmesh::Hierarchical());
    options = {Target::vertices(200)};
    options.premultiplied = true;
    album.add("premultiplied", hmesh_test::scene<std::uint8_t, 4>(60, 50, 7), options, Annealed{Effort::fast});

    hmesh::Mesh light = hmesh::mesh_image(scene.view(), {Target::vertices(200)}, Annealed{Effort::draft}).mesh;
    hmesh::LinearLightOptions fit;
    fit.grid = 1;
    CHECK(hmesh::fit_linear_light(light, scene.view(), fit).status);
    album.add_mesh("linear_light", light);
    add_outlines(album);
    return album.entries();
}

}  // namespace

TEST_CASE("meshes have the bytes that they had yesterday") {
    const std::vector<Entry> entries = make_entries();

    // What scripts/matrix.sh compares between compilers.
    std::map<std::string, Entry> made;
    for (const Entry& entry : entries) CHECK(made.emplace(entry.name, entry).second);
    std::printf("mesh bytes: image %.8s", made["scene"].hash.c_str());
    for (const char* name : {"draft", "fast", "normal"}) {
        const Entry& entry = made[std::string("scene/") + name];
        std::printf(", %s %.8s (%.3f dB)", name, entry.hash.c_str(), entry.psnr);
    }
    std::printf("\n");

    const std::string path = golden_file();
    const char* const renew = std::getenv("HMESH_RENEW_GOLDEN");
    if (renew != nullptr && std::string(renew) == "1") {
        REQUIRE_MESSAGE(!path.empty(), "this is a build whose meshes may have other bytes: there is no file for it to renew");
        std::ofstream file(path, std::ios::binary);
        for (const Entry& entry : entries) file << entry.name << ' ' << entry.hash << '\n';
        file.close();
        REQUIRE_MESSAGE(file.good(), path << " was not written");
        std::printf("golden: %s holds %zu hashes now\n", path.c_str(), entries.size());
        return;
    }
    if (path.empty()) {
        std::printf("golden: nothing is compared, as this build is for no platform that a file is held for\n");
        return;
    }
    std::ifstream file(path, std::ios::binary);
    REQUIRE_MESSAGE(file.good(), path << " cannot be read; HMESH_RENEW_GOLDEN=1 writes it");
    std::size_t lines = 0;
    for (std::string name, hash; file >> name >> hash; ++lines) {
        CAPTURE(name);
        REQUIRE_MESSAGE(made.count(name) == 1, "is held and not made");
        CHECK(made[name].hash == hash);
    }
    CHECK(lines == entries.size());
}
