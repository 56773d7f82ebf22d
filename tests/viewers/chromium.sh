#!/bin/sh
# Compares a picture of write_svg()'s or a page of write_html()'s, as Chromium shows it, with render()'s of the same mesh.
#
# usage: chromium.sh PSNR FILE REFERENCE.png LEAST     PSNR: the program made of psnr.cpp; LEAST: in dB
# The browser is $CHROMIUM, else /usr/bin/chromium; the Node module playwright-core must be where NODE_PATH finds it.
# Exit status: 0, 1 below LEAST, 77 without one of these.
set -eu
[ $# = 4 ] || { echo "usage: chromium.sh PSNR FILE REFERENCE.png LEAST" >&2; exit 2; }
: "${CHROMIUM:=/usr/bin/chromium}"
export CHROMIUM
[ -x "$CHROMIUM" ] || { echo "skipped: there is no $CHROMIUM"; exit 77; }
command -v node >/dev/null || { echo "skipped: there is no node"; exit 77; }
node -e 'require("playwright-core")' 2>/dev/null || { echo "skipped: node finds no playwright-core"; exit 77; }
shot=$(mktemp)
trap 'rm -f "$shot"' EXIT
node "$(dirname "$0")/chromium.js" "$2" "$shot"
"$1" "$shot" "$3" "$4"
