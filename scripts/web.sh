#!/usr/bin/env bash
# Builds what runs in browsers: the package `hmesh` of packaging/npm, into build/web/npm.
#
# usage: scripts/web.sh
# It installs Emscripten where that is missing.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

[ $# = 0 ] || fail "usage: scripts/web.sh"
need eigen emscripten

package=build/web/npm
source=packaging/npm

# Node finds the packages that Debian's Emscripten is made of there alone.
emcc() { NODE_PATH=/usr/share/nodejs em++ "$@"; }

# No glue: a memory that the JavaScript brings, a stack of its size (elsewhere it has 64 kB), no main().
build_wasm() {
    emcc -std=c++17 -O3 -msimd128 -fno-exceptions -fno-rtti -DNDEBUG -DEIGEN_MPL2_ONLY -Wall -Wextra -Iinclude "${include_folders[@]}" \
        "$source/binding/hmesh.cpp" -o "$1" --no-entry -sSTANDALONE_WASM -sIMPORTED_MEMORY -sALLOW_MEMORY_GROWTH \
        -sINITIAL_MEMORY=4MB -sTOTAL_STACK=1MB -sFILESYSTEM=0 -sWARN_ON_UNDEFINED_SYMBOLS=0 -sERROR_ON_UNDEFINED_SYMBOLS=0
}

rm -rf "$package"
mkdir -p "$package"
step "Building $package/hmesh.wasm ..." build_wasm "$package/hmesh.wasm"
cp "$source"/src/*.js "$source"/src/*.d.ts "$source/package.json" "$source/README.md" LICENSE "$package"
