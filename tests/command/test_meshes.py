"""What is written, and what is said of it."""
import base64
import io
import json
import math
import os
import re
import shlex
import shutil
import struct
import subprocess
from pathlib import Path

import pytest
from PIL import Image

import dems
from conftest import FORMATS, is_png, is_whole, ply_header, program, read
from terminal import shown

ALL_FORMATS = " ".join(f"-o x.{kind}" for kind in FORMATS)


def test_a_mesh_pictures_and_a_report_are_written_and_told(hmesh):
    files = ["mesh.ply", "second.PLY", "render.png", "wire.png", "report.json"]
    out = hmesh.done("picture.png --vertices 100 -o {} -o {} --render {} --wireframe {} --report {}".format(*files))
    for line in [r"vertices +100", r"PSNR +[0-9.]+ dB .*pixels and channels.*", r"time +[0-9.]+ s"]:
        assert re.search(f"^{line}$", out, re.M)
    assert re.findall(r"^written +(.*)$", out, re.M) == files
    assert read("mesh.ply") == read("second.PLY")
    assert is_png("render.png", (96, 64)) and is_png("wire.png", (192, 128))
    report = json.loads(read("report.json"))
    assert {"element vertex 100", f"element face {report['faces']}"} <= set(ply_header("mesh.ply"))
    assert list(report) == """version input width height channels bits method effort colors fit_space premultiplied periodic
                              straight_border samples border_tolerance seed weights tile target status vertices border_copies faces opaque_faces area psnr
                              psnr_convention psnr_written levels maps psnr_glb psnr_glb_fitted energy max_error seconds stages""".split()
    assert report.items() >= {"input": "picture.png", "width": 96, "height": 64, "channels": 3, "bits": 8, "method": "annealed",
                              "effort": "normal", "colors": "optimal", "fit_space": "stored", "premultiplied": False, "periodic": "none",
                              "straight_border": False, "samples": "squares", "border_copies": 0, "seed": 1,
                              "weights": None, "tile": 0, "target": "--vertices 100", "status": "ok", "vertices": 100}.items()
    assert report["psnr_convention"] == ("10 log10(peak^2 / MSE) in dB, MSE the mean over pixels and channels of the image's "
                                         "stored values; psnr of the mesh, values drawn not rounded, psnr_written of "
                                         "what the files hold")
    assert report["psnr"] == pytest.approx(10 * math.log10(255**2 * 96 * 64 * 3 / report["energy"]), abs=1e-6)
    assert report["seconds"] > 0.99 * sum(stage["seconds"] for stage in report["stages"]) > 0
    assert float(re.search(r"^time +([0-9.]+) s$", out, re.M)[1]) == pytest.approx(report["seconds"], abs=0.006)
    for stage in report["stages"]:
        assert list(stage) == ["name", "vertices", "energy", "psnr", "seconds"]
        assert stage["name"] and stage["vertices"] >= 4 and stage["psnr"] > 0 and stage["seconds"] >= 0


def test_quiet_prints_nothing(hmesh):
    assert hmesh.done("picture.png -o quiet.ply --quiet") == ""
    assert is_whole("quiet.ply")


@pytest.mark.parametrize("options, key, value", [
    ("", "vertices", 61), ("--effort draft", "effort", "draft"), ("--seed 7", "seed", 7), ("--tile 64", "tile", 64)])
def test_the_report_tells_options_and_one_vertex_for_100_pixels_is_the_default(hmesh, options, key, value):
    assert hmesh.report("picture.png " + options)[key] == value


def test_a_search_reaches_its_psnr_and_times_its_stages(hmesh):
    report = hmesh.report("picture.png --psnr 24")
    assert report["psnr"] >= 24
    assert any(stage["seconds"] is not None for stage in report["stages"])


@pytest.mark.parametrize("arguments", [
    "picture.png --vertices 100 --seed 1", "--vertices=100 --seed=1 -- picture.png", "picture.png --vertices 100 --threads 1",
    "picture.png --vertices 100 --threads 3", "picture.png --vertices 100 " + ALL_FORMATS])
def test_the_same_mesh_is_the_same_bytes(hmesh, arguments):
    hmesh.done("picture.png --vertices 100 -o mesh.ply")
    hmesh.done("-o again.ply " + arguments)
    assert read("mesh.ply") == read("again.ply")


def test_tiles_make_another_mesh_for_any_number_of_threads(hmesh):
    for name, tiles in {"whole": "", "tiles": "--tile 64 --threads 1", "again": "--tile 64 --threads 3"}.items():
        hmesh.done(f"wide.png --vertices 1400 --effort fast -o {name}.ply {tiles}")
    assert read("whole.ply") != read("tiles.ply") == read("again.ply")


def test_seeds_and_efforts_make_other_meshes(hmesh):
    options = ["", "--seed 2", "--effort draft", "--effort fast"]
    psnr = [hmesh.report(f"picture.png --vertices 100 {option} -o {k}.ply")["psnr"] for k, option in enumerate(options)]
    assert len({read(f"{k}.ply") for k in range(4)}) == 4 and psnr[2] < psnr[3] < psnr[0]


def test_where_weights_are_large_the_mesh_is_closer(hmesh):
    weights = Image.new("L", (96, 64), 1)
    weights.paste(255, (0, 0, 48, 64))
    weights.save("weights.png")
    off = []
    for name, option in {"plain": "", "weighted": "--weights weights.png"}.items():
        hmesh.done(f"picture.png --vertices 100 {option} --render {name}.png -q")
        halves = [Image.open(file).convert("RGB").crop((0, 0, 48, 64)).tobytes() for file in ["picture.png", f"{name}.png"]]
        off.append(sum((a - b) ** 2 for a, b in zip(*halves)))
    assert off[1] < 0.7 * off[0]


def test_weights_are_the_mean_of_colours_without_alpha(hmesh):
    grey = Image.linear_gradient("L").resize((96, 64)).point(lambda sample: sample // 2 + 40)
    darker, lighter = grey.point(lambda sample: sample - 40), grey.point(lambda sample: sample + 40)
    noise = Image.effect_noise((96, 64), 80)
    weights = {"L": [grey], "LA": [grey, noise], "RGB": [darker, lighter, grey], "RGBA": [lighter, darker, grey, noise]}
    for mode, channels in weights.items():
        Image.merge(mode, channels).save("weights.png")
        hmesh.done(f"picture.png --vertices 80 --weights weights.png -o {mode}.ply")
        assert read(f"{mode}.ply") == read("L.ply")
    hmesh.done("picture.png --vertices 80 -o even.ply")
    assert read("even.ply") != read("L.ply")


@pytest.mark.parametrize("file", ["grey.pgm", "grey16.pgm", "color.ppm", "color16.ppm", "grey_alpha.tga", "rgba.tga"])
def test_any_image_serves_as_weights(hmesh, file):
    report = hmesh.report(f"grey.pgm --weights {file}")
    assert report["weights"] == file
    assert ", each as often as its weight over the largest says," in report["psnr_convention"]


def test_premultiplied_colors_are_told_and_drawn(hmesh):
    hmesh.done("rgba.tga -o straight.html --vertices 40")
    outputs = "-o pre.html -o pre.glb -o pre.ply --render pre.png --strip strip.png"
    assert hmesh.report(f"rgba.tga --vertices 40 --premultiplied {outputs}")["premultiplied"] is True
    assert b'"premultiplied":true' in read("pre.html") and b'"premultiplied":false' in read("straight.html")
    assert is_png("pre.png")


def test_colors_for_linear_light_are_others(hmesh):
    hmesh.done("picture.png -o stored.glb --vertices 100")
    report = hmesh.report("picture.png -o linear.glb --vertices 100 --fit-space linear --residual residual.png")
    assert report["fit_space"] == "linear"
    assert read("stored.glb") != read("linear.glb")


@pytest.mark.parametrize("method, own_colors", [("annealed", "optimal"), ("adams", "sampled"), ("adaptive_thinning", "sampled"),
                                                ("xie", "sampled"), ("hierarchical", "optimal")])
def test_methods_have_colors_of_their_own_and_take_others(hmesh, method, own_colors):
    own = hmesh.report(f"picture.png -o own.ply --vertices 90 --method {method}")
    assert (own["method"], own["colors"]) == (method, own_colors)
    assert "element vertex 90" in ply_header("own.ply")
    psnr = {}
    for colors in ["optimal", "sampled"]:
        report = hmesh.report(f"picture.png -o {colors}.ply --vertices 90 --method {method} --colors {colors}")
        assert report["colors"] == colors
        psnr[colors] = report["psnr"]
    assert read("own.ply") == read(f"{own_colors}.ply")
    assert psnr["optimal"] > psnr["sampled"]
    solved = [stage for stage in own["stages"] if "iterations" in stage]
    assert [stage["name"] for stage in solved] == (["geometry"] * 4 if method == "hierarchical" else [])
    assert all(stage["iterations"] > 0 and 0 <= stage["residual"] < 1 for stage in solved)


def original_of(page):
    """The bytes of the picture in an .html file."""
    return base64.b64decode(re.search(rb'src="data:image/[a-z]+;base64,([^"]*)"', read(page))[1])


def test_every_format_holds_the_mesh(hmesh):
    report = hmesh.report(f"picture.png {ALL_FORMATS} --vertices 100")
    faces = report["faces"]
    assert all(is_whole(f"x.{kind}") for kind in FORMATS)
    assert read("x.obj").count(b"\nf ") == faces and read("x.svg").count(b"<path ") == faces
    assert b"/FlateDecode" in read("x.pdf") and b"/FlateDecode" in read("x.eps")
    page = read("x.html").decode()
    assert "<title>picture.png</title>" in page
    assert f">100 vertices\n{faces} faces\nPSNR {report['psnr']:.2f} dB<" in page
    assert '<p id="notes">PSNR = 10 log10(peak^2 / MSE), MSE over pixels and channels, values drawn not rounded</p>' in page
    assert original_of("x.html") == read("picture.png")


def turn_of(page):
    """How the page turns its picture: a number of Exif's."""
    return int(re.search(rb'data-turn="(\d)"', read(page))[1])


def chunks(png):
    """The names of a PNG file's."""
    names, at = [], 8
    while at < len(png):
        names.append(png[at + 4 : at + 8].decode())
        at += 12 + int.from_bytes(png[at : at + 4], "big")
    return names


def same_samples(one, two):
    """Whether two pictures hold the same, as they are stored."""
    one, two = Image.open(io.BytesIO(one)), Image.open(io.BytesIO(two))
    return (one.mode, one.size, list(one.getdata())) == (two.mode, two.size, list(two.getdata()))


@pytest.mark.parametrize("file, turn", [("plain.jpg", 1), ("upright.jpg", 1), ("turned.jpg", 6), ("turned_little.jpg", 6)])
def test_a_page_holds_a_jpeg_file_turns_it_itself_and_tells_nothing_of_the_camera(hmesh, file, turn):
    hmesh.done(f"{file} -o x.html")
    kept = original_of("x.html")
    assert turn_of("x.html") == turn
    assert b"Exif" in read(file) and b"Exif" not in kept
    assert same_samples(kept, read(file))
    assert kept[kept.index(b"\xff\xdb") :] in read(file)  # the tables, and all behind


def test_of_a_jpeg_file_the_page_leaves_out_profiles_comments_and_what_follows(hmesh):
    image = Image.open("picture.png").convert("RGB")
    image.save("rich.jpg", progressive=True, icc_profile=b"profile" * 20000, comment=b"a comment", restart_marker_blocks=2)
    plain = len(read("rich.jpg"))
    Path("rich.jpg").write_bytes(read("rich.jpg") + b"a clip" * 1000)
    hmesh.done("rich.jpg -o x.html")
    kept = original_of("x.html")
    assert same_samples(kept, read("rich.jpg")) and len(kept) < plain - 140000
    assert kept.endswith(b"\xff\xd9") and not any(word in kept for word in [b"profile", b"a comment", b"a clip"])


def test_of_a_png_file_the_page_leaves_out_what_changes_how_browsers_show_it(hmesh):
    image = Image.open("picture.png").convert("RGB").quantize(30)
    exif = Image.Exif()
    exif[274] = 6
    image.save("rich.png", icc_profile=b"profile", exif=exif, transparency=3, save_all=True,
               append_images=[image.transpose(Image.Transpose.ROTATE_180)])
    assert {"iCCP", "eXIf", "acTL", "fdAT"} <= set(chunks(read("rich.png")))
    hmesh.done("rich.png -o x.html")
    kept = original_of("x.html")
    assert [name for name in chunks(kept) if name != "IDAT"] == ["IHDR", "PLTE", "tRNS", "IEND"] and turn_of("x.html") == 6
    assert same_samples(kept, read("rich.png"))


def test_a_page_holds_as_png_what_browsers_may_show_otherwise(hmesh):
    image = Image.open("picture.png").convert("RGB")
    Image.merge("CMYK", [*image.split(), image.getchannel(0)]).save("four.jpg")
    Image.linear_gradient("L").convert("I;16").save("deep.png")
    for file, mode in {"four.jpg": "RGB", "deep.png": "L"}.items():
        hmesh.done(f"{file} -o x.html --vertices 40")
        kept = Image.open(io.BytesIO(original_of("x.html")))
        assert (kept.format, kept.mode) == ("PNG", mode), file


def test_the_psnr_of_a_glb_file_is_told_as_its_viewers_show_it_and_each_format_may_have_colours_of_its_own(hmesh):
    plain = hmesh.report("picture.png -o plain.glb -o plain.ply --vertices 100")
    each = hmesh.report("picture.png -o each.glb -o each.ply --vertices 100 --fit-space each")
    linear = hmesh.report("picture.png -o linear.glb --vertices 100 --fit-space linear")
    assert plain["psnr_glb"] < plain["psnr_glb_fitted"] == each["psnr_glb"] == linear["psnr"] and linear["psnr_glb"] is None
    assert plain["psnr"] == each["psnr"] and read("plain.ply") == read("each.ply")
    assert read("each.glb") == read("linear.glb") != read("plain.glb")
    said = hmesh.done("picture.png -o plain.glb --vertices 100")
    assert f"PSNR .glb {plain['psnr_glb']:.2f} dB" in said and f"{plain['psnr_glb_fitted']:.2f} dB with --fit-space each" in said
    assert ".glb" not in hmesh.done("picture.png -o plain.ply --vertices 100")


def test_a_page_holds_other_images_as_png(hmesh):
    hmesh.done("grey_alpha.tga -o x.html --vertices 40")
    Path("original.png").write_bytes(original_of("x.html"))
    assert is_png("original.png", (20, 16)) and Image.open("original.png").mode == "LA"


def test_a_page_without_the_original_differs_in_nothing_else(hmesh):
    hmesh.done("picture.png -o with.html --vertices 100")
    hmesh.done("picture.png -o without.html --no-original --vertices 100")
    assert read("without.html") == re.sub(rb"<img[^>]*>", b"", read("with.html"))
    assert b"<img" in read("with.html")


def test_svg_has_three_kinds(hmesh):
    for name, option in {"default": "", "gradient": "--svg gradient", "exact": "--svg exact", "flat": "--svg flat"}.items():
        hmesh.done(f"picture.png --vertices 100 -o {name}.svg {option}")
        assert is_whole(f"{name}.svg")
    assert read("default.svg") == read("gradient.svg")
    assert b"mix-blend-mode:screen" in read("exact.svg") and b"linearGradient" not in read("flat.svg")


def test_pictures_have_their_sizes(hmesh):
    hmesh.done("picture.png --vertices 100 --render big.png --render-scale 3 --residual residual.png --strip strip.png")
    assert is_png("big.png", (288, 192)) and is_png("residual.png", (96, 64))
    assert is_png("strip.png", (396, 64))  # four pictures, 4 px between


def test_a_strip_is_the_image_the_mesh_its_edges_and_what_is_off_four_times_as_large(hmesh):
    hmesh.done("picture.png --vertices 100 --render render.png --residual residual.png --strip strip.png -q")
    names = ["picture", "render", "strip", "residual"]
    original, drawn, strip, residual = (Image.open(f"{name}.png").convert("RGB") for name in names)
    parts = [strip.crop((100 * k, 0, 100 * k + 96, 64)).tobytes() for k in range(4)]
    off = bytes(max(0, min(255, 128 + 4 * (d - o))) for o, d in zip(original.tobytes(), drawn.tobytes()))
    assert parts[0] == original.tobytes() and parts[1] == drawn.tobytes() and parts[3] == residual.tobytes() == off
    lines = list(zip(parts[1], parts[2]))  # white
    assert sum(a != b for a, b in lines) > 2000 and all(a <= b for a, b in lines)
    assert all(set(strip.crop((100 * k - 4, 0, 100 * k, 64)).tobytes()) == {255} for k in (1, 2, 3))


@pytest.mark.parametrize("options", ["", "--samples points", "--periodic x"])
def test_a_wireframe_is_the_edges_and_nothing_else(hmesh, options):
    hmesh.done(f"black.pgm --vertices 24 {options} --wireframe wire.png -o mesh.obj -q")
    lines = [line.split() for line in Path("mesh.obj").read_text().splitlines()]
    shift, height = (0.5, 30) if "points" in options else (0, 32)  # of the picture, which is twice as large
    scale = (39 / 19, 31 / 15) if "points" in options else (2, 2)
    places = [(float(x), height / 2 - float(y)) for kind, x, y, *_ in lines[1:] if kind == "v"]
    points = [(x * scale[0] + shift, y * scale[1] + shift) for x, y in places]
    edges = {tuple(sorted((int(face[k]), int(face[k % 3 + 1])))) for face in lines[1:] if face[0] == "f" for k in (1, 2, 3)}
    edges = [(points[a - 1], points[b - 1]) for a, b in edges]
    if "periodic" in options:
        edges += [((a[0] + turn, a[1]), (b[0] + turn, b[1])) for a, b in edges for turn in (-40, 40)]
    wire, lit = Image.open("wire.png").convert("L"), 0
    assert wire.size == (40, 32)
    for y in range(32):
        for x in range(40):
            far = min(distance(x + 0.5, y + 0.5, *edge) for edge in edges)
            lit += far < 0.5
            assert wire.getpixel((x, y)) == 0 if far > 1.01 else far > 0.5 or wire.getpixel((x, y)) >= 0.5 * 0.6 * 255 - 1
    assert 200 < lit < 1000


def test_an_edge_lets_the_picture_through(hmesh):
    hmesh.done("constant.pgm --vertices 4 --wireframe wire.png")
    seen = set(Image.open("wire.png").convert("L").getdata())
    assert (min(seen), max(seen)) == (77, 77 + round(0.6 * (255 - 77)))


def distance(x, y, a, b):
    """Of a place from a line from a to b."""
    across, down = b[0] - a[0], b[1] - a[1]
    along = max(0, min(1, ((x - a[0]) * across + (y - a[1]) * down) / (across * across + down * down)))
    return math.hypot(a[0] + along * across - x, a[1] + along * down - y)


def test_where_nothing_is_lost_the_residual_is_plain(hmesh):
    hmesh.done("constant.pgm --residual residual.png")
    assert set(Image.open("residual.png").getdata()) == {(128, 128, 128)}


@pytest.mark.parametrize("file, channels, bits, last", [
    ("grey.pgm", 1, 8, "intensity"), ("grey16.pgm", 1, 16, "intensity"), ("grey_alpha.tga", 2, 8, "alpha"),
    ("color.ppm", 3, 8, "blue"), ("color16.ppm", 3, 16, "blue"), ("rgba.tga", 4, 8, "alpha")])
def test_images_of_any_depth_and_channels_become_meshes_and_pictures(hmesh, file, channels, bits, last):
    pictures = "--render render.png --wireframe wire.png --residual residual.png --strip strip.png"
    report = hmesh.report(f"{file} {ALL_FORMATS} --vertices 40 {pictures}")
    assert (report["channels"], report["bits"]) == (channels, bits)
    assert f"property uchar {last}" in ply_header("x.ply")
    assert all(is_whole(f"x.{kind}") for kind in FORMATS)
    assert all(is_png(f"{name}.png") for name in ["render", "wire", "residual", "strip"])


@pytest.mark.parametrize("eight, sixteen", [("grey.pgm", "grey16.pgm"), ("color.ppm", "color16.ppm")])
def test_8_and_16_bits_are_the_same_picture(hmesh, eight, sixteen):
    psnr = hmesh.report(f"{eight} --vertices 8")["psnr"]
    assert psnr > 20  # bytes in the wrong order would make noise of 10 dB
    assert hmesh.report(f"{sixteen} --vertices 8")["psnr"] == pytest.approx(psnr, abs=1)


def test_the_smallest_images_become_meshes(hmesh):
    hmesh.done("one.pgm -o one.ply --vertices 4")
    assert "element vertex 4" in ply_header("one.ply")
    hmesh.done("row.pgm -o row.ply")


def test_a_constant_image_has_the_psnr_inf(hmesh):
    assert re.search(r"^PSNR +inf ", hmesh.done("constant.pgm"), re.M)
    assert hmesh.report("constant.pgm")["psnr"] == "inf"


def test_any_file_name_is_told_in_utf_8(hmesh):
    name = b'odd "name" \\ \t\xff\xc3\xa4.pgm'
    shutil.copy(b"grey.pgm", name)
    assert hmesh.run([name, "--report", "odd.json"]).returncode == 0
    assert json.loads(read("odd.json"))["input"] == 'odd "name" \\ \t\ufffd\u00e4.pgm'


def test_links_are_followed_and_permissions_kept(hmesh):
    Path("real.ply").touch(0o600)
    Path("later").mkdir()
    links = {"link.ply": "real.ply", "first.ply": "later/new.ply", "second.ply": Path("first.ply").absolute(),
             "loop.ply": "loop.ply"}
    for link, target in links.items():
        Path(link).symlink_to(target)
    hmesh.done("grey.pgm -o link.ply -o second.ply")
    hmesh.fails("'loop.ply'", "grey.pgm -o loop.ply")
    assert all(Path(link).is_symlink() for link in links)
    assert is_whole("real.ply") and is_whole("later/new.ply")
    assert Path("real.ply").stat().st_mode & 0o777 == 0o600


def test_a_depfile_says_what_was_read_for_what_was_written(hmesh):
    shutil.copy("grey.pgm", "a #1 $2.pgm")
    hmesh.done("'a #1 $2.pgm' -o 'b $.ply' --report b.json --weights grey.pgm --depfile b.d")
    assert Path("b.d").read_text() == "b\\ $$.ply b.json: \\\n  a\\ \\#1\\ $$2.pgm \\\n  grey.pgm\n"


@pytest.mark.parametrize("engine", ["make", "ninja"])
@pytest.mark.parametrize("image, mesh", [("a #1 $2.pgm", "b $.ply"), ("a:b (1),{2}@!+.pgm", "c:d.ply")])
def test_make_and_ninja_run_again_what_has_changed(hmesh, engine, image, mesh):
    if shutil.which(engine) is None:
        pytest.skip(f"there is no {engine}")
    shutil.copy("grey.pgm", image)
    call = shlex.join(hmesh.words([image, "-o", mesh, "--depfile", "a.d", "-q"])).replace("$", "$$")
    named = mesh.replace("$", "$$")
    Path("makefile").write_text("-include a.d\n" + re.sub("([ :])", r"\\\1", named) + f":\n\t{call}\n")
    target = re.sub("([ :])", r"$\1", named)
    Path("build.ninja").write_text(f"rule mesh\n  command = {call}\n  depfile = a.d\nbuild {target}: mesh\n")

    def made():
        assert subprocess.run([engine, mesh], capture_output=True).returncode == 0
        return Path(mesh).stat().st_mtime_ns

    first = made()
    assert made() == first
    later = Path(mesh).stat().st_mtime + 10
    os.utime(image, (later, later))
    assert made() != first


def test_a_terminal_shows_a_progress_bar_unless_quiet(hmesh):
    status, bar = shown(hmesh.words("picture.png --vertices 100"), shows_output=True)
    assert status == 0 and re.search(rb"\[#*\.*\].* vertices", bar)
    assert shown(hmesh.words("picture.png --vertices 100 --quiet"), shows_output=True) == (0, b"")


def test_the_terrain_of_heightmap_looks_up(tmp_path, pytestconfig):
    terrain = tmp_path / "island.obj"
    subprocess.run([program(pytestconfig, "heightmap"), terrain], check=True, capture_output=True)
    model = dems.read_obj(terrain)
    ground = [(x, z) for x, _, z in model.vertices]
    faces = [[ground[v] for v in face] for face in model.faces]
    assert len(faces) > 1000 and all(y > 0 for _, y, _ in model.normals)
    assert all((b[1] - a[1]) * (c[0] - a[0]) > (b[0] - a[0]) * (c[1] - a[1]) for a, b, c in faces)


def test_heightmap_reads_png_of_16_bits_and_refuses_pgm_whose_bytes_stb_image_swaps(tmp_path, pytestconfig):
    heights = [236 + 3 * k for k in range(280)]
    Image.frombytes("I;16", (20, 14), struct.pack("<280H", *heights)).save(tmp_path / "heights.png")
    (tmp_path / "heights.pgm").write_bytes(b"P5 20 14 65535\n" + struct.pack(">280H", *heights))
    heightmap = [program(pytestconfig, "heightmap"), tmp_path / "heights.obj"]
    assert b"heights from 236 to 1073:" in subprocess.run([*heightmap, tmp_path / "heights.png"], check=True, capture_output=True).stdout
    assert subprocess.run([*heightmap, tmp_path / "heights.pgm"], capture_output=True).returncode == 1


@pytest.mark.parametrize("options, slow, who, seconds", [
    ("--vertices 20000", {"x.svg"}, "browsers take", 10), ("--vertices 19999", set(), "", 0),
    ("--vertices 6000 --svg exact", {"x.svg"}, "browsers take", 10), ("--vertices 5999 --svg exact", set(), "", 0),
    ("--vertices 40000 --svg flat", {"x.svg"}, "browsers take", 9), ("--vertices 39999 --svg flat", set(), "", 0),
    ("--vertices 50000", {"x.pdf", "X.SVG"}, "", 0)])
def test_it_says_which_file_is_slow_to_draw_and_what_to_take_instead(hmesh, options, slow, who, seconds):
    Image.effect_noise((400, 300), 80).save("noise.png")
    svg = "X.SVG" if len(slow) == 2 else "x.svg"
    out = hmesh.done(f"noise.png --effort draft {options} -o x.pdf -o {svg} -o x.glb -o x.html")
    notes = re.findall(r"^note +(\S+) has ([\d,]+) vertices: (.*) about (\d+) s to draw it; .html or .glb draw at once$", out, re.M)
    assert {note[0] for note in notes} == slow and out.count("note ") == len(slow)
    vertices = re.search(r"^vertices +(\d+)$", out, re.M)[1]
    for name, count, viewer, told in notes:
        assert count == f"{int(vertices):,}"
        if who:
            assert (viewer, int(told)) == (who, seconds)
    if len(slow) == 2:
        assert [(n[2], int(n[3])) for n in notes] == [("poppler (Okular, pdftoppm) takes", 10), ("browsers take", 22)]


def test_it_does_not_say_so_when_it_is_to_be_quiet(hmesh):
    Image.effect_noise((400, 300), 80).save("noise.png")
    assert hmesh.done("noise.png --effort draft --vertices 6000 --svg exact -o x.svg --quiet") == ""
