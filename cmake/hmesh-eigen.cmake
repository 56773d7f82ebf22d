# hmesh_find_eigen(VARIABLE): finds the target Eigen3::Eigen where there is none; VARIABLE is empty then, else it says what to do.
macro(hmesh_find_eigen variable)
    set(${variable} "")
    # Without a version: Eigen 5 declares itself incompatible with a request for 3.4, although it would serve.
    if(NOT TARGET Eigen3::Eigen)
        find_package(Eigen3 CONFIG QUIET)
    endif()
    if(NOT TARGET Eigen3::Eigen)
        string(CONCAT ${variable} "Eigen 3.4 or newer: install libeigen3-dev (Debian, Ubuntu), eigen3-devel (Fedora) or eigen "
                                  "(Homebrew, vcpkg, Conan), or add its prefix to CMAKE_PREFIX_PATH")
    elseif(Eigen3_VERSION AND Eigen3_VERSION VERSION_LESS 3.4)  # a superbuild may say no version
        set(${variable} "Eigen 3.4 or newer, and ${Eigen3_DIR} holds ${Eigen3_VERSION}")
    endif()
endmacro()
