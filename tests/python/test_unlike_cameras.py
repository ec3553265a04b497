"""A rig of three cameras of which everything differs: each camera's part of a result is what it gives alone, in every order
of the cameras, and what they give together does not depend on the order."""
import itertools
import json
import re

import numpy as np
import pytest

import palpa
from commands import ROOT, run, write_png

# Like the paper's three places, with other images, lenses and units.
CUBE = ROOT / "assets/cube.glb"
PAPER = re.findall(r"T_world_camera = (\[\[.*?\]\])", (ROOT / "assets/rigs/paper.toml").read_text(), re.S)
CAMERAS = {
    "wide": {"width": 200, "height": 150, "fx": 620.0, "fy": 600.0, "cx": 104.5, "cy": 70.5, "depth_unit_m": 0.0001, "min_range_m": 0.28, "rate_hz": 90.0,
             "distortion": [0.05, -0.1, 0.001, -0.002, 0.01], "roi": [30, 20, 76, 110], "T_world_camera": PAPER[0]},
    "fine": {"width": 168, "height": 176, "fx": 660.0, "fy": 680.0, "cx": 80.5, "cy": 90.0, "depth_unit_m": 0.00025, "min_range_m": 0.2, "rate_hz": 90.0,
             "distortion": [-0.08, 0.2, -0.002, 0.001, 0.0], "mask": "mask.png", "T_world_camera": PAPER[1]},
    "tall": {"width": 144, "height": 192, "fx": 580.0, "fy": 560.0, "cx": 75.0, "cy": 101.5, "depth_unit_m": 0.0004, "min_range_m": 0.1, "rate_hz": 90.0,
             "distortion": [0.03, 0.0, 0.0, 0.002, 0.0], "background": "background.png", "background_margin_m": 0.004, "T_world_camera": PAPER[2]}}
ORDERS = list(itertools.permutations(CAMERAS))
ARRAY = '\n[array]\nlayout = "openmpd"\nT_world_layout = [[1, 0, 0, 0], [0, 0, 1, -0.19], [0, -1, 0, 0], [0, 0, 0, 1]]\n'
SYNTHETIC = {"layout": "openmpd", "noise_free": True, "backend": "cpu"}


def written(value):
    return value if isinstance(value, str) and value[0] == "[" else json.dumps(value)


def rig_of(folder, order, **changes):
    """A rig with these cameras; `changes`: {camera: {key: value or None}}."""
    text = ""
    for name in order:
        keys = {key: value for key, value in ({"name": name} | CAMERAS[name] | changes.get(name, {})).items() if value is not None}
        text += "[[camera]]\n" + "".join(f"{key} = {written(value)}\n" for key, value in keys.items())
    file = folder / f"{'-'.join(order)}.toml"
    file.write_text(text + ARRAY)
    return file


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cameras")
    mask = np.full((176, 168), 255, np.uint8)
    mask[90:, :] = 0
    write_png(folder / "mask.png", mask)
    background = np.full((192, 144), 855, np.uint16)
    background[:, 75:] = 2000
    write_png(folder / "background.png", background)
    return folder


@pytest.fixture(scope="module")
def seen(folder):
    """{camera: what it sees of a finger, alone}."""
    images = {}
    for name in CAMERAS:
        recording = record(folder, (name,))
        images[name] = recording.images(len(recording) - 1)[0]
    return images


def record(folder, order, **changes):
    kept = folder / f"take-{'-'.join(order)}"
    palpa.Session(palpa.Scene(CUBE), source="synthetic", rig=rig_of(folder, order, **changes), record=kept, overwrite=True, every_frame=True,
                  **SYNTHETIC).run(frames=6)
    return palpa.Recording(kept)


def touch(folder, order, seen, **changes):
    return palpa.Scene(CUBE).touch(depth=[seen[name] for name in order], rig=rig_of(folder, order, **changes), min_points=1, backend="cpu")


def contacts_by_camera(touch, order):
    """{camera: its contacts' pixels and depths}."""
    ends = np.cumsum([0] + [CAMERAS[name]["width"] * CAMERAS[name]["height"] for name in order])
    indices, found = np.array(touch.contacts.indices), {}
    for name, first, end in zip(order, ends, ends[1:]):
        its = (indices >= first) & (indices < end)
        found[name] = (indices[its] - first).tolist(), np.array(touch.contacts.positions)[its].tolist(), np.array(touch.contacts.depths)[its].tolist()
    return found


def test_each_camera_records_what_it_sees_alone(folder, seen):
    for order in ORDERS[::2]:
        recording = record(folder, order)
        assert tuple(recording.cameras) == order
        for name, image in zip(order, recording.images(len(recording) - 1)):
            assert np.array_equal(image, seen[name])


def test_a_recording_has_the_fields_of_each_camera(folder):
    more = {name: {"rate_hz": 30.0 + number, "residual_m": 0.001 * number, "calibration": "device" if number == 2 else "file", "exposure_s": 0.001 * number,
                   "hardware_preset": number} for number, name in enumerate(CAMERAS, 1)}
    for order in ORDERS[::2]:
        record(folder, order, **more)
        kept = folder / f"take-{'-'.join(order)}"
        for name, table in zip(order, (kept / "recording.toml").read_text().split("[[camera]]")[1:]):
            fields = dict(re.findall(r"^(\w+) = (.*?)(?=^\w|^\[|\Z)", table, re.M | re.S))
            for key, value in (CAMERAS[name] | more[name]).items():
                told = fields.get(key, '"file"')
                if key in ("mask", "background"):
                    assert f"-{order.index(name)}.png" in told and (kept / json.loads(told)).exists()
                else:
                    assert json.loads(told) == json.loads(written(value)), key
        again = palpa.export(CUBE, f"recording:{kept}", layout="openmpd", backend="cpu").foci
        live = palpa.export(CUBE, "synthetic", frames=6, rig=rig_of(folder, order, **more), **SYNTHETIC).foci
        assert len(again["x"]) > 0 and np.allclose(again["x"], live["x"], atol=1e-9)


def test_contacts_of_each_camera_are_those_it_finds_alone(folder, seen):
    touched = {name: touch(folder, (name,), seen) for name in CAMERAS}
    alone = {name: contacts_by_camera(touched[name], (name,))[name] for name in CAMERAS}
    assert min(len(indices) for indices, _, _ in alone.values()) > 10
    for order in ORDERS:
        together = touch(folder, order, seen)
        assert contacts_by_camera(together, order) == alone and together.points == sum(one.points for one in touched.values())


CHANGES = {"fx": 700.0, "fy": 590.0, "cx": 90.0, "cy": 80.0, "depth_unit_m": 0.0002, "min_range_m": 0.5, "distortion": [0.1, 0, 0, 0, 0.1], "roi": [0, 0, 80, 100],
           "mask": None, "background": None, "background_margin_m": 0.0005, "T_world_camera": PAPER[0].replace("-0.1649", "-0.1659")}


@pytest.mark.parametrize("key", CHANGES)
def test_a_field_of_a_camera_changes_only_its_contacts(folder, seen, key):
    order = ORDERS[0]
    before = contacts_by_camera(touch(folder, order, seen), order)
    changed = 0
    for name in order:
        value = CHANGES[key]
        if value is None and key not in CAMERAS[name] or key == "background_margin_m" and key not in CAMERAS[name]:
            continue
        more = {"background_margin_m": None} if key == "background" else {}
        after = contacts_by_camera(touch(folder, order, seen, **{name: {key: value} | more}), order)
        assert {other for other in order if after[other] != before[other]} == {name}
        changed += 1
    assert changed > 0


def fingers_of(folder, order, **options):
    """What all cameras together find, frame by frame."""
    foci = palpa.export(CUBE, "synthetic", rig=rig_of(folder, order), **SYNTHETIC, **options).foci
    return {key: np.asarray(value) for key, value in foci.items()}


@pytest.mark.parametrize("options", [{"frames": 6}, {"frames": 12, "method": "single-focus", "predict_latency": "20ms"}], ids=str)
def test_foci_do_not_depend_on_the_order(folder, options):
    first = fingers_of(folder, ORDERS[0], **options)
    assert len(first["x"]) > 2
    for order in ORDERS[1:]:
        other = fingers_of(folder, order, **options)
        for key, value in first.items():
            if value.dtype.kind == "f":
                assert np.allclose(other[key], value, rtol=1e-4, atol=2e-6), (order, key)


def by_name(cameras):
    return {camera["name"]: camera for camera in cameras}


PLAIN = dict.fromkeys(("roi", "mask", "background", "background_margin_m"))
# Level, around the board with the target.
BESIDE = {name: f"[[{c}, 0, {s}, {-0.396 * s}], [0, -1, 0, -0.075], [{s}, 0, {-c}, {0.396 * c}], [0, 0, 0, 1]]"
          for name, c, s in (("wide", 0.707107, 0.707107), ("fine", -0.707107, -0.707107), ("tall", 0.6, 0.8))}


def beside(name):
    """Wide enough for the target, and with all of the image."""
    lens = {"width": 3 * CAMERAS[name]["width"], "height": 3 * CAMERAS[name]["height"], "fx": 0.8 * CAMERAS[name]["fx"], "fy": 0.8 * CAMERAS[name]["fy"]}
    return PLAIN | lens | {"cx": lens["width"] / 2 - 3.5, "cy": lens["height"] / 2 + 2.5, "T_world_camera": BESIDE[name],
                           "distortion": [value / 5 for value in CAMERAS[name]["distortion"]]}


# The noise of a camera depends on its number.
CALIBRATED = {"points": {"rtol": 0.05}, "rms_m": {"rtol": 0.2}, "p95_m": {"rtol": 0.2}, "hold": {"rtol": 0.05}, "scale": {"atol": 3e-3}, "T_world_camera": {"atol": 1e-3}}


def test_calibrations_of_cameras_are_those_they_have_alone(folder):
    def found(order):
        done = palpa.calibrate(rig=rig_of(folder, order, **{name: beside(name) for name in order}), frames=2)
        done.write_rig(folder / "calibrated.toml")
        cameras, tables = by_name(json.loads(done.json())["cameras"]), (folder / "calibrated.toml").read_text().split("[[camera]]")[1:]
        for (name, camera), table in zip(cameras.items(), tables):
            assert f'name = "{name}"' in table and f'residual_m = {camera["rms_m"]}' in table
            pose = json.loads(re.search(r"T_world_camera = (\[\[.*?\]\])", table, re.S)[1])
            assert np.allclose(pose, camera["T_world_camera"], atol=1e-12) and np.allclose(pose, json.loads(BESIDE[name]), atol=1e-3)
            assert camera["moved_m"] < 1e-3 and camera["turned_rad"] < 2e-3
        return cameras
    alone = {name: found((name,))[name] for name in CAMERAS}
    for order in (ORDERS[0], ORDERS[3]):
        together = found(order)
        assert tuple(together) == order
        for name, (key, near) in itertools.product(order, CALIBRATED.items()):
            assert np.allclose(together[name][key], alone[name][key], **{"rtol": 0, "atol": 0} | near), (order, name, key)


def test_backgrounds_of_cameras_are_those_they_learn_alone(folder):
    def learnt(order, out):
        learn = palpa.learn_background(folder / out, rig=rig_of(folder, order, **{name: PLAIN for name in order}),
                                       source="synthetic", frames=10)
        tables = dict(zip(order, (folder / out).read_text().split("[[camera]]")[1:]))
        files = {name: (folder / re.search(r'background = "(.*)"', table)[1]).read_bytes() for name, table in tables.items()}
        margins = {name: re.search(r"background_margin_m = (.*)", table)[1] for name, table in tables.items()}
        return by_name(learn.cameras), files, margins
    alone = {name: learnt((name,), f"{name}-alone.toml") for name in CAMERAS}
    for number, order in enumerate(ORDERS[::2]):
        told, files, margins = learnt(order, f"all-{number}.toml")
        for name in order:
            assert files[name] == alone[name][1][name] and margins[name] == alone[name][2][name]
            same = {key: value for key, value in told[name].items() if key != "file"}
            assert same == {key: value for key, value in alone[name][0][name].items() if key != "file"}


def test_the_doctor_says_of_each_camera_what_it_says_of_it_alone(folder):
    def told(order):
        rows = json.loads(run(["doctor", "--rig", str(rig_of(folder, order)), "--backend", "cpu", "--json", "-", "--quiet"]))["rig"]
        return {row.pop("name"): row for row in rows}
    alone = {name: told((name,))[name] for name in CAMERAS}
    first = told(ORDERS[0])
    for order in (ORDERS[0], ORDERS[3]):
        together = told(order)
        assert list(together)[:3] == list(order) and together.pop("all cameras together") == pytest.approx(first.get("all cameras together", {}), rel=1e-9)
        assert together == {name: pytest.approx(alone[name], rel=1e-9) for name in order}


def test_the_spread_of_a_rig_is_that_of_all_its_cameras(folder):
    residuals = dict(zip(CAMERAS, (0.001, 0.0005, 0.002)))
    def spread(position):
        return palpa.Layout("openmpd").solve([[0, 0, 0.1]], spread=f"position={position}", draws=20, backend="cpu").spread
    for order in ORDERS:
        assert spread(rig_of(folder, order, **{name: {"residual_m": residuals[name]} for name in order})) == spread(np.sqrt(np.mean(np.square(list(residuals.values())))))


TABLES = {"array": {"layout": '"sonicsurface"', "T_world_layout": "[[1, 0, 0, 0], [0, 0, 1, -0.15], [0, -1, 0, 0], [0, 0, 0, 1]]"},
          "screen": {"width_m": "0.4", "height_m": "0.3", "T_world_screen": "[[1, 0, 0, 0], [0, 1, 0, 0.01], [0, 0, 1, -0.05], [0, 0, 0, 1]]", "eye_m": "[0.1, 0.1, 0.6]"},
          "room": {"low_m": "[-0.1, -0.1, 0]", "high_m": "[0.1, 0.4, 0]"}, "joints": {"T_world_joints": "[[1, 0, 0, 0], [0, 1, 0, 0.1], [0, 0, 1, 0], [0, 0, 0, 1]]", "residual_m": "0.003"}}
ELSEWHERE = {"screen.eye_m": "viewer: test_viewpoint.cpp", "joints.T_world_joints": "a tracker: test_cli_tracker.cpp", "joints.residual_m": "told: test_cli_nudge.cpp"}


def test_every_key_of_a_rig_on_the_page_is_tried():
    block = re.search(r"```toml\n(\[\[camera\]\].*?)```", (ROOT / "docs/cameras.md").read_text(), re.S)[1]
    named, table = set(), ""
    for line in block.splitlines():
        table = found[1] if (found := re.match(r"\[+(\w+)\]+", line)) else table
        if key := re.match(r"(?:# )?(\w+) = ", line):
            named.add(f"{table}.{key[1]}" if table != "camera" else key[1])
    tried = {key for keys in CAMERAS.values() for key in keys} | set(CHANGES) | {"name", "residual_m", "calibration", "exposure_s", "hardware_preset"}
    assert named == tried | {f"{table}.{key}" for table, keys in TABLES.items() for key in keys}
