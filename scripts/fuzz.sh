#!/usr/bin/env bash
# Builds hmesh's fuzzers with clang++ and lets them look for inputs that break a promise.
#
# usage: scripts/fuzz.sh [--seconds N] [NAME...]
#        N: for each, default 600; NAME: of tests/fuzz/NAME_fuzzer.cpp, default all
# As many run at once as there are processors. Each starts from tests/fuzz/corpus/NAME and from what earlier runs left in
# build/fuzz/corpus/NAME; an input that breaks something ends it and is kept in build/fuzz/findings/NAME. Prints a line for
# each at the end, and fails where there is a finding. To see one again: build/fuzz/bin/NAME_fuzzer FILE.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage="usage: scripts/fuzz.sh [--seconds N] [NAME...]"
seconds=600
names=()
while [ $# != 0 ]; do
    case $1 in
        --seconds)
            if [ $# -lt 2 ] || ! [ "$2" -gt 0 ] 2>/dev/null; then fail "$usage"; fi
            seconds=$2
            shift 2
            ;;
        -*) fail "$usage" ;;
        *)
            [ -f "tests/fuzz/$1_fuzzer.cpp" ] || fail "there is no tests/fuzz/$1_fuzzer.cpp"
            names+=("$1")
            shift
            ;;
    esac
done
if [ ${#names[@]} = 0 ]; then
    for source in tests/fuzz/*_fuzzer.cpp; do
        name=${source##*/}
        names+=("${name%_fuzzer.cpp}")
    done
fi

# fuzz NAME: runs it and writes the line about it into build/fuzz/NAME.line.
fuzz() {
    local name=$1 log=build/fuzz/$1.log new=build/fuzz/corpus/$1 findings=build/fuzz/findings/$1 begin=$SECONDS
    local longest=1024
    [[ $name != read_* ]] || longest=8192  # image files
    mkdir -p "$new" "$findings"
    "build/fuzz/bin/${name}_fuzzer" -max_total_time="$seconds" -max_len="$longest" -len_control=0 -rss_limit_mb=4096 \
        -timeout=120 -report_slow_units=120 -print_final_stats=1 -artifact_prefix="$findings/" \
        "$new" "tests/fuzz/corpus/$name" >"$log" 2>&1 </dev/null || true
    awk -v name="$name" -v seconds="$((SECONDS - begin))" '
        / cov: / { for (i = 1; i < NF; i++) if ($i == "cov:") edges = $(i + 1) }
        /^stat::number_of_executed_units:/ { runs = $2 }
        /Test unit written to / { findings++; file = $NF }
        END {
            printf "%-12s %10d executions, %5d s, %6d edges, %d findings %s\n", name, runs, seconds, edges, findings, file
            if (runs == 0) print "             it did not run: see build/fuzz/" name ".log"
        }' "$log" >"build/fuzz/$name.line"
}
export -f fuzz
export seconds

need compiler cmake eigen clang-sanitizers command
step "Configuring build/fuzz ..." cmake --preset fuzz
step "Building build/fuzz ..." cmake --build --preset fuzz --parallel "$jobs" --target "${names[@]/%/_fuzzer}"
printf 'Fuzzing for %s s each: %s\n' "$seconds" "${names[*]}"
printf '%s\n' "${names[@]}" | xargs -P "$jobs" -I NAME bash -c 'fuzz NAME'
for name in "${names[@]}"; do cat "build/fuzz/$name.line"; done | tee build/fuzz/lines
! grep -qvE ' 0 findings $' build/fuzz/lines || fail "there are findings, or one did not run"
