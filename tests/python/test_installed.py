"""What users install: the module beside any NumPy, and the files of a wheel and of an sdist."""
import fnmatch
import os
import pathlib
import re
import subprocess
import tomllib

import pytest

import palpa
from commands import ROOT, python

BUILD = pathlib.Path(palpa.__file__).resolve().parents[2]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("numpy", ["1.24.2", "1.26.4", "2.0.0", "2.5.1"])
def test_numpy_that_pybind11_does_not_know(numpy):
    """pybind11 before 2.12 computes with wrong numbers under NumPy 2, without an error."""
    done = python(f"import numpy; numpy.__version__ = '{numpy}'; import palpa; print('imported')")
    knows = tuple(map(int, palpa._engine._pybind11.split(".")[:2])) >= (2, 12)
    if knows or numpy < "2":
        assert (done.returncode, done.stdout, done.stderr) == (0, "imported\n", "")
    else:
        assert done.returncode == 1
        assert done.stderr.splitlines()[-1].startswith(f"ImportError: palpa was built with pybind11 {palpa._engine._pybind11}, ")
        assert f"NumPy {numpy}: install numpy<2, or build" in done.stderr and done.stderr.count("Traceback") == 1


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The folder palpa of a wheel, as CMake fills it for pip."""
    place = tmp_path_factory.mktemp("wheel")
    subprocess.run(["cmake", "--install", BUILD, "--component", "wheel", "--prefix", place], check=True, capture_output=True)
    assert [path.name for path in place.iterdir()] == ["palpa"]
    return place / "palpa"


def files_in(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts}


def test_a_wheel_has_all_that_the_module_looks_for(wheel):
    of_assets = {f"assets/{name}" for name in files_in(ROOT / "assets") if not name.startswith("generators/") and name != "CMakeLists.txt"}
    of_python = files_in(ROOT / "python/palpa") | {"__init__.pyi", "palpa-guard", pathlib.Path(palpa._engine.__file__).name}
    assert files_in(wheel) == of_assets | of_python
    assert os.access(wheel / "palpa-guard", os.X_OK)


def test_a_wheel_works_far_from_the_sources(wheel, tmp_path):
    """Sensations, the rig that is taken if none is named, and models."""
    code = """
import os, palpa
print(os.path.dirname(palpa.__file__))
for name in ("circle", "heartbeat", "lateral", "point", "sweep"):
    palpa.Sensation(name)
scene = palpa.Scene(palpa.asset("cube.glb"))
print(len(scene.touch(palpa.read_ply(palpa.asset("finger.ply")), penetration=3e-3, backend="cpu").contacts))
palpa.Session(scene, source="synthetic", backend="cpu", every_frame=True).run(frames=1)
"""
    environment = {name: value for name, value in os.environ.items() if name != "PALPA_ASSETS"}
    done = python(code, cwd=tmp_path, env=environment | {"PYTHONPATH": str(wheel.parent)})
    assert (done.returncode, done.stdout) == (0, f"{wheel}\n199\n"), done.stderr


def test_an_asset_has_a_path(monkeypatch, tmp_path):
    assert pathlib.Path(palpa.asset("rigs/paper.toml")).samefile(ROOT / "assets/rigs/paper.toml")
    monkeypatch.setenv("PALPA_ASSETS", str(tmp_path))
    (tmp_path / "mine.glb").touch()
    assert palpa.asset("mine.glb") == str(tmp_path / "mine.glb")
    for name in ("cube.glb", "../mine.glb", ""):
        with pytest.raises(palpa.Error):
            palpa.asset(name)


def test_what_pip_is_told():
    """The version is the project's; an sdist has all folders of which CMake builds the module, and nothing else."""
    (version,) = SETTINGS["tool"]["dynamic-metadata"]
    text = (ROOT / version["input"]).read_text(encoding="utf-8")
    assert [match["value"] for match in re.finditer(version["regex"], text)] == [palpa.__version__]
    sdist = SETTINGS["tool"]["scikit-build"]["sdist"]
    assert sdist["inclusion-mode"] == "explicit"
    taken = {name.removesuffix("/**").lstrip("/") for name in sdist["include"]}
    folders = set(re.findall(r"^ *add_subdirectory\((\w+)", text, re.M)) - {"viewer", "tests"}
    assert taken == folders | {"CMakeLists.txt", "LICENSE", "README.md", "pyproject.toml", "cmake", "shaders", "tests/house/units.py"}
    tracked = subprocess.run(["git", "-c", "safe.directory=*", "ls-files", *taken], cwd=ROOT, capture_output=True, text=True, check=False)
    if tracked.returncode:
        pytest.skip("not in a clone: what is the project's own is not known")
    left_out = [name for name in tracked.stdout.splitlines() for pattern in sdist["exclude"]
                if any(fnmatch.fnmatch(part, pattern.rstrip("/")) for part in name.split("/"))]
    assert left_out == []
