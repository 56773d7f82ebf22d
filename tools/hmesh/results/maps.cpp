#include "results/maps.hpp"

#include <algorithm>
#include <cmath>

#include "arguments/map_names.hpp"
#include "meshing.hpp"
#include "readers/image_set.hpp"
#include "results/psnr_between.hpp"
#include "terminal/standard_streams.hpp"

namespace tool {

std::string find_maps(const Arguments& arguments, const std::vector<ImageFile>& images, std::vector<Map>& maps) {
    int first = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
        Map map;
        map.file = i == 0 ? arguments.input : arguments.others[i - 1].file;
        map.name = i == 0 ? arguments.name : arguments.others[i - 1].name;
        if (i > 0)
            map.meaning = is_normal_map(map.name) ? hmesh::ChannelGroup::Meaning::normal : hmesh::ChannelGroup::Meaning::data;
        map.first = first;
        map.channels = images[i].channels;
        first += map.channels;
        if (map.meaning == hmesh::ChannelGroup::Meaning::normal && map.channels != 3)
            return input_words(map.file) + " is called '" + map.name + "' and has " + std::to_string(map.channels) +
                   " channels, not the 3 of a normal: --with NAME=FILE names it otherwise";
        const bool is_second =
            map.meaning == hmesh::ChannelGroup::Meaning::normal &&
            std::any_of(maps.begin(), maps.end(), [&](const Map& other) { return other.meaning == map.meaning; });
        if (is_second) return input_words(map.file) + " is a second map of normals: --with NAME=FILE names it otherwise";
        maps.push_back(map);
    }
    return {};
}

std::string spread_weights(const std::vector<double>& weights, const std::vector<Map>& maps, const ImageFile& joined,
                           std::vector<double>& spread) {
    const auto channels = static_cast<std::size_t>(joined.channels - joined.padding);
    const std::size_t images = std::max<std::size_t>(1, maps.size());
    spread.clear();
    if (weights.empty() && joined.padding == 0) return {};
    if (weights.empty()) {
        spread.assign(channels, 1);
    } else if (weights.size() == channels) {
        spread = weights;
    } else if (weights.size() == images) {
        for (std::size_t i = 0; i < images; ++i)
            spread.insert(spread.end(), maps.empty() ? channels : static_cast<std::size_t>(maps[i].channels), weights[i]);
    } else {
        return "--channel-weights has " + std::to_string(weights.size()) + " numbers, for " + std::to_string(images) +
               (images == 1 ? " image" : " images") + " of " + std::to_string(channels) + " channels together";
    }
    spread.resize(static_cast<std::size_t>(joined.channels), 0);
    return {};
}

void balance_maps(const ImageFile& joined, MeshingOptions options, const hmesh::ParallelFor& parallel_for,
                  std::vector<Map>& maps) {
    constexpr int rounds = 3;
    constexpr double most = 100;    // dB, of a map that is exact
    constexpr double least = 1e-4;  // of the largest: 16 bits keep a hundredth of their steps for such a map
    options.effort = hmesh::Effort::draft;
    options.levels = 1;
    for (int round = 0; round < rounds; ++round) {
        std::vector<double> weights;
        weights.reserve(maps.size());
        for (const Map& map : maps) weights.push_back(map.weight);
        if (!spread_weights(weights, maps, joined, options.channel_weights).empty()) return;
        const hmesh::Result trial = mesh_file(joined, options, parallel_for);
        if (!trial.status) return;
        measure_maps(trial.mesh, joined, options.weights, maps);
        double largest = 0;
        for (Map& map : maps) {
            map.weight = std::pow(10, std::min(most, map.psnr) / 10) / map.channels;
            largest = std::max(largest, map.weight);
        }
        for (Map& map : maps) map.weight = std::max(least, map.weight / largest);
    }
}

std::vector<hmesh::ChannelGroup> groups_of(const std::vector<Map>& maps) {
    std::vector<hmesh::ChannelGroup> groups;
    groups.reserve(maps.size());
    for (const Map& map : maps) groups.push_back({map.name.c_str(), map.meaning, map.channels});
    return groups;
}

hmesh::Mesh mesh_of(const Map& map, const hmesh::Mesh& mesh) {
    hmesh::Mesh part;
    part.positions = mesh.positions;
    part.faces = mesh.faces;
    part.channels = map.channels;
    part.width = mesh.width, part.height = mesh.height;
    part.periodic = mesh.periodic, part.samples = mesh.samples;
    part.peak = mesh.peak;
    const auto all = static_cast<std::size_t>(mesh.channels);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const float* const color = mesh.colors.data() + all * v + map.first;
        part.colors.insert(part.colors.end(), color, color + map.channels);
    }
    return part;
}

void measure_maps(const hmesh::Mesh& mesh, const ImageFile& joined, const hmesh::ImageView<float, 1>& weights,
                  std::vector<Map>& maps) {
    const auto all = static_cast<std::size_t>(joined.channels);
    for (Map& map : maps) {
        std::vector<float> drawn;
        if (!draw_samples(mesh_of(map, mesh).view(), false, drawn)) continue;
        const auto channels = static_cast<std::size_t>(map.channels), first = static_cast<std::size_t>(map.first);
        std::vector<float> wanted(drawn.size());
        for (std::size_t i = 0; i < wanted.size(); ++i)
            wanted[i] = static_cast<float>(sample_of(joined, i / channels * all + first + i % channels));
        map.psnr = psnr_between(wanted, drawn, channels, mesh.peak, {weights, {}});
    }
}

}  // namespace tool
