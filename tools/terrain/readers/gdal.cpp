// Whatever GDAL reads.
//
// GDAL's geotransform is that of the corner of the first sample's area, by its convention and whatever the file's: of a GeoTIFF
// of points (AREA_OR_POINT) it is moved by half a sample. So samples stand at the centres of these areas in any case.
#include "terrain/readers/readers.hpp"

#ifdef HMESH_HAS_GDAL
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "readers/gdal_library.hpp"
#include "terrain/readers/grid_file.hpp"
#include "writers/ending.hpp"
#endif

namespace terrain {

#ifdef HMESH_HAS_GDAL

namespace {

using tool::gdal;

struct Close {
    void operator()(void* dataset) const noexcept { static_cast<void>(gdal().GDALClose(dataset)); }
};

class GdalDem : public Dem {
  public:
    [[nodiscard]] std::string open(const std::string& path, const ReadOptions& options);
    [[nodiscard]] std::string read(int x, int y, int columns, int rows, float* heights, double& rounding) override;

  private:
    [[nodiscard]] std::string find_place();
    void find_crs();
    // A row of the file as doubles or floats, the row after it next.
    template <class T>
    [[nodiscard]] bool read_row(GDALRasterBandH band, GDALDataType type, int x, int j, std::vector<T>& row) {
        const int line = is_south_up_ ? height - 1 - j : j;
        return gdal().GDALRasterIO(band, GF_Read, x, line, static_cast<int>(row.size()), 1, row.data(),
                                   static_cast<int>(row.size()), 1, type, 0, 0) == CE_None;
    }

    std::unique_ptr<void, Close> dataset_;
    GDALRasterBandH band_ = nullptr, mask_ = nullptr;  // mask_: 0 where there is no data; null: not asked
    bool is_south_up_ = false, is_text_ = false;
};

std::string GdalDem::open(const std::string& path, const ReadOptions& options) {
    if (!gdal().why.empty()) return gdal().why;
    // Of text GDAL makes floats or 32-bit numbers, unless it is told otherwise, and what does not fit in is no longer seen.
    const char* const as_doubles[] = {"DATATYPE=Float64", nullptr};
    is_text_ = tool::has_ending(path, ".asc");
    dataset_.reset(gdal().open(path, is_text_ ? as_doubles : nullptr));
    if (!dataset_) return gdal().last_error("GDAL reads no such file");
    const int bands = gdal().GDALGetRasterCount(dataset_.get());
    const bool has_alpha =
        bands == 2 && gdal().GDALGetRasterColorInterpretation(gdal().GDALGetRasterBand(dataset_.get(), 2)) == GCI_AlphaBand;
    if (bands < 1) return "it has no raster, but perhaps others in it: gdalinfo lists them";
    if (bands > 1 && !has_alpha)
        return "it has " + std::to_string(bands) + " bands, and heights are one: gdal_translate -b takes one of them";
    band_ = gdal().GDALGetRasterBand(dataset_.get(), 1);
    const GDALDataType type = gdal().GDALGetRasterDataType(band_);
    if (gdal().GDALDataTypeIsComplex(type) != 0) return "its samples are complex numbers, and heights are real";
    if (gdal().GDALGetRasterColorInterpretation(band_) == GCI_PaletteIndex) return no_palette;
    width = gdal().GDALGetRasterXSize(dataset_.get());
    height = gdal().GDALGetRasterYSize(dataset_.get());
    reader = std::string("GDAL ") + gdal().GDALVersionInfo("RELEASE_NAME") + ", " +
             gdal().GDALGetDriverShortName(gdal().GDALGetDatasetDriver(dataset_.get()));
    int has = 0;
    if (const double value = gdal().GDALGetRasterNoDataValue(band_, &has); has != 0) no_data = value;
    if (options.no_data) no_data = options.no_data;
    else if (const int flags = gdal().GDALGetMaskFlags(band_); (flags & GMF_ALL_VALID) == 0) {
        mask_ = gdal().GDALGetMaskBand(band_);
        has_mask = (flags & GMF_NODATA) == 0;
    }
    height_scale = gdal().GDALGetRasterScale(band_, &has);
    if (has == 0) height_scale = 1;
    height_offset = gdal().GDALGetRasterOffset(band_, &has);
    if (has == 0) height_offset = 0;
    if (!std::isfinite(height_scale) || !std::isfinite(height_offset) || height_scale == 0)
        return "its scale of heights is 0 or not finite";
    if (std::string why = find_place(); !why.empty()) return why;
    // GDAL reads no .prj of version 2 of well-known text, and of such an .asc would know no coordinate system.
    if (is_text_ && place.is_known && place.crs.empty() && !read_prj(path, place).empty()) place.crs.clear();
    return {};
}

std::string GdalDem::find_place() {
    double t[6] = {};
    if (gdal().GDALGetGeoTransform(dataset_.get(), t) != CE_None) return {};
    for (const double number : t)
        if (!std::isfinite(number)) return "its geotransform is not finite";
    if (t[2] != 0 || t[4] != 0) return "its rows are turned against the axes of its map: gdalwarp lays them along";
    if (!(t[1] > 0) || t[5] == 0) return "its columns do not run to the east: gdalwarp makes them do so";
    is_south_up_ = t[5] > 0;
    const double first = is_south_up_ ? height - 0.5 : 0.5;
    place.is_known = true;
    place.transform = {t[0] + 0.5 * t[1], t[1], 0, t[3] + first * t[5], 0, -std::fabs(t[5])};
    find_crs();
    return {};
}

void GdalDem::find_crs() {
    OGRSpatialReferenceH crs = gdal().GDALGetSpatialRef(dataset_.get());
    if (crs == nullptr) return;
    char* text = nullptr;
    if (gdal().OSRExportToWkt(crs, &text) == OGRERR_NONE && text != nullptr) place.crs = text;
    gdal().VSIFree(text);
    OGRErr error = OGRERR_NONE;
    const double axis = gdal().OSRGetSemiMajor(crs, &error);
    if (error == OGRERR_NONE && axis > 0) place.semi_major = axis;
    const double flattening = gdal().OSRGetInvFlattening(crs, &error);
    if (error == OGRERR_NONE && flattening >= 0) place.inverse_flattening = flattening;
    place.is_geographic = gdal().OSRIsGeographic(crs) != 0;
    if (place.is_geographic) {
        place.make_degrees(gdal().OSRGetAngularUnits(crs, nullptr));
    } else if (const double metres = gdal().OSRGetLinearUnits(crs, nullptr); metres > 0) {
        place.unit = metres;
    }
}

std::string GdalDem::read(int x, int y, int columns, int rows, float* heights, double& rounding) {
    gdal().CPLErrorReset();
    rounding = 0;
    const GDALDataType type = gdal().GDALGetRasterDataType(band_);
    const bool is_exact = (type == GDT_Byte || type == GDT_UInt16 || type == GDT_Int16 || type == GDT_Float32) &&
                          height_scale == 1 && height_offset == 0;
    std::vector<float> single(is_exact ? static_cast<std::size_t>(columns) : 0);
    std::vector<double> twice(is_exact ? 0 : static_cast<std::size_t>(columns));
    std::vector<unsigned char> mask(mask_ != nullptr ? static_cast<std::size_t>(columns) : 0);
    for (int j = y; j < y + rows; ++j) {
        const bool is_read = is_exact ? read_row(band_, GDT_Float32, x, j, single) : read_row(band_, GDT_Float64, x, j, twice);
        if (!is_read || (mask_ != nullptr && !read_row(mask_, GDT_Byte, x, j, mask)))
            return gdal().last_error("GDAL cannot read its samples");
        for (std::size_t k = 0; k < static_cast<std::size_t>(columns); ++k) {
            const double stored = is_exact ? static_cast<double>(single[k]) : twice[k];
            const double value = is_exact ? stored : height_scale * stored + height_offset;
            const auto rounded = static_cast<float>(value);
            const bool is_masked = mask_ != nullptr && mask[k] == 0;
            const bool is_none = is_masked || ((mask_ == nullptr || is_text_) && is_no_data(stored, no_data));
            const bool is_height = !is_none && std::isfinite(rounded);
            *heights++ = is_height ? rounded : std::numeric_limits<float>::quiet_NaN();
            if (is_height) rounding = std::max(rounding, std::fabs(value - static_cast<double>(rounded)));
        }
    }
    return {};
}

}  // namespace

std::string open_gdal(const std::string& path, const ReadOptions& options, DemPointer& dem) {
    auto file = std::make_unique<GdalDem>();
    if (std::string why = file->open(path, options); !why.empty()) return why;
    // A row of tiles reads the same rows of samples again and again, which may have to be decoded whole.
    if (options.rows > 0) gdal().keep_bytes(std::int64_t{8} * file->width * (options.rows + 3));
    dem = std::move(file);
    return {};
}

std::string gdal_version() { return "GDAL " GDAL_RELEASE_NAME; }

#else

std::string open_gdal(const std::string& /*path*/, const ReadOptions& /*options*/, DemPointer& /*dem*/) {
    return "this hmesh-terrain was built without GDAL";
}

std::string gdal_version() { return {}; }

#endif

}  // namespace terrain
