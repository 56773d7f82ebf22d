// gpu_layouts - the buffers of a mesh in every layout that pack_for_gpu() has, as JSON for webgpu.js, with what render() draws.
#ifndef HMESH_TESTS_VIEWERS_GPU_LAYOUTS_HPP
#define HMESH_TESTS_VIEWERS_GPU_LAYOUTS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>
#include <hmesh/io/detail/base64.hpp>

// The mesh of 4 channels in grey: its green, and alpha.
inline hmesh::Mesh gray_of(const hmesh::Mesh& mesh) {
    hmesh::Mesh gray = mesh;
    gray.channels = 2;
    gray.colors.clear();
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        gray.colors.insert(gray.colors.end(), {mesh.colors[4 * v + 1], mesh.colors[4 * v + 3]});
    return gray;
}

class GpuLayouts {
  public:
    explicit GpuLayouts(hmesh::Sink sink) : writer_(sink) {}

    // {"pictures": [of the mesh, and in grey], "layouts": [..]}, bytes as base64. For a mesh of 4 channels of 8 bits.
    hmesh::Status write(const hmesh::Mesh& mesh) {
        using hmesh::GpuFormat;
        const hmesh::Mesh gray = gray_of(mesh);
        text("{\"pictures\":[");
        put_picture(hmesh::to_pixels<std::uint8_t>(hmesh::render<4>(mesh.view()).image));
        text(",");
        put_picture(hmesh::to_pixels<std::uint8_t>(hmesh::render<2>(gray.view()).image));
        text("],\"layouts\":[");
        const char* between = "";
        for (const GpuFormat color : {GpuFormat::unorm8x4, GpuFormat::unorm16x4, GpuFormat::unorm8x2, GpuFormat::unorm16x2})
            for (const GpuFormat position : {GpuFormat::unorm16x2, GpuFormat::float32x2})
                for (const auto topology : {hmesh::GpuTopology::triangle_list, hmesh::GpuTopology::triangle_strip})
                    for (const auto index : {hmesh::GpuIndexFormat::uint16, hmesh::GpuIndexFormat::uint32})
                        for (const std::uint32_t chunk : {0U, 300U}) {
                            const bool is_gray = hmesh::components_of(color) == 2;
                            const auto buffers = hmesh::pack_for_gpu((is_gray ? gray : mesh).view(),
                                                                     {position, color, {}, topology, index, chunk});
                            if (!buffers.status) return buffers.status;
                            text(between);
                            put(buffers);
                            between = ",";
                        }
        text("]}");
        return writer_.finish();
    }

  private:
    void text(const char* words) { writer_.text(words); }
    void number(const char* name, double value) {
        text(name);
        writer_.real(value);
    }
    void bytes(const void* from, std::size_t size) {
        text("\"");
        hmesh::detail::Base64Sink base64(writer_);
        base64(from, size);
        base64.finish();
        text("\"");
    }
    template <int C>
    void put_picture(const hmesh::Image<std::uint8_t, C>& picture) {
        std::vector<std::uint8_t> rgba;
        for (std::size_t i = 0; i < picture.size() / C; ++i)
            for (std::size_t k = 0; k < 4; ++k) rgba.push_back(picture.data()[C * i + (C == 4 ? k : k / 3)]);
        bytes(rgba.data(), rgba.size());
    }
    void put_attribute(const char* name, const hmesh::GpuAttribute& attribute) {
        const char* const formats[] = {"float32x2", "unorm16x2", "unorm16x4", "unorm8x2", "unorm8x4"};
        text(name);
        text("{\"format\":\"");
        text(formats[static_cast<int>(attribute.format)]);
        number("\",\"offset\":", attribute.offset);
        text("}");
    }
    void put(const hmesh::GpuBuffers& buffers) {
        const hmesh::GpuLayout& layout = buffers.layout;
        number("{\"size\":[", layout.width);
        number(",", layout.height);
        number("],\"scale\":[", static_cast<double>(layout.scale[0]));
        number(",", static_cast<double>(layout.scale[1]));
        number("],\"offset\":[", static_cast<double>(layout.offset[0]));
        number(",", static_cast<double>(layout.offset[1]));
        number("],\"stride\":", layout.stride);
        put_attribute(",\"position\":", layout.position);
        put_attribute(",\"color\":", layout.color);
        text(layout.index == hmesh::GpuIndexFormat::uint16 ? ",\"index\":\"uint16\"" : ",\"index\":\"uint32\"");
        text(layout.topology == hmesh::GpuTopology::triangle_list ? ",\"topology\":\"triangle-list\""
                                                                  : ",\"topology\":\"triangle-strip\"");
        text(",\"chunks\":[");
        for (std::size_t i = 0; i < buffers.chunks.size(); ++i) {
            number(i == 0 ? "[" : ",[", buffers.chunks[i].index_count);
            number(",", buffers.chunks[i].first_index);
            number(",", buffers.chunks[i].first_vertex);
            text("]");
        }
        text("],\"vertices\":");
        bytes(buffers.vertices.data(), buffers.vertices.size());
        text(",\"indices\":");
        bytes(buffers.indices.data(), buffers.indices.size());
        text("}");
    }

    hmesh::detail::Writer writer_;
};

#endif  // HMESH_TESTS_VIEWERS_GPU_LAYOUTS_HPP
