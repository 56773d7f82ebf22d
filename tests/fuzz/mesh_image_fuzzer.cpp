// Fuzzes mesh_image(): images of any size, sample type, stride and content; any options and recipes, absurd ones among them;
// weights; cancellation; then fit_linear_light(). Whatever comes back has to be what its docstring promises, and the same when
// asked again.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fuzz_images.hpp"
#include "fuzz_input.hpp"
#include "fuzz_meshing.hpp"
#include "fuzz_options.hpp"
#include "fuzz_results.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"
#include "hmesh/solve/linear_light.hpp"
#include "mesh_flaws.hpp"
#include "same_bytes.hpp"
#include "test_executors.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::demand_same;
using hmesh_test::draw_size;
using hmesh_test::FuzzInput;
using hmesh_test::FuzzSamples;
using hmesh_test::Height;
using hmesh_test::same_bytes;
using hmesh_test::Size;

// --- images ---

// Pixels in memory that ends with the last of them, so that the address sanitizer sees what lies outside; what lies between
// the rows is filled twice over, see fill_gaps().
template <class T, int C>
class FuzzImage {
  public:
    FuzzImage(Size size, int padding, bool bottom_up)
        : size_(size), row_bytes_(static_cast<std::size_t>(size.width) * C * sizeof(T)),
          stride_(row_bytes_ + static_cast<std::size_t>(padding) * sizeof(T)), bottom_up_(bottom_up),
          bytes_(stride_ * static_cast<std::size_t>(size.height - 1) + row_bytes_), memory_(new unsigned char[bytes_]) {}

    [[nodiscard]] hmesh::ImageView<T, C> view() const {
        const std::size_t first = bottom_up_ ? stride_ * static_cast<std::size_t>(size_.height - 1) : 0;
        const auto step = static_cast<std::ptrdiff_t>(stride_);
        return {reinterpret_cast<const T*>(memory_.get() + first), size_.width, size_.height, bottom_up_ ? -step : step};
    }
    // `sample(k)` is the k-th in memory.
    template <class Sample>
    void fill(const Sample& sample) {
        std::size_t k = 0;
        for (int y = 0; y < size_.height; ++y)
            for (int i = 0; i < size_.width * C; ++i) {
                const T value = sample(k++);
                std::memcpy(row(y) + static_cast<std::size_t>(i) * sizeof(T), &value, sizeof(T));
            }
    }
    void fill_gaps(int with) {
        for (int y = 0; y + 1 < size_.height; ++y) std::memset(row(y) + row_bytes_, with, stride_ - row_bytes_);
    }
    [[nodiscard]] std::vector<unsigned char> bytes() const { return {memory_.get(), memory_.get() + bytes_}; }

  private:
    [[nodiscard]] unsigned char* row(int y) { return memory_.get() + static_cast<std::size_t>(y) * stride_; }

    Size size_;
    std::size_t row_bytes_, stride_;
    bool bottom_up_;
    std::size_t bytes_;
    std::unique_ptr<unsigned char[]> memory_;
};

template <class T, int C>
FuzzImage<T, C> draw_image(FuzzInput& input, Size size) {
    const int padding = input.one_in(4) ? input.within(1, 40) : 0;
    return FuzzImage<T, C>(size, padding, input.one_in(4));
}

// One that makes no sense, of an image that does: to be refused before a pixel is read.
template <class T, int C>
hmesh::ImageView<T, C> spoil(FuzzInput& input, hmesh::ImageView<T, C> view) {
    const auto packed = static_cast<int>(sizeof(T)) * C * view.width;
    const auto bad_size = [&] {
        return input.one_of<int>({0, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), 65537});
    };
    switch (input.byte() % 5) {
        case 0: view.width = bad_size(); break;
        case 1: view.height = bad_size(); break;
        case 2: view.data = nullptr; break;
        case 3:
            view.row_stride = sizeof(T) > 1 && input.flag() ? packed + 1 : input.within(1, packed - 1);
            if (input.flag()) view.row_stride = -view.row_stride;
            break;
        default:
            view.row_stride = input.one_of<std::ptrdiff_t>({std::numeric_limits<std::ptrdiff_t>::min(),
                                                            std::numeric_limits<std::ptrdiff_t>::max(), std::ptrdiff_t{1} << 60,
                                                            -(std::ptrdiff_t{1} << 60)});
    }
    return view;
}

// --- how it is run ---

// Cancels after so many calls; looks at the meshes that are offered until then.
struct Patience {
    int calls = 0;
    bool is_over = false;
    bool looks = false;

    bool operator()(const hmesh::ProgressInfo& info) {
        demand(info.stage != nullptr && *info.stage != 0, "a stage has a name");
        demand(!std::isnan(info.energy), "an energy is a number");
        if (looks && info.mesh_so_far) {
            const hmesh::Mesh mesh = info.mesh_so_far();
            const std::string flaw = hmesh_test::flaw_of(mesh.view(), mesh.width, mesh.height);
            demand(flaw.empty(), flaw.c_str());
            demand(mesh.vertex_count() == info.vertices, "the mesh so far has as many vertices as is said");
            for (const float color : mesh.colors) demand(!std::isnan(color), "the colours so far are numbers");
        }
        return operator()(info.fraction);
    }
    bool operator()(double fraction) {
        demand(!is_over, "a callback that cancelled is called no more");
        demand(fraction >= 0 && fraction <= 1, "a fraction is in [0, 1]");
        is_over = calls-- <= 0;
        return !is_over;
    }
};

// --- what has to come back ---

// The report is true: of stored values of integer types, which all count the same.
template <class T, int C>
void demand_true_energy(const hmesh::ImageView<T, C>& view, const hmesh::Result& result) {
    const auto [drawn, status] = hmesh::render<C>(result.mesh.view());
    demand(static_cast<bool>(status), "a mesh can be drawn");
    double energy = 0;
    for (int y = 0; y < view.height; ++y)
        for (int i = 0; i < view.width * C; ++i) {
            const double difference = static_cast<double>(drawn.pixel(0, y)[i]) - hmesh::PixelTraits<T>::to_real(view.row(y)[i]);
            energy += difference * difference;
        }
    // 1e-3 dB, and what floats lose of drawn samples.
    const double sample = 1e-6 * hmesh::PixelTraits<T>::highest;
    const double rounding = static_cast<double>(C) * view.width * view.height * sample * sample;
    demand(std::abs(result.report.energy - energy) <= 2.3e-4 * energy + rounding, "the energy reported is that of the mesh");
}

void demand_good_colors(const hmesh::Mesh& mesh, double lowest, double highest, bool whole) {
    for (const float color : mesh.colors) {
        demand(static_cast<double>(color) >= lowest && static_cast<double>(color) <= highest, "a colour is in range");
        if (whole) demand(std::floor(color) == color, "a colour is a stored value");
    }
}

template <class T, int C>
void demand_good_mesh(const hmesh::ImageView<T, C>& view, const hmesh::Options& options, const hmesh::Result& result) {
    using Traits = hmesh::PixelTraits<T>;
    const hmesh::Mesh& mesh = result.mesh;
    const std::string flaw = hmesh_test::flaw_of(mesh.view(), view.width, view.height);
    demand(flaw.empty(), flaw.c_str());
    demand(mesh.channels == C && mesh.colors.size() == C * mesh.vertex_count(), "a vertex has a colour");
    demand(mesh.peak == Traits::peak && mesh.premultiplied == options.premultiplied, "the mesh says what its colours mean");
    demand(result.report.vertices == mesh.vertex_count() && result.report.faces == mesh.face_count(),
           "the report counts what there is");
    demand(result.report.energy >= 0 && !std::isnan(result.report.psnr), "the report holds numbers");
    demand(!result.report.stages.empty(), "the report names stages");
    for (const hmesh::StageReport& stage : result.report.stages)
        demand(stage.energy >= 0 && !std::isnan(stage.psnr) && !std::isnan(stage.residual), "stages report numbers");

    demand_good_colors(mesh, Traits::lowest, Traits::highest, Traits::is_integer && options.round_colors);
    if constexpr (Traits::is_integer)
        if (!options.premultiplied && options.weights.data == nullptr) demand_true_energy(view, result);
}

// What a status says is so. `patience`: as it was left.
template <class T, int C>
void demand_true_status(const hmesh::ImageView<T, C>& view, const hmesh_test::Request& request, const hmesh::Result& result,
                        const Patience& patience) {
    using hmesh::Errc;
    const hmesh::Options& options = request.options;
    const Errc code = result.status.code;
    const bool has_mesh = result.has_mesh();
    demand(has_mesh == (result.mesh.vertex_count() > 0), "a mesh has vertices and faces, or neither");
    demand(code != Errc::write_failed, "nothing is written");
    demand((code == Errc::ok) == (*result.status.what == 0), "a status has a sentence if and only if it is bad");
    demand((code == Errc::cancelled) == patience.is_over, "cancelled is who was");
    demand(!has_mesh || code == Errc::ok || code == Errc::cancelled || options.target.kind == hmesh::Target::Kind::psnr,
           "what is refused gives no mesh");
    demand(has_mesh || (code != Errc::ok && code != Errc::cancelled), "what is not refused gives a mesh");
    demand(!has_mesh || !hmesh_test::names_nothing_known(request), "an enumerator that means nothing is refused");
    if (code != Errc::ok) return;
    const double pixels = static_cast<double>(view.width) * view.height, most = std::max(4.0, pixels),
                 value = options.target.value, n = static_cast<double>(result.report.vertices);
    switch (options.target.kind) {
        case hmesh::Target::Kind::vertices: demand(n == std::floor(value), "the number of vertices is met"); break;
        case hmesh::Target::Kind::percent:
            demand(n == std::min(most, std::max(4.0, std::round(pixels * value / 100))), "the percentage is met");
            break;
        case hmesh::Target::Kind::psnr: demand(result.report.psnr >= value && n <= most, "the PSNR is met"); break;
    }
}

// Colors for linear light, for a mesh of this image.
template <class T, int C>
void fuzz_linear_light(const hmesh::ImageView<T, C>& view, const hmesh::Options& options, const hmesh::Mesh& mesh, int calls) {
    using Traits = hmesh::PixelTraits<T>;
    hmesh::LinearLightOptions light;
    light.weights = options.weights;
    light.ridge = options.limits.ridge;
    light.grid = Traits::is_integer && options.round_colors ? 1 : 0;
    Patience patience{calls, false};
    hmesh::Mesh fitted = mesh;
    const auto go_on = [&](double share) { return patience(share); };
    const hmesh::LinearLightReport report = hmesh::fit_linear_light(fitted, view, light, {}, go_on);
    demand(static_cast<bool>(report.status) == !mesh.premultiplied, "what is fitted for linear light are straight colours");
    demand(fitted.faces == mesh.faces && same_bytes(fitted.positions, mesh.positions), "the geometry stays");
    if (!report.status) {
        demand(same_bytes(fitted.colors, mesh.colors), "what is refused stays as it was");
        return;
    }
    demand_good_colors(fitted, 0, Traits::peak, light.grid > 0);
    demand(report.energy >= 0 && report.energy <= report.converted, "a fit never raises the error");
    demand(!std::isnan(report.psnr) && !std::isnan(report.residual), "the report of a fit holds numbers");
}

template <class T, int C>
void fuzz(FuzzInput& input) {
    const Size size = draw_size(input);
    hmesh_test::RequestDraw draw(input);
    hmesh_test::Request request = draw.request(size.width, size.height);
    hmesh::Options& options = request.options;
    FuzzImage<T, C> image = draw_image<T, C>(input, size);
    std::optional<FuzzImage<float, 1>> weights;
    if (input.one_in(4)) {
        weights.emplace(draw_image<float, 1>(input, size));
        const double gain = input.flag() ? input.wild_real() : 1, least = std::numeric_limits<float>::max() / 256.0;
        const auto unit = static_cast<float>(std::abs(gain) <= least ? gain : 1);
        const int mask = input.byte();  // 0: none of them counts
        weights->fill(
            [&](std::size_t k) { return static_cast<float>((k * k * 7 + 13 * k) & static_cast<unsigned>(mask)) * unit; });
        options.weights = weights->view();
        if (input.one_in(16)) options.weights = spoil(input, options.weights);
    }
    const bool is_spoilt = input.one_in(32);
    const hmesh::ImageView<T, C> view = is_spoilt ? spoil(input, image.view()) : image.view();
    const int calls = input.one_in(3) ? input.within(0, 60) : 100;
    const bool is_repeated = input.one_in(4);
    image.fill(FuzzSamples<T>(input));
    image.fill_gaps(0);
    const std::vector<unsigned char> before = image.bytes();

    Patience patience{calls, false, true};
    options.progress = patience;
    const auto mesh_image = [&](const hmesh::ParallelFor& parallel_for) {
        return std::visit([&](const auto& recipe) { return hmesh::mesh_image(view, options, recipe, parallel_for); },
                          request.recipe);
    };
    const hmesh::Result result = mesh_image({});
    demand(!is_spoilt || !result.status, "a view that makes no sense is refused");
    demand_true_status(view, request, result, patience);
    if (result.has_mesh()) demand_good_mesh(view, options, result);
    if (result.has_mesh() && request.linear_light) fuzz_linear_light(view, options, result.mesh, calls);
    demand(image.bytes() == before, "nothing is written into the image");

    if (!is_repeated) return;
    image.fill_gaps(255);
    if (weights) weights->fill_gaps(255);
    // Where the callback falls among the pieces of a stage depends on their order.
    const bool was_cancelled = patience.is_over;
    patience = {calls, false};  // who looks gets the same mesh as who does not
    const hmesh_test::ReverseFor backwards;
    demand_same(result, mesh_image(was_cancelled ? hmesh::ParallelFor() : hmesh::ParallelFor(backwards)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    FuzzInput input(bytes, size);
    switch (input.byte() % 5) {
        case 0: fuzz<std::uint8_t, 3>(input); break;
        case 1: fuzz<std::uint16_t, 4>(input); break;
        case 2: fuzz<float, 1>(input); break;
        case 3: fuzz<float, 2>(input); break;
        default: fuzz<Height, 1>(input);
    }
    return 0;
}
