#!/usr/bin/env bash
# Runs the command, with sanitizers and assertions, over images with options of every kind, alone and together: photographs at
# full size are what tests with small drawn pictures do not see.
#
# usage: scripts/options.sh IMAGE...      some three minutes for 0.4 megapixels and one core
# Prints the runs that end by a signal, by a finding or with a status above 1, with their output, and fails where there are any.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

[ $# -gt 0 ] || fail "usage: scripts/options.sh IMAGE..."
images=()
for image in "$@"; do
    [[ $image == /* ]] || image=$start_directory/$image
    [ -r "$image" ] || fail "there is no file $image"
    images+=("$image")
done

need compiler cmake eigen clang-sanitizers command
step "Configuring build/asan ..." cmake --preset asan
step "Building build/asan ..." cmake --build --preset asan --parallel "$jobs" --target hmesh_command
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The options of a run, a line each; IMAGE is the image, and files are written into the folder of this run.
options() {
    local bytes periodic method
    for bytes in 150 400 2500 6500; do printf -- '-o a.hmc --bytes %s --effort fast\n' $bytes; done
    printf -- '-o a.hmc --bytes 10000\n'
    for periodic in x y xy; do
        printf -- '-o a.ply --periodic %s --effort fast\n' $periodic
        printf -- '-o a.glb --periodic %s --straight-border --effort draft --rate 3\n' $periodic
    done
    for method in hierarchical xie adams adaptive_thinning; do printf -- '-o a.ply --method %s\n' $method; done
    cat <<'LINES'
-o a.glb -o a.svg -o a.pdf -o a.eps -o a.obj -o a.html -o a.ply --effort fast --strip a.png
-o a.svg --svg exact --effort draft
-o a.glb --effort draft --rate 4 --lods 6
-o a.glb --glb meshopt --effort fast --lods 3
-o a.ply --samples points --border-tolerance 6 --effort fast
-o a.ply --effort fast --rate 20
-o a.ply --effort draft --rate 60
-o a.ply --effort draft --rate 100
-o a.ply --rate 0.01
-o a.ply --grid 4 --effort fast --rate 25
-o a.ply --psnr 30 --effort fast
-o a.ply --max-vertices 3000 --good-enough 28 --effort draft
-o a.ply --tile 64 --effort fast --rate 5
-o a.ply --weights IMAGE --effort fast
-o a.glb --with other=IMAGE --channel-weights balanced --effort draft
-o a.glb --fit-space each --effort fast
-o a.glb --sprite --effort fast
-o a.glb --outline
LINES
}
command=$PWD/build/asan/bin/hmesh
runs=0 findings=0
for image in "${images[@]}"; do
    printf '%s ...\n' "${image##*/}"
    while read -ra words; do
        status=0
        (cd "$folder" && "$command" -q "$image" "${words[@]/IMAGE/$image}") >"$folder/said" 2>&1 </dev/null || status=$?
        runs=$((runs + 1))
        if [ $status -gt 1 ] || grep -qE 'Sanitizer|runtime error|Assertion' "$folder/said"; then
            findings=$((findings + 1))
            printf 'status %s: hmesh %s %s\n' $status "$image" "${words[*]}"
            cat "$folder/said"
        fi
    done < <(options)
done
printf '%s runs, %s findings\n' $runs $findings
[ $findings = 0 ]
