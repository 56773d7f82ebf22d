#!/bin/sh
# Makes what the tests labelled `viewers` show: three meshes in all formats, with the pictures that they are compared with.
#
# usage: meshes.sh HMESH SCENE GRID_MESH TURNED DIRECTORY      the four programs; DIRECTORY is emptied
#   DIRECTORY/scene   the scene of tools/pictures at 1 %, as the command fits and writes it
#   DIRECTORY/grid    a mesh without thin faces (grid_mesh.cpp), and DIRECTORY/alpha with 4 channels
#   DIRECTORY/turned  of photographs in all orientations (turned.cpp) the page, and the mesh, exact but for JPEG's noise, drawn
set -eu
[ $# = 5 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
hmesh=$1 scene=$2 grid_mesh=$3 turned=$4 to=$5
rm -rf "$to"
mkdir -p "$to/scene" "$to/grid" "$to/alpha" "$to/turned"
"$scene" "$to/scene.png"
# fitted ARGUMENT...: the same mesh each time.
fitted() { "$hmesh" "$to/scene.png" --rate 1 --quiet "$@"; }
fitted -o "$to/scene/mesh.ply" -o "$to/scene/mesh.obj" -o "$to/scene/mesh.glb" -o "$to/scene/mesh.pdf" -o "$to/scene/mesh.eps" \
    -o "$to/scene/mesh.html" -o "$to/scene/gradient.svg" --render "$to/scene/reference.png"
fitted -o "$to/scene/exact.svg" --svg exact --render "$to/scene/reference4.png" --render-scale 4
"$grid_mesh" "$to/grid" 3
"$grid_mesh" "$to/alpha" 4
"$turned" "$to/turned"
for photo in "$to/turned"/*.jpg; do
    "$hmesh" "$photo" --rate 25 --quiet -o "${photo%.jpg}.html" --render "${photo%.jpg}.png"
done
