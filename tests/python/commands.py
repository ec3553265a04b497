"""The documented command lines, and the same in Python; programs and threads of tests; what a link got."""
import concurrent.futures
import contextlib
import itertools
import os
import pathlib
import re
import shlex
import socket
import struct
import subprocess
import sys
import time
import zlib

import numpy as np
import pytest

import palpa
from palpa import _case

ROOT = pathlib.Path(__file__).resolve().parents[2]
PALPA = os.environ.get("PALPA_BINARY", str(ROOT / "build/release/bin/palpa"))
# As many transducers as openmpd, in another order and at other places.
TWIN = next(name for name in palpa.Layout.names() if name != "openmpd" and len(palpa.Layout(name)) == len(palpa.Layout("openmpd")))
# Options of outputs, of which the module has arrays.
OUTPUTS = {"wav", "csv", "png", "vtu", "json", "stats"}
FLAGS = {"spectrum", "audible", "tune", "force", "no_absorption", "absorption", "noise_free", "figure6", "quiet", "allow_outside", "every_frame", "keep_boards",
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


PORTS = itertools.cycle(10000 + (37 * os.getpid() + n) % 20000 for n in range(20000))  # below the ephemeral ones


def own_port():
    """A UDP port that was free a moment ago, and that the system gives to nobody who asks for any port."""
    for port in PORTS:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free, contextlib.suppress(OSError):
            free.bind(("127.0.0.1", port))
            return port


def drives_in(file, transducers=256, so_far=False):
    """The amplitudes that --link record:FILE wrote, a row per slot, by the description in docs/run.md. `so_far`: while it is being written."""
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


def write_png(file, image):
    """Grey, of 8 or 16 bits."""
    rows = image.astype(f">u{image.itemsize}")
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8 * image.itemsize, 0, 0, 0, 0)),
              (b"IDAT", zlib.compress(b"".join(b"\0" + row.tobytes() for row in rows))), (b"IEND", b""))
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks))


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


def computed(command):
    """Computes as a sweep does, which takes the command's texts."""
    def result(options):
        lists = {name: value if isinstance(value, list) else [value] for name, value in options.items() if name in ("focus", "null")}
        return _case.CALLS[command](options | lists, (), {})
    return result


def scatter(options):
    where = _case.places(options) if options.keys() & {"plane", "line", "points"} else None
    waves = {key: _case.lengths(options.pop(key)) for key in ("plane_wave", "point_source") if key in options}
    if "layout" in options:
        layout = palpa.Layout(options.pop("layout"))
        waves |= {"layout": layout, "drive": layout.read_drive(options.pop("drive"))}
    return palpa.scatter(palpa.Mesh(options.pop("mesh")), where=where, **waves, **options)


def simulate(options):
    finger = options.pop("finger", "assets/finger.ply")
    if options.pop("figure6", False):
        return palpa.figure6(palpa.Mesh(finger), **options)
    return computed("simulate")(options | {"finger": finger})


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


IN_PYTHON = {"touch": computed("touch"), "drive": computed("drive"), "field": computed("field"), "scatter": scatter, "simulate": simulate, "export": export, "decompose": Decomposed,
             "calibrate": calibrate, "run": live}


def in_python(words):
    """The result of the line ["touch", "--scene", ...] in Python."""
    return IN_PYTHON[words[0]](options_of(words[1:]))


def same_but_times(text):
    """Without the times, which differ from run to run."""
    text = re.sub(r'"timing_ms": \{[^}]*\}', '"timing_ms": {}', text)
    return re.sub(r'"seconds": [0-9.e+-]+', '"seconds": 0', text)
