"""hmesh-terrain job: a model as tasks in files, done by whatever engine, in any order, on a disk that fails."""
import json
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
from pathlib import Path

import pytest

import dems
from conftest import contents, is_failure, limit, read, rows, send_once_caught
from dems import ground, judge, read_model, with_holes
from jobs import finish, forge, join_interrupted, kill_session, phases, receipts, run, sums, tiles

WIDTH, HEIGHT, CELLS = 120, 75, 32
TILES = [(x, y) for y in range(3) for x in range(4)]
OPTIONS = f"--max-error 9 --effort fast --tiles {CELLS}"


def write(name, content):
    Path(name).write_bytes(content)


def plan(terrain, options="", dem="dem.pgm", folder="job"):
    if not Path(dem).exists():
        write(dem, dems.pgm(ground(WIDTH, HEIGHT)))
    terrain.done(f"job plan {dem} -o {folder} {OPTIONS} -q {options}")
    return phases(folder)


def edges(model):
    """Those of one face, as pairs of places."""
    found = {}
    for a, b, c in model.faces:
        for edge in ((a, b), (b, c), (c, a)):
            assert edge not in found, "an edge has two faces on one side"
            found[edge] = True
    return {(model.vertices[a], model.vertices[b]) for a, b in found if (b, a) not in found}


def floats(numbers):
    return struct.unpack("3f", struct.pack("3f", *numbers))  # of the nine digits of OBJ


def from_south(height):
    return lambda x, y, z: (x, height - 1 - y, z)


# ---- what comes out ----
@pytest.mark.parametrize("kind, options", [("glb", ""), ("glb", "--no-normals --scale 0.5 --z-scale 3"),
                                           ("terrain", "--extent 7,45,7.5,45.4")])
def test_tiles_are_those_of_one_process_byte_for_byte_in_whatever_order_tasks_are_done(terrain, kind, options):
    first, seams, index = plan(terrain, f"{options} --format {kind}")
    assert len(first) == len(TILES) and len(seams) == 3 and index == ["index"]
    assert [sorted(names) for names in (first, seams)] == [sorted(first, key=lambda n: n.split("_")), seams]
    random.Random(7).shuffle(first)
    run(terrain, first)
    run(terrain, seams[::-1])
    run(terrain, index)
    terrain.done(f"dem.pgm -o one.{kind} {OPTIONS} {options} -q")
    for x, y in TILES:
        assert read(f"one_{x}_{y}.{kind}") == read(f"job/tiles/0/{x:04}_{y:04}.{kind}")
    report = json.loads(read("job/tiles/index.json"))
    assert report["seams"]["pairs"] == 17 and report["seams"]["shared"] > 60 and report["seams"]["open"] == 0
    assert {t["file"]: t["sha256"] for t in report["tiles"]}.items() <= sums().items()


def test_no_threads_processes_or_restarts_are_seen_in_the_files(terrain):
    plan(terrain)
    finish(terrain)
    before = sums()
    plan(terrain, folder="other")
    first, seams, index = phases()
    for k, tasks in enumerate([first[:1], first[1:5], first[5:], seams[1:], seams[:1], index]):
        terrain.done(f"job run other {' '.join(tasks)} --jobs {k % 4} -q")
    assert sums("other/tiles") == before


def test_the_whole_is_one_surface_without_a_crack_within_the_bound_in_any_format(terrain):
    plan(terrain)
    finish(terrain)
    text = terrain.done("job join job -o whole.ply")
    assert "note" not in text
    model = read_model("whole.ply")
    assert f"{len(model.vertices)} vertices, {len(model.faces)} triangles" in text
    assert judge(ground(WIDTH, HEIGHT), model, from_south(HEIGHT)) <= 9
    assert len(set(model.vertices)) == len(model.vertices) == len(model.normals)
    assert all(a[k] == b[k] and a[k] in (0, side) for a, b in edges(model)
               for k, side in [(0, WIDTH - 1) if a[0] == b[0] else (1, HEIGHT - 1)])
    corners = sorted((x, y) for x, y, _ in model.vertices if x in (0, WIDTH - 1) and y in (0, HEIGHT - 1))
    assert corners == [(0, 0), (0, 74), (119, 0), (119, 74)]
    of_tiles = [read_model(f"job/tiles/0/{x:04}_{y:04}.glb") for x, y in TILES]
    assert len(model.faces) == sum(len(tile.faces) for tile in of_tiles)
    known = {vertex: normal for tile in of_tiles for vertex, normal in zip(tile.vertices, tile.normals)}
    assert all(known[vertex] == normal for vertex, normal in zip(model.vertices, model.normals))
    for kind in ["glb", "obj"]:
        terrain.done(f"job join job -o whole.{kind} -q")
        other = read_model(f"whole.{kind}")
        assert other.faces == model.faces and [floats(v) for v in other.vertices] == model.vertices
        assert [floats(n) for n in other.normals] == model.normals


@pytest.mark.parametrize("options, step", [("", 1), ("--scale 0.5 --no-normals", 0.5)])
def test_the_whole_has_places_in_an_image_of_the_heights_and_normals_if_its_tiles_have(terrain, options, step):
    plan(terrain, options)
    finish(terrain)
    tile = read_model("job/tiles/0/0001_0001.glb")
    for kind in ["ply", "obj", "glb"]:
        terrain.done(f"job join job -o whole.{kind} -q")
        model = read_model(f"whole.{kind}")
        assert len(model.normals) == (len(model.vertices) if options == "" else 0)
        assert set(tile.vertices) <= set(map(floats, model.vertices))
        places = [((x / step + 0.5) / WIDTH, (HEIGHT - 0.5 - y / step) / HEIGHT) for x, y, _ in model.vertices]
        assert len(places) == len(model.textures)
        assert all(abs(a - b) < 1e-6 for place, texture in zip(places, model.textures) for a, b in zip(place, texture))


def test_a_full_disk_leaves_nothing_of_a_whole(terrain):
    plan(terrain)
    finish(terrain)
    before = contents()
    for output in ["whole.ply", "whole.obj", "whole.glb", "served"]:
        terrain.fails("cannot write '", f"job join job -o {output}", **limit(resource.RLIMIT_FSIZE, 1024))
    assert contents() == before


def test_ctrl_c_while_tiles_are_joined_leaves_no_file_and_no_folder_that_looks_whole(terrain):
    plan(terrain)
    finish(terrain)
    before = contents()
    for output in ["whole.ply", "whole.obj", "whole.glb"]:
        said = join_interrupted(terrain, "tile_0_0001_0000", output)  # it goes over all tiles more than once
        assert re.fullmatch(rf"hmesh-terrain: (cannot write '{output}': )?interrupted(; nothing is written)?\n", said)
    assert contents() == before
    said = join_interrupted(terrain, "tile_0_0001_0000", "served")
    assert re.fullmatch(r"hmesh-terrain: interrupted; ('served' has no index yet|'served/.*' is not written)\n", said)
    assert not Path("served/index.json").exists()
    terrain.done("job join job -o served -q")
    assert tiles("served") == tiles()


def test_a_folder_of_tiles_has_an_index_and_is_copied_again_where_it_differs(terrain):
    plan(terrain)
    finish(terrain)
    assert f"{len(TILES) + 2} files copied" in terrain.done("job join job -o served")
    assert tiles("served") == tiles()
    Path("served/0/0001_0001.glb").write_bytes(b"short")
    content = read("served/0/0002_0001.glb")
    Path("served/0/0002_0001.glb").write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    assert f"2 files copied, {len(TILES)} were there" in terrain.done("job join job -o served")
    assert tiles("served") == tiles()


def test_a_tileset_holds_each_tile_in_a_box_of_a_tree(terrain):
    plan(terrain)
    finish(terrain)
    tileset = json.loads(read("job/tiles/tileset.json"))
    assert tileset["asset"]["version"] == "1.1" and tileset["root"]["refine"] == "REPLACE"
    found, inner = [], []

    def walk(node, around, error):
        box = node["boundingVolume"]["box"]
        span = [(box[k] - box[3 + 4 * k], box[k] + box[3 + 4 * k]) for k in range(3)]
        assert all(low >= a and high <= b for (low, high), (a, b) in zip(span, around)) and node["geometricError"] <= error
        for child in node.get("children", []):
            walk(child, span, node["geometricError"])
        inner.append("children" in node)
        assert len(node.get("children", [])) <= 4 and ("content" in node) == (node["geometricError"] == 0)
        if "content" in node:
            found.append(node["content"]["uri"])
            for vertex in read_model("job/tiles/" + found[-1]).vertices:  # +y up in the file, turned as viewers do
                assert all(low <= at <= high for (low, high), at in zip(span, vertex))

    walk(tileset["root"], [(-1e9, 1e9)] * 3, tileset["geometricError"])
    assert sorted(found) == [f"0/{x:04}_{y:04}.glb" for x in range(4) for y in range(3)]
    assert sum(inner) == 5  # all, and four parts of two columns and one or two rows


def test_tiles_of_cesiums_grid_have_its_names_and_a_layer(terrain):
    side = 180 / 2 ** 9
    west, north = -180 + 530 * side, -90 + 380 * side
    write("dem.pgm", dems.pgm(ground(4 * 16 + 1, 3 * 16 + 1)))
    extent = f"{west},{north - 3 * side},{west + 4 * side},{north}"
    planned = terrain.done(f"job plan dem.pgm -o job --max-error 9 --effort fast --tiles 16 --format terrain --extent {extent}")
    assert "note" not in planned + terrain.done("job plan dem.pgm -o other --max-error 9 --tiles 16")
    finish(terrain)
    layer = json.loads(read("job/tiles/layer.json"))
    assert layer["maxzoom"] == 9 and layer["tiles"] == ["{z}/{x}/{y}.terrain"] and layer["extensions"] == ["octvertexnormals"]
    assert layer["available"][:9] == [[]] * 9
    names = {f"9/{x}/{y}.terrain" for run in layer["available"][9]
             for x in range(run["startX"], run["endX"] + 1) for y in range(run["startY"], run["endY"] + 1)}
    assert names == {f"9/{x}/{y}.terrain" for x in range(530, 534) for y in (377, 378, 379)} == set(tiles()) - {"layer.json", "index.json"}
    report = json.loads(read("job/tiles/index.json"))
    assert next(t for t in report["tiles"] if t["file"] == "9/530/379.terrain")["row"] == 0
    terrain.fails("join them into a folder", "job join job -o whole.ply")
    off = "job plan dem.pgm -o off --max-error 9 --tiles 16 --format terrain --extent 7,45,8,46"
    assert "no layer.json" in terrain.done(off) and "docs/jobs.md" in terrain.done(off) and terrain.done(f"{off} -q") == ""


@pytest.mark.parametrize("across, down, left, up, wide, high", [
    (2, 2, 0, 0, 1, 1), (2.25, 2, 0, 0, 1, 1), (2, 2.25, 0, 0, 1, 1), (2, 2, 0.25, 0, 1, 1), (2, 2, 0, 0.25, 1, 1),
    (2, 2, 0, 0, 3, 3), (2, 2, 0, 0, 1, 2)])
def test_tiles_beside_cesiums_grid_or_cut_off_or_no_squares_have_no_layer(terrain, across, down, left, up, wide, high):
    side, cells = 180 / 2 ** 9, 8
    write("dem.pgm", dems.pgm(ground(round(across * cells) + 1, round(down * cells) + 1)))
    west, south = -180 + (528 + left) * side, -90 + (384 + up - high * down) * side
    extent = f"{west!r},{south!r},{west + wide * across * side!r},{south + high * down * side!r}"
    text = terrain.done(f"job plan dem.pgm -o job --max-error 9 --tiles {cells} --format terrain --extent {extent}")
    is_grid = (across, down, left, up, wide, high) == (2, 2, 0, 0, 1, 1)
    assert ("no layer.json" in text) == (not is_grid) == (json.loads(read("job/plan.json"))["globe"] is None)


def test_samples_without_data_and_tiles_of_none(terrain):
    heights = with_holes(ground(WIDTH, HEIGHT))
    heights = [[None if x > 64 and y > 32 else z for x, z in enumerate(row)] for y, row in enumerate(heights)]
    write("dem.asc", dems.asc(heights))
    plan(terrain, dem="dem.asc")
    finish(terrain)
    empty = {t["file"] for t in json.loads(read("job/tiles/index.json"))["tiles"] if t["is"] == "empty"}
    assert empty == {f"0/{x:04}_{y:04}.glb" for x, y in [(2, 1), (3, 1), (2, 2), (3, 2)]} and not empty & set(tiles())
    assert "content" in str(json.loads(read("job/tiles/tileset.json"))) and not any(name in read("job/tiles/tileset.json").decode() for name in empty)
    alone = json.loads(read("job/tiles/index.json"))["seams"]["no_data"]
    assert alone > 0
    text = terrain.done("job join job -o whole.ply")
    assert f"note       {alone} vertices of seams beside samples without data stand alone" in text
    # A tile knows nothing of corners of holes in its neighbour: only one of them has a vertex there.
    is_seam = lambda x, y: x in (32, 64) or y in (32, 64)
    assert judge(heights, read_model("whole.ply"), from_south(HEIGHT), may_be_open=is_seam) <= 9


def test_tiles_that_do_not_meet_are_not_joined_unawares(terrain):
    plan(terrain)
    plan(terrain, "--z-scale 2", folder="other")
    finish(terrain, "other")
    run(terrain, phases()[0])
    name = "tiles/0/0001_0001.glb"
    shutil.copy(f"other/{name}", f"job/{name}")
    files = [{"name": name, "bytes": len(read(f"job/{name}")), "sha256": sums()[name[6:]]}]
    forge("job/done/tile_0_0001_0001.json", files=files)
    finish(terrain)
    terrain.fails("first of tile_0_0001_0000 and tile_0_0001_0001", "job join job -o whole.ply")
    assert not Path("whole.ply").exists()
    terrain.done("job join job -o whole.ply --open-seams")
    assert len(edges(read_model("whole.ply"))) > 100


def test_tiles_that_are_shaded_otherwise_along_their_seam_do_not_meet(terrain):
    first, *_ = plan(terrain)
    run(terrain, first)
    name = "tiles/0/0001_0001.glb"
    tile = bytearray(read(f"job/{name}"))
    size = struct.unpack_from("<I", tile, 12)[0]
    head = json.loads(tile[20 : 20 + size])
    view = head["bufferViews"][head["accessors"][head["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]]["bufferView"]]
    for at in range(28 + size + view["byteOffset"], 28 + size + view["byteOffset"] + view["byteLength"], 4):
        tile[at] ^= 1  # the last bit of each number
    write(f"job/{name}", bytes(tile))
    forge("job/done/tile_0_0001_0001.json", files=[{"name": name, "bytes": len(tile), "sha256": sums()[name[6:]]}])
    finish(terrain)
    terrain.fails("first of tile_0_0001_0000 and tile_0_0001_0001", "job join job -o whole.ply")


@pytest.mark.parametrize("hole", [(31, 8), (33, 8), (8, 31), (8, 33)])
def test_a_hole_beside_a_seam_in_either_tile_is_no_fault(terrain, hole):
    heights = [[None if (x, y) == hole else z for x, z in enumerate(row)] for y, row in enumerate(ground(50, 50))]
    write("dem.asc", dems.asc(heights))
    plan(terrain, dem="dem.asc")
    finish(terrain)
    seams = json.loads(read("job/tiles/index.json"))["seams"]
    assert seams["open"] == 0 < seams["no_data"] and seams["first"] == ""
    terrain.done("job join job -o whole.ply -q")


# ---- what is done ----
def test_a_task_that_is_done_is_not_done_again_and_says_so(terrain):
    plan(terrain)
    finish(terrain)
    before = {path: (content, path.stat().st_mtime_ns) for path, content in contents().items()}
    tasks = sum(phases(), [])
    assert run(terrain, tasks) == "".join(f"{task}  done before\n" for task in tasks)
    terrain.done(f"job plan dem.pgm -o job {OPTIONS}")  # the same again
    assert all((read(path), path.stat().st_mtime_ns) == before[path] for path in before if path.parts[-1] != "dem.pgm"
               and path.parts[1] in ("done", "tiles", "plan.json"))
    assert terrain.done("job status job").count("done") == 3


def test_status_tells_what_is_done_ready_missing_and_damaged(terrain):
    first, seams, index = plan(terrain)

    def status(arguments=""):
        ran = terrain.run(f"job status job {arguments}")
        assert ran.stderr == ""
        return ran.returncode, ran.stdout

    assert status("--ready") == status("--ready -q") == (1, "".join(task + "\n" for task in first))
    run(terrain, first[:8])
    code, text = status()
    assert code == 1 and "tiles: 8 of 12 tasks done" in text and "seams: 0 of 3 tasks done" in text
    assert status("--ready") == (1, "".join(task + "\n" for task in first[8:] + seams[:1]))
    finish(terrain)
    assert status()[0] == 0 and status("--ready") == (0, "")
    whole = sums()
    Path("job/tiles/0/0002_0001.glb").write_bytes(read("job/tiles/0/0002_0001.glb")[:-1])
    broken = {name: Path(f"job/done/{name}.json") for name in first[:4]}
    for path, content in zip(broken.values(), [b"{}", b"[]", b'{"check": 7}']):
        path.write_bytes(content)
    broken[first[3]].unlink()
    broken[first[3]].mkdir()
    code, text = status()
    assert code == 1 and "tiles: 7 of 12 tasks done, 5 damaged" in text
    assert "'job/tiles/0/0002_0001.glb' is damaged: it has" in text and f"cannot read '{broken[first[3]]}'" in text
    assert all(f"'{broken[name]}' is damaged" in text for name in first[:3])
    before = {path: path.read_bytes() for path in Path("job/done").iterdir() if path.stem not in (*first[:4], "tile_0_0002_0001")}
    assert "5 taken back" in status("--mend")[1]
    # Engines do what has no receipt.
    assert before == {path: path.read_bytes() for path in Path("job/done").iterdir()}
    assert status("--ready")[1].split() == [*first[:4], "tile_0_0002_0001"]
    assert run(terrain, first).count("done before") == 7 and status()[0] == 0 and sums() == whole


def damage(how):
    tile, receipt = Path("job/tiles/0/0001_0000.glb"), Path("job/done/tile_0_0001_0000.json")
    if how == "cut":
        tile.write_bytes(tile.read_bytes()[:-4])
    elif how == "flipped":
        tile.write_bytes(tile.read_bytes()[:700] + bytes([tile.read_bytes()[700] ^ 1]) + tile.read_bytes()[701:])
    elif how == "gone":
        tile.unlink()
    elif how == "undone":
        receipt.unlink()
    elif how == "receipt cut":
        receipt.write_bytes(receipt.read_bytes()[:-9])
    elif how == "receipt changed":
        receipt.write_bytes(receipt.read_bytes().replace(b'"vertices": ', b'"vertices": 1'))
    elif how == "foreign":
        forge(receipt, plan="0" * 64)
    elif how == "renamed":
        shutil.copy("job/done/tile_0_0002_0000.json", receipt)


DAMAGES = {"cut": "'job/tiles/0/0001_0000.glb' is damaged: it has", "flipped": "'job/tiles/0/0001_0000.glb' is damaged: its bytes",
           "gone": "'job/tiles/0/0001_0000.glb' is missing", "undone": "'job/done/tile_0_0001_0000.json' is missing",
           "receipt cut": "'job/done/tile_0_0001_0000.json' is damaged",
           "receipt changed": "'job/done/tile_0_0001_0000.json' is damaged",
           "foreign": "'job/done/tile_0_0001_0000.json' is of another plan",
           "renamed": "'job/done/tile_0_0001_0000.json' is of another task"}


def test_input_that_is_missing_damaged_or_foreign_is_named_and_nothing_is_written(terrain):
    first, seams, _ = plan(terrain)
    run(terrain, first)
    whole = sums()
    for how, sentence in DAMAGES.items():
        damage(how)
        before = contents()
        terrain.fails(sentence, f"job run job {seams[0]}")
        assert contents() == before
        text = terrain.run("job status job").stdout
        assert f"11 of 12 tasks done{'' if how == 'undone' else ', 1 damaged'}\n" in text
        assert how == "undone" or ("foreign    " if how in ("foreign", "renamed") else "damaged    ") + sentence in text
        assert run(terrain, ["tile_0_0001_0000"]).count("off by at most") == 1 and sums() == whole
    run(terrain, seams)


@pytest.mark.parametrize("how, sentence", [("cut", "'job/tiles/0/0001_0000.glb' is damaged"), ("flipped", "its bytes are not those")])
def test_join_refuses_what_was_damaged_after_it_was_indexed(terrain, how, sentence):
    plan(terrain)
    finish(terrain)
    damage(how)
    for output in ["whole.ply", "served"]:
        terrain.fails(sentence, f"job join job -o {output}")
    assert not Path("whole.ply").exists() and not Path("served/index.json").exists()


def test_what_is_no_plan_of_this_program_and_input_is_refused(terrain):
    plan(terrain)
    text = read("job/plan.json")

    def fails(sentence, arguments="job run job tile_0_0000_0000"):
        before = contents()
        terrain.fails(sentence, arguments)
        assert contents() == before

    for sentence, content in [("is damaged: its checksum", text.replace(b'"9"', b'"8"')), ("is damaged", text[:-30]), ("is damaged", b"")]:
        write("job/plan.json", content)
        fails(sentence)
    for changes, sentence in [({"version": "0.0.9"}, "was made by hmesh-terrain 0.0.9, and this is"), ({"is": "a letter"}, "is no plan of"),
                              ({"compiler": "tcc"}, "was made by an hmesh-terrain of tcc"), ({"width": "wide"}, "holds what no plan"),
                              ({"options": ["--fast"]}, "has options that mean nothing: unknown option '--fast'")]:
        write("job/plan.json", text)
        forge("job/plan.json", **changes)
        fails(sentence)
    write("job/plan.json", text)
    fails("'dem' is no job", "job run dem tile_0_0000_0000")
    for name in ["tile_0_0004_0000", "tile_0_0_0", "tile_1_0000_0000", "seams", "../plan", "tile_0_0000_0000_", "index2"]:
        fails(f"'{name}' is no task of this job", f"job run job {name}")
    fails("holds another plan", f"job plan dem.pgm -o job {OPTIONS} --scale 2")
    dem, written = read("dem.pgm"), os.stat("dem.pgm")
    write("dem.pgm", dem.replace(b"120 75", b"75 120"))
    os.utime("dem.pgm", ns=(written.st_atime_ns, written.st_mtime_ns))
    fails("is not the input that was planned: it has 75 x 120 samples, and had 120 x 75")
    write("dem.pgm", dem)
    os.utime("dem.pgm", (1e9, 1e9))
    fails("has been written since")
    write("dem.pgm", read("dem.pgm") + b" ")
    fails(f"is not the input that was planned: it has {len(dem) + 1} bytes, and had {len(dem)}")
    fails("'.' is not the input that was planned: it is no plain file", "job run job tile_0_0000_0000 --input .")
    Path("dem.pgm").unlink()
    fails("dem.pgm': there is no such file")


def test_a_plan_that_goes_by_the_bytes_of_its_input_takes_a_copy_elsewhere(terrain):
    plan(terrain, "--hash")
    os.utime("dem.pgm", (1e9, 1e9))
    Path("there").mkdir()
    os.rename("dem.pgm", "there/copy.pgm")
    plan(terrain, "--hash", "there/copy.pgm", "other")
    finish(terrain, "other")
    terrain.done(f"job run job {' '.join(sum(phases(), []))} --input there/copy.pgm -q")
    assert {name for name, content in tiles().items() if content != tiles("other/tiles")[name]} == {"index.json"}
    assert json.loads(read("job/tiles/index.json"))["input"] == str(Path("dem.pgm").resolve())
    Path("job/done/tile_0_0001_0000.json").unlink()
    content = bytearray(read("there/copy.pgm"))
    content[-1] ^= 1
    write("there/copy.pgm", bytes(content))
    terrain.fails("its bytes are others", "job run job tile_0_0001_0000 --input there/copy.pgm")


def test_a_worker_that_is_interrupted_says_so_once_and_leaves_what_is_done(terrain):
    write("dem.raw", dems.raw([[(x * 7919 + y * 104729 + x * y * 31) % 997 for x in range(601)] for y in range(601)]))
    terrain.done("job plan dem.raw --size 601x601 -o job --max-error 300 --effort best --tiles 300 -q")
    words = terrain.words(["job", "run", "job", *phases()[0]])
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8") as job:
        send_once_caught(job, signal.SIGINT, 0.3)
        out, err = job.communicate(timeout=60)
    if job.returncode == 0:
        pytest.skip("this machine was done before it was interrupted")
    is_failure(subprocess.CompletedProcess(job.args, job.returncode, out, err), "interrupted")
    assert len(receipts()) == len(tiles()) if Path("job/tiles").exists() else not receipts()
    assert "damaged" not in terrain.run("job status job").stdout


def test_workers_on_one_task_at_once_do_no_harm(terrain):
    first, _, _ = plan(terrain)
    run(terrain, first)
    whole = sums()
    shutil.rmtree("job/done")
    shutil.rmtree("job/tiles")
    workers = [subprocess.Popen(terrain.words(f"job run job {first[k % 2]} {first[0]} -q"), stderr=subprocess.PIPE) for k in range(6)]
    assert [(worker.communicate(timeout=60)[1], worker.returncode) for worker in workers] == [(b"", 0)] * 6
    assert sums() == {name: whole[name] for name in ["0/0000_0000.glb", "0/0001_0000.glb"]} and set(receipts()) == set(first[:2])
    assert not list(Path().rglob("*.hmesh-part*"))


def test_plans_at_once_leave_one_of_them_and_the_others_say_so(terrain):
    write("dem.pgm", dems.pgm(ground(WIDTH, HEIGHT)))
    for number in range(8):
        plans = [subprocess.Popen(terrain.words(f"job plan dem.pgm -o job{number} --max-error {k % 2 + 8} --tiles {CELLS} -q"),
                                  stderr=subprocess.PIPE) for k in range(6)]
        said = [(planned.communicate(timeout=60)[1], planned.returncode) for planned in plans]
        options = json.loads(read(f"job{number}/plan.json"))["options"]
        kept = int(options[options.index("--max-error") + 1]) - 8
        assert all(status == (0 if k % 2 == kept else 1) for k, (_, status) in enumerate(said))
        assert all(b"holds another plan" in why for why, status in said if status)
        assert not list(Path(f"job{number}").glob("*.hmesh-part*"))


def test_a_plan_that_was_killed_while_it_was_written_can_be_made_again(terrain):
    Path("job").mkdir()
    write("job/plan.json.hmesh-part0", b"{" * 9999)  # longer than what takes its place
    plan(terrain)
    assert not Path("job/plan.json.hmesh-part0").exists()


def test_a_plan_whose_files_for_engines_cannot_be_written_fails(terrain):
    plan(terrain)
    for name in ["phase_2.txt", "parallel.sh", "slurm_task.sh", "slurm.sh", "build.ninja"]:
        Path("job", name).unlink()
        Path("job", name).mkdir()
        terrain.fails(f"cannot write 'job/{name}': Is a directory", f"job plan dem.pgm -o job {OPTIONS}")
        Path("job", name).rmdir()
    Path("job/plan.json").unlink()
    Path("job/plan.json").mkdir()
    for arguments in [f"job plan dem.pgm -o job {OPTIONS}", "job status job"]:
        terrain.fails("cannot read 'job/plan.json': Is a directory", arguments)


def test_a_folder_with_any_file_but_parts_of_a_plan_is_none_for_a_plan(terrain):
    write("dem.pgm", dems.pgm(ground(WIDTH, HEIGHT)))
    for k in range(6):  # whichever of them the system lists last
        Path("full").mkdir()
        for n in range(6):
            write(f"full/{n}" + ("" if n == k else ".hmesh-part0"), b"")
        ran = terrain.run(f"job plan dem.pgm -o full {OPTIONS}")
        assert ran.returncode == 1 and "'full' is not empty, and no job" in ran.stderr and len(contents()) == 7
        shutil.rmtree("full")


def test_columns_and_rows_of_more_than_four_digits_are_names_that_sort(terrain):
    write("wide.pgm", dems.pgm([[0] * 10002] * 2))
    terrain.done("job plan wide.pgm -o job --max-error 9 --tiles 1 -q")
    first, seams, _ = phases()
    assert first == [f"tile_0_{x:05}_00000" for x in range(10001)] and seams == ["seams_0_00000"]
    run(terrain, first[-1:])
    assert list(tiles()) == ["0/10000_00000.glb"]
    terrain.fails("'tile_0_1000_0000' is no task of this job", "job run job tile_0_1000_0000")


def test_join_leaves_the_files_of_the_job_alone(terrain):
    plan(terrain)
    finish(terrain)
    before = contents()
    for output in ["job", "job/done", "job/x.ply"]:
        terrain.fails("is within the job", f"job join job -o {output}")
    Path("out.ply").symlink_to("job/done/x.ply")
    terrain.fails("is within the job", "job join job -o out.ply")
    Path("out.ply").unlink()
    Path("out.ply").symlink_to("dem.pgm")
    terrain.fails("'out.ply' would overwrite the input of the job", "job join job -o out.ply")
    Path("out.ply").unlink()
    assert terrain.run("job join job -o -").returncode == 2 and contents() == before
    for output in ["x.tif", "x.hmc", "x.stl", "out/.ply"]:
        terrain.fails("is none of .ply, .obj, .glb and a folder", f"job join job -o {output}")
    assert contents() == before
    plan(terrain, folder="other")
    terrain.fails("is within another job, '", "job join job -o other/tiles")
    Path("site").mkdir()
    write("site/plan.json", b"{}")  # of another program
    terrain.done("job join job -o site/whole.ply -q")


def test_names_that_no_plan_can_hold_are_refused(terrain):
    name = os.fsdecode(b"b\xff.pgm")
    write(name, dems.pgm(ground(WIDTH, HEIGHT)))
    terrain.fails("is no name in UTF-8", ["job", "plan", name, "-o", "job", "--max-error", "9"])
    assert not Path("job").exists()


def test_a_full_disk_loses_no_finished_task(terrain):
    first, _, _ = plan(terrain)
    run(terrain, first[:3])
    before = contents()
    terrain.fails("cannot write 'job/tiles/0/0003_0000.glb'", f"job run job {first[3]} -q", **limit(resource.RLIMIT_FSIZE, 1024))
    assert contents() == before
    finish(terrain)
    terrain.done("job status job -q")


def test_nothing_outside_of_the_job_is_written_not_by_a_link_either(terrain):
    first, _, _ = plan(terrain)
    Path("outside").mkdir()
    write("outside/0000_0000.glb", b"old")
    Path("job/tiles").mkdir()
    Path("job/tiles/0").symlink_to("../../outside")
    terrain.fails("'job/tiles/0' is a link", f"job run job {first[0]}")
    Path("job/tiles/0").unlink()
    Path("job/tiles/0").mkdir()
    Path("job/tiles/0/0000_0000.glb").symlink_to("../../../outside/0000_0000.glb")
    terrain.fails("is a link", f"job run job {first[0]}")
    Path("job/tiles/0/0000_0000.glb").unlink()
    finish(terrain)
    assert {path.parts[0] for path in contents()} == {"job", "dem.pgm", "outside"} and read("outside/0000_0000.glb") == b"old"
    Path("full").mkdir()
    write("full/file", b"")
    terrain.fails("is not empty, and no job", f"job plan dem.pgm -o full {OPTIONS}")


# ---- engines ----
def engine(terrain, name):
    if not shutil.which(name):
        pytest.skip(f"{name} is not installed")
    if name == "parallel" and "GNU" not in subprocess.run([name, "--version"], capture_output=True, text=True, check=False).stdout:
        pytest.skip("parallel is not GNU's")
    return {"ninja": ["ninja", "-C", "job", "-j", "2"], "parallel": ["sh", "job/parallel.sh", "--jobs", "2"]}[name]


@pytest.mark.parametrize("name", ["ninja", "parallel"])
def test_engines_do_all_tasks_and_do_again_what_was_killed_or_damaged_and_nothing_else(terrain, name):
    words = engine(terrain, name)
    write("dem.pgm", dems.pgm(ground(WIDTH, HEIGHT)))
    copy = Path("a folder's \"$name\" {} {.} {#} {= x =}")  # engines must call it nevertheless
    copy.mkdir()
    (copy / "hmesh-terrain").symlink_to(terrain.path)
    terrain.done(f"job plan dem.pgm -o one {OPTIONS} -q")
    finish(terrain, "one")
    subprocess.run([str(copy / "hmesh-terrain"), *terrain.words(f"job plan dem.pgm -o job {OPTIONS} -q")[1:]], check=True)

    def run_engine():
        return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)

    for pause in [0.03, 0.08]:
        started = run_engine()
        time.sleep(pause)
        kill_session(started)
    Path("job/tiles/0").mkdir(parents=True, exist_ok=True)
    for path in list(Path("job/tiles").rglob("*.glb"))[::3]:
        path.write_bytes(path.read_bytes()[:50])
    terrain.run("job status job --mend -q")
    before = receipts()
    assert run_engine().wait(timeout=120) == 0
    assert sums() == sums("one/tiles") and not [task for task, receipt in before.items() if receipts()[task] != receipt]
    before = {path: path.stat().st_mtime_ns for path in Path("job").rglob("*") if path.parts[1] in ("done", "tiles")}
    assert run_engine().wait(timeout=120) == 0
    assert before == {path: path.stat().st_mtime_ns for path in before}


def test_a_task_that_fails_stops_what_waits_for_it(terrain):
    words = engine(terrain, "ninja")
    plan(terrain)
    os.utime("dem.pgm", (1e9, 1e9))
    ran = subprocess.run(words, capture_output=True, encoding="utf-8")
    assert ran.returncode == 1 and "has been written since" in ran.stdout and not receipts()


def test_slurms_script_submits_a_phase_after_the_other(terrain):
    plan(terrain)
    Path("bin").mkdir()  # in place of Slurm: takes what is submitted, and runs it
    Path("bin/sbatch").write_text("""#!/bin/sh
echo "$*" >> ../submitted
for word in "$@"; do case $word in --array=0-*) last=${word#--array=0-};; esac; done
while case $1 in --*) true;; *) false;; esac; do shift; done
for element in $(seq 0 "$last"); do SLURM_ARRAY_TASK_ID=$element sh "$@" >&2 || exit 1; done
wc -l < ../submitted
""")
    Path("bin/sbatch").chmod(0o755)
    path = f"{Path('bin').resolve()}:{os.environ['PATH']}"
    ran = subprocess.run(["job/slurm.sh", "--partition=short"], env={**os.environ, "PATH": path}, capture_output=True, encoding="utf-8")
    assert (ran.returncode, ran.stdout.strip()) == (0, "3"), ran.stderr
    assert Path("submitted").read_text().splitlines() == [
        "--parsable --array=0-11 --partition=short slurm_task.sh phase_1.txt 1",
        "--parsable --dependency=afterok:1 --kill-on-invalid-dep=yes --array=0-2 --partition=short slurm_task.sh phase_2.txt 1",
        "--parsable --dependency=afterok:2 --kill-on-invalid-dep=yes --array=0-0 --partition=short slurm_task.sh phase_3.txt 1"]
    terrain.done("job status job -q")
    for width, height, elements in [(61, 51, 1000), (62, 42, 834)]:  # 3000 and 2501 tiles: an element is some of them
        write(f"{width}.pgm", dems.pgm([[0] * width] * height))
        terrain.done(f"job plan {width}.pgm -o job{width} --max-error 1 --tiles 1 -q")
        assert f"submit {elements} phase_1.txt 3 " in Path(f"job{width}/slurm.sh").read_text()


# ---- the command line ----
WRONG = rows("""
    job is given without plan, run, status or join  | job
    job 'do' is not one of: plan, run, status, join | job do
    no input file is given                          | job plan -o x --max-error 1
    no folder is given                              | job plan dem.pgm --max-error 1
    how fine is not said                            | job plan dem.pgm -o x
    --free-borders is given for a job               | job plan dem.pgm -o x --max-error 1 --free-borders
    --base is given for a job                       | job plan dem.pgm -o x --max-error 1 --base 0
    --skirts is given without --levels              | job plan dem.pgm -o x --max-error 1 --skirts
    --extent is given without --format terrain      | job plan dem.pgm -o x --max-error 1 --extent 1,2,3,4
    --heights is given without --format terrain     | job plan dem.pgm -o x --max-error 1 --heights 1,2
    Cesium hangs skirts itself                      | job plan dem.pgm -o x --max-error 1 --skirts --levels 2 --format terrain
    --levels '0' must be                            | job plan dem.pgm -o x --max-error 1 --levels 0
    meet with --border-tolerance alone              | job plan dem.pgm -o x --vertices 9
    --format 'ply' is not one of: glb, terrain      | job plan dem.pgm -o x --max-error 1 --format ply
    two inputs                                      | job plan dem.pgm dem.pgm -o x --max-error 1
    unknown option '--only'                         | job plan dem.pgm -o x --max-error 1 --only
    no folder or no task is given                   | job run x
    no folder is given                              | job status
    no output is given                              | job join x
    """)


@pytest.mark.parametrize("sentence, arguments", WRONG)
def test_wrong_usage_is_told_in_one_sentence_with_exit_status_2(terrain, sentence, arguments):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    before = contents()
    ran = terrain.run(arguments)
    assert ran.returncode == 2 and ran.stderr.startswith("hmesh-terrain: ") and sentence in ran.stderr.splitlines()[0]
    assert ran.stdout == "" and contents() == before


FAILURES = rows("""
    'missing.pgm'                    | job plan missing.pgm -o x --max-error 1
    a run has not finished writing    | job plan a.pgm.hmesh-part0 -o x --max-error 1
    does not say its degrees         | job plan dem.pgm -o x --max-error 1 --format terrain
    'dem.pgm' is no folder           | job plan dem.pgm -o dem.pgm --max-error 1
    is no plain file                 | job plan . -o x --max-error 1 --hash
    'x' is no job                    | job status x
    is no job                        | job join x -o whole.ply
    """)


@pytest.mark.parametrize("sentence, arguments", FAILURES)
def test_a_failure_is_told_in_one_sentence_and_writes_nothing(terrain, sentence, arguments):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    before = contents()
    terrain.fails(sentence, arguments)
    assert contents() == before


def test_help_of_each_part(terrain):
    assert all(f"hmesh-terrain job {part}" in terrain.done("job --help") for part in ["plan", "run", "status", "join"])
    for part, option in [("plan", "--hash"), ("run", "--input"), ("status", "--mend"), ("join", "--open-seams")]:
        text = terrain.done(f"job {part} --help")
        assert option in text and max(map(len, text.splitlines())) <= 132
    plan = terrain.done("job plan --help")
    assert "--no-normals " in plan and "--free-borders " not in plan and "--base " not in plan  # which it refuses
    assert "hmesh-terrain job --help" in terrain.done("--help")
