"""Every number that a command reports has a check: it is computed here from the command's other outputs and inputs by
formulas of the pages, or another test, which is named, does so. A new number without a check fails, and so does a check
that does not see a wrong number."""
import copy
import csv
import fnmatch
import functools
import json
import math
import re
import shlex
import socket

import numpy as np
import pytest

import palpa
from commands import ROOT, drives_in, run
from numbers_said import check_text, rows_of

pytestmark = pytest.mark.times  # other tests run the same code under a sanitizer

AIM = "--layout openmpd --directivity piston --focus 0,0,10cm --focus 2cm,1cm,12cm,0.7"
SPREAD = "--spread phase=0.1 --draws 20 --backend cpu"
LINES = {
    "drive": f"drive {AIM} --null 0,2cm,10cm --null 0,4mm,10cm {SPREAD}",
    "field": f"field {AIM} --plane xz --centre 0,0,10cm --size 4cm,3cm --pixels 7,5 --temperature 25 --humidity 20 --air-pressure 90kPa --csv OUT/field.csv "
             f"{SPREAD}",
    "touch": "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout openmpd --directivity piston --tune --spectrum --audible "
             "--backend cpu",
    "touch --pressure": "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout openmpd --pressure 300Pa --backend cpu",
    "simulate": "simulate --scene assets/cube.glb --finger IN/tip.ply --penetration 1mm --layout openmpd --csv OUT/faces.csv "
                f"--spectrum --tune {SPREAD}",
    "scatter": "scatter --mesh IN/pebble.ply --plane-wave 0,0,1 --temperature 25 --air-pressure 90kPa --csv OUT/faces.csv",
    "export": "export --scene assets/cube.glb --source recording:assets/depth/take --foci OUT/foci.json --drives OUT/drives.bin --layout openmpd --backend cpu",
    "run": "run --scene assets/cube.glb --source recording:assets/depth/take --every-frame --pressure 300Pa --layout openmpd --link record:OUT/drives.bin "
           "--backend cpu",
    "play": "play heartbeat --duration 50ms --csv OUT/slots.csv --param rate=80",
    "decompose": "decompose --scene assets/cube.glb --parts 4 --resolution 10000 --out OUT/parts.glb",
    "calibrate": "calibrate --rig tests/cli/support/small_rig.toml --frames 2",
    "link test": "link test --layout openmpd --link null --each 1ms --rest 0 --first 2 --last 4",
    "afferents": "afferents --scene assets/cube.glb --finger IN/tip.ply --penetration 1mm --layout openmpd --duration 50ms",
    "doctor": "doctor --backend cpu",
    "study level": "study level assets/studies/paper.toml",
    "study power": "study power --people 8 --studies 100",
    "study compare": "study compare paper",
    "study rehearse": "study rehearse assets/studies/five-minutes.toml --participant 1 --out OUT/study",
    "study analyse": "study analyse IN/study",
}

# Whose numbers other tests check: they compute for seconds, or only measure.
WITHOUT = {"bench": "measures", "emulate": "has none", "study run": "opens windows", "study withdraw": "has none", "study plan": "study/test_order.cpp, cli/test_cli_study.cpp", "study simulate": "cli/test_cli_observer.cpp"}


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


def near(value, wanted, rel=1e-4, least=0):
    """Lists, too."""
    np.testing.assert_allclose(value, wanted, rtol=rel, atol=least)


# ---- checks: of a JSON, and the folder of files beside it -----------------------------------------------------------

def of_a_drive(j, _):
    layout = palpa.Layout("openmpd")
    drive = np.array(j["amplitudes"]) * np.exp(1j * np.array(j["phases_rad"]))
    asked = np.array(j["foci_m"])
    near(asked, [[0, 0, 0.1], [0.02, 0.01, 0.12]])
    assert j["gains"] == [1, 0.7] and j["transducers"] == len(layout)
    near(j["sound_speed_m_s"], 331.3 * math.sqrt(1 + 20 / 273.15))
    near(j["frequency_hz"], 40000)
    heard = np.abs(sound(layout, drive, asked))
    near(j["pressures_pa"], heard.tolist())
    asked_of = heard / [1, 0.7]
    near(j["weakest_to_strongest"], min(asked_of) / max(asked_of))
    for null, place in zip(j["nulls"], [[0, 0.02, 0.1], [0, 0.004, 0.1]]):
        near(null["place_m"], place)
        assert null["radius_m"] == 0
        near(null["loudest_pa"], abs(sound(layout, drive, [place])[0]), rel=0.02, least=1e-2)
        near(null["depth_db"], 20 * math.log10(null["loudest_pa"] / min(heard)))
    without = layout.solve(asked, [1, 0.7], solver="gs-pat", directivity="piston", backend="cpu")
    near(j["kept_with_nulls"], min(1, *(heard / np.abs(sound(layout, without.vector, asked)))), rel=1e-3)


def of_a_field(j, folder):
    alpha, k = absorption(25, 20, 90000, 40000), 25 + 273.15
    near(j["absorption_np_m"], alpha)
    near(j["density_kg_m3"], 90000 / (287.05 * k))
    near(j["sound_speed_m_s"], 331.3 * math.sqrt(k / 273.15))
    layout = palpa.Layout("openmpd")
    solved = layout.solve([[0, 0, 0.1], [0.02, 0.01, 0.12]], [1, 0.7], directivity="piston", temperature=25, backend="cpu")
    x, z = ((np.arange(n) + 0.5) / n * size - size / 2 for n, size in ((7, 0.04), (5, 0.03)))
    places = np.array([[a, 0, 0.1 + b] for b in z[::-1] for a in x])
    heard = np.abs(sound(layout, solved.vector, places, 25, alpha))
    rows = rows_of(folder / "field.csv")
    assert j["points"] == len(rows) == len(places)
    near([abs(complex(row["re"], row["im"])) for row in rows], heard.tolist())
    near(j["peak_pa"], max(heard))
    near(j["peak_m"], places[heard.argmax()].tolist(), least=1e-9)


def of_a_touch(j, _):
    skin, (finger,), layout = palpa.read_ply("assets/finger.ply"), j["fingers"], palpa.Layout("openmpd")
    skin = skin + [0, -3e-3 - skin[:, 1].min(), 0]  # the cube's top is at y = 0
    indices, depths = j["contacts"]["indices"], j["contacts"]["depths_m"]
    assert j["points"] == len(skin) and j["contacts"]["count"] == len(indices)
    inside = np.flatnonzero((skin[:, 1] < 0) & (skin[:, 1] > -1.5e-3))
    assert indices == finger["indices"] == inside.tolist()
    near(depths, (-skin[inside, 1]).tolist(), least=1e-8)
    mine = skin[inside]
    near(finger["centroid_m"], mine.mean(axis=0).tolist(), least=1e-8)
    values, axes = np.linalg.eigh(np.cov(mine.T, bias=True))
    near(finger["eigenvalues_m2"], values[::-1].tolist(), rel=1e-3, least=1e-12)
    near(np.abs(np.sum(np.array(finger["axes"]) * axes.T[::-1], axis=1)).tolist(), [1, 1, 1])
    w, centred = np.array(finger["axes"]), mine - mine.mean(axis=0)
    a, b = (centred @ w[i] / math.sqrt(finger["eigenvalues_m2"][i]) for i in (0, 1))
    count = finger["tune"]["foci"]
    sectors = np.floor((-np.arctan2(b, a)) % (2 * np.pi) / (2 * np.pi) * count).astype(int)
    assert finger["focus_points"] == np.bincount(sectors, minlength=count).tolist()
    foci = [mine[sectors == n].mean(axis=0).tolist() for n in range(count)]
    near(finger["foci_m"], foci, least=1e-8)
    stride = finger["tune"]["stride"]
    assert j["schedule"]["order"] == [n * stride % count for n in range(count)]
    assert j["schedule"]["dwell_s"] == finger["tune"]["dwell_s"] == 1.5e-3
    places = layout.from_world(np.array(foci))
    k = 2 * np.pi * 40000 / 343.2
    for place, told in zip(places, finger["pressures_pa"]):
        d = np.linalg.norm(place - layout.positions, axis=1)
        near(told, abs(sound(layout, np.exp(-1j * k * d), [place])[0]), rel=1e-3)
    near(finger["pressure_pa"], min(finger["pressures_pa"]))


def of_a_requested_pressure(j, _):
    finger, = j["fingers"]
    assert finger["asked_pa"] == 300
    near(finger["pressures_pa"], [300] * 10, rel=1e-3)
    near(finger["pressure_pa"], min(finger["pressures_pa"]))


def of_a_simulation(j, folder):
    rows = rows_of(folder / "faces.csv")
    mesh = palpa.Mesh(folder.parent / "tip.ply")
    assert j["finger"]["faces"] == len(rows) and j["finger"]["vertices"] == len(np.unique(mesh.vertices, axis=0))
    assert j["penetration_m"] == 1e-3
    place, area = np.array([[row[axis] for axis in "xyz"] for row in rows]), np.array([row["area"] for row in rows])
    for kind in ("langevin", "squared"):
        told, pressure = j[kind], np.array([row[kind] for row in rows])
        near(told["peak_pa"], pressure.max())
        near(told["peak_m"], place[pressure.argmax()].tolist())
        near(told["half_area_m2"], area[pressure > pressure.max() / 2].sum())
        near(told["half_radius_m"], math.sqrt(told["half_area_m2"] / np.pi))
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    out = np.cross(b - a, c - a)
    push = -np.array([row["langevin"] for row in rows])[:, None] * area[:, None] * out / np.linalg.norm(out, axis=1, keepdims=True)
    near(j["force_N"], push.sum(axis=0), rel=0.02, least=2e-8)
    near(j["force_far_N"], push.sum(axis=0), rel=0.02, least=2e-8)
    near(j["torque_Nm"], np.cross([0, 0.002, 0], j["force_N"]), rel=0.02, least=1e-13)  # of a sphere around this place


def of_an_export(j, folder):
    frames = json.loads((folder / "foci.json").read_text())["frames"]
    loudest = drives_in(folder / "drives.bin").max(axis=1)
    assert j["frames"] == 12 and j["touching"] == sum(bool(frame["fingers"]) for frame in frames)
    assert j["drives"] == len(loudest) - 1 and j["silent_drives"] == np.count_nonzero(loudest == 0) - 1  # without the last silence
    assert j["slot_s"] == 1.5e-3
    near(j["duration_s"], j["drives"] * 1.5e-3)


def of_a_run(j, folder):
    frames, loudest = j["frames"], drives_in(folder / "drives.bin").max(axis=1)
    assert frames["captured"] == frames["planned"] + frames["replaced"] == 12 and frames["missing"] == frames["unrecorded"] == 0
    assert frames["touching"] == 8
    assert j["drives"]["sent"] == len(loudest) - 1 and j["drives"]["silent"] == np.count_nonzero(loudest == 0) - 1
    sounding = j["hand_over"]["drives"]
    assert sounding["loop"] == j["drives"]["sent"] - j["drives"]["silent"] == sounding["played"] + sounding["lost"] and sounding["lost"] == 0
    finger, = j["fingers"]
    assert finger["id"] == 0 and finger["asked_pa"] == 300 and finger["frames"] == 8
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


def of_a_scattering(j, folder):
    assert j["faces"] == len(rows_of(folder / "faces.csv"))
    near(j["density_kg_m3"], 90000 / (287.05 * (25 + 273.15)))
    near(j["force_N"], j["force_far_N"], rel=0.05, least=0.01 * max(j["force_N"]))


def of_a_rehearsal(j, folder):
    assert (j["participant"], j["starts"], j["void"], j["stay_void"]) == (1, 1, 0, 0)
    assert j["complete"] == len((folder / "study/sub-01/sub-01_order.csv").read_text().splitlines()) - 1


def of_a_link_test(j, _):
    assert (j["first"], j["played"]) == (2, 3)


def of_an_ear(j, _):
    plan = (ROOT / "assets/studies/paper.toml").read_text()
    assert j["level_db"] == max(j["left_db"], j["right_db"])
    assert j["ceiling"] == float(re.search(r"^ceiling = (\S+)", plan, re.M)[1]) and j["limit_db"] == float(re.search(r"^limit_db = (\S+)", plan, re.M)[1])
    near(j["equivalent_8h_db"], j["level_db"] + 10 * math.log10(j["sounding_s"] / 28800), rel=1e-9)


def of_power(j, _):
    assert (j["studies"], j["seed"]) == (100, 0) and j["participants"] == min(row["participants"] for row in j["rows"] if row["power"] >= j["power"])
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
        near(table["p_chance"], binomial_tail(int(right.sum()), trials, 1 / len(counts)), rel=1e-3, least=1e-300)
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


def of_the_solved(j, _):
    """Foci times the board's 256 transducers stay below what two cores solve in each slot."""
    drives = j["drives"] if isinstance(j.get("drives"), dict) else j
    assert drives["solved_foci"] == 8192 // 256


# ---- the list -------------------------------------------------------------------------------------------------------

SKIN = " ".join(f"{kind}.{name}" for kind in ("langevin", "squared") for name in ("peak_pa", "peak_m", "half_area_m2", "half_radius_m"))
TABLES = "trials correct counts accuracy clopper_pearson p_chance recall precision information.bits information.chi_square information.most_bits"
# For each line: a check, or the file of the tests that check it, and names of numbers.
NUMBERS = {
    "drive": {of_a_drive: "transducers sound_speed_m_s frequency_hz foci_m gains pressures_pa weakest_to_strongest nulls.* kept_with_nulls amplitudes phases_rad",
              "setup/test_spread.cpp": "spread.*"},
    "field": {of_a_field: "points peak_pa peak_m sound_speed_m_s density_kg_m3 absorption_np_m", "setup/test_spread.cpp": "spread.*"},
    "touch": {of_a_touch: "points contacts.* fingers.indices fingers.centroid_m fingers.axes fingers.eigenvalues_m2 fingers.foci_m fingers.focus_points "
                          "fingers.pressure_pa fingers.pressures_pa fingers.tune.foci fingers.tune.stride fingers.tune.dwell_s schedule.*",
              "acoustics/test_tune.cpp": "fingers.tune.perimeter_m fingers.tune.*_share fingers.tune.*_before", "acoustics/test_spectrum.cpp": "fingers.spectrum.*",
              "acoustics/test_audible.cpp": "audible_dba", of_the_solved: "solved_foci"},
    "touch --pressure": {of_the_solved: "solved_foci", of_a_requested_pressure: "fingers.asked_pa fingers.pressure_pa fingers.pressures_pa"},
    "simulate": {of_the_solved: "solved_foci", of_a_simulation: f"finger.* penetration_m {SKIN} force_N force_far_N torque_Nm",
                 "cli/test_cli_touch.cpp": "foci_m", "acoustics/test_focus_shape.cpp": "langevin.elongation squared.elongation",
                 "setup/tasks/test_simulate_spread.cpp": "spread.*", "acoustics/test_tune.cpp": "fingers.tune.*", "acoustics/test_spectrum.cpp": "fingers.spectrum.*"},
    "scatter": {of_a_scattering: "faces density_kg_m3 force_N force_far_N", "cli/test_cli_scatter.cpp": "torque_Nm"},
    "export": {of_the_solved: "solved_foci", of_an_export: "frames touching drives silent_drives slot_s duration_s", "cli/test_cli_surroundings.cpp": "dropped.*"},
    "run": {of_the_solved: "drives.solved_foci", of_a_run: "frames.captured frames.planned frames.replaced frames.missing frames.unrecorded frames.touching drives.sent drives.silent hand_over.* fingers.*", of_times: "timing_ms.* passes_ms.*", "cli/test_cli_surroundings.cpp": "dropped.*",
            "acoustics/test_audible.cpp": "audible_dba", "session/test_loop.cpp": "frames.unplayed drives.skipped_slots"},
    "play": {of_played_slots: "slots slot_s parameters.rate", "sensation/test_read_pattern.cpp": "parameters.loop"},
    "decompose": {of_parts: "solids.parts solids.mesh_volume_m3 solids.volume_m3 solids.volume_ratio",
                  "geometry/test_decompose.cpp": "solids.surface_error_m.* solids.mesh_error_m.* solids.filled_cavities solids.internal_area"},
    "calibrate": {"cli/test_cli_calibrate.cpp": "frames T_world_target cameras.points cameras.rms_m cameras.p95_m cameras.hold cameras.agreement cameras.scale "
                                                "cameras.deviation_m cameras.deviation_rad cameras.moved_m cameras.turned_rad cameras.T_world_camera"},
    "link test": {of_a_link_test: "first played"},
    "afferents": {"cli/test_cli_observer.cpp": "factor crest_n wave_m_s afferents.* active.* bin_s spikes.* sites.*"},
    "doctor": {"cli/test_cli_doctor.cpp": "gpus.index"},
    "study level": {of_an_ear: "level_db ceiling limit_db equivalent_8h_db", "study/test_ear_level.cpp": "left_db right_db bound_db reflections_db sounding_s foci_m",
                    "acoustics/test_audible.cpp": "audible_dba"},
    "study power": {of_power: "studies seed participants rows.power rows.found", "study/test_power.cpp": "accuracies spread correlation trials alpha power other_* rows.*"},
    "study compare": {of_compared_tables: " ".join(f"tables.{name}" for name in TABLES.split()), "study/test_tables.cpp": "tables.* pairs.*"},
    "study rehearse": {of_a_rehearsal: "participant complete void stay_void starts"},
    "study analyse": {of_a_study: " ".join(f"methods.{name}" for name in TABLES.split()) + " methods.participants methods.void methods.mean_accuracy pairs.differences",
                      "study/test_analysis.cpp": "seed resamples least_trials methods.* pairs.* participants.* felt_nothing.*"},
}
# Measured; the same on the next line.
MEASURED = {"timing_ms.*", "seconds", "solids.seconds", "version"}


def numbers_in(at, name=""):
    """{name: places}; a place is a list of keys and indices."""
    found = {}
    for key, value in at.items() if isinstance(at, dict) else enumerate(at) if isinstance(at, list) else ():
        inner = name if isinstance(at, list) else f"{name}.{key}".lstrip(".")
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            found.setdefault(inner, []).append([key])
        for deeper, places in numbers_in(value, inner).items():
            found.setdefault(deeper, []).extend([key, *place] for place in places)
    return found


def has(names, number):
    return any(fnmatch.fnmatchcase(number, name) for name in names)


def falsified(told, places):
    """With another number at these places."""
    other = copy.deepcopy(told)
    for *way, last in places:
        at = functools.reduce(lambda inner, key: inner[key], way, other)
        at[last] = at[last] + 1 + at[last] // 10 if isinstance(at[last], int) else 1.1 * at[last] + 1e-6
    return other


@pytest.fixture(scope="module")
def inputs(tmp_path_factory, bodies):
    folder = tmp_path_factory.mktemp("numbers")
    bodies(folder)
    run(["study", "rehearse", "assets/studies/five-minutes.toml", "--participant", "1", "--out", str(folder / "study"), "--quiet"])
    return folder


@pytest.mark.parametrize("line", LINES)
def test_a_number_has_a_check(line, inputs):
    out = inputs / line.replace(" ", "_")
    out.mkdir()
    text = run([word.replace("OUT/", f"{out}/").replace("IN/", f"{inputs}/") for word in shlex.split(LINES[line])] + ["--json", str(out / "told.json")])
    told = json.loads((out / "told.json").read_text())
    check_text(line, told, text, out)
    numbers, checks = numbers_in(told), NUMBERS[line]
    listed = [name for names in [*checks.values(), *NUMBERS[line.partition(" --")[0]].values()] for name in names.split()] + sorted(MEASURED)
    assert [number for number in numbers if not has(listed, number)] == [], "a new number needs a check"
    assert [name for names in checks.values() for name in names.split() if not any(has([name], number) for number in numbers)] == [], "no such number"
    for check, names in checks.items():
        if isinstance(check, str):
            assert (ROOT / "tests" / check).exists()
            continue
        check(told, out)
        for number in [number for number in numbers if has(names.split(), number) and check is not of_times]:
            try:
                check(falsified(told, numbers[number]), out)
            except (AssertionError, IndexError, ValueError):
                continue
            raise AssertionError(f"the check of {number} does not see a wrong one")


def test_the_numbers_of_a_plan(tmp_path):
    """They stand in text only."""
    plan = "assets/studies/five-minutes.toml"
    text = run(["study", "plan", plan, "--csv", str(tmp_path / "order.csv")])
    steps = list(csv.DictReader((tmp_path / "order.csv").read_text().splitlines()))
    level = json.loads(run(["study", "level", plan, "--json", "-"]))
    blocks = [(int(times), float(each)) for times, each in re.findall(r"(\d+) x (\d+) s", text)]
    assert re.search(r"participant 1: (\d+) steps, (\d+) min of touch", text).groups() == (str(len(steps)), f"{sum(times * each for times, each in blocks) / 60:.0f}")
    assert sum(times for times, _ in blocks) == len(steps)
    found = re.search(r"at the ceiling (\S+): (\S+) dB predicted at the louder ear \(limit (\S+) dB\), a force of (\S+) mN", text)
    ceiling, heard, limit, force = map(float, found.groups())
    assert (ceiling, limit) == (level["ceiling"], level["limit_db"]) and heard == pytest.approx(level["level_db"], abs=0.06)
    wanted, needed, loud = map(float, re.search(r"the paper's force, (\S+) mN, needs a ceiling of about (\S+), (\S+) dB", text).groups())
    assert wanted == 16 and needed == pytest.approx(ceiling * math.sqrt(wanted / force), rel=0.02) and loud == pytest.approx(heard + 20 * math.log10(needed / ceiling), abs=0.6)
    (tmp_path / "plan.toml").write_text((ROOT / plan).read_text().replace("ceiling = 0.04", "ceiling = 0.12").replace("limit_db = 110", "limit_db = 150"))
    louder = float(re.search(r"a force of (\S+) mN", run(["study", "plan", str(tmp_path / "plan.toml")]))[1])
    assert louder == pytest.approx(9 * force, rel=0.07)  # both have two digits


def test_the_line_of_foci_has_the_pressure_under_the_ceiling(inputs):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(60)
        run(["run", *shlex.split(LINES["run"])[1:-4], "--ceiling", "0.3", "--hold", "1s", "--link", f"foci:udp:127.0.0.1:{receiver.getsockname()[1]}", "--backend", "cpu"])
        while not (told := json.loads(receiver.recv(65536)))["fingers"]:
            pass
    finger, = told["fingers"]
    near(finger["pressure_pa"], 0.3 * 300, rel=0.01)
    near(finger["gain"], 0.3)
    assert finger["dwell_s"] == 1.5e-3 and sorted(finger["order"]) == list(range(len(finger["foci_m"])))


def test_every_command_with_numbers_is_here():
    commands = re.findall(r"^  (\S+(?: \S+)?)  ", run(["--help"]).partition("Subcommands:\n")[2].partition("\n\n")[0], re.M)
    assert len(commands) > 20
    assert {command for command in commands if "--json" in run(["help", *command.split(), "all"])} - {line.partition(" test")[0] for line in LINES} == set(WITHOUT)
