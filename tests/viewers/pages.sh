#!/bin/sh
# Renders a PDF or EPS file with poppler and Ghostscript and compares with a picture of the same mesh.
#
# usage: tests/viewers/pages.sh PSNR FILE REFERENCE LEAST_POPPLER LEAST_GHOSTSCRIPT [DPI]
#        PSNR: the program of psnr.cpp; FILE: .pdf or .eps; REFERENCE: PNG or PPM, of DPI / 72 times the mesh's size;
#        LEAST_...: in dB; DPI: default 72
# Prints a line for each renderer. Exit status 0; 1 when a picture falls short; 77 when a program is missing, which it says.
#
# Neither is told to smooth: poppler and Ghostscript do not for shadings. Both paint more of a face than the pixels whose
# centres it holds - poppler all that it touches, Ghostscript half a pixel along its sides - so that a mesh of thin faces
# is drawn less exactly at 72 dpi than one of round faces, and any mesh more exactly at higher resolutions.
set -eu
[ $# -ge 5 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
psnr=$1 file=$2 reference=$3 least_poppler=$4 least_ghostscript=$5 dpi=${6-72}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
skipped=0

# judge NAME PICTURE LEAST
judge() {
    status=0
    got=$("$psnr" "$2" "$reference" "$3") || status=$?
    [ "$status" -le 1 ] || exit "$status"
    echo "$file, $1, $dpi dpi: $got (at least $3 dB)"
    failures=$((failures + status))
}
has() {
    command -v "$1" >/dev/null 2>&1 || { echo "$file: no $1, skipped" && skipped=1 && return 1; }
}

eps=
case $file in
    *.eps) eps=-dEPSCrop ;;
    *)
        if has pdftoppm; then
            pdftoppm -r "$dpi" -singlefile "$file" "$work/poppler"
            judge poppler "$work/poppler.ppm" "$least_poppler"
        fi
        ;;
esac
if has gs; then
    # shellcheck disable=SC2086  # nothing or one word
    gs -q -dSAFER -dBATCH -dNOPAUSE $eps -sDEVICE=ppmraw -r"$dpi" -sOutputFile="$work/gs.ppm" "$file" >"$work/log" 2>&1 ||
        { cat "$work/log" >&2; exit 1; }
    judge Ghostscript "$work/gs.ppm" "$least_ghostscript"
fi
[ "$failures" = 0 ] || exit 1
[ "$skipped" = 0 ] || exit 77
