"""Several images in one run, and the most vertices of a search."""
import json
import math
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from PIL import Image

from conftest import contents, is_png, is_whole, ply_header, read

THREE = "picture.png grey.pgm rgba.tga"


def lines(text):
    return [json.loads(line) for line in text.splitlines()]


def test_each_image_has_files_of_its_own_the_same_as_alone_and_one_line(hmesh):
    out = hmesh.done(THREE + " --rate 5 -o out/{name}.glb -o {name}/mesh.{name}.ply --render new/deep/{name}.png"
                             " --report {name}.json --depfile {name}.d")
    said = out.splitlines()
    assert len(said) == 3
    for line, file in zip(said, THREE.split()):
        name = file[:-4]
        files = [f"out/{name}.glb", f"{name}/mesh.{name}.ply", f"new/deep/{name}.png", f"{name}.json", f"{name}.d"]
        report = json.loads(read(f"{name}.json"))
        assert re.fullmatch(rf"{file}: {report['vertices']} vertices, [\d.]+ dB, [\d.]+ s, written {', '.join(files)}", line)
        assert report["input"] == file and f"element vertex {report['vertices']}" in ply_header(files[1])
        assert f"{file}\n" in read(f"{name}.d").decode()
        hmesh.done(f"{file} --rate 5 -o alone.glb --render alone.png")
        assert read("alone.glb") == read(files[0]) and read("alone.png") == read(files[2])


def test_one_image_is_told_of_as_ever_and_its_name_may_be_a_pattern_too(hmesh):
    assert "written   out/grey.ply\n" in hmesh.done("grey.pgm -o out/{name}.ply")
    assert is_whole("out/grey.ply")


def test_where_one_fails_the_others_are_meshed_and_the_sentences_are_told_at_once(hmesh):
    run = hmesh.run("grey.pgm text.png missing.png picture.png short.ppm -o out/{name}.ply")
    assert run.returncode == 1
    assert [line.partition(":")[0] for line in run.stdout.splitlines()] == ["grey.pgm", "picture.png"]
    *sentences, total = run.stderr.splitlines()
    assert [re.match(r"hmesh: cannot read '(.*?)'", line)[1] for line in sentences] == ["text.png", "missing.png", "short.ppm"]
    assert total == "hmesh: 3 of 5 images failed"
    assert sorted(path.name for path in Path("out").iterdir()) == ["grey.ply", "picture.ply"]


def test_what_cannot_be_meshed_or_written_fails_alone(hmesh):
    Path("folder/grey.ply").mkdir(parents=True)
    run = hmesh.run("constant.pgm grey.pgm picture.png --vertices 100 -o folder/{name}.ply")
    assert run.returncode == 1 and [line.partition(":")[0] for line in run.stdout.splitlines()] == ["picture.png"]
    too_many, folder, total = run.stderr.splitlines()
    assert "'constant.pgm' with --vertices 100" in too_many and "'folder/grey.ply'" in folder
    assert total == "hmesh: 2 of 3 images failed"


def test_a_folder_that_stayed_empty_is_none(hmesh):
    before = contents()
    assert hmesh.run("text.png constant.pgm --vertices 100 -o new/deep/{name}.ply").returncode == 1
    assert not Path("new").exists() and contents() == before
    hmesh.fails("'nowhere/mesh.ply'", "grey.pgm -o nowhere/mesh.ply")  # a plain name makes none


def test_a_folder_that_cannot_be_made_is_told(hmesh):
    hmesh.fails("cannot make the folder 'grey.pgm/new'", "grey.pgm -o grey.pgm/new/{name}.ply")


def test_names_may_hold_braces_brackets_and_dots_and_are_taken_once(hmesh):
    names = ["{name}", "{name}{name}", "a.b", "[c]", "{", ".hidden", "-dash", "[d]"]
    files = [name + ".pgm" for name in names[:-1]] + ["[d]"]
    for file in files:
        shutil.copy("grey.pgm", file)
    out = hmesh.done(["-q", "-o", "out/{name}-{name}.ply", "--", *files])
    assert out == ""
    assert sorted(path.name for path in Path("out").iterdir()) == sorted(f"{name}-{name}.ply" for name in names)
    hmesh.done("grey.pgm -o {nam}.ply -o {NAME}.ply -o }{.ply")
    assert is_whole("{nam}.ply") and is_whole("{NAME}.ply") and is_whole("}{.ply")


def test_weights_are_one_for_all_or_one_for_each(hmesh):
    hmesh.done("grey.pgm color.ppm -o {name}.ply --weights grey.pgm")
    Path("masks").mkdir()
    for name in ["grey", "color"]:
        shutil.copy("grey.pgm", f"masks/{name}.pgm")
    hmesh.done("grey.pgm color.ppm -o out/{name}.ply --weights masks/{name}.pgm")
    assert read("grey.ply") == read("out/grey.ply") and read("color.ply") == read("out/color.ply")
    run = hmesh.run("grey.pgm picture.png --weights masks/{name}.pgm")
    assert "cannot read 'masks/picture.pgm'" in run.stderr and run.stdout.startswith("grey.pgm: ")


def test_the_standard_input_may_be_one_of_several_and_is_called_stdin(hmesh):
    with open("grey.pgm", "rb") as stream:
        assert hmesh.run("picture.png - -o out/{name}.ply", stdin=stream).returncode == 0
    assert is_whole("out/stdin.ply") and is_whole("out/picture.ply")


def test_json_is_a_line_for_each_image_in_place_of_the_summary(hmesh):
    reports = lines(hmesh.done(THREE + " --rate 5 --json -o out/{name}.ply --report {name}.json"))
    assert [report["input"] for report in reports] == THREE.split()
    for report in reports:
        assert report == json.loads(read(report["input"][:-4] + ".json"))
    alone, = lines(hmesh.done("grey.pgm --json --quiet"))
    assert alone["input"] == "grey.pgm" and alone["status"] == "ok"


def test_json_tells_of_failures_too(hmesh):
    run = hmesh.run("grey.pgm text.png constant.pgm --vertices 100 --json")
    assert run.returncode == 1
    good, text, constant = lines(run.stdout)
    assert good["status"] == "ok" and good["vertices"] == 100
    assert list(text) == list(constant) == ["version", "input", "status"]
    assert text["input"] == "text.png" and text["status"].startswith("cannot read 'text.png': ")
    assert "--vertices 100" in constant["status"] and run.stderr.count("\n") == 3
    assert [line[7:] for line in run.stderr.splitlines()[:2]] == [text["status"], constant["status"]]
    run = hmesh.run("picture.png --psnr 60 --max-vertices 50 --effort draft --json")
    missed, = lines(run.stdout)  # of the mesh that there is
    assert run.returncode == 1 and 4 <= missed["vertices"] <= 50 and missed["status"] in run.stderr and missed["psnr"] < 60


def test_quiet_says_what_fails_and_nothing_else(hmesh):
    assert hmesh.done(THREE + " -o {name}.ply -q") == ""
    run = hmesh.run("grey.pgm text.png -q")
    assert run.stdout == "" and run.stderr.count("\n") == 2


def test_several_images_that_change_nothing_are_found_alike_in_thousands(hmesh):
    """Clashes are looked for among all names: it must not take their square."""
    Path("many").mkdir()
    for k in range(1500):
        Path(f"many/{k}.pgm").write_bytes(b"P5 1 1 255\nA")
    words = [f"many/{k}.pgm" for k in range(1500)]
    begin = time.monotonic()
    run = hmesh.run([*words, "many/../many/7.pgm", "-o", "out/{name}.ply", "--report", "out/{name}.json"])
    assert run.returncode == 2 and "'many/7.pgm' and 'many/../many/7.pgm' would both become 'out/7.ply'" in run.stderr
    assert time.monotonic() - begin < 5


def test_an_output_that_is_an_input_by_another_link_is_refused(hmesh):
    for kind, link in {"hard": os.link, "soft": os.symlink}.items():
        Path(kind).mkdir()
        link(Path("picture.png").absolute(), f"{kind}/grey.png")
        run = hmesh.run(f"picture.png grey.pgm --render {kind}/{{name}}.png")
        assert run.returncode == 2 and f"'{kind}/grey.png' would overwrite the input" in run.stderr


@pytest.mark.parametrize("keep", ["", "--keep-partial"])
def test_an_interrupt_ends_the_whole_run(hmesh, keep):
    Image.effect_noise((500, 400), 60).save("slow.png")
    with subprocess.Popen(hmesh.words(f"grey.pgm slow.png picture.png -o out/{{name}}.ply --effort best --rate 20 {keep}"),
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8") as job:
        first = job.stdout.readline()
        time.sleep(1)
        job.send_signal(signal.SIGINT)
        out, err = job.communicate(timeout=60)
    assert job.returncode == 1 and first.startswith("grey.pgm: ")
    sentence, total = err.splitlines()
    assert "'slow.png' with" in sentence and ": interrupted; " in sentence
    assert total == "hmesh: 1 of 3 images failed, and 1 of 3 images were not begun"
    assert out.startswith("slow.png: ") if keep else out == ""
    assert sorted(path.name for path in Path("out").iterdir()) == ["grey.ply", *(["slow.ply"] if keep else [])]


def test_where_nobody_reads_the_lines_the_run_ends(hmesh):
    ours, its = os.pipe()
    os.close(ours)
    with os.fdopen(its, "wb") as gone:
        run = hmesh.run(THREE + " -o out/{name}.ply", stdout=gone)
    assert run.returncode == 1 and "Broken pipe" in run.stderr
    assert run.stderr.splitlines()[-1] == "hmesh: 1 of 3 images failed, and 2 of 3 images were not begun"
    assert [path.name for path in Path("out").iterdir()] == ["picture.ply"]


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no /dev/full")
def test_where_the_line_of_a_failure_finds_no_space_the_run_ends_and_says_so(hmesh):
    with open("/dev/full", "wb") as file:
        run = hmesh.run("text.png grey.pgm -o out/{name}.ply --json", stdout=file)
    unread, untold, total = run.stderr.splitlines()
    assert run.returncode == 1 and unread.startswith("hmesh: cannot read 'text.png': ")
    assert untold == "hmesh: cannot write to the standard output: No space left on device"
    assert total == "hmesh: 1 of 2 images failed, and 1 of 2 images were not begun"
    assert not Path("out").exists()


def test_one_image_that_takes_too_much_memory_fails_alone(hmesh):
    within = hmesh.within_memory(1024**3)
    Path("flat.pgm").write_bytes(b"P5 1024 1024 255\n" + bytes(1024**2))
    run = hmesh.run("flat.pgm grey.pgm --vertices 4 --effort draft --render {name}.png --render-scale 16", **within)
    assert run.returncode == 1 and is_png("grey.png") and not Path("flat.png").exists()
    assert "'flat.pgm': there is not enough memory" in run.stderr


# ---- the most vertices of a search ----
def test_a_search_stays_within_the_most_vertices_and_says_where_they_do_not_reach(hmesh):
    needed = hmesh.report("picture.png --psnr 26")["vertices"]
    most = needed // 2
    run = hmesh.run(f"picture.png --max-vertices {most} --psnr 26 -o bound.ply --report bound.json")
    report = json.loads(read("bound.json"))
    assert run.returncode == 1
    assert f"--psnr 26 --max-vertices {most} " in run.stderr and "no mesh of so few vertices reached" in run.stderr
    assert f"{most} vertices and {report['psnr']:.2f} dB, is written" in run.stderr
    assert report["vertices"] == most and report["psnr"] < 26 and "so few vertices" in report["status"]
    assert re.search(r" \(2\d\.\d+, limit 26\)$", report["status"])
    assert report["target"] == f"--psnr 26 --max-vertices {most}"
    assert f"element vertex {most}" in ply_header("bound.ply")
    plain = hmesh.report(f"picture.png --vertices {most}")["psnr"]
    assert math.isclose(report["psnr"], plain, abs_tol=0.3)


def test_a_search_that_needs_fewer_or_an_image_that_has_fewer_pixels_is_not_bounded(hmesh):
    needed = hmesh.report("picture.png --psnr 24 -o free.ply")["vertices"]
    assert hmesh.report("picture.png --psnr 24 --max-vertices 100000 -o wide.ply")["vertices"] == needed
    assert read("wide.ply") == read("free.ply")
    reports = lines(hmesh.run("picture.png row.pgm grey.pgm --psnr 24 --max-vertices 1000 --json").stdout)
    assert [report["status"] for report in reports] == ["ok"] * 3


@pytest.mark.parametrize("method", ["hierarchical", "xie", "adams", "adaptive_thinning"])
def test_all_methods_stay_within_the_most_vertices(hmesh, method):
    run = hmesh.run(f"picture.png --method {method} --psnr 35 --max-vertices 50 --report r.json")
    assert run.returncode == 1 and json.loads(read("r.json"))["vertices"] == 50


def test_a_depfile_asks_for_the_psnr_within_the_bound(hmesh):
    before = contents()
    hmesh.fails("as --depfile asks for whole results", "picture.png --psnr 35 --max-vertices 50 -o keep.ply --depfile a.d")
    assert contents() == before
