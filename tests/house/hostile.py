"""hostile.py: running programs of palpa that are given bad data, killed or starved: what they may say, how they may end, and what
they leave behind; for fuzz.py, kill.py and kill_study.py."""
import argparse
import concurrent.futures
import itertools
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
MARGIN_S = 2.0  # for a busy machine, in addition to ten times the longest oversleep of this program
# Messages of sanitizers, the C++ library and the C library about something broken.
BROKEN = re.compile(r"Sanitizer|runtime error:|terminate called|what\(\):|bad optional|bad variant|bad_alloc|std::|"
                    r"vector::|basic_string|stack smashing|buffer overflow|[Aa]ssert(ion)? |corrupted|double free|"
                    r"Segmentation|not validated:|VUID|invalid_argument|out_of_range|stoi|stod")
LONGEST_LINE = 500  # bytes, as in docs/limits.md
# Control characters, marks of direction, and characters without a width.
UNSEEN = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]")


def faults_of_messages(stderr, code):
    """What is wrong with what was written to stderr (bytes); code: the exit code, negative after a signal."""
    faults = []
    try:
        text = stderr.decode()
    except UnicodeDecodeError as error:
        faults.append(f"stderr is not UTF-8: {error}")
        text = stderr.decode(errors="replace")
    if UNSEEN.search(text):
        faults.append(f"stderr has the character {UNSEEN.search(text).group()!r}")
    if BROKEN.search(text):
        faults.append(f"stderr says {BROKEN.search(text).group()!r}")
    lines = text.splitlines()
    errors = [line for line in lines if ": error: " in line]
    strange = [line for line in lines if not line.startswith(("palpa", "WARNING: lavapipe"))]
    if len(errors) > 1:
        faults.append(f"{len(errors)} error lines")
    if code > 0 and not errors:
        faults.append(f"exit code {code} without an error line")
    if code == 0 and errors:
        faults.append("an error line, and exit code 0")
    if strange:
        faults.append(f"a line that does not begin with the program's name: {strange[0]!r}")
    if any(len(line.encode()) > LONGEST_LINE for line in lines):
        faults.append(f"a line of more than {LONGEST_LINE} bytes")
    return faults


def name_of_signal(number):
    """Those of the system have names, others numbers."""
    return next((known.name for known in signal.Signals if known == number), f"signal {number}")


def name_of_end(code):
    """An exit code in words."""
    return name_of_signal(-code) if code < 0 else f"exit code {code}"


class Clock:
    """Sleeps, and knows by how much that took too long."""

    def __init__(self):
        self.overslept = 0.0

    def sleep(self, seconds):
        begin = time.monotonic()
        time.sleep(seconds)
        self.overslept = max(self.overslept, time.monotonic() - begin - seconds)

    def until(self, condition, seconds):
        """Waits for something, for that long and a margin. Whether it has come."""
        begin = time.monotonic()
        while not condition():
            if time.monotonic() - begin > seconds + MARGIN_S + 10 * self.overslept:
                return False
            self.sleep(0.005)
        return True


class Marked:
    """Programs that can be found by a mark in their environment, and an emulated board that hears them (wires.py), or None."""

    def __init__(self, folder, **variables):
        self.folder, self.mark, self.clock, self.faults, self.board = folder, f"{os.getpid()}-{folder}", Clock(), [], None
        self.environment = dict(os.environ, PALPA_MARK=self.mark, XDG_RUNTIME_DIR=str(folder), PALPA_CACHE="off", **variables)

    def fault(self, text):
        self.faults.append(text)

    def start(self, line, **more):
        """Starts a program in the folder; what it says goes to the files stdout and stderr there, unless something else is given."""
        with open(self.folder / "stderr", "wb") as err, open(self.folder / "stdout", "wb") as out:
            usual = dict(stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=self.folder, env=self.environment, start_new_session=True)
            return subprocess.Popen(line, **usual | more)

    def said(self):
        return (self.folder / "stderr").read_bytes()

    def expect_silence(self, seconds, why):
        if self.board and not self.clock.until(lambda: not self.board.sounds(), seconds):
            self.fault(f"the board still sounds {seconds} s and a margin after {why}")

    def processes(self):
        """The living ones: pid -> name."""
        found = {}
        for path in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if f"PALPA_MARK={self.mark}".encode() in (path / "environ").read_bytes().split(b"\0"):
                    found[int(path.name)] = (path / "comm").read_text().strip()
            except OSError:
                continue  # it has ended, or belongs to another user
        return found

    def guards(self):
        return [pid for pid, name in self.processes().items() if name == "palpa-guard"]

    def faults_of_end(self, seconds):
        """A fault if some are left after these seconds; they are then ended."""
        if self.clock.until(lambda: not self.processes(), seconds):
            return []
        left = self.processes()
        for pid in left:
            os.kill(pid, signal.SIGKILL)
        return [f"processes are left: {left}"]


class Display:
    """An Xvfb of its own; `name` is None if there is none."""

    def __init__(self):
        self.name = self.process = None
        read, write = os.pipe()
        with os.fdopen(read, "rb") as number:
            try:
                self.process = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x720x24", "-nolisten", "tcp"], pass_fds=[write],
                                                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            except FileNotFoundError:
                return
            finally:
                os.close(write)
            if told := number.readline():
                self.name = f":{told.decode().strip()}"

    def close(self):
        if self.process:
            self.process.terminate()
            self.process.wait()


def small_rig(by):
    """The paper's rig with fewer pixels to a side, without its array, and with it."""
    rig = (ROOT / "assets/rigs/paper.toml").read_text()
    for number, small in {"848": 848 // by, "480": 480 // by, "640.0": 640 / by, "423.5": 424 / by - 0.5, "239.5": 240 / by - 0.5}.items():
        rig = re.sub(rf"= {re.escape(number)}$", f"= {small}", rig, flags=re.M)
    array, screen = rig.index("[array]"), rig.index("[screen]")
    return rig[:array] + rig[screen:], rig


class Cases:
    """The command line of a program with random cases, which depend on the seed and their number; and how it runs them."""

    def __init__(self, program, doc, jobs, **more):
        parser = argparse.ArgumentParser(description=doc.splitlines()[0])
        parser.add_argument("--seconds", type=float, default=60)
        parser.add_argument("--seed", type=int, default=1)
        parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
        parser.add_argument("--only", type=int, help="one case, whose files are kept")
        parser.add_argument("--jobs", type=int, default=jobs)
        for name, settings in more.items():
            parser.add_argument(f"--{name}", **settings)
        self.chosen, self.program = parser.parse_args(), program
        os.environ.setdefault("PALPA_ASSETS", str(ROOT / "assets"))
        self.bin, self.begin = self.chosen.bin.resolve(), time.monotonic()
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="pk-"))  # short: socket names have at most 107 bytes

    def going_on(self):
        return time.monotonic() - self.begin < self.chosen.seconds

    def run(self, run):
        """run(number, folder) -> faults, what is counted, lines about the case. Returns the numbers of cases, of cases at fault, and
        of what."""
        numbers, ends, found = itertools.count(), {}, []

        def one(number):
            folder = self.work / str(number)
            faults, what, lines = run(number, folder)
            if faults or self.chosen.only is not None:
                err = (folder / "stderr").read_bytes()[-700:]
                print("\n".join([f"case {number}: {lines[0]}", *(f"  {line}" for line in lines[1:] + faults), f"  stderr: {repr(err)[2:-1]}",
                                 f"  again: {self.program} --only {number} {shlex.join(sys.argv[1:])}"]), flush=True)
            else:
                shutil.rmtree(folder)
            found.append(bool(faults))
            ends[what] = ends.get(what, 0) + 1

        def worker(_):
            while self.going_on():
                one(next(numbers))

        if self.chosen.only is not None:
            one(self.chosen.only)
            print(f"its files are in {self.work}")
        else:
            with concurrent.futures.ThreadPoolExecutor(self.chosen.jobs) as executor:
                list(executor.map(worker, range(self.chosen.jobs)))
        return len(found), sum(found), ends

    def end(self, summary, found):
        """Prints the last line; the exit code."""
        print(f"{summary}; {found} found something" + (f", files in {self.work}" if found else ""))
        if not found and self.chosen.only is None:
            shutil.rmtree(self.work)
        return int(found > 0)
