"""The bar on a terminal: one over the whole run, on one line at any width."""
import re

import pytest

from terminal import shown


def drawn_at(columns, words, environment=None, shows_output=False):
    """What a program draws on a terminal of this width: its status, and the texts between returns."""
    status, printed = shown(words, columns, environment, shows_output)
    return status, printed.decode().split("\r")


def check_bar(columns, lines):
    """Never as wide as the terminal, never a step back, 100 % at the end, then wiped."""
    assert not [line for line in lines if len(line) >= max(columns, 1) or "\n" in line]
    percents = [int(found[1]) for line in lines if (found := re.search(r"(\d+)(?: %|$)", line.rstrip()))]
    if columns >= 4:
        assert percents == sorted(percents) and percents[-1] == 100
        assert 0 < len(percents) and percents[0] < 50
    assert lines[-1] == "" and (len(lines) < 2 or not lines[-2].strip())
    return percents


@pytest.mark.parametrize("columns", [1, 2, 3, 4, 5, 6, 10, 17, 18, 19, 24, 40, 80, 200])
def test_the_bar_is_one_line_at_any_width(hmesh, columns):
    status, lines = drawn_at(columns, hmesh.words("large.png --effort draft"))
    assert status == 0
    check_bar(columns, lines)


@pytest.mark.parametrize("columns", [10, 40, 80])
@pytest.mark.parametrize("arguments", [
    "--effort fast --psnr 34", "--rate 2 -o a.ply -o a.glb -o a.html --render r.png --strip s.png",
    "--rate 2 --fit-space linear", "--method adams --psnr 25", "--method hierarchical", "--method xie"])
def test_one_bar_runs_over_all_stages_runs_and_files(hmesh, arguments, columns):
    status, lines = drawn_at(columns, hmesh.words("large.png " + arguments))
    assert status == 0
    percents = check_bar(columns, lines)
    assert len(set(percents)) >= 2
    if columns == 80:
        assert re.fullmatch(r"\[\.+\]   0 %, reading *", lines[1])
        assert re.search(r"\[#+\.*\] +\d+ %, .*\d+ vertices", "\n".join(lines))


def test_the_bar_tells_the_time_to_go_after_a_second(hmesh):
    status, lines = drawn_at(80, hmesh.words("large.png --rate 20 --effort fine --threads 1"))
    assert status == 0
    check_bar(80, lines)
    assert re.search(r"\d+ %, \d+:\d\d to go, \w+, \d+ vertices", "\n".join(lines))


def test_without_the_size_of_a_terminal_the_bar_keeps_to_the_variable_columns(hmesh):
    for columns in [20, 60]:
        status, lines = drawn_at(0, hmesh.words("large.png"), {"COLUMNS": str(columns)})
        assert status == 0
        check_bar(columns, lines)
        assert max(map(len, lines)) > columns // 3
    for columns in ["", "-3", "word", "0", "99999999999999999999"]:
        check_bar(80, drawn_at(0, hmesh.words("large.png"), {"COLUMNS": columns})[1])


@pytest.mark.parametrize("arguments, sentence", [
    ("no.png", "cannot read 'no.png'"), ("text.png", "cannot read 'text.png'"),
    ("picture.png --psnr 900", "no mesh of this image reached"), ("picture.png -o none/a.ply", "cannot write")])
def test_errors_stand_on_a_line_of_their_own(hmesh, arguments, sentence):
    status, lines = drawn_at(80, hmesh.words(arguments))
    assert status == 1
    errors = [line for line in lines if "hmesh:" in line]
    assert len(errors) == 1 and errors[0].startswith("hmesh: ") and sentence in errors[0]
    assert lines[-1] == "\n" and not lines[lines.index(errors[0]) - 1].strip()


def test_there_is_no_bar_where_none_is_wanted(hmesh):
    assert drawn_at(80, hmesh.words("picture.png --quiet")) == (0, [""])
    assert hmesh.run("picture.png").stderr == ""


def check_wiped_before(lines, place):
    """Whether the text stands on a line of its own, after a bar that was at 100 % and then wiped, or after no bar."""
    before = [line for line in lines[:place] if line.strip()]
    assert not lines[place - 1].strip()
    assert not before or not before[-1].startswith("[") or "100 %" in before[-1]


@pytest.mark.parametrize("options", ["", "--json", "-o {name}.ply --report -", "--quiet"])
def test_each_of_several_images_has_a_bar_that_is_wiped_before_its_line(hmesh, options):
    images = ["picture.png", "large.png", "grey.pgm"]
    if "-o" in options:  # the standard output is one file
        images = ["large.png"]
    status, lines = drawn_at(80, hmesh.words(" ".join(images) + " --effort draft " + options), shows_output=True)
    assert status == 0
    if options == "--quiet":
        assert lines == [""]
        return
    text = {"--json": r'\{"version"', "": r"[\w.]+: \d+ vertices"}.get(options, r"image +large\.png")
    places = [at for at, line in enumerate(lines) if re.match(r"\n?" + text, line)]
    assert len(places) == len(images)
    for place in places:
        check_wiped_before(lines, place)
    assert sum("100 %, done" in line for line in lines) == len(images)


def test_what_goes_to_the_terminal_as_a_file_and_the_summary_beside_it_do_not_meet_the_bar(hmesh):
    status, lines = drawn_at(80, hmesh.words("large.png --vertices 20 -o - --format obj"), shows_output=True)
    assert status == 0
    begin, = [at for at, line in enumerate(lines) if line.startswith("# made by")]
    assert not lines[begin - 1].strip()
    summary, = [at for at, line in enumerate(lines) if line.lstrip("\n").startswith("image     large.png")]
    check_wiped_before(lines, summary)


def test_of_several_images_one_that_fails_has_its_sentence_on_a_line_of_its_own(hmesh):
    status, lines = drawn_at(80, hmesh.words("large.png no.png picture.png --effort draft"), shows_output=True)
    assert status == 1
    errors = [at for at, line in enumerate(lines) if "hmesh: cannot read 'no.png'" in line]
    assert len(errors) == 1 and lines[errors[0]].startswith("hmesh: ") and not lines[errors[0] - 1].strip()
    assert lines[-1] == "\n" and lines[-2].strip() == "hmesh: 1 of 3 images failed"
