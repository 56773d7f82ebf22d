#include "terrain/written/surface.hpp"

namespace terrain {
namespace {

std::string read_model(Format format, tool::Bytes file, Model& model) {
    switch (format) {
        case Format::none: break;
        case Format::glb: return read_glb(file, model);
        case Format::ply: return read_ply(file, model);
        case Format::obj: return read_obj(file, model);
        case Format::stl: return read_stl(file, model);
        case Format::quantized_mesh: return read_quantized_mesh(file, model);
    }
    return "it has no format";
}

}  // namespace

std::string read_back(Format format, tool::Bytes file, const Frame& frame, const Tile& tile, Surface& surface) {
    Model model;
    if (std::string why = read_model(format, file, model); !why.empty()) return why;
    const bool is_globe = format == Format::quantized_mesh;
    surface = {};
    surface.x.reserve(model.vertices.size());
    surface.y.reserve(model.vertices.size());
    surface.height.reserve(model.vertices.size());
    for (const auto& [x, y, z] : model.vertices) {
        surface.x.push_back(is_globe ? x * (tile.width - 1) : (x - frame.x_origin) / frame.x_step - tile.column);
        surface.y.push_back(is_globe ? (1 - y) * (tile.height - 1) : (frame.y_origin - y) / frame.y_step - tile.row);
        surface.height.push_back((z - frame.z_offset) / frame.z_scale);
    }
    surface.faces.reserve(model.faces.size());
    for (const auto& [a, b, c] : model.faces) {
        if (a >= surface.x.size() || b >= surface.x.size() || c >= surface.x.size()) return "it has a face that names no vertex";
        const double area = (surface.x[b] - surface.x[a]) * (surface.y[c] - surface.y[a]) -
                            (surface.x[c] - surface.x[a]) * (surface.y[b] - surface.y[a]);
        // Counter-clockwise as seen from above, with y to the north: in rows from the north the other way round.
        if (area < 0) surface.faces.push_back({a, c, b});
    }
    return {};
}

}  // namespace terrain
