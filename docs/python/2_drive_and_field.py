# %% [markdown]
# # A drive and its field
# A drive is one complex vector: the amplitude (0 to 1) and phase of each transducer. The field is the sum of the
# sound of all transducers.

# %%
import numpy as np
import palpa

array = palpa.Layout("openmpd")
drive = array.drive([0, 0, 0.15], backend="cpu")
print(array, drive.shape, drive.dtype, "largest amplitude", np.abs(drive).max())

# %% [markdown]
# The field in a plane through the focus. Rows run from the top; `extent` is for `imshow`.

# %%
plane = palpa.plane("xz", centre=(0, 0, 0.12), size=(0.12, 0.16), pixels=(120, 160))
field = array.field(drive, plane, backend="cpu")
print(field, "at", field.peak_at)

# %% [markdown]
# The same by hand: `transfer` gives the sound between each transducer and each point, without the air's absorption.

# %%
points = np.array([[0, 0, 0.15], [0.01, 0, 0.15]])
by_hand = array.transfer(points) @ drive
print(np.abs(by_hand), "Pa")
lossless = array.field(drive, points, no_absorption=True, backend="cpu")
assert np.allclose(by_hand, lossless.pressure, rtol=1e-3)

# %% [markdown]
# The sound pressure level at a place where an ear could be, half a metre beside the focus.

# %%
ear = array.field(drive, [0.5, 0, 0.15], backend="cpu")
level = 20 * np.log10(abs(ear.pressure[0]) / np.sqrt(2) / 20e-6)
print(f"{level:.0f} dB")

# %%
import matplotlib.pyplot as plt

plt.figure(figsize=(5, 6))
plt.imshow(np.abs(field.pressure), extent=[1e3 * side for side in plane.extent])
plt.colorbar(label="|p| (Pa)")
plt.xlabel("x (mm)")
plt.ylabel("z (mm)")
plt.savefig("field.png", bbox_inches="tight")
