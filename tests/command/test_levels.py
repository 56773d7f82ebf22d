"""hmesh-terrain job --levels: tiles of several levels of detail, each of them one surface within its bound."""
import json
import math
import struct
from pathlib import Path

import pytest

import dems
from conftest import read
from dems import Model, as_float, ground, judge, read_model, with_holes
from jobs import finish, phases, run, sums, tiles
from test_terrain import needs_gdal

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


def hanging(name):
    """The second primitive of a tile: positions, z up, and faces."""
    file = Path(name).read_bytes()
    size = struct.unpack_from("<I", file, 12)[0]
    head, buffer = json.loads(file[20 : 20 + size]), file[28 + size :]
    surface, walls = head["meshes"][0]["primitives"]

    def numbers(accessor):
        accessor = head["accessors"][accessor]
        view = head["bufferViews"][accessor["bufferView"]]
        form = {5126: "f", 5125: "I", 5123: "H"}[accessor["componentType"]]
        count = accessor["count"] * {"VEC3": 3, "VEC2": 2, "SCALAR": 1}[accessor["type"]]
        return struct.unpack_from(f"<{count}{form}", buffer, view["byteOffset"] if "byteOffset" in view else 0)

    flat, corners = numbers(walls["attributes"]["POSITION"]), numbers(walls["indices"])
    bounds = head["accessors"][walls["attributes"]["POSITION"]]
    assert [[min(flat[k::3]), max(flat[k::3])] for k in range(3)] == [[as_float(bounds[end][k]) for end in ("min", "max")] for k in range(3)]
    return [(x, -z, y) for x, y, z in zip(flat[::3], flat[1::3], flat[2::3])], list(zip(corners[::3], corners[1::3], corners[2::3]))


def height_at(line, at):
    """Of a polyline of (place, height) from a lower place to a higher one."""
    for (a, low), (b, high) in zip(line, line[1:]):
        if a <= at <= b:
            return low + (high - low) * (at - a) / (b - a)
    return None


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


@pytest.mark.parametrize("words", ["--max-error {}", "--vertices 80 --border-tolerance {}"])
def test_a_level_is_the_model_of_every_second_sample_with_twice_the_tolerance(terrain, words):
    heights = ground(65, 49)
    Path("dem.asc").write_bytes(dems.asc(heights))
    Path("thin.asc").write_bytes(dems.asc(thinned(heights, 2), cell=2))
    terrain.done(f"job plan dem.asc -o job {words.format(7)} --effort fast --tiles {CELLS} --levels 2 -q")
    finish(terrain)
    terrain.done(f"thin.asc -o one.glb {words.format(14)} --effort fast --tiles {CELLS} -q")
    for x, y in [(0, 0), (0, 1), (1, 0), (1, 1)]:
        assert read(f"one_{x}_{y}.glb") == read(f"job/tiles/1/{x:04}_{y:04}.glb")


@pytest.mark.parametrize("width, height, options, z_scale", [
    (WIDTH, HEIGHT, "", 1), (66, 34, "", 1),  # the last of the tiles of 66 has nothing above it
    (131, 65, "--scale 2 --z-scale 3", 6)])
def test_a_tileset_is_a_tree_in_which_four_tiles_replace_one(terrain, width, height, options, z_scale):
    index = make(terrain, ground(width, height), options)
    tileset = json.loads(read("job/tiles/tileset.json"))
    assert tileset["root"]["refine"] == "REPLACE" and tileset["geometricError"] >= tileset["root"]["geometricError"]
    errors = {tile["file"]: tile["input_error"] * z_scale for tile in index["tiles"]}
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
        below = [child["geometricError"] for child in node.get("children", [])]
        assert node["geometricError"] == pytest.approx(max(errors[name], *below) if below else 0)
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


@pytest.mark.parametrize("west, north, across, down, options", [
    (530, 380, 6, 4, ""), (531, 379, 7, 6, "--no-normals"), (531, 378, 10, 7, "")])
def test_zooms_of_cesiums_grid_have_the_tiles_that_lie_within_the_input(terrain, west, north, across, down, options):
    side, cells = 180 / 2 ** 9, 8
    heights = ground(across * cells + 1, down * cells + 1)
    Path("dem.asc").write_bytes(dems.asc(heights))
    w, n = -180 + west * side, -90 + (north + 1) * side
    levels = 2 if across < 8 else 3
    terrain.done(f"job plan dem.asc -o job --max-error {BOUND} --effort fast --tiles {cells} --levels {levels} --format terrain "
                 f"--extent {w},{n - down * side},{w + across * side},{n} -q {options}")
    finish(terrain)
    fine = {(x, y) for x in range(west, west + across) for y in range(north - down + 1, north + 1)}
    names = {f"{9 - k}/{x >> k}/{y >> k}.terrain" for k in range(levels) for x, y in fine
             if all(((x >> k << k) + a, (y >> k << k) + b) in fine for a in range(2 ** k) for b in range(2 ** k))}
    layer = json.loads(read("job/tiles/layer.json"))
    assert layer["extensions"] == ([] if options else ["octvertexnormals"])
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


@pytest.mark.parametrize("west", [-181, -180, 170, 178, 180, 185])
def test_degrees_may_be_counted_beyond_180(terrain, west):
    side, cells, across = 180 / 2 ** 6, 4, 4
    first = round((west + 180) / side)
    west = first * side - 180
    Path("dem.asc").write_bytes(dems.asc(ground(across * cells + 1, 2 * cells + 1)))
    terrain.done(f"job plan dem.asc -o job --max-error 9 --tiles {cells} --levels 2 --format terrain --extent {west},0,{west + across * side},{2 * side} -q")
    finish(terrain)
    columns = {(first + x) % 128 for x in range(across)}
    layer = json.loads(read("job/tiles/layer.json"))
    assert {x for run in layer["available"][6] for x in range(run["startX"], run["endX"] + 1)} == columns
    assert {int(name.split("/")[1]) for name in tiles() if name.startswith("6/")} == columns
    assert {int(name.split("/")[1]) for name in tiles() if name.startswith("5/")} == {x // 2 for x in columns if x % 2 == 0 and x + 1 in columns}
    for name in set(tiles()) - {"layer.json", "index.json"}:
        zoom, x, _ = (int(number) for number in name.replace(".terrain", "").split("/"))
        middle = struct.unpack_from("<2d", Path("job/tiles", name).read_bytes())
        degrees = math.degrees(math.atan2(middle[1], middle[0])) + 180
        assert degrees == pytest.approx((x + 0.5) * 180 / 2 ** zoom, abs=0.01)


# The last column of tiles of 98 samples, 96 to 97, stands beside coarser levels that end there, amid a tile's side.
@pytest.mark.parametrize("effort, width", [("fast", WIDTH), ("best", WIDTH), ("fast", 6 * CELLS + 2)])
def test_skirts_hang_from_the_sides_as_deep_as_any_crack_to_another_level_is(terrain, effort, width):
    heights = ground(width, HEIGHT)
    terrain_options = f"--max-error {BOUND} --tiles {CELLS} --levels {LEVELS} --effort {effort} -q"
    Path("dem.asc").write_bytes(dems.asc(heights))
    for folder, options in [("plain", ""), ("job", "--skirts")]:
        terrain.done(f"job plan dem.asc -o {folder} {terrain_options} {options}")
        finish(terrain, folder)
        terrain.done(f"job join {folder} -o {folder}.ply -q")
    assert read("plain.ply") == read("job.ply")
    index, lines = json.loads(read("job/tiles/index.json")), {}
    tree = nodes(json.loads(read("job/tiles/tileset.json"))["root"])
    boxes = {node["content"]["uri"]: span(node) for node, _ in tree if "content" in node}
    for tile in index["tiles"]:
        name = tile["file"]
        model, plain = read_model(f"job/tiles/{name}"), read_model(f"plain/tiles/{name}")
        assert (model.vertices, model.faces, model.normals) == (plain.vertices, plain.faces, plain.normals)
        walls, faces = hanging(f"job/tiles/{name}")
        assert all(low <= at <= high for vertex in walls for (low, high), at in zip(boxes[name], vertex))
        step = 2 ** tile["level"]
        west, north = tile["column"] * step, HEIGHT - 1 - tile["row"] * step
        sides = {(0, west), (0, west + (tile["width"] - 1) * step), (1, north), (1, north - (tile["height"] - 1) * step)}
        on = {side: sorted((v[1 - side[0]], v[2]) for v in model.vertices if v[side[0]] == side[1]) for side in sides}
        below = {}
        for x, y, z in walls:
            below.setdefault((x, y), []).append(z)
        assert set(below) == {(v[0], v[1]) for v in model.vertices if (0, v[0]) in sides or (1, v[1]) in sides}
        assert all(max(zs) - min(zs) == pytest.approx(tile["skirt"], abs=1e-3) for zs in below.values())
        edges = {tuple(sorted((walls[a][:2], walls[b][:2]))) for face in faces for a, b in zip(face, face[1:] + face[:1]) if walls[a][:2] != walls[b][:2]}
        assert len(faces) == 2 * len(edges) and len(edges) == sum(len(line) - 1 for line in on.values())
        for a, b, c in faces:  # outward: away from the middle of the tile
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = walls[a], walls[b], walls[c]
            normal = ((by - ay) * (cz - az) - (bz - az) * (cy - ay), (bz - az) * (cx - ax) - (bx - ax) * (cz - az))
            middle = (west + (tile["width"] - 1) * step / 2, north - (tile["height"] - 1) * step / 2)
            assert normal[0] * (ax - middle[0]) + normal[1] * (ay - middle[1]) > 0
        for side, line in on.items():
            lines.setdefault(side, []).append((tile, line))
    widest = compared = 0
    for beside in lines.values():
        for one, line in beside:
            for other, there in beside:
                if one["level"] >= other["level"]:
                    continue
                for at in {at for at, _ in line + there}:
                    a, b = height_at(line, at), height_at(there, at)
                    if a is not None and b is not None:
                        compared += 1
                        widest = max(widest, abs(a - b))
                        assert abs(a - b) <= min(one["skirt"], other["skirt"])
    assert compared > 1000 and widest > 2 * BOUND


def test_levels_of_heights_of_64_bits_say_how_far_they_are_off_these(terrain):
    needs_gdal(terrain)
    heights = [[2 ** 24 + 0.37 * z for z in row] for row in ground(65, 33)]  # floats are 2 apart there
    Path("dem.tif").write_bytes(dems.geotiff(heights, kind="d"))
    terrain.done(f"job plan dem.tif -o job --max-error {BOUND} --effort fast --tiles {CELLS} --levels 2 -q")
    finish(terrain)
    for tile in json.loads(read("job/tiles/index.json"))["tiles"]:
        step, model = 2 ** tile["level"], read_model(f"job/tiles/{tile['file']}")
        west, north, wide, high = (step * at for at in (tile["column"], tile["row"], tile["width"] - 1, tile["height"] - 1))
        samples = [row[west : west + wide + 1] for row in heights[north : north + high + 1]]
        for part, told in [(1, "input_error"), (step, "max_error")]:
            place = lambda x, y, z, s=part: ((x - west) / s, (32 - y - north) / s, z)
            assert judge(thinned(samples, part), model, place) <= tile[told]


@pytest.mark.parametrize("cells", [2, 8])
@pytest.mark.parametrize("along", [0, 1])
def test_a_pit_in_a_row_that_tiles_share_counts_for_both_wherever_rounding_takes_the_row(terrain, cells, along):
    side = 2 * cells  # of level 1; the pit is between its samples
    x, y = (side, 1) if along == 1 else (1, side)
    Path("dem.asc").write_bytes(dems.asc([[-500 if (i, j) == (x, y) else 0 for i in range(2 * side + 1)] for j in range(2 * side + 1)]))
    for spacing in ["1", "0.1", "30.87"]:
        terrain.done(f"job plan dem.asc -o {spacing} --max-error 1 --tiles {cells} --levels 2 --spacing {spacing} -q")
        finish(terrain, spacing)
        index, tileset = (json.loads(read(f"{spacing}/tiles/{name}.json")) for name in ("index", "tileset"))
        off = {(tile["x"], tile["y"]): tile["input_error"] for tile in index["tiles"] if tile["level"] == 1}
        beside = {(0, 0), (1, 0) if along == 1 else (0, 1)}
        assert off == {place: pytest.approx(500 if place in beside else 0) for place in [(0, 0), (1, 0), (0, 1), (1, 1)]}
        coarse = [node for node, _ in nodes(tileset["root"]) if node.get("content", {}).get("uri", "").startswith("1/")]
        assert sum(node["geometricError"] > 499 for node in coarse) == 2


def test_a_pit_beside_a_hole_counts_where_15_bits_leave_it_beside_the_surface(terrain):
    width, hole, pit = 4097, range(1456, 1480), (1480, 3)  # of which 15 bits make 1480.045
    heights = [[None if x in hole else -500 if (x, y) == pit else 0 for x in range(width)] for y in range(17)]
    Path("dem.asc").write_bytes(dems.asc(heights))
    terrain.done("job plan dem.asc -o job --max-error 1 --tiles 512 --levels 4 --format terrain --extent 0,0,1,0.004 --effort draft -q")
    finish(terrain)
    off = [level["input_error"] for level in json.loads(read("job/tiles/index.json"))["levels"]]
    assert off[0] < 1 and off[1:] == [pytest.approx(500, abs=0.01)] * 3


def test_skirts_reach_into_pits_of_their_rows_that_a_level_leaves_out(terrain):
    pits = {(2, 0), (2, 8), (0, 2), (8, 2)}  # between samples 0 and 4 of level 2
    heights = [[100 if (x, y) in pits else 300 for x in range(9)] for y in range(9)]
    Path("dem.asc").write_bytes(dems.asc(heights))
    terrain.done("job plan dem.asc -o job --max-error 1 --tiles 2 --levels 3 --skirts -q")
    finish(terrain)
    found = []
    for tile in json.loads(read("job/tiles/index.json"))["tiles"]:
        west, north, east, south = (2 ** tile["level"] * at for at in (
            tile["column"], tile["row"], tile["column"] + tile["width"] - 1, tile["row"] + tile["height"] - 1))
        if any((x in (west, east) or y in (north, south)) and west <= x <= east and north <= y <= south for x, y in pits):
            found.append(tile["skirt"])
    assert len(found) == 1 + 3 + 7 and min(found) > 200


def test_more_levels_than_there_are_samples_or_tiles_for_are_refused(terrain):
    Path("dem.asc").write_bytes(dems.asc(ground(20, 9)))
    terrain.fails("has 4 levels, not 5: it has too few samples for more", "job plan dem.asc -o job --max-error 9 --levels 5")
    Path("square.asc").write_bytes(dems.asc(ground(9, 9)))
    side = 180 / 2 ** 9
    terrain.fails("has 1 levels, not 2: no tile of Cesium's next zoom lies within it",
                  f"job plan square.asc -o job --max-error 9 --levels 2 --tiles 8 --format terrain --extent {side},0,{2 * side},{side}")
    assert not Path("job").exists()
