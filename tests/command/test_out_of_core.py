"""--out-of-core: images that are read by rectangles, with the meshes of those that are read as a whole."""
import struct
from pathlib import Path

import pytest
from PIL import Image

from conftest import is_whole, read


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


def test_weights_and_points_are_known(hmesh):
    draw("image.ppm")
    Image.linear_gradient("L").resize((150, 90)).save("weights.png")
    options = "image.ppm --vertices 200 --samples points --weights weights.png --channel-weights 1,2,3 --effort draft"
    hmesh.done(f"{options} -o whole.ply")
    hmesh.done(f"{options} --out-of-core -o read.ply")
    assert read("read.ply") == read("whole.ply")


def test_what_cannot_be_read_by_rectangles_is_refused(hmesh):
    hmesh.fails("it is no PGM, PPM or PFM file, but PNG, and others are not read by rectangles", "picture.png --out-of-core -o a.ply")
    hmesh.fails("it is no PGM, PPM or PFM file, and others", "text.png --out-of-core -o a.ply")
    hmesh.fails("No such file", "none.pgm --out-of-core -o a.ply")
    hmesh.fails("it cannot be read by rectangles, as a file can", "- --out-of-core -o a.ply")
    hmesh.fails("the file ends before its last pixel", "short.ppm --out-of-core -o a.ply")
    hmesh.fails("the image is too wide (99999999, limit 65536)", "huge.pgm --out-of-core -o a.ply")
    assert not Path("a.ply").exists()


def test_a_sample_that_cannot_be_ends_the_work_with_its_rectangle(hmesh):
    hmesh.fails("the image could not be read (columns 0 to 1 of rows 0 to 1): it has a sample above the maximum of its PNM header",
                "above.pgm --out-of-core -o a.ply")
    assert not Path("a.ply").exists()


@pytest.mark.parametrize("option", ["--psnr 30", "--render a.png", "--lods 3", "--sprite", "--method adams", "--strip a.png",
                                    "--fit-space each", "--premultiplied", "-o a.svg", "--with b.png", "--keep-partial"])
def test_options_that_want_the_whole_image_are_refused(hmesh, option):
    draw("image.ppm")
    run = hmesh.run(f"image.ppm --out-of-core -o a.ply {option}")
    assert run.returncode == 2 and "--out-of-core" in run.stderr and not Path("a.ply").exists()
