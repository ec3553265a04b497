"""Sweeps: the command's numbers, ids, shards, what goes wrong, and bad plans."""
import csv
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

import pytest

import palpa
from commands import ROOT, TWIN, options_of, run
from palpa import _case, sweeps
from palpa._plan import Plan, path_fault

PLAN = """command = "drive"
results = ["weakest_to_strongest", "pressures_pa.0", "transducers"]
[options]
focus = ["0,0,100mm", "10mm,0,100mm"]
[vary]
layout = ["openmpd", "%s"]
solver = ["naive", "gs-pat", "adjoint"]
temperature = [20, 25]
""" % TWIN
DRIVE = {"command": "drive", "options": {"layout": "openmpd", "focus": "0,0,0.1"}}
ASSETS = ROOT / "assets"


@pytest.fixture(autouse=True)
def no_scheduler(monkeypatch):
    for name in ("SLURM_ARRAY_TASK_ID", *sweeps.RANKS, *sweeps.RANKS.values()):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def plan(tmp_path):
    file = tmp_path / "plan.toml"
    file.write_text(PLAN)
    return file


def command(*words, **more):
    return subprocess.run([sys.executable, "-m", "palpa.sweeps", *map(str, words)], capture_output=True, text=True, timeout=60, check=False, **more)


def states(rows):
    return [row["state"] for row in rows]


def lines_of(folder):
    return [json.loads(line) for file in sorted(folder.glob("*.jsonl")) for line in file.read_text().splitlines()]


# ---- numbers --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("line", [
    "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout openmpd --pressure 2kPa --spectrum --tune",
    "touch --scene assets/prism.glb --points assets/finger.ply --penetration 2mm --method multi-focus --layout openmpd",
    "touch --scene assets/cube.glb --depth assets/depth/hand.png --camera assets/depth/camera.toml",
    "touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --surface parts --parts 4 --internal-faces keep",
    "drive --layout openmpd --focus 0,0,15cm --focus 2cm,0,15cm,0.5 --solver greedy --seed 3",
    "drive --layout openmpd --focus 0,0,15cm --focus 1cm,0,15cm --spread amplitude=10%,phase=0.2 --draws 20 --seed 2",
    "drive --layout openmpd --focus 0,0,15cm --focus 2mm,0,15cm --null 3cm,0,15cm,2mm --null 0,3cm,15cm --spread phase=0.2 --draws 20",
    pytest.param("drive --layout paper --focus 0,0.2mm,0 --transfer finger --mesh assets/finger.ply", marks=pytest.mark.slow),
    "field --layout openmpd --focus 0,0,15cm --plane xy --centre 0,0,15cm --size 3cm,2cm --pixels 9,6 --no-absorption --solver gs-pat",
    "field --layout openmpd --focus 0,0,15cm --line 0,0,14cm 0,0,16cm --samples 9 --spread amplitude=10% --draws 20 --temperature 25",
    "field --layout autd3 --focus 0,0,200mm --points assets/finger.ply",
    "simulate --scene assets/cube.glb --finger {tip} --penetration 1mm --layout openmpd --spread phase=0.1 --draws 20 --temperature 22",
    pytest.param("simulate --scene assets/cube.glb --finger assets/finger.ply --foci 16 --tune --transfer finger", marks=pytest.mark.slow),
])
def test_a_case_is_the_command(line, sphere, tmp_path):
    """The same JSON, and every name in it may be a result."""
    sphere(tmp_path / "ball.ply")
    ball = palpa.Mesh(tmp_path / "ball.ply")
    palpa.write_ply(tmp_path / "tip.ply", 0.4 * ball.vertices + [0, 0.004, 0], ball.faces)
    words = shlex.split(line.format(tip=tmp_path / "tip.ply"))
    wanted = json.loads(run([*words, "--backend", "cpu", "--json", "-"]))
    one = Plan({"command": words[0], "keep": "everything", "options": options_of(words[1:])})
    made = _case.compute(_case.Task(one.command, {}, (), (), {"backend": "cpu"}), one.ready(one.cases()[0]))
    assert made["state"] == "done", made
    assert made["json"] == {name: value for name, value in wanted.items() if name not in ("timing_ms", "backend", "backend_why")}

    def paths(at, path):
        inside = at.items() if isinstance(at, dict) else enumerate(at) if isinstance(at, list) else ()
        return [path] * (not inside and at is not None) + [one for name, value in inside for one in paths(value, f"{path}.{name}".lstrip("."))]
    assert [path for path in paths(made["json"], "") if path_fault(words[0], path)] == []


# ---- tables ---------------------------------------------------------------------------------------------------------

def test_the_table_is_the_same_however_the_cases_are_divided(plan, tmp_path):
    tables = []
    for count in (1, 2, 7):
        out = tmp_path / f"out-{count}"
        rows = [row for index in reversed(range(count)) for row in palpa.sweep(plan, out, shard=(index, count), backend="cpu")]
        assert len(rows) == 12 and states(rows).count("refused") == 4 and len(lines_of(out)) == 12
        gathered = palpa.gather(plan, out, out / "t.csv")
        assert sorted(gathered, key=lambda row: row["id"]) == sorted(rows, key=lambda row: row["id"])
        tables.append((out / "t.csv").read_bytes())
    palpa.sweep(plan, tmp_path / "pool", workers=2, backend="cpu")
    palpa.gather(plan, tmp_path / "pool", tmp_path / "t.csv")
    tables.append((tmp_path / "t.csv").read_bytes())
    assert len(set(tables)) == 1
    rows = list(csv.DictReader(tables[0].decode().splitlines()))
    assert [row["temperature"] for row in rows] == ["20", "25"] * 6 and [row["layout"] for row in rows] == ["openmpd"] * 6 + [TWIN] * 6
    drive = palpa.Layout("openmpd").solve([[0, 0, 0.1], [0.01, 0, 0.1]], solver="gs-pat", temperature=25, backend="cpu")
    assert float(rows[3]["pressures_pa.0"]) == json.loads(drive.json())["pressures_pa"][0] and rows[3]["error"] == ""
    assert rows[4]["state"] == "refused" and rows[4]["pressures_pa.0"] == "" and "finger is missing" in rows[4]["error"]


def test_rows(plan):
    row = palpa.sweep(plan, backend="cpu", shard="0/12")[0]
    assert row["temperature"] == 20 and row["layout"] == "openmpd" and row["error"] is None and row["transducers"] == 256
    pandas = pytest.importorskip("pandas")
    assert list(pandas.DataFrame([row])) == ["id", "layout", "solver", "temperature", "weakest_to_strongest", "pressures_pa.0", "transducers", "state",
                                             "error"]


def test_a_sweep_goes_on(plan, tmp_path):
    out, called = tmp_path / "out", []
    first = palpa.sweep(plan, out, shard=(0, 3), backend="cpu", after=lambda *numbers: called.append(numbers))
    assert called == [(1, 4), (2, 4), (3, 4), (4, 4)]
    with pytest.raises(palpa.Error, match="out: 8 of 12 cases have no result yet"):
        palpa.gather(plan, out, tmp_path / "t.csv")
    assert not (tmp_path / "t.csv").exists()
    assert palpa.gather(plan, out, tmp_path / "t.csv", partial=True) == first
    # The last line is torn, and another one is no JSON.
    file = out / "shard-0-of-3.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join([b"\0\0\0\n", *lines[1:3], lines[3][:-9]]))
    again = []
    assert palpa.sweep(plan, out, shard=(0, 3), backend="cpu", after=lambda *numbers: again.append(numbers)) == first and len(again) == 2
    assert palpa.sweep(plan, out, shard=(0, 3), backend="cpu", after=again.append) == first and len(again) == 2
    # Other shards and more values use what is there.
    plan.write_text(PLAN.replace("20, 25", "25, 20, 15"))
    assert len(palpa.sweep(plan, out, backend="cpu", after=lambda *numbers: again.append(numbers))) == 18
    assert again[-1] == (14, 14)


def test_everything_is_kept(tmp_path):
    everything = DRIVE | {"keep": "everything"}
    assert palpa.sweep(everything, tmp_path, backend="cpu")[0]["amplitudes.max"] == 1
    rows = palpa.gather(everything | {"results": ["phases_rad.count", "gains.0"]}, tmp_path)
    assert rows[0]["phases_rad.count"] == 256 and rows[0]["gains.0"] == 1
    with pytest.raises(palpa.Error, match="has no result of this plan"):
        palpa.gather(DRIVE, tmp_path)


def test_nulls_may_vary(tmp_path, openmpd):
    focus, nulls = [0.01, 0, 0.15], [[0, 0, 0.15], [-0.01, 0, 0.15]]
    drives = palpa.sweep({"command": "drive", "options": {"layout": "openmpd", "focus": "1cm,0,15cm"}, "vary": {"null": [["0,0,15cm,0.1mm", "-1cm,0,15cm"], "0,0,15cm"]},
                          "results": ["phases_rad.0"]}, backend="cpu")
    expected = [openmpd.solve(focus, nulls=nulls, null_radius=[1e-4, 0], backend="cpu"), openmpd.solve(focus, nulls=nulls[:1], backend="cpu")]
    assert [row["phases_rad.0"] for row in drives] == [json.loads(one.json())["phases_rad"][0] for one in expected]
    field = palpa.sweep({"command": "field", "options": {"layout": "openmpd", "focus": "1cm,0,15cm", "null": "0,0,15cm", "line": ["0,0,0.15", "0,0,0.16"], "samples": 2},
                         "results": ["peak_pa"]}, backend="cpu")
    assert field[0]["peak_pa"] == openmpd.field(openmpd.solve(focus, nulls=nulls[0], backend="cpu"), palpa.line([0, 0, 0.15], [0, 0, 0.16], samples=2), backend="cpu").peak


def test_a_table_replaces_no_input_and_no_result(plan, tmp_path, openmpd):
    drive = tmp_path / "drive.csv"
    openmpd.write_drive(drive, openmpd.drive([0, 0, 0.1], backend="cpu"))
    plan.write_text('command = "field"\n[options]\nlayout = "openmpd"\ndrive = "drive.csv"\nline = ["0,0,0.1", "0,0,0.2"]\nsamples = 3\n')
    assert states(palpa.sweep(plan, tmp_path / "out", backend="cpu")) == ["done"]
    for file, what in ((drive, "an input of the plan"), (plan, "an input of the plan"), (tmp_path / "out/shard-0-of-1.jsonl", "one of the results")):
        before = file.read_bytes()
        with pytest.raises(palpa.BadUsage, match=f"{file.name}: is {what}"):
            palpa.gather(plan, tmp_path / "out", file)
        assert file.read_bytes() == before
    with pytest.raises(palpa.Error, match="none/t.csv: cannot be written: No such file"):
        palpa.gather(plan, tmp_path / "out", tmp_path / "none/t.csv")


def test_results_of_both_backends_are_not_mixed(tmp_path):
    rows = {backend: palpa.sweep(DRIVE, tmp_path, backend=backend) for backend in ("cpu", "gpu")}
    assert rows["cpu"][0]["id"] != rows["gpu"][0]["id"]
    with pytest.raises(palpa.BadUsage, match="has results of cpu and of gpu"):
        palpa.gather(DRIVE, tmp_path)
    assert palpa.gather(DRIVE, tmp_path, backend="gpu") == rows["gpu"]
    assert palpa.sweep(DRIVE)[0]["id"] == rows["gpu"][0]["id"]  # PALPA_BACKEND
    assert palpa.sweep(DRIVE, backend="auto", gpu="0")[0]["id"] == rows["gpu"][0]["id"]
    for workers in (1, 2):
        with pytest.raises(palpa.NoDevice):
            palpa.sweep(DRIVE, tmp_path / "none", backend="gpu", gpu=["no such GPU"], workers=workers)
    assert not list(tmp_path.glob("none/*.jsonl"))


# ---- plans that Python makes ----------------------------------------------------------------------------------------

def test_derived_values_and_constraints():
    """Coprime strides, and a dwell with which every order takes as long."""
    orders = [{"foci": foci, "stride": stride, "dwell": 15e-3 / foci} for foci in (9, 10) for stride in range(1, 5) if math.gcd(foci, stride) == 1]
    rows = palpa.sweep({"command": "touch", "results": ["schedule.dwell_s", "fingers.0.foci_m.count"], "vary": {"order": orders}, "options": {
        "scene": ASSETS / "cube.glb", "points": str(ASSETS / "finger.ply"), "penetration": 3e-3}}, backend="cpu")
    assert [(row["foci"], row["stride"]) for row in rows] == [(9, 1), (9, 2), (9, 4), (10, 1), (10, 3)] and states(rows) == ["done"] * 5
    assert all(row["schedule.dwell_s"] == pytest.approx(15e-3 / row["foci"]) and row["fingers.0.foci_m.count"] == row["foci"] for row in rows)


def test_a_plan_may_be_a_python_file(tmp_path):
    file = tmp_path / "plan.py"
    file.write_text('import random\nnumbers = random.Random(1)\nplan = {"command": "drive", "options": {"layout": "openmpd", "focus": [0, 0, 0.1]},\n'
                    '        "vary": {"temperature": [round(numbers.uniform(15, 25), 3) for _ in range(3)]}}\n')
    rows = palpa.sweep(file, backend="cpu")
    assert [row["temperature"] for row in rows] == [16.344, 23.474, 22.638] and states(rows) == ["done"] * 3
    for text, says in (("plan = 3", "is not a table"), ("x = 1", "no dict that is called plan"), ("plan = {", "is not Python")):
        file.write_text(text)
        with pytest.raises(palpa.BadInput, match=says):
            palpa.sweep(file, backend="cpu")


def own(function, version="1", **more):
    return DRIVE | {"functions": {"mine": {"function": function, "version": version}}, "vary": {"solver": ["naive", "mine"], **more}}


def quiet(matrix, gains):
    return 0.5 * (matrix[0].conj() / abs(matrix[0]).max())


def deadly(matrix, gains):
    """Ends its process, at the first call or at every one, as the first file that it finds says."""
    once = pathlib.Path(os.environ["PALPA_DEADLY"])
    if once.name == "always" or not once.exists():
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return quiet(matrix, gains)


def broken(matrix, gains):
    raise RuntimeError("no\nsolution")


def test_own_functions(tmp_path):
    rows = palpa.sweep(own(quiet), tmp_path, backend="cpu")
    assert states(rows) == ["done", "done"] and rows[1]["solver"] == "mine" and rows[1]["amplitudes.max"] == pytest.approx(0.5, rel=1e-3)
    assert palpa.sweep(own(quiet), workers=2, backend="cpu") == rows
    assert palpa.sweep(own(broken), tmp_path, backend="cpu") == rows  # the version says that it is the same
    other = palpa.sweep(own(broken, 2), tmp_path, backend="cpu")
    assert states(other) == ["done", "failed"] and other[1]["error"] == "RuntimeError: no\nsolution" and other[1]["id"] != rows[1]["id"]
    assert states(palpa.sweep(own(quiet, 2), tmp_path, backend="cpu")) == ["done", "done"]  # what failed is computed again
    assert len(lines_of(tmp_path)) == 4
    with pytest.raises(palpa.BadUsage, match="functions: cannot be sent to other processes: .*; define them in a module"):
        palpa.sweep(own(lambda matrix, gains: matrix[0]), workers=2, backend="cpu")
    for wrong in ({"function": quiet}, {"function": quiet, "version": ""}, quiet, {"function": "quiet", "version": "1"}):
        with pytest.raises(palpa.BadInput, match="functions: mine must be"):
            palpa.sweep(DRIVE | {"functions": {"mine": wrong}}, backend="cpu")


def loud(matrix, gains):
    return matrix[0].conj() / abs(matrix[0]).max()


def pair(finger):
    return finger.positions[:2]


def five(finger):
    return finger.positions[:5]


LINE = DRIVE["options"] | {"line": ["0,0,0.09", "0,0,0.11"], "samples": 3}
TOUCH = {"scene": ASSETS / "cube.glb", "points": ASSETS / "finger.ply", "penetration": 2e-3}


@pytest.mark.parametrize("command, options, option, usual, functions, path, ratio", [
    ("drive", DRIVE["options"], "solver", "naive", (quiet, loud), "amplitudes.max", 2), ("field", LINE, "solver", "naive", (quiet, loud), "peak_pa", 2),
    ("touch", TOUCH, "method", "single-focus", (pair, five), "fingers.0.foci_m.count", 2.5)])
def test_another_version_of_an_own_function_is_another_case(command, options, option, usual, functions, path, ratio, tmp_path):
    def made(version):
        return palpa.sweep({"command": command, "options": options, "vary": {option: [usual, "mine"]}, "results": [path],
                            "functions": {"mine": {"function": functions[version], "version": version}}}, tmp_path, backend="cpu")
    rows = [made(version) for version in (0, 1)]
    assert states(rows[0] + rows[1]) == ["done"] * 4 and rows[0][0] == rows[1][0]
    assert rows[1][1][path] == pytest.approx(ratio * rows[0][1][path], rel=1e-3) and len(lines_of(tmp_path)) == 3


@pytest.mark.parametrize("which", ["once", "always"])
def test_a_killed_process_loses_its_case_only(which, tmp_path, monkeypatch):
    monkeypatch.setenv("PALPA_DEADLY", str(tmp_path / which))
    rows = palpa.sweep(own(deadly, temperature=[20]), tmp_path / "out", workers=2, backend="cpu")
    assert states(rows) == ["done", "done" if which == "once" else "failed"] and len(lines_of(tmp_path / "out")) == 2
    assert which == "once" or rows[1]["error"] == "its process ended twice, at last with exit code -9"


def test_a_program_must_be_importable(tmp_path):
    (tmp_path / "many.py").write_text(f"import palpa\npalpa.sweep({DRIVE!r}, workers=2, backend='cpu')\n")
    done = subprocess.run([sys.executable, tmp_path / "many.py"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "a process cannot start: call palpa.sweep with workers under if __name__" in done.stderr.splitlines()[-1]


# ---- ends and other processes ---------------------------------------------------------------------------------------

LONG = ("command = \"field\"\n[options]\nfocus = \"0,0,0.1\"\nlayout = \"paper\"\nplane = \"xz\"\nsize = \"0.1,0.1\"\npixels = \"100,100\"\n"
        "[vary]\ntemperature = { from = 1, to = 30, count = 300 }\n")


@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_loses_what_is_being_computed(tmp_path, workers):
    plan, out = tmp_path / "plan.toml", tmp_path / "out"
    plan.write_text(LONG)
    words = [sys.executable, "-m", "palpa.sweeps", plan, "--out", out, "--backend", "cpu", "--workers", str(workers)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        end = time.monotonic() + 120
        while not any(file.stat().st_size for file in out.glob("*.jsonl")) and time.monotonic() < end:
            time.sleep(0.05)
        with pytest.raises(palpa.BadUsage, match="shard-0-of-1.jsonl: another process computes this shard"):
            palpa.sweep(plan, out, backend="cpu")
        os.killpg(process.pid, signal.SIGINT)
        printed = process.communicate(timeout=120)
    assert printed == ("", "palpa.sweeps: interrupted; the same command continues\n") and process.returncode == 130
    assert 0 < len(lines_of(out)) < 300 and {line["state"] for line in lines_of(out)} == {"done"}


def test_ctrl_c_does_not_end_a_process_that_starts(tmp_path):
    """Here it comes while the process imports the program, which is before work()."""
    (tmp_path / "many.py").write_text("import os, signal, palpa\nif __name__ == '__mp_main__': os.kill(os.getpid(), signal.SIGINT)\n"
                                      "def mine(matrix, gains): return 0.5 * matrix[0].conj() / abs(matrix[0]).max()\nif __name__ == '__main__':\n"
                                      f"    plan = {DRIVE!r} | {{'vary': {{'solver': ['naive', 'mine']}}}}\n"
                                      "    plan['functions'] = {'mine': {'function': mine, 'version': '1'}}\n"
                                      "    print([row['state'] for row in palpa.sweep(plan, workers=2, backend='cpu')])\n")
    done = subprocess.run([sys.executable, tmp_path / "many.py"], capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "['done', 'done']\n", "")


def test_a_full_disk_loses_one_case(plan, tmp_path):
    words = shlex.join([sys.executable, "-m", "palpa.sweeps", str(plan), "--out", str(tmp_path / "out"), "--backend", "cpu"])
    done = subprocess.run(["bash", "-c", f"ulimit -f 2; exec {words}"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and done.stderr == f"palpa.sweeps: {tmp_path}/out/shard-0-of-1.jsonl: cannot be written: File too large\n"
    rows = palpa.sweep(plan, tmp_path / "out", backend="cpu")
    assert rows == palpa.sweep(plan, backend="cpu")


@pytest.mark.parametrize("variables, shard", [
    ({"SLURM_ARRAY_TASK_ID": "5", "SLURM_ARRAY_TASK_MIN": "3", "SLURM_ARRAY_TASK_MAX": "6", "SLURM_ARRAY_TASK_COUNT": "4"}, (2, 4)),
    ({"SLURM_ARRAY_TASK_ID": "0", "SLURM_ARRAY_TASK_MIN": "0", "SLURM_ARRAY_TASK_MAX": "6", "SLURM_ARRAY_TASK_COUNT": "4"}, "the step 1 and no gaps"),
    ({"SLURM_ARRAY_TASK_ID": "0", "SLURM_ARRAY_TASK_MIN": "0", "SLURM_ARRAY_TASK_MAX": "3"}, "SLURM_ARRAY_TASK_COUNT is not set"),
    ({"SLURM_ARRAY_TASK_ID": "0", "SLURM_ARRAY_TASK_MIN": "0", "SLURM_ARRAY_TASK_MAX": "3", "SLURM_ARRAY_TASK_COUNT": "4",
      "SLURM_STEP_NUM_TASKS": "2"}, "start one"),
    ({"OMPI_COMM_WORLD_RANK": "1", "OMPI_COMM_WORLD_SIZE": "3"}, (1, 3)), ({"PMI_RANK": "0", "PMI_SIZE": "2"}, (0, 2)),
    ({"PMI_RANK": "2", "PMI_SIZE": "2"}, "not a shard"), ({"PMI_RANK": "x", "PMI_SIZE": "2"}, "PMI_RANK is 'x'"),
    ({"SLURM_PROCID": "3", "SLURM_STEP_NUM_TASKS": "4"}, (3, 4)), ({"SLURM_PROCID": "0"}, (0, 1)),
    ({"SLURM_PROCID": "0", "SLURM_NTASKS": "4"}, "not started by srun"), ({}, "without a scheduler")])
def test_the_shard_of_a_scheduler(variables, shard):
    if isinstance(shard, tuple):
        assert sweeps.shard_of("env", variables) == shard
        return
    with pytest.raises(palpa.BadUsage, match="^shard.*" + shard):
        sweeps.shard_of("env", variables)


# ---- faults ---------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("arguments, kind, says", [
    ({"shard": (2, 2)}, palpa.BadUsage, "2/2"), ({"shard": (0,)}, palpa.BadUsage, "is not a shard"), ({"shard": "env"}, palpa.BadUsage, "SLURM"),
    ({"shard": (0.5, 2)}, palpa.BadUsage, "0.5/2"), ({"workers": 0}, palpa.BadUsage, "workers"), ({"client": 3}, palpa.BadUsage, "client"),
    ({"gpu": "0"}, palpa.BadUsage, "--gpu"), ({"out": "plan.toml"}, palpa.Error, "plan.toml: cannot be read: Not a directory"),
    ({"out": "plan.toml/x"}, palpa.Error, "Not a directory"), ({"out": ""}, palpa.BadUsage, "out: '' is no path")])
def test_arguments(plan, arguments, kind, says, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind) as caught:
        palpa.sweep(plan, **{"backend": "cpu"} | arguments)
    assert says in str(caught.value) and "\n" not in str(caught.value)


# ---- the command ----------------------------------------------------------------------------------------------------

def test_the_command(plan, tmp_path):
    out = tmp_path / "out"
    done = command(plan, "--out", out, "--backend", "cpu", "--shard", "0/2")
    assert (done.returncode, done.stdout) == (0, "6 cases: 4 done, 2 refused\n")
    assert re.fullmatch("palpa.sweeps: 2 of 6 cases refused; the first: --solver adjoint: .*\n", done.stderr)
    done = command(plan, "--out", out, "--gather", out / "t.csv", "--partial")
    assert (done.returncode, done.stdout, done.stderr) == (0, "6 cases: 4 done, 2 refused\n", "") and len((out / "t.csv").read_text().splitlines()) == 7
    for words, code, says in (
            ([plan], 2, "the following arguments are required: --out"), ([plan, "--out", out, "--cliam"], 2, "unrecognized arguments: --cliam"),
            ([plan, "--out", out, "--gather", out / "t.csv"], 1, "6 of 12 cases have no result yet"),
            (["none.toml", "--out", out], 4, "none.toml: no such file"), ([plan, "--out", out, "--gpu", "no such GPU"], 3, "no such GPU")):
        done = command(*words)
        assert done.returncode == code and re.fullmatch(f"palpa.sweeps: .*{says}.*\n", done.stderr) and done.stdout == "", done
    plan.write_text(PLAN.replace('"naive", "gs-pat", ', ""))
    done = command(plan, "--out", out, "--backend", "cpu", "--quiet")
    assert (done.returncode, done.stdout) == (1, "") and "4 of 4 cases refused" in done.stderr


# ---- pages ----------------------------------------------------------------------------------------------------------

def blocks(page, heading):
    """The indented blocks and the Python of a section."""
    section = (ROOT / page).read_text(encoding="utf-8").split(f"\n{heading}\n")[1].split("\n## ")[0]
    indented = re.findall(r"(?:^    .*\n|^\n(?=    ))+", re.sub(r"```.*?```", "", section, flags=re.S), re.M)
    return ["".join(line[4:] + "\n" for line in block.splitlines()) for block in indented], re.findall(r"```python\n(.*?)```", section, re.S)


def test_the_plan_of_the_page(tmp_path):
    """It has as many cases as the page says, and those of the example."""
    for name in ("finger.ply", "cube.glb", "semi-sphere.glb"):
        shutil.copy(ASSETS / name, tmp_path)
    (tmp_path / "plan.toml").write_text(blocks("docs/sweeps.md", "## Plans of sweeps")[0][0])
    page, example = Plan(tmp_path / "plan.toml"), Plan(ROOT / "docs/examples/sweep/plan.toml")
    assert "has 2 x 3 x 4 = 24 cases" in re.sub(r"\s+", " ", (ROOT / "docs/sweeps.md").read_text(encoding="utf-8"))
    assert len(page.cases()) == 24 and page.results[0] in example.results
    assert [page.id(settings, "cpu")[:0] + str(settings["method"]) for settings in page.cases()] == [str(settings["method"]) for settings in example.cases()]


@pytest.fixture
def first_sweep(tmp_path, monkeypatch):
    """The page's first sweep as (its commands, its Python), in a folder that has its plan and assets."""
    (plan, commands), (code,) = blocks("docs/sweeps.md", "## A first sweep")
    (tmp_path / "plan.toml").write_text(plan)
    (tmp_path / "assets").symlink_to(ASSETS)
    monkeypatch.chdir(tmp_path)
    return commands, code


def test_the_first_sweep_of_the_page(first_sweep):
    assert len(Plan("plan.toml").cases()) == 200
    rows = palpa.sweep("plan.toml", shard=(0, 100), backend="cpu")
    assert states(rows) == ["done", "done"]
    assert all(0 <= row[f"fingers.0.spectrum.{share}"] <= 1 for row in rows for share in ("felt_share", "flutter_share"))


@pytest.mark.exhaustive
def test_the_first_sweep_of_the_page_as_it_stands(first_sweep, tmp_path):
    commands, code = first_sweep
    (tmp_path / "best.py").write_text(code)
    words = commands.replace("python3", sys.executable)
    done = subprocess.run(["sh", "-c", f"{words}\n{sys.executable} best.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert re.fullmatch(r"200 cases; the best has stride [13] and dwell [0-9.]+ms", done.stdout.splitlines()[-1])


def test_the_python_of_the_page(tmp_path, monkeypatch):
    _, programs = blocks("docs/sweeps.md", "## Plans in Python")
    assert programs
    monkeypatch.chdir(tmp_path)
    (tmp_path / "assets").symlink_to(ASSETS)
    for program in programs:
        (tmp_path / "plan.py").write_text(program)
        read = Plan("plan.py")
        assert states(palpa.sweep("plan.py", backend="cpu", shard=(0, len(read.cases())))) == ["done"]
