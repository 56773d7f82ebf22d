#include "readers/bytes.hpp"
#include "readers/readers.hpp"
#include "terrain/readers/grid_file.hpp"
#include "terrain/readers/readers.hpp"
#include "writers/ending.hpp"

namespace terrain {

const char wgs84[] =
    "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],"
    "AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433],AUTHORITY[\"EPSG\",\"4326\"]]";

std::string open_dem(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    if (options.raw_width > 0) return open_raw(path, options, dem);
    if (options.gdal && !gdal_version().empty()) return open_gdal(path, options, dem);
    if (tool::has_ending(path, ".asc")) return open_asc(path, options, dem);
    if (tool::has_ending(path, ".hgt")) return open_hgt(path, options, dem);
    GridFile file;
    std::vector<unsigned char> beginning;
    if (std::string why = file.open(path); !why.empty()) return why;
    if (std::string why = file.begin(64, beginning); !why.empty()) return why;
    const tool::Bytes bytes{beginning.data(), beginning.size()};
    if (bytes.says(0, "P5")) return open_pgm(path, options, dem);
    if (tool::kind_of(bytes) == tool::FileKind::png) return open_png(path, options, dem);
    return std::string("it is none of .asc, .hgt, PGM and PNG, nor is it raw with its --size") +
           (gdal_version().empty() ? "; other formats need GDAL, which this hmesh-terrain was built without" : "");
}

}  // namespace terrain
