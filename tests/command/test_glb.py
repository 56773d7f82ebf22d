"""How .glb files hold the mesh: exactly, packed, or compressed."""
import json
import math
import random
import re
import struct
from pathlib import Path

import pytest
from PIL import Image

from conftest import read
from glb import Glb


def corners(file):
    """The faces as places and colours, in no order; each from its least corner on, so that its orientation counts."""
    faces = []
    for face in file.faces:
        face = [(file.places[v], file.attributes["COLOR_0"][v]) for v in face]
        first = face.index(min(face))
        faces.append(tuple(face[first:] + face[:first]))
    return sorted(faces)


def has_meshopt(hmesh):
    return "--glb meshopt" in hmesh.done("--version")


def test_a_packed_file_holds_the_same_mesh_in_fewer_bytes(hmesh):
    hmesh.done("picture.png --vertices 300 -o exact.glb -q")
    hmesh.done("picture.png --vertices 300 -o packed.glb --glb packed -q")
    exact, packed = Glb("exact.glb"), Glb("packed.glb")
    assert packed.json["extensionsRequired"] == ["KHR_mesh_quantization"]
    assert len(read("packed.glb")) < len(read("exact.glb")) - 4 * 300 + 100
    # Of the image's 96 px a position is exact, and the scale has nine digits.
    for a, b in zip(corners(exact), corners(packed)):
        for (place, color), (other, same) in zip(a, b):
            assert color == same and place == pytest.approx(other, abs=1e-8)


def test_a_packed_file_of_many_vertices_numbers_them_with_16_bits(hmesh):
    Image.frombytes("L", (280, 250), random.Random(1).randbytes(280 * 250)).save("noise.png")
    hmesh.done("noise.png --vertices 66000 --effort draft --grid 128 -o exact.glb -q")
    hmesh.done("noise.png --vertices 66000 --effort draft --grid 128 -o packed.glb --glb packed -q")
    exact, packed = Glb("exact.glb"), Glb("packed.glb")
    kinds = [[file.json["accessors"][primitive["indices"]]["componentType"] for primitive in file.json["meshes"][0]["primitives"]]
             for file in [exact, packed]]
    assert kinds == [[5125], [5123, 5123]]
    # 280 px are 35,840 steps of 1/128 px: nothing is rounded, so that there are no cracks between the parts.
    for file in [exact, packed]:
        file.places = [(round(x * 35840), round(y * 35840)) for x, y, _ in file.places]
    assert len(exact.faces) > 120000 and corners(exact) == corners(packed)
    assert len(packed.places) < 66000 + 1000


def test_vertices_of_a_packed_file_come_in_the_order_in_which_faces_name_them(hmesh):
    hmesh.done("picture.png --vertices 300 -o packed.glb --glb packed -q")
    seen = []
    for v in [v for face in Glb("packed.glb").faces for v in face]:
        if v not in seen:
            seen.append(v)
    assert seen == list(range(300))


@pytest.mark.parametrize("bits", [8, 16])
def test_a_compressed_file_holds_what_a_packed_one_does(hmesh, bits):
    if not has_meshopt(hmesh):
        assert "meshoptimizer" in hmesh.run("picture.png -o small.glb --glb meshopt").stderr
        pytest.skip("this hmesh was built without meshoptimizer")
    for form in ["packed", "meshopt"]:
        hmesh.done(f"picture.png --vertices 300 -o {form}.glb --glb {form} --glb-bits {bits} -q")
    packed, compressed = Glb("packed.glb"), Glb("meshopt.glb")
    assert compressed.json["extensionsRequired"] == ["KHR_mesh_quantization", "EXT_meshopt_compression"]
    assert corners(compressed) == corners(packed)
    assert len(read("meshopt.glb")) - 20 - len(json.dumps(compressed.json)) < (10.5 if bits == 8 else 14) * 300


def test_colours_of_8_bits_are_those_of_16_rounded(hmesh):
    for bits in [8, 16]:
        hmesh.done(f"picture.png --vertices 100 -o {bits}.glb --glb-bits {bits} -q")
    fine, coarse = Glb("16.glb").attributes["COLOR_0"], Glb("8.glb").attributes["COLOR_0"]
    assert fine != coarse and len(coarse) == 100
    for a, b in zip(fine, coarse):
        assert b == pytest.approx(a, abs=0.5 / 255 + 1 / 65535)


def test_the_psnr_of_a_file_with_colours_of_8_bits_is_told(hmesh):
    report = hmesh.report("picture.png --vertices 600 -o mesh.glb --glb-bits 8")
    assert report["psnr_written"]["mesh.glb"] < report["psnr"] - 0.001
    assert report["psnr_written"]["mesh.glb"] > report["psnr"] - 1
    assert re.search(r"^PSNR +[0-9.]+ dB as mesh.glb holds it, colours of 8 bits$",
                     hmesh.done("picture.png --vertices 600 -o mesh.glb --glb-bits 8"), re.M)


@pytest.mark.parametrize("width, steps", [(255, 256), (256, 128), (512, 64)])
def test_positions_of_a_packed_file_are_exact_whatever_the_size(hmesh, width, steps):
    Image.open("picture.png").resize((width, 32), Image.BICUBIC).save("strip.png")
    hmesh.done("strip.png --vertices 200 -o mesh.glb --glb packed -o mesh.ply -q")
    node = Glb("mesh.glb").json["nodes"][0]
    assert node["scale"][0] == pytest.approx(1 / steps / width, rel=1e-8)
    assert all(float(x).is_integer() for place in Glb("mesh.glb").attributes["POSITION"] for x in place)
    body = read("mesh.ply").partition(b"end_header\n")[2]
    at = [struct.unpack_from("<2f", body, 15 * i) for i in range(200)]
    assert all((x * steps).is_integer() and (y * steps).is_integer() for x, y in at)
    # Places of the two files, as sets.
    places = {(round(x * width * steps), round(y * width * steps)) for x, y, _ in Glb("mesh.glb").places}
    assert places == {(round(x * steps), round(y * steps)) for x, y in at}


def test_positions_of_an_image_of_more_than_65535_quarters_of_a_pixel_are_rounded_to_as_many_steps(hmesh):
    Path("long.pgm").write_bytes(b"P5 20000 3 255\n" + bytes((x * x // 977 + 40 * y) % 256 for y in range(3) for x in range(20000)))
    hmesh.done("long.pgm --vertices 200 --effort draft -o mesh.glb --glb packed -o mesh.ply -q")
    body = read("mesh.ply").partition(b"end_header\n")[2]
    at = [struct.unpack_from("<2f", body, 13 * i) for i in range(200)]
    assert all((x * 4).is_integer() and (y * 4).is_integer() for x, y in at)
    file, step = Glb("mesh.glb"), 20000 / 65535
    assert file.json["nodes"][0]["scale"][0] == pytest.approx(1 / 65535, rel=1e-8)
    places = {tuple(round(x * 65535) for x in place[:2]) for place in file.places}
    assert places == {(math.floor(x / step + 0.5), math.floor(y / step + 0.5)) for x, y in at}
    assert max(x for x, _ in places) == 65535


@pytest.mark.parametrize("steps", [4, 16, 256])
def test_positions_lie_on_the_grid_asked_for(hmesh, steps):
    hmesh.done(f"picture.png --vertices 150 -o mesh.glb --glb packed --grid {steps} -q")
    node = Glb("mesh.glb").json["nodes"][0]
    assert node["scale"][0] == pytest.approx(1 / steps / 96, rel=1e-8)


@pytest.mark.parametrize("arguments, sentence", [
    ("-o x.ply --glb packed", "--glb is given without an output that ends in .glb"),
    ("-o x.ply --glb-bits 8", "--glb-bits is given without an output that ends in .glb"),
    ("-o x.glb --glb tiny", "--glb 'tiny' is not one of: exact, packed, meshopt"),
    ("-o x.glb --glb-bits 12", "--glb-bits '12' must be 8 or 16"),
    ("-o x.glb --grid 3", "--grid '3' must be from 4 to 256"),
    ("-o x.glb --grid 100", "--grid '100' must be a power of two"),
    ("-o x.glb --grid 512", "--grid '512' must be from 4 to 256")])
def test_wrong_forms_are_refused(hmesh, arguments, sentence):
    run = hmesh.run("picture.png " + arguments)
    assert run.returncode == 2 and sentence in run.stderr
    assert not Path("x.glb").exists() and not Path("x.ply").exists()


def test_images_with_alpha_and_of_grey_are_packed_and_compressed_too(hmesh):
    for name in ["rgba.tga", "grey_alpha.tga", "grey.pgm", "one.pgm", "row.pgm", "color16.ppm"]:
        for form in ["packed", "meshopt"] if has_meshopt(hmesh) else ["packed"]:
            hmesh.done(f"{name} -o exact.glb -q")
            hmesh.done(f"{name} -o packed.glb --glb {form} -q")
            exact, packed = Glb("exact.glb"), Glb("packed.glb")
            assert len(exact.faces) == len(packed.faces)
            for a, b in zip(corners(exact), corners(packed)):
                for (place, color), (other, same) in zip(a, b):
                    assert color == same and math.dist(place, other) < 1e-7
