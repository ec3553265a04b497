"""The example that Adaptics' Designer drives: spoken to as the Designer does, and as others may."""
import base64
import contextlib
import json
import os
import re
import resource
import signal
import socket
import struct
import subprocess
import sys
import time

import numpy as np
import pytest

from commands import PALPA, ROOT, begins

websockets = pytest.importorskip("websockets")
sys.path.insert(0, str(ROOT / "examples/adaptics"))
import server as adaptics  # noqa: E402

IDENTITY = [[1.0 if row == column else 0.0 for column in range(4)] for row in range(4)]
PATTERN = (ROOT / "assets/sensations/circle.adaptics").read_text(encoding="utf-8")


class Client:
    """A websocket of its own, so that it may also send what no library sends."""

    def __init__(self, port, origin=None):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        lines = ["GET / HTTP/1.1", f"Host: 127.0.0.1:{port}", "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(), "Sec-WebSocket-Version: 13"]
        lines += [f"Origin: {origin}"] if origin is not None else []
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            self.bytes += self._read()
        head, self.bytes = self.bytes.split(b"\r\n\r\n", 1)
        self.status = int(head.split()[1])

    def _read(self):
        data = self.socket.recv(1 << 16)
        if not data:
            raise ConnectionError
        return data

    def frame(self, data, kind=1, last=True):
        mask = os.urandom(4)
        size = struct.pack("!BH", 0x80 | 126, len(data)) if len(data) < 1 << 16 else struct.pack("!BQ", 0x80 | 127, len(data))
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(data))
        self.socket.sendall(bytes([(0x80 if last else 0) | kind]) + size + mask + masked)

    def send(self, cmd, **data):
        self.frame(json.dumps({"cmd": cmd, "data": data}).encode())

    def next(self):
        """The next text; answers pings."""
        while True:
            while len(self.bytes) < 2:
                self.bytes += self._read()
            kind, size, head = self.bytes[0] & 15, self.bytes[1] & 127, 2
            if size == 126:
                head = 4
            elif size == 127:
                head = 10
            while len(self.bytes) < head:
                self.bytes += self._read()
            if size > 125:
                size = int.from_bytes(self.bytes[2:head], "big")
            while len(self.bytes) < head + size:
                self.bytes += self._read()
            data, self.bytes = self.bytes[head:head + size], self.bytes[head + size:]
            if kind == 9:
                self.frame(data, 10)
            elif kind == 8:
                raise ConnectionError
            elif kind == 1:
                return json.loads(data)

    def connect_as_the_designer(self, pattern=PATTERN):
        self.parameters()
        self.send("update_playstart", playstart=0, playstart_offset=-1.7e12)
        self.send("update_pattern", pattern_json=pattern)
        self.parameters()
        self.send("update_tracking", enabled=False)

    def parameters(self, time_ms=0, **given):
        self.send("update_parameters",
                  evaluator_params={"time": time_ms, "user_parameters": given, "geometric_transform": IDENTITY})

    def play(self, offset_ms=0.0):
        self.send("update_playstart", playstart=1.7e12, playstart_offset=offset_ms)

    def evals_until(self, condition):
        """The first update whose newest point fulfils the condition."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            message = self.next()
            assert message["cmd"] == "playback_update"
            if condition(message["data"]["evals"]):
                return message["data"]["evals"]
        raise AssertionError("no such update")


PATIENCE_S = 60  # a test's client answers pings only while it reads, and does other work in between


@contextlib.contextmanager
def serve(*options, patience_s=PATIENCE_S, before="", **more):
    """Its port and its process. Clients that freeze are dropped that soon. `before`: what else is done before its main()."""
    code = (f"import sys; sys.path.insert(0, {str(ROOT / 'examples/adaptics')!r}); import server\n"
            f"server.PING_S = server.PATIENCE_S = {patience_s}\n{before}\nserver.main()")
    with subprocess.Popen([sys.executable, "-c", code, "--port", "0", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          **more) as process:
        try:
            yield int(re.search(r":(\d+)/", process.stdout.readline())[1]), process
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(60)


@pytest.fixture
def served(request):
    """Its port, its process, and a socket that gets its foci. With a parameter, clients that freeze are dropped that soon."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as heard:
        heard.bind(("127.0.0.1", 0))
        heard.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        with serve("--layout", "openmpd", "--link", f"foci:udp:127.0.0.1:{heard.getsockname()[1]}",
                   patience_s=getattr(request, "param", PATIENCE_S)) as (port, process):
            yield port, process, heard


def sounds(heard):
    """Whether the newest line that has come sounds; None if none came."""
    newest = None
    heard.setblocking(False)
    while True:
        try:
            newest = json.loads(heard.recv(1 << 16))
        except BlockingIOError:
            return None if newest is None else any(finger["gain"] > 0 for finger in newest["fingers"])


def wait_for_sound(heard, wanted):
    end = time.monotonic() + 60
    while sounds(heard) is not wanted:
        assert time.monotonic() < end
        time.sleep(0.02)


def radius_mm(evals):
    at = evals[-1]["ul_control_point"]["coords"]
    return round((at["x"] ** 2 + at["y"] ** 2) ** 0.5, 3)


def test_it_plays_what_the_designer_draws(served):
    port, process, heard = served
    designer = Client(port, origin=adaptics.DESIGNER)
    assert designer.status == 101
    designer.connect_as_the_designer()
    designer.play()
    evals = designer.evals_until(lambda evals: len(evals) >= 8)
    assert len(evals) <= 64 and radius_mm(evals) == 10 and abs(evals[0]["ul_control_point"]["coords"]["z"] - 200) < 1e-9
    assert set(evals[0]) == {"ul_control_point", "pattern_time", "stop", "next_eval_params"} and evals[0]["stop"] is False
    assert abs(evals[1]["pattern_time"] - evals[0]["pattern_time"] - 0.625) < 1e-9  # 16 places in a turn of 100 Hz
    wait_for_sound(heard, True)
    designer.parameters(radius=25)
    designer.evals_until(lambda evals: radius_mm(evals) == 25)
    designer.parameters()  # and back
    designer.evals_until(lambda evals: radius_mm(evals) == 10)
    edited = json.loads(PATTERN)
    edited["keyframes"][0]["brush"]["brush"]["params"]["radius"] = {"type": "f64", "value": 15}
    designer.send("update_pattern", pattern_json=json.dumps(edited))
    designer.evals_until(lambda evals: radius_mm(evals) == 15)
    designer.send("update_playstart", playstart=0, playstart_offset=-1.7e12)
    wait_for_sound(heard, False)
    designer.parameters(5000)
    designer.play(-5000.0)  # goes on from 5 s
    evals = designer.evals_until(lambda evals: evals[-1]["pattern_time"] >= 5000)
    assert evals[0]["pattern_time"] < 60000
    wait_for_sound(heard, True)
    designer.socket.close()  # without a word: the last client is gone
    wait_for_sound(heard, False)
    again = Client(port)
    again.connect_as_the_designer()
    again.play()
    wait_for_sound(heard, True)
    again.socket.close()
    wait_for_sound(heard, False)
    assert process.poll() is None


# Column and row of each transducer, in units of its pitch from the middle, and the place of its byte in a frame.
COLUMN, ROW = np.arange(256) // 16, np.arange(256) % 16
PIN = 64 * (3 - COLUMN // 4) + 8 * (7 - ROW // 2) + np.array([[1, 5], [0, 4], [3, 6], [2, 7]])[COLUMN % 4, ROW % 2]
AT_MM = 10.5 * np.stack([COLUMN - 7.5, 7.5 - ROW], axis=1)
RADII_MM = np.arange(5, 31, 5)


def radii_on_the_wire(trace):
    """For each frame in which the board sounds, how far from its axis the sound converges 200 mm above it; 0 for silence."""
    data = b"".join(bytes.fromhex(entry["hex"]) for entry in map(json.loads, trace.read_text().splitlines()[:-1]) if entry["kind"] == "bulk")
    frames = np.frombuffer(data[:len(data) // 512 * 512], np.uint8).reshape(-1, 512)
    widths = (frames[:, 256:] & 0x7F)[:, PIN]
    turns = (((frames[:, :256] & 0x7F)[:, PIN] - (64 - widths.astype(float)) / 2) / 128)[:, None, :]
    angles = np.arange(0, 2 * np.pi, 0.05)
    radii = np.zeros(len(frames))
    sounding = np.flatnonzero(widths.any(axis=1))
    best = np.zeros(len(sounding))
    for radius in RADII_MM:
        places = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        away_mm = np.sqrt(((AT_MM[None] - places[:, None]) ** 2).sum(axis=2) + 200.0 ** 2)
        wave = np.exp(2j * np.pi * away_mm / 8.58)
        sent = np.exp(2j * np.pi * turns[sounding, 0])
        together = np.abs(sent @ wave.T).max(axis=1) / 256
        radii[sounding] = np.where(together > best, radius, radii[sounding])
        best = np.maximum(best, together)
    assert (best > 0.95).all()
    return radii


def test_the_wire_of_a_board_has_what_the_designer_does(tmp_path):
    trace, where = tmp_path / "wire.jsonl", {"env": os.environ | {"XDG_RUNTIME_DIR": str(tmp_path)}}
    emulator = subprocess.Popen([PALPA, "emulate", "openmpd", "--serial", "EMU1", "--trace", str(trace), "--json", str(tmp_path / "heard.json")],
                                **where)
    try:
        begins(lambda: (tmp_path / "palpa" / "usb-1.sock").exists())
        with serve("--link", "openmpd:EMU1", "--steps", "off", "--ceiling", "0.5", **where) as (port, process):
            ends = lambda silent: begins(lambda: len(radii := radii_on_the_wire(trace)) and (radii[-1] == 0) == silent)  # noqa: E731
            designer = Client(port, origin=adaptics.DESIGNER)
            designer.connect_as_the_designer()
            designer.play()
            designer.evals_until(lambda evals: evals[-1]["pattern_time"] > 300)
            designer.parameters(radius=25)
            designer.evals_until(lambda evals: radius_mm(evals) == 25)
            designer.send("update_pattern", pattern_json=PATTERN.replace('"param", "value": "radius"', '"f64", "value": 15'))
            designer.evals_until(lambda evals: radius_mm(evals) == 15)
            designer.send("update_playstart", playstart=0, playstart_offset=-1.7e12)
            ends(True)
            designer.parameters(5000)
            designer.play(-5000.0)
            designer.evals_until(lambda evals: evals[-1]["pattern_time"] > 5000)
            ends(False)
            designer.socket.close()
            ends(True)
            assert process.poll() is None
    finally:
        emulator.send_signal(signal.SIGTERM)
        assert emulator.wait(60) == 0
    radii = radii_on_the_wire(trace)
    heard = [int(radius) for radius, before in zip(radii[1:], radii) if radius != before]
    # A machine that holds the loop up makes it fall silent in between, and continue.
    sounds = [radius for i, radius in enumerate(radius for radius in heard if radius) if i == 0 or radius != [r for r in heard if r][i - 1]]
    assert sounds == [10, 25, 15] and heard[-1] == 0
    assert json.loads((tmp_path / "heard.json").read_text())["boards"][0]["violation_count"] == 0


def test_a_port_that_is_taken_is_told_in_a_line(served):
    done = subprocess.run([sys.executable, ROOT / "examples/adaptics/server.py", "--port", str(served[0])], capture_output=True, text=True,
                          timeout=120, check=False)
    assert done.returncode == 1 and f"--port {served[0]}: " in done.stderr and len(done.stderr.splitlines()) == 1


def test_it_listens_only_with_its_link_open(tmp_path):
    done = subprocess.run([sys.executable, ROOT / "examples/adaptics/server.py", "--port", "0", "--link", "openmpd:ABSENT"],
                          capture_output=True, text=True, timeout=120, check=False, env=os.environ | {"XDG_RUNTIME_DIR": str(tmp_path)})
    assert done.returncode == 1 and done.stdout == "" and "ABSENT" in done.stderr


def test_a_stop_is_told(served):
    port, _, heard = served
    client = Client(port)
    stopping = json.loads(PATTERN)
    stopping["keyframes"].append({"type": "stop", "time": 1000})
    client.connect_as_the_designer(json.dumps(stopping))
    for _ in range(2):
        client.play()
        evals = client.evals_until(lambda evals: evals[0]["stop"])
        assert len(evals) >= 2 and all(one["ul_control_point"]["intensity"] == 0 for one in evals)
        wait_for_sound(heard, False)


@pytest.mark.parametrize("served", [2], indirect=True)  # it must sound before that
def test_a_client_that_freezes_is_dropped(served):
    port, _, heard = served
    frozen, other = Client(port), Client(port)
    frozen.connect_as_the_designer()
    frozen.play()
    wait_for_sound(heard, True)
    other.socket.close()
    wait_for_sound(heard, False)  # the last client that answers pings is gone; it has read nothing since


def test_half_finished_handshakes_keep_nobody_out():
    few_files = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (128, 128))  # noqa: E731
    with serve("--layout", "openmpd", preexec_fn=few_files) as (port, process):
        halves = []
        for _ in range(200):
            halves.append(socket.create_connection(("127.0.0.1", port), timeout=60))
            halves[-1].sendall(b"GET / HTTP/1.1\r\n")
        assert Client(port, origin=adaptics.DESIGNER).status == 101
        for half in halves:  # the last ones after a while
            with contextlib.suppress(ConnectionError):
                while half.recv(1 << 16):
                    pass
        assert process.poll() is None


def test_a_signal_does_not_wait_for_its_loop():
    stuck = """
async def send_updates(self):
    while not self.player.sensation.playing:
        await server.asyncio.sleep(0.02)
    import time
    time.sleep(600)
server.Server.send_updates = send_updates
"""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as heard:
        heard.bind(("127.0.0.1", 0))
        with serve("--layout", "openmpd", "--link", f"foci:udp:127.0.0.1:{heard.getsockname()[1]}", before=stuck) as (port, process):
            try:
                client = Client(port)
                client.connect_as_the_designer()
                client.play()
                wait_for_sound(heard, True)
                process.send_signal(signal.SIGINT)
                wait_for_sound(heard, False)
            finally:
                process.kill()


def test_a_port_that_is_none_is_told():
    for port in ("99999", "-1", "x"):
        done = subprocess.run([sys.executable, ROOT / "examples/adaptics/server.py", "--port=" + port], capture_output=True, text=True,
                              timeout=120, check=False)
        assert done.returncode == 2 and "a port is from 0 to 65535" in done.stderr


def test_pages_of_others_are_refused(served):
    port, _, _ = served
    for origin in ("null", "https://evil.example", "https://adaptivehaptics.github.io.evil.example",
                   "http://adaptivehaptics.github.io", "https://evil-adaptivehaptics.github.io", "http://localhost.evil.example",
                   "http://127.0.0.1.evil.example", "http://localhost@evil.example", "https://adaptivehaptics.github.io:444", ""):
        assert Client(port, origin).status == 403, origin
    for origin in (adaptics.DESIGNER, "http://localhost", "http://localhost:8080", "http://127.0.0.1:3000", "http://[::1]:80", None):
        assert Client(port, origin).status == 101, origin
    assert adaptics.may_connect("null", ["null"]) and not adaptics.may_connect("null")
    assert adaptics.may_connect("http://example.org", ["http://example.org"])


def test_no_message_does_harm(served):
    port, process, heard = served
    client = Client(port)
    client.connect_as_the_designer()
    client.play()
    wait_for_sound(heard, True)
    for text in (b"", b"{", b"[]", b"null", b"7", b'{"cmd":"update_pattern"}', b'{"cmd":3,"data":{}}', b'{"cmd":"_set","data":{}}',
                 b'{"cmd":"take","data":{}}', b'{"cmd":"update_pattern","data":{"pattern_json":"{}"}}', b"[" * 100000,
                 b'{"cmd":"update_pattern","data":{"pattern_json":3}}', b'{"cmd":"update_playstart","data":{"playstart":"now"}}',
                 b'{"cmd":"update_playstart","data":{"playstart":1,"playstart_offset":NaN}}',
                 b'{"cmd":"update_playstart","data":{"playstart":1,"playstart_offset":1e300}}',
                 b'{"cmd":"user_parameter","data":{"name":"radius","value":Infinity}}',
                 b'{"cmd":"user_parameter","data":{"name":"radius","value":1' + b"0" * 400 + b"}}",
                 b'{"cmd":"update_playstart","data":{"playstart":1,"playstart_offset":-1' + b"0" * 400 + b"}}",
                 b'{"cmd":"user_parameter","data":{"name":"radius","value":1' + b"0" * 5000 + b"}}",
                 b'{"cmd":"geo_transform_matrix","data":{"transform":[[1]]}}', b'{"cmd":"user_parameters","data":{"user_parameters":3}}'):
        client.frame(text)
    client.frame(b"\x00\x01", kind=2)
    big = json.loads(PATTERN) | {"note": "x" * 200000}
    whole = json.dumps({"cmd": "update_pattern", "data": {"pattern_json": json.dumps(big)}}).encode()
    client.frame(whole[:1000], last=False)  # in fragments
    client.frame(whole[1000:], kind=0)
    for _ in range(500):
        client.parameters(radius=5)
    client.parameters(radius=20)
    client.evals_until(lambda evals: radius_mm(evals) == 20)
    flood = Client(port)
    with pytest.raises(OSError):
        flood.frame(b"x" * (adaptics.MOST_BYTES + 1))
        while True:
            flood.next()
    client.evals_until(lambda evals: len(evals) >= 2)
    assert process.poll() is None
