#!/usr/bin/env python3
"""What the seams of `hmesh job` cost: the error of pixels along them, beside them and elsewhere.

usage: benchmarks/job_seams.py IMAGE... [--tile 128,256] [--rate 2] [--effort normal] [--hmesh PROGRAM]

Of each image and tile size: the tolerance of sides that the job chose; the PSNR of the joined mesh and of one mesh of the whole;
and the mean squared error, over pixels and channels, of the pixels on seams, of those within a pixel of one, of all others, and in
brackets what one mesh of the whole has there. index.json says where tiles meet. Meshes are read from .ply and drawn at the pixels'
centres by a loop over triangles, without code of hmesh: 0.1 ms each. Needs ninja, numpy and Pillow.
"""
import argparse
import json
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

TYPES = {"float": "<f4", "uchar": "u1", "ushort": "<u2"}


def read_ply(path):
    """Positions, colours and triangles of a binary file, y downward from the first row of samples."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    fields, counts = [], {}
    for words in (line.split() for line in data[:end].decode().splitlines()):
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        elif words[0] == "property" and words[1] in TYPES:
            fields.append((words[2], TYPES[words[1]]))
    vertices = np.frombuffer(data, np.dtype(fields), counts["vertex"], end)
    faces = np.frombuffer(data, np.dtype([("n", "u1"), ("v", "<i4", 3)]), counts["face"], end + vertices.nbytes)
    places = np.stack([vertices["x"], vertices["y"].max() - vertices["y"]], 1).astype(float)
    return places, np.stack([vertices[c] for c in ("red", "green", "blue")], 1).astype(float), faces["v"]


def drawn(path, height, width):
    places, colors, faces = read_ply(path)
    picture = np.full((height, width, 3), np.nan)
    for face in faces:
        (ax, ay), (bx, by), (cx, cy) = places[face]
        x = np.arange(math.ceil(min(ax, bx, cx)), math.floor(max(ax, bx, cx)) + 1)
        y = np.arange(math.ceil(min(ay, by, cy)), math.floor(max(ay, by, cy)) + 1)[:, None]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
        v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
        inside = (u >= -1e-6) & (v >= -1e-6) & (u + v <= 1 + 1e-6)
        rows, columns = np.nonzero(inside)
        weights = np.stack([u[inside], v[inside], 1 - u[inside] - v[inside]], 1)
        if rows.size:
            picture[rows + y[0, 0], columns + x[0]] = weights @ colors[face]
    assert not np.isnan(picture).any(), f"{path} leaves out pixels"
    return picture


def psnr(errors):
    return 10 * math.log10(255 * 255 / errors.mean())


def measure(image, tile, options, folder):
    def run(*words):
        subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL)

    truth = np.asarray(Image.open(image).convert("RGB"), dtype=float)
    height, width, _ = truth.shape
    wanted = ["--rate", options.rate, "--effort", options.effort]
    run(options.hmesh, "job", "plan", image, "-o", folder / "job", "--tile", tile, *wanted)
    run("ninja", "-C", folder / "job")
    run(options.hmesh, "job", "join", folder / "job", "-o", folder / "job.ply", "-q")
    run(options.hmesh, image, "--samples", "points", "-o", folder / "whole.ply", "-q", *wanted)
    index = json.loads((folder / "job/tiles/index.json").read_text())
    job, whole = (((drawn(folder / name, height, width) - truth) ** 2).mean(2) for name in ("job.ply", "whole.ply"))
    on = np.zeros((height, width), bool)
    for x, y in ((t["x"], t["y"]) for t in index["tiles"]):
        on[:, x] |= x > 0
        on[y] |= y > 0
    near = on.copy()
    near[1:] |= on[:-1]
    near[:-1] |= on[1:]
    near[:, 1:] |= on[:, :-1]
    near[:, :-1] |= on[:, 1:]
    errors = " | ".join(f"{job[where].mean():.1f} ({whole[where].mean():.1f})" for where in (on, near, ~near))
    print(f"| {Path(image).stem} | {tile} | {index['border_tolerance']:.1f} | {psnr(job):.2f} ({psnr(whole):.2f}) | {errors} |",
          flush=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n")[0])
    parser.add_argument("images", nargs="+")
    parser.add_argument("--tile", default="128,256")
    parser.add_argument("--rate", default="2")
    parser.add_argument("--effort", default="normal")
    parser.add_argument("--hmesh", default="build/native/bin/hmesh")
    options = parser.parse_args()
    Image.MAX_IMAGE_PIXELS = None
    print("| image | tile | tolerance | PSNR, dB | on seams | within a pixel | elsewhere |\n|---|---|---|---|---|---|---|")
    for image in options.images:
        for tile in options.tile.split(","):
            with tempfile.TemporaryDirectory() as folder:
                measure(image, tile, options, Path(folder))


if __name__ == "__main__":
    main()
