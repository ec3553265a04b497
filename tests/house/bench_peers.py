#!/usr/bin/env python3
"""bench_peers.py [--sets N] [--foci FILE]: the weakest of several foci that sound together, by palpa's solvers and by other programs.

Each drive is judged by the model in this file, which shares no code with them: exact pistons on `openmpd`, the T4010A1's table on
`autd3`, 343 m/s, 4.386 Pa m, no absorption. Prints the mean over all sets of foci, and the least ratio of palpa's to the loudest
other's, set by set. FILE has sets of foci of one's own, {"4": [[[x, y, z], ...], ...], ...} in metres. Needs NumPy, SciPy and the
Python module; programs that Python does not have are left out by name.
"""
import argparse
import importlib.util
import json
import sys

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.special import j1

import palpa

SPEED, HERTZ, LEVEL_PA_M, RADIUS_M = 343.0, 40e3, 4.386, 4.5e-3
WAVE_NUMBER = 2 * np.pi * HERTZ / SPEED
T4010A1 = PchipInterpolator(np.arange(0, 91, 10), [1, 1, 1, 0.8912509, 0.7079458, 0.5011872, 0.3548134, 0.2511886, 0.1995262, 0.1778279])
COUNTS = (1, 2, 4, 8, 16, 32)
PALPA = {"palpa, once (loudest)": {}, "palpa, in a run (gs-pat)": {"solver": "gs-pat"}, "palpa, naive, uniform": {"solver": "naive"},
         "palpa, the paper's (naive, normalise)": {"solver": "naive", "constraint": "normalise", "amplitude": "distance"}}


def transfer(layout, foci, directivity):
    """The pressure at each focus from each transducer at full amplitude, as the judge has it."""
    way = foci[:, None, :] - layout.positions[None]
    distance = np.linalg.norm(way, axis=2)
    cosine = np.einsum("fti,ti->ft", way, layout.axes) / distance
    if directivity == "piston":
        x = WAVE_NUMBER * RADIUS_M * np.sqrt(np.clip(1 - cosine**2, 1e-24, 1))
        share = 2 * j1(x) / x
    else:
        share = T4010A1(np.degrees(np.arccos(np.clip(cosine, 0, 1))))
    return LEVEL_PA_M * share * np.exp(1j * WAVE_NUMBER * distance) / distance


def made_sets(count, sets):
    """Sets of foci within 50 mm of the axis, 150 to 200 mm away, at least 15 mm apart; the same each time."""
    random = np.random.default_rng(count)
    found = []
    while len(found) < sets:
        foci = []
        while len(foci) < count:
            x, y, z = random.uniform(-0.05, 0.05, 2).tolist() + [random.uniform(0.15, 0.2)]
            if x * x + y * y <= 0.05**2 and all(np.linalg.norm(np.subtract(one, (x, y, z))) >= 0.015 for one in foci):
                foci.append((x, y, z))
        found.append(foci)
    return found


def acoustools_solver():
    """AcousTools' wgs as a function of the layout and the foci; its board is that of the layout."""
    import torch
    from acoustools.Solvers import wgs
    from acoustools.Utilities import forward_model

    def solve(layout, foci):
        board = torch.tensor(np.asarray(layout.positions), dtype=torch.float32)
        points = torch.tensor(foci.T[None], dtype=torch.float32)
        normals = torch.tensor(np.asarray(layout.axes)).to(torch.complex64)  # its own would be 0 at z = 0
        matrix = forward_model(points, board, norms=normals)
        drive = wgs(points, iterations=200, board=board, A=matrix).detach().numpy().reshape(-1)
        return drive / np.abs(drive)

    return {"AcousTools wgs": solve}


def peers():
    if any(importlib.util.find_spec(name) is None for name in ("acoustools", "torch")):
        print("skipped: AcousTools (pip install acoustools torch)", file=sys.stderr)
        return {}
    return acoustools_solver()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--sets", type=int, default=10)
    parser.add_argument("--foci", help="a file with sets of foci")
    given = parser.parse_args()
    own = json.load(open(given.foci)) if given.foci else {}
    others = peers()
    for name, directivity in (("openmpd", "piston"), ("autd3", "t4010a1")):
        layout, rows = palpa.Layout(name), {}
        ratio = np.inf
        for count in COUNTS:
            weakest = {}
            for foci in map(np.asarray, own.get(str(count)) or made_sets(count, given.sets)):
                judge = transfer(layout, foci, directivity)
                drives = {row: layout.drive(foci, sound_speed=SPEED, directivity=directivity, backend="cpu", **options)
                          for row, options in PALPA.items()}
                if directivity == "piston":  # AcousTools knows no other
                    drives |= {row: solve(layout, foci) for row, solve in others.items()}
                heard = {row: np.abs(judge @ np.asarray(drive)).min() for row, drive in drives.items()}
                for row, pascals in heard.items():
                    weakest.setdefault(row, []).append(pascals)
                if loud := [heard[row] for row in others if row in heard]:
                    ratio = min(ratio, min(heard[row] for row in list(PALPA)[:2]) / max(loud))
            for row, pascals in weakest.items():
                rows.setdefault(row, []).append(np.mean(pascals))
        print(f"\n{name:40}" + "".join(f"{count:>8}" for count in COUNTS) + "   foci; Pa at the weakest")
        for row, pascals in rows.items():
            print(f"{row:40}" + "".join(f"{one:8.0f}" for one in pascals))
        if np.isfinite(ratio):
            print(f"palpa's quieter of the first two, over the loudest other, in the worst set: {ratio:.3f}")


if __name__ == "__main__":
    main()
