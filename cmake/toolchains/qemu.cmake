# Programs for Linux on another processor, HMESH_PROCESSOR as Debian's compilers name it, linked statically and run by qemu.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES HMESH_PROCESSOR)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${HMESH_PROCESSOR})
set(CMAKE_CXX_COMPILER ${HMESH_PROCESSOR}-linux-gnu-g++)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-${HMESH_PROCESSOR})

# Libraries and headers of this machine are not for that one. Packages may be: Eigen is headers only.
set(CMAKE_FIND_ROOT_PATH /usr/${HMESH_PROCESSOR}-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
