#!/usr/bin/env bash
# Builds what runs in browsers: the package `hmesh` of packaging/npm, into build/web/npm.
#
# usage: scripts/web.sh [--test [--quick]]
# It installs Emscripten where that is missing. With --test it tests the package in node and Chromium, against the command where
# scripts/test.sh has built that, and, unless --quick, with vite, webpack, esbuild, deno and TypeScript, which it installs into
# build/web/tools.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case $*: in
    : | --test: | "--test --quick:") ;;
    *) fail "usage: scripts/web.sh [--test [--quick]]" ;;
esac
need eigen emscripten

source=packaging/npm
objects=build/web/objects
package=build/web/npm

# Debian's Emscripten finds the node packages that it is made of there alone.
emscripten() { NODE_PATH=/usr/share/nodejs em++ -std=c++17 -msimd128 -fno-exceptions -fno-rtti "$@"; }

compile() {
    emscripten "-O$1" -DNDEBUG -DEIGEN_MPL2_ONLY -DHMESH_COMPILED -Wall -Wextra -Iinclude "${include_folders[@]}" \
        -c "$source/binding/$2.cpp" -o "$objects/$2.o"
}

# What meshes is compiled for speed (-O3 is no faster and 4 kB larger), the rest for size.
build_objects() {
    compile 2 meshing &
    compile z images && compile z files && wait "$!"
}

# No JavaScript of Emscripten's: no main(), a memory that ours brings, imports that it has, and a stack of a size that is said.
link() {
    emscripten -Oz "$objects"/*.o -o "$package/hmesh.wasm" --no-entry -sSTANDALONE_WASM -sIMPORTED_MEMORY -sALLOW_MEMORY_GROWTH \
        -sINITIAL_MEMORY=4MB -sTOTAL_STACK=1MB -sFILESYSTEM=0 -sWARN_ON_UNDEFINED_SYMBOLS=0 -sERROR_ON_UNDEFINED_SYMBOLS=0
}

rm -rf "$package" "$objects"
mkdir -p "$package" "$objects"
step "Building $package/hmesh.wasm ..." build_objects
step "Linking it ..." link
cp "$source"/src/*.js "$source"/src/*.d.ts "$source/package.json" "$source/README.md" LICENSE "$package"

[ "${1-}" = --test ] || exit 0
need browser
tools=build/viewers
if [ "${2-}" = --quick ]; then
    need_node_modules "$PWD/$tools"
else
    tools=build/web/tools
    mkdir -p "$tools"
    cp tests/web/package.json "$tools"
    step "Installing what tests use into $tools ..." env PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 \
        npm install --prefix "$tools" --ignore-scripts --no-package-lock --no-audit --no-fund
    export NODE_PATH=$PWD/$tools/node_modules${NODE_PATH:+:$NODE_PATH}
fi
command=$PWD/build/release/bin/hmesh
[ -x "$command" ] || command=
CHROMIUM=${CHROMIUM:-$(command -v chromium)} sh tests/web/run.sh "$package" "$command" ${2+"$2"}
