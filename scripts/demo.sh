#!/usr/bin/env bash
# Builds hmesh and turns a picture into a mesh. What it makes is in out/.
#
# usage: scripts/demo.sh [IMAGE]        without IMAGE: a scene drawn by tools/pictures/scene.cpp
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if [ $# -gt 1 ] || [[ ${1-} == -* ]]; then
    echo "usage: scripts/demo.sh [IMAGE]" >&2
    exit 2
fi
image=${1-}
case $image in
    '' | /*) ;;
    *) image=$start_directory/$image ;;
esac
[ -z "$image" ] || [ -r "$image" ] || fail "$image cannot be read"

need compiler cmake eigen command
step "Configuring build/release ..." cmake --preset release -DHMESH_BUILD_TESTS=OFF
step "Building hmesh ..." cmake --build --preset release --parallel "$jobs" --target hmesh_command --target scene

out=out
[ "$start_directory" = "$PWD" ] || out=$PWD/out  # so that the printed names can be opened from where the user is
mkdir -p "$out"
if [ -z "$image" ]; then
    image=$out/scene.png
    step "Drawing $image ..." build/release/bin/scene "$image"
fi
build/release/bin/hmesh "$image" -o "$out/mesh.ply" --render "$out/render.png" --wireframe "$out/wireframe.png" \
    --report "$out/report.json"
