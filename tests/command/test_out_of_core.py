"""--out-of-core: images that are read by rectangles, with the meshes of those that are read as a whole."""
import shutil
import struct
from pathlib import Path

import pytest
from PIL import Image

from conftest import is_whole, read
from jobs import finish, tiles


def draw(name, width=150, height=90):
    """A picture of slopes and edges, in the format that the name ends in."""
    def sample(x, y, c):
        return ((x * x + 3 * y * y) // 40 + (90 if (x // 37 + y // 29 + c) % 2 else 0) + 31 * c) % 256 / 255

    channels = 3 if name.endswith(("ppm", "color.pfm")) else 1
    rows = [[sample(x, y, c) for x in range(width) for c in range(channels)] for y in range(height)]
    if name.endswith("pfm"):
        order = "<" if "little" in name else ">"
        data = b"".join(struct.pack(f"{order}{len(row)}f", *row) for row in reversed(rows))
        header = f"P{'F' if channels == 3 else 'f'}\n{width} {height}\n{'-' if order == '<' else ''}1.0\n"
    else:
        most = 1000 if "16" in name else 200 if "200" in name else 255
        data = b"".join(struct.pack(f">{len(row)}{'H' if most > 255 else 'B'}", *[round(most * s) for s in row]) for row in rows)
        header = f"P{6 if channels == 3 else 5}\n# a comment\n{width} {height} {most}\n"
    Path(name).write_bytes(header.encode() + data)


@pytest.mark.parametrize("name", ["grey.pgm", "200.ppm", "16.pgm", "16.ppm", "grey.pfm", "little_color.pfm"])
def test_the_mesh_is_that_of_the_whole_image(hmesh, name):
    draw(name)
    options = "--vertices 300 --tile 64 --effort fast"
    hmesh.done(f"{name} {options} -o whole.ply -o whole.glb")
    report = hmesh.report(f"{name} {options} --out-of-core -o read.ply -o read.glb -o read.obj --threads 2")
    assert report.items() >= {"width": 150, "height": 90, "vertices": 300, "status": "ok"}.items()
    assert read("read.ply") == read("whole.ply") and read("read.glb") == read("whole.glb")
    assert is_whole("read.obj")


def test_rows_of_tiles_of_a_large_image_are_read_in_bands(hmesh):
    draw("small.pgm")  # what is larger than 4 megapixels has tables of its tiles; 24 bands, of which 16 are kept
    Image.open("small.pgm").resize((2900, 1500), Image.BICUBIC).save("large.pgm")
    options = "large.pgm --vertices 400 --effort draft"
    hmesh.done(f"{options} -o whole.ply")
    for threads in [1, 3]:
        hmesh.done(f"{options} --out-of-core -o read.ply --threads {threads}")
        assert read("read.ply") == read("whole.ply")


def has_tiff(hmesh):
    return "TIFF: libtiff" in hmesh.done("--version")


def save_tiff(name, mode, **how):
    draw("image.ppm")
    image = Image.open("image.ppm")
    if mode in ("RGBA", "LA"):
        image.putalpha(Image.linear_gradient("L").resize(image.size))
    if mode == "I;16":
        image = Image.open("image.ppm").convert("L").convert("I").point(lambda v: v * 257).convert("I;16")
    else:
        image = image.convert(mode)
    image.save(name, **how)


@pytest.mark.parametrize("mode, how", [
    ("RGB", {}), ("RGB", {"compression": "tiff_lzw"}), ("RGB", {"compression": "tiff_deflate", "tiffinfo": {278: 7}}),
    ("L", {"compression": "packbits"}), ("RGBA", {}), ("LA", {}), ("I;16", {"tiffinfo": {278: 16}}), ("F", {}), ("CMYK", {})])
def test_tiff_files_by_strips(hmesh, mode, how):
    if not has_tiff(hmesh):
        pytest.skip("built without libtiff")
    save_tiff("image.tif", mode, **how)
    options = "image.tif --vertices 300 --tile 64 --effort draft"
    hmesh.done(f"{options} -o whole.ply")
    hmesh.done(f"{options} --out-of-core -o read.ply --threads 2")
    assert read("read.ply") == read("whole.ply")


def tiled_tiff(planes):
    """RGB of 150 x 90 px in tiles of 32 x 16, interleaved or in planes, and not compressed."""
    draw("image.ppm")
    image = Image.open("image.ppm")
    across, down = 5, 6
    parts = []
    for plane in [image] if planes == 1 else image.split():
        for j in range(down):
            for i in range(across):
                part = Image.new(plane.mode, (32, 16))
                part.paste(plane.crop((32 * i, 16 * j, min(150, 32 * i + 32), min(90, 16 * j + 16))))
                parts.append(part.tobytes())
    data, offsets = bytearray(), []
    for part in parts:
        offsets.append(8 + len(data))
        data += part
    arrays = 8 + len(data)
    count = len(parts)
    tags = [(256, 4, 1, 150), (257, 4, 1, 90), (258, 3, 3, arrays + 8 * count), (259, 3, 1, 1), (262, 3, 1, 2), (277, 3, 1, 3),
            (284, 3, 1, 1 if planes == 1 else 2), (322, 4, 1, 32), (323, 4, 1, 16), (324, 4, count, arrays),
            (325, 4, count, arrays + 4 * count)]
    data += struct.pack(f"<{2 * count}I3H", *offsets, *[len(part) for part in parts], 8, 8, 8)
    data += b"\0" * (len(data) % 2)
    directory = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *tag) for tag in tags) + struct.pack("<I", 0)
    Path("tiled.tif").write_bytes(struct.pack("<2sHI", b"II", 42, 8 + len(data)) + bytes(data) + directory)


@pytest.mark.parametrize("planes", [1, 3])
def test_tiff_files_by_tiles(hmesh, planes):
    if not has_tiff(hmesh):
        pytest.skip("built without libtiff")
    tiled_tiff(planes)
    options = "--vertices 300 --tile 64 --effort draft"
    hmesh.done(f"image.ppm {options} -o whole.ply")
    hmesh.done(f"tiled.tif {options} --out-of-core -o read.ply --threads 2")
    assert read("read.ply") == read("whole.ply")
    file = bytearray(read("tiled.tif"))  # its last tile lies beyond its end
    at = file.rindex(struct.pack("<HHI", 324, 4, 30 * planes)) + 8
    first = struct.unpack_from("<I", file, at)[0]
    struct.pack_into("<I", file, first + 4 * (30 * planes - 1), 1 << 30)
    Path("cut.tif").write_bytes(file)
    hmesh.fails("the image could not be read (columns ", f"cut.tif {options} --out-of-core -o a.ply")
    assert not Path("a.ply").exists()


def vrt(name, parts, kind="Byte", channels=3, width=150, height=90, more="", last=""):
    """A mosaic: files, each with the place of its first pixel and its size."""
    def source(k, part):
        file, x, y, w, h = part
        return (f'<SimpleSource><SourceFilename relativeToVRT="1">{file}</SourceFilename><SourceBand>{k}</SourceBand>'
                f'<SrcRect xOff="0" yOff="0" xSize="{w}" ySize="{h}"/><DstRect xOff="{x}" yOff="{y}" xSize="{w}" ySize="{h}"/></SimpleSource>')

    bands = "".join(f'<VRTRasterBand dataType="{kind}" band="{k}">{more or last * (k == channels)}{"".join(source(k, part) for part in parts)}</VRTRasterBand>'
                    for k in range(1, channels + 1))
    Path(name).write_text(f'<VRTDataset rasterXSize="{width}" rasterYSize="{height}">{bands}</VRTDataset>')


def cut(name):
    """The image as four files."""
    image = Image.open(name)
    boxes = [(0, 0, 70, 50), (70, 0, 80, 50), (0, 50, 70, 40), (70, 50, 80, 40)]
    parts = []
    for k, (x, y, w, h) in enumerate(boxes):
        image.crop((x, y, x + w, y + h)).save(f"part{k}.ppm")
        parts.append((f"part{k}.ppm", x, y, w, h))
    return parts


def needs_gdal(hmesh):
    if "by rectangles: GDAL" not in hmesh.done("--version"):
        pytest.skip("built without GDAL")


@pytest.mark.parametrize("kind", ["mosaic", "16 bits", "floats", "grey with alpha", "grey and no alpha", "JPEG 2000"])
def test_what_gdal_reads(hmesh, kind):
    needs_gdal(hmesh)
    name, whole = "image.vrt", "image.ppm"
    draw(whole)
    if kind == "mosaic":
        vrt(name, cut(whole))
    elif kind == "JPEG 2000":
        name = "image.jp2"
        Image.open(whole).save(name, irreversible=False)
    else:
        if not has_tiff(hmesh):
            pytest.skip("built without libtiff")
        whole = "image.tif"
        mode, numbers, channels = {"16 bits": ("I;16", "UInt16", 1), "floats": ("F", "Float32", 1)}.get(kind, ("LA", "Byte", 2))
        save_tiff(whole, mode)
        vrt(name, [(whole, 0, 0, 150, 90)], numbers, channels, last="<ColorInterp>Alpha</ColorInterp>" * (kind == "grey with alpha"))
        if kind == "grey and no alpha":
            Image.open(whole).getchannel("L").save("grey.tif")
            whole = "grey.tif"
    options = "--vertices 300 --tile 64 --effort draft"
    hmesh.done(f"{whole} {options} --out-of-core -o whole.ply")
    hmesh.done(f"{name} {options} --out-of-core -o read.ply --threads 2")
    assert read("read.ply") == read("whole.ply")


def test_what_gdal_reads_and_is_no_image_is_refused(hmesh):
    needs_gdal(hmesh)
    draw("image.ppm")
    parts = cut("image.ppm")
    vrt("five.vrt", parts, channels=5)
    vrt("signed.vrt", parts, "Int16")
    vrt("palette.vrt", parts, channels=1, more="<ColorInterp>Palette</ColorInterp><ColorTable><Entry c1='1' c2='2' c3='3' c4='255'/></ColorTable>")
    vrt("wide.vrt", parts, width=70000)
    vrt("broken.vrt", parts)
    Path("part2.ppm").write_bytes(read("part2.ppm")[:100])
    Path("bad.vrt").write_text("<VRTDataset rasterXSize='9'")
    for name, sentence in {"five": "it has 5 bands, and images have 1 to 4", "signed": "its samples are Int16", "bad": "GDAL says: ",
                           "palette": "numbers of a palette", "wide": "the image is too wide (70000, limit 65536)",
                           "broken": "the image could not be read (columns "}.items():
        hmesh.fails(sentence, f"{name}.vrt --vertices 300 --effort draft --out-of-core -o a.ply")
    assert not Path("a.ply").exists()


def test_a_job_of_a_mosaic_is_that_of_the_image(hmesh):
    needs_gdal(hmesh)
    draw("image.ppm")
    vrt("image.vrt", cut("image.ppm"))
    for name, folder in [("image.ppm", "whole"), ("image.vrt", "job")]:
        hmesh.done(f"job plan {name} -o {folder} --vertices 900 --tile 64 --effort draft -q")
        finish(hmesh, folder)
    names = {name for name in tiles("whole/tiles") if name != "index.json"}
    assert len(names) == 6 and all(tiles("job/tiles")[name] == tiles("whole/tiles")[name] for name in names)


def test_weights_and_points_are_known(hmesh):
    draw("image.ppm")
    Image.linear_gradient("L").resize((150, 90)).save("weights.png")
    options = "image.ppm --vertices 200 --samples points --weights weights.png --channel-weights 1,2,3 --effort draft"
    hmesh.done(f"{options} -o whole.ply")
    hmesh.done(f"{options} --out-of-core -o read.ply")
    assert read("read.ply") == read("whole.ply")


def test_what_cannot_be_read_by_rectangles_is_refused(hmesh):
    hmesh.fails("it is no PGM, PPM, PFM or TIFF file, but PNG, which is not read by rectangles", "picture.png --out-of-core -o a.ply")
    hmesh.fails("it is no PGM, PPM, PFM or TIFF file, and ", "text.png --out-of-core -o a.ply")
    hmesh.done("grey.pgm -o a.hmc")
    shutil.copy("a.hmc", "b")  # known by its content
    assert hmesh.run("a.hmc --out-of-core -o a.ply").stderr.startswith(
        "hmesh: --out-of-core means nothing to 'a.hmc', which is a mesh and no image\n")
    hmesh.fails("cannot read 'b': it is a mesh, and no image", "b --out-of-core -o a.ply")
    hmesh.fails("No such file", "none.pgm --out-of-core -o a.ply")
    hmesh.fails("it cannot be read by rectangles, as a file can", "- --out-of-core -o a.ply")
    hmesh.fails("the file ends before its last pixel", "short.ppm --out-of-core -o a.ply")
    hmesh.fails("the image is too wide (99999999, limit 65536)", "huge.pgm --out-of-core -o a.ply")
    assert not Path("a.ply").exists()


@pytest.mark.parametrize("name", ["grey.pgm", "16.ppm", "grey.pfm"])
def test_a_header_is_looked_for_in_the_first_65536_bytes(hmesh, name):
    draw(name)
    file = read(name)
    Path(name).write_bytes(file[:2] + b"\n#" + b"x" * 60000 + file[2:])
    for out_of_core in ["", "--out-of-core"]:
        hmesh.done(f"{name} --vertices 100 --effort draft {out_of_core} -o a.ply")
    Path(name).write_bytes(file[:2] + b"\n#" + b"x" * 65536 + file[2:])
    hmesh.done(f"{name} --vertices 100 --effort draft -o a.ply")
    hmesh.fails("its header does not end within 65536 bytes", f"{name} --vertices 100 --out-of-core -o a.ply")


def test_a_sample_that_cannot_be_ends_the_work_with_its_rectangle(hmesh):
    hmesh.fails("the image could not be read (columns 0 to 1 of rows 0 to 1): it has a sample above the maximum of its PNM header",
                "above.pgm --out-of-core -o a.ply")
    assert not Path("a.ply").exists()


def test_fewer_vertices_may_be_good_enough(hmesh):
    draw("image.ppm")
    for ways in ["--rate 10 --good-enough 20", "--vertices 300 --good-enough 25", "--max-vertices 300"]:
        whole, parts = (hmesh.done(f"image.ppm -o {name}.ply --effort fast {ways}{more}") for name, more in
                        [("whole", ""), ("parts", " --out-of-core")])
        assert Path("whole.ply").read_bytes() == Path("parts.ply").read_bytes()
        assert "vertices  300" not in parts or "--max" in ways


@pytest.mark.parametrize("option", ["--psnr 30", "--render a.png", "--lods 3", "--sprite", "--method adams", "--strip a.png",
                                    "--fit-space each", "--premultiplied", "-o a.svg", "--with b.png", "--keep-partial",
                                    "--outline", "--wireframe a.png", "--residual a.png", "-o a.glb --glb-bits 8"])
def test_options_that_want_the_whole_image_are_refused(hmesh, option):
    draw("image.ppm")
    run = hmesh.run(f"image.ppm --out-of-core -o a.ply {option}")
    assert run.returncode == 2 and "--out-of-core" in run.stderr and not Path("a.ply").exists()
