# find_package(hmesh) defines the target hmesh::hmesh and the function hmesh_add_meshes().
set(hmesh_NOT_FOUND_MESSAGE "")
foreach(component IN LISTS hmesh_FIND_COMPONENTS)
    if(hmesh_FIND_REQUIRED_${component})
        set(hmesh_NOT_FOUND_MESSAGE "hmesh has no components, and ${component} is asked for")
    endif()
endforeach()
# Not by find_dependency(), whose sentences say neither what is needed nor where to get it.
if(NOT TARGET Eigen3::Eigen)
    find_package(Eigen3 CONFIG QUIET)
    if(NOT Eigen3_FOUND)
        string(CONCAT hmesh_NOT_FOUND_MESSAGE
               "hmesh needs Eigen 3.4 or newer: install libeigen3-dev (Debian, Ubuntu), eigen3-devel (Fedora) or eigen "
               "(Homebrew, vcpkg, Conan), or add its prefix to CMAKE_PREFIX_PATH")
    elseif(Eigen3_VERSION AND Eigen3_VERSION VERSION_LESS 3.4)
        set(hmesh_NOT_FOUND_MESSAGE "hmesh needs Eigen 3.4 or newer, and ${Eigen3_DIR} holds ${Eigen3_VERSION}")
    endif()
endif()
if(hmesh_NOT_FOUND_MESSAGE)
    set(hmesh_FOUND FALSE)
    return()
endif()
include("${CMAKE_CURRENT_LIST_DIR}/hmesh-targets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/hmesh-meshes.cmake")
