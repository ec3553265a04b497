#!/usr/bin/env python3
"""A long run on an emulated board: what it costs over time, and what faults do to it.

    /usr/bin/python3 tests/tools/soak/soak.py build/release/bin [MINUTES [SEED [tracker|cameras]]]

Without a seed, palpa's default run: a synthetic hand and depth cameras. With one, faults at random, half the time with
a tracker's hands, half with three depth cameras (or with one of both alone): frames that are late, missing, empty or
broken, frames that stop, cameras that come and go, ten or twenty fingers at once, floods of OSC messages, a scene that
is saved again, another model, a board that is held up, pulled and put back. Prints memory, files and threads as they
are, and at the end the frames, slots and how late drives left. Fails if memory grows by more than 1 MB after the first
minute (with faults, after half the time) and again in as much time after that, or files or threads become more both
times; if anything sounds later than the hold and 20 ms after its cause is gone, if an undisturbed touch has no event,
or if palpa fails.
"""
import json
import os
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import faults
from board import Emulator

ROOT = faults.ROOT
SOURCES = {"tracker": (faults.Tracker, "palpa", "joints:udp:{}"), "cameras": (faults.Cameras, "soak_palpa", "fed:{}")}


def state(process):
    folder = Path(f"/proc/{process}")
    status = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines())
    return {"kb": int(status["RssAnon"].split()[0]), "files": len(list((folder / "fd").iterdir())),
            "threads": int(status["Threads"])}


def guard_of(process):
    for child in Path(f"/proc/{process}/task/{process}/children").read_text().split():
        if "palpa-guard" in Path(f"/proc/{child}/comm").read_text():
            return int(child)
    return None


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def watch(run, begin, until, minutes, series):
    """Looks every few seconds, until then or until the run ends."""
    while time.monotonic() < until and run.poll() is None:
        guard = guard_of(run.pid)
        series.append((time.monotonic() - begin, state(run.pid), state(guard) if guard else None))
        if len(series) % max(1, round(minutes)) == 1:
            at, loop, held = series[-1]
            print(f"{at:7.0f} s  loop {loop['kb'] / 1e3:7.2f} MB {loop['files']:3} files {loop['threads']:3} threads   "
                  f"guard {held['kb'] / 1e3:6.2f} MB {held['files']:3} files" if held else f"{at:7.0f} s", flush=True)
        time.sleep(min(5.0, max(0.0, until - time.monotonic())))


def live_run(programs, minutes, seed, source):
    """Its result, how it ended, what it said, its events, its state over time, its faults (none without a
    seed), and when it had settled (None: too soon to tell)."""
    # In memory, as XDG_RUNTIME_DIR usually is. A search for boards must not wait for a disk.
    with tempfile.TemporaryDirectory(dir="/dev/shm") as name:
        folder = Path(name)
        # Memory is filled when it is taken. Otherwise it would come page by page, and look like a leak.
        environment = {**os.environ, "XDG_RUNTIME_DIR": name, "MALLOC_PERTURB_": "85"}
        kind, program, spec = SOURCES.get(source, (None, "palpa", None))
        scene, port, messages = folder / "scene.glb", free_port(), free_port()
        scene.write_bytes(faults.scene_of("cube", kind.scale if kind else 1))
        emulator = Emulator(str(programs / "palpa"), folder, environment, kind is not None)
        emulator.start()
        line = [str(programs / program), "run", "--scene", str(scene), "--layout", "openmpd", "--link", "openmpd:EMU1",
                "--json", "-", "--events", str(folder / "events")]
        if kind:
            line += ["--source", spec.format(port), "--osc", str(messages), "--reload", "--steps", "off",
                     "--predict", "off"]
        if kind is faults.Cameras:
            (folder / "rig.toml").write_text(faults.rig_of_cameras())
            line += ["--rig", str(folder / "rig.toml")]
        run = subprocess.Popen(line, env=environment, stdout=subprocess.PIPE, stderr=open(folder / "said", "w"),
                               text=True)
        series, done, settled = [], None, None
        try:
            if kind is not None:
                done = kind(port, seed, run, emulator, messages, scene)
                done.await_first_touch(folder / "events")
            begin = time.monotonic()

            def go_on(seconds):
                until = time.monotonic() + seconds
                watching = threading.Thread(target=watch, args=(run, begin, until, minutes, series), daemon=True)
                watching.start()
                if done is not None:
                    done.go_on(until)
                watching.join()
            go_on(60 * minutes)
            settled = settled_after(series, done)
            if settled is not None and run.poll() is None and (grown := list(growth(series, settled))):
                print("goes on, to see whether this was all: " + "; ".join(grown), flush=True)
                settled, more = series[-1][0], series[-1][0] - settled
                go_on(more)
        finally:
            run.terminate()  # SIGINT does nothing to a program in the background
            result = run.communicate()[0]
            time.sleep(0.3)
            emulator.stop()
        events = [json.loads(one) for one in (folder / "events").read_text().splitlines()]
        return result, run.returncode, (folder / "said").read_text(), events, series, done, settled


def settled_after(series, done):
    """The time after which nothing should grow; None if the run was too short. Faults reach the most that they need only
    after a few turns."""
    if done is None:
        return 60
    half = max(60, series[-1][0] / 2)
    return half if done.first_turn and done.first_turn < half else None


def growth(series, settled):
    """What grew after that time. A scene that is loaded again, and a camera that is closed, need more for a moment. Faults
    that first come together late (twenty fingers while a scene is loaded) need more once; a leak grows again and again,
    so what grew is looked at for as much time again."""
    for which, who in ((1, "loop"), (2, "guard")):
        after = [one[which] for one in series if one[which] and one[0] > settled]
        part = len(after) // 5
        for what, most in (("kb", 1000), ("files", 0), ("threads", 0)) if part else ():
            more = min(one[what] for one in after[-part:]) - statistics.median(one[what] for one in after[:part])
            if more > most:
                yield f"the {who}'s {what} grew by {more} after {settled:.0f} s"


def touches_of(events):
    """How many touches began and ended, and how many there were at once."""
    now = began = ended = most = 0
    for event in events:
        began, ended = began + (event["event"] == "touch"), ended + (event["event"] == "release")
        most = max(most, began - ended)
    return began, ended, most


def faulty(done, events, fingers):
    print("faults: " + ", ".join(f"{count} {kind}" for kind, count in sorted(done.done.items())))
    late = done.wire.late
    if late:
        most, doing = max(late)
        yield f"{len(late)} times, something sounded too long after its cause, most {most:.3f} s ({doing})"
    touched = [event["time_s"] for event in events if event["event"] == "touch"]
    felt = [sum(begin <= time_s <= end for time_s in touched) for begin, end, _ in done.quiet]
    lost = sum(max(0, touches - found) for found, (_, _, touches) in zip(felt, done.quiet))
    print(f"{sum(touches for _, _, touches in done.quiet)} undisturbed touches, {lost} without an event")
    if lost:
        yield f"{lost} undisturbed touches have no event"
    if done.done.get("many_fingers") and fingers < done.fingers:
        yield f"of {done.fingers} fingers at once, {fingers} were felt"


def soak(programs, minutes, seed=None, source=None):
    """Prints what happened, and returns what is wrong."""
    result, code, said, events, series, done, settled = live_run(programs, minutes, seed, source)
    wrong = [] if code == 0 and result else [f"palpa ended with {code}: {said[-500:]}"]
    if settled is not None:
        wrong += growth(series, settled)
    else:
        print("too short to find leaks: each fault must come once in the first half")
    if result:
        stats = json.loads(result)
        jitter = stats["timing_ms"]["drive_jitter"]
        print(f"{stats['frames']['captured']} frames, {stats['frames'].get('replaced', 0)} replaced; "
              f"{stats['drives']['sent']} slots, {stats['drives']['skipped_slots']} left out; "
              f"late by p50 {jitter['median']} p99 {jitter['p99']} p99.9 {jitter['p999']} "
              f"max {jitter['max']} ms; {stats.get('scheduling')}; {stats['hand_over']['drives']}")
        if done is None and sum(one["event"] == "touch" for one in events) < stats["seconds"] // 2 - 1:
            wrong.append("the finger touches every 2 s, but some touches have no event")
    began, ended, most = touches_of(events)
    print(f"{began} touches, {ended} releases; at most {most} at once")
    if began != ended:
        wrong.append(f"{began} touches and {ended} releases")
    if done is not None:
        wrong += faulty(done, events, most)
    wrong += ["palpa said: " + one for one in said.splitlines() if one.startswith("palpa: error")][:1]
    return wrong


def main():
    programs, minutes = Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
    wrong = []
    if len(sys.argv) < 4:
        wrong = soak(programs, minutes)
    else:
        sources = sys.argv[4:] or list(SOURCES)
        for source in sources:
            print(f"{source}:", flush=True)
            wrong += [f"{source}: {one}" for one in soak(programs, minutes / len(sources), int(sys.argv[3]), source)]
    for one in wrong:
        print("soak: " + one)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
