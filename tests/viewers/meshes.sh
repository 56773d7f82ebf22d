#!/bin/sh
# Makes what the tests labelled `viewers` show: three meshes in all formats, with the pictures that they are compared with.
#
# usage: meshes.sh HMESH SCENE GRID_MESH TURNED DIRECTORY      the four programs; DIRECTORY is emptied
#   DIRECTORY/scene   the scene of tools/pictures at 1 %, as the command fits and writes it
#   DIRECTORY/grid    a mesh without thin faces (grid_mesh.cpp), and DIRECTORY/alpha with 4 channels, the latter as GPU buffers too
#   DIRECTORY/points  of a slope whose samples are points the page, and the slope between them, as such pages show the original
#   DIRECTORY/turned  of photographs in all orientations (turned.cpp) the page, and the mesh, exact but for JPEG's noise, drawn
set -eu
[ $# = 5 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
hmesh=$1 scene=$2 grid_mesh=$3 turned=$4 to=$5
rm -rf "$to"
mkdir -p "$to/scene" "$to/grid" "$to/alpha" "$to/points" "$to/turned"
"$scene" "$to/scene.png"
# fitted ARGUMENT...: the same mesh each time.
fitted() { "$hmesh" "$to/scene.png" --rate 1 --quiet "$@"; }
fitted -o "$to/scene/mesh.ply" -o "$to/scene/mesh.obj" -o "$to/scene/mesh.glb" -o "$to/scene/mesh.pdf" -o "$to/scene/mesh.eps" \
    -o "$to/scene/mesh.html" -o "$to/scene/gradient.svg" --render "$to/scene/reference.png"
fitted -o "$to/scene/exact.svg" --svg exact --render "$to/scene/reference4.png" --render-scale 4
"$grid_mesh" "$to/grid" 3
"$grid_mesh" "$to/alpha" 4
# slope WIDTH HEIGHT LEAST: rises by 2 a column and a row.
slope() { LC_ALL=C awk -v w="$1" -v h="$2" -v z="$3" 'BEGIN { printf "P5 %d %d 255\n", w, h
    for (y = 0; y < h; ++y) for (x = 0; x < w; ++x) printf "%c", z + 2 * (x + y) }'; }
slope 49 33 2 >"$to/points/slope.pgm"
slope 48 32 4 >"$to/points/between.pgm"
"$hmesh" "$to/points/slope.pgm" --samples points --vertices 4 --quiet -o "$to/points/mesh.html"
"$turned" "$to/turned"
for photo in "$to/turned"/*.jpg; do
    "$hmesh" "$photo" --rate 25 --quiet -o "${photo%.jpg}.html" --render "${photo%.jpg}.png"
done
