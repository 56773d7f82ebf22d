#include "readers/gdal_library.hpp"

#ifdef HMESH_HAS_GDAL
#include <algorithm>
#include <cstdint>
#ifdef HMESH_GDAL_LIBRARY
#include <dlfcn.h>
#endif

namespace tool {

namespace {

GdalLibrary load_gdal() {
    GdalLibrary out;
#ifdef HMESH_GDAL_LIBRARY
    void* const library = dlopen(HMESH_GDAL_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        out.why = "GDAL, which reads others, is not here: " HMESH_GDAL_LIBRARY;
        return out;
    }
    bool is_whole = true;
#define HMESH_GDAL_TAKE(NAME)                                              \
    out.NAME = reinterpret_cast<decltype(&::NAME)>(dlsym(library, #NAME)); \
    is_whole = is_whole && out.NAME != nullptr
    HMESH_GDAL_FUNCTIONS(HMESH_GDAL_TAKE)
#undef HMESH_GDAL_TAKE
    if (!is_whole) {
        out.why = "GDAL, which reads others, is another one than this program was built with";
        return out;
    }
#else
#define HMESH_GDAL_TAKE(NAME) out.NAME = &::NAME
    HMESH_GDAL_FUNCTIONS(HMESH_GDAL_TAKE)
#undef HMESH_GDAL_TAKE
#endif
    out.GDALAllRegister();
    out.CPLSetErrorHandler(out.CPLQuietErrorHandler);
    return out;
}

}  // namespace

const GdalLibrary& gdal() {
    static const GdalLibrary library = load_gdal();
    return library;
}

GDALDatasetH GdalLibrary::open(const std::string& path, const char* const* options) const {
    CPLErrorReset();
    return GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, nullptr, options, nullptr);
}

std::string GdalLibrary::last_error(const char* otherwise) const {
    std::string text = CPLGetLastErrorMsg();
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::replace(text.begin(), text.end(), '\r', ' ');
    return text.empty() ? otherwise : "GDAL says: " + text;
}

void GdalLibrary::keep_bytes(std::int64_t bytes) const {
    constexpr std::int64_t most = std::int64_t{1} << 30U;
    GDALSetCacheMax64(std::max<std::int64_t>(GDALGetCacheMax64(), std::min(bytes, most)));
}

}  // namespace tool
#endif
