#!/usr/bin/env bash
# Makes pages from the headers, README.md and docs/, in build/docs/html. Fails with doxygen's words where something public is not
# described or a reference leads nowhere, and where Markdown links to a file that is not there.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
need doxygen
dead=0
# shellcheck disable=SC2016
for page in README.md CONTRIBUTING.md CHANGELOG.md docs/*.md; do
    while read -r link; do
        [ -e "$(dirname "$page")/${link%%#*}" ] || { printf '%s: no such file: %s\n' "$page" "$link" >&2 && dead=1; }
    done < <(awk '/^```/ { code = !code } !code' "$page" | sed 's/`[^`]*`//g' |
        grep -oE '\]\([^)#: ][^): ]*\)' | sed 's/^](//; s/)$//')
done
[ "$dead" = 0 ] || fail "links lead nowhere"
rm -rf build/docs
mkdir -p build/docs
HMESH_VERSION=$(sed -n 's/^#define HMESH_VERSION_STRING "\(.*\)"$/\1/p' include/hmesh/core/version.hpp)
export HMESH_VERSION
step "Making build/docs/html/index.html ..." doxygen docs/Doxyfile
