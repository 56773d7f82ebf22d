/// \file
/// The head of a compact file: what stands before the arithmetic code, in bytes. docs/compact.md has the table.
#ifndef HMESH_IO_COMPACT_CONTAINER_HPP
#define HMESH_IO_COMPACT_CONTAINER_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// How a compact file holds colours.
enum class CompactColors : std::uint8_t {
    bits8,   ///< shares of the peak in 255ths, held to [0, 1]
    bits16,  ///< in 65535ths
    floats,  ///< the very floats of the mesh
};

namespace detail {

/// What the head of a compact file says.
struct CompactHead {
    static constexpr std::uint32_t widest = std::uint32_t{1} << 25;  ///< side of a frame, in 1/256 px
    static constexpr std::uint32_t coarsest = 4095;                  ///< step of colours
    static constexpr int last_table = 6;                             ///< number of a start table

    int channels = 0;                                 ///< 1 to 4
    CompactColors colors = CompactColors::bits8;      ///< how colours are held
    bool premultiplied = false, linear = false;       ///< what they mean
    bool is_masked = false;                           ///< whether some faces are not shown
    Periodic periodic = Periodic::none;               ///< along which axes the mesh goes on
    Samples samples = Samples::squares;               ///< where samples stand
    int width = 0, height = 0;                        ///< px of the image
    double peak = 0;                                  ///< colour value of full intensity
    std::uint32_t step = 1;                           ///< of the lattice, in 1/256 px
    std::uint32_t color_step = 0;                     ///< 0: colours are exact; else that of CoarseColors
    int table = 0;                                    ///< number of the start table, 0: none
    std::int32_t left = 0, top = 0;                   ///< the frame, the rectangle that all faces fill, in 1/256 px
    std::uint32_t frame_width = 0, frame_height = 0;  ///< its size

    /// The peak of the images that have such colours, which is not said.
    [[nodiscard]] double usual_peak() const noexcept {
        return colors == CompactColors::bits8 ? 255 : colors == CompactColors::bits16 ? 65535 : 1;
    }
    /// The largest colour before steps.
    [[nodiscard]] std::uint32_t most_color() const noexcept {
        return colors == CompactColors::bits8 ? 255 : colors == CompactColors::bits16 ? 65535 : 0xffffffffU;
    }
    /// Makes the image's rectangle the frame.
    void frame_image() noexcept {
        left = top = 0;
        frame_width = static_cast<std::uint32_t>(kit::extent(width, samples)) * 256U;
        frame_height = static_cast<std::uint32_t>(kit::extent(height, samples)) * 256U;
    }
    /// Whether it is.
    [[nodiscard]] bool is_image_framed() const noexcept {
        CompactHead framed = *this;
        framed.frame_image();
        return left == 0 && top == 0 && frame_width == framed.frame_width && frame_height == framed.frame_height;
    }
    /// The sites of the lattice along a side of the frame beyond the first: their number.
    [[nodiscard]] static std::uint32_t sites(std::uint32_t side, std::uint32_t step) noexcept { return (side + step - 1) / step; }
};

/// The polynomial checksum of PNG, gzip and others (ISO 3309), of bytes after others whose checksum is `before`.
[[nodiscard]] inline std::uint32_t crc32(const std::uint8_t* bytes, std::size_t size, std::uint32_t before = 0) noexcept {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t k = 0; k < 256; ++k) {
        table[k] = k;
        for (int bit = 0; bit < 8; ++bit) table[k] = table[k] >> 1 ^ ((table[k] & 1U) != 0 ? 0xedb88320U : 0U);
    }
    std::uint32_t crc = ~before;
    for (std::size_t i = 0; i < size; ++i) crc = crc >> 8 ^ table[(crc ^ bytes[i]) & 0xffU];
    return ~crc;
}

inline constexpr std::array<std::uint8_t, 4> compact_magic{0x9d, 'H', 'M', 'C'};  ///< how files begin
inline constexpr std::uint8_t compact_version = 1;                                ///< of the format
inline constexpr std::size_t compact_checked = 14;  ///< bytes before those that say what the mesh is

/// Bytes that are read one after another, never behind their end.
class ByteReader {
  public:
    /// Of bytes that outlive it.
    ByteReader(const std::uint8_t* bytes, std::size_t size) noexcept : bytes_(bytes), size_(size) {}

    [[nodiscard]] bool has_failed() const noexcept { return has_failed_; }            ///< whether bytes lacked or are wrong
    [[nodiscard]] const std::uint8_t* next() const noexcept { return bytes_ + at_; }  ///< those not read yet
    [[nodiscard]] std::size_t left() const noexcept { return size_ - at_; }           ///< how many they are

    /// A byte, or 0 where there is none.
    std::uint8_t u8() noexcept {
        if (at_ < size_) return bytes_[at_++];
        has_failed_ = true;
        return 0;
    }
    /// An integer of 32 bits, the lowest byte first.
    std::uint32_t u32() noexcept {
        std::uint32_t value = 0;
        for (int k = 0; k < 4; ++k) value |= std::uint32_t{u8()} << (8 * k);
        return value;
    }
    /// A number of 32 bits at most in groups of 7, the lowest first, all but the last with their highest bit set; as short as may
    /// be.
    std::uint32_t varint() noexcept {
        std::uint64_t value = 0;
        for (int k = 0; k < 5; ++k) {
            const std::uint8_t byte = u8();
            value |= std::uint64_t{byte & 0x7fU} << (7 * k);
            if ((byte & 0x80U) != 0) continue;
            if ((byte == 0 && k > 0) || value > 0xffffffffU) has_failed_ = true;
            return static_cast<std::uint32_t>(value);
        }
        has_failed_ = true;
        return 0;
    }
    /// A number with a sign, in varint(): 0, -1, 1, -2 and so on.
    std::int32_t signed_varint() noexcept {
        const std::uint32_t value = varint();
        return static_cast<std::int32_t>(value >> 1 ^ (0U - (value & 1U)));
    }
    /// A number as IEEE 754 binary64.
    double f64() noexcept {
        std::uint64_t bits = u32();
        bits |= std::uint64_t{u32()} << 32;
        double value = 0;
        std::memcpy(&value, &bits, 8);
        return value;
    }

  private:
    const std::uint8_t* bytes_;
    std::size_t size_, at_ = 0;
    bool has_failed_ = false;
};

inline void put_u32(std::vector<std::uint8_t>& out, std::uint32_t value) {
    for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(value >> (8 * k) & 0xffU));
}
inline void put_varint(std::vector<std::uint8_t>& out, std::uint32_t value) {
    for (; value >= 0x80U; value >>= 7) out.push_back(static_cast<std::uint8_t>((value & 0x7fU) | 0x80U));
    out.push_back(static_cast<std::uint8_t>(value));
}
inline void put_signed_varint(std::vector<std::uint8_t>& out, std::int32_t value) {
    put_varint(out, static_cast<std::uint32_t>(value) << 1 ^ (value < 0 ? 0xffffffffU : 0U));
}

// --- the bytes that say what the mesh is ---

/// Puts the head.
inline void put_head(std::vector<std::uint8_t>& out, const CompactHead& head) {
    const bool has_peak = head.peak != head.usual_peak(), has_frame = !head.is_image_framed();
    out.push_back(static_cast<std::uint8_t>((head.channels - 1) | static_cast<int>(head.colors) << 2 |
                                            (head.premultiplied ? 16 : 0) | (head.samples == Samples::points ? 32 : 0) |
                                            (head.linear ? 64 : 0) | (has_peak ? 128 : 0)));
    out.push_back(static_cast<std::uint8_t>(static_cast<int>(head.periodic) | (head.is_masked ? 4 : 0) | (has_frame ? 8 : 0)));
    for (const int side : {head.width, head.height}) put_varint(out, static_cast<std::uint32_t>(side));
    put_varint(out, head.step);
    put_varint(out, head.color_step);
    if (has_peak) {
        static_assert(std::numeric_limits<double>::is_iec559 && sizeof(double) == 8, "double is IEEE 754 binary64");
        std::uint64_t bits = 0;
        std::memcpy(&bits, &head.peak, 8);
        put_u32(out, static_cast<std::uint32_t>(bits & 0xffffffffU));
        put_u32(out, static_cast<std::uint32_t>(bits >> 32));
    }
    if (has_frame) {
        put_signed_varint(out, head.left);
        put_signed_varint(out, head.top);
        put_varint(out, head.frame_width);
        put_varint(out, head.frame_height);
    }
}

/// Reads the head, and refuses what put_head() never puts.
[[nodiscard]] inline Status get_head(ByteReader& in, CompactHead& head) {
    constexpr auto refused = [](const char* what, double value = 0, double limit = 0) {
        return Status(Errc::invalid_argument, what, value, limit);
    };
    const unsigned first = in.u8(), second = in.u8();
    if ((first >> 2 & 3U) == 3 || (second & 0xf0U) != 0)
        return refused("the compact file uses what this version does not know, or is damaged");
    head.channels = static_cast<int>(first & 3U) + 1;
    head.colors = static_cast<CompactColors>(first >> 2 & 3U);
    head.premultiplied = (first & 16U) != 0;
    head.samples = (first & 32U) != 0 ? Samples::points : Samples::squares;
    head.linear = (first & 64U) != 0;
    head.periodic = static_cast<Periodic>(second & 3U);
    head.is_masked = (second & 4U) != 0;
    const std::uint32_t width = in.varint(), height = in.varint();
    head.step = in.varint();
    head.color_step = in.varint();
    head.peak = (first & 128U) != 0 ? in.f64() : head.usual_peak();
    const std::uint32_t least = head.samples == Samples::points ? 2 : 1;
    if (width < least || height < least || width > 65536 || height > 65536)
        return refused("the compact file's image must have sides of 1, or for points 2, to 65536 px",
                       width < least || width > 65536 ? width : height, width < least || height < least ? least : 65536);
    head.width = static_cast<int>(width);
    head.height = static_cast<int>(height);
    head.frame_image();
    if ((second & 8U) != 0) {
        head.left = in.signed_varint();
        head.top = in.signed_varint();
        head.frame_width = in.varint();
        head.frame_height = in.varint();
        constexpr auto widest = static_cast<std::int32_t>(CompactHead::widest);
        if (head.frame_width < 1 || head.frame_height < 1 || head.frame_width > CompactHead::widest ||
            head.frame_height > CompactHead::widest || head.left < -widest || head.left > widest || head.top < -widest ||
            head.top > widest || head.is_image_framed() || head.periodic == Periodic::none)
            return refused("the compact file's frame has no size, is too large, or is not that of a periodic mesh");
    }
    if (in.has_failed()) return refused("the compact file ends early or is damaged, in its head");
    if (head.step < 1 || head.step > CompactHead::widest)
        return refused("the compact file's lattice must have a step of 1 to 2^25, in 1/256 px", head.step, CompactHead::widest);
    if (head.color_step > (head.colors == CompactColors::bits8 ? CompactHead::coarsest : 0))
        return refused("the compact file's colours have a step that they cannot have", head.color_step, CompactHead::coarsest);
    if (!kit::is_finite(head.peak) || head.peak <= 0 || ((first & 128U) != 0 && head.peak == head.usual_peak()))
        return refused("the compact file's peak must be positive, finite and not the usual one");
    return {};
}

// --- the bare profile: a few bytes, and no checksum ---

/// The size of an image that is told by others.
struct ToldSize {
    int width = 0, height = 0;  ///< px; 0: it is told by the file
};

/// Whether the bare profile can hold what a head says.
[[nodiscard]] inline bool is_bare(const CompactHead& head) noexcept {
    return head.colors == CompactColors::bits8 && head.peak == 255 && !head.is_masked && head.periodic == Periodic::none &&
           head.samples == Samples::squares && head.step % 256 == 0 && head.step <= 65536U * 256 && head.is_image_framed();
}
/// Puts the head of the bare profile, with or without the image's size.
inline void put_bare_head(std::vector<std::uint8_t>& out, const CompactHead& head, bool is_size_told) {
    out.push_back(static_cast<std::uint8_t>((2 * head.table + (is_size_told ? 2 : 1)) << 4 | (head.linear ? 8 : 0) |
                                            (head.premultiplied ? 4 : 0) | (head.channels - 1)));
    if (!is_size_told)
        for (const int side : {head.width, head.height}) put_varint(out, static_cast<std::uint32_t>(side));
    put_varint(out, head.step / 256);
    put_varint(out, head.color_step);
}
/// Reads it.
[[nodiscard]] inline Status get_bare_head(ByteReader& in, ToldSize told, CompactHead& head) {
    constexpr auto refused = [](const char* what, double value = 0, double limit = 0) {
        return Status(Errc::invalid_argument, what, value, limit);
    };
    const unsigned first = in.u8();
    const unsigned kind = first >> 4;
    if (kind < 1 || kind > 2 * CompactHead::last_table + 2)
        return refused("these bytes are no bare compact mesh of a version known", kind, 2.0 * CompactHead::last_table + 2);
    head.table = static_cast<int>(kind - 1) / 2;
    if ((kind % 2 == 0) != (told.width != 0))
        return refused("a bare compact mesh is read with its size where it does not tell it, and without where it does");
    head.channels = static_cast<int>(first & 3U) + 1;
    head.premultiplied = (first & 4U) != 0;
    head.linear = (first & 8U) != 0;
    for (std::uint32_t side : {static_cast<std::uint32_t>(told.width), static_cast<std::uint32_t>(told.height)}) {
        if (told.width == 0) side = in.varint();
        if (side < 1 || side > 65536) return refused("the bare compact mesh must have sides of 1 to 65536 px", side, 65536);
        (head.width == 0 ? head.width : head.height) = static_cast<int>(side);
    }
    const std::uint32_t step = in.varint();
    head.color_step = in.varint();
    head.peak = 255;
    head.frame_image();
    if (in.has_failed()) return refused("the bare compact mesh ends in its head");
    if (step < 1 || step > 65536) return refused("the bare compact mesh must have a lattice of 1 to 65536 px", step, 65536);
    if (head.color_step > CompactHead::coarsest)
        return refused("the bare compact mesh has too large a step of colours", head.color_step, CompactHead::coarsest);
    head.step = 256 * step;
    return {};
}

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_CONTAINER_HPP
