#!/bin/sh
# Compares pictures of write_svg()'s and pages of write_html()'s, as Chromium shows them, with render()'s of the same meshes.
#
# usage: chromium.sh PSNR (FILE REFERENCE.png LEAST)...     PSNR: the program made of psnr.cpp; LEAST: in dB
# One browser shows them all. needs_chromium.sh says what it needs. Exit status: 0, 1 if one is below LEAST, 77 without one of these.
set -eu
if [ $# -lt 4 ] || [ $(($# % 3)) != 1 ]; then
    echo "usage: chromium.sh PSNR (FILE REFERENCE.png LEAST)..." >&2
    exit 2
fi
here=$(dirname "$0")
# shellcheck source=tests/viewers/needs_chromium.sh
. "$here/needs_chromium.sh"
psnr=$1
shift
shots=$(mktemp -d)
trap 'rm -rf "$shots"' EXIT
node "$here/chromium.js" "$shots" "$@"
status=0 n=0
while [ $# != 0 ]; do
    got=$("$psnr" "$shots/$n.png" "$2" "$3") || status=1
    echo "$1: $got (at least $3 dB)"
    shift 3
    n=$((n + 1))
done
exit "$status"
