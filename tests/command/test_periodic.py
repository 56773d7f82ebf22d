"""Images that repeat, and the borders of their meshes."""
import json
import re
import struct

import pytest

from conftest import is_png, ply_header, read


def vertices(name):
    """Places and colours of the vertices of a .ply file."""
    data = read(name)
    header, _, body = data.partition(b"end_header\n")
    count = int(re.search(rb"element vertex (\d+)", header)[1])
    return [struct.unpack_from("<3f3B", body, 15 * k) for k in range(count)]


def test_the_border_of_a_periodic_mesh_pairs_in_place_and_colour(hmesh):
    out = hmesh.done("picture.png --vertices 150 --periodic xy --straight-border --report report.json -o tile.ply")
    report = json.loads(read("report.json"))
    assert report.items() >= {"periodic": "xy", "straight_border": True, "vertices": 150}.items()
    assert f"element vertex {150 + report['border_copies']}" in ply_header("tile.ply")
    assert re.search(rf"^vertices +150, and {report['border_copies']} copies of those on the border$", out, re.M)
    border = vertices("tile.ply")
    assert all(0 <= x <= 96 and 0 <= y <= 64 for x, y, *_ in border)
    for axis, size in [(0, 96), (1, 64)]:
        sides = [{v[1 - axis]: v[3:] for v in border if v[axis] == end} for end in (0, size)]
        assert len(sides[0]) > 2 and sides[0] == sides[1]


@pytest.mark.parametrize("axes", ["x", "y", "xy"])
def test_a_jagged_border_stands_out_of_the_image_and_pictures_are_covered(hmesh, axes):
    formats = " ".join(f"-o tile.{kind}" for kind in "ply obj glb pdf eps svg html".split())
    hmesh.done(f"picture.png --vertices 200 --periodic {axes} {formats} --render tile.png --wireframe wire.png --report report.json")
    report = json.loads(read("report.json"))
    assert report.items() >= {"periodic": axes, "straight_border": False, "vertices": 200}.items()
    assert report["border_copies"] > 0
    assert is_png("tile.png", (96, 64)) and is_png("wire.png", (192, 128))
    places = {v[:2] for v in vertices("tile.ply")}
    outside = [(x, y) for x, y in places if not (0 <= x <= 96 and 0 <= y <= 64)]
    assert outside
    assert all(0 <= y <= 64 for _, y in places) or "y" in axes
    assert all(0 <= x <= 96 for x, _ in places) or "x" in axes


def test_a_periodic_mesh_is_fitted_for_linear_light_too(hmesh):
    report = hmesh.report("picture.png --vertices 150 --periodic xy --fit-space each -o light.glb")
    assert report["psnr_glb"] > 15 and report["status"] == "ok"


def test_a_search_finds_a_periodic_mesh(hmesh):
    report = hmesh.report("picture.png --periodic x --psnr 22 --effort fast -o search.ply")
    assert report["psnr"] >= 22


@pytest.mark.parametrize("options, sentence", [
    ("--straight-border", "--straight-border is given without --periodic"),
    ("--periodic z", "--periodic"),
    ("--periodic x --method xie", "--periodic means nothing to --method xie")])
def test_what_means_nothing_is_wrong_usage(hmesh, options, sentence):
    run = hmesh.run(f"picture.png -o wrong.ply {options}")
    assert run.returncode == 2 and sentence in run.stderr
