"""Help, version, and command lines that are refused."""
import re

import pytest

from conftest import contents, rows


def test_help_names_every_option(hmesh):
    text = hmesh.done("--help")
    for name in """output format vertices rate psnr max-vertices good-enough sprite outline alpha margin
                   tolerance no-holes texture effort method colors fit-space premultiplied seed weights tile threads svg
                   no-original render render-scale wireframe residual strip report depfile keep-partial quiet json help
                   version man completion""".split():
        assert re.search(rf"^ +(-\w, *)?--{name}\b", text, re.M), name
    assert hmesh.done("-h") == text
    assert hmesh.done("grey.pgm --rate x --help") == text


def test_version_prints_name_version_and_decoders(hmesh):
    assert re.match(r"hmesh \d+\.\d+\.\d+\nreads\n", hmesh.done("--version"))


WRONG = rows("""
    no input image                            |
    --seed means nothing to --method xie      | grey.pgm --method xie --seed 2
    --tile means nothing to --method xie      | grey.pgm --method xie --tile 64
    --effort means nothing to --method adams  | grey.pgm --effort best --method adams
    larger number than any image has pixels   | grey.pgm --vertices 99999999999999999999
    --keep-partial is given with --depfile    | grey.pgm -o new.ply --depfile new.d --keep-partial
    makefiles have no names with control      | grey.pgm -o 'a\\b.ply' --depfile new.d
    makefiles have no names with control      | grey.pgm -o 'a;b.ply' --depfile new.d
    makefiles have no names with control      | grey.pgm -o 'a&b.ply' --depfile new.d
    makefiles have no names with control      | grey.pgm -o a%b.ply --depfile new.d
    makefiles have no names with control      | grey.pgm -o a=b.ply --depfile new.d
    makefiles have no names with control      | grey.pgm -o a.ply --report 'a(1)' --depfile new.d
    --depfile is given with 'a;b.pgm'         | grey.pgm --weights 'a;b.pgm' -o a.ply --depfile new.d
    has '', which is not a number             | color.ppm --channel-weights 1,1,1,
    has '-1', which must be from 0 to 1000000 | color.ppm --channel-weights 1,-1,1
    --vertices '3' must be at least 4         | grey.pgm -o new.ply --vertices 3
    --vertices '-5' must be at least 4        | grey.pgm -o new.ply --vertices -5
    --max-vertices '3' must be at least 4     | grey.pgm -o new.ply --max-vertices 3
    --fit-space each is given without         | grey.pgm -o new.ply --fit-space each
    sampled ones are asked for                | grey.pgm --fit-space linear --colors sampled
    not premultiplied ones                    | grey.pgm --fit-space linear --premultiplied
    no input image                            | ''
    no input image                            | grey.pgm '' constant.pgm
    'mesh.ply' is named for 2 images: it needs {name} | grey.pgm constant.pgm -o mesh.ply
    'r.json' is named for 2 images            | grey.pgm constant.pgm -o {name}.ply --report r.json
    'a.d' is named for 2 images               | grey.pgm constant.pgm -o {name}.ply --depfile a.d
    'grey.pgm' and './grey.pgm' would both become 'new/grey.ply' | grey.pgm ./grey.pgm -o new/{name}.ply
    overwrite the input of that name          | grey.pgm picture.png --render {name}.png
    overwrite the input of that name          | picture.png grey.pgm --render {name}.png
    overwrite the weights                     | grey.pgm constant.pgm --weights picture.png --render picture.png
    './' is no file: it has no name           | ./ -o {name}.ply
    './' is no file: it has no name           | ./ --weights {name}.png
    './' is no file: it has no name           | ./ -o a.glb --with {name}.png
    --output - needs --format, one of: ply, obj, glb, pdf, eps, svg, html | grey.pgm -o -
    'xyz' is not one of: ply, obj, glb, pdf, eps, svg, html | grey.pgm -o - --format xyz
    --format is given without an output       | grey.pgm --format ply
    --format is given without an output       | grey.pgm -o a.ply --format ply
    --format is given twice                   | grey.pgm -o - --format ply --format ply
    --svg is given without an output          | grey.pgm -o - --format ply --svg exact
    the standard output is named for two outputs | grey.pgm -o - --format ply --report -
    the standard output is named for two outputs | grey.pgm -o - -o - --format ply
    the standard output is named for two outputs | grey.pgm --render - --strip -
    the standard output is named for 2 images | grey.pgm constant.pgm -o - --format obj
    the standard output is named for 2 images; --json prints a line | grey.pgm constant.pgm --report -
    the standard input is named twice         | - -
    the standard input is named twice         | - --weights -
    the standard input is named twice         | grey.pgm constant.pgm --weights -
    --json is given with an output that is -  | grey.pgm -o - --format obj --json
    --json is given with an output that is -  | grey.pgm --report - --json
    --depfile is given with -                 | - -o a.ply --depfile a.d
    --depfile is given with -                 | grey.pgm --weights - -o a.ply --depfile a.d
    --depfile is given with -                 | grey.pgm -o - --format ply --depfile a.d
    --depfile is given with -                 | grey.pgm --with - -o a.ply --depfile a.d
    --json takes no value                     | grey.pgm --json=1
    excludes --max-vertices                   | grey.pgm --rate 2 --max-vertices 50
    excludes --max-vertices                   | grey.pgm --vertices 20 --max-vertices 50
    '3' must be at least 4                    | grey.pgm --psnr 30 --max-vertices 3
    '-9' must be at least 4                   | grey.pgm --psnr 30 --max-vertices -9
    '5e3' is not a whole number               | grey.pgm --psnr 30 --max-vertices 5e3
    --max-vertices needs a value              | grey.pgm --psnr 30 --max-vertices
    'tcsh' is not one of: bash, zsh, fish     | --completion tcsh
    --completion needs a value                | --completion
    '--frobnicate'                            | grey.pgm --frobnicate
    '--frobnicate'                            | --frobnicate
    '-x'                                      | grey.pgm -x
    --quiet takes no value                    | grey.pgm --quiet=1
    --vertices needs a value                  | grey.pgm --vertices
    --output needs a value                    | grey.pgm -o
    --weights needs a value                   | grey.pgm --weights
    --method needs a value                    | grey.pgm --method
    --colors needs a value                    | grey.pgm --colors
    --depfile needs a value                   | grey.pgm -o a.ply --depfile
    --output needs a value that is not empty  | grey.pgm -o ''
    '12x' is not a whole number               | grey.pgm --vertices 12x
    '1.5' is not a whole number               | grey.pgm --vertices 1.5
    ' 5' is not a whole number                | grey.pgm --vertices=' 5'
    '99999999999999999999'                    | grey.pgm --vertices 99999999999999999999
    'nan' is not a number                     | grey.pgm --rate nan
    'inf' is not a number                     | grey.pgm --psnr inf
    '1e999' must be above 0 and at most 1000  | grey.pgm --psnr 1e999
    '0x10' is not a number                    | grey.pgm --rate 0x10
    '1.2.3' is not a number                   | grey.pgm --rate 1.2.3
    '1,5' is not a number                     | grey.pgm --rate 1,5
    '0' must be above 0 and at most 100       | grey.pgm --rate 0
    '-1' must be above 0 and at most 100      | grey.pgm --rate -1
    '100.1' must be above 0 and at most 100   | grey.pgm --rate 100.1
    '-3' is not a whole number from 0 to 2^64 - 1 | grey.pgm --seed -3
    '18446744073709551616' is not             | grey.pgm --seed 18446744073709551616
    --vertices excludes --rate                | grey.pgm --vertices 20 --rate 2
    --vertices excludes --psnr                | grey.pgm --vertices 20 --psnr 30
    --vertices excludes --bytes               | grey.pgm -o a.hmc --vertices 20 --bytes 300
    --rate excludes --bytes                   | grey.pgm -o a.hmc --rate 2 --bytes 300
    --psnr excludes --bytes                   | grey.pgm -o a.hmc --psnr 30 --bytes 300
    --rate excludes --psnr                    | grey.pgm --rate 2 --psnr 30
    --seed is given twice                     | grey.pgm --seed 1 --seed 2
    --weights is given twice                  | grey.pgm --weights grey.pgm --weights grey.pgm
    --method is given twice                   | grey.pgm --method xie --method xie
    --svg is given twice                      | grey.pgm -o a.svg --svg exact --svg flat
    '-1' must be from 0 to 1024               | grey.pgm --threads -1
    '1025' must be from 0 to 1024             | grey.pgm --threads 1025
    '-' is not a whole number                 | grey.pgm --threads -
    'two' is not a whole number               | grey.pgm --threads two
    '63' must be from 64 to 65536             | grey.pgm --tile 63
    '65537' must be from 64 to 65536          | grey.pgm --tile 65537
    '1e3' is not a whole number               | grey.pgm --tile 1e3
    '0' must be from 1 to 16                  | grey.pgm --render a.png --render-scale 0
    '17' must be from 1 to 16                 | grey.pgm --render a.png --render-scale 17
    'slow' is not one of: draft, fast, normal, fine, best | grey.pgm --effort slow
    'magic' is not one of: annealed, hierarchical, xie, adams, adaptive_thinning | grey.pgm --method magic
    'magic' is not one of: optimal, sampled   | grey.pgm --colors magic
    'light' is not one of: stored, linear, each | grey.pgm --fit-space light
    'Exact' is not one of: gradient, exact, flat | grey.pgm -o a.svg --svg Exact
    'mesh' is not one of: gradient, exact, flat | grey.pgm -o a.svg --svg=mesh
    'mesh.xyz' must end in one of: .ply, .obj, .glb, .pdf, .eps, .svg, .html, .hmc | grey.pgm -o mesh.xyz
    'mesh' must end in one of                 | grey.pgm -o mesh
    '.svg' must end in one of                 | grey.pgm -o .svg
    'x.jpg' must end in .png                  | grey.pgm --render x.jpg
    'x' must end in .png                      | grey.pgm --wireframe x
    'x.pdf' must end in .png                  | grey.pgm --residual x.pdf
    'x' must end in .png                      | grey.pgm --strip x
    --svg is given without an output that ends in .svg | grey.pgm -o a.pdf --svg exact
    --no-original is given without an output that ends in .html | grey.pgm -o a.svg --no-original
    --no-original takes no value              | grey.pgm -o a.html --no-original=1
    --render-scale requires --render          | grey.pgm --wireframe a.png --render-scale 2
    --depfile is given without another output | grey.pgm --depfile a.d
    named for two outputs                     | grey.pgm -o a.ply -o ./a.ply
    named for two outputs                     | grey.pgm -o a.svg -o ./a.svg
    named for two outputs                     | grey.pgm -o a.ply --report a.d --depfile ./a.d
    named for two outputs                     | grey.pgm --render a.png --wireframe a.png
    named for two outputs                     | grey.pgm --residual a.png --strip a.png
    overwrite the input                       | picture.png --render picture.png
    overwrite the input                       | picture.png --residual ./picture.png
    overwrite the input                       | picture.png --strip picture.png
    overwrite the weights                     | grey.pgm --weights picture.png --render ./picture.png
    overwrite the weights                     | grey.pgm -o a.ply --weights picture.png --depfile picture.png
    """)


@pytest.mark.parametrize("sentence, arguments", WRONG)
def test_wrong_usage_is_told_in_a_sentence_and_touches_no_file(hmesh, sentence, arguments):
    before = contents()
    run = hmesh.run(arguments)
    assert (run.returncode, run.stdout) == (2, "")
    assert sentence in run.stderr and "hmesh --help" in run.stderr
    assert contents() == before


@pytest.mark.parametrize("mark", "\\*?[]%=;|<>^&~'\"`\t\1")
def test_a_name_that_no_makefile_can_hold_has_no_depfile(hmesh, mark):
    before = contents()
    for words in [["grey.pgm", "-o", f"a{mark}b.ply"], [f"a{mark}b.pgm", "-o", "a.ply"]]:
        run = hmesh.run([*words, "--depfile", "a.d"])
        assert run.returncode == 2 and "makefiles have no names with control characters" in run.stderr
    assert contents() == before
