#!/bin/sh
# Checks models with programs that are not hmesh: tests/viewers/models.sh DIRECTORY
#
# DIRECTORY holds mesh.ply, mesh.obj and mesh.glb of one mesh, from an image of 8 bits. assimp must read the same counts,
# positions and colours from all three; Khronos' validator must find nothing in mesh.glb, and in quantized.glb if there is one
# (assimp 5.2 does not know KHR_mesh_quantization). Needs assimp (Debian: assimp-utils), node, and the npm module
# gltf-validator where NODE_PATH finds it. Exit status 0 or 1; 77 when a program is
# missing and the rest is well.
set -eu
if [ $# -ne 1 ] || ! [ -d "$1" ]; then
    echo "usage: $0 DIRECTORY" >&2
    exit 2
fi
here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0
skipped=0

skip() {
    echo "skipped: $1"
    skipped=1
}

for file in mesh.ply mesh.obj mesh.glb; do
    [ -s "$1/$file" ] || { echo "FAILED: there is no $1/$file"; exit 1; }
done
command -v node >/dev/null || { skip "there is no node, which all checks of models need"; exit 77; }

if command -v assimp >/dev/null; then
    for kind in ply obj glb; do
        if assimp export "$1/mesh.$kind" "$work/$kind.assbin" -fassbin >"$work/log" 2>&1 && [ -s "$work/$kind.assbin" ]; then
            node "$here/models_compare.js" "$1/mesh.ply" "$kind" "$work/$kind.assbin" || status=1
        else
            echo "FAILED: assimp does not read mesh.$kind"
            cat "$work/log"
            status=1
        fi
    done
else
    skip "there is no assimp to read models back"
fi

if (cd "$here" && node -e 'require("gltf-validator")') 2>/dev/null; then
    for file in "$1/mesh.glb" "$1/quantized.glb"; do
        [ ! -e "$file" ] || node "$here/gltf_validate.js" "$file" || status=1
    done
else
    skip "the npm module gltf-validator is not found by NODE_PATH"
fi

[ "$status" -ne 0 ] || [ "$skipped" -eq 0 ] || exit 77
exit "$status"
