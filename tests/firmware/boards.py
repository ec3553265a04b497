"""boards.py: what a test must know of the boards to read their outputs, from palpa's pages and from the makers' own files.

`places`: where the transducers of the wire's slots are, seen from the side that emits: x to the right, y up, in metres.
"""
import ast
import pathlib
import re

import numpy as np

SLOTS = np.arange(256)
LATE = SLOTS % 8 == 3  # the slots whose outputs SonicSurface's firmware sets a step late


class OpenMpd:
    """128 steps of phase; amplitudes are pulse widths, 64 is full. Transducer 16 x + y, docs/layouts.md."""
    name, kind, steps = "OpenMPD", "openmpd", 128
    slot_of_output = [(7 - n) % 8 for n in range(8)]
    aligned = True  # it changes all outputs where a period of its own begins
    uneven = np.zeros(256, bool)
    full_width = 64
    any_width, modulated = True, False
    correction = np.zeros(256, np.int64)

    def __init__(self):
        x, y = np.divmod(np.arange(256), 16)
        within = np.array([[1, 5], [0, 4], [3, 6], [2, 7]])
        self.slot = 64 * (3 - x // 4) + 8 * (7 - y // 2) + within[x % 4, y % 2]
        self.places = np.empty((256, 2))
        self.places[self.slot] = np.stack([x - 7.5, 7.5 - y], -1) * 10.5e-3

    def widths(self, amplitudes, loudest):
        """The lowest and the highest width that an amplitude may have: the nearest one that is not above the loudest amplitude of
        the drive."""
        return self.nearest(amplitudes - 1e-5, loudest), self.nearest(amplitudes + 1e-5, loudest)

    @staticmethod
    def nearest(amplitudes, loudest):
        below = np.floor(64 * 2 / np.pi * np.arcsin(np.clip(amplitudes, 0, 1)))
        lower, upper = np.sin(np.pi / 128 * below), np.sin(np.pi / 128 * np.minimum(below + 1, 64))
        return np.where((amplitudes - lower > upper - amplitudes) & (upper <= loudest + 1e-6), np.minimum(below + 1, 64), below)


class SonicSurface:
    """32 steps of phase; a transducer that sounds has pulses of half a period. Transducer 16 r + c."""
    name, kind, steps = "SonicSurface", "sonicsurface", 32
    slot_of_output = [(2 - n) % 8 for n in range(8)]
    aligned = False
    uneven = LATE
    full_width = 16
    any_width, modulated = False, False
    correction = np.zeros(256, np.int64)

    def __init__(self):
        row, column = np.divmod(np.arange(256), 16)
        within = np.array([[0, 4], [7, 3], [1, 6], [2, 5]])
        self.slot = 64 * (column // 4) + 8 * (row // 2) + within[column % 4, row % 2]
        self.places = np.empty((256, 2))
        self.places[self.slot] = np.stack([column - 7.5, row - 7.5], -1) * 10.5e-3

    def widths(self, amplitudes, _):
        width = np.where(amplitudes > 0, self.full_width, 0)
        return width, width


class Tactile(SonicSurface):
    """16 steps of phase. The source has a table of corrections, which the published program of the FPGA does not have. The firmware
    switches the outputs on and off one after the other."""
    name, steps, full_width, modulated = "SonicSurface, tactile", 16, 7, True

    def __init__(self, source):
        super().__init__()
        table = re.search(r"PHASE_CORRECTION\s*:\s*\w+\s*:=\s*\(([\d,\s]+)\)", source)[1]
        self.correction = np.array([int(word) for word in table.split(",")]) // 2


def makers_places(program):
    """The makers' places of SonicSurface's slots, from their program in Python, seen from the side that emits: x to the right,
    y up, in metres. Their axes are right-handed, and +y is where the board emits, so up is their -z."""
    for node in ast.walk(ast.parse(program)):
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "EMITTERS_POS":
            places = np.array(ast.literal_eval(node.value), float).reshape(256, 3)
            places -= (places.max(0) + places.min(0)) / 2  # some of their numbers are from another origin
            return places[:, [0, 2]] * [1, -1]
    raise ValueError("the makers' program has no EMITTERS_POS")


def files_of_boards(folder):
    """{name: the places of the wire's slots} of the makers' files of OpenMPD boards. A file has a serial number, 256, 128; then of each
    transducer a place (x, y, z); its pin, which is its slot; an offset of its phase; a factor of its amplitude. Lines break anywhere."""
    found = {}
    for file in sorted(pathlib.Path(folder).rglob("*board_*.pat*")):
        numbers = [float(word) for word in re.findall(r"[-+.\deE]+", file.read_text().split("\n", 1)[1])]
        if len(numbers) < 2 + 4 * 256 or numbers[0] != 256:
            raise ValueError(f"{file}: is no file of a board")
        places, pins = np.array(numbers[2:2 + 3 * 256]).reshape(256, 3), np.array(numbers[2 + 3 * 256:2 + 4 * 256], int)
        if sorted(pins) != list(range(256)) or places[:, 2].any():
            raise ValueError(f"{file}: its pins are not 0 to 255, or not all places are in the plane")
        found[file.name] = np.empty((256, 2))
        found[file.name][pins] = places[:, :2]
    return found
