"""Compact files: written, read to pictures and to every other format, and refused."""
import re
import shutil
import struct
from pathlib import Path

import pytest
from PIL import Image

import hmc
from conftest import is_png, ply_header, read


@pytest.mark.parametrize("image, options", [
    ("picture.png", "--vertices 200"), ("grey16.pgm", ""), ("rgba.tga", "--premultiplied"), ("grey_alpha.tga", "--sprite"),
    ("picture.png", "--periodic xy"), ("grey.pgm", "--samples points"), ("picture.png", "--fit-space linear")])
def test_a_compact_file_holds_the_mesh(hmesh, image, options):
    hmesh.done(f"{image} {options} -o x.hmc --render made.png --wireframe edges.png")
    out = hmesh.done("x.hmc -o y.ply -o y.glb -o y.html -o y.hmc --render read.png --wireframe again.png")
    assert "written   y.hmc" in out and "PSNR" not in out
    assert read("x.hmc") == read("y.hmc")
    assert read("made.png") == read("read.png") and read("edges.png") == read("again.png")
    assert len(read("x.hmc")) < 0.4 * len(read("y.ply"))


@pytest.mark.parametrize("axes", ["x", "xy"])
def test_copies_on_the_border_of_a_periodic_mesh_are_told_as_such(hmesh, axes):
    made = hmesh.done(f"picture.png --vertices 200 --periodic {axes} -o x.hmc")
    counts = re.search(r"^vertices  200, and \d+ copies of those on the border$", made, re.M)
    assert counts and counts.group() in hmesh.done("x.hmc")
    assert "x.hmc: 200 vertices, " in hmesh.done("x.hmc picture.png --render {name}_again.png")


def test_it_is_drawn_at_any_size_read_from_the_standard_input_and_one_of_several(hmesh):
    hmesh.done("picture.png --vertices 50 -o a.hmc")
    hmesh.done("a.hmc --render large.png --render-scale 3")
    assert is_png("large.png", (288, 192))
    with open("a.hmc", "rb") as stream:
        assert hmesh.run("- -o b.ply", stdin=stream).returncode == 0
    assert "element vertex 50" in ply_header("b.ply")
    out = hmesh.done("a.hmc picture.png -o {name}.obj")
    assert "a.hmc: 50 vertices, " in out and "picture.png: " in out


@pytest.mark.parametrize("option", [
    "--vertices 9", "--rate 1", "--psnr 30", "--max-vertices 9", "--good-enough 30", "--effort draft", "--method xie",
    "--colors sampled", "--fit-space linear", "--periodic x", "--premultiplied", "--samples points", "--weights grey.pgm",
    "--with grey.pgm", "--grid 8", "--seed 2", "--channel-weights 1,1,1", "--tile 64", "--lods 2", "--sprite", "--outline",
    "--residual r.png", "--strip s.png", "--report r.json", "--json", "--keep-partial"])
def test_options_that_make_meshes_mean_nothing_to_it(hmesh, option):
    hmesh.done("picture.png --vertices 50 -o a.hmc")
    sentence = f"hmesh: {option.split()[0]} means nothing to 'a.hmc', which is a mesh and no image\n"
    run = hmesh.run(f"a.hmc {option} -o a.ply")
    assert run.returncode == 2 and run.stderr.startswith(sentence)
    shutil.copy("a.hmc", "b")  # known by its content
    hmesh.fails(sentence.replace("a.hmc", "b")[:-1], f"b {option} -o a.ply")


def test_damage_is_told(hmesh):
    hmesh.done("picture.png --vertices 50 -o a.hmc")
    whole = read("a.hmc")
    for name, content, why in [("cut.hmc", whole[:-1], "has another size than it says"),
                               ("odd.hmc", whole[:40] + bytes([whole[40] ^ 1]) + whole[41:], "its checksum does not fit"),
                               ("new.hmc", whole[:4] + b"\2" + whole[5:], "of a version that is not known (2, limit 1)")]:
        Path(name).write_bytes(content)
        hmesh.fails(why, f"{name} -o x.ply")


@pytest.mark.parametrize("name", ["rgb", "gray", "holes", "wide", "bare", "coarse", "coarse_bare", "table", "table_bare",
                                  "table_2", "table_2_bare", "table_2_gray", "first_coarse", "first_coarse_bare", "first_table", "first_table_bare"])
def test_another_decoder_reads_what_the_library_does(name):
    file = Path(__file__).parent.parent / "golden" / "compact" / name
    size, vertices, faces = hmc.read_compact(file.with_suffix(".hmc").read_bytes(), "bare" in name)
    lines = [size, [len(vertices)], *vertices, [len(faces)], *faces]
    assert [" ".join(map(str, line)) for line in lines] == file.with_suffix(".txt").read_text(encoding="ascii").splitlines()


@pytest.mark.parametrize("options", ["picture.png --vertices 26", "picture.png --vertices 16 --periodic xy", "grey16.pgm --vertices 20",
                                     "rgba.tga --vertices 24 --sprite", "grey.pgm --samples points --vertices 20"])
def test_another_decoder_reads_what_the_command_writes(hmesh, options):
    hmesh.done(f"{options} -o x.hmc -o x.ply")
    _, vertices, faces = hmc.read_compact(read("x.hmc"))
    head = ply_header("x.ply")
    assert f"element vertex {len(vertices)}" in head and f"element face {len(faces)}" in head
    height = int(Image.open(options.split()[0]).size[1]) - (1 if "points" in options else 0)
    body = read("x.ply").partition(b"end_header\n")[2]
    size = len([line for line in head if line.startswith("property uchar")]) + 12
    places = sorted(struct.unpack_from("<2f", body, size * k) for k in range(len(vertices)))
    assert places == sorted((v[0] / 256, height - v[1] / 256) for v in vertices)


# The decoder's Delaunay triangulation takes the fourth power of the vertices, of which grey files have many a byte.
@pytest.mark.parametrize("image, options, most", [("picture.png", "", 200), ("picture.png", "--no-table", 200),
                                                  ("grey.pgm", "--effort draft", 100), ("rgba.tga", "--premultiplied", 250)])
def test_a_file_of_so_many_bytes(hmesh, image, options, most):
    said = hmesh.done(f"{image} {options} --bytes {most} -o x.hmc -o x.ply --render x.png")
    assert 0.98 * most <= len(read("x.hmc")) <= most and "vertices  " in said
    assert read("x.hmc")[5] == (0 if "--no-table" in options else 2)
    hmesh.done("x.hmc -o y.ply --render y.png")
    assert read("x.ply") == read("y.ply") and read("x.png") == read("y.png")
    size, vertices, faces = hmc.read_compact(read("x.hmc"))
    assert f"element vertex {len(vertices)}" in ply_header("x.ply") and f"vertices  {len(vertices)}\n" in said
    hmesh.done(f"{image} {options} --bytes {most} --threads 3 -o again.hmc")
    assert read("x.hmc") == read("again.hmc")


def test_what_bytes_cannot_be(hmesh):
    hmesh.fails("of 4 vertices (", "picture.png --bytes 9 -o x.hmc")
    hmesh.fails("--bytes makes files of 8-bit colours, and the image has 16 bits a sample", "grey16.pgm --bytes 300 -o x.hmc")
    for options, why in [("-o x.ply", "--bytes is given without an output that ends in .hmc"),
                         ("-o x.hmc --lods 2", "--lods means nothing to --bytes, which makes a small .hmc file"),
                         ("-o x.hmc --method xie", "--method means nothing to --bytes, which makes a small .hmc file")]:
        run = hmesh.run(f"picture.png --bytes 300 {options}")
        assert run.returncode == 2 and why in run.stderr
    run = hmesh.run("picture.png --no-table -o x.hmc")
    assert run.returncode == 2 and "--no-table is given without --bytes" in run.stderr
    for count in ["0", "-3", "1e3", "2000000000"]:
        assert hmesh.run(f"picture.png --bytes {count} -o x.hmc").returncode == 2
    assert not Path("x.hmc").exists()


@pytest.mark.parametrize("option", [
    "--max-vertices 50", "--good-enough 30", "--colors sampled", "--fit-space linear", "--periodic x", "--samples points",
    "--weights picture.png", "--channel-weights 1,1,1", "--sprite", "--outline", "--keep-partial", "--grid 8"])
def test_what_a_number_of_bytes_does_not_know_is_refused(hmesh, option):
    run = hmesh.run(f"picture.png --bytes 300 -o x.hmc {option}")
    assert run.returncode == 2 and f"{option.split()[0]} means nothing to --bytes, which makes a small .hmc file" in run.stderr
    assert not Path("x.hmc").exists()
