// hmesh - the version, read by CMake from here and nowhere else.
#ifndef HMESH_CORE_VERSION_HPP
#define HMESH_CORE_VERSION_HPP

#define HMESH_VERSION_MAJOR 0
#define HMESH_VERSION_MINOR 1
#define HMESH_VERSION_PATCH 0
#define HMESH_VERSION_STRING "0.1.0"

#endif  // HMESH_CORE_VERSION_HPP
