#!/bin/sh
# hmesh_add_meshes(): what a build meshes, and that it meshes only what has changed.
#
# usage: tests/package/meshes.sh GENERATOR SOURCE COMMAND
#        GENERATOR: Ninja or "Unix Makefiles"; SOURCE: hmesh's sources; COMMAND: the program hmesh
# CMAKE, CXX: the programs to use. Exit status 77: there is no such generator.
set -eu
generator=$1 source=$2 command=$3
cmake=${CMAKE:-cmake} cxx=${CXX:-c++}
case $generator in Ninja) command -v ninja ;; *) command -v make ;; esac >/dev/null || exit 77
# The folder's name has what build systems must quote.
top=$(mktemp -d)
work="$top/a folder"
mkdir "$work"
trap 'rm -rf "$top"' EXIT

fail() {
    cat "$work/log"
    echo "FAILED: $*" >&2
    exit 1
}
# project FOLDER OPTION...: configures the project.
project() {
    folder=$1
    shift
    "$cmake" -S "$folder" -B "$work/build" -G "$generator" -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_COMPILER=$cxx" \
        "-DHMESH_COMMAND=$command" "-DHMESH_SOURCE_DIR=$source" "$@" >"$work/log" 2>&1
}
# meshes NAME...: a build meshes these images and no others.
meshes() {
    "$cmake" --build "$work/build" >"$work/log" 2>&1 || fail "it cannot be built"
    meshed=$(grep -o 'Meshing .*' "$work/log" | sort | tr '\n' ' ')
    wanted=$(for name; do echo "Meshing $name"; done | tr '\n' ' ')
    [ "$meshed" = "$wanted" ] || fail "meshed: '$meshed', wanted: '$wanted'"
}
# Files get another time than those that were built before.
later() {
    sleep 1.1
    touch "$@"
}
vertices() { sed -n 's/^element vertex //p' "$work/build/$1"; }
image() { awk -v seed="$1" 'BEGIN { printf "P5 24 18 255\n"; for (i = 0; i < 432; ++i) printf "%c", 33 + (i * i + seed * i) % 90 }'; }

image 1 >"$work/one.pgm"
image 2 >"$work/two.pgm"
image 3 >"$work/weights.pgm"
set -- "-DIMAGES=$work/one.pgm;$work/two.pgm" "-DIMAGE_WEIGHTS=$work/weights.pgm"

project "$source/tests/package/meshes" "$@" -DRATE=5 || fail "it cannot be configured"
meshes one one two two
for file in one.ply one.obj one.svg two.ply two.obj two.svg; do [ -s "$work/build/meshes/$file" ] || fail "$file was not made"; done
meshes
later "$work/two.pgm"
meshes two two
meshes
later "$work/weights.pgm"  # which only the depfiles of one target know of
meshes one two
meshes
rm "$work/build/meshes/one.obj"
meshes one
project "$source/tests/package/meshes" "$@" -DRATE=8 || fail "it cannot be configured again"
meshes one one two two
[ "$(vertices meshes/one.ply)" = 35 ] || fail "8 % of 432 pixels are not 35 vertices"
meshes

# Of levels of detail each has its file, but in .glb.
project "$source/tests/package/meshes" "$@" -DRATE=8 "-DMORE=RATE;8;LODS;3;FORMAT;ply;glb" || fail "LODS cannot be configured"
meshes one two
for file in one.ply one_lod1.ply one_lod2.ply one.glb; do [ -s "$work/build/more/$file" ] || fail "$file was not made"; done
meshes
rm "$work/build/more/two_lod2.ply"
meshes two
[ "$(vertices more/two_lod2.ply)" = 8 ] || fail "a quarter of 35 vertices are not 8"

# check_options OPTION...: what options make of images. Whatever builds them, the files that follow are as those above.
check_options() {
    # An image's own options take the place of what they cannot stand beside.
    project "$source/tests/package/meshes" "$@" -DRATE=8 "-DMORE=RATE;8;EFFORT;draft;LODS;2" "-DOWN_OPTIONS=--vertices;20;--effort=fast" ||
        fail "HMESH_OPTIONS cannot be configured"
    meshes one one one two
    for wanted in "meshes/one 20" "more/one 20" "more/one_lod1 10" "meshes/two 35" "more/two_lod1 17"; do
        [ "$(vertices "${wanted% *}.ply")" = "${wanted#* }" ] || fail "$wanted vertices were wanted"
    done
    meshes
    project "$source/tests/package/meshes" "$@" -DRATE=8 "-DMORE=RATE;8" "-DOWN_OPTIONS=--max-vertices;12;--grid;16" ||
        fail "--max-vertices of an image cannot be configured"
    meshes one one one two
    [ "$(vertices more/one.ply)" = 12 ] || fail "12 vertices were wanted"

    # An image with a number of bytes of its own.
    cp "$work/one.pgm" "$work/small.pgm"
    project "$source/tests/package/meshes" "$@" -DRATE=8 -DOWN_OPTIONS= -DMORE= "-DSMALL=$work/small.pgm" || fail "--bytes cannot be configured"
    meshes one one small
    size=$(wc -c <"$work/build/small/small.hmc")
    [ "$size" -gt 200 ] && [ "$size" -le 300 ] || fail "300 bytes were wanted, and there are $size"
    set -- "$@" -DSMALL=

    # Textures that tile: the mesh holds copies of the vertices on its border. One image says that it does not.
    project "$source/tests/package/meshes" "$@" -DRATE=8 "-DOWN_OPTIONS=--periodic;none" "-DMORE=VERTICES;30;PERIODIC;xy" ||
        fail "PERIODIC cannot be configured"
    meshes one one one two
    [ "$(vertices more/one.ply)" = 30 ] && [ "$(vertices more/two.ply)" -gt 30 ] || fail "two.ply alone should be periodic"

    # Sprites, outlines and at most so many vertices. The images have no alpha: all of them is inside.
    project "$source/tests/package/meshes" "$@" -DRATE=8 -DOWN_OPTIONS= "-DMORE=OUTLINE;MAX_VERTICES;8;FORMAT;obj;glb" ||
        fail "OUTLINE cannot be configured"
    meshes one one one two
    for file in one.obj one.mtl two.glb; do [ -s "$work/build/more/$file" ] || fail "$file was not made"; done
    [ "$(grep -c '^vt ' "$work/build/more/two.obj")" = 4 ] || fail "the outline of an opaque image should have 4 vertices"
    rm "$work/build/more/one.mtl"
    meshes one
    meshes
    project "$source/tests/package/meshes" "$@" -DRATE=8 "-DOWN_OPTIONS=--sprite" "-DMORE=SPRITE;MAX_VERTICES;30" ||
        fail "SPRITE cannot be configured"
    meshes one one one two
    [ "$(vertices more/one.ply) $(vertices more/two.ply)" = "30 30" ] || fail "sprites of 30 vertices were wanted"
    project "$source/tests/package/meshes" "$@" -DRATE=8 -DOWN_OPTIONS= -DMORE= || fail "it cannot be configured without"
    meshes one one

    # Of a search with a bound, the mesh within it, or none and a build that says so.
    project "$source/tests/package/meshes" "$@" -DRATE=8 "-DMORE=PSNR;10;MAX_VERTICES;50" || fail "MAX_VERTICES cannot be configured"
    meshes one two
    project "$source/tests/package/meshes" "$@" -DRATE=8 "-DMORE=PSNR;60;MAX_VERTICES;50" || fail "PSNR 60 cannot be configured"
    ! "$cmake" --build "$work/build" >"$work/log" 2>&1 || fail "PSNR 60 was reached with 50 vertices, or built without them"
    grep -q "with --psnr 60 --max-vertices 50 .* no mesh of so few vertices" "$work/log" || fail "the build does not say what was missed"
}
[ "$generator" != Ninja ] || check_options "$@"
project "$source/tests/package/meshes" "$@" -DRATE=8 -DSMALL= -DOWN_OPTIONS= -DMORE= || fail "it cannot be configured once more"

echo "no image" >"$work/two.pgm"
! "$cmake" --build "$work/build" >"$work/log" 2>&1 || fail "an image that cannot be read does not stop the build"
grep -q "cannot read '$work/two.pgm'" "$work/log" || fail "the build does not say which image cannot be read"

# What cannot be meant is refused when the project is configured, whatever builds it: one generator will do. The sentences may be
# broken into lines.
refuses() {
    sentence=$1
    shift
    ! project "$source/tests/package/meshes" "$@" || fail "accepted: $*"
    tr -s ' \n' ' ' <"$work/log" | grep -qF -e "$sentence" || fail "refused without the words: $sentence"
}
# check_refusals OPTION...: those of a project that can be configured.
check_refusals() {
    refuses "SOURCES names no image" "-DIMAGES=" "-DIMAGE_WEIGHTS=$work/weights.pgm"
    mkdir "$work/other"
    refuses "two images are named one" "-DIMAGES=$work/one.pgm;$work/other/one.pgm" "-DIMAGE_WEIGHTS=$work/weights.pgm"
    refuses "RATE and PSNR cannot both be given" "-DIMAGES=$work/one.pgm" "-DIMAGE_WEIGHTS=$work/weights.pgm" "-DRATE=8;PSNR;30"
    for image in a:b/one "one\$1"; do
        refuses "$work/$image.pgm or its OUTPUT_DIRECTORY has a '" "-DIMAGES=$work/$image.pgm" "-DIMAGE_WEIGHTS=$work/weights.pgm" -DRATE=8
    done
    refuses "its OUTPUT_DIRECTORY has a '\$', which CMake does not quote for Ninja" "$@" "-DMORE=OUTPUT_DIRECTORY;a\$b"
    formats=$("$command" "$work/one.pgm" -o mesh.xyz 2>&1 | sed -n 's/.*must end in \([^;]*\);.*/\1/p' | tr -d .) || true
    refuses "FORMAT 'xyz' is not $formats" "$@" "-DMORE=FORMAT;ply;xyz"
    efforts=$("$command" "$work/one.pgm" --effort Fast 2>&1 | sed -n "s/.*'Fast' is not //p") || true
    refuses "EFFORT 'Fast' is not $efforts" "$@" "-DMORE=EFFORT;Fast"
    axes=$("$command" "$work/one.pgm" --periodic z 2>&1 | sed -n "s/.*'z' is not //p") || true
    refuses "PERIODIC 'z' is not $axes" "$@" "-DMORE=PERIODIC;z"
    for rate in 0 -1 100.5 1,5 1e nan 5%; do
        refuses "RATE '$rate' must be a number above 0 and at most 100" "$@" "-DMORE=RATE;$rate"
    done
    for psnr in 0 -3 1001 30dB; do
        refuses "PSNR '$psnr' must be a number above 0 and at most 1000" "$@" "-DMORE=PSNR;$psnr"
    done
    for vertices in 12x 3 -5 1e3; do
        refuses "VERTICES '$vertices' must be a whole number of at least 4" "$@" "-DMORE=VERTICES;$vertices"
        refuses "MAX_VERTICES '$vertices' must be a whole number of at least 4" "$@" "-DMORE=PSNR;30;MAX_VERTICES;$vertices"
    done
    for levels in 0 33 2x; do
        refuses "LODS '$levels' must be a whole number of 1 to 32" "$@" "-DMORE=LODS;$levels"
    done
    refuses "RATE and MAX_VERTICES cannot both be given" "$@" "-DMORE=RATE;5;MAX_VERTICES;50"
    refuses "SPRITE and OUTLINE cannot both be given" "$@" "-DMORE=SPRITE;OUTLINE"
    refuses "SPRITE and PERIODIC cannot both be given" "$@" "-DMORE=SPRITE;PERIODIC;x"
    refuses "EFFORT means nothing to OUTLINE" "$@" "-DMORE=EFFORT;fast;OUTLINE"
    refuses "FORMAT 'svg' of an outline is not one of: ply, obj, glb" "$@" "-DMORE=FORMAT;svg;OUTLINE"
    refuses "OPTIONS: --lods says which files are made: it is LODS" "$@" "-DMORE=OPTIONS;--lods;3"
    refuses "OPTIONS: --depfile is given by hmesh_add_meshes()" "$@" "-DMORE=OPTIONS;--depfile=x.d"
    refuses "HMESH_OPTIONS of $work/one.pgm: --outline says which files are made: it is OUTLINE" "$@" "-DOWN_OPTIONS=--outline"
    refuses "HMESH_OPTIONS of $work/one.pgm: '--sprite --seed 2' is one word to CMake" "$@" "-DOWN_OPTIONS=--sprite --seed 2"
    for own in --rate=3 "--vertices;20" "--psnr;30" "--bytes;300" --effort=fast "--periodic;x" --sprite; do
        refuses "HMESH_OPTIONS of $work/one.pgm: ${own%[=;]*} means nothing to OUTLINE" "$@" -DMORE=OUTLINE "-DOWN_OPTIONS=$own"
    done
    refuses "OPTIONS: --vertices means nothing to OUTLINE" "$@" -DOWN_OPTIONS= "-DMORE=OUTLINE;OPTIONS;--vertices;20"
    set -- "$@" -DOWN_OPTIONS=
    for more in "RATE;1e2" "RATE;+.5" "PSNR;32.5" "VERTICES;4" "LODS;1" "MAX_VERTICES;4;PSNR;32.5" "MAX_VERTICES;4;SPRITE" "PERIODIC;none" "OUTLINE;FORMAT;OBJ" 'RATE;$<IF:$<CONFIG:Debug>,5,8>' "FORMAT;PLY;glb" 'OUTPUT_DIRECTORY;$<1:a>' 'EFFORT;$<IF:$<CONFIG:Debug>,draft,best>'; do
        project "$source/tests/package/meshes" "$@" "-DMORE=$more" || fail "refused: $more"
    done
}
set -- "-DIMAGES=$work/one.pgm" "-DIMAGE_WEIGHTS=$work/weights.pgm" -DRATE=8
[ "$generator" != Ninja ] || check_refusals "$@"

# Projects of older policies than the function's, with the installed file alone.
rm -rf "$work/build"
image 2 >"$work/two.pgm"
project "$source/tests/package/old_policies" "-DIMAGES=$work/one.pgm;$work/two.pgm" "-DIMAGE_WEIGHTS=$work/weights.pgm" ||
    fail "a project of older policies cannot be configured"
meshes one two
meshes
later "$work/weights.pgm"
meshes one two

# The command that is built is run if it is one of this machine, or an emulator runs it.
set -- "$@" -DHMESH_COMMAND= -DHMESH_BUILD_COMMAND=ON
runs() {
    wanted=$1
    shift
    rm -rf "$work/build"
    project "$source/tests/package/meshes" "$@" "-DWANTED_COMMAND=$wanted" || fail "$wanted should be run"
}
runs hmesh_command "$@"
[ ! -e "$work/build/CMakeFiles/VerifyGlobs.cmake" ] || fail "each build looks for new examples, which are not built"
mkdir "$work/host"
ln -s "$command" "$work/host/hmesh"
PATH="$work/host:$PATH" runs "$work/host/hmesh" "$@" "-DCMAKE_SYSTEM_NAME=$(uname -s)"
runs hmesh_command "$@" "-DCMAKE_SYSTEM_NAME=$(uname -s)" -DCMAKE_CROSSCOMPILING_EMULATOR=env
echo "only what changed was meshed again, under $generator"
