"""Every key of a study's plan changes what the commands make of the plan: its JSON, the level, or what a rehearsal writes."""
import re

import pytest

from commands import ROOT, run

PLAN = {
    "": {"title": '"Two shapes"', "language": '"en"'},
    "shape.0": {"name": '"cube"', "model": '"palpa:cube.glb"', "labels": '{ de = "Wuerfel" }'}, "shape.1": {"name": '"prism"', "model": '"palpa:prism.glb"'},
    "method.0": {"name": '"one"', "method": '"single-focus"', "layout": '"openmpd"', "modulation_hz": "200"},
    "method.1": {"name": '"other"', "method": '"cross-section"', "layout": '"openmpd"', "foci": "8", "stride": "3", "dwell_ms": "1.5", "delta_mm": "1.5"},
    "study": {"participants": "4", "trials_per_shape": "3", "touch_s": "5", "least_trials": "4"},
    "run": {"order": '"alternate"', "seed": "3", "deep_mm": "15", "masking": '"white"', "axes": '"steady"', "smoothing": '"one-euro"', "hysteresis": '"on"', "predict": "true", "ask_depth_frames": "false"},
    "level": {"ceiling": "0.1", "limit_db": "150", "measured_db": "100", "measured_ceiling": "0.1", "left_ear_mm": "[-80, 300, 650]", "right_ear_mm": "[80, 300, 650]"},
    "block.0": {"kind": '"practice"', "shapes": '["prism"]', "repeats": "1", "touch_s": "4", "feedback": "true", "once": "true", "text": '"Touch it."'},
    "block.1": {"kind": '"trial"', "repeats": "3", "touch_s": "5", "apart": "false"}, "block.2": {"kind": '"rest"', "rest_s": "20"}}
CHANGES = {
    "title": '"Two other shapes"', "shape.0.name": '"box"', "method.0.name": '"single"', "method.0.method": '"multi-focus"', "method.0.layout": '"autd3"',
    "method.0.modulation_hz": "150", "method.1.foci": "7", "method.1.stride": "1", "method.1.dwell_ms": "2", "method.1.delta_mm": "2", "study.participants": "3", "study.least_trials": "5",
    "run.order": '"halves"', "run.seed": "4", "run.masking": '"off"', "level.ceiling": "0.2", "level.limit_db": "149", "level.measured_db": "101",
    "level.measured_ceiling": "0.2", "block.0.shapes": '["cube"]', "block.0.repeats": "2", "block.0.touch_s": "3", "block.0.once": "false", "block.1.repeats": "2",
    "block.1.touch_s": "6", "block.1.apart": "true", "block.2.rest_s": "30", "run.deep_mm": "10"}
# What only a person sees, or a sitting does.
ELSEWHERE = {"language": "viewer/study/test_screens.cpp", "shape.0.labels": "viewer/study/test_screens.cpp", "run.ask_depth_frames": "study/test_sitting.cpp", "block.0.feedback": "viewer/study/test_screens.cpp",
             "block.0.text": "study/test_sitting.cpp", "shape.0.model": "viewer/study/test_shapes.cpp",
             **dict.fromkeys(("run.axes", "run.smoothing", "run.hysteresis", "run.predict"), "viewer/study/test_plan_options.cpp"), "study.trials_per_shape": "its blocks say how often", "study.touch_s": "its blocks say how long",
             "level.left_ear_mm": "a reading replaces the prediction: test_unlike_people.py", "level.right_ear_mm": "the same"}


def text_of(plan):
    lines = []
    for table, keys in plan.items():
        kind = table.partition(".")[0]
        lines += [f"[[{kind}]]" if "." in table else f"[{kind}]"] if table else []
        lines += [f"{key} = {value}" for key, value in keys.items()]
    return "\n".join(lines) + "\n"


def rehearsed(file):
    out = file.parent / f"{file.stem}-out"
    run(["study", "rehearse", str(file), "--participant", "2", "--out", str(out), "--quiet"])
    return {str(path.relative_to(out)): path.read_text() for path in sorted(out.rglob("*")) if path.is_file()}


# The first one is the quickest.
MAKERS = [rehearsed, *(lambda file, command=command: run(["study", command, str(file), "--json", "-", "--quiet"]) for command in ("plan", "level"))]


def without_sums(made):
    """Without the sum of the plan's text, and the time of day."""
    return re.sub(r'\b[0-9a-f]{64}\b|(?<=\\t)[0-9a-f]{8}\b|(?<=Crc32": ")[0-9a-f]{8}|\d{4}-\d\d-\d\dT[\d:.]+Z?', "", str(made))


def changed(key):
    table, _, name = key.rpartition(".")
    plan = {one: dict(keys) for one, keys in PLAN.items()}
    plan[table][name] = CHANGES[key]
    return plan


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    file = tmp_path_factory.mktemp("plan") / "base.toml"
    file.write_text(text_of(PLAN))
    return file, [without_sums(make(file)) for make in MAKERS]


@pytest.mark.parametrize("key", CHANGES)
def test_a_key_changes_what_is_made(key, base):
    file = base[0].with_name(f"{key}.toml")
    file.write_text(text_of(changed(key)))
    assert any(without_sums(make(file)).replace(file.stem, "base") != before for make, before in zip(MAKERS, base[1]))


def test_the_same_plan_makes_the_same(base):
    file = base[0].with_name("same.toml")
    file.write_text(text_of(PLAN))
    assert [without_sums(make(file)).replace("same", "base") for make in MAKERS] == [one.replace("same", "base") for one in base[1]]


def test_every_key_is_tried():
    given = {f"{table}.{key}".lstrip(".") for table, keys in PLAN.items() for key in keys}
    twins = {"shape.1.name", "shape.1.model", "method.1.name", "method.1.method", "method.1.layout", "block.0.kind", "block.1.kind", "block.2.kind"}
    assert given == set(CHANGES) | set(ELSEWHERE) | twins
    source = "".join((ROOT / "engine/study/plan" / name).read_text() for name in ("plan_tables.cpp", "plan_file.cpp"))
    read = set(re.findall(r'(?:table|one|top)\.(?:text|number|flag|whole|numbers|texts|text_or|number_or|flag_or|table)\(\s*"(\w+)"', source))
    known = {key.rpartition(".")[2] for key in given} | {"study", "run", "level", "texts", "observer", "fit", "placements", "lateral_mm", "yaw_deg", "crest_mn", "accuracy", "trials", "depths_mm", "other_crests_mn"}
    assert len(read) > 30 and read <= known, "a new key needs an entry"
