/// \file
/// HeightSamples: the samples of a heightmap as exporters read them, of any type and any number of channels, to take normals
/// from.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_SAMPLES_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_SAMPLES_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// A non-owning view of samples of any type, read one by one. An ImageView becomes one by itself; {} stands for no samples.
///
/// The image may be larger than the mesh's, which then begins at the sample (column, row) of it: neighbouring tiles get the same
/// normals on their common border if each is given one sample more on each side where there is one (Samples::points; two with
/// Samples::squares), or all are given the whole map.
class HeightSamples {
  public:
    /// No samples.
    HeightSamples() = default;
    /// The samples of an image, of which the mesh's first is (first_column, first_row). Where the mask, which has the size of the
    /// image or is empty, is 0 there is no data; nor is there where a sample is NaN or infinite. Both must outlive this object.
    template <class T, int C>
    // NOLINTNEXTLINE(google-explicit-constructor): an ImageView may stand for its samples
    HeightSamples(const ImageView<T, C>& image, const ImageView<std::uint8_t, 1>& mask = {}, int first_column = 0,
                  int first_row = 0) noexcept
        : status_(check_both(image, mask)), mask_(mask), width_(image.width), height_(image.height), channels_(C),
          first_column_(first_column), first_row_(first_row) {
        if (!status_) return;
        first_ = reinterpret_cast<const unsigned char*>(image.data);
        stride_ = image.row_stride != 0 ? image.row_stride
                                        : static_cast<std::ptrdiff_t>(image.width) * C * static_cast<std::ptrdiff_t>(sizeof(T));
        read_ = [](const unsigned char* row, std::ptrdiff_t index) noexcept {
            return PixelTraits<T>::to_real(reinterpret_cast<const T*>(row)[index]);
        };
    }

    /// Whether there are none.
    [[nodiscard]] bool is_empty() const noexcept { return channels_ == 0; }
    /// Columns of the image.
    [[nodiscard]] int width() const noexcept { return width_; }
    /// Rows of the image.
    [[nodiscard]] int height() const noexcept { return height_; }
    /// The image's column of the mesh's first sample.
    [[nodiscard]] int first_column() const noexcept { return first_column_; }
    /// The image's row of the mesh's first sample.
    [[nodiscard]] int first_row() const noexcept { return first_row_; }

    /// The sample in a column and a row of the image, both inside, as stored: NaN or infinite where there is no data.
    [[nodiscard]] double value(int column, int row, int channel) const noexcept {
        if (mask_.data != nullptr && *mask_.pixel(column, row) == 0) return kit::detail::nan();
        return read_(first_ + stride_ * row, static_cast<std::ptrdiff_t>(column) * channels_ + channel);
    }

    /// Whether they have this channel and all of the mesh's samples; true of no samples. Otherwise invalid_argument or what
    /// check() says of an image.
    [[nodiscard]] Status check_for(const MeshView& mesh, int channel) const noexcept {
        if (is_empty()) return {};
        if (!status_) return status_;
        if (channel >= channels_)
            return {Errc::invalid_argument, "the channel of heights must be one of the samples'", channel, channels_ - 1};
        if (first_column_ < 0 || first_row_ < 0)
            return {Errc::invalid_argument, "the mesh's first sample must be one of the samples given",
                    first_column_ < 0 ? first_column_ : first_row_, 0};
        if (mesh.width > width_ - first_column_)
            return {Errc::invalid_argument, "the mesh has more columns of samples than are given", mesh.width,
                    width_ - first_column_};
        if (mesh.height > height_ - first_row_)
            return {Errc::invalid_argument, "the mesh has more rows of samples than are given", mesh.height,
                    height_ - first_row_};
        return {};
    }

  private:
    template <class T, int C>
    [[nodiscard]] static Status check_both(const ImageView<T, C>& image, const ImageView<std::uint8_t, 1>& mask) noexcept {
        if (const Status status = check(image); !status) return status;
        if (mask.data == nullptr) return {};
        if (mask.width != image.width)
            return {Errc::invalid_argument, "the mask must be as wide as the samples", mask.width, image.width};
        if (mask.height != image.height)
            return {Errc::invalid_argument, "the mask must be as high as the samples", mask.height, image.height};
        return check(mask);
    }

    Status status_;
    const unsigned char* first_ = nullptr;
    std::ptrdiff_t stride_ = 0;
    double (*read_)(const unsigned char* row, std::ptrdiff_t index) noexcept = nullptr;
    ImageView<std::uint8_t, 1> mask_;
    int width_ = 0, height_ = 0, channels_ = 0, first_column_ = 0, first_row_ = 0;
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_SAMPLES_HPP
