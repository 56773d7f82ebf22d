"""Image files: which are read, as what, and what is said of those that are not whole."""
import io
import json
import os
import re
import struct
from pathlib import Path

import pytest
from PIL import Image

import images
from conftest import is_failure, rows

# Name, channels, bits, and by how much of 255 colours may differ from those that images.py draws.
WHOLE = rows("""
    rgb.png         | 3 |  8 |  0
    grey.png        | 1 |  8 |  1
    alpha.png       | 4 |  8 |  1
    rgb16.png       | 3 | 16 |  1
    grey16.png      | 1 | 16 | -1
    palette.png     | 3 |  8 | -1
    bits.png        | 1 |  8 | -1
    exif.png        | 3 |  8 |  0
    key.png         | 4 |  8 | -1
    key16.png       | 2 | 16 | -1
    rgb.jpg         | 3 |  8 | 60
    grey.jpg        | 1 |  8 | 20
    progressive.jpg | 3 |  8 | 60
    cmyk.jpg        | 3 |  8 | 20
    exif.jpg        | 3 |  8 | 60
    rgb.bmp         | 3 |  8 |  0
    alpha.bmp       | 4 |  8 |  1
    palette.bmp     | 3 |  8 | 40
    bits.bmp        | 3 |  8 | -1
    top_down.bmp    | 3 |  8 |  0
    masks.bmp       | 3 |  8 |  0
    alpha_mask.bmp  | 4 |  8 | -1
    gap.bmp         | 3 |  8 |  0
    masks_gap.bmp   | 3 |  8 |  0
    long_gap.bmp    | 3 |  8 |  0
    palette_gap.bmp | 3 |  8 | 40
    os2.bmp         | 3 |  8 |  0
    rgb.tga         | 3 |  8 |  0
    bits15.tga      | 3 |  8 |  7
    bits16.tga      | 3 |  8 |  7
    runs.tga        | 3 |  8 |  0
    alpha.tga       | 4 |  8 |  1
    zeros.tga       | 3 |  8 |  0
    palette.tga     | 3 |  8 | 40
    grey.tga        | 1 |  8 |  1
    rgb.gif         | 3 |  8 | 40
    animated.gif    | 3 |  8 | 40
    interlaced.gif  | 3 |  8 | 40
    raw.psd         | 3 |  8 |  0
    runs.psd        | 3 |  8 |  0
    deep.psd        | 3 | 16 |  0
    alpha.psd       | 4 |  8 | -1
    cmyk.psd        | 3 |  8 |  1
    deep_runs.psd   | 3 | 16 |  0
    rgb.ppm         | 3 |  8 |  0
    grey.pgm        | 1 |  8 |  1
    deep.pgm        | 1 | 16 | -1
    rgb.pfm         | 3 | 32 |  1
    grey.pfm        | 1 | 32 | -1
    rgb.hdr         | 3 | 32 |  1
    flat.hdr        | 3 | 32 |  1
    crlf.hdr        | 3 | 32 |  1
    rgb.tif         | 3 |  8 |  0
    rgb16.tif       | 3 | 16 |  1
    big_endian.tif  | 3 | 16 |  1
    float.tif       | 3 | 32 |  1
    grey_float.tif  | 1 | 32 | -1
    cmyk.tif        | 3 |  8 |  1
    palette.tif     | 3 |  8 | 40
    bits.tif        | 1 |  8 | -1
    fax.tif         | 1 |  8 | -1
    alpha.tif       | 4 |  8 |  1
    turned.tif      | 3 |  8 |  0
    lzw.tif         | 3 |  8 |  0
    deflate.tif     | 3 |  8 |  0
    packbits.tif    | 3 |  8 |  0
    jpeg.tif        | 3 |  8 | 70
    rgb.webp        | 3 |  8 | 60
    lossless.webp   | 3 |  8 |  0
    alpha.webp      | 4 |  8 |  1
    exif.webp       | 3 |  8 |  0
    animated.webp   | 3 |  8 |  0
    """)
FILES = images.all_files()
LIBRARIES = {"tif": ("TIFF", "libtiff"), "webp": ("WebP", "libwebp")}


def put(name):
    if name not in FILES:
        pytest.skip("Pillow does not write it here")
    Path(name).write_bytes(FILES[name])


def reads(hmesh, name):
    """Whether this build does."""
    needed = LIBRARIES.get(name.rpartition(".")[2])
    return needed is None or f"\n  {needed[0]}: " in hmesh.done("--version")


def skip_unless_read(hmesh, name):
    if not reads(hmesh, name):
        pytest.skip("this build does not read it")


def test_every_file_that_is_drawn_here_is_in_the_table():
    assert set(FILES) <= {name for name, *_ in WHOLE}


@pytest.mark.parametrize("name, channels, bits, most", WHOLE)
def test_a_picture_has_the_channels_bits_and_colors_of_its_file(hmesh, name, channels, bits, most):
    put(name)
    if not reads(hmesh, name):
        hmesh.fails(f"this hmesh was built without {LIBRARIES[name.rpartition('.')[2]][1]}", f"{name} -o x.ply")
        return
    report = hmesh.report(f"{name} --effort draft --vertices 8 --strip strip.png")
    turned = name.rpartition(".")[0] in ("exif", "turned")
    size = images.SIZE[::-1] if turned else images.SIZE
    assert (report["channels"], report["bits"], report["width"], report["height"]) == (int(channels), int(bits), *size)
    if int(most) < 0:
        return
    expected = images.picture("RGBA") if channels == "4" else images.picture("L" if channels == "1" else "RGB").convert("RGB")
    if bits == "32":  # 128 is 1, and all above
        expected = expected.point(lambda sample: min(255, (sample * 255 + 64) // 128))
    if channels == "4":
        expected = Image.alpha_composite(Image.new("RGBA", size, "white"), expected).convert("RGB")
    if turned:
        expected = expected.transpose(Image.Transpose.ROTATE_270)
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, *size))
    assert max(abs(a - b) for p, q in zip(seen.getdata(), expected.getdata()) for a, b in zip(p, q)) <= int(most)


@pytest.mark.parametrize("share", [0.2, 0.6, 0.9])
@pytest.mark.parametrize("name", sorted(FILES))
def test_a_file_that_is_cut_is_refused(hmesh, name, share):
    skip_unless_read(hmesh, name)
    whole = FILES[name]
    if name.endswith(".tga") and whole.endswith(b"TRUEVISION-XFILE.\0"):
        whole = whole[:-26]  # its footer, behind the pixels
    cut = Path("cut." + name.rpartition(".")[2])
    cut.write_bytes(whole[: int(len(whole) * share)])
    run = hmesh.run(f"{cut} -o x.ply")
    is_failure(run, f"cannot read '{cut}': ")
    assert "outofdata" not in run.stderr
    assert not Path("x.ply").exists()


@pytest.mark.parametrize("kind", [1, 2, 3, 9, 10])
def test_a_cut_tga_is_refused_whatever_the_memory_held(hmesh, kind):
    map_ = bytes(range(96)) if kind in (1, 9) else b""
    bits, size = (24, 3) if kind in (2, 10) else (8, 1)
    pixel = bytes([5] * size)
    whole = (bytes([127]) + pixel * 128) * 4 if kind > 8 else pixel * images.WIDTH * images.HEIGHT
    for length in [0, 1, 100, len(whole) // 2 if kind < 8 else 300]:
        Path("t.tga").write_bytes(images.tga(bits, kind, color_map=map_, pixels=whole[:length]))
        sentences = {hmesh.run("t.tga", env={**os.environ, "MALLOC_PERTURB_": fill}).stderr for fill in ["1", "85", "254"]}
        assert len(sentences) == 1 and "the file ends before its last pixel (" in sentences.pop()


def sized(width, height):
    """Headers that are whole, of pictures without pixels."""
    return {
        "png": images.png(size=(width, height), lines=[b""]), "ppm": b"P6 %d %d 255\n" % (width, height),
        "pfm": b"PF %d %d -1\n" % (width, height), "hdr": images.hdr(f"-Y {height} +X {width}"),
        "bmp": struct.pack("<2sIIIIiiHHIIIIII", b"BM", 0, 0, 54, 40, width, height, 1, 24, 0, 0, 0, 0, 0, 0),
        "psd": struct.pack(">4sH6xHIIHH", b"8BPS", 1, 3, height, width, 8, 3) + bytes(14),
        "tif": images.tiff(bytes(10), 8, 2, size=(1, 1), strip=10, more={256: (4, [width]), 257: (4, [height]), 278: (4, [height])}.items()),
    }


@pytest.mark.parametrize("kind", sorted(sized(1, 1)))
def test_a_picture_that_is_too_large_is_refused_by_its_header(hmesh, kind):
    small_memory = hmesh.within_memory(1 << 29)
    for (width, height), why in {(70000, 10): "the image is too wide (70000, limit 65536)",
                                 (10, 70000): "the image is too high (70000, limit 65536)",
                                 (60000, 60000): "the image has too many pixels (3600000000, limit 268435456)"}.items():
        file = Path(f"large.{kind}")
        file.write_bytes(sized(width, height)[kind])
        os.truncate(file, 1 << 30)  # not read: there is less memory
        hmesh.fails(f"'{file}': {why}", f"{file} -o x.ply", **small_memory)


def test_a_header_that_asks_for_more_than_the_file_can_hold_is_refused(hmesh):
    for kind, file in sized(16000, 16000).items():
        Path(f"empty.{kind}").write_bytes(file)
        hmesh.fails(f"'empty.{kind}'", f"empty.{kind} -o x.ply")


def damaged_files():
    """Sentence and bytes."""
    rgb = FILES["rgb.png"]
    flipped = bytearray(rgb)
    flipped[60] ^= 16
    no_end = FILES["rgb.jpg"][:-2]
    corrupt = bytearray(FILES["grey.jpg"])
    corrupt[-60:-2] = bytes(58)
    bmp = bytearray(FILES["palette.bmp"])
    first = struct.unpack_from("<I", bmp, 10)[0]
    small = bytes(bmp[:54]) + bytes(bmp[54:62]) + bytes(bmp[first:])  # two colours are left
    gif = FILES["rgb.gif"]
    hdr = FILES["rgb.hdr"].replace(b"rle_rgbe", b"rle_xyze")
    return {
        "flipped.png": ("libpng refuses it|check sum", bytes(flipped)), "colors.png": ("palette", images.png_palette(2)),
        "no_end.jpg": ("libjpeg refuses it: Premature end|end marker", no_end),
        "small.bmp": ("its palette has 2", small[:10] + struct.pack("<I", 62) + small[14:]),
        "mask.bmp": ("bits a pixel", FILES["rgb.bmp"][:28] + b"\x07" + FILES["rgb.bmp"][29:]),
        "runs.tga": ("a run beyond its last pixel", images.tga(24, 10, pixels=b"\xff\1\2\3" * 4)),
        "color.tga": ("a pixel of colour 9, and its colour map has 2", images.tga(8, 1, color_map=bytes(6), pixels=b"\x09" * 432)),
        "no_trailer.gif": ("the file ends before its trailer", gif[:-1]),
        "mode.psd": ("its PSD colour mode is 9, and hmesh reads 1, 3 and 4", images.psd(mode=9)),
        "xyz.hdr": ("'32-bit_rle_xyze'", hdr), "nan.pfm": ("NaN", b"PF 2 2 -1\n" + struct.pack("<12f", *[float("nan")] * 12)),
        "unknown.heic": ("in no format that hmesh reads", b"\0\0\0\x18ftypheic" + bytes(40)),
        "zero.pgm": ("no maximum from 1 to 65535", b"P5 2 2 0\n" + bytes(4)),
        "deep.pgm": ("no maximum from 1 to 65535", b"P5 2 2 65536\n" + bytes(8)),
        "tight.pgm": ("its PNM header does not end in white space", b"P5 2 2 255#" + bytes(4)),
        "byte.pgm": (r"the file ends before its last pixel \(14 of 15 bytes\)", b"P5 2 2 255\nabc"),
        "zero.pfm": ("no scale other than 0", b"Pf 2 2 0\n" + bytes(16)),
        "unit.pfm": ("no scale other", b"Pf 2 2 1x\n" + bytes(16)),
        "tight.pfm": ("its PFM header does not end in white space", b"Pf 2 2 -1." + b"0" * 40 + b"\n" + bytes(16)),
        "some.pam": ("PNM file of the kind P7, of which", b"P7\nWIDTH 1\nHEIGHT 1\n"),
        "two.tif": ("it has 2 samples a pixel, and its colours need 3", images.tiff(bytes(864), 8, 2, 2)),
        "text.ppm": ("it is a PNM file of the kind P3, of which hmesh reads P5, P6, Pf and PF", b"P3\n1 1\n255\n1 2 3\n"),
        "signed.tif": ("its samples have 16 bits and a sign", images.tiff(bytes(2592), 16, 2, more={339: (3, [2] * 3)}.items())),
        "long.tif": ("its samples have 32 bits", images.tiff(bytes(5184), 32, 2)),
        "codes.tif": ("libtiff refuses it", images.tiff(bytes(600), 8, 2, more={259: (3, [5])}.items())),
    }


@pytest.mark.parametrize("name", sorted(damaged_files()))
def test_what_is_wrong_with_a_file_is_named(hmesh, name):
    skip_unless_read(hmesh, name)
    why, content = damaged_files()[name]
    Path(name).write_bytes(content)
    run = hmesh.run(f"{name} -o x.ply --vertices 4")
    is_failure(run, f"'{name}'")
    assert re.search(why, run.stderr), run.stderr


def test_rows_from_right_to_left_are_turned(hmesh):
    Path("left.tga").write_bytes(images.tga(descriptor=0x30))
    hmesh.done("left.tga --vertices 4 --effort draft --strip strip.png")
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, *images.SIZE))
    assert list(seen.getdata()) == list(images.picture().transpose(Image.Transpose.FLIP_LEFT_RIGHT).getdata())


@pytest.mark.parametrize("layout, turn", [
    (f"+Y {images.HEIGHT} +X {images.WIDTH}", Image.Transpose.FLIP_TOP_BOTTOM),
    (f"-Y {images.HEIGHT} -X {images.WIDTH}", Image.Transpose.FLIP_LEFT_RIGHT),
    (f"+X {images.HEIGHT} -Y {images.WIDTH}", Image.Transpose.TRANSPOSE),
    (f"-X {images.HEIGHT} -Y {images.WIDTH}", Image.Transpose.ROTATE_270),
    (f"+X {images.HEIGHT} +Y {images.WIDTH}", Image.Transpose.ROTATE_90)])
def test_a_radiance_file_says_where_its_rows_lie(hmesh, layout, turn):
    Path("x.hdr").write_bytes(images.hdr(layout))
    hmesh.done("x.hdr --vertices 4 --effort draft --strip strip.png")
    expected = images.picture().point(lambda sample: min(255, (sample * 255 + 64) // 128)).transpose(turn)
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, *expected.size))
    assert max(abs(a - b) for p, q in zip(seen.getdata(), expected.getdata()) for a, b in zip(p, q)) <= 1


def test_a_cmyk_jpeg_without_the_marker_of_adobe_has_inks_that_are_not_inverted(hmesh):
    whole = FILES["cmyk.jpg"]
    marker = whole.index(b"\xff\xee\0\x0eAdobe")
    Path("plain.jpg").write_bytes(whole[:marker] + whole[marker + 16:])
    if "libjpeg" not in hmesh.done("--version"):
        hmesh.fails("it is CMYK without Adobe's marker, and this hmesh was built without libjpeg", "plain.jpg -o x.ply")
        return
    hmesh.done("plain.jpg --effort draft --vertices 8 --strip strip.png")
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, *images.SIZE))
    inks = Image.open(io.BytesIO(whole)).getdata()  # of the file with the marker: 255 less
    expected = [tuple((ink * black + 127) // 255 for ink in light) for *light, black in inks]
    assert max(abs(a - b) for p, q in zip(seen.getdata(), expected) for a, b in zip(p, q)) <= 1


@pytest.mark.parametrize("background", [0, 1, 31])
def test_what_the_first_frame_of_a_gif_leaves_of_its_picture_is_transparent(hmesh, background):
    Path("corner.gif").write_bytes(images.gif_in_corner(background))
    hmesh.done("corner.gif --effort draft --vertices 60 --strip strip.png")
    width, height = images.WIDTH + 2, images.HEIGHT + 1
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, width, height))  # over white
    framed = {seen.getpixel((x, y)) for y in range(height) for x in range(width) if x < 2 or y < 1}
    assert framed == {(255, 255, 255)}
    expected = images.picture("P").convert("RGB")
    assert seen.crop((2, 1, width, height)).tobytes() == expected.tobytes()


@pytest.mark.parametrize("name", ["animated.gif", "animated.webp"])
def test_of_an_animation_the_first_frame_is_taken_and_told(hmesh, name):
    skip_unless_read(hmesh, name)
    put(name)
    assert re.search(r"^note +the file is animated: .*first .*taken$", hmesh.done(f"{name} --vertices 8"), re.M)


def test_floats_are_meshed_as_they_are(hmesh):
    put("rgb.pfm")
    report = hmesh.report("rgb.pfm -o x.ply -o x.html --vertices 300 --render r.png --weights rgb.pfm")
    assert report["bits"] == 32 and report["psnr"] > 30


def test_help_and_version_say_what_is_read(hmesh):
    text = hmesh.done("--help")
    version = hmesh.done("--version")
    for name in ["PNG", "JPEG", "BMP", "TGA", "GIF", "PSD", "PGM", "PPM", "PFM", "HDR"]:
        assert name in text and re.search(rf"^  .*\b{name}\b.*: \S", version, re.M)
    for kind, _ in LIBRARIES.values():
        assert (kind in text) == (kind in version)


@pytest.mark.parametrize("name", ["rgb.png", "rgb.bmp", "rgb.gif", "raw.psd"])
def test_of_a_file_that_ends_within_its_header_no_size_is_told(hmesh, name):
    kind = name.rpartition(".")[2]
    for length in range(8, 24 if kind == "png" else 26 if kind == "bmp" else 10 if kind == "gif" else 22):
        Path(f"cut.{kind}").write_bytes(FILES[name][:length])
        hmesh.fails(f"'cut.{kind}': its {kind.upper()} header is cut off", f"cut.{kind} -o x.ply")


def test_a_png_for_ios_is_told_as_one(hmesh):
    whole = FILES["rgb.png"]
    Path("ios.png").write_bytes(whole[:8] + images.png_chunk(b"CgBI", b"\x50\0\x20\2") + whole[8:])
    hmesh.fails("it is a PNG file for iOS alone", "ios.png -o x.ply")


def exif_of(kind, value):
    """Big-endian, the orientation as a tag of this type."""
    return struct.pack(">2sHIHHHI", b"MM", 42, 8, 1, 274, kind, 1) + value + bytes(4)


# The last one is the second tag of a table that does not follow its header.
@pytest.mark.parametrize("data", [
    images.exif(6), exif_of(3, b"\0\6\0\0"), exif_of(4, b"\0\0\0\6"),
    struct.pack(">2sHIHHHHI4sHHIHHI", b"MM", 42, 10, 0, 2, 271, 2, 4, b"abc\0", 274, 3, 1, 6, 0, 0)])
def test_an_orientation_is_a_number_of_16_or_32_bits(hmesh, data):
    Path("x.png").write_bytes(images.png(images.png_chunk(b"eXIf", data)))
    assert hmesh.report("x.png --vertices 4")["width"] == images.HEIGHT


def test_exif_data_behind_bytes_that_fill_are_found(hmesh):
    whole = FILES["exif.jpg"]
    at = whole.index(b"\xff\xe1")
    Path("x.jpg").write_bytes(whole[:at] + b"\xff\xff" + whole[at:])
    assert hmesh.report("x.jpg --vertices 4")["width"] == images.HEIGHT


@pytest.mark.parametrize("tag", [274, 296])
def test_tags_that_are_no_pixels_need_not_be_right(hmesh, tag):
    skip_unless_read(hmesh, "x.tif")
    Path("x.tif").write_bytes(images.tiff(images.picture().tobytes(), 8, 2, more={tag: (3, [0])}.items()))
    hmesh.done("x.tif --vertices 4 --effort draft --strip strip.png")
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, *images.SIZE))
    assert list(seen.getdata()) == list(images.picture().getdata())


def test_a_palette_may_lie_in_small_tiles(hmesh):
    skip_unless_read(hmesh, "x.tif")
    size = 32, 16  # two tiles of 256 bytes
    tiles = bytes(range(256)) + bytes(range(255, -1, -1))
    head = {256: (3, [32]), 257: (3, [16]), 258: (3, [8]), 259: (3, [1]), 262: (3, [3]), 277: (3, [1]), 320: (3, [257 * k for k in range(256)] * 3),
            322: (3, [16]), 323: (3, [16]), 324: (4, [8, 264]), 325: (4, [256, 256])}
    place, table, after = 8 + len(tiles), b"", b""
    behind = place + 2 + 12 * len(head) + 4
    for number, (kind, values) in sorted(head.items()):
        packed = struct.pack(f"<{len(values)}{'H' if kind == 3 else 'I'}", *values)
        if len(packed) > 4:
            packed, after = struct.pack("<I", behind + len(after)), after + packed
        table += struct.pack("<HHI", number, kind, len(values)) + packed.ljust(4, b"\0")
    Path("x.tif").write_bytes(struct.pack("<2sHI", b"II", 42, place) + tiles + struct.pack("<H", len(head)) + table + bytes(4) + after)
    hmesh.done("x.tif --vertices 4 --effort draft --strip strip.png")
    seen = Image.open("strip.png").convert("RGB").crop((0, 0, *size))
    assert [seen.getpixel((x, 3))[0] for x in (0, 15, 16, 31)] == [48, 63, 207, 192]


@pytest.mark.parametrize("layers, red", [(b"", 100), (struct.pack(">IhI", 6, 1, 0), 100), (struct.pack(">IhI", 6, -1, 0), 0)])
def test_colors_of_a_psd_lie_over_white_where_it_has_transparency_and_no_selection(hmesh, layers, red):
    planes = b"".join(bytes([sample]) * 4 for sample in (100, 150, 200, 128))
    head = struct.pack(">4sH6xHIIHH", b"8BPS", 1, 4, 2, 2, 8, 3) + bytes(8) + struct.pack(">I", len(layers)) + layers
    Path("x.psd").write_bytes(head + b"\0\0" + planes)
    hmesh.done("x.psd --vertices 4 --render r.png")
    assert Image.open("r.png").getpixel((0, 0))[::3] == (red, 128)  # the fourth channel is alpha all the same


# ---- what a picture of one colour is drawn with ----
def drawn(hmesh, name, options=""):
    hmesh.done(f"{name} --vertices 4 --effort draft --render drawn.png {options}")
    return Image.open("drawn.png").getpixel((0, 0))


@pytest.mark.parametrize("head, sample, grey", [
    (b"P5\r\n4 4\r\n255\r", b"\x4d", 77), (b"P5 4 # a comment\r4 255\n", b"\x4d", 77), (b"P5#\n4 4 255\n", b"\x4d", 77),
    (b"P5 4 4 100\n", b"\x22", 87), (b"P5 4 4 100\n", b"\x64", 255), (b"P5 4 4 256\n", b"\1\0", 255),
    (b"P5 4 4 512\n", b"\1\0", 128), (b"Pf 4 4 2.5\n", struct.pack(">f", 0.2), 51)])
def test_a_sample_of_a_pnm_file_is_a_part_of_its_maximum_whatever_ends_the_lines_of_its_header(hmesh, head, sample, grey):
    Path("x.pnm").write_bytes(head + sample * 16)
    assert drawn(hmesh, "x.pnm") == grey


def test_a_pfm_file_has_either_order_of_bytes(hmesh):
    for name, order in [("little", "<"), ("big", ">")]:
        Path(f"{name}.pfm").write_bytes(images.pfm(order))
        hmesh.done(f"{name}.pfm --vertices 40 --effort draft -o {name}.ply")
    assert Path("little.ply").read_bytes() == Path("big.ply").read_bytes()


def test_a_radiance_file_may_begin_as_its_older_kind(hmesh):
    Path("x.hdr").write_bytes(FILES["rgb.hdr"].replace(b"#?RADIANCE", b"#?RGBE"))
    assert hmesh.report("x.hdr --vertices 4")["bits"] == 32


@pytest.mark.parametrize("tags, photometric, pixel, color", [
    ({339: (3, [4] * 3)}, 2, [10, 20, 30], (10, 20, 30)),  # nothing is said of the samples
    ({338: (3, [0])}, 2, [10, 20, 30, 40], (10, 20, 30)),  # the fourth is no alpha
    ({338: (3, [1])}, 2, [100, 50, 0, 128], (199, 100, 0, 128)),  # colours times alpha
    ({338: (3, [1])}, 2, [200, 128, 0, 128], (255, 255, 0, 128)), ({338: (3, [1])}, 2, [10, 0, 0, 0], (10, 0, 0, 0)),
    ({}, 0, [55], 200)])  # 0 is white
@pytest.mark.parametrize("bits", [8, 16])
def test_samples_of_a_tiff_file_mean_what_its_tags_say(hmesh, tags, photometric, pixel, color, bits):
    skip_unless_read(hmesh, "x.tif")
    samples = bytes(pixel) if bits == 8 else struct.pack(f"<{len(pixel)}H", *[257 * sample for sample in pixel])
    Path("x.tif").write_bytes(images.tiff(samples * (images.WIDTH * images.HEIGHT), bits, photometric, len(pixel), tags.items()))
    assert drawn(hmesh, "x.tif", "--report r.json") == color
    assert json.loads(Path("r.json").read_text())["bits"] == bits


def test_the_planes_of_a_tiff_file_may_lie_one_behind_the_other(hmesh):
    skip_unless_read(hmesh, "x.tif")
    planes = [plane.tobytes() for plane in images.picture().split()]
    tags = {284: (3, [2]), 279: (4, [len(plane) for plane in planes])}
    Path("x.tif").write_bytes(images.tiff(b"".join(planes), 8, 2, more=tags.items()))
    Path("whole.tif").write_bytes(FILES["rgb.tif"])
    for name, options in [("whole", ""), ("x", ""), ("x", "--out-of-core")]:
        hmesh.done(f"{name}.tif --vertices 40 --effort draft -o {name}.ply {options}")
        assert Path(f"{name}.ply").read_bytes() == Path("whole.ply").read_bytes()


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_tiff_file_may_be_of_the_large_kind(hmesh, order):
    skip_unless_read(hmesh, "x.tif")
    tags = {256: 4, 257: 4, 258: 8, 259: 1, 262: 1, 273: 16, 277: 1, 278: 4, 279: 16}
    table = b"".join(struct.pack(order + "HHQHHI", number, 3, 1, value, 0, 0) for number, value in tags.items())
    head = struct.pack(order + "2sHHHQ", b"II" if order == "<" else b"MM", 43, 8, 0, 32) + bytes([77]) * 16
    Path("x.tif").write_bytes(head + struct.pack(order + "Q", len(tags)) + table + bytes(8))
    assert drawn(hmesh, "x.tif") == 77


@pytest.mark.parametrize("options", ["", "--out-of-core -o x.ply"])
def test_of_several_pages_of_a_tiff_file_the_first_is_taken_and_told(hmesh, options):
    skip_unless_read(hmesh, "x.tif")
    images.picture().save("x.tif", save_all=True, append_images=[Image.new("RGB", (9, 9))])
    said = hmesh.done(f"x.tif --vertices 8 {options}")
    assert f"{images.WIDTH} x {images.HEIGHT}" in said
    assert re.search("^note +the file has more pages than one: its first", said, re.M)


def test_a_tiff_file_that_is_turned_or_has_a_palette_is_not_read_by_rectangles(hmesh):
    skip_unless_read(hmesh, "x.tif")
    for name, why in [("turned", "it is turned"), ("palette", "it has palettes, bits or YCbCr")]:
        put(f"{name}.tif")
        hmesh.fails(why, f"{name}.tif --out-of-core -o x.ply")


@pytest.mark.parametrize("index, color", [(0, (0, 1, 2, 128)), (2, (6, 7, 8, 255))])
def test_a_palette_of_a_png_file_has_alpha_for_its_first_colors(hmesh, index, color):
    line = bytes([0x55 * index] * (images.WIDTH // 4))
    extra = [images.png_chunk(b"PLTE", bytes(range(9))), images.png_chunk(b"tRNS", b"\x80")]
    Path("x.png").write_bytes(images.png(*extra, bits=2, kind=3, lines=[line] * images.HEIGHT))
    assert drawn(hmesh, "x.png") == color


def test_an_animated_png_is_told_as_one(hmesh):
    Path("x.png").write_bytes(images.png(images.png_chunk(b"acTL", struct.pack(">II", 1, 0))))
    assert re.search("^note +the file is animated: the picture for programs that show no", hmesh.done("x.png --vertices 8"), re.M)


def test_a_png_file_of_one_color_is_as_small_as_it_can_be_and_read(hmesh):
    Image.new("L", (2000, 1000), 9).save("x.png", compress_level=9)
    assert Path("x.png").stat().st_size < 2000 * 1000 / 500
    assert drawn(hmesh, "x.png") == 9


@pytest.mark.parametrize("orientation", [0, 9])
def test_an_orientation_that_there_is_not_is_upright(hmesh, orientation):
    Path("x.png").write_bytes(images.png(images.png_chunk(b"eXIf", images.exif(orientation))))
    assert hmesh.report("x.png --vertices 4")["width"] == images.WIDTH


def test_exif_data_may_follow_others_of_the_same_marker(hmesh):
    whole, other = FILES["exif.jpg"], b"http://ns.adobe.com/xap/1.0/\0<x/>"
    at = whole.index(b"\xff\xe1")
    Path("x.jpg").write_bytes(whole[:at] + b"\xff\xe1" + struct.pack(">H", 2 + len(other)) + other + whole[at:])
    assert hmesh.report("x.jpg --vertices 4")["width"] == images.HEIGHT


def test_exif_data_of_a_webp_file_may_begin_as_in_a_jpeg_file(hmesh):
    skip_unless_read(hmesh, "x.webp")
    if "exif.webp" not in FILES:
        pytest.skip("Pillow does not write it here")
    whole = FILES["exif.webp"]
    at, (size,) = whole.index(b"EXIF"), struct.unpack_from("<I", whole, 4)
    data, = struct.unpack_from("<I", whole, at + 4)
    exif = struct.pack("<I", data + 6) + b"Exif\0\0" + whole[at + 8:]
    Path("x.webp").write_bytes(whole[:4] + struct.pack("<I", size + 6) + whole[8:at + 4] + exif)
    assert hmesh.report("x.webp --vertices 4")["width"] == images.HEIGHT


def test_what_markers_say_that_is_no_pixel_is_passed_over(hmesh):
    whole = FILES["rgb.jpg"]
    assert whole[2:4] == b"\xff\xe0" and whole[6:12] == b"JFIF\0\1"
    adobe = b"\xff\xee\0\x0eAdobe\0\x64\0\0\0\0\7"  # a transform that there is not
    Path("plain.jpg").write_bytes(whole)
    Path("version.jpg").write_bytes(whole[:11] + b"\2" + whole[12:])
    Path("adobe.jpg").write_bytes(whole[:2] + adobe + whole[20:])
    for name in ["plain", "version", "adobe"]:
        hmesh.done(f"{name}.jpg --vertices 40 --effort draft -o {name}.ply")
        assert Path(f"{name}.ply").read_bytes() == Path("plain.ply").read_bytes()
