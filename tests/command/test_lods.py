"""--lods: levels of detail in one .glb or in files of their own."""
import json
import re
import struct
from pathlib import Path

import pytest

from conftest import as_others, is_png, is_whole, ply_header, read


def ply_counts(name):
    header = "\n".join(ply_header(name))
    return int(re.search(r"element vertex (\d+)", header)[1]), int(re.search(r"element face (\d+)", header)[1])


def ply_points(name):
    """Positions as they are stored."""
    header, _, body = read(name).partition(b"end_header\n")
    vertices = int(re.search(rb"element vertex (\d+)", header)[1])
    layout = struct.Struct(f"<3f{len(re.findall(rb'property uchar', header))}B")
    return sorted(layout.unpack_from(body, layout.size * k)[:2] for k in range(vertices))


def glb_levels(name):
    """The scene, and of each level that MSFT_lod names the positions and faces, read by the specification alone."""
    file = read(name)
    chunk, = struct.unpack_from("<I", file, 12)
    scene = json.loads(file[20:20 + chunk])
    body = 20 + chunk + 8
    first = scene["scenes"][0]["nodes"]
    assert len(first) == 1
    node = scene["nodes"][first[0]]
    levels = []
    for number in first + node.get("extensions", {}).get("MSFT_lod", {"ids": []})["ids"]:
        primitive, = scene["meshes"][scene["nodes"][number]["mesh"]]["primitives"]

        def numbers(accessor, width):
            accessor = scene["accessors"][accessor]
            view = scene["bufferViews"][accessor["bufferView"]]
            row = struct.Struct(f"<{width}{ {5123: 'H', 5125: 'I', 5126: 'f'}[accessor['componentType']] }")
            at = body + view.get("byteOffset", 0)
            return [row.unpack_from(file, at + k * view.get("byteStride", row.size)) for k in range(accessor["count"])]

        indices = [n for n, in numbers(primitive["indices"], 1)]
        levels.append((numbers(primitive["attributes"]["POSITION"], 3), [indices[k:k + 3] for k in range(0, len(indices), 3)]))
    return scene, levels


def test_a_glb_holds_all_levels_and_other_formats_have_a_file_for_each(hmesh):
    out = hmesh.done("picture.png --vertices 120 --lods 3 -o x.glb -o y.ply --render r.png --report report.json")
    files = ["x.glb", "y.ply", "y_lod1.ply", "y_lod2.ply", "r.png", "report.json"]
    assert re.findall(r"^written +(.*)$", out, re.M) == files
    assert all(is_whole(name) for name in files[:4]) and is_png("r.png", (96, 64))
    assert [ply_counts(name)[0] for name in files[1:4]] == [120, 60, 30]
    scene, levels = glb_levels("x.glb")
    assert "MSFT_lod" in scene["extensionsUsed"] and "extensionsRequired" not in scene
    assert scene["nodes"][0]["extensions"] == {"MSFT_lod": {"ids": [1, 2]}}
    assert scene["nodes"][0]["extras"] == {"MSFT_screencoverage": [0.5, 0.25, 0]}
    report = json.loads(read("report.json"))
    for level, name, (positions, faces) in zip(report["levels"], files[1:4], levels):
        assert (level["vertices"], level["faces"]) == (len(positions), len(faces)) == ply_counts(name)
        assert sorted(p[:2] for p in positions) == ply_points(name)
        area = sum((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                   for a, b, c in ([positions[v] for v in face] for face in faces))
        assert area == pytest.approx(2 * 96 * 64)  # they tile the picture, counter-clockwise
    assert [level["files"] for level in report["levels"]] == [["x.glb", "y.ply"], ["y_lod1.ply"], ["y_lod2.ply"]]
    assert report["levels"][0]["psnr"] == report["psnr"]
    for k in (1, 2):
        level = report["levels"][k]
        assert level["psnr"] < report["levels"][k - 1]["psnr"]
        assert re.search(rf"^level {k}   {level['vertices']} vertices, {level['faces']} faces, {level['psnr']:.2f} dB$", out, re.M)


def test_the_first_level_is_the_mesh_without_levels(hmesh):
    hmesh.done("picture.png --vertices 100 -o one.ply -q")
    hmesh.done("picture.png --vertices 100 --lods 1 -o same.ply -o same.glb -q")
    hmesh.done("picture.png --vertices 100 --lods 4 -o many.ply -q")
    assert read("one.ply") == read("same.ply") == read("many.ply")
    assert "MSFT_lod" not in json.dumps(glb_levels("same.glb")[0])


def test_lod_in_a_name_is_the_number_of_the_level(hmesh):
    hmesh.done("picture.png row.pgm grey.pgm --rate 10 --lods 1 -o {name}/{lod}.obj")
    hmesh.done("picture.png grey.pgm --rate 10 --lods 2 -o out/{name}/lod{lod}/mesh.glb -o {lod}_{name}.html")
    for name in ("picture", "grey"):
        for lod in (0, 1):
            assert is_whole(f"out/{name}/lod{lod}/mesh.glb") and is_whole(f"{lod}_{name}.html")
            assert len(glb_levels(f"out/{name}/lod{lod}/mesh.glb")[1]) == 1
    assert len(glb_levels("out/grey/lod1/mesh.glb")[1][0][0]) == 16  # of 32
    assert is_whole("row/0.obj")
    hmesh.done("grey.pgm --rate 10 --lods 2 -o levels/{lod}.ply -q")
    assert is_whole("levels/0.ply") and is_whole("levels/1.ply")
    hmesh.done("grey.pgm --rate 10 --lods 2 -o steps/{lod}/x.ply -q")
    assert is_whole("steps/0/x.ply") and is_whole("steps/1/x.ply")


def test_no_folder_is_made_of_a_name_that_stands_for_another(hmesh):
    """Not even for a while: where nothing may be made, what is there is written into."""
    Path("locked/picture").mkdir(parents=True)
    Path("locked").chmod(0o555)
    run = hmesh.run("../picture.png --vertices 50 --lods 2 -o {name}/{lod}.ply -q", cwd="locked", preexec_fn=as_others)
    assert (run.returncode, run.stderr) == (0, "")
    assert is_whole("locked/picture/0.ply") and is_whole("locked/picture/1.ply")


def test_all_kinds_of_images_and_fits_have_levels(hmesh):
    for image, options in [("rgba.tga", "--premultiplied"), ("rgba.tga", "--fit-space each"), ("color16.ppm", "--fit-space linear"),
                           ("picture.png", "--psnr 22"), ("grey_alpha.tga", "--effort draft"),
                           ("picture.png", "--with r=grey_of_picture.png --glb packed")]:
        if "grey_of" in options:
            from PIL import Image
            Image.open("picture.png").convert("L").save("grey_of_picture.png")
        hmesh.done(f"{image} {options} {'' if 'psnr' in options else '--vertices 60'} --lods 3 -o x.glb -q")
        assert len(glb_levels("x.glb")[1]) == 3 if "packed" not in options else is_whole("x.glb")


def test_a_line_tells_the_levels_of_one_of_several_images(hmesh):
    out = hmesh.done("picture.png grey.pgm --rate 10 --lods 2 -o {name}.ply")
    for name, vertices in [("picture.png", 614), ("grey.pgm", 32)]:
        assert re.search(rf"^{name}: {vertices} vertices, [0-9.]+ dB \(levels: {vertices // 2} vertices, [0-9.]+ dB\), ", out, re.M)
    assert re.search(r"written picture.ply, picture_lod1.ply$", out, re.M)


def test_the_depfile_names_the_files_of_all_levels(hmesh):
    hmesh.done("picture.png --vertices 50 --lods 2 -o x.ply -o x.glb --depfile x.d -q")
    assert read("x.d").split(b":")[0].split() == [b"x.ply", b"x_lod1.ply", b"x.glb"]


@pytest.mark.parametrize("options, sentence", [
    ("--lods 0 -o x.ply", "--lods '0' must be from 1 to 32"), ("--lods 33 -o x.ply", "--lods '33' must be from 1 to 32"),
    ("--lods x -o x.ply", "--lods 'x'"), ("--lods 2 -o - --format ply", "--output - is one"),
    ("-o x{lod}.ply", "without --lods"), ("--lods 2 --method xie -o x.ply", "means nothing to --method xie"),
    ("--lods 2 --keep-partial -o x.ply", "--keep-partial is given with --lods"),
    ("--lods 2 -o x.ply -o x_lod1.ply", "named for two outputs")])
def test_nonsense_is_refused(hmesh, options, sentence):
    before = sorted(Path().iterdir())
    run = hmesh.run("picture.png " + options)
    assert run.returncode == 2 and sentence in run.stderr and re.fullmatch(r"hmesh: [^\n]*\n(.*\n)*", run.stderr)
    assert sorted(Path().iterdir()) == before


def test_levels_that_were_not_made_are_not_said_to_be_written(hmesh):
    run = hmesh.run("grey.pgm --samples points --border-tolerance 0 --vertices 200 --lods 4 -o x.ply")
    said = [line.split()[-1] for line in run.stdout.splitlines() if line.startswith("written")]
    assert run.returncode == 1 and 0 < len(said) < 4 and sorted(said) == sorted(str(file) for file in Path().glob("x*.ply"))


def test_more_levels_than_vertices_allow_are_refused_and_nothing_is_written(hmesh):
    for target in ("--vertices 31", "--rate 0.5"):  # of 6144 pixels: 31
        hmesh.fails("'picture.png': --lods 4 is too many for 31 vertices: a mesh has at least 4, and level 3 would have 3; at most "
                    "--lods 3", f"picture.png {target} --lods 4 -o x.ply")
    hmesh.fails("is too many for", "picture.png --psnr 15 --lods 12 -o x.ply")
    assert not Path("x.ply").exists()
    hmesh.done("picture.png --vertices 32 --lods 4 -o x.ply -q")
    assert ply_counts("x_lod3.ply")[0] == 4


def test_a_glb_of_levels_goes_to_the_standard_output(hmesh):
    run = hmesh.run("picture.png --vertices 60 --lods 2 -o - --format glb", stdout=open("x.glb", "wb"))
    assert run.returncode == 0 and len(glb_levels("x.glb")[1]) == 2
