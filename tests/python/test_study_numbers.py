"""The analysis in Python says what the C++ program says: every number of every report, of studies as people leave them."""
import json
import math
import os
import random
import subprocess
import sys

import pytest

import study_folders as made
import commands
from commands import ROOT
from palpa.study import __main__ as command
from palpa.study import analysis, counts, pages, reading, text

PALPA = os.path.abspath(commands.PALPA)
STUDIES = {make.__name__: make for make in made.STUDIES}
NEAR, NEAR_DEPTH = 1e-9, 5.1e-6  # the C++ program writes depths with six digits


def run(words, cwd=None):
    """What the C++ program prints."""
    done = subprocess.run([PALPA, *words], cwd=cwd, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def differences(told, mine, place="", near=NEAR):
    """Where two documents differ: whole numbers, names and what is missing not at all, others by more than 1e-9."""
    if isinstance(told, dict) and isinstance(mine, dict):
        found = [f"{place}.{key}: only in one" for key in told.keys() - mine.keys()]
        for key in told.keys() & mine.keys():
            found += differences(told[key], mine[key], f"{place}.{key}", NEAR_DEPTH if key == "depth" else near)
        return found
    if isinstance(told, list) and isinstance(mine, (list, tuple)) and len(told) == len(mine):
        return [one for i, (a, b) in enumerate(zip(told, mine)) for one in differences(a, b, f"{place}[{i}]", near)]
    if isinstance(told, (int, float)) and isinstance(mine, (int, float)) and not isinstance(told, bool):
        return [] if math.isclose(told, mine, rel_tol=near, abs_tol=1e-12) else [f"{place}: {told!r} {mine!r}"]
    return [] if told == mine else [f"{place}: {told!r} {mine!r}"]


@pytest.fixture(scope="module")
def studies(tmp_path_factory):
    """Each study, with what the C++ program says of it."""
    folder = tmp_path_factory.mktemp("studies")

    def of(name, *options):
        if not (folder / name).exists():
            STUDIES[name](folder / name)
        done = subprocess.run([PALPA, "study", "analyse", name, "--json", f"{name}.json", "--csv", f"{name}.csv", *options], cwd=folder,
                              capture_output=True, text=True, timeout=120, check=False)
        assert done.returncode == 0, done.stderr
        return done, json.loads((folder / f"{name}.json").read_text())
    of.folder = folder
    return of


@pytest.fixture
def in_studies(studies, monkeypatch):
    monkeypatch.chdir(studies.folder)
    return studies


@pytest.mark.parametrize("name", STUDIES)
def test_every_number_of_a_study(name, in_studies, capsys):
    done, told = in_studies(name, "--seed", "3")
    assert command.main(["analyse", name, "--json", "mine.json", "--csv", "mine.csv", "--seed", "3"]) == 0
    out, err = capsys.readouterr()
    mine = json.loads((in_studies.folder / "mine.json").read_text())
    assert not differences(told, mine)
    assert out == done.stdout, "the summary"
    assert err == done.stderr, "the warnings"
    wanted, got = ((in_studies.folder / f"{one}.csv").read_text().splitlines() for one in (name, "mine"))
    assert wanted[0] == got[0] and len(wanted) == len(got)
    for a, b in zip(wanted, got):
        for x, y in zip(a.split(","), b.split(",")):
            assert x == y or math.isclose(float(x), float(y), rel_tol=1e-9, abs_tol=1e-12)


PIECES = [b"\t", b"\n", b'"', b"\r\n", b" ", b"n/a", b"-1", b"1e5", b"\xef\xbb\xbf", b"\xc3", b"{", b",", b"\0", b"trial", b"void", b"99999999999"]


def damaged(data, chance):
    """The bytes with a change of a disk, a cable or a person."""
    at = chance.randrange(len(data))
    return chance.choice([data[:at] + bytes([chance.randrange(256)]) + data[at + 1:], data[:at] + data[at + chance.randint(1, 30):],
                          data[:at] + chance.choice(PIECES) + data[at:], data[:at], data[:at] + data[max(0, at - 40):at] + data[at:]])


@pytest.mark.parametrize("seed", range(24))
def test_damaged_studies_are_read_alike(seed, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    chance = random.Random(seed)
    chance.choice([made.halves, made.faulty_rows, made.fingers, made.journals, made.copies, made.voids])(tmp_path / "study")
    files = [file for file in sorted((tmp_path / "study").rglob("*")) if file.is_file()]
    for file in chance.sample(files, 5):
        data = file.read_bytes()
        for _ in range(chance.randint(1, 3)):
            data = damaged(data, chance) if data else data
        file.write_bytes(data)
    done = subprocess.run([PALPA, "study", "analyse", "study", "--json", "told.json"], capture_output=True, timeout=60, check=False)
    code = command.main(["analyse", "study", "--json", "mine.json"])
    out, err = capsys.readouterr()
    assert (code, err) == (done.returncode, done.stderr.decode("utf-8", "replace"))
    # The C++ program prints -nan for a method whose rows are all left out.
    assert out == done.stdout.decode("utf-8", "replace").replace("mean accuracy -nan of 0", "mean accuracy - of 0")
    if code == 0:
        assert not differences(*(json.loads((tmp_path / f"{who}.json").read_text()) for who in ("told", "mine")))


def test_two_folders_are_one_study(in_studies, capsys):
    for name, first in (("east", 1), ("west", 11)):
        made.Maker(in_studies.folder / name, first, LeastTrials=12).people(5, first=first)
    told = json.loads(run(["study", "analyse", "east", "west", "--json", "-", "--quiet"], cwd=in_studies.folder))
    assert command.main(["analyse", "east", "west", "--json", "-"]) == 0
    assert not differences(told, json.loads(capsys.readouterr().out))


def refused(words, capsys):
    """The exit codes and lines of both programs."""
    done = subprocess.run([PALPA, "study", *words], capture_output=True, text=True, timeout=120, check=False)
    code = command.main(words)
    return (done.returncode, done.stderr), (code, capsys.readouterr().err)


def test_what_cannot_be_analysed_gets_the_same_line(in_studies, capsys):
    folder = in_studies.folder
    (folder / "empty").mkdir()
    (folder / "file").write_text("x")
    made.Maker(folder / "nobody", 1).person(1)
    made.Maker(folder / "no-answer", 1).person(1, [["10", "practice", "m", "cube", "cube", "2", "answered"]])
    made.Maker(folder / "one", 2).people(2)
    made.Maker(folder / "same", 3).people(1, first=2)
    made.Maker(folder / "no-shapes-in-common", 4).person(1, [["4", "trial", "m", "ball", "egg", "1", "answered"]])
    broken = folder / "broken/sub-1/beh/sub-1_task-shapes_events.tsv"
    broken.parent.mkdir(parents=True)
    broken.write_text("")
    cases = [["analyse", place] for place in ("empty", "file", "nowhere", "nobody", "no-answer", "no-shapes-in-common", "broken")]
    cases += [["analyse", "one", "file"], ["analyse", "one", "same"], ["compare", "paper", "nowhere.csv"], ["compare", "one/sub-1", "paper"]]
    for words in cases:
        wanted, got = refused(words, capsys)
        assert wanted[0] == 4 and got == wanted, words


@pytest.mark.parametrize("name", made.COUNTS)
def test_tables_of_counts(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "counts.csv").write_bytes(made.COUNTS[name].encode("latin-1" if name == "latin" else "utf-8"))
    done = subprocess.run([PALPA, "study", "analyse", "counts.csv", "--json", "told.json"], capture_output=True, text=True, timeout=60, check=True)
    assert command.main(["analyse", "counts.csv", "--json", "mine.json"]) == 0
    assert not differences(json.loads((tmp_path / "told.json").read_text()), json.loads((tmp_path / "mine.json").read_text()))
    out, err = capsys.readouterr()
    assert (out, err) == (done.stdout, done.stderr)


@pytest.mark.parametrize("content", made.BAD_COUNTS)
def test_bad_counts_get_the_same_line(content, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "counts.csv").write_text(content)
    wanted, got = refused(["analyse", "counts.csv"], capsys)
    assert wanted[0] == 4 and got == wanted


def test_results_beside_each_other(in_studies, capsys):
    folder = in_studies.folder
    for name in ("halves", "one_method"):
        in_studies(name)
    for name in ("plain", "zeros"):
        (folder / f"{name}.csv").write_text(made.COUNTS[name])
    sources = ["paper", "halves", "plain.csv", "zeros.csv", "one_method.json"]
    for words in (sources, ["told.json", "halves.json"]):
        run(["study", "compare", *words, "--json", "told-now.json", "--csv", "told.csv", "--quiet"], cwd=folder)
        summary = run(["study", "compare", *words], cwd=folder)
        assert command.main(["compare", *words, "--json", "mine.json", "--csv", "mine.csv"]) == 0
        assert capsys.readouterr().out == summary
        assert not differences(json.loads((folder / "told-now.json").read_text()), json.loads((folder / "mine.json").read_text()))
        assert (folder / "told.csv").read_text() == (folder / "mine.csv").read_text()
        (folder / "told-now.json").rename(folder / "told.json")


def test_the_papers_numbers():
    """The measures of its Tables I and II, as scipy and R compute them."""
    single, cross = (analysis.measures(counts.PAPER[name]) for name in ("single-focus", "cross-section"))
    assert (single["accuracy"], cross["accuracy"]) == (0.39, 0.6525)
    assert single["clopper_pearson"] == pytest.approx([0.3419209849, 0.4397193331], abs=1e-10)
    assert (single["dprime"], cross["dprime"]) == pytest.approx((0.4892759241, 1.327078511), abs=1e-9)
    assert (single["luce_fit"]["deviance"], cross["luce_fit"]["deviance"]) == pytest.approx((4.160288411, 25.30202174), rel=1e-9)
    assert single["p_chance"] == pytest.approx(4.903515775e-10, rel=1e-9)


@pytest.mark.parametrize("words", [
    [], ["--studies", "300", "--seed", "18446744073709551615"], ["--people", "2", "--studies", "100"], ["--baseline", "0.9", "--accuracy", "1", "--studies", "200"],
    ["--baseline", "0.5", "--accuracy", "0.6", "--power", "0.9", "--people", "60", "--seed", "7", "--studies", "200", "--correlation", "-0.3",
     "--trials", "20", "--spread", "0.2", "--alpha", "0.01"]])
def test_how_many_participants(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    done = subprocess.run([PALPA, "study", "power", *words, "--json", "told.json", "--csv", "told.csv"], capture_output=True, text=True, timeout=120, check=True)
    assert command.main(["power", *words, "--json", "mine.json", "--csv", "mine.csv"]) == 0
    assert not differences(json.loads((tmp_path / "told.json").read_text()), json.loads((tmp_path / "mine.json").read_text()))
    assert (tmp_path / "told.csv").read_text() == (tmp_path / "mine.csv").read_text()
    out, err = capsys.readouterr()
    assert (out, err) == (done.stdout, done.stderr)


def test_a_page_is_the_same_twice_and_asks_for_no_network(in_studies):
    made_once = []
    for name in ("fingers", "three_methods"):
        in_studies(name)
        result = analysis.analyse(name)
        made_once = [pages.analysis_page(result).text() for _ in range(2)]
        assert made_once[0] == made_once[1]
        assert not [word for word in ("<dc:date>", 'href="http', "src=", "<script", "@import") if word in made_once[0]]
        ids = [part.split('"')[0] for part in made_once[0].split(' id="')[1:]]
        assert len(ids) == len(set(ids))


def test_a_program_of_ones_own(in_studies):
    """--script writes one that makes the same page."""
    in_studies("paper")
    assert command.main(["analyse", "paper", "--html", "told.html", "--script", "mine.py", "--quiet"]) == 0
    script = (in_studies.folder / "mine.py").read_text()
    assert '"report.html"' not in script and "'told.html'" in script
    wanted = (in_studies.folder / "told.html").read_bytes()
    (in_studies.folder / "told.html").unlink()
    done = subprocess.run([sys.executable, "mine.py"], cwd=in_studies.folder, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
                          capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert (in_studies.folder / "told.html").read_bytes() == wanted
    assert command.main(["analyse", "paper", "--script", "mine.py", "--quiet"]) == 2, "it may have been changed"


def started(words, cwd, **environment):
    own = {name: value for name, value in os.environ.items() if name not in ("PALPA_PYTHON", "VIRTUAL_ENV", "CONDA_PREFIX", "PYTHONPATH")}
    return subprocess.run([PALPA, "study", *words], cwd=cwd, env=own | environment, capture_output=True, text=True, timeout=120, check=False)


def test_palpa_starts_python_for_a_script(in_studies):
    folder = in_studies.folder
    in_studies("paper")
    done = started(["analyse", "paper", "--seed", "3", "--json", "by-python.json", "--html", "by-python.html", "--script", "by-python.py"], folder,
                   PALPA_PYTHON=sys.executable)
    wanted = run(["study", "analyse", "paper", "--seed", "3", "--json", "by-palpa.json"], cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, wanted, "")
    assert not differences(*(json.loads((folder / f"by-{who}.json").read_text()) for who in ("palpa", "python")))
    first = (folder / "by-python.html").read_bytes()
    again = subprocess.run([sys.executable, "by-python.py"], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert again.returncode == 0, again.stderr
    assert (folder / "by-python.html").read_bytes() == first, "without the module palpa in the path"
    done = started(["compare", "paper", "by-palpa.json", "--quiet", "--script", "beside.py"], folder, PALPA_PYTHON=sys.executable)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "") and "study.compare(SOURCES)" in (folder / "beside.py").read_text()
    log = "paper/sub-1/beh/sub-1_task-shapes_run-01_events.tsv"
    before = (folder / log).read_bytes()
    for words in (["--json", log], ["--csv", "a", "--html", "./a"]):
        done = started(["analyse", "paper", "--script", "other.py", *words], folder, PALPA_PYTHON=sys.executable)
        assert done.returncode == 2 and done.stderr.count("\n") == 1 and not (folder / "other.py").exists()
    assert (folder / log).read_bytes() == before


def test_which_python_palpa_starts(tmp_path):
    """PALPA_PYTHON, else that of the active environment, else Debian's; one line if there is none."""
    def python(name):
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"#!/bin/sh\necho {name} $*\nexit 7\n")
        file.chmod(0o755)
        return str(file)
    words = ["compare", "paper", "paper", "--quiet", "--script", "mine.py"]
    environment, conda = python("venv/bin/python3"), python("conda/bin/python3")
    given = {"VIRTUAL_ENV": str(tmp_path / "venv"), "CONDA_PREFIX": str(tmp_path / "conda")}
    named = started(words, tmp_path, PALPA_PYTHON=python("named"), **given)
    assert named.returncode == 7 and named.stdout.startswith("named ") and named.stdout.endswith("compare --script=mine.py --seed=0 --quiet -- paper paper\n")
    assert started(words, tmp_path, **given).stdout.startswith("venv/bin/python3 ")
    os.unlink(environment)
    assert started(words, tmp_path, **given).stdout.startswith("conda/bin/python3 ")
    os.unlink(conda)
    missing = started(words, tmp_path, PALPA_PYTHON=str(tmp_path / "nowhere"))
    assert missing.returncode == 1 and missing.stderr.count("\n") == 1 and "nowhere cannot be started: No such file or directory: install" in missing.stderr


def test_outputs_that_would_destroy_something(in_studies, capsys):
    in_studies("paper")
    log = "paper/sub-1/beh/sub-1_task-shapes_run-01_events.tsv"
    for words in (["--json", log], ["--html", "paper/sub-1/report.html"], ["--json", "x", "--csv", "./x"], ["--csv", "nowhere/x"], ["--csv", "paper"]):
        assert command.main(["analyse", "paper", *words]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    (in_studies.folder / "a.csv").write_text(made.COUNTS["plain"])
    assert command.main(["analyse", "a.csv", "--csv", "a.csv"]) == 2


def test_a_package_that_is_missing_is_named(tmp_path):
    """Without numpy and scipy, one line says what to install."""
    for name in ("numpy", "scipy"):
        (tmp_path / f"{name}.py").write_text(f"raise ModuleNotFoundError('none', name='{name}')")
    done = subprocess.run([sys.executable, str(ROOT / "python/palpa/study/__main__.py"), "power"], env=os.environ | {"PYTHONPATH": str(tmp_path)},
                          capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "python3-scipy" in done.stderr and not done.stdout


def test_it_needs_nothing_of_the_engine_and_waits_for_no_figure():
    code = ("import runpy, sys; sys.argv = ['study', 'compare', 'paper', 'paper'];\n"
            "try: runpy.run_path('python/palpa/study/__main__.py', run_name='__main__')\n"
            "except SystemExit as end: assert end.code == 0\n"
            "print(sorted({'palpa._engine', 'pandas', 'matplotlib', 'scipy.stats'} & set(sys.modules)))")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_names_that_are_no_text(tmp_path, monkeypatch):
    """Bytes that are not UTF-8 in a folder's name and in a log."""
    monkeypatch.chdir(tmp_path)
    folder = os.fsdecode(b"st\xfcdie")
    made.Maker(tmp_path / folder, 1).people(2)
    log = tmp_path / folder / "sub-1/beh/sub-1_task-shapes_run-01_events.tsv"
    log.write_bytes(log.read_bytes().replace(b"single-focus", b"f\xfcnf"))
    told = json.loads(subprocess.run([PALPA, "study", "analyse", folder, "--json", "-"], capture_output=True, timeout=60, check=True).stdout)
    assert command.main(["analyse", folder, "--json", "mine.json"]) == 0
    mine = json.loads((tmp_path / "mine.json").read_text())
    assert not differences(told, mine) and "f\ufffdnf" in [one["name"] for one in mine["methods"]]


def test_numbers_of_cells():
    for cell, value in {"1": 1, "+1.5": 1.5, "-.5e1": -5, "5.": 5, "1e-400": None, "0e9": 0, "1e999": None, " 1": None, "1,5": None, "0x1": None,
                        "nan": None, "inf": None, "": None, "1_0": None, "\u0661": None}.items():
        assert text.number_in(cell) == value
    assert reading.participant_number("sub-007") == 7 and reading.participant_number("sub-x") is None
