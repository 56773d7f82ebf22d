"""Sprites: faces that show nothing, outlines for textures, and budgets that flat images do not fill."""
import json
import re
import struct
from pathlib import Path

import pytest
from PIL import Image

from conftest import FORMATS, is_whole, ply_header, read, rows


@pytest.fixture
def icons(hmesh):
    """A soft disc with a ring's hole beside it over nothing, 80 x 60 px, and a picture of nothing."""
    pixels = []
    for y in range(60):
        for x in range(80):
            far, ring = ((x - 23) ** 2 + (y - 30) ** 2) ** 0.5, ((x - 62) ** 2 + (y - 30) ** 2) ** 0.5
            alpha = max(min(1, 22.5 - far), min(1, 14.5 - ring, ring - 6.5), 0)
            pixels.append((3 * x, 4 * y, 90, round(255 * alpha)) if alpha > 0 else (255, 0, 255, 0))
    disc = Image.new("RGBA", (80, 60))
    disc.putdata(pixels)
    disc.save("disc.png")
    Image.new("RGBA", (40, 30), (200, 10, 10, 0)).save("air.png")
    return hmesh


def read_ply(name):
    """Vertices as tuples of floats and bytes, and faces."""
    header, _, body = read(name).partition(b"end_header\n")
    lines = header.decode().splitlines()
    count = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    kinds = "".join({"float": "f", "uchar": "B"}[line.split()[1]] for line in lines if re.match(r"property (float|uchar) ", line))
    size = struct.calcsize("<" + kinds)
    vertices = [struct.unpack_from("<" + kinds, body, size * i) for i in range(count["vertex"])]
    faces = [struct.unpack_from("<B3i", body, size * count["vertex"] + 13 * i)[1:] for i in range(count["face"])]
    return vertices, faces


def covered(vertices, faces, width, height):
    """For each pixel, in rows: whether its centre is in a face or on its border, and in how many faces it is within."""
    out = [[(False, 0)] * width for _ in range(height)]
    for face in faces:
        p = [(vertices[v][0], height - vertices[v][1]) for v in face]
        for j in range(height):
            for i in range(width):
                side = [(p[k - 1][0] - p[k][0]) * (j + 0.5 - p[k][1]) - (p[k - 1][1] - p[k][1]) * (i + 0.5 - p[k][0])
                        for k in range(3)]
                is_in, count = out[j][i]
                out[j][i] = (is_in or min(side) >= 0 or max(side) <= 0, count + (min(side) > 0 or max(side) < 0))
    return out


def json_of(name):
    file = read(name)
    assert struct.unpack_from("<4sII", file)[2] == len(file)
    return json.loads(file[20 : 20 + struct.unpack_from("<I", file, 12)[0]])


def test_a_sprite_has_no_face_that_shows_nothing_and_says_how_many_are_opaque(icons):
    whole = icons.report("disc.png --premultiplied --vertices 200 -o whole.ply")
    report = icons.report("disc.png --sprite --vertices 200 -o disc.ply --render disc_drawn.png")
    assert whole["opaque_faces"] is None and whole["area"] is None
    assert report["premultiplied"] and report["faces"] < whole["faces"] and report["vertices"] <= whole["vertices"]
    assert report["psnr"] == pytest.approx(whole["psnr"], abs=0.05)
    vertices, faces = read_ply("disc.ply")
    assert len(vertices) == report["vertices"] and len(faces) == report["faces"]
    assert all(max(vertices[v][6] for v in face) > 2 for face in faces)
    opaque = [min(vertices[v][6] for v in face) == 255 for face in faces]
    assert opaque == [True] * report["opaque_faces"] + [False] * (len(faces) - report["opaque_faces"])
    assert report["opaque_faces"] > 50
    alpha = Image.open("disc.png").getchannel("A")
    assert report["area"] < 1.06 * sum(1 for a in alpha.getdata() if a > 0) / 4800
    drawn = Image.open("disc_drawn.png")
    assert drawn.mode == "RGBA" and drawn.getpixel((1, 1)) == (0, 0, 0, 0) and drawn.getpixel((23, 30))[3] == 255
    out = icons.done("disc.png --sprite --vertices 200")
    assert re.search(rf"^faces +{len(faces)}, the first {report['opaque_faces']} opaque; [0-9.]+ % of the rectangle$", out, re.M)
    more = icons.report("disc.png --sprite --alpha 100 --vertices 200")
    assert more["area"] < report["area"] and more["psnr"] < report["psnr"]


def test_a_picture_of_nothing_is_an_empty_mesh_in_every_format(icons):
    outputs = " ".join(f"-o air.{kind}" for kind in FORMATS)
    pictures = "--render r.png --wireframe w.png --residual e.png --strip s.png"
    for kind in ["exact", "flat", "gradient"]:
        report = icons.report(f"air.png --sprite --max-vertices 50 {outputs} {pictures} --svg {kind}")
        assert (report["status"], report["vertices"], report["faces"], report["psnr"]) == ("ok", 0, 0, "inf")
        assert report["opaque_faces"] == 0 and report["area"] == 0
    assert {"element vertex 0", "element face 0"} <= set(ply_header("air.ply"))
    icons.done("air.png --sprite --max-vertices 50 --glb packed -o packed.glb -q")
    assert json_of("air.glb")["scenes"] == json_of("packed.glb")["scenes"] == [{}]
    assert all(is_whole(f"air.{kind}") for kind in ["pdf", "eps", "svg", "html"])
    assert Image.open("r.png").getextrema() == ((0, 0),) * 4
    assert icons.report("air.png --premultiplied --vertices 50 -o full.ply")["vertices"] == 50


def test_images_without_alpha_are_sprites_that_are_all_opaque(icons):
    plain = icons.report("picture.png --vertices 80 -o plain.ply")
    report = icons.report("picture.png --vertices 80 --sprite -o sprite.ply")
    assert read("plain.ply") == read("sprite.ply")
    assert not report["premultiplied"] and report["opaque_faces"] == report["faces"] == plain["faces"] and report["area"] == 1


def test_a_search_for_a_sprite_reaches_its_psnr_as_it_is_written(icons):
    report = icons.report("disc.png --sprite --psnr 34 -o disc.ply --render drawn.png")
    assert report["psnr"] >= 34 and all(psnr >= 34 for psnr in report["psnr_written"].values())


def test_flat_images_do_not_fill_a_budget_and_others_do(icons):
    Image.new("RGB", (64, 48), (20, 60, 200)).save("flat.png")
    assert icons.report("flat.png --max-vertices 900")["vertices"] == 4
    assert icons.report("flat.png --rate 10 --good-enough 50")["vertices"] == 4
    assert icons.report("flat.png --vertices 90")["vertices"] == 90
    assert icons.report("picture.png --max-vertices 90 -o most.ply")["vertices"] == 90
    icons.done("picture.png --vertices 90 -o exact.ply")
    assert read("most.ply") == read("exact.ply")
    report = icons.report("picture.png --max-vertices 900 --good-enough 24")
    assert report["target"] == "--max-vertices 900 --good-enough 24" and 24 <= report["psnr"] < 25 and report["vertices"] < 400
    assert icons.report("constant.pgm --max-vertices 99999999")["vertices"] == 4


def test_an_outline_covers_every_pixel_once_and_has_texture_coordinates(icons):
    report = icons.report("disc.png --outline -o disc.ply -o disc.obj -o new/{name}.glb --wireframe w.png")
    assert report["method"] == "outline" and report["status"] == "ok" and report["borders"] in (2, 3)
    assert 1 <= report["area"] / report["area_needed"] <= 1.2
    vertices, faces = read_ply("disc.ply")
    assert len(vertices) == report["vertices"] < 50 and len(faces) == report["faces"]
    for x, y, z, s, t in vertices:
        assert z == 0 and s == pytest.approx(x / 80) and t == pytest.approx(y / 60) and 0 <= s <= 1 and 0 <= t <= 1
    alpha = Image.open("disc.png").getchannel("A")
    counts = covered(vertices, faces, 80, 60)
    for y in range(60):
        for x in range(80):
            is_in, count = counts[y][x]
            assert count <= 1 and (is_in or alpha.getpixel((x, y)) == 0)
    assert "comment TextureFile disc.png" in ply_header("disc.ply")
    assert "mtllib disc.mtl\n" in Path("disc.obj").read_text() and "map_Kd -clamp on disc.png\n" in Path("disc.mtl").read_text()
    gltf = json_of("new/disc.glb")
    assert gltf["images"] == [{"uri": "../disc.png"}] and gltf["accessors"][1]["count"] == len(vertices)
    wire = Image.open("w.png").convert("RGB")
    assert wire.size == (160, 120) and wire.getpixel((2, 2)) == (128, 128, 128)  # air is grey
    assert sum(wire.getpixel((2 * x, 2 * y)) == (3 * x, 4 * y, 90) for x in range(15, 32) for y in range(22, 39)) > 200  # of 289
    text = icons.done("disc.png --outline")
    share, least = 100 * report["area"], 100 * report["area_needed"]
    for line in [f"vertices  {len(vertices)} of {report['borders']} borders", f"faces     {len(faces)}",
                 f"area      {share:.2f} % of the rectangle, of which {least:.2f} % have to be inside"]:
        assert f"\n{line}\n" in text


@pytest.mark.parametrize("options, most", [("--max-vertices 4", 4), ("--max-vertices 9", 9), ("--tolerance 100", 12)])
def test_outlines_have_as_few_vertices_as_they_are_told(icons, options, most):
    assert 4 <= icons.report(f"disc.png --outline {options}")["vertices"] <= most


def test_outlines_know_margins_thresholds_holes_and_names(icons):
    plain = icons.report("disc.png --outline --tolerance 0 --margin 0")
    alpha = Image.open("disc.png").getchannel("A")
    assert plain["area_needed"] == pytest.approx(sum(1 for a in alpha.getdata() if a > 0) / 4800, abs=0.002)
    assert plain["area"] == pytest.approx(plain["area_needed"])
    inner = icons.report("disc.png --outline --tolerance 0 --margin 0 --alpha 200")
    assert inner["area"] < plain["area"] and inner["alpha"] == 200
    assert icons.report("disc.png --outline --margin 2")["area"] > plain["area"]
    assert icons.report("disc.png --outline --no-holes")["borders"] < 3
    icons.done("disc.png --outline --texture sheet/{name}_0.png -o named.ply -o named.glb")
    assert "comment TextureFile sheet/disc_0.png" in ply_header("named.ply")
    assert json_of("named.glb")["images"] == [{"uri": "sheet/disc_0.png"}]


def test_outlines_of_nothing_of_opaque_images_and_of_several_are_written(icons):
    out = icons.done("disc.png air.png picture.png --outline -o out/{name}.obj -o out/{name}.ply")
    assert [line.split(":")[0] for line in out.splitlines()] == ["disc.png", "air.png", "picture.png"]
    assert {"element vertex 0", "element face 0"} <= set(ply_header("out/air.ply"))
    assert {"element vertex 4", "element face 2"} <= set(ply_header("out/picture.ply"))
    assert Path("out/picture.mtl").is_file()


WRONG = rows("""
    --rate means nothing to --outline            | disc.png --outline --rate 2
    --sprite means nothing to --outline          | disc.png --outline --sprite
    --render means nothing to --outline          | disc.png --outline --render x.png
    'x.svg' holds none                           | disc.png --outline -o x.svg
    needs --texture                              | - --outline
    --alpha is given without                     | disc.png --alpha 3
    --alpha '255' must be from 0 to 254          | disc.png --sprite --alpha 255
    --margin requires --outline                  | disc.png --margin 1
    with a sprite, which does not repeat         | disc.png --sprite --periodic x
    with a sprite, which does not repeat         | disc.png --outline --periodic x
    --no-holes is given without --outline        | disc.png --no-holes
    --margin '64.5' must be from 0 to 64         | disc.png --outline --margin 64.5
    --margin 'x' is not a number                 | disc.png --outline --margin x
    --tolerance '-1' must be from 0              | disc.png --outline --tolerance -1
    --max-vertices '3' must be at least 4        | disc.png --outline --max-vertices 3
    --good-enough '0' must be above 0            | disc.png --good-enough 0
    excludes --good-enough                       | disc.png --psnr 30 --good-enough 40
    colours, and --sprite those times alpha      | disc.png --sprite --fit-space each
    'disc.mtl' would overwrite the input         | disc.mtl --outline -o disc.obj
""")


@pytest.mark.parametrize("sentence, arguments", WRONG)
def test_what_cannot_be_is_refused_with_a_sentence(icons, sentence, arguments):
    Path("disc.mtl").write_bytes(b"x")
    run = icons.run(arguments)
    assert run.returncode == 2 and sentence in run.stderr and run.stdout == ""


@pytest.mark.parametrize("option", [
    "--vertices 9", "--psnr 30", "--good-enough 30", "--effort draft", "--method xie", "--colors sampled", "--fit-space linear",
    "--premultiplied", "--weights disc.png", "--seed 2", "--tile 64", "--residual r.png", "--strip s.png", "--with disc.png",
    "--channel-weights 1,1,1,1", "--lods 2", "--grid 8", "--glb packed", "--glb-bits 8"])
def test_what_an_outline_does_not_know_is_refused(icons, option):
    run = icons.run(f"disc.png --outline -o x.glb {option}")
    assert run.returncode == 2 and f"{option.split()[0]} means nothing to --outline, which makes no mesh of colours" in run.stderr
    assert not Path("x.glb").exists()


def test_an_outline_on_the_standard_output_has_no_file_of_materials(icons):
    with open("disc.png", "rb") as image, open("stream.obj", "wb") as stream:
        assert icons.run("- --outline --texture disc.png -o - --format obj", stdin=image, stdout=stream).returncode == 0
    assert b"\nf " in Path("stream.obj").read_bytes() and not list(Path().glob("*.mtl"))


@pytest.mark.parametrize("weights", ["1,1,1,1", "1,0.02,0.02,0.3"])
def test_what_is_left_of_a_sprite_is_measured_by_the_weights_of_channels(icons, weights):
    report = icons.report(f"disc.png --sprite --channel-weights {weights} --vertices 120 -o x.ply --render x.png")
    assert report["psnr_written"]["x.png"] == pytest.approx(report["psnr"], abs=0.15)  # its rounding
    found = icons.report(f"disc.png --sprite --channel-weights {weights} --psnr 30 -o x.ply")
    assert 30 <= min(found["psnr"], found["psnr_written"]["x.ply"]) < 31
