#!/usr/bin/env python3
"""kill.py [--seconds N] [--seed S] [--bin FOLDER] [--only CASE] [--kills N]: loops that are killed, and the silence that must follow.

Each case is a `palpa run` or `palpa link test` that plays to an emulated board, or into a file or a pipe. It has some trouble
from the start (nobody reads what it writes, its disk is full, its files may not grow) and at a random moment it or its guard
gets signals. Then, as docs/safety.md promises, the board must fall silent in both of its memories, the loop must end, and none
of its processes may be left. What a board hears is read from the trace of its emulator by wires.py.

Meanwhile, short studies with a scripted participant are killed and continued (kill_study.py). --kills: instead, one long study is
killed that often.

A case depends on the seed and its own number only, except for the moments: how far the program has come by then depends
on the machine. --only repeats a case alone and keeps its files.
"""
import concurrent.futures
import fcntl
import os
import random
import resource
import shlex
import signal
import struct
import subprocess
import sys
import termios
import time

from hostile import ROOT, Cases, Marked, faults_of_messages, name_of_end, name_of_signal, small_rig
from kill_study import KilledStudies
from wires import KINDS, SERIAL, Board

# Seconds, as in docs/safety.md; a case's margin is added.
SILENT_S = 0.15      # after a death, or a stop: 100 ms without a drive, and up to 45 ms on the slowest board's line
ENDED_S = 1.0        # a run that is asked to end
GUARD_LOST_S = 1.2   # a guard that is stopped is ended by its loop after a second
OPENED_S = 10.0      # a guard that opens its board may take this long
# Signals that end no program, that no program can catch, or that the C library reserves.
NOTHING = {signal.SIGCHLD, signal.SIGCONT, signal.SIGURG, signal.SIGWINCH, signal.SIGTTIN, signal.SIGTTOU, 32, 33}
STOPS = {signal.SIGSTOP}
TROUBLES = ["none"] * 6 + ["stderr", "events", "json", "full record", "full events", "small files"]
BOARDS = {"openmpd": 3, "autd3": 3, SERIAL: 3, "file": 1, "pipe": 1}
DRIVES_HEAD = struct.Struct("<8sIId")


def filled_pipe(read, write):
    """A pipe that takes nothing more."""
    os.set_blocking(write, False)
    try:
        while True:
            os.write(write, b"x" * 4096)
    except BlockingIOError:
        os.set_blocking(write, True)
    return read, write


class Case(Marked):
    def __init__(self, number, seed, folder, palpa, rig, namespace):
        super().__init__(folder)
        self.random = draw = random.Random(f"{seed}:{number}")
        self.palpa, self.rig, self.namespace = palpa, rig, namespace
        self.kind = draw.choices(list(BOARDS), list(BOARDS.values()))[0]
        self.trouble = draw.choice(TROUBLES)
        self.command = "run" if draw.random() < 0.75 or self.trouble != "none" else "link"
        self.ramp = draw.choice([0, 0, 0.1, 0.5]) if self.command == "run" else 0
        self.victim = "guard" if self.kind in KINDS and draw.random() < 0.2 else "loop"
        self.early = draw.random() < 0.25
        self.delay = draw.choice([draw.uniform(0, 0.05), draw.uniform(0, 0.6), draw.uniform(0, 2)])
        if self.victim == "guard":
            self.signals = [draw.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGSTOP])]
        else:
            usual = [signal.SIGKILL] * 4 + [signal.SIGSTOP] * 3 + [signal.SIGTERM, signal.SIGINT] * 2 + [signal.SIGXFSZ, signal.SIGPIPE, signal.SIGTSTP]
            self.signals = [draw.choice(usual + [draw.randrange(1, signal.NSIG)] * 5) for _ in range(draw.choice([1, 1, 1, 2]))]
        if self.early:  # the system stops no process whose terminal is gone
            self.signals = [signal.SIGTERM if number == signal.SIGTSTP else number for number in self.signals]
        self.gap = draw.choice([0, 0.01, 0.3])
        self.open, self.events, self.loop, self.reader = [], [], None, None
        folder.mkdir()

    # ---- beginning ----
    def start_board(self):
        """Starts the emulator; the link to it."""
        if self.kind == "file":
            return f"record:{self.folder}/drives.bin"
        if self.kind == "pipe":
            os.mkfifo(self.folder / "drives")
            if self.random.random() < 0.8:  # otherwise nobody opens it, which is an error
                self.reader = os.open(self.folder / "drives", os.O_RDONLY | os.O_NONBLOCK)
                self.open.append(self.reader)
            return f"record:{self.folder}/drives"
        more = ["--port", "0"] if self.kind == "autd3" else []
        self.board = Board(self.palpa, self.kind, self.folder, dict(self.environment, PALPA_MARK="emulator"), *more)
        return "openmpd:EMU1" if self.kind == "openmpd" else f"{self.kind}:{self.board.address}"

    def pipe(self, room):
        """A pipe that nobody reads, with room for a while or for nothing."""
        read, write = os.pipe()
        self.open += [read, write]
        fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, 4096)
        return write if room else filled_pipe(read, write)[1]

    def start_loop(self, link):
        draw, folder = self.random, self.folder
        layout = ["--layout", self.kind if self.board else "openmpd", "--link", link]
        pipes = {}
        if self.command == "link":
            arguments = ["link", "test", *layout, "--each", draw.choice(["30ms", "100s"])]
        else:
            arguments = ["run", *layout, "--backend", "cpu", "--scene", str(ROOT / "assets/cube.glb"), "--source", "synthetic",
                         "--rig", str(self.rig), "--hold", draw.choice(["100ms", "500ms", "2s"]), "--ramp", f"{self.ramp}s"]
            if self.kind == SERIAL:
                arguments += ["--method", "single-focus"]
            arguments += draw.choice([[], ["--every-frame"]]) + draw.choice([[], ["--noise-free"]])
        before = []
        if self.trouble == "stderr":
            pipes["stderr"] = self.pipe(room=True)
            arguments += ["--log-level", "debug"]
        elif self.trouble == "json":
            pipes["stdout"] = self.pipe(room=False)
            arguments += ["--json", "-"]
        elif self.trouble == "events":
            os.mkfifo(folder / "events")
            read = os.open(folder / "events", os.O_RDONLY | os.O_NONBLOCK)
            write = os.open(folder / "events", os.O_WRONLY)
            self.open += filled_pipe(read, write)
            arguments += ["--events", str(folder / "events"), "--event-move", "0"]
        elif self.trouble.startswith("full") and self.namespace:
            (folder / "disk").mkdir()
            place = f"{folder}/disk/" + self.trouble.split()[1]
            arguments += ["--" + self.trouble.split()[1], place] + (["--event-move", "0"] if "events" in self.trouble else [])
            mount = f"mount -t tmpfs -o size={draw.choice([4, 64, 256])}k none {shlex.quote(str(folder / 'disk'))} && exec \"$@\""
            before = [*self.namespace, "sh", "-c", mount, "sh"]
        elif self.trouble == "small files":
            arguments += draw.choice([["--record", f"{folder}/take"], ["--events", f"{folder}/events", "--event-move", "0"]])
        size = draw.choice([100000, 300000, 1000000]) if self.trouble == "small files" else None

        def limits():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.pthread_sigmask(signal.SIG_SETMASK, [])
            if size is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        self.line = [*before, str(self.palpa), *arguments]
        self.loop = self.start(self.line, preexec_fn=limits, **pipes)

    # ---- what happens ----
    def ended(self):
        return self.loop.poll() is not None

    def sounds(self):
        if self.board:
            return self.board.sounds()
        return False if self.kind == "pipe" else self.drives().strip(b"\0") != b""

    def has_begun(self):
        """Whether something has sounded, or, through a pipe that is not read, something has come."""
        if self.reader is not None:
            return struct.unpack("i", fcntl.ioctl(self.reader, termios.FIONREAD, bytes(4)))[0] > 0
        return self.sounds()

    def moment(self):
        return "its start" if self.early else "the first sound"

    def send(self, pid, number):
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            pass
        self.events.append(f"{name_of_signal(number)} to {self.victim}")

    def expect_end(self, seconds, why):
        if not self.clock.until(self.ended, seconds):
            self.fault(f"the loop does not end within {seconds} s and a margin after {why}")
            self.loop.kill()
            self.loop.wait()

    def run(self):
        self.start_loop(self.start_board())
        if not self.early:
            self.clock.until(lambda: self.ended() or self.has_begun(), 4)
        begin = time.monotonic()
        while time.monotonic() - begin < self.delay and not self.ended():
            self.clock.sleep(0.003)
            self.sounds()
        killed_guard = False
        for number in self.signals:
            if self.ended():
                break
            guards = self.guards() if self.victim == "guard" else []
            if self.victim == "guard" and guards:
                self.send(guards[0], number)
                killed_guard = True
                why = f"{name_of_signal(number)} to its guard"
                self.expect_silence(GUARD_LOST_S + SILENT_S, why)
                opening = self.early and number == signal.SIGSTOP
                self.expect_end((OPENED_S if opening else GUARD_LOST_S) + ENDED_S, why)
                break
            self.victim = "loop"
            self.send(self.loop.pid, number)
            self.clock.sleep(self.gap)
            if number in STOPS:
                self.expect_silence(SILENT_S, "SIGSTOP")
                self.send(self.loop.pid, signal.SIGCONT)
        last = self.signals[-1]
        if not self.ended() and self.victim == "loop":
            if all(number in NOTHING or number in STOPS for number in self.signals):
                self.clock.sleep(0.02)
                self.send(self.loop.pid, signal.SIGTERM)
                last = signal.SIGTERM
            why = name_of_signal(last)
            self.expect_silence(SILENT_S + self.ramp, why)
            self.expect_end(ENDED_S, why)
        elif not self.ended():
            self.send(self.loop.pid, signal.SIGTERM)
        self.expect_silence(SILENT_S, "the loop's end")
        self.after(killed_guard)

    def drives(self):
        """The last drive of a record: file."""
        try:
            with open(self.folder / "drives.bin", "rb") as file:
                size = 8 + 8 * DRIVES_HEAD.unpack(file.read(DRIVES_HEAD.size))[2]
                whole = (os.fstat(file.fileno()).st_size - DRIVES_HEAD.size) // size
                file.seek(DRIVES_HEAD.size + max(0, whole - 1) * size + 8)
                return file.read(size - 8)
        except (FileNotFoundError, struct.error):
            return b""

    # ---- the end ----
    def after(self, killed_guard):
        self.faults += self.faults_of_end(ENDED_S + SILENT_S)
        code = self.loop.returncode
        sent = set(self.signals) | {signal.SIGTERM}
        if code < 0 and -code not in sent:
            self.fault(f"the loop ends with {name_of_end(code)}, which nobody sent")
        if code > 4:
            self.fault(f"the loop ends with {code}")
        if code >= 0 and self.trouble != "stderr":
            faults = faults_of_messages(self.said(), code)
            # A program that is held up after a signal has 50 ms for its line, which may be too short on a busy machine.
            self.faults += [fault for fault in faults if not (self.events and fault.endswith("without an error line"))]
        if code >= 0 and self.kind == "file" and self.drives().strip(b"\0"):
            self.fault("the last drive of its file is not silence")
        if self.board:
            self.clock.sleep(0.05)
            self.sounds()
            try:
                reports = self.board.end()
            except subprocess.TimeoutExpired:
                self.fault("the emulator does not end")
                return
            if self.sounds():
                self.fault("by its wire the board sounds at the end")
            if self.played() and any(report["sounds"] for report in reports):
                self.fault("by its emulator the board sounds at the end")
            wrong = sum(report["violation_count"] for report in reports)
            if wrong and not killed_guard:
                self.fault(f"{wrong} violations: {(self.folder / 'emulator.err').read_text()[:300]}")

    def played(self):
        """Whether a board was played to."""
        return bool(self.board and self.board.trace.board.told)

    def close(self):
        if self.loop and self.loop.poll() is None:
            self.loop.kill()
            self.loop.wait()
        if self.board:
            self.board.close()
        for descriptor in self.open:
            os.close(descriptor)


def namespace_command():
    """What runs a command where it may mount a file system of its own; None where that is not allowed."""
    for command in (["unshare", "--mount"], ["unshare", "--map-root-user", "--mount"]):
        try:
            done = subprocess.run([*command, "sh", "-c", "mount -t tmpfs -o size=64k none /mnt"], capture_output=True, timeout=20)
            if done.returncode == 0:
                return command
        except (OSError, subprocess.TimeoutExpired):
            continue
    return None


def kill_loops(cases, rig):
    """Kills loops, and short studies meanwhile. Returns a summary and the number of faults."""
    namespace = namespace_command()
    if namespace is None:
        print("kill: no file system may be mounted here: full disks are left out")
    try:
        for end in os.openpty():
            os.close(end)
    except OSError as fault:
        del BOARDS[SERIAL]
        print(f"kill: no pseudo terminal ({fault.strerror}): {SERIAL} boards are left out")

    def run(number, folder):
        case = Case(number, cases.chosen.seed, folder, cases.bin / "palpa", rig, namespace)
        try:
            case.run()
        finally:
            case.close()
        return case.faults, case.played(), [
            shlex.join(case.line), f"{case.kind}, trouble: {case.trouble}, {case.delay:.3f} s after {case.moment()}; {', '.join(case.events)}",
            name_of_end(case.loop.returncode)]

    if cases.chosen.only is not None:
        return "kill", cases.run(run)[1]
    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        studies = executor.submit(kill_studies, cases, rig, 4, lambda kills: cases.going_on())
        count, found, played = cases.run(run)
        found += studies.result()
    return f"kill: seed {cases.chosen.seed}, {count} cases, in {played.get(True, 0)} a board was played to", found


def kill_studies(cases, rig, trials, goes_on):
    """Returns the number of faults."""
    studies = KilledStudies(cases.chosen.seed, cases.work / "study", cases.bin / "palpa", rig, trials)
    try:
        if not studies.available():
            print("kill: there is no Xvfb: studies are left out")
            return 0
        studies.run(goes_on)
    finally:
        studies.close()
    print(*studies.faults, f"kill: {studies.summary()}", sep="\n")
    return len(studies.faults)


def main():
    cases = Cases("tests/house/kill.py", __doc__, os.cpu_count() + 1, kills={"type": int, "help": "one study with as many kills"})
    # A shell that starts this in the background makes it ignore these signals. Loops would inherit that and play on.
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # running cases still end, so that no loop plays on
    rig = cases.work / "rig.toml"
    rig.write_text(small_rig(4)[0])
    most = cases.chosen.kills
    summary, found = kill_loops(cases, rig) if most is None else (f"kill: seed {cases.chosen.seed}", kill_studies(cases, rig, 100, lambda kills: kills < most))
    return cases.end(f"{summary}, {time.monotonic() - cases.begin:.0f} s", found)


if __name__ == "__main__":
    sys.exit(main())
