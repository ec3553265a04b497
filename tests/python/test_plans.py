"""Plans of sweeps: results, ids, values and faults."""
import json
import re
import shutil

import pytest

import palpa
from commands import ROOT
from palpa._plan import Plan, find, path_fault

ASSETS = ROOT / "assets"


def test_what_a_path_finds():
    document = {"a": [3, 1.5, None, 2], "b": {"c": "text", "d": []}, "n": 0.1}
    found = {"a.count": 4, "a.0": 3, "a.7": None, "a.min": 1.5, "a.max": 3, "a.sum": 6.5, "a.mean": 6.5 / 3, "b.c": "text", "b.count": 2,
             "b.d.count": 0, "b.d.max": None, "b.d.0": None, "n": 0.1, "n.x": None, "x.y": None, "a": None, "a.2": None}
    assert {path: find(document, path) for path in found} == found


@pytest.mark.parametrize("name, path, says", [
    ("touch", "contacts.cuont", "did you mean contacts.count?"), ("touch", "contacts", "contacts is an object; name one of its entries, such as contacts.count"),
    ("drive", "pressures_pa", "pressures_pa is a list; name one of its entries, such as pressures_pa.0, or pressures_pa.count"),
    ("drive", "pressures_p.0", "did you mean pressures_pa.0?"), ("drive", "points", "a case of drive has no points"),
    ("touch", "fingers.0.spectrum.felt", "did you mean fingers.0.spectrum.f"), ("field", "timing_ms.total", "has no timing_ms.total"),
    ("field", "", "a case of field has no "), ("field", "peak_pa.max", "has no peak_pa.max"), ("drive", "count", "has no count"),
    ("touch", "fingers.0.foci_m.2.1", ""), ("touch", "fingers.count", ""), ("touch", "contacts.depths_m.mean", ""), ("touch", "contacts.min", "has no"),
    ("drive", "nulls.1.place_m.2", ""), ("drive", "nulls.0.radius_m", ""), ("drive", "nulls.count", ""), ("drive", "nulls.0.loudest_pa", ""), ("drive", "nulls.0.depth_db", ""),
    ("drive", "kept_with_nulls", ""), ("drive", "spread.nulls_pa.0.1", ""), ("drive", "solution.residual", ""), ("drive", "nulls.0.depth", "did you mean nulls.0.depth_db?"),
])
def test_paths(name, path, says):
    assert says in path_fault(name, path) and bool(says) == bool(path_fault(name, path))


# ---- ids ------------------------------------------------------------------------------------------------------------

@pytest.fixture
def ids(tmp_path):
    """The ids of a touch with files that name files."""
    for name in ("cube.glb", "finger.ply"):
        shutil.copy(ASSETS / name, tmp_path)
    (tmp_path / "model.gltf").write_text('{"buffers": [{"uri": "my%20data.bin", "byteLength": 4}, {"uri": "data:;base64,AAAA"}]}')
    (tmp_path / "my data.bin").write_text("abcd")
    (tmp_path / "layout.toml").write_text("[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n")
    (tmp_path / "rig.toml").write_text('[array]\nlayout = "layout.toml"\n')

    def of(options, backend="cpu", plan="plan.toml", **more):
        quoted = "".join(f"{name} = {json.dumps(value)}\n" for name, value in options.items())
        (tmp_path / plan).write_text("".join(f"{name} = {json.dumps(value)}\n" for name, value in ({"command": "touch"} | more).items())
                                     + f"[options]\n{quoted}[vary]\nfoci = [7, 9]\n")
        read = Plan(tmp_path / plan)
        return [read.id(settings, backend) for settings in read.cases()]
    return of


TOUCH = {"scene": "cube.glb", "points": "finger.ply"}


def test_an_id_is_that_of_what_is_computed(ids, tmp_path):
    before = ids(TOUCH)
    assert len(set(before)) == 2 and all(re.fullmatch("[0-9a-f]{20}", name) for name in before)
    # The names of files, the order of options and flags that are not given change nothing.
    shutil.copy(tmp_path / "cube.glb", tmp_path / "other.glb")
    assert ids({"points": "finger.ply", "scene": "other.glb", "tune": False}, plan="other.toml") == before
    # Contents, options, what is kept, the command and the backend do.
    others = [ids(TOUCH | {"seed": 1}), ids(TOUCH, results=["points"]), ids(TOUCH, keep="everything"), ids(TOUCH, "gpu"),
              ids({"scene": "cube.glb", "finger": "finger.ply"}, command="simulate")]
    (tmp_path / "finger.ply").write_bytes((tmp_path / "finger.ply").read_bytes() + b"\n")
    others.append(ids(TOUCH))
    assert len({name for of in [before, *others] for name in of}) == 14


@pytest.mark.parametrize("options, changed", [
    (TOUCH | {"scene": "model.gltf"}, "my data.bin"), ({"scene": "cube.glb", "depth": ["finger.ply"], "rig": "rig.toml"}, "layout.toml"),
    (TOUCH | {"layout": "layout.toml"}, "layout.toml")])
def test_files_that_files_name_count_too(ids, tmp_path, options, changed):
    before = ids(options)
    assert ids(options) == before
    (tmp_path / changed).write_bytes((tmp_path / changed).read_bytes() + b" ")
    assert not set(ids(options)) & set(before)


def test_a_rig_in_a_spread_is_a_file(tmp_path):
    seen, text = tmp_path / "seen.toml", "[[camera]]\nwidth = 4\nheight = 4\nfx = 4\nfy = 4\ncx = 2\ncy = 2\nresidual_m = 0.000"
    (tmp_path / "plan.toml").write_text('command = "drive"\n[options]\nlayout = "openmpd"\nfocus = "0,0,0.1"\nspread = "phase=0.1,position=seen.toml"\n')

    def case():
        read = Plan(tmp_path / "plan.toml")
        return read.id(read.cases()[0], "cpu"), read.ready(read.cases()[0])["spread"]
    seen.write_text(text + "3\n")
    before = case()
    assert before[1] == f"phase=0.1,position={seen}"
    seen.write_text(text + "4\n")
    assert case()[0] != before[0]


# ---- faults and values -----------------------------------------------------------------------------------------------

@pytest.mark.parametrize("text, says", [
    ("command = \"drive\"\nvery = 1", "unknown key very; did you mean vary?"), ("command = \"fly\"", "command is 'fly', but must be one of touch, drive"),
    ("[vary", "is not TOML"), ("results = [\"points\"]", "command is None"), ("command = \"drive\"\noptions = 3", "options must be a table"),
    ("results = 3\n{}", "results must be a list"), ("results = []\n{}", "results must be a list"), ("keep = \"all\"\n{}", "keep must be"),
    ("results = [\"foci_m\"]\n{}", "results: foci_m is a list; name one of its entries"), ("results = [\"gains.0\", \"gains.0\"]\n{}", "twice"),
    ("results = [\"pressures_p.0\"]\n{}", "results: a case of drive has no pressures_p.0; did you mean pressures_pa.0?"),
    ("{}tempreature = 3", "tempreature is not an option that a case of drive can have; did you mean temperature?"),
    ("{}backend = \"cpu\"", "backend is not an option"), ("{}json = \"x\"", "json is not an option"), ("{}temperature = \"\"", "must be a text or a finite"),
    ("{}temperature = []", "[options] temperature has an empty list"), ("{}temperature = [1, 2]", "temperature must be one value, not [1, 2]"),
    ("{}temperature = true", "[options] temperature must be a text or a finite number, not True"), ("{}temperature = nan", "finite"),
    ("{}temperature = \"warm\"", "[options] temperature: warm is not a number"), ("{}frequency = \"40mm\"", "not a number, alone or with Hz, kHz, MHz"),
    ("{}draws = 20.5", "20.5 is not a whole number"), ("{}force = 1", "[options] force must be true or false"),
    ("{}solver = \"gspat\"", "gspat is not one of its words; did you mean gs-pat?"), ("{}sound-speed = 340\nsound_speed = 1", ""),
    ("{}mesh = \"none.ply\"", "[options] mesh: "), ("{}mesh = \".\"", "is not a regular file"), ("command = \"drive\"\n[options]\nfocus = \"0,0,1\"",
                                                                                             "drive needs layout: set it in [options] or [vary]"),
    ("command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,1\"", "field needs plane or line or points"),
    ("command = \"touch\"\n[options]\nscene = \"{cube}\"", "touch needs points or depth"), ("command = \"drive\"\n[options]\nlayout = \"opnmpd\"", "openmpd"),
    ("{}[vary]\ntemperature = []", "[vary] temperature must be a list of values, or have from, to and count"),
    ("{}[vary]\ntemperature = 3", "must be a list"), ("{}[vary]\ntemperature = [20, 25, \"20\"]", "[vary] temperature has a value twice: 20"),
    ("{}[vary]\nfocus = [\"0,0,0.2\"]", "focus is set in [options] and in focus of [vary]"), ("{}[vary]\nair = [{{}}]", "has an empty table"),
    ("{}[vary]\nair = [{{ temperature = 20 }}]\ntemperature = [3]", "temperature is set in air of [vary] and in temperature of [vary]"),
    ("{}[vary]\ntemperature = {{ from = 1, to = 3 }}", "must have from, to and count, not from, to"),
    ("{}[vary]\ntemperature = {{ from = 1, to = 3, count = 1 }}", "count must be a whole number from 2 to 1,000,000"),
    ("{}[vary]\nfrequency = {{ from = \"1Hz\", to = \"3kHz\", count = 3 }}", "numbers with the same unit"),
    ("{}[vary]\ntemperature = {{ from = 1, to = 30, count = 40000 }}\nsound-speed = {{ from = 300, to = 390, count = 40000 }}",
     "has 1,600,000,000 cases (40,000 temperature x 40,000 sound_speed); a plan has at most 1,000,000"),
])
def test_plans(tmp_path, text, says):
    plan = tmp_path / "plan.toml"
    shutil.copy(ASSETS / "cube.glb", tmp_path)
    plan.write_text(text.format("command = \"drive\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,0.1\"\n", cube="cube.glb"))
    if not says:
        assert Plan(plan).cases()[0]["sound_speed"] == ("1",)
        return
    with pytest.raises(palpa.BadInput) as caught:
        palpa.sweep(plan, tmp_path / "out", backend="cpu")
    assert says in str(caught.value) and str(caught.value).startswith(f"{plan}: ") and caught.value.file == str(plan)
    assert "\n" not in str(caught.value) and not (tmp_path / "out").exists()


def test_encodings(tmp_path):
    text = "command = \"drive\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,0.1\"\n"
    for name, code in (("plan.toml", text), ("plan.py", "plan = {'command': 'drive', 'options': {'layout': 'openmpd', 'focus': '0,0,0.1'}}\n")):
        plan = tmp_path / name
        for encoding in ("utf-8", "utf-8-sig"):
            plan.write_bytes(code.replace("\n", "\r\n").encode(encoding))
            assert len(Plan(plan).cases()) == 1
        for encoding in ("utf-16", "utf-16-le", "utf-16-be"):
            plan.write_bytes(code.encode(encoding))
            with pytest.raises(palpa.BadInput) as caught:
                Plan(plan)
            assert str(caught.value) == f"{plan}: is text in UTF-16; save it as UTF-8" and caught.value.file == str(plan)


def test_values():
    read = Plan({"command": "field", "options": {"layout": "openmpd", "plane": "xz", "size": (0.1, 0.05), "focus": [[0, 0, 0.1], "0,0,12cm,0.5"]}, "vary": {
        "temperature": {"from": 15, "to": "16", "count": 4}, "frequency": {"from": "39kHz", "to": "41kHz", "count": 3}, "no-absorption": [True, False],
        "air": [{"humidity": 40, "air-pressure": "99kPa"}, {"humidity": 50.0}]}})
    cases = read.cases()
    assert len(cases) == 48 and read.varied == ["temperature", "frequency", "no_absorption", "humidity", "air_pressure"]
    assert [case["temperature"] for case in cases[::12]] == [("15",), ("15.3333333333",), ("15.6666666667",), ("16",)]
    assert [case["frequency"][0] for case in cases[:12:4]] == ["39kHz", "40kHz", "41kHz"]
    assert cases[0]["size"] == ("0.1,0.05",) and cases[0]["focus"] == ("0,0,0.1", "0,0,12cm,0.5")
    assert read.ready(cases[3]) == {"layout": "openmpd", "plane": "xz", "size": "0.1,0.05", "focus": ["0,0,0.1", "0,0,12cm,0.5"], "temperature": "15",
                                    "frequency": "39kHz", "humidity": "50"}
