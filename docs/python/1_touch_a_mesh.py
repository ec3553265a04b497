# %% [markdown]
# # Touch a mesh
# A fingertip is pressed 3 mm into a cube. palpa finds the contacts, the finger's cross-section and its foci.

# %%
import numpy as np
import palpa

scene = palpa.Scene(palpa.asset("cube.glb"))
skin = palpa.read_ply(palpa.asset("finger.ply"))  # (n, 3) in metres, the tip at the origin
print(scene, skin.shape)

# %% [markdown]
# `penetration` lowers the skin until its lowest point is 3 mm below the top of the cube. All options of the command
# line are keywords, and numbers are in SI units.

# %%
touch = scene.touch(skin, penetration=3e-3, backend="cpu")
finger = touch.fingers[0]
print(len(touch.contacts), "contacts around", finger.centroid)
print("deepest contact:", touch.contacts.depths.max(), "m")
print("foci play in the order", touch.order, "for", touch.dwell, "s each")

# %% [markdown]
# Seen along the third axis of the cross-section, the foci form a ring around the centroid.

# %%
ring = (finger.foci - finger.centroid) @ finger.axes.T
print("radius of each focus in mm:", np.hypot(ring[:, 0], ring[:, 1]).round(4) * 1e3)

# %%
import matplotlib.pyplot as plt

plt.figure(figsize=(5, 5))
contacts = touch.contacts.positions * 1e3
plt.scatter(contacts[:, 0], contacts[:, 2], c=touch.contacts.depths * 1e3, s=12)
plt.colorbar(label="depth (mm)")
plt.plot(finger.foci[:, 0] * 1e3, finger.foci[:, 2] * 1e3, "rx", label="foci")
plt.xlabel("x (mm)")
plt.ylabel("z (mm)")
plt.axis("equal")
plt.legend()
plt.savefig("touch.png", bbox_inches="tight")
