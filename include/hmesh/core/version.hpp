/// \file
/// The version, read by CMake from here and nowhere else.
#ifndef HMESH_CORE_VERSION_HPP
#define HMESH_CORE_VERSION_HPP

/// Rises when programs must be changed; while it is 0, the next number does.
#define HMESH_VERSION_MAJOR 0
/// Rises when there is something new.
#define HMESH_VERSION_MINOR 1
/// Rises when something was mended.
#define HMESH_VERSION_PATCH 0
/// The three numbers, as in names of packages.
#define HMESH_VERSION_STRING "0.1.0"

#endif  // HMESH_CORE_VERSION_HPP
