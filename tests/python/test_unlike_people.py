"""Several unlike fingers, hands, foci, nulls, places, participants, ears, shapes and methods: their order changes nothing but
the order of results."""
import itertools
import json
import shlex

import numpy as np
import pytest

import palpa
from commands import run
from tracked_hands import hand, one_finger

pytestmark = pytest.mark.filterwarnings("ignore::palpa.PalpaWarning")
FOCI = [("0,0,0.12", 1.0), ("0.03,-0.01,0.15", 0.4), ("-0.02,0.02,0.1", 0.7)]
NULLS = [("0,0.06,0.12", 0), ("0.05,0.05,0.14", 0.002), ("-0.06,0,0.12", 0.001)]


def told(line):
    return json.loads(run([*shlex.split(line), "--json", "-"]))


@pytest.mark.parametrize("solver", ["gs-pat", "eigenvalue", "loudest", "back-propagation"])
def test_foci_and_nulls_of_a_drive(solver):
    def drive(foci, nulls=()):
        words = " ".join([f"--focus {at},{gain}" for at, gain in foci] + [f"--null {at},{radius}" for at, radius in nulls])
        return told(f"drive --layout openmpd --backend cpu --solver {solver} {words}")
    nulls = NULLS if solver == "gs-pat" else []
    first = drive(FOCI, nulls)
    for order in itertools.permutations(range(3)):
        other = drive([FOCI[i] for i in order], [nulls[i] for i in order] if nulls else [])
        for key in ("foci_m", "gains"):
            assert other[key] == [first[key][i] for i in order]
        near = 0.02 if solver in ("gs-pat", "eigenvalue") else 0.1  # they stop somewhere near the best
        assert other["pressures_pa"] == pytest.approx([first["pressures_pa"][i] for i in order], rel=near)


def test_pressures_of_unlike_gains_follow_them():
    drive = told("drive --layout openmpd --backend cpu --solver gs-pat " + " ".join(f"--focus {at},{gain}" for at, gain in FOCI))
    shares = np.array(drive["pressures_pa"]) / [gain for _, gain in FOCI]
    assert shares == pytest.approx(shares.mean(), rel=0.02)


def test_places_of_a_field():
    layout = palpa.Layout("openmpd")
    drive = layout.drive([0, 0, 0.1], backend="cpu")
    points = np.array([[0, 0, 0.1], [0.01, 0.02, 0.12], [-0.05, 0, 0.2]])
    assert np.array_equal(layout.field(drive, points[::-1], backend="cpu").pressure[::-1], layout.field(drive, points, backend="cpu").pressure)
    assert np.array_equal(layout.transfer(points[::-1])[::-1], layout.transfer(points))


def test_hands_of_a_tracker(tmp_path):
    """Two unlike hands that press a cube at two places."""
    hands = {"left": (one_finger(0.001), -0.012), "right": (one_finger(0.002), 0.013)}

    def felt(sides):
        lines = []
        for frame in range(6):
            one = {"v": 1, "hands": [hand(np.array(hands[side][0]) + 0.0003 * frame - 0.001, hands[side][1], side) for side in sides]} | {"t_s": frame / 60}
            lines.append(json.dumps(one))
        file = tmp_path / f"{'-'.join(sides)}.jsonl"
        file.write_text("\n".join(lines) + "\n")
        foci = tmp_path / "foci.json"
        palpa.export("assets/cube.glb", f"joints:{file}", layout="openmpd", foci=foci, finger_gap=0.003, backend="cpu")
        return [sorted((finger["foci_m"], finger["order"], finger["gain"]) for finger in frame["fingers"]) for frame in json.loads(foci.read_text())["frames"]]
    both = felt(["left", "right"])
    assert max(map(len, both)) == 2 and felt(["right", "left"]) == both


SHAPES = ["cube", "semi-sphere", "pyramid", "prism"]
PEOPLE = [(12, 30), (20, 28), (9, 25), (26, 24)]  # right answers of 40, with each method


def write_study(folder, people):
    """As the logs of a study are."""
    for number, right in enumerate(people, 1):
        beh = folder / f"sub-{number}/beh"
        beh.mkdir(parents=True)
        for part, (method, count) in enumerate(zip(("single-focus", "cross-section"), right), 1):
            rows = ["onset\tduration\ttrial_type\tmethod\tshape\tanswer\tresponse_time\tstatus"]
            for k in range(40):
                answer = k % 4 if k * 7 % 40 < count else (k + 1 + count % 2) % 4
                rows.append(f"{1e-3 * number + 100 + 15 * k}\t10\ttrial\t{method}\t{SHAPES[k % 4]}\t{SHAPES[answer]}\t{1 + 0.001 * count * (k % 9)}\tanswered")
            name = beh / f"sub-{number}_task-shapes_run-{part}_events"
            name.with_suffix(".tsv").write_text("\n".join(rows) + "\n")
            name.with_suffix(".json").write_text(json.dumps({"PalpaStudyVersion": 1, "shape": {"Levels": dict.fromkeys(SHAPES, "")}}))
    return told(f"study analyse {folder} --quiet")


def test_each_participant_counts_once_and_for_itself(tmp_path):
    def rows_of(study):
        return sorted(json.dumps({key: one[key] for key in one if key not in ("participant", "name")}) for one in study["participants"])
    first, last = write_study(tmp_path / "first", PEOPLE), write_study(tmp_path / "last", PEOPLE[::-1])
    assert rows_of(last) == rows_of(first) and len(set(rows_of(first))) == 2 * len(PEOPLE)
    alone = [write_study(tmp_path / f"alone-{number}", [one]) for number, one in enumerate(PEOPLE)]
    assert sorted(itertools.chain(*map(rows_of, alone))) == rows_of(first)
    for number, (a, b) in enumerate(zip(first["methods"], last["methods"])):
        assert a["counts"] == b["counts"] == np.sum([one["methods"][number]["counts"] for one in alone], axis=0).tolist()
        for key in ("trials", "correct", "accuracy", "participants", "mean_accuracy", "p_chance"):
            assert a[key] == pytest.approx(b[key], rel=1e-12), key
    a, b = first["pairs"][0], last["pairs"][0]
    assert a["mean"] == pytest.approx(b["mean"], rel=1e-12) and a["differences"] == pytest.approx(b["differences"][::-1], rel=1e-12)


PLAN = {"shape": ['name = "a"\nmodel = "palpa:cube.glb"\n', 'name = "b"\nmodel = "palpa:prism.glb"\n', 'name = "c"\nmodel = "palpa:button-and-knob.glb"\n'],
        "method": ['name = "single-focus"\nlayout = "openmpd"\n', 'name = "cross-section"\nlayout = "autd3"\nfoci = 4\n', 'name = "multi-focus"\nlayout = "sonicsurface"\nfoci = 3\n'],
        "level": ["ceiling = 0.05\nlimit_db = 160\nleft_ear_mm = [-300, 120, 200]\nright_ear_mm = [80, 300, 650]\n"]}


def level(folder, **order):
    tables = PLAN | {kind: [PLAN[kind][i] for i in places] for kind, places in order.items()}
    file = folder / "plan.toml"
    file.write_text("".join(f"[[{kind}]]\n{one}" if kind != "level" else f"[level]\n{one}" for kind, ones in tables.items() for one in ones))
    return told(f"study level {file} --quiet"), file


def test_ears_shapes_and_methods_of_a_level(tmp_path):
    first, _ = level(tmp_path)
    assert first["left_db"] != pytest.approx(first["right_db"], abs=1)
    for order in ({"shape": [2, 0, 1]}, {"method": [1, 2, 0], "shape": [1, 0, 2]}):
        other, _ = level(tmp_path, **order)
        for key in ("left_db", "right_db", "level_db", "bound_db", "audible_dba"):
            assert other[key] == pytest.approx(first[key], abs=1e-6), (order, key)
    PLAN["level"] = [PLAN["level"][0].replace("left", "LEFT").replace("right", "left").replace("LEFT", "right")]
    swapped, _ = level(tmp_path)
    assert (swapped["left_db"], swapped["right_db"]) == pytest.approx((first["right_db"], first["left_db"]), abs=1e-9)
    assert swapped["audible_dba"] == pytest.approx(first["audible_dba"], abs=1e-9)


def test_counts_of_compared_studies_are_of_their_own(tmp_path):
    tables = {"one": [[5, 1], [2, 4]], "two": [[3, 3], [1, 5]], "three": [[6, 0], [0, 6]]}
    for name, counts in tables.items():
        (tmp_path / f"{name}.csv").write_text("shape,a,b\n" + "".join(f"{shape},{row[0]},{row[1]}\n" for shape, row in zip("ab", counts)))
    for order in itertools.permutations(tables):
        compared = told(f"study compare {' '.join(str(tmp_path / name) + '.csv' for name in order)} --quiet")
        assert [table["counts"] for table in compared["tables"]] == [tables[name] for name in order]


