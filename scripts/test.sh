#!/usr/bin/env bash
# Builds hmesh with its examples and tests, and runs all tests.
#
# usage: scripts/test.sh [--preset NAME] [ARGUMENT...]        NAME: one of CMakePresets.json, default release;
#                                                             ARGUMENT: for ctest, such as -R render
# The words of the variable HMESH_CONFIGURE are handed to cmake when it configures.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

preset=release
if [ "${1-}" = --preset ]; then
    [ $# -ge 2 ] || fail "usage: scripts/test.sh [--preset NAME] [ARGUMENT...]"
    preset=$2
    shift 2
fi

need compiler cmake eigen stb doctest
case $preset in clang*) need clang ;; esac
# shellcheck disable=SC2086  # words
step "Configuring build/$preset ..." cmake --preset "$preset" -DHMESH_BUILD_TESTS=ON ${HMESH_CONFIGURE-}
step "Building build/$preset ..." cmake --build --preset "$preset" --parallel "$jobs"
ctest --preset "$preset" --parallel "$jobs" "$@"
