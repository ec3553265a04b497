"""The tutorials run as they stand."""
import os
import pathlib
import subprocess
import sys

import pytest

import palpa
from commands import ROOT, python

QUICK = {"1_touch_a_mesh", "8_hand_over_drives"}
TUTORIALS = sorted((ROOT / "docs/python").glob("*.py"))


def test_there_are_eight():
    assert [path.name[0] for path in TUTORIALS] == list("12345678")


@pytest.mark.parametrize("path", [pytest.param(path, id=path.stem, marks=[] if path.stem in QUICK else [pytest.mark.exhaustive]) for path in TUTORIALS])
def test_it_runs(path, tmp_path):
    needs = ["matplotlib"] if "matplotlib" in path.read_text() else []
    needs += ["pandas"] if "pandas" in path.read_text() else []
    for module in needs:
        pytest.importorskip(module)
    done = subprocess.run([sys.executable, str(path)], cwd=tmp_path, capture_output=True, text=True, timeout=900, check=False,
                          env=os.environ | {"MPLBACKEND": "Agg", "MPLCONFIGDIR": str(tmp_path),
                                            "PYTHONPATH": str(pathlib.Path(palpa.__file__).resolve().parents[1])})
    # The new folder has no list of fonts, and Matplotlib says so if making one takes seconds.
    told = done.stderr.replace("Matplotlib is building the font cache; this may take a moment.\n", "")
    assert done.returncode == 0 and told == "", done.stderr
    assert done.stdout
    if "savefig" in path.read_text():
        (figure,) = tmp_path.glob("*.png")
        assert figure.stat().st_size > 5000


def pieces_of_the_page():
    text = (ROOT / "docs/python/getting-started.md").read_text(encoding="utf-8")
    pieces = [piece.split("```")[0] for piece in text.split("```python\n")[1:]]
    assert pieces
    return pieces


def test_the_pages_lines_run(tmp_path):
    """The Python of the first steps."""
    for piece in pieces_of_the_page():
        code = "import palpa\n" + piece.replace('.ply"), penetration=3e-3)', '.ply"), penetration=3e-3, backend="cpu")').replace(
            "foci[0])", 'foci[0], backend="cpu")')
        done = python(code)
        assert done.returncode == 0, done.stderr


@pytest.mark.exhaustive
def test_mypy_passes(tmp_path):
    """A user's type checker has nothing against code as in the page and the tutorials."""
    pytest.importorskip("mypy")
    files = list(TUTORIALS)
    for number, piece in enumerate(pieces_of_the_page()):
        files.append(tmp_path / f"piece_{number}.py")
        files[-1].write_text(piece, encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "mypy", "--ignore-missing-imports", "--cache-dir", str(tmp_path), *map(str, files)], cwd=tmp_path,
                          capture_output=True, text=True, check=False,
                          env=os.environ | {"MYPYPATH": str(pathlib.Path(palpa.__file__).resolve().parents[1])})
    assert done.returncode == 0, done.stdout
