#!/usr/bin/env bash
# Which lines of include/hmesh do the tests execute? Builds the preset `coverage`, runs the tests and prints gcovr's table.
#
# usage: scripts/coverage.sh [LEAST]      LEAST: the per cent of the lines below which it fails, default 95
#
# A line counts as executed when one of its instantiations is, in one program. A template that nothing instantiates has no lines
# for gcov: such functions are looked for with ctags and named, and the script fails. What was not executed is marked in
# build/coverage/html/index.html.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
if [ $# -gt 1 ] || [[ ${1-} == -* ]]; then fail "usage: scripts/coverage.sh [LEAST]"; fi

need coverage cmake eigen doctest
build=build/coverage
step "Configuring $build ..." cmake --preset coverage
step "Building $build, unoptimised ..." cmake --build --preset coverage --parallel "$jobs"
find $build -name '*.gcda' -delete  # counts of former runs
ctest --preset coverage --parallel "$jobs" -LE "^viewers\$"

mkdir -p $build/html
status=0
gcovr --root . --filter 'include/hmesh/' --gcov-ignore-parse-errors --exclude-throw-branches -j "$jobs" --json $build/lines.json \
    --html-details $build/html/index.html --txt --fail-under-line "${1:-95}" $build/tests || status=$?

headers=$(find include/hmesh -name '*.hpp' -o -name '*.ipp' | LC_ALL=C sort)
# name, first line, last line, file: of each function that is defined in a header
# shellcheck disable=SC2086  # words: names of headers hold no spaces
ctags -x --language-force=C++ --kinds-C++=f --_xformat='%N	%n	%e	%F' -D HMESH_ALWAYS_INLINE=inline \
    -D HMESH_NEVER_INLINE= -D HMESH_COLD= --sort=no $headers >$build/functions.txt
python3 - $build/lines.json $build/functions.txt <<'PYTHON' || status=1
import json, sys
with open(sys.argv[1]) as file:
    lines = {entry["file"]: {line["line_number"] for line in entry["lines"]} for entry in json.load(file)["files"]}
unseen = 0
with open(sys.argv[2]) as file:
    for name, first, last, header in (line.rstrip("\n").split("\t") for line in file):
        if not lines.get(header, set()).intersection(range(int(first), int(last or first) + 1)):
            print(f"{header}:{first}: no test instantiates {name}")
            unseen += 1
sys.exit(unseen > 0)
PYTHON
exit $status
