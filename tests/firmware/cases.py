#!/usr/bin/env python3
"""cases.py WORK PALPA [--openmpd [--boards DIR]] [--sonicsurface CLONE]: plays palpa's bytes in the simulators that run.sh built
in WORK.

A row per case and board: runs of equal periods; pulses that were compared, and how many of them differ from the intended drive;
periods in which the outputs change; runs that show no drive; by how many steps the slots 3 modulo 8 are late; rms difference of
phase in steps; sound at the foci, relative to what the intended phases give; drives that were shown and intended.
"""
import argparse
import os
import pathlib
import subprocess
import sys

import numpy as np

from boards import OpenMpd, SonicSurface, Tactile, files_of_boards, makers_places
from compare import Comparison, between, loudest, on_or_off, wrap
from damage import OPENMPD_DAMAGES, SONICSURFACE_DAMAGES, damage_openmpd, damage_sonicsurface, single_slots
from pins import Pins
from places import heard_place
from play import Player, line_end, wire_bytes
from still import ROOT, focus_of, write_pair, write_recording, write_rig

FOCUS_M = (0.020, 0.030, 0.145)
ROW = "{:<34}{:>6}{:>9}{:>10}{:>7}{:>8}{:>7}{:>6}{:>8}{:>9}"


class Stage:
    def __init__(self, work, palpa):
        self.work, self.failures, self.compared, self.different = work, [], 0, 0
        self.player = Player(palpa, work, write_recording(work / "still"))
        self.focus_m = focus_of(palpa, self.player.recording, work)

    def expect(self, true, what):
        if not true:
            self.failures.append(what)
            print(f"    WRONG: {what}")

    def rig(self, layout):
        return write_rig(self.work / f"{pathlib.Path(layout).stem}.rig.toml", layout, self.focus_m, FOCUS_M)

    def simulate(self, simulator, board, wires, rest_s):
        """The outputs of each board. `wires`: what each chip gets, or the one line of all SonicSurfaces; `rest_s`: for how long
        the simulation goes on."""
        seconds = max(wire["at_s"][-1] for wire in wires) + rest_s
        files = [self.work / f"{number}.bytes" for number in range(len(wires))]
        for wire, file in zip(wires, files):
            wire.tofile(file)
        outputs = [self.work / f"{number}.pins" for number in range(2 if simulator.endswith("pair") else 1)]
        if board.kind == "openmpd":
            words = [word for pair in zip(files, outputs) for word in pair]
        else:
            words = [files[0], *outputs]
        subprocess.run([self.work / simulator, repr(float(seconds)), *words[:4]], check=True)
        return [Pins(output, board.steps, board.slot_of_output) for output in outputs]

    def row(self, name, found, most_different=0, most_spoiled=0, most_mixed=0):
        self.compared, self.different = self.compared + found.compared, self.different + found.different
        late = "" if found.late != found.late else f"{found.late:.2f}"
        print(ROW.format(name, found.runs, found.compared, found.different, found.mixed, found.spoiled, late, f"{found.rms:.2f}",
                         f"{100 * found.focus:.1f} %", f"{found.shown}/{found.drives}"), flush=True)
        self.expect(found.silent_at_end, f"{name}: not silent at the end")
        self.expect(found.shown > 0, f"{name}: no drive is played")
        self.expect(found.spoiled <= most_spoiled, f"{name}: {found.spoiled} runs show no drive, more than {most_spoiled}")
        if most_spoiled == 0:
            self.expect(found.different <= most_different, f"{name}: {found.different} pulses differ")
        self.expect(found.mixed <= most_mixed, f"{name}: {found.mixed} mixed periods, more than {most_mixed}")
        self.expect(not abs(found.late) > 0.3, f"{name}: slots 3 modulo 8 are {found.late:.2f} steps late")

    def link_test(self, kind, link, words):
        """The bytes of palpa link test, and the slots that it sends alone. A busy machine leaves some out, so it may try again."""
        wires = []
        while not wires or (len(wires) < 3 and len(single_slots(wires[-1], kind)) < 250):
            wires.append(wire_bytes(self.player.link_test(kind, link, words)))
        wire = max(wires, key=lambda wire: len(single_slots(wire, kind)))
        return wire, single_slots(wire, kind)

    def one_by_one(self, found, sent):
        self.expect(found.shown == len(sent) and found.shown >= 64, f"link test: {found.shown} transducers sound alone, and palpa sent {len(sent)}")

    def check_places(self, board, makers):
        """Where palpa has the transducers; `makers`: where their makers have those of the wire's slots."""
        file = self.work / "drive.csv"
        subprocess.run([self.player.palpa, "drive", "--layout", board.kind, "--focus", "0,0,0.1", "--csv", file, "--quiet"], check=True)
        palpas = np.loadtxt(file, delimiter=",", skiprows=1)[:, 1:3]
        right = int((np.abs(palpas - makers[board.slot]).max(1) < 0.5e-3).sum())
        print(f"    {right} of 256 transducers are where the makers have them, seen from the side that emits")
        self.expect(right == 256, f"{256 - right} transducers are not where the makers have them")

    def check_focus(self, comparison, makers):
        """Where a single focus sounds, by the makers' places."""
        place = heard_place(comparison, makers)
        asked, heard = (", ".join(f"{1000 * c:.1f}" for c in where) for where in (FOCUS_M, place))
        print(f"    a focus asked for at ({asked}) mm sounds at ({heard}) mm")
        self.expect(np.abs(place - FOCUS_M).max() < 2e-3, f"the focus for ({asked}) mm sounds at ({heard}) mm")

    def lag(self, name, first, second, board, most):
        lag = wrap(second.delay - first.delay, board.steps)
        print(f"    {name}: the further board is {lag:+.2f} of {board.steps} steps later ({25 * lag / board.steps:+.2f} us); "
              f"a focus of both is {100 * abs(1 + np.exp(2j * np.pi * lag / board.steps)) / 2:.1f} % of what was intended")
        self.expect(abs(lag) <= most, f"{name}: the further board is {lag:+.2f} of {board.steps} steps later, more than {most}")


def one_by_one():
    """The drives of palpa link test: each transducer alone."""
    drives = np.zeros((256, 256, 2))
    drives[range(256), range(256), 0] = 1
    return drives


# ---- OpenMPD --------------------------------------------------------------------------------------------------------


def openmpd_cases(stage, files):
    board, rig = OpenMpd(), stage.rig("openmpd")
    for name, places in files.items():
        stage.expect(np.abs(places - board.places).max() < 1e-6, f"{name} has other places or pins than boards.py")
    print("\nOpenMPD, firmware 3.4.2; places and pins " + (f"of {len(files)} files of the makers" if files else "as in boards.py"))
    print(ROW.format("case", "runs", "pulses", "different", "mixed", "no drive", "late", "rms", "focus", "drives"))

    jumps = ("--steps", "off")

    def case(name, words, of_link=jumps, scaled=False, steps=1, frames=12):
        trace, drives = stage.player.run("openmpd", "openmpd:EMU1", rig, words, frames, of_link=of_link)
        wire = wire_bytes(trace)
        pins = stage.simulate("openmpd", board, [wire], 5e-3)[0]
        if scaled:
            drives = between(loudest(drives), steps)
        comparison = Comparison(board, pins, drives, scaled)
        stage.row(name, comparison.result())
        return wire, drives, comparison

    *_, comparison = case("--method single-focus", ["--method", "single-focus"])
    stage.check_places(board, board.places)
    stage.check_focus(comparison, board.places)
    wire, drives, _ = case("--steps off", [], frames=30)
    case("default", [], of_link=(), scaled=True, steps=14)
    case("--ceiling 0.8", ["--ceiling", "0.8"])
    case("--amplitude uniform", ["--amplitude", "uniform"])
    case("--ramp 20ms", ["--ramp", "20ms"], scaled=True, steps=7)
    case("--dwell 0.1ms", ["--dwell", "0.1ms"], of_link=())
    test, sent = stage.link_test("openmpd", "openmpd:EMU1", ["--each", "4ms", "--rest", "2ms", "--dwell", "2ms"])
    found = Comparison(board, stage.simulate("openmpd", board, [test], 5e-3)[0], one_by_one()).result()
    stage.row("link test, one by one", found)
    stage.one_by_one(found, sent)

    again, begin_s = damage_openmpd(wire)
    pins = stage.simulate("openmpd", board, [again], 5e-3)[0]
    comparison = Comparison(board, pins, drives)
    count = len(OPENMPD_DAMAGES)
    found = comparison.result()
    stage.row(f"lost bytes, {count} kinds", found, most_spoiled=count)
    print(f"    the longest pulse is {found.widest} of 128 steps")
    stage.row("the next run after lost bytes", comparison.result(since_s=begin_s))

    trace, drives = stage.player.run("openmpd", "openmpd:EMU1,EMU2", stage.rig("openmpd-pair"), [], 12, ("--serial", "EMU1,EMU2"), jumps)
    wires = [wire_bytes(trace, serial) for serial in ("EMU1", "EMU2")]
    both = [Comparison(board, pins, drives[:, half], loudest=drives[:, :, 0].max(1)).result()
            for pins, half in zip(stage.simulate("openmpd_pair", board, wires, 5e-3), (slice(0, 256), slice(256, 512)))]
    stage.row("master of a pair", both[0])
    stage.row("slave", both[1])
    stage.lag("pair", *both, board, 1.0)


# ---- SonicSurface ---------------------------------------------------------------------------------------------------


def sonicsurface_cases(stage, clone):
    board = SonicSurface()
    tactile = Tactile((clone / "Firmware/FPGA tactile modulation/src/Distribute.vhd").read_text())
    makers = makers_places((clone / "ControlSoftware/Python/SonicSurface.py").read_text())
    rig, single, moving = stage.rig("sonicsurface"), ["--method", "single-focus"], ["--dwell", "12ms"]
    print("\nSonicSurface, plain firmware")
    print(ROW.format("case", "runs", "pulses", "different", "mixed", "no drive", "late", "rms", "focus", "drives"))

    def play(link, rig, words, emulator=(), frames=24):
        trace, drives = stage.player.run("sonicsurface", link, rig, words, frames, emulator)
        return with_hidden(wire_bytes(trace)), on_or_off(drives)

    def with_hidden(wire):
        """At the end, the buffers change places once more: the hidden one must be silent, too."""
        more = wire[-1:].copy()
        more["at_s"], more["value"] = line_end(wire, 230400) + 0.02, 253
        return np.concatenate([wire, more])

    def case(name, simulator, board, wire, drives, scaled=False, **most):
        pins = stage.simulate(simulator, board, [wire], 0.01)[0]
        comparison = Comparison(board, pins, drives, scaled)
        found = comparison.result()
        # The tactile firmware's own modulation changes the outputs, too: between two of the runs of equal periods.
        own_changes = found.runs // 10 if simulator == "tactile" else 0
        stage.row(name, found, most_mixed=3 * int((wire["value"] == 253).sum()) + own_changes, **most)
        return comparison, found

    comparison, _ = case("default: a single focus at 200 Hz", "plain", board, *play("sonicsurface:{}", rig, single))
    stage.check_places(board, makers)
    stage.check_focus(comparison, makers)
    wire, drives = play("sonicsurface:{}", rig, moving, frames=48)
    case("--dwell 12ms", "plain", board, wire, drives)
    case("--amplitude uniform", "plain", board, *play("sonicsurface:{}", rig, [*single, "--amplitude", "uniform"]))
    _, found = case("--ceiling 0.5", "plain", board, *play("sonicsurface:{}", rig, [*moving, "--ceiling", "0.5"]), scaled=True)
    stage.expect(abs(found.sounding - 0.5) < 0.01, f"--ceiling 0.5: {100 * found.sounding:.1f} % of the transducers sound")
    case("--ramp 100ms", "plain", board, *play("sonicsurface:{}", rig, [*moving, "--ramp", "100ms"], frames=36), scaled=True)
    damaged = damage_sonicsurface(wire)
    case(f"lost bytes, {len(SONICSURFACE_DAMAGES)} kinds", "plain", board, damaged, drives, most_spoiled=2 * len(SONICSURFACE_DAMAGES))
    test, sent = stage.link_test("sonicsurface", "sonicsurface:{}", ["--each", "24ms", "--rest", "0s", "--dwell", "24ms"])
    _, found = case("link test, one by one", "plain", board, with_hidden(test), one_by_one())
    stage.one_by_one(found, sent)

    layout = write_pair(stage.work / "pair.toml", "sonicsurface", 0.29)
    for name, words in (("single focus", single), ("--dwell 24ms", ["--dwell", "24ms"])):
        wire, drives = play("sonicsurface:{}", stage.rig(str(layout)), words, ("--layout", str(layout)), 36)
        both = [Comparison(board, pins, on_or_off(drives[:, half])).result()
                for pins, half in zip(stage.simulate("sonicsurface_pair", board, [wire], 0.01), (slice(0, 256), slice(256, 512)))]
        for who, found in zip(("primary", "secondary"), both):
            stage.row(f"{who} of a pair, {name}", found, most_mixed=3 * int((wire["value"] == 253).sum()))
        stage.lag(f"pair, {name}", *both, board, 0.6)

    print("\nSonicSurface, tactile firmware")
    for name, words in (("single focus", single), ("--dwell 12ms", moving)):
        case(f"tactile: {name}", "tactile", tactile, *play("sonicsurface:{},tactile", rig, words, ("--tactile",)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("palpa")
    parser.add_argument("--openmpd", action="store_true")
    parser.add_argument("--boards", type=pathlib.Path)
    parser.add_argument("--sonicsurface", type=pathlib.Path)
    options = parser.parse_args()
    os.environ.setdefault("PALPA_ASSETS", str(ROOT / "assets"))  # for a palpa that lies elsewhere
    stage = Stage(options.work, options.palpa)
    if options.sonicsurface:
        sonicsurface_cases(stage, options.sonicsurface)
    if options.openmpd:
        openmpd_cases(stage, files_of_boards(options.boards) if options.boards else {})
    print(f"\ntest firmware: {stage.compared} pulses compared, {stage.different} different")
    for failure in stage.failures:
        print(f"test firmware: FAILED: {failure}")
    sys.exit(1 if stage.failures else 0)


if __name__ == "__main__":
    main()
