"""Tests of the Python module. They run in the source tree, where assets/ is."""
import os
import pathlib
import signal

import pytest

os.environ["PALPA_BACKEND"] = "gpu"  # as in the tests of C++
# A shell starts what runs in the background without Ctrl-C, and programs that tests start inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def in_the_tree(monkeypatch):
    monkeypatch.chdir(ROOT)


@pytest.fixture(scope="session")
def cube():
    import palpa
    return palpa.Scene(ROOT / "assets/cube.glb")


@pytest.fixture(scope="session")
def finger():
    import palpa
    return palpa.read_ply(ROOT / "assets/finger.ply")


@pytest.fixture(scope="session")
def openmpd():
    import palpa
    return palpa.Layout("openmpd")


def pytest_collection_modifyitems(items):
    """Long and slow cases run in the matrix; times mean nothing under a sanitizer."""
    for item in items:
        if "exhaustive" in item.keywords and not os.environ.get("PALPA_EXHAUSTIVE"):
            item.add_marker(pytest.mark.skip(reason="long: PALPA_EXHAUSTIVE=1 runs it"))
        if "slow" in item.keywords and not (os.environ.get("PALPA_EXHAUSTIVE") or os.environ.get("PALPA_SANITIZE")):
            item.add_marker(pytest.mark.skip(reason="takes seconds: the matrix runs it, or PALPA_EXHAUSTIVE=1"))
        if "times" in item.keywords and os.environ.get("PALPA_SANITIZE"):
            item.add_marker(pytest.mark.skip(reason="a sanitizer makes it slow"))


def pytest_configure(config):
    config.addinivalue_line("markers", "exhaustive: long, only with PALPA_EXHAUSTIVE=1")
    config.addinivalue_line("markers", "slow: takes seconds, only with PALPA_EXHAUSTIVE=1 or under a sanitizer")
    config.addinivalue_line("markers", "times: about times, or about nothing of palpa's own memory: not under a sanitizer")


@pytest.fixture(scope="session")
def sphere():
    """Writes a sphere of 10 mm."""
    import numpy as np
    import palpa

    def write(file):
        corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
        triangles = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
        for _ in range(3):
            a, b, c = (corners[triangles[:, i]] for i in range(3))
            middle = np.stack([a, b, c, a + b, b + c, c + a], axis=1)
            corners = (middle / np.linalg.norm(middle, axis=2, keepdims=True)).reshape(-1, 3)
            triangles = (6 * np.arange(len(triangles))[:, None] + np.array([0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5])).reshape(-1, 3)
        palpa.write_ply(file, 0.01 * corners, triangles)

    return write


@pytest.fixture(scope="session")
def bodies(sphere):
    """Writes a sphere of 10 mm, one of 1 mm, and a fingertip of 2 mm on the origin."""
    import palpa

    def write(folder):
        sphere(folder / "sphere.ply")
        ball = palpa.Mesh(folder / "sphere.ply")
        palpa.write_ply(folder / "pebble.ply", 0.1 * ball.vertices, ball.faces)
        palpa.write_ply(folder / "tip.ply", 0.2 * ball.vertices + [0, 0.002, 0], ball.faces)

    return write
