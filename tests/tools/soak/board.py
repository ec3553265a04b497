"""An emulated board, and what it hears."""
import fcntl
import math
import os
import subprocess
import threading
import time

HOLD, GRACE = 0.1, 0.02


class Wire:
    """What the board hears, from the emulator's trace."""

    def __init__(self, fifo):
        self.last_sound = 0.0  # on CLOCK_MONOTONIC, as all times here
        self.late = []  # seconds after a cause, and during which fault
        self.doing = None  # the fault; nothing counts before the first
        self.begin = math.inf  # of the trace's times, at the latest: no line is read before it is written
        self.cause = 0.0  # when sound last had a reason: the newest frame with a touch was sent
        self.deaf_until = 0.0  # the emulator was held up: what it reads then is old
        self.lock = threading.Lock()
        threading.Thread(target=self.read, args=(fifo,), daemon=True).start()

    def read(self, fifo):
        while True:
            with open(fifo, "rb") as lines:
                fcntl.fcntl(lines, fcntl.F_SETPIPE_SZ, 1 << 20)  # so that the board need not wait for this thread
                for line in lines:
                    since = float(line[line.find(b":") + 1:line.find(b",")])
                    self.begin = min(self.begin, time.monotonic() - since)
                    at = line.find(b'"hex":"')
                    if b'"bulk"' not in line or at < 0:
                        continue
                    payload = line[at + 7:line.rfind(b'"')]
                    if len(payload) < 1024 or payload[-512:].strip(b"0") == b"":
                        continue
                    when = self.begin + since
                    with self.lock:
                        self.last_sound = when
                        if self.doing and when > max(self.cause + HOLD + GRACE, self.deaf_until):
                            self.late.append((when - self.cause, self.doing))


class Emulator:
    def __init__(self, palpa, folder, environment, traced):
        self.palpa, self.environment, self.process = palpa, environment, None
        self.fifo = self.wire = None
        if traced:
            self.fifo = folder / "wire"
            os.mkfifo(self.fifo)
            self.wire = Wire(self.fifo)

    def start(self):
        trace = ["--trace", str(self.fifo)] if self.fifo else []
        self.process = subprocess.Popen([self.palpa, "emulate", "openmpd", "--quiet", *trace], env=self.environment,
                                        stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()
        if self.wire:
            self.wire.begin = time.monotonic()

    def stop(self):
        self.process.terminate()
        self.process.wait()
