#!/usr/bin/env python3
"""What images are worth in few bytes: compact meshes beside AVIF, JPEG XL, WebP, JPEG 2000 and JPEG.

usage: benchmarks/compact_rates.py IMAGE... [--bpp 0.05,0.1] [--efforts normal,fine] [--avif-speed 0] [--hmesh PROGRAM] [--only NAME,..]

Prints the commands, then a table of each measure: PSNR over pixels and channels of RGB; PSNR of luma (ITU-R BT.601); SSIM of
luma in windows of 7 x 7 px, all alike. All are of pictures of 8 bits at full size, decoded from whole files, of which every byte
counts. A compact file has the bytes that are asked for, and so has JPEG 2000; of the others a row of qualities is encoded, and
what they have between two is interpolated linearly in the logarithm of the bytes: '-' where they have no file so small or so
large. Needs Pillow with OpenJPEG, numpy, and of avifenc, avifdec, cjxl, djxl, cwebp and dwebp those that are to be compared with.
"""
import argparse
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

AVIF = "avifenc -s {speed} -j 1 -y 444 --min 0 --max 63 -a end-usage=q -a cq-level={q} -a tune=psnr"
JXL = "cjxl -e 9 -d {q}"
WEBP = "cwebp -m 6 -q {q}"


def luma(pixels):
    return pixels @ np.array([0.299, 0.587, 0.114])


def psnr(a, b):
    error = np.mean((a - b) ** 2)
    return 10 * math.log10(255 * 255 / error) if error > 0 else math.inf


def window_means(plane, side=7):
    sums = np.pad(plane, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
    return (sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]) / side**2


def ssim(a, b):
    c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    ma, mb = window_means(a), window_means(b)
    va, vb = window_means(a * a) - ma * ma, window_means(b * b) - mb * mb
    covariance = window_means(a * b) - ma * mb
    return float(np.mean((2 * ma * mb + c1) * (2 * covariance + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))))


def pixels_of(path):
    return np.asarray(Image.open(path).convert("RGB"), dtype=np.float64)


class Judge:
    """Encodes one image in every way that is asked for, and measures what comes back."""

    def __init__(self, path, folder, options):
        self.truth = pixels_of(path)
        self.folder = folder
        self.options = options
        self.png = folder / "truth.png"  # what all are given
        Image.fromarray(self.truth.astype(np.uint8)).save(self.png)

    def measures(self, file, picture):
        got = pixels_of(picture)
        a, b = luma(self.truth), luma(got)
        return file.stat().st_size, (psnr(self.truth, got), psnr(a, b), ssim(a, b))

    def run(self, command, *words):
        subprocess.run([*command.split(), *map(str, words)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def coded(self, ending, encode, decode):
        """A row of one codec: encode(file) and decode(file, picture)."""
        file, picture = self.folder / ("coded" + ending), self.folder / "decoded.png"
        encode(file)
        decode(file, picture)
        return self.measures(file, picture)

    def avif(self):
        for q in range(62, 29, -4):
            command = AVIF.format(speed=self.options.avif_speed, q=q)
            yield self.coded(".avif", lambda file: self.run(command, self.png, file), lambda *to: self.run("avifdec", *to))

    def jxl(self):
        for q in (2.5, 3.5, 5, 7, 10, 15):
            command = JXL.format(q=q)
            yield self.coded(".jxl", lambda file: self.run(command, self.png, file), lambda *to: self.run("djxl", *to))

    def webp(self):
        for q in (0, 2, 5, 10, 20, 35, 50, 65, 80):
            command = WEBP.format(q=q)
            yield self.coded(".webp", lambda file: self.run(command, self.png, "-o", file),
                             lambda file, picture: self.run("dwebp", file, "-o", picture))

    def pillow(self, ending, **how):
        image = Image.fromarray(self.truth.astype(np.uint8))
        return self.coded(ending, lambda file: image.save(file, **how), lambda file, picture: Image.open(file).save(picture))

    def jpeg(self):
        for q in (1, 2, 4, 6, 9, 13, 18, 25, 35):
            yield max(
                (self.pillow(".jpg", quality=q, optimize=True, progressive=True, subsampling=s) for s in (0, 2)),
                key=lambda got: got[1][0] - 6 * math.log10(got[0]),
            )

    def j2k(self, sizes):
        whole = self.truth.size
        for size in sizes:
            yield self.pillow(".jp2", irreversible=True, mct=1, quality_mode="rates", quality_layers=[whole / size])

    def hmesh(self, sizes, effort):
        for size in sizes:
            command = f"{self.options.hmesh} --bytes {size} --effort {effort} --quiet"
            yield self.coded(".hmc", lambda file: self.run(command, self.png, "-o", file),
                             lambda file, picture: self.run(self.options.hmesh, "--quiet", file, "--render", picture))


def at(row, size):
    """The measures of a row of (bytes, measures) at so many bytes, or None."""
    best = []
    for bytes_, got in sorted(row):
        if not best or got[0] > best[-1][1][0]:
            best.append((bytes_, got))
    for (low, a), (high, b) in zip(best, best[1:]):
        if low <= size <= high:
            share = math.log(size / low) / math.log(high / low)
            return tuple(x + share * (y - x) for x, y in zip(a, b))
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("images", nargs="+", metavar="IMAGE")
    parser.add_argument("--bpp", default="0.05,0.1,0.15,0.2,0.3,0.4")
    parser.add_argument("--efforts", default="normal,fine")
    parser.add_argument("--avif-speed", default="0")
    parser.add_argument("--hmesh", default=shutil.which("hmesh") or "build/native/bin/hmesh")
    parser.add_argument("--only", help="some of hmesh, avif, jxl, webp, j2k and jpeg")
    options = parser.parse_args()
    rates = [float(rate) for rate in options.bpp.split(",")]
    asked = options.only.split(",") if options.only else ["hmesh", "avif", "jxl", "webp", "j2k", "jpeg"]
    programs = {"avif": "avifenc", "jxl": "cjxl", "webp": "cwebp"}
    for name, program in programs.items():
        if name in asked and shutil.which(program) is None:
            print(f"{program} is not there: {name} is left out", file=sys.stderr)
            asked.remove(name)
    print(f"{options.hmesh} --bytes N --effort {options.efforts}\n{AVIF.format(speed=options.avif_speed, q='62, 58 .. 30')}")
    print(JXL.format(q="2.5 .. 15"), WEBP.format(q="0 .. 80"), sep="\n")
    print("Pillow: JPEG 2000 irreversible, mct=1; JPEG optimised, progressive, the better of 4:4:4 and 4:2:0\n")
    efforts = options.efforts.split(",") if "hmesh" in asked else []
    names = efforts + [name for name in asked if name != "hmesh"]
    print("| image | bpp | bytes | " + " | ".join(names) + " |\n" + "|---" * (3 + len(names)) + "|", flush=True)
    for path in options.images:
        with tempfile.TemporaryDirectory() as folder:
            judge = Judge(path, Path(folder), options)
            sizes = [int(rate * judge.truth.shape[0] * judge.truth.shape[1] / 8) for rate in rates]
            rows = [[(size, got) for size, (_, got) in zip(sizes, judge.hmesh(sizes, effort))] for effort in efforts]
            for name in names[len(efforts):]:
                if name == "j2k":
                    rows.append([(size, got) for size, (_, got) in zip(sizes, judge.j2k(sizes))])
                else:
                    rows.append(list(getattr(judge, name)()))
            for rate, size in zip(rates, sizes):
                exact = [dict(row).get(size) or at(row, size) for row in rows]
                cells = ["-" if got is None else f"{got[0]:.2f} / {got[1]:.2f} / {got[2]:.3f}" for got in exact]
                print(f"| {Path(path).stem} | {rate:g} | {size} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
