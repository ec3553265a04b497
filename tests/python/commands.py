"""The documented command lines, and the same in Python; programs and threads of tests; what a link got."""
import concurrent.futures
import os
import pathlib
import re
import shlex
import struct
import subprocess
import sys
import time

import numpy as np
import pytest

import palpa

ROOT = pathlib.Path(__file__).resolve().parents[2]
PALPA = os.environ.get("PALPA_BINARY", str(ROOT / "build/release/bin/palpa"))
# Options of outputs, of which the module has arrays.
OUTPUTS = {"csv", "png", "vtu", "json", "stats"}
FLAGS = {"spectrum", "tune", "force", "no_absorption", "absorption", "noise_free", "figure6", "quiet", "allow_outside", "every_frame", "keep_boards",
         "background"}
# What a page's variables and a README's earlier lines stand for: npm has the bunny, and a recording of 90 frames is slow.
STAND_INS = {"$bunny": "assets/button-and-knob.glb", "$fingers": "assets/finger.ply", "recording:take1": "recording:assets/depth/take",
             "recording:circling": "recording:assets/depth/take"}


def documented(*commands):
    """The lines of the README, the pages and palpa help that call one of these commands, without their comments."""
    lines = []
    texts = [page.read_text(encoding="utf-8") for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]]
    texts += [re.sub("^  palpa", "    palpa", run(["help", command]), flags=re.M) for command in commands]
    for text in texts:
        for line in re.findall(r"^    (palpa .+)$", text.replace("\\\n", " "), re.M):
            words = [STAND_INS.get(word, word) for word in shlex.split(line.split(" #")[0])]
            if words[1] in commands and words not in lines:
                lines.append(words)
    return lines


def run(words, cwd=ROOT):
    """What the command prints."""
    done = subprocess.run([PALPA, *words], cwd=cwd, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def begins(condition, limit_s=120):
    """Waits until this holds, however late it does on a busy machine."""
    end = time.monotonic() + limit_s
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def python(code, *arguments, timeout=120, **more):
    """Runs a program of its own."""
    return subprocess.run([sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, check=False,
                          **{"cwd": ROOT} | more)


def in_threads(*works):
    """Runs functions side by side; what they return."""
    with concurrent.futures.ThreadPoolExecutor(len(works)) as executor:
        return [one.result(60) for one in [executor.submit(work) for work in works]]


def drives_in(file, transducers=256, so_far=False):
    """The amplitudes that --link record:FILE wrote, a row per slot, by the description in docs/files.md. `so_far`: while it is being written."""
    slot = np.dtype([("slot", "<u8"), ("drive", "<f4", (transducers, 2))])
    data = file.read_bytes() if file.exists() or not so_far else b""
    if so_far:
        if len(data) < 24 + slot.itemsize:
            return np.zeros((1, transducers))
        data = data[:len(data) - (len(data) - 24) % slot.itemsize]
    assert data[:8] == b"palpadrv" and struct.unpack_from("<II", data, 8) == (1, transducers)
    return np.frombuffer(data[24:], slot)["drive"][:, :, 0]


def newest_in(file):
    """The largest amplitude of the newest drive of a run that goes on; 0 if there is none yet."""
    return round(float(drives_in(file, so_far=True)[-1].max()), 6)


def assert_it_sounded_and_ended_in_silence(file):
    amplitudes = drives_in(file)
    assert amplitudes.max() == pytest.approx(1, abs=1e-6) and amplitudes[-1].max() == 0


def without_lateness(err):
    """What a program wrote to stderr, without the warnings that a live run gives where a slow or busy machine has frames late."""
    late = re.compile(r"(palpa: warning|<string>:\d+: PalpaWarning): (overloaded: |frames arrive .* late or in bursts: )")
    return "".join(line for line in err.splitlines(keepends=True) if not late.match(line))


def without_outputs(words):
    """The line without options that write files."""
    kept, skip = [], False
    for word in words:
        skip_this, skip = skip, False
        if skip_this:
            continue
        if word.lstrip("-") in OUTPUTS and word.startswith("--"):
            skip = True
            continue
        kept.append(word)
    return kept


def options_of(words):
    """{keyword: value} of a command line; several values are a list."""
    options, at = {}, 0
    while at < len(words):
        key, _, value = words[at][2:].partition("=")
        key = key.replace("-", "_")
        at += 1
        if key in FLAGS:
            options[key] = True
            continue
        values = [value] if value else [words[at]]
        at += 0 if value else 1
        if key == "line":
            values = [words[at - 1], words[at]]
            at += 1
        options.setdefault(key, []).extend(values)
    return {key: value[0] if isinstance(value, list) and len(value) == 1 else value for key, value in options.items()}


UNITS = {"mm": 1000, "cm": 100, "m": 1}


def metres(text):
    """A length of the command line. Division gives the double that is nearest to the decimal, as palpa reads it."""
    for unit in ("mm", "cm", "m"):
        if text.endswith(unit):
            return float(text[:-len(unit)]) / UNITS[unit]
    return float(text)


def point(text):
    return [metres(part) for part in text.split(",")[:3]]


def as_list(value):
    return value if isinstance(value, list) else [value]


def foci(texts):
    """(points, gains) of --focus."""
    return [point(text) for text in as_list(texts)], [float(text.split(",")[3]) if text.count(",") == 3 else 1 for text in as_list(texts)]


def nulls(options):
    """The arguments of --null."""
    texts = as_list(options.pop("null", []))
    if not texts:
        return {}
    return {"nulls": [point(text) for text in texts],
            "null_radius": [metres(text.split(",")[3]) if text.count(",") == 3 else 0 for text in texts]}


def places(options):
    if "plane" in options:
        size = [metres(part) for part in options.pop("size").split(",")]
        pixels = options.pop("pixels", None)
        return palpa.plane(options.pop("plane"), centre=point(options.pop("centre", "0,0,0")), size=size,
                           pixels=[int(n) for n in pixels.split(",")] if pixels else None)
    if "line" in options:
        ends = options.pop("line")
        return palpa.line(point(ends[0]), point(ends[1]), samples=int(options.pop("samples", 201)))
    if "points" in options:
        return palpa.read_ply(options.pop("points"))
    return None


def touch(options):
    scene = palpa.Scene(options.pop("scene"), **{key: options.pop(key) for key in ("gltf_scene", "surface", "parts") if key in options})
    skin = palpa.read_ply(options.pop("points")) if "points" in options else None
    penetration = metres(options.pop("penetration")) if "penetration" in options else None
    return scene.touch(skin, penetration=penetration, **options)


def drive(options):
    layout = palpa.Layout(options.pop("layout"))
    if "touch" in options:
        slot = options.pop("slot", None)
        return layout.solve_touch(options.pop("touch"), slot=None if slot is None else int(slot), **nulls(options), **options)
    where, gains = foci(options.pop("focus"))
    finger = palpa.Mesh(options.pop("mesh")) if "mesh" in options else None
    return layout.solve(where, gains, finger=finger, **nulls(options), **options)


def field(options):
    layout = palpa.Layout(options.pop("layout"))
    where = places(options)
    if "drive" in options:
        sound = layout.read_drive(options.pop("drive"))
    else:
        solved = {key: options.pop(key) for key in ("amplitude", "solver", "constraint", "pressure") if key in options}
        at, gains = foci(options.pop("focus"))
        air = {key: options[key] for key in ("temperature", "sound_speed", "frequency", "directivity") if key in options}
        sound = layout.solve(at, gains, backend="cpu", **nulls(options), **solved, **air)
    return layout.field(sound, where, **options)


def scatter(options):
    where = places(options)
    waves = {key: point(options.pop(key)) for key in ("plane_wave", "point_source") if key in options}
    if "layout" in options:
        layout = palpa.Layout(options.pop("layout"))
        waves |= {"layout": layout, "drive": layout.read_drive(options.pop("drive"))}
    return palpa.scatter(palpa.Mesh(options.pop("mesh")), where=where, **waves, **options)


def simulate(options):
    finger = palpa.Mesh(options.pop("finger", "assets/finger.ply"))
    penetration = {"penetration": metres(options.pop("penetration"))} if "penetration" in options else {}
    if options.pop("figure6", False):
        return palpa.figure6(finger, **penetration, **options)
    return palpa.simulate(palpa.Scene(options.pop("scene")), finger, **penetration, **options)


class Played:
    """What `export --played` writes."""

    def __init__(self, options):
        self.text = palpa.export_played(options.pop("played"), options.pop("drives"), **options)

    def json(self):
        return self.text


def export(options):
    if "played" in options:
        options.pop("backend", None)  # it always computes on the processor
        return Played(options)
    return palpa.export(options.pop("scene"), options.pop("source", "synthetic"), **options)


class Decomposed:
    """The parts of a model in a file, as the command writes them."""

    def __init__(self, options):
        self.file = options.pop("out")
        self.parts = palpa.decompose(options.pop("scene"), **options)
        self.parts.write(self.file)

    def json(self):
        return self.parts.json(self.file)


def calibrate(options):
    if options.pop("background", False):
        return palpa.learn_background(options.pop("out", None), **options)
    return palpa.calibrate(**options)


def live(options):
    frames = int(options.pop("frames", 0))
    return palpa.Session(palpa.Scene(options.pop("scene")), source=options.pop("source", "synthetic"), **options).run(frames=frames)


IN_PYTHON = {"touch": touch, "drive": drive, "field": field, "scatter": scatter, "simulate": simulate, "export": export, "decompose": Decomposed,
             "calibrate": calibrate, "run": live}


def in_python(words):
    """The result of the line ["touch", "--scene", ...] in Python."""
    return IN_PYTHON[words[0]](options_of(words[1:]))


def same_but_times(text):
    """Without the times, which differ from run to run."""
    text = re.sub(r'"timing_ms": \{[^}]*\}', '"timing_ms": {}', text)
    return re.sub(r'"seconds": [0-9.e+-]+', '"seconds": 0', text)
