#!/bin/sh
# Checks models of heights with programs that are not hmesh: tests/viewers/heights.sh HEIGHTS DIRECTORY
#
# HEIGHTS is the program that makes them (heights.cpp), in DIRECTORY, which is emptied. assimp must read the same positions, normals,
# texture coordinates and faces from PLY, OBJ, glTF and STL; Khronos' validator must find nothing in the .glb and its image; ADMesh
# must find the solid without an open edge, a degenerate facet or a normal to be mended; HERE's decoder must read the tile's faces,
# normals and sides. Needs assimp (Debian: assimp-utils), node, the npm modules gltf-validator and @here/quantized-mesh-decoder
# where NODE_PATH finds them, and admesh. Exit status 0 or 1; 77 when a program is missing and the rest is well.
set -eu
if [ $# -ne 2 ]; then
    echo "usage: $0 HEIGHTS DIRECTORY" >&2
    exit 2
fi
here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
status=0
skipped=0
rm -rf "$2"
mkdir -p "$2"
"$1" "$2"
cd "$2"

skip() {
    echo "skipped: $1"
    skipped=1
}

if command -v node >/dev/null && command -v assimp >/dev/null; then
    for kind in ply obj glb stl; do
        if assimp export "height.$kind" "$kind.assbin" -fassbin >log 2>&1 && [ -s "$kind.assbin" ]; then
            node "$here/heights_compare.js" height.ply "$kind" "$kind.assbin" || status=1
        else
            echo "FAILED: assimp does not read height.$kind"
            cat log
            status=1
        fi
    done
else
    skip "there is no node or no assimp to read models back"
fi

if (cd "$here" && node -e 'require("gltf-validator")') 2>/dev/null; then
    node "$here/gltf_validate.js" height.glb || status=1
else
    skip "the npm module gltf-validator is not found by NODE_PATH"
fi

if (cd "$here" && node -e 'require("@here/quantized-mesh-decoder")') 2>/dev/null; then
    node "$here/heights_tile.js" height.ply height.terrain 7,46,7.0222222222222222,46.0074074074074074 || status=1
else
    skip "the npm module @here/quantized-mesh-decoder is not found by NODE_PATH"
fi

if command -v admesh >/dev/null; then
    admesh solid.stl >admesh.log
    # Facets as they were, all connected, and nothing mended.
    for line in 'Total disconnected facets  *: *0 ' 'Degenerate facets  *: *0$' 'Edges fixed  *: *0$' 'Facets removed  *: *0$' \
        'Facets added  *: *0$' 'Facets reversed  *: *0$' 'Backwards edges  *: *0$' 'Normals fixed  *: *0$'; do
        grep -q "$line" admesh.log || { echo "FAILED: ADMesh does not say '$line' of the solid"; status=1; }
    done
    grep -E 'Number of facets|Volume' admesh.log
else
    skip "there is no admesh to look at solids"
fi

[ "$status" -ne 0 ] || [ "$skipped" -eq 0 ] || exit 77
exit "$status"
