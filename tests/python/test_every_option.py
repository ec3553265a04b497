"""Every option of every command that the module has, too: the value changes the command's result, and in Python and in a
case of a sweep, it gives the same result. All cases share what the process keeps: models, arrays, fingers."""
import functools
import json
import re
import shlex
import struct
import subprocess

import numpy as np
import pytest

import palpa
from commands import PALPA, ROOT, in_python, run, same_but_times
from palpa import _engine

pytestmark = pytest.mark.times  # other tests run the same code under a sanitizer

TAKE = f"recording:{ROOT}/assets/depth/take"
PARTS = "--surface parts --parts 3"
TOUCH = "--points assets/finger.ply --penetration 3mm"
DRIVEN = "--layout openmpd --drive IN/drive.csv"
AIM = "--layout openmpd --focus 0,0,10cm --focus 2cm,0,10cm"
SIMULATE = "simulate --finger IN/tip.ply --penetration 1mm --layout openmpd"
EXPORT = f"export --source {TAKE} --foci OUT/foci.json --events OUT/events.jsonl --drives OUT/drives.bin --layout openmpd"
# The line on which an option is tried: one that names it, else the command's first.
LINES = {
    "touch": {
        "": f"touch --scene IN/two.glb {TOUCH} --layout openmpd", "solver constraint": f"touch --scene assets/prism.glb {TOUCH} --layout openmpd --method multi-focus",
        "modulation modulation-frequency": f"touch --scene assets/prism.glb {TOUCH} --method single-focus --spectrum",
        "spot tune-longest tune-shortest": f"touch --scene assets/cube.glb {TOUCH} --tune --tune-shortest 1ms --tune-longest 2ms",
        "internal-faces parts": f"touch --scene IN/two.glb {TOUCH} {PARTS}",
        "camera depth": "touch --scene assets/cube.glb --depth assets/depth/hand.png --camera assets/depth/camera.toml",
        "rig": "touch --scene assets/cube.glb --depth assets/depth/hand.png --rig assets/depth/camera.toml",
        "steps": f"touch --scene assets/prism.glb {TOUCH} --layout openmpd --audible"},
    "drive": {
        "": f"drive {AIM}", "amplitude": "drive --layout openmpd --focus 0,0,10cm", "draws seed": f"drive {AIM} --spread phase=0.1 --draws 20", "slot touch": "drive --layout openmpd --touch IN/touch.json",
        "mesh": "drive --layout openmpd --focus 0,0,10cm --transfer finger --mesh IN/above.ply",
        "force": "drive --layout openmpd --focus 0,0,10cm --transfer finger --mesh IN/coarse.ply"},
    "field": {
        "": f"field {AIM} --solver gs-pat --pressure 300Pa --plane xz --centre 0,0,10cm --size 2cm,2cm --pixels 4,4", "null solver constraint": f"field {AIM} --plane xz --centre 0,0,10cm --size 2cm,2cm --pixels 4,4",
        "amplitude": "field --layout openmpd --focus 0,0,10cm --plane xz --centre 0,0,10cm --size 2cm,2cm --pixels 4,4",
        "line samples": f"field {AIM} --line 0,0,9cm 0,0,11cm --samples 5",
        "centre draws seed": f"field {AIM} --plane xz --size 2cm,2cm --pixels 4,4 --spread phase=0.1 --draws 20", "points": f"field {AIM} --points IN/above.ply",
        "drive": "field --layout openmpd --drive IN/drive.csv --points IN/above.ply"},
    "simulate": {
        "": f"{SIMULATE} --scene assets/cube.glb", "dwell modulation modulation-frequency spot": f"{SIMULATE} --scene assets/cube.glb --method single-focus --spectrum",
        "tune-longest tune-shortest": f"{SIMULATE} --scene assets/prism.glb --tune --tune-shortest 1ms --tune-longest 2ms",
        "solver constraint": f"{SIMULATE} --scene assets/cube.glb --method multi-focus", "draws seed": f"{SIMULATE} --scene assets/cube.glb --spread phase=0.1 --draws 20",
        "gltf-scene delta surface": f"{SIMULATE} --scene IN/two.glb", "parts": f"{SIMULATE} --scene IN/two.glb {PARTS}",
        "noise-free": f"{SIMULATE} --scene assets/cube.glb --skin cameras", "force": f"{SIMULATE} --scene assets/cube.glb".replace("tip", "coarse"),
        "rig": f"{SIMULATE} --scene assets/cube.glb".replace("--layout openmpd", "")},
    "scatter": {
        "": "scatter --mesh IN/pebble.ply --plane-wave 0,0,1", "absorption directivity drive": f"scatter --mesh IN/above.ply {DRIVEN}",
        "humidity": f"scatter --mesh IN/above.ply {DRIVEN} --absorption", "force": "scatter --mesh IN/coarse.ply --plane-wave 0,0,1",
        "layout point-source": "scatter --mesh IN/pebble.ply"},
    "export": {
        "": f"{EXPORT} --scene IN/two.glb", "constraint directivity hysteresis solver": f"{EXPORT} --scene assets/prism.glb --method multi-focus",
        "modulation modulation-frequency": f"{EXPORT} --scene assets/prism.glb --method single-focus", "tune": f"{EXPORT} --scene assets/cube.glb --dwell 0.8ms",
        "internal-faces parts": f"{EXPORT} --scene IN/two.glb {PARTS}", "frequency": f"{EXPORT} --scene IN/two.glb".replace("openmpd", "IN/bare.toml"),
        "noise-free rig seed": f"{EXPORT.replace(TAKE, 'synthetic')} --frames 2 --scene assets/cube.glb"},
    "decompose": {"": "decompose --scene IN/two.glb --parts 3 --resolution 10000 --out OUT/parts.glb"},
    "calibrate": {"": "calibrate --rig tests/cli/support/small_rig.toml --frames 2"},
}
# What each option is set to. The first word of a line names the command of an option that has another value there.
VALUES = {
    "scene": "assets/semi-sphere.glb", "gltf-scene": "1", "surface": "parts", "parts": "2", "internal-faces": "keep", "penetration": "2mm",
    "points": "IN/tip.ply", "camera": "IN/camera.toml", "depth": f"{ROOT}/assets/depth/take/000006-0.png", "rig": "assets/rigs/openmpd-one.toml", "touch rig": "IN/camera.toml", "layout": "sonicsurface",
    "delta": "1mm", "simulate delta": "0.5mm", "finger-gap": "0.1mm", "min-points": "100000", "finger-width": "0", "cluster": "inside", "foci": "7", "foci-count": "7",
    "spacing": "arc", "stride": "1", "dwell": "2ms", "method": "ellipse", "modulation": "amplitude-sine", "modulation-frequency": "150Hz",
    "spot": "5mm", "tune-shortest": "1.9ms", "tune-longest": "1.1ms", "simulate tune-longest": "1.01ms", "simulate scene": "assets/prism.glb", "steps": "off", "amplitude": "distance", "solver": "greedy",
    "constraint": "normalise", "pressure": "500Pa", "directivity": "omni", "temperature": "30", "sound-speed": "350m/s", "frequency": "41kHz",
    "spread": "amplitude=10% --draws 20", "draws": "30", "focus": "0,1cm,9cm", "null": "0,2cm,10cm", "touch": "IN/other.json", "slot": "2",
    "mesh": "IN/wide.ply", "transfer": "finger", "drive transfer": "finger --mesh IN/above.ply", "plane": "yz", "centre": "0,0,9cm", "size": "3cm,2cm", "pixels": "5,3", "line": "0,0,8cm 0,0,9cm",
    "samples": "7", "drive": "IN/other.csv", "humidity": "20", "air-pressure": "90kPa", "finger": "IN/other.ply", "simulate rig": "assets/rigs/openmpd-two.toml", "skin": "cameras",
    "plane-wave": "0,1,0", "point-source": "0,0,10cm", "scatter layout": "autd3 --drive IN/autd3.csv", "source": "synthetic --frames 4", "frames": "3", "hold": "20ms", "ceiling": "0.5", "ramp": "10ms",
    "event-move": "0", "axes": "covariance", "smoothing": "none", "hysteresis": "off", "predict": "auto", "predict-latency": "20ms",
    "resolution": "20000", "seed": "7", "error": "5", "at": "5mm,0,0", "turn": "90",
}
# Why an option is not tried.
WRITTEN = ("csv", "vtu", "png", "wav", "wav-scale", "out", "foci", "events", "drives", "played", "target", "background")
UNTRIED = {
    **dict.fromkeys((f"{command} {option}" for command in LINES for option in WRITTEN), "an output, which the lines have, or another kind of result"),
    "touch foci": "", "simulate foci": "",
    **dict.fromkeys((f"{command} {option}" for command in LINES for option in ("gpu", "backend", "validation", "quiet", "log-level", "json")), "other tests"),
    **dict.fromkeys((f"{command} allow-outside" for command in LINES), "changes no result: test_files.py"), "decompose seed": "its cuts are the same", "touch seed": "not random", "scatter seed": "not random",
    **dict.fromkeys((f"calibrate {option}" for option in ("nudge", "by-touch", "scene", "link", "board-files", "keys", "hold", "ceiling", "ramp", "temperature",
                                                          "sound-speed", "frequency")), "at a terminal only"),
    **dict.fromkeys(("calibrate source", "calibrate frames", "calibrate rig", "calibrate layout"), "cameras that see the target: test_same_numbers.py"),
    **dict.fromkeys(("scatter plane", "scatter centre", "scatter size", "scatter pixels", "scatter line", "scatter samples", "scatter points"),
                    "not in its JSON: test_results.py"),
    **dict.fromkeys((f"{command} cluster" for command in LINES), "needs a finger through a solid: test_inside.cpp"),
    **dict.fromkeys((f"{command} finger-width" for command in LINES), "needs fingers side by side: test_split.cpp"),
    "drive pattern": "in Python, a pattern's points are the targets of Layout.solve", "drive rig": "Python has no rig there",
    "simulate figure6": "another function: test_same_numbers.py", "export keep-boards": "needs an object near a board: test_cli_surroundings.cpp",
    "export predict": "its finger rests", "export predict-latency": "its finger rests", "export spot": "its finger fits any spot",
    "simulate internal-faces": "its finger touches no cut",
}


def write_ells(file):
    """A model of an L, in two scenes at different places. Its inner edge is under the finger."""
    outline = np.array([[-20, -40], [20, -40], [20, -2], [0, -2], [0, 0], [-20, 0]]) * 1e-3
    corners = np.concatenate([np.insert(outline, 2, z, axis=1) for z in (-0.02, 0.02)]).astype("<f4")
    front = np.array([[0, 1, 3], [1, 2, 3], [0, 3, 4], [0, 4, 5]])
    sides = [[[a, b, b + 6], [a, b + 6, a + 6]] for a, b in zip(range(6), [1, 2, 3, 4, 5, 0])]
    faces = np.concatenate([front[:, ::-1], front + 6, np.reshape(sides, (-1, 3))]).astype("<u2")
    binary = corners.tobytes() + faces.tobytes()
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}, {"nodes": [1]}], "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [3e-3, -1e-3, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "buffers": [{"byteLength": len(binary)}],
        "bufferViews": [{"buffer": 0, "byteLength": corners.nbytes}, {"buffer": 0, "byteOffset": corners.nbytes, "byteLength": faces.nbytes}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3", "min": corners.min(axis=0).tolist(), "max": corners.max(axis=0).tolist()},
                      {"bufferView": 1, "componentType": 5123, "count": faces.size, "type": "SCALAR"}]}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    file.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, sphere):
    """The files that lines name, and what palpa keeps."""
    folder = tmp_path_factory.mktemp("options")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PALPA_CACHE", "on")
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        write_inputs(folder, sphere)
        yield folder


def write_inputs(folder, sphere):
    sphere(folder / "sphere.ply")
    ball = palpa.Mesh(folder / "sphere.ply")
    for name, size, up in (("above", 0.2, 0.1), ("wide", 0.3, 0.1), ("other", 0.3, 0.003), ("pebble", 0.1, 0), ("tip", 0.2, 0.002)):
        palpa.write_ply(folder / f"{name}.ply", size * ball.vertices + [0, 0, up] if up == 0.1 else size * ball.vertices + [0, up, 0], ball.faces)
    for name, array, place in (("drive", "openmpd", 0.1), ("other", "openmpd", 0.12), ("autd3", "autd3", 0.1)):
        layout = palpa.Layout(array)
        layout.write_drive(folder / f"{name}.csv", layout.drive([0, 0, place], backend="cpu"))
    for name, pressed in (("touch", "3mm"), ("other", "2mm")):
        run(["touch", "--scene", "assets/cube.glb", "--points", "assets/finger.ply", "--penetration", pressed, "--backend", "cpu", "--json",
             str(folder / f"{name}.json")])
    octahedron = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    palpa.write_ply(folder / "coarse.ply", 0.006 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]) + [0, 0.006, 0], octahedron)
    write_ells(folder / "two.glb")
    (folder / "bare.toml").write_text("".join(f"[[transducer]]\nposition_m = [{x}, 0, 0]\naxis = [0, 0, 1]\n" for x in (0, 0.02)))
    camera = (ROOT / "assets/depth/camera.toml").read_text()
    (folder / "camera.toml").write_text(camera.replace("fx = 400", "fx = 410"))
    (folder / "OUT").mkdir()


def placed(words, folder):
    return [word.replace("OUT/", f"{folder}/OUT/").replace("IN/", f"{folder}/") for word in words]


def without(words, option):
    kept, inside = [], False
    for word in words:
        inside = word == f"--{option}" or inside and not word.startswith("--")
        kept += [] if inside else [word]
    return kept


def files_in(folder):
    files = {file.name: file.read_bytes() for file in folder.iterdir()}
    for name in files:
        (folder / name).unlink()
    return files


@functools.lru_cache(maxsize=None)
def of_the_command(words, folder):
    """The exit code, the JSON without times or the error, and the files that it writes."""
    done = subprocess.run([PALPA, *words, "--json", "-"], capture_output=True, text=True, timeout=120, check=False)
    text = done.stdout if done.returncode == 0 else done.stderr.splitlines()[-1].removeprefix("palpa: error: ")
    return done.returncode, same_but_times(text), files_in(folder / "OUT")


def of_python(words, folder):
    try:
        return 0, same_but_times(in_python(words).json()), files_in(folder / "OUT")
    except palpa.Error as fault:
        return fault.exit_code, str(fault), files_in(folder / "OUT")


def options_of_help(command):
    """Option -> its type, as the command's help lists them; at its end, it names those that many commands have."""
    lists = [dict(re.findall(r"^  --(\S+)(?: (\S+))?", run(["help", *words]), re.M)) for words in ([command, "all"], ["all"])]
    named = run(["help", command, "all"]).partition("Common options (palpa help all):")[2].split()
    assert len(named) > 3
    return lists[0] | {option: kind for option, kind in lists[1].items() if f"--{option}" in named}


BACKEND = {"touch", "drive", "field", "simulate", "export"}
OPTIONS = [(command, option, kind) for command in LINES for option, kind in options_of_help(command).items()]


@pytest.mark.filterwarnings("ignore::palpa.PalpaWarning")
@pytest.mark.parametrize("command, option, kind", OPTIONS)
def test_an_option_in_python_is_the_commands(command, option, kind, folder):
    if UNTRIED.get(f"{command} {option}"):
        return
    value = VALUES.get(f"{command} {option}", VALUES.get(option, "")).split()
    assert bool(kind) == bool(value), f"give {option} a value"
    line = next((line for names, line in LINES[command].items() if option in names.split()), LINES[command][""])
    words = placed(shlex.split(line) + (["--backend", "cpu"] if command in BACKEND else []), folder)
    given = (*without(words, option), f"--{option}", *placed(value, folder))
    before, after = of_the_command(tuple(words), folder), of_the_command(given, folder)
    assert after != before and after[0] != 2, "an option is tried on a line on which it makes a difference, or has a reason why not"
    assert of_python(given, folder) == after


def test_every_function_with_options_is_called_or_known():
    called = {"Scene", "Scene.touch", "Layout.solve", "Layout.solve_touch", "Layout.field", "simulate", "scatter", "export", "decompose", "calibrate"}
    other = {
        "Session": "a run measures itself: it reads the same options as export, and test_same_numbers.py compares its counts",
        "Sensation.play": "a run, too: test_sensations.py", "export_played": "test_same_numbers.py", "figure6": "test_same_numbers.py",
        "learn_background": "test_same_numbers.py", "write_target": "test_same_numbers.py", "write_nudged_rig": "test_same_numbers.py",
        "Layout.drive": "the vector of Layout.solve", "Layout.transfer": "test_frames.py", "FingerBody": "test_misuse.py", "FingerSound": "test_misuse.py"}
    assert {name for name in _engine._options() if name not in other} == called
