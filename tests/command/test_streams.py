"""- : the standard input and output as files."""
import io
import json
import os
import pty
import signal
import struct
import subprocess
from pathlib import Path

import pytest
from PIL import Image

from conftest import FORMATS, contents, is_png, is_whole, read, send_once_caught


def piped(hmesh, arguments, image):
    """What it writes to a pipe, of an image from a pipe, and what it says."""
    run = subprocess.run(hmesh.words(arguments), input=image, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
    assert run.returncode == 0, run.stderr
    return run.stdout, run.stderr.decode()


@pytest.mark.parametrize("kind", FORMATS)
def test_a_mesh_from_pipe_to_pipe_is_that_from_file_to_file_and_the_summary_is_elsewhere(hmesh, kind):
    hmesh.done(f"picture.png --vertices 80 -o x.{kind}")
    out, said = piped(hmesh, f"- --vertices 80 -o - --format {kind}", read("picture.png"))
    if kind == "html":
        out = out.replace(b"standard input", b"picture.png")
    assert out == read(f"x.{kind}")
    assert "vertices  80\n" in said and said.endswith("written   -\n")
    assert piped(hmesh, f"- --vertices 80 -o - --format {kind} --quiet", read("picture.png"))[1] == ""


@pytest.mark.parametrize("file", ["grey16.pgm", "rgba.tga", "upright.jpg"])
def test_any_image_is_read_from_a_pipe_and_from_a_file_as_standard_input(hmesh, file):
    hmesh.done(f"{file} --vertices 12 -o named.ply")
    piped(hmesh, "- --vertices 12 -o piped.ply", read(file))
    with open(file, "rb") as stream:
        assert hmesh.run("- --vertices 12 -o led.ply", stdin=stream).returncode == 0
    assert read("piped.ply") == read("led.ply") == read("named.ply")


def test_a_tiff_file_of_more_than_a_megabyte_is_read_from_standard_input_wherever_that_begins(hmesh):
    Image.effect_noise((1100, 1000), 50).save("large.tif")
    if hmesh.run("large.tif --vertices 4 --effort draft -q").returncode != 0:
        pytest.skip("this build reads no TIFF")
    at, = struct.unpack_from("<I", read("large.tif"), 4)  # where the directory is, and before the file another, of a larger image
    if at > 60:
        pytest.skip("the directory is behind the pixels")
    directory = struct.pack("<HHHIIHHII", 2, 256, 4, 1, 99999999, 257, 4, 1, 8)
    Path("behind.tif").write_bytes((bytes(at) + directory).ljust(100, b"\0") + read("large.tif"))
    with open("behind.tif", "rb", buffering=0) as stream:
        stream.seek(100)
        assert hmesh.run("- --vertices 4 --effort draft -q", stdin=stream).returncode == 0


def test_the_report_of_standard_input_says_so_and_pictures_weights_and_reports_may_be_streams_too(hmesh):
    out, said = piped(hmesh, "- --vertices 40 --report -", read("picture.png"))
    assert json.loads(out)["input"] == "-" and "vertices  40" in said
    for option in ["--render", "--wireframe", "--residual", "--strip"]:
        out, _ = piped(hmesh, f"picture.png --vertices 40 {option} -", b"")
        assert Image.open(io.BytesIO(out)).format == "PNG"
    hmesh.done("picture.png --vertices 40 --weights picture.png -o named.ply")
    piped(hmesh, "picture.png --vertices 40 --weights - -o piped.ply", read("picture.png"))
    assert read("piped.ply") == read("named.ply")


def test_format_is_that_of_names_that_say_none_and_files_that_are_called_dash_have_a_folder(hmesh):
    hmesh.done("picture.png --vertices 40 -o x.obj -o x.glb")
    hmesh.done("picture.png --vertices 40 -o ./- -o mesh --format glb -o other.obj")
    assert read("-") == read("mesh") == read("x.glb") and read("other.obj") == read("x.obj")
    Path("-").write_bytes(read("grey.pgm"))
    assert "20 x 16" in hmesh.done("./-")
    for order in ["--format glb -o first", "-o first --format glb"]:
        hmesh.done(f"picture.png --vertices 40 {order}")
        assert read("first") == read("x.glb")


def test_the_image_of_standard_input_has_a_name_for_its_files(hmesh):
    piped(hmesh, "- --vertices 40 -o {name}.ply --render new/{name}.png", read("picture.png"))
    assert is_whole("stdin.ply") and is_png("new/stdin.png", (96, 64))


def test_options_of_a_format_hold_for_the_standard_output(hmesh):
    hmesh.done("picture.png --vertices 40 -o x.svg --svg flat")
    assert piped(hmesh, "picture.png --vertices 40 -o - --format svg --svg flat", b"")[0] == read("x.svg")
    hmesh.done("picture.png --vertices 40 -o x.html --no-original")
    assert piped(hmesh, "picture.png --vertices 40 -o - --format html --no-original", b"")[0] == read("x.html")
    hmesh.done("picture.png --vertices 40 -o x.glb --fit-space each")
    out, said = piped(hmesh, "picture.png --vertices 40 -o - --format glb --fit-space each", b"")
    assert out == read("x.glb") and "PSNR .glb" in said


@pytest.mark.parametrize("image, sentence", [(b"", "cannot read the standard input: it is empty"),
                                             (b"no image", "cannot read the standard input: it is in no format"),
                                             (b"P6\n20 16\n255\nshort", "cannot read the standard input: the file ends before")])
def test_what_is_wrong_with_the_standard_input_is_told(hmesh, image, sentence):
    with open("stream", "wb+") as stream:
        stream.write(image)
        stream.seek(0)
        hmesh.fails(sentence, "- -o keep.ply", stdin=stream)
    assert read("keep.ply") == b"old\n"


def closed(number):
    return {"preexec_fn": lambda: os.close(number), **({"stdin": None} if number == 0 else {"stdout": None})}


def test_a_closed_stream_is_a_failure_and_no_file_takes_its_place(hmesh):
    hmesh.fails("cannot read the standard input", "- -o new.ply", **closed(0))
    hmesh.fails("cannot write to the standard output", "grey.pgm -o - --format ply", **closed(1))
    hmesh.fails("cannot write to the standard output", "grey.pgm -o new.ply", **closed(1))
    assert is_whole("new.ply")


def test_a_reader_that_goes_away_is_a_failure_in_one_sentence(hmesh):
    for arguments in ["picture.png --vertices 4000 -o - --format obj", "picture.png --vertices 20 --json", "grey.pgm",
                      "picture.png --vertices 20 --render -"]:
        ours, its = os.pipe()
        os.close(ours)
        with os.fdopen(its, "wb") as gone:
            hmesh.fails("cannot write to the standard output: Broken pipe", arguments, stdout=gone)


def test_help_for_a_reader_that_goes_away_ends_in_silence(hmesh):
    ours, its = os.pipe()
    os.close(ours)
    with os.fdopen(its, "wb") as gone:
        run = hmesh.run("--help", stdout=gone)
    assert (run.returncode, run.stderr) == (-signal.SIGPIPE, "")


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no /dev/full")
@pytest.mark.parametrize("arguments", [*(f"-o - --format {kind}" for kind in FORMATS), "--render -", "--report -", "--json"])
def test_a_full_standard_output_is_the_reason(hmesh, arguments):
    with open("/dev/full", "wb") as file:
        hmesh.fails("cannot write to the standard output: No space left", f"grey.pgm {arguments}", stdout=file)


def test_a_terminal_is_shown_text_and_is_no_image(hmesh):
    ours, its = pty.openpty()
    with os.fdopen(its, "wb+", buffering=0) as terminal:
        for output in ["-o - --format ply", "-o - --format glb", "-o - --format pdf", "-o - --format hmc", "--strip -",
                       "--render -", "--wireframe -", "--residual -"]:
            run = hmesh.run(f"grey.pgm {output}", stdout=terminal)
            assert run.returncode == 2 and "is a terminal, and ." in run.stderr
        assert hmesh.run("grey.pgm --vertices 4 -o x.ply -o - --format obj -q", stdout=terminal).returncode == 0
        assert os.read(ours, 9) == b"# made by"
        hmesh.fails("it is a terminal", "-", stdin=terminal)
    os.close(ours)


def test_a_device_may_be_named_for_several_outputs(hmesh):
    Path("nothing.png").symlink_to("/dev/null")
    hmesh.done("grey.pgm --vertices 4 --render nothing.png --strip nothing.png -q")
    assert Path("/dev/null").is_char_device()
    Path("nothing.png").unlink()
    assert hmesh.run("grey.pgm --vertices 4 --render nothing.png --strip nothing.png -q").returncode == 2


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_the_wait_for_an_image(hmesh, which):
    before = contents()
    with subprocess.Popen(hmesh.words("- -o keep.ply"), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          encoding="utf-8") as job:
        job.stdin.write("P5 20 16 255\n")
        job.stdin.flush()
        send_once_caught(job, which, 0.5)
        assert job.wait(timeout=10) == 1
        assert job.stderr.read() == "hmesh: cannot read the standard input: interrupted\n"
    assert contents() == before
