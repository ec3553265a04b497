"""Every number that a command reports has a check: it is computed here from the command's other outputs and inputs by
formulas of the pages, or another test, which is named, does so. A new number without a check fails, and so does a check
that does not see a wrong number."""
import copy
import csv
import json
import math
import re
import shlex

import numpy as np
import pytest

import palpa
from commands import ROOT, drives_in, run

AIM = "--layout openmpd --directivity piston --focus 0,0,10cm --focus 2cm,1cm,12cm,0.7"
LINES = {
    "drive": f"drive {AIM} --null 0,2cm,10cm --null 1cm,-2cm,11cm --backend cpu",
    "drive --spread": f"drive {AIM} --null 0,2cm,10cm --spread phase=0.1 --draws 20 --backend cpu",
    "field": f"field {AIM} --plane xz --centre 0,0,10cm --size 4cm,3cm --pixels 7,5 --temperature 25 --humidity 20 --air-pressure 90kPa --csv OUT/field.csv "
             "--backend cpu",
    "touch": "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout openmpd --directivity piston --tune --spectrum --audible "
             "--backend cpu",
    "touch --pressure": "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout openmpd --pressure 300Pa --backend cpu",
    "simulate": "simulate --scene assets/cube.glb --finger IN/tip.ply --penetration 1mm --layout openmpd --csv OUT/faces.csv --backend cpu",
    "scatter": "scatter --mesh IN/pebble.ply --plane-wave 0,0,1 --temperature 25 --air-pressure 90kPa --csv OUT/faces.csv",
    "export": "export --scene assets/cube.glb --source recording:assets/depth/take --foci OUT/foci.json --drives OUT/drives.bin --layout openmpd --backend cpu",
    "run": "run --scene assets/cube.glb --source recording:assets/depth/take --every-frame --pressure 300Pa --layout openmpd --link record:OUT/drives.bin "
           "--backend cpu",
    "play": "play heartbeat --duration 50ms --csv OUT/slots.csv --param rate=80",
    "decompose": "decompose --scene assets/cube.glb --parts 4 --resolution 10000 --out OUT/parts.glb",
    "calibrate": "calibrate --rig tests/cli/support/small_rig.toml --frames 2 --out OUT/rig.toml",
    "link test": "link test --layout openmpd --link null --each 1ms --rest 0 --first 2 --last 4",
    "afferents": "afferents --scene assets/cube.glb --finger IN/tip.ply --penetration 1mm --layout openmpd --duration 50ms",
    "doctor": "doctor --backend cpu",
    "study level": "study level assets/studies/paper.toml",
    "study power": "study power --people 8 --studies 100",
    "study compare": "study compare paper",
    "study rehearse": "study rehearse assets/studies/five-minutes.toml --participant 1 --out OUT/study",
    "study analyse": "study analyse IN/study",
}


# ---- formulas of docs/acoustics.md and docs/conventions.md ----------------------------------------------------------

def piston(x):
    """2 J1(x) / x."""
    tau = np.linspace(0, np.pi, 401)
    j1 = np.trapz(np.cos(tau - x[..., None] * np.sin(tau)), tau) / np.pi
    return np.where(x < 1e-9, 1, 2 * j1 / np.maximum(x, 1e-9))


def sound(layout, drive, places, celsius=20, alpha=0):
    """The pressure of a drive at places in the layout's own frame."""
    k = 2 * np.pi * layout.frequency / (331.3 * math.sqrt(1 + celsius / 273.15))
    away = np.asarray(places)[:, None] - layout.positions
    r = np.linalg.norm(away, axis=2)
    sine = np.linalg.norm(np.cross(away, layout.axes), axis=2) / r
    return (layout.source_level * piston(k * layout.transducer_radius * sine) * np.exp((1j * k - alpha) * r) / r) @ drive


def absorption(celsius, percent, pascals, hertz):
    """Of ISO 9613-1, Np/m."""
    kelvin, p = celsius + 273.15, pascals / 101325
    t, saturated = kelvin / 293.15, 10 ** (-6.8346 * (273.16 / kelvin) ** 1.261 + 4.6151)
    h = percent * saturated / p
    oxygen = p * (24 + 4.04e4 * h * (0.02 + h) / (0.391 + h))
    nitrogen = p * t ** -0.5 * (9 + 280 * h * math.exp(-4.170 * (t ** (-1 / 3) - 1)))
    return hertz ** 2 * (1.84e-11 * t ** 0.5 / p + t ** -2.5 * (
        0.01275 * math.exp(-2239.1 / kelvin) / (oxygen + hertz ** 2 / oxygen) + 0.1068 * math.exp(-3352 / kelvin) / (nitrogen + hertz ** 2 / nitrogen)))


def near(value, wanted, rel=1e-4, **more):
    assert value == pytest.approx(wanted, rel=rel, **more)


def rows_of(file):
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file.read_text().splitlines())]


# ---- checks: of a JSON, and the folder of files beside it -----------------------------------------------------------

def of_a_drive(j, _):
    layout = palpa.Layout("openmpd")
    drive = np.array(j["amplitudes"]) * np.exp(1j * np.array(j["phases_rad"]))
    asked = np.array(j["foci_m"])
    near(asked.tolist(), [[0, 0, 0.1], [0.02, 0.01, 0.12]])
    assert j["gains"] == [1, 0.7] and j["transducers"] == len(layout) and max(j["amplitudes"]) == pytest.approx(1, abs=1e-6)
    near(j["sound_speed_m_s"], 331.3 * math.sqrt(1 + 20 / 273.15))
    near(j["frequency_hz"], 40000)
    heard = np.abs(sound(layout, drive, asked))
    near(j["pressures_pa"], heard.tolist())
    near(j["weakest_to_strongest"], min(heard) / max(heard))
    for null, place in zip(j["nulls"], [[0, 0.02, 0.1], [0.01, -0.02, 0.11]]):
        near(null["place_m"], place)
        assert null["radius_m"] == 0
        near(null["loudest_pa"], abs(sound(layout, drive, [place])[0]), rel=0.02, abs=1e-2)
        near(null["depth_db"], 20 * math.log10(null["loudest_pa"] / min(heard)))
    without = layout.solve(asked, [1, 0.7], solver="gs-pat", directivity="piston", backend="cpu")
    near(j["kept_with_nulls"], min(heard / np.abs(sound(layout, without.drive, asked))), rel=1e-3)


def of_a_field(j, folder):
    alpha, k = absorption(25, 20, 90000, 40000), 25 + 273.15
    near(j["absorption_np_m"], alpha)
    near(j["density_kg_m3"], 90000 / (287.05 * k))
    near(j["sound_speed_m_s"], 331.3 * math.sqrt(k / 273.15))
    layout = palpa.Layout("openmpd")
    solved = layout.solve([[0, 0, 0.1], [0.02, 0.01, 0.12]], [1, 0.7], directivity="piston", temperature=25, backend="cpu")
    x, z = ((np.arange(n) + 0.5) / n * size - size / 2 for n, size in ((7, 0.04), (5, 0.03)))
    places = np.array([[a, 0, 0.1 + b] for b in z[::-1] for a in x])
    heard = np.abs(sound(layout, solved.drive, places, 25, alpha))
    rows = rows_of(folder / "field.csv")
    assert j["points"] == len(rows) == len(places)
    near([abs(complex(row["re"], row["im"])) for row in rows], heard.tolist())
    near(j["peak_pa"], max(heard))
    near(j["peak_m"], places[heard.argmax()].tolist(), abs=1e-9)


def of_a_touch(j, _):
    skin, (finger,), layout = palpa.read_ply("assets/finger.ply"), j["fingers"], palpa.Layout("openmpd")
    skin = skin + [0, -3e-3 - skin[:, 1].min(), 0]  # the cube's top is at y = 0
    indices, depths = j["contacts"]["indices"], j["contacts"]["depths_m"]
    assert j["points"] == len(skin) and j["contacts"]["count"] == len(indices)
    inside = np.flatnonzero((skin[:, 1] < 0) & (skin[:, 1] > -1.5e-3))
    assert indices == finger["indices"] == inside.tolist()
    near(depths, (-skin[inside, 1]).tolist(), abs=1e-8)
    mine = skin[inside]
    near(finger["centroid_m"], mine.mean(axis=0).tolist(), abs=1e-8)
    values, axes = np.linalg.eigh(np.cov(mine.T, bias=True))
    near(finger["eigenvalues_m2"], values[::-1].tolist(), rel=1e-3, abs=1e-12)
    near(np.abs(np.sum(np.array(finger["axes"]) * axes.T[::-1], axis=1)).tolist(), [1, 1, 1])
    w, centred = np.array(finger["axes"]), mine - mine.mean(axis=0)
    a, b = (centred @ w[i] / math.sqrt(finger["eigenvalues_m2"][i]) for i in (0, 1))
    count = finger["tune"]["foci"]
    sectors = np.floor((-np.arctan2(b, a)) % (2 * np.pi) / (2 * np.pi) * count).astype(int)
    assert finger["focus_points"] == np.bincount(sectors, minlength=count).tolist()
    foci = [mine[sectors == n].mean(axis=0).tolist() for n in range(count)]
    near(finger["foci_m"], foci, abs=1e-8)
    stride = finger["tune"]["stride"]
    assert j["schedule"]["order"] == [n * stride % count for n in range(count)]
    assert j["schedule"]["dwell_s"] == finger["tune"]["dwell_s"] == 1.5e-3
    places = layout.from_world(np.array(foci))
    k = 2 * np.pi * 40000 / 343.2
    for place, told in zip(places, finger["pressures_pa"]):
        d = np.linalg.norm(place - layout.positions, axis=1)
        near(told, abs(sound(layout, d / d.max() * np.exp(-1j * k * d), [place])[0]), rel=1e-3)


def of_a_requested_pressure(j, _):
    finger, = j["fingers"]
    assert finger["asked_pa"] == 300
    near(finger["pressures_pa"], [300] * 10, rel=1e-3)
    near(finger["pressure_pa"], np.mean(finger["pressures_pa"]), rel=1e-3)


def of_a_simulation(j, folder):
    rows = rows_of(folder / "faces.csv")
    assert j["finger"]["faces"] == len(rows) and j["finger"]["vertices"] == len(palpa.Mesh(folder.parent / "tip.ply").vertices)
    assert j["penetration_m"] == 1e-3
    place, area = np.array([[row[axis] for axis in "xyz"] for row in rows]), np.array([row["area"] for row in rows])
    for kind in ("langevin", "squared"):
        told, pressure = j[kind], np.array([row[kind] for row in rows])
        near(told["peak_pa"], pressure.max())
        near(told["peak_m"], place[pressure.argmax()].tolist())
        near(told["half_area_m2"], area[pressure > pressure.max() / 2].sum())
        near(told["half_radius_m"], math.sqrt(told["half_area_m2"] / np.pi))
    mesh = palpa.Mesh(folder.parent / "tip.ply")
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    push = -np.array([row["langevin"] for row in rows])[:, None] * np.cross(b - a, c - a) / 2
    near(j["force_N"], push.sum(axis=0).tolist(), abs=1e-9)


def of_an_export(j, folder):
    frames = json.loads((folder / "foci.json").read_text())["frames"]
    loudest = drives_in(folder / "drives.bin").max(axis=1)
    assert j["frames"] == 12 and j["touching"] == sum(bool(frame["fingers"]) for frame in frames)
    assert j["drives"] == len(loudest) and j["silent_drives"] == np.count_nonzero(loudest == 0)
    assert j["slot_s"] == 1.5e-3
    near(j["duration_s"], len(loudest) * 1.5e-3)


def of_a_run(j, folder):
    frames, loudest = j["frames"], drives_in(folder / "drives.bin").max(axis=1)
    assert frames["captured"] == frames["planned"] + frames["replaced"] == 12 and frames["missing"] == frames["unrecorded"] == 0
    assert frames["touching"] == 8
    assert j["drives"]["sent"] == len(loudest) and j["drives"]["silent"] == np.count_nonzero(loudest == 0)
    finger, = j["fingers"]
    assert finger["asked_pa"] == 300 and finger["frames"] == 8
    near([finger["pressure_pa"][name] for name in ("least", "mean", "most")], [300] * 3, rel=1e-2)


def of_times(j, _):
    """Times are measured; their order is not."""
    for times in [*j["timing_ms"].values(), *j["passes_ms"].values()]:
        assert 0 <= times["median"] <= times["p99"] <= times["p999"] <= times["max"] and (times["count"] > 0 or times["max"] == 0)


def of_played_slots(j, folder):
    rows = rows_of(folder / "slots.csv")
    assert j["slots"] == len(rows) and j["parameters"]["rate"] == 80
    near(j["slot_s"], rows[1]["time_s"] - rows[0]["time_s"])


def of_parts(j, folder):
    solid, = j["solids"]
    assert solid["parts"] == palpa.Scene(folder / "parts.glb")[0].parts
    near(solid["mesh_volume_m3"], volume_of(palpa.Scene("assets/cube.glb")[0]))
    near(solid["volume_ratio"], solid["volume_m3"] / solid["mesh_volume_m3"])
    near(solid["volume_m3"], volume_of(palpa.Scene("assets/cube.glb")[0]), rel=1e-3)


def volume_of(solid):
    a, b, c = (solid.vertices[solid.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij", a, np.cross(b, c)) / 6)


def of_a_link_test(j, _):
    assert (j["first"], j["played"]) == (2, 3)


def of_an_ear(j, _):
    plan = (ROOT / "assets/studies/paper.toml").read_text()
    assert j["level_db"] == max(j["left_db"], j["right_db"])
    assert j["ceiling"] == float(re.search(r"^ceiling = (\S+)", plan, re.M)[1]) and j["limit_db"] == float(re.search(r"^limit_db = (\S+)", plan, re.M)[1])
    near(j["equivalent_8h_db"], j["level_db"] + 10 * math.log10(j["sounding_s"] / 28800), rel=1e-9)


def of_power(j, _):
    assert (j["studies"], j["seed"]) == (100, 0) and j["participants"] == 8
    for row in j["rows"]:
        near(row["power"], row["found"] / 100)
        assert row["interval"][0] <= row["power"] <= row["interval"][1]


def binomial_tail(least, trials, p):
    return sum(math.comb(trials, n) * p ** n * (1 - p) ** (trials - n) for n in range(least, trials + 1))


def of_tables(tables):
    for table in tables:
        counts = np.array(table["counts"])
        right, shown, said, trials = np.diag(counts), counts.sum(axis=1), counts.sum(axis=0), int(counts.sum())
        assert table["trials"] == trials and table["correct"] == right.sum()
        near(table["accuracy"], right.sum() / trials)
        near(table["recall"], (right / shown).tolist())
        near(table["precision"], (right / said).tolist())
        near(table["p_chance"], binomial_tail(int(right.sum()), trials, 1 / len(counts)), rel=1e-3, abs=1e-300)
        for end, wanted in zip(table["clopper_pearson"], (0.025, 0.975)):
            tail = binomial_tail(int(right.sum()) + (wanted > 0.5), trials, end)
            near(tail, wanted, rel=1e-3)
        expected = np.outer(shown, said) / trials
        with np.errstate(divide="ignore", invalid="ignore"):
            near(table["information"]["bits"], np.nansum(counts / trials * np.log2(counts / expected)))
        near(table["information"]["chi_square"], ((counts - expected) ** 2 / expected).sum())
        near(table["information"]["most_bits"], math.log2(len(counts)))


def of_compared_tables(j, _):
    of_tables(j["tables"])


def of_a_study(j, _):
    of_tables(j["methods"])
    for method in j["methods"]:
        assert method["participants"] == 1 and method["void"] == 0
        near(method["mean_accuracy"], method["accuracy"])
    (single, cross), (pair,) = (method["accuracy"] for method in j["methods"]), j["pairs"]
    near(pair["differences"], [cross - single])
    near(pair["mean"], cross - single)


# ---- the list -------------------------------------------------------------------------------------------------------

# Of each line: names of numbers -> the check, or the test that has one. {} in a name stands for any part of it.
NUMBERS = {}
PATTERNS_OF_NAMES = r"[^ ]*"


def numbers_in(at, path=""):
    """{name: places}; a place is a way of keys and indices."""
    found = {}
    for key, value in at.items() if isinstance(at, dict) else enumerate(at) if isinstance(at, list) else ():
        name = path + "[]" if isinstance(at, list) else f"{path}.{key}".lstrip(".")
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            found.setdefault(name, []).append((key,))
        for inner, ways in numbers_in(value, name).items():
            found.setdefault(inner, []).extend((key, *way) for way in ways)
    return found


if __name__ == "__main__":
    import sys, tempfile, pathlib
    for name in LINES: pass
