#!/usr/bin/env python3
"""A long run on an emulated board: what it costs over time, and what faults do to it.

    /usr/bin/python3 tests/tools/soak.py build/release/bin/palpa [MINUTES [SEED]]

Without a seed, palpa's default run: a synthetic hand and depth cameras. With one, a tracker's hands, and faults at random: frames that are
late, missing, empty or broken, a tracker that stops, hands that come and go, ten fingers at once, floods of OSC messages, a scene that is
saved again, another model, a board that is held up, pulled and put back. Prints memory, files and threads as they are, and at the end the
frames, slots and how late drives left. Fails if memory grows by more than 1 MB after the first minute, if files or threads become more,
if anything sounds later than the hold and 20 ms after its cause is gone, if an undisturbed touch has no event, or if palpa fails.
"""
import json
import math
import os
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples/trackers"))
import mediapipe_hands  # noqa: E402
import palpa_lines  # noqa: E402

HOLD, GRACE, FRAME = 0.1, 0.02, 1 / 90
TIP = 0.0065


def hand(side, depths, x, jitter):
    """A hand above the cube whose fingers point down. Each tip is so deep below y = 0, and the hand moves a little."""
    mirror = 1 if side == "right" else -1
    landmarks = np.zeros((21, 3))
    landmarks[0] = [x + 0.02 * mirror + jitter, TIP - max(depths) + 0.17, 0]
    for finger, depth in enumerate(depths):
        for joint in range(4):
            landmarks[1 + 4 * finger + joint] = [x + 0.02 * (finger - 1) * mirror, TIP - depth + 0.025 * (3 - joint), 0]
    return palpa_lines.hand(side, mediapipe_hands.openxr_joints(landmarks), mediapipe_hands.openxr_radii())


def osc(address, *numbers):
    def text(words):
        raw = words.encode() + b"\0"
        return raw + b"\0" * (-len(raw) % 4)
    return text(address) + text("," + "f" * len(numbers)) + b"".join(struct.pack(">f", n) for n in numbers)


class Wire:
    """What the board hears, from the emulator's trace."""

    def __init__(self, fifo):
        self.last_sound, self.late = 0.0, []
        self.cause = 0.0  # when sound last had a reason: the newest frame with a touch was sent
        self.deaf_until = 0.0  # the emulator was held up: what it reads then is old
        self.lock = threading.Lock()
        threading.Thread(target=self.read, args=(fifo,), daemon=True).start()

    def read(self, fifo):
        while True:
            with open(fifo, "rb") as lines:
                for line in lines:
                    at = line.find(b'"hex":"')
                    if b'"bulk"' not in line or at < 0:
                        continue
                    payload = line[at + 7:line.rfind(b'"')]
                    if len(payload) < 1024 or payload[-512:].strip(b"0") == b"":
                        continue
                    when = float(line[line.find(b":") + 1:line.find(b",")])
                    with self.lock:
                        self.last_sound = when
                        if when > max(self.cause + HOLD + GRACE, self.deaf_until):
                            self.late.append(when - self.cause)


class Emulator:
    def __init__(self, palpa, folder, environment, traced):
        self.palpa, self.environment = palpa, environment
        self.fifo = folder / "wire" if traced else None
        if traced:
            os.mkfifo(self.fifo)
        self.process = None

    def start(self):
        trace = ["--trace", str(self.fifo)] if self.fifo else []
        self.process = subprocess.Popen([self.palpa, "emulate", "openmpd", "--quiet", *trace], env=self.environment,
                                        stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def stop(self):
        self.process.terminate()
        self.process.wait()


def state(process):
    folder = Path(f"/proc/{process}")
    status = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines())
    return {"kb": int(status["RssAnon"].split()[0]), "files": len(list((folder / "fd").iterdir())), "threads": int(status["Threads"])}


def guard_of(process):
    for child in Path(f"/proc/{process}/task/{process}/children").read_text().split():
        if "palpa-guard" in Path(f"/proc/{child}/comm").read_text():
            return int(child)
    return None


class Faults:
    """Sends a tracker's frames, and one kind of fault after the other."""

    def __init__(self, seed, run, emulator, wire, tracker, messages, scene):
        self.random, self.run, self.emulator, self.wire, self.scene = random.Random(seed), run, emulator, wire, scene
        self.sender, self.osc = palpa_lines.Sender(tracker), ("127.0.0.1", messages)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.frame, self.begin, self.touches, self.done = 0, time.monotonic(), 0, {}

    def wait(self, until):
        time.sleep(max(0.0, until - time.monotonic()))

    def send(self, hands, touches):
        if touches:
            with self.wire.lock:
                self.wire.cause = time.monotonic()
        self.sender.send(time.monotonic(), hands)

    def dips(self, seconds, sides=("right",), fingers=1, spoil=lambda: None):
        """Fingers that dip into the cube and leave it, once in each second. `spoil` may send something else instead of a frame."""
        begin, since = time.monotonic(), None
        while (now := time.monotonic() - begin) < seconds:
            depth = 0.006 * math.sin(2 * math.pi * now) - 0.002
            every = [depth - 0.05] * 5
            for finger in range(1, 1 + fingers):
                every[finger % 5] = depth
            if not spoil():
                jitter = 1e-4 * math.sin(17 * now)
                self.send([hand(side, every, 0.0 if side == "right" else 0.06, jitter) for side in sides], depth > -0.001)
            since = self.frame
            self.frame += 1
            self.wait(begin + (self.frame - since + round(now / FRAME)) * FRAME)
        self.send([], False)
        self.wait(time.monotonic() + 0.3)

    def undisturbed(self):
        self.dips(3.0)
        self.touches += 3

    def late(self):
        self.dips(2.0, spoil=lambda: self.random.random() < 0.2 and (time.sleep(0.05 * self.random.random()) or False))

    def missing(self):
        self.dips(2.0, spoil=lambda: self.random.random() < 0.3)

    def empty(self):
        self.dips(2.0, spoil=lambda: self.random.random() < 0.1 and (self.send([], False) or True))

    def broken(self):
        def spoil():
            if self.random.random() > 0.3:
                return False
            junk = self.random.choice([b"", b"{", b"\xff" * 40, b'{"t_s": 1e999, "hands": []}', b'{"t_s": 1, "hands": 7}',
                                       self.random.randbytes(300), b"[" * 5000])
            self.sender.socket.sendto(junk, self.sender.address)
            return True
        self.dips(2.0, spoil=spoil)

    def ten_fingers(self):
        self.dips(2.0, ("right", "left"), 5)

    def tracker_stops(self):
        self.send([hand("right", [-0.047, 0.003, -0.047, -0.047, -0.047], 0.0, 0.0)], True)
        self.wait(time.monotonic() + 1.0)

    def osc_flood(self):
        def spoil():
            for _ in range(100):
                message = self.random.choice([osc("/palpa/gain", self.random.random()), osc("/palpa/pose/cube", 0, 1e-3 * self.random.random(), 0),
                                              osc("/palpa/stiffness/cube", 0, self.random.random()), osc("/nothing", 1), self.random.randbytes(60)])
                self.socket.sendto(message, self.osc)
            return False
        self.dips(1.0, spoil=spoil)
        for message in (osc("/palpa/gain", 1), osc("/palpa/pose/cube", 0, 0, 0), osc("/palpa/stiffness/cube", 0, 1)):
            self.socket.sendto(message, self.osc)

    def muted(self):
        self.socket.sendto(osc("/palpa/mute", 1), self.osc)
        self.wait(time.monotonic() + 0.3)
        before = self.wire.last_sound
        self.dips(1.0)
        if self.wire.last_sound != before:
            self.wire.late.append(self.wire.last_sound - before)
        self.socket.sendto(osc("/palpa/mute", 0), self.osc)

    def reload(self):
        for name in ("semi-sphere", "cube"):
            part = self.scene.with_suffix(".part")
            part.write_bytes((ROOT / f"assets/{name}.glb").read_bytes())
            part.rename(self.scene)
            self.dips(1.0)

    def held_up(self):
        with self.wire.lock:
            self.wire.deaf_until = math.inf
        self.emulator.process.send_signal(signal.SIGSTOP)
        self.dips(0.5)
        self.emulator.process.send_signal(signal.SIGCONT)
        self.dips(0.5)
        with self.wire.lock:
            self.wire.deaf_until = time.monotonic()

    def pulled(self):
        self.emulator.stop()
        self.dips(1.0)
        self.emulator.start()
        self.dips(3.0)

    def go_on(self, until):
        kinds = [self.late, self.missing, self.empty, self.broken, self.ten_fingers, self.tracker_stops, self.osc_flood, self.muted,
                 self.reload, self.held_up, self.pulled]
        while time.monotonic() < until and self.run.poll() is None:
            for kind in self.random.sample(kinds, len(kinds)):
                if time.monotonic() >= until or self.run.poll() is not None:
                    return
                kind()
                self.done[kind.__name__] = self.done.get(kind.__name__, 0) + 1
                self.undisturbed()


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def watch(run, until, minutes, series):
    """Looks every few seconds until the run ends. Then asks it to end."""
    begin = time.monotonic()
    while time.monotonic() < until and run.poll() is None:
        guard = guard_of(run.pid)
        series.append((time.monotonic() - begin, state(run.pid), state(guard) if guard else None))
        if len(series) % max(1, round(minutes)) == 1:
            at, loop, held = series[-1]
            print(f"{at:7.0f} s  loop {loop['kb'] / 1e3:7.2f} MB {loop['files']:3} files {loop['threads']:3} threads   "
                  f"guard {held['kb'] / 1e3:6.2f} MB {held['files']:3} files" if held else f"{at:7.0f} s", flush=True)
        time.sleep(min(5.0, max(0.0, until - time.monotonic())))


def main():
    palpa = sys.argv[1]
    minutes = float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else None
    failures = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # Memory is filled when it is taken. Otherwise it would come page by page, and look like a leak.
        environment = {**os.environ, "XDG_RUNTIME_DIR": name, "MALLOC_PERTURB_": "85"}
        scene = folder / "scene.glb"
        scene.write_bytes((ROOT / "assets/cube.glb").read_bytes())
        emulator = Emulator(palpa, folder, environment, seed is not None)
        wire = Wire(emulator.fifo) if seed is not None else None
        emulator.start()
        line = [palpa, "run", "--scene", str(scene), "--layout", "openmpd", "--link", "openmpd:EMU1", "--json", "-", "--events", str(folder / "events")]
        tracker, messages = free_port(), free_port()
        if seed is not None:
            line += ["--source", f"joints:udp:{tracker}", "--osc", str(messages), "--reload", "--steps", "off", "--predict", "off"]
        run = subprocess.Popen(line, env=environment, stdout=subprocess.PIPE, stderr=open(folder / "said", "w"), text=True)
        until, series = time.monotonic() + 60 * minutes, []
        if seed is None:
            watch(run, until, minutes, series)
        else:
            faults = Faults(seed, run, emulator, wire, tracker, messages, scene)
            watching = threading.Thread(target=watch, args=(run, until, minutes, series), daemon=True)
            time.sleep(3)
            watching.start()
            faults.go_on(until)
        run.send_signal(signal.SIGINT)
        result, code = run.communicate()[0], run.returncode
        time.sleep(0.3)
        emulator.stop()
        said = (folder / "said").read_text()
        events = [json.loads(one) for one in (folder / "events").read_text().splitlines()]
    if code != 0 or not result:
        failures.append(f"palpa ended with {code}: {said[-500:]}")
    # Faults reach the most that they need only after a few turns.
    settled = 60 if seed is None else max(60, series[-1][0] / 2)
    for which, who in ((1, "loop"), (2, "guard")):
        before, after = ([one[which] for one in series if one[which] and (one[0] > settled) == late] for late in (False, True))
        if not after:
            continue
        for what, most in (("kb", 1000), ("files", 0), ("threads", 0)):
            if (more := max(one[what] for one in after) - max(one[what] for one in before)) > most:
                failures.append(f"the {who}'s {what} grew by {more} after {settled:.0f} s")
    if result:
        stats = json.loads(result)
        jitter = stats["timing_ms"]["drive_jitter"]
        print(f"{stats['frames']['captured']} frames, {stats['frames'].get('replaced', 0)} replaced; {stats['drives']['sent']} slots, "
              f"{stats['drives']['skipped_slots']} left out; late by p50 {jitter['median']} p99 {jitter['p99']} p99.9 {jitter['p999']} "
              f"max {jitter['max']} ms; {stats.get('scheduling')}; {stats['hand_over']['drives']}")
    began, ended = (sum(1 for one in events if one["event"] == kind) for kind in ("touch", "release"))
    print(f"{began} touches, {ended} releases")
    if began != ended:
        failures.append(f"{began} touches and {ended} releases")
    if seed is not None:
        print("faults: " + ", ".join(f"{count} {kind}" for kind, count in sorted(faults.done.items())))
        print(f"{faults.touches} undisturbed touches; the last sound after a cause: {max(wire.late, default=0):.3f} s too late")
        if wire.late:
            failures.append(f"{len(wire.late)} times, something sounded up to {max(wire.late):.3f} s after its cause")
        if began < faults.touches:
            failures.append(f"{faults.touches} undisturbed touches have only {began} events")
    unknown = [one for one in said.splitlines() if one.startswith("palpa: error")]
    if unknown:
        failures.append("palpa said: " + unknown[0])
    for failure in failures:
        print("soak: " + failure)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
