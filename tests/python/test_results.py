"""Results: their shapes, their memory, their text, and that they agree with each other."""
import gc
import struct
import warnings
import zlib

import numpy as np
import pytest

import palpa


def test_a_touch(cube, finger):
    touch = cube.touch(finger, penetration=3e-3, backend="cpu", layout="openmpd", spectrum=True)
    (one,) = touch.fingers
    n = len(touch.contacts)
    assert touch.points == len(finger) and n > 100
    assert touch.contacts.depths.dtype == np.float64 and touch.contacts.positions.shape == (n, 3)
    assert np.all((touch.contacts.depths > 0) & (touch.contacts.depths < 1.5e-3)) and np.all(np.diff(touch.contacts.indices) > 0)
    assert one.solid == "cube" and one.foci.shape == (10, 3) and one.axes.shape == (3, 3)
    assert np.allclose(one.axes @ one.axes.T, np.eye(3), atol=1e-6)
    mine = touch.contacts.positions[one.contacts]
    assert np.allclose(mine.mean(axis=0), one.centroid, atol=1e-7)
    assert np.allclose(np.linalg.eigvalsh(np.cov(mine.T, bias=True))[::-1][:2], one.eigenvalues[:2], rtol=1e-3)
    assert one.focus_points.sum() == len(one.contacts)
    assert list(touch.order) == [0, 3, 6, 9, 2, 5, 8, 1, 4, 7] and touch.dwell == 1.5e-3
    assert one.pressures.shape == (10,) and np.all(one.pressures > 1000)
    assert one.spectrum["frequency"][0] == pytest.approx(1 / 15e-3) and 0 < one.spectrum["felt_share"] <= 1
    # A cube's top is y = 0: depths and positions are two ways to the same number.
    assert np.allclose(cube[0].depth(touch.contacts.positions), touch.contacts.depths, atol=1e-6)


def test_empty_sectors_are_nan(cube):
    x = np.linspace(-4e-3, 4e-3, 9)
    skin = np.stack(np.meshgrid(x, [-1e-3], x), axis=-1).reshape(-1, 3)
    half = skin[(skin[:, 0] >= 0) | (np.abs(skin[:, 2]) > 3.5e-3)]
    (one,) = cube.touch(half, foci=64, backend="cpu").fingers
    empty = one.focus_points == 0
    assert empty.any() and np.isnan(one.foci[empty]).all() and np.isfinite(one.foci[~empty]).all() and np.isfinite(one.played_foci).all()


def test_depth_images_as_arrays_and_files(cube, tmp_path):
    camera, recording = "assets/depth/camera.toml", palpa.Recording("assets/depth/take")
    image, count = recording.images(6)[0], len(recording)
    frames = [recording.images(number)[0] for number in range(count)]
    assert len({frame.tobytes() for frame in frames}) > 5 and all(np.array_equal(recording.images(number - count)[0], frame) for number, frame in enumerate(frames))
    for number in (count, -count - 1):
        with pytest.raises(IndexError, match=f"the recording has {count} frames"):
            recording.images(number)
    assert image.dtype == np.uint16 and not image.flags.writeable
    write_png16(tmp_path / "image.png", image)
    files = cube.touch(depth=tmp_path / "image.png", camera=camera, backend="cpu")
    arrays = cube.touch(depth=[image], camera=[camera], backend="cpu")
    assert np.array_equal(arrays.contacts.indices, files.contacts.indices) and arrays.points == files.points > 1000


def write_png16(file, pixels):
    """A 16-bit grey PNG, written with nothing but the standard library."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in pixels)
    head = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 16, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def test_the_drive_of_the_paper(openmpd):
    focus = np.array([0.01, 0.02, 0.15])
    drive = openmpd.drive(focus, amplitude="distance", backend="cpu")
    distance = np.linalg.norm(openmpd.positions - focus, axis=1)
    k = 2 * np.pi * 40e3 / (331.3 * np.sqrt(1 + 20 / 273.15))
    expected = distance / distance.max() * np.exp(-1j * k * distance)
    assert drive.dtype == np.complex128 and np.abs(drive - expected).max() < 1e-5


def test_transfer_gives_the_pressure_at_the_foci(openmpd):
    foci = [[0, 0, 0.15], [0.02, 0, 0.15], [0, -0.03, 0.12]]
    solved = openmpd.solve(foci, solver="gs-pat", backend="cpu")
    matrix = openmpd.transfer(foci)
    assert matrix.shape == (3, 256) and matrix.dtype == np.complex128 and matrix.flags.c_contiguous
    assert np.allclose(np.abs(matrix @ solved.vector), solved.pressures, rtol=1e-4)
    # The field is the same sum, by another way.
    field = openmpd.field(solved, foci, no_absorption=True, backend="cpu")
    assert np.allclose(field.pressure, matrix @ solved.vector, rtol=1e-3)
    quiet = openmpd.field(solved, foci, backend="cpu")
    assert np.all(np.abs(quiet.pressure) < np.abs(field.pressure)) and quiet.absorption > 0 == field.absorption


def test_many_points_at_once_are_the_same(openmpd):
    points = np.random.default_rng(1).uniform(-0.1, 0.1, (150, 3)) + [0, 0, 0.2]
    whole = openmpd.transfer(points)
    assert np.array_equal(whole[137], openmpd.transfer(points[137])[0])


def test_places(openmpd):
    plane = palpa.plane("xz", centre=(0, 0, 0.15), size=(0.03, 0.02), pixels=(6, 4))
    assert plane.shape == (4, 6) and plane.points.shape == (24, 3) and plane.extent == pytest.approx((-0.015, 0.015, 0.14, 0.16))
    assert plane.points[0] == pytest.approx([-0.0125, 0, 0.1575]) and plane.points[-1] == pytest.approx([0.0125, 0, 0.1425])
    drive = openmpd.drive([0, 0, 0.15], backend="cpu")
    field = openmpd.field(drive, plane, backend="cpu")
    assert field.pressure.shape == (4, 6)
    assert np.array_equal(field.pressure.ravel(), openmpd.field(drive, plane.points, backend="cpu").pressure)
    line = openmpd.field(drive, palpa.line([0, 0, 0.1], [0, 0, 0.2], samples=11), backend="cpu")
    assert line.pressure.shape == (11,) and line.peak_at == pytest.approx([0, 0, 0.15], abs=1e-9)
    surface = openmpd.field(drive, (line.points[:3] + [[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]], [[0, 1, 2]]), backend="cpu")
    assert surface.faces.tolist() == [[0, 1, 2]]
    assert np.abs(np.asarray(line)).max() == line.peak


def test_results_keep_their_owners_alive(openmpd):
    drive = openmpd.drive([0, 0, 0.15], backend="cpu")
    pressure = openmpd.field(drive, palpa.plane("xy", centre=(0, 0, 0.15), size=(0.1, 0.1), pixels=(64, 64)), backend="cpu").pressure
    kept = pressure.copy()
    vertices = palpa.Scene("assets/cube.glb")[0].vertices
    finger = palpa.Scene("assets/cube.glb").touch(palpa.read_ply("assets/finger.ply"), penetration=3e-3, backend="cpu").fingers[0]
    gc.collect()
    _ = [np.ones(1000) for _ in range(1000)]
    assert np.array_equal(pressure, kept) and np.abs(vertices).max() < 0.1 and finger.foci.shape == (10, 3)


@pytest.mark.parametrize("array", [
    lambda a: a.positions, lambda a: a.axes, lambda a: a.drive([0, 0, 0.15], backend="cpu"), lambda a: a.transfer([0, 0, 0.15]),
    lambda a: palpa.Scene("assets/cube.glb")[0].vertices, lambda a: palpa.Mesh("assets/finger.ply").faces,
    lambda a: a.field(np.ones(256), [0, 0, 0.15], backend="cpu").pressure,
])
def test_results_are_read_only_and_in_c_order(openmpd, array):
    result = array(openmpd)
    assert not result.flags.writeable and result.flags.c_contiguous
    with pytest.raises(ValueError):
        result[0] = 0


def test_large_results_are_not_copied(openmpd):
    field = openmpd.field(np.ones(256), palpa.plane("xy", centre=(0, 0, 0.15), size=(0.1, 0.1), pixels=(32, 32)), backend="cpu")
    assert field.pressure.ctypes.data == field.pressure.ctypes.data == np.asarray(field).ctypes.data
    mesh = palpa.Mesh("assets/finger.ply")
    assert mesh.vertices.ctypes.data == mesh.vertices.ctypes.data and mesh.vertices.base is mesh


def test_layouts(tmp_path):
    assert "paper" in palpa.Layout.names()
    paper = palpa.Layout("paper")
    assert len(paper) == 3984 and len(paper.boards) == 16 and np.allclose(np.linalg.norm(paper.axes, axis=1), 1)
    turned = np.array([[0, 0, 1, 0.1], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1.0]])
    moved = paper.moved(turned)
    assert np.allclose(moved.positions, paper.positions @ turned[:3, :3].T + [0.1, 0, 0])
    drive = paper.drive([0, 0, 0], backend="cpu")
    paper.write_drive(tmp_path / "drive.csv", drive)
    assert np.allclose(paper.read_drive(tmp_path / "drive.csv"), drive, atol=1e-6)


def test_texts(cube, finger, openmpd):
    for value in (cube, cube[0], openmpd, palpa.Mesh("assets/finger.ply"), cube.touch(finger, penetration=3e-3, backend="cpu"),
                  openmpd.solve([0, 0, 0.15], backend="cpu"), palpa.plane("xy", size=(1, 1)), palpa.Recording("assets/depth/take")):
        assert repr(value).startswith("<palpa.") and len(repr(value)) < 200
    with pytest.raises(KeyError):
        cube["sphere"]
    with pytest.raises(IndexError):
        cube[1]
    assert [solid.name for solid in cube] == ["cube"] and cube["cube"].haptics == {}
    assert [solid.haptics for solid in palpa.Scene("assets/design.glb")] == [
        {"intensity": 0.5, "press_depth": 0.003, "click": (0.045, 200)}, {"stiffness": [(0, 0.05), (0.01, 1)]},
        {"texture": (0.2, 1, 0.6), "grain": 0.002}, {"texture": (1, 0, 0.15), "grain": 0.01}]


def test_a_mesh_reads_back(tmp_path):
    mesh = palpa.Mesh("assets/finger.ply")
    palpa.write_ply(tmp_path / "again.ply", mesh.vertices, mesh.faces)
    again = palpa.Mesh(tmp_path / "again.ply")
    assert np.array_equal(again.vertices, mesh.vertices) and np.array_equal(again.faces, mesh.faces) and again.volume > 0


def test_warnings_are_pythons_and_kept(cube, capfd):
    palpa.messages()
    with pytest.warns(palpa.PalpaWarning, match="100ms") as told:
        cube.touch([0, 1, 0], dwell=0.1, backend="cpu")
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(palpa.PalpaWarning):
            cube.touch([0, 1, 0], dwell=0.1, backend="cpu")
    palpa.messages()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cube.touch([0, 1, 0], dwell=0.1, backend="cpu")
    lines = palpa.messages()
    assert [level for level, _ in lines] == ["warning"] and "100ms" in lines[0][1] and palpa.messages() == []
    assert capfd.readouterr() == ("", "")


def test_scattering(sphere, tmp_path):
    sphere(tmp_path / "sphere.ply")
    result = palpa.scatter(tmp_path / "sphere.ply", plane_wave=(0, 0, 1), where=[[0, 0, -0.05], [0, 0, 0]])
    assert result.pressure.shape == (len(result.faces),) and np.isnan(result.around[1]) and abs(result.around[0]) > 0.3
    assert np.allclose(result.areas.sum(), 4 * np.pi * 1e-4, rtol=0.03)
    assert result.force[2] > 0 and abs(result.force[0]) < 1e-2 * result.force[2]
    # The same force by the momentum in the air.
    assert np.allclose(result.force, result.far_force, atol=0.02 * result.force[2])


def test_parts_and_calibration(tmp_path):
    parts = palpa.decompose("assets/prism.glb", parts=4, resolution=20000)
    (one,) = parts.solids
    assert one["solid"] and len(one["parts"]) >= 1 and one["volume_ratio"] == pytest.approx(1, abs=0.1)
    parts.write(tmp_path / "parts.glb")
    assert palpa.Scene(tmp_path / "parts.glb")[0].parts == len(one["parts"])
