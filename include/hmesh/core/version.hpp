/// \file
/// The version of hmesh. CMake and the packages read it from here.
#ifndef HMESH_CORE_VERSION_HPP
#define HMESH_CORE_VERSION_HPP

/// Major version: rises with breaking changes (while it is 0, the minor version does).
#define HMESH_VERSION_MAJOR 0
/// Minor version: rises with new features.
#define HMESH_VERSION_MINOR 1
/// Patch version: rises with fixes.
#define HMESH_VERSION_PATCH 0
/// The version as text, "major.minor.patch".
#define HMESH_VERSION_STRING "0.1.0"

#endif  // HMESH_CORE_VERSION_HPP
