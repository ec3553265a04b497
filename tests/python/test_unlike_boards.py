"""A layout of three unlike boards and single transducers: each board's transducers, drives and sound are those of the board
alone, in every order of the boards, and each key of a board changes its own part only."""
import itertools
import json

import numpy as np
import pytest

import palpa
from commands import run

pytestmark = pytest.mark.filterwarnings("ignore::palpa.PalpaWarning")
UNITS = {
    "openmpd": {"type": "openmpd", "position_m": [0.02, -0.01, 0.005], "quaternion_wxyz": [0.9914448613738104, 0.1305261922200516, 0, 0]},
    "autd3": {"type": "autd3", "position_m": [-0.19, 0.01, 0.02], "quaternion_wxyz": [0.9659258262890683, 0, 0.2588190451025207, 0]},
    "sonicsurface": {"type": "sonicsurface", "position_m": [0.21, 0.03, 0.04], "quaternion_wxyz": [0.9659258262890683, 0, -0.2588190451025207, 0]}}
SINGLE = [{"position_m": [0.0, 0.3, 0.05], "axis": [0.0, -0.6, 0.8]}, {"position_m": [0.01, -0.3, 0.04], "axis": [0.0, 0.6, 0.8]}]
ORDERS = list(itertools.permutations(UNITS))
FOCI = [[0.0, 0.0, 0.16], [0.015, -0.01, 0.14]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("boards")


def file_of(folder, order, **changes):
    tables = [("unit", UNITS[name] | changes.get(name, {})) for name in order] + [("transducer", one) for one in (SINGLE if len(order) > 1 else [])]
    file = folder / f"{'-'.join(order)}.toml"
    file.write_text("".join(f"[[{kind}]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items()) for kind, keys in tables))
    return file


def test_every_type_of_board_is_here(folder):
    (folder / "unknown.toml").write_text('[[unit]]\ntype = "unknown"\nposition_m = [0, 0, 0]\nquaternion_wxyz = [1, 0, 0, 0]\n')
    with pytest.raises(palpa.Error) as fault:
        palpa.Layout(folder / "unknown.toml")
    assert set(str(fault.value).partition("known: ")[2].split(", ")) == set(UNITS)


def layout_of(folder, order, **changes):
    return palpa.Layout(file_of(folder, order, **changes))


def parts_of(layout, order, values):
    """{board: its part of an array over transducers}, and that of the single ones."""
    ends = np.cumsum([0] + [board["count"] for board in layout.boards])
    assert [board["first"] for board in layout.boards] == ends[:-1].tolist()
    return {name: np.asarray(values)[first:end] for name, first, end in zip([*order, "single"], ends, [*ends[1:], len(layout)])}


def same(parts, others, **near):
    return parts.keys() == others.keys() and all(np.allclose(parts[name], others[name], **near) for name in parts)


def test_each_board_is_where_it_is_alone(folder):
    alone = {name: layout_of(folder, (name,)) for name in UNITS}
    for order in ORDERS:
        layout = layout_of(folder, order)
        for name, board in zip(order, layout.boards):
            one, = alone[name].boards
            assert board["type"] == name and board["size"] == one["size"] and np.array_equal(board["pose"], one["pose"])
            for values, its in ((layout.positions, alone[name].positions), (layout.axes, alone[name].axes), (layout.transfer(FOCI).T, alone[name].transfer(FOCI).T)):
                assert np.array_equal(parts_of(layout, order, values)[name], its)
        moved = layout.moved([[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]])
        for name, board in zip(order, moved.boards):
            assert np.allclose(board["pose"][:3, 3], np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) @ UNITS[name]["position_m"] + [0.1, 0.2, 0.3])


OTHER = {"type": "autd3", "position_m": [0.02, -0.01, -0.3], "quaternion_wxyz": [1, 0, 0, 0]}


@pytest.mark.parametrize("name, key", itertools.product(UNITS, OTHER))
def test_a_key_of_a_board_changes_only_its_transducers(folder, name, key):
    if UNITS[name][key] == OTHER[key]:
        return
    before, after = layout_of(folder, ORDERS[0]), layout_of(folder, ORDERS[0], **{name: {key: OTHER[key]}})
    assert {other for other, part in parts_of(after, ORDERS[0], after.transfer(FOCI).T).items()
            if not np.array_equal(part, parts_of(before, ORDERS[0], before.transfer(FOCI).T)[other])} == {name}


SOLVERS = [{}, {"solver": "naive", "constraint": "normalise"}, {"solver": "gs-pat"}, {"solver": "greedy"}, {"solver": "gs-pat", "pressure": 300}, {"solver": "eigenvalue", "amplitude": "uniform"}, {"constraint": "uniform"}, {"directivity": "piston"},
           {"nulls": [[0.0, 0.04, 0.15]]}]


@pytest.mark.parametrize("options", SOLVERS, ids=str)
def test_drives_and_their_sound_do_not_depend_on_the_order(folder, options):
    first, *others = (layout_of(folder, order) for order in ORDERS)
    solved = first.solve(FOCI, backend="cpu", **options)
    parts, sound = parts_of(first, ORDERS[0], solved.vector), first.field(solved, FOCI, backend="cpu").pressure
    # They take one transducer after the other, or begin with some of them, so that other drives may be as good.
    one_by_one, seeks = options.get("solver") == "greedy", options.get("solver", "gs-pat") == "gs-pat" and not {"pressure", "nulls"} & set(options)
    near = {"rtol": 0.15} if one_by_one else {"rtol": 0.02} if seeks else {"rtol": 5e-3}
    for order, layout in zip(ORDERS[1:], others):
        again = layout.solve(FOCI, backend="cpu", **options)
        heard = layout.field(again, FOCI, backend="cpu").pressure
        turn = sound[0] / heard[0] / abs(sound[0] / heard[0])  # the phase of all is free
        if not one_by_one and not seeks:
            assert same({name: part * turn for name, part in parts_of(layout, order, again.vector).items()}, parts, atol=5e-3)
        assert np.allclose(again.pressures, solved.pressures, **near) and np.allclose(np.abs(heard), np.abs(sound), **near)


def test_files_of_a_drive_have_each_board_at_its_place(folder):
    for order in ORDERS:
        layout = layout_of(folder, order)
        drive = layout.drive(FOCI[0], backend="cpu")
        layout.write_drive(folder / "drive.csv", drive)
        assert same(parts_of(layout, order, layout.read_drive(folder / "drive.csv")), parts_of(layout, order, drive), atol=1e-6)
        told = json.loads(run(["drive", "--layout", str(file_of(folder, order)), "--focus", "0,0,0.16", "--backend", "cpu", "--json", "-"]))
        assert np.allclose(np.array(told["amplitudes"]) * np.exp(1j * np.array(told["phases_rad"])), drive, atol=1e-5)


def touch_level(folder, order, **options):
    touch = palpa.Scene("assets/cube.glb").touch("assets/finger.ply", penetration=3e-3, layout=file_of(folder, order), audible=True, backend="cpu", **options)
    told = json.loads(touch.json())
    return told["audible_dba"], told["fingers"][0]["pressures_pa"]


@pytest.mark.parametrize("options", [{}, {"method": "single-focus"}, {"pressure": 100}, {"steps": "off"}], ids=str)
def test_levels_and_pressures_do_not_depend_on_the_order(folder, options):
    level, pressures = touch_level(folder, ORDERS[0], **options)
    for order in ORDERS[1:]:
        other, its = touch_level(folder, order, **options)
        assert other == pytest.approx(level, abs=0.3) and np.allclose(its, pressures, rtol=5e-3)


def test_a_finger_among_unlike_boards_feels_the_same_in_each_order(folder, sphere):
    sphere(folder / "sphere.ply")
    ball = palpa.Mesh(folder / "sphere.ply")
    palpa.write_ply(folder / "tip.ply", 0.2 * ball.vertices + [0, 0.002, 0], ball.faces)
    felt = [palpa.simulate(palpa.Scene("assets/cube.glb"), folder / "tip.ply", penetration=1e-3, layout=file_of(folder, order), backend="cpu") for order in ORDERS[::2]]
    for other in felt[1:]:
        a, b = (json.loads(one.json()) for one in (felt[0], other))
        assert np.allclose(a["force_N"], b["force_N"], rtol=0.01, atol=1e-9) and a["langevin"]["peak_pa"] == pytest.approx(b["langevin"]["peak_pa"], rel=0.01)


def test_cameras_see_each_board_in_each_order(folder):
    """What hides a camera's view, what counts as surroundings, and what the doctor says of boards."""
    rig = "assets/rigs/openmpd-one.toml"

    def told(order):
        doctor = json.loads(run(["doctor", "--rig", rig, "--layout", str(file_of(folder, order)), "--backend", "cpu", "--json", "-", "--quiet"]))["rig"]
        exported = palpa.export("assets/cube.glb", "synthetic", rig=rig, layout=file_of(folder, order), frames=2, noise_free=True, backend="cpu")
        return [{key: row[key] for key in row if key not in ("hold", "advice")} for row in doctor], json.loads(exported.json())["dropped"]  # the target stands on the first
    first = told(ORDERS[0])
    assert first[0][0]["board"] > 0.01
    for order in (ORDERS[2], ORDERS[5]):
        assert told(order) == first


def test_boards_are_compared_each_with_the_first(folder):
    """Three boards that are turned differently, and transducers one after the other."""
    places = {"a": ([0, 0, 0], [1, 0, 0, 0]), "b": ([0.25, 0.0, 0.05], [0.9238795325, 0, -0.3826834324, 0]), "c": ([0.0, 0.25, 0.04], [0.9238795325, 0.3826834324, 0, 0])}
    k, place = 2 * np.pi * 40e3 / (331.3 * np.sqrt(1 + 20 / 273.15)), np.array([0.01, 0.02, 0.15])
    for order in ("abc", "cab"):
        file = folder / f"{order}.toml"
        file.write_text("".join(f'[[unit]]\ntype = "openmpd"\nposition_m = {places[name][0]}\nquaternion_wxyz = {places[name][1]}\n' for name in order))
        away = np.linalg.norm(palpa.Layout(file).positions - place, axis=1)
        test = ["link", "test", "--layout", str(file), "--link", f"record:{folder}/{order}.bin", "--each", "1ms", "--rest", "0", "--dwell", "1ms", "--quiet"]
        run([*test, "--compare", "0.01,0.02,0.15"])
        steps = {}
        for drive in drives_of(folder / f"{order}.bin"):
            sounds = [part.any() for part in np.split(drive[:, 0] > 0, 3)]
            if not any(sounds):
                continue
            turns = np.split((drive[:, 1] + k * away) / (2 * np.pi), 3)
            assert sounds[0] and sum(sounds) == 2
            board = 1 + sounds[1:].index(True)
            apart = turns[board][:, None] - turns[0][None]
            assert np.abs(np.angle(np.exp(2j * np.pi * (apart - apart[0, 0])))).max() < 5e-3, "both meet at the place"
            steps.setdefault(board, []).append(round(-16 * apart[0, 0]) % 16)
        in_order = {board: [step for step, _ in itertools.groupby(played)] for board, played in steps.items()}
        assert in_order == {1: list(range(16)), 2: list(range(16))}, "each earlier than before, as palpa says"
        (folder / f"{order}.bin").unlink()
        told = run([*test[:-1], "--first", "300", "--last", "302"])
        assert [line.split(" at ")[0] for line in told.splitlines()[:3]] == ["300", "301", "302"]
        for line, position in zip(told.splitlines(), palpa.Layout(file).positions[300:303]):
            assert np.allclose(np.array(line.split(" at ")[1].removesuffix(" mm").split(", "), float), 1e3 * position, atol=0.06)
        heard = [np.flatnonzero(drive[:, 0]).tolist() for drive in drives_of(folder / f"{order}.bin")]
        assert [one for one, _ in itertools.groupby(one for one in heard if one)] == [[300], [301], [302]]


def drives_of(file, transducers=768):
    data = file.read_bytes()
    return np.frombuffer(data[24:], np.dtype([("slot", "<u8"), ("drive", "<f4", (transducers, 2))]))["drive"]
