"""Hands from a tracker, and the example programs that send them."""
import math
import socket
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import palpa
from commands import ROOT, own_port, run
from tracked_hands import TIP_RADIUS, hand, mediapipe_hands, one_finger, palpa_lines, pointing


def film(frames):
    """A finger that dips 2 mm into the cube; it moves a little in every frame."""
    return [palpa_lines.line(0.01 * n, [hand(one_finger(2e-3 * math.sin(0.1 * n)), 1e-5 * n)]) for n in range(frames)]


@pytest.fixture
def recorded(tmp_path):
    file = tmp_path / "hands.jsonl"
    file.write_text("\n".join(film(30)) + "\n")
    return f"joints:{file}"


def test_an_export_is_the_commands(cube, recorded, tmp_path):
    result = palpa.export(cube, recorded, backend="cpu")
    file = tmp_path / "foci.csv"
    json = run(["export", "--scene", "assets/cube.glb", "--source", recorded, "--foci", str(file), "--backend", "cpu",
                "--json", "-"])
    assert result.json() == json
    table = np.genfromtxt(file, delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert len(table) == len(result.foci["x"]) > 100
    thin = palpa.export(cube, recorded, backend="cpu", delta=1e-3)
    assert np.abs(result.foci["y"]).max() > np.abs(thin.foci["y"]).max()  # the shell is 3 mm thick unless it is given


def test_a_run_takes_what_a_program_sends(cube):
    port = own_port()
    fingers, ends = [], threading.Event()

    def send():
        sender = palpa_lines.Sender(port)
        begin = time.monotonic()
        while not ends.wait(0.01):
            t = time.monotonic() - begin
            sender.send(t, [hand(one_finger(1.5e-3), 1e-4 * math.sin(t))])

    def on_frame(frame):
        fingers.append(len(frame.fingers))
        return 1 not in fingers

    session = palpa.Session(cube, backend="cpu", layout="openmpd", source=f"joints:udp:{port}", link="null")
    sending = threading.Thread(target=send)
    sending.start()
    try:
        session.run(frames=1000, on_frame=on_frame)
    finally:
        ends.set()
        sending.join()
    assert fingers[-1] == 1


def test_what_it_sends_is_recorded_as_lines(cube, tmp_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(60)
        sender = palpa_lines.Sender(receiver.getsockname()[1])
        recorded = b""
        for n in range(3):
            sender.send(0.01 * n, [hand(one_finger(2e-3), 1e-5 * n)])
            recorded += receiver.recv(1 << 16)
    file = tmp_path / "hands.jsonl"
    file.write_bytes(recorded)
    assert palpa.export(cube, f"joints:{file}", backend="cpu").frames == 3


def test_what_a_tracker_cannot_do(cube, recorded, tmp_path):
    with pytest.raises(ValueError, match="goes with depth cameras"):
        palpa.Session(cube, backend="cpu", layout="openmpd", source=recorded, link="null", keep_boards=True)
    with pytest.raises(ValueError, match="26"):
        palpa_lines.hand("right", [(0, 0, 0)] * 21, [0.01] * 21)
    (tmp_path / "bad.jsonl").write_text("{}\n")
    with pytest.raises(palpa.BadInput, match="line 1"):
        palpa.export(cube, f"joints:{tmp_path / 'bad.jsonl'}", backend="cpu")


def test_the_examples_tell_how_they_are_called():
    for name, wrong, told_of in (("openxr_hands.py", ["port"], "a port is from 1 to 65535, not port"),
                                 ("mediapipe_hands.py", ["model", "abc"], "invalid float value")):
        call = [sys.executable, str(ROOT / "examples/trackers" / name)]
        told = subprocess.run([*call, "--help"], capture_output=True, text=True)
        assert told.returncode == 0 and f"usage: {name}" in told.stdout and told.stderr == ""
        refused = subprocess.run([*call, *wrong], capture_output=True, text=True)
        assert refused.returncode == 2 and told_of in refused.stderr


def test_of_hands_that_mediapipe_calls_alike_the_surest_is_sent():
    assert mediapipe_hands.surest([("Right", 0.8), ("Left", 0.7)]) == {0: "left", 1: "right"}
    assert mediapipe_hands.surest([("Right", 0.8), ("Right", 0.9)]) == {1: "left"}
    assert mediapipe_hands.surest([("Left", 0.9), ("Left", 0.8)]) == {0: "right"}
    assert mediapipe_hands.surest([]) == {}


def test_the_axes_and_joints_of_the_example():
    landmarks = pointing(one_finger(TIP_RADIUS))
    joints = mediapipe_hands.openxr_joints(landmarks)
    assert joints.shape == (26, 3) and len(mediapipe_hands.openxr_radii()) == 26
    assert np.array_equal(joints[10], landmarks[8]) and np.array_equal(joints[25], landmarks[20])
    assert np.array_equal(joints[5], landmarks[4]) and np.array_equal(joints[1], landmarks[0])
    # The image's right, down and forward are the tracker's right, minus up and minus backward.
    assert np.array_equal(mediapipe_hands.to_tracker(np.array([[1, 2, 3]])), [[1, -2, -3]])
