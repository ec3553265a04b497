"""Sweeps: the command's numbers, shards, and bad plans."""
import csv
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import pytest

import palpa
from commands import PALPA, ROOT, run

PLAN = """command = "drive"
results = ["weakest_to_strongest", "pressures_pa.0", "transducers"]
[options]
focus = ["0,0,100mm", "10mm,0,100mm"]
[vary]
layout = ["openmpd", "sonicsurface"]
solver = ["naive", "gs-pat", "adjoint"]
temperature = [20, 25]
"""


@pytest.fixture
def plan(tmp_path):
    file = tmp_path / "plan.toml"
    file.write_text(PLAN)
    return file


def table(text):
    return list(csv.DictReader(text.splitlines()))


def test_the_rows_are_those_of_the_command(plan, tmp_path):
    rows = palpa.sweep(plan, backend="cpu")
    assert len(rows) == 12 and [row["state"] for row in rows].count("refused") == 4
    run(["sweep", str(plan), "--out", f"{tmp_path}/cli", "--backend", "cpu", "--quiet"])
    run(["sweep", str(plan), "--out", f"{tmp_path}/cli", "--gather", f"{tmp_path}/cli/t.csv", "--quiet"])
    text = (tmp_path / "cli/t.csv").read_text()
    for mine, theirs in zip(rows, table(text), strict=True):
        assert mine["id"] == theirs["id"] and mine["state"] == theirs["state"] and mine["layout"] == theirs["layout"]
        assert str(mine["temperature"]) == theirs["temperature"] and isinstance(mine["temperature"], int)
        if mine["state"] == "done":
            assert mine["pressures_pa.0"] == float(theirs["pressures_pa.0"]) and "error" not in mine
        else:
            assert mine["pressures_pa.0"] is None and "adjoint" in mine["error"]
    # Two shards in one folder, and their table, byte for byte.
    parts = [palpa.sweep(plan, tmp_path / "two", shard=shard, backend="cpu") for shard in ((0, 2), "1/2")]
    assert sorted(row["id"] for part in parts for row in part) == sorted(row["id"] for row in rows)
    assert palpa.gather(plan, tmp_path / "two", tmp_path / "two/t.csv") == {"rows": 12, "missing": 0, "refused": 4, "failed": 0, "others": 0}
    assert (tmp_path / "two/t.csv").read_text() == text


def test_a_sweep_goes_on(plan, tmp_path):
    first = palpa.sweep(plan, tmp_path / "out", shard=(0, 3), backend="cpu")
    with pytest.raises(palpa.Error, match="8 of 12 cases have no result"):
        palpa.gather(plan, tmp_path / "out", tmp_path / "t.csv")
    assert palpa.gather(plan, tmp_path / "out", tmp_path / "t.csv", partial=True)["missing"] == 8
    before = sorted((tmp_path / "out/runs").iterdir())
    assert palpa.sweep(plan, tmp_path / "out", shard=(0, 3), backend="cpu") == first
    assert sorted((tmp_path / "out/runs").iterdir()) == before  # nothing was left to compute
    assert len(palpa.sweep(plan, tmp_path / "out", claim=True, backend="cpu")) == 12


@pytest.mark.parametrize("arguments, kind, says", [
    ({"shard": (2, 2)}, palpa.BadUsage, "2/2"), ({"shard": (0,)}, palpa.BadUsage, "(i, n)"), ({"shard": "env"}, palpa.BadUsage, "SLURM"),
    ({"shard": (0.5, 2)}, palpa.BadUsage, "0.5/2"), ({"claim": True}, palpa.BadUsage, "out"), ({"seed": 3}, palpa.BadUsage, "no option 'seed'"),
    ({"out": "o", "claim": True, "shard": (0, 2)}, palpa.BadUsage, "exclude"), ({"gpu": "0", "backend": "cpu"}, palpa.BadUsage, "--gpu"),
    ({"out": ROOT}, palpa.BadUsage, "no folder of a sweep"),
])
def test_arguments(plan, arguments, kind, says, monkeypatch):
    for name in ("SLURM_ARRAY_TASK_ID", "OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(kind) as caught:
        palpa.sweep(plan, **arguments)
    assert says in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("text, says", [
    ("command = \"drive\"\nvery = 1", "very"), ("command = \"fly\"", "fly"), ("[vary", "1"),
    ("command = \"drive\"\n[options]\nfocus = \"0,0,0.1\"\nlayout = \"missing.toml\"", "missing.toml"),
    ("command = \"drive\"\n[options]\nfocus = \"0,0,0.1\"\n[vary]\ntemperature = { from = 1, to = 30, count = 40000 }\n"
     "humidity = { from = 1, to = 90, count = 40000 }", "humidity"),
    ("command = \"drive\"\n[options]\nlayout = \"openmpd\"\n[vary]\ntemperature = { from = 1, to = 30, count = 40000 }\n"
     "sound-speed = { from = 300, to = 390, count = 40000 }", "1,600,000,000 cases"),
])
def test_plans(tmp_path, text, says):
    plan = tmp_path / "plan.toml"
    plan.write_text(text)
    with pytest.raises(palpa.BadInput) as caught:
        palpa.sweep(plan, backend="cpu")
    assert says in str(caught.value) and str(plan) in str(caught.value) and caught.value.file == str(plan)


@pytest.fixture
def first_sweep(tmp_path, monkeypatch):
    """The page's first sweep as (its commands, its Python), in a folder that has its plan and assets."""
    page = (ROOT / "docs/sweeps.md").read_text(encoding="utf-8")
    section = page[page.index("## A first sweep"):page.index("## How it works")]
    blocks = re.findall(r"(?:^    .*\n|^\n(?=    ))+", section.split("```python")[0], re.M)
    plan, commands = ("".join(line[4:] + "\n" for line in block.splitlines()) for block in blocks)
    (tmp_path / "plan.toml").write_text(plan)
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    monkeypatch.chdir(tmp_path)
    return commands, section.split("```python\n")[1].split("```")[0]


def test_the_first_sweep_of_the_page(first_sweep, tmp_path):
    assert run(["sweep", "plan.toml", "--list"], cwd=tmp_path).count("\n") == 201
    rows = palpa.sweep("plan.toml", shard=(0, 100), backend="cpu")
    assert [row["state"] for row in rows] == ["done", "done"]
    assert all(0 <= row[f"fingers.0.spectrum.{share}"] <= 1 for row in rows for share in ("felt_share", "flutter_share"))


@pytest.mark.exhaustive
def test_the_first_sweep_of_the_page_as_it_stands(first_sweep, tmp_path):
    commands, code = first_sweep
    (tmp_path / "best.py").write_text(code)
    environment = os.environ | {"PATH": f"{pathlib.Path(PALPA).parent}:{os.environ['PATH']}"}
    done = subprocess.run(["sh", "-c", f"{commands}\n{sys.executable} best.py"], cwd=tmp_path, env=environment, capture_output=True, text=True,
                          timeout=300, check=False)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert re.fullmatch(r"200 cases; the best has stride [13] and dwell [0-9.]+ms", done.stdout.splitlines()[-1])


def test_ctrl_c_loses_one_case(tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text("command = \"field\"\n[options]\nfocus = \"0,0,0.1\"\nlayout = \"paper\"\nplane = \"xz\"\nsize = \"0.1,0.1\"\n"
                    "pixels = \"100,100\"\n[vary]\ntemperature = { from = 1, to = 30, count = 300 }\n")
    code = f"import palpa\ntry:\n palpa.sweep({str(plan)!r}, {str(tmp_path / 'out')!r}, backend='cpu')\nexcept KeyboardInterrupt:\n print('interrupted')"
    with subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        end = time.monotonic() + 30
        while not any(file.stat().st_size for file in tmp_path.glob("out/runs/*/cases.jsonl")) and time.monotonic() < end:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert (out, err, process.returncode) == ("interrupted\n", "", 0)
    (lines,) = tmp_path.glob("out/runs/*/cases.jsonl")
    states = [line.split('"state":"')[1].split('"')[0] for line in lines.read_text().splitlines()]
    assert 0 < len(states) < 300 and set(states) == {"done"}


def test_a_misspelt_result_is_told(plan):
    plan.write_text(PLAN.replace('"pressures_pa.0"', '"pressures_p.0"'))
    with pytest.warns(palpa.PalpaWarning, match="a case has no pressures_p; did you mean pressures_pa"):
        assert palpa.sweep(plan, backend="cpu")[0]["pressures_p.0"] is None
