// Fuzzes mesh_image() of images that are not in memory, of which some cannot be read from some call on, and some change while
// they are read. A sound reader comes to the mesh of its view, whatever the options; of the others comes what the docstring
// promises.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "fuzz_images.hpp"
#include "fuzz_input.hpp"
#include "fuzz_meshing.hpp"
#include "fuzz_options.hpp"
#include "fuzz_results.hpp"
#include "hmesh/large/mesh_reader.hpp"
#include "hmesh/mesh_image.hpp"
#include "mesh_flaws.hpp"
#include "test_executors.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzInput;

enum class Fault : unsigned { none, refuses, changes };

// Reads an image. From its call of this number on it says that it cannot, or gives the pixels of another one at every other call.
template <class T, int C>
struct FaultyReader {
    hmesh::ViewReader<T, C> image, other;
    Fault fault = Fault::none;
    int from = 0;
    int calls = 0;
    hmesh::kit::Rect last{};  // of the last call

    bool operator()(const hmesh::kit::Rect& rect, T* to, std::ptrdiff_t stride) {
        last = rect;
        const int late = calls++ - from;
        if (fault == Fault::refuses && late >= 0) return false;
        return fault == Fault::changes && late >= 0 && late % 2 == 0 ? other(rect, to, stride) : image(rect, to, stride);
    }
    [[nodiscard]] bool has_failed() const { return fault == Fault::refuses && calls > from; }
};

template <class T, int C>
hmesh::Image<T, C> draw_image(hmesh_test::Size size, const hmesh_test::FuzzSamples<T>& sample, std::size_t first) {
    hmesh::Image<T, C> image(size.width, size.height);
    for (std::size_t k = 0; k < image.size(); ++k) image.data()[k] = sample(first + k);
    return image;
}

// What RequestDraw leaves as it is.
void draw_options(FuzzInput& input, hmesh::Options& options, hmesh::Annealed& recipe, int channels) {
    if (input.one_in(4)) options.samples = hmesh::Samples::points;
    if (input.one_in(4)) options.periodic = input.one_of({hmesh::Periodic::x, hmesh::Periodic::y, hmesh::Periodic::xy});
    options.straight_border = input.one_in(8);
    if (input.one_in(4))
        for (int c = 0; c < channels; ++c) options.channel_weights.push_back(input.share());
    if (input.one_in(4)) recipe.border_tolerance = 100 * input.share();
    if (input.one_in(4)) recipe.effort = hmesh::Effort::draft;
}

template <class T, int C>
void fuzz(FuzzInput& input) {
    const hmesh_test::Size size = hmesh_test::draw_size(input);
    hmesh_test::RequestDraw draw(input);
    hmesh_test::Request request = draw.request(size.width, size.height);
    hmesh::Annealed recipe;
    if (const auto* const annealed = std::get_if<hmesh::Annealed>(&request.recipe)) recipe = *annealed;
    hmesh::Options& options = request.options;
    draw_options(input, options, recipe, C);
    const auto fault = input.one_of({Fault::none, Fault::refuses, Fault::changes});
    const int from = input.within(0, input.flag() ? 300 : 15), patience = input.one_in(4) ? input.within(0, 60) : 300;
    std::optional<hmesh::Image<float, 1>> weights;
    if (input.one_in(4)) {
        const unsigned mask = input.byte();
        weights.emplace(size.width, size.height);
        for (std::size_t k = 0; k < weights->size(); ++k) weights->data()[k] = static_cast<float>((k * k * 7 + 13 * k) & mask);
        options.weights = weights->view();
    }
    const bool is_backwards = input.flag(), is_concurrent = input.flag();
    const hmesh_test::FuzzSamples<T> samples(input);
    const auto image = draw_image<T, C>(size, samples, 0), other = draw_image<T, C>(size, samples, 1);

    FaultyReader<T, C> read{hmesh::ViewReader<T, C>(image.view()), hmesh::ViewReader<T, C>(other.view()), fault, from};
    int calls = 0;
    const auto progress = [&](const hmesh::ProgressInfo&) {
        demand(!read.has_failed(), "who could not read is told no more");
        return calls++ < patience;
    };
    options.progress = progress;
    const hmesh_test::ReverseFor backwards;
    const auto executor = is_backwards ? hmesh::ParallelFor(backwards) : hmesh::ParallelFor();
    const hmesh::Result result =
        hmesh::mesh_image(hmesh::ImageReader<T, C>{size.width, size.height, read, is_concurrent}, options, recipe, executor);

    const hmesh::Errc code = result.status.code;
    demand(result.has_mesh() || (code != hmesh::Errc::ok && code != hmesh::Errc::cancelled), "what is not refused gives a mesh");
    demand((code == hmesh::Errc::read_failed) == read.has_failed(), "read_failed is what could not be read");
    if (read.has_failed()) {
        demand(read.calls == from + 1, "once it could not be read it is read no more");
        demand(!result.has_mesh(), "there is no mesh of what could not be read");
        demand(std::string(message(result.status).c_str()) == message(hmesh::kit::unread(read.last)).c_str(),
               "the status names what could not be read");
    }
    if (result.has_mesh() && options.periodic == hmesh::Periodic::none) {
        const std::string flaw = hmesh_test::flaw_of(result.mesh.view(), size.width, size.height);
        demand(flaw.empty(), flaw.c_str());
    }
    if (read.calls > from && fault != Fault::none) return;
    // Who is asked how often to go on depends on what is read, and on the order of the pieces.
    if (calls > patience) return;
    options.progress = {};
    const hmesh::Result expected = hmesh::mesh_image(image.view(), options, recipe);
    if (!result.has_mesh() && !expected.has_mesh() && !expected.status) return;  // of several reasons either names one
    hmesh_test::demand_same(result, expected);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    FuzzInput input(bytes, size);
    switch (input.byte() % 3) {
        case 0: fuzz<std::uint8_t, 3>(input); break;
        case 1: fuzz<float, 1>(input); break;
        default: fuzz<float, 2>(input);
    }
    return 0;
}
