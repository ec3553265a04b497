"""Four fingers on four solids of which everything differs: each finger feels what it feels on its solid alone, the order of the
solids makes no difference, each property changes what one finger feels, and copies of a mesh are as if each had its own."""
import itertools
import json
import re

import numpy as np
import pytest

import palpa
from commands import ROOT, write_png

pytestmark = pytest.mark.filterwarnings("ignore::palpa.PalpaWarning")
BOX = np.array(list(itertools.product((-0.02, 0.02), (-0.03, 0), (-0.02, 0.02))))
BOX_FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
RIDGE = np.where(BOX[:, 1:2] == 0, BOX * [0.5, 1, 1] - [0, 0.0005, 0], BOX)
DENTED = np.concatenate([BOX, [[0, -0.0006, 0]]])  # its top is a funnel
DENTED_FACES = [face for face in BOX_FACES if not set(face) <= {2, 3, 6, 7}] + [[2, 3, 8], [3, 7, 8], [7, 6, 8], [6, 2, 8]]
MESHES = {"box": (BOX, BOX_FACES), "ridge": (RIDGE, BOX_FACES), "dented": (DENTED, DENTED_FACES)}
# The mesh, its pose, and how it is felt.
SOLIDS = {
    "first": ("box", {"translation": [-0.09, 0, 0]}, {"delta_m": 0.002, "foci": 8, "intensity": 0.9, "press_depth_m": 0.0015, "click": True}),
    "second": ("ridge", {"translation": [-0.03, 0, 0.002], "rotation": [0, 0.2588190451, 0, 0.9659258263]},
               {"delta_m": 0.0016, "foci": 7, "stride": 3, "intensity": 0.7, "stiffness": [0.0005, 0.2, 0.002, 0.9]}),
    "third": ("dented", {"translation": [0.03, 0.0008, -0.001], "scale": [1.2, 1, -0.9]}, {"foci": 9, "press_depth_m": 0.001, "texture": [0.5, 0.3, 0.9], "grain_m": 0.003}),
    "fourth": ("box", {"translation": [0.09, 0.0002, 0], "rotation": [0, 0.1736481777, 0, 0.984807753], "scale": [0.8, 1, 1.3]},
               {"delta_m": 0.0012, "stride": 7, "intensity": 0.8, "texture": [1, 0, 0.4], "stiffness": [0, 0.5, 0.003, 1], "press_depth_m": 0.0018, "click": [0.04, 180]})}
# For each property: another value on each solid.
CHANGES = {"touchable": False, "delta_m": 0.0009, "foci": 5, "stride": 1, "dwell_s": 0.003, "intensity": 0.35, "pressure_pa": 400.0, "press_depth_m": 0.0005, "click": [0.05, 160],
           "stiffness": [0.001, 0.1], "texture": [0.2, 0.9, 0.1], "grain_m": 0.007}
ORDERS = [list(SOLIDS), list(SOLIDS)[::-1], ["third", "first", "fourth", "second"]]


def write_scene(file, order, shared=True, **changes):
    """glTF with these nodes in this order."""
    nodes, data, views, accessors, meshes, placed = [], b"", [], [], [], {}
    for name in order:
        mesh, pose, haptics = SOLIDS[name]
        if not shared or mesh not in placed:
            placed[mesh] = len(meshes)
            corners, faces = np.asarray(MESHES[mesh][0], "<f4"), np.asarray(MESHES[mesh][1], "<u2")
            for array, kind, one in ((corners, "VEC3", 5126), (faces, "SCALAR", 5123)):
                bounds = {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()} if kind == "VEC3" else {}
                accessors.append({"bufferView": len(views), "componentType": one, "type": kind, "count": len(array) if kind == "VEC3" else array.size} | bounds)
                views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
                data += array.tobytes() + b"\0" * (-array.nbytes % 4)
            meshes.append({"primitives": [{"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1}]})
        nodes.append({"name": name, "mesh": placed[mesh], "extras": {"palpa": haptics | changes.get(name, {})}} | pose)
    file.with_suffix(".bin").write_bytes(data)
    file.write_text(json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
                                "buffers": [{"uri": file.with_suffix(".bin").name, "byteLength": len(data)}], "bufferViews": views, "accessors": accessors}))
    return file


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A recording of four spheres that press down on the solids, from below: deeper and deeper, and away again."""
    folder = tmp_path_factory.mktemp("solids")
    u, v = np.meshgrid(np.arange(264), np.arange(56))
    ray = np.stack([(u - 131.5) / 400, (v - 27.5) / 400, np.ones(u.shape)], axis=-1)
    for frame, depth in enumerate(np.interp(np.arange(14), [0, 2, 9, 13], [-0.001, 0, 0.0028, -0.001])):
        nearest = np.zeros(u.shape)
        for number, (_, pose, _) in enumerate(SOLIDS.values()):
            x, y, z = pose["translation"]
            centre = np.array([x + 0.0004 * frame * (number % 2), -z, 0.35 + y + 0.008 - depth * (1 - 0.1 * number)])
            along, squared = ray @ centre, (ray * ray).sum(axis=-1)
            left = along ** 2 - squared * (centre @ centre - 0.008 ** 2)
            nearest = np.where(left > 0, (along - np.sqrt(np.maximum(left, 0))) / squared, nearest)
        write_png(folder / f"{frame}.png", np.round(nearest / 5e-5).astype(np.uint16))
    (folder / "recording.toml").write_text('[recording]\nfiles = ["%d.png"]\nrate_hz = 30\n' + CAMERA)
    (folder / "camera.toml").write_text(CAMERA)
    return folder


CAMERA = """[[camera]]
name = "below"
width = 264
height = 56
fx = 400
fy = 400
cx = 131.5
cy = 27.5
depth_unit_m = 5e-5
T_world_camera = [[1, 0, 0, 0], [0, 0, 1, -0.35], [0, -1, 0, 0], [0, 0, 0, 1]]
"""


class Exported:
    """What is felt of a scene: by the name of the solid, foci and events; and all drives."""

    def __init__(self, folder, order, **options):
        changes, shared = {name: options.pop(name) for name in SOLIDS if name in options}, options.pop("shared", True)
        scene = write_scene(folder / "scene.gltf", order, shared, **changes)
        palpa.export(scene, f"recording:{folder}", foci=folder / "foci.json", events=folder / "events.jsonl", drives=folder / "drives.bin", layout="openmpd", backend="cpu", **options)
        self.drives = np.frombuffer((folder / "drives.bin").read_bytes()[24:], np.dtype([("slot", "<u8"), ("drive", "<f4", (256, 2))]))["drive"]
        self.felt = {name: [] for name in SOLIDS}
        for number, frame in enumerate(json.loads((folder / "foci.json").read_text())["frames"]):
            for finger in frame["fingers"]:
                self.felt[finger["solid"]].append((number, {key: finger[key] for key in finger if key not in ("id", "solid")}))
        for event in map(json.loads, (folder / "events.jsonl").read_text().splitlines()):
            self.felt[event["solid"]].append((event["time_s"], {key: event[key] for key in event if key not in ("finger", "solid")}))

    def sound(self):
        return np.stack([self.drives[..., 0] * np.cos(self.drives[..., 1]), self.drives[..., 0] * np.sin(self.drives[..., 1])])


@pytest.fixture(scope="module")
def all_four(folder):
    return Exported(folder, ORDERS[0])


def test_each_is_touched_and_pressed(all_four):
    for name, (_, _, haptics) in SOLIDS.items():
        kinds = {one["event"] for _, one in all_four.felt[name] if "event" in one}
        assert kinds == {"touch", "move", "release"} | ({"press"} if "press_depth_m" in haptics else set())
    assert len({len(one["foci_m"]) for felt in all_four.felt.values() for _, one in felt if "foci_m" in one}) == 5  # that of a click, too


def test_each_finger_feels_what_it_feels_on_its_solid_alone(folder, all_four):
    for name in SOLIDS:
        assert Exported(folder, [name]).felt[name] == all_four.felt[name]


@pytest.mark.parametrize("options", [{}, {"method": "single-focus"}, {"method": "multi-focus"}, {"surface": "parts"}], ids=str)
def test_the_order_of_solids_makes_no_difference(folder, options):
    first, *others = (Exported(folder, order, **options) for order in ORDERS)
    assert all(first.felt.values())
    for other in others:
        assert other.felt == first.felt and np.allclose(other.sound(), first.sound(), atol=2e-4)


def test_copies_are_as_if_each_had_its_mesh(folder, all_four):
    own = Exported(folder, ORDERS[0], shared=False)
    assert own.felt == all_four.felt and np.array_equal(own.drives, all_four.drives)


def is_as(felt, before):
    """The same; a pressure beside other requests to 1 %."""
    def rest(all_of):
        return [(when, {key: value for key, value in one.items() if key != "pressure_pa"}) for when, one in all_of]
    return rest(felt) == rest(before) and [one.get("pressure_pa") for _, one in felt] == [one.get("pressure_pa") and pytest.approx(one["pressure_pa"], rel=0.01) for _, one in before]


@pytest.mark.parametrize("options", [{"tune": True}, {"spectrum": True, "method": "single-focus"}, {"pressure": 200, "solver": "gs-pat", "method": "multi-focus"}], ids=str)
def test_a_touch_tells_of_each_finger_what_it_tells_of_it_alone(folder, options):
    def told(order):
        touch = palpa.Scene(write_scene(folder / "scene.gltf", order)).touch(depth=folder / "8.png", camera=folder / "camera.toml", layout="openmpd", backend="cpu", **options)
        fingers = {finger["solid"]: finger for finger in json.loads(touch.json())["fingers"]}
        depths = {name: np.array(touch.contacts.depths)[np.array(touch.contacts.solids) == number].tolist() for number, name in enumerate(order)}
        return fingers, depths
    all_of, depths = told(ORDERS[0])
    for order in ORDERS[1:] + [[name] for name in SOLIDS]:
        fingers, its_depths = told(order)
        assert fingers.keys() == set(order) and its_depths == {name: depths[name] for name in order}
        for name, key in itertools.product(order, all_of[order[0]]):
            if len(order) == 1 and key.startswith("pressure") and "pressure" not in options:
                continue  # it has the whole array
            assert near(fingers[name].get(key), all_of[name].get(key)), (order, name, key)


def near(a, b):
    """To 1 %, as far as it is numbers."""
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(near(a[key], b[key]) for key in a)
    return np.allclose(a, b, rtol=0.01, atol=1e-9) if isinstance(a, (list, float)) and np.asarray(a).dtype.kind == "f" else a == b


def test_a_decomposition_cuts_each_solid_as_alone(folder):
    def cut(order):
        parts = palpa.decompose(write_scene(folder / "scene.gltf", order), parts=3, resolution=10000)
        parts.write(folder / "parts.glb")
        for one, told in zip(parts.solids, json.loads(parts.json(folder / "parts.glb"))["solids"]):
            errors = {f"{name}error_{which}": told[f"{key}_error_m"][which] for name, key in (("", "surface"), ("mesh_", "mesh")) for which in ("mean", "p95", "max")}
            same = {"solid": told["name"]} | {name: told[name] for name in ("volume_ratio", "filled_cavities", "seconds")}
            assert {name: one[name] for name in errors | same} == errors | same
            differ.append(len(set(errors.values())))
        return {one["solid"]: one | {"seconds": 0, "parts": [part.vertices.tolist() for part in one["parts"]]} for one in parts.solids}, {solid.name: solid.parts for solid in palpa.Scene(folder / "parts.glb")}
    differ = []
    alone = [cut([name]) for name in SOLIDS]
    assert max(differ) == 6, "no number of one solid is another's"
    for order in ORDERS:
        told, written = cut(order)
        assert list(told) == order and all(near(told[name], one[name]) and written[name] == kept[name] for name, (one, kept) in zip(SOLIDS, alone))


def test_a_pose_of_a_session_moves_its_solid_only(folder):
    for order in ORDERS:
        session = palpa.Session(palpa.Scene(write_scene(folder / "scene.gltf", order)), depth=True, camera=folder / "camera.toml", backend="cpu")
        image = palpa.Recording(folder).images(8)

        def contacts():
            found = session.touch(depth=image).contacts
            return {name: np.array(found.depths)[np.array(found.solids) == number] for number, name in enumerate(order)}
        before = contacts()
        for name in SOLIDS:
            for which in (name, order.index(name)):
                session.set_pose(which, [[1, 0, 0, 0], [0, 1, 0, -0.0003], [0, 0, 1, 0], [0, 0, 0, 1]])
                after = contacts()
                assert {other for other in SOLIDS if not np.array_equal(after[other], before[other])} == {name}
                session.set_pose(which, np.eye(4))


# What a property needs: on its solid, on all of them.
NEEDS = {"click": ({"press_depth_m": 0.001}, {}), "grain_m": ({"texture": [1, 0.5, 0.5]}, {}), "pressure_pa": ({}, {name: {"pressure_pa": 150.0 + 50 * number} for number, name in enumerate(SOLIDS)})}


@pytest.mark.parametrize("key, name", itertools.product(CHANGES, SOLIDS))
def test_a_property_changes_only_what_is_felt_of_its_solid(folder, all_four, key, name):
    own, everywhere = NEEDS.get(key, ({}, {}))
    base = everywhere | {name: {one: value for one, value in own.items() if one not in SOLIDS[name][2]} | everywhere.get(name, {})}
    before = Exported(folder, ORDERS[0], **base) if any(base.values()) else all_four
    after = Exported(folder, ORDERS[0], **(base | {name: base[name] | {key: CHANGES[key]}}))
    assert {other for other in SOLIDS if not is_as(after.felt[other], before.felt[other])} == {name}
    assert key == "press_depth_m" or after.drives.shape != before.drives.shape or not np.array_equal(after.drives, before.drives)
    if key == "touchable":
        assert not after.felt[name]


def test_every_property_of_the_page_is_here():
    rows = re.findall(r"^\| `palpa_(\w+)` \|", (ROOT / "docs/scenes.md").read_text(), re.M)
    assert len(rows) > 10 and set(rows) == set(CHANGES)
