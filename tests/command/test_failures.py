"""What cannot be read, meshed or written, and Ctrl-C."""
import contextlib
import fcntl
import json
import os
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
from pathlib import Path

import pytest
from PIL import Image

from conftest import FORMATS, as_others, contents, is_failure, is_png, is_whole, limit, ply_header, program, read, rows, send_once_caught

FAILURES = rows("""
    'missing.png'                                     | missing.png -o keep.ply
    'empty.png'                                       | empty.png -o keep.ply
    'text.png'                                        | text.png -o keep.ply
    'short.ppm': the file ends before its last pixel  | short.ppm -o keep.ply
    'huge.pgm': the image is too wide                 | huge.pgm -o keep.ply
    'above.pgm'                                       | above.pgm -o keep.ply
    '.'                                               | . -o keep.ply
    'missing.png'                                     | grey.pgm --weights missing.png -o keep.ply
    'text.png'                                        | grey.pgm --weights text.png -o keep.ply
    'constant.pgm' are 8 x 8 px, the image is 20 x 16 px | grey.pgm --weights constant.pgm -o keep.ply --depfile new.d
    'black.pgm' are all zero                          | grey.pgm --weights black.pgm -o keep.ply
    'nan.pfm' have a sample that is NaN or infinite, in row 14 | grey.pgm --weights nan.pfm -o keep.ply
    'nan.pfm' has a sample that is NaN or infinite, in row 14 | grey.pgm --with nan.pfm -o keep.ply
    'mesh.hmc': it is a mesh, and no image            | grey.pgm --weights mesh.hmc -o keep.ply
    --vertices 321                                    | grey.pgm -o keep.ply --vertices 321
    limit 320                                         | grey.pgm -o keep.ply --vertices 321
    'nowhere/mesh.ply'                                | grey.pgm -o nowhere/mesh.ply
    'nowhere/r.d'                                     | grey.pgm -o new.ply --depfile nowhere/r.d
    'nowhere/r.json'                                  | grey.pgm -o new.ply --report nowhere/r.json
    which those of 2 or 4 channels have               | color.ppm --vertices 40 --premultiplied -o new.ply
    nothing is written                                | grey.pgm -o new.ply --psnr 99 --depfile new.d
    """)


@pytest.mark.parametrize("sentence, arguments", FAILURES)
def test_a_failure_is_told_in_one_sentence_and_writes_nothing(hmesh, sentence, arguments):
    before = contents()
    hmesh.fails(sentence, arguments)
    assert contents() == before


@pytest.mark.skipif(not Path("/dev/zero").is_char_device(), reason="there is no /dev/zero")
def test_what_is_no_image_is_refused_before_its_end(hmesh):
    hmesh.fails("'/dev/zero': it is in no format", "/dev/zero -o new.ply", **hmesh.within_memory(1 << 30))


def test_a_folder_is_not_written(hmesh):
    Path("folder.ply").mkdir()
    hmesh.fails("'folder.ply'", "grey.pgm -o folder.ply")


def test_a_locked_folder_is_not_written(hmesh):
    Path("locked").mkdir(0o555)
    hmesh.fails("'locked/mesh.ply'", "grey.pgm -o locked/mesh.ply", preexec_fn=as_others)


@pytest.mark.parametrize("arguments", [*(f"-o x.{kind}" for kind in FORMATS), "--render x.png", "--wireframe x.png",
                                       "--residual x.png", "--strip x.png", "--report x.json", "--report full"])
def test_a_full_disk_is_the_reason_and_is_not_replaced(hmesh, full, arguments):
    file = Path(arguments.split()[1])
    if file.name != full.name:
        file.symlink_to(full)
    hmesh.fails(f"'{file}': No space left", f"grey.pgm {arguments}")
    assert file.is_char_device() and file.is_symlink() == (file.name != full.name)


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no /dev/full")
def test_a_full_standard_output_is_a_failure(hmesh):
    with open("/dev/full", "wb") as file:
        hmesh.fails("standard output", "grey.pgm", stdout=file)


@pytest.mark.parametrize("kind", FORMATS)
def test_a_disk_that_fills_up_leaves_what_was_there(hmesh, kind):
    Path(f"keep.{kind}").write_text("old")
    # 512 bytes are less than any of these files.
    hmesh.fails(f"'keep.{kind}'", f"picture.png --vertices 100 -o keep.{kind}", **limit(resource.RLIMIT_FSIZE, 512))
    assert read(f"keep.{kind}") == b"old"


def test_where_there_is_no_memory_one_sentence_says_so(hmesh):
    within = hmesh.within_memory(1024**3)
    Path("flat.pgm").write_bytes(b"P5 1024 1024 255\n" + bytes(1024**2))
    hmesh.fails("memory", "flat.pgm --vertices 4 --effort draft --render none.png --render-scale 16", **within)  # takes 1 GiB
    assert not Path("none.png").exists()


def interrupt(hmesh, arguments, sentence, which=signal.SIGINT, delay=1):
    """Ctrl-C or another signal after some seconds of what takes more than five on any machine: two threads, however many cores there are."""
    with subprocess.Popen(hmesh.words(f"large.png --threads 2 {arguments}"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          encoding="utf-8") as job:
        send_once_caught(job, which, delay)
        out, err = job.communicate(timeout=60)
    is_failure(subprocess.CompletedProcess(job.args, job.returncode, out, err), f": interrupted; {sentence}")


LONG = "--effort best --vertices 6000"


def test_ctrl_c_leaves_all_files_as_they_are(hmesh):
    before = contents()
    interrupt(hmesh, f"{LONG} -o keep.ply -o new.ply --render new.png --report new.json --depfile new.d", "nothing is written")
    assert contents() == before


@pytest.mark.parametrize("which", [signal.SIGTERM, signal.SIGHUP])
def test_a_request_to_end_is_as_ctrl_c(hmesh, which):
    before = contents()
    interrupt(hmesh, f"{LONG} -o keep.ply", "nothing is written", which)
    assert contents() == before


@pytest.mark.parametrize("target, most", [("--vertices 6000", 6000), ("--rate 9.3765", 6001)])  # 6000.96 of 64,000 px
def test_ctrl_c_with_keep_partial_writes_the_mesh_reached_so_far_within_its_budget(hmesh, target, most):
    reached = []
    for delay in [0.2, 0.5, 1]:  # best inserts three times as many at first: one run at least is brought to its budget
        interrupt(hmesh, f"-o cut.ply --effort best {target} --report cut.json --keep-partial", "the mesh reached so far, ", delay=delay)
        report = json.loads(read("cut.json"))
        assert report["status"] == "interrupted" and f"element vertex {report['vertices']}" in ply_header("cut.ply")
        reached.append(report["vertices"])
    assert max(reached) == most


def test_ctrl_c_with_keep_partial_leaves_the_colours_that_a_method_has(hmesh):
    image = Image.effect_noise((600, 450), 60)
    image.save("large.png")
    for delay in [0.5, 1, 1.5, 3, 6, 12, 24]:  # begins with all pixels, and is brought to its budget: sooner or later by the compiler
        interrupt(hmesh, "-o cut.ply --vertices 900 --method adaptive_thinning --report cut.json --keep-partial", "the mesh", delay=delay)
        report = json.loads(read("cut.json"))
        assert report["colors"] == "sampled"
        if report["vertices"] == 900:
            break
    assert report["vertices"] == 900
    for x, y, _, value in struct.iter_unpack("<3fB", read("cut.ply").partition(b"end_header\n")[2][:13 * 900]):
        x, y = min(599, max(0, x - 0.5)), min(449, max(0, 449.5 - y))
        i, j = min(598, int(x)), min(448, int(y))
        near = [[image.getpixel((i + k, j + m)) for k in (0, 1)] for m in (0, 1)]
        above, below = [left + (x - i) * (right - left) for left, right in near]
        assert abs(above + (y - j) * (below - above) - value) < 0.51


@pytest.mark.parametrize("method", ["hierarchical", "xie", "adams", "adaptive_thinning"])
def test_ctrl_c_while_a_method_of_the_paper_runs_is_as_while_the_usual_one_does(hmesh, method):
    Image.open("picture.png").resize((2000, 2000)).save("large.png", compress_level=1)
    before = contents()
    arguments = f"--method {method} --vertices 9000 -o keep.ply --report new.json"
    interrupt(hmesh, arguments, "nothing is written, as --keep-partial is not given", delay=0.2)
    assert contents() == before
    interrupt(hmesh, f"{arguments} --keep-partial", "the mesh reached so far, ", delay=0.2)
    report = json.loads(read("new.json"))
    assert report["status"] == "interrupted" and report["vertices"] <= 9000
    assert f"element vertex {report['vertices']}" in ply_header("keep.ply")


def test_ctrl_c_in_a_search_with_keep_partial_writes_the_mesh_reached_so_far(hmesh):
    interrupt(hmesh, "-o search.ply --psnr 60 --effort best --keep-partial", "the mesh reached so far, ")
    assert is_whole("search.ply")


def test_what_a_killed_run_leaves_behind_is_in_nobodys_way(hmesh):
    for number in range(100):
        Path(f"keep.ply.hmesh-part{number}").write_bytes(b"left behind")
    hmesh.done("grey.pgm --vertices 40 -o keep.ply")
    assert is_whole("keep.ply")
    with open("keep.ply.hmesh-part1", "r+b") as taken:  # of a run that still goes on
        fcntl.flock(taken, fcntl.LOCK_EX)
        hmesh.done("grey.pgm --vertices 41 -o keep.ply")
        hmesh.done("grey.pgm --vertices 42 -o keep.ply")
    assert is_whole("keep.ply") and read("keep.ply.hmesh-part1") == b"left behind"
    Path("link.glb").symlink_to("not_there.ply")
    run = hmesh.run("grey.pgm -o not_there.ply -o link.glb")
    assert run.returncode == 2 and "named for two outputs" in run.stderr and not Path("not_there.ply").exists()
    Path("other").write_bytes(b"somebody's")
    Path("linked.ply.hmesh-part0").symlink_to("other")
    os.link("other", "linked.ply.hmesh-part1")
    hmesh.done("grey.pgm --vertices 40 -o linked.ply")
    assert read("other") == b"somebody's"


def test_runs_that_write_one_file_at_once_each_write_it_whole(hmesh):
    """Who finds another's part between its last byte and its name would take it over, and rename what is there no more."""
    whole = set()
    for vertices in [40, 41]:
        hmesh.done(f"grey.pgm --effort draft --vertices {vertices} -o shared.ply")
        whole.add(read("shared.ply"))
    for _ in range(10):
        runs = [subprocess.Popen(hmesh.words(f"grey.pgm --effort draft --vertices {40 + k % 2} -o shared.ply -q"), stderr=subprocess.PIPE)
                for k in range(12)]
        assert [(run.communicate(timeout=60)[1], run.returncode) for run in runs] == [(b"", 0)] * 12
        assert read("shared.ply") in whole
    assert not list(Path().glob("*.hmesh-part*"))


def has_bytes(name):
    with contextlib.suppress(FileNotFoundError):
        return Path(name).stat().st_size > 0
    return False


def test_an_interrupt_while_files_are_written_leaves_all_as_they_were(hmesh):
    hmesh.done("large.png --effort draft --vertices 50 -o a.ply --render r.png")
    before = contents()
    with subprocess.Popen(hmesh.words("large.png --effort draft --vertices 60 -o a.ply --render r.png --render-scale 8 -q"),
                          stderr=subprocess.PIPE) as run:
        while run.poll() is None and not has_bytes("a.ply.hmesh-part0"):
            time.sleep(0.001)
        run.send_signal(signal.SIGTERM)
        assert run.wait() == 1 and re.search(rb"cannot write '(a\.ply|r\.png)': interrupted", run.stderr.read())
    assert contents() == before


def test_a_folder_that_another_run_takes_away_is_made_again(hmesh):
    with subprocess.Popen(hmesh.words("large.png --effort fast -o 'out/{name}/a.ply' -q")) as run:
        while run.poll() is None and not Path("out").exists():
            time.sleep(0.001)
        while Path("out").exists() and run.poll() is None:  # its test of the file keeps it there at first
            with contextlib.suppress(OSError):
                os.removedirs("out/large")
        assert run.wait() == 0
    assert is_whole("out/large/a.ply")


def test_a_pipe_has_all_of_its_file_before_the_next_one_is_written(hmesh):
    os.mkfifo("a.fifo")
    os.mkfifo("b.fifo")
    with subprocess.Popen(["cat", "a.fifo", "b.fifo"], stdout=subprocess.PIPE) as reader:
        hmesh.done("grey.pgm -o a.fifo --format ply --report b.fifo -q")
        assert reader.stdout.read().startswith(b"ply") and reader.wait() == 0


def test_what_is_no_part_of_an_output_is_left_alone(hmesh):
    shutil.copy("grey.pgm", "a.ply.hmesh-part0")
    run = hmesh.run("a.ply.hmesh-part0 -o a.ply")
    assert run.returncode == 2 and "has not finished writing" in run.stderr and read("a.ply.hmesh-part0") == read("grey.pgm")
    Path("a.ply.hmesh-part0").unlink()
    Path("a.ply.part0").write_text("precious")
    long_name = "ä" * 125 + ".ply"  # 254 bytes
    hmesh.done(f"grey.pgm -o a.ply -o {long_name}")
    assert read("a.ply.part0") == b"precious" and read(long_name) == read("a.ply")


def test_a_run_that_is_ended_at_any_moment_leaves_the_old_file_or_the_new_one(hmesh):
    """HMESH_KILLS of each kind, at moments spread over a run."""
    def run(vertices):
        return subprocess.Popen(hmesh.words(f"large.png --effort draft --vertices {vertices} -o a.ply -o a.html -q"),
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    begin = time.monotonic()
    assert run(900).wait() == 0
    seconds = time.monotonic() - begin
    old = {name: read(name) for name in ["a.ply", "a.html"]}
    assert run(901).wait() == 0
    new = {name: read(name) for name in old}
    kills = int(os.environ.get("HMESH_KILLS", "5"))
    for which in [signal.SIGINT, signal.SIGTERM, signal.SIGKILL]:
        for k in range(kills):
            for name, content in old.items():
                Path(name).write_bytes(content)
            with run(901) as job:
                time.sleep(1.2 * seconds * (k + 1) / kills)
                job.send_signal(which)
            assert all(read(name) in [old[name], new[name]] for name in old)
    assert run(901).wait() == 0 and {name: read(name) for name in old} == new
    left = [path.name for path in Path().glob("a.*.hmesh-part*")]
    assert left == []


def test_scene_draws_the_same_bytes_twice_and_says_what_it_cannot_do(hmesh, pytestconfig):
    def scene(*words):
        return subprocess.run([program(pytestconfig, "scene"), *words], capture_output=True, encoding="utf-8")

    assert scene("again.png", "96", "64").returncode == 0
    assert is_png("again.png", (96, 64)) and read("again.png") == read("picture.png")
    assert scene("zero.png", "0", "64").returncode == 2
    run = scene("missing/picture.png", "8", "8")
    assert run.returncode == 1 and "missing/picture.png" in run.stderr
