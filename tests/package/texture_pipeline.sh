#!/bin/sh
# The project examples/texture_pipeline under Ninja: it is built and run, and a texture that changes is meshed again alone.
#
# usage: tests/package/texture_pipeline.sh SOURCE COMMAND
#        SOURCE: hmesh's sources; COMMAND: the program hmesh
# CMAKE, CXX: the programs to use. Exit status 77: there is no Ninja.
set -eu
source=$1 command=$2
cmake=${CMAKE:-cmake} cxx=${CXX:-c++}
command -v ninja >/dev/null || exit 77
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    cat "$work/log"
    echo "FAILED: $*" >&2
    exit 1
}
build() { "$cmake" --build "$work/build" "$@" >"$work/log" 2>&1 || fail "it cannot be built"; }

"$cmake" -S "$source/examples/texture_pipeline" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Debug \
    "-DCMAKE_CXX_COMPILER=$cxx" "-DHMESH_COMMAND=$command" -DRATE=0.2 >"$work/log" 2>&1 || fail "it cannot be configured"
build
[ "$(grep -c 'Meshing' "$work/log")" = 3 ] || fail "three textures should be meshed"
build --target show
[ "$(grep -Ec '^ +131 .*/(bricks|planks|marble)\.ply$' "$work/log")" = 3 ] || fail "three meshes of 131 vertices should be shown"
sleep 1.1
touch "$work/build/planks.ppm"
build
[ "$(grep -o 'Meshing .*' "$work/log")" = "Meshing planks" ] || fail "planks alone should be meshed again"
build
grep -q 'no work to do' "$work/log" || fail "nothing should be left to do"
