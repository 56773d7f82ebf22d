#!/bin/sh
# The project examples/texture_pipeline under Ninja: it is built and run, and an image that changes is meshed again alone.
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
[ "$(grep -c 'Meshing' "$work/log")" = 5 ] || fail "three textures, a sprite and an outline should be made"
build --target show
# A torus has two faces a vertex; the mesh holds copies of those on its border.
[ "$(grep -Ec '^ +1[3-9][0-9] +262 .*/(bricks|planks)\.ply$' "$work/log")" = 2 ] || fail "two tori of 131 vertices should be shown"
[ "$(grep -Ec '^ +[0-9]+ +(130|64) .*/(bricks|planks)_lod[12]\.ply$' "$work/log")" = 4 ] || fail "of each a half and a quarter too"
grep -Eq '^ +2[0-9]{3} +4000 .*/marble\.ply$' "$work/log" || fail "one of 2000 vertices, its own number, should be shown"
grep -Eq '^ +[34][0-9]{2} .*/sprites/leaf\.ply$' "$work/log" || fail "a sprite of less than 500 vertices should be shown"
for file in obj mtl; do grep -q 'leaf\.' "$work/build/outlines/leaf.$file" || fail "the outline's .$file should name its texture"; done
sleep 1.1
touch "$work/build/planks.ppm"
build
[ "$(grep -o 'Meshing .*' "$work/log")" = "Meshing planks" ] || fail "planks alone should be meshed again"
build
sleep 1.1
touch "$work/build/leaf.tga"
build
[ "$(grep -c 'Meshing leaf' "$work/log") $(grep -c 'Meshing' "$work/log")" = "2 2" ] || fail "the leaf alone should be made again"
build
grep -q 'no work to do' "$work/log" || fail "nothing should be left to do"
