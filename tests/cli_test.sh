#!/bin/bash
# Tests the command line: tests/cli_test.sh HMESH_BINARY SCENE_BINARY
#
# Needs bash, coreutils, grep, sed and awk. Each check is a sentence; the sentences that do not hold are printed. Exit 0 or 1.
set -u
export LC_ALL=C
[ $# -eq 2 ] || { echo "usage: $0 HMESH_BINARY SCENE_BINARY" >&2; exit 2; }
for binary; do [ -x "$binary" ] || { echo "no program: $binary" >&2; exit 2; }; done
hmesh=$(realpath "$1")
scene=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
checks=0
failures=0

# check SENTENCE COMMAND...: the command must succeed.
check() {
    local sentence=$1
    shift
    checks=$((checks + 1))
    "$@" && return
    failures=$((failures + 1))
    echo "FAILED: $sentence"
    echo "  exit $status, command: hmesh ${last:-}"
    sed 's/^/  stderr: /' err
}
# run ARGUMENTS...: runs hmesh; leaves $status, out and err.
run() {
    last=$*
    "$hmesh" "$@" >out 2>err </dev/null
    status=$?
}
exits() { [ "$status" -eq "$1" ]; }
says() { grep -qF -e "$1" err; }
is_silent() { [ ! -s out ] && [ ! -s err ]; }
is_one_sentence() { [ "$(wc -l <err)" -eq 1 ] && grep -q '^hmesh: ' err; }
no_part_is_left() { [ -z "$(find . -name '*.part*')" ]; }
# json_value FILE KEY: the first value of the key, as it stands.
json_value() { sed -nE "s/^ *\"$2\": (.*[^,]),?\$/\1/p" "$1" | head -n 1; }
has() { [ "$(json_value "$1" "$2")" = "$3" ]; }
# Replaces strings and numbers by letters, then whole objects and arrays, until one letter is left.
is_json() {
    [ "$(tr '\n' ' ' <"$1" | sed -E 's/"([^"\\]|\\["\\\/bfnrt]|\\u[0-9a-fA-F]{4})*"/S/g
        s/-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?/N/g; s/null|true|false/N/g; s/ //g
        :a; s/\{(S:[SNV](,S:[SNV])*)?\}/V/g; s/\[([SNV](,[SNV])*)?\]/V/g; ta')" = V ]
}
is_ply() { head -c 4 "$1" | grep -q ply && grep -aq '^end_header' "$1"; }
is_png() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ]; }
begins_with() { head -c "$((${#2} + 1))" "$1" | grep -aqF -e "$2"; }
# is_whole FILE: its first bytes name its kind, and its end is there.
is_whole() {
    case $1 in
        *.ply) is_ply "$1" ;;
        *.obj) begins_with "$1" '# made by hmesh' && tail -n 1 "$1" | grep -Eqx 'f [0-9]+ [0-9]+ [0-9]+' ;;
        *.glb) begins_with "$1" glTF && [ "$(od -An -tu4 -j8 -N4 --endian=little "$1")" -eq "$(wc -c <"$1")" ] ;;
        *.pdf) begins_with "$1" %PDF-1 && [ "$(tail -c 6 "$1")" = %%EOF ] ;;
        *.eps) begins_with "$1" '%!PS-Adobe-3.0 EPSF-3.0' && [ "$(tail -c 6 "$1")" = %%EOF ] ;;
        *.svg) begins_with "$1" '<svg ' && [ "$(tail -c 7 "$1")" = '</svg>' ] ;;
        *.html) begins_with "$1" '<!DOCTYPE html>' && [ "$(tail -c 8 "$1")" = '</html>' ] ;;
    esac
}
kinds="ply obj glb pdf eps svg html"
all_kinds=()  # for a mesh named x
for kind in $kinds; do all_kinds+=(-o "x.$kind"); done
# original_of FILE: the bytes of the picture in an .html file.
original_of() { sed -nE 's/.*src="data:image\/[a-z]+;base64,([^"]*)".*/\1/p' "$1" | base64 -d; }
png_size() { od -An -tu4 -j16 -N8 --endian=big "$1" | tr -s ' ' ' '; }
ply_has() { sed '/^end_header/q' "$1" | grep -aqx "$2"; }

# ---- small pictures --------------------------------------------------------------------------------------------------
# samples W H "EXPRESSIONS": for each pixel the bytes that bash computes from x and y.
samples() {
    local text='' x y e
    for ((y = 0; y < $2; ++y)); do
        for ((x = 0; x < $1; ++x)); do
            for e in $3; do printf -v byte '\\x%02x' $((e)); text+=$byte; done
        done
    done
    printf "$text"
}
grey='x*x/3+y*(20-y)+(x&3)*8'
low='(x*37+y*91)%256'  # the lower bytes of 16-bit samples: noise below 1/255
{ printf 'P5\n# a comment\n20 16\n255\n'; samples 20 16 "$grey"; } >grey.pgm
{ printf 'P5 20 16 65535\n'; samples 20 16 "$grey $low"; } >grey16.pgm
{ printf 'P6\n20 16\n255\n'; samples 20 16 "$grey y*15 x*12"; } >color.ppm
{ printf 'P6\n20 16\n65535\n'; samples 20 16 "$grey $low y*15 $low x*12 $low"; } >color16.ppm
{ printf '\0\0\2\0\0\0\0\0\0\0\0\0\x14\0\x10\0\x20\x28'; samples 20 16 "x*12 y*15 $grey 255-x*5"; } >rgba.tga
{ printf '\0\0\3\0\0\0\0\0\0\0\0\0\x14\0\x10\0\x10\x28'; samples 20 16 "$grey 255-x*5"; } >grey_alpha.tga
{ printf 'P5\n8 8\n255\n'; samples 8 8 '77'; } >constant.pgm
# jpeg EXIF: 16 x 8 px of one grey, all tables as short as can be, after a segment of Exif.
jpeg() {
    printf "\\xff\\xd8$1\\xff\\xdb\\0\\x43\\0"
    printf '\1%.0s' {1..64}
    printf '\xff\xc0\0\x0b\x08\0\x08\0\x10\1\1\x11\0'
    for class in '\0' '\x10'; do printf "\\xff\\xc4\\0\\x14$class\\1" && printf '\0%.0s' {1..16}; done
    printf '\xff\xda\0\x08\1\1\0\0\x3f\0\x0f\xff\xd9'
}
turned='\xff\xe1\0\x22Exif\0\0MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0'
turned_little='\xff\xe1\0\x22Exif\0\0II*\0\x08\0\0\0\1\0\x12\1\3\0\1\0\0\0\6\0\0\0\0\0\0\0'
upright=${turned/\\6/\\1}
jpeg '' >plain.jpg
jpeg "$turned" >turned.jpg
jpeg "$turned_little" >turned_little.jpg
jpeg "$upright" >upright.jpg
printf 'P5 1 1 255\nA' >one.pgm
printf 'P5 5 1 255\nA0a9Z' >row.pgm
printf 'P6\n20 16\n255\nshort' >short.ppm
printf 'P5 99999999 99999999 255\nx' >huge.pgm
printf 'P5 2 2 100\n\144\144\145\144' >above.pgm
printf 'this is no image\n' >text.png
: >empty.png
status=0
: >err

"$scene" picture.png 96 64 2>err || status=$?
check "scene draws a PNG file" is_png picture.png
"$scene" again.png 96 64
check "scene draws the same bytes twice" cmp -s picture.png again.png
"$scene" picture.png 0 64 2>err; status=$?
check "scene refuses a width of 0 with exit 2" exits 2
"$scene" missing/picture.png 8 8 2>err; status=$?
check "scene fails with exit 1 where it cannot write" exits 1
check "scene names the file that it cannot write" says missing/picture.png

# ---- help, version, usage --------------------------------------------------------------------------------------------
run --help
check "--help exits 0" exits 0
check "--help prints the options on stdout" grep -q -e --wireframe out
run --version
check "--version exits 0" exits 0
check "--version prints name and version" grep -Eqx 'hmesh [0-9]+\.[0-9]+\.[0-9]+' out

# wrong VALUE ARGUMENTS...: exit 2, a sentence that holds VALUE, a hint, nothing on stdout.
wrong() {
    local value=$1
    shift
    run "$@"
    check "wrong usage exits 2" exits 2
    check "the message for wrong usage holds: $value" says "$value"
    check "wrong usage hints at --help" says --help
    check "wrong usage prints nothing on stdout" test ! -s out
}
wrong "no input"
wrong "two.png" grey.pgm two.png
wrong "--frobnicate" grey.pgm --frobnicate
wrong "-x" grey.pgm -x
wrong "--vertices needs a value" grey.pgm --vertices
wrong "-o needs a value" grey.pgm -o
wrong "-o" grey.pgm -o ''
wrong "'12x'" grey.pgm --vertices 12x
wrong "'1.5'" grey.pgm --vertices 1.5
wrong "' 5'" grey.pgm --vertices=' 5'
wrong "99999999999999999999" grey.pgm --vertices 99999999999999999999
wrong "'nan'" grey.pgm --rate nan
wrong "'inf'" grey.pgm --psnr inf
wrong "'1e999'" grey.pgm --psnr 1e999
wrong "'0x10'" grey.pgm --rate 0x10
wrong "'1,5'" grey.pgm --rate 1,5
wrong "'0'" grey.pgm --rate 0
wrong "'-1'" grey.pgm --rate -1
wrong "'100.1'" grey.pgm --rate 100.1
wrong "'-3'" grey.pgm --seed -3
wrong "18446744073709551616" grey.pgm --seed 18446744073709551616
wrong "--rate" grey.pgm --vertices 20 --rate 2
wrong "--psnr" grey.pgm --rate 2 --psnr 30
wrong "twice" grey.pgm --seed 1 --seed 2
wrong "'-1' must be from 0 to 1024" grey.pgm --threads -1
wrong "'1025' must be from 0 to 1024" grey.pgm --threads 1025
wrong "'two' is not a whole number" grey.pgm --threads two
wrong "'63' must be from 64 to 65536" grey.pgm --tile 63
wrong "'65537' must be from 64 to 65536" grey.pgm --tile 65537
wrong "'1e3' is not a whole number" grey.pgm --tile 1e3
wrong "--weights needs a value" grey.pgm --weights
wrong "twice" grey.pgm --weights grey.pgm --weights grey.pgm
wrong "'slow' is not one of: draft, fast, normal, best" grey.pgm --effort slow
wrong "'magic' is not one of: annealed, hierarchical, xie, adams, adaptive_thinning" grey.pgm --method magic
wrong "'magic' is not one of: optimal, sampled" grey.pgm --colors magic
wrong "--method needs a value" grey.pgm --method
wrong "--colors needs a value" grey.pgm --colors
wrong "twice" grey.pgm --method xie --method xie
wrong "'light' is not one of: stored, linear" grey.pgm --fit-space light
wrong "'mesh.xyz' must end in one of: .ply, .obj, .glb, .pdf, .eps, .svg, .html" grey.pgm -o mesh.xyz
wrong "'.svg' must end in one of" grey.pgm -o .svg
wrong "'Exact' is not one of: gradient, exact, flat" grey.pgm -o a.svg --svg Exact
wrong "'mesh' is not one of: gradient, exact, flat" grey.pgm -o a.svg --svg=mesh
wrong "--svg is given without an output that ends in .svg" grey.pgm -o a.pdf --svg exact
wrong "--svg is given twice" grey.pgm -o a.svg --svg exact --svg flat
wrong "'0' must be from 1 to 16" grey.pgm --render a.png --render-scale 0
wrong "'17' must be from 1 to 16" grey.pgm --render a.png --render-scale 17
wrong "--render-scale is given without --render" grey.pgm --wireframe a.png --render-scale 2
wrong "'x.pdf' must end in .png" grey.pgm --residual x.pdf
wrong "'x' must end in .png" grey.pgm --strip x
wrong "--depfile is given without another output" grey.pgm --depfile a.d
wrong "--depfile needs a value" grey.pgm -o a.ply --depfile
wrong "named for two outputs" grey.pgm -o a.ply --report a.d --depfile ./a.d
wrong "overwrite the weights" grey.pgm -o a.ply --weights picture.png --depfile picture.png
wrong "'mesh'" grey.pgm -o mesh
wrong "'x.jpg' must end in .png" grey.pgm --render x.jpg
wrong "'x' must end in .png" grey.pgm --wireframe x
wrong "named for two outputs" grey.pgm -o a.ply -o ./a.ply
wrong "named for two outputs" grey.pgm --render a.png --wireframe a.png
wrong "named for two outputs" grey.pgm --residual a.png --strip a.png
wrong "named for two outputs" grey.pgm -o a.svg -o ./a.svg
wrong "overwrite the input" picture.png --render picture.png
wrong "overwrite the input" picture.png --residual ./picture.png
wrong "overwrite the input" picture.png --strip picture.png
wrong "overwrite the weights" grey.pgm --weights picture.png --render ./picture.png
check "a refused command line leaves the input as it was" cmp -s picture.png again.png
check "refused command lines leave no file" test ! -e a.ply -a ! -e a.png -a ! -e a.svg -a ! -e a.pdf

# ---- failures --------------------------------------------------------------------------------------------------------
# fails VALUE ARGUMENTS...: exit 1, one sentence on stderr that holds VALUE.
fails() {
    local value=$1
    shift
    run "$@"
    check "a failure exits 1" exits 1
    check "a failure says one sentence" is_one_sentence
    check "the sentence holds: $value" says "$value"
}
echo old >keep.ply
fails "'missing.png'" missing.png -o keep.ply
fails "'empty.png'" empty.png -o keep.ply
fails "'text.png'" text.png -o keep.ply
fails "'short.ppm': the file ends before its last pixel" short.ppm -o keep.ply
fails "'huge.pgm': the image is too wide" huge.pgm -o keep.ply
fails "'above.pgm'" above.pgm -o keep.ply
fails "'.'" . -o keep.ply
fails "'missing.png'" grey.pgm --weights missing.png -o keep.ply
fails "'text.png'" grey.pgm --weights text.png -o keep.ply
fails "'constant.pgm' are 8 x 8 px, the image is 20 x 16 px" grey.pgm --weights constant.pgm -o keep.ply
fails "--vertices 3" grey.pgm -o keep.ply --vertices 3
fails "got 3" grey.pgm -o keep.ply --vertices 3
fails "--vertices -5" grey.pgm -o keep.ply --vertices -5
fails "--vertices 321" grey.pgm -o keep.ply --vertices 321
fails "limit 320" grey.pgm -o keep.ply --vertices 321
check "a failure leaves the file that was there" grep -qx old keep.ply
fails "'nowhere/mesh.ply'" grey.pgm -o nowhere/mesh.ply
fails "'nowhere/r.d'" grey.pgm -o good.ply --depfile nowhere/r.d
fails "'nowhere/r.json'" grey.pgm -o good.ply --report nowhere/r.json
check "nothing is written when another output cannot be" test ! -e good.ply
mkdir -p directory.ply
fails "'directory.ply'" grey.pgm -o directory.ply
if [ "$(id -u)" -ne 0 ]; then
    mkdir -p locked && chmod a-w locked
    fails "'locked/mesh.ply'" grey.pgm -o locked/mesh.ply
fi
# A full disk. Nobody but root could replace the system's device by a file; root gets one of its own, in this directory.
make_full_device() {
    if [ "$(id -u)" -eq 0 ]; then mknod full.device c 1 7 2>/dev/null; else ln -s /dev/full full.device; fi
    { echo x >full.device; } 2>&1 | grep -q 'No space left'
}
if make_full_device; then
    for file in full.png full.json; do ln -s full.device $file; done
    for kind in $kinds; do
        ln -s full.device full.$kind
        fails "'full.$kind'" grey.pgm -o full.$kind
        check "a full disk is the reason for no $kind" says "No space left"
        check "a link to a device is not replaced by a $kind file" test -L full.$kind
    done
    for option in --render --wireframe --residual --strip; do fails "'full.png'" grey.pgm $option full.png; done
    fails "'full.json'" grey.pgm --report full.json
    fails "'full.device'" grey.pgm --report full.device
    check "a full disk is named as the reason" says "No space left"
    check "a link to a device is not replaced" test -L full.png -a -L full.json
    check "a device is not replaced" test -c full.device
else
    echo "skipped: no full device can be made here"
fi
if [ -c /dev/full ]; then
    "$hmesh" grey.pgm >/dev/full 2>err; status=$?
    check "a full standard output exits 1" exits 1
fi
# The disk fills up while a file is written: what was there stays. 1 KiB is less than any of these files.
for kind in $kinds; do
    echo old >"keep.$kind"
    last="-o keep.$kind, no file above 1 KiB"
    (trap '' XFSZ && ulimit -f 1 && "$hmesh" picture.png --vertices 100 -o "keep.$kind" >out 2>err </dev/null); status=$?
    check "a $kind file that the disk cannot hold exits 1" exits 1
    check "a $kind file that the disk cannot hold is named" says "'keep.$kind'"
    check "a $kind file that the disk cannot hold leaves what was there" grep -qx old "keep.$kind"
done
check "failures leave no half-written file" no_part_is_left

# ---- success ---------------------------------------------------------------------------------------------------------
run picture.png -o mesh.ply -o second.PLY --vertices 100 --render render.png --wireframe wire.png --report report.json
check "a mesh, pictures and a report are written with exit 0" exits 0
check "the mesh is a PLY file" is_ply mesh.ply
check "-o may be given more than once, its ending in any case" cmp -s mesh.ply second.PLY
check "the mesh has the number of vertices asked for" ply_has mesh.ply 'element vertex 100'
check "the rendered mesh is a PNG file" is_png render.png
check "the wireframe is a PNG file" is_png wire.png
check "piped output has no progress bar and no message" test ! -s err
check "stdout names vertices" grep -Eq '^vertices +100$' out
check "stdout names the PSNR and its convention" grep -Eq '^PSNR +[0-9.]+ dB .*pixels and channels' out
check "stdout names the time" grep -Eq '^time +[0-9.]+ s$' out
for file in mesh.ply second.PLY render.png wire.png report.json; do
    check "stdout names the file written: $file" grep -Eq "^written +$file\$" out
done
check "the report is JSON" is_json report.json
for key in version input width height channels bits method effort colors fit_space premultiplied seed weights tile target status \
    vertices faces psnr psnr_convention energy seconds stages; do
    check "the report holds $key" grep -q "^  \"$key\": " report.json
done
check "the report's width is the image's" has report.json width 96
check "the report's channels are the image's" has report.json channels 3
check "the report's bits are the image's" has report.json bits 8
check "the report's vertices are the mesh's" has report.json vertices 100
check "the report's faces are the mesh's" ply_has mesh.ply "element face $(json_value report.json faces)"
stage='\{"name": "[^"]+", "vertices": [0-9]+, "energy": [0-9.e+]+, "psnr": [0-9.]+, "seconds": [0-9.]+\}'
check "the report holds name, vertices, energy, PSNR and seconds of each stage" grep -Eq "$stage" report.json
check "every stage was timed" test "$(grep -c '"name"' report.json)" -eq "$(grep -Ec "$stage" report.json)"
check "the report says what its PSNR is" has report.json psnr_convention \
    '"10 log10(peak^2 / MSE) in dB, MSE the mean over pixels and channels of the image'"'"'s stored values"'
check "energy and psnr agree by the convention" awk -v e="$(json_value report.json energy)" -v p="$(json_value report.json psnr)" \
    'BEGIN { q = 10 * log(255 * 255 * 96 * 64 * 3 / e) / log(10); exit !(q - p < 1e-6 && p - q < 1e-6) }'

run render.png --report render.json
check "the rendered picture has the image's width" has render.json width 96
check "the rendered picture has the image's height" has render.json height 64

run picture.png -o again.ply --vertices 100 --seed 1
check "two runs with one seed write the same bytes" cmp -s mesh.ply again.ply
run -o dashes.ply --vertices=100 --seed=1 -- picture.png
check "--option=value and -- mean the same" cmp -s mesh.ply dashes.ply
run picture.png -o again.ply --vertices 100 --threads 1
check "--threads 1 writes the same bytes as all cores" cmp -s mesh.ply again.ply
run picture.png -o again.ply --vertices 100 --threads 3
check "--threads 3 writes the same bytes as all cores" cmp -s mesh.ply again.ply
"$scene" wide.png 160 140
run wide.png -o whole.ply --vertices 1400 --effort fast
run wide.png -o tiles.ply --vertices 1400 --effort fast --tile 64 --threads 1 --report tile.json
check "--tile exits 0" exits 0
check "the report names the tile" has tile.json tile 64
check "tiles make another mesh than the image in one piece" test "$(cmp whole.ply tiles.ply | wc -l)" -eq 1
run wide.png -o again.ply --vertices 1400 --effort fast --tile 64 --threads 3
check "tiles shared among three threads make the mesh that one makes" cmp -s tiles.ply again.ply
for file in grey.pgm grey16.pgm color.ppm color16.ppm grey_alpha.tga rgba.tga; do
    run grey.pgm --weights $file --report weights.json
    check "$file serves as weights" exits 0
    check "the report says that its PSNR is weighted" grep -q '"psnr_convention": .*, each as often as its weight' weights.json
    check "the report names the weights $file" has weights.json weights "\"$file\""
done
run picture.png -o quiet.ply --quiet
check "--quiet exits 0" exits 0
check "--quiet prints nothing" is_silent
check "--quiet writes the mesh" is_ply quiet.ply
run picture.png --report default.json
check "the default is one vertex for 100 pixels" has default.json vertices 61
run picture.png --psnr 24 --report psnr.json
check "--psnr exits 0" exits 0
check "--psnr reaches the PSNR" awk -v p="$(json_value psnr.json psnr)" 'BEGIN { exit !(p + 0 >= 24) }'
check "the report of a search is JSON with timed stages" is_json psnr.json
check "stages of a search are timed" grep -Eq "$stage" psnr.json
run picture.png --effort draft --vertices 80 --report draft.json
check "the report names the effort" has draft.json effort '"draft"'

# ---- what colours are fitted for -------------------------------------------------------------------------------------
run rgba.tga -o straight.html --vertices 40
run rgba.tga -o pre.html -o pre.glb -o pre.ply --vertices 40 --premultiplied --render pre.png --strip pre_strip.png --report pre.json
check "--premultiplied exits 0" exits 0
check "the report says premultiplied" has pre.json premultiplied true
check "a page of premultiplied colours says so" grep -q 'premultiplied: true' pre.html
check "a page of straight colours says so" grep -q 'premultiplied: false' straight.html
check "a premultiplied mesh is drawn" is_png pre.png
run color.ppm --vertices 40 --premultiplied
check "an image without alpha cannot be premultiplied" exits 1
check "and is told why" says "which those of 2 or 4 channels have"
run picture.png -o stored.glb --vertices 100
run picture.png -o linear.glb --vertices 100 --fit-space linear --residual linear.png --report linear.json
check "--fit-space linear exits 0" exits 0
check "colours for linear light are others" test "$(cmp -s stored.glb linear.glb; echo $?)" = 1
check "the report names the fit space" has linear.json fit_space '"linear"'
run picture.png --vertices 100 --fit-space linear --colors sampled
check "sampled colours are not fitted" exits 1

# ---- methods and colours ---------------------------------------------------------------------------------------------
# means METHOD COLORS: what the method's own colours are.
means() {
    run picture.png -o own.ply --vertices 90 --method "$1" --report own.json
    check "--method $1 exits 0" exits 0
    check "the report names the method $1" has own.json method "\"$1\""
    check "the report names the colours of the method $1" has own.json colors "\"$2\""
    check "the mesh of the method $1 has the vertices asked for" ply_has own.ply 'element vertex 90'
    check "the report of the method $1 is JSON" is_json own.json
    for colors in optimal sampled; do
        run picture.png -o $colors.ply --vertices 90 --method "$1" --colors $colors --report $colors.json
        check "--method $1 --colors $colors exits 0" exits 0
        check "the report names the colours asked for" has $colors.json colors "\"$colors\""
    done
    check "without --colors the method $1 has $2 ones" cmp -s own.ply "$2.ply"
    check "optimal colours fit better than sampled ones" awk -v o="$(json_value optimal.json psnr)" \
        -v s="$(json_value sampled.json psnr)" 'BEGIN { exit !(o + 0 > s + 0) }'
}
means annealed optimal
means adams sampled
check "stages that solve nothing have no iterations" test "$(grep -c iterations own.json)" -eq 0
means adaptive_thinning sampled
means xie sampled
means hierarchical optimal
solve='\{"name": "geometry", .*, "iterations": [1-9][0-9]*, "residual": [0-9.]+(e-[0-9]+)?\}'
check "the report holds iterations and residual of the four geometry steps" test "$(grep -Ec "$solve" own.json)" -eq 4
check "the report holds them of no other stage" test "$(grep -c iterations own.json)" -eq 4
# ---- formats and pictures --------------------------------------------------------------------------------------------
run picture.png "${all_kinds[@]}" --vertices 100
check "all formats are written at once" exits 0
for kind in $kinds; do
    check "a whole file is written as $kind" is_whole x.$kind
    check "stdout names the file written: x.$kind" grep -Eq "^written +x.$kind\$" out
done
check "the same mesh is written beside other formats" cmp -s x.ply mesh.ply
faces=$(json_value report.json faces)
check "the OBJ file has the mesh's faces" test "$(grep -c '^f ' x.obj)" -eq "$faces"
check "the SVG file has the mesh's faces" test "$(grep -c '<path ' x.svg)" -eq "$faces"
check "the PDF file is deflated" grep -aq /FlateDecode x.pdf
check "the EPS file is deflated" grep -aq /FlateDecode x.eps
check "the page is named after the input" grep -q '<title>picture.png</title>' x.html
check "the page says how many vertices and faces" grep -q "100 vertices" x.html
check "the page says how many faces" grep -qx "$faces faces" x.html
check "the page says the PSNR" grep -qx "PSNR $(printf '%.2f' "$(json_value report.json psnr)") dB" x.html
check "the page says the PSNR's convention" grep -qF 'MSE over pixels and channels' x.html
original_of x.html >original.png
check "the page holds the PNG file that was meshed" cmp -s original.png picture.png
for file in plain upright; do
    run $file.jpg -o x.html
    original_of x.html >original.jpg
    check "the page holds a JPEG file that is shown as it is stored: $file" cmp -s original.jpg $file.jpg
done
for file in turned turned_little; do
    run $file.jpg -o x.html
    original_of x.html >original.png
    check "the page holds as PNG a JPEG file that browsers would turn: $file" is_png original.png
    check "what the page holds is turned as the tags say: $file" test "$(png_size original.png)" = ' 8 16'
done
run grey_alpha.tga -o x.html --vertices 40
original_of x.html >original.png
check "the page holds other images as PNG" is_png original.png
check "the page's PNG has the image's size" test "$(png_size original.png)" = ' 20 16'
run original.png --report original.json
check "the page's PNG has the image's channels" has original.json channels 2
for kind in gradient exact flat; do
    run picture.png -o $kind.svg --svg $kind --vertices 100
    check "--svg $kind is written" is_whole $kind.svg
done
check "the default is --svg gradient" cmp -s x.svg gradient.svg
check "--svg exact blends layers" grep -q mix-blend-mode:screen exact.svg
check "--svg flat has no gradients" test "$(grep -c linearGradient flat.svg)" -eq 0

run picture.png --vertices 100 --render big.png --render-scale 3 --residual residual.png --strip strip.png
check "pictures of the error and the strip exit 0" exits 0
check "--render-scale 3 draws at three times the size" test "$(png_size big.png)" = ' 288 192'
check "--residual draws at the image's size" test "$(png_size residual.png)" = ' 96 64'
check "--strip draws four pictures with 4 px between" test "$(png_size strip.png)" = ' 396 64'
run constant.pgm --residual residual.png
run residual.png --report residual.json
check "where nothing is lost the residual is plain" has residual.json psnr '"inf"'

ln -s real.ply link.ply
: >real.ply
run grey.pgm -o link.ply
check "a symbolic link is followed, not replaced" test -L link.ply -a -s real.ply
mkdir later
ln -s later/new.ply first.ply
ln -s "$PWD/first.ply" second.ply
run grey.pgm -o second.ply
check "links to a file that does not exist yet are followed" test -L second.ply -a -L first.ply -a -s later/new.ply
ln -s loop.ply loop.ply
run grey.pgm -o loop.ply
check "a link to itself cannot be written" exits 1
check "a link to itself is left" test -L loop.ply
: >private.ply
chmod 600 private.ply
run grey.pgm -o private.ply
check "who may read a file stays as it was" test "$(stat -c %a private.ply)" = 600
if (ulimit -v 1000000 && "$hmesh" --version) >out 2>err; then  # not with the address sanitizer
    { printf 'P5 1024 1024 255\n' && head -c 1048576 /dev/zero; } >flat.pgm
    last="flat.pgm --render none.png --render-scale 16, which takes 1 GiB, within 1 GB"
    (ulimit -v 1000000 && "$hmesh" flat.pgm --vertices 4 --effort draft --render none.png --render-scale 16 >out 2>err </dev/null)
    status=$?
    check "where there is no memory hmesh exits 1" exits 1
    check "where there is no memory hmesh says so" is_one_sentence
    check "where there is no memory no file is left" test ! -e none.png
    check "where there is no memory no part of a file is left" no_part_is_left
fi

# ---- what was read for what is written --------------------------------------------------------------------------------
cp grey.pgm 'a #1 $2.pgm'
run 'a #1 $2.pgm' -o 'b $.ply' --report b.json --weights constant.pgm --depfile b.d
check "weights of another size make no depfile" test ! -e b.d
run 'a #1 $2.pgm' -o 'b $.ply' --report b.json --weights grey.pgm --depfile b.d
check "--depfile exits 0" exits 0
check "the depfile names what was written and what was read" test "$(cat b.d)" = \
    "$(printf '%s \\\n  %s \\\n  %s' 'b\ $$.ply b.json:' 'a\ \#1\ $$2.pgm' grey.pgm)"
if command -v make >/dev/null; then
    printf 'include b.d\nb\\ $$.ply:\n\techo again\n' >makefile
    check "make reads the depfile: nothing is to be done" make -q 'b $.ply'
    sleep 0.1 && touch grey.pgm
    check "make sees that the weights are newer" test "$(make -s 'b $.ply')" = again
fi

# ---- depths and channels ---------------------------------------------------------------------------------------------
# meshes FILE CHANNELS BITS PROPERTY
meshes() {
    run "$1" -o "$1.ply" "${all_kinds[@]}" --vertices 40 --report "$1.json" --render "$1.png" --wireframe "$1.wire.png" \
        --residual "$1.residual.png" --strip "$1.strip.png"
    check "$1 becomes a mesh" exits 0
    check "$1 has $2 channels" has "$1.json" channels "$2"
    check "$1 has $3 bits" has "$1.json" bits "$3"
    check "the mesh of $1 has the property $4" ply_has "$1.ply" "property uchar $4"
    check "the mesh of $1 is drawn" is_png "$1.png"
    check "the mesh of $1 is drawn with edges" is_png "$1.wire.png"
    check "the error of $1 is drawn" is_png "$1.residual.png"
    check "the strip of $1 is drawn" is_png "$1.strip.png"
    for kind in $kinds; do check "$1 is written as $kind" is_whole x.$kind; done
}
meshes grey.pgm 1 8 intensity
meshes grey16.pgm 1 16 intensity
meshes grey_alpha.tga 2 8 alpha
meshes color.ppm 3 8 blue
meshes color16.ppm 3 16 blue
meshes rgba.tga 4 8 alpha
# Bytes in the wrong order would make noise of 10 dB.
for name in grey.pgm:grey16.pgm color.ppm:color16.ppm; do
    run "${name%:*}" --vertices 8 --report eight.json
    run "${name#*:}" --vertices 8 --report sixteen.json
    check "a picture in 8 and 16 bits gives the same PSNR within 1 dB" \
        awk -v a="$(json_value eight.json psnr)" -v b="$(json_value sixteen.json psnr)" \
        'BEGIN { exit !(a > 20 && a - b < 1 && b - a < 1) }'
done
run one.pgm -o one.ply --vertices 4
check "an image of one pixel becomes a mesh" exits 0
check "the mesh of one pixel has four vertices" ply_has one.ply 'element vertex 4'
run row.pgm -o row.ply
check "an image of one row becomes a mesh" exits 0
run constant.pgm --report constant.json
check "a constant image exits 0" exits 0
check "a constant image has the PSNR \"inf\" in the report" has constant.json psnr '"inf"'
check "a constant image has the PSNR inf on stdout" grep -Eq '^PSNR +inf ' out
check "the report of a constant image is JSON" is_json constant.json
odd=$'odd "name" \\ \t\xff.pgm'
cp grey.pgm "$odd"
run "$odd" --report odd.json
check "a name with quotes, tabs and no UTF-8 exits 0" exits 0
check "a name with quotes, tabs and no UTF-8 is escaped in the report" is_json odd.json

# ---- terminal and Ctrl-C ---------------------------------------------------------------------------------------------
if command -v script >/dev/null && script -qec true /dev/null >/dev/null 2>&1 </dev/null; then
    script -qec "'$hmesh' picture.png --vertices 100" /dev/null >out 2>err </dev/null
    check "a progress bar is drawn on a terminal" grep -q '\[#*\.*\].* vertices' out
    script -qec "'$hmesh' picture.png --vertices 100 --quiet" /dev/null >out 2>err </dev/null
    check "--quiet draws no progress bar" test ! -s out
fi
# interrupt SECONDS ARGUMENTS...: runs hmesh and sends SIGINT after so many seconds; leaves $status, out and err.
interrupt() {
    local seconds=$1
    shift
    last="$*, interrupted"
    "$hmesh" "$@" >out 2>err </dev/null &
    local job=$!
    sleep "$seconds"
    kill -INT $job 2>/dev/null
    wait $job
    status=$?
}
# Both would take more than 5 s on any machine: two threads, however many cores there are.
"$scene" large.png 320 200
interrupt 1 large.png -o cancelled.ply --effort best --vertices 6000 --threads 2 --report cancelled.json
check "Ctrl-C exits 1" exits 1
check "Ctrl-C is told in one sentence" is_one_sentence
check "the sentence says why it ended" says ': interrupted; '
check "the sentence says that the mesh reached so far is written" says "the mesh reached so far, "
check "Ctrl-C leaves a PLY file" is_ply cancelled.ply
check "the mesh of a cancelled run has the report's vertices" \
    ply_has cancelled.ply "element vertex $(json_value cancelled.json vertices)"
check "the report of a cancelled run is JSON" is_json cancelled.json
check "the report of a cancelled run says so" has cancelled.json status '"interrupted"'
interrupt 1 large.png -o search.ply --psnr 60 --effort normal --threads 2
check "Ctrl-C ends a search for a PSNR with exit 1" exits 1
check "Ctrl-C in a search is told" says ': interrupted; '
check "Ctrl-C in a search leaves the mesh reached so far" is_ply search.ply
# What make and Ninja find is up to date for them.
echo old >kept.ply
interrupt 1 large.png -o kept.ply -o new.ply --effort best --vertices 6000 --threads 2 --render new.png --report new.json --depfile new.d
check "Ctrl-C exits 1 where there is a depfile to write" exits 1
check "Ctrl-C is told in one sentence where there is a depfile to write" is_one_sentence
check "the sentence says that nothing is written" says ': interrupted; nothing is written'
check "Ctrl-C leaves no file beside a depfile" test ! -e new.ply -a ! -e new.png -a ! -e new.json -a ! -e new.d
check "Ctrl-C leaves what was there beside a depfile" grep -qx old kept.ply
fails "nothing is written" grey.pgm -o new.ply --psnr 99 --depfile new.d
check "a PSNR out of reach leaves no file beside a depfile" test ! -e new.ply -a ! -e new.d
check "no half-written file is left at the end" no_part_is_left

echo "$checks checks, $failures failed"
[ "$failures" -eq 0 ]
