"""Compact files: written, read to pictures and to every other format, and refused."""
import shutil
from pathlib import Path

import pytest

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


def test_it_is_drawn_at_any_size_read_from_the_standard_input_and_one_of_several(hmesh):
    hmesh.done("picture.png --vertices 50 -o a.hmc")
    hmesh.done("a.hmc --render large.png --render-scale 3")
    assert is_png("large.png", (288, 192))
    with open("a.hmc", "rb") as stream:
        assert hmesh.run("- -o b.ply", stdin=stream).returncode == 0
    assert "element vertex 50" in ply_header("b.ply")
    out = hmesh.done("a.hmc picture.png -o {name}.obj")
    assert "a.hmc: 50 vertices, " in out and "picture.png: " in out


@pytest.mark.parametrize("option", ["--vertices 9", "--effort draft", "--residual r.png", "--json", "--sprite", "--with grey.pgm"])
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
