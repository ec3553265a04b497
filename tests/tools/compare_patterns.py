#!/usr/bin/env python3
"""Writes the section "Compared" of docs/patterns.md with its pictures: patterns and the paper's method on one finger.

    compare_patterns.py [--palpa PROGRAM] [--page PAGE]

The pictures go to images/patterns beside the page. It runs `palpa drive`, `field`, `scatter`, `touch` and `simulate`,
for about a minute. It needs no package of Python's.
"""
import argparse
import array
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

TOP = pathlib.Path(__file__).resolve().parents[2]
LAYOUT = ["--layout", "paper"]
PENETRATION_M = 0.003
PLANE_Y_M = -0.0008  # of the foci of a cross-section
SIDE_M, PIXELS = 0.1, 201
SHOWN_M = 0.04  # side of a picture
RING_M = 0.0045, 0.0065  # radii of the outline
AIM_M, SQUARE_M = 0.0055, 0.018  # radius of the circle that all but one aim at, and the side of that one's square
SCALE_M = 0.01
WHITE, RED = bytes([255] * 3), bytes([255, 40, 90])
LETTERS = {"1": "010 110 010 010 111", "0": "111 101 101 101 111", "m": "00000 11010 10101 10101 10101", " ": "0 0 0 0 0"}
SECTORS = 24
INSIDE_M, OUTSIDE_M = 0.002, 0.015
SECTION, NEXT_SECTION = "## Compared\n", "## How each is made\n"

LOUD = ["--constraint", "uniform"]

# Name of the picture or the pattern, text of the row, options of the paper's method.
ROWS = [("hoshi", "Hoshi: a picture in a plane", None), ("gavrilov", "Gavrilov: several foci", None),
        ("carter", "Carter: points of zero pressure", None), ("hasegawa", "Hasegawa: a distribution in space", None),
        ("inoue", "Inoue: a standing image", None), ("cross-section", "the paper: a focus that moves", LOUD),
        ("", "the same with the paper's amplitudes", [])]


class Palpa:
    def __init__(self, program, work):
        self.program, self.work = program, work

    def __call__(self, *arguments):
        line = [self.program, *map(str, arguments)]
        done = subprocess.run(line, capture_output=True, text=True)
        sys.stderr.write(done.stderr)
        if done.returncode != 0:
            sys.exit(f"{' '.join(line)} failed")
        return done.stdout

    def json(self, *arguments):
        return json.loads(self(*arguments, "--json", "-"))


def lowered(ply, metres):
    """A binary PLY of palpa's, whose vertices begin with x, y and z as floats, moved down."""
    head, mark, body = ply.partition(b"end_header\n")
    count = next(int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element vertex"))
    numbers = array.array("f", body[: 12 * count])
    for i in range(1, 3 * count, 3):
        numbers[i] -= metres
    return head + mark + numbers.tobytes() + body[12 * count:]


def intensity(palpa, drives):
    """The mean of |p|^2 over the drives, in Pa^2, at (x, z) in metres."""
    field = {}
    for drive in drives:
        plane = ["--plane", "xz", "--centre", f"0,{PLANE_Y_M},0", "--size", f"{SIDE_M},{SIDE_M}"]
        pixels = ["--pixels", f"{PIXELS},{PIXELS}"]
        rows = palpa("field", *LAYOUT, "--drive", drive, *plane, *pixels, "--csv", "-", "--quiet")
        for row in rows.splitlines()[1:]:
            x, _, z, real, imaginary = map(float, row.split(",")[:5])
            at = round(x, 7), round(z, 7)
            field[at] = field.get(at, 0) + (real * real + imaginary * imaginary) / len(drives)
    return field


def mean(values):
    return sum(values) / len(values)


def half_crossing(levels, peak, step):
    """From the peak of a profile, the number of bins up to half of it."""
    at = peak
    while 0 <= at + step < len(levels) and levels[at + step] > levels[peak] / 2:
        at += step
    after = at + step
    if not 0 <= after < len(levels):
        return abs(at - peak) + 0.5
    return abs(at - peak) + (levels[at] - levels[peak] / 2) / (levels[at] - levels[after])


def measures(field):
    """Width of the line in mm. In dB: outline over its inside, and relative to the outline its weakest sector and the
    loudest place elsewhere."""
    at_radius = {at: math.hypot(*at) for at in field}
    part = lambda low, high: [field[at] for at, radius in at_radius.items() if low <= radius <= high]
    outline = mean(part(*RING_M))
    step_m = SIDE_M / PIXELS
    bins = [[] for _ in range(int(OUTSIDE_M / step_m))]
    for at, radius in at_radius.items():
        if radius < step_m * len(bins):
            bins[int(radius / step_m)].append(field[at])
    profile = [mean(values) for values in bins]
    peak = profile.index(max(profile))
    width_m = step_m * (half_crossing(profile, peak, -1) + half_crossing(profile, peak, 1))
    sectors = [[] for _ in range(SECTORS)]
    for (x, z), radius in at_radius.items():
        if RING_M[0] <= radius <= RING_M[1]:
            sectors[int((math.atan2(z, x) / (2 * math.pi) + 1) * SECTORS) % SECTORS].append(field[x, z])
    decibels = lambda ratio: 10 * math.log10(ratio)
    return (width_m * 1e3, decibels(outline / mean(part(0, INSIDE_M))), decibels(min(map(mean, sectors)) / outline),
            decibels(max(part(OUTSIDE_M, SIDE_M)) / outline))


def colour(value):
    """0 is dark and 1 is light."""
    stops = [(0.05, 0.02, 0.12), (0.23, 0.20, 0.53), (0.13, 0.53, 0.55), (0.42, 0.79, 0.35), (1.0, 0.95, 0.55)]
    place = min(max(value, 0), 1) * (len(stops) - 1)
    low = min(int(place), len(stops) - 2)
    return bytes(round(255 * (a + (b - a) * (place - low))) for a, b in zip(stops[low], stops[low + 1]))


def outline(name):
    """What the pattern aims at: (x, z) in metres, in steps with gaps between them."""
    if name != "inoue":
        return [(AIM_M * math.cos(turn / 100), AIM_M * math.sin(turn / 100)) for turn in range(629) if turn // 13 % 2]
    half, steps = SQUARE_M / 2, [SQUARE_M * step / 200 for step in range(-100, 101) if step // 10 % 2]
    return [place for t in steps for place in ((t, -half), (t, half), (-half, t), (half, t))]


def words(text, left, top, size):
    """The pixels of a text in LETTERS."""
    for letter in text:
        lines = LETTERS[letter].split()
        for y, line in enumerate(lines):
            for x, dot in enumerate(line):
                if dot == "1":
                    yield from ((left + size * x + i, top + size * y + j) for i in range(size) for j in range(size))
        left += size * (len(lines[0]) + 1)


def draw(file, field):
    """|p|^2 from above, relative to its largest value, +x to the right and -z up, three pixels for each sample. With
    what it aims at, and a scale."""
    xs = sorted({x for x, _ in field if abs(x) <= SHOWN_M / 2})
    zs = sorted({z for _, z in field if abs(z) <= SHOWN_M / 2})
    loudest, zoom = max(field.values()), 3
    rows = [bytearray(b"".join(colour(field[x, z] / loudest) * zoom for x in xs)) for z in zs for _ in range(zoom)]
    pixel_m = (xs[-1] - xs[0]) / (len(xs) - 1) / zoom
    middle = zoom * len(xs) / 2
    marks = [(round(middle + x / pixel_m), round(middle + z / pixel_m), RED) for x, z in outline(file.stem)]
    length, low = round(SCALE_M / pixel_m), len(rows) - 12
    marks += [(10 + x, low + y, WHITE) for x in range(length) for y in range(3)]
    marks += [(x, y, WHITE) for x, y in words("10 mm", 10, low - 14, 2)]
    for x, y, ink in marks:
        rows[y][3 * x:3 * x + 3] = ink
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", len(xs) * zoom, len(rows), 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) +
                     chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 9)) + chunk(b"IEND", b""))


def pattern(palpa, name, finger):
    """Its force on the finger in N, and its drives."""
    drive = palpa.work / f"{name}.csv"
    palpa("drive", *LAYOUT, "--pattern", name, *LOUD, "--csv", drive, "--quiet")
    return palpa.json("scatter", "--mesh", finger, *LAYOUT, "--drive", drive)["force_N"], [drive]


def paper(palpa, skin, amplitudes):
    """The same of the paper's method, the mean over its schedule."""
    touch = ["--scene", TOP / "assets/cube.glb", "--penetration", f"{PENETRATION_M * 1e3:g}mm"]
    result = palpa.work / "touch.json"
    palpa("touch", *touch, "--points", skin, "--json", result, "--quiet")
    drives = []
    for slot in range(10):
        drives.append(palpa.work / f"slot{slot}.csv")
        palpa("drive", *LAYOUT, "--touch", result, "--slot", slot, *amplitudes, "--csv", drives[-1], "--quiet")
    return palpa.json("simulate", *touch, "--finger", skin, *amplitudes)["force_N"], drives


def section(palpa, pictures):
    """The section of the page. Writes the pictures."""
    skin, finger = TOP / "assets/finger.ply", palpa.work / "finger.ply"
    finger.write_bytes(lowered(skin.read_bytes(), PENETRATION_M))
    heads = ["", "force on the finger", "width of the line", "outline over its inside", "weakest part of the outline",
             "loudest elsewhere"]
    text = "| " + " | ".join(heads) + " |\n|" + "---|" * len(heads) + "\n"
    for name, title, amplitudes in ROWS:
        force, drives = pattern(palpa, name, finger) if amplitudes is None else paper(palpa, skin, amplitudes)
        field = intensity(palpa, drives)
        if name:
            draw(pictures / f"{name}.png", field)
        width, *decibels = measures(field)
        cells = [title, f"{math.hypot(*force) * 1e3:.1f} mN", f"{width:.1f} mm", *(f"{db:.1f} dB" for db in decibels)]
        text += f"| {' | '.join(cells)} |\n"
    shown = [(name, title) for name, title, _ in ROWS if name]
    text += "\n| " + " | ".join(title for _, title in shown) + " |\n|" + "---|" * len(shown) + "\n"
    return text + "| " + " | ".join(f"![{title}](images/patterns/{name}.png)" for name, title in shown) + " |\n"


def main():
    own = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    own.add_argument("--palpa", default=TOP / "build/release/bin/palpa", help="the program")
    own.add_argument("--page", type=pathlib.Path, default=TOP / "docs/patterns.md", help="the page")
    options = own.parse_args()
    page = options.page.read_text(encoding="utf-8")
    before, mark, after = page.partition(NEXT_SECTION)
    if not mark:
        sys.exit(f"{options.page}: has no line '{NEXT_SECTION.strip()}'")
    pictures = options.page.parent / "images/patterns"
    pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        new = section(Palpa(options.palpa, pathlib.Path(folder)), pictures)
    options.page.write_text(before.partition(SECTION)[0] + SECTION + "\n" + new + "\n" + mark + after, encoding="utf-8")


if __name__ == "__main__":
    main()
