"""play.py: what palpa sends to a board in a run, and the drives that the run intended."""
import json
import os
import pathlib
import subprocess
import sys
import time

import numpy as np

from still import ROOT, SCENE

sys.path.insert(0, str(ROOT / "tests/house"))
from wires import Board  # noqa: E402

BYTE = np.dtype([("at_s", "<f8"), ("value", "u1")])


def wire_bytes(trace, serial=None, begin_s=3e-3):
    """The bytes of a trace and when each came. The first one of all boards comes at begin_s."""
    at, values, first = [], [], None
    for line in pathlib.Path(trace).read_text().splitlines():
        entry = json.loads(line)
        if entry["kind"] == "control":
            continue
        first = entry["t_s"] if first is None else first
        if serial and entry.get("serial") != serial:
            continue
        data = bytes.fromhex(entry.get("hex", ""))
        at += [entry["t_s"] - first + begin_s] * len(data)
        values += data
    wire = np.zeros(len(at), BYTE)
    wire["at_s"], wire["value"] = at, values
    return wire


def line_end(wire, baud):
    """When a serial line has sent all of it."""
    number, byte_s = np.arange(len(wire)), 10 / baud
    return float((wire["at_s"] - number * byte_s).max() + len(wire) * byte_s)


def read_drives(file, settled=20):
    """The distinct sounding drives of a file that --link record:FILE or --drives wrote, amplitudes and phases, without its first slots.
    Those of two frames of a resting finger differ by the rounding of floats, which no wire carries: they count as one."""
    with open(file, "rb") as stream:
        magic, version, transducers, _ = np.fromfile(stream, "S8,<u4,<u4,<f8", 1)[0]
        assert magic == b"palpadrv" and version == 1
        drives = np.fromfile(stream, [("slot", "<u8"), ("drive", "<f4", (transducers, 2))])["drive"]
    distinct, found = [], np.unique(drives[settled:][(drives[settled:, :, 0] > 0).any(1)], axis=0)
    for drive, waves in zip(found, found[:, :, 0] * np.exp(1j * found[:, :, 1])):
        if not any(np.abs(waves - other).max() < 1e-4 for _, other in distinct):
            distinct.append((drive, waves))
    return np.array([drive for drive, _ in distinct])


def rests(trace, seconds=0.5):
    """Waits until the emulator has read all that palpa left in the line: it reads at the speed of a board."""
    size = -1
    while trace.stat().st_size != size:
        size = trace.stat().st_size
        time.sleep(seconds)


class Player:
    """Runs palpa against its own emulators, each time in a new folder."""

    def __init__(self, palpa, folder, recording):
        self.palpa, self.folder, self.recording, self.count = palpa, folder, recording, 0

    def begin(self, kind, more):
        self.count += 1
        folder = self.folder / f"{self.count}"
        folder.mkdir()
        # The sockets of USB boards; another emulator of this machine may run.
        environment = dict(os.environ, XDG_RUNTIME_DIR=str(folder))
        return folder, environment, Board(self.palpa, kind, folder, environment, *more)

    def palpa_with_board(self, kind, emulator, link, words):
        """The trace of what a command sends. `link` has {} for the emulator's address."""
        folder, environment, board = self.begin(kind, emulator)
        try:
            with open(folder / "palpa.err", "wb") as err:
                status = subprocess.run([self.palpa, *words, "--link", link.format(board.address), "--quiet"], env=environment, stdin=subprocess.DEVNULL,
                                        stderr=err, cwd=ROOT, check=False).returncode
            rests(folder / "wire.jsonl")
            for report in board.end():
                if report["violation_count"]:
                    raise RuntimeError(f"the emulator complains: {report['violations']}")
        finally:
            board.close()
        if status:
            raise RuntimeError(f"palpa {words[0]}: exit code {status}: {(folder / 'palpa.err').read_text()}")
        return folder / "wire.jsonl"

    def run(self, kind, link, rig, words, frames=24, emulator=(), of_link=()):
        """A live run with the resting finger: its trace, and the drives that it intends. `of_link`: options of the link alone."""
        common = ["--scene", SCENE, "--source", f"recording:{self.recording}", "--rig", rig, "--smoothing", "none", "--backend", "cpu", *words]
        trace = self.palpa_with_board(kind, emulator, link, ["run", *common, *of_link, "--predict", "off", "--frames", str(frames)])
        file = trace.parent / "drives.bin"
        subprocess.run([self.palpa, "export", *common, "--predict-latency", "20ms", "--frames", "60", "--drives", file, "--quiet"], check=True, cwd=ROOT)
        return trace, read_drives(file)

    def link_test(self, kind, link, words, emulator=()):
        return self.palpa_with_board(kind, emulator, link, ["link", "test", *words])
