#!/usr/bin/env bash
# Builds hmesh with its examples and tests, and runs the tests.
#
# usage: scripts/test.sh [--preset NAME] [--viewers] [ARGUMENT...]
#        NAME: one of CMakePresets.json, default release; ARGUMENT: for ctest, such as -R render
# With --viewers it runs only those that show meshes to other programs (poppler, Ghostscript, librsvg, assimp, ADMesh,
# Chromium, Khronos' validator), which it installs; without, all the others. The words of the variable HMESH_CONFIGURE are handed to
# cmake when it configures. The command and the examples are optimised lightly, for they take longer to compile than to run;
# HMESH_CONFIGURE=-DHMESH_LIGHT=OFF tests them as users get them. That each header compiles alone takes a minute, and is left to
# .ci/run or -DHMESH_TEST_HEADERS=ON.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

preset=release
label=(-LE "^viewers\$")
targets=()
while [ $# != 0 ]; do
    case $1 in
        --preset)
            [ $# -ge 2 ] || fail "usage: scripts/test.sh [--preset NAME] [--viewers] [ARGUMENT...]"
            preset=$2
            shift 2
            ;;
        --viewers)
            label=(-L "^viewers\$")
            targets=(--target hmesh_command --target scene --target viewers_programs)
            shift
            ;;
        *) break ;;
    esac
done

need compiler cmake eigen command doctest pytest
case $preset in
    asan | tsan) need clang-sanitizers ;;
    clang*) need clang ;;
esac
if [ ${#targets[@]} != 0 ]; then
    need viewers
    need_node_modules "$PWD/build/viewers"
    CHROMIUM=${CHROMIUM:-$(command -v chromium)}
    export CHROMIUM
fi
# shellcheck disable=SC2086  # words
step "Configuring build/$preset ..." cmake --preset "$preset" -DHMESH_BUILD_TESTS=ON -DHMESH_LIGHT=ON \
    -DHMESH_TEST_HEADERS=TOGETHER ${HMESH_CONFIGURE-}
step "Building build/$preset ..." cmake --build --preset "$preset" --parallel "$jobs" ${targets[@]+"${targets[@]}"}
ctest --preset "$preset" --parallel "$jobs" "${label[@]}" "$@"
