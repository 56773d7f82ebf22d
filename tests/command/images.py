"""Image files of every kind that the command reads, drawn here. By itself: images.py FOLDER writes all of them."""
import io
import struct
import sys
import zlib
from pathlib import Path

from PIL import Image, features

SIZE = WIDTH, HEIGHT = 24, 18


def color(x, y):
    """Red, green and blue of a pixel, whole numbers of 8 bits: smooth, and other in each corner."""
    return (x * 10, y * 13, (x * 5 + y * 7) % 256)


def picture(mode="RGB"):
    image = Image.new("RGB", SIZE)
    image.putdata([color(x, y) for y in range(HEIGHT) for x in range(WIDTH)])
    if mode in ("RGBA", "LA"):
        image.putalpha(Image.linear_gradient("L").resize(SIZE))
    return image.convert(mode) if mode != "P" else image.quantize(32)


def rows(pixel):
    return [b"".join(pixel(x, y) for x in range(WIDTH)) for y in range(HEIGHT)]


def saved(image, kind, **how):
    out = io.BytesIO()
    image.save(out, kind, **how)
    return out.getvalue()


def exif(orientation):
    """As a TIFF file begins: one tag."""
    return struct.pack("<2sHIHHHIHHI", b"II", 42, 8, 1, 274, 3, 1, orientation, 0, 0)


# ---- PNG ----
def png_chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png(*extra, bits=8, kind=2, lines=None, interlace=0, size=SIZE):
    lines = lines if lines is not None else rows(lambda x, y: bytes(color(x, y)))
    data = zlib.compress(b"".join(b"\0" + line for line in lines))
    header = struct.pack(">IIBBBBB", *size, bits, kind, 0, 0, interlace)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        [png_chunk(b"IHDR", header), *extra, png_chunk(b"IDAT", data), png_chunk(b"IEND", b"")])


def png16(channels):
    return png(bits=16, kind={1: 0, 3: 2}[channels],
               lines=rows(lambda x, y: struct.pack(f">{channels}H", *[s * 257 + x for s in color(x, y)][:channels])))


def png_palette(colors):
    """Of three colours more are used than it has, unless it has three."""
    palette = png_chunk(b"PLTE", bytes(range(3 * colors)))
    return png(palette, kind=3, lines=rows(lambda x, y: bytes([(x + y) % 3])))


# ---- TIFF, of one strip: tags are (number, type, values) ----
def tiff(pixels, bits, photometric, samples=3, more=(), order="<", size=SIZE, strip=None):
    tags = {256: (3, [size[0]]), 257: (3, [size[1]]), 258: (3, [bits] * samples), 259: (3, [1]), 262: (3, [photometric]),
            277: (3, [samples]), 278: (3, [size[1]]), 279: (4, [len(pixels) if strip is None else strip]), **dict(more)}
    sizes = tags[279][1]
    tags[273] = (4, [8 + sum(sizes[:k]) for k in range(len(sizes))])
    place = 8 + len(pixels)
    place += place % 2
    table, after = b"", b""
    behind = place + 2 + 12 * len(tags) + 4
    for number, (kind, values) in sorted(tags.items()):
        packed = struct.pack(f"{order}{len(values)}{'H' if kind == 3 else 'I'}", *values)
        if len(packed) > 4:
            packed, after = struct.pack(order + "I", behind + len(after)), after + packed
        table += struct.pack(order + "HHI", number, kind, len(values)) + packed.ljust(4, b"\0")
    head = struct.pack(order + "2sHI", b"II" if order == "<" else b"MM", 42, place)
    return (head + pixels).ljust(place, b"\0") + struct.pack(order + "H", len(tags)) + table + bytes(4) + after


def tiff16(order="<"):
    return tiff(b"".join(rows(lambda x, y: struct.pack(order + "3H", *(s * 257 + x for s in color(x, y))))), 16, 2, order=order)


def tiff_float(channels=3):
    pixels = b"".join(rows(lambda x, y: struct.pack(f"<{channels}f", *[s / 128 for s in color(x, y)][:channels])))
    return tiff(pixels, 32, 2 if channels == 3 else 1, channels, {339: (3, [3] * channels)}.items())


# ---- floats ----
def pfm(order="<", channels=3):
    lines = rows(lambda x, y: struct.pack(f"{order}{channels}f", *[s / 128 for s in color(x, y)][:channels]))
    head = "%s\n%d %d\n%s\n" % ("PF" if channels == 3 else "Pf", *SIZE, "-1.0" if order == "<" else "1.0")
    return head.encode() + b"".join(reversed(lines))


def rgbe(x, y):
    """The exponent 129: a mantissa of 128 is 1."""
    return [*color(x, y), 129]


def hdr(layout=f"-Y {HEIGHT} +X {WIDTH}", has_runs=True, line_end="\n"):
    head = "".join(line + line_end for line in ["#?RADIANCE", "# a comment", "FORMAT=32-bit_rle_rgbe", "", layout]).encode()
    if not has_runs:
        return head + b"".join(rows(lambda x, y: bytes(rgbe(x, y))))
    for y in range(HEIGHT):
        head += struct.pack(">BBH", 2, 2, WIDTH)
        for c in range(3):
            head += bytes([WIDTH, *(rgbe(x, y)[c] for x in range(WIDTH))])
        head += bytes([128 + WIDTH, 129])
    return head


# ---- PSD ----
def packbits(line):
    return bytes([len(line) - 1]) + line


def psd(bits=8, has_runs=False, channels=3, mode=3):
    head = struct.pack(">4sH6xHIIHH", b"8BPS", 1, channels, HEIGHT, WIDTH, bits, mode) + bytes(12)
    image = Image.eval(picture("CMYK"), lambda ink: 255 - ink) if mode == 4 else picture()
    lines = [bytes(plane.getpixel((x, y)) for x in range(WIDTH)) for plane in image.split() for y in range(HEIGHT)]
    if mode != 4:
        lines += [bytes([y * 10]) * WIDTH for y in range(HEIGHT)] * (channels - 3)
    if bits == 16:
        lines = [bytes(sample for byte in line for sample in (byte, byte)) for line in lines]
    if not has_runs:
        return head + b"\0\0" + b"".join(lines)
    packed = [packbits(line) for line in lines]
    return head + b"\0\1" + b"".join(struct.pack(">H", len(line)) for line in packed) + b"".join(packed)


# ---- BMP, TGA, GIF beyond Pillow's ----
def bmp(header=40, top_down=False, masks=()):
    """Of 24 bits; with masks, those of BGRA, of 32, half transparent where the header has room for the fourth."""
    lines = rows(lambda x, y: bytes(color(x, y)[::-1]) + (b"\x80" if masks else b""))
    pixels = b"".join(line + bytes(-len(line) % 4) for line in (lines if top_down else lines[::-1]))
    head = struct.pack("<IiiHHIIIIII", header, WIDTH, -HEIGHT if top_down else HEIGHT, 1, 32 if masks else 24, 3 if masks else 0,
                       len(pixels), 0, 0, 0, 0) + struct.pack(f"<{len(masks)}I", *masks)
    head = head.ljust(header, b"\0")
    return struct.pack("<2sIHHI", b"BM", 14 + len(head) + len(pixels), 0, 0, 14 + len(head)) + head + pixels


def bmp_of_os2():
    """Whose header has 12 bytes, and its sides 16 bits."""
    pixels = b"".join(line + bytes(-len(line) % 4) for line in rows(lambda x, y: bytes(color(x, y)[::-1]))[::-1])
    return struct.pack("<2sIHHIIHHHH", b"BM", 26 + len(pixels), 0, 0, 26, 12, WIDTH, HEIGHT, 1, 24) + pixels


def with_gap(whole, gap):
    """A BMP file with something between its palette and its pixels."""
    first = struct.unpack_from("<I", whole, 10)[0]
    return whole[:10] + struct.pack("<I", first + len(gap)) + whole[14:first] + gap + whole[first:]


def gif_in_corner(background):
    """Two columns and a row larger than its frame, in whose lower right corner it lies. The background is one of the palette's."""
    whole = saved(picture("P"), "GIF")
    at = whole.index(b"\x2c\0\0\0\0" + struct.pack("<HH", *SIZE))
    return (whole[:6] + struct.pack("<HH", WIDTH + 2, HEIGHT + 1) + whole[10:11] + bytes([background]) + whole[12:at + 1] +
            struct.pack("<HH", 2, 1) + whole[at + 5:])


def tga(bits=24, kind=2, descriptor=0x20, pixels=None, color_map=b""):
    head = struct.pack("<BBBHHBHHHHBB", 0, 1 if color_map else 0, kind, 0, len(color_map) // 3, 24 if color_map else 0, 0, 0, *SIZE, bits,
                       descriptor)
    return head + color_map + (pixels if pixels is not None else b"".join(rows(lambda x, y: bytes(color(x, y)[::-1]))))


def tga_of_5_bits_a_color(bits):
    def pixel(x, y):
        red, green, blue = (sample >> 3 for sample in color(x, y))
        return struct.pack("<H", red << 10 | green << 5 | blue)

    return tga(bits, pixels=b"".join(rows(pixel)))


def all_files():
    """Name: bytes, each of a whole picture that every decoder reads."""
    rgb, grey, rgba, palette = picture(), picture("L"), picture("RGBA"), picture("P")
    files = {
        "rgb.png": png(), "grey.png": saved(grey, "PNG"), "alpha.png": saved(rgba, "PNG"), "palette.png": png_palette(3),
        "rgb16.png": png16(3), "grey16.png": png16(1), "bits.png": saved(picture("1"), "PNG"), "exif.png": png(png_chunk(b"eXIf", exif(6))),
        "key.png": png(png_chunk(b"tRNS", struct.pack(">3H", *color(3, 2)))),
        "key16.png": png(png_chunk(b"tRNS", struct.pack(">H", 10 * 257)), bits=16, kind=0, lines=rows(lambda x, y: struct.pack(">H", x * 2570))),
        "rgb.jpg": saved(rgb, "JPEG", quality=90), "grey.jpg": saved(grey, "JPEG"),
        "progressive.jpg": saved(rgb, "JPEG", progressive=True), "cmyk.jpg": saved(picture("CMYK"), "JPEG", quality=95),
        "exif.jpg": saved(rgb, "JPEG", exif=b"Exif\0\0" + exif(6)),
        "rgb.bmp": saved(rgb, "BMP"), "alpha.bmp": saved(rgba, "BMP"), "palette.bmp": saved(palette, "BMP"),
        "gap.bmp": with_gap(bmp(), b"gap"),
        "masks_gap.bmp": with_gap(bmp(masks=(0xff0000, 0xff00, 0xff)), bytes(1024)),
        "long_gap.bmp": with_gap(bmp(56, masks=(0xff0000, 0xff00, 0xff, 0)), b"gap"),
        "palette_gap.bmp": with_gap(saved(palette, "BMP"), b"gap" * 400),
        "bits.bmp": saved(picture("1"), "BMP"), "top_down.bmp": bmp(top_down=True),
        "masks.bmp": bmp(56, masks=(0xff0000, 0xff00, 0xff, 0)), "alpha_mask.bmp": bmp(56, masks=(0xff0000, 0xff00, 0xff, 0xff000000)),
        "os2.bmp": bmp_of_os2(), "bits15.tga": tga_of_5_bits_a_color(15), "bits16.tga": tga_of_5_bits_a_color(16),
        "rgb.tga": saved(rgb, "TGA"), "runs.tga": saved(rgb, "TGA", compression="tga_rle"),
        "zeros.tga": tga(32, pixels=b"".join(rows(lambda x, y: bytes(color(x, y)[::-1]) + b"\0"))),
        "alpha.tga": saved(rgba, "TGA"), "palette.tga": saved(palette, "TGA"), "grey.tga": saved(grey, "TGA"),
        "rgb.gif": saved(palette, "GIF"), "animated.gif": saved(palette, "GIF", save_all=True, append_images=[palette.rotate(90)]),
        "interlaced.gif": saved(palette, "GIF", interlace=1), "raw.psd": psd(), "runs.psd": psd(has_runs=True), "deep.psd": psd(16),
        "cmyk.psd": psd(channels=4, mode=4), "deep_runs.psd": psd(16, has_runs=True),
        "alpha.psd": psd(channels=4), "rgb.pfm": pfm(), "grey.pfm": pfm(">", 1), "rgb.hdr": hdr(), "flat.hdr": hdr(has_runs=False),
        "crlf.hdr": hdr(line_end="\r\n"),
        "rgb.ppm": saved(rgb, "PPM"), "grey.pgm": saved(grey, "PPM"),
        "deep.pgm": b"P5 24 18 1000\n" + b"".join(rows(lambda x, y: struct.pack(">H", 40 * x))),
    }
    files.update({
        "rgb.tif": tiff(rgb.tobytes(), 8, 2), "rgb16.tif": tiff16(), "big_endian.tif": tiff16(">"), "float.tif": tiff_float(),
        "grey_float.tif": tiff_float(1), "cmyk.tif": tiff(picture("CMYK").tobytes(), 8, 5, 4), "palette.tif": saved(palette, "TIFF"),
        "bits.tif": saved(picture("1"), "TIFF"), "alpha.tif": tiff(rgba.tobytes(), 8, 2, 4, {338: (3, [2])}.items()),
        "turned.tif": tiff(rgb.tobytes(), 8, 2, more={274: (3, [6])}.items()),
        **{f"{how}.tif": saved(rgb, "TIFF", compression=name) for how, name in
           {"lzw": "tiff_lzw", "deflate": "tiff_adobe_deflate", "packbits": "packbits", "jpeg": "jpeg"}.items()
           if features.check("libtiff")},
        "fax.tif": saved(picture("1"), "TIFF", compression="group4"),
    })
    if features.check("webp"):
        files.update({"rgb.webp": saved(rgb, "WEBP", quality=90), "lossless.webp": saved(rgb, "WEBP", lossless=True),
                      "alpha.webp": saved(rgba, "WEBP", lossless=True), "exif.webp": saved(rgb, "WEBP", lossless=True, exif=exif(6)),
                      "animated.webp": saved(rgb, "WEBP", save_all=True, append_images=[rgb.rotate(180)], lossless=True)})
    return files


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in all_files().items():
        (folder / name).write_bytes(content)
