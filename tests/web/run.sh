#!/bin/sh
# Tests the package of packaging/npm that scripts/web.sh has built.
#
# usage: tests/web/run.sh PACKAGE COMMAND [--quick]
#        PACKAGE: the built package; COMMAND: the native command, or nothing; --quick: not with bundlers, deno and TypeScript
# What tests need beside node is found through NODE_PATH and CHROMIUM; those that lack it are skipped and say so.
# Exit status 77: there is no such package, or no node.
set -eu
case $#:${3-} in
    2: | 3:--quick) ;;
    *)
        echo "usage: tests/web/run.sh PACKAGE COMMAND [--quick]" >&2
        exit 2
        ;;
esac
[ -f "$1/hmesh.wasm" ] || { echo "skipped: there is no $1/hmesh.wasm, which scripts/web.sh builds"; exit 77; }
command -v node >/dev/null || { echo "skipped: there is no node"; exit 77; }
tests=$(dirname "$0") quick=${3-} HMESH_NPM=$(cd "$1" && pwd) HMESH_COMMAND=$2
export HMESH_NPM HMESH_COMMAND
set -- package placeholder command chromium
[ -n "$quick" ] || set -- "$@" bundlers
for name; do
    shift
    set -- "$@" "$tests/$name.test.mjs"
done
exec node --test "$@"
