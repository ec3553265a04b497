"""Every column of every CSV that a command writes beside its JSON has the values of the JSON, or those that are computed here
from the module's arrays. A new column, and a new command with a CSV, needs an entry."""
import csv
import json
import re
import shlex

import numpy as np
import pytest

import palpa
from commands import run

AIM = "--layout openmpd --directivity piston --focus 0,0,10cm --focus 2cm,1cm,12cm,0.7 --backend cpu"
TIP = "--scene assets/cube.glb --finger IN/tip.ply --penetration 1mm --layout openmpd --backend cpu"
LINES = {
    "drive": f"drive {AIM} --csv OUT", "field": f"field {AIM} --plane xz --centre 0,0,10cm --size 4cm,3cm --pixels 7,5 --csv OUT",
    "touch": "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --backend cpu --csv OUT",
    "export": "export --scene assets/cube.glb --source recording:assets/depth/take --backend cpu --foci OUT", "play": "play heartbeat --duration 50ms --csv OUT",
    "simulate": f"simulate {TIP} --csv OUT", "scatter": "scatter --mesh IN/pebble.ply --plane-wave 0,0,1 --backend cpu --csv OUT",
    "afferents": f"afferents {TIP} --duration 50ms --csv OUT", "study power": "study power --people 8 --studies 100 --csv OUT", "study compare": "study compare paper --csv OUT",
    "study plan": "study plan assets/studies/five-minutes.toml --csv OUT"}
# Commands whose CSV other tests compare.
WITHOUT = {"bench": "measures", "study analyse": "study/test_reports.cpp", "study simulate": "cli/test_cli_observer.cpp"}


def xyz(points, names="xyz"):
    return dict(zip(names, np.asarray(points).T))


def of_a_drive(j, _):
    layout = palpa.Layout("openmpd")
    return {"index": range(256), **xyz(layout.positions), **dict(zip(("nx", "ny", "nz"), layout.axes.T)), "amplitude": j["amplitudes"], "phase": j["phases_rad"]}


def of_a_field(j, _):
    layout, places = palpa.Layout("openmpd"), palpa.plane("xz", centre=(0, 0, 0.1), size=(0.04, 0.03), pixels=(7, 5))
    options = {"directivity": "piston", "backend": "cpu"}
    heard = np.asarray(layout.field(layout.solve([[0, 0, 0.1], [0.02, 0.01, 0.12]], [1, 0.7], **options), places, **options).pressure)
    return {**xyz(places.points.reshape(-1, 3)), "re": heard.real.ravel(), "im": heard.imag.ravel()}


def of_a_touch(j, _):
    skin = palpa.read_ply("assets/finger.ply")[j["contacts"]["indices"]] - [0, 0.003, 0]
    return {"index": j["contacts"]["indices"], **xyz(skin), "depth": j["contacts"]["depths_m"], "finger": np.zeros(len(skin)), "solid": ["cube"] * len(skin)}


def of_an_export(_, folder):
    """The JSON of the same foci."""
    run([word.replace("OUT", str(folder / "foci.json")) for word in shlex.split(LINES["export"])])
    rows = [(frame["slot"], frame["time_s"], finger["id"], finger["solid"], number, *focus, finger["gain"]) for frame in json.loads((folder / "foci.json").read_text())["frames"]
            for finger in frame["fingers"] for number, focus in enumerate(finger["foci_m"])]
    return dict(zip(("slot", "time_s", "finger", "solid", "focus", "x", "y", "z", "gain"), zip(*rows)))


def of_played_slots(j, _):
    times = np.arange(j["slots"]) * j["slot_s"]
    places, gains = palpa.Sensation("heartbeat").evaluate(times)
    return {"time_s": times, **dict(zip(("x_m", "y_m", "z_m"), np.asarray(places).T)), "gain": np.asarray(gains)}


def of_faces(mesh):
    corners = [mesh.vertices[mesh.faces[:, i]] for i in range(3)]
    return {"face": range(len(mesh.faces)), **xyz(sum(corners) / 3), "area": np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]), axis=1) / 2}


def of_a_simulation(_, folder):
    mesh = palpa.Mesh(folder / "tip.ply")
    told = palpa.simulate(palpa.Scene("assets/cube.glb"), folder / "tip.ply", penetration=1e-3, layout="openmpd", backend="cpu")
    faces = of_faces(mesh)
    return faces | {"y": faces["y"] - 1e-3, "langevin": told.langevin, "squared": told.squared}


def of_a_scattering(_, folder):
    told = palpa.scatter(folder / "pebble.ply", plane_wave=(0, 0, 1))
    faces = of_faces(palpa.Mesh(folder / "pebble.ply"))
    return {key: faces[key] for key in ("face", *"xyz")} | {"re": told.pressure.real, "im": told.pressure.imag}


def of_afferents(j, _):
    sites = j["sites"]
    return {"site": range(len(sites)), **xyz([site["position_m"] for site in sites]), "area_cm2": [site["area_cm2"] for site in sites],
            **{f"{kind}_hz": [site["rates_hz"][kind] for site in sites] for kind in ("sa1", "ra", "pc")}}


def of_power(j, _):
    rows = j["rows"]
    return {**{key: [row[key] for row in rows] for key in ("participants", "found", "power")}, **dict(zip(("low", "high"), zip(*(row["interval"] for row in rows))))}


def of_compared_tables(j, _):
    tables = j["tables"]
    return {**{key: [table[key] for table in tables] for key in ("name", "trials", "correct", "accuracy")}, **dict(zip(("low", "high"), zip(*(table["clopper_pearson"] for table in tables)))),
            "dprime": [table["dprime"] for table in tables], "bits": [table["information"]["bits"] for table in tables]}


def of_a_plan(j, _):
    return {"step": range(1, len(j["steps"]) + 1), **{key: [step.get(key, "") for step in j["steps"]] for key in ("kind", "method", "shape")}}


COLUMNS = {"drive": of_a_drive, "field": of_a_field, "touch": of_a_touch, "export": of_an_export, "play": of_played_slots, "simulate": of_a_simulation, "scatter": of_a_scattering,
           "afferents": of_afferents, "study power": of_power, "study compare": of_compared_tables, "study plan": of_a_plan}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory, bodies):
    folder = tmp_path_factory.mktemp("columns")
    bodies(folder)
    return folder


def test_the_columns_of_spikes_over_time(inputs):
    told = json.loads(run([word.replace("--csv", "--times").replace("OUT", str(inputs / "times.csv")).replace("IN/", f"{inputs}/") for word in shlex.split(LINES["afferents"])]
                          + ["--json", "-"]))
    rows = list(csv.DictReader((inputs / "times.csv").read_text().splitlines()))
    assert list(rows[0]) == ["time_s", "sa1", "ra", "pc"] and len(rows) == len(told["spikes"])
    for number, (row, spikes) in enumerate(zip(rows, told["spikes"])):
        assert float(row["time_s"]) == pytest.approx(told["bin_s"] * (number + 0.5), abs=0.51 * told["bin_s"])
        assert [float(row[kind]) for kind in ("sa1", "ra", "pc")] == pytest.approx([spikes[kind] for kind in ("sa1", "ra", "pc")], rel=1e-5)


@pytest.mark.parametrize("line", LINES)
def test_a_column_is_known(line, inputs):
    file = inputs / f"{line.replace(' ', '-')}.csv"
    told = run([word.replace("OUT", str(file)).replace("IN/", f"{inputs}/") for word in shlex.split(LINES[line])] + ["--json", "-"])
    rows = list(csv.DictReader(file.read_text().splitlines()))
    expected = COLUMNS[line](json.loads(told), inputs)
    assert list(rows[0]) == list(expected), "a new column needs its values"
    for key, values in expected.items():
        given = [row[key] for row in rows]
        assert len(given) == len(values), key
        if not isinstance(values[0], str):
            scale = np.abs(np.asarray(values, float)).max()
            assert np.allclose(np.array(given, float), np.asarray(values, float), rtol=1e-5, atol=1e-5 * scale), key
        else:
            assert given == [str(value) for value in values], key


def test_every_command_with_a_csv_is_here():
    commands = re.findall(r"^  (\S+(?: \S+)?)  ", run(["--help"]).partition("Subcommands:\n")[2].partition("\n\n")[0], re.M)
    assert {command for command in commands if re.search(r"--csv |--foci FILE", run(["help", *command.split(), "all"]))} == set(LINES) | set(WITHOUT)
