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
        self.last_sound, self.late = 0.0, []  # on CLOCK_MONOTONIC, as all times here; seconds after a cause
        self.cause = 0.0  # when sound last had a reason: the newest frame with a touch was sent
        self.deaf_until = 0.0  # the emulator was held up: what it reads then is old
        self.lock = threading.Lock()
        threading.Thread(target=self.read, args=(fifo,), daemon=True).start()

    def read(self, fifo):
        while True:
            with open(fifo, "rb") as lines:
                fcntl.fcntl(lines, fcntl.F_SETPIPE_SZ, 1 << 20)  # so that the board need not wait for this thread
                begin = math.inf  # the trace's times count from when the emulator began: some line is read at once
                for line in lines:
                    since = float(line[line.find(b":") + 1:line.find(b",")])
                    begin = min(begin, time.monotonic() - since)
                    at = line.find(b'"hex":"')
                    if b'"bulk"' not in line or at < 0:
                        continue
                    payload = line[at + 7:line.rfind(b'"')]
                    if len(payload) < 1024 or payload[-512:].strip(b"0") == b"":
                        continue
                    when = begin + since
                    with self.lock:
                        self.last_sound = when
                        if when > max(self.cause + HOLD + GRACE, self.deaf_until):
                            self.late.append(when - self.cause)


def at_once():
    """A board does not wait for a busy machine: real-time scheduling, where this is allowed."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        pass


class Emulator:
    def __init__(self, palpa, folder, environment, traced):
        self.palpa, self.environment = palpa, environment
        self.fifo = folder / "wire" if traced else None
        if traced:
            os.mkfifo(self.fifo)
        self.process = None

    def start(self):
        trace = ["--trace", str(self.fifo)] if self.fifo else []
        self.process = subprocess.Popen([self.palpa, "emulate", "openmpd", "--quiet", *trace], env=self.environment,
                                        stdout=subprocess.PIPE, text=True, preexec_fn=at_once)
        self.process.stdout.readline()

    def stop(self):
        self.process.terminate()
        self.process.wait()
