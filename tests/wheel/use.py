"""use.py [gpu]: what an installed palpa can do, far from its sources, on the processor or on a device."""
import pathlib
import subprocess
import sys

import numpy as np
import palpa

backend = sys.argv[1] if len(sys.argv) > 1 else "cpu"
folder = pathlib.Path(palpa.__file__).parent
print("palpa", palpa.__version__, palpa._engine._commit or "without a commit", "pybind11", palpa._engine._pybind11, "NumPy", np.__version__)

# Programs and libraries find what they need, and all but the system's own is in the wheel.
guard = subprocess.run([folder / "palpa-guard"], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
assert guard.returncode == 1, guard  # it ends at once if nobody is there to talk to; without a library, the loader gives 127
for file in [folder / "palpa-guard", *folder.glob("*.so*"), *(folder.parent / "palpa.libs").iterdir()]:
    needed = subprocess.run(["ldd", file], capture_output=True, text=True, check=True).stdout
    assert "not found" not in needed, f"{file}: {needed}"
    for line in needed.splitlines():
        name, _, place = line.strip().partition(" => ")
        system = name.startswith(("libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so", "libstdc++.so", "libgcc_s.so", "/lib", "linux-vdso", "libz.so"))
        assert system or place.startswith(str(folder.parent)), f"{file} takes {line.strip()} from the system"

for name in ("circle", "heartbeat", "lateral", "point", "sweep"):
    palpa.Sensation(name)
scene = palpa.Scene(palpa.asset("cube.glb"))
skin = palpa.read_ply(palpa.asset("finger.ply"))
touch = scene.touch(skin, penetration=3e-3, foci=10, backend=backend)
assert len(touch.contacts) == 199 and touch.fingers[0].foci.shape == (10, 3)
assert 0 < touch.contacts.depths.min() < touch.contacts.depths.max() < 1.5e-3
assert np.allclose(scene[0].depth([[0, -0.001, 0], [0.005, -0.002, 0], [0, 0.003, 0]]), [0.001, 0.002, -0.003], atol=1e-6)

# Every array arrives whole: NumPy computes the same pressures in air that absorbs nothing.
array = palpa.Layout("openmpd")
drive = array.drive([0, 0, 0.15], backend=backend)
points = np.array([[0, 0, 0.15], [0.01, 0, 0.15], [0, 0.02, 0.1]])
pressure = array.field(drive, points, no_absorption=True, backend=backend).pressure
assert np.allclose(array.transfer(points) @ np.asarray(drive), pressure, rtol=1e-3, atol=1e-3 * abs(pressure).max())
assert 5e3 < abs(pressure[0]) < 1e4 and abs(pressure[1]) < 0.5 * abs(pressure[0])
assert palpa.Mesh((np.asarray(scene[0].vertices), np.asarray(scene[0].faces))).vertices.shape == scene[0].vertices.shape

# The equations of scattered sound need OpenBLAS, which is loaded when it is needed.
print(palpa.scatter(palpa.asset("finger.ply"), plane_wave=[0, 0, 1]))

palpa.Session(scene, source="synthetic", backend=backend, every_frame=True).run(frames=2)
