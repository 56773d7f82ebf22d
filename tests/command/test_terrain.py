"""hmesh-terrain: heights of all kinds become models within a bound."""
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import zlib
from pathlib import Path

import pytest

import dems
from conftest import as_others, contents, is_failure, limit, read, rows, send_once_caught
from dems import ground, judge, read_model, with_holes
from jobs import finish, forge, phases

FORMATS = ["glb", "ply", "obj", "stl", "terrain"]
EFFORTS = ["draft", "fast", "normal", "best"]
WIDTH, HEIGHT = 48, 37


def write(name, content):
    Path(name).write_bytes(content)
    return name


def has_gdal(terrain):
    return "GDAL" in terrain.done("--version")


def needs_gdal(terrain):
    if not has_gdal(terrain):
        pytest.skip("this hmesh-terrain has no GDAL")
    terrain.takes_gdal = True


def readers(terrain):
    """What files are read by: "" by GDAL where it is there."""
    terrain.takes_gdal = True
    return ["", "--no-gdal"] if has_gdal(terrain) else [""]


def report_of(terrain, arguments):
    terrain.done(arguments + " -q --report report.json")
    return json.loads(Path("report.json").read_text(encoding="utf-8"))


def from_south(height, step=1):
    """For judge(): of local metres, which begin at the south-western sample."""
    return lambda x, y, z: (x / step, height - 1 - y / step, z)


def in_tile(width, height):
    return lambda x, y, z: (x * (width - 1), (1 - y) * (height - 1), z)


def placed(name, width=WIDTH, height=HEIGHT):
    return in_tile(width, height) if name.endswith(".terrain") else from_south(height)


EXTENT = "--extent 7,45,7.5,45.4"


def extent_for(kind):
    return EXTENT if kind == "terrain" else ""


# ---- the bound ----
@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("effort", EFFORTS)
def test_no_triangle_is_further_from_a_sample_than_the_bound_in_any_format(terrain, kind, effort):
    heights = ground(WIDTH, HEIGHT)
    write("dem.pgm", dems.pgm(heights))
    report = report_of(terrain, f"dem.pgm -o model.{kind} --max-error 12.5 --effort {effort} {extent_for(kind)}")
    model = read_model(f"model.{kind}")
    slack = 1e-6 if kind != "terrain" else 2e-3
    error = judge(heights, model, placed(f"model.{kind}"), slack)
    assert error <= 12.5
    assert report["max_error"] == pytest.approx(error, abs=1e-4) and report["max_error"] <= 12.5
    assert report["triangles"] == len(model.faces) < 1.2 * WIDTH * HEIGHT
    assert report["vertices"] == len(set(model.vertices)) if kind == "stl" else len(model.vertices)


@pytest.mark.parametrize("bound", ["0", "0.001", "1", "40", "100000"])
def test_every_bound_is_kept_from_none_to_all(terrain, bound):
    heights = ground(23, 19)
    write("dem.asc", dems.asc(heights))
    for kind in ["ply", "glb"]:
        terrain.done(f"dem.asc -o model.{kind} --max-error {bound}")
        assert judge(heights, read_model(f"model.{kind}"), from_south(19)) <= float(bound) + 1e-12  # of the judge
    if bound == "0":
        write("dem.raw", dems.raw([[math.sin(z) * 1e-3 for z in row] for row in heights]))
        assert report_of(terrain, "dem.raw --size 23x19 -o model.ply --max-error 0")["max_error"] == 0
    assert bound != "100000" or len(read_model("model.ply").faces) <= 4


def test_where_rounding_takes_more_than_its_share_the_mesh_is_made_anew_within_a_tighter_bound(terrain):
    heights = [[(x * 7919 + y * 104729 + x * y * 31) % 997 for x in range(60)] for y in range(60)]  # as steep as can be
    write("dem.raw", dems.raw(heights))
    arguments = f"dem.raw --size 60x60 -o tile.terrain {EXTENT}"
    report = report_of(terrain, f"{arguments} --max-error 8")
    assert not report["tiles"][0]["is_tighter"] and report["max_error"] <= 8  # the border is what it would have been
    error = judge(heights, read_model("tile.terrain"), in_tile(60, 60), 2e-3)
    assert report["max_error"] == pytest.approx(error, abs=1e-4)
    report = report_of(terrain, f"{arguments} --max-error 50 --effort best")
    assert not report["tiles"][0]["is_tighter"] and report["max_error"] <= 50
    for effort in EFFORTS:
        report = report_of(terrain, f"{arguments} --max-error 2 --effort {effort}")
        assert not report["tiles"][0]["is_tighter"] and report["max_error"] <= 2
    # Below what any mesh keeps the smallest bound is named, and kept by each effort.
    write("dem.raw", dems.raw([row[:20] for row in heights[:20]]))
    for name, options, bounds in [("tile.terrain", EXTENT, ["0.1", "0.003", "0"]), ("x.ply", "--scale 1e-7 --offset 30000000", ["0.5", "0"])]:
        about = "about " if name == "tile.terrain" else ""
        for bound in bounds:
            said = terrain.run(f"dem.raw --size 20x20 -o {name} {options} --max-error {bound}")
            is_failure(said, f"'{name}' cannot keep --max-error {bound}: its numbers, as it rounds them, are off by ")
            smallest = re.search(rf", and the smallest that it keeps is {about}([\d.]+)$", said.stderr)[1]
            assert float(smallest) > float(bound)
            for effort in EFFORTS:
                report = report_of(terrain, f"dem.raw --size 20x20 -o {name} {options} --max-error {smallest} --effort {effort}")
                assert report["max_error"] <= float(smallest)


def test_far_from_the_origin_best_takes_no_more_triangles_than_normal(terrain):
    chance = random.Random(1)
    row = lambda y: [100 * round(chance.random()) if chance.random() < 0.3 else 30 * math.sin(x / 5) * math.cos(y / 3) for x in range(64)]
    write("dem.raw", b"".join(2048 * dems.raw([row(y)]) for y in range(17)))
    arguments = "dem.raw --size 131072x17 -o t.ply --max-error 8 --tiles 64 --spacing 0.7"
    for only in ["1_0", "2000_0"]:
        normal, best = (report_of(terrain, f"{arguments} --only {only} --effort {effort}") for effort in ["normal", "best"])
        assert best["max_error"] <= 8 and best["triangles"] <= normal["triangles"]


def test_tiles_of_15_bits_keep_one_range_of_heights_and_one_border_with_all_efforts(terrain):
    write("dem.raw", dems.raw([[(x * 7919 + y * 104729 + x * y * 31) % 97 for x in range(61)] for y in range(41)]))
    for effort in EFFORTS:
        report = report_of(terrain, f"dem.raw --size 61x41 -o t.terrain {EXTENT} --max-error 3 --tiles 20 --effort {effort}")
        assert report["max_error"] <= 3 and len(report["tiles"]) == 6
        assert not any(tile["is_tighter"] for tile in report["tiles"])
        tiles = {(x, y): read_model(f"t_{x}_{y}.terrain") for x in range(3) for y in range(2)}
        side = lambda model, axis, at: sorted(p[1 - axis:2 - axis] + p[2:] for p in model.vertices if p[axis] == at)
        assert all(side(tiles[x, y], 0, 1) == side(tiles[x + 1, y], 0, 0) for x in range(2) for y in range(2))
        assert all(side(tiles[x, 0], 1, 0) == side(tiles[x, 1], 1, 1) for x in range(3))


def test_a_tile_so_far_away_that_floats_leave_some_of_its_samples_out_is_not_written(terrain):
    with open("dem.raw", "wb") as file:
        file.truncate(2 * 2 * 2000000)
    arguments = "dem.raw --size 2000000x2 --type int16 --spacing 0.3371 --tiles 41 --only 40001_0 --max-error 20"
    for kind in ["glb", "ply", "stl"]:
        sentence = f"'t_40001_0.{kind}' leaves 2 samples out and covers 0 without data; it is not written\n"
        terrain.fails(sentence, f"{arguments} -o t.{kind}")
    assert not list(Path().glob("t_*"))
    terrain.done(f"{arguments} -o t.obj -q")  # its numbers have as many digits as they need


def test_a_folder_that_is_not_there_is_said_to_be_missing(terrain):
    write("dem.pgm", dems.pgm(ground(9, 8)))
    terrain.fails("cannot write 'nowhere/model.ply': No such file or directory", "dem.pgm -o nowhere/model.ply --max-error 2")


def test_a_better_effort_takes_fewer_triangles(terrain):
    write("dem.pgm", dems.pgm(ground(90, 80)))
    counts = [report_of(terrain, f"dem.pgm -o model.ply --max-error 20 --effort {effort}")["triangles"] for effort in EFFORTS]
    assert counts == sorted(counts, reverse=True) and counts[-1] < 0.7 * counts[0]


@pytest.mark.parametrize("shape", [(2, 2), (2, 9), (9, 2), (3, 3), (64, 2)])
def test_small_models_are_models(terrain, shape):
    heights = ground(*shape)
    write("dem.asc", dems.asc(heights))
    terrain.done("dem.asc -o model.ply --max-error 1")
    assert judge(heights, read_model("model.ply"), from_south(shape[1])) <= 1


@pytest.mark.parametrize("height", [0, -7.25, 8848.86, 1e-3, 1e6])
def test_a_plain_is_two_triangles(terrain, height):
    write("dem.raw", dems.raw([[height] * 20] * 15))
    assert report_of(terrain, "dem.raw --size 20x15 -o model.ply --max-error 0.5")["triangles"] == 2
    assert {v[2] for v in read_model("model.ply").vertices} == {struct.unpack("f", struct.pack("f", height))[0]}


# ---- no data ----
@pytest.mark.parametrize("kind", FORMATS)
def test_samples_without_data_become_holes(terrain, kind):
    heights = with_holes(ground(WIDTH, HEIGHT))
    write("dem.asc", dems.asc(heights))
    report = report_of(terrain, f"dem.asc -o model.{kind} --max-error 10 {extent_for(kind)}")
    slack = 1e-6 if kind != "terrain" else 2e-3
    assert judge(heights, read_model(f"model.{kind}"), placed(f"model.{kind}"), slack) <= 10
    none = sum(z is None for row in heights for z in row)
    assert report["no_data"] == {"value": -9999, "samples": none, "share": pytest.approx(none / (WIDTH * HEIGHT))}


def test_no_data_is_said_by_the_file_by_nan_or_by_the_option(terrain):
    heights = with_holes(ground(WIDTH, HEIGHT))
    write("dem.asc", dems.asc(heights))
    write("nan.raw", dems.raw(heights))
    write("zero.pgm", dems.pgm(heights, none=0))
    write("other.asc", dems.asc(heights, none=-1).replace(b"NODATA_value -1", b"NODATA_value 77"))
    made = []
    for reader in readers(terrain):
        for arguments in ["dem.asc", f"nan.raw --size {WIDTH}x{HEIGHT}", "zero.pgm --no-data 0", "other.asc --no-data -1"]:
            terrain.done(f"{arguments} -o model.ply --max-error 10 {reader}")
            made.append(read("model.ply"))
    assert len(set(made)) == 1


def test_a_model_without_data_is_a_failure_and_nothing_is_written(terrain):
    write("dem.asc", dems.asc([[None] * 5] * 4))
    terrain.fails("has no data", "dem.asc -o model.ply --max-error 1")
    write("dem.asc", dems.asc([[1, None, 1, None]] * 3))
    terrain.fails("has no data in any four samples", "dem.asc -o model.ply --max-error 1")
    assert not Path("model.ply").exists()


# ---- what is read ----
def test_every_reader_reads_the_same_heights(terrain):
    heights = ground(WIDTH, HEIGHT)
    files = {"dem.pgm": dems.pgm(heights), "low.pgm": dems.pgm(heights, 1000), "dem.png": dems.png(heights),
             "dem.asc": dems.asc(heights), "dem.raw": dems.raw(heights), "short.raw": dems.raw(heights, "h"),
             "dem.r16": dems.raw(heights, "H")}
    options = {"dem.raw": "--size 48x37", "short.raw": "--size 48x37", "dem.r16": "--size 48x37 --type uint16"}
    made = {}
    for reader in readers(terrain):
        for name, content in files.items():
            write(name, content)
            terrain.done(f"{name} {options.get(name, '')} {reader} -o model.ply --max-error 9")
            made[name + reader] = read("model.ply")
    assert len(set(made.values())) == 1, [name for name in made if made[name] != made["dem.pgm"]]


def test_a_pgm_of_8_bits_is_read_as_it_is(terrain):
    heights = [[z % 90 for z in row] for row in ground(20, 16)]
    write("dem.pgm", dems.pgm(heights, 100))
    for reader in readers(terrain):
        terrain.done(f"dem.pgm -o model.ply --max-error 3 {reader}")
        assert judge(heights, read_model("model.ply"), from_south(16)) <= 3
    write("dem.pgm", b"P5\n#" + b"x" * 65536 + b"\n20 16\n100\n" + bytes(320))
    terrain.fails("its header does not end within 65536 bytes", "dem.pgm -o model.ply --max-error 3 --no-gdal")


@pytest.mark.parametrize("center", [False, True])
def test_an_asc_says_where_it_is(terrain, center):
    write("dem.asc", dems.asc(ground(12, 9), (500000, 5000000), 30, center=center))
    half = 0 if center else 15
    for reader in readers(terrain):
        report = report_of(terrain, f"dem.asc -o model.ply --max-error 5 {reader}")
        assert report["geotransform"] == [500000 + half, 30, 0, 5000000 + half + 8 * 30, 0, -30]
        assert report["coordinates"]["origin"] == [500000 + half, 5000000 + half]
        vertices = read_model("model.ply").vertices
        assert (min(v[0] for v in vertices), max(v[0] for v in vertices), max(v[1] for v in vertices)) == (0, 330, 240)


CORNERS = [("xllcenter 100 yllcorner 200", 100, 205), ("xllcorner 100 yllcenter 200", 105, 200)]


@pytest.mark.parametrize("corner, x, y", CORNERS)
def test_an_asc_may_say_a_centre_one_way_and_a_corner_the_other(terrain, corner, x, y):
    Path("dem.asc").write_text(f"ncols 2 nrows 3 {corner} cellsize 10 1 2 3 4 5 6")
    assert report_of(terrain, "dem.asc --no-gdal -o x.ply --max-error 0")["coordinates"]["origin"] == [x, y]


def test_cells_of_an_asc_without_a_corner_have_their_size(terrain):
    Path("dem.asc").write_text("ncols 2\nnrows 3\ncellsize 10\n1 2\n3 4\n5 6\n")
    for reader in readers(terrain):
        terrain.done(f"dem.asc {reader} -o x.ply --max-error 0")
        assert max(v[1] for v in read_model("x.ply").vertices) == 20


@pytest.mark.parametrize("heights", ["1 2 3 4 5 6", "1.5 2 3 4 5 6", "1 2 3 4 5 nan"])
def test_a_height_is_not_no_data_because_nan_is(terrain, heights):
    Path("dem.asc").write_text("ncols 2\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value nan\n" + heights + "\n")
    for reader in readers(terrain):
        report = report_of(terrain, f"dem.asc {reader} -o x.ply --max-error 0")
        assert report["no_data"]["samples"] == heights.count("nan")


def test_heights_of_an_asc_are_held_to_the_bound_as_its_text_has_them(terrain):
    write("dem.asc", dems.asc([[20000000.3, 20000000.3], [20000000.3, 5000000000]]))
    for reader in readers(terrain):
        report = report_of(terrain, f"dem.asc {reader} -o x.ply --max-error 1")
        assert report["max_error"] == pytest.approx(0.3) and max(v[2] for v in read_model("x.ply").vertices) == 5e9
        terrain.fails("cannot keep --max-error 0:", f"dem.asc {reader} -o x.ply --max-error 0")


DEGREES = 'GEOGCS["E",DATUM["D",SPHEROID["S",{},{}]],PRIMEM["G",0],UNIT["u",{}]]'.format
PRJS = {"feet": 'PROJCS["P",' + DEGREES(6378137, 298.257222101, 0.0174532925199433) + ',PROJECTION["Transverse_Mercator"],'
                'PARAMETER["latitude_of_origin",40],PARAMETER["central_meridian",9],PARAMETER["scale_factor",1],'
                'PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["US survey foot",0.304800609601219]]',
        "ellipsoid": DEGREES(6300000, 280, 0.0174532925199433), "gons": DEGREES(6378137, 298.257222101, 0.0157079632679489),
        "compound": 'COMPD_CS["c",' + DEGREES(6378137, 298.257223563, 0.0174532925199433) +
                    ',VERT_CS["v",VERT_DATUM["d",2005],UNIT["metre",1]]]',
        "feet of axes": 'PROJCRS["P",BASEGEOGCRS["E",DATUM["D",ELLIPSOID["S",6378137,298.257222101,LENGTHUNIT["metre",1]]],'
                        'PRIMEM["G",0,ANGLEUNIT["degree",0.0174532925199433]]],CONVERSION["C",METHOD["Transverse Mercator",ID["EPSG",9807]],'
                        + "".join(f'PARAMETER["{name}",{value},{unit}],' for name, value, unit in [
                            ("Latitude of natural origin", 40, 'ANGLEUNIT["degree",0.0174532925199433]'),
                            ("Longitude of natural origin", 9, 'ANGLEUNIT["degree",0.0174532925199433]'),
                            ("Scale factor at natural origin", 1, 'SCALEUNIT["unity",1]'),
                            ("False easting", 0, 'LENGTHUNIT["metre",1]')])
                        + 'PARAMETER["False northing",0,LENGTHUNIT["metre",1]]],CS[Cartesian,2],'
                        'AXIS["(E)",east,ORDER[1],LENGTHUNIT["US survey foot",0.304800609601219]],'
                        'AXIS["(N)",north,ORDER[2],LENGTHUNIT["US survey foot",0.304800609601219]]]',
        "gons of axes": 'GEODCRS["E",DATUM["D",ELLIPSOID["S",6378137,298.257222101,LENGTHUNIT["metre",1]]],PRIMEM["G",0],CS[ellipsoidal,3],'
                        'AXIS["(lat)",north,ORDER[1],ANGLEUNIT["grad",0.0157079632679489]],'
                        'AXIS["(lon)",east,ORDER[2],ANGLEUNIT["grad",0.0157079632679489]],'
                        'AXIS["(h)",up,ORDER[3],LENGTHUNIT["foot",0.3048]]]'}
METRES = {"feet of axes": (1200 / 3937, 1200 / 3937), "gons of axes": (84722.434, 111044.950), "feet": (1200 / 3937, 1200 / 3937), "ellipsoid": (77835.214, 109758.986), "gons": (84722.434, 111044.950),
          "compound": (78791.955, 111132.559)}


@pytest.mark.parametrize("name", PRJS)
def test_metres_of_an_asc_are_by_its_prj(terrain, name):
    write("dem.asc", dems.asc(ground(9, 9), (10, 45), 0.01, center=True))
    Path("dem.prj").write_text(PRJS[name])
    for reader in readers(terrain):
        metres = report_of(terrain, f"dem.asc {reader} -o x.ply --max-error 9")["coordinates"]["metres_of_unit"]
        assert metres == pytest.approx(METRES[name], rel=1e-7), reader


def test_a_prj_of_arcinfo_is_not_taken_for_metres(terrain):
    write("dem.asc", dems.asc(ground(9, 9), (10, 45), 0.01))
    Path("dem.prj").write_text("Projection    GEOGRAPHIC\nDatum WGS84\nUnits DD\nParameters\n")
    terrain.fails("'dem.prj' is one of ArcInfo", "dem.asc --no-gdal -o x.ply --max-error 9")


def png_of(depth, rows, chunks=b"", kind=0):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", 4, 2, depth, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunks + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


EXIF = b"II*\0\x08\0\0\0\1\0" + struct.pack("<HHIHH", 0x112, 3, 1, 6, 0) + bytes(4)  # turned by a quarter
TURN = struct.pack(">I", len(EXIF)) + b"eXIf" + EXIF + struct.pack(">I", zlib.crc32(b"eXIf" + EXIF))
PNGS = {"4 bits": (png_of(4, b"\0\x12\x34\0\x56\x7f"), [[1, 2, 3, 4], [5, 6, 7, 15]]),
        "1 bit": (png_of(1, b"\0\x50\0\xb0"), [[0, 1, 0, 1], [1, 0, 1, 1]]),
        "turned": (png_of(8, b"\0\1\2\3\4\0\5\6\7\x09", TURN), [[1, 2, 3, 4], [5, 6, 7, 9]])}


@pytest.mark.parametrize("name", PNGS)
def test_heights_of_a_png_are_as_they_are_stored(terrain, name):
    content, heights = PNGS[name]
    write("dem.png", content)
    for reader in readers(terrain):
        terrain.done(f"dem.png {reader} -o x.ply --max-error 0")
        assert judge(heights, read_model("x.ply"), from_south(2)) < 1e-9


def test_numbers_of_a_palette_are_no_heights(terrain):
    colors = bytes([10] * 3 + [90] * 3 + [200] * 3)
    palette = struct.pack(">I", len(colors)) + b"PLTE" + colors + struct.pack(">I", zlib.crc32(b"PLTE" + colors))
    write("dem.png", png_of(8, b"\0\1\2\1\2\0\0\1\2\1", palette, kind=3))
    for reader in readers(terrain):
        terrain.fails("its samples are numbers of a palette, and no heights", f"dem.png {reader} -o x.ply --max-error 1")


def metres_of_degrees(latitude):
    """By quadrature of the ellipse itself: a small arc of the meridian, and of the parallel."""
    a, b = 6378137.0, 6378137.0 * (1 - 1 / 298.257223563)

    def at(phi):  # geodetic latitude to the meridian's plane
        n = a * a / math.hypot(a * math.cos(phi), b * math.sin(phi))
        return n * math.cos(phi), b * b / (a * a) * n * math.sin(phi)

    phi, d = math.radians(latitude), 1e-4
    (r0, z0), (r1, z1) = at(phi - d), at(phi + d)
    return at(phi)[0] * math.pi / 180, math.hypot(r1 - r0, z1 - z0) / (2 * d) * math.pi / 180


def test_an_hgt_lies_between_degrees_and_its_metres_are_those_of_its_middle(terrain):
    side = 61
    heights = ground(side, side)
    heights[3][4] = heights[40][50] = None
    write("S09W071.hgt", dems.hgt(heights))
    report = report_of(terrain, "S09W071.hgt --no-gdal -o model.ply --max-error 10")
    assert report["geotransform"] == [pytest.approx(x) for x in [-71, 1 / 60, 0, -8, 0, -1 / 60]]
    assert "4326" in report["crs"] and report["no_data"]["samples"] == 2
    across, along = metres_of_degrees(-8.5)
    assert report["coordinates"]["metres_of_unit"] == [pytest.approx(across, rel=1e-7), pytest.approx(along, rel=1e-7)]
    assert report["coordinates"]["origin"] == [pytest.approx(-71), pytest.approx(-9)]
    model = read_model("model.ply")
    assert judge(heights, model, lambda x, y, z: (x / across * 60, 60 - y / along * 60, z), 1e-4) <= 10


def test_an_hgt_of_another_name_stands_nowhere(terrain):
    write("mountain.hgt", dems.hgt(ground(20, 20)))
    report = report_of(terrain, "mountain.hgt --no-gdal -o model.ply --max-error 10")
    assert report["geotransform"] is None and report["crs"] is None


@pytest.mark.parametrize("is_point", [False, True])
@pytest.mark.parametrize("kind", ["f", "d", "h"])
def test_a_geotiff_is_of_areas_or_points_as_it_says(terrain, is_point, kind):
    needs_gdal(terrain)
    heights = with_holes(ground(WIDTH, HEIGHT))
    write("dem.tif", dems.geotiff(heights, (600000, 5200000), (10, 20), is_point, kind=kind, none=-999))
    report = report_of(terrain, "dem.tif -o model.glb --max-error 11")
    x, y = (600000, 5200000) if is_point else (600005, 5199990)
    assert report["geotransform"] == [x, 10, 0, y, 0, -20] and "GTiff" in report["reader"]
    assert "UTM" in report["crs"] and report["coordinates"]["metres_of_unit"] == [1, 1]
    assert report["coordinates"]["origin"] == [x, y - 20 * (HEIGHT - 1)]
    assert report["no_data"]["value"] == -999
    assert judge(heights, read_model("model.glb"), lambda x, y, z: (x / 10, HEIGHT - 1 - y / 20, z)) <= 11


def test_a_geotiff_of_degrees_knows_the_extent_of_its_tile(terrain):
    needs_gdal(terrain)
    write("dem.tif", dems.geotiff(ground(33, 33), (10, 50), (1 / 32, 1 / 32), is_point=True, geographic=True))
    report = report_of(terrain, "dem.tif -o model.terrain --max-error 10")
    assert report["coordinates"]["extent"] == [10, 49, 11, 50]
    across, along = metres_of_degrees(49.5)
    report = report_of(terrain, "dem.tif -o model.ply --max-error 10")
    assert report["coordinates"]["metres_of_unit"] == [pytest.approx(across, rel=1e-7), pytest.approx(along, rel=1e-7)]


def test_around_a_pole_a_tile_of_the_globe_needs_no_metres_of_degrees_nor_what_has_its_spacing(terrain):
    needs_gdal(terrain)
    write("dem.tif", dems.geotiff(ground(33, 33), (10, 90), (1e-4, 1e-4), is_point=True, geographic=True))
    place = report_of(terrain, "dem.tif -o x.terrain --max-error 10")["coordinates"]
    assert place["extent"] == pytest.approx([10, 89.9968, 10.0032, 90])
    place = report_of(terrain, "dem.tif -o x.ply --max-error 10 --spacing 5")["coordinates"]
    assert "--spacing" in place["metres"] and place["metres_of_unit"] == pytest.approx([50000, 50000])
    terrain.fails("lies around a pole", "dem.tif -o y.ply --max-error 10")


def test_feet_of_a_map_become_metres(terrain):
    needs_gdal(terrain)
    write("dem.tif", dems.geotiff(ground(20, 10), (1000000, 2000000), (100, 100), epsg=2263))  # New York, US survey feet
    report = report_of(terrain, "dem.tif -o model.ply --max-error 10")
    assert report["coordinates"]["metres_of_unit"] == [pytest.approx(1200 / 3937)] * 2
    assert max(v[0] for v in read_model("model.ply").vertices) == pytest.approx(1900 * 1200 / 3937)


def test_heights_of_64_bits_are_held_to_the_bound_as_the_file_has_them(terrain):
    needs_gdal(terrain)
    heights = [[z + 1e7 + 0.3 for z in row] for row in ground(30, 20)]  # a float's step is 1 there
    write("dem.tif", dems.geotiff(heights, kind="d"))
    report = report_of(terrain, "dem.tif -o model.obj --max-error 10")
    error = judge(heights, read_model("model.obj"), from_south(20))
    assert error <= report["max_error"] <= 10


# ---- the model ----
def test_scales_and_offset_are_as_help_says(terrain):
    heights = ground(20, 16)
    write("dem.pgm", dems.pgm(heights))
    terrain.done("dem.pgm -o model.ply --max-error 4 --scale 0.5 --z-scale 3 --offset 100 --spacing 25")
    place = lambda x, y, z: (x / 12.5, 15 - y / 12.5, z / 1.5 - 100)
    assert judge(heights, read_model("model.ply"), place) <= 4 + 1e-4


def test_normals_are_those_of_the_samples_and_may_be_left_out(terrain):
    write("dem.asc", dems.asc([[3 * x + 4 * y for x in range(12)] for y in range(9)]))
    for kind in ["ply", "obj", "glb"]:
        terrain.done(f"dem.asc -o model.{kind} --max-error 1 --z-scale 0.5")
        length = math.sqrt(1.5**2 + 2**2 + 1)
        assert all(normal == pytest.approx((-1.5 / length, 2 / length, 1 / length), abs=1e-6) for normal in read_model(f"model.{kind}").normals)
        terrain.done(f"dem.asc -o model.{kind} --max-error 1 --no-normals")
        assert read_model(f"model.{kind}").normals == []


def test_a_base_makes_a_closed_solid(terrain):
    heights = with_holes(ground(WIDTH, HEIGHT))
    write("dem.asc", dems.asc(heights))
    terrain.done("dem.asc -o model.stl --max-error 15 --base -100 --scale 0.5")
    model = read_model("model.stl")
    edges = {}
    for a, b, c in model.faces:
        for edge in ((a, b), (b, c), (c, a)):
            edges[edge] = edges.get(edge, 0) + 1
    assert all(count == edges.get((b, a)) for (a, b), count in edges.items())
    assert min(v[2] for v in model.vertices) == -50
    volume = sum(p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0])
                 for p, q, r in ([model.vertices[i] for i in face] for face in model.faces)) / 6
    assert volume > 0.25 * 0.5 * 200 * 0.8 * WIDTH * HEIGHT
    terrain.fails("", "dem.asc -o model.stl --max-error 15 --base 1000")


@pytest.mark.parametrize("effort", ["draft", "fast"])  # heights are samples: both sides of a touch have one
def test_an_edge_of_a_solid_has_two_faces_where_holes_touch_in_a_vertex(terrain, effort):
    heights = ground(30, 20)
    for x, y in [(11, 6), (13, 8), (20, 10), (22, 12), (24, 10)]:
        heights[y][x] = None
    write("dem.asc", dems.asc(heights))
    terrain.done(f"dem.asc -o model.stl --max-error 15 --base -100 --effort {effort}")
    edges = [edge for a, b, c in read_model("model.stl").faces for edge in ((a, b), (b, c), (c, a))]
    assert len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)


# ---- tiles ----
def border(model, is_border):
    """Position and normal of the vertices there, by position."""
    return sorted((v, n) for v, n in zip(model.vertices, model.normals or [()] * len(model.vertices)) if is_border(v))


@pytest.mark.parametrize("holes", [False, True])
@pytest.mark.parametrize("effort", EFFORTS)
def test_neighbours_have_the_same_vertices_and_normals_along_their_common_row(terrain, effort, holes):
    heights = ground(WIDTH, HEIGHT)
    if holes:  # that end within a tile: a border alone knows nothing of what is without data beside it
        heights = [[None if math.hypot(x - 24, y - 8) < 5 or (x < 5 and 20 < y < 27) or (x, y) == (40, 28) else z for x, z in enumerate(row)]
                   for y, row in enumerate(heights)]
    write("dem.asc", dems.asc(heights, cell=3.7))
    report = report_of(terrain, f"dem.asc -o tile.ply --max-error 9 --tiles 16 --effort {effort}")
    tiles = {(t["x"], t["y"]): read_model(t["file"]) for t in report["tiles"]}
    assert sorted(tiles) == [(x, y) for x in range(3) for y in range(3)]
    for t in report["tiles"]:
        cut = [row[t["column"] :][: t["width"]] for row in heights[t["row"] :][: t["height"]]]
        place = lambda x, y, z: (x / 3.7 - t["column"], HEIGHT - 1 - y / 3.7 - t["row"], z)
        assert judge(cut, tiles[t["x"], t["y"]], place, 1e-5) <= 9
    single = lambda x: struct.unpack("f", struct.pack("f", x))[0]
    shared = 0
    for x in (1, 2):
        for y in range(3):
            at = single(3.7 * 16 * x)
            here, there = (border(tiles[c, y], lambda v: v[0] == at) for c in (x - 1, x))
            assert here == there
            shared += len(here)
    for y in (1, 2):
        for x in range(3):
            at = single(3.7 * (HEIGHT - 1) - 3.7 * 16 * y)
            here, there = (border(tiles[x, r], lambda v: v[1] == at) for r in (y - 1, y))
            assert here == there
            shared += len(here)
    assert shared > 40


@pytest.mark.parametrize("kind", ["ply", "obj", "glb", "stl"])
@pytest.mark.parametrize("effort", ["fast", "best"])
def test_tiles_put_together_by_equal_numbers_are_one_surface_within_the_bound(terrain, kind, effort):
    heights = ground(WIDTH, HEIGHT)
    write("dem.asc", dems.asc(heights, cell=3.7))
    report = report_of(terrain, f"dem.asc -o tile.{kind} --max-error 9 --tiles 16 --effort {effort}")
    vertices, faces = {}, []
    for tile in report["tiles"]:
        model = read_model(tile["file"])
        faces += [tuple(vertices.setdefault(model.vertices[v], len(vertices)) for v in face) for face in model.faces]
    assert len(report["tiles"]) == 9 and len(faces) == report["triangles"]
    assert judge(heights, dems.Model(list(vertices), faces), from_south(HEIGHT, 3.7), 1e-5) <= 9


def test_the_judge_sees_a_crack():
    vertices = [(x, y, 0) for y in range(3) for x in range(3)]
    faces = [(a, b, c) for k in (0, 1, 3, 4) for a, b, c in ((k, k + 3, k + 1), (k + 1, k + 3, k + 4))]
    assert judge([[0] * 3] * 3, dems.Model(vertices, faces)) == 0
    faces[-1] = (9, *faces[-1][1:])
    with pytest.raises(AssertionError, match="data on both sides"):
        judge([[0] * 3] * 3, dems.Model([*vertices, vertices[5]], faces))


def test_a_tile_is_the_same_made_alone_or_with_others_by_any_number_of_jobs(terrain):
    write("dem.pgm", dems.pgm(ground(70, 50)))
    made = []
    for how in ["--jobs 1", "--jobs 3"]:
        terrain.done(f"dem.pgm -o a.ply --max-error 7 --tiles 20 {how}")
        made.append({name: content for name, content in contents().items() if name.suffix == ".ply"})
    assert made[0] == made[1] and len(made[0]) == 4 * 3
    assert terrain.done("dem.pgm --tiles 20 --list").split() == [f"{x}_{y}" for y in range(3) for x in range(4)]
    for name in terrain.done("dem.pgm --tiles 20 --list").split():
        terrain.done(f"dem.pgm -o b.ply --max-error 7 --tiles 20 --only {name} -q")
        assert read(f"b_{name}.ply") == read(f"a_{name}.ply")
    terrain.done("dem.pgm -o c.ply --max-error 7 --tiles 20 --only 3_2 --only 0_1 --only 3_2 -q")
    assert sorted(path.name for path in Path().glob("c_*")) == ["c_0_1.ply", "c_3_2.ply"]
    whole = []
    for how in ["--jobs 1", "--jobs 3"]:
        terrain.done(f"dem.pgm -o whole.ply --max-error 7 {how}")
        whole.append(read("whole.ply"))
    assert whole[0] == whole[1]


def test_models_that_were_cut_apart_before_have_the_same_borders_unless_they_are_free(terrain):
    for name, column in [("west", 0), ("east", 30)]:
        write(f"{name}.asc", dems.asc(ground(31, 40, column)))
    for options in ["", "--free-borders"]:
        for name in ["west", "east"]:
            terrain.done(f"{name}.asc -o {name}.ply --max-error 9 {options}")
        west, east = ([v[1:] for v in read_model(f"{name}.ply").vertices if v[0] == x] for name, x in [("west", 30), ("east", 0)])
        assert (sorted(west) == sorted(east)) == (options == "")


def test_a_budget_is_met_with_less_error_than_within_a_bound(terrain):
    heights = ground(WIDTH, HEIGHT)
    write("dem.pgm", dems.pgm(heights))
    bound = report_of(terrain, "dem.pgm -o bound.ply --max-error 30 --effort draft")
    budget = report_of(terrain, f"dem.pgm -o budget.ply --vertices {bound['vertices']}")
    assert budget["vertices"] == bound["vertices"] and budget["bound"] is None
    assert budget["rms_error"] < 0.8 * bound["rms_error"]
    assert judge(heights, read_model("budget.ply"), from_south(HEIGHT)) == pytest.approx(budget["max_error"], abs=1e-3)
    assert report_of(terrain, "dem.pgm -o budget.glb --percent 10 --effort fast")["vertices"] == round(WIDTH * HEIGHT / 10)
    write("dem.asc", dems.asc(with_holes(heights)))
    terrain.fails("numbers of vertices do not", "dem.asc -o x.ply --vertices 90")


def test_tiles_of_a_budget_meet_where_their_borders_have_a_tolerance(terrain):
    write("dem.pgm", dems.pgm(ground(41, 21)))
    for options in ["", "--border-tolerance 12"]:
        terrain.done(f"dem.pgm -o t.ply --vertices 90 --tiles 20 {options}")
        west, east = (border(read_model(f"t_{x}_0.ply"), lambda v: v[0] == 20) for x in (0, 1))
        assert len(west) > 2 and (west == east) == (options != "")


def test_last_tiles_that_have_fewer_samples_than_vertices_are_asked_for_get_these(terrain):
    for width, last in [(42, [42, 4]), (52, [90, 24])]:
        write("dem.pgm", dems.pgm(ground(width, 22)))
        report = report_of(terrain, "dem.pgm -o t.ply --vertices 90 --border-tolerance 12 --tiles 20 --effort draft")
        assert [(t["x"], t["y"], t["vertices"]) for t in report["tiles"]] == [
            (0, 0, 90), (1, 0, 90), (2, 0, last[0]), (0, 1, 42), (1, 1, 42), (2, 1, last[1])]
    terrain.fails("a mesh has at most one vertex a pixel (500, limit 441)", "dem.pgm -o u.ply --vertices 500 --tiles 20")
    terrain.fails("a mesh has at most one vertex a pixel (2000, limit 1144)", "dem.pgm -o u.ply --vertices 2000")


def test_samples_are_spacing_apart_in_both_directions(terrain):
    needs_gdal(terrain)
    heights = ground(12, 9)
    write("dem.tif", dems.geotiff(heights, step=(2, 3)))
    terrain.done("dem.tif -o x.ply --max-error 5 --spacing 10 -q")
    assert judge(heights, read_model("x.ply"), from_south(9, 10)) <= 5


def test_samples_that_are_no_metres_apart_in_either_direction_or_too_many_are_refused(terrain):
    for width, height, options in [(20, 2, "--scale 1e307"), (2, 20, "--scale 1e307"), (9, 9, "--scale 1e-300 --spacing 1e-100")]:
        write("dem.pgm", dems.pgm(ground(width, height)))
        terrain.fails("'dem.pgm' has samples that are no metres apart, or too many", f"dem.pgm -o x.ply --max-error 9 {options}")
    assert not Path("x.ply").exists()


def test_scales_that_make_0_of_all_heights_are_refused(terrain):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    for how in ["--vertices 20", "--max-error 9"]:
        terrain.fails("--scale and --z-scale make 0 of all heights", f"dem.pgm -o x.ply {how} --scale 1e-30 --z-scale 1e-300")
    assert not Path("x.ply").exists()


def test_tiles_of_a_budget_keep_to_one_range_of_heights(terrain):
    write("dem.raw", dems.raw([[1000 if (7919 * x + 104729 * y) % 53 == 0 else 0 for x in range(61)] for y in range(61)]))
    terrain.done(f"dem.raw --size 61x61 -o t.terrain --vertices 200 --border-tolerance 5 --tiles 30 {EXTENT}")
    tiles = {(x, y): read_model(f"t_{x}_{y}.terrain") for x in (0, 1) for y in (0, 1)}
    assert {tile.range for tile in tiles.values()} == {(-50, 1050)}
    east = sorted(p[1:] for p in tiles[0, 0].grid if p[0] == 32767)
    assert east == sorted(p[1:] for p in tiles[1, 0].grid if p[0] == 0) and len(east) > 2
    terrain.fails("a height beyond", f"dem.raw --size 61x61 -o u.terrain --vertices 200 --heights 0,10 {EXTENT}")


def test_resume_leaves_tiles_that_are_newer_than_the_input(terrain):
    write("dem.pgm", dems.pgm(ground(40, 30)))
    os.utime("dem.pgm", (1e9, 1e9))
    terrain.done("dem.pgm -o t.ply --max-error 7 --tiles 20")
    whole = read("t_0_0.ply")
    write("t_0_0.ply", b"kept")
    Path("t_1_0.ply").unlink()
    report = report_of(terrain, "dem.pgm -o t.ply --max-error 7 --tiles 20 --resume")
    assert [t["is"] for t in report["tiles"]] == ["kept", "made", "kept", "kept"] and read("t_0_0.ply") == b"kept"
    assert Path("t_1_0.ply").exists() and report["tiles"][1]["vertices"] > 0
    assert [report[name] for name in ["vertices", "triangles", "max_error", "rms_error"]] == [None] * 4  # of all, hence not known
    assert report["samples"] == 40 * 30 and report["no_data"] == {"value": None, "samples": None, "share": None}
    terrain.done("dem.pgm -o t.ply --max-error 7 --tiles 20")
    assert read("t_0_0.ply") == whole
    for time in (9e8, 1e9):  # what is as old as the input may be of what was there before
        write("t_0_0.ply", b"old")
        os.utime("t_0_0.ply", (time, time))
        report = report_of(terrain, "dem.pgm -o t.ply --max-error 7 --tiles 20 --resume")
        assert [t["is"] for t in report["tiles"]] == ["made", "kept", "kept", "kept"] and read("t_0_0.ply") == whole


def test_a_tile_without_data_has_no_file(terrain):
    heights = ground(41, 21)
    write("dem.asc", dems.asc([[z if x < 21 else None for x, z in enumerate(row)] for row in heights]))
    report = report_of(terrain, "dem.asc -o t.ply --max-error 7 --tiles 20")
    assert [t["is"] for t in report["tiles"]] == ["made", "empty"]
    assert Path("t_0_0.ply").exists() and not Path("t_1_0.ply").exists()


def test_a_tile_that_has_no_data_any_more_has_no_file_of_a_run_before(terrain):
    write("dem.asc", dems.asc([[7 if x < 20 else x + y for x in range(41)] for y in range(21)]))
    terrain.done("dem.asc -o t.ply --max-error 1 --tiles 20")
    assert Path("t_0_0.ply").exists()
    terrain.done("dem.asc -o t.ply --max-error 1 --tiles 20 --no-data 7")
    assert not Path("t_0_0.ply").exists() and Path("t_1_0.ply").exists()


def test_samples_that_tiles_share_count_once(terrain):
    write("dem.asc", dems.asc([[None if 10 < x < 40 and y < 25 else z for x, z in enumerate(row)] for y, row in enumerate(ground(60, 50))]))
    whole, cut = (report_of(terrain, f"dem.asc -o x.ply --max-error 9 {tiles}") for tiles in ["", "--tiles 16"])
    assert cut["samples"] == whole["samples"] == 60 * 50 and cut["no_data"] == whole["no_data"]
    terrain.done("job plan dem.asc -o job --max-error 9 --tiles 16 --levels 2 -q")
    finish(terrain)
    index = json.loads(read("job/tiles/index.json"))
    assert index["no_data"] == whole["no_data"] and [level["samples"] for level in index["levels"]] == [60 * 50, 30 * 25]


@pytest.mark.parametrize("kind, options", [("ply", ""), ("terrain", f"{EXTENT} --heights 0,1")])
def test_tiles_of_as_many_cells_as_help_allows_are_made_beside_others(terrain, kind, options):
    most = int(re.search(r"cells a side, 1 to (\d+)", terrain.done("--help"))[1])
    assert f"1 to {most} " in terrain.done("job plan --help")
    write("dem.raw", bytes(2 * 2 * (2 * most + 2)))
    arguments = f"dem.raw --size {2 * most + 2}x2 --type int16 -o t.{kind} {options} --max-error 1 --effort draft"
    terrain.done(f"{arguments} --tiles {most}")
    assert sorted(path.name for path in Path().glob("t_*")) == [f"t_{x}_0.{kind}" for x in range(3)]
    assert terrain.run(f"{arguments} --tiles {most + 1}").returncode == 2


def write_wide(name, width, height):
    """A model of no height as GDAL has it, of any size."""
    Path(name).write_text(f"<VRTDataset rasterXSize='{width}' rasterYSize='{height}'><VRTRasterBand dataType='Float32' band='1'/></VRTDataset>")


def test_a_model_as_wide_as_any_is_cut_into_tiles(terrain):
    needs_gdal(terrain)
    side, cells = 2 ** 31 - 1, 65533
    write_wide("dem.vrt", side, 2)
    names = terrain.done(f"dem.vrt --tiles {cells} --list").split()
    assert names == [f"{x}_0" for x in range((side - 2) // cells + 1)]
    report = report_of(terrain, f"dem.vrt -o t.terrain {EXTENT} --heights 0,1 --max-error 1 --effort draft --tiles {cells} "
                       f"--only {names[0]} --only {names[-1]}")
    assert [t["column"] + t["width"] for t in report["tiles"]] == [cells + 1, side]


def test_a_model_of_one_row_or_column_or_of_too_long_ones_is_refused(terrain):
    write("few.raw", bytes(18))
    write("long.raw", bytes(2 * 65537 * 2))
    for a, b in [(9, 1), (1, 9)]:
        terrain.fails(f"'few.raw' has {a} x {b} samples, and a surface has at least 2 x 2",
                      f"few.raw --size {a}x{b} -o x.ply --max-error 1")
    for a, b in [(65537, 2), (2, 65537)]:
        terrain.fails(f"'long.raw' has {a} x {b} samples, more than 65536 a side or 268435456 in all: --tiles cuts it smaller",
                      f"long.raw --size {a}x{b} -o x.ply --max-error 1")
    assert not Path("x.ply").exists()


def test_tiles_that_are_too_many_or_too_large_are_refused_before_any_is_made(terrain):
    needs_gdal(terrain)
    side = 2 ** 31 - 1
    write_wide("dem.vrt", side, side)
    terrain.fails(f"has {side} x {side} samples, more than 65536 a side", "dem.vrt -o x.ply --max-error 1")
    for command in ["dem.vrt -o x.ply", "job plan dem.vrt -o job"]:
        terrain.fails(f"would be {(side - 1) ** 2} tiles, more than 1000000", f"{command} --max-error 1 --tiles 1")
        terrain.fails("has tiles of 20003 x 20003 samples, those beside them counted, more than 65536 a side or 268435456 in all",
                      f"{command} --max-error 1 --tiles 20000")


def test_tiles_of_the_globe_share_heights_and_say_their_degrees(terrain):
    heights = ground(WIDTH, HEIGHT)
    write("dem.pgm", dems.pgm(heights))
    report = report_of(terrain, f"dem.pgm -o t.terrain --max-error 9 --tiles 18 {EXTENT}")
    tiles = {(t["x"], t["y"]): (t, read_model(t["file"])) for t in report["tiles"]}
    assert len({model.range for _, model in tiles.values()}) == 1
    for t, model in tiles.values():
        cut = [row[t["column"] :][: t["width"]] for row in heights[t["row"] :][: t["height"]]]
        assert judge(cut, model, in_tile(t["width"], t["height"]), 2e-3) <= 9
        assert 1 in model.extensions and len(model.extensions[1]) == 2 * len(model.vertices)
        for edge, (k, value) in zip(model.edges, [(0, 0), (1, 0), (0, 32767), (1, 32767)]):
            assert sorted(edge) == [v for v, place in enumerate(model.grid) if place[k] == value]
    for x, y in [(0, 0), (1, 0), (0, 1)]:
        east = sorted(p[1:] for p in tiles[x, y][1].grid if p[0] == 32767)
        west = sorted(p[1:] for p in tiles[x + 1, y][1].grid if p[0] == 0)
        assert east == west
    alone = f"dem.pgm -o a.terrain --max-error 9 --tiles 18 {EXTENT} --only 1_1"
    low, high = (f(z for row in heights for z in row) for f in (min, max))
    terrain.done(f"{alone} --heights {low},{high}")
    assert read("a_1_1.terrain") == read("t_1_1.terrain")
    terrain.done(alone)
    assert read("a_1_1.terrain") == read("t_1_1.terrain")


# ---- the command line ----
WRONG = rows("""
    no input file is given                        |
    no output is given                            | dem.pgm --max-error 1
    how fine is not said                          | dem.pgm -o x.ply
    must end in one of: .glb, .ply                | dem.pgm -o x.png --max-error 1
    --max-error 'two' is not a number             | dem.pgm -o x.ply --max-error two
    --max-error '-1' must be 0 or more            | dem.pgm -o x.ply --max-error -1
    --max-error '1e999' is not finite             | dem.pgm -o x.ply --max-error 1e999
    --max-error 'nan' is not a number             | dem.pgm -o x.ply --max-error nan
    --max-error is given twice                    | dem.pgm -o x.ply --max-error 1 --max-error 2
    excludes                                      | dem.pgm -o x.ply --max-error 1 --vertices 9
    --vertices '3' must be at least 4             | dem.pgm -o x.ply --vertices 3
    --percent '101' must be above 0               | dem.pgm -o x.ply --percent 101
    --effort 'fine' is not one of: draft, fast    | dem.pgm -o x.ply --max-error 1 --effort fine
    --tiles '0' must be from 1                    | dem.pgm -o x.ply --max-error 1 --tiles 0
    --output 'a/.ply' must end in one of          | dem.pgm -o a/.ply --max-error 1 --tiles 4
    --only requires --tiles                       | dem.pgm -o x.ply --max-error 1 --only 0_0
    --list requires --tiles                       | dem.pgm --list
    --resume requires --tiles                     | dem.pgm -o x.ply --max-error 1 --resume
    --only '1-2' is not two numbers               | dem.pgm -o x.ply --max-error 1 --tiles 9 --only 1-2
    --size '12' is not two numbers                | dem.pgm -o x.ply --max-error 1 --size 12
    --type is given without --size                | dem.pgm -o x.ply --max-error 1 --type int16
    --scale '0' must be above 0                   | dem.pgm -o x.ply --max-error 1 --scale 0
    --spacing '-1' must be above 0                | dem.pgm -o x.ply --max-error 1 --spacing -1
    --base is given without                       | dem.pgm -o x.ply --max-error 1 --base 0
    --extent is given without                     | dem.pgm -o x.ply --max-error 1 --extent 1,2,3,4
    --extent '1,2,3' is not 4 numbers             | dem.pgm -o x.terrain --max-error 1 --extent 1,2,3
    --extent '3,2,1,4' must be degrees            | dem.pgm -o x.terrain --max-error 1 --extent 3,2,1,4
    --scale means nothing to .terrain             | dem.pgm -o x.terrain --max-error 1 --extent 1,2,3,4 --scale 2
    --heights is given without an output          | dem.pgm -o x.ply --max-error 1 --heights 1,2
    --border-tolerance is given with --max-error  | dem.pgm -o x.ply --max-error 1 --border-tolerance 1
    --border-tolerance '-1' must be 0 or more     | dem.pgm -o x.ply --vertices 9 --border-tolerance -1
    --heights '2,1' must be the lowest            | dem.pgm -o x.terrain --max-error 1 --heights 2,1
    --free-borders is given without --max-error   | dem.pgm -o x.ply --vertices 9 --free-borders
    --free-borders is given with --tiles          | dem.pgm -o x.ply --max-error 1 --free-borders --tiles 9
    --jobs '1025' must be from 0 to 1024          | dem.pgm -o x.ply --max-error 1 --jobs 1025
    two inputs                                    | dem.pgm dem.pgm -o x.ply --max-error 1
    the standard input is no file                 | - -o x.ply --max-error 1
    unknown option '--fast'                       | dem.pgm -o x.ply --max-error 1 --fast
    """)


@pytest.mark.parametrize("sentence, arguments", WRONG)
def test_wrong_usage_is_told_in_one_sentence_with_exit_status_2(terrain, sentence, arguments):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    before = contents()
    run = terrain.run(arguments)
    first, second = run.stderr.splitlines()
    assert run.returncode == 2 and first.startswith("hmesh-terrain: ") and sentence in first
    assert second == "Try 'hmesh-terrain --help'." and run.stdout == "" and contents() == before


CLASHES = rows("""
    './dem.pgm' would overwrite the input 'dem.pgm'    | dem.pgm -o x.ply --report ./dem.pgm
    'input.json' would overwrite the input 'dem.pgm'   | dem.pgm -o x.ply --report input.json
    'dem.ply' would overwrite the input './dem.ply'    | ./dem.ply --size 9x9 -o dem.ply
    'dem_1_0.ply' would overwrite the input            | dem_1_0.ply --size 9x9 -o dem.ply --tiles 4
    'x.ply' is named for two outputs                   | dem.pgm -o x.ply --report x.ply
    'x.ply' and './x.ply' are one file                 | dem.pgm -o x.ply --report ./x.ply
    't_1_1.ply' is named for two outputs               | dem.pgm -o t.ply --tiles 4 --report t_1_1.ply
    'keep.ply' and 'link.json' are one file            | dem.pgm -o keep.ply --report link.json
    'new.ply' and 'nowhere.json' are one file          | dem.pgm -o new.ply --report nowhere.json
    'new_0_0.ply' and 'new_1_0.ply' are one file       | dem.pgm -o new.ply --tiles 4
    'keep.ply' and 'hard.json' are one file            | dem.pgm -o keep.ply --report hard.json
    'hard.ply' would overwrite the input 'dem.pgm'     | dem.pgm -o hard.ply
    """)


@pytest.mark.parametrize("sentence, arguments", CLASHES)
def test_no_file_is_two_of_input_tiles_and_report_by_whatever_name(terrain, sentence, arguments):
    for name, content in {"dem.pgm": dems.pgm(ground(9, 9)), "keep.ply": b"old", "dem.ply": dems.raw(ground(9, 9))}.items():
        write(name, content)
    for link, target in {"input.json": "dem.pgm", "link.json": "keep.ply", "nowhere.json": "new.ply", "new_1_0.ply": "new_0_0.ply",
                         "dem_1_0.ply": "dem.ply"}.items():
        Path(link).symlink_to(target)
    for link, target in {"hard.json": "keep.ply", "hard.ply": "dem.pgm"}.items():
        os.link(target, link)
    before = contents()
    run = terrain.run(f"{arguments} --max-error 1")
    assert run.returncode == 2 and sentence in run.stderr.splitlines()[0] and run.stdout == "" and contents() == before


def test_help_names_every_option_and_version_what_reads(terrain):
    text = terrain.done("--help")
    for option in ["--output", "--max-error", "--effort", "--tiles", "--resume", "--vertices", "--percent", "--no-data", "--scale", "--z-scale",
                   "--offset", "--no-normals", "--base", "--extent", "--jobs", "--report", "--quiet", "--help", "--version", "--size",
                   "--type", "--only", "--list", "--spacing", "--heights", "--no-gdal", "--free-borders",
                   "--border-tolerance", "--man", "--completion"]:
        assert re.search(rf"^  (-\w,)?{option}\b", text, re.M), option
    assert max(map(len, text.splitlines())) <= 132
    assert re.match(r"hmesh-terrain \d+\.\d+\.\d+\nreads\n", terrain.done("--version"))


def test_the_summary_and_quiet(terrain):
    write("dem.pgm", dems.pgm(ground(20, 20)))
    text = terrain.done("dem.pgm -o x.ply --max-error 5")
    assert re.search(r"^mesh +\d+ vertices, \d+ triangles$", text, re.M) and "(bound 5)" in text and "written    x.ply" in text
    assert terrain.done("dem.pgm -o x.ply --max-error 5 -q") == ""


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no /dev/full")
@pytest.mark.parametrize("arguments", ["-o x.ply --max-error 5", "--tiles 9 --list", "-o x.ply --max-error 5 --report - -q"])
def test_what_cannot_be_printed_is_a_failure(terrain, arguments):
    write("dem.pgm", dems.pgm(ground(20, 20)))
    with open("/dev/full", "wb") as file:
        is_failure(terrain.run(f"dem.pgm {arguments}", stdout=file), "cannot write to the standard output")


def test_the_summary_tells_of_no_file_that_was_not_written(terrain):
    write("none.asc", dems.asc([[None] * 20] * 20))

    def summary(arguments):
        return terrain.done(arguments).replace("read by    hmesh\n", "")

    text = summary("none.asc -o x.ply --max-error 5 --tiles 20")
    assert "0 made, 1 empty, which have no file" in text and "written" not in text and "mesh" not in text
    write("dem.pgm", dems.pgm(ground(20, 20)))
    os.utime("dem.pgm", (1e9, 1e9))
    assert "written    x_0_0.ply" in terrain.done("dem.pgm -o x.ply --max-error 5 --tiles 20")
    text = summary("dem.pgm -o x.ply --max-error 5 --tiles 20 --resume")
    assert "0 made, 1 kept" in text and "written" not in text and "mesh" not in text


def test_a_report_on_the_standard_output_is_all_that_is_there(terrain):
    write("dem.pgm", dems.pgm(ground(20, 20)))
    run = terrain.run("dem.pgm -o x.ply --max-error 5 --report -")
    assert run.returncode == 0 and json.loads(run.stdout)["width"] == 20 and "written    x.ply" in run.stderr
    assert json.loads(terrain.done("dem.pgm -o x.ply --max-error 5 --report - -q"))["height"] == 20


# ---- failures ----
FAILURES = rows("""
    'missing.tif'                                | missing.tif -o keep.ply --max-error 1
    'empty.asc'                                  | empty.asc -o keep.ply --max-error 1
    'text.tif'                                   | text.tif -o keep.ply --max-error 1
    '.'                                          | . -o keep.ply --max-error 1
    'short.raw'                                  | short.raw --size 20x20 -o keep.ply --max-error 1
    20 x 20 samples are 1600 as float32          | short.raw --size 20x20 --type int16 -o keep.ply --max-error 1
    'raw.raw'                                    | raw.raw --size 19x20 -o keep.ply --max-error 1
    'one.pgm' has 1 x 1 samples                  | one.pgm -o keep.ply --max-error 1
    'nowhere/x.ply'                              | dem.pgm -o nowhere/x.ply --max-error 1
    'nowhere/r.json'                             | dem.pgm -o keep.ply --max-error 1 --report nowhere/r.json
    is not one of the 3 x 3 tiles                | dem.pgm -o keep.ply --max-error 1 --tiles 8 --only 3_0
    does not say its degrees                     | dem.pgm -o keep.terrain --max-error 1
    cannot keep --max-error                      | dem.pgm -o keep.terrain --max-error 0.0001 --extent 1,2,3,4
    """)


@pytest.mark.parametrize("reader", ["", "--no-gdal"])
@pytest.mark.parametrize("sentence, arguments", FAILURES)
def test_a_failure_is_told_in_one_sentence_and_writes_nothing(terrain, sentence, arguments, reader):
    heights = ground(20, 20)
    for name, content in {"dem.pgm": dems.pgm(heights), "empty.asc": b"", "text.tif": b"this is no model\n", "one.pgm": dems.pgm([[7]]),
                          "short.raw": dems.raw(heights)[:-3], "raw.raw": dems.raw(heights), "keep.ply": b"old",
                          "keep.terrain": b"old"}.items():
        write(name, content)
    before = contents()
    terrain.takes_gdal = True
    terrain.fails(sentence, f"{arguments} {reader}")
    assert contents() == before


@pytest.mark.parametrize("name", ["dem.pgm", "dem.png", "dem.asc", "N10E010.hgt", "dem.tif"])
def test_a_file_that_is_cut_off_anywhere_is_refused(terrain, name):
    if name == "dem.tif":
        needs_gdal(terrain)
    heights = ground(20, 20)
    whole = {"dem.pgm": dems.pgm, "dem.png": dems.png, "dem.asc": dems.asc, "N10E010.hgt": dems.hgt, "dem.tif": dems.geotiff}[name](heights)
    for reader in readers(terrain) if name != "dem.tif" else [""]:
        for size in [0, 1, 7, 20, len(whole) // 3, len(whole) // 2, len(whole) - 30]:
            write(name, whole[:size])
            terrain.fails(f"cannot read '{name}': ", f"{name} -o x.ply --max-error 1 {reader}")
    assert not Path("x.ply").exists()


ODD_ASC = rows("""
    which is no number     | ncols 2 nrows 2 xllcorner 0 yllcorner 0 cellsize 1 1 2 3 four
    its head has           | ncols 2 nrows 2 colour 3 cellsize 1 1 2 3 4
    no ncols and nrows     | ncols 2.5 nrows 2 cellsize 1 1 2 3 4
    no ncols and nrows     | ncols -2 nrows 2 cellsize 1 1 2 3 4
    no cellsize            | ncols 2 nrows 2 cellsize 0 1 2 3 4
    no cellsize            | ncols 2 nrows 2 1 2 3 4
    ends before            | ncols 2 nrows 2 cellsize 1 1 2 3
    ends before            | ncols 2000000000 nrows 2000000000 cellsize 1 1 2 3
    has no number          | ncols two
    corner that is not     | ncols 2 nrows 2 xllcorner 1e400 yllcorner 0 cellsize 1 1 2 3 4
    corner that is not     | ncols 2 nrows 2 xllcenter 0 yllcenter nan cellsize 1 1 2 3 4
    """)


@pytest.mark.parametrize("sentence, text", ODD_ASC)
def test_what_is_wrong_with_an_asc_is_said(terrain, sentence, text):
    Path("dem.asc").write_text(text)
    terrain.fails(sentence, "dem.asc --no-gdal -o x.ply --max-error 1")


def test_long_words_of_an_asc_are_read_to_their_end(terrain):
    write("dem.asc", b"ncols 2 nrows 2 cellsize 1 0." + b"0" * 80 + b"3e81 1 2 1." + b"0" * 90)
    terrain.done("dem.asc --no-gdal -o x.obj --max-error 0")
    assert sorted(z for _, _, z in read_model("x.obj").vertices) == [1, 1, 2, 3]
    write("dem.asc", b"ncols 2 nrows 2 cellsize 1 1 2 3 0." + b"0" * 600 + b"4e601")
    terrain.fails("which is no number", "dem.asc --no-gdal -o y.obj --max-error 0")


CRS = 'GEOGCS["Earth",DATUM["D",SPHEROID["S",6378137,298]],PRIMEM["G",0],UNIT["degree",0.0174532925199433]]'
AUX = "<PAMDataset><PAMRasterBand band='1'>{}</PAMRasterBand></PAMDataset>"
MASK = ("<VRTDataset rasterXSize='30' rasterYSize='20'><Metadata><MDI key='INTERNAL_MASK_FLAGS_1'>2</MDI></Metadata>"
        "<VRTRasterBand dataType='Byte' band='1'/></VRTDataset>")
BESIDE = [("dem.asc", "dem.prj", "coordinate system", CRS), ("dem.pgm", "dem.wld", "geotransform", "2\n0\n0\n-2\n7\n45\n"),
          ("dem.pgm", "dem.pgm.aux.xml", "no-data value", AUX.format("<NoDataValue>200</NoDataValue>")),
          ("dem.pgm", "dem.pgm.aux.xml", "scale", AUX.format("<Scale>2</Scale>")),
          ("dem.pgm", "dem.pgm.aux.xml", "offset", AUX.format("<Offset>100</Offset>")), ("dem.pgm", "dem.pgm.msk", "mask", MASK)]


@pytest.mark.parametrize("dem, beside, what, text", BESIDE)
def test_a_job_refuses_a_copy_of_its_input_beside_which_another_file_says_something_else(terrain, dem, beside, what, text):
    if dem != "dem.asc":
        needs_gdal(terrain)
    for folder in ["planned", "copy"]:
        Path(folder).mkdir()
        write(f"{folder}/{dem}", (dems.asc if dem == "dem.asc" else dems.pgm)(ground(30, 20)))
    Path(f"planned/{beside}").write_text(text)
    for reader in readers(terrain) if dem == "dem.asc" else [""]:
        folder = f"job{reader}"
        terrain.done(f"job plan planned/{dem} -o {folder} --hash --max-error 9 --tiles 16 -q {reader}")
        first, seams, index = phases(folder)
        for task, before in [(first[0], first[1:]), (index[0], first + seams)]:
            terrain.done(f"job run {folder} {' '.join(before)} -q")
            there = contents()
            terrain.fails(f"'copy/{dem}' is not the input that was planned: its {what} is another",
                          f"job run {folder} {task} --input copy/{dem}")
            assert contents() == there
        shutil.copy(f"planned/{beside}", "copy")
        terrain.done(f"job run {folder} {index[0]} --input copy/{dem} -q")
        Path(f"copy/{beside}").unlink()


def test_a_plan_that_was_made_before_plans_held_this_is_refused(terrain):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    terrain.done("job plan dem.pgm -o job --max-error 9 -q")
    values = json.loads(read("job/plan.json"))
    del values["metadata"]
    Path("job/plan.json").write_text(json.dumps(values))
    forge("job/plan.json")
    for command in ["status job", "run job index"]:
        terrain.fails("'job' holds what no plan and no task of hmesh-terrain's wrote", f"job {command}")


def test_what_gdal_reads_and_is_no_model_of_heights_is_refused(terrain):
    needs_gdal(terrain)
    write("dem.tif", dems.geotiff(ground(9, 9), bands=3))
    terrain.fails("3 bands", "dem.tif -o x.ply --max-error 1")
    Path("turned.vrt").write_text("<VRTDataset rasterXSize='9' rasterYSize='9'><GeoTransform>0, 1, 0.5, 0, 0, -1</GeoTransform>"
                                  "<VRTRasterBand dataType='Float32' band='1'/></VRTDataset>")
    terrain.fails("turned against the axes", "turned.vrt -o x.ply --max-error 1")


def test_heights_that_run_to_the_north_are_turned(terrain):
    needs_gdal(terrain)
    heights = ground(WIDTH, HEIGHT)
    write("dem.tif", dems.geotiff(heights[::-1]))
    Path("up.vrt").write_text(f"<VRTDataset rasterXSize='{WIDTH}' rasterYSize='{HEIGHT}'><GeoTransform>100, 2, 0, 200, 0, 2</GeoTransform>"
                              "<VRTRasterBand dataType='Float32' band='1'><SimpleSource><SourceFilename relativeToVRT='1'>dem.tif"
                              "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>")
    report = report_of(terrain, "up.vrt -o x.ply --max-error 8")
    assert report["geotransform"] == [101, 2, 0, 200 + 2 * HEIGHT - 1, 0, -2]
    assert judge(heights, read_model("x.ply"), from_south(HEIGHT, 2)) <= 8


@pytest.mark.parametrize("options", ["-o locked/x.ply", "-o locked/x.ply --tiles 4", "-o x.ply --report locked/r.json"])
def test_a_locked_folder_is_not_written(terrain, options):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    Path("locked").mkdir(0o555)
    terrain.fails("Permission denied", f"dem.pgm {options} --max-error 1", preexec_fn=as_others)
    assert not list(Path("locked").iterdir())


@pytest.mark.parametrize("kind", [*FORMATS, "json"])
def test_a_full_disk_is_the_reason_and_is_not_replaced(terrain, full, kind):
    write("dem.pgm", dems.pgm(ground(9, 9)))
    Path(f"x.{kind}").symlink_to(full)
    arguments = "-o y.ply --report x.json" if kind == "json" else f"-o x.{kind} {extent_for(kind)}"
    terrain.fails(f"'x.{kind}': No space left", f"dem.pgm {arguments} --max-error 1")
    assert Path(f"x.{kind}").is_symlink() and full.is_char_device()


@pytest.mark.parametrize("kind", FORMATS)
def test_a_disk_that_fills_up_leaves_what_was_there(terrain, kind):
    write("dem.pgm", dems.pgm(ground(60, 60)))
    write(f"keep.{kind}", b"old")
    terrain.fails(f"'keep.{kind}'", f"dem.pgm -o keep.{kind} --max-error 1 {extent_for(kind)}", **limit(resource.RLIMIT_FSIZE, 1024))
    assert read(f"keep.{kind}") == b"old"


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("tiles", ["", "--tiles 100"])
def test_an_interrupt_leaves_whole_files_or_none(terrain, which, tiles):
    write("dem.raw", dems.raw([[(x * 7919 + y * 104729 + x * y * 31) % 997 for x in range(900)] for y in range(900)]))
    write("keep.ply", b"old")
    arguments = f"dem.raw --size 900x900 -o keep.ply --max-error 300 --effort best --jobs 2 {tiles}"
    with subprocess.Popen(terrain.words(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8") as job:
        send_once_caught(job, which, 0.7)
        out, err = job.communicate(timeout=60)
    if job.returncode == 0:
        pytest.skip("this machine was done before it was interrupted")
    is_failure(subprocess.CompletedProcess(job.args, job.returncode, out, err), "interrupted")
    assert read("keep.ply") == b"old"
    for path in Path().glob("keep_*.ply"):
        dems.read_ply(path)
