#!/usr/bin/env bash
# Runs clang-tidy over sources, as many at once as there are processors, and prints what it finds: nothing if all is well.
#
# usage: scripts/tidy.sh [--all | FILE...]
#
# FILE: .cpp files. Without any: those of the commands' outermost folders and one test, which between them see every header of the
# library, and most of the tests'; those of a command are looked at as one file, in half the time, and not for arguments that
# need not be copied, which takes another third of it. That is a minute and a half of one core; --all, which is every source by
# itself and all checks, takes three quarters of an hour.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# together NAME FILE...: a file that includes these.
together() {
    local name=build/tidy/$1.cpp file
    shift
    mkdir -p build/tidy
    for file; do echo "#include \"$PWD/$file\"  // NOLINT(bugprone-suspicious-include)"; done >"$name"
    files+=("$name")
}
files=()
checks=
needed=(clang-tidy eigen command doctest)
case ${1-} in
    '')
        together hmesh tools/hmesh/*.cpp tools/hmesh/writers/formats.cpp
        together terrain tools/terrain/*.cpp
        files+=(tests/hierarchical_test.cpp)
        checks=--checks=-performance-unnecessary-value-param
        ;;
    --all)
        mapfile -t files < <(find tools examples tests benchmarks -name '*.cpp' | LC_ALL=C sort)
        needed+=(benchmark opengl)
        ;;
    -*) fail "usage: scripts/tidy.sh [--all | FILE...]" ;;
    *)
        for file in "$@"; do
            [[ $file == /* ]] || file=$start_directory/$file
            files+=("$file")
        done
        ;;
esac
need "${needed[@]}"

# The compile line is said here, so that nothing need be configured first.
for library in PNG=png.h JPEG=jpeglib.h WEBP=webp/demux.h TIFF=tiffio.h GDAL=gdal.h; do
    ! has_header "${library#*=}" || include_words+=" -DHMESH_HAS_${library%=*}"
done
export checks
# shellcheck disable=SC2086  # words
tidy() {
    clang_tidy $checks "$1" -- -std=c++17 -Iinclude -Iexamples -Itools -Itools/hmesh -Itools/pictures -Itests -Itests/fuzz $include_words
}
export -f tidy
# shellcheck disable=SC2016  # an argument of that shell
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$jobs" bash -c 'tidy "$1"' tidy || exit 1
