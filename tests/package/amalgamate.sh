#!/bin/sh
# What scripts/amalgamate writes where, and what it refuses.
#
# usage: tests/package/amalgamate.sh SOURCE        SOURCE: hmesh's sources
set -eu
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() {
    echo "FAILED: $*" >&2
    exit 1
}
refuses() {
    status=0
    "$source/scripts/amalgamate" "$@" >out 2>err || status=$?
    [ "$status" = 2 ] || fail "exit status $status instead of 2 for: $*"
    grep -q '^usage: ' err || fail "no word of how it is used for: $*"
    rm out err
    [ -z "$(ls -A)" ] || fail "a file was written for: $*"
}
refuses --help
refuses --chekc
refuses -o hmesh.hpp
refuses --check hmesh.hpp
refuses one.hpp two.hpp
refuses ''

"$source/scripts/amalgamate" one.hpp
"$source/scripts/amalgamate" one.hpp  # again, over what is there
[ "$(ls)" = one.hpp ] || fail "other files than the one asked for: $(ls)"
grep -q '^#endif' one.hpp || fail "it does not write the header"
ln -s one.hpp link.hpp
: >one.hpp
"$source/scripts/amalgamate" link.hpp
[ -L link.hpp ] || fail "a link, such as /dev/stdout is, was replaced by a file"
grep -q '^#endif' one.hpp || fail "a link is not followed"
mkfifo pipe
cat pipe >two.hpp &
"$source/scripts/amalgamate" pipe
wait
[ -p pipe ] || fail "a pipe was replaced by a file"
cmp one.hpp two.hpp || fail "a pipe does not get the bytes that a file gets"
