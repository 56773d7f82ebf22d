#!/usr/bin/env bash
# Builds all tests with each compiler and kind of flags that hmesh is promised for, runs them, and prints a table.
#
# usage: scripts/matrix.sh [--list] [CELL...]        without CELL: all of them, some four and a half hours of one core
#        --list: prints the cells and what each is for, and builds nothing
#
# A cell is configured, built and tested in build/matrix/CELL, where its logs are; build/matrix/table.md holds the results of
# all cells that were run there, as a table in Markdown. Exit status 1 if a cell failed. Cells do not depend on CMake's
# build types, which would add flags: what the table below says is all that the compiler is told.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# A line a cell: name; compiler; C++ standard; flags; CMake options without -D; what it is for. NDEBUG leaves assertions out.
cells() {
    cat <<'TABLE'
gcc-O0; g++; 17; -O0 -D_GLIBCXX_ASSERTIONS; ; the oldest standard, nothing optimised, all assertions
gcc-O2; g++; 20; -O2 -DNDEBUG -march=x86-64 -fno-exceptions -fno-rtti; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF; any x86-64, without exceptions and RTTI
gcc-O3-native; g++; 23; -O3 -DNDEBUG -march=native -DEIGEN_MPL2_ONLY -Wno-maybe-uninitialized -Wno-restrict; HMESH_TEST_HEADERS=OFF; all that g++ can do: wide vectors, contracted products (the warnings are false in g++ 12: of AVX-512 intrinsics, and of std::string, GCC bug 105651)
gcc-m32; g++; 17; -O1 -m32 -msse2 -mfpmath=sse; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF; 32 bits, with the arithmetic of 64 (not x87, see docs)
clang14-O1; clang++-14; 17; -O1 -DNDEBUG -march=native -ffp-contract=off; HMESH_TEST_HEADERS=OFF; wide vectors without contracted products
clang19-O0; clang++-19; 23; -O0 -Wno-deprecated-declarations; ; the newest clang++, its warnings but one of g++ 12's std::stable_sort
clang19-O3; clang++-19; 20; -O3 -DNDEBUG -march=native -fno-exceptions -fno-rtti -Wno-deprecated-declarations; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF; all that clang++ can do
single-header; clang++-14; 23; -O0 -fno-exceptions -fno-rtti -DEIGEN_MPL2_ONLY; HMESH_TEST_SINGLE_HEADER=ON HMESH_BUILD_EXAMPLES=OFF; an older clang++, all tests with single_include/hmesh.hpp
mingw; x86_64-w64-mingw32-g++-posix; 17; -O1; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF; Windows: long of 32 bits, another C library, run by Wine
aarch64; aarch64-linux-gnu-g++; 17; -O2; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF HMESH_TEST_TIMEOUT=3000; 64-bit ARM: char without a sign, contracted products in all code, run by qemu
s390x; s390x-linux-gnu-g++; 17; -O2 -DNDEBUG; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF HMESH_TEST_TIMEOUT=3000; IBM Z: numbers in memory begin with their highest byte, run by qemu
emscripten; em++; 17; -O1 -fexceptions -pthread; HMESH_TEST_HEADERS=OFF HMESH_BUILD_EXAMPLES=OFF; WebAssembly: 32 bits, no packet mathematics in Eigen, libc++, run by node
TABLE
}

# field NUMBER LINE: a field of a line of the table.
field() { printf '%s\n' "$2" | awk -F ' *; *' -v n="$1" '{ print $n }'; }
# attribute NAME FILE: a number of CTest's JUnit file.
attribute() { sed -n "s/^.*<testsuite .*$1=\"\\([0-9]*\\)\".*\$/\\1/p; /^[[:space:]]*$1=\"/s/[^0-9]//gp" "$2" | head -n 1; }

version_of() {
    case $1 in
        *mingw*) printf 'MinGW-w64 g++ %s' "$("$1" -dumpversion)" ;;
        em++) printf 'Emscripten %s, node %s' "$(em++ --version | sed -n '1s/.* \([0-9.]*\) .*/\1/p')" "$(node --version)" ;;
        *clang*) printf 'clang++ %s' "$("$1" -dumpversion)" ;;
        *-linux-gnu-g++) printf 'g++ %s for %s' "$("$1" -dumpfullversion)" "${1%%-*}" ;;
        *) printf 'g++ %s' "$("$1" -dumpfullversion)" ;;
    esac
}

# What a cell needs beyond compiler, CMake, Eigen, doctest, and what the command is made of and tested with.
need_for() {
    case $1 in
        clang14* | single*) need clang-14 ;;
        clang19*) need clang-19 ;;
        gcc-m32*) need m32 ;;
        mingw) need mingw wine ;;
        aarch64 | s390x) need "g++-$1" qemu ;;
        emscripten) need emscripten ;;
    esac
}

# Headers of this machine must not be seen by compilers for others, so doctest gets a directory of its own.
lone_doctest() {
    local directory=$PWD/build/matrix/include found
    mkdir -p "$directory/doctest"
    found=$(printf '#include <doctest/doctest.h>\n' | "${CXX:-c++}" -x c++ -M - | tr ' ' '\n' | grep 'doctest/doctest\.h$')
    ln -sf "$found" "$directory/doctest/doctest.h"
    printf '%s' "$directory"
}

# run_cell LINE: leaves a line of the Markdown table in build/matrix/rows. Returns 1 if anything failed.
run_cell() {
    local line=$1 name compiler std flags options what directory result status=ok option toolchain="" arguments=() TIMEFORMAT='%U %S'
    name=$(field 1 "$line") compiler=$(field 2 "$line") std=$(field 3 "$line") flags=$(field 4 "$line")
    options=$(field 5 "$line") what=$(field 6 "$line")
    directory=build/matrix/$name
    need_for "$name"
    mkdir -p "$directory" build/matrix/rows
    rm -f "$directory/result.xml" "build/matrix/rows/$name"{,.bytes}

    for option in $options; do arguments+=("-D$option"); done
    case $flags in *-fno-exceptions*) flags+=" -DDOCTEST_CONFIG_NO_EXCEPTIONS_BUT_WITH_ALL_ASSERTS" ;; esac
    case $compiler in
        *mingw*)
            toolchain=mingw-w64
            export WINEPREFIX=$PWD/build/matrix/wine WINEDEBUG=-all DISPLAY=
            ;;
        em++)
            toolchain=emscripten
            export NODE_PATH=/usr/share/nodejs
            ;;
        *-linux-gnu-g++)
            toolchain=qemu
            arguments+=(-DHMESH_PROCESSOR="${compiler%%-*}")
            ;;
        *) arguments+=(-DCMAKE_CXX_COMPILER="$compiler") ;;
    esac
    [ -z "$toolchain" ] || arguments+=(-DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/toolchains/$toolchain.cmake"
        -DHMESH_DOCTEST_DOCTEST_H_DIR="$(lone_doctest)")
    ! has ninja || arguments+=(-G Ninja)

    printf '%s: %s\n' "$name" "$what"
    if ! cmake -S . -B "$directory" -DCMAKE_BUILD_TYPE= -DCMAKE_CXX_STANDARD="$std" -DCMAKE_CXX_EXTENSIONS=OFF \
        -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DHMESH_WERROR=ON "${arguments[@]}" \
        >"$directory/configure.log" 2>&1; then
        status="does not configure"
    else
        { time cmake --build "$directory" --parallel "$jobs" -- -k 0 >"$directory/build.log" 2>&1 ||
            status="does not build"; } 2>"$directory/build.time"
        [ "$name" != mingw ] || wineboot --init >/dev/null 2>&1 || true
        { time ctest --test-dir "$directory" --parallel "$jobs" --label-exclude "^viewers\$" --no-tests=error \
            --output-on-failure --output-junit "$PWD/$directory/result.xml" >"$directory/test.log" 2>&1 ||
            [ "$status" != ok ] || status=fails; } 2>"$directory/test.time"
    fi

    result="| | | | |"
    if [ -s "$directory/result.xml" ]; then
        grep -h '^mesh bytes: ' "$directory/Testing/Temporary/LastTest.log" >"build/matrix/rows/$name.bytes" || true
        result=$(awk -v tests="$(attribute tests "$directory/result.xml")" -v failed="$(attribute failures "$directory/result.xml")" \
            -v skipped="$(attribute skipped "$directory/result.xml")" 'FNR == 1 { cpu[++n] = $1 + $2 }
            END { printf "%d / %d / %d | %.1f | %.0f |", tests - failed - skipped, failed, skipped, cpu[1] / 60, cpu[2] }' \
            "$directory/build.time" "$directory/test.time")
    fi
    printf "| %s | %s | \`-std=c++%s %s\` | %s | %s\n" "$name" "$(version_of "$compiler")" "$std" "$(field 4 "$line")" "$status" \
        "$result" >"build/matrix/rows/$name"
    cat "build/matrix/rows/$name"
    [ "$status" = ok ] || printf 'see %s/*.log\n' "$directory"
    [ "$status" = ok ]
}

write_table() {
    local line row
    printf '| cell | compiler | flags | | passed / failed / skipped | build, CPU min | tests, CPU s |\n|---|---|---|---|---|---|---|\n'
    while read -r line; do
        row=build/matrix/rows/$(field 1 "$line")
        [ ! -f "$row" ] || cat "$row"
    done < <(cells)
    printf '\nMeshes of one image, as numbers made of their bytes, and their PSNR:\n\n| cell | image | draft | fast | normal |\n|---|---|---|---|---|\n'
    while read -r line; do
        row=build/matrix/rows/$(field 1 "$line").bytes
        [ ! -s "$row" ] || sed "s/^mesh bytes: image/| $(field 1 "$line") |/; s/, [a-z]*/ |/g; s/\$/ |/" "$row"
    done < <(cells)
}

if [ "${1-}" = --list ]; then
    cells | awk -F ' *; *' '{ printf "%-14s %-28s c++%s  %s\n%14s %s\n", $1, $2, $3, $4, "", $6 }'
    exit
fi
chosen=$(cells)
if [ $# != 0 ]; then
    chosen=$(for name in "$@"; do
        cells | grep "^$name;" || fail "no cell is called $name: see scripts/matrix.sh --list"
    done)
fi

need compiler cmake eigen command doctest pytest
failed=0
while read -r line <&3; do
    run_cell "$line" </dev/null || failed=1
done 3<<<"$chosen"
write_table >build/matrix/table.md
cat build/matrix/table.md
exit "$failed"
