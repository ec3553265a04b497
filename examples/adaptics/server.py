#!/usr/bin/env python3
"""Lets the Designer of Adaptics play its patterns on palpa's arrays: speaks the protocol of Adaptics' engine.

    examples/adaptics/server.py --layout openmpd --link openmpd:FT43NK5M --ceiling 0.5
    examples/adaptics/server.py --layout paper --link autd3:127.0.0.1:8080 --on palm --source joints:udp:9000

It needs palpa's Python module and Debian's python3-websockets. Ctrl-C ends it, and silences the array.

Any web page can open a websocket to this machine. So pages are refused, except for the Designer's published one, pages
of this machine, and those of --allow-origin. A client that names no origin is no web page but a program, and may connect.
"""
import argparse
import asyncio
import contextlib
import http
import json
import logging
import math
import signal
import sys
import threading
import urllib.parse
import warnings

import palpa
import websockets

PORT = 8037
DESIGNER = "https://adaptivehaptics.github.io"
THIS_MACHINE = ("localhost", "127.0.0.1", "::1")
MOST_CLIENTS = 16
HANDSHAKE_S, MOST_HANDSHAKES = 3, 32  # what has not become a client by then, or is the oldest of more, is dropped
ENDING = (signal.SIGINT, signal.SIGTERM)
MOST_BYTES = 4 << 20            # of a message; a large pattern has 0.2 MB
PING_S, PATIENCE_S = 2.5, 2.5   # a client that has frozen is gone after both
UPDATE_S, UPDATE_POINTS = 0.018, 32
MOST_WAITING_BYTES = 1 << 20    # of updates that a client has not read
ZERO, ONE, STEP = {"type": "f64", "value": 0}, {"type": "f64", "value": 1}, {"name": "step", "params": {}}
# Before a pattern comes: silence, with a brush of 100 Hz, as most patterns have. Slots are made for it.
SILENCE = json.dumps({
    "$DATA_FORMAT": "MidAirHapticsAnimationFileFormat", "$REVISION": "0.1.0-alpha.3", "name": "silence",
    "keyframes": [{"type": "pause", "time": 0, "cjumps": [], "brush": {
        "brush": {"name": "circle", "params": {"radius": ZERO, "am_freq": ZERO}}, "transition": STEP}}],
    "pattern_transform": {
        "geometric_transforms": {"translate": dict.fromkeys("xyz", ZERO), "rotation": ZERO, "scale": dict.fromkeys("xyz", ONE)},
        "intensity_factor": ONE, "playback_speed": ONE},
    "user_parameter_definitions": {}})


def may_connect(origin, allowed=()):
    """Whether a client with this Origin, or None without one, may connect."""
    if origin is None or origin in allowed or origin == DESIGNER:
        return True
    try:
        parts = urllib.parse.urlsplit(origin)
        host, _ = parts.hostname, parts.port
    except ValueError:
        return False
    return parts.scheme in ("http", "https") and host in THIS_MACHINE and not parts.username and not parts.path


def finite(value, what):
    """A number of a message; ValueError for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"{what} is no finite number")
    try:
        number = float(value)
    except OverflowError:  # a whole number of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{what} is no finite number")
    return number


def port_number(text):
    """A port of --port; 0 is a free one."""
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"a port is from 0 to 65535, not {text:.20}")
    return int(text)


class Player:
    """The sensation that plays, and what clients may change about it."""

    def __init__(self, options):
        self.has_hand = "on" in options
        self.sensation = palpa.Sensation("point")
        self.sensation.set_pattern(SILENCE)
        self.sensation.pause()
        self.parameters = {}
        self.fault = None
        self.thread = threading.Thread(target=self._play, args=(options,))

    def _play(self, options):
        try:
            self.sensation.play(ends=False, paused=True, **options)
        except palpa.Error as fault:
            self.fault = fault

    def end(self):
        """Silence, and the end of play(), which may only have begun."""
        while self.thread.is_alive():
            self.sensation.stop()
            self.thread.join(0.05)

    def take(self, text):
        """Does what a message says. ValueError for one that says nothing it knows: it changes nothing."""
        if not isinstance(text, str):
            raise ValueError("a binary message")
        message = json.loads(text)
        if not isinstance(message, dict) or not isinstance(message.get("data"), dict):
            raise ValueError("no message of the protocol")
        command, data = message.get("cmd"), message["data"]
        if not isinstance(command, str) or not hasattr(self, "do_" + command):
            raise ValueError(f"an unknown cmd {command!r:.60}")
        try:
            getattr(self, "do_" + command)(data)
        except (KeyError, TypeError, AttributeError) as fault:
            raise ValueError(f"{command} with other data: {fault!r:.100}") from fault

    def do_update_pattern(self, data):
        text = data["pattern_json"]
        if not isinstance(text, str):
            raise ValueError("pattern_json is no text")
        self.sensation.set_pattern(text)

    def do_update_playstart(self, data):
        if finite(data["playstart"], "playstart") == 0:
            self.sensation.pause()
            return
        offset_s = 1e-3 * finite(data["playstart_offset"], "playstart_offset")
        self.sensation.start(time=max(0.0, -offset_s), delay=max(0.0, offset_s))

    def do_update_parameters(self, data):
        given = data["evaluator_params"]
        finite(given["time"], "time")  # while it plays, the clock has the time; a start says where it begins
        parameters, matrix = self._parameters(given["user_parameters"]), self._matrix(given["geometric_transform"])
        self._set(parameters)
        self.sensation.set_matrix(matrix)

    def do_update_tracking(self, data):
        if data["enabled"] is True and not self.has_hand:
            raise ValueError("update_tracking: give the server --on and --source")
        self.sensation.follow(data["enabled"] is True)

    def do_parameter_time(self, data):
        finite(data["time"], "time")

    def do_user_parameters(self, data):
        self._set(self._parameters(data["user_parameters"]))

    def do_user_parameter(self, data):
        self._set(self.parameters | self._parameters({data["name"]: data["value"]}))

    def do_geo_transform_matrix(self, data):
        self.sensation.set_matrix(self._matrix(data["transform"]))

    def _set(self, parameters):
        self.sensation.set(**parameters)
        self.parameters = parameters

    @staticmethod
    def _parameters(given):
        return {str(name): finite(value, "a parameter") for name, value in given.items()}

    @staticmethod
    def _matrix(rows):
        matrix = [[finite(value, "a value of the matrix") for value in row] for row in rows]
        if [len(row) for row in matrix] != [4, 4, 4, 4]:
            raise ValueError("the matrix has not 4 rows of 4")
        return matrix

    def update(self):
        """What has just sounded, as a message; None if nothing has."""
        points = self.sensation.newest(UPDATE_POINTS)
        if not points:
            return None
        if points[-1]["stop"]:
            points = [points[-1]] * 2  # the Designer looks at the first one only
        evals = []
        for point in points:
            x, y, z = (1e3 * value for value in point["place"])
            evals.append({
                "ul_control_point": {"coords": {"x": x, "y": y, "z": z}, "intensity": point["gain"]},
                "pattern_time": 1e3 * point["pattern_time"], "stop": point["stop"],
                "next_eval_params": {"last_eval_pattern_time": 1e3 * point["pattern_time"], "time_offset": 0.0}})
        return json.dumps({"cmd": "playback_update", "data": {"evals": evals}}), points[-1]["stop"]


class Server:
    """The clients of a Player."""

    def __init__(self, player, allowed):
        self.player, self.allowed = player, allowed
        self.clients = set()
        self.handshakes = []
        self.told = set()

    def tell(self, what):
        """Once for each kind of fault: a client may send any number of them."""
        kind = str(what)[:40]
        if kind not in self.told and len(self.told) < 100:
            self.told.add(kind)
            print(f"ignored: {what}", file=sys.stderr, flush=True)

    def connections(self):
        """The argument of serve() that limits connections which are no clients yet, by the old and by the new form of
        websockets."""
        old = "legacy" in websockets.serve.__module__
        handshakes = self.handshakes

        def drop(connection):
            if connection.state == 0:
                connection.transport.abort()

        class Connection(websockets.WebSocketServerProtocol if old else websockets.ServerConnection):
            def connection_made(self, transport):
                super().connection_made(transport)
                handshakes[:] = [one for one in handshakes if one.state == 0 and not one.transport.is_closing()]
                handshakes.append(self)
                if len(handshakes) > MOST_HANDSHAKES:
                    drop(handshakes.pop(0))
                asyncio.get_running_loop().call_later(HANDSHAKE_S, drop, self)
        return {"create_protocol" if old else "create_connection": Connection}

    def check(self, *request):
        """Called with the request for a connection, by the old and by the new form of websockets."""
        old = isinstance(request[0], str)
        headers = request[1] if old else request[1].headers
        origins = headers.get_all("Origin")
        refusal = None
        if len(origins) > 1 or not may_connect(origins[0] if origins else None, self.allowed):
            refusal = (http.HTTPStatus.FORBIDDEN, f"pages of {str(origins)[:100]} may not drive this array\n")
        elif len(self.clients) >= MOST_CLIENTS:
            refusal = (http.HTTPStatus.SERVICE_UNAVAILABLE, "too many clients\n")
        if refusal is None:
            return None
        self.tell(refusal[1].strip())
        return (refusal[0], [], refusal[1].encode()) if old else request[0].respond(*refusal)

    async def serve(self, client, *_path):
        """One client, until it is gone."""
        self.clients.add(client)
        loop = asyncio.get_running_loop()
        try:
            async for text in client:
                try:
                    await loop.run_in_executor(None, self.player.take, text)
                except (ValueError, RecursionError, palpa.Error) as fault:
                    self.tell(fault)
        except websockets.ConnectionClosed:
            pass
        finally:
            self.clients.discard(client)
            if not self.clients:
                self.player.sensation.pause()

    async def send_updates(self):
        """While it plays, and once when it has stopped."""
        was_playing = False
        while True:
            await asyncio.sleep(UPDATE_S)
            playing = self.player.sensation.playing
            update = self.player.update() if playing or was_playing else None
            if update and (playing or update[1]):
                websockets.broadcast([client for client in self.clients
                                      if client.transport.get_write_buffer_size() < MOST_WAITING_BYTES], update[0])
            was_playing = playing


async def run(player, arguments):
    server = Server(player, arguments.allow_origin)
    end, loop = asyncio.Event(), asyncio.get_running_loop()

    def wait_for_signal():
        signal.sigwait(ENDING)
        player.sensation.stop()  # silence does not wait for this program's loop
        with contextlib.suppress(RuntimeError):  # which may be over
            loop.call_soon_threadsafe(end.set)
    threading.Thread(target=wait_for_signal, daemon=True).start()
    player.thread.start()
    try:
        while player.thread.is_alive() and not player.sensation.open and not end.is_set():
            await asyncio.sleep(0.02)
        if not player.sensation.open:
            return
        async with websockets.serve(server.serve, "127.0.0.1", arguments.port, process_request=server.check,
                                    **server.connections(), backlog=MOST_CLIENTS, max_size=MOST_BYTES,
                                    ping_interval=PING_S, ping_timeout=PATIENCE_S, close_timeout=1) as listening:
            port = next(iter(listening.sockets)).getsockname()[1]
            print(f"listening on ws://127.0.0.1:{port}/", flush=True)
            updates = asyncio.create_task(server.send_updates())
            while player.thread.is_alive() and not end.is_set():
                try:
                    await asyncio.wait_for(end.wait(), 0.1)
                except asyncio.TimeoutError:
                    pass
            updates.cancel()
            player.end()  # silence comes before clients that may be slow to say goodbye
    finally:
        player.end()


def warn(message, *_where):
    """Shows a warning as palpa's programs do."""
    print(f"warning: {message}", file=sys.stderr, flush=True)


def main():
    warnings.showwarning = warn
    logging.getLogger("websockets").setLevel(logging.CRITICAL)  # a client may cause any number of its lines
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--port", type=port_number, default=PORT, help="port on 127.0.0.1 [8037, as the Designer has it]")
    parser.add_argument("--allow-origin", action="append", default=[], metavar="ORIGIN",
                        help="a further page that may connect, such as http://example.org; null is any sandboxed page")
    for name in ("link", "layout", "rig", "board-files", "steps", "ceiling", "ramp", "hold", "dwell", "at", "on", "source", "scene", "osc"):
        parser.add_argument("--" + name, help="as of palpa play")
    parser.add_argument("--upright", action="store_true", help="as of palpa play")
    arguments = parser.parse_args()
    options = {name: value for name, value in vars(arguments).items()
               if name not in ("port", "allow_origin") and value not in (None, False)}
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)  # for all threads that follow; one waits for them
    player = Player(options)
    try:
        asyncio.run(run(player, arguments))
    except OSError as fault:
        sys.exit(f"{sys.argv[0]}: --port {arguments.port}: {fault}")
    if player.fault:
        sys.exit(f"{sys.argv[0]}: {player.fault}")


if __name__ == "__main__":
    main()
