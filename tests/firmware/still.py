"""still.py: a finger that rests on the cube before a camera, as a recording, and rigs whose arrays have its focus at a given place."""
import json
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
TAKE, FRAME, FRAMES = ROOT / "assets/depth/take", "000005-0.png", 240
SCENE = ROOT / "assets/cube.glb"


def write_recording(folder):
    """One image of the take, again and again."""
    folder.mkdir()
    (folder / "still.png").write_bytes((TAKE / FRAME).read_bytes())
    camera = re.search(r"\[\[camera\]\].*", (TAKE / "recording.toml").read_text(), re.S)[0]
    frames = "".join(f'[[frame]]\nfiles = ["still.png"]\ntime_s = {frame / 90!r}\n' for frame in range(FRAMES))
    (folder / "recording.toml").write_text(f"[recording]\n\n{camera}\n{frames}")
    return folder


def focus_of(palpa, recording, scratch):
    """Where in the world a single focus of that finger is."""
    file = scratch / "foci.json"
    subprocess.run([palpa, "export", "--scene", SCENE, "--source", f"recording:{recording}", "--predict-latency", "20ms", "--smoothing", "none",
                    "--method", "single-focus", "--frames", "3", "--foci", file, "--quiet"], check=True)
    return json.loads(file.read_text())["frames"][0]["fingers"][0]["foci_m"][0]


def write_rig(file, layout, focus_m, at_m):
    """A rig whose array has the focus at that place of its own frame, with the world's axes."""
    rows = [[float(row == column) for column in range(3)] + [focus_m[row] - at_m[row]] for row in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    file.write_text(f'[array]\nlayout = "{layout}"\nT_world_layout = {json.dumps(rows)}\n')
    return file


def write_pair(file, kind, gap_m):
    """A layout of two boards that face each other."""
    file.write_text(f'[[unit]]\ntype = "{kind}"\nposition_m = [0, 0, 0]\nquaternion_wxyz = [1, 0, 0, 0]\n\n'
                    f'[[unit]]\ntype = "{kind}"\nposition_m = [0, 0, {gap_m}]\nquaternion_wxyz = [0, 0, 1, 0]\n')
    return file
