// What GDAL reads and no reader of ours does, as JPEG 2000 and mosaics in VRT files, by rectangles: 1 to 4 bands of 8 or 16 bits
// or floats.
#include "readers/rectangles.hpp"

#ifdef HMESH_HAS_GDAL
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "hmesh/core/status.hpp"
#include "hmesh/image/image_reader.hpp"
#include "readers/gdal_library.hpp"
#include "readers/image_file.hpp"
#include "terminal/words.hpp"
#endif

namespace tool {

#ifdef HMESH_HAS_GDAL

namespace {

class GdalFile : public RectangleFile {
  public:
    ~GdalFile() override {
        if (file_ != nullptr) static_cast<void>(gdal().GDALClose(file_));
    }

    [[nodiscard]] std::string open(const std::string& path, ImageFile& image) {
        const GdalLibrary& library = gdal();
        if (!library.why.empty()) return library.why;
        file_ = library.open(path);
        if (file_ == nullptr) return library.last_error("GDAL reads no such file");
        channels_ = library.GDALGetRasterCount(file_);
        if (channels_ < 1 || channels_ > 4)
            return "it has " + std::to_string(channels_) + " bands, and images have 1 to 4: gdal_translate -b takes some of them";
        type_ = library.GDALGetRasterDataType(library.GDALGetRasterBand(file_, 1));
        if (type_ != GDT_Byte && type_ != GDT_UInt16 && type_ != GDT_Float32)
            return std::string("its samples are ") + library.GDALGetDataTypeName(type_) +
                   ", and those of images Byte, UInt16 or Float32: gdal_translate -ot makes them so";
        for (int k = 1; k <= channels_; ++k) {
            const GDALRasterBandH band = library.GDALGetRasterBand(file_, k);
            if (library.GDALGetRasterDataType(band) != type_)
                return "its bands are of several types: gdal_translate -ot makes them of one";
            const GDALColorInterp meaning = library.GDALGetRasterColorInterpretation(band);
            if (meaning >= GCI_CyanBand && meaning <= GCI_BlackBand) return "its bands are inks, and those of images light";
            if (meaning == GCI_PaletteIndex)
                return "its samples are numbers of a palette: gdal_translate -expand rgb makes colours of them";
        }
        // Near infrared, say, is no alpha: left out, as of TIFF files.
        if (channels_ % 2 == 0 &&
            library.GDALGetRasterColorInterpretation(library.GDALGetRasterBand(file_, channels_)) != GCI_AlphaBand)
            --channels_;
        image = {};
        image.width = library.GDALGetRasterXSize(file_);
        image.height = library.GDALGetRasterYSize(file_);
        image.channels = channels_;
        image.bits = type_ == GDT_Byte ? 8 : type_ == GDT_UInt16 ? 16 : 32;
        const auto none = [](const hmesh::kit::Rect&, std::uint8_t*, std::ptrdiff_t) { return false; };
        if (const hmesh::Status status = check(hmesh::ImageReader<std::uint8_t, 1>{image.width, image.height, none}); !status)
            return in_words(status);
        // What it decoded of a row of tiles, which reads it again and again.
        library.keep_bytes(std::int64_t{1024} * image.width * channels_ * (image.bits / 8));
        return {};
    }

    bool read(const hmesh::kit::Rect& rect, void* samples, std::ptrdiff_t row_stride) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!why_.empty()) return false;
        std::array<int, 4> bands = {1, 2, 3, 4};
        const int size = type_ == GDT_Byte ? 1 : type_ == GDT_UInt16 ? 2 : 4;
        const GdalLibrary& library = gdal();
        library.CPLErrorReset();
        if (library.GDALDatasetRasterIO(file_, GF_Read, rect.x, rect.y, rect.width, rect.height, samples, rect.width, rect.height,
                                        type_, channels_, bands.data(), size * channels_, static_cast<int>(row_stride),
                                        size) != CE_None)
            why_ = library.last_error("GDAL cannot read its samples");
        return why_.empty();
    }
    [[nodiscard]] std::string why() const override { return why_; }

  private:
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
