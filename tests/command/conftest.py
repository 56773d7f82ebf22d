"""Runs the programs, each test in a folder of small pictures that it has for itself."""
import ctypes
import errno
import json
import os
import re
import resource
import shlex
import shutil
import stat
import struct
import subprocess
import time
from pathlib import Path

import pytest
from PIL import Image

FORMATS = ["ply", "obj", "glb", "pdf", "eps", "svg", "html", "hmc"]


def pytest_addoption(parser):
    for name in ["hmesh", "scene", "heightmap"]:
        parser.addoption("--" + name, metavar="PROGRAM", required=True, help="the program to test")
    parser.addoption("--terrain", metavar="PROGRAM", help="hmesh-terrain, whose tests are skipped without")


def program(config, name):
    return str(config.invocation_params.dir / config.getoption(name))


# ---- small pictures ----
def write_pnm(path, maximum, channels):
    """20 x 16 px: grey slopes, others for green and blue; the lower bytes of 16-bit samples are noise below 1/255."""
    pixels = bytearray()
    for y in range(16):
        for x in range(20):
            grey = (x * x // 3 + y * (20 - y) + (x & 3) * 8) % 256
            for sample in [grey, y * 15, x * 12][:channels]:
                pixels += bytes([sample, (x * 37 + y * 91) % 256][: 1 if maximum < 256 else 2])
    path.write_bytes(b"P%d\n# a comment\n20 16\n%d\n" % (6 if channels == 3 else 5, maximum) + pixels)


def write_jpeg(path, orientation, endian):
    """16 x 8 px as they are stored, dark on the left; orientation 0: without Exif tags."""
    image = Image.new("L", (16, 8), 40)
    image.paste(200, (8, 0, 16, 8))
    exif = Image.Exif()
    exif.endian = endian
    exif.update({274: orientation} if orientation else {})
    image.save(path, quality=95, exif=exif)


@pytest.fixture(scope="session")
def pictures(tmp_path_factory, pytestconfig):
    folder = tmp_path_factory.mktemp("pictures")
    subprocess.run([program(pytestconfig, "scene"), folder / "picture.png", "96", "64"], check=True)
    picture = Image.open(folder / "picture.png")
    picture.resize((160, 140)).save(folder / "wide.png")
    picture.resize((320, 200)).save(folder / "large.png")
    for channels, name in {1: "grey{}.pgm", 3: "color{}.ppm"}.items():
        write_pnm(folder / name.format(""), 255, channels)
        write_pnm(folder / name.format(16), 65535, channels)
    color = Image.open(folder / "color.ppm")
    alpha = Image.linear_gradient("L").resize(color.size)
    Image.merge("RGBA", [*color.split(), alpha]).save(folder / "rgba.tga")
    Image.merge("LA", [color.getchannel(0), alpha]).save(folder / "grey_alpha.tga")
    Image.new("L", (8, 8), 77).save(folder / "constant.pgm")
    for name, orientation, endian in [("plain", 0, "<"), ("upright", 1, "<"), ("turned", 6, ">"), ("turned_little", 6, "<")]:
        write_jpeg(folder / f"{name}.jpg", orientation, endian)
    contents = {"one.pgm": b"P5 1 1 255\nA", "row.pgm": b"P5 5 1 255\nA0a9Z", "short.ppm": b"P6\n20 16\n255\nshort",
                "huge.pgm": b"P5 99999999 99999999 255\nx", "above.pgm": b"P5 2 2 100\ndded", "empty.png": b"",
                "text.png": b"this is no image\n", "keep.ply": b"old\n",
                "black.pgm": b"P5 20 16 255\n" + bytes(320), "mesh.hmc": b"\x9dHMC" + bytes(20),
                "nan.pfm": b"Pf 20 16 -1\n" + struct.pack("<320f", *[float("nan") if k == 25 else 1 for k in range(320)])}
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return folder


# ---- the command ----
class Command:
    """hmesh in a folder. Its arguments are a list, or one string that is split as a shell would."""

    def __init__(self, path):
        self.path = path

    def words(self, arguments):
        return [self.path, *(shlex.split(arguments) if isinstance(arguments, str) else arguments)]

    def run(self, arguments, **how):
        how = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **how}
        return subprocess.run(self.words(arguments), encoding="utf-8", errors="replace", timeout=300, **how)

    def done(self, arguments):
        """It must succeed without a word on stderr. Returns what it prints."""
        run = self.run(arguments)
        assert (run.returncode, run.stderr) == (0, "")
        return run.stdout

    def report(self, arguments):
        """The same. Returns its report."""
        self.done(arguments + " --report report.json")
        return json.loads(Path("report.json").read_text(encoding="utf-8"))

    def within_memory(self, size):
        """For run(): within so many bytes of addresses, where that is enough for the program alone."""
        how = limit(resource.RLIMIT_AS, size)
        if self.run("--version", **how).returncode != 0:
            pytest.skip("the address sanitizer takes more")
        return how

    def fails(self, sentence, arguments, **how):
        """It must exit with 1, say one sentence that holds this one, and leave no part of a file."""
        try:
            run = self.run(arguments, **how)
        except subprocess.SubprocessError as error:
            if isinstance(error, subprocess.TimeoutExpired):
                raise
            pytest.skip(str(error))  # of preexec_fn
        is_failure(run, sentence)


class Terrain(Command):
    """hmesh-terrain. What it can read by itself it does, for that is most tests' way to some heights: GDAL takes longer to load than
    such a test to run. `takes_gdal`: by GDAL, where it has that, as it does for its users."""

    takes_gdal = False

    def words(self, arguments):
        words = super().words(arguments)
        reads_alone = any(str(word).endswith((".asc", ".hgt", ".pgm", ".png")) for word in words) and words[1:3] != ["job", "run"]
        return [*words, "--no-gdal"] if reads_alone and not self.takes_gdal and "--no-gdal" not in words else words


def limit(what, size):
    """For run(): no more than so many bytes. Python has SIGXFSZ ignored, and so has what it starts."""
    return {"preexec_fn": lambda: resource.setrlimit(what, (size, size)), "restore_signals": False}


def send_once_caught(job, which, delay):
    """Sends a signal some seconds after the program has begun to catch it, which a busy machine may put off."""
    end = time.monotonic() + 60
    status = Path(f"/proc/{job.pid}/status")
    while status.exists() and time.monotonic() < end:
        caught = re.search(r"^SigCgt:\s*(\w+)$", status.read_text(encoding="ascii"), re.MULTILINE)
        if job.poll() is not None or caught is None or int(caught[1], 16) >> (which - 1) & 1:
            break
        time.sleep(0.01)
    time.sleep(delay)
    job.send_signal(which)


def is_failure(run, sentence):
    assert run.returncode == 1
    assert re.fullmatch(r"hmesh(-terrain)?: .*\n", run.stderr) and sentence in run.stderr
    assert not list(Path().rglob("*.hmesh-part*"))


@pytest.fixture
def hmesh(pictures, tmp_path, monkeypatch, pytestconfig):
    shutil.copytree(pictures, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return Command(program(pytestconfig, "hmesh"))


@pytest.fixture
def terrain(tmp_path, monkeypatch, pytestconfig):
    """hmesh-terrain in a folder without a file."""
    if not pytestconfig.getoption("terrain"):
        pytest.skip("--terrain is not given")
    monkeypatch.chdir(tmp_path)
    return Terrain(program(pytestconfig, "terrain"))


# ---- files ----
@pytest.fixture
def full(tmp_path):
    """A full disk. Nobody but root could replace the system's by a file; root gets one of its own."""
    file = tmp_path / "full"
    try:
        if os.geteuid() == 0:
            os.mknod(file, stat.S_IFCHR | 0o666, os.makedev(1, 7))
        else:
            file.symlink_to("/dev/full")
        file.write_bytes(b"x")
    except OSError as error:
        if error.errno == errno.ENOSPC:
            return file
    pytest.skip("no full device can be made here")


def as_others():
    """For preexec_fn: root may write everywhere, until it has given that right up for what it executes."""
    drop_from_bounding_set, override_access = 24, 1  # of Linux's prctl() and capabilities
    if os.geteuid() == 0 and ctypes.CDLL(None).prctl(drop_from_bounding_set, override_access, 0, 0, 0) != 0:
        raise OSError("root cannot give up its rights here")


def read(name):
    return Path(name).read_bytes()


def contents():
    """Of all files in the folder."""
    return {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}


def ply_header(name):
    header, end, _ = read(name).partition(b"end_header\n")
    assert header.startswith(b"ply\n") and end
    return header.decode().splitlines()


def is_png(name, size=None):
    image = Image.open(name)
    image.load()
    return image.format == "PNG" and size in (None, image.size)


def is_whole(name):
    """Whether the file begins as its kind does, and its end is there."""
    file = read(name)
    kind = name.rpartition(".")[2]
    if kind == "ply":
        return bool(ply_header(name))
    if kind == "glb":
        magic, _, size, chunk = struct.unpack_from("<4s3I", file)
        return magic == b"glTF" and size == len(file) and "meshes" in json.loads(file[20 : 20 + chunk])
    begin, end = {"obj": (rb"# made by hmesh", rb"\nf \d+ \d+ \d+\n"), "pdf": (rb"%PDF-1", rb"%%EOF\n"),
                  "eps": (rb"%!PS-Adobe-3.0 EPSF-3.0", rb"%%EOF\n"), "svg": (rb"<svg ", rb"</svg>\n"),
                  "html": (rb"<!DOCTYPE html>", rb"</html>\n"), "hmc": (b"\x9dHMC\1\0", rb"")}[kind]
    return file.startswith(begin) and re.search(end + rb"\Z", file) is not None


def rows(table):
    """The cells of lines such as 'a | b'."""
    return [tuple(cell.strip() for cell in line.split("|")) for line in table.strip().splitlines()]
