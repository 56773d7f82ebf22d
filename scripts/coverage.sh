#!/usr/bin/env bash
# Which lines of include/hmesh do the tests execute? Builds the preset `coverage`, runs the tests and prints a table.
#
# usage: scripts/coverage.sh [LEAST]      LEAST: the per cent of the lines below which it fails, default 95
#
# A line counts as executed when one of its instantiations is, in one program. A template that nothing instantiates has no
# lines for gcov: such functions are looked for with ctags and named, and the script fails, as it does where no line of a
# header with functions is executed. The lines that are not executed are listed in build/coverage/missed.txt.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
if [ $# -gt 1 ] || [[ ${1-} == -* ]]; then fail "usage: scripts/coverage.sh [LEAST]"; fi

need coverage cmake eigen doctest
build=build/coverage
step "Configuring $build ..." cmake --preset coverage
step "Building $build, unoptimised ..." cmake --build --preset coverage --parallel "$jobs"
find $build -name '*.gcda' -delete  # counts of former runs
ctest --preset coverage --parallel "$jobs" -LE "^viewers\$"

headers=$(find include/hmesh -name '*.hpp' | LC_ALL=C sort)
# Of a unit whose program did not run there is no .gcda; it is read all the same, and nothing in it is executed.
find $build/tests -name '*.gcno' -print0 | LC_ALL=C sort -z |
    xargs -0 -n 1 gcov --stdout --relative-only --source-prefix "$PWD" >$build/gcov.txt 2>$build/gcov.log ||
    fail "gcov failed, see $build/gcov.log"
# name, first line, last line, file: of each function that is defined in a header
# shellcheck disable=SC2086  # words: names of headers hold no spaces
ctags -x --language-force=C++ --kinds-C++=f --_xformat='%N	%n	%e	%F' -D HMESH_ALWAYS_INLINE=inline \
    -D HMESH_NEVER_INLINE= --sort=no $headers >$build/functions.txt

# shellcheck disable=SC2086
LC_ALL=C awk -v least="${1:-95}" -v missed=$build/missed.txt '
function row(name, code, executed) {
    printf "%-44s %7d %9d %8s\n", name, code, executed, code ? sprintf("%.1f %%", 100 * executed / code) : "-"
}

FNR == 1 { file++ }

# gcov: "executions:line:text". Executions are "-" where there is no code, "#####" where it was not executed and "=====" where
# only an exception leads: closing braces, where memory is given back. Below a line with several instantiations, those of each
# follow.
file == 1 {
    split($0, part, ":")
    if (part[2] + 0 == 0) {
        if (part[3] == "Source") source = part[4]
    } else if (source ~ /^include\/hmesh\// && part[1] ~ /^ *([0-9]+\*?|#+)$/) {
        code[source, part[2] + 0] = 1
        if (part[1] + 0 > 0) executed[source, part[2] + 0] = 1
    }
    next
}

file == 2 {
    split($0, part, "\t")
    if (part[1] ~ /^__anon/) part[1] = "a lambda"
    functions[part[4]]++
    found = 0
    for (i = part[2]; i <= part[3]; i++) found += ((part[4], i) in code)
    if (!found) unseen[++unseens] = part[4] ":" part[2] ": " part[1]
    next
}

FNR == 1 { headers[++count] = FILENAME }
{ text[FILENAME, FNR] = $0; lines[FILENAME] = FNR }

END {
    printf "" >missed
    printf "%-44s %7s %9s %8s\n", "header", "lines", "executed", "per cent"
    for (i = 1; i <= count; i++) {
        header = headers[i]
        folder = header
        sub(/[^\/]*$/, "", folder)
        if (!(folder in folder_code)) folders[++folder_count] = folder
        header_code = header_executed = 0
        for (n = 1; n <= lines[header]; n++) {
            if (!((header, n) in code)) continue
            header_code++
            if ((header, n) in executed) header_executed++
            else print header ":" n ": " text[header, n] >missed
        }
        row(substr(header, 15), header_code, header_executed)
        folder_code[folder] += header_code
        folder_executed[folder] += header_executed
        if (functions[header] && !header_executed) dead[++deads] = header
    }
    print ""
    for (i = 1; i <= folder_count; i++) {
        row(folders[i], folder_code[folders[i]], folder_executed[folders[i]])
        all += folder_code[folders[i]]
        all_executed += folder_executed[folders[i]]
    }
    row("all", all, all_executed)
    for (i = 1; i <= unseens; i++) {
        print "instantiated by no test: " unseen[i]
        faults++
    }
    for (i = 1; i <= deads; i++) {
        print "no line is executed: " dead[i]
        faults++
    }
    if (100 * all_executed < least * all) {
        print "less than " least " % of the lines are executed, see " missed
        faults++
    }
    exit faults > 0
}' $build/gcov.txt $build/functions.txt $headers
