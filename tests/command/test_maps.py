"""Several images of one size as one mesh: --with, --channel-weights."""
import json
import math
import re
import struct
from pathlib import Path

import pytest
from PIL import Image, ImageChops, ImageFilter

from conftest import is_png, ply_header, read
from glb import Glb


@pytest.fixture
def maps(hmesh):
    """rock_albedo.png, rock_normal.png and rock_rough.png, 96 x 64 px."""
    albedo = Image.open("picture.png").convert("RGB")
    albedo.save("rock_albedo.png")
    height = albedo.convert("L").filter(ImageFilter.GaussianBlur(2))
    slope_x = ImageChops.subtract(height, ImageChops.offset(height, 1, 0), 1, 128)
    slope_y = ImageChops.subtract(height, ImageChops.offset(height, 0, 1), 1, 128)
    Image.merge("RGB", [slope_x, slope_y, Image.new("L", albedo.size, 230)]).save("rock_normal.png")
    height.save("rock_rough.png")
    return hmesh


def srgb_to_linear(share):
    return share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4


def ply_vertices(name):
    """Names of the properties, and the vertices' values."""
    header = ply_header(name)
    properties = [line.split()[1:] for line in header if line.startswith("property ") and "list" not in line]
    form = "<" + "".join({"float": "f", "uchar": "B"}[kind] for kind, _ in properties)
    count = int(next(line for line in header if line.startswith("element vertex")).split()[2])
    body = read(name).partition(b"end_header\n")[2]
    names = [name for _, name in properties]
    return names, [dict(zip(names, struct.unpack_from(form, body, i * struct.calcsize(form)))) for i in range(count)]


def psnr(a, b):
    a, b = Image.open(a).tobytes(), Image.open(b).tobytes()
    assert len(a) == len(b)
    return 10 * math.log10(255**2 * len(a) / sum((x - y) ** 2 for x, y in zip(a, b)))


def test_maps_become_attributes_and_properties_with_the_same_values(maps):
    maps.done("rock_albedo.png --with rock_normal.png --with rock_rough.png --vertices 200 -o rock.glb -o rock.ply -q")
    glb, (names, vertices) = Glb("rock.glb"), ply_vertices("rock.ply")
    assert names == "x y z red green blue nx ny nz rough".split()
    assert list(glb.attributes) == ["POSITION", "COLOR_0", "NORMAL", "TANGENT", "_ROUGH"]
    assert "extensionsUsed" not in glb.json  # it is lit
    assert len(vertices) == len(glb.places) == 200
    for i, vertex in enumerate(vertices):
        assert glb.places[i] == pytest.approx((vertex["x"] / 96, vertex["y"] / 96, 0), abs=1e-7)
        color = glb.attributes["COLOR_0"][i]
        for share, name in zip(color, ["red", "green", "blue"]):
            assert share == pytest.approx(srgb_to_linear(vertex[name] / 255), abs=0.006)
        normal = glb.attributes["NORMAL"][i]
        assert normal == pytest.approx((vertex["nx"], vertex["ny"], vertex["nz"]), abs=1e-6)
        assert math.hypot(*normal) == pytest.approx(1, abs=1e-6)
        assert glb.attributes["TANGENT"][i] == (1, 0, 0, 1)
        assert glb.attributes["_ROUGH"][i][0] == pytest.approx(vertex["rough"] / 255, abs=0.5 / 255 + 1e-4)


def test_the_values_are_those_of_the_images_under_the_vertices(maps):
    # A map that is a slope is kept exactly by any mesh.
    slope = Image.linear_gradient("L").rotate(90).resize((96, 64))
    slope.save("rock_slope.png")
    Image.new("RGB", (96, 64), (128, 218, 218)).save("rock_normal.png")
    maps.done("rock_albedo.png --with rock_slope.png --with rock_normal.png --vertices 100 --channel-weights 1,1,0.1 -o x.ply -q")
    for vertex in ply_vertices("x.ply")[1]:
        x, y = min(95, int(vertex["x"])), min(63, int(64 - vertex["y"]))
        assert vertex["slope"] == pytest.approx(slope.getpixel((x, y)), abs=4)
        assert (vertex["nx"], vertex["ny"], vertex["nz"]) == pytest.approx((0.005, 0.706, 0.706), abs=0.01)


def test_the_psnr_of_each_image_is_told_and_that_of_its_picture(maps):
    arguments = "rock_albedo.png --with rock_normal.png --with rough=rock_rough.png --vertices 250 --render x.png"
    report = maps.report(arguments)
    assert report["channels"] == 7 and report["bits"] == 16
    assert [(m["file"], m["name"], m["meaning"], m["channels"]) for m in report["maps"]] == [
        ("rock_albedo.png", "albedo", "color", 3), ("rock_normal.png", "normal", "normal", 3),
        ("rock_rough.png", "rough", "data", 1)]
    for m in report["maps"]:
        picture = f"x_{m['name']}.png"
        assert is_png(picture, (96, 64))
        assert psnr(m["file"], picture) == pytest.approx(m["psnr"], abs=0.1)
    mean = sum(m["channels"] * 10 ** (-m["psnr"] / 10) for m in report["maps"]) / 7
    assert report["psnr"] == pytest.approx(-10 * math.log10(mean), abs=0.01)
    out = maps.done(arguments)
    assert re.search(r"^PSNR +[0-9.]+ dB of 'rock_normal.png', 3 channels as normal$", out, re.M)
    assert re.findall(r"^written +(.*)$", out, re.M) == ["x_albedo.png", "x_normal.png", "x_rough.png"]


def test_pictures_of_periodic_maps_are_whole(maps):
    report = maps.report("rock_albedo.png --with rock_rough.png --vertices 250 --periodic xy --render x.png")
    for m in report["maps"]:
        assert psnr(m["file"], f"x_{m['name']}.png") == pytest.approx(m["psnr"], abs=0.1)
    mean = sum(m["channels"] * 10 ** (-m["psnr"] / 10) for m in report["maps"]) / 4
    assert report["psnr"] == pytest.approx(-10 * math.log10(mean), abs=0.01)


def test_two_maps_of_one_channel_keep_their_values(maps):
    Image.new("L", (96, 64), 40).save("a.png")
    Image.new("L", (96, 64), 200).save("b.png")
    maps.done("a.png --with b.png --vertices 10 -o x.ply -o x.glb -q")
    assert {(vertex["intensity"], vertex["b"]) for vertex in ply_vertices("x.ply")[1]} == {(40, 200)}
    assert [value for (value,) in Glb("x.glb").attributes["_B"]] == pytest.approx([200 / 255] * 10, abs=1e-4)


def test_weights_of_images_and_of_channels_move_the_psnr(maps):
    images = "rock_albedo.png --with rock_normal.png --with rock_rough.png --vertices 150 "
    even, albedo, by_channel, rough = [maps.report(images + more)["maps"] for more in [
        "", "--channel-weights 1,0.01,0.01", "--channel-weights 1,1,1,0.01,0.01,0.01,0.01", "--channel-weights 0,0,1"]]
    assert albedo == by_channel
    assert albedo[0]["psnr"] > even[0]["psnr"] + 0.1
    assert rough[2]["psnr"] > even[2]["psnr"] + 0.1
    assert rough[0]["psnr"] < even[0]["psnr"]


def test_balanced_weights_make_the_sum_of_the_psnrs_larger(maps):
    images = "rock_albedo.png --with rock_normal.png --with rock_rough.png --vertices 150 "
    even, balanced = [maps.report(images + more)["maps"] for more in ["", "--channel-weights balanced"]]
    assert sum(one["psnr"] for one in balanced) > sum(one["psnr"] for one in even) + 1
    weights = [one["weight"] for one in balanced]
    assert max(weights) == 1 and min(weights) >= 1e-4 and len(set(weights)) > 1 and "weight" not in even[0]
    # They are weights as one would give them, and told in the summary.
    again = maps.report(images + "--channel-weights " + ",".join("%.17g" % weight for weight in weights))["maps"]
    assert [one["psnr"] for one in again] == [one["psnr"] for one in balanced]
    assert re.search(r"3 channels as normal, weight [0-9.e-]+$", maps.done(images + "--channel-weights balanced"), re.M)


def test_a_map_of_one_value_does_not_take_all_of_the_balance(maps):
    Image.new("L", (96, 64), 77).save("flat.png")
    report = maps.report("rock_albedo.png --with flat.png --vertices 150 --channel-weights balanced")["maps"]
    assert report[0]["weight"] == pytest.approx(1e-4) and report[0]["psnr"] > 20 and report[1]["psnr"] == "inf"


def test_the_balance_counts_images_and_not_their_channels(maps):
    rough = Image.open("rock_rough.png").convert("L")
    rough.save("one.png")
    Image.merge("RGB", [rough] * 3).save("three.png")  # of the same PSNR in any mesh
    one, three = maps.report("one.png --with three.png --vertices 150 --channel-weights balanced")["maps"]
    assert one["weight"] == 1 and three["weight"] == pytest.approx(1 / 3, rel=1e-3)


def test_one_image_has_weights_of_its_channels(hmesh):
    plain, same, red = [hmesh.report("picture.png --vertices 100 " + more) for more in [
        "", "--channel-weights 2,2,2", "--channel-weights 1,0.01,0.01"]]
    assert plain["energy"] == same["energy"]
    assert red["psnr"] != plain["psnr"]
    assert "by their weights" in red["psnr_convention"]


@pytest.mark.parametrize("images, channels, bits", [
    ("color.ppm --with grey.pgm", 4, 8), ("grey.pgm --with color16.ppm", 4, 16), ("color.ppm --with color16.ppm", 6, 16),
    ("rgba.tga --with a=rgba.tga --with b=rgba.tga --with c=rgba.tga", 16, 16), ("grey.pgm --with float.pfm", 2, 32),
    ("color.ppm --with float.pfm --with flow=color16.ppm", 7, 32)])
def test_samples_become_those_of_the_widest_image(hmesh, images, channels, bits):
    Path("float.pfm").write_bytes(b"Pf\n20 16\n-1\n" + struct.pack("<320f", *[i / 320 for i in range(320)]))
    report = hmesh.report(images + " --vertices 60 -o x.ply -o x.glb")
    assert (report["channels"], report["bits"]) == (channels, bits)
    assert report["vertices"] == 60
    assert all(m["psnr"] > 12 for m in report["maps"])
    assert sum(map(len, (a[0] for name, a in Glb("x.glb").attributes.items() if name != "POSITION"))) >= channels


@pytest.mark.parametrize("files, names", [
    ("rock.png, rock_rough.png", "color rough"), ("rocks.png, rock_rough.png", "rocks rock_rough"),
    ("a/rock.png, b/rock.png", "color map"), ("rock-base.png, rock-rough.png", "base rough"),
    ("rock.base.png, rock.rough.png", "base rough"), ("1_base.png, 1__rough_.png", "base rough"),
    ("x_red.png, x_alpha.png", "red_map alpha_map"), ("x_a+b.png, x_c=d.png", "a_b c_d"),
    ("rock base.png, rock rough.png", "base rough")])
def test_maps_are_called_by_what_their_files_names_do_not_share(hmesh, files, names):
    files = files.split(", ")
    for file in files:
        Path(file).parent.mkdir(exist_ok=True)
        Path(file).write_bytes(read("picture.png"))
    report = hmesh.report(f"'{files[0]}' --with './{files[1]}' --vertices 20 --effort draft -o x.ply")
    assert [part["name"] for part in report["maps"]] == names.split()


def test_a_folder_may_have_the_sign_between_a_name_and_a_file(maps):
    Path("of=1").mkdir()
    Path("of=1/rough.png").write_bytes(read("rock_rough.png"))
    report = maps.report("rock_albedo.png --with ./of=1/rough.png --vertices 20 --effort draft -o x.ply")
    assert report["maps"][1]["file"] == "./of=1/rough.png"


def test_normals_may_be_called_so(maps):
    maps.done("rock_albedo.png --with his_normals=rock_normal.png --vertices 20 --effort draft -o x.ply")
    assert "property float nx" in ply_header("x.ply")


def test_what_is_to_be_known_of_another_map_is_told(hmesh):
    color = Image.open("color.ppm")
    color.save("moving.gif", save_all=True, append_images=[Image.new("RGB", color.size)])
    told = hmesh.done("color.ppm --with moving.gif -o x.glb --vertices 8")
    assert re.search(r"^note +the file is animated: .*first .*taken$", told, re.M)


def test_several_images_have_maps_of_their_own(maps):
    for name in ["albedo", "normal"]:
        Path(f"clay_{name}.png").write_bytes(read(f"rock_{name}.png"))
    maps.done("rock_albedo.png clay_albedo.png --vertices 50 --with normal={name}.png -o {name}.glb -q")
    assert list(Glb("rock_albedo.glb").attributes) == ["POSITION", "COLOR_0", "NORMAL", "TANGENT"]
    assert Path("clay_albedo.glb").exists()


def test_a_depfile_names_all_maps(maps):
    maps.done("rock_albedo.png --with rock_rough.png --vertices 50 -o x.ply --depfile x.d -q")
    assert read("x.d").decode().replace("\\\n", " ").split() == ["x.ply:", "rock_albedo.png", "rock_rough.png"]


def test_a_search_for_a_psnr_goes_by_all_maps(maps):
    report = maps.report("rock_albedo.png --with rock_rough.png --psnr 30 -o x.ply")
    assert 30 <= report["psnr"] < 32
    text = " ".join(maps.done("--help").split())
    assert "of --render; with --with that of the mesh, over all images" in text
    assert "--psnr is then that of the mesh over the channels of all" in text


def test_maps_are_packed_and_compressed(maps):
    images = "rock_albedo.png --with rock_normal.png --with rock_rough.png --vertices 150 -q "
    maps.done(images + "-o packed.glb --glb packed --glb-bits 8")
    packed = Glb("packed.glb")
    assert len(packed.places) == 150
    for normal in packed.attributes["NORMAL"]:
        assert math.hypot(*normal) == pytest.approx(1, abs=0.01)
    if "--glb meshopt" in maps.done("--version"):
        maps.done(images + "-o small.glb --glb meshopt --glb-bits 8")
        small = Glb("small.glb")
        for name, values in packed.attributes.items():
            assert sorted(values) == sorted(small.attributes[name])


@pytest.mark.parametrize("arguments, sentence", [
    ("--with wide.png -o x.ply",
     "'rock_albedo.png' has 96 x 64 px and 'wide.png' has 160 x 140 px: images of one mesh must have one size"),
    ("--with none.png -o x.ply", "cannot read 'none.png'"),
    ("--with normal=rock_rough.png -o x.ply", "called 'normal' and has 1 channel"),
    ("--with normal=rock_normal.png --with his_normal=rock_normal.png -o x.ply", "is a second map of normals"),
    ("--with rock_rough.png --channel-weights 1,2,3 -o x.ply",
     "--channel-weights has 3 numbers, for 2 images of 4 channels together"),
    ("--with rock_normal.png --samples points --border-tolerance 90 -o x.ply",
     "--border-tolerance makes sides of 1 to 4, 8 or 16 channels, and the images have 6 together")])
def test_maps_that_do_not_go_together_are_refused(maps, arguments, sentence):
    maps.fails(sentence, "rock_albedo.png " + arguments)
    assert not Path("x.ply").exists()


def test_more_than_16_channels_are_refused(hmesh):
    hmesh.fails("the images have 20 channels together, and a mesh has at most 16",
                "rgba.tga --with a=rgba.tga --with b=rgba.tga --with c=rgba.tga --with d=rgba.tga -o x.ply")


@pytest.mark.parametrize("arguments, sentence", [
    ("--with rock_rough.png -o x.pdf", "--with makes a mesh that .glb and .ply hold, and .pdf does not"),
    ("--with rock_rough.png -o x.ply --premultiplied", "--premultiplied is given with --with"),
    ("--with rock_rough.png -o x.ply --sprite", "--sprite is given with --with"),
    ("--with rock_rough.png -o x.glb --fit-space each", "--fit-space is given with --with"),
    ("--with rock_rough.png -o x.ply --method xie", "--with means nothing to --method xie"),
    ("--with alpha=rock_rough.png -o x.ply", "has a name that positions or colours have in files"),
    ("--with a= -o x.ply", "--with 'a=' names no file"),
    ("--with m=rock_rough.png --with M=rock_normal.png -o x.ply", "are both called 'M'"),
    ("rock_rough.png --with rock_normal.png -o {name}.ply", "--with is given for 2 images"),
    ("--with rock_rough.png -o rock_rough.png --format ply", "'rock_rough.png' would overwrite the input"),
    ("--with rock_rough.png -o x.ply --channel-weights 1,b", "has 'b', which is not a number"),
    ("--with rock_rough.png -o x.ply --channel-weights 0,0", "has no weight above 0"),
    ("-o x.ply --channel-weights balanced", "--channel-weights balanced is given without --with"),
    ("--with rock_rough.png -o x.ply --channel-weights balanced --psnr 30", "leave one of them out"),
    ("--with rock_rough.png -o x.ply --channel-weights 1,,1", "has '', which is not a number"),
    ("--with rock_rough.png --render - -o x.ply", "--render - names one")])
def test_wrong_usage_of_maps_is_refused(maps, arguments, sentence):
    run = maps.run("rock_albedo.png " + arguments)
    assert run.returncode == 2 and sentence in run.stderr, run.stderr
    assert not Path("x.ply").exists()
