"""The numbers that a command says to people: each stands in its JSON, or is computed here."""
import csv
import math
import re

import numpy as np

import palpa


def rows_of(file):
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file.read_text().splitlines())]


NUMBER = re.compile(r"(?<![\w.#/-])-?\d[\d,]*(?:\.\d+)?(?:e[+-]\d+)?(?![\w.]*[A-Za-z.-]\d)(?: ?(mm2|mm|ms|mN|kHz|%|degrees|min)(?!\w))?")
SCALES = {"mm2": 1e6, "mm": 1e3, "ms": 1e3, "mN": 1e3, "kHz": 1e-3, "%": 100, "degrees": 180 / math.pi, "min": 1 / 60}
# Times, constants of a model and of a sentence, and a formula's name.
SAID = re.compile(r"(?: in [\d.]+ s\b| \([\d.]+ m?s\)|[\d.]+ m beside the beam|\b9[05] %|4 rho c|\|p\|\^2|within 10 cm|for 8 hours|seed 0|as boards? \d|interval)")
# Numbers that stand in no JSON, by formula.
TEXT_ONLY = {
    "drive": lambda j, folder: [j["sound_speed_m_s"] / j["frequency_hz"]],
    "scatter": lambda j, folder: loudest_of_faces(folder),
    "play": lambda j, folder: [j["slots"] * j["slot_s"]],
    "link test": lambda j, folder: (palpa.Layout("openmpd").positions[2:5]).ravel().tolist() + [2, 3, 4],
    "afferents": lambda j, folder: [sum(one[kind] for one in j["spikes"]) / (len(j["spikes"]) * j["bin_s"]) for kind in ("sa1", "ra", "pc")],
    # The limits of the authorities, and 40 kHz and the years beside them; the level of reflections.
    "study level": lambda j, folder: [j["level_db"] + j["reflections_db"], 100, 110, 130, 115, 40, 1984, 2010],
    "study compare": lambda j, folder: shares_of(j["tables"]), "study analyse": lambda j, folder: shares_of(j["methods"]),
    "doctor": None,  # the names of libraries and devices
}


def loudest_of_faces(folder):
    rows = rows_of(folder / "faces.csv")
    loudest = max(rows, key=lambda row: math.hypot(row["re"], row["im"]))
    return [math.hypot(loudest["re"], loudest["im"]), loudest["x"], loudest["y"], loudest["z"]]


def shares_of(tables):
    return [share for table in tables for row in table["counts"] for share in (np.array(row) / sum(row)).tolist()]


def all_numbers(at):
    """Those of a JSON, and how long its lists are."""
    if isinstance(at, (dict, list)):
        yield len(at)
        for inner in at.values() if isinstance(at, dict) else at:
            yield from all_numbers(inner)
    elif isinstance(at, (int, float)) and not isinstance(at, bool):
        yield at


def strange_numbers(text, known):
    """Those that are no known one, to their last digit, in any unit that they may have."""
    strange, known = [], np.abs(np.array(known, float))
    for found in NUMBER.finditer(SAID.sub("", text)):
        number = found[0].split()[0].rstrip(",%").replace(",", "")
        digits, _, power = number.partition("e")
        step = 0.5001 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
        scales = {1, SCALES[found[1]]} if found[1] else {1, 1e3, 1e6, 100}
        if not any((np.abs(known * scale - abs(float(number))) <= step + 1e-9 * abs(float(number))).any() for scale in scales):
            strange.append(found[0])
    return strange


def check_text(line, told, text, folder):
    """Each number that the command says stands in its JSON, or is computed here."""
    more = TEXT_ONLY.get(line.partition(" --")[0], lambda j, folder: [])
    if more is None:
        return
    known = [*all_numbers(told), *more(told, folder)]
    text = text.replace(str(folder), "")
    assert strange_numbers(text, known) == [], text
    wrong = re.sub(r"\d\.\d{2,}", lambda found: f"{1.07 * float(found[0]) + 0.003:.{len(found[0]) - 2}f}", SAID.sub("", text))
    assert len(strange_numbers(wrong, known)) >= len(re.findall(r"\d\.\d{2,}", SAID.sub("", text))) // 5, "a wrong number is seen"
