"""hmesh-terrain job --levels: tiles of several levels of detail, each of them one surface within its bound."""
import json
from pathlib import Path

import pytest

import dems
from conftest import read
from dems import Model, ground, judge, read_model, with_holes
from jobs import finish, phases, run, sums, tiles

WIDTH, HEIGHT, CELLS, BOUND, LEVELS = 120, 75, 16, 9, 3
OPTIONS = f"--effort fast --tiles {CELLS} --levels {LEVELS}"


def make(terrain, heights, options="", name="dem.asc"):
    Path(name).write_bytes(dems.asc(heights))
    terrain.done(f"job plan {name} -o job --max-error {BOUND} {OPTIONS} -q {options}")
    finish(terrain)
    return json.loads(read("job/tiles/index.json"))


def of_level(index, level):
    return [tile for tile in index["tiles"] if tile["level"] == level and tile["is"] == "made"]


def whole(names):
    """Tiles as one model: vertices are one where position and normal are the same bit for bit."""
    known, faces = {}, []
    for name in names:
        tile = read_model(f"job/tiles/{name}")
        numbers = [known.setdefault(key, len(known)) for key in zip(tile.vertices, tile.normals)]
        faces += [tuple(numbers[v] for v in face) for face in tile.faces]
    return Model([position for position, _ in known], faces)


def thinned(heights, step):
    return [row[::step] for row in heights[::step]]


def covered(heights, step):
    """All samples between the outermost of those that a level has."""
    return [row[: (len(row) - 1) // step * step + 1] for row in heights[: (len(heights) - 1) // step * step + 1]]


def nodes(node, parents=()):
    yield node, parents
    for child in node.get("children", []):
        yield from nodes(child, (*parents, node))


def span(node):
    box = node["boundingVolume"]["box"]
    return [(box[k] - box[3 + 4 * k], box[k] + box[3 + 4 * k]) for k in range(3)]


@pytest.mark.parametrize("options, scale", [("", 1), ("--scale 0.5 --z-scale 3", 0.5)])
def test_each_level_is_one_surface_within_its_bound_and_says_how_far_it_is_off_all_samples(terrain, options, scale):
    heights = ground(WIDTH, HEIGHT)
    index = make(terrain, heights, options)
    z_scale = 1.5 if scale == 0.5 else 1
    assert [level["step"] for level in index["levels"]] == [1, 2, 4]
    for k, level in enumerate(index["levels"]):
        step = 2 ** k
        model = whole(tile["file"] for tile in of_level(index, k))
        place = lambda x, y, z, s=scale * step: (x / s, (scale * (HEIGHT - 1) - y) / s, z / z_scale)
        off = judge(thinned(heights, step), model, place)
        assert off <= level["bound"] == BOUND * step and off == pytest.approx(level["max_error"], abs=1e-4)
        place = lambda x, y, z: (x / scale, HEIGHT - 1 - y / scale, z / z_scale)
        assert judge(covered(heights, step), model, place) == pytest.approx(level["input_error"], abs=1e-4)
        assert level["input_error"] == max(tile["input_error"] for tile in of_level(index, k))
    assert index["triangles"] == index["levels"][0]["triangles"] > index["levels"][1]["triangles"] > index["levels"][2]["triangles"]


@pytest.mark.parametrize("width, height", [(WIDTH, HEIGHT), (66, 34), (131, 65)])  # tiles of 66: the last one has nothing above it
def test_a_tileset_is_a_tree_in_which_four_tiles_replace_one(terrain, width, height):
    index = make(terrain, ground(width, height))
    tileset = json.loads(read("job/tiles/tileset.json"))
    assert tileset["root"]["refine"] == "REPLACE" and tileset["geometricError"] >= tileset["root"]["geometricError"]
    errors = {tile["file"]: tile["input_error"] for tile in index["tiles"]}
    found = []
    for node, parents in nodes(tileset["root"]):
        for parent in parents:
            assert all(low >= a and high <= b for (low, high), (a, b) in zip(span(node), span(parent)))
            assert node["geometricError"] <= parent["geometricError"]
        if "content" not in node:
            assert node["children"]
            continue
        name = node["content"]["uri"]
        found.append(name)
        level, x, y = (int(number) for number in name.replace(".glb", "").replace("_", "/").split("/"))
        assert node["geometricError"] == 0 if level == 0 else node["geometricError"] >= errors[name]
        above = [parent["content"]["uri"] for parent in parents if "content" in parent]
        assert above == [name for name in (f"{k}/{x >> k - level:04}_{y >> k - level:04}.glb" for k in range(LEVELS - 1, level, -1)) if name in errors]
        assert all(low <= at <= high for vertex in read_model(f"job/tiles/{name}").vertices for (low, high), at in zip(span(node), vertex))
    assert sorted(found) == sorted(errors) == sorted(set(tiles()) - {"index.json", "tileset.json"})


def test_levels_are_the_same_in_any_order_and_the_join_is_that_of_the_finest(terrain):
    make(terrain, ground(WIDTH, HEIGHT))
    before = sums()
    terrain.done(f"job plan dem.asc -o other --max-error {BOUND} {OPTIONS} -q")
    run(terrain, phases("other")[0][::-1], "other")
    finish(terrain, "other")
    assert sums("other/tiles") == before
    terrain.done(f"job plan dem.asc -o one --max-error {BOUND} --effort fast --tiles {CELLS} -q")
    finish(terrain, "one")
    assert {name: content for name, content in before.items() if name[:2] == "0/"}.items() <= sums("one/tiles").items()
    for job in ["job", "one"]:
        terrain.done(f"job join {job} -o {job}.ply -q")
    assert read("job.ply") == read("one.ply")


def test_levels_leave_out_what_has_no_data(terrain):
    heights = with_holes(ground(WIDTH, HEIGHT))
    heights = [[None if x > 63 and y > 31 else z for x, z in enumerate(row)] for y, row in enumerate(heights)]
    index = make(terrain, heights)
    for k in range(LEVELS):
        step = 2 ** k
        is_seam = lambda x, y: x % CELLS == 0 or y % CELLS == 0
        place = lambda x, y, z: (x / step, (HEIGHT - 1 - y) / step, z)
        assert judge(thinned(heights, step), whole(tile["file"] for tile in of_level(index, k)), place, may_be_open=is_seam) <= BOUND * step


@pytest.mark.parametrize("west, north, across, down", [(530, 380, 6, 4), (531, 379, 7, 6), (531, 378, 10, 7)])
def test_zooms_of_cesiums_grid_have_the_tiles_that_lie_within_the_input(terrain, west, north, across, down):
    side, cells = 180 / 2 ** 9, 8
    heights = ground(across * cells + 1, down * cells + 1)
    Path("dem.asc").write_bytes(dems.asc(heights))
    w, n = -180 + west * side, -90 + (north + 1) * side
    levels = 2 if across < 8 else 3
    terrain.done(f"job plan dem.asc -o job --max-error {BOUND} --effort fast --tiles {cells} --levels {levels} --format terrain "
                 f"--extent {w},{n - down * side},{w + across * side},{n} -q")
    finish(terrain)
    fine = {(x, y) for x in range(west, west + across) for y in range(north - down + 1, north + 1)}
    names = {f"{9 - k}/{x >> k}/{y >> k}.terrain" for k in range(levels) for x, y in fine
             if all(((x >> k << k) + a, (y >> k << k) + b) in fine for a in range(2 ** k) for b in range(2 ** k))}
    layer = json.loads(read("job/tiles/layer.json"))
    available = {f"{zoom}/{x}/{y}.terrain" for zoom, runs in enumerate(layer["available"]) for r in runs
                 for x in range(r["startX"], r["endX"] + 1) for y in range(r["startY"], r["endY"] + 1)}
    assert available == names == set(tiles()) - {"layer.json", "index.json"} and len({name[0] for name in names}) == levels
    for name in names:
        zoom, x, y = (int(number) for number in name.replace(".terrain", "").split("/"))
        step = 2 ** (9 - zoom)
        column, row = (x * step - west) * cells, (north + 1 - (y + 1) * step) * cells
        samples = [line[column : column + cells * step + 1 : step] for line in heights[row : row + cells * step + 1 : step]]
        place = lambda u, v, z: (u * cells, (1 - v) * cells, z)
        assert judge(samples, read_model(f"job/tiles/{name}"), place, slack=0.001) <= BOUND * step


def test_more_levels_than_there_are_samples_or_tiles_for_are_refused(terrain):
    Path("dem.asc").write_bytes(dems.asc(ground(20, 9)))
    terrain.fails("has 4 levels, not 5: it has too few samples for more", "job plan dem.asc -o job --max-error 9 --levels 5")
    Path("square.asc").write_bytes(dems.asc(ground(9, 9)))
    side = 180 / 2 ** 9
    terrain.fails("has 1 levels, not 2: no tile of Cesium's next zoom lies within it",
                  f"job plan square.asc -o job --max-error 9 --levels 2 --tiles 8 --format terrain --extent {side},0,{2 * side},{side}")
    assert not Path("job").exists()
