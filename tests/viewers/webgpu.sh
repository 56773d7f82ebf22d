#!/bin/sh
# Compares what WebGPU draws of buffers, in Chromium, with render()'s picture of the same mesh.
#
# usage: webgpu.sh LAYOUTS.json LEAST     LAYOUTS.json: of gpu_layouts.hpp; LEAST: in dB
# needs_chromium.sh says what it needs. Exit status: 0, 1 below LEAST, 77 without the browser, or where it has no WebGPU.
set -eu
[ $# = 2 ] || { echo "usage: webgpu.sh LAYOUTS.json LEAST" >&2; exit 2; }
here=$(dirname "$0")
# shellcheck source=tests/viewers/needs_chromium.sh
. "$here/needs_chromium.sh"
exec node "$here/webgpu.js" "$1" "$2"
