"""Fingers that dip into an object as a tracker or depth cameras see them, and one kind of fault after the other."""
import contextlib
import math
import random
import signal
import socket
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/python"))
from edited_glb import with_node  # noqa: E402
from osc_messages import message  # noqa: E402
from tracked_hands import hand, one_finger, palpa_lines  # noqa: E402

FRAME = 1 / 90


def scene_of(name, scale):
    return with_node((ROOT / f"assets/{name}.glb").read_bytes(), scale=[scale, 1, scale])


class Faults:
    """What any source has. `show(depth, many, fault)` of its kinds sends a frame with one finger, or many, so deep
    below y = 0; `fault(...)` may send something else instead, and then returns true. `leave()` sends a frame without a
    finger."""
    scale = 1  # of the scene, across

    def __init__(self, seed, run, emulator, messages, scene):
        self.random, self.run, self.scene = random.Random(seed), run, scene
        self.emulator, self.wire = emulator, emulator.wire
        self.socket, self.osc = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), ("127.0.0.1", messages)
        self.quiet, self.done, self.first_turn = [], {}, None  # begin, end and touches of what nothing disturbed

    def wait(self, until):
        time.sleep(max(0.0, until - time.monotonic()))

    @contextlib.contextmanager
    def cause(self, sounds):
        """What is sent inside may sound: from before it is sent until after, whenever this program goes on."""
        for after in (False, True):
            if sounds:
                with self.wire.lock:
                    self.wire.cause = time.monotonic()
            if not after:
                yield

    def dips(self, seconds, many=False, fault=lambda *_: False, between=lambda now: None):
        """Fingers that dip into the object and leave it, once in each second."""
        begin = time.monotonic()
        while (now := time.monotonic() - begin) < seconds:
            between(now)
            self.show(0.006 * math.sin(2 * math.pi * now) - 0.002, many, fault)
            self.wait(begin + (1 + round(now / FRAME)) * FRAME)
        self.leave()
        self.wait(time.monotonic() + 0.3)

    def undisturbed(self):
        begin = time.monotonic()
        self.dips(3.0)
        self.quiet.append((begin, time.monotonic(), 3))

    def many_fingers(self):
        self.dips(2.0, many=True)

    def frames_stop(self):
        self.show(0.003, False, lambda *_: False)
        self.wait(time.monotonic() + 1.0)

    def osc_flood(self):
        def flood(_):
            for _ in range(100):
                self.socket.sendto(self.random.choice([
                    message("/palpa/gain", "f", self.random.random()),
                    message("/palpa/pose/cube", "fff", 0, 1e-3 * self.random.random(), 0),
                    message("/palpa/stiffness/cube", "ff", 0, self.random.random()),
                    message("/nothing", "f", 1), self.random.randbytes(60)]), self.osc)
        self.dips(1.0, between=flood)
        for one in (message("/palpa/gain", "f", 1), message("/palpa/pose/cube", "fff", 0, 0, 0),
                    message("/palpa/stiffness/cube", "ff", 0, 1)):
            self.socket.sendto(one, self.osc)

    def muted(self):
        self.socket.sendto(message("/palpa/mute", "f", 1), self.osc)
        self.wait(time.monotonic() + 0.3)
        before = self.wire.last_sound
        self.dips(1.0)
        if self.wire.last_sound != before:
            self.wire.late.append((self.wire.last_sound - before, "muted"))
        self.socket.sendto(message("/palpa/mute", "f", 0), self.osc)

    def reload(self):
        for name in ("semi-sphere", "cube"):
            part = self.scene.with_suffix(".part")
            part.write_bytes(scene_of(name, self.scale))
            part.rename(self.scene)
            self.dips(1.0)

    def board_held_up(self):
        with self.wire.lock:
            self.wire.deaf_until = math.inf
        self.emulator.process.send_signal(signal.SIGSTOP)
        self.dips(0.5)
        self.emulator.process.send_signal(signal.SIGCONT)
        self.dips(0.5)
        with self.wire.lock:
            self.wire.deaf_until = time.monotonic()

    def board_pulled(self):
        self.emulator.stop()
        self.dips(1.0)
        self.emulator.start()
        self.dips(3.0)

    def kinds(self):
        return [self.late, self.missing, self.empty, self.broken, self.many_fingers, self.frames_stop, self.osc_flood,
                self.muted, self.reload, self.board_held_up, self.board_pulled]

    def await_first_touch(self, events):
        """Until palpa is there."""
        while self.run.poll() is None and not (events.exists() and events.stat().st_size):
            self.dips(1.0)

    def go_on(self, until):
        begin = time.monotonic()
        while time.monotonic() < until and self.run.poll() is None:
            kinds = self.kinds()
            for kind in self.random.sample(kinds, len(kinds)):
                if time.monotonic() >= until or self.run.poll() is not None:
                    return
                self.wire.doing = kind.__name__
                kind()
                self.done[kind.__name__] = self.done.get(kind.__name__, 0) + 1
                self.wire.doing = f"undisturbed after {kind.__name__}"
                self.undisturbed()
            self.first_turn = self.first_turn or time.monotonic() - begin


class Tracker(Faults):
    """A tracker's hands: one finger, or the ten of two hands."""
    fingers, touches_from, scale = 10, -0.0035, 5

    def __init__(self, port, *others):
        super().__init__(*others)
        self.sender = palpa_lines.Sender(port)

    def show(self, depth, many, fault):
        if fault():
            return
        now = time.monotonic()
        # A hand that does not move at all is none.
        depths, sway = [depth] * 5 if many else one_finger(depth), 1e-4 * math.sin(17 * now)
        hands = [hand(depths, 0.03 + sway), hand(depths, sway - 0.03, "left")] if many else [hand(depths, sway)]
        with self.cause(depth > self.touches_from):
            self.sender.send(now, hands)

    def leave(self):
        self.sender.send(time.monotonic(), [])

    def late(self):
        self.dips(2.0, fault=lambda: self.random.random() < 0.2 and time.sleep(0.05 * self.random.random()))

    def missing(self):
        self.dips(2.0, fault=lambda: self.random.random() < 0.3)

    def empty(self):
        self.dips(2.0, fault=lambda: self.random.random() < 0.1 and (self.leave() or True))

    def broken(self):
        def fault():
            if self.random.random() > 0.3:
                return False
            junk = self.random.choice([b"", b"{", b"\xff" * 40, b'{"t_s": 1e999, "hands": []}',
                                       b'{"t_s": 1, "hands": 7}', self.random.randbytes(300), b"[" * 5000])
            self.sender.socket.sendto(junk, self.sender.address)
            return True
        self.dips(2.0, fault=fault)


def rig_of_cameras():
    """The paper's cameras with a quarter of their pixels."""
    text = (ROOT / "assets/rigs/paper.toml").read_text().split("[array]")[0]
    for key, full, half in (("width", 848, 424), ("height", 480, 240), ("fx", 640.0, 320.0), ("fy", 640.0, 320.0),
                            ("cx", 423.5, 211.5), ("cy", 239.5, 119.5)):
        assert text.count(f"\n{key} = {full}\n") == 3
        text = text.replace(f"\n{key} = {full}\n", f"\n{key} = {half}\n")
    return text


class Cameras(Faults):
    """Three depth cameras (fed_cameras.hpp): one finger, or twenty."""
    fingers, touches_from, scale, depths = 20, -0.0035, 3, 25

    def __init__(self, port, *others):
        super().__init__(*others)
        self.address, self.waiting = ("127.0.0.1", port), []

    def order(self, *words):
        self.socket.sendto(" ".join(map(str, words)).encode(), self.address)

    def frame(self, camera, time_s, picture, kind="whole"):
        depth = (picture - 1) % self.depths * 5e-4 - 8e-3
        with self.cause(kind == "noise" or (picture > 0 and depth > self.touches_from)):
            self.order("frame", camera, time_s, picture, kind)

    def show(self, depth, many, fault):
        picture = 1 + min(self.depths - 1, max(0, round((depth + 8e-3) / 5e-4))) + (self.depths if many else 0)
        now = time.monotonic()
        for camera in range(3):
            if not fault(camera, now, picture):
                self.frame(camera, now, picture)

    def leave(self):
        now = time.monotonic()
        for camera in range(3):
            self.frame(camera, now, 0)

    def empty_for(self, seconds):
        """Long enough for cameras that were away to take part again."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.leave()
            self.wait(time.monotonic() + FRAME)

    def late(self):
        """A camera's frames come one to five frames later than they were captured, in their order."""
        queues = [[], [], []]

        def fault(camera, now, picture):
            queue = queues[camera]
            queue.append((now + self.random.choice([0, 0, 0, 1, 2, 5]) * FRAME, now, picture))
            while queue and queue[0][0] <= now:
                self.frame(camera, *queue.pop(0)[1:])
            return True
        self.dips(2.0, fault=fault)

    def missing(self):
        self.dips(2.0, fault=lambda *_: self.random.random() < 0.3)

    def empty(self):
        self.dips(2.0, fault=lambda camera, now, _: self.random.random() < 0.1 and (self.frame(camera, now, 0) or True))

    def broken(self):
        def fault(camera, now, picture):
            if self.random.random() > 0.3:
                return False
            for kind in self.random.choice([["cut"], ["damaged"], ["noise"], ["whole", "whole"]]):
                self.frame(camera, now, picture, kind)
            return True
        self.dips(2.0, fault=fault)

    def one_freezes(self):
        """For so long that palpa starts it again."""
        frozen = self.random.randrange(3)
        self.dips(4.0, fault=lambda camera, *_: camera == frozen)
        self.empty_for(1.0)

    def come_and_go(self):
        gone = {}

        def between(now):
            if self.random.random() < 0.03:
                camera = self.random.randrange(3)
                self.order("pull", camera)
                gone[camera] = now + self.random.choice([0.0, 0.1, 0.5, 1.0])
            for camera in [one for one, until in gone.items() if until <= now]:
                del gone[camera]
                self.order("plug", camera)
        self.dips(4.0, between=between)
        for camera in gone:
            self.order("plug", camera)
        self.empty_for(1.5)

    def all_pulled(self):
        self.show(0.003, False, lambda *_: False)
        for camera in range(3):
            self.order("pull", camera)
        self.wait(time.monotonic() + self.random.choice([0.2, 1.0, 4.0]))
        for camera in range(3):
            self.order("plug", camera)
        self.empty_for(1.5)

    def kinds(self):
        return [*super().kinds(), self.one_freezes, self.come_and_go, self.all_pulled]
