#!/bin/sh
# Compares a picture of write_svg()'s, as rsvg-convert draws it, with render()'s of the same mesh.
#
# usage: rsvg.sh PSNR FILE.svg REFERENCE.png LEAST     PSNR: the program made of psnr.cpp; LEAST: in dB
# Exit status: 0, 1 below LEAST, 77 without rsvg-convert.
set -eu
[ $# = 4 ] || { echo "usage: rsvg.sh PSNR FILE.svg REFERENCE.png LEAST" >&2; exit 2; }
command -v rsvg-convert >/dev/null || { echo "skipped: there is no rsvg-convert"; exit 77; }
drawn=$(mktemp)
trap 'rm -f "$drawn"' EXIT
rsvg-convert --unlimited --format png --output "$drawn" "$2"
"$1" "$drawn" "$3" "$4"
