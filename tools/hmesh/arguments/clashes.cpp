#include "arguments/clashes.hpp"

#include <cstddef>
#include <filesystem>
#include <system_error>

#include "arguments/files.hpp"
#include "arguments/patterns.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/file_set.hpp"
#include "writers/output_file.hpp"

namespace tool {
namespace {

namespace fs = std::filesystem;

std::string find_stream_clash(const std::vector<Arguments>& images) {
    std::size_t reads = 0, writes = 0, most = 0;
    for (const Arguments& image : images) {
        std::size_t of_image = 0;
        for (const std::string& file : output_files(image)) of_image += is_standard(file) ? 1 : 0;
        most = of_image > most ? of_image : most;
        writes += of_image;
        for (const std::string& file : input_files(image)) reads += is_standard(file) ? 1 : 0;
    }
    if (reads > 1) return "the standard input is named twice";
    if (most > 1) return "the standard output is named for two outputs";
    if (writes > 1)
        return "the standard output is named for " + std::to_string(writes) + " images; --json prints a line for each";
    if (writes == 0 || !is_terminal(stdout)) return {};
    const auto is_text = [](const std::string& ending) {
        return ending != ".ply" && ending != ".glb" && ending != ".pdf" && ending != ".hmc";
    };
    const auto refusal = [](const std::string& ending) {
        return "the standard output is a terminal, and " + ending + " is no text: lead it to a file or a program";
    };
    for (const Arguments& image : images) {
        for (const MeshFile& mesh : image.meshes)
            if (is_standard(mesh.name) && !is_text(mesh.ending)) return refusal(mesh.ending);
        for (const std::string& file : {image.render, image.wireframe, image.residual, image.strip})
            if (is_standard(file)) return refusal(".png");
    }
    return {};
}

std::string in_two_images(const std::string& file, const Arguments& a, const Arguments& b, std::size_t images) {
    if (image_name(a.input) == image_name(b.input))
        return "'" + a.input + "' and '" + b.input + "' would both become '" + file + "'";
    return "'" + file + "' is named for " + std::to_string(images) + " images: it needs {name} in it, which is that of each";
}

}  // namespace

std::string find_clash(const std::vector<Arguments>& images) {
    if (std::string why = find_stream_clash(images); !why.empty()) return why;
    for (const Arguments& image : images)
        for (const std::string& file : input_files(image))
            if (is_part(file)) return unfinished(file);
    FileSet inputs, weights, outputs;
    for (const Arguments& image : images) {
        inputs.add(image.input, 0);
        for (const OtherMap& other : image.others) inputs.add(other.file, 0);
        if (!image.weights.empty()) weights.add(image.weights, 0);
    }
    for (std::size_t i = 0; i < images.size(); ++i)
        for (const std::string& file : output_files(images[i])) {
            std::error_code none;
            if (is_standard(file) || (fs::exists(file, none) && !fs::is_regular_file(file, none))) continue;
            if (inputs.find(file) != FileSet::no_file)
                return "'" + file + "' would overwrite the input" + (images.size() > 1 ? " of that name" : "");
            if (weights.find(file) != FileSet::no_file) return "'" + file + "' would overwrite the weights";
            const std::size_t other = outputs.find(file);
            if (other == i) return "'" + file + "' is named for two outputs";
            if (other != FileSet::no_file) return in_two_images(file, images[other], images[i], images.size());
            outputs.add(file, i);
        }
    return {};
}

}  // namespace tool
