"""The manual pages and completions of both commands, which are made of their help."""
import re
import shutil
import subprocess

import pytest

SHELLS = ["bash", "zsh", "fish"]


@pytest.fixture(params=["hmesh", "hmesh-terrain"])
def command(request, hmesh):
    """Each, in the folder of small pictures."""
    if request.param == "hmesh":
        hmesh.name, hmesh.inputs, hmesh.values = request.param, "*:image:_files", VALUES
        return hmesh
    terrain = request.getfixturevalue("terrain")
    terrain.name, terrain.inputs, terrain.values = request.param, "1:dem:_files", VALUES_OF_TERRAIN
    return terrain


def options(hmesh):
    """The names of options that help lists, and whether they take a value."""
    found = re.findall(r"^  (?:(-\w),)?(--[\w-]+)(?: ([A-Z][\w.,]*))? ", hmesh.done("--help"), re.M)
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


def test_the_manual_page_has_the_sections_that_pages_have(command):
    page = command.done("--man")
    assert re.match(rf'\.TH {command.name.upper()} 1 "" "hmesh \d'.replace("-", r"\\-"), page)
    sections = re.findall(r"^\.SH (.*)$", page, re.M)
    assert sections[:4] == ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS"] and "EXIT STATUS" in sections and "EXAMPLES" in sections
    assert re.search(rf"^{command.name} ".replace("-", r"\\-") + r"\\- [a-z].*[^.]$", page, re.M)  # what whatis and apropos read
    assert "`" not in page and not re.search(r"^\.(?!TH|SH|SS|TP|PP|B|RI|IR|nf|fi|RS|RE)", page, re.M)


def test_the_manual_page_says_all_that_the_help_says(command):
    text = " ".join(re.sub(r"\s+", " ", shown(command.done("--man"))).split()).lower()
    for name, takes_value in options(command).items():
        assert re.search(rf"{name}(, --[\w-]+)?{' [a-z]+' if takes_value else ''}", text), name
    for word in re.findall(r"\S+", command.done("--help").partition("iles:\n")[2]):
        word = re.sub(r"^-\w,|:$", "", word)
        assert word.lower() in text, word


@pytest.mark.skipif(shutil.which("man") is None, reason="there is no man")
def test_man_finds_nothing_wrong_with_the_page(command):
    run = subprocess.run(["man", "--warnings", "-l", "-"], input=command.done("--man"), capture_output=True, encoding="utf-8",
                         env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "MANWIDTH": "100"})
    if "No manual" in run.stderr or "minimized" in run.stdout:
        pytest.skip("man shows nothing here")
    assert (run.returncode, run.stderr) == (0, "")


# ---- completion ----
@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_is_one_of_its_shell(command, shell):
    script = command.done(f"--completion {shell}")
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell}")
    run = subprocess.run([shell, "-n"], input=script, capture_output=True, encoding="utf-8")
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_knows_every_option(command, shell):
    script = command.done(f"--completion {shell}")
    for name in options(command):
        word = name if shell != "fish" else f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
        assert re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", script), name


VALUES = {"--effort": "draft fast normal fine best", "--method": "annealed hierarchical xie adams adaptive_thinning",
          "--colors": "optimal sampled", "--fit-space": "stored linear each", "--svg": "gradient exact flat",
          "--format": "ply obj glb pdf eps svg html hmc", "--completion": "bash zsh fish"}
VALUES_OF_TERRAIN = {"--effort": "draft fast normal best", "--type": "float32 int16 uint16", "--completion": "bash zsh fish"}


def bash(command, *words):
    """What bash offers for the last word, through the function that was registered: bash itself splits at =."""
    if shutil.which("bash") is None:
        pytest.skip("there is no bash")
    script = command.done("--completion bash") + """
        line=$(complete -p "$0") && [[ $line == *"-o default"* && $line =~ -F\\ ([^ ]+) ]] || exit 3
        COMP_WORDS=("$0" "$@") COMP_CWORD=$# COMP_LINE="$0 $*" COMP_POINT=${#COMP_LINE}
        "${BASH_REMATCH[1]}" "$0" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
        printf '%s\\n' "${COMPREPLY[@]}"
        """
    run = subprocess.run(["bash", "--norc", "-c", script, command.name, *words], capture_output=True, encoding="utf-8")
    assert (run.returncode, run.stderr) == (0, "")
    return run.stdout.split()


def test_bash_offers_options_their_values_and_files(command):
    assert bash(command, "--eff") == ["--effort"]
    assert bash(command, "picture.png", "--no-o") == ["--no-original"] or command.name != "hmesh"
    assert set(bash(command, "-")) == set(options(command))
    for name, values in command.values.items():
        assert bash(command, name, "") == values.split()
        assert bash(command, name, "=", "") == values.split()
        first = values.split()[0]
        assert first in bash(command, name, "=", first[:2]) and first in bash(command, "x.png", name, first[:1])
    assert bash(command, "--effort", "=") == command.values["--effort"].split()
    for nothing in [[""], ["pic"], ["-o", ""], ["--output", "=", "x"], ["--vertices", ""], ["--report", "-"], ["--effort", "x"]]:
        assert bash(command, *nothing) == []  # readline then offers files


@pytest.mark.skipif(shutil.which("fish") is None, reason="there is no fish")
def test_fish_offers_options_their_values_and_files(command, tmp_path):
    script = tmp_path / f"{command.name}.fish"
    script.write_text(command.done("--completion fish"))

    def fish(line):
        run = subprocess.run(["fish", "--no-config", "-c", f"source {script}; complete -C '{line}'"], capture_output=True,
                             encoding="utf-8", env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "LC_ALL": "C.UTF-8"})
        assert run.stderr == ""
        return [offer.partition("\t")[0] for offer in run.stdout.splitlines()]

    assert fish(f"{command.name} --eff") == ["--effort"]
    assert "picture.png" in fish(f"{command.name} pict") and "picture.png" in fish(f"{command.name} -o pict")
    for name, values in command.values.items():
        assert sorted(fish(f"{command.name} {name} ")) == sorted(values.split())


@pytest.mark.skipif(shutil.which("zsh") is None, reason="there is no zsh")
def test_zsh_takes_the_specifications(command, tmp_path):
    """_arguments is not run, for which a terminal is needed: its words are counted, and of each one parsed."""
    (tmp_path / f"_{command.name}").write_text(command.done("--completion zsh"))
    program = f"""
        autoload -Uz compinit && compinit -u -D -d {tmp_path}/dump
        _arguments() {{ print -rl -- "$@" }}
        fpath=({tmp_path} $fpath); autoload -Uz _{command.name}; _{command.name}
        """
    run = subprocess.run(["zsh", "-f", "-c", program], capture_output=True, encoding="utf-8")
    assert run.stderr == ""
    specs = [line for line in run.stdout.splitlines() if line not in ("-S", "-s")]
    assert specs[-1] == command.inputs and len(specs) == len(options(command)) + 1
    spec = re.compile(r"(\*|\([^)]*\))(--?[\w-]+)[=+]?\[((?:[^\[\]:\\]|\\.)*)\](?::((?:[^:\\]|\\.)*):(\(.*\)|_files| ))?")
    found = {match[2]: match for match in map(spec.fullmatch, specs[:-1])}
    assert set(found) == set(options(command))
    for name, values in command.values.items():
        assert found[name][5] == f"({values})"
    for name, takes_value in options(command).items():
        assert (found[name][4] is not None) == takes_value
