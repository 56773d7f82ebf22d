// What GDAL reads and no reader of ours does, as JPEG 2000 and mosaics in VRT files, by rectangles: 1 to 4 bands of 8 or 16 bits
// or floats.
//
// GDAL comes with a hundred libraries, which take 80 ms to load: so it is loaded when there is such a file, and by no other run.
#include "readers/rectangles.hpp"

#ifdef HMESH_GDAL_LIBRARY
#include <cpl_error.h>
#include <dlfcn.h>
#include <gdal.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>

#include "hmesh/core/status.hpp"
#include "hmesh/image/image_reader.hpp"
#include "readers/image_file.hpp"
#include "terminal/words.hpp"
#endif

namespace tool {

#ifdef HMESH_GDAL_LIBRARY

namespace {

// Its functions, of the types that its headers give them.
struct Gdal {
    decltype(&GDALAllRegister) register_all = nullptr;
    decltype(&GDALOpenEx) open = nullptr;
    decltype(&GDALClose) close = nullptr;
    decltype(&GDALGetRasterCount) bands = nullptr;
    decltype(&GDALGetRasterXSize) width = nullptr;
    decltype(&GDALGetRasterYSize) height = nullptr;
    decltype(&GDALGetRasterBand) band = nullptr;
    decltype(&GDALGetRasterDataType) type = nullptr;
    decltype(&GDALGetDataTypeName) name_of_type = nullptr;
    decltype(&GDALGetRasterColorInterpretation) meaning = nullptr;
    decltype(&GDALDatasetRasterIO) read = nullptr;
    decltype(&GDALGetCacheMax64) cache = nullptr;
    decltype(&GDALSetCacheMax64) set_cache = nullptr;
    decltype(&CPLErrorReset) reset_error = nullptr;
    decltype(&CPLGetLastErrorMsg) error = nullptr;
    decltype(&CPLSetErrorHandler) set_error_handler = nullptr;
    decltype(&CPLQuietErrorHandler) be_quiet = nullptr;

    // Returns "" or what is wrong.
    [[nodiscard]] std::string load() {
        void* const library = dlopen(HMESH_GDAL_LIBRARY, RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr) return "GDAL, which reads others, is not here: " HMESH_GDAL_LIBRARY;
        bool is_whole = true;
        const auto take = [&](const char* name, auto& function) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
            is_whole = is_whole && function != nullptr;
        };
        take("GDALAllRegister", register_all);
        take("GDALOpenEx", open);
        take("GDALClose", close);
        take("GDALGetRasterCount", bands);
        take("GDALGetRasterXSize", width);
        take("GDALGetRasterYSize", height);
        take("GDALGetRasterBand", band);
        take("GDALGetRasterDataType", type);
        take("GDALGetDataTypeName", name_of_type);
        take("GDALGetRasterColorInterpretation", meaning);
        take("GDALDatasetRasterIO", read);
        take("GDALGetCacheMax64", cache);
        take("GDALSetCacheMax64", set_cache);
        take("CPLErrorReset", reset_error);
        take("CPLGetLastErrorMsg", error);
        take("CPLSetErrorHandler", set_error_handler);
        take("CPLQuietErrorHandler", be_quiet);
        if (!is_whole) return "GDAL, which reads others, is another one than this program was built with";
        register_all();
        set_error_handler(be_quiet);
        return {};
    }
    // Its words on one line, for the end of a sentence.
    [[nodiscard]] std::string last_error(const char* otherwise) const {
        std::string text = error();
        std::replace(text.begin(), text.end(), '\n', ' ');
        std::replace(text.begin(), text.end(), '\r', ' ');
        return text.empty() ? otherwise : "GDAL says: " + text;
    }
};

class GdalFile : public RectangleFile {
  public:
    ~GdalFile() override {
        if (file_ != nullptr) static_cast<void>(gdal_.close(file_));
    }

    [[nodiscard]] std::string open(const std::string& path, ImageFile& image) {
        if (std::string why = gdal_.load(); !why.empty()) return why;
        gdal_.reset_error();
        file_ = gdal_.open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr);
        if (file_ == nullptr) return gdal_.last_error("GDAL reads no such file");
        channels_ = gdal_.bands(file_);
        if (channels_ < 1 || channels_ > 4)
            return "it has " + std::to_string(channels_) + " bands, and images have 1 to 4: gdal_translate -b takes some of them";
        type_ = gdal_.type(gdal_.band(file_, 1));
        if (type_ != GDT_Byte && type_ != GDT_UInt16 && type_ != GDT_Float32)
            return std::string("its samples are ") + gdal_.name_of_type(type_) +
                   ", and those of images Byte, UInt16 or Float32: gdal_translate -ot makes them so";
        for (int k = 1; k <= channels_; ++k) {
            const GDALRasterBandH band = gdal_.band(file_, k);
            if (gdal_.type(band) != type_) return "its bands are of several types: gdal_translate -ot makes them of one";
            if (gdal_.meaning(band) == GCI_PaletteIndex)
                return "its samples are numbers of a palette: gdal_translate -expand rgb makes colours of them";
        }
        image = {};
        image.width = gdal_.width(file_);
        image.height = gdal_.height(file_);
        image.channels = channels_;
        image.bits = type_ == GDT_Byte ? 8 : type_ == GDT_UInt16 ? 16 : 32;
        const auto none = [](const hmesh::kit::Rect&, std::uint8_t*, std::ptrdiff_t) { return false; };
        if (const hmesh::Status status = check(hmesh::ImageReader<std::uint8_t, 1>{image.width, image.height, none}); !status)
            return in_words(status);
        // What it decoded of a row of tiles, which reads it again and again.
        constexpr std::int64_t rows = 1024, most = std::int64_t{1} << 30U;
        const std::int64_t needs = rows * image.width * channels_ * (image.bits / 8);
        gdal_.set_cache(std::max<std::int64_t>(gdal_.cache(), std::min(needs, most)));
        return {};
    }

    bool read(const hmesh::kit::Rect& rect, void* samples, std::ptrdiff_t row_stride) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!why_.empty()) return false;
        std::array<int, 4> bands = {1, 2, 3, 4};
        const int size = type_ == GDT_Byte ? 1 : type_ == GDT_UInt16 ? 2 : 4;
        gdal_.reset_error();
        if (gdal_.read(file_, GF_Read, rect.x, rect.y, rect.width, rect.height, samples, rect.width, rect.height, type_,
                       channels_, bands.data(), size * channels_, static_cast<int>(row_stride), size) != CE_None)
            why_ = gdal_.last_error("GDAL cannot read its samples");
        return why_.empty();
    }
    [[nodiscard]] std::string why() const override { return why_; }

  private:
    Gdal gdal_;
    GDALDatasetH file_ = nullptr;
    int channels_ = 0;
    GDALDataType type_ = GDT_Unknown;
    std::mutex mutex_;
    std::string why_;
};

}  // namespace

std::string open_gdal_rectangles(const std::string& path, ImageFile& image) {
    auto file = std::make_shared<GdalFile>();
    if (std::string why = file->open(path, image); !why.empty()) return why;
    image.rectangles = std::move(file);
    return {};
}

std::string rectangle_decoder() { return "GDAL " GDAL_RELEASE_NAME; }

#else

std::string open_gdal_rectangles(const std::string& /*path*/, ImageFile& /*image*/) {
    return "others are not read by rectangles";
}

std::string rectangle_decoder() { return {}; }

#endif

}  // namespace tool
