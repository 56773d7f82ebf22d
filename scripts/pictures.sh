#!/usr/bin/env bash
# Draws the pictures of docs/method.md and docs/terrain.md anew, into docs/method/ and docs/terrain/, and prints the figures that
# go with them.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
need compiler cmake eigen command
step "Configuring build/release ..." cmake --preset release -DHMESH_BUILD_TESTS=OFF
step "Building the programs that draw ..." cmake --build --preset release --parallel "$jobs" --target stages relief
rm -f docs/method/*.jpg
build/release/bin/stages docs/method annealed
build/release/bin/stages docs/method hierarchical
rm -f docs/method/hierarchical-{1-levels,6-geometry,8-geometry,10-geometry}.jpg  # not shown
mkdir -p docs/terrain
build/release/bin/relief docs/terrain
