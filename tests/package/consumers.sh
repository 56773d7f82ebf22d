#!/bin/sh
# A project takes hmesh in, in one of the ways in which projects do, is built and run.
#
# usage: tests/package/consumers.sh WAY SOURCE BUILD VERSION
#        WAY: find_package, add_subdirectory, fetch_content, pkg_config, single_header, no_eigen or wrong_eigen; compiled, which is a
#        program of two files, one of which compiles mesh_image() for the other, and compiled_single, the same with the single
#        header; install_dirs, which is to install into folders of other names; readme, which is to install as README.md says; or
#        flat_stb, which is to build an example with stb's headers in no folder of theirs
#        SOURCE: hmesh's sources; BUILD: its binary directory, from which it is installed; VERSION: that of hmesh
# CMAKE, CXX: the programs to use. Exit status 77: what the way needs is not there.
set -eu
way=$1 source=$2 build=$3 version=$4
cmake=${CMAKE:-cmake} cxx=${CXX:-c++}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "$*" >&2
    exit 1
}
# with_cmake FOLDER OPTION...: configures and builds that project, and runs what it makes.
with_cmake() {
    folder=$1
    shift
    "$cmake" -S "$source/tests/package/$folder" -B "$work/build" -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_COMPILER=$cxx" "$@"
    "$cmake" --build "$work/build"
    "$work/build/consumer" "$version"
}
# with_compiler OPTION...: one compiler line, and what it makes is run.
with_compiler() {
    "$cxx" -std=c++17 "$source/tests/package/main.cpp" "$@" -o "$work/consumer"
    "$work/consumer" "$version"
}
# copied: the single header and that of the paper's methods, copied into a project.
copied() {
    mkdir -p "$work/include/hmesh"
    cp "$source/single_include/hmesh.hpp" "$work/include/hmesh"
    cp "$source/single_include/hmesh_paper.hpp" "$work/include/hmesh/paper.hpp"
}
# compiled INCLUDE: the two files in declare-only mode. Eigen is not there.
compiled() {
    for file in compiled compiled_meshing; do
        "$cxx" -std=c++17 -DHMESH_COMPILED "-I$1" -c "$source/tests/package/$file.cpp" -o "$work/$file.o"
    done
    "$cxx" "$work/compiled.o" "$work/compiled_meshing.o" -o "$work/consumer"
    "$work/consumer" "$version" >"$work/said"
    cat "$work/said"
    # Declared only is declared only.
    ! "$cxx" "$work/compiled.o" -o "$work/alone" 2>"$work/log" || fail "mesh_image() was compiled in both files"
    grep -q mesh_image "$work/log" || fail "the linker misses something else: $(cat "$work/log")"
}
install() {
    "$cmake" --install "$build" --prefix "$work/prefix" >"$work/installed"
    case $(find "$work/prefix" -name '*.[hi]pp' -o -name '*.cmake' -o -name '*.pc') in
        */lib/*) fail "something was installed to a folder of this machine's kind" ;;
    esac
}
# Where the compiler does not look by itself for Eigen.
eigen_include() {
    for directory in /usr/include/eigen3 /usr/local/include/eigen3 /opt/homebrew/include/eigen3; do
        [ ! -d "$directory" ] || echo "-I$directory"
    done
}
# program FILE: puts a program there.
program() {
    mkdir -p "$(dirname "$1")"
    printf '#!/bin/sh\n' >"$1"
    chmod +x "$1"
}
# accepts OPTION...: the project of find_package is configured, again if it was.
accepts() {
    "$cmake" -S "$source/tests/package/find_package" -B "$work/build" "$@" >"$work/log" 2>&1 ||
        fail "$* is not accepted: $(cat "$work/log")"
}
# refuses SENTENCE OPTION...: the project of find_package must not be configured, for that reason.
refuses() {
    sentence=$1
    shift
    rm -rf "$work/build"
    ! "$cmake" -S "$source/tests/package/find_package" -B "$work/build" "-DCMAKE_PREFIX_PATH=$work/prefix" "$@" >"$work/log" 2>&1 ||
        fail "$* was accepted"
    tr -s ' \n' ' ' <"$work/log" | grep -qF -e "$sentence" || fail "$* was refused without the words: $sentence"
}
# An Eigen of another version, which like the real one refuses requests for other major versions.
fake_eigen() {
    mkdir -p "$work/eigen-$1/share/eigen3/cmake"
    cat >"$work/eigen-$1/share/eigen3/cmake/Eigen3Config.cmake" <<END
add_library(Eigen3::Eigen INTERFACE IMPORTED)
set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "$(eigen_include | sed 's/^-I//')")
END
    printf 'set(PACKAGE_VERSION %s)\nif(PACKAGE_FIND_VERSION_MAJOR STREQUAL "" OR PACKAGE_FIND_VERSION_MAJOR EQUAL %s)\n' \
        "$1" "${1%%.*}" >"$work/eigen-$1/share/eigen3/cmake/Eigen3ConfigVersion.cmake"
    printf '    set(PACKAGE_VERSION_COMPATIBLE TRUE)\nendif()\n' >>"$work/eigen-$1/share/eigen3/cmake/Eigen3ConfigVersion.cmake"
}

case $way in
    find_package)
        install
        [ -x "$work/prefix/bin/hmesh" ] || program "$work/prefix/bin/hmesh"  # the command is not built
        with_cmake find_package "-DCMAKE_PREFIX_PATH=$work/prefix" "-DWANTED=${version%.*}" \
            "-DWANTED_COMMAND=$work/prefix/bin/hmesh"
        # Configured again with another package, or another command.
        cp -R "$work/prefix" "$work/other"
        accepts "-Dhmesh_DIR=$work/other/share/cmake/hmesh" "-DWANTED_COMMAND=$work/other/bin/hmesh"
        program "$work/own/hmesh"
        (cd "$work" && accepts -DHMESH_COMMAND=own/hmesh "-DWANTED_COMMAND=$work/own/hmesh")
        accepts -DHMESH_COMMAND= "-DWANTED_COMMAND=$work/other/bin/hmesh"
        # The package of another machine holds a command that this one cannot run.
        program "$work/host/hmesh"
        rm -rf "$work/build"
        (PATH="$work/host:$PATH" && accepts "-DCMAKE_PREFIX_PATH=$work/prefix" "-DCMAKE_SYSTEM_NAME=$(uname -s)" \
            "-DWANTED_COMMAND=$work/host/hmesh")
        refuses "hmesh has one component, paper, and gpu is asked for" -DWANTED_COMPONENTS=gpu
        refuses "$version" "-DWANTED=$((${version%%.*} + 1)).0"
        ;;
    readme)
        mkdir "$work/clone"
        ln -s "$source"/* "$work/clone"
        rm -f "$work/clone/build"
        lines=$(sed -n '/^cmake -B build /p; /^cmake --install build /p' "$source/README.md" | sed "s|PREFIX|'$work/prefix'|")
        cmake() { command "$cmake" "$@"; }
        (cd "$work/clone" && eval "$lines") >"$work/log" 2>&1 || fail "README.md's lines do not install hmesh: $(cat "$work/log")"
        accepts "-DCMAKE_PREFIX_PATH=$work/prefix" "-DWANTED=$version"
        ;;
    flat_stb)
        folder=$(sed -n 's/^HMESH_STB_IMAGE_H_DIR:PATH=//p' "$build/CMakeCache.txt")
        mkdir -p "$work/flat/include"
        for header in stb_image.h stb_image_write.h; do ln -s "$folder/$header" "$work/flat/include"; done
        "$cmake" -S "$source" -B "$work/build" -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_COMPILER=$cxx" -DHMESH_BUILD_TESTS=OFF \
            "-DCMAKE_PREFIX_PATH=$work/flat"
        grep -qxF "HMESH_STB_IMAGE_H_DIR:PATH=$work/flat/include" "$work/build/CMakeCache.txt" || fail "stb was not found there"
        "$cmake" --build "$work/build" --target scene
        ;;
    wrong_eigen)
        install
        refuses "hmesh/paper.hpp needs Eigen 3.4 or newer: install libeigen3-dev" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON \
            -DWANTED_COMPONENTS=paper
        fake_eigen 3.3.9
        refuses "hmesh/paper.hpp needs Eigen 3.4 or newer, and $work/eigen-3.3.9" "-DEigen3_DIR=$work/eigen-3.3.9/share/eigen3/cmake" \
            -DWANTED_COMPONENTS=paper
        fake_eigen 5.0.1
        rm -rf "$work/build"
        accepts "-DCMAKE_PREFIX_PATH=$work/prefix" "-DEigen3_DIR=$work/eigen-5.0.1/share/eigen3/cmake" -DWANTED_COMPONENTS=paper
        ;;
    no_eigen)
        "$cmake" -S "$source" -B "$work/hmesh" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON -DHMESH_BUILD_TESTS=OFF -DHMESH_BUILD_EXAMPLES=OFF
        "$cmake" --install "$work/hmesh" --prefix "$work/prefix"
        with_cmake find_package "-DCMAKE_PREFIX_PATH=$work/prefix" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON -DWANTED_PAPER=OFF
        # Installed without Eigen, used with it.
        rm -rf "$work/build"
        with_cmake find_package "-DCMAKE_PREFIX_PATH=$work/prefix" -DWANTED_COMPONENTS=paper
        ! "$cmake" -S "$source" -B "$work/tests" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON >"$work/log" 2>&1 || fail "tests were prepared"
        tr -s ' \n' ' ' <"$work/log" | grep -qF "tests and benchmarks of hmesh need Eigen 3.4 or newer: install libeigen3-dev" ||
            fail "tests without Eigen are refused by other words: $(cat "$work/log")"
        ;;
    add_subdirectory)
        with_cmake "$way" "-DHMESH_SOURCE_DIR=$source"
        ;;
    fetch_content)
        with_cmake "$way" "-DHMESH_SOURCE_DIR=$source"
        ;;
    install_dirs)
        "$cmake" -S "$source" -B "$work/hmesh" -DCMAKE_INSTALL_INCLUDEDIR=headers/all -DCMAKE_INSTALL_DATADIR=data/any \
            -DCMAKE_INSTALL_BINDIR=programs -DCMAKE_INSTALL_DOCDIR=papers -DCMAKE_INSTALL_MANDIR=manuals \
            -DHMESH_BUILD_TESTS=OFF -DHMESH_BUILD_EXAMPLES=OFF -DHMESH_BUILD_COMMAND=ON "-DHMESH_STB_IMAGE_H_DIR=$work" "-DHMESH_CLI_CLI_HPP_DIR=$work" \
            "-DHMESH_NLOHMANN_JSON_HPP_DIR=$work"
        # As if they had been built.
        program "$work/hmesh/bin/hmesh"
        program "$work/hmesh/bin/hmesh-terrain"
        mkdir "$work/hmesh/tools/hmesh/words" "$work/hmesh/tools/terrain/words"
        for words in hmesh.1 hmesh.bash _hmesh hmesh.fish; do echo >"$work/hmesh/tools/hmesh/words/$words"; done
        for words in hmesh-terrain.1 hmesh-terrain.bash _hmesh-terrain hmesh-terrain.fish; do
            echo >"$work/hmesh/tools/terrain/words/$words"
        done
        "$cmake" --install "$work/hmesh" --prefix "$work/installed"
        mv "$work/installed" "$work/prefix"  # which makes no difference
        [ "$(cd "$work/prefix" && echo *)" = "data headers manuals papers programs" ] || fail "other folders than those wanted"
        [ -f "$work/prefix/manuals/man1/hmesh.1" ] || fail "the manual page is not where manual pages are"
        [ -f "$work/prefix/data/any/bash-completion/completions/hmesh" ] || fail "the completions are not where data are"
        [ -f "$work/prefix/papers/LICENSE" ] || fail "the licence is not where documents are"
        with_cmake find_package "-Dhmesh_DIR=$work/prefix/data/any/cmake/hmesh" "-DWANTED_COMMAND=$work/prefix/programs/hmesh"
        command -v pkg-config >/dev/null || exit 0
        folder=$(PKG_CONFIG_PATH="$work/prefix/data/any/pkgconfig" pkg-config --variable=includedir hmesh)
        [ -f "$folder/hmesh/hmesh.hpp" ] || fail "pkg-config says that the headers are in $folder"
        ;;
    pkg_config)
        command -v pkg-config >/dev/null || exit 77
        install
        export PKG_CONFIG_PATH="$work/prefix/share/pkgconfig"
        [ "$(pkg-config --modversion hmesh)" = "$version" ] || fail "pkg-config says version $(pkg-config --modversion hmesh)"
        # shellcheck disable=SC2046  # words
        with_compiler $(pkg-config --cflags --libs hmesh eigen3)
        # shellcheck disable=SC2046  # words
        with_compiler -DWITHOUT_PAPER $(pkg-config --cflags --libs hmesh)
        ;;
    compiled)
        compiled "$source/include"
        # Header-only the first file is a program by itself, and does the same.
        "$cxx" -std=c++17 "-I$source/include" "$source/tests/package/compiled.cpp" -o "$work/alone"
        "$work/alone" "$version" >"$work/header_only"
        cmp "$work/header_only" "$work/said" || fail "header-only it does something else"
        ;;
    compiled_single)
        copied
        compiled "$work/include"
        ;;
    single_header)
        copied
        # shellcheck disable=SC2046  # words
        with_compiler "-I$work/include" $(eigen_include)
        ;;
    *) fail "unknown way: $way" ;;
esac
