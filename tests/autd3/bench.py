#!/usr/bin/env python3
"""bench.py [--seconds N] [--ends N] [--drives N] [--load N] [--palpa FILE] [WHAT...]: figures of AUTD3 units, each beside its goal.

WHAT: drives (what the makers' units sound), rate (drives to the last unit's answer on an emulated cable), ends (how soon all are
silent) or losses; all of them by default. The goals are for an otherwise idle machine; ends is measured with --load busy processes
(4). What the makers' units are needed for is skipped where there is no cargo. Exit code 1 where a goal is missed.
"""
import argparse
import json
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time

from run import PATIENCE_S, ROOT, ServedUnits, Stage, UdpUnits, judge_program, say, write_layout

WAYS = {"Ctrl-C": (signal.SIGINT, 10), "SIGTERM": (signal.SIGTERM, 10), "kill -9": (signal.SIGKILL, 300)}
FAULTS = ("none", "drop 0 3", "dropanswer 0 3", "repeat 0 3", "delay 2000")


class Bench:
    def __init__(self, given, work):
        self.given, self.work, self.missed = given, work, []
        self.palpa = given.palpa.resolve()

    def row(self, figure, measured, goal, met):
        print(f"{figure:<58} {measured:<52} goal: {goal}{'' if met else '   MISSED'}", flush=True)
        if not met:
            self.missed.append(figure)

    def play(self, units, link, *words):
        layout = write_layout(self.work / f"row-{units}.toml", units)
        return [self.palpa, "play", "circle", "--layout", layout, "--ceiling", "1", *words, "--link", link]

    # ---- what units sound -------------------------------------------------------------------------------------------

    def drives(self, program):
        for release, kind in (("0.13", UdpUnits), ("0.12", UdpUnits), ("38", ServedUnits)):
            for count in (1, 3, 16):
                for words in ([], ["--amplitude", "distance"]):
                    stage = Stage(self.palpa, self.work, lambda _: None)
                    units = kind(program, release, count)
                    try:
                        layout = write_layout(self.work / "row.toml", count)
                        meant = stage.play(release, units, count, ["play", "circle", *words, "--layout", layout, "--ceiling", "1"],
                                           -(-self.given.drives // count))
                    finally:
                        units.close()
                    name = f"drives: {release}, units: {count}, amplitudes {'by distance' if words else 'uniform'}"
                    if meant is None:
                        self.row(name, "nothing sounds", "0 others", False)
                        continue
                    computed = f"{meant.most_true:.1f}/256 from the true phase" if "foci" in meant.kinds else f"phase {meant.most_phase:.2f}/256"
                    self.row(name, f"{meant.others} of {meant.compared} others, {computed}, amplitude {meant.most_intensity:.2f}/255",
                             "0 others, phase 0.5/256 or by formula", stage.failures == 0)

    # ---- an emulated cable ------------------------------------------------------------------------------------------

    def emulated(self, units, protocol, emulator, words, seconds, expect_fault=False):
        """Plays to palpa's emulator: what palpa says of the drives, the processor time it took, and the emulator's report."""
        layout = write_layout(self.work / f"row-{units}.toml", units)
        report, err = self.work / "emulated.json", self.work / "palpa.err"
        served = subprocess.Popen([self.palpa, "emulate", "autd3-udp", "--port", "0", "--protocol", str(protocol), "--layout", layout, "--json", report,
                                   "--quiet", *emulator], stdout=subprocess.PIPE, text=True)
        try:
            address = served.stdout.readline().strip()
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            with open(err, "w") as log:
                done = subprocess.run([*self.play(units, f"autd3-udp:{address}", *words), "--duration", f"{seconds}s", "--log-level", "info"],
                                      stdout=log, stderr=log, check=False)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
        finally:
            served.send_signal(signal.SIGINT)
            served.wait(PATIENCE_S)
        used = sum(getattr(after, part) - getattr(before, part) for part in ("ru_utime", "ru_stime"))
        text = err.read_text()
        if done.returncode and not expect_fault:
            say(f"palpa failed: {text.strip()}")
        number = lambda pattern: int((re.search(pattern, text) or [0, "0"])[1])
        return {"status": done.returncode, "text": text, "share": used / seconds, "sent": number(r"(\d+) drives sounded"),
                "there": number(r"(\d+) were completed"), "again": number(r"(\d+) frames sent again"), "late": number(r"(\d+) carried out late"),
                "overslept": number(r"(\d+) slots overslept"), "report": json.loads(report.read_text())}

    def rate(self, _):
        for units, dwell, hertz in ((1, "0.2ms", 5000), (16, "1ms", 1000)):
            for processing, goal in (("50us", True), ("200us", False)):
                if units * 1e-6 * int(processing[:-2]) and hertz * int(processing[:-2]) > 900_000:
                    continue  # a unit is not that fast
                was = self.emulated(units, 5, ["--processing", processing], ["--amplitude", "distance", "--dwell", dwell], self.given.seconds)
                slots = self.given.seconds * hertz
                late = (was["late"] / max(1, units) + max(0, was["sent"] - was["there"]) + was["overslept"]) / slots
                self.row(f"rate: {units} unit{'s' * (units > 1)}, {hertz} drives/s, {processing} of processing",
                         f"{was['there']} of {was['sent']} there, {100 * late:.2f} % late, {100 * was['share']:.0f} % of a core",
                         "0.1 % late, 25 % of a core" if goal else "measured and said",
                         not goal or (was["there"] > 0 and late <= 1e-3 and was["share"] <= 0.25))

    def losses(self, _):
        for units in (1, 16):
            was = self.emulated(units, 5, ["--fault", "lose=1%"], ["--amplitude", "distance", "--dwell", "5ms"], self.given.seconds)
            slots = 200 * self.given.seconds
            late = (was["late"] / units + max(0, was["sent"] - was["there"]) + was["overslept"]) / slots
            self.row(f"losses: 1 % both ways, 200 drives/s, units: {units}",
                     f"{was['there']} of {was['sent']} there, {100 * late:.2f} % late, {was['again']} sent again, exit code {was['status']}",
                     "no stop, 2 % late" if units == 1 else "measured and said",
                     was["status"] == 0 and not was["report"]["sounds"] and (units > 1 or late <= 0.02))

    # ---- ends -------------------------------------------------------------------------------------------------------

    def silent_after(self, units, player, send):
        """Milliseconds from the signal until no unit sounds."""
        begin = time.monotonic()
        player.send_signal(send)
        while units.ask("sounds")["sounds"]:
            if time.monotonic() > begin + PATIENCE_S:
                return float("inf")
        took = 1e3 * (time.monotonic() - begin)
        player.wait(PATIENCE_S)
        return took

    def ends(self, program):
        loads = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(self.given.load)]
        try:
            if program is not None:
                for release in ("0.13", "0.12"):
                    for way, (send, goal_ms) in WAYS.items():
                        for fault in FAULTS:
                            self.end(program, release, way, send, goal_ms, fault)
                    self.end(program, release, "a unit that falls silent", None, 500, "mute 0 1")
            for protocol in (2, 3, 5):
                for fault in ("cut=0@2s", "reboot=0@2s", "mute=0@2s"):
                    was = self.emulated(1, protocol, ["--fault", fault], ["--amplitude", "distance"], 2.6, True)
                    line = next((line for line in was["text"].splitlines() if "warning" in line and "ceiling" not in line), "")
                    self.row(f"ends: protocol {protocol}, {fault}, 600 ms later", ("sounds" if was["report"]["sounds"] else "silent") + f"; {line[:70]}",
                             "silent in 500 ms, and a line", not was["report"]["sounds"] and line != "")
        finally:
            for load in loads:
                load.kill()
                load.wait()

    def end(self, program, release, way, send, goal_ms, fault):
        times, lines = [], 0
        units = UdpUnits(program, release, 1)
        try:
            for _ in range(self.given.ends):
                err = self.work / "palpa.err"
                with open(err, "w") as log:
                    player = subprocess.Popen([*self.play(1, f"autd3-udp:{units.address}", "--amplitude", "distance"), "--quiet"],
                                              stdin=subprocess.DEVNULL, stderr=log)
                begin = time.monotonic()
                while not units.ask("sounds")["sounds"] and time.monotonic() < begin + PATIENCE_S:
                    time.sleep(0.01)
                time.sleep(0.2)
                if fault != "none":
                    units.ask(fault)
                if send is None:
                    times.append(self.silent_after(units, player, 0))
                    player.send_signal(signal.SIGINT)
                    player.wait(PATIENCE_S)
                    lines += "warning" in err.read_text() or "error" in err.read_text()
                else:
                    times.append(self.silent_after(units, player, send))
                for undo in ("mute 0 0", "delay 0", "drop 0 0", "dropanswer 0 0", "repeat 0 0"):
                    units.ask(undo)
        finally:
            units.close()
        times.sort()
        self.row(f"ends: {release}, {way}" + ("" if fault in ("none", "mute 0 1") else f", {fault}"),
                 f"silent after {times[len(times) // 2]:.1f} ms, at most {times[-1]:.1f}" + ("" if send else f"; {lines} of {len(times)} lines"),
                 f"{goal_ms} ms", times[-1] <= goal_ms and (send is not None or lines == len(times)))


def main():
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have started this with it ignored, and palpa would inherit that
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("what", nargs="*", choices=["drives", "rate", "ends", "losses", []])
    options.add_argument("--seconds", type=float, default=60)
    options.add_argument("--ends", type=int, default=50)
    options.add_argument("--drives", type=int, default=1000)
    options.add_argument("--load", type=int, default=4)
    options.add_argument("--palpa", default=ROOT / "build/release/bin/palpa", type=pathlib.Path)
    given = options.parse_args()
    program, why = judge_program(False)
    with tempfile.TemporaryDirectory(prefix="autd3.") as work:
        bench = Bench(given, pathlib.Path(work))
        for what in given.what or ["drives", "rate", "ends", "losses"]:
            if program is None and what == "drives":
                say(f"skipped: {what}: {why}")
                continue
            getattr(bench, what)(program)
    print(f"{len(bench.missed)} goals missed" + "".join(f"\n  {figure}" for figure in bench.missed))
    return 1 if bench.missed else 0


if __name__ == "__main__":
    sys.exit(main())
