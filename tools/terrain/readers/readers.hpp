// hmesh-terrain - the readers of elevation models, one a format: by GDAL where it is built with it, else these few.
//
// A reader opens a file and reads as much of it as it needs to know its size; heights are read from it as they are asked for. It
// returns "" or what is wrong, as the end of a sentence that begins with the file's name.
#ifndef HMESH_TERRAIN_READERS_READERS_HPP
#define HMESH_TERRAIN_READERS_READERS_HPP

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "terrain/dem.hpp"

namespace terrain {

enum class RawType : std::uint8_t { by_size, float32, int16, uint16 };

struct ReadOptions {
    std::optional<double> no_data;      // in place of the file's
    int raw_width = 0, raw_height = 0;  // of a file without a header; 0: it has one
    RawType raw_type = RawType::by_size;
    bool gdal = true;  // where it is there
    int rows = 0;      // of a tile: so many are read again for each tile beside it; 0: each once
};

using DemPointer = std::unique_ptr<Dem>;

// By the reader that knows the file.
[[nodiscard]] std::string open_dem(const std::string& path, const ReadOptions& options, DemPointer& dem);

[[nodiscard]] std::string open_gdal(const std::string& path, const ReadOptions& options, DemPointer& dem);
[[nodiscard]] std::string open_asc(const std::string& path, const ReadOptions& options, DemPointer& dem);
[[nodiscard]] std::string open_hgt(const std::string& path, const ReadOptions& options, DemPointer& dem);
[[nodiscard]] std::string open_pgm(const std::string& path, const ReadOptions& options, DemPointer& dem);
[[nodiscard]] std::string open_png(const std::string& path, const ReadOptions& options, DemPointer& dem);
[[nodiscard]] std::string open_raw(const std::string& path, const ReadOptions& options, DemPointer& dem);

// The coordinate system of NAME.prj beside NAME.asc, where there is one.
[[nodiscard]] std::string read_prj(std::string path, Georeference& place);

// What is said of samples that are numbers of colours.
inline constexpr char no_palette[] =
    "its samples are numbers of a palette, and no heights: gdal_translate -expand gray makes shades of grey of them";

// "GDAL 3.6.2"; empty: this build has none.
[[nodiscard]] std::string gdal_version();

// The WKT of WGS 84 in degrees, in which the Earth's models without a word about it are.
extern const char wgs84[];

}  // namespace terrain

#endif  // HMESH_TERRAIN_READERS_READERS_HPP
