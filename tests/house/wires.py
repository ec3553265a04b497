"""wires.py: emulated boards, and what they heard, from the traces that `palpa emulate --trace` writes; for kill.py.

Each class reads a board's wire by itself, apart from palpa's own emulators. `sounds` is whether a transducer sounds, or would
after the board's next change from one of its memories to the other; `told` whether the board was told anything yet.
"""
import json
import signal
import subprocess


class OpenMpd:
    """Frames of 512 bytes that begin with bit 7: 256 phases, 256 pulse widths. A part of one is dropped after a second."""

    def __init__(self):
        self.sounds = self.told = False
        self.frame, self.at_s = bytearray(), 0.0

    def take(self, time_s, data):
        if time_s - self.at_s >= 1:
            self.frame.clear()
        self.at_s, self.told = time_s, True
        for byte in data:
            if self.frame or byte & 0x80:
                self.frame.append(byte)
            if len(self.frame) == 512:
                self.sounds = any(width & 0x7f for width in self.frame[256:])
                self.frame.clear()


class SonicSurface:
    """254: phases follow; 253: the two buffers change places; 0 to 31 are phases, 32 is silence. It sounds from power-up."""

    def __init__(self):
        self.buffers, self.front, self.counter, self.selected = [[0] * 256, [0] * 256], 0, 256, True
        self.told = False

    def take(self, _time_s, data):
        self.told = self.told or bool(data)
        for byte in data:
            if byte == 254:
                if self.selected:
                    self.counter = 0
            elif byte == 253:
                self.front ^= 1
                self.counter = 0
            elif byte in (192, 193):
                self.selected = byte == 192
            elif self.selected and byte <= 32:
                self.buffers[self.front ^ 1][self.counter % 256] = byte
                self.counter = self.counter % 256 + 1

    @property
    def sounds(self):
        return any(phase != 32 for buffer in self.buffers for phase in buffer)


class Autd3:
    """Requests over TCP to one unit: those of kind 3 carry a message of 626 bytes with one or two operations."""
    HELLO = bytes.fromhex("100100415554443352454d4f5445")
    SIZES = {0x10: 14, 0x01: 33, 0x02: 33, 0x03: 627}

    def __init__(self):
        self.segments, self.request, self.number, self.told = [False, False], bytearray(), None, False

    @property
    def sounds(self):
        return any(self.segments)

    def take(self, _time_s, data):
        self.told = self.told or bool(data)
        if data.startswith(self.HELLO):
            self.request.clear()  # a new client
        self.request += data
        while self.request:
            size = self.SIZES.get(self.request[0], 1)
            if len(self.request) < size:
                break
            if self.request[0] == 3:
                self.message(bytes(self.request[1:size]))
            del self.request[:size]

    def message(self, message):
        if message[0] == self.number:
            return  # it is a repetition
        self.number = message[0]
        self.operation(message[4:])
        second = int.from_bytes(message[2:4], "little")
        if second:
            self.operation(message[4 + second:])

    def operation(self, o):
        if o[0] == 0x01:  # as after power-up
            self.segments = [False, False]
        elif o[0] == 0x30:  # phase and intensity of 249 transducers
            self.segments[o[1] & 1] = any(o[5:5 + 2 * 249:2])
        elif o[0] == 0x41:  # a part of a pattern; without amplitudes, all are at their maximum
            index, at = (o[1] >> 3) & 1, 16 if o[1] & 1 else 2
            if o[1] & 1:
                self.segments[index], self.phases_only = False, o[2] != 0
            self.segments[index] |= self.phases_only or any(o[at + 1:at + 1 + 2 * 249:2])
        elif o[0] == 0x42:  # foci, whose last ten bits begin with an intensity
            words = (int.from_bytes(o[24 + 8 * i:32 + 8 * i], "little") for i in range(o[2]))
            self.segments[o[3] & 1] = any(word >> 54 & 0xff for word in words)


SERIAL = "sonicsurface"  # the kind of boards on a serial port
KINDS = {"openmpd": OpenMpd, "autd3": Autd3, SERIAL: SonicSurface}


class Trace:
    """A board's trace while it grows."""

    def __init__(self, kind, path):
        self.board, self.path, self.rest, self.offset = KINDS[kind](), path, b"", 0

    def look(self):
        """Reads what is new; whether the board sounds."""
        try:
            with open(self.path, "rb") as file:
                file.seek(self.offset)
                new = file.read()
        except FileNotFoundError:
            return False
        self.offset += len(new)
        *lines, self.rest = (self.rest + new).split(b"\n")
        for line in lines:
            entry = json.loads(line)
            if entry["kind"] != "control":
                self.board.take(entry["t_s"], bytes.fromhex(entry.get("hex", "")))
        return self.board.told and self.board.sounds


class Board:
    """`palpa emulate`, and the trace of its wire. `address`: its first line."""

    def __init__(self, palpa, kind, folder, environment, *more):
        self.folder, wire = folder, folder / "wire.jsonl"
        wire.unlink(missing_ok=True)
        with open(folder / "emulator.err", "wb") as err:
            self.process = subprocess.Popen([palpa, "emulate", kind, *more, "--trace", wire, "--json", folder / "board.json"], stdin=subprocess.DEVNULL,
                                            stdout=subprocess.PIPE, stderr=err, cwd=folder, env=environment, start_new_session=True)
        self.address = self.process.stdout.readline().decode().strip()
        if not self.address:
            raise RuntimeError(f"the emulator does not start: {(folder / 'emulator.err').read_text()}")
        self.trace, self.sounded = Trace(kind, wire), False

    def sounds(self):
        now = self.trace.look()
        self.sounded = self.sounded or now
        return now

    def end(self):
        """Its report on each of its boards."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(20)
        report = json.loads((self.folder / "board.json").read_text())
        return report.get("boards", [report])

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()
