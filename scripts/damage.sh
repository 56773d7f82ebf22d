#!/usr/bin/env bash
# Damages image files of every kind that the command reads, and reads them: with the system's allocator, twice each over memory
# that was filled with other bytes before, and under the sanitizers with two fills.
#
# usage: scripts/damage.sh [COUNT]      how many files, default 100000; the same ones in each run
# Prints a table for each run, see tests/damaged/damaged_images.cpp, and keeps what breaks something in build/damaged. Fails where
# there is any, or where two runs have read a file as different pictures.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

count=${1:-100000}
if [ $# -gt 1 ] || ! [ "$count" -gt 0 ] 2>/dev/null; then fail "usage: scripts/damage.sh [COUNT]"; fi

need compiler cmake eigen command doctest pytest
python=python3
"$python" -c 'import PIL' 2>/dev/null || python=/usr/bin/python3
for preset in release asan; do
    step "Configuring build/$preset ..." cmake --preset "$preset"
    step "Building build/$preset ..." cmake --build --preset "$preset" --parallel "$jobs" --target damaged_images
done
rm -rf build/damaged
step "Drawing image files ..." "$python" -B tests/command/images.py build/damaged/whole

# damage PRESET FILL: the byte that the sanitizer's allocator fills memory with.
damage() {
    ASAN_OPTIONS=max_malloc_fill_size=1000000000:malloc_fill_byte=$2 \
        "build/$1/bin/damaged_images" "$count" build/damaged/whole "build/damaged/findings_$1_$2" >"build/damaged/$1_$2" 2>&1 ||
        findings=1
    printf '%s, memory filled with %s:\n' "$1" "$2"
    cat "build/damaged/$1_$2"
}
findings=0
damage release 53
damage asan 17
damage asan 238
[ $findings = 0 ] || fail "there are findings: see build/damaged"
for run in release_53 asan_238; do
    cmp -s build/damaged/asan_17 "build/damaged/$run" || fail "the table of $run is not that of asan_17"
done
