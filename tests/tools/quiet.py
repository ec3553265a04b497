#!/usr/bin/env python3
"""How loud boards are to the ear, from what emulators are sent: each goal of docs/quiet.md, by code that shares nothing with palpa.

    python3 tests/tools/quiet.py build/release/bin/palpa

Starts `palpa emulate` with a trace and `palpa run`, plays the trace's frames as a board does, lets transducers with a Q of 20 and 40
follow them, and prints the A-weighted level of beta / (2 pi c^2 r) dP/dt at 0.72 m, the longest queue and the processor time. Then it
computes what steps change in the vibration that skin feels, line by line, without palpa. Needs numpy. Run it on an idle machine: drives that are lost beside load change the levels by a decibel or two.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parents[2]
PERIOD, C, RHO, BETA, D2, LEVEL, FAR = 25e-6, 343.2, 1.204, 1.2, 0.291, 4.386, 0.72
LINES = [k / 0.015 for k in (1, 2, 3, 4, 6)]  # of the vibration at a focus, whose turn comes every 15 ms


def places():
    return np.array([((x - 7.5) * 0.0105, (7.5 - y) * 0.0105) for x in range(16) for y in range(16)])


def pins():
    wire = {0: (1, 5), 1: (0, 4), 2: (3, 6), 3: (2, 7)}
    return np.array([64 * (3 - x // 4) + 8 * (7 - y // 2) + wire[x % 4][y % 2] for x in range(16) for y in range(16)])


def frames_of(trace):
    """(arrival, complex drive) of each frame."""
    out, rest = [], b""
    where, last = pins(), 0
    for line in open(trace):
        entry = json.loads(line)
        if entry["kind"] != "bulk":
            continue
        if entry["t_s"] - last > 1:
            rest = b""
        last = entry["t_s"]
        rest += bytes.fromhex(entry["hex"])
        while len(rest) >= 512:
            block, rest = rest[:512], rest[512:]
            one = np.frombuffer(block, np.uint8)
            phase, width = one[:256][where] & 127, one[256:][where] & 127
            amplitude = np.sin(np.pi * width / 128)
            out.append((entry["t_s"], amplitude * np.exp(2j * np.pi * (phase - (64 - width) / 2) / 128)))
    return out


def play(frames, periods=4):
    """The drive of each period, and the most frames that waited."""
    shown, queue, free, most, at = [], [], 0, 0, 0
    for arrival, _ in frames:
        begin = max(int(arrival / PERIOD) + 1, free)
        shown.append(begin)
        free = begin + periods
        queue = [b for b in queue if b > arrival / PERIOD] + [begin]
        most = max(most, len(queue))
    drives = np.zeros((shown[-1] + periods - shown[0], 256), complex)
    for (begin, (_, drive)), end in zip(zip(shown, frames), shown[1:] + [shown[-1] + periods]):
        drives[begin - shown[0]:end - shown[0]] = drive
    return drives, most


def weighting(hz):
    f2 = np.maximum(hz, 1e-9) ** 2
    gain = 12194.217 ** 2 * f2 ** 2 / ((f2 + 20.598997 ** 2) * np.sqrt((f2 + 107.65265 ** 2) * (f2 + 737.86223 ** 2)) * (f2 + 12194.217 ** 2))
    return gain * 10 ** 0.1


def level(drives, q):
    rest, a = np.exp(-np.pi / q), np.zeros(drives.shape[1], complex)
    power = np.empty(len(drives))
    for k, drive in enumerate(drives):
        a = drive + (a - drive) * rest
        power[k] = np.sum(abs(a) ** 2)
    power *= LEVEL ** 2 * np.pi * D2 / (RHO * C)
    hz = np.fft.rfftfreq(len(power), PERIOD)
    window = np.hanning(len(power))
    lines = np.fft.rfft((power - power.mean()) * window) / len(power) * 2 * np.pi * hz * BETA / (2 * np.pi * C * C * FAR)
    return 10 * np.log10(2 * np.sum(abs(lines) ** 2 * weighting(hz) ** 2) / np.mean(window ** 2) / (20e-6) ** 2)


def run(palpa, words, frames=120):
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_RUNTIME_DIR": folder}
        trace = Path(folder) / "wire.jsonl"
        emulator = subprocess.Popen([palpa, "emulate", "openmpd", "--trace", trace, "--quiet"], env=environment, stdout=subprocess.PIPE)
        emulator.stdout.readline()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([palpa, "run", "--scene", HERE / "assets/cube.glb", "--source", "synthetic", "--noise-free", "--layout",
                               "openmpd", "--link", "openmpd:EMU1", "--backend", "cpu", "--frames", str(frames), "--json", "-", *words],
                              env=environment, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        emulator.terminate()
        emulator.wait()
        if done.returncode:
            sys.exit(done.stderr)
        frames = frames_of(trace)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    sounding = [i for i, (_, drive) in enumerate(frames) if abs(drive).any()]
    drives, most = play(frames[sounding[0]:sounding[-1] + 1])
    half = int(0.4 / PERIOD)  # the last 0.4 s of the touch
    return {"levels": np.array([level(drives[-half:], q) for q in (20, 40)]), "queue": most, "processor": processor,
            "palpa": json.loads(done.stdout).get("audible_dba"), "lost": json.loads(done.stdout)["hand_over"]["drives"]["lost"]}


def vibration(steps, q, rings=12):
    """The lines of |p|^2 on a ring of 35 mm, 150 mm above the board: ten foci, stride 3, slots of 60 periods, changes in `steps` of 4."""
    def at(count):
        angle = 2 * np.pi * np.arange(count) / count
        place = np.stack([0.0175 * np.cos(angle), 0.0175 * np.sin(angle), np.full(count, 0.15)], 1)
        return np.linalg.norm(place[:, None] - np.column_stack([places(), np.zeros(256)])[None], axis=2)
    wave = 2 * np.pi * 40e3 / C
    foci = -wave * at(10)[[3 * k % 10 for k in range(10)]]
    rest, a, shown = np.exp(-np.pi / q), np.zeros(256, complex), []
    for slot in range(10 * rings):
        before, change = foci[(slot - 1) % 10], np.angle(np.exp(1j * (foci[slot % 10] - foci[(slot - 1) % 10])))
        for period in range(60):
            drive = np.exp(1j * (before + change * min(1, (period // 4 + 1) / steps)))
            a = drive + (a - drive) * rest
            shown.append(a)
    far = at(60)
    power = abs(np.array(shown[1200:]) @ (np.exp(1j * wave * far) / far).T) ** 2
    time = np.arange(len(power)) * PERIOD
    return np.array([np.sqrt(np.mean(abs(np.mean(power * np.exp(-2j * np.pi * hz * time)[:, None], 0)) ** 2)) for hz in LINES])


def main():
    palpa = sys.argv[1]
    cases = {
        "jumps": ["--steps", "off"],
        "--ramp of before": ["--steps", "off", "--ramp", "20ms"],
        "steps": [],
        "one focus, 1.5 ms, jumps": ["--method", "single-focus", "--dwell", "1.5ms", "--steps", "off"],
        "one focus": ["--method", "single-focus"],
    }
    print(f"{'':28} dB(A) Q 20  Q 40   queue  lost  processor s   palpa says")
    for name, words in cases.items():
        found = run(palpa, words)
        low, high = found["levels"]
        print(f"{name:28} {low:9.1f} {high:6.1f} {found['queue']:6} {found['lost']:6} {found['processor']:9.2f}     {found['palpa']}", flush=True)
    print(f"\nvibration, steps against jumps, dB at {', '.join(f'{hz:.0f}' for hz in LINES)} Hz:")
    for q in (20, 40):
        change = 20 * np.log10(vibration(14, q) / vibration(1, q))
        print(f"Q {q}: " + "  ".join(f"{one:+.1f}" for one in change))


if __name__ == "__main__":
    main()
