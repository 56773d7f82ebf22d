/// \file
/// ChannelGroups: what the channels of a mesh mean, for files that hold more than a colour: a material's colour, normal and
/// roughness, meshed as one image of 7 channels.
///
/// The groups follow one another from the first channel on, and channels behind the last are left out of the file. write_glb()
/// makes COLOR_0, NORMAL and attributes of its own of them, write_ply() properties with names. Without groups, a mesh of 1 to 4
/// channels is one colour.
#ifndef HMESH_IO_CHANNEL_GROUPS_HPP
#define HMESH_IO_CHANNEL_GROUPS_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Channels of a mesh that belong together.
struct ChannelGroup {
    /// What some channels of a mesh are.
    enum class Meaning : std::uint8_t {
        /// 1 to 4 channels of an sRGB-encoded colour: grey, or red, green and blue; of 2 or 4 the last is alpha, and straight.
        color,
        /// 3 channels (n + 1) / 2 of a unit vector n, as shares of the peak: x to the right, y up and z toward the viewer, as in
        /// the normal maps of OpenGL and glTF. Files hold n, with the length 1 that interpolation and fitting took from it.
        normal,
        /// 1 to 4 channels of any other numbers, such as roughness or height: shares of the peak, nothing is decoded.
        data,
    };

    /// Letters, digits and underscores of ASCII, at least one: the name in files, but for normals and the first colour.
    const char* name = "";
    Meaning meaning = Meaning::data;  ///< what the channels are
    int channels = 1;                 ///< how many, 1 to 4
};

/// The groups of a mesh. What it points to outlives the call that it is handed to.
struct ChannelGroups {
    const ChannelGroup* groups = nullptr;  ///< `count` groups, in the order of the channels
    std::size_t count = 0;                 ///< 0: the channels are one colour

    /// Whether there are none.
    [[nodiscard]] bool is_empty() const noexcept { return count == 0; }
    /// For loops over all groups.
    [[nodiscard]] const ChannelGroup* begin() const noexcept { return groups; }
    /// For loops over all groups.
    [[nodiscard]] const ChannelGroup* end() const noexcept { return groups + count; }
};

namespace detail {

/// A letter of ASCII in lower case, any other character as it is.
[[nodiscard]] constexpr int lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; }

/// Whether two texts are the same but for capitals.
[[nodiscard]] inline bool is_same_name(const char* a, const char* b) noexcept {
    for (; *a != '\0' && lower(*a) == lower(*b); ++a, ++b) continue;
    return lower(*a) == lower(*b);
}

/// Whether a text is a name: letters, digits and underscores, at least one.
[[nodiscard]] inline bool is_name(const char* text) noexcept {
    if (text == nullptr || *text == '\0') return false;
    for (; *text != '\0'; ++text) {
        const char c = *text;
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_')) return false;
    }
    return true;
}

/// Whether files give this name to positions or colours.
[[nodiscard]] inline bool is_reserved_name(const char* name) noexcept {
    for (const char* known : {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha", "intensity"})
        if (is_same_name(name, known)) return true;
    return false;
}

/// Whether a name is that of one of several channels of a group: "rough_0" of "rough".
[[nodiscard]] inline bool is_part_name(const char* name, const ChannelGroup& of) noexcept {
    const std::size_t length = std::strlen(name), size = std::strlen(of.name);
    if (of.channels < 2 || length != size + 2 || name[size] != '_') return false;
    if (name[size + 1] < '0' || name[size + 1] > '3') return false;
    for (std::size_t i = 0; i < size; ++i)
        if (lower(name[i]) != lower(of.name[i])) return false;
    return true;
}

}  // namespace detail

/// Whether groups describe this mesh: each of 1 to 4 channels, a normal of 3 and at most one, together no more channels than the
/// mesh has, whose colours are straight; with names that differ from one another in more than capitals, and from those that files
/// give to positions and colours (x, nx, red, alpha, intensity and their like). Otherwise invalid_argument with the number of the
/// group, from 0 on; of too many channels with how many they are, of a null pointer with how many groups it is to point at, and
/// of colours that are not straight with no number.
[[nodiscard]] HMESH_COLD inline Status check(const ChannelGroups& groups, const MeshView& mesh) noexcept {
    if (groups.is_empty()) return {};
    const auto bad = [](const char* what, std::size_t value, std::size_t limit) {
        return Status(Errc::invalid_argument, what, static_cast<std::int64_t>(value), static_cast<std::int64_t>(limit));
    };
    if (groups.groups == nullptr) return bad("the pointer to the groups of channels is null, of their number", groups.count, 0);
    if (mesh.premultiplied) return {Errc::invalid_argument, "a mesh with groups of channels must have straight colours"};
    std::size_t channels = 0, normals = 0;
    for (std::size_t i = 0; i < groups.count; ++i) {
        const ChannelGroup& group = groups.groups[i];
        if (group.channels < 1 || group.channels > 4) return bad("a group must have 1 to 4 channels, unlike group", i, 0);
        if (group.meaning > ChannelGroup::Meaning::data) return bad("the meaning is none of those known, of group", i, 0);
        if (group.meaning == ChannelGroup::Meaning::normal && group.channels != 3)
            return bad("a normal must have 3 channels, unlike group", i, 0);
        normals += group.meaning == ChannelGroup::Meaning::normal ? 1 : 0;
        if (normals > 1) return bad("a mesh has one normal at most, and another is group", i, 0);
        channels += static_cast<std::size_t>(group.channels);
        if (!detail::is_name(group.name))
            return bad("a group's name must be letters, digits and underscores, unlike that of group", i, 0);
        if (detail::is_reserved_name(group.name)) return bad("positions and colours have the name of group", i, 0);
        for (std::size_t k = 0; k < i; ++k) {
            const ChannelGroup& other = groups.groups[k];
            if (detail::is_same_name(other.name, group.name) || detail::is_part_name(group.name, other) ||
                detail::is_part_name(other.name, group))
                return bad("a group before it has the name of group", i, 0);
        }
    }
    const auto most = static_cast<std::size_t>(mesh.channels > 0 ? mesh.channels : 0);
    if (channels > most) return bad("the groups have more channels than the mesh", channels, most);
    return {};
}

namespace detail {

/// A unit vector from the three channels of a normal; (0, 0, 1) where they have no direction.
[[nodiscard]] inline std::array<double, 3> unit_normal(const float* color, double peak) noexcept {
    std::array<double, 3> n{};
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        n[k] = 2 * share_of_peak(color[k], peak) - 1;
        square += n[k] * n[k];
    }
    if (!(square > 1e-12)) return {0, 0, 1};
    for (double& x : n) x /= std::sqrt(square);
    return n;
}

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_CHANNEL_GROUPS_HPP
