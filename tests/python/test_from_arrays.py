"""Scenes, layouts and cameras of arrays, and pickles."""
import binascii
import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import palpa
from commands import ROOT, TWIN, same_but_times


def same_touch(a, b):
    return np.array_equal(a.contacts.depths, b.contacts.depths) and np.array_equal(a.fingers[0].foci, b.fingers[0].foci)


def test_a_scene(cube, finger):
    solid = cube["cube"]
    expected = cube.touch(finger, penetration=3e-3, backend="cpu")
    for given in ((solid.vertices, solid.faces), palpa.Mesh((solid.vertices, solid.faces)), {"cube": (solid.vertices, solid.faces)}):
        scene = palpa.Scene(given)
        assert scene.source == "" and same_touch(scene.touch(finger, penetration=3e-3, backend="cpu"), expected)
        assert same_touch(pickle.loads(pickle.dumps(scene)).touch(finger, penetration=3e-3, backend="cpu"), expected)
    assert [one.name for one in scene] == ["cube"]
    stats = palpa.Session(scene, source="synthetic", layout="openmpd", noise_free=True, every_frame=True, backend="cpu").run(frames=12)
    assert stats.touching > 0
    exported = [palpa.export(one, "synthetic", frames=12, noise_free=True, layout="openmpd", backend="cpu").foci["x"] for one in (scene, cube)]
    assert len(exported[0]) > 0 and np.allclose(exported[0], exported[1], atol=1e-6)
    for bad, says in ((solid.vertices, "vertices, faces"), ((solid.vertices, solid.faces[1:]), "open"), ({3: (solid.vertices, solid.faces)}, "name")):
        with pytest.raises(palpa.Error, match=says):
            palpa.Scene(bad)


def test_a_layout(cube, finger, openmpd):
    made = palpa.Layout((openmpd.positions, openmpd.axes), name="mine")
    assert np.array_equal(made.drive([0, 0, 0.15], backend="cpu"), openmpd.drive([0, 0, 0.15], backend="cpu"))
    assert np.array_equal(made.default_pose, openmpd.default_pose)
    pressures = [cube.touch(finger, penetration=3e-3, layout=layout, backend="cpu").fingers[0].pressures for layout in (made, "openmpd")]
    assert np.allclose(*pressures)
    stats = palpa.Session(cube, source="synthetic", layout=palpa.Layout((openmpd.positions, openmpd.axes)), every_frame=True, backend="cpu").run(frames=3)
    assert stats.frames == 3
    for change, says in (({"axes": 2 * openmpd.axes}, "axis of transducer 0 has length 2"), ({"axes": openmpd.axes[1:]}, "255 for 256"),
                         ({"positions": openmpd.positions * 0}, "transducers 0 and 1"), ({"positions": openmpd.positions + 11}, "limit is 10 m"),
                         ({"frequency": 1.0}, "frequency is 1 Hz"), ({"source_level": -1}, "source level")):
        good = {"positions": openmpd.positions, "axes": openmpd.axes} | change
        with pytest.raises(palpa.BadUsage, match=says):
            palpa.Layout((good.pop("positions"), good.pop("axes")), **good)
    with pytest.raises(palpa.BadUsage, match="go with arrays"):
        palpa.Layout("openmpd", name="mine")


def test_a_camera(cube):
    """That of assets/depth/camera.toml."""
    image = "assets/depth/hand.png"
    from_file = cube.touch(depth=image, camera="assets/depth/camera.toml", backend="cpu")
    pose = [[1, 0, 0, 0], [0, -0.743294146, 0.668964732, -0.15], [0, -0.668964732, -0.743294146, 0.2], [0, 0, 0, 1]]
    camera = palpa.Camera(424, 240, [[400, 0, 211.5], [0, 400, 119.5], [0, 0, 1]], distortion=np.zeros(4), depth_unit=1e-4, pose=pose)
    for one in (camera, [camera], pickle.loads(pickle.dumps(camera))):
        assert same_but_times(cube.touch(depth=image, camera=one, backend="cpu").json()) == same_but_times(from_file.json())
    far = palpa.Camera(424, 240, [[400, 0, 211.5], [0, 400, 119.5], [0, 0, 1]], depth_unit=1e-4, min_range=1.0, pose=pose)
    for one in (far, pickle.loads(pickle.dumps(far)), copy.deepcopy(far)):
        assert len(cube.touch(depth=image, camera=one, backend="cpu").contacts) == 0
    session = palpa.Session(cube, depth=True, camera=camera, backend="cpu")
    assert len(session.touch(depth=[np.zeros(camera.shape, np.uint16)]).contacts) == 0 < len(from_file.contacts)
    # As other programs give them: with an axis of one channel, one array instead of a list, a stack.
    pixels = np.zeros(camera.shape, np.uint16)
    pixels[100:140, 180:240] = 3000
    seen = cube.touch(depth=pixels, camera=camera, backend="cpu").contacts.depths
    for same in (pixels[:, :, None], [pixels[:, :, None]], pixels[None]):
        assert np.array_equal(cube.touch(depth=same, camera=camera, backend="cpu").contacts.depths, seen)
        assert np.array_equal(session.touch(depth=same).contacts.depths, session.touch(depth=[pixels]).contacts.depths)
    for bad in ({"width": 0}, {"matrix": np.eye(4)}, {"matrix": [[500, 1, 3], [0, 500, 3], [0, 0, 1]]}, {"depth_unit": 2.0}, {"distortion": [-5.0]}):
        with pytest.raises(palpa.Error):
            palpa.Camera(**({"width": 848, "height": 480, "matrix": [[600, 0, 424], [0, 600, 240], [0, 0, 1]]} | bad))


def test_pickles(cube, finger, openmpd, sphere, tmp_path):
    sphere(tmp_path / "sphere.ply")
    touch = cube.touch(finger, penetration=3e-3, layout="openmpd", spectrum=True, tune=True, backend="cpu")
    drive = openmpd.solve([[0, 0, 0.15], [0.02, 0, 0.15]], spread="amplitude=10%", draws=20, backend="cpu")
    field = openmpd.field(drive, palpa.plane("xz", size=(0.1, 0.1), pixels=(4, 3)), backend="cpu")
    scattering = palpa.scatter(tmp_path / "sphere.ply", plane_wave=(0, 0, 1), where=[[0, 0, -0.05]])
    exported = palpa.export("assets/cube.glb", palpa.Recording("assets/depth/take"), backend="cpu")
    simulated = palpa.simulate(cube, tmp_path / "sphere.ply", penetration=1e-3, layout="openmpd", backend="cpu")
    assert simulated.centroids.of == simulated.vertices.of == "world" and type(scattering.centroids) is np.ndarray
    results = [touch, drive, field, scattering, exported, simulated]
    for one in results:
        data = pickle.dumps(one)
        again = pickle.loads(data)
        assert again.json() == one.json() and pickle.dumps(again) == data and copy.deepcopy(one).json() == one.json()
    assert np.array_equal(pickle.loads(pickle.dumps(field)).pressure, field.pressure)
    (one,) = pickle.loads(pickle.dumps(touch.fingers))
    assert np.array_equal(one.spectrum["amplitude"], touch.fingers[0].spectrum["amplitude"]) and one.tuned == touch.fingers[0].tuned
    assert np.array_equal(pickle.loads(pickle.dumps(touch.contacts)).positions, touch.contacts.positions)
    assert np.array_equal(pickle.loads(pickle.dumps(exported)).foci["x"], exported.foci["x"])
    recording = pickle.loads(pickle.dumps(palpa.Recording("assets/depth/take")))
    assert np.array_equal(recording.times, palpa.Recording("assets/depth/take").times)
    mesh = palpa.Mesh(tmp_path / "sphere.ply")
    assert np.array_equal(pickle.loads(pickle.dumps(mesh)).vertices, mesh.vertices)
    # An array knows its frame on the other side, too.
    for foci in (pickle.loads(pickle.dumps(one.foci)), pickle.loads(pickle.dumps(touch)).fingers[0].foci):
        with pytest.raises(palpa.BadUsage, match="in the world"):
            openmpd.solve(foci, backend="cpu")
    with pytest.raises(palpa.BadUsage, match="openmpd"):
        palpa.Layout(TWIN).field(pickle.loads(pickle.dumps(drive)), [0, 0, 0.1], backend="cpu")
    # Damage, such as an index beyond the vertices.
    name, data, checksum, frame = mesh.__reduce__()[1]
    with pytest.raises(palpa.BadUsage, match="cut off"):
        palpa._engine._restore(name, data[:-9], binascii.crc32(data[:-9]), frame)
    at = data.index(np.asarray(mesh.faces).astype("<u4").tobytes())
    with pytest.raises(palpa.BadUsage, match="damaged"):
        palpa._engine._restore(name, data[:at] + b"\0\x09\x3d\0" + data[at + 4:], checksum, frame)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_what_cannot_be_pickled_says_so(cube, protocol):
    for one in (cube["cube"], palpa.Session(cube, backend="cpu")):
        with pytest.raises(TypeError, match="cannot"):
            pickle.dumps(one, protocol)
    mesh = palpa.Mesh("assets/cube.glb")
    assert np.array_equal(pickle.loads(pickle.dumps(mesh, protocol)).vertices, mesh.vertices)


def test_another_process_works_with_them(tmp_path):
    """As multiprocessing and Dask do."""
    code = """
import multiprocessing, palpa
def pressed(args):
    scene, depth = args
    return scene.touch(palpa.read_ply("assets/finger.ply"), penetration=depth, backend="cpu")
if __name__ == "__main__":
    scene = palpa.Scene("assets/cube.glb")
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        print([len(touch.contacts) for touch in pool.map(pressed, [(scene, 1e-3), (scene, 3e-3)])])
"""
    (tmp_path / "pool.py").write_text(code)
    done = subprocess.run([sys.executable, tmp_path / "pool.py"], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    cube = palpa.Scene("assets/cube.glb")
    expected = [len(cube.touch(palpa.read_ply("assets/finger.ply"), penetration=depth, backend="cpu").contacts) for depth in (1e-3, 3e-3)]
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{expected}\n", "")
