#!/usr/bin/env bash
# Builds what runs in browsers: the package `hmesh` of packaging/npm, into build/web/npm, and the page of web/,
# build/web/index.html with what it loads and, in one file, build/web/hmesh.html.
#
# usage: scripts/web.sh [--serve [PORT] | --test [--quick]]
# It installs Emscripten and Node where these are missing. With --serve it then serves the page to this machine, at port 8080
# unless another is given. With --test it tests the package in node and Chromium, against the command where scripts/test.sh has
# built that, then the page in Chromium and the package with vite, webpack, esbuild, deno and TypeScript, which it installs into
# build/web/tools; with --quick not these, and of the page the ways in alone.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case $*: in
    : | --test: | "--test --quick:") ;;
    --serve: | "--serve ${2-}:") ;;
    *) fail "usage: scripts/web.sh [--serve [PORT] | --test [--quick]]" ;;
esac
need eigen emscripten node

source=packaging/npm
objects=build/web/objects
package=build/web/npm

# Debian's Emscripten finds the node packages that it is made of there alone.
emscripten() { NODE_PATH=/usr/share/nodejs in_large_pages em++ -std=c++17 -msimd128 -fno-exceptions -fno-rtti "$@"; }

# compile NAME FLAG FILE...: files of the binding, of one thread or, by FLAG, of several. What meshes is compiled for speed, but for
# inlining beyond what is as good as free: thresholds of 60 cost 3 kB (brotli) and gain 2 %, Clang's own, 225 and 325 where a function is
# said to be inline, 8 kB and 3 %. The rest is compiled for size. Conversions to whole numbers that do not trap take less room, and
# engines more time (1.15 of a draft in node 20): for the rest alone.
compile() {
    local name=$1 flag=$2 file level
    shift 2
    for file; do
        case $file in
            meshing | compact) level=(-O2 -mllvm -inline-threshold=25 -mllvm -inlinehint-threshold=45) ;;
            *) level=(-Oz -mnontrapping-fptoint) ;;
        esac
        emscripten "${level[@]}" -mbulk-memory ${flag:+"$flag"} -DNDEBUG -DEIGEN_MPL2_ONLY -DHMESH_COMPILED -Wall -Wextra -Iinclude \
            "${include_folders[@]}" -c "$source/binding/$file.cpp" -o "$objects/$name/$file.o" || return
    done
}

# link NAME OBJECT... FLAG...: no JavaScript of Emscripten's, hence no main(), a memory that ours brings, imports that it has, and a stack of
# a size that is said. Not -Oz, whose exp() and the like are slower; Emscripten's small malloc(), which is as fast here. Nothing lies in
# the first 1024 bytes, which lets a constant offset be a part of a load (0.2 % of the bytes). Code made flat and its branches found
# anew, twice, is 0.7 % smaller and as fast; that loads and divisions do not trap, as in C++, 0.3 %.
link() {
    local name=$1
    shift
    emscripten -Os "$@" -o "$package/$name.wasm" --no-entry -sSTANDALONE_WASM -sIMPORTED_MEMORY -sMALLOC=emmalloc \
        -sALLOW_MEMORY_GROWTH -sMAXIMUM_MEMORY=2GB -sINITIAL_MEMORY=4MB -sTOTAL_STACK=1MB -sFILESYSTEM=0 \
        -sWARN_ON_UNDEFINED_SYMBOLS=0 -sERROR_ON_UNDEFINED_SYMBOLS=0 &&
        wasm-opt --ignore-implicit-traps --low-memory-unused --flatten --rereloop -Oz --rse -Oz --flatten --rereloop -Oz --rse -Oz \
            --enable-simd --enable-bulk-memory --enable-sign-ext --enable-nontrapping-float-to-int --enable-threads "$package/$name.wasm" -o "$package/$name.wasm"
}

# Emscripten's own threads want its JavaScript (3.1.6 refuses them with STANDALONE_WASM). Ours share a memory with the libraries of
# one thread, which the linker is told to allow: only operator new is called by several, and has a lock (binding/heap.hpp).
build_modules() {
    compile hmesh "" meshing images files compact &
    compile hmesh.threads -pthread meshing images files && wait "$!" &&
        link hmesh "$objects"/hmesh/{files,images,meshing}.o && link hmesh.meshing "$objects"/hmesh/{images,meshing}.o &&
        link hmesh.compact "$objects"/hmesh/{compact,images,meshing}.o &&
        link hmesh.threads "$objects"/hmesh.threads/{files,images,meshing}.o -matomics -mbulk-memory -Wl,--shared-memory,--no-check-features
}

rm -rf "$package" "$objects"
mkdir -p "$package" "$objects/hmesh" "$objects/hmesh.threads"
step "Building $package ..." build_modules
cp "$source"/src/*.js "$source"/src/*.d.ts "$source/package.json" "$source/README.md" LICENSE "$package"

step "Putting the page together in build/web ..." node web/build.mjs build/web
[ "${1-}" != --serve ] || exec node web/serve.mjs build/web "${2-8080}"
[ "${1-}" = --test ] || exit 0
need browser
tools=build/viewers
if [ "${2-}" = --quick ]; then
    need_node_modules "$PWD/$tools"
else
    tools=build/web/tools
    mkdir -p "$tools"
    cp tests/web/package.json tests/web/package-lock.json "$tools"
    step "Installing what tests use into $tools ..." env PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 \
        npm install --prefix "$tools" --ignore-scripts --no-audit --no-fund
    export NODE_PATH=$PWD/$tools/node_modules${NODE_PATH:+:$NODE_PATH}
fi
command=$PWD/build/release/bin/hmesh
[ -x "$command" ] || command=
export CHROMIUM=${CHROMIUM:-$(command -v chromium)}
sh tests/web/run.sh "$package" "$command" ${2+"$2"}
need viewers
need_node_modules "$PWD/build/viewers"
psnr=$PWD/build/release/bin/psnr
[ -x "$psnr" ] || psnr=
sh tests/web/page.sh build/web "$command" "$psnr" ${2+": a photo"}  # quick: the ways in alone
