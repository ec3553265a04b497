"""Points know their frame and drives their array: what is used elsewhere is refused."""
import pickle

import numpy as np
import pytest

import palpa
from commands import TWIN


@pytest.fixture(scope="module")
def touch(cube, finger):
    return cube.touch(finger, penetration=3e-3, layout="openmpd", backend="cpu")


@pytest.fixture(scope="module")
def twin():
    return palpa.Layout(TWIN)


def refused(call, *says):
    with pytest.raises(palpa.BadUsage) as caught:
        call()
    assert all(one in str(caught.value) for one in says), caught.value


def test_a_drive_of_another_layout(openmpd, twin, cube, finger, tmp_path):
    drive = openmpd.drive([0, 0, 0.15], backend="cpu")
    solved = openmpd.solve([0, 0, 0.15], backend="cpu")
    assert len(twin) == len(openmpd) and solved.layout is openmpd
    openmpd.write_drive(tmp_path / "d.csv", drive)
    wider = palpa.Layout((1.1 * openmpd.positions, openmpd.axes), name="wider")
    session = palpa.Session(cube, layout="openmpd", backend="cpu")
    session.touch(finger - [0, 2e-3 + finger[:, 1].min(), 0], 0.0)
    for one in (drive, solved, solved.vector, drive.copy(), drive[:], openmpd.read_drive(tmp_path / "d.csv"), session.drives[0]):
        refused(lambda one=one: twin.field(one, [0, 0, 0.15], backend="cpu"), "drive", "openmpd", TWIN)
        refused(lambda one=one: twin.write_drive(tmp_path / "s.csv", one), "openmpd", TWIN)
        refused(lambda one=one: palpa.scatter("assets/finger.ply", layout=twin, drive=one), "openmpd", TWIN)
        refused(lambda one=one: wider.solve([0, 0, 0.15], solver=lambda g, gains, one=one: one, backend="cpu"), "openmpd", "wider")
        assert np.allclose(openmpd.moved(openmpd.default_pose).solve([0, 0, 0], solver=lambda g, gains, one=one: one, backend="cpu").vector, one)
        assert openmpd.field(one, [0, 0, 0.15], backend="cpu").peak > 100
    # The same array, loaded again or moved, and plain arrays.
    peak = openmpd.field(drive, [0, 0, 0.15], backend="cpu").peak
    moved = openmpd.moved(openmpd.default_pose)
    for array, at in ((palpa.Layout("openmpd"), [0, 0, 0.15]), (moved, [0, 0, 0])):
        assert array.field(drive, at, backend="cpu").peak == pytest.approx(peak, rel=1e-5)
    assert twin.field(np.asarray(drive), [0, 0, 0.15], backend="cpu").peak > 0
    assert type(0.5 * drive) is type(np.conj(drive)) is type(np.stack([drive, drive])) is type(drive.dot(np.eye(256))) is np.ndarray


def test_foci_of_the_world(openmpd, twin, touch):
    foci = touch.fingers[0].foci
    for call in (lambda: openmpd.solve(foci[:3], backend="cpu"), lambda: openmpd.drive(touch.fingers[0].centroid, backend="cpu"),
                 lambda: openmpd.transfer(touch.contacts.positions), lambda: openmpd.field(np.ones(256), touch.fingers[0].played_foci, backend="cpu")):
        refused(call, "in the world", "layout openmpd", "from_world")
    own = openmpd.from_world(foci)
    assert np.allclose(own, np.c_[foci, np.ones(10)] @ np.linalg.inv(openmpd.default_pose).T[:, :3], atol=1e-12)
    # What palpa touch says of the same focus.
    louder = openmpd.solve(own[0], backend="cpu")
    assert louder.pressures[0] == pytest.approx(touch.fingers[0].pressures[0], rel=1e-4)
    refused(lambda: twin.solve(own[0], backend="cpu"), "openmpd", TWIN)
    refused(lambda: twin.field(np.ones(256), louder.foci, backend="cpu"), "openmpd", TWIN)
    refused(lambda: palpa.Scene("assets/cube.glb").touch(own, backend="cpu"), "layout openmpd", "in the world")
    # The paper's layout is in the world, and so is one that was moved there.
    assert palpa.Layout("paper").solve(foci[0], backend="cpu").pressures[0] > 0
    assert openmpd.moved(openmpd.default_pose).solve(foci[0], backend="cpu").pressures[0] == pytest.approx(louder.pressures[0], rel=1e-4)
    assert type(foci + 0) is np.ndarray and openmpd.solve(np.asarray(foci[0]), backend="cpu").pressures[0] > 0


def test_a_touch_is_solved_as_its_file(openmpd, touch, tmp_path):
    (tmp_path / "touch.json").write_text(touch.json())
    for slot in (None, 4):
        ours, files = (openmpd.solve_touch(one, slot=slot, backend="cpu") for one in (touch, tmp_path / "touch.json"))
        assert np.array_equal(ours.vector, files.vector) and ours.pressures[0] == pytest.approx(touch.fingers[0].pressures[touch.order[slot or 0]], rel=1e-4)
    refused(lambda: openmpd.solve_touch(touch, slot=99, backend="cpu"), "slot", "touch")
    with pytest.raises(palpa.BadInput, match="no finger"):
        openmpd.solve_touch(palpa.Scene("assets/cube.glb").touch([0, 1, 0], backend="cpu"), backend="cpu")


def test_lists_planes_and_lines_keep_the_frame(openmpd, twin, touch):
    foci, drive = touch.fingers[0].foci, np.ones(256)
    own = openmpd.from_world(foci)
    line, plane = palpa.line(foci[0], foci[1], samples=2), palpa.plane("xz", centre=foci[0], size=(0.01, 0.01), pixels=(2, 2))
    for where in (line, plane, line.points, list(foci), tuple(foci[:2]), [foci[0], (0, 0, 0.1)], pickle.loads(pickle.dumps(line))):
        refused(lambda where=where: openmpd.field(drive, where, backend="cpu"), "where", "in the world", "layout openmpd")
    for ours in (palpa.line(own[0], own[1], samples=2), list(own), pickle.loads(pickle.dumps(palpa.line(own[0], own[1], samples=2)))):
        assert openmpd.field(drive, ours, backend="cpu").peak > 0
        refused(lambda ours=ours: twin.field(drive, ours, backend="cpu"), "openmpd", TWIN)
        refused(lambda ours=ours: palpa.scatter("assets/finger.ply", layout=twin, drive=drive, where=ours), "where", "openmpd", TWIN)
    refused(lambda: openmpd.solve([finger.centroid for finger in touch.fingers], backend="cpu"), "in the world")
    refused(lambda: palpa.Scene("assets/cube.glb").touch(list(own), backend="cpu"), "layout openmpd", "in the world")
    refused(lambda: openmpd.solve([own[0], foci[0]], backend="cpu"), "in the world")
    refused(lambda: palpa.line(own[0], foci[0]), "start, end", "different frames, that of the layout openmpd and the world")
    # Plain points, and those of a layout that is in the world.
    paper = palpa.Layout("paper")
    assert palpa.line(foci[0], paper.solve(foci[1], backend="cpu").foci[0], samples=2).shape == (2,)
    plain = palpa.plane("xz", centre=np.asarray(foci[0]), size=(0.01, 0.01), pixels=(2, 2))
    assert type(plain.points) is np.ndarray and openmpd.field(drive, plain, backend="cpu").peak > 0
    assert openmpd.field(drive, np.stack(list(foci)), backend="cpu").peak > 0


def test_what_is_written_into_an_array_says_where_it_belongs(openmpd, twin, touch):
    foci = touch.fingers[0].foci
    own = openmpd.from_world(foci)
    filled, partly, view, copied = (foci.copy() for _ in range(4))
    filled[:] = own
    partly[0] = own[0]
    view[:2][:] = own[:2]
    np.copyto(copied, own)
    right = openmpd.solve(own, solver="gs-pat", backend="cpu").foci
    for points in (filled, copied):
        assert np.allclose(openmpd.solve(points, solver="gs-pat", backend="cpu").foci, right)
    refused(lambda: twin.solve(filled, backend="cpu"), "openmpd", TWIN)
    assert partly.of is view.of is copied.of is None and foci.of == "world"
    out = foci.copy()
    np.add(own, 0, out=out)
    assert out.of is None
    for write in (lambda a: a.flat.__setitem__(slice(None), own.ravel()), lambda a: setattr(a, "flat", own), lambda a: a.put(range(a.size), own), lambda a: a.fill(0.1)):
        copy = foci.copy()
        write(copy)
        assert copy.of is None
    assert foci.flat[0] == foci[0, 0] and foci.of == "world"
    # What stays in its frame, and single numbers.
    same = foci.copy()
    same[0], same[1, 2] = foci[1], 0.2
    refused(lambda: openmpd.solve(same, backend="cpu"), "in the world")
    one, other = openmpd.drive([0, 0, 0.15], backend="cpu"), twin.drive([0, 0, 0.15], backend="cpu")
    drive = one.copy()
    drive[3] = 0
    refused(lambda: twin.field(drive, [0, 0, 0.1], backend="cpu"), "openmpd", TWIN)
    drive[:] = other
    refused(lambda: openmpd.field(drive, [0, 0, 0.1], backend="cpu"), "openmpd", TWIN)
    assert twin.field(drive, [0, 0, 0.1], backend="cpu").peak > 0
