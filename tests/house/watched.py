"""watched.py: waiting for programs on a machine that may be busy, and finding their processes; for kill.py and kill_study.py."""
import pathlib
import time

MARGIN_S = 2.0  # for a busy machine, in addition to ten times the longest oversleep of this program


class Clock:
    """Sleeps, and knows by how much that took too long."""

    def __init__(self):
        self.overslept = 0.0

    def sleep(self, seconds):
        begin = time.monotonic()
        time.sleep(seconds)
        self.overslept = max(self.overslept, time.monotonic() - begin - seconds)

    def until(self, condition, seconds):
        """Waits for something, for that long and a margin; how long it took, or None."""
        begin = time.monotonic()
        while not condition():
            if time.monotonic() - begin > seconds + MARGIN_S + 10 * self.overslept:
                return None
            self.sleep(0.005)
        return time.monotonic() - begin


def processes(mark):
    """The living processes that have the mark in their environment: pid -> name."""
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if mark in (path / "environ").read_bytes().split(b"\0"):
                found[int(path.name)] = (path / "comm").read_text().strip()
        except OSError:
            continue  # it has ended, or belongs to another user
    return found
