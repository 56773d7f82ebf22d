#!/bin/sh
# Tests the page of web/ in Chromium, from a server and from a file, and has the files that it saves opened by others.
#
# usage: page.sh FOLDER HMESH PSNR [NAME]     FOLDER: what scripts/web.sh makes; HMESH: the command, or nothing; PSNR: the program
#        made of tests/viewers/psnr.cpp, or nothing; NAME: a part of the names of the tests to be run
# What else opens files, poppler, librsvg and assimp, is used where it is. The browser is $CHROMIUM, else /usr/bin/chromium; the
# Node modules playwright-core and gltf-validator must be where NODE_PATH finds them.
# Exit status: 0; 1 where a test fails; 77 without one of these.
set -eu
[ $# -ge 3 ] || { echo "usage: page.sh FOLDER HMESH PSNR [NAME]" >&2; exit 2; }
: "${CHROMIUM:=/usr/bin/chromium}"
export CHROMIUM
[ -f "$1/hmesh.html" ] || { echo "skipped: there is no $1/hmesh.html, which scripts/web.sh makes"; exit 77; }
[ -x "$CHROMIUM" ] || { echo "skipped: there is no $CHROMIUM"; exit 77; }
command -v node >/dev/null || { echo "skipped: there is no node"; exit 77; }
node -e 'require("playwright-core"), require("gltf-validator")' 2>/dev/null ||
    { echo "skipped: node finds no playwright-core or no gltf-validator"; exit 77; }
exec node "$(dirname "$0")/page.js" "$@"
