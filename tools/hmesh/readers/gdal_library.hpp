// GDAL's functions, which are loaded when there is a file for them.
//
// GDAL comes with a hundred libraries, which take 40 to 80 ms to load: runs without such a file do without. Where there is no
// dlopen() the program is linked with it.
#pragma once

#ifdef HMESH_HAS_GDAL
#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <cstdint>
#include <string>

namespace tool {

// Each by its own name, of the type that its header gives it.
#define HMESH_GDAL_FUNCTIONS(DO)          \
    DO(CPLErrorReset);                    \
    DO(CPLGetLastErrorMsg);               \
    DO(CPLQuietErrorHandler);             \
    DO(CPLSetErrorHandler);               \
    DO(GDALAllRegister);                  \
    DO(GDALClose);                        \
    DO(GDALDataTypeIsComplex);            \
    DO(GDALDatasetRasterIO);              \
    DO(GDALGetCacheMax64);                \
    DO(GDALGetDataTypeName);              \
    DO(GDALGetDatasetDriver);             \
    DO(GDALGetDriverShortName);           \
    DO(GDALGetGeoTransform);              \
    DO(GDALGetMaskBand);                  \
    DO(GDALGetMaskFlags);                 \
    DO(GDALGetRasterBand);                \
    DO(GDALGetRasterColorInterpretation); \
    DO(GDALGetRasterCount);               \
    DO(GDALGetRasterDataType);            \
    DO(GDALGetRasterNoDataValue);         \
    DO(GDALGetRasterOffset);              \
    DO(GDALGetRasterScale);               \
    DO(GDALGetRasterXSize);               \
    DO(GDALGetRasterYSize);               \
    DO(GDALGetSpatialRef);                \
    DO(GDALOpenEx);                       \
    DO(GDALRasterIO);                     \
    DO(GDALSetCacheMax64);                \
    DO(GDALVersionInfo);                  \
    DO(OSRExportToWkt);                   \
    DO(OSRGetAngularUnits);               \
    DO(OSRGetInvFlattening);              \
    DO(OSRGetLinearUnits);                \
    DO(OSRGetSemiMajor);                  \
    DO(OSRIsGeographic);                  \
    DO(VSIFree);

struct GdalLibrary {
#define HMESH_GDAL_MEMBER(NAME) decltype(&::NAME) NAME = nullptr  // NOLINT(bugprone-macro-parentheses): it declares a name
    HMESH_GDAL_FUNCTIONS(HMESH_GDAL_MEMBER)
#undef HMESH_GDAL_MEMBER

    // Opens a file of rasters, with options of its driver that end in a null; null: it could not.
    [[nodiscard]] GDALDatasetH open(const std::string& path, const char* const* options = nullptr) const;
    // Its last words on one line, for the end of a sentence.
    [[nodiscard]] std::string last_error(const char* otherwise) const;
    // Lets it keep so many bytes of what it has decoded, up to a gigabyte: what is read by rows is read again and again.
    void keep_bytes(std::int64_t bytes) const;
    std::string why;  // what is wrong with it: nothing else may be used then; "": nothing
};

// The library, quiet and ready. It is loaded by the first call.
[[nodiscard]] const GdalLibrary& gdal();

}  // namespace tool
#endif
