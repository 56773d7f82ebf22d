#include "readers/rectangles.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_reader.hpp"
#include "readers/file_at.hpp"
#include "readers/image_file.hpp"
#include "readers/plain_layout.hpp"
#include "readers/readers.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"

namespace tool {
namespace {

class PlainFile : public RectangleFile {
  public:
    // Opens a file. Returns "" or what is wrong; `kind`: which one it is, by its first bytes.
    [[nodiscard]] std::string open(const std::string& path, FileKind& kind) {
        if (std::string why = file_.open(path); !why.empty()) return why;
        std::vector<unsigned char> beginning(static_cast<std::size_t>(std::min<std::uint64_t>(file_.size(), 65536)));
        if (std::string why = file_.read(0, beginning.size(), beginning.data()); !why.empty()) return why;
        const Bytes bytes{beginning.data(), beginning.size()};
        kind = kind_of(bytes);
        if (is_mesh(bytes)) return "it is a mesh, and no image";
        if (kind == FileKind::tiff || kind == FileKind::unknown) return {};
        if (kind != FileKind::pnm && kind != FileKind::pfm)
            return std::string("it is no PGM, PPM, PFM or TIFF file, but ") + name_of(kind) + ", which is not read by rectangles";
        if (std::string why = kind == FileKind::pnm ? read_pnm_layout(bytes, layout_) : read_pfm_layout(bytes, layout_);
            !why.empty())
            return why;
        const auto none = [](const hmesh::kit::Rect&, std::uint8_t*, std::ptrdiff_t) { return false; };
        const hmesh::ImageReader<std::uint8_t, 1> reader{layout_.width, layout_.height, none};
        if (const hmesh::Status status = check(reader); !status) return in_words(status);
        const std::uint64_t needs =
            layout_.first + std::uint64_t{layout_.row_bytes()} * static_cast<std::uint64_t>(layout_.height);
        return file_.size() < needs ? too_short(file_.size(), needs) : "";
    }
    [[nodiscard]] const PlainLayout& layout() const noexcept { return layout_; }

    bool read(const hmesh::kit::Rect& rect, void* samples, std::ptrdiff_t row_stride) override {
        const std::size_t pixel = layout_.sample_bytes * static_cast<std::size_t>(layout_.channels);
        const std::size_t size = static_cast<std::size_t>(rect.width) * pixel, from = static_cast<std::size_t>(rect.x) * pixel;
        const bool in_bands = 2 * rect.width < layout_.width && narrow_.fetch_add(1) >= first_in_bands;
        std::vector<unsigned char> bytes(in_bands ? 0 : size);
        BandInUse band(*this);
        for (int j = 0; j < rect.height; ++j) {
            const int y = layout_.is_bottom_up ? layout_.height - 1 - (rect.y + j) : rect.y + j;
            const unsigned char* row = bytes.data();
            std::string why;
            if (in_bands) {
                why = band.turn_to(y / band_rows);
                if (why.empty()) row = band.bytes() + static_cast<std::size_t>(y % band_rows) * layout_.row_bytes() + from;
            } else {
                why = file_.read(place_of(y) + from, size, bytes.data());
            }
            if (why.empty())
                why = take_samples(layout_, row, size / layout_.sample_bytes,
                                   static_cast<unsigned char*>(samples) + j * row_stride);
            if (!why.empty()) return fail(why);
        }
        return true;
    }
    [[nodiscard]] std::string why() const override { return why_; }

  private:
    // Some rows as they stand in the file, as wide as the image. A row of tiles reads the same rows piece by piece, and each
    // piece of a row would be a call of the system's: with bands these take 0.4 of the time. What reads a tile or two, as tasks
    // of a job do, reads no more than these.
    struct Band {
        int number = -1, users = 0;
        hmesh::kit::Array<unsigned char> bytes;  // in large pages: a tile takes a piece of each of its rows
    };
    // A band that is not read over while it is looked at.
    class BandInUse {
      public:
        explicit BandInUse(PlainFile& file) noexcept : file_(&file) {}
        BandInUse(const BandInUse&) = delete;
        BandInUse& operator=(const BandInUse&) = delete;
        ~BandInUse() { file_->leave(band_); }
        // Looks at this one. Returns "" or why it could not be read.
        [[nodiscard]] std::string turn_to(int number) {
            if (band_ != nullptr && band_->number == number) return {};
            file_->leave(band_);
            return file_->enter(number, band_);
        }
        [[nodiscard]] const unsigned char* bytes() const noexcept { return band_->bytes.data(); }

      private:
        PlainFile* file_;
        Band* band_ = nullptr;
    };
    static constexpr int band_rows = 64, first_in_bands = 8;
    static constexpr std::size_t most_bands = 16;  // of two rows of tiles

    [[nodiscard]] std::uint64_t place_of(int y) const noexcept {
        return layout_.first + std::uint64_t{layout_.row_bytes()} * static_cast<std::uint64_t>(y);
    }

    // Memory of bands is used again: new memory costs as much as reading into it, as the system hands it out in cleared pages.
    [[nodiscard]] std::string enter(int number, Band*& band) {
        band = nullptr;
        const std::lock_guard<std::mutex> lock(mutex_);
        auto at = std::find_if(bands_.begin(), bands_.end(), [&](const auto& known) { return known->number == number; });
        if (at == bands_.end()) {
            if (bands_.size() >= most_bands)
                at = std::find_if(bands_.begin(), bands_.end(), [](const auto& known) { return known->users == 0; });
            if (at == bands_.end()) at = bands_.insert(at, std::make_unique<Band>());
            Band& read = **at;
            read.number = -1;  // what is there now goes
            const auto rows = static_cast<std::size_t>(std::min(band_rows, layout_.height - number * band_rows));
            read.bytes.resize_raw(rows * layout_.row_bytes());
            if (std::string why = file_.read(place_of(number * band_rows), read.bytes.size(), read.bytes.data()); !why.empty())
                return why;
            read.number = number;
        }
        std::rotate(at, at + 1, bands_.end());  // the last one used is the last
        band = bands_.back().get();
        ++band->users;
        return {};
    }
    void leave(Band* band) noexcept {
        if (band == nullptr) return;
        const std::lock_guard<std::mutex> lock(mutex_);
        --band->users;
    }

    bool fail(const std::string& why) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (why_.empty()) why_ = why;
        return false;
    }

    FileAt file_;
    PlainLayout layout_;
    std::atomic<int> narrow_{0};  // rectangles of less than half the image's width, so far
    std::mutex mutex_;
    std::vector<std::unique_ptr<Band>> bands_;
    std::string why_;
};

}  // namespace

std::string open_rectangles(const std::string& path, ImageFile& image) {
    if (is_standard(path)) return "it cannot be read by rectangles, as a file can";
    auto file = std::make_shared<PlainFile>();
    FileKind kind = FileKind::unknown;
    if (std::string why = file->open(path, kind); !why.empty()) return why;
    if (kind == FileKind::tiff) return open_tiff_rectangles(path, image);
    if (kind == FileKind::unknown) {
        const std::string why = open_gdal_rectangles(path, image);
        return why.empty() ? "" : "it is no PGM, PPM, PFM or TIFF file, and " + why;
    }
    image = {};
    image.width = file->layout().width;
    image.height = file->layout().height;
    image.channels = file->layout().channels;
    image.bits = file->layout().bits();
    image.rectangles = std::move(file);
    return {};
}

}  // namespace tool
