"""The manual page and completion, which are made of the help."""
import re
import shutil
import subprocess

import pytest

SHELLS = ["bash", "zsh", "fish"]


def options(hmesh):
    """The names of options that help lists, and whether they take a value."""
    found = re.findall(r"^  (?:(-\w),)?(--[\w-]+)(?: ([A-Z][\w.]*))? ", hmesh.done("--help"), re.M)
    assert len(found) > 25
    return {name: value != "" for short, long, value in found for name in (short, long) if name}


# ---- the manual page ----
def shown(page):
    """As man shows it on a wide terminal, without bold and underlined; its warnings are failures."""
    if shutil.which("groff") is None:
        pytest.skip("there is no groff")
    run = subprocess.run(["groff", "-man", "-Tascii", "-P-cbou", "-ww", "-rLL=250n", "-rHY=0"], input=page, capture_output=True,
                         encoding="utf-8", check=True)
    assert run.stderr == ""
    return run.stdout


def test_the_manual_page_has_the_sections_that_pages_have(hmesh):
    page = hmesh.done("--man")
    assert re.match(r'\.TH HMESH 1 "" "hmesh \d', page)
    sections = re.findall(r"^\.SH (.*)$", page, re.M)
    assert sections[:4] == ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS"] and "EXIT STATUS" in sections and "EXAMPLES" in sections
    assert re.search(r"^hmesh \\- [a-z].*[^.]$", page, re.M)  # what whatis and apropos read
    assert "`" not in page and not re.search(r"^\.(?!TH|SH|SS|TP|PP|B|RI|IR|nf|fi|RS|RE)", page, re.M)


def test_the_manual_page_says_all_that_the_help_says(hmesh):
    text = " ".join(re.sub(r"\s+", " ", shown(hmesh.done("--man"))).split()).lower()
    for name, takes_value in options(hmesh).items():
        assert re.search(rf"{name}(, --[\w-]+)?{' [a-z]+' if takes_value else ''}", text), name
    for word in re.findall(r"\S+", hmesh.done("--help").partition("Mesh files:")[2]):
        word = re.sub(r"^-\w,|:$", "", word)
        assert word.lower() in text, word


@pytest.mark.skipif(shutil.which("man") is None, reason="there is no man")
def test_man_finds_nothing_wrong_with_the_page(hmesh):
    run = subprocess.run(["man", "--warnings", "-l", "-"], input=hmesh.done("--man"), capture_output=True, encoding="utf-8",
                         env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "MANWIDTH": "100"})
    if "No manual" in run.stderr or "minimized" in run.stdout:
        pytest.skip("man shows nothing here")
    assert (run.returncode, run.stderr) == (0, "")


# ---- completion ----
@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_is_one_of_its_shell(hmesh, shell):
    script = hmesh.done(f"--completion {shell}")
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell}")
    run = subprocess.run([shell, "-n"], input=script, capture_output=True, encoding="utf-8")
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_knows_every_option(hmesh, shell):
    script = hmesh.done(f"--completion {shell}")
    for name in options(hmesh):
        word = name if shell != "fish" else f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
        assert re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", script), name


VALUES = {"--effort": "draft fast normal fine best", "--method": "annealed hierarchical xie adams adaptive_thinning",
          "--colors": "optimal sampled", "--fit-space": "stored linear each", "--svg": "gradient exact flat",
          "--format": "ply obj glb pdf eps svg html hmc", "--completion": "bash zsh fish"}


def bash(hmesh, *words):
    """What bash offers for the last word, through the function that was registered: bash itself splits at =."""
    if shutil.which("bash") is None:
        pytest.skip("there is no bash")
    script = hmesh.done("--completion bash") + """
        line=$(complete -p hmesh) && [[ $line == *"-o default"* && $line =~ -F\\ ([^ ]+) ]] || exit 3
        COMP_WORDS=(hmesh "$@") COMP_CWORD=$# COMP_LINE="hmesh $*" COMP_POINT=${#COMP_LINE}
        "${BASH_REMATCH[1]}" hmesh "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
        printf '%s\\n' "${COMPREPLY[@]}"
        """
    run = subprocess.run(["bash", "--norc", "-c", script, "bash", *words], capture_output=True, encoding="utf-8")
    assert (run.returncode, run.stderr) == (0, "")
    return run.stdout.split()


def test_bash_offers_options_their_values_and_files(hmesh):
    assert bash(hmesh, "--eff") == ["--effort"]
    assert bash(hmesh, "picture.png", "--no-o") == ["--no-original"]
    assert set(bash(hmesh, "-")) == set(options(hmesh))
    for name, values in VALUES.items():
        assert bash(hmesh, name, "") == values.split()
        assert bash(hmesh, name, "=", "") == values.split()
        first = values.split()[0]
        assert first in bash(hmesh, name, "=", first[:2]) and first in bash(hmesh, "x.png", name, first[:1])
    assert bash(hmesh, "--effort", "=") == VALUES["--effort"].split()
    for nothing in [[""], ["pic"], ["-o", ""], ["--output", "=", "x"], ["--vertices", ""], ["--weights", "-"], ["--effort", "x"]]:
        assert bash(hmesh, *nothing) == []  # readline then offers files


@pytest.mark.skipif(shutil.which("fish") is None, reason="there is no fish")
def test_fish_offers_options_their_values_and_files(hmesh, tmp_path):
    script = tmp_path / "hmesh.fish"
    script.write_text(hmesh.done("--completion fish"))

    def fish(line):
        run = subprocess.run(["fish", "--no-config", "-c", f"source {script}; complete -C '{line}'"], capture_output=True,
                             encoding="utf-8", env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "LC_ALL": "C.UTF-8"})
        assert run.stderr == ""
        return [offer.partition("\t")[0] for offer in run.stdout.splitlines()]

    assert fish("hmesh --eff") == ["--effort"]
    assert "picture.png" in fish("hmesh pict") and "picture.png" in fish("hmesh -o pict")
    for name, values in VALUES.items():
        assert sorted(fish(f"hmesh {name} ")) == sorted(values.split())


@pytest.mark.skipif(shutil.which("zsh") is None, reason="there is no zsh")
def test_zsh_takes_the_specifications(hmesh, tmp_path):
    """_arguments is not run, for which a terminal is needed: its words are counted, and of each one parsed."""
    (tmp_path / "_hmesh").write_text(hmesh.done("--completion zsh"))
    program = f"""
        autoload -Uz compinit && compinit -u -D -d {tmp_path}/dump
        _arguments() {{ print -rl -- "$@" }}
        fpath=({tmp_path} $fpath); autoload -Uz _hmesh; _hmesh
        """
    run = subprocess.run(["zsh", "-f", "-c", program], capture_output=True, encoding="utf-8")
    assert run.stderr == ""
    specs = [line for line in run.stdout.splitlines() if line not in ("-S", "-s")]
    assert specs[-1] == "*:image:_files" and len(specs) == len(options(hmesh)) + 1
    spec = re.compile(r"(\*|\([^)]*\))(--?[\w-]+)[=+]?\[((?:[^\[\]:\\]|\\.)*)\](?::((?:[^:\\]|\\.)*):(\(.*\)|_files| ))?")
    found = {match[2]: match for match in map(spec.fullmatch, specs[:-1])}
    assert set(found) == set(options(hmesh))
    for name, values in VALUES.items():
        assert found[name][5] == f"({values})"
    for name, takes_value in options(hmesh).items():
        assert (found[name][4] is not None) == takes_value
