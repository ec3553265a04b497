"""Every public function and class with values that it cannot use: a palpa.Error or a TypeError, and never a crash."""
import gc
import inspect
import threading

import numpy as np
import pytest

import palpa
from commands import ROOT

ASSETS = ROOT / "assets"
CLASSES = [value for name in palpa.__all__ if inspect.isclass(value := getattr(palpa, name)) and not issubclass(value, Exception)]
# Texts with a zero character, half of a surrogate pair, and no bytes; numbers that are too large or not finite.
BAD = [None, True, -1, 2**70, 10**5000, 1.5, float("nan"), float("inf"), "", "a\0b", "\ud800", "\udcff", "é" * 3000, "no such thing", b"x", [], [None], {},
       object(), np.zeros(0), np.array(np.nan), np.zeros((2, 2, 2)), np.array([["a", "b", "c"]]), len]
WORST = [float("nan"), "a\0b", "\ud800", object(), 10**5000, [None], ""]


def tried(call, *arguments, **options):
    """Whether it works. What else than a palpa.Error or a TypeError it raises is a fault."""
    try:
        call(*arguments, **options)
    except palpa.Error as error:
        assert str(error) and "\n" not in str(error) and "\0" not in str(error)
        return False
    except (TypeError, KeyError, IndexError) as error:
        assert str(error) and (isinstance(error, TypeError) or call.__name__ == "set_pose")  # it names a solid
        return False
    return True


def members(cls):
    return [name for name in dir(cls) if not name.startswith("_")] + [
        name for name in ("__repr__", "__len__", "__getitem__", "__array__", "__enter__", "__exit__") if name in vars(cls)]


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_an_object_without_a_value_has_no_members(cls):
    """__new__ alone makes an object that pybind11 knows but that has no value."""
    empty = cls.__new__(cls)
    for name in members(cls):
        if isinstance(inspect.getattr_static(cls, name), staticmethod):
            continue
        arguments = {"__getitem__": (0,), "__exit__": (None, None, None)}.get(name, ())
        with pytest.raises(TypeError):
            member = getattr(empty, name)
            member(*arguments) if callable(member) else None
            pytest.fail(f"{cls.__name__}.{name} gave {member!r}")
    with pytest.raises(TypeError):
        repr(empty)
    del empty
    gc.collect()


def test_functions_and_texts_where_none_are_taken(cube, openmpd):
    for call in (lambda: palpa.export(cube, palpa.Recording("assets/depth/take"), solver=len), lambda: palpa.simulate(cube, "assets/finger.ply", method=len)):
        with pytest.raises(palpa.BadUsage, match="no function is taken here"):
            call()
    with pytest.raises(palpa.BadUsage, match="is no path") as caught:
        openmpd.solve_touch('{"fingers": []}' + 10000 * " ")
    assert len(str(caught.value)) < 200


def test_the_class_of_all_classes_makes_nothing():
    base = palpa.Layout.__mro__[-2]
    with pytest.raises(TypeError, match="cannot be made"):
        base()
    with pytest.raises(TypeError, match="cannot be made"):
        type("Own", (base,), {})()


def test_an_object_without_a_value_is_no_argument(cube, finger):
    for call in (lambda o: palpa.Session(o(palpa.Scene)), lambda o: palpa.decompose(o(palpa.Scene)), lambda o: palpa.export(cube, o(palpa.Recording)),
                 lambda o: palpa.scatter(o(palpa.Mesh), plane_wave=[0, 0, 1]), lambda o: palpa.FingerSound(o(palpa.Layout), "assets/finger.ply"),
                 lambda o: palpa.scatter("assets/finger.ply", layout=o(palpa.Layout), drive=np.ones(3)),
                 lambda o: palpa.simulate(cube, o(palpa.FingerBody)), lambda o: palpa.simulate(o(palpa.Scene), "assets/finger.ply"),
                 lambda o: cube.touch(o(palpa.Touch)), lambda o: palpa.Layout("openmpd").field(o(palpa.Drive), [0, 0, 0.1]),
                 lambda o: palpa.Layout("openmpd").field(np.ones(256), o(palpa.Places))):
        with pytest.raises((TypeError, palpa.BadUsage)):
            call(lambda cls: cls.__new__(cls))

    class Late(palpa.Scene):
        """Uses itself before it has a value."""

        def __init__(self):
            self.text = repr(self)

    with pytest.raises(TypeError):
        Late()


@pytest.fixture(scope="module")
def calls(cube, finger, openmpd, sphere, tmp_path_factory):
    """What to call, with arguments that work; the name under which its options are known."""
    folder = tmp_path_factory.mktemp("misuse")
    sphere(folder / "sphere.ply")
    camera, image = ASSETS / "depth/camera.toml", np.zeros((480, 848), np.uint16)
    touch = cube.touch(finger, penetration=3e-3, backend="cpu", spectrum=True, layout="openmpd")
    (folder / "touch.json").write_text(touch.json())
    palpa.export(ASSETS / "cube.glb", "recording:" + str(ASSETS / "depth/take"), foci=folder / "played.json", frames=3, backend="cpu")
    drive = openmpd.solve([0, 0, 0.15], backend="cpu")
    session = palpa.Session(cube, backend="cpu")
    session.touch(finger, 0.0)
    live = palpa.Session(cube, source="points", layout="openmpd", backend="cpu")
    ring, pattern = palpa.Sensation("circle"), (ASSETS / "sensations/circle.adaptics").read_text(encoding="utf-8")
    plan = folder / "plan.toml"
    plan.write_text('command = "drive"\n[options]\nfocus = "0,0,0.1"\nlayout = "openmpd"\n')
    palpa.sweep(plan, folder / "out", backend="cpu")
    (folder / "mesh.ply").write_bytes((folder / "sphere.ply").read_bytes())
    cpu = {"backend": "cpu"}
    return [
        (palpa.Scene, {"file": ASSETS / "cube.glb"}, "Scene"), (palpa.Mesh, {"source": ASSETS / "finger.ply"}, None),
        (palpa.Layout, {"source": "openmpd"}, None), (palpa.Scene, {"file": {"cube": (cube[0].vertices, cube[0].faces)}}, None),
        (palpa.Layout, {"source": (openmpd.positions, openmpd.axes), "name": "mine", "source_level": 4.0, "frequency": 4e4, "transducer_radius": 4e-3,
                        "pose": np.eye(4)}, None),
        (palpa.Camera, {"width": 64, "height": 48, "matrix": [[50, 0, 31.5], [0, 50, 23.5], [0, 0, 1]], "distortion": [0.0], "depth_unit": 1e-3,
                        "min_range": 0.1, "pose": np.eye(4), "name": "mine"}, None),
        (openmpd.from_world, {"points": finger, "pose": np.eye(4)}, None), (openmpd.solve_touch, {"touch": touch, **cpu}, None),
        (palpa.Recording, {"folder": ASSETS / "depth/take"}, None),
        (palpa.Recording(ASSETS / "depth/take").images, {"frame": 0}, None), (palpa.read_ply, {"file": ASSETS / "finger.ply"}, None),
        (palpa.asset, {"name": "cube.glb"}, None),
        (palpa.write_ply, {"file": folder / "w.ply", "points": finger, "faces": [[0, 1, 2]]}, None),
        (palpa.plane, {"plane": "xz", "centre": [0, 0, 0.1], "size": (0.1, 0.1), "pixels": (3, 3)}, None),
        (palpa.line, {"start": [0, 0, 0], "end": [0, 0, 1], "samples": 3}, None), (palpa.set_log_level, {"level": "quiet"}, None),
        (cube["cube"].depth, {"points": finger}, None), (cube.touch, {"skin": finger, "penetration": 3e-3, **cpu}, "Scene.touch"),
        (cube.touch, {"depth": image, "camera": camera, "rig": None, **cpu}, None),
        (palpa.Session, {"scene": cube, "camera": camera, "depth": True, **cpu}, None),
        (palpa.Session, {"scene": cube, "source": "points", "layout": "openmpd", **cpu}, "Session"),
        (session.touch, {"skin": finger, "time": 1.0, "depth": None}, None), (session.set_pose, {"solid": 0, "pose": np.eye(4)}, None),
        (session.set_aim, {"offset": [0, 0, 0]}, None), (live.set_gain, {"gain": 0.5}, None), (live.push_points, {"points": finger, "time": None}, None),
        (live.start, {"frames": 3, "on_frame": 3, "on_event": 3}, None), (session.start, {"frames": 3}, None), (session.run, {"frames": 3}, None),
        (openmpd.solve, {"foci": [0, 0, 0.15], "gains": 0.5, "finger": None, "force": False, **cpu}, "Layout.solve"),
        (openmpd.drive, {"foci": [0, 0, 0.15], "gains": [1.0], **cpu}, "Layout.drive"), (openmpd.transfer, {"points": [0, 0, 0.15]}, "Layout.transfer"),
        (openmpd.field, {"drive": drive, "where": [0, 0, 0.15], **cpu}, "Layout.field"), (openmpd.moved, {"pose": np.eye(4)}, None),
        (openmpd.solve_touch, {"touch": folder / "touch.json", "slot": 0, **cpu}, "Layout.solve_touch"),
        (openmpd.write_drive, {"file": folder / "d.csv", "drive": drive}, None), (openmpd.read_drive, {"file": folder / "d.csv"}, None),
        (palpa.scatter, {"mesh": folder / "sphere.ply", "layout": "openmpd", "drive": 3, "where": [0, 0, 1], "force": True}, "scatter"),
        (palpa.scatter, {"mesh": 3, "plane_wave": [0, 0, 1], "point_source": None}, None),
        (palpa.FingerBody, {"finger": 3, "force": True}, "FingerBody"), (palpa.FingerSound, {"layout": openmpd, "finger": 3, "force": False}, "FingerSound"),
        (palpa.simulate, {"scene": cube, "finger": 3, "penetration": 1e-3, "skin": "vertices", **cpu}, "simulate"),
        (palpa.figure6, {"finger": 3, "penetration": 1e-3, "skin": "vertices", **cpu}, "figure6"), (palpa.decompose, {"scene": 3}, "decompose"),
        (palpa.calibrate, {"source": "none", "frames": 1}, "calibrate"), (palpa.write_target, {"file": folder / "t.stl"}, "write_target"),
        (palpa.write_nudged_rig, {"file": folder / "nudged.toml", "offset": (1e-3, 0, 0)}, "write_nudged_rig"),
        (palpa.learn_background, {"out": folder / "rig.toml", "source": "none", "frames": 10}, "learn_background"), (palpa.export, {"scene": cube, "source": "none", **cpu}, "export"),
        (palpa.export_played, {"played": folder / "played.json", "drives": folder / "drives.bin"}, "export_played"),
        (palpa.sweep, {"plan": plan, "out": folder / "out", "shard": (0, 1), "workers": 1, "client": None, "gpu": None, "after": None, **cpu}, None),
        (palpa.Sensation, {"sensation": "circle"}, None), (ring.evaluate, {"times": [0, 1], "parameters": {"radius": 3}, "details": True, "seed": 0}, None),
        (ring.set_matrix, {"matrix": np.eye(4)}, None), (ring.set_pattern, {"text": pattern}, None), (ring.newest, {"most": 3}, None),
        (ring.start, {"time": 0.0, "delay": 0.0}, None), (ring.follow, {"on": True}, None),
        (palpa.gather, {"plan": plan, "out": folder / "out", "file": folder / "t.csv", "partial": False}, None),
    ]


def test_every_function_with_values_that_it_cannot_use(calls, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # some values are good names of files
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    refused = 0
    for call, good, options in calls:
        for name in good:
            if name == "backend":
                continue
            for bad in BAD:
                # A value of that name may be right for this function.
                refused += not tried(call, **(good | {name: bad}))
        for keyword, *_ in palpa._engine._options().get(options, []):
            for bad in WORST:
                refused += not tried(call, **(good | {keyword: bad}))
        refused += not tried(call, **good, **{"no such option": 3})
        refused += not tried(call, **good, **{"\ud800": 3})
    assert refused > 3000
    palpa.messages()


def constructible(cls):
    try:
        cls()
    except TypeError as error:
        return "No constructor" not in str(error)
    return True


def test_every_function_is_among_them(calls):
    """What is added must be tried, too."""
    known = {getattr(call, "__name__", "") for call, _, _ in calls}
    functions = {name for name in palpa.__all__ if callable(getattr(palpa, name)) and not inspect.isclass(getattr(palpa, name))}
    assert functions - known == {"messages"}
    assert {cls.__name__ for cls in CLASSES if constructible(cls)} <= known


def test_words_of_the_log():
    with pytest.raises(palpa.BadUsage, match="'loud' is no log level; the levels are quiet, error, warning, info, debug"):
        palpa.set_log_level("loud")


def test_names_that_are_not_utf8(cube, tmp_path):
    """A file may have any bytes as its name; Python has them as half surrogates."""
    odd = str(tmp_path / "caf\udce9.ply")
    palpa.write_ply(odd, [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert palpa.read_ply(odd).shape == (3, 3)
    assert "caf\udce9" in repr(palpa.Mesh(odd)) and "1 face>" in repr(palpa.Mesh(odd))
    assert len(cube.touch(odd, backend="cpu").contacts) == 0
    with pytest.raises(palpa.BadInput) as caught:
        palpa.Scene(odd + ".glb")
    assert caught.value.file == odd + ".glb"


@pytest.mark.parametrize("output", [{"link": "record:{}/drives.bin"}, {"record": "{}/take", "overwrite": True}, {"events": "{}/events.jsonl"}])
def test_two_sessions_do_not_write_one_file(cube, tmp_path, output):
    options = {key: value.format(tmp_path) if isinstance(value, str) else value for key, value in output.items()}

    def session():
        return palpa.Session(cube, source="synthetic", layout="openmpd", noise_free=True, backend="cpu", **options)

    seen = threading.Event()
    with session() as first:
        first.start(on_frame=lambda touch: seen.set())
        assert seen.wait(120)
        with pytest.raises(palpa.BadUsage, match="another palpa is writing this file"):
            session().run(frames=2)
        assert first.running
        first.stop()
        assert first.wait().frames > 0
    assert session().run(frames=2).frames == 2
