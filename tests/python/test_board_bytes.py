"""What palpa sends to boards, as their makers' firmware plays it: the short form of `./dev test firmware`, by its rules, without
simulators and clones (tests/firmware). Every pulse is compared with the drive that palpa intended, and a focus must sound where it was
asked for. A busy machine leaves drives out; those that come must be right."""
import sys

import numpy as np
import pytest

from commands import PALPA, ROOT

sys.path.insert(0, str(ROOT / "tests/firmware"))
from boards import OpenMpd, SonicSurface  # noqa: E402
from compare import Comparison, between, loudest, on_or_off, wrap  # noqa: E402
from decoded import openmpd, sonicsurface  # noqa: E402
from places import heard_place  # noqa: E402
from play import Player, wire_bytes  # noqa: E402
from still import focus_of, write_pair, write_recording, write_rig  # noqa: E402

FOCUS_M = np.array([0.020, 0.030, 0.145])
SINGLE, JUMPS = ["--method", "single-focus"], ("--steps", "off")
OPENMPD_LATE, SONICSURFACE_LATE = 0.762 * 128, 16.5  # the second board's periods, in steps


class Bench:
    def __init__(self, folder):
        self.folder = folder
        self.player = Player(PALPA, folder, write_recording(folder / "still"))
        self.focus_m = focus_of(PALPA, self.player.recording, folder)

    def rig(self, layout):
        return write_rig(self.folder / "rig.toml", layout, self.focus_m, FOCUS_M.tolist())


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Bench(tmp_path_factory.mktemp("w"))


def is_right(found):
    assert found.shown > 0 and found.compared > 0 and found.silent_at_end
    assert found.different == found.spoiled == found.mixed == 0


def sounds_at(comparison, places):
    return np.abs(heard_place(comparison, places) - FOCUS_M).max() < 2e-3


@pytest.mark.parametrize("words, of_link", [
    ([], ()), ([], JUMPS), (SINGLE, JUMPS), (["--ceiling", "0.8"], JUMPS), (["--amplitude", "uniform"], JUMPS), (["--ramp", "20ms"], JUMPS),
    (["--dwell", "0.1ms"], ())])
def test_openmpd(bench, words, of_link):
    board = OpenMpd()
    trace, drives = bench.player.run("openmpd", "openmpd:EMU1", bench.rig("openmpd"), words, 12, of_link=of_link)
    steps = 7 if "--ramp" in words else 1 if of_link or words else 14
    comparison = Comparison(board, openmpd(wire_bytes(trace)), between(loudest(drives), steps) if steps > 1 else drives, steps > 1)
    is_right(comparison.result())
    if words == SINGLE:
        assert sounds_at(comparison, board.places)
        assert not sounds_at(comparison, board.places * [1, -1]), "as of a layout that is mirrored"


def test_openmpd_pair(bench):
    board = OpenMpd()
    trace, drives = bench.player.run("openmpd", "openmpd:EMU1,EMU2", bench.rig("openmpd-pair"), [], 12, ("--serial", "EMU1,EMU2"), JUMPS)
    found = [Comparison(board, openmpd(wire_bytes(trace, serial), late), drives[:, half], loudest=drives[:, :, 0].max(1)).result()
             for serial, late, half in (("EMU1", 0, slice(0, 256)), ("EMU2", OPENMPD_LATE, slice(256, 512)))]
    for one in found:
        is_right(one)
    assert abs(wrap(found[1].delay - found[0].delay, board.steps)) <= 1


@pytest.mark.parametrize("words", [SINGLE, ["--dwell", "12ms"], ["--dwell", "12ms", "--ceiling", "0.5"]])
def test_sonicsurface(bench, words):
    board = SonicSurface()
    trace, drives = bench.player.run("sonicsurface", "sonicsurface:{}", bench.rig("sonicsurface"), words)
    comparison = Comparison(board, sonicsurface(wire_bytes(trace), board.uneven), on_or_off(drives), "--ceiling" in words)
    found = comparison.result()
    is_right(found)
    assert abs(found.late) < 0.3 and abs(found.sounding - (0.5 if "--ceiling" in words else 1)) < 0.01
    if words == SINGLE:
        assert sounds_at(comparison, board.places)
        assert not sounds_at(comparison, board.places * [1, -1]), "as of a layout that is mirrored"


def test_sonicsurface_pair(bench):
    board, layout = SonicSurface(), write_pair(bench.folder / "pair.toml", "sonicsurface", 0.29)
    trace, drives = bench.player.run("sonicsurface", "sonicsurface:{}", bench.rig(str(layout)), SINGLE, 36, ("--layout", str(layout)))
    wire = wire_bytes(trace)
    found = [Comparison(board, sonicsurface(wire, board.uneven, late, selected_by), on_or_off(drives[:, half])).result()
             for late, selected_by, half in ((0, 192, slice(0, 256)), (SONICSURFACE_LATE, 193, slice(256, 512)))]
    for one in found:
        is_right(one)
    assert abs(wrap(found[1].delay - found[0].delay, board.steps)) <= 0.6
