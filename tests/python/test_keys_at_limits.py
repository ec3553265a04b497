"""Keys of files exactly at their limits: the last value is read, and the next one is refused with the key's name."""
import json
import math

import numpy as np
import pytest

import palpa
from commands import ROOT
from test_unlike_cameras import BESIDE
from test_unlike_solids import SOLIDS, write_scene

pytestmark = pytest.mark.filterwarnings("ignore::palpa.PalpaWarning")
# The keys of a solid: the least, which may not be allowed itself, and the most.
OPEN, CLOSED, WHOLE = "open", "closed", "whole"
SOLID = {"delta_m": (OPEN, 0, 0.1), "foci": (WHOLE, 1, 64), "stride": (WHOLE, 1, 1048576), "dwell_s": (CLOSED, 1e-6, 10), "intensity": (CLOSED, 0, 1),
         "pressure_pa": (OPEN, 0, 1e5), "press_depth_m": (OPEN, 0, 1), "grain_m": (CLOSED, 1e-4, 0.1)}
CAMERA = {"width": (WHOLE, 1, 16384), "height": (WHOLE, 1, 16384), "fx": (CLOSED, 1e-3, 1e7), "fy": (CLOSED, 1e-3, 1e7), "cx": (CLOSED, -1e6, 1e6), "cy": (CLOSED, -1e6, 1e6),
          "depth_unit_m": (CLOSED, 1e-9, 1), "rate_hz": (CLOSED, 0, 1e6), "residual_m": (CLOSED, 0, 1), "hardware_preset": (WHOLE, 0, 255), "exposure_s": (CLOSED, 0, 0.2)}
LAYOUT = {"source_level_pa_m": (OPEN, 0, 1e4), "transducer_radius_m": (OPEN, 0, 0.1), "frequency_hz": (CLOSED, 1e3, 1e7)}
SCREEN = {"width_m": (CLOSED, 1e-3, 1e3), "height_m": (CLOSED, 1e-3, 1e3)}


def values_of(kind, low, high):
    """Those that are right, and those that are not."""
    if kind == WHOLE:
        return (low, high), (low - 1, high + 1, low + 0.5)
    right = (math.nextafter(low, math.inf) if kind == OPEN else low, high)
    return right, (low if kind == OPEN else math.nextafter(low, -math.inf), math.nextafter(high, math.inf))


def expect(right, wrong, key, read):
    for value in right:
        try:
            read(value)
        except palpa.Error as error:
            assert key not in str(error), (value, str(error))  # something else may be impossible with it
    for value in wrong:
        with pytest.raises(palpa.Error, match=key):
            read(value)


@pytest.mark.parametrize("key", SOLID)
def test_of_a_solid(tmp_path, key):
    right, wrong = values_of(*SOLID[key])

    def read(value):
        name = "first"
        own = {key: value} | ({"stride": 1} if key == "foci" else {"foci": 1} if key == "stride" else {})
        return palpa.Scene(write_scene(tmp_path / "scene.gltf", [name], **{name: own}))
    for value in right:
        read(value)
    expect((), wrong, key, read)
    assert "first" in SOLIDS


LISTS = {"click": ([[0.03, 150], [0.06, 200]], [[0.029, 150], [0.061, 200], [0.03, 149], [0.06, 201], [0.03]]),
         "stiffness": ([[0, 0], [1, 1], sum(([0.01 * i, 1] for i in range(32)), [])], [[-1e-9, 0], [1.0000001, 1], [0, 1.0000001], [0, -1e-9], sum(([0.01 * i, 1] for i in range(33)), [])]),
         "texture": ([[0, 0, 1], [1, 1, 1]], [[0, 0, 0], [1.0000001, 0, 0], [0, -1e-9, 1], [1, 1]])}


@pytest.mark.parametrize("key", LISTS)
def test_lists_of_a_solid(tmp_path, key):
    def read(value):
        return palpa.Scene(write_scene(tmp_path / "scene.gltf", ["first"], first={key: value}))
    right, wrong = LISTS[key]
    for value in right:
        read(value)
    expect((), wrong, key, read)


def toml(value):
    return repr(value) if isinstance(value, float) else json.dumps(value)


@pytest.mark.parametrize("key", CAMERA)
def test_of_a_camera(tmp_path, key):
    plain = {"name": "one", "width": 8, "height": 8, "fx": 8.0, "fy": 8.0, "cx": 3.5, "cy": 3.5, "T_world_camera": BESIDE["wide"]}

    def read(value):
        file = tmp_path / "rig.toml"
        file.write_text("[[camera]]\n" + "".join(f"{name} = {one if name.startswith('T_') else toml(one)}\n" for name, one in (plain | {key: value}).items()))
        pixels = [(plain | {key: value})[side] for side in ("height", "width")]
        image = np.zeros(pixels if all(isinstance(side, int) and side > 0 for side in pixels) else (8, 8), np.uint16)
        return palpa.Scene("assets/cube.glb").touch(depth=[image], rig=file, backend="cpu")
    expect(*values_of(*CAMERA[key]), key, read)
    read({"width": 9, "height": 9}.get(key, plain.get(key, 0.1 if key == "exposure_s" else 1)))


@pytest.mark.parametrize("key", SCREEN)
def test_of_a_screen(tmp_path, key):
    rig = (ROOT / "assets/rigs/paper.toml").read_text()

    def read(value):
        file = tmp_path / "rig.toml"
        number = {"width_m": "0.345", "height_m": "0.194"}[key]
        file.write_text(rig.replace(f"{key} = {number}", f"{key} = {toml(value)}"))
        return palpa.export("assets/cube.glb", "synthetic", rig=file, frames=1, backend="cpu")
    expect((), values_of(*SCREEN[key])[1], key, read)


@pytest.mark.parametrize("key", LAYOUT)
def test_of_a_layout(tmp_path, key):
    def read(value):
        (tmp_path / "layout.toml").write_text(f"{key} = {toml(float(value))}\n[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n")
        return palpa.Layout(tmp_path / "layout.toml")
    right, wrong = values_of(*LAYOUT[key])
    for value in right:
        read(value)
    expect((), wrong, key, read)


def test_places_and_axes_of_a_layout(tmp_path):
    def read(place=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0), turn=(1.0, 0.0, 0.0, 0.0)):
        (tmp_path / "layout.toml").write_text(f"[[transducer]]\nposition_m = {list(place)}\naxis = {list(axis)}\n[[unit]]\ntype = \"openmpd\"\nposition_m = [0, 0, 1]\n"
                                              f"quaternion_wxyz = {list(turn)}\n")
        return palpa.Layout(tmp_path / "layout.toml")
    read(place=(10.0, 0.0, 0.0))
    read(axis=(0.0, 0.0, 1.0009))
    read(turn=(0.9991, 0.0, 0.0, 0.0))
    for wrong in ({"place": (10.0001, 0.0, 0.0)}, {"axis": (0.0, 0.0, 1.0011)}, {"turn": (0.9989, 0.0, 0.0, 0.0)}):
        with pytest.raises(palpa.Error):
            read(**wrong)


def test_of_places():
    def plane(value, size=(0.1, 0.1)):
        return palpa.plane("xz", size=size, pixels=value)
    for pixels in ((1, 1), (1, 65536), (65536, 1)):
        assert plane(pixels).shape == pixels[::-1] and len(plane(pixels)) == pixels[0] * pixels[1]
    for wrong in (0, 65537, 1.5, -1):
        for pixels in ((wrong, 2), (2, wrong)):
            expect((), (pixels,), "from 1 to 65536", plane)
    expect((), (0, math.nextafter(0, -1), math.inf), "size", lambda value: plane((2, 2), (0.1, value)))
    for samples in (2, 3):
        assert len(palpa.line([0, 0, 0], [0, 0, 0.1], samples=samples)) == samples
    expect((), (0, 1), "at least 2 samples", lambda value: palpa.line([0, 0, 0], [0, 0, 0.1], samples=value))
