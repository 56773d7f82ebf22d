# What hmesh's own executables share: warnings, where they are put, and the headers that only they need.

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
find_package(Threads REQUIRED)

# Link this to get the library with every warning on. It is not exported: users choose their own warnings.
add_library(hmesh_internal INTERFACE)
target_link_libraries(hmesh_internal INTERFACE hmesh::hmesh Threads::Threads)
if(MSVC)
    target_compile_options(hmesh_internal INTERFACE /W4 /permissive- $<$<BOOL:${HMESH_WERROR}>:/WX>)
else()
    target_compile_options(hmesh_internal INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                                    $<$<BOOL:${HMESH_WERROR}>:-Werror>)
endif()

# What is compiled for seconds and run for milliseconds is optimised lightly: the tests, and all else with HMESH_LIGHT.
set(hmesh_light_options $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang,AppleClang>>:-O1>)
set(hmesh_lightest_options "")  # of what runs for less than it takes to optimise it; those of a source come after its target's
if(HMESH_LIGHT)
    target_compile_options(hmesh_internal INTERFACE ${hmesh_light_options})
    set(hmesh_lightest_options $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang,AppleClang>>:-O0>)
endif()

# hmesh_find_header(<target> <header> <how to get it> [<folder>]): an INTERFACE target with the directory that holds <header>,
# which may be one of that name.
function(hmesh_find_header target header advice)
    string(MAKE_C_IDENTIFIER "HMESH_${header}_DIR" variable)
    string(TOUPPER ${variable} variable)
    find_path(${variable} ${header} PATH_SUFFIXES ${ARGN})
    mark_as_advanced(${variable})
    if(NOT ${variable})
        message(FATAL_ERROR "<${header}> was not found: ${advice}")
    endif()
    add_library(${target} INTERFACE)
    target_include_directories(${target} SYSTEM INTERFACE "${${variable}}")
endfunction()

if(HMESH_BUILD_EXAMPLES OR HMESH_BUILD_COMMAND OR HMESH_BUILD_BENCHMARKS OR HMESH_BUILD_FUZZERS)
    # Debian has it in a folder stb, vcpkg has it not.
    hmesh_find_header(hmesh_stb stb_image.h
        "the command, examples, benchmarks and fuzzers need stb (Debian: libstb-dev); without it set HMESH_BUILD_EXAMPLES, \
HMESH_BUILD_COMMAND, HMESH_BUILD_BENCHMARKS and HMESH_BUILD_FUZZERS to OFF" stb)
endif()
include("${CMAKE_CURRENT_LIST_DIR}/readers.cmake")
if(HMESH_BUILD_EXAMPLES OR HMESH_BUILD_COMMAND)
    set(switch "without it set HMESH_BUILD_EXAMPLES and HMESH_BUILD_COMMAND to OFF")
    hmesh_find_header(hmesh_cli11 CLI/CLI.hpp "the command needs CLI11 (Debian: libcli11-dev); ${switch}")
    hmesh_find_header(hmesh_json nlohmann/json.hpp "the command needs nlohmann/json (Debian: nlohmann-json3-dev); ${switch}")
endif()
if(HMESH_BUILD_TESTS)
    hmesh_find_header(hmesh_doctest doctest/doctest.h
        "the tests need doctest (Debian: doctest-dev); without it set HMESH_BUILD_TESTS to OFF")
endif()
