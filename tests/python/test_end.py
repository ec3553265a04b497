"""The interpreter's end and Ctrl-C, whatever the functions of a session do. Each case is a process of its own."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import palpa
from commands import ROOT, assert_it_sounded_and_ended_in_silence, drives_in, python, without_lateness

SESSION = """
import gc, sys, threading, time
import numpy as np
import palpa
scene, skin = palpa.Scene("assets/cube.glb"), palpa.read_ply("assets/finger.ply")
sounds = threading.Event()
seen = 0
def look(touch):
    global seen
    seen += bool(touch.fingers)
    if seen > 30 and not sounds.is_set():
        print("sounds\\n", end="", flush=True)  # one string: another thread prints, too
        sounds.set()
def focus(transfer, gains):
    return np.conj(transfer[0]) / abs(transfer[0])
def ring(finger):
    openmpd.transfer(openmpd.from_world(finger.positions))
    return finger.centroid + 4e-3 * finger.axes
def calls(touch):
    look(touch)
    touch.csv()
    scene.touch(skin, penetration=2e-3, backend="cpu")
openmpd = palpa.Layout("openmpd")
options = {"source": "synthetic", "layout": "openmpd", "noise_free": True, "backend": "cpu", "hold": 1, "link": "record:" + sys.argv[1]}
"""
ENDLESS = """
def stuck(touch):
    look(touch)
    if sounds.is_set():
        %s
"""
STUCK = "session = palpa.Session(scene, **options)\nsession.start(on_frame=stuck)\n"
LOOKS = "session = palpa.Session(scene, **options)\nsession.start(on_frame=look)\n"
CASES = {
    "a callback": LOOKS,
    "a solver": "session = palpa.Session(scene, solver=focus, **options)\nsession.start(on_frame=look)\n",
    "a method": "session = palpa.Session(scene, method=ring, **options)\nsession.start(on_frame=look)\n",
    "a callback that calls palpa": "session = palpa.Session(scene, **options)\nsession.start(on_frame=calls)\n",
    "a callback that computes": ENDLESS % "while True: pass" + STUCK,
    "a callback that catches everything": ENDLESS % "while True:\n            try: time.sleep(0.01)\n            except BaseException: pass" + STUCK,
    "a callback that sleeps": ENDLESS % "time.sleep(1e6)" + STUCK,
    "a callback that waits": ENDLESS % "threading.Event().wait()" + STUCK,
    "another thread waits for the run": "session = palpa.Session(scene, **options)\ncallbacks = {'on_frame': look, 'on_event': lambda event: None}\n"
                                        "threading.Thread(target=session.run, kwargs=callbacks, daemon=True).start()\n",
}
ENDS = [(case, "sys.exit(3)", 3) for case in CASES] + [("a callback", "", 0), ("a callback", "del session; gc.collect()", 0), ("a callback", "1 / 0", 1)]


@pytest.mark.parametrize("case, end, code", ENDS)
def test_the_interpreter_ends_whatever_a_session_runs(case, end, code, tmp_path):
    done = python(f"{SESSION}{CASES[case]}sounds.wait()\n{end}\n", tmp_path / "drives.bin")
    err = done.stderr.partition("Traceback")[0] if code == 1 else done.stderr
    assert (done.returncode, done.stdout, without_lateness(err)) == (code, "sounds\n", "")
    assert_it_sounded_and_ended_in_silence(tmp_path / "drives.bin")


@pytest.mark.parametrize("fault, code", [("SystemExit(5)", 5), ("KeyboardInterrupt()", -signal.SIGINT)])
def test_a_callback_that_ends_the_program(fault, code):
    done = python(SESSION + f"def ends(touch):\n    raise {fault}\npalpa.Session(scene, **(options | {{'link': 'null'}})).run(on_frame=ends)\n", "-")
    assert done.returncode == code and done.stdout == ""


def test_ctrl_c(tmp_path):
    code = SESSION + """
session = palpa.Session(scene, **options)
try:
    session.run(on_frame=look)
except KeyboardInterrupt:
    print("interrupted", session.running)
"""
    with subprocess.Popen([sys.executable, "-c", code, tmp_path / "drives.bin"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        assert process.stdout.readline() == "sounds\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    assert (out, without_lateness(err), process.returncode) == ("interrupted False\n", "", 0)
    assert_it_sounded_and_ended_in_silence(tmp_path / "drives.bin")


@pytest.mark.parametrize("waits", ["while True: pass", "time.sleep(1e6)"])
def test_a_second_ctrl_c_leaves_a_callback_that_does_not_return(waits, tmp_path):
    code = SESSION + ENDLESS % waits + """
import signal
raised = [0]
def handle(*_):
    if len(raised) < 3 and time.monotonic() - raised[-1] > 0.1:
        raised.append(time.monotonic())
        raise KeyboardInterrupt
signal.signal(signal.SIGINT, handle)
session = palpa.Session(scene, **options)
try:
    with session:
        session.run(on_frame=stuck)
except KeyboardInterrupt:
    del session
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    print("interrupted", flush=True)
"""
    with subprocess.Popen([sys.executable, "-c", code, tmp_path / "drives.bin"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        assert process.stdout.readline() == "sounds\n"
        for _ in range(300):  # one that comes while another is handled is the same one
            process.send_signal(signal.SIGINT)
            try:
                process.wait(0.2)
                break
            except subprocess.TimeoutExpired:
                pass
        out, err = process.communicate(timeout=120)
    assert (out, process.returncode, without_lateness(err)) == ("interrupted\n", 0, "")
    assert_it_sounded_and_ended_in_silence(tmp_path / "drives.bin")


@pytest.mark.times
@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_ctrl_c_ends_a_field_and_a_spread(backend):
    """Without it, each takes a minute of processor time."""
    paper = palpa.Layout("paper")
    drive = paper.drive([0, 0, 0], backend="cpu")
    plane = palpa.plane("xy", size=(0.2, 0.2), pixels=(2048, 2048))
    foci = [[0.01 * n, 0, 0] for n in range(10)]
    for work in (lambda: paper.field(drive, plane, backend=backend),
                 lambda: paper.solve(foci, spread="amplitude=10%,phase=0.2", draws=10000, backend=backend)):
        sent = []

        def interrupt(sent=sent):
            sent.append(time.process_time())
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(0.15, interrupt)
        with pytest.raises(KeyboardInterrupt):
            timer.start()
            work()
        assert time.process_time() - sent[0] < 10
        timer.join()


def test_an_error_that_nobody_waits_for_is_told(cube, monkeypatch):
    told = []
    monkeypatch.setattr(sys, "unraisablehook", lambda what: told.append((what.exc_type, str(what.exc_value))))

    def fails(touch):
        raise LookupError("mine")

    session = palpa.Session(cube, source="synthetic", layout="openmpd", backend="cpu")
    session.start(on_frame=fails)
    while session.running:
        time.sleep(0.01)
    del session
    assert told == [(LookupError, "mine")]
    code = SESSION + "def fails(touch): raise LookupError('mine')\nsession = palpa.Session(scene, **(options | {'link': 'null'}))\n" \
        "session.start(on_frame=fails)\nwhile session.running: time.sleep(0.01)\n"
    done = python(code, "-")
    assert done.returncode == 0 and "LookupError: mine" in done.stderr and "nobody has waited for" in done.stderr


@pytest.mark.parametrize("who", ["on_frame", "on_event", "method", "solver"])
def test_there_is_no_ramp_after_an_error(who, cube, tmp_path):
    """As docs/safety.md promises: the drive before the silence is not a quiet one. The session can run again."""
    calls = []

    def fails(*arguments):
        calls.append(arguments)
        if len(calls) > 30:
            raise LookupError("mine")
        if who == "method":
            return arguments[0].centroid + 4e-3 * arguments[0].axes
        return np.conj(arguments[0][0]) / np.abs(arguments[0][0]) if who == "solver" else None

    options = {"source": "synthetic", "layout": "openmpd", "backend": "cpu", "every_frame": True, "hold": 10, "ramp": 0.4,
               "link": f"record:{tmp_path}/drives.bin"}
    session = palpa.Session(cube, **options, **({who: fails} if not who.startswith("on_") else {"event_move": 0.0}))
    with pytest.raises(LookupError, match="mine"):
        session.run(**({who: fails} if who.startswith("on_") else {}))
    assert not session.running
    loudest = drives_in(tmp_path / "drives.bin").max(axis=1)
    sounding = loudest[loudest > 0]
    assert loudest[-1] == 0 and sounding[-1] > 0.5 * sounding.max()
    calls.clear()
    (tmp_path / "drives.bin").unlink()
    again = []
    session.run(on_frame=lambda touch: again.append(touch) or len(again) < 2)  # which does not wait for the end of the hold
    assert len(again) >= 2
