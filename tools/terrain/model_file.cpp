#include "terrain/model_file.hpp"

#include <cstddef>

#include "hmesh/io/heights/height_glb.hpp"
#include "hmesh/io/heights/height_models.hpp"
#include "hmesh/io/heights/height_stl.hpp"
#include "hmesh/io/heights/quantized_mesh.hpp"

namespace terrain {

hmesh::Status write_model(const Arguments& arguments, const Dem& dem, const Frame& frame, const HeightRange& range,
                          const Tile& tile, const Window& window, const hmesh::MeshView& mesh,
                          std::vector<unsigned char>& bytes) {
    bytes.clear();
    const auto sink = hmesh::kit::append_to(bytes);
    const hmesh::HeightSamples samples(window.around(), {}, window.left, window.top);
    hmesh::HeightOptions options;
    options.z = {0, frame.z_scale, frame.z_offset};
    options.x_step = frame.x_step;
    options.y_step = frame.y_step;
    options.x_origin = frame.x_origin;
    options.y_origin = frame.y_origin;
    options.first_column = tile.column;
    options.first_row = tile.row;
    options.has_normals = arguments.has_normals;
    options.skirt = frame.z_scale * tile.skirt;
    switch (arguments.format) {
        case Format::none: break;
        case Format::glb: return hmesh::write_height_glb(mesh, samples, sink, options);
        case Format::ply: return hmesh::write_height_ply(mesh, samples, sink, options);
        case Format::obj: return hmesh::write_height_obj(mesh, samples, sink, options);
        case Format::stl:
            if (arguments.base)
                return hmesh::write_solid_stl(mesh, frame.z_offset + frame.z_scale * *arguments.base, sink, options);
            return hmesh::write_height_stl(mesh, sink, options);
        case Format::quantized_mesh: {
            const Extent extent = extent_of(frame, dem.width, dem.height, tile);
            const double turn = extent[0] > 180 ? -360 : extent[0] < -180 ? 360 : 0;  // files may count degrees from 0 to 360
            hmesh::QuantizedMeshOptions globe;
            globe.west = extent[0] + turn;
            globe.south = extent[1];
            globe.east = extent[2] + turn;
            globe.north = extent[3];
            globe.z = options.z;
            globe.low = frame.z_offset + frame.z_scale * range.low;
            globe.high = frame.z_offset + frame.z_scale * range.high;
            globe.has_normals = arguments.has_normals;
            return hmesh::write_quantized_mesh(mesh, samples, sink, globe);
        }
    }
    return {hmesh::Errc::invalid_argument, "the file has no format"};
}

}  // namespace terrain
