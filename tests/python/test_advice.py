"""What a message advises is right: with the advised number, the message is gone; with one that is slightly less, it comes."""
import re
import shlex
import subprocess

import pytest

from commands import PALPA, ROOT
from test_unlike_cameras import BESIDE
from test_unlike_solids import write_scene

TOUCH = "--scene assets/cube.glb --points assets/finger.ply --penetration 3mm --backend cpu"
PLAN = '[[shape]]\nname = "a"\nmodel = "palpa:cube.glb"\n[[shape]]\nname = "b"\nmodel = "palpa:prism.glb"\n[[method]]\nname = "single-focus"\nlayout = "openmpd"\namplitude = "distance"\nconstraint = "normalise"\n[level]\nceiling = {}\n'


def said(words):
    done = subprocess.run([PALPA, *shlex.split(words)], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    return done.stderr


def touch(options):
    return lambda value, folder: said(f"touch {TOUCH} {options}".replace("VALUE", str(value)).replace("OUT", str(folder)))


def plan_at(value, folder):
    (folder / "plan.toml").write_text(PLAN.format(value))
    return said(f"study level {folder}/plan.toml")


def felt(**haptics):
    """A touch of a solid with these properties at a dwell in ms, or at an intensity."""
    def touched(value, folder):
        own = {"delta_m": 0.003} | {key: value if one == "VALUE" else one for key, one in haptics.items()}
        scene = write_scene(folder / "scene.gltf", ["first"], first=own)
        dwell = "" if "VALUE" in haptics.values() else f"--dwell {value}ms"
        return said(f"touch --scene {scene} --points assets/finger.ply --penetration 1mm --backend cpu {dwell}")
    return touched


def exposed(value, folder):
    (folder / "rig.toml").write_text(f'[[camera]]\nname = "a"\nwidth = 64\nheight = 48\nfx = 50.0\nfy = 50.0\ncx = 30.0\ncy = 24.0\nrate_hz = 90\nexposure_s = {value}\nT_world_camera = {BESIDE["wide"]}\n')
    return said(f"doctor --rig {folder}/rig.toml --layout openmpd --quiet --backend cpu")


# What is run with a value; a value for which the message comes; the message with its advice; how a value that is a little worse is made.
ADVICE = {
    "the scale of a sound file": (touch("--layout paper --audible --steps off --wav OUT/a.wav --wav-scale VALUE"), 10, r"--wav: .* give --wav-scale (\d+)", lambda v: v - 1.5),
    "the dwell of a serial board": (touch("--layout sonicsurface --audible --method cross-section --dwell VALUE"), "5ms", r"use --dwell (\S+)ms", lambda v: f"{v - 0.8}ms"),
    "a stride": (touch("--foci 6 --stride VALUE"), 4, r"give a stride such as (\d+)", None),
    "the ceiling of a loud plan": (plan_at, 0.5, r"lower the ceiling of its \[level\] from 0.5 to ([\d.]+)", lambda v: round(v + 0.01, 3)),
    "the ceiling of a silent plan": (plan_at, 0.02, r"is 0.02, below ([\d.]+), the least", lambda v: round(v - 0.0001, 4)),
    "the dwell of a texture": (felt(texture=[0, 0, 1]), 4, r"give a dwell of at most ([\d.]+) ms", lambda v: round(1.01 * v, 4)),
    "the dwell of a click": (felt(press_depth_m=0.0005, click=[0.05, 180]), 4, r"give a dwell of at most ([\d.]+) ms", lambda v: round(1.01 * v, 4)),
    "the gain of a click": (felt(press_depth_m=0.0005, click=True, intensity="VALUE"), 1.0, r"an intensity that makes it at most ([\d.]+)", lambda v: v + 0.001),
    "an exposure": (exposed, 0.02, r"at 90 Hz: at most ([\d.]+)", lambda v: round(v + 0.0001, 6))}


@pytest.mark.parametrize("what", ADVICE)
def test_the_advice_is_right(what, tmp_path):
    run, wrong, message, worse = ADVICE[what]
    advised = re.search(message, run(wrong, tmp_path))[1]
    unit = re.search(r"[a-z]+$", str(wrong)) if isinstance(wrong, str) else None
    number = float(advised) if "." in advised or unit else int(advised)
    general = re.sub(r"\\?\b\d[\d.]*\b(?!\))", r"\\S+", message)  # with any numbers
    assert not re.search(general, run(f"{advised}{unit[0]}" if unit else number, tmp_path)), "what is advised is refused"
    if worse:
        assert re.search(general, run(worse(number), tmp_path)), "a little worse is not refused"
