// PLY (Greg Turk, 1994), OBJ (Wavefront) and STL (3D Systems) as far as models of heights need them.
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

#include "terrain/written/surface.hpp"

namespace terrain {
namespace {

double f32(tool::Bytes file, std::size_t at) {
    const std::uint32_t word = file.le32(at);
    float value = 0;
    std::memcpy(&value, &word, 4);
    return static_cast<double>(value);
}

// The next line, without its end; `at` goes behind it.
std::string next_line(tool::Bytes file, std::size_t& at) {
    std::string line;
    for (; at < file.size && file.u8(at) != '\n'; ++at) line += static_cast<char>(file.u8(at));
    ++at;
    return line;
}

// The words of a line.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    for (std::size_t at = 0; (at = line.find_first_not_of(' ', at)) != std::string::npos;) {
        const std::size_t end = std::min(line.find(' ', at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

}  // namespace

std::string read_ply(tool::Bytes file, Model& model) {
    std::size_t at = 0, vertices = 0, faces = 0, stride = 0;
    std::map<std::string, std::size_t> places;  // of properties in a vertex
    bool is_vertex = false;
    for (std::string line = next_line(file, at); line != "end_header"; line = next_line(file, at)) {
        if (at >= file.size) return "its head has no end";
        const std::vector<std::string> words = words_of(line);
        if (words.size() == 3 && words[0] == "element") {
            is_vertex = words[1] == "vertex";
            (is_vertex ? vertices : faces) = std::strtoull(words[2].c_str(), nullptr, 10);
        } else if (words.size() == 3 && words[0] == "property" && is_vertex) {
            if (words[1] != "float") return "its vertices have other numbers than floats";
            places[words[2]] = stride;
            stride += 4;
        }
    }
    if (places.count("x") + places.count("y") + places.count("z") != 3) return "its vertices have no x, y and z";
    if (!file.has(at, vertices * stride + faces * 13)) return "it is too short";
    for (std::size_t v = 0; v < vertices; ++v, at += stride)
        model.vertices.push_back({f32(file, at + places["x"]), f32(file, at + places["y"]), f32(file, at + places["z"])});
    for (std::size_t f = 0; f < faces; ++f, at += 13) {
        if (file.u8(at) != 3) return "it has a face that is no triangle";
        model.faces.push_back({file.le32(at + 1), file.le32(at + 5), file.le32(at + 9)});
    }
    return {};
}

std::string read_obj(tool::Bytes file, Model& model) {
    for (std::size_t at = 0; at < file.size;) {
        const std::vector<std::string> words = words_of(next_line(file, at));
        if (words.size() != 4 || (words[0] != "v" && words[0] != "f")) continue;
        if (words[0] == "v") {
            std::array<double, 3> place{};
            for (std::size_t k = 0; k < 3; ++k) place[k] = std::strtod(words[k + 1].c_str(), nullptr);
            model.vertices.push_back(place);
        } else {
            std::array<std::uint32_t, 3> face{};
            for (std::size_t k = 0; k < 3; ++k)
                face[k] = static_cast<std::uint32_t>(std::strtoul(words[k + 1].c_str(), nullptr, 10) - 1);
            model.faces.push_back(face);
        }
    }
    return {};
}

std::string read_stl(tool::Bytes file, Model& model) {
    const std::size_t faces = file.le32(80);
    if (!file.has(84, faces * 50)) return "it is too short";
    for (std::size_t f = 0; f < faces; ++f) {
        const auto first = static_cast<std::uint32_t>(model.vertices.size());
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t at = 84 + 50 * f + 12 + 12 * k;
            model.vertices.push_back({f32(file, at), f32(file, at + 4), f32(file, at + 8)});
        }
        model.faces.push_back({first, first + 1, first + 2});
    }
    return {};
}

}  // namespace terrain
