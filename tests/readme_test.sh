#!/usr/bin/env bash
# The code in README.md is that of examples/minimal.cpp between its marks, unindented, and packages have hmesh's version.
# usage: readme_test.sh ROOT
set -eu
root=$1
example=$(sed -n '/\/\/ README begin/,/\/\/ README end/p' "$root/examples/minimal.cpp" | sed -e '/\/\/ README /d' -e 's/^    //')
readme=$(sed -n '/<!-- examples\/minimal.cpp -->/,/^```$/p' "$root/README.md" | sed -e '1,2d' -e '$d')
[ -n "$example" ] || { echo "examples/minimal.cpp has no README marks"; exit 1; }
if [ "$example" != "$readme" ]; then
    echo "README.md does not show examples/minimal.cpp as it is:"
    diff <(printf '%s\n' "$example") <(printf '%s\n' "$readme") || true
    exit 1
fi
version=$(sed -n 's/^#define HMESH_VERSION_STRING "\(.*\)"$/\1/p' "$root/include/hmesh/core/version.hpp")
for recipe in packaging/vcpkg/hmesh/vcpkg.json packaging/npm/package.json; do
    said=$(sed -n 's/^ *"version": "\(.*\)",$/\1/p' "$root/$recipe")
    [ "$said" = "$version" ] || { echo "$recipe has version $said, hmesh is $version"; exit 1; }
done
