"""Each documented example gives the same bytes as a command and in Python."""
import json
import pathlib
import re
import shlex

import pytest

import palpa
from commands import ROOT, TWIN, documented, in_python, options_of, run, same_but_times, without_outputs

LONG = {"simulate", "--transfer", "finger.ply --layout paper", "finger.ply --plane-wave", "--surface parts", "--frames", "knob.glb --parts"}
MADE = {"drive.csv", "touch.json", "sphere.ply", "parts.glb", "played.json"}


def lines(*commands):
    found = []
    for words in documented(*commands):
        if "--pattern" in words:
            continue  # in Python, a pattern's points are the targets of Layout.solve
        line = without_outputs(words[1:])
        text = shlex.join(line)
        marks = [pytest.mark.exhaustive] if any(word in text for word in LONG) else []
        found.append(pytest.param(line, id=text, marks=marks))
    return found


def compare(words, folder):
    backend = [] if words[0] in {"scatter", "decompose", "calibrate"} else ["--backend", "cpu"]
    words = [str(folder / word) if word in MADE else word for word in words]
    text = run([*words, *backend, "--json", "-"])
    assert same_but_times(in_python([*words, *backend]).json()) == same_but_times(text)


@pytest.fixture(scope="module")
def made_files(tmp_path_factory, sphere):
    """The files that the pages' lines read."""
    folder = tmp_path_factory.mktemp("made")
    sphere(folder / "sphere.ply")
    run(["drive", "--layout", "paper", "--focus", "0,0,0", "--backend", "cpu", "--csv", str(folder / "drive.csv")])
    run(["touch", "--scene", "assets/cube.glb", "--points", "assets/finger.ply", "--penetration", "3mm", "--backend", "cpu", "--json",
         str(folder / "touch.json")])
    run(["decompose", "--scene", "assets/cube.glb", "--parts", "32", "--out", str(folder / "parts.glb")])
    run(["export", "--scene", "assets/cube.glb", "--source", "recording:assets/depth/take", "--foci", str(folder / "played.json")])
    return folder


@pytest.mark.parametrize("words", lines("touch", "drive", "simulate", "field", "scatter"))
def test_documented(words, made_files):
    if words[0] == "field" and "--drive" in words and "openmpd" in words:
        pytest.skip("drive.csv is the paper array's")
    compare(words, made_files)


@pytest.mark.parametrize("words", lines("decompose"))
def test_documented_decompose(words, tmp_path):
    compare(["parts.glb" if word.startswith("parts") else word for word in words], tmp_path)
    ours = (tmp_path / "parts.glb").read_bytes()
    run([str(tmp_path / "parts.glb") if word.startswith("parts") else word for word in words])
    assert (tmp_path / "parts.glb").read_bytes() == ours


@pytest.mark.parametrize("words", lines("export"))
def test_documented_export(words, made_files, tmp_path):
    """The JSON, and every file that is written."""
    words = [str(made_files / word) if word in MADE else word for word in words]
    written = [words[at + 1] for at, word in enumerate(words) if word in {"--foci", "--drives", "--events"}]
    texts = {}
    for folder, json_of in (("cli", lambda line: run([*line, "--json", "-"])), ("python", lambda line: in_python(line).json())):
        (tmp_path / folder).mkdir()
        line = [str(tmp_path / folder / word) if word in written else word for word in words]
        texts[folder] = json_of([*line, "--backend", "cpu"])
    assert texts["python"] == texts["cli"] and written
    for name in written:
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "cli" / name).read_bytes()


def runs_here(words):
    """Without a camera, a board, or a receiver."""
    text = " ".join(words)
    return not re.search(r"v4l2:|realsense:|bag:|joints:|openmpd|autd3:|%s|rig\.toml|one\.toml|\.\.\." % TWIN, text)


def live_lines():
    found = []
    for words in documented("run"):
        if not runs_here(words):
            continue
        line = without_outputs(words[1:])
        quick = "take" in " ".join(line)
        found.append(pytest.param(line, id=shlex.join(line), marks=[] if quick else [pytest.mark.exhaustive]))
    return found


@pytest.mark.parametrize("words", live_lines())
def test_documented_run(words, tmp_path):
    """A live run's times are its own. What is counted is the same, at least if it takes every frame."""
    line, skip = [], False
    for word in words:
        if not skip and word not in {"--frames", "--record", "--events", "--every-frame"}:
            line.append(word)
        skip = word in {"--frames", "--record", "--events"}
    line += ["--frames", "6", "--backend", "cpu"] + ([] if "--transfer" in line else ["--every-frame"])
    cli, python = json.loads(run([*line, "--json", "-"])), json.loads(in_python(line).json())
    assert list(python) == list(cli) and list(python["passes_ms"]) == list(cli["passes_ms"])
    for count in ("captured", "planned", "touching") if "--every-frame" in line else ("captured",):
        assert python["frames"][count] == cli["frames"][count]
    assert cli["frames"]["captured"] == 6


@pytest.mark.exhaustive
def test_a_rehearsal_of_a_calibration(tmp_path):
    line = shlex.split("calibrate --frames 3 --noise-free")
    found = in_python(line)
    assert found.json() == run([*line, "--json", "-"]) and found.frames == 3 and len(found.cameras) == 3
    assert max(camera["moved"] for camera in found.cameras) < 1e-3
    found.write_rig(tmp_path / "rig.toml")
    palpa.write_target(tmp_path / "target.glb", rig=tmp_path / "rig.toml")  # reads it


@pytest.mark.exhaustive
def test_a_rehearsal_of_a_background(tmp_path):
    compare(shlex.split("calibrate --background --layout openmpd --frames 10"), tmp_path)


@pytest.mark.parametrize("line", [shlex.join(words[1:]) for words in documented("calibrate") if "--target" in words]
                         + ["calibrate --target target.glb --layout openmpd --at 1cm,0,2mm --turn 30"])
def test_documented_target(line, tmp_path):
    words = [str(tmp_path / word) if word.startswith("target.") else word for word in shlex.split(line)]
    run(words)
    file = pathlib.Path(words[words.index("--target") + 1])
    theirs = file.read_bytes()
    file.unlink()
    options = options_of(words[1:])
    palpa.write_target(options.pop("target"), **options)
    assert file.read_bytes() == theirs


@pytest.mark.parametrize("which", [[], ["--layout", "openmpd"], ["--rig", str(ROOT / "tests/cli/support/small_rig.toml")]])
def test_a_nudged_rig(which, tmp_path):
    theirs, ours = tmp_path / "theirs.toml", tmp_path / "ours.toml"
    found = json.loads(run(["calibrate", "--nudge", "--keys", "right*2 shift+up*3 pageup enter", "--backend", "cpu",
                            "--noise-free", "--out", str(theirs), "--json", "-", *which]))
    assert found["offset_m"] == pytest.approx([2e-3, 3e-4, -1e-3])
    palpa.write_nudged_rig(ours, found["offset_m"], **options_of(which))
    assert ours.read_bytes() == theirs.read_bytes()


def test_a_nudge_is_small(tmp_path):
    palpa.write_nudged_rig(tmp_path / "most.toml", (0.05, 0, -0.05))
    for offset in ((0.0501, 0, 0), (0, -0.06, 0), (0, 0, 1)):
        with pytest.raises(palpa.BadUsage, match="offset: .* mm along [xyz] is more than a nudge"):
            palpa.write_nudged_rig(tmp_path / "rig.toml", offset)
    assert not (tmp_path / "rig.toml").exists()


def test_there_are_examples():
    assert len(lines("touch", "drive", "field", "scatter", "simulate")) > 20
    assert len(lines("decompose")) > 1 and len(lines("export")) > 1 and len(live_lines()) > 8


def test_gpu_gives_the_same(cube, finger):
    words = shlex.split("touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm")
    json = run([*words, "--json", "-"])
    assert same_but_times(in_python(words).json()) == same_but_times(json)


def test_csv_files(cube, finger, openmpd):
    touch = "--scene assets/cube.glb --points assets/finger.ply --penetration 3mm --backend cpu --quiet --csv -"
    assert cube.touch(finger, penetration=3e-3, backend="cpu").csv() == run(["touch", *touch.split()])
    drive = "--layout openmpd --focus 0,0,0.15 --backend cpu --quiet --csv -"
    assert openmpd.solve([0, 0, 0.15], backend="cpu").csv() == run(["drive", *drive.split()])


def test_version():
    assert run(["--version"]).splitlines()[0] == f"palpa {palpa.__version__}"


def test_a_length_may_be_a_text():
    cube = palpa.Scene("assets/cube.glb")
    touches = [cube.touch("assets/finger.ply", penetration=given, backend="cpu") for given in ("3mm", 3e-3, "0.003")]
    assert len({same_but_times(touch.json()) for touch in touches}) == 1
