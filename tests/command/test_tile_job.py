"""hmesh job: an image as tiles that share rows of samples, each a task in files, done by whatever engine."""
import hashlib
import json
import math
import os
import random
import re
import resource
import shutil
import struct
import subprocess
import time
from pathlib import Path

import pytest
from PIL import Image

from conftest import contents, is_failure, is_whole, limit, read, rows
from jobs import finish, forge, join_interrupted, phases, receipts, run, sums, tiles
from test_psnr import psnr_of, read_glb, read_ply

WIDTH, HEIGHT, TILE = 230, 150, 64  # 4 x 3 tiles
OPTIONS = f"--tile {TILE} --rate 6 --effort fast"


def sample(x, y, c):
    """Slopes, edges and, in the right half, texture."""
    noise = (x // 3 * 37 + y // 3 * 91 + c * 13) * 2654435761 % 97 if x > 120 else 0
    return (x * x // 90 + y * (150 - y) // 60 + (80 if (x // 41 + y // 37 + c) % 2 else 0) + noise // 2 + 20 * c) % 256


def draw(name="image.ppm", channels=3, width=WIDTH, height=HEIGHT, value=sample):
    body = bytes(value(x, y, c) for y in range(height) for x in range(width) for c in range(channels))
    Path(name).write_bytes(b"P%d %d %d 255\n" % (6 if channels == 3 else 5, width, height) + body)


def plan(hmesh, options=OPTIONS, image="image.ppm", folder="job"):
    if not Path(image).exists():
        draw(image)
    hmesh.done(f"job plan {image} -o {folder} -q {options}")
    return phases(folder)


def shown(mesh, width, height):
    """The mesh at each sample, between the colours of the corners."""
    positions, colors, corners = mesh
    picture = {}
    for a, b, c in corners:
        (ax, ay), (bx, by), (cx, cy) = positions[a], positions[b], positions[c]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        assert area > 0
        for y in range(math.ceil(min(ay, by, cy)), math.floor(max(ay, by, cy)) + 1):
            for x in range(math.ceil(min(ax, bx, cx)), math.floor(max(ax, bx, cx)) + 1):
                u = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
                v = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
                if u >= 0 and v >= 0 and u + v <= 1:
                    picture[x, y] = [p + u * (q - p) + v * (r - p) for p, q, r in zip(colors[a], colors[b], colors[c])]
    assert len(picture) == width * height
    return picture


def is_tiling(mesh, width, height):
    """One surface over the rectangle: each edge within it has two faces, one on each side."""
    positions, _, corners = mesh
    assert len(set(positions)) == len(positions)
    edges = {edge for a, b, c in corners for edge in ((a, b), (b, c), (c, a))}
    assert len(edges) == 3 * len(corners)
    for a, b in edges:
        if (b, a) not in edges:
            (ax, ay), (bx, by) = positions[a], positions[b]
            assert (ax == bx and ax in (0, width - 1)) or (ay == by and ay in (0, height - 1))
    area = sum((positions[b][0] - positions[a][0]) * (positions[c][1] - positions[a][1]) -
               (positions[b][1] - positions[a][1]) * (positions[c][0] - positions[a][0]) for a, b, c in corners)
    assert area == 2 * (width - 1) * (height - 1)
    return True


def downward(mesh):
    """A mesh of test_psnr's readers, whose faces turn as they do on a screen."""
    positions, colors, corners = mesh
    return positions, colors, [(a, c, b) for a, b, c in corners]


# ---- what comes out ----
def test_the_whole_is_one_surface_of_as_many_vertices_as_asked_for_and_of_the_psnr_that_is_told(hmesh):
    plan(hmesh)
    finish(hmesh)
    index = json.loads(read("job/tiles/index.json"))
    told = hmesh.done("job join job -o whole.ply -q") + hmesh.done("job join job -o whole.hmc")
    assert "joined     2070 vertices" in told and index["vertices"] == 2070 == round(WIDTH * HEIGHT * 0.06)
    mesh = downward(read_ply("whole.ply"))
    assert len(mesh[0]) == 2070 and len(mesh[2]) == index["faces"] and is_tiling(mesh, WIDTH, HEIGHT)
    wanted = {(x, y): [sample(x, y, c) for c in range(3)] for y in range(HEIGHT) for x in range(WIDTH)}
    picture = shown(mesh, WIDTH, HEIGHT)
    # The index counts samples of seams once for each of their tiles, each of which errs as it says.
    assert abs(psnr_of(wanted, picture) - index["psnr"]) < 0.2
    for t in index["tiles"]:
        inside = {(x, y) for x in range(t["x"], t["x"] + t["width"]) for y in range(t["y"], t["y"] + t["height"])}
        assert abs(psnr_of({place: wanted[place] for place in inside}, picture) - t["psnr"]) < 1e-6
        off = max(abs(a - b) for place in inside for a, b in zip(wanted[place], picture[place]))
        assert off == pytest.approx(t["max_error"], abs=1e-3)
    assert index["max_error"] == max(t["max_error"] for t in index["tiles"])

    def error(places):
        errors = [sum((a - b) ** 2 for a, b in zip(wanted[place], picture[place])) for place in places]
        return sum(errors) / len(errors)

    lines = [{t[axis] for t in index["tiles"]} - {0} for axis in "xy"]
    assert [len(at) for at in lines] == [3, 2]
    seams = [place for place in wanted if min(abs(place[k] - at) for k in (0, 1) for at in lines[k]) <= 1]
    assert error(seams) < 1.05 * error(wanted)
    hmesh.done("whole.hmc -o again.ply -q")
    assert sorted(read_ply("again.ply")[0]) == sorted(read_ply("whole.ply")[0])


def test_vertices_go_where_they_are_worth_most(hmesh):
    plan(hmesh)
    finish(hmesh)
    counts = {(t["x"] > 100): 0 for t in json.loads(read("job/tiles/index.json"))["tiles"]}
    for t in json.loads(read("job/tiles/index.json"))["tiles"]:
        counts[t["x"] > 100] += t["vertices"]
    assert counts[True] > 1.5 * counts[False]


def test_a_tile_alone_is_the_mesh_that_the_command_makes_of_the_image_with_its_share_and_tolerance(hmesh):
    samples = [257 * sample(x + 100, y, 0) for y in range(50) for x in range(60)]
    Path("deep.pgm").write_bytes(b"P5 60 50 65535\n" + struct.pack(">3000H", *samples))
    plan(hmesh, "--tile 64 --rate 6 --effort fast --seed 7", "deep.pgm")
    finish(hmesh)
    shares = json.loads(read("job/done/shares_0.json"))["facts"]
    options = f"--samples points --vertices {shares['vertices'][0]} --border-tolerance {shares['tolerance']} --effort fast"
    hmesh.done(f"deep.pgm -o one.hmc -q --seed 7 {options}")
    hmesh.done(f"deep.pgm -o other.hmc -q --seed 8 {options}")
    hmesh.done("job join job -o whole.hmc -q")
    assert read("other.hmc") != read("one.hmc") == read("job/tiles/0/0000_0000.hmc") == read("whole.hmc")


@pytest.mark.parametrize("kind", ["glb", "ply"])
def test_tiles_in_a_folder_stand_in_their_places_and_meet_bit_for_bit(hmesh, kind):
    plan(hmesh)
    finish(hmesh)
    hmesh.done(f"job join job -o served --format {kind} -q")
    index = json.loads(read("served/index.json"))
    assert len(index["tiles"]) == 12 and sums("served").items() >= {t["file"]: t["sha256"] for t in index["tiles"]}.items()
    assert all(t["bytes"] == Path("served", t["file"]).stat().st_size for t in index["tiles"])
    reader = {"glb": read_glb, "ply": read_ply}[kind]
    sides = {}
    for t in index["tiles"]:
        positions, colors, _ = reader("served/" + t["file"])  # whose y goes down from the file's highest
        assert len(positions) == t["vertices"] and is_whole("served/" + t["file"])
        assert {(t["x"], 0), (t["x"] + t["width"] - 1, t["height"] - 1)} <= set(positions)
        for (x, y), color in zip(positions, colors):
            place = (x, y + t["y"])
            if place[0] in (t["x"], t["x"] + t["width"] - 1) or y in (0, t["height"] - 1):
                sides.setdefault(place, []).append(tuple(color))
    within = [colors for (x, y), colors in sides.items() if 0 < x < WIDTH - 1 and 0 < y < HEIGHT - 1]
    assert len(within) > 20 and all(len(colors) in (2, 4) and len(set(colors)) == 1 for colors in within)


@pytest.mark.parametrize("image, options", rows("""
    color.ppm | --rate 20      | x
    color16.ppm | --rate 20    | x
    grey16.pgm | --rate 20     | x
    rgba.tga | --rate 20       | x
    grey_alpha.tga | --rate 20 | x
    constant.pgm | --rate 100  | x
    row2.pgm | --rate 100      | x
    four.pgm | --vertices 4    | x
""".replace("| x", "")))
def test_images_of_every_kind(hmesh, image, options):
    Path("row2.pgm").write_bytes(b"P5 9 2 255\n" + bytes(range(18)))
    Path("four.pgm").write_bytes(b"P5 2 2 255\nabcd")
    plan(hmesh, options.rstrip("| ") + " --tile 64 --effort draft", image)
    finish(hmesh)
    hmesh.done("job join job -o whole.ply -q")
    assert is_whole("whole.ply")


def test_float_images_and_those_of_several_tiles_of_every_kind(hmesh):
    for channels, name in [(1, "f"), (3, "F")]:
        data = b"".join(struct.pack("<f", sample(x, y, c) / 300) for y in reversed(range(70)) for x in range(140) for c in range(channels))
        Path("image.pfm").write_bytes(f"P{name}\n140 70\n-1.0\n".encode() + data)
        shutil.rmtree("job", ignore_errors=True)
        plan(hmesh, OPTIONS, "image.pfm")
        finish(hmesh)
        assert json.loads(read("job/tiles/index.json"))["seams"].items() >= {"pairs": 7, "open": 0}.items()
        hmesh.done("job join job -o whole.glb -q")


# ---- levels of detail ----
def halves(step):
    """How much of each pixel of a line is in the line of `step` px around it."""
    return [(d, 0.5 if abs(d) == step // 2 and step > 1 else 1) for d in range(-(step // 2), step // 2 + 1)]


def mean_around(x, y, step, channels=3, value=sample, width=WIDTH, height=HEIGHT):
    """The mean of the square of step x step px around pixel (x, y), of what there is of it, as it is stored."""
    parts = [(x + i, y + j, p * q) for i, p in halves(step) for j, q in halves(step)
             if 0 <= x + i < width and 0 <= y + j < height]
    area = sum(part for _, _, part in parts)
    return [math.floor(sum(part * value(i, j, c) for i, j, part in parts) / area + 0.5) for c in range(channels)]


def test_levels_are_meshes_of_the_image_at_half_the_size_each_and_stand_in_one_place(hmesh):
    looks, shares, made, seams, index = plan(hmesh, OPTIONS + " --levels 3")
    assert shares == ["shares_0", "shares_1", "shares_2"]
    finish(hmesh)
    assert "joined     2070 vertices" in hmesh.done("job join job -o whole.ply")  # of level 0
    told = hmesh.done("job join job -o served --format ply")
    index = json.loads(read("served/index.json"))
    finest = index["levels"][0]
    assert f"\nseams      {finest['shared']} vertices shared\nPSNR       {finest['psnr']:.2f} dB of the samples" in told
    assert [level["step"] for level in index["levels"]] == [1, 2, 4]
    assert [level["vertices"] for level in index["levels"]] == [2070, 518, 129]
    assert [(level["width"], level["height"]) for level in index["levels"]] == [(230, 150), (115, 75), (58, 38)]
    assert len(made) == len(looks) == len(index["tiles"]) == sum(1 for _ in Path("served").rglob("*.ply"))
    places, sides = {}, {}
    for t in index["tiles"]:
        level, step = t["level"], index["levels"][t["level"]]["step"]
        number, column = t["file"][2:].split(".")[0].split("_")
        assert t["file"].startswith(f"{level}/") and t["width"] <= TILE + 1 and t["height"] <= TILE + 1
        box = t["x"], t["y"], t["x"] + t["width"] - 1, t["y"] + t["height"] - 1
        places[level, int(column), int(number)] = [step * k for k in box]
        # In px of the image, and as good as is told of the samples of its level.
        positions, colors, corners = downward(read_ply("served/" + t["file"]))
        own = [(x / step - t["x"], y / step) for x, y in positions]
        picture = shown((own, colors, corners), t["width"], t["height"])
        wanted = {(x, y): mean_around(step * (t["x"] + x), step * (t["y"] + y), step) for x, y in picture}
        assert len(positions) == t["vertices"] and abs(psnr_of(wanted, picture) - t["psnr"]) < 1e-6
        assert is_tiling((own, colors, corners), t["width"], t["height"])
        for (x, y), color in zip(own, colors):
            if x in (0, t["width"] - 1) or y in (0, t["height"] - 1):
                sides.setdefault((level, x + t["x"], y + t["y"]), []).append(tuple(color))
    for (level, x, y), colors in sides.items():
        if 0 < x < index["levels"][level]["width"] - 1 and 0 < y < index["levels"][level]["height"] - 1:
            assert len(colors) in (2, 4) and len(set(colors)) == 1
    for (level, column, row), (x0, y0, x1, y1) in places.items():
        if level < 2:  # its parent has it, but for the last samples before the end, which are of no coarser level
            px0, py0, px1, py1 = places[level + 1, column // 2, row // 2]
            assert px0 <= x0 and py0 <= y0 and x1 < px1 + 2 ** (level + 1) and y1 < py1 + 2 ** (level + 1)
    assert index["seams"]["open"] == 0 and index["seams"]["pairs"] == sum(
        1 for level, column, row in places for other in ((level, column + 1, row), (level, column, row + 1)) if other in places)


@pytest.mark.parametrize("width, height", [(12, 300), (8250, 4)])
def test_levels_of_tiles_that_are_read_in_parts_are_means_of_the_image_everywhere(hmesh, width, height):
    wave = lambda x, y, c: round(128 + 100 * math.sin((x + y) / 40))
    draw("long.pgm", 1, width, height, wave)
    tasks = plan(hmesh, "--rate 10 --tile 65536 --levels 2 --effort draft", "long.pgm")
    run(hmesh, [task for phase in tasks[:3] for task in phase if "s_1" in task or "_1_" in task])
    hmesh.done("job/tiles/1/0000_0000.hmc -o tile.ply -q")
    picture = shown(downward(read_ply("tile.ply")), width // 2, height // 2)
    errors = [color[0] - mean_around(2 * x, 2 * y, 2, 1, wave, width, height)[0] for (x, y), color in picture.items()]
    energy = json.loads(read("job/done/tile_1_0000_0000.json"))["facts"]["energy"]
    assert sum(error * error for error in errors) == pytest.approx(energy, rel=1e-5)


@pytest.mark.parametrize("wanted, vertices", [(130, [130, 33, 8, 4]), (1000, [256, 64, 16, 4])])
def test_levels_have_a_fourth_of_the_vertices_each_but_four_at_least_and_one_a_sample_at_most(hmesh, wanted, vertices):
    draw("small.pgm", 1, 16, 16, lambda x, y, c: 77)
    plan(hmesh, f"--vertices {wanted} --tile 64 --effort draft --levels 4", "small.pgm")
    finish(hmesh)
    assert [level["vertices"] for level in json.loads(read("job/tiles/index.json"))["levels"]] == vertices


def test_level_0_is_the_same_whatever_levels_there_are_if_tiles_are(hmesh):
    draw(width=257, height=129)
    plan(hmesh)
    finish(hmesh)
    plan(hmesh, OPTIONS + " --levels 3", folder="levels")
    finish(hmesh, "levels")
    finest = {name: content for name, content in tiles("levels/tiles").items() if name.startswith("0/")}
    assert len(finest) == 8 and finest == {name: content for name, content in tiles().items() if name.startswith("0/")}


def test_colours_of_what_is_transparent_do_not_show_at_any_level(hmesh):
    image = Image.new("RGBA", (130, 70), (200, 40, 10, 255))
    for x in range(0, 130, 2):
        image.paste((0, 255, 0, 0), (x, 0, x + 1, 70))
    image.save("stripes.png")
    plan(hmesh, "--rate 20 --tile 64 --effort draft --levels 3", "stripes.png")
    finish(hmesh)
    hmesh.done("job join job -o served --format ply -q")
    for path in [*Path("served/1").iterdir(), *Path("served/2").iterdir()]:
        colors = set(read_ply(path)[1])
        assert {color[:3] for color in colors} == {(200, 40, 10)} and all(80 < color[3] < 160 for color in colors)
    Image.new("RGBA", (70, 70), (200, 40, 10, 0)).save("nothing.png")
    plan(hmesh, "--rate 20 --tile 64 --effort draft --levels 2", "nothing.png", "other")
    finish(hmesh, "other")
    hmesh.done("job join other -o nothing --format ply -q")
    assert set(read_ply(*Path("nothing/1").iterdir())[1]) == {(200, 40, 10, 0)}


def test_fine_detail_that_is_meshed_well_is_foretold(hmesh):
    draw("rings.pgm", 1, 640, 400, lambda x, y, c: round(128 + 60 * math.sin(math.hypot(x - 320, y - 200) / 2)))
    plan(hmesh, "--rate 5 --tile 640 --effort draft", "rings.pgm")
    finish(hmesh)
    whole = json.loads(hmesh.done("rings.pgm -o whole.ply --samples points --rate 5 --effort draft --json"))
    assert json.loads(read("job/tiles/index.json"))["psnr"] > whole["psnr"] - 0.5


def test_slopes_are_foretold_as_what_a_mesh_shows(hmesh):
    heights = [round(1500 + 900 * math.sin(x / 70) * math.cos(y / 90) + 60 * math.sin(x / 9 + y / 13))
               for y in range(400) for x in range(400)]
    Path("heights.pgm").write_bytes(b"P5 400 400 65535\n" + struct.pack(">160000H", *heights))
    plan(hmesh, "--rate 2 --tile 400 --effort draft", "heights.pgm")
    finish(hmesh)
    whole = json.loads(hmesh.done("heights.pgm -o whole.ply --samples points --rate 2 --effort draft --json"))
    assert json.loads(read("job/tiles/index.json"))["psnr"] > whole["psnr"] - 0.5


def test_shares_are_those_at_which_one_more_vertex_is_worth_the_same(hmesh):
    draw(width=129, height=65)
    looks, (shares,), *_ = plan(hmesh, "--tile 64 --vertices 300")
    run(hmesh, looks)

    def share(*trials, sides=lambda k: [2] * 4, lost=0):
        """Of two tiles of 65 x 65 samples; tolerance k is 63.75 halved k / 2 times, or 0.7 of the one before."""
        counts = [sides(k) for k in range(18)]
        for name, trial in zip(looks, trials):
            forge(f"job/done/{name}.json", facts={"trials": trial, "lost": lost, "pixels": 65 * 65, "sides": counts})
        Path(f"job/done/{shares}.json").unlink(missing_ok=True)
        run(hmesh, [shares])
        facts = json.loads(read(f"job/done/{shares}.json"))["facts"]
        return facts["vertices"], facts["tolerance"]

    falling = lambda factor: [[n, factor / n ** 2] for n in (800, 400, 200)]  # whose slopes are as 1 / n^3
    of_error = lambda error: error ** 2 * 65 * 65 * 3  # of each tile
    (few, many), tolerance = share(falling(1e3), falling(8e3), lost=of_error(20))
    assert few + many == 302 and abs(many - 2 * few) <= 2 and tolerance == 63.75 / 4  # the first one within the error
    odd = falling(1e3)
    odd[1][1] = odd[0][1]  # of half as many vertices and no more error, from which nothing is to be learnt
    assert share(odd, falling(8e3))[0] == [few, many]
    assert share(falling(1), falling(1e9), sides=lambda k: [10] * 4)[0] == [72, 310 - 72]  # twice what sides need
    heavy = lambda k: [2 if k < 3 else 40] * 4
    assert share(falling(1e3), falling(1e3), sides=heavy)[1] == 63.75 / 2  # not more than half of all for sides
    kinked = [[80, 0.9e6], [40, 1e6], [20, 4e6]]  # worth 50,000 each up to there, 3,800 beyond
    assert share(kinked, falling(5e3 * 262 ** 3))[0] == [40, 262]


def test_a_large_tile_is_looked_at_at_a_quarter_of_its_size_and_foretells_what_a_mesh_of_all_its_pixels_errs_by(hmesh):
    Image.open("picture.png").convert("L").resize((820, 801)).save("large.pgm")
    looks, *_ = plan(hmesh, "--rate 3.1", "large.pgm")
    count = round(820 * 801 * 0.031) // 2  # above 10000: a fourth of it in a sixteenth of the pixels
    assert run(hmesh, looks) == f"look_0_0000_0000  {count // 4} vertices tried\n"
    found = json.loads(read("job/done/look_0_0000_0000.json"))["facts"]
    assert [vertices for vertices, _ in found["trials"]] == [count // 4, count // 8, count // 16]
    whole = json.loads(hmesh.done(f"large.pgm -o whole.hmc --samples points --vertices {count // 4} --effort draft --json"))
    assert found["lost"] + found["trials"][0][1] == pytest.approx(whole["energy"], rel=0.2)


@pytest.mark.parametrize("scale", [None, 2.0 ** -12, 1, 2.0 ** 40])
def test_sides_err_as_their_tiles_do_whatever_the_range_of_the_samples(hmesh, scale):
    """Heights of 16 bits that use a thirtieth of these, and floats."""
    def height(x, y):
        return math.sin(x / 30) * math.cos(y / 47) + 0.3 * math.sin((x + 2 * y) / 11)

    places = [(x, y) for y in range(200) for x in range(300)]
    if scale:
        Path("heights.pfm").write_bytes(b"Pf 300 200 -1\n" + struct.pack("<60000f", *[scale * height(x, y) for x, y in places]))
    else:
        samples = [round(1500 + 1000 * height(x, y)) for x, y in places]
        Path("heights.pgm").write_bytes(b"P5 300 200 65535\n" + struct.pack(">60000H", *samples))
    plan(hmesh, "--rate 10 --tile 150 --effort draft", "heights.pfm" if scale else "heights.pgm")
    finish(hmesh)
    index = json.loads(read("job/tiles/index.json"))
    error = (1 if scale else 65535) * 10 ** (-index["psnr"] / 20)
    foretold = 1.2  # at most so many times the error
    assert 0.5 * error < index["border_tolerance"] < foretold * error


def test_sums_of_sides_are_those_of_the_files_and_where_they_differ_meshes_are_compared(hmesh):
    looks, shares, made, seams, _ = plan(hmesh)
    run(hmesh, looks + shares + made)
    told = run(hmesh, seams)
    for task in made:
        facts = json.loads(read(f"job/done/{task}.json"))["facts"]
        across, down = task.split("_")[2:]
        hmesh.done(f"job/tiles/0/{down}_{across}.hmc -o tile.ply -q")
        positions, colors, _ = read_ply("tile.ply")  # whose y goes down from the tile's highest
        wide, high = (max(place[axis] for place in positions) for axis in (0, 1))
        for said, axis, at in zip(facts["sides"], (0, 0, 1, 1), (0, wide, 0, high)):  # west, east, north, south
            side = sorted((place[1 - axis], *color) for place, color in zip(positions, colors) if place[axis] == at)
            content = b"".join(struct.pack("<4f", *vertex) for vertex in side)
            assert said == {"vertices": len(side), "sha256": hashlib.sha256(content).hexdigest()}
        forge(f"job/done/{task}.json", facts=facts | {"sides": [side | {"sha256": task} for side in facts["sides"]]})
    for task in seams:
        Path(f"job/done/{task}.json").unlink()
    assert run(hmesh, seams) == told


def test_tiles_that_do_not_meet_are_counted_and_not_joined(hmesh):
    draw(width=128, height=128)
    looks, shares, made, seams, index = plan(hmesh)
    draw("other.ppm", width=128, height=128, value=lambda x, y, c: (sample(x, y, c) + 99 * (y > 40)) % 256)  # in its corners, too
    plan(hmesh, OPTIONS + " --border-tolerance 40", "other.ppm", "other")
    run(hmesh, looks + shares + made)
    finish(hmesh, "other")
    name = "tiles/0/0000_0001.hmc"
    shutil.copy(f"other/{name}", f"job/{name}")
    forge("job/done/tile_0_0001_0000.json", files=[{"name": name, "bytes": len(read(f"job/{name}")), "sha256": sums()[name[6:]]}])
    told = run(hmesh, seams + index).splitlines()

    def side(row, column, axis, at):
        hmesh.done(f"job/tiles/0/{row:04}_{column:04}.hmc -o tile.ply -q")
        positions, colors, _ = read_ply("tile.ply")  # whose y goes down from the tile's highest
        return {(place, tuple(color)) for place, color in zip(positions, colors) if place[axis] == at}

    def compare(one, other, axis):
        one, other = ({(place[1 - axis], color) for place, color in side(*tile, axis, at)} for *tile, at in (one, other))
        return len(one & other), len(one ^ other)

    wide, high = (json.loads(read("job/tiles/index.json"))["tiles"][0][key] - 1 for key in ("width", "height"))
    pairs = [compare((0, 0, high), (1, 0, 0), 1), compare((0, 0, wide), (0, 1, 0), 0), compare((0, 1, high), (1, 1, 0), 1),
             compare((1, 0, wide), (1, 1, 0), 0)]
    (shared, opened), first = [sum(column) for column in zip(*pairs)], "tile_0_0000_0000 and tile_0_0001_0000"
    assert [there == 0 for _, there in pairs] == [True, False, False, True] and shared > 9
    assert json.loads(read("job/tiles/index.json"))["seams"] == {"pairs": 4, "shared": shared, "open": opened, "first": first}
    assert told[:2] == [f"seams_0_0000  3 pairs, {shared - pairs[3][0]} vertices shared, {opened} that the other has not",
                        f"seams_0_0001  1 pairs, {pairs[3][0]} vertices shared"]
    for output in ["whole.ply", "served --format glb"]:
        hmesh.fails(f"the tiles do not all meet, first {first}", f"job join job -o {output}")
    assert not Path("whole.ply").exists() and not Path("served").exists()


# ---- by whatever engine ----
def test_no_order_threads_processes_or_restarts_are_seen_in_the_files(hmesh):
    looks, shares, made, seams, index = plan(hmesh)
    assert len(looks) == len(made) == 12 and len(seams) == 3 and (shares, index) == (["shares_0"], ["index"])
    finish(hmesh)
    plan(hmesh, folder="other")
    dice = random.Random(5)
    for k, tasks in enumerate([looks, shares, made, seams, index]):
        dice.shuffle(tasks)
        for part in (tasks[:5], tasks[5:]):
            if part:
                hmesh.done(f"job run other {' '.join(part)} --jobs {k % 4} -q")
    assert sums("other/tiles") == sums()
    run(hmesh, made)
    assert run(hmesh, made).count("done before") == 12 and hmesh.done("job status job").count("done") == 5


def test_status_tells_what_is_ready_and_mends(hmesh):
    looks, shares, made, seams, _ = plan(hmesh)
    ready = lambda: hmesh.run("job status job --ready").stdout.split()
    assert ready() == looks
    run(hmesh, looks)
    assert ready() == shares
    run(hmesh, shares)
    assert ready() == made
    run(hmesh, made[4:8])
    assert ready() == made[:4] + made[8:]
    run(hmesh, made[:4])
    assert ready() == made[8:] + seams[:1]
    finish(hmesh)
    whole = sums()
    Path("job/tiles/0/0001_0002.hmc").write_bytes(read("job/tiles/0/0001_0002.hmc")[:-1])
    assert "1 taken back" in hmesh.run("job status job --mend").stdout
    assert ready() == ["tile_0_0002_0001"]
    run(hmesh, made)
    hmesh.done("job status job -q")
    assert sums() == whole


def test_ninja_runs_a_job(hmesh):
    if not shutil.which("ninja"):
        pytest.skip("ninja is not there")
    plan(hmesh)
    plan(hmesh, folder="other")
    finish(hmesh, "other")
    subprocess.run(["ninja", "-C", "job", "-j", "2"], check=True, stdout=subprocess.DEVNULL)
    assert sums() == sums("other/tiles")


def test_killed_workers_leave_nothing_that_a_next_one_trips_over(hmesh):
    tasks = sum(plan(hmesh), [])
    plan(hmesh, folder="other")
    finish(hmesh, "other")
    dice = random.Random(3)
    for _ in range(12):
        worker = subprocess.Popen(hmesh.words(f"job run job -q {' '.join(tasks)}"), stderr=subprocess.DEVNULL)
        time.sleep(dice.uniform(0, 0.3))
        worker.kill()
        worker.wait()
    before = receipts()
    finish(hmesh)
    assert sums() == sums("other/tiles") and receipts().items() >= before.items()


# ---- what is refused ----
def test_input_that_is_missing_damaged_or_foreign_is_named_and_nothing_is_written(hmesh):
    looks, shares, made, seams, index = plan(hmesh)

    def fails(sentence, task):
        before = contents()
        hmesh.fails(sentence, f"job run job {task}")
        assert contents() == before

    fails("the task look_0_0000_0000 is not done", shares[0])
    fails("the task shares_0 is not done", made[3])
    run(hmesh, looks + shares + made)
    tile, receipt = Path("job/tiles/0/0000_0001.hmc"), Path("job/done/tile_0_0001_0000.json")
    whole, said = tile.read_bytes(), receipt.read_bytes()
    for content, sentence in [(whole[:-4], "is damaged: it has"), (whole[:90] + b"?" + whole[91:], "its bytes are not those")]:
        tile.write_bytes(content)
        fails(sentence, seams[0])
    tile.unlink()
    fails("is missing", seams[0])
    tile.write_bytes(whole)
    receipt.write_bytes(said[:-9])
    fails("is damaged", seams[0])
    receipt.write_bytes(said)
    forge(receipt, plan="0" * 64)
    fails("is of another plan", seams[0])
    receipt.write_bytes(said)
    share, look = Path("job/done/shares_0.json"), Path(f"job/done/{looks[0]}.json")
    shared, seen = share.read_bytes(), look.read_bytes()
    share.unlink()
    facts = json.loads(seen)["facts"]
    forge(look, facts=facts | {"sides": facts["sides"][::2]})
    fails("counts sides by 9 tolerances and not by 18", "shares_0")
    look.write_bytes(seen)
    share.write_bytes(shared)
    forge("job/done/shares_0.json", plan="0" * 64)
    Path("job/done/tile_0_0002_0000.json").unlink()
    fails("is of another plan", "tile_0_0002_0000")
    for name in "tile_0_0004_0000 tile_1_0000_0000 shares_1 seams_0_0003 look_0_0_0 look_0000_0000 shares".split():
        fails(f"'{name}' is no task of this job", name)
    Path(f"job/done/{looks[0]}.json").unlink()
    length, written = len(read("image.ppm")), os.stat("image.ppm")

    def fails_with(sentence, content):
        """As long and old as the image that was planned: a comment is what it lacks."""
        header, _, body = content.partition(b" 255\n")
        Path("image.ppm").write_bytes(header + b" #".ljust(length - len(content), b".") + b"\n255\n" + body)
        os.utime("image.ppm", ns=(written.st_atime_ns, written.st_mtime_ns))
        fails(sentence, looks[0])

    for kind, width, height, channels in [(6, 229, 150, 3), (6, 230, 149, 3), (5, 230, 150, 1)]:
        fails_with(f"is not the input that was planned: it has {width} x {height} samples of {channels} channels and 8 bits, "
                   "and had 230 x 150 samples of 3 channels and 8 bits",
                   b"P%d %d %d 255\n" % (kind, width, height) + bytes(width * height * channels))
    fails_with("cannot read '", b"P7 230 150 255\n")
    os.utime("image.ppm", (1e9, 1e9))
    fails("has been written since", looks[0])
    forge("job/plan.json", effort="none")
    fails("'job/plan.json' has an effort that", index[0])
    forge("job/plan.json", version="0.0.9")
    fails("was made by hmesh 0.0.9", index[0])


def test_join_refuses_tiles_that_were_damaged_after_they_were_indexed(hmesh):
    draw(width=128, height=128)
    plan(hmesh)
    finish(hmesh)
    tile = Path("job/tiles/0/0001_0000.hmc")
    whole = tile.read_bytes()
    flipped = whole[:90] + bytes([whole[90] ^ 1]) + whole[91:]
    for content, sentence in [(whole[:-1], "is damaged: it has"), (flipped, "its bytes are not those"), (None, "is missing")]:
        if content is None:
            tile.unlink()
        else:
            tile.write_bytes(content)
        for output in ["whole.ply", "as_they_are --format hmc", "served --format glb"]:
            hmesh.fails(sentence, f"job join job -o {output}")
    assert not Path("whole.ply").exists() and not list(Path().glob("*/index.json"))
    Path("job/done/index.json").unlink()
    hmesh.fails("the task index is not done", "job join job -o whole.ply")


def test_ctrl_c_while_tiles_are_joined_leaves_no_file_and_no_folder_that_looks_whole(hmesh):
    plan(hmesh)
    finish(hmesh)
    before = contents()
    said = join_interrupted(hmesh, "tile_0_0001_0000", "new.ply")
    assert said in {"hmesh: interrupted; nothing is written\n", "hmesh: cannot write 'new.ply': interrupted\n"}
    assert contents() == before
    said = join_interrupted(hmesh, "tile_0_0001_0000", "served")
    assert re.fullmatch(r"hmesh: interrupted; ('served' has no index yet|'served/.*' is not written)\n", said)
    served = [str(path) for path in Path("served").rglob("*") if path.is_file()]
    assert served and all(name.endswith(".glb") and is_whole(name) for name in served)
    hmesh.done("job join job -o served -q")
    assert len(tiles("served")) == 12 + 1


def test_a_full_disk_loses_no_finished_task(hmesh):
    looks, shares, made, _, _ = plan(hmesh)
    run(hmesh, looks + shares + made[:2])
    before = contents()
    hmesh.fails("cannot write", f"job run job {made[3]} -q", **limit(resource.RLIMIT_FSIZE, 100))
    assert contents() == before
    finish(hmesh)


def test_images_and_numbers_that_make_no_tiles_are_refused(hmesh):
    for width, height in [(300, 1), (1, 300)]:
        draw("row.ppm", width=width, height=height)
        hmesh.fails(f"is {width} x {height} px: tiles have 2 samples or more a side", "job plan row.ppm -o job")
    hmesh.fails("cannot read", "job plan no.ppm -o job")
    Path("nan.pfm").write_bytes(b"Pf 20 10 -1\n" + struct.pack("<200f", *[math.nan if k % 20 == 0 else 1 for k in range(200)]))
    hmesh.done("job plan nan.pfm -o nan -q --rate 10")
    hmesh.fails("has a sample that is NaN", "job run nan look_0_0000_0000")
    for width, height in [(9, 17), (17, 9)]:
        draw("small.ppm", width=width, height=height)
        hmesh.fails("small.ppm' has 4 levels, not 5: it has too few pixels for more", "job plan small.ppm -o job --levels 5")
    draw()
    hmesh.fails("is no folder", "job plan image.ppm -o color.ppm")
    for arguments in ["job status job", "job run job index", "job join job -o whole.ply"]:
        hmesh.fails("'job' is no job: 'job/plan.json' is missing", arguments)
    assert not Path("job").exists()
    plan(hmesh, "--tile 64 --vertices 30 --border-tolerance 1")
    hmesh.fails("'job' holds another plan", "job plan image.ppm -o job --tile 64 --vertices 31 --border-tolerance 1")
    plan(hmesh, "--tile 64 --vertices 30 --border-tolerance 1")
    run(hmesh, phases()[0])
    hmesh.fails("the sides of 12 tiles need", "job run job shares_0")


def test_as_many_vertices_as_a_rate_rounds_to_and_no_more_tiles_than_a_job_may_have(hmesh):
    assert ", 8 x 8 px, 9 vertices\n" in hmesh.done("job plan constant.pgm -o job --rate 13.3")  # of 8.512
    with open("large.pgm", "wb") as file:  # a hole, but for its head
        file.write(b"P5 20289 20289 255\n")
        file.truncate(file.tell() + 20289 ** 2)
    hmesh.fails("large.pgm' would be 100489 tiles, more than 100000: take larger ones by --tile",
                "job plan large.pgm -o other --tile 64")
    assert not Path("other").exists()


def test_an_image_of_as_many_bytes_and_other_samples_is_not_the_planned_one(hmesh):
    (look, *_), *_ = plan(hmesh, "--rate 20", "grey16.pgm")
    size, written = len(read("grey16.pgm")), os.stat("grey16.pgm")
    head = b"P5\n20 16 #".ljust(size - 20 * 16 - 5, b".") + b"\n255\n"
    Path("grey16.pgm").write_bytes(head + bytes(20 * 16))
    os.utime("grey16.pgm", ns=(written.st_atime_ns, written.st_mtime_ns))
    assert len(read("grey16.pgm")) == size
    hmesh.fails("it has 20 x 16 samples of 1 channels and 8 bits, and had 20 x 16 samples of 1 channels and 16 bits",
                f"job run job {look}")


@pytest.mark.parametrize("words, sentence", rows("""
    job                                        | job is given without plan, run, status or join
    job walk                                   | job 'walk' is not one of: plan, run, status, join
    job plan                                   | no input file is given
    job plan a.png                             | no folder is given: -o names it
    job plan a.png b.png -o job                | are two images
    job plan - -o job                          | the standard input is no file
    job plan a.png -o job --tile 63            | --tile '63' must be from 64 to 65536
    job plan a.png -o job --levels 0           | --levels '0' must be from 1 to 10
    job plan a.png -o job --levels 11          | --levels '11' must be from 1 to 10
    job plan a.png -o job --vertices 3         | --vertices '3' must be from 4 to
    job plan a.png -o job --vertices 9 --rate 1 | --vertices excludes --rate
    job plan a.png -o job --rate 0             | --rate '0' must be above 0
    job plan a.png -o job --border-tolerance x | --border-tolerance 'x' is not a number
    job plan a.png -o job --border-tolerance 1e7 | --border-tolerance '1e7' must be from 0 to 1000000
    job plan a.png -o job --max-error 2        | unknown option '--max-error'
    job run job                                | no folder or no task is given
    job status                                 | no folder is given
    job join job                               | no output is given
    job join job -o x/{name}.ply               | --output 'x/{name}.ply' has {name} in it, which stands for nothing in a job
    job join job -o x.ply --format glb         | --format is given, of tiles in a folder, and 'x.ply' is one file
    job join job -o x.xyz                      | 'x.xyz' must end in one of: .ply, .obj
    job join job -o {lod}                      | has {lod} in it
    job join job -o x --format pdf             | --format 'pdf' is not one of: glb, ply, obj, hmc
"""))
def test_wrong_usage(hmesh, words, sentence):
    ran = hmesh.run(words)
    assert ran.returncode == 2 and sentence in ran.stderr


def test_help_of_jobs(hmesh):
    assert "hmesh job plan IMAGE -o JOB" in hmesh.done("job --help")
    assert "\n  JOB                   the job's folder\n" in hmesh.done("job run --help")
    for command in "plan run status join".split():
        assert "Usage: hmesh job " + command in hmesh.done(f"job {command} --help")


def test_join_writes_nothing_into_the_job_and_says_what_an_output_is_not(hmesh):
    draw("image.ppm", value=lambda x, y, c: 77)
    plan(hmesh)
    finish(hmesh)
    before = contents()
    for output in ["job", "job/done", "job/x.ply", "./job/../job/tiles"]:
        hmesh.fails("is within the job", f"job join job -o {output}")
    for link, make in {"soft.ply": os.symlink, "hard.ply": os.link}.items():
        make("image.ppm", link)
        image = read("image.ppm")
        hmesh.fails(f"'{link}' would overwrite the input of the job", f"job join job -o {link}")
        assert read("image.ppm") == read(link) == image
        Path(link).unlink()
    for arguments, sentence in {"-o -": "--output - is no file", "-o x.glb --format ply": "'x.glb' is one file of the format .glb"}.items():
        run = hmesh.run(f"job join job {arguments}")
        assert run.returncode == 2 and sentence in run.stderr
    for name in ["x.stl", "x.gltf", "x.foo", ".ply", "out/.ply"]:  # no silent folders of such names
        run = hmesh.run(f"job join job -o {name}")
        assert run.returncode == 2 and f"'{name}' must end in one of" in run.stderr
    assert contents() == before
    plan(hmesh, folder="other")
    hmesh.fails("is within another job, '", "job join job -o other/tiles")
    hmesh.done("job join job -o v1.2 --format glb")
    hmesh.done("job join job -o v1.2")
    hmesh.done("job join job -o as_they_are --format hmc")
    assert tiles("as_they_are") == tiles()
    Path("taken/0/0001_0000.glb").mkdir(parents=True)
    hmesh.fails("cannot write 'taken/0/0001_0000.glb': Is a directory", "job join job -o taken")
    assert not Path("taken/index.json").exists()
    for folder in ["v1.3/", ".hidden/", "new/."]:
        hmesh.done(f"job join job -o {folder}")
        assert Path(folder, "index.json").exists()
    assert Path("v1.2").is_dir()
    assert "\nPSNR       inf dB of" in hmesh.done("job join job -o x.glb")


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no /dev/full")
def test_what_cannot_be_printed_is_a_failure(hmesh):
    draw(width=128, height=128)
    tasks = sum(plan(hmesh), [])
    with open("/dev/full", "wb") as file:
        assert hmesh.run(f"job plan image.ppm -o job {OPTIONS}", stdout=file).returncode == 1
        assert hmesh.run(["job", "run", "job", *tasks], stdout=file).returncode == 1
        assert list(receipts()) == tasks[:1]  # who reads nothing of it does not want the others
        is_failure(hmesh.run("job status job --ready", stdout=file), "cannot write to the standard output")
        finish(hmesh)
        for arguments in ["job status job", "job join job -o whole.ply"]:
            is_failure(hmesh.run(arguments, stdout=file), "cannot write to the standard output")
        assert hmesh.run("job status job -q", stdout=file).returncode == 0
        assert hmesh.run(f"job run job {tasks[0]} -q", stdout=file).returncode == 0


def test_samples_far_above_one_have_sides_that_fit_them(hmesh):
    size, samples = 120, [1e5 * math.sin(x / 9) * math.cos(y / 7) for y in range(120) for x in range(120)]
    for name, factor in {"high": 1, "low": 1e-5}.items():
        Path(f"{name}.pfm").write_bytes(b"Pf %d %d -1\n" % (size, size) + struct.pack(f"<{size * size}f", *[factor * s for s in samples]))
        plan(hmesh, "--tile 64 --rate 6 --effort fast", f"{name}.pfm", name)
        finish(hmesh, name)
    assert [json.loads(read(f"{name}/tiles/index.json"))["vertices"] for name in ("high", "low")] == [864, 864]


def test_levels_with_fewer_vertices_than_their_sides_need_say_so(hmesh):
    draw("small.ppm", width=100, height=100)
    tasks = sum(plan(hmesh, "--levels 3", "small.ppm"), [])
    run = hmesh.run(["job", "run", "job", *tasks])
    assert run.returncode == 1 and "the sides of the only tile need" in run.stderr and "take fewer levels by --levels" in run.stderr
    for tile, folder, advice in [(64, "four", "larger tiles by --tile, or more vertices"), (99, "one", "more vertices")]:
        looks, shares, *_ = plan(hmesh, f"--vertices 5 --tile {tile}", "small.ppm", folder)
        run = hmesh.run(["job", "run", folder, *looks, *shares])
        assert run.returncode == 1 and run.stderr.endswith(f" vertices with those between them, more than 5: take {advice}\n")
