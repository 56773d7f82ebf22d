#!/bin/bash
# The terrain of examples/heightmap.cpp lies on the ground: tests/heightmap_test.sh HEIGHTMAP_BINARY FILE.obj
set -eu
"$1" "$2"
awk '
    $1 == "v" { ++n; x[n] = $2; z[n] = $4 }
    $1 == "f" {
        ++faces
        up = (z[$3] - z[$2]) * (x[$4] - x[$2]) - (x[$3] - x[$2]) * (z[$4] - z[$2])  # of the normal
        if (up <= 0) ++wrong
    }
    END {
        printf "%d faces, of which %d do not look up\n", faces, wrong
        exit !(faces > 1000 && wrong == 0)
    }' "$2"
