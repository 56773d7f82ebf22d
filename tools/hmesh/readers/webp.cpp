// WebP files (RFC 9649), by libwebp; of animated ones the first frame, by libwebpdemux.
#include "readers/exif.hpp"
#include "readers/readers.hpp"

#ifdef HMESH_HAS_WEBP
#include <webp/decode.h>
#include <webp/demux.h>

#include <cstring>
#include <memory>
#endif

namespace tool {

#ifdef HMESH_HAS_WEBP

namespace {

unsigned webp_orientation(Bytes file) {
    for (std::size_t at = 12; file.has(at, 8); at += 8 + (std::size_t{file.le32(at + 4)} + 1) / 2 * 2)
        if (file.says(at, "EXIF")) {
            const Bytes exif = file.part(at + 8, file.le32(at + 4));
            return tiff_orientation(exif.says(0, "Exif\0\0") ? exif.part(6) : exif);
        }
    return 1;
}

std::string read_still(Bytes file, ImageFile& image) {
    const int stride = image.width * image.channels;
    std::uint8_t* const to = image.samples8.data();
    const std::uint8_t* done = image.channels == 4 ? WebPDecodeRGBAInto(file.data, file.size, to, image.samples8.size(), stride)
                                                   : WebPDecodeRGBInto(file.data, file.size, to, image.samples8.size(), stride);
    return done != nullptr ? "" : "libwebp refuses its pixels: they are damaged or cut off";
}

std::string read_first_frame(Bytes file, ImageFile& image) {
    WebPAnimDecoderOptions options;
    if (WebPAnimDecoderOptionsInit(&options) == 0) return "libwebpdemux is not the one that this hmesh was built with";
    options.color_mode = MODE_RGBA;
    const WebPData data{file.data, file.size};
    const std::unique_ptr<WebPAnimDecoder, void (*)(WebPAnimDecoder*)> decoder(WebPAnimDecoderNew(&data, &options),
                                                                               WebPAnimDecoderDelete);
    std::uint8_t* frame = nullptr;
    int time = 0;
    if (decoder == nullptr || WebPAnimDecoderGetNext(decoder.get(), &frame, &time) == 0)
        return "libwebp refuses its first frame: it is damaged or cut off";
    std::memcpy(image.samples8.data(), frame, image.samples8.size());
    image.note = "the file is animated: its first frame is taken";
    drop_opaque_alpha(image);
    return {};
}

}  // namespace

std::string read_webp(Bytes file, ImageFile& image) {
    const std::size_t needs = std::size_t{file.le32(4)} + 8;
    if (file.size < needs) return too_short(file.size, needs);
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(file.data, file.size, &features) != VP8_STATUS_OK) return "libwebp refuses its header";
    const int channels = features.has_alpha != 0 || features.has_animation != 0 ? 4 : 3;
    if (std::string why = start_image(image, features.width, features.height, channels, 8); !why.empty()) return why;
    const std::string why = features.has_animation != 0 ? read_first_frame(file, image) : read_still(file, image);
    if (why.empty()) turn_upright(webp_orientation(file), image);
    return why;
}

std::string webp_decoder() {
    const int version = WebPGetDecoderVersion();
    return "libwebp " + std::to_string(version >> 16) + "." + std::to_string(version >> 8 & 255) + "." +
           std::to_string(version & 255);
}

#else

std::string read_webp(Bytes /*file*/, ImageFile& /*image*/) {
    return "it is a WebP file, and this hmesh was built without libwebp";
}
std::string webp_decoder() { return {}; }

#endif

}  // namespace tool
