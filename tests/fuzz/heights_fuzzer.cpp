// Fuzzes the exporters of heights: write_height_ply(), _obj(), _glb(), _stl(), write_solid_stl() and write_quantized_mesh().
// Files have to be as long as they say, numbers finite, normals of length 1, indices those of vertices, and solids closed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/terrain.hpp"

namespace {

using hmesh_test::demand;

// The bytes of a file, from the first on.
class Reader {
  public:
    explicit Reader(const std::string& file) : file_(&file) {}

    template <class T>
    [[nodiscard]] T number() {  // the machine is little-endian
        demand(at_ + sizeof(T) <= file_->size(), "the file is as long as it says");
        T value{};
        std::memcpy(&value, file_->data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    void skip_behind(const char* words) {
        at_ = file_->find(words, at_);
        demand(at_ != std::string::npos, "the head has its words");
        at_ += std::strlen(words);
    }
    [[nodiscard]] std::array<float, 3> point() {
        std::array<float, 3> out{};
        for (float& coordinate : out) {
            coordinate = number<float>();
            demand(std::isfinite(coordinate), "a coordinate is finite");
        }
        return out;
    }
    void unit_normal(bool may_be_zero) {
        const auto [x, y, z] = point();
        const double length =
            std::sqrt(static_cast<double>(x) * static_cast<double>(x) + static_cast<double>(y) * static_cast<double>(y) +
                      static_cast<double>(z) * static_cast<double>(z));
        demand(std::abs(length - 1) < 1e-5 || (may_be_zero && length == 0), "a normal has the length 1");
    }
    void align(std::size_t to) { at_ = (at_ + to - 1) / to * to; }
    void expect_end() const { demand(at_ == file_->size(), "the file is no longer than it says"); }
    [[nodiscard]] bool is_at_end() const { return at_ == file_->size(); }

  private:
    const std::string* file_;
    std::size_t at_ = 0;
};

void check_ply(const std::string& file, const hmesh::MeshView& mesh, const hmesh::HeightOptions& options) {
    Reader reader(file);
    reader.skip_behind("end_header\n");
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        static_cast<void>(reader.point());
        if (options.has_normals) reader.unit_normal(false);
        for (int k = 0; k < 2 && options.drape != hmesh::Drape::none; ++k)
            demand(std::isfinite(reader.number<float>()), "a texture coordinate is finite");
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        demand(reader.number<std::uint8_t>() == 3, "a face has three corners");
        for (int k = 0; k < 3; ++k) demand(reader.number<std::uint32_t>() < mesh.vertex_count, "a corner is a vertex");
    }
    reader.expect_end();
}

void check_stl(const std::string& file, bool is_closed) {
    Reader reader(file);
    for (int i = 0; i < 80; ++i) static_cast<void>(reader.number<char>());
    using Point = std::array<float, 3>;
    std::vector<std::array<Point, 2>> edges, backward;
    for (auto faces = reader.number<std::uint32_t>(); faces > 0; --faces) {
        reader.unit_normal(true);
        std::array<Point, 3> corners{};
        for (Point& corner : corners) corner = reader.point();
        for (std::size_t k = 0; k < 3; ++k) {
            edges.push_back({corners[k], corners[(k + 1) % 3]});
            backward.push_back({corners[(k + 1) % 3], corners[k]});
        }
        demand(reader.number<std::uint16_t>() == 0, "a facet has no attributes");
    }
    reader.expect_end();
    std::sort(edges.begin(), edges.end());
    std::sort(backward.begin(), backward.end());
    demand(!is_closed || edges == backward, "a solid has a facet on either side of each edge");
}

void check_tile(const std::string& file, const hmesh::MeshView& mesh) {
    Reader reader(file);
    for (int k = 0; k < 3; ++k) demand(std::isfinite(reader.number<double>()), "the centre is a point");
    const auto low = reader.number<float>(), high = reader.number<float>();
    demand(low <= high, "the heights are a range");
    for (int k = 0; k < 7; ++k) demand(std::isfinite(reader.number<double>()), "the sphere and the occlusion point are points");
    const auto vertices = reader.number<std::uint32_t>();
    demand(vertices >= 1 && vertices <= mesh.vertex_count + 1, "vertices are the mesh's");
    for (int k = 0; k < 3; ++k) {
        int value = 0;
        for (std::uint32_t v = 0; v < vertices; ++v) {
            const int code = reader.number<std::uint16_t>();
            value += code % 2 == 0 ? code / 2 : -(code / 2) - 1;
            demand(value >= 0 && value <= 32767, "a coordinate has 15 bits");
        }
    }
    const bool is_wide = vertices > 65536;
    if (is_wide) reader.align(4);
    const auto index = [&] { return is_wide ? reader.number<std::uint32_t>() : std::uint32_t{reader.number<std::uint16_t>()}; };
    const auto faces = reader.number<std::uint32_t>();
    demand(faces == mesh.face_count, "faces are the mesh's");
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 3 * std::size_t{faces}; ++i) {
        const std::uint32_t code = index();
        demand(code <= next, "an index is one that was, or the next");
        demand(next - code < vertices, "an index names a vertex");
        next += code == 0 ? 1 : 0;
    }
    for (int side = 0; side < 4; ++side)
        for (auto count = reader.number<std::uint32_t>(); count > 0; --count) demand(index() < vertices, "a side is of vertices");
    if (reader.is_at_end()) return;
    demand(reader.number<std::uint8_t>() == 1, "the extension is that of normals");
    demand(reader.number<std::uint32_t>() == 2 * vertices, "each vertex has two bytes");
    for (std::uint32_t v = 0; v < vertices; ++v) static_cast<void>(reader.number<std::uint16_t>());
    reader.expect_end();
}

hmesh::HeightOptions draw_options(hmesh_test::FuzzInput& input, bool is_wild) {
    hmesh::HeightOptions options;
    options.up = input.one_of({hmesh::UpAxis::usual, hmesh::UpAxis::y, hmesh::UpAxis::z});
    options.has_normals = !input.flag();
    options.drape = input.one_of({hmesh::Drape::raster, hmesh::Drape::mesh, hmesh::Drape::none});
    if (options.drape != hmesh::Drape::none && input.flag()) options.texture = "map.png";
    if (!is_wild) return options;
    options.x_step = input.wild_real(), options.y_step = input.wild_real();
    options.x_origin = input.wild_real(), options.y_origin = input.wild_real();
    options.first_column = input.wild_int(), options.first_row = input.wild_int();
    options.z = {input.within(-1, 4), input.wild_real(), input.wild_real()};
    return options;
}

hmesh::QuantizedMeshOptions draw_tile(hmesh_test::FuzzInput& input, bool is_wild) {
    hmesh::QuantizedMeshOptions tile;
    tile.west = input.within(-180, 170), tile.south = input.within(-90, 80);
    tile.east = tile.west + 1 + 179 * input.share(), tile.north = tile.south + (90 - tile.south) * std::max(0.01, input.share());
    tile.has_normals = !input.flag();
    if (!is_wild) return tile;
    tile.z = {input.within(-1, 4), input.wild_real(), input.wild_real()};
    tile.low = input.wild_real(), tile.high = input.wild_real();
    if (input.flag()) tile.east = input.wild_real(), tile.north = input.wild_real();
    return tile;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    const int format = input.within(0, 5);
    const bool is_wild = input.one_in(3), are_points = input.flag(), has_samples = input.flag();
    const hmesh::HeightOptions options = draw_options(input, is_wild);
    const hmesh::QuantizedMeshOptions tile = draw_tile(input, is_wild);
    const double base = input.flag() ? -1e6 : input.wild_real();
    hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    mesh.is_good = mesh.is_good && !is_wild && !are_points && format < 4;
    if (are_points) mesh.view.samples = hmesh::Samples::points;

    hmesh::Image<float, 1> samples;
    if (has_samples && mesh.view.width > 0 && mesh.view.width <= 300 && mesh.view.height > 0 && mesh.view.height <= 300)
        samples = hmesh::Image<float, 1>(mesh.view.width, mesh.view.height);
    for (std::size_t i = 0; i < samples.size() && input.left() > 0; ++i)
        samples.data()[i] = input.one_in(9) ? input.bits<float>() : static_cast<float>(input.byte());
    hmesh::Image<std::uint8_t, 1> mask(samples.width(), samples.height());
    for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] = input.left() > 0 && input.one_in(3) ? 0 : 1;
    hmesh::HeightSamples view;
    if (samples.size() > 0 && options.z.channel == 0) view = hmesh::HeightSamples(samples.view(), mask.view());

    const auto write = [&](const hmesh::MeshView& of, hmesh::Sink sink) {
        switch (format) {
            case 0: return hmesh::write_height_ply(of, view, sink, options);
            case 1: return hmesh::write_height_obj(of, view, sink, options);
            case 2: return hmesh::write_height_glb(of, view, sink, options);
            case 3: return hmesh::write_height_stl(of, sink, options);
            case 4: return hmesh::write_solid_stl(of, base, sink, options);
            default: return hmesh::write_quantized_mesh(of, view, sink, tile);
        }
    };
    hmesh_test::fuzz_exporter(input, mesh, write, [&](const std::string& file, const hmesh::MeshView& of) {
        if (format == 0) check_ply(file, of, options);
        if (format == 3) check_stl(file, false);
        if (format == 4) check_stl(file, true);
        if (format == 5) check_tile(file, of);
    });
    if (format == 5) {
        const hmesh::TileRounding rounding = hmesh::rounded_to_tile(mesh.view, tile);
        demand(!rounding.status || rounding.mesh.vertex_count() == mesh.view.vertex_count,
               "a rounded mesh has the same vertices");
        demand(!rounding.status || hmesh::check(rounding.mesh.view(), 16), "a rounded mesh can be written");
    }
    return 0;
}
