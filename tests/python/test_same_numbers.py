"""Each documented example gives the same bytes as a command and in Python."""
import shlex

import pytest

import palpa
from commands import documented, in_python, run, same_but_times, without_outputs

LONG = {"simulate", "--transfer", "finger.ply --layout paper"}


def lines(*commands):
    found = []
    for words in documented(*commands):
        line = without_outputs(words[1:])
        text = shlex.join(line)
        marks = [pytest.mark.exhaustive] if any(word in text for word in LONG) else []
        found.append(pytest.param(line, id=text, marks=marks))
    return found


def compare(words, folder):
    backend = [] if words[0] == "scatter" else ["--backend", "cpu"]
    words = [str(folder / word) if word in {"drive.csv", "touch.json", "sphere.ply"} else word for word in words]
    json = run([*words, *backend, "--json", "-"])
    assert same_but_times(in_python([*words, *backend]).json()) == same_but_times(json)


@pytest.fixture(scope="module")
def made_files(tmp_path_factory):
    """The files that the pages' lines read."""
    folder = tmp_path_factory.mktemp("made")
    run(["drive", "--layout", "paper", "--focus", "0,0,0", "--backend", "cpu", "--csv", str(folder / "drive.csv")])
    run(["touch", "--scene", "assets/cube.glb", "--points", "assets/finger.ply", "--penetration", "3mm", "--backend", "cpu", "--json",
         str(folder / "touch.json")])
    return folder


@pytest.mark.parametrize("words", lines("touch", "drive", "simulate"))
def test_documented(words, made_files):
    compare(words, made_files)


@pytest.mark.parametrize("words", lines("field"))
def test_documented_field(words, made_files):
    if "--drive" in words and "openmpd" in words:
        pytest.skip("drive.csv is the paper array's")
    compare(words, made_files)


@pytest.mark.parametrize("words", lines("scatter"))
def test_documented_scatter(words, made_files, sphere):
    sphere(made_files / "sphere.ply")
    compare(words, made_files)


def test_there_are_examples():
    assert len(lines("touch", "drive", "field", "scatter", "simulate")) > 20


@pytest.mark.parametrize("line", [
    "touch --scene assets/prism.glb --points assets/finger.ply --penetration 2mm --method multi-focus --layout openmpd",
    "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --foci 7 --stride 2 --dwell 2ms --spacing arc",
    "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --method single-focus --modulation-frequency 150Hz",
    "drive --layout sonicsurface --focus 0,0,15cm --constraint uniform --amplitude uniform --temperature 25",
    "drive --layout openmpd --focus 0,0,15cm --focus 2cm,0,15cm,0.5 --solver greedy",
    "drive --layout openmpd --focus 0,0,15cm --focus 2cm,0,15cm --pressure 500",
    "field --layout openmpd --focus 0,0,15cm --plane xy --centre 0,0,15cm --size 3cm,2cm --pixels 9,6 --no-absorption",
    "field --layout openmpd --focus 0,0,15cm --line 0,0,14cm 0,0,16cm --spread amplitude=10% --draws 20 --seed 3",
])
def test_further_options(line, made_files):
    compare(shlex.split(line), made_files)


def test_gpu_gives_the_same(cube, finger):
    words = shlex.split("touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm")
    json = run([*words, "--json", "-"])
    assert same_but_times(in_python(words).json()) == same_but_times(json)


def test_csv_files(cube, finger, openmpd):
    touch = "--scene assets/cube.glb --points assets/finger.ply --penetration 3mm --backend cpu --quiet --csv -"
    assert cube.touch(finger, penetration=3e-3, backend="cpu").csv() == run(["touch", *touch.split()])
    drive = "--layout openmpd --focus 0,0,0.15 --backend cpu --quiet --csv -"
    assert openmpd.solve([0, 0, 0.15], backend="cpu").csv() == run(["drive", *drive.split()])


def test_a_drive_from_a_touch(made_files, openmpd):
    json = run(["drive", "--layout", "openmpd", "--touch", str(made_files / "touch.json"), "--slot", "2", "--backend", "cpu", "--json", "-"])
    assert openmpd.solve_touch(made_files / "touch.json", slot=2, backend="cpu").json() == json


def test_version():
    assert run(["--version"]).splitlines()[0] == f"palpa {palpa.__version__}"


def test_a_length_may_be_a_text():
    cube = palpa.Scene("assets/cube.glb")
    touches = [cube.touch("assets/finger.ply", penetration=given, backend="cpu") for given in ("3mm", 3e-3, "0.003")]
    assert len({same_but_times(touch.json()) for touch in touches}) == 1
