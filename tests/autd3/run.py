#!/usr/bin/env python3
"""run.py [--built] [--palpa FILE]: palpa and the AUTD3 units of their makers' own emulators.

Plays to the makers' emulated units of 0.13 and 0.12 (a network cable) and of 38 (the older server), and compares every phase and
intensity that they sound with what palpa meant in the same run (--link record:), or, where the units compute the phases of a
focus, with the firmware's formula in whole numbers. Ends palpa by Ctrl-C and kill -9, and looks whether the units are silent. Plays
to the emulator of the Python package autd3 0.12.0, which has to accept every frame.

The Rust programs beside this file are built once, outside the clone: in $XDG_CACHE_HOME/palpa (~/.cache/palpa). The Python package
goes there, too. --built uses what is there, and builds and fetches nothing. Whatever is missing is skipped by name.
"""
import argparse
import json
import os
import pathlib
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "palpa"
TRANSDUCERS = 249
MEANT, LOOKS, LOOK_S = "3s", 30, 0.01  # the sensations below repeat sooner
STEP = 1.6  # of the widths of pulses, in 1/255 of the full amplitude; a gain is rounded down to a step
PATIENCE_S = 60  # for everything that has to happen at some time


def say(text):
    print(f"autd3: {text}", flush=True)


# ---- the makers' units ----------------------------------------------------------------------------------------------


def judge_program(built):
    """The program with the makers' units, or why there is none. One that is older than its sources is built again."""
    target = CACHE / "autd3-judges"
    program, stamp = target / "release/judge", target / "sources"
    text = "".join((HERE / name).read_text() for name in ("Cargo.toml", "Cargo.lock", "judge.rs", "udp.rs", "v38.rs"))
    if program.exists() and stamp.exists() and stamp.read_text() == text:
        return program, ""
    if built:
        return None, "their program was not built before: ./dev test autd3 builds it"
    if not shutil.which("cargo"):
        return None, "there is no cargo here"
    say("building the makers' units, once")
    done = subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=HERE, env=dict(os.environ, CARGO_TARGET_DIR=str(target)),
                          stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        return None, "cargo could not build their program: " + (done.stderr.strip().splitlines() or ["no reason given"])[-1]
    stamp.write_text(text)
    return program, ""


def hexes(text):
    return np.frombuffer(bytes.fromhex(text), np.uint8)


class Units:
    """The units of a judge: each a dictionary with what it sounds."""

    def __init__(self, program, *words):
        self.process = subprocess.Popen([program, *map(str, words)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.address = json.loads(self.process.stdout.readline())["address"]

    def close(self):
        self.process.kill()
        self.process.wait()

    def silent(self):
        return all(unit["sounding"] == 0 and unit.get("other", 0) == 0 for unit in self.now())


class UdpUnits(Units):
    link = "autd3-udp"

    def __init__(self, program, release, units):
        super().__init__(program, release, units)

    def ask(self, text):
        self.process.stdin.write(text + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def now(self):
        return self.ask("dump")["units"]

    def parts(self):
        return self.ask("parts")["units"]

    def refused(self):
        return sum(unit["refused"] for unit in self.now())


class ServedUnits(Units):
    link = "autd3"

    def __init__(self, program, release, _units, *words):
        with socket.socket() as any_port:
            any_port.bind(("127.0.0.1", 0))
            port = any_port.getsockname()[1]
        super().__init__(program, release, "--port", port, "--period-ms", 5, *words)
        self.samples, self.come = [], threading.Condition()
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stdout:
            with self.come:
                self.samples = [*self.samples[-1999:], json.loads(line)]
                self.come.notify_all()

    def newest(self):
        """The next sample."""
        with self.come:
            before = self.samples[-1:]
            self.come.wait_for(lambda: self.samples[-1:] != before, PATIENCE_S)
            return self.samples[-1]

    def now(self):
        return self.newest()["units"]

    def refused(self):
        return self.newest()["errors"]


# ---- what palpa meant -----------------------------------------------------------------------------------------------


def write_layout(file, units):
    """Units side by side, each turned a little more about y."""
    text = 'name = "row"\n'
    for u in range(units):
        half = 0.1 * (u - (units - 1) / 2) / max(1, units - 1)
        text += (f'[[unit]]\ntype = "autd3"\nposition_m = [{0.2 * (u - (units - 1) / 2)!r}, 0.0, {0.01 * u!r}]\n'
                 f"quaternion_wxyz = [{np.cos(half)!r}, 0.0, {-np.sin(half)!r}, 0.0]\n")
    file.write_text(text)
    return file


def frame_of(unit, units):
    """Where a unit's transducer 0 is, and its axes as columns."""
    half = 0.1 * (unit - (units - 1) / 2) / max(1, units - 1)
    angle = -2 * half
    axes = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return np.array([0.2 * (unit - (units - 1) / 2), 0, 0.01 * unit]) + axes @ [-8.5 * 10.16e-3, -6.5 * 10.16e-3, 0], axes


SINE = np.floor(128 + 127.5 * np.sin(2 * np.pi * np.arange(256) / 256)).astype(int)
PLACES = np.array([(round(406.4 * column), round(406.4 * row)) for row in range(14) for column in range(18)
                   if (column, row) not in ((1, 1), (2, 1), (16, 1))])  # in 0.025 mm


def computed_phases(focus, speed):
    """The phases that a unit computes for a focus in 0.025 mm, in whole numbers. `speed`: times 64 m/s."""
    square = ((focus[:2] - PLACES) ** 2).sum(1) + focus[2] ** 2
    distance = np.sqrt(square).astype(int)
    distance -= distance**2 > square
    turn = 16384 * distance // speed
    sine, cosine = SINE[turn % 256] >> 1, SINE[(turn + 64) % 256] >> 1
    return (-np.floor(np.arctan2(sine - 64, cosine - 64) * 128 / np.pi + 0.5) % 256).astype(int)


def heard(intensity):
    """The amplitude of a pulse as wide as a unit's table has it."""
    return np.sin(np.pi * np.rint(512 * np.arcsin(intensity / 255) / np.pi) / 512)


def turns_off(phases, turns):
    """In 1/256 of a turn."""
    return np.abs((phases - 256 * turns + 128) % 256 - 128)


class Meant:
    """The distinct drives of a command, and its foci."""

    def __init__(self, palpa, folder, words):
        subprocess.run([palpa, *words, "--duration", MEANT, "--link", f"record:{folder}/meant.bin", "--csv", f"{folder}/meant.csv", "--quiet"], check=True)
        with open(folder / "meant.bin", "rb") as stream:
            _, _, transducers, _ = np.fromfile(stream, "S8,<u4,<u4,<f8", 1)[0]
            drives = np.fromfile(stream, [("slot", "<u8"), ("drive", "<f4", (transducers, 2))])["drive"]
        self.drives = np.unique(drives[(drives[:, :, 0] > 0).any(1)], axis=0)
        slots = np.genfromtxt(folder / "meant.csv", delimiter=",", names=True)
        self.foci = np.unique(np.stack([slots["x_m"], slots["y_m"], slots["z_m"]], -1), axis=0)
        self.most_phase = self.most_intensity = self.most_true = 0
        self.compared = self.others = 0
        self.kinds = set()

    def compare(self, unit, of, units, phase, intensity):
        """One pattern of a unit with what is nearest to it. Returns the number of the drive."""
        own = self.drives[:, of * TRANSDUCERS:(of + 1) * TRANSDUCERS]
        amplitude_off = 255 * np.abs(own[:, :, 0] - heard(intensity)).max(1)
        off = turns_off(phase.astype(float), own[:, :, 1] / (2 * np.pi)).max(1)
        self.compared += 1
        self.kinds.add(unit["kind"])
        if unit["kind"] == "foci":
            first, axes = frame_of(of, units)
            computed = [computed_phases(np.rint((axes.T @ (focus - first)) / 0.025e-3).astype(int), unit["sound_speed"]) for focus in self.foci]
            right = any((phases == phase).all() for phases in computed) and (amplitude_off < STEP).any()
            self.most_true = max(self.most_true, off.min())
        else:
            near = np.flatnonzero((off < 0.501) & (amplitude_off < STEP))
            right = len(near) > 0
            if right:
                self.most_phase = max(self.most_phase, off[near[0]])
        self.most_intensity = max(self.most_intensity, amplitude_off.min())
        self.others += not right


# ---- cases ----------------------------------------------------------------------------------------------------------


class Stage:
    def __init__(self, palpa, work, tell=say):
        self.palpa, self.work, self.say = palpa, work, tell
        self.failures, self.skipped, self.passed = 0, [], 0

    def skip(self, what, why):
        self.say(f"skipped: {what}: {why}")
        self.skipped.append(what)

    def expect(self, true, what):
        self.say(("ok: " if true else "WRONG: ") + what)
        self.failures += not true
        self.passed += bool(true)

    def begin(self, units, words):
        return subprocess.Popen([self.palpa, *words, "--link", f"{units.link}:{units.address}", "--quiet"], stdin=subprocess.DEVNULL,
                                stderr=open(self.work / "palpa.err", "w"))

    def until(self, true, player=None):
        """Whether that came true in time, and after how many seconds."""
        begin = time.monotonic()
        while time.monotonic() < begin + PATIENCE_S:
            if true():
                return time.monotonic() - begin
            if player and player.poll() is not None:
                return None
        return None

    def play(self, name, units, count, words, looks=LOOKS):
        """Compares what sounds while palpa plays, then ends it by Ctrl-C. Returns the comparison, or None if nothing sounds."""
        meant = Meant(self.palpa, self.work, words)
        player = self.begin(units, words)
        if self.until(lambda: not units.silent(), player) is None:
            player.kill()
            self.expect(False, f"{name}: nothing sounds: {(self.work / 'palpa.err').read_text().strip()}")
            return None
        silent = 0
        for _ in range(looks):
            time.sleep(LOOK_S)
            for number, unit in enumerate(units.now()):
                intensity = hexes(unit["intensity"])
                if intensity.any():
                    meant.compare(unit, number, count, hexes(unit["phase"]), intensity)
                else:
                    silent += 1
        refused = units.refused()
        player.send_signal(signal.SIGINT)
        status = player.wait(PATIENCE_S)
        still = units.silent()
        computed = f", {meant.most_true:.1f}/256 from the true phase at most" if "foci" in meant.kinds else ""
        self.expect(meant.others == 0 and meant.compared > 0 and refused == 0 and status == 0,
                    f"{name}: {meant.compared} drives of {len(meant.drives)} ({', '.join(sorted(meant.kinds))}): {meant.others} others; "
                    f"phases within {meant.most_phase:.2f}/256{computed}, amplitudes within {meant.most_intensity:.2f}/255; {silent} silent, {refused} refused")
        self.expect(still, f"{name}: silent after Ctrl-C")
        return meant

    def kill(self, name, units, words):
        player = self.begin(units, words)
        if self.until(lambda: not units.silent(), player) is None:
            player.kill()
            return self.expect(False, f"{name}: nothing sounds before kill -9")
        player.kill()
        player.wait()
        after = self.until(units.silent)
        self.expect(after is not None, f"{name}: silent after kill -9" + ("" if after is None else f", in {1e3 * after:.0f} ms"))


def units_of(stage, program, release, kind):
    for count in (1, 3):
        layout = write_layout(stage.work / "row.toml", count)
        units = kind(program, release, count)
        try:
            name = f"{release}, {count} unit" + "s" * (count > 1)
            common, slow = ["--layout", layout, "--ceiling", "1"], ["--dwell", "5ms"]
            stage.play(f"{name}, circle", units, count, ["play", "circle", *slow, *common])
            stage.play(f"{name}, circle, amplitudes by distance", units, count, ["play", "circle", "--amplitude", "distance", *slow, *common])
            stage.play(f"{name}, point", units, count, ["play", "point", *common])
            stage.kill(name, units, ["play", "circle", *common])
        finally:
            units.close()


# ---- the Python package ---------------------------------------------------------------------------------------------

EMULATOR = """
import sys, autd3
emulator = autd3.UdpEmulator(int(sys.argv[1]))
print(str(emulator.option().iface).split('"')[1], flush=True)
sys.stdin.read()
"""


def python_with_package(built):
    folder = CACHE / "autd3-0.12"
    python = folder / "bin/python"
    if python.exists() and subprocess.run([python, "-c", "import autd3"], stderr=subprocess.DEVNULL, check=False).returncode == 0:
        return python, ""
    if built:
        return None, "it was not installed before: ./dev test autd3 does it"
    say("installing the Python package autd3 0.12.0, once")
    for words in ([sys.executable, "-m", "venv", folder], [python, "-m", "pip", "install", "--quiet", "autd3==0.12.0"]):
        try:
            done = subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        except OSError as error:
            return None, str(error)
        if done.returncode:
            return None, (done.stderr.strip().splitlines() or ["pip could not install it"])[-1]
    return python, ""


class Relay(threading.Thread):
    """Stands between palpa and emulated units, and counts the answers that refuse something."""

    def __init__(self, group):
        super().__init__(daemon=True)
        self.group, self.client = group, None
        self.front, self.back = self.open(), self.open()
        self.fronts, self.answers, self.refused = {}, 0, 0
        self.port = self.front.getsockname()[1]

    @staticmethod
    def open():
        one = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
        one.bind(("::1", 0))
        return one

    def run(self):
        while True:
            for one in select.select([self.front, self.back, *self.fronts.values()], [], [])[0]:
                data, source = one.recvfrom(2048)
                if one is self.back:
                    port = source[1]
                    if port not in self.fronts:
                        self.fronts[port] = self.open()
                    self.answers += 1
                    status = data[5 if data[1] in (0, 7) else 4]
                    # An answer that asks for another protocol byte is what palpa wants from its first question.
                    self.refused += status != 0 and not (data[1] == 1 and status == 1)
                    self.fronts[port].sendto(data, self.client)
                else:
                    self.client = source
                    port = self.group if one is self.front else next(port for port, front in self.fronts.items() if front is one)
                    self.back.sendto(data, ("::1", port))


def package(stage, python):
    for count in (1, 3):
        emulator = subprocess.Popen([python, "-c", EMULATOR, str(count)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        try:
            relay = Relay(int(emulator.stdout.readline().rsplit(":", 1)[1]))
            relay.start()
            layout = write_layout(stage.work / "row.toml", count)
            for words in (["circle"], ["circle", "--amplitude", "distance"], ["point"]):
                begun = relay.answers
                done = subprocess.run([stage.palpa, "play", *words, "--duration", "1s", "--layout", layout, "--ceiling", "1", "--quiet", "--link",
                                       f"autd3-udp:[::1]:{relay.port}"], stderr=subprocess.PIPE, text=True, check=False)
                stage.expect(done.returncode == 0 and relay.refused == 0 and relay.answers > begun,
                             f"the package autd3 0.12.0, {count} of its units, {' '.join(words)}: {relay.answers - begun} answers, {relay.refused} refuse a frame"
                             + (f": {done.stderr.strip()}" if done.returncode else ""))
        finally:
            emulator.kill()
            emulator.wait()


def main():
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have started this with it ignored, and palpa would inherit that
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--built", action="store_true")
    options.add_argument("--palpa", default=ROOT / "build/release/bin/palpa", type=pathlib.Path)
    given = options.parse_args()
    with tempfile.TemporaryDirectory(prefix="autd3.") as work:
        stage = Stage(given.palpa.resolve(), pathlib.Path(work))
        program, why = judge_program(given.built)
        for release, kind in (("0.13", UdpUnits), ("0.12", UdpUnits), ("38", ServedUnits)):
            if program is None:
                stage.skip(f"the makers' units of {release}", why)
            else:
                units_of(stage, program, release, kind)
        python, why = python_with_package(given.built)
        if python is None:
            stage.skip("the Python package autd3 0.12.0", why)
        else:
            package(stage, python)
    say(f"{stage.passed} passed, {stage.failures} failed, {len(stage.skipped)} skipped" + (f": {'; '.join(stage.skipped)}" if stage.skipped else ""))
    return 1 if stage.failures else 0


if __name__ == "__main__":
    sys.exit(main())
