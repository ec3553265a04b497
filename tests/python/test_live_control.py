"""Other programs change a run: OSC messages, and scenes that are saved."""
import json
import queue
import shutil
import signal
import socket
import subprocess
import time

import numpy as np
import pytest

import palpa
from commands import PALPA, ROOT, begins, drives_in, newest_in, own_port, run, without_lateness
from edited_glb import with_node
from osc_messages import bundle, message
from test_session import pressed

needs_liblo = pytest.mark.skipif("+liblo" not in run(["--version"]), reason="this palpa was built without liblo")


class Program:
    """Another program, which sends to a port where palpa will listen."""

    def __init__(self):
        self.port = own_port()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, *packets):
        for packet in packets:
            self.socket.sendto(packet, ("127.0.0.1", self.port))


@pytest.fixture
def program():
    sender = Program()
    yield sender
    sender.socket.close()


def pushed(cube, program, **options):
    """A run whose frames the test pushes one by one, and a function that pushes one and returns its Touch."""
    session = palpa.Session(cube, **{"source": "points", "layout": "openmpd", "backend": "cpu", "hold": 10, "osc": program.port} | options)
    touches = queue.Queue()
    session.start(on_frame=touches.put)

    def push(skin):
        session.push_points(skin)
        return touches.get(timeout=60)

    return session, push


@needs_liblo
def test_a_pose_holds_from_the_next_frame_on(cube, finger, program):
    session, push = pushed(cube, program)
    with session:
        skin = pressed(finger, 1e-3)
        assert len(push(skin).fingers) == 1
        for pose, touches in [((0, -0.01, 0), 0), ((0, 0.001, 0), 1), ((0.5, 0, 0), 0), ((0, 0, 0), 1),
                              ((0.5, 0, 0), 0), ((0, -0.04, 0, 0, 0, 1, 0), 1),  # upside down: its lower side is now at the top
                              ((0, 0.1, 0, 0, 0, 1, 0), 0),
                              ((0, 0, 0, 0, 0.7071068, 0, 0.7071068), 1)]:
            program.send(message("/palpa/pose/cube", "f" * len(pose), *pose))
            begins(lambda touches=touches: len(push(skin).fingers) == touches)
        program.send(bundle(message("/palpa/gain", "f", 0.5), bundle(message("/palpa/pose/cube", "ddd", 0, -0.01, 0))))
        begins(lambda: push(skin).fingers == [])
        session.stop()
        counts = json.loads(session.wait().json())["osc"]
    assert counts == {"taken": 10, "refused": 0}  # two of them in a bundle


@needs_liblo
def test_gain_and_mute_multiply_the_ceiling_and_never_raise_it(cube, finger, program, tmp_path):
    file = tmp_path / "drives.bin"
    session, push = pushed(cube, program, link=f"record:{file}", ceiling=0.5)
    skin = pressed(finger, 1e-3)

    def plays(amplitude):
        begins(lambda: len(push(skin).fingers) == 1 and newest_in(file) == amplitude)

    with session:
        plays(0.5)
        program.send(message("/palpa/gain", "f", 0.5))
        plays(0.25)
        program.send(message("/palpa/mute", "i", 1))
        plays(0)
        # It stays muted: the poses say that the gain was taken.
        program.send(message("/palpa/gain", "d", 0.25), message("/palpa/pose/cube", "fff", 0.5, 0, 0))
        begins(lambda: push(skin).fingers == [])
        program.send(message("/palpa/pose/cube", "fff", 0, 0, 0))
        plays(0)
        slots = len(drives_in(file, so_far=True))
        begins(lambda: len(push(skin).fingers) == 1 and len(drives_in(file, so_far=True)) > slots + 20)
        assert not drives_in(file, so_far=True)[slots:].any()
        program.send(message("/palpa/mute", "F"))
        plays(0.125)
        with pytest.warns(palpa.PalpaWarning, match="/palpa/gain: give a number from 0 to 1"):
            program.send(*(message("/palpa/gain", "f", gain) for gain in (7, -1, float("nan"), float("inf"))))
            program.send(message("/palpa/gain", "i", 1))
            plays(0.5)
            session.stop()
            assert json.loads(session.wait().json())["osc"] == {"taken": 7, "refused": 4}
    loudest = np.round(drives_in(file).max(axis=1), 6)
    steps = list(loudest[np.flatnonzero(np.diff(loudest, prepend=-1))])
    assert steps[1 if steps[0] == 0 else 0:] == [0.5, 0.25, 0, 0.125, 0.5, 0]


@needs_liblo
def test_how_an_object_feels_changes_within_the_ceiling(finger, program, tmp_path):
    file = tmp_path / "drives.bin"
    session, push = pushed(palpa.Scene(ROOT / "assets/button-and-knob.glb"), program, link=f"record:{file}", ceiling=0.5)
    with session:
        with pytest.warns(palpa.PalpaWarning, match="/palpa/stiffness/button: give 1 to 32 pairs"):
            skin, deep = pressed(finger, 1e-3), pressed(finger, 4e-3)
            begins(lambda: push(skin) and newest_in(file) == 0.25)  # the button's intensity is 0.5
            for stiffness, amplitude in ((0.25, 0.125), (1, 0.25)):
                program.send(message("/palpa/stiffness/button", "ff", 0, stiffness))
                begins(lambda amplitude=amplitude: push(skin) and newest_in(file) == amplitude)
            for packet in (message("/palpa/texture/button", "fff", 0.25, 1, 1), message("/palpa/texture/button", "fff", 1, 0, 0),
                           message("/palpa/click/button", "ff", 0.06, 150), message("/palpa/stiffness/button", "ff", 0, 9),
                           message("/palpa/click/knob", "i", 1)):
                for before, mute in (([packet], 1), ([], 0)):  # which shows that the packet was taken, and is played
                    program.send(*before, message("/palpa/mute", "i", mute))
                    begins(lambda mute=mute: push(skin) and (newest_in(file) > 0) != mute)
            begins(lambda: push(skin) and push(deep) and drives_in(file, so_far=True).max() > 0.45)  # it clicks, with all of the gain
            session.stop()
            assert json.loads(session.wait().json())["osc"] == {"taken": 5 + 10, "refused": 2}
    loudest = drives_in(file).max(axis=1)
    assert 0.45 < loudest.max() <= 0.5 + 1e-6


@needs_liblo
def test_what_is_refused_changes_nothing_and_is_counted(cube, finger, program):
    refused = [message("/palpa/loud", "f", 1), message("/palpa/gain"), message("/palpa/gain", "s", "1"), message("/palpa/gain", "ff", 0, 0),
               message("/palpa/gain", "f", 1.0001), message("/palpa/mute", "f", 0.5), message("/palpa/mute", "i", 2),
               message("/palpa/pose/", "fff", 9, 9, 9), message("/palpa/pose/sphere", "fff", 9, 9, 9), message("/palpa/pose/cube", "ff", 9, 9),
               message("/palpa/pose/cube", "fff", 9, float("nan"), 9), message("/palpa/pose/cube", "fff", 9, 1e9, 9),
               message("/palpa/pose/cube", "fffffff", 9, 9, 9, 0, 0, 0, 0), message("/palpa/pose/cube", "fffffff", 9, 9, 9, 1, 1, 1, 1),
               message("/palpa/pose/cube", "f" * 12, *[9] * 12), message("/palpa/pose/*", "fff", 9, 9, 9), message("/palpa/pose/\x1b[31m", "fff", 9, 9, 9),
               b"", b"/", b"garbage", b"/palpa/gain\0,f\0\0", b"#bundle\0", b"#bundle\0" + b"\0" * 8 + b"\xff" * 8, b"\xff" * 1500]
    session, push = pushed(cube, program)
    with session:
        skin = pressed(finger, 1e-3)
        before = push(skin).fingers[0].depth
        with pytest.warns(palpa.PalpaWarning) as told:
            program.send(*refused, message("/palpa/pose/cube", "fff", 0, 1e-3, 0))
            begins(lambda: push(skin).fingers[0].depth > before + 5e-4)
            session.stop()
            assert json.loads(session.wait().json())["osc"] == {"taken": 1, "refused": len(refused)}
    lines = [str(one.message) for one in told if "--osc" in str(one.message)]
    assert "/palpa/loud: is unknown; known: /palpa/gain, /palpa/mute, /palpa/pose/NAME" in lines[0]
    assert "/palpa/gain: give a number from 0 to 1" in lines[1]
    assert f"{len(refused)} of {len(refused) + 1} messages were refused" in lines[-1]


@needs_liblo
def test_a_flood_delays_nothing(cube, finger, program):
    session, push = pushed(cube, program)
    with session:
        skin = pressed(finger, 1e-3)
        push(skin)
        begin = time.perf_counter()
        with pytest.warns(palpa.PalpaWarning, match="a datagram is no OSC message"):
            for n in range(50):
                program.send(*[message("/palpa/pose/cube", "fff", 0, 0, 1e-6 * n), b"\xff" * 200] * 200)
                assert len(push(skin).fingers) == 1
            assert time.perf_counter() - begin < 60
            # The system drops what finds its buffer full.
            begins(lambda: program.send(message("/palpa/pose/cube", "fff", 0, -0.01, 0)) or push(skin).fingers == [])
            session.stop()
            session.wait()


@needs_liblo
def test_where_it_listens(cube, program, tmp_path):
    other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    other.bind(("127.0.0.1", program.port))
    with other, pytest.raises(palpa.Error, match=f"cannot listen on 127.0.0.1:{program.port}: Address already in use"):
        palpa.Session(cube, source="points", layout="openmpd", backend="cpu", osc=program.port).run(frames=1)
    for form in ("9000x", "0", "65536", "localhost:", ":9000"):
        with pytest.raises(palpa.BadUsage, match="takes PORT or ADDRESS:PORT"):
            palpa.Session(cube, source="points", osc=form)
    with pytest.raises(palpa.BadUsage, match="osc goes with source"):
        palpa.Session(cube, osc=9000)


# ---- the command ----------------------------------------------------------------------------------------------------


class Command:
    """`palpa run` of a scene, whose touches are in a file of events."""

    def __init__(self, scene, folder, *options):
        self.events_file = folder / "events.jsonl"
        line = ["run", "--scene", scene, "--rig", ROOT / "tests/cli/support/small_rig.toml", "--noise-free", "--backend", "cpu",
                "--events", self.events_file, "--event-move", "0", "--stats", "json", *options]
        self.err_file = folder / "stderr"
        with self.err_file.open("w", encoding="utf-8") as err:
            self.process = subprocess.Popen([PALPA, *map(str, line)], cwd=ROOT, stdout=subprocess.PIPE, stderr=err, text=True)

    def events(self):
        text = self.events_file.read_text() if self.events_file.exists() else ""
        return [json.loads(line) for line in text.splitlines() if line.endswith("}")]

    def touches(self, solid):
        """Waits until it is touched from now on."""
        before = len(self.events())
        begins(lambda: any(event["solid"] == solid for event in self.events()[before:]) or self.process.poll() is not None)
        assert self.process.poll() is None

    def says(self, part):
        begins(lambda: part in self.err_file.read_text(encoding="utf-8"))

    def end(self):
        """Its statistics, and its lines on stderr."""
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=120)
        err = self.err_file.read_text(encoding="utf-8")
        assert self.process.returncode == 0, err
        return json.loads(out), without_lateness(err).splitlines()


@needs_liblo
def test_the_command_takes_messages(program, tmp_path):
    file = tmp_path / "drives.bin"
    command = Command(ROOT / "assets/cube.glb", tmp_path, "--osc", program.port, "--layout", "openmpd", "--link", f"record:{file}")
    begins(lambda: newest_in(file) > 0)
    program.send(b"garbage", message("/palpa/mute", "i", 1))

    def silent_while_it_is_touched():
        slots = len(drives_in(file, so_far=True))
        for _ in range(20):
            command.touches("cube")
        return not drives_in(file, so_far=True)[slots:].any()

    begins(silent_while_it_is_touched)
    program.send(message("/palpa/pose/cube", "fff", 0, -1, 0))
    begins(lambda: command.events()[-1]["event"] == "release")
    stats, lines = command.end()
    assert stats["osc"] == {"taken": 2, "refused": 1}
    assert len(lines) == 1 and "a message is refused: a datagram is no OSC message" in lines[0]


def test_a_scene_that_is_saved_is_felt(tmp_path):
    whole = (ROOT / "assets/cube.glb").read_bytes()
    scene, saved = tmp_path / "scene.glb", tmp_path / "scene.glb.new"
    shutil.copy(ROOT / "assets/cube.glb", scene)
    command = Command(scene, tmp_path, "--reload")
    command.touches("cube")

    scene.write_bytes(whole.replace(b'"name":"cube"', b'"name":"tube"'))  # in place
    command.touches("tube")
    scene.write_bytes(whole[:400])  # broken
    command.says("palpa keeps the previous scene")
    command.touches("tube")
    with scene.open("wb") as file:  # in steps; meanwhile, palpa keeps the previous scene
        for at in range(0, len(whole), 64):
            file.write(whole[at:at + 64])
            file.flush()
            time.sleep(0.02)
    command.touches("cube")
    scene.unlink()
    command.says("scene.glb: no such file")
    command.touches("cube")
    saved.write_bytes(whole.replace(b'"name":"cube"', b'"name":"cupe"'))  # as another file
    saved.rename(scene)
    command.touches("cupe")

    stats, lines = command.end()
    assert stats["reload"]["taken"] == 3
    # Where the machine stood still, a half written scene may have looked complete.
    assert 2 <= stats["reload"]["refused"] <= 4
    assert len(lines) == stats["reload"]["refused"] and all("palpa keeps the previous scene: " in line and "scene.glb" in line for line in lines)
    order = [event["solid"] for event in command.events() if event["event"] == "touch"]
    assert [solid for n, solid in enumerate(order) if n == 0 or order[n - 1] != solid] == ["cube", "tube", "cube", "cupe"]
    held = {}
    for event in command.events():  # every touch is released before the next scene's begin
        if event["event"] == "touch":
            held[event["finger"]] = event["solid"]
        assert held[event["finger"]] == event["solid"]
        if event["event"] == "release":
            del held[event["finger"]]
    assert not held


def test_a_scene_with_another_slot_is_refused(tmp_path):
    scene = tmp_path / "scene.glb"
    shutil.copy(ROOT / "assets/cube.glb", scene)
    command = Command(scene, tmp_path, "--reload")
    command.touches("cube")
    scene.write_bytes(with_node(scene.read_bytes(), extras={"palpa_dwell_s": 1e-3}))
    command.says("start the run again")
    command.touches("cube")
    stats, lines = command.end()
    assert stats["reload"] == {"taken": 0, "refused": 1}
    assert len(lines) == 1 and "its shortest dwell is 1 ms, but the link was opened for 1.5 ms: start the run again" in lines[0]
