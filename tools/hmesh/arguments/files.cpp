#include "arguments/files.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>

#include "arguments/map_names.hpp"
#include "arguments/patterns.hpp"
#include "terminal/standard_streams.hpp"

namespace tool {
namespace {

// The names of the files that are written; of arguments that are const or not.
template <class AnyArguments, class Take>
void for_each_output(AnyArguments& arguments, Take&& take) {
    for (auto& mesh : arguments.meshes) {
        take(mesh.name);
        for (auto& level : mesh.coarser) take(level);
    }
    for (auto& material : arguments.materials) take(material);
    for (auto* file :
         {&arguments.render, &arguments.wireframe, &arguments.residual, &arguments.strip, &arguments.report, &arguments.depfile})
        if (!file->empty()) take(*file);
}

// Names the files of the levels of detail.
void name_levels(Arguments& arguments) {
    for (MeshFile& mesh : arguments.meshes) {
        const std::string all = mesh.name;
        const int levels = mesh.ending == ".glb" && !has_level_mark(all) ? 1 : arguments.meshing.levels;
        mesh.name = level_file(all, 0);
        for (int level = 1; level < levels; ++level) mesh.coarser.push_back(level_file(all, level));
        if (!has_level_mark(all)) continue;
        arguments.folders.push_back(std::filesystem::path(mesh.name).parent_path().string());
        for (const std::string& level : mesh.coarser)
            arguments.folders.push_back(std::filesystem::path(level).parent_path().string());
    }
}

}  // namespace

std::vector<std::string> render_files(const Arguments& arguments) {
    const std::string& render = arguments.render;
    if (render.empty()) return {};
    if (arguments.others.empty() || is_standard(render)) return {render};
    const std::size_t dot = render.size() - 4;  // of .png
    std::vector<std::string> files{render.substr(0, dot) + "_" + arguments.name + render.substr(dot)};
    for (const OtherMap& other : arguments.others) files.push_back(render.substr(0, dot) + "_" + other.name + render.substr(dot));
    return files;
}

std::vector<std::string> output_files(const Arguments& arguments) {
    std::vector<std::string> files;
    for_each_output(arguments, [&](const std::string& file) {
        if (&file != &arguments.render) return files.push_back(file);
        const std::vector<std::string> pictures = render_files(arguments);
        files.insert(files.end(), pictures.begin(), pictures.end());
    });
    return files;
}

std::vector<std::string> input_files(const Arguments& arguments) {
    std::vector<std::string> files{arguments.input};
    for (const OtherMap& other : arguments.others) files.push_back(other.file);
    if (!arguments.weights.empty()) files.push_back(arguments.weights);
    return files;
}

bool writes_standard_output(const Arguments& arguments) {
    const std::vector<std::string> files = output_files(arguments);
    return std::any_of(files.begin(), files.end(), is_standard);
}

bool has_output(const Arguments& arguments, const std::string& ending) {
    return std::any_of(arguments.meshes.begin(), arguments.meshes.end(),
                       [&](const MeshFile& mesh) { return mesh.ending == ending; });
}

bool has_pattern(const Arguments& arguments) {
    const std::vector<std::string> files = output_files(arguments);
    const auto is_pattern_of = [](const OtherMap& other) { return is_pattern(other.file); };
    return is_pattern(arguments.weights) || std::any_of(files.begin(), files.end(), is_pattern) ||
           std::any_of(arguments.others.begin(), arguments.others.end(), is_pattern_of);
}

Arguments for_image(Arguments all, const std::string& input) {
    all.input = input;
    name_levels(all);
    const std::string name = image_name(input);
    for (std::string& folder : all.folders) folder = expand(folder, name);
    all.weights = expand(all.weights, name);
    for (OtherMap& other : all.others) other.file = expand(other.file, name);
    for_each_output(all, [&](std::string& file) {
        if (!is_pattern(file)) return;
        file = expand(file, name);
        all.folders.push_back(std::filesystem::path(file).parent_path().string());
    });
    all.texture = expand(all.texture, name);
    for (const MeshFile& mesh : all.meshes)
        if (all.outline && mesh.ending == ".obj" && !is_standard(mesh.name))
            all.materials.push_back(std::filesystem::path(mesh.name).replace_extension(".mtl").string());
    return all;
}

std::string name_maps(Arguments& arguments) {
    if (arguments.others.empty()) return {};
    std::vector<std::string> files{arguments.input};
    for (const OtherMap& other : arguments.others) files.push_back(other.file);
    std::vector<std::string> names = map_names(files);
    for (std::size_t i = 0; i < arguments.others.size(); ++i) {
        OtherMap& other = arguments.others[i];
        if (other.name.empty()) other.name = names[i + 1];
        names[i + 1] = other.name;
    }
    arguments.name = names[0];
    for (std::size_t i = 0; i < names.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (hmesh::detail::is_same_name(names[i].c_str(), names[k].c_str()))
                return "'" + files[k] + "' and '" + files[i] + "' are both called '" + names[i] + "': --with NAME=FILE names one";
    return {};
}

}  // namespace tool
