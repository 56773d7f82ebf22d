// Python module - hmesh._core: what hmesh/__init__.py calls. It takes arrays that are checked and laid out already, and gives
// arrays that own what the library made, without a copy. The Python package says what all this is for.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "hmesh/compact.hpp"
#include "hmesh/hmesh.hpp"
#include "hmesh/terrain.hpp"
#include "meshing.hpp"
#include "thread_pool.hpp"

namespace py = pybind11;

namespace python {
namespace {

// A status that is not ok as the exception that a caller expects.
[[noreturn]] void raise(const hmesh::Status& status) { throw py::value_error(hmesh::message(status).c_str()); }

// --- what Python's numbers and words become ---

// What is taken as a Value, for a sentence.
template <class Value>
[[nodiscard]] constexpr const char* kind_of() {
    if (std::is_same_v<Value, bool>) return "True or False";
    if (std::is_same_v<Value, std::string>) return "text";
    if (std::is_floating_point_v<Value>) return "a number";
    return sizeof(Value) == 4 ? "a whole number of 32 bits" : "a whole number of 64 bits";
}
template <class Value>
[[nodiscard]] Value cast(const char* name, const py::handle& from) {
    try {
        if (!from.is_none()) return from.cast<Value>();
    } catch (const py::cast_error&) {  // said below
    }
    std::string words = std::string("of type ") + Py_TYPE(from.ptr())->tp_name;
    try {
        words = py::repr(from).cast<std::string>();
    } catch (const py::error_already_set&) {  // it has no words of its own
    }
    throw py::type_error(std::string(name) + " must be " + kind_of<Value>() + ", and is " + words);
}
// What a dict has by this name; from get_optional() None is no value.
template <class Value>
[[nodiscard]] Value get(const py::dict& from, const char* name) {
    return cast<Value>(name, from[name]);
}
template <class Value>
[[nodiscard]] std::optional<Value> get_optional(const py::dict& from, const char* name) {
    const py::object value = from[name];
    if (value.is_none()) return {};
    return cast<Value>(name, value);
}

// --- arrays ---

// An array over a vector's numbers, which it owns from now on.
template <class Number>
[[nodiscard]] py::array_t<Number> array_of(std::vector<Number>&& numbers, std::vector<py::ssize_t> shape) {
    auto* const owner = new std::vector<Number>(std::move(numbers));
    const py::capsule capsule(owner, [](void* at) { delete static_cast<std::vector<Number>*>(at); });
    return py::array_t<Number>(std::move(shape), owner->data(), capsule);
}
[[nodiscard]] py::array_t<std::uint32_t> array_of(std::vector<hmesh::Triangle>&& faces) {
    auto* const owner = new std::vector<hmesh::Triangle>(std::move(faces));
    const py::capsule capsule(owner, [](void* at) { delete static_cast<std::vector<hmesh::Triangle>*>(at); });
    return py::array_t<std::uint32_t>({static_cast<py::ssize_t>(owner->size()), py::ssize_t{3}},
                                      reinterpret_cast<const std::uint32_t*>(owner->data()), capsule);
}

// The arrays and the numbers that make a mesh, by the names that Python's Mesh has for them.
[[nodiscard]] py::dict dict_of(hmesh::Mesh&& mesh) {
    py::dict out;
    const auto n = static_cast<py::ssize_t>(mesh.vertex_count());
    out["width"] = mesh.width;
    out["height"] = mesh.height;
    out["peak"] = mesh.peak;
    out["premultiplied"] = mesh.premultiplied;
    out["periodic"] = static_cast<int>(mesh.periodic);
    out["samples"] = static_cast<int>(mesh.samples);
    const py::ssize_t channels = mesh.channels;
    out["positions"] = array_of(std::move(mesh.positions), {n, 2});
    out["colors"] = array_of(std::move(mesh.colors), {n, channels});
    out["faces"] = array_of(std::move(mesh.faces));
    return out;
}

using Floats = py::array_t<float, py::array::c_style>;
using Indices = py::array_t<std::uint32_t, py::array::c_style>;

// A mesh of Python's over its own arrays, which stay alive as long as this does.
struct HeldMesh {
    Floats positions, colors;
    Indices faces;
    hmesh::MeshView view;

    explicit HeldMesh(const py::dict& from)
        : positions(from["positions"].cast<Floats>()), colors(from["colors"].cast<Floats>()),
          faces(from["faces"].cast<Indices>()) {
        view.positions = positions.data();
        view.colors = colors.data();
        static_assert(sizeof(hmesh::Triangle) == 3 * sizeof(std::uint32_t));
        view.faces = reinterpret_cast<const hmesh::Triangle*>(faces.data());
        view.vertex_count = static_cast<std::size_t>(positions.shape(0));
        view.face_count = static_cast<std::size_t>(faces.shape(0));
        view.channels = static_cast<int>(colors.shape(1));
        view.width = get<int>(from, "width");
        view.height = get<int>(from, "height");
        view.peak = get<double>(from, "peak");
        view.premultiplied = get<bool>(from, "premultiplied");
        view.periodic = static_cast<hmesh::Periodic>(get<int>(from, "periodic"));
        view.samples = static_cast<hmesh::Samples>(get<int>(from, "samples"));
    }
    // A copy that the library may keep.
    [[nodiscard]] hmesh::Mesh copy() const {
        hmesh::Mesh mesh;
        mesh.positions.assign(view.positions, view.positions + 2 * view.vertex_count);
        mesh.colors.assign(view.colors, view.colors + static_cast<std::size_t>(view.channels) * view.vertex_count);
        mesh.faces.assign(view.faces, view.faces + view.face_count);
        mesh.channels = view.channels;
        mesh.width = view.width;
        mesh.height = view.height;
        mesh.peak = view.peak;
        mesh.premultiplied = view.premultiplied;
        mesh.periodic = view.periodic;
        mesh.samples = view.samples;
        return mesh;
    }
};

// An image array of shape (h, w, c), laid out as Pixels are.
struct HeldImage {
    py::array array;
    Pixels pixels;
    int channels;

    explicit HeldImage(const py::array& from) : array(from), pixels{}, channels(static_cast<int>(from.shape(2))) {
        const auto side = [](py::ssize_t size) { return static_cast<int>(std::min<py::ssize_t>(size, 1 << 30)); };
        const py::ssize_t item = from.itemsize();
        const py::ssize_t row_stride = from.shape(0) > 1 ? from.strides(0) : 0;  // numpy calls any stride of one row contiguous
        pixels = {from.data(), side(from.shape(1)), side(from.shape(0)), row_stride,
                  item == 1   ? Sample::uint8
                  : item == 2 ? Sample::uint16
                              : Sample::float32};
    }
};

// --- a call that takes long ---

// The parts of calls that do without the interpreter's lock. Of an interpreter that ends, Python ends the threads that ask for
// the lock, and C++ frames on their stacks end the process with them. So when it is about to, what other threads are at is
// stopped, and waited for.
class Calls {
  public:
    // A part of a call, without the lock. Ends the thread where the interpreter is about to.
    class Free {
        struct Counted {
            Counted() {
                check();
                add(1);
            }
            ~Counted() { add(-1); }
        } counted_;
        const py::gil_scoped_release free_;
    };
    // Whether a thread's calls are to stop. The one that ends the interpreter may make more, as in functions of atexit.
    [[nodiscard]] static bool are_over(std::thread::id thread) {
        const std::thread::id by = all().ended_by;
        return by != std::thread::id() && by != thread;
    }
    static void check() {
        if (!are_over(std::this_thread::get_id())) return;
        PyErr_SetNone(PyExc_SystemExit);  // of which threads say nothing
        throw py::error_already_set();
    }
    static void end() {
        all().ended_by = std::this_thread::get_id();
        const py::gil_scoped_release free;
        std::unique_lock<std::mutex> lock(all().mutex);
        // A callback may never return, which ends nothing.
        all().has_left.wait_for(lock, std::chrono::seconds(2), [] { return all().count == 0; });
    }

  private:
    struct All {
        std::atomic<std::thread::id> ended_by{std::thread::id()};
        std::mutex mutex;
        std::condition_variable has_left;
        int count = 0;
    };
    // Never destroyed: threads may outlive what main() does.
    [[nodiscard]] static All& all() {
        static All* const one = new All;
        return *one;
    }
    static void add(int count) {
        const std::lock_guard<std::mutex> lock(all().mutex);
        all().count += count;
        all().has_left.notify_all();
    }
};

// Tells Python how far the work is, and the work whether to go on: from whatever thread it comes, with the interpreter's lock for
// just that time. What a callback raises, and Ctrl-C, ends the work and is raised again by finish().
class Listener {
  public:
    explicit Listener(py::object callback) : callback_(std::move(callback)), thread_(std::this_thread::get_id()) {}

    bool operator()(const hmesh::ProgressInfo& info) {
        if (Calls::are_over(thread_)) return false;
        const bool is_caller = std::this_thread::get_id() == thread_;
        const auto now = std::chrono::steady_clock::now();
        const bool looks = is_caller && now - looked_ > std::chrono::milliseconds(20);
        if (callback_.is_none() && !looks) return true;
        const py::gil_scoped_acquire lock;
        try {
            if (looks) {
                looked_ = now;
                if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            }
            return callback_.is_none() || tell(info);
        } catch (...) {
            error_ = std::current_exception();
            return false;
        }
    }
    // With the interpreter's lock: raises what a callback raised.
    void finish() {
        if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    }

  private:
    bool tell(const hmesh::ProgressInfo& info) {
        // The mesh can be asked for during this call alone.
        const auto offered = std::make_shared<const hmesh::ProgressInfo*>(info.mesh_so_far ? &info : nullptr);
        const py::cpp_function mesh([offered] {
            if (*offered == nullptr) throw std::runtime_error("the mesh so far can be had during the callback's call alone");
            return dict_of((*offered)->mesh_so_far());
        });
        struct End {
            const std::shared_ptr<const hmesh::ProgressInfo*>& at;
            ~End() { *at = nullptr; }
        } const end{offered};
        const py::object result = callback_(info.stage, info.fraction, info.vertices, info.energy, info.total,
                                            info.mesh_so_far ? py::object(mesh) : py::none());
        const int is_true = result.is_none() ? 1 : PyObject_IsTrue(result.ptr());
        if (is_true < 0) throw py::error_already_set();
        return is_true == 1;
    }
    py::object callback_;
    std::thread::id thread_;
    std::chrono::steady_clock::time_point looked_{};
    std::exception_ptr error_;
};

// The result as Python takes it: a dict of the mesh and of its report. The mesh nearest to a PSNR out of reach, and that of
// cancelled work, come with a message; else the message is raised.
[[nodiscard]] py::dict dict_of(hmesh::Result&& result) {
    const bool is_partial =
        result.status.code == hmesh::Errc::target_out_of_range || result.status.code == hmesh::Errc::cancelled;
    if (!result.has_mesh() || (!result.status && !is_partial)) raise(result.status);
    py::dict out = dict_of(std::move(result.mesh));
    py::list stages;
    for (const hmesh::StageReport& stage : result.report.stages) {
        py::dict one;
        one["name"] = stage.name;
        one["vertices"] = stage.vertices;
        one["energy"] = stage.energy;
        one["psnr"] = stage.psnr;
        stages.append(one);
    }
    py::dict report;
    report["vertices"] = result.report.vertices;
    report["faces"] = result.report.faces;
    report["energy"] = result.report.energy;
    report["psnr"] = result.report.psnr;
    report["max_error"] = result.report.max_error;
    report["stages"] = stages;
    report["message"] = result.status ? "" : hmesh::message(result.status).c_str();
    out["report"] = report;
    return out;
}

// --- options ---

// Options and what they refer to.
struct HeldOptions {
    hmesh::Options options;
    py::object weights, mask;  // packed arrays, or None

    explicit HeldOptions(const py::dict& from) : weights(from["weights"]), mask(from["mask"]) {
        const auto kind = get<std::string>(from, "target");
        const auto value = get<double>(from, "value");
        options.target = {kind == "vertices"  ? hmesh::Target::Kind::vertices
                          : kind == "percent" ? hmesh::Target::Kind::percent
                                              : hmesh::Target::Kind::psnr,
                          value, get_optional<std::int64_t>(from, "max_vertices"), get_optional<double>(from, "good_enough")};
        options.round_colors = get<bool>(from, "round_colors");
        options.premultiplied = get<bool>(from, "premultiplied");
        options.periodic = static_cast<hmesh::Periodic>(get<int>(from, "periodic"));
        options.straight_border = get<bool>(from, "straight_border");
        options.samples = static_cast<hmesh::Samples>(get<int>(from, "samples"));
        options.nan_is_no_data = get<bool>(from, "nan_is_no_data");
        options.limits.position_step = get<double>(from, "position_step");
        if (const auto colors = get_optional<int>(from, "colors")) options.colors = static_cast<hmesh::Colors>(*colors);
        for (const py::handle weight : from["channel_weights"]) options.channel_weights.push_back(weight.cast<double>());
        if (!weights.is_none()) {
            const auto array = weights.cast<py::array_t<float>>();
            options.weights = {array.data(), static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))};
        }
        if (!mask.is_none()) {
            const auto array = mask.cast<py::array_t<std::uint8_t>>();
            options.mask = {array.data(), static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))};
        }
    }
};

constexpr int max_channels = HMESH_PYTHON_MAX_CHANNELS;
constexpr int max_compact_channels = std::min(4, max_channels);

template <int C, class Body>
[[nodiscard]] auto call_with(Body& body) {
    return body(std::integral_constant<int, C>());
}
template <int... before, class Body>
[[nodiscard]] auto call_with_one_of(std::integer_sequence<int, before...>, int channels, Body& body) {
    using Call = decltype(call_with<1>(body)) (*)(Body&);
    constexpr Call calls[] = {&call_with<before + 1, Body>...};
    return calls[channels - 1](body);
}
// What body() gives of a number of channels, 1 to `most`, as a constant.
template <int most, class Body>
[[nodiscard]] auto with_channels(int channels, Body&& body) {
    return call_with_one_of(std::make_integer_sequence<int, most>(), channels, body);
}

// How much work goes into a mesh, and its random numbers.
[[nodiscard]] hmesh::Annealed recipe_of(const py::dict& with) {
    hmesh::Annealed recipe;
    recipe.effort = static_cast<hmesh::Effort>(get<int>(with, "effort"));
    recipe.seed = get<std::uint64_t>(with, "seed");
    return recipe;
}

// A pool of threads whose pieces may throw, as where memory runs out: the first exception is thrown by the call, which hands out
// no more pieces.
class Threads {
  public:
    explicit Threads(unsigned count) : pool_(count) {}
    void operator()(std::size_t n, hmesh::Piece piece) const {
        std::atomic<bool> has_failed{false};
        std::exception_ptr error;  // of the one that set has_failed
        pool_(n, [&](std::size_t i) {
            if (has_failed) return;
            try {
                piece(i);
            } catch (...) {
                if (!has_failed.exchange(true)) error = std::current_exception();
            }
        });
        if (error) std::rethrow_exception(error);
    }

  private:
    example::ThreadPool pool_;
};

// What a call gives that runs without the interpreter's lock, with so many threads and a callback.
template <class Call>
[[nodiscard]] auto run(const py::dict& with, hmesh::Progress& progress, Call&& call) {
    Listener listener(with["progress"]);
    progress = hmesh::Progress(listener);
    const auto threads = get<unsigned>(with, "threads");
    auto result = [&] {
        const Calls::Free free;
        const Threads pool(threads);
        return call(pool);
    }();
    listener.finish();
    Calls::check();
    return result;
}

py::dict mesh_image(const py::array& array, const py::dict& with) {
    const HeldImage image(array);
    HeldOptions held(with);
    hmesh::Annealed recipe = recipe_of(with);
    recipe.tile = get<int>(with, "tile");
    recipe.border_tolerance = get_optional<double>(with, "border_tolerance");
    hmesh::Mesh start;
    if (const py::object from = with["start"]; !from.is_none()) {
        start = HeldMesh(from.cast<py::dict>()).copy();
        recipe.start = &start;
    }
    return dict_of(run(with, held.options.progress, [&](const hmesh::ParallelFor& parallel_for) {
        return with_channels<max_channels>(image.channels, [&](auto channels) {
            return mesh_channels<channels.value>(image.pixels, held.options, recipe, parallel_for);
        });
    }));
}

py::dict compact_image(const py::array& array, const py::dict& with) {
    const HeldImage image(array);
    hmesh::CompactImageOptions options;
    options.bytes = get<std::size_t>(with, "bytes");
    options.table = get<bool>(with, "table") ? &hmesh::compact_photographs : nullptr;
    options.premultiplied = get<bool>(with, "premultiplied");
    const hmesh::Annealed recipe = recipe_of(with);
    hmesh::CompactImage made = run(with, options.progress, [&](const hmesh::ParallelFor& parallel_for) {
        return with_channels<max_compact_channels>(image.channels, [&](auto channels) {
            return compact_channels<channels.value>(image.pixels, options, recipe, parallel_for);
        });
    });
    if (!made.status) raise(made.status);
    py::dict out = dict_of(std::move(made.mesh));
    out["data"] = py::bytes(reinterpret_cast<const char*>(made.bytes.data()), made.bytes.size());
    out["psnr"] = made.psnr;
    return out;
}

py::dict mesh_terrain(const py::array& array, const py::dict& with) {
    const HeldImage image(array);
    HeldOptions held(with);
    hmesh::Bounded recipe;
    recipe.max_error = get<double>(with, "max_error");
    recipe.effort = static_cast<hmesh::Bounded::Effort>(get<int>(with, "effort"));
    recipe.free_borders = get<bool>(with, "free_borders");
    return dict_of(run(with, held.options.progress, [&](const hmesh::ParallelFor& parallel_for) {
        return mesh_heights(image.pixels, held.options, recipe, parallel_for);
    }));
}

// --- drawing and files ---

template <int C>
[[nodiscard]] py::array draw(const hmesh::MeshView& mesh, const hmesh::RenderOptions& options, unsigned threads) {
    hmesh::RenderResult<C> result;
    {
        const Calls::Free free;
        const Threads pool(threads);
        result = hmesh::render<C>(mesh, options, pool);
    }
    if (!result.status) raise(result.status);
    auto* const owner = new hmesh::Image<float, C>(std::move(result.image));
    const py::capsule capsule(owner, [](void* at) { delete static_cast<hmesh::Image<float, C>*>(at); });
    return py::array_t<float>(
        {static_cast<py::ssize_t>(owner->height()), static_cast<py::ssize_t>(owner->width()), py::ssize_t{C}}, owner->view().data,
        capsule);
}

py::array render(const py::dict& from, std::optional<int> width, std::optional<int> height, bool linear, unsigned threads) {
    const HeldMesh mesh(from);
    hmesh::RenderOptions options;
    options.width = width;
    options.height = height;
    if (linear) options.interpolation = hmesh::RenderOptions::Interpolation::linear;
    if (const hmesh::Status status = hmesh::check(mesh.view, 16); !status) raise(status);
    return with_channels<16>(mesh.view.channels,
                             [&](auto channels) -> py::array { return draw<channels.value>(mesh.view, options, threads); });
}

[[nodiscard]] hmesh::HeightOptions height_options(const py::dict& with) {
    hmesh::HeightOptions options;
    options.z = {get<int>(with, "channel"), get<double>(with, "z_scale"), get<double>(with, "z_offset")};
    options.x_step = get<double>(with, "x_step");
    options.y_step = get<double>(with, "y_step");
    return options;
}

// The bytes of a mesh as a file of a format.
py::bytes write(const py::dict& from, const std::string& format, const py::dict& with) {
    const HeldMesh mesh(from);
    std::string bytes;
    const auto put = hmesh::kit::append_to(bytes);
    const hmesh::Sink sink(put);
    const auto run = [&](auto&& body) {
        const Calls::Free free;
        return body();
    };
    hmesh::Status status;
    if (const auto& view = mesh.view; format == "ply") {
        hmesh::PlyOptions options;
        options.ascii = get<bool>(with, "ascii");
        options.float_colors = get<bool>(with, "float_colors");
        status = run([&] { return hmesh::write_ply(view, sink, options); });
    } else if (format == "obj") {
        status = run([&] { return hmesh::write_obj(view, sink); });
    } else if (format == "glb") {
        hmesh::GltfOptions options;
        options.longer_side = get<double>(with, "longer_side");
        options.quantized_positions = get<bool>(with, "quantized_positions");
        options.colors_are_linear = get<bool>(with, "colors_are_linear");
        options.color_bits = get<int>(with, "color_bits");
        status = run([&] { return hmesh::write_glb(view, sink, options); });
    } else if (format == "svg") {
        hmesh::SvgOptions options;
        options.kind = static_cast<hmesh::SvgOptions::Kind>(get<int>(with, "kind"));
        options.wireframe = get<bool>(with, "wireframe");
        status = run([&] { return hmesh::write_svg(view, sink, options); });
    } else if (format == "html") {
        const auto title = get<std::string>(with, "title");
        if (title.find('\0') != std::string::npos) throw py::value_error("the title must not have a zero, at which it would end");
        hmesh::HtmlOptions options;
        options.title = title.c_str();
        status = run([&] { return hmesh::write_html(view, sink, options); });
    } else if (format == "pdf") {
        status = run([&] { return hmesh::write_pdf(view, sink); });
    } else if (format == "eps") {
        status = run([&] { return hmesh::write_eps(view, sink); });
    } else if (format == "hmc") {
        hmesh::CompactOptions options;
        options.colors = static_cast<hmesh::CompactColors>(get<int>(with, "colors"));
        status = run([&] { return hmesh::write_compact(view, sink, options); });
    } else if (format == "height_ply") {
        const hmesh::HeightOptions options = height_options(with);
        status = run([&] { return hmesh::write_height_ply(view, {}, sink, options); });
    } else if (format == "height_obj") {
        const hmesh::HeightOptions options = height_options(with);
        status = run([&] { return hmesh::write_height_obj(view, {}, sink, options); });
    } else if (format == "height_glb") {
        const hmesh::HeightOptions options = height_options(with);
        status = run([&] { return hmesh::write_height_glb(view, {}, sink, options); });
    } else if (format == "stl") {
        const auto base = get_optional<double>(with, "base");
        const hmesh::HeightOptions options = height_options(with);
        status = run([&] {
            return base ? hmesh::write_solid_stl(view, *base, sink, options) : hmesh::write_height_stl(view, sink, options);
        });
    } else {
        throw py::value_error("no format of this name is known: " + format);
    }
    if (!status) raise(status);
    return py::bytes(bytes);
}

py::dict read_compact(const py::bytes& from, std::int64_t max_vertices, std::int64_t max_pixels) {
    char* data = nullptr;
    py::ssize_t size = 0;
    if (PyBytes_AsStringAndSize(from.ptr(), &data, &size) != 0) throw py::error_already_set();
    hmesh::CompactMesh read;
    {
        const Calls::Free free;
        hmesh::CompactLimits limits;
        limits.max_vertices = max_vertices;
        limits.max_pixels = max_pixels;
        read = hmesh::read_compact(reinterpret_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size), limits,
                                   &hmesh::compact_photographs);
    }
    if (!read.status) raise(read.status);
    return dict_of(std::move(read.mesh));
}

}  // namespace
}  // namespace python

PYBIND11_MODULE(_core, module) {
    module.attr("version") = HMESH_VERSION_STRING;
    module.attr("max_channels") = python::max_channels;
    module.attr("max_compact_channels") = python::max_compact_channels;
    py::module_::import("atexit").attr("register")(py::cpp_function(&python::Calls::end));
    module.def("mesh_image", &python::mesh_image);
    module.def("compact_image", &python::compact_image);
    module.def("mesh_terrain", &python::mesh_terrain);
    module.def("render", &python::render);
    module.def("write", &python::write);
    module.def("read_compact", &python::read_compact);
}
