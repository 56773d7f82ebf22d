#!/bin/sh
# Compares a picture of write_svg()'s or a page of write_html()'s, as Chromium shows it, with render()'s of the same mesh.
#
# usage: chromium.sh PSNR FILE REFERENCE.png LEAST     PSNR: the program made of psnr.cpp; LEAST: in dB
# needs_chromium.sh says what it needs. Exit status: 0, 1 below LEAST, 77 without one of these.
set -eu
[ $# = 4 ] || { echo "usage: chromium.sh PSNR FILE REFERENCE.png LEAST" >&2; exit 2; }
here=$(dirname "$0")
# shellcheck source=tests/viewers/needs_chromium.sh
. "$here/needs_chromium.sh"
shot=$(mktemp)
trap 'rm -f "$shot"' EXIT
node "$here/chromium.js" "$2" "$shot"
"$1" "$shot" "$3" "$4"
