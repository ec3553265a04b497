"""Sessions, frame by frame and live."""
import gc
import re
import subprocess
import sys
import threading
import warnings
import weakref

import numpy as np
import pytest

import palpa
from commands import ROOT, begins, drives_in, in_threads, newest_in, run


def pressed(skin, depth):
    """The skin with its lowest point `depth` below y = 0."""
    return skin + [0, -depth - skin[:, 1].min(), 0]


def test_frame_by_frame(cube, finger):
    session = palpa.Session(cube, backend="cpu", layout="openmpd")
    kinds = []
    for n, depth in enumerate([-1e-3, 1e-3, 2e-3, 2e-3, -1e-3]):
        touch = session.touch(pressed(finger, depth), n / 90)
        kinds += [event.kind for event in session.events]
        if depth > 0:
            assert [one.id for one in touch.fingers] == [0] and touch.time == n / 90
            assert session.drives.shape[1] == 256 and 0 < np.abs(session.drives).max() <= 1 + 1e-12
        else:
            assert touch.fingers == []
    assert kinds[0] == "touch" and "move" in kinds
    assert kinds[-1] == "release" or [event.kind for event in session.end()] == ["release"]


def test_a_solid_moves(cube, finger):
    session = palpa.Session(cube, backend="cpu")
    skin = pressed(finger, 1e-3)
    before = session.touch(skin, 0).contacts.depths.max()
    lower = np.eye(4)
    lower[1, 3] = -2e-3
    session.set_pose("cube", lower)
    assert len(session.touch(skin, 0.01).contacts) == 0
    session.set_pose(0, np.eye(4))
    assert session.touch(skin, 0.02).contacts.depths.max() == pytest.approx(before, abs=1e-6)
    for pose in (2 * np.eye(4), np.eye(3)):
        with pytest.raises(palpa.BadUsage):
            session.set_pose(0, pose)
    with pytest.raises(KeyError):
        session.set_pose("sphere", np.eye(4))


def test_misuse(cube, finger):
    session = palpa.Session(cube, backend="cpu")
    for call in (lambda: session.touch(finger, np.nan), lambda: session.touch(), lambda: session.touch(depth=[]), lambda: session.run(),
                 lambda: session.wait(), lambda: session.set_gain(1), lambda: palpa.Session(cube, link="null:x", backend="cpu"),
                 lambda: palpa.Session(cube, record="take", backend="cpu"), lambda: palpa.Session(cube, source="synthetic", depth=True),
                 lambda: palpa.Session(cube, frames=3)):
        with pytest.raises(palpa.BadUsage):
            call()


def cross(finger):
    """Four foci around the centroid, along the axes of the cross-section."""
    arms = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]) @ finger.axes
    return finger.centroid + 4e-3 * arms


def test_a_method_of_ones_own(cube, finger):
    session = palpa.Session(cube, method=cross, layout="openmpd", backend="cpu")
    (one,) = session.touch(pressed(finger, 2e-3)).fingers
    assert np.allclose(one.foci, cross(one), atol=1e-7) and np.allclose(one.played_foci, one.foci)
    assert one.positions.shape == (len(one.contacts), 3) and np.allclose(one.positions.mean(axis=0), one.centroid, atol=1e-6)
    assert sorted(one.order.tolist()) == [0, 1, 2, 3] and session.drives.shape == (4, 256)
    moved = []
    live(cube, method=cross).run(frames=8, on_frame=lambda touch: moved.extend(len(finger.foci) for finger in touch.fingers))
    assert set(moved) == {4}


@pytest.mark.parametrize("method, kind, says", [
    (lambda finger: np.zeros((0, 3)), palpa.BadUsage, "0 foci"), (lambda finger: np.zeros((65, 3)), palpa.BadUsage, "65 foci"),
    (lambda finger: np.full((2, 3), np.nan), palpa.BadUsage, "not finite"), (lambda finger: [[0, 0, 200.0]], palpa.BadUsage, "100 m"),
    (lambda finger: "ring", palpa.BadUsage, "method"), (lambda finger: finger.nothing, AttributeError, "nothing"),
])
def test_what_a_method_returns_is_checked(cube, finger, method, kind, says):
    session = palpa.Session(cube, method=method, backend="cpu")
    for _ in range(2):  # the session goes on
        with pytest.raises(kind, match=says):
            session.touch(pressed(finger, 2e-3))
    with pytest.raises(kind, match=says):
        live(cube, method=method).run(frames=8)


def focusing(transfer, gains):
    """All transducers in full, in phase at the foci on the whole."""
    drive = np.conj(transfer.T @ gains)
    return drive / np.maximum(np.abs(drive), 1e-12)


def test_a_solver_of_ones_own(cube, finger, openmpd):
    foci = [[0, 0, 0.15], [0.02, 0, 0.15]]
    own = openmpd.solve(foci, [1, 0.5], solver=focusing)
    assert np.allclose(own.vector, focusing(openmpd.transfer(foci), np.array([1, 0.5])), atol=1e-6)
    assert np.allclose(own.pressures, np.abs(openmpd.transfer(foci) @ own.vector), rtol=1e-4)
    session = palpa.Session(cube, solver=focusing, layout="openmpd", backend="cpu")
    session.touch(pressed(finger, 2e-3))
    assert session.drives.shape == (10, 256) and np.allclose(np.abs(session.drives), 1, atol=1e-6)
    for solver, says in ((lambda g, a: np.ones(3), "shape"), (lambda g, a: 2 * np.ones(256), "amplitude 2"), (lambda g, a: np.full(256, np.nan), "nan")):
        with pytest.raises(palpa.BadUsage, match=says):
            openmpd.solve(foci, solver=solver)
    with pytest.raises(ZeroDivisionError):
        openmpd.drive(foci, solver=lambda g, a: 1 / 0)
    with pytest.raises(palpa.BadUsage, match="layout"):
        palpa.Session(cube, solver=focusing, backend="cpu")
    for idle in ({"amplitude": "uniform"}, {"constraint": "clamp"}, {"pressure": 1e3}):
        with pytest.raises(palpa.BadUsage, match="no effect"):
            palpa.Session(cube, solver=focusing, layout="openmpd", backend="cpu", **idle)


@pytest.mark.parametrize("backend", ["cpu", pytest.param("gpu", marks=pytest.mark.slow)])
def test_a_live_solver_of_ones_own(cube, tmp_path, backend):
    """What the link gets is what the function returns; a fifth of the full amplitude is not one of palpa's own drives."""
    shapes, file = set(), tmp_path / "drives.bin"

    def soft(transfer, gains):
        shapes.add((transfer.shape, gains.shape))
        return 0.2 * focusing(transfer, gains)

    live(cube, solver=soft, link=f"record:{file}", noise_free=True, hold=1, backend=backend).run(frames=12)
    amplitudes = drives_in(file)
    sounding = amplitudes[amplitudes.max(axis=1) > 0]
    assert shapes == {((1, 256), (1,))} and len(sounding) > 10
    assert np.allclose(sounding, 0.2, atol=1e-6) and amplitudes[-1].max() == 0
    shapes.clear()
    live(cube, solver=soft, method="multi-focus", noise_free=True, backend=backend).run(frames=12)
    ((matrix, gains),) = shapes
    assert matrix == (gains[0], 256) and gains[0] > 1


@pytest.mark.parametrize("solver, kind, says", [
    (lambda g, a: np.ones(3), palpa.BadUsage, "shape"), (lambda g, a: 2 * np.ones(256), palpa.BadUsage, "amplitude 2"),
    (lambda g, a: 1 / 0, ZeroDivisionError, "division"), (lambda g: g, TypeError, "argument"),
])
def test_a_live_solver_that_fails_ends_in_silence(cube, tmp_path, solver, kind, says):
    session = live(cube, solver=solver, link=f"record:{tmp_path}/drives.bin", noise_free=True)
    for _ in range(2):  # it can run again
        with pytest.raises(kind, match=says):
            session.run()
        (tmp_path / "drives.bin").exists() and (tmp_path / "drives.bin").rename(tmp_path / "first.bin")
    amplitudes = drives_in(tmp_path / "first.bin")
    assert not amplitudes.any()


def test_a_solver_of_a_run_from_points(cube, finger, tmp_path):
    session = palpa.Session(cube, source="points", layout="openmpd", solver=lambda g, a: 0.3 * focusing(g, a), backend="cpu", hold=10,
                            link=f"record:{tmp_path}/drives.bin")
    with session:
        session.start()
        for n in range(5):
            session.push_points(pressed(finger, 2e-3), n / 90)
        begins(lambda: newest_in(tmp_path / "drives.bin") > 0)
        session.stop()
        session.wait()
    assert drives_in(tmp_path / "drives.bin").max() == pytest.approx(0.3, abs=1e-6)


def test_a_function_cannot_call_its_own_session(cube, finger):
    session = palpa.Session(cube, method=lambda finger: session.set_aim([0, 0, 0]), backend="cpu")
    with pytest.raises(palpa.BadUsage, match="calls it"):
        session.touch(pressed(finger, 2e-3))


def test_two_threads_and_a_method_share_a_session(cube, finger):
    """The method needs the interpreter's lock while another thread waits for its turn."""
    session = palpa.Session(cube, method=cross, layout="openmpd", backend="cpu")
    in_threads(lambda: [session.touch(pressed(finger, 2e-3)) for _ in range(10)],
               lambda: [(session.set_aim([0, 0, 0]), session.drives) for _ in range(50)])


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_a_method_of_ones_own_in_a_single_touch(cube, finger, backend):
    solids = []
    touch = cube.touch(finger, penetration=2e-3, method=lambda finger: solids.append(finger.solid) or cross(finger), layout="openmpd", backend=backend)
    (one,) = touch.fingers
    assert solids == [one.solid] == ["cube"]
    usual = cube.touch(finger, penetration=2e-3, backend=backend).fingers[0]
    assert np.allclose(one.foci, cross(usual), atol=1e-7) and sorted(one.order.tolist()) == [0, 1, 2, 3]
    assert one.pressures.shape == (4,) and one.pressures.min() > 0 and '"foci_m"' in touch.json()
    for idle in ({"foci": 4}, {"spacing": "arc"}, {"tune": True}):
        with pytest.raises(palpa.BadUsage, match="no effect"):
            cube.touch(finger, method=cross, backend=backend, **idle)
    for method, kind, says in ((lambda finger: 1 / 0, ZeroDivisionError, "division"),
                               (lambda finger: np.zeros((0, 3)), palpa.BadUsage, "returned 0 foci; a finger has 1 to 64"),
                               (lambda finger: finger.positions[:65], palpa.BadUsage, "returned 65 foci; a finger has 1 to 64")):
        with pytest.raises(kind, match=says):
            cube.touch(finger, penetration=2e-3, method=method, backend=backend)


@pytest.mark.parametrize("count", [1, 7, 12, 64])
def test_each_slot_of_a_touch_plays_a_focus_of_ones_own_method(cube, finger, openmpd, count):
    touch = cube.touch(finger, penetration=2e-3, method=lambda finger: finger.positions[:count], backend="cpu")
    foci = openmpd.from_world(touch.fingers[0].foci)
    played = [openmpd.solve_touch(touch, slot=slot, backend="cpu").foci[0] for slot in range(count)]
    assert len(foci) == count and sorted(map(tuple, np.round(played, 9))) == sorted(map(tuple, np.round(foci, 9)))


def live(cube, **options):
    return palpa.Session(cube, **{"source": "synthetic", "every_frame": True, "backend": "cpu", "layout": "openmpd"} | options)


def test_live_frames_are_those_of_the_export(cube):
    touches, events = [], []
    stats = live(cube, noise_free=True).run(frames=12, on_frame=touches.append, on_event=events.append)
    assert stats.frames == 12 == len(touches) and stats.drives > 0 and '"frames"' in stats.json()
    foci = palpa.export(cube, "synthetic", frames=12, noise_free=True, backend="cpu", layout="openmpd").foci
    rows = [(touch.time, *focus) for touch in touches for finger in touch.fingers for focus in finger.played_foci]
    assert len(rows) == len(foci["x"]) > 0
    times = np.array([row[0] for row in rows])
    assert np.allclose(times - times[0], foci["time"] - foci["time"][0], atol=1e-9)
    assert np.allclose([row[1:] for row in rows], np.stack([foci["x"], foci["y"], foci["z"]], axis=1), atol=1e-7)
    assert {event.kind for event in events} <= {"touch", "move", "press", "release"} and events[0].kind == "touch"


def test_the_gain_multiplies_amplitudes_and_the_last_drive_is_silent(cube, tmp_path):
    file = tmp_path / "drives.bin"
    session = live(cube, link=f"record:{file}", noise_free=True, hold=1)
    session.set_gain(0.25)
    session.run(frames=12)
    amplitudes = drives_in(file)
    assert amplitudes.max() == pytest.approx(0.25, rel=1e-6) and amplitudes[-1].max() == 0


@pytest.mark.parametrize("truth", [bool, np.bool_])
def test_false_ends_a_run(cube, truth):
    seen = []

    def on_frame(touch):
        seen.append(touch)
        return truth(len(seen) < 3)

    assert live(cube).run(on_frame=on_frame).frames >= 3 and 3 <= len(seen) <= 5


def test_a_far_aim_is_warned_of(cube):
    for session in (palpa.Session(cube, backend="cpu"), live(cube)):
        with pytest.warns(palpa.PalpaWarning, match="offset: 5, 0, 0 m is far"):
            session.set_aim([5, 0, 0])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            session.set_aim([0, 0.05, 0])


def test_nulls_near_a_focus_are_warned_of(cube, finger):
    skin = pressed(finger, 2e-3)
    focus = palpa.Session(cube, layout="openmpd", backend="cpu").touch(skin, 0).fingers[0].foci[0]
    once = "--null: .*; this warning comes once"
    alone = palpa.Session(cube, layout="openmpd", nulls=focus, backend="cpu")
    with pytest.warns(palpa.PalpaWarning, match=once):
        alone.touch(skin, 0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        alone.touch(skin, 1 / 90)
    pushed = palpa.Session(cube, source="points", layout="openmpd", nulls=focus, backend="cpu", hold=10)
    with warnings.catch_warnings(record=True) as heard, pushed:
        warnings.simplefilter("always")
        pushed.start()
        pushed.push_points(skin, 0)
        begins(lambda: pushed.set_gain(1) or any(re.match(once, str(one.message)) for one in heard))


def test_a_pose_holds_from_the_first_frame_on(cube, finger):
    far = np.eye(4)
    far[1, 3] = -1
    seen = []
    session = live(cube)
    session.set_pose("cube", far)
    session.run(frames=6, on_frame=lambda touch: seen.append(len(touch.fingers)))
    assert seen == 6 * [0]
    # The next run begins at the place that the scene has.
    session.run(frames=6, on_frame=lambda touch: seen.append(len(touch.fingers)))
    assert seen[6:] == 6 * [1]
    seen.clear()
    pushed = live(cube, source="points", every_frame=False, hold=10)
    with pushed:
        pushed.set_pose("cube", far)
        pushed.start(on_frame=lambda touch: seen.append(len(touch.fingers)))
        for number, pose, expected in ((7, far, 0), (8, np.eye(4), 1), (9, far, 0)):
            pushed.set_pose("cube", pose)
            pushed.push_points(pressed(finger, 2e-3), number / 90)
            begins(lambda: len(seen) == number - 6)
            assert seen[-1] == expected


def test_from_other_threads(cube):
    session = live(cube, every_frame=False)
    with session:
        session.start()
        assert session.running
        with pytest.raises(palpa.BadUsage):
            session.start()
        in_threads(*[lambda: [session.set_gain(0.5), session.set_aim([0, 1e-3, 0]), session.set_pose(0, np.eye(4))]] * 4)
        session.stop()
        session.wait()
    assert not session.running


def test_two_sessions_at_a_time(cube):
    one, two = live(cube), live(cube)
    one.start(frames=5)
    two.start(frames=5)
    assert one.wait().frames == two.wait().frames == 5


def test_a_callback_cannot_wait_for_its_own_run(cube):
    session = live(cube)
    with pytest.raises(palpa.BadUsage, match="stop"):
        session.run(frames=50, on_frame=lambda touch: session.wait())
    assert not session.running


def test_one_thread_waits_for_a_run(cube):
    session, refused = live(cube), threading.Event()
    session.start()

    def wait():
        try:
            return session.wait().frames
        except palpa.BadUsage as error:
            refused.set()
            return str(error)

    def stop():
        refused.wait(50)
        session.stop()

    ends = in_threads(wait, wait, stop)[:2]
    assert sorted(isinstance(end, int) for end in ends) == [False, True] and any("another thread" in str(end) for end in ends)


def test_points_pushed_into_a_run(cube, finger, tmp_path):
    file = tmp_path / "drives.bin"
    session = palpa.Session(cube, source="points", layout="openmpd", link=f"record:{file}", backend="cpu", hold=10)
    with pytest.raises(palpa.BadUsage, match="start"):
        session.push_points(finger)
    touches, kinds = [], []
    arrived, pushed = threading.Event(), threading.Event()

    def on_frame(touch):
        pushed.wait(50)  # who pushes does not wait for the frame
        touches.append(touch)
        arrived.set()

    with session:
        session.start(on_frame=on_frame, on_event=lambda event: kinds.append(event.kind))
        for n, depth in enumerate([1e-3, 2e-3, -5e-3]):
            arrived.clear()
            pushed.clear()
            session.push_points(pressed(finger, depth), n / 90)
            assert not arrived.is_set()
            pushed.set()
            assert arrived.wait(60)
            begins(lambda: (newest_in(file) > 0) == (depth > 0))
        for bad in (finger[:, :2], finger * np.nan):
            with pytest.raises(palpa.BadUsage):
                session.push_points(bad)
        session.stop()
        stats = session.wait()
    assert stats.frames == 3 == len(touches) and stats.touching == 2 and [touch.time for touch in touches] == [0, 1 / 90, 2 / 90]
    # The same contacts as frame by frame, and a sound that ends in silence.
    alone = palpa.Session(cube, backend="cpu").touch(pressed(finger, 1e-3))
    assert np.array_equal(alone.contacts.indices, touches[0].contacts.indices)
    amplitudes = drives_in(file)
    assert amplitudes.max() == pytest.approx(1, abs=1e-6) and amplitudes[-1].max() == 0
    assert kinds[0] == "touch" and kinds[-1] == "release"


@pytest.mark.parametrize("options", [{"every_frame": True}, {"record": "take"}, {"finger_width": 0.02}, {"noise_free": True}, {"keep_boards": True}, {"hysteresis": "on"}])
def test_options_that_points_do_not_have(cube, options):
    with pytest.raises(palpa.BadUsage):
        palpa.Session(cube, source="points", backend="cpu", **options)


@pytest.mark.parametrize("source", ["Points", "point", "points ", "points:x", "nowhere"])
def test_sources_that_no_run_would_open(cube, source):
    with pytest.raises(palpa.BadUsage, match="points"):
        palpa.Session(cube, source=source, backend="cpu")


def test_objects_in_a_circle_are_collected(cube):
    """A callback that knows its session, and a session whose run is over."""
    session = live(cube)
    known = weakref.ref(cube_of := type("Owner", (), {})())
    cube_of.session = session
    session.run(frames=2, on_frame=lambda touch, owner=cube_of: owner.session.set_gain(0.5))
    del session, cube_of
    gc.collect()
    assert known() is None


def test_a_recording_exported(cube, tmp_path):
    recording = palpa.Recording("assets/depth/take")
    result = palpa.export(cube, recording, backend="cpu")
    file = tmp_path / "foci.csv"
    json = run(["export", "--scene", "assets/cube.glb", "--source", "recording:assets/depth/take", "--foci", str(file), "--backend", "cpu",
                "--json", "-"])
    assert result.json() == json
    table = np.genfromtxt(file, delimiter=",", names=True, dtype=None, encoding="utf-8")
    foci = result.foci
    assert len(table) == len(foci["x"]) > 50
    for column in ("x", "y", "z"):
        assert np.allclose(table[column], foci[column], atol=1e-7)
    assert len(recording) == 12 and recording.times.shape == (12,)


@pytest.mark.slow
def test_a_scripts_recording_has_a_finger_whose_place_is_known(cube, tmp_path):
    """The documented script, and foci ahead of its finger by the tangent of its circle."""
    folder = tmp_path / "circling"
    subprocess.run([sys.executable, ROOT / "docs/examples/circling_finger.py", folder, "1"], check=True)

    def middles(**options):
        """The middle of each frame's foci, as x + iz, turned back by the angle of the finger."""
        foci = palpa.export(cube, palpa.Recording(folder), backend="cpu", **options).foci
        frames = np.round(foci["slot"] * 1.5e-3 * 90).astype(int)  # slots of 1.5 ms
        assert set(frames) == set(range(28))
        places = foci["x"] + 1j * foci["z"]
        return np.array([places[frames == n].mean() * np.exp(-2j * np.pi * n / 28) for n in range(28)])

    assert np.abs(middles() - 0.01).max() < 0.6e-3
    # 30 ms at the speed of the finger; the first frames have no speed yet.
    step = 1j * 2 * np.pi * 0.01 * 0.03 * 90 / 28
    assert np.abs(middles(predict_latency=0.03)[9:] - (0.01 + step)).max() < 1.2e-3
