"""kill_study.py: a study that is killed at random moments, and continued; for kill.py.

A scripted participant goes through a study with `palpa study run --rehearse`: two windows under Xvfb, touches of 50 ms,
an emulated OpenMPD board. At a random moment the program or the guard of its board gets SIGKILL, and the same command
is started again, until the participant has finished. Each time, the board must fall silent, none of the processes may
be left, the journal must be as docs/study.md promises, and what there is must be analysed. At the end, each step of the
plan must be complete exactly once, and the analysis must be that of a study that nobody interrupts.
"""
import json
import os
import pathlib
import random
import re
import signal
import struct
import subprocess
import time

import journals
from hostile import ROOT, Display, Marked, faults_of_messages, name_of_end
from wires import Board

SILENT_S = 0.15     # as in kill.py, after a death
ENDED_S = 3.0       # a program whose guard was killed starts another one, pauses, and is stopped by the scripted people
WHOLE_S = 600       # a program that nobody kills; a busy machine is no fault
PLAN = """title = "Killed"
[[shape]]
name = "cube"
model = "{assets}/cube.glb"
[[shape]]
name = "pyramid"
model = "{assets}/pyramid.glb"
[[method]]
name = "single-focus"
layout = "openmpd"
[[method]]
name = "cross-section"
layout = "openmpd"
[study]
participants = 4
trials_per_shape = {trials}
touch_s = 0.05
[run]
masking = "off"
[level]
limit_db = 140
"""
BLOCKS = ROOT / "tests/support/study_blocks.toml"


def lowered_finger(by_m):
    """The bytes of assets/finger.ply, lowered, so that the finger of a synthetic source is in the object all the time."""
    data = bytearray((ROOT / "assets/finger.ply").read_bytes())
    at = data.index(b"end_header\n") + 11
    for _ in range(int(re.search(rb"element vertex (\d+)", data)[1])):
        x, y, z = struct.unpack_from("<fff", data, at)
        struct.pack_into("<fff", data, at, x, y - by_m, z)
        at += 12
    return bytes(data)


class KilledStudies(Marked):
    """One participant after the other, in the study's folder; trials: per shape and method. Call close() at the end."""

    def __init__(self, seed, folder, palpa, rig, trials):
        self.display = Display()
        super().__init__(folder, DISPLAY=self.display.name or "", WAYLAND_DISPLAY="", XDG_CONFIG_HOME="/dev/null", PALPA_ASSETS=str(ROOT / "assets"))
        self.random, self.palpa, self.rig = random.Random(f"{seed}:study"), str(palpa), str(rig)
        self.participant, self.kills, self.startup_s, self.line = 0, {"palpa": 0, "viewer": 0, "guard": 0}, 1.0, []
        folder.mkdir()
        self.plan, self.study = folder / "plan.toml", folder / "study"
        self.plan.write_text(PLAN.format(assets=ROOT / "assets", trials=trials) + BLOCKS.read_text())
        (folder / "pressed.ply").write_bytes(lowered_finger(6e-3))

    def available(self):
        return self.display.name is not None

    def fault(self, text):
        super().fault(f"participant {self.participant}, {sum(self.kills.values())} kills: {text}")

    # ---- one participant after the other ----
    def sub(self):
        return self.study / f"sub-{self.participant:02}"

    def next_participant(self):
        self.participant += 1
        self.line = [self.palpa, "study", "run", str(self.plan), "--participant", str(self.participant), "--out", str(self.study), "--rig",
                     self.rig, "--backend", "cpu", "--rehearse", "0.5", "--size", "400x300", "--hold", "2s", "--link",
                     "openmpd:EMU1", "--source", f"synthetic:{self.folder / 'pressed.ply'}", "--quiet"]
        self.before, self.counted = b"", (0, 0)
        self.board = Board(self.palpa, "openmpd", self.folder, dict(self.environment, PALPA_MARK="emulator"), "--serial", "EMU1")

    def end_participant(self):
        """What must be true when a participant has finished."""
        self.expect_silence(SILENT_S, "the end")
        if not self.board.sounded:
            self.fault("the board never sounded")
        self.board.end()
        self.board.close()
        self.board = None
        process = self.start(self.line)  # writes the logs if it was killed between the journal's last line and the logs
        process.wait(WHOLE_S)
        if process.returncode != 2 or b"has finished" not in self.said():
            self.fault(f"a participant who has finished: {name_of_end(process.returncode)}, {self.said().decode()[-300:]}")
        walk = self.walk()
        if walk is None:
            return
        if not walk.finished or len(walk.answers) + len(walk.stay_void) != len(walk.rounds):
            self.fault(f"{len(walk.answers)} of {len(walk.rounds)} steps are complete")
        for fault in journals.faults_of_files(self.sub() / "beh", walk, True):
            self.fault(fault)
        whole = self.folder / "whole"
        subprocess.run([self.palpa, "study", "rehearse", self.plan, "--participant", str(self.participant), "--out", whole, "--accuracy", "0.5", "--quiet"],
                       env=self.environment, check=True, stdin=subprocess.DEVNULL, timeout=WHOLE_S)
        if not walk.stay_void and self.analysis(self.study) != self.analysis(whole):
            self.fault(f"the analyses of {self.study} and {whole} differ")

    def analysis(self, study):
        """The results of a study, or None if no trial is answered yet."""
        done = subprocess.run([self.palpa, "study", "analyse", study, "--json", "-"], env=self.environment, capture_output=True, stdin=subprocess.DEVNULL,
                              timeout=WHOLE_S)
        for fault in faults_of_messages(done.stderr, done.returncode):
            self.fault(f"the analysis: {fault}")
        if done.returncode:
            if done.returncode != 4 or b"nothing can be analysed" not in done.stderr and b"no participants" not in done.stderr:
                self.fault(f"the analysis ends with {name_of_end(done.returncode)}: {done.stderr.decode()[:300]}")
            return None
        result = json.loads(done.stdout)
        for line in result["left_out"]:
            no_row = f"{self.sub()}/beh: has no log" in line and not any(self.sub().glob("beh/*_events.tsv"))  # killed before
            killed = f"{self.sub().name}_journal.jsonl: " in line and (" because the program was killed " in line or "the sitting is not finished" in line or " void, because " in line)
            if not no_row and not killed and not line.endswith(("it is analysed all the same", "has no answered trial; the participant is left out")):
                self.fault(f"the analysis leaves out: {line}")
        return journals.results_of(result)

    # ---- the journal ----
    def journal(self):
        try:
            return (self.sub() / f"{self.sub().name}_journal.jsonl").read_bytes()
        except FileNotFoundError:
            return b""

    def answers(self):
        return self.journal().count(b'"answer"')

    def lines(self):
        """The number of lines of the journal. Reads only what is new: this is called again and again."""
        try:
            with open(self.sub() / f"{self.sub().name}_journal.jsonl", "rb") as file:
                if os.fstat(file.fileno()).st_size < self.counted[0]:  # a line that was cut off was removed
                    self.counted = 0, 0
                file.seek(self.counted[0])
                new = file.read()
        except FileNotFoundError:
            return 0
        self.counted = self.counted[0] + len(new), self.counted[1] + new.count(b"\n")
        return self.counted[1]

    def walk(self):
        try:
            return journals.Walk((self.sub() / f"{self.sub().name}_order.csv").read_text(), journals.entries_of(self.journal()))
        except ValueError as fault:
            self.fault(str(fault))
        except FileNotFoundError as fault:
            if b"\n" in self.journal():  # otherwise it was killed before
                self.fault(str(fault))
        return None

    def check_after_kill(self):
        """Whether the participant has finished."""
        now = self.journal()
        if not now.startswith(self.before.rpartition(b"\n")[0]):
            self.fault("the journal has lost lines")
        self.before = now
        walk = self.walk() if b"\n" in now else None
        if walk is None or not walk.starts:
            return False
        for fault in walk.faults + journals.faults_of_files(self.sub() / "beh", walk, False):
            self.fault(fault)
        self.analysis(self.study)
        return walk.finished

    # ---- kills ----
    def wait_for_moment(self, process):
        """The next moment to kill: while palpa or its viewer begins, or some lines later in the journal."""
        draw, begin, lines = self.random, time.monotonic(), self.lines()
        how = draw.random()
        until = draw.uniform(0, 0.05) if how < 0.1 else draw.uniform(0, self.startup_s) if how < 0.25 else None
        wanted, more = lines + draw.randrange(2, 40), draw.uniform(0, 0.06)
        known = False
        while process.poll() is None:
            now = time.monotonic() - begin
            count = self.lines()
            if not known and count > lines:
                known, self.startup_s = True, now
            if (until is not None and now >= until) or (until is None and count >= wanted):
                break
            if now > WHOLE_S:
                self.fault(f"nothing happens for {WHOLE_S} s")
                break
            self.clock.sleep(0.002)
            self.board.sounds()
        if until is None:
            self.clock.sleep(more)

    def attempt(self):
        """Starts the program and kills it. Whether the participant has finished."""
        process = self.start(self.line)
        self.wait_for_moment(process)
        guards = self.guards() if self.random.random() < 0.25 else []
        victim = "viewer"
        if process.poll() is None:
            try:
                name = pathlib.Path(f"/proc/{process.pid}/comm").read_text()
                victim = "guard" if guards else "viewer" if "viewer" in name else "palpa"
                os.kill(guards[0] if guards else process.pid, signal.SIGKILL)
                self.kills[victim] += 1
            except (ProcessLookupError, FileNotFoundError):
                pass  # it has just ended
        if not guards:
            process.wait()
        self.expect_silence(SILENT_S, f"SIGKILL of the {victim}")
        if guards and not self.clock.until(lambda: process.poll() is not None, ENDED_S):
            # A guard that was ending anyway is not missed.
            process.kill()
            process.wait()
            self.expect_silence(SILENT_S, "SIGKILL of the viewer")
        return self.ended(process)

    def ended(self, process):
        for fault in self.faults_of_end(ENDED_S):
            self.fault(fault)
        code = process.returncode
        if code not in (0, 1, -signal.SIGKILL):
            self.fault(f"the program ends with {name_of_end(code)}: {self.said().decode()[-300:]}")
        elif code >= 0:
            for fault in faults_of_messages(self.said(), code):
                self.fault(fault)
        self.expect_silence(SILENT_S, "its end")
        return self.check_after_kill()

    def run(self, goes_on):
        """Kills while `goes_on(kills)`; then lets the participant finish."""
        while goes_on(sum(self.kills.values())) and len(self.faults) < 5:
            self.next_participant()
            # On a busy machine, drives get lost or windows stand still. The scripted people then end the program, and it is
            # started again, as long as it now and then brings them a step further.
            finished, since = False, time.monotonic()
            while not finished and len(self.faults) < 5:
                if goes_on(sum(self.kills.values())):
                    finished = self.attempt()
                    since = time.monotonic()
                    continue
                answered = self.answers()
                process = self.start(self.line)
                process.wait(WHOLE_S)
                finished = self.ended(process)
                if self.answers() > answered:
                    since = time.monotonic()
                if not finished and time.monotonic() - since > WHOLE_S:
                    self.fault(f"no step becomes complete in {WHOLE_S} s: {self.said().decode()[-300:]}")
                    break
            if finished:
                self.end_participant()

    def close(self):
        if self.board:
            self.board.close()
        self.display.close()

    def summary(self):
        each = ", ".join(f"{count} of the {victim}" for victim, count in self.kills.items())
        return f"{sum(self.kills.values())} kills of a study ({each}), {self.participant} participants; {len(self.faults)} faults"
