"""The numbers that a command says to people: each stands in its JSON, or is computed here."""
import csv
import json
import math
import re
from types import SimpleNamespace

import numpy as np

import palpa


def rows_of(file):
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file.read_text().splitlines())]


NUMBER = re.compile(r"(?<![\w.#/-])-?\d[\d,]*(?:\.\d+)?(?:e[+-]\d+)?(?![\w.]*[A-Za-z.-]\d)(?: ?(mm2|mm|ms|mN|kHz|%|degrees|min)(?!\w))?")
SCALES = {"mm2": 1e6, "mm": 1e3, "ms": 1e3, "mN": 1e3, "kHz": 1e-3, "%": 100, "degrees": 180 / math.pi, "min": 1 / 60}
# Times, constants of a model and of a sentence, and a formula's name.
SAID = re.compile(r"(?: in [\d.]+ s\b| \([\d.]+ m?s\)|[\d.]+ m beside the beam|\b9[05] %|4 rho c|\|p\|\^2|10 dB either way|within 10 cm|for 8 hours|seed 0|as boards? \d|interval)")
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
# Which number is which, by the JSON j: {} are those of a formatted string.
SENTENCES = {
    "drive": ["{j.transducers} transducers, {j.frequency_hz / 1e3:g} kHz, sound at {j.sound_speed_m_s:.2f} m/s, wavelength {1e3 * j.sound_speed_m_s / j.frequency_hz:.3f} mm",
              "(0.00, 0.00, 100.00) mm: {j.pressures_pa[0]:.0f} Pa;", "(20.00, 10.00, 120.00) mm: {j.pressures_pa[1]:.0f} Pa;",
              "relative to what was asked: {j.weakest_to_strongest:.3f};", "amplitudes {min(j.amplitudes):.3f} to {max(j.amplitudes):.3f}",
              "(0.00, 20.00, 100.00) mm: at most {j.nulls[0].loudest_pa:.3g} Pa, {-j.nulls[0].depth_db:.0f} dB below", "of {j.spread.draws} random arrays (seed {j.spread.seed})"],
    "field": ["{j.points} points in", "at most {j.peak_pa:.0f} Pa, at ({1e3 * j.peak_m[0]:.2f}, {1e3 * j.peak_m[1]:.2f}, {1e3 * j.peak_m[2]:.2f}) mm",
              "air: {j.sound_speed_m_s:.2f} m/s, {j.density_kg_m3:.4f} kg/m3, absorbs {j.absorption_np_m:.4f} Np/m"],
    "touch": ["{j.points} skin points, {j.contacts.count} contacts, {len(j.fingers)} finger",
              "pressure at its foci: {min(j.fingers[0].pressures_pa):.0f} to {max(j.fingers[0].pressures_pa):.0f} Pa"],
    "simulate": [f"{name}: at most {{j.{key}.peak_pa:.1f}} Pa, at ({{1e3 * j.{key}.peak_m[0]:.2f}}, {{1e3 * j.{key}.peak_m[1]:.2f}}, {{1e3 * j.{key}.peak_m[2]:.2f}}) mm; above half of it "
                 f"{{1e6 * j.{key}.half_area_m2:.1f}} mm2, as a disc of radius {{1e3 * j.{key}.half_radius_m:.2f}} mm, elongation {{j.{key}.elongation:.2f}}"
                 for name, key in (("radiation pressure", "langevin"), ("|p|^2 / (4 rho c^2)", "squared"))]
                + ["stride {j.fingers[0].tune.stride} and {1e3 * j.fingers[0].tune.dwell_s:g} ms, of the sound on the finger: {100 * j.fingers[0].tune.felt_share:.0f} % felt as vibration, "
                   "{100 * j.fingers[0].tune.flutter_share:.0f} % as flutter", "perimeter {1e3 * j.fingers[0].spectrum.perimeter_m:.1f} mm"],
    "export": ["{j.frames} frames, {j.touching} with a touch; {j.drives} drives of {1e3 * j.slot_s:g} ms, {j.silent_drives} of them silent"],
    "run": ["{j.frames.captured} frames, {j.frames.touching} with a touch, {j.frames.replaced} left out",
            "median {j.timing_ms.frame_to_plan.median:.2f} ms, p99 {j.timing_ms.frame_to_plan.p99:.2f} ms; {j.drives.sent} drives, {j.drives.silent} of them silent, {j.drives.skipped_slots} slots"],
    "decompose": ["{j.solids[0].volume_ratio:.3f} of its volume"] + [
        f"{name}: mean {{1e3 * j.solids[0].{key}_error_m.mean:.3g}}, p95 {{1e3 * j.solids[0].{key}_error_m.p95:.3g}}, max {{1e3 * j.solids[0].{key}_error_m.max:.3g}} mm"
        for name, key in (("from the parts' surface to the mesh", "surface"), ("from the mesh to the parts' surface", "mesh"))],
    "calibrate": ["{j.cameras[0].name}: {1e3 * j.cameras[0].rms_m:.2f} mm rms, {1e3 * j.cameras[0].p95_m:.2f} mm at 95 %, {j.cameras[0].points} points; moved by "
                  "{1e3 * j.cameras[0].moved_m:.1f} mm and {math.degrees(j.cameras[0].turned_rad):.2f} degrees"],
    "afferents": ["level {j.factor:.1f} of the linear pressures, crest of the force {1e3 * j.crest_n:.1f} mN"]
                 + [f"{name}: {{j.afferents.{key}:.0f}} afferents, {{100 * j.active.{key}:.0f}} % fire" for name, key in (("SA1", "sa1"), ("RA ", "ra"), ("PC ", "pc"))],
    "study level": ["left {j.left_db:.1f}, right {j.right_db:.1f}\n", "take away {j.reflections_db:.0f} dB: up to {j.level_db + j.reflections_db:.1f} dB", "at the ceiling {j.ceiling}\n",
                    "no drive is louder than {j.bound_db:.1f} dB", "sounds for {j.sounding_s / 60:.3g} min: {j.equivalent_8h_db:.1f} dB", "{j.limit_db:.1f} dB  this plan's"],
    "study rehearse": ["participant {j.participant}: {j.complete} steps complete, {j.void} void, {j.starts} start;"],
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
    by_name = {"j": json.loads(json.dumps(told), object_hook=lambda at: SimpleNamespace(**at)), "math": math}
    for sentence in SENTENCES.get(line.partition(" --")[0], []):
        assert eval("f" + repr(sentence), by_name) in text, text
    text = text.replace(str(folder), "")
    assert strange_numbers(text, known) == [], text
    wrong = re.sub(r"\d\.\d{2,}", lambda found: f"{1.07 * float(found[0]) + 0.003:.{len(found[0]) - 2}f}", SAID.sub("", text))
    assert len(strange_numbers(wrong, known)) >= len(re.findall(r"\d\.\d{2,}", SAID.sub("", text))) // 5, "a wrong number is seen"
