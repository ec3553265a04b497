"""Bad arrays and bad options: one clear message, of the right class, and nothing else happens."""
import warnings

import numpy as np
import pytest

import palpa


def message(kind, call):
    with pytest.raises(kind) as caught:
        call()
    text = str(caught.value)
    assert "\n" not in text and 0 < len(text) < 500
    return text


@pytest.mark.parametrize("skin, says", [
    (np.zeros((4, 2)), "shape (4, 2)"),
    (np.zeros((2, 3, 1)), "shape (2, 3, 1)"),
    (np.zeros(4), "shape (4,)"),
    (np.float64(1), "shape ()"),
    (np.zeros((4, 3), complex), "type complex128"),
    (np.zeros((4, 3), bool), "type bool"),
    (np.array([["a", "b", "c"]]), "type <U1"),
    (np.array([[None, 1, 2]]), "type object"),
    ([[1, 2, 3], [4, 5]], "not list"),
    (object(), "shape ()"),
    (np.array([[0, 0, 0], [0, np.nan, 0]]), "row 1 is not finite"),
    (np.array([[np.inf, 0, 0]]), "row 0 is not finite"),
    (np.broadcast_to(np.zeros(3), (10**12, 3)), "at most 16777216"),
    *((np.eye(3)[[axis, axis]] * [[1], [1e300]], "vertex 1 lies beyond 3e38 m") for axis in range(3)),
])
def test_points(cube, skin, says):
    assert says in message(ValueError, lambda: cube.touch(skin, backend="cpu"))


@pytest.mark.parametrize("change", [
    lambda a: a.astype(np.float32), lambda a: np.asfortranarray(a), lambda a: np.ascontiguousarray(a[:, ::-1])[:, ::-1],
    lambda a: np.repeat(a, 2, axis=0)[::2], lambda a: a.astype(">f8"), lambda a: a.tolist(), lambda a: a.view(np.matrix),
])
def test_any_memory_order_is_taken(cube, finger, change):
    expected = cube.touch(finger.astype(np.float32).astype(float), penetration=3e-3, backend="cpu")
    touch = cube.touch(change(finger.astype(np.float32).astype(float)), penetration=3e-3, backend="cpu")
    assert np.array_equal(touch.contacts.depths, expected.contacts.depths)


def test_an_array_is_not_changed(cube, finger):
    mine = finger.copy()
    mine.flags.writeable = False
    cube.touch(mine, penetration=3e-3, backend="cpu")
    assert np.array_equal(mine, finger)


def test_no_points_touch_nothing(cube):
    touch = cube.touch(np.zeros((0, 3)), backend="cpu")
    assert len(touch.contacts) == 0 and touch.fingers == [] and touch.contacts.positions.shape == (0, 3)


@pytest.mark.parametrize("drive, says", [
    (np.ones(255, complex), "shape (255,)"),
    (np.ones((256, 1), complex), "shape (256, 1)"),
    (np.full(256, 1.0001 + 0j), "entry 0 has the amplitude 1.0001"),
    (np.full(256, 1.001 + 0j), "entry 0 has the amplitude 1.001"),
    (np.full(256, np.nan + 0j), "entry 0 has the amplitude nan"),
    (np.array(["x"] * 256), "type <U1"),
])
def test_drives(openmpd, drive, says):
    assert says in message(palpa.BadUsage, lambda: openmpd.field(drive, [0, 0, 0.15], backend="cpu"))


def test_rounding_leaves_a_full_drive_full(openmpd):
    """numpy's abs of a unit phasor is often 1.0000000000000002, and of complex64 1.0000001."""
    full = openmpd.field(np.ones(256, complex), [0, 0, 0.15], backend="cpu")
    for rounded in (1 + 1e-6, 1.0000000000000002, np.complex64(1.0000001)):
        assert np.array_equal(openmpd.field(np.full(256, rounded), [0, 0, 0.15], backend="cpu").pressure, full.pressure)


def test_a_drive_of_single_precision(openmpd):
    single = np.exp(1j * np.linspace(0, 50, 256)).astype(np.complex64)
    assert np.abs(single.astype(complex)).max() > 1
    assert openmpd.field(single, [0, 0, 0.15], backend="cpu").peak > 0


def test_errors_of_the_callers_arrays_are_theirs(cube, openmpd):
    class Array:
        def __array__(self, *_, **__):
            raise OSError("the disk is gone")

    class Number:
        def __float__(self):
            raise OSError("the disk is gone")

    class Sequence(list):
        def __len__(self):
            raise OSError("the disk is gone")

    for call in (lambda: cube.touch(Array(), backend="cpu"), lambda: openmpd.solve(Array(), backend="cpu"),
                 lambda: openmpd.field(Array(), [0, 0, 0.15], backend="cpu"), lambda: openmpd.solve([0, 0, 0.15], pressure=Number(), backend="cpu"),
                 lambda: cube.touch([0, 0, 0], penetration=Number(), backend="cpu"), lambda: cube.touch([0, 0, 0], layout=Sequence(), backend="cpu")):
        with pytest.raises(OSError, match="the disk is gone"):
            call()
    assert "inhomogeneous" in message(palpa.BadUsage, lambda: cube.touch([[1, 2, 3], [4, 5]], backend="cpu"))


@pytest.mark.parametrize("call, says", [
    (lambda a: a.solve([0, 0, 0.15], gains=[1, 1]), "2 for 1 focus"),
    (lambda a: a.solve([0, 0, 0.15], gains=[0]), "gain of 0"),
    (lambda a: a.solve(np.zeros((0, 3)), backend="cpu"), "no focus"),
    (lambda a: a.solve([0, 0, 1e3]), "farther than 100 m"),
    (lambda a: a.solve(a.positions[3]), "transducer 3"),
    (lambda a: a.solve([0, 0, 0.15], solver="best"), "naive"),
    (lambda a: a.solve([0, 0, 0.15], solver="adjoint"), "finger is missing"),
    (lambda a: a.solve([0, 0, 0.15], pressure=1e9), "out of range"),
    (lambda a: a.solve([0, 0, 0.15], pressure=1e3, constraint="clamp"), "--constraint"),
    (lambda a: a.solve([0, 0, 0.15], temperature=20, sound_speed=343), "--temperature"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0.02]), "shape (2,)"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, np.nan, 0.15]), "not finite"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0.02, 0.15], null_radius=[1e-3, 1e-3]), "2 for 1 null"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0.02, 0.15], null_radius=-1e-3), "radius from 0 to 5mm"),
    (lambda a: a.solve([0, 0, 0.15], null_radius=1e-3), "goes with nulls"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0, 0.15], backend="cpu"), "closer than the array resolves"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0.02, 0.15], solver="greedy"), "--solver gs-pat"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0.02, 0.15], solver=lambda g, gains: np.ones(256)), "gs-pat"),
    (lambda a: a.solve([0, 0, 0.15], nulls=[0, 0.02, 0.15], pressure=500), "--null"),
    (lambda a: a.solve([0, 0, 0.15], backend="cpu", gpu="0"), "--gpu"),
    (lambda a: a.solve([0, 0, 0.15], slover="naive"), "did you mean solver?"),
    (lambda a: a.solve([0, 0, 0.15], json="-"), "no option 'json'"),
    (lambda a: a.field(np.ones(256), np.zeros((0, 3)), backend="cpu"), "point"),
    (lambda a: a.field(np.ones(256), [0, 0, 200.0], backend="cpu"), "100 m"),
    (lambda a: a.field(np.ones(256), [0, 0, 0.15], solver="naive"), "no option 'solver'"),
    (lambda a: a.field(np.ones(256), [0, 0, 0.15], no_absorption=True, humidity=30, backend="cpu"), "--humidity"),
    (lambda a: a.field(np.ones(256), [0, 0, 0.15], no_absorption=1, backend="cpu"), "True or False"),
    (lambda a: a.transfer([0, 0, 101.0]), "100 m"),
    (lambda a: a.transfer(np.broadcast_to(0.1, (1 << 21, 3))), "give fewer at a time"),
    (lambda a: a.moved(np.eye(3)), "shape (3, 3)"),
    (lambda a: a.moved(2 * np.eye(4)), "no rigid transform"),
    (lambda a: a.moved(np.full((4, 4), np.nan)), "not all of its numbers are finite"),
    (lambda a: palpa.plane("zz", size=(1, 1)), "not one of xy, xz, yz"),
    (lambda a: palpa.plane("xy", size=(1, 1), pixels=(1.5, 2)), "whole number"),
    (lambda a: palpa.plane("xy", size=(0, 1)), "plane"),
    (lambda a: palpa.line([0, 0, 0], [0, 0, 0]), "line"),
    (lambda a: palpa.Mesh((np.zeros((3, 3)), [[0, 1, 3]])), "vertex 3, but there are 3"),
    (lambda a: palpa.Mesh((np.zeros((3, 3)), [[0, 1, -1]])), "vertex -1"),
    (lambda a: palpa.Mesh((np.zeros((3, 3)), [[0.0, 1, 2]])), "whole numbers"),
    (lambda a: palpa.Mesh(3), "give a palpa.Mesh"),
    (lambda a: palpa.Scene(3), "path"),
    (lambda a: palpa.Scene("a\0b.glb"), "zero character"),
    (lambda a: palpa.Scene("assets/cube.glb", parts=3), "--parts"),
])
def test_arguments(openmpd, call, says):
    assert says in message(palpa.BadUsage, lambda: call(openmpd))


@pytest.mark.parametrize("options, says", [
    ({"foci": 12, "stride": 3}, "a stride such as 5"), ({"foci": 0}, "--foci"), ({"foci": 2.5}, "--foci"), ({"foci": 10, "stride": 5}, "--stride"), ({"delta": "3kg"}, "--delta"),
    ({"delta": float("nan")}, "--delta"), ({"method": "best"}, "cross-section"), ({"layout": "nowhere"}, "nowhere"), ({"pressure": 100}, "--layout"),
    ({"spot": 1e-3}, "--spot"), ({"finger_width": 0.02}, "--finger-width"), ({"tune": "yes"}, "True or False"), ({"method": ""}, "empty"),
    ({"delta": [1, 2]}, "--delta"), ({"delta": None, "dwell": -1}, "--dwell"), ({"penetration": 11}, "penetration"), ({"penetration": "3 apples"}, "a length such as"),
    ({"penetration": True}, "a length such as"), ({"penetration": float("nan")}, "a length such as"), ({"camera": "x.toml"}, "--camera"),
])
def test_options_of_a_touch(cube, finger, options, says):
    assert says in message(palpa.Error, lambda: cube.touch(finger, backend="cpu", **options))


def test_depth_images(cube):
    camera = "assets/depth/camera.toml"
    right = np.zeros((240, 424), np.uint16)
    session = palpa.Session(cube, depth=True, camera=camera, backend="cpu")
    for bad, says in [(right.astype(np.int32), "the type int32"), (right[:, 1:], "the shape (240, 423)"), (right.astype(float), "the type float64"),
                      (np.zeros((240, 424, 3), np.uint16), "the shape (240, 424, 3)"), (np.zeros((240, 424, 1, 1), np.uint16), "the shape (240, 424, 1, 1)"),
                      (right[:, None, :], "the shape (240, 1, 424)"), (right[None][:0], "the shape (0, 240, 424)"), (right.T[:, None, :], "the shape (424, 1, 240)"),
                      (right[0], "the shape (424,)"), (np.array(3, np.uint16), "the shape ()"), (right[:, :, None] > 1, "the type bool")]:
        for one in (bad, [bad]):
            assert says in message(ValueError, lambda: cube.touch(depth=one, camera=camera, backend="cpu"))
            assert says in message(ValueError, lambda: session.touch(depth=one))
    assert "one for each camera" in message(ValueError, lambda: session.touch(depth=np.zeros((2, 240, 424), np.uint16)))
    assert "no skin" in message(palpa.BadUsage, lambda: cube.touch(backend="cpu"))
    assert "exclude" in message(palpa.BadUsage, lambda: cube.touch(np.zeros((1, 3)), depth=right, camera=camera, backend="cpu"))


def test_files_are_named(tmp_path):
    broken = tmp_path / "a: b.glb"
    broken.write_bytes(b"no model")
    with pytest.raises(palpa.BadInput) as caught:
        palpa.Scene(broken)
    assert caught.value.file == str(broken) and caught.value.exit_code == 4 and str(caught.value).startswith(str(broken))
    with pytest.raises(palpa.BadInput) as caught:
        palpa.Layout("openmpd").read_drive(tmp_path / "missing.csv")
    assert caught.value.file == str(tmp_path / "missing.csv")


def test_classes():
    assert issubclass(palpa.BadInput, palpa.Error) and issubclass(palpa.BadInput, ValueError)
    assert issubclass(palpa.BadUsage, palpa.Error) and issubclass(palpa.BadUsage, ValueError)
    assert issubclass(palpa.NoDevice, palpa.Error) and issubclass(palpa.NoDevice, RuntimeError)
    assert palpa.Error.__module__ == "palpa"


def test_no_device(cube, finger):
    with pytest.raises(palpa.NoDevice) as caught:
        cube.touch(finger, gpu="no such device")
    assert caught.value.exit_code == 3


def test_skin_in_another_unit_is_told(cube, finger):
    skin = 1e3 * finger
    told = pytest.warns(palpa.PalpaWarning, match=r"skin: measures .* m \(coordinates are metres\); if they are millimetres")
    with told:
        cube.touch(skin, backend="cpu")
    session = palpa.Session(cube, backend="cpu")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        session.touch(finger[:50], 0.0)  # too few to tell
    with told as caught:
        session.touch(skin, 0.01)
        session.touch(skin, 0.02)
    assert len(caught) == 1
    pushed = palpa.Session(cube, source="points", layout="openmpd", backend="cpu")
    with pytest.warns(palpa.PalpaWarning, match="points: measures"), pushed:
        pushed.start()
        pushed.push_points(skin)


@pytest.mark.parametrize("masked", [lambda points: np.ma.masked_where(points == points[3], points),
                                    lambda points: [points[0], np.ma.masked_equal(points[1], points[1][0])]])
def test_masked_entries_are_refused(cube, finger, openmpd, masked):
    for call in (lambda: cube.touch(masked(finger), backend="cpu"), lambda: openmpd.solve(masked(finger[:9]), backend="cpu")):
        with pytest.raises(palpa.BadUsage, match="has masked entries: leave them out, or fill them"):
            call()
    assert len(cube.touch(np.ma.array(finger), penetration=1e-3, backend="cpu").contacts) > 0


def test_a_least_range_that_leaves_nothing_is_told(cube):
    matrix = [[400, 0, 211.5], [0, 400, 119.5], [0, 0, 1]]
    with pytest.warns(palpa.PalpaWarning, match="^Camera: min_range_m = 280 makes all depths below 280 m no data; if it is in millimetres, write 0.28"):
        palpa.Camera(424, 240, matrix, min_range=280)
    camera = palpa.Camera(424, 240, matrix, depth_unit=1e-4, min_range=3, name="one")
    with pytest.warns(palpa.PalpaWarning, match='camera "one": its min_range_m = 3 makes all of the .* depths in its image no data: they reach to'):
        cube.touch(depth="assets/depth/hand.png", camera=camera, backend="cpu")


def test_a_cameras_fault_has_no_line():
    with pytest.raises(palpa.BadInput, match="^Camera: width is 0, expected 1 to 16384$"):
        palpa.Camera(0, 480, [[400, 0, 211.5], [0, 400, 119.5], [0, 0, 1]])


def test_flags_of_numpy(cube, finger, openmpd):
    """A comparison of arrays gives np.bool_."""
    drive, where = openmpd.drive([0, 0, 0.15], backend="cpu"), [[0, 0, 0.15]]
    for flag in (False, True):
        same = openmpd.field(drive, where, no_absorption=np.array([flag])[0], backend="cpu").pressure
        assert np.array_equal(same, openmpd.field(drive, where, no_absorption=flag, backend="cpu").pressure)
    assert (cube.touch(finger, penetration=3e-3, layout="openmpd", spectrum=np.True_, backend="cpu").fingers[0].spectrum is None) is False
    for number in (1, 0.0, "yes", np.array([True, False])):
        assert "True or False" in message(palpa.BadUsage, lambda: openmpd.field(drive, where, no_absorption=number, backend="cpu"))
    for options in ({"foci": np.True_}, {"delta": np.True_}, {"penetration": np.True_}):
        message(palpa.BadUsage, lambda: cube.touch(finger, backend="cpu", **options))
