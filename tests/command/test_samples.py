"""--samples points: meshes over [0, W - 1] x [0, H - 1], as heightmaps have them."""
import json
import re
import struct
from pathlib import Path

import pytest

from conftest import is_png, ply_header, read


def vertices(name):
    """Places and colours of the vertices of a .ply file."""
    data = read(name)
    header, _, body = data.partition(b"end_header\n")
    count = int(re.search(rb"element vertex (\d+)", header)[1])
    return [struct.unpack_from("<3f3B", body, 15 * k) for k in range(count)]


def test_points_end_at_the_outermost_samples(hmesh):
    formats = " ".join(f"-o points.{kind}" for kind in "ply obj glb pdf eps svg html".split())
    hmesh.done(f"picture.png --vertices 200 --samples points {formats} --render drawn.png --wireframe wire.png --report report.json")
    report = json.loads(read("report.json"))
    assert report.items() >= {"samples": "points", "width": 96, "height": 64, "vertices": 200, "status": "ok"}.items()
    assert 0 < report["max_error"] <= 255
    assert report["max_error"] ** 2 >= report["energy"] / (96 * 64 * 3)
    assert "element vertex 200" in ply_header("points.ply")
    places = {v[:2] for v in vertices("points.ply")}
    assert {(0, 0), (95, 0), (0, 63), (95, 63)} <= places
    assert all(0 <= x <= 95 and 0 <= y <= 63 for x, y in places)
    assert b'viewBox="0 0 95 63"' in read("points.svg")
    assert b"%%BoundingBox: 0 0 95 63" in read("points.eps")
    assert is_png("drawn.png", (96, 64)) and is_png("wire.png", (192, 128))


@pytest.mark.parametrize("method", "hierarchical xie adams adaptive_thinning".split())
def test_every_method_meshes_points(hmesh, method):
    report = hmesh.report(f"picture.png --vertices 100 --samples points --method {method} -o mesh.ply")
    assert report.items() >= {"samples": "points", "vertices": 100}.items()
    assert {(0, 0), (95, 63)} <= {v[:2] for v in vertices("mesh.ply")}


def test_squares_are_the_default_to_the_byte(hmesh):
    hmesh.done("picture.png --vertices 100 --samples squares -o named.ply")
    hmesh.done("picture.png --vertices 100 -o default.ply")
    assert read("named.ply") == read("default.ply")


@pytest.mark.parametrize("fit", ["stored", "linear", "each"])
def test_levels_and_linear_light_tell_the_largest_error_too(hmesh, fit):
    report = hmesh.report(f"picture.png --vertices 200 --samples points --fit-space {fit} -o light.glb")
    assert 0 < report["max_error"] <= 255
    report = hmesh.report("picture.png --vertices 200 --samples points --lods 3 -o level.ply")
    errors = [level["max_error"] for level in report["levels"]]
    assert len(errors) == 3 and errors[0] == report["max_error"] and all(error > 0 for error in errors)


def test_images_that_share_a_column_share_its_vertices(hmesh):
    rgb = [bytes((x * x + 3 * y * y) // 40 % 256 for c in range(3)) for y in range(40) for x in range(90)]
    for name, left, right in [("west", 0, 50), ("east", 49, 90)]:
        with open(f"{name}.ppm", "wb") as file:
            file.write(b"P6\n%d 40\n255\n" % (right - left))
            file.write(b"".join(rgb[90 * y + x] for y in range(40) for x in range(left, right)))
        report = hmesh.report(f"{name}.ppm --vertices {300 + left} --samples points --border-tolerance 4 -o {name}.ply")
        assert report["border_tolerance"] == 4
    west = sorted(v[1:] for v in vertices("west.ply") if v[0] == 49)
    east = sorted(v[1:] for v in vertices("east.ply") if v[0] == 0)
    assert len(west) > 2 and west == east


def test_fewer_vertices_than_the_sides_need_are_refused_and_nothing_is_written(hmesh):
    for target in ("--vertices 5", "--psnr 20"):
        hmesh.fails("more vertices than it may have", f"grey.pgm {target} --samples points --border-tolerance 0 -o mesh.ply")
        assert not Path("mesh.ply").exists()


def test_a_search_that_ends_at_sides_of_four_corners_writes_them(hmesh):
    hmesh.fails("no mesh of so few vertices reached", "grey.pgm --psnr 90 --max-vertices 4 --samples points --border-tolerance 255 -o few.ply")
    assert "element vertex 4" in ply_header("few.ply")


@pytest.mark.parametrize("options, sentence", [
    ("--samples dots", "--samples"),
    ("--samples points --periodic x", "--samples points is given with --periodic, whose samples are squares"),
    ("--border-tolerance 3", "--border-tolerance is given without --samples points"),
    ("--samples points --border-tolerance -1", "--border-tolerance"),
    ("--samples points --border-tolerance 3 --channel-weights 1,1,1", "--border-tolerance is given with --channel-weights"),
    ("--samples points --border-tolerance 3 --method xie", "--border-tolerance means nothing to --method xie"),
    ("--samples points --outline", "--samples means nothing to --outline")])
def test_points_that_make_no_sense_are_refused(hmesh, options, sentence):
    run = hmesh.run(f"picture.png {options} -o mesh.ply")
    assert run.returncode == 2 and sentence in run.stderr
    assert re.fullmatch(r"hmesh: .*\n(.*\n)?", run.stderr)
