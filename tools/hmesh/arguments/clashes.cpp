#include "arguments/clashes.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "arguments/patterns.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/output_file.hpp"

namespace tool {
namespace {

namespace fs = std::filesystem;

// Files by any of their names. In a run of thousands of images each is looked up among all: hence by its full name, and where it
// is there already among those of its size and age alone, one of which may be the same by another link.
class FileSet {
  public:
    // The number under which this file was added, or that of no file.
    [[nodiscard]] std::size_t find(const std::string& name) const {
        if (const auto found = by_name_.find(full_name(name)); found != by_name_.end()) return found->second;
        std::error_code none;
        const auto [first, last] = by_look_.equal_range(look(name));
        for (auto other = first; other != last; ++other)
            if (fs::equivalent(name, other->second.first, none)) return other->second.second;
        return no_file;
    }
    void add(const std::string& name, std::size_t number) {
        by_name_.emplace(full_name(name), number);
        std::error_code none;
        if (fs::exists(name, none)) by_look_.emplace(look(name), std::make_pair(name, number));
    }

    static constexpr auto no_file = static_cast<std::size_t>(-1);

  private:
    using Look = std::pair<std::uintmax_t, fs::file_time_type>;

    static Look look(const std::string& name) {
        std::error_code none;
        const std::uintmax_t size = fs::file_size(name, none);
        return {size, fs::last_write_time(name, none)};
    }

    std::map<std::string, std::size_t> by_name_;
    std::multimap<Look, std::pair<std::string, std::size_t>> by_look_;
};

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
