# %% [markdown]
# # A recording analysed with pandas
# `export` plays a recording on its own clock, and gives the foci of all its frames as columns.

# %%
import palpa
import pandas

recording = palpa.Recording(palpa.asset("depth/take"))
print(recording, "from", recording.times[0], "to", recording.times[-1], "s")
image = recording.images(0)[0]
print("an image:", image.shape, image.dtype)

# %%
scene = palpa.Scene(palpa.asset("cube.glb"))
table = pandas.DataFrame(palpa.export(scene, recording, backend="cpu").foci)
print(table.describe())

# %% [markdown]
# How far the foci of each finger are from their centre, frame by frame.

# %%
centres = table.groupby(["time", "finger"])[["x", "y", "z"]].transform("mean")
table["radius"] = ((table[["x", "y", "z"]] - centres) ** 2).sum(axis=1) ** 0.5
print(table.groupby("finger")["radius"].agg(["mean", "std"]) * 1e3, "mm")

# %%
import matplotlib.pyplot as plt

plt.figure(figsize=(6, 4))
for finger, rows in table.groupby("finger"):
    plt.plot(rows["x"] * 1e3, rows["z"] * 1e3, ".", label=f"finger {finger}")
plt.xlabel("x (mm)")
plt.ylabel("z (mm)")
plt.axis("equal")
plt.legend()
plt.savefig("recording.png", bbox_inches="tight")
