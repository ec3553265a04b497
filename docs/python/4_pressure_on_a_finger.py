# %% [markdown]
# # Pressure on a finger
# `simulate` presses a rigid finger into a scene, focuses the array on it as in a live run, and computes the radiation
# pressure of the scattered sound on its skin.

# %%
import numpy as np
import palpa

scene = palpa.Scene(palpa.asset("cube.glb"))
finger = palpa.FingerBody(palpa.asset("finger.ply"))  # keeps its equations for the next method

# %%
results = {}
for method in ("cross-section", "single-focus"):
    results[method] = palpa.simulate(scene, finger, penetration=3e-3, method=method, backend="cpu")
    one = results[method]
    spot = one.langevin_spot
    print(f"{method}: at most {spot['peak']:.1f} Pa, half of it on {spot['half_area'] * 1e6:.1f} mm2, "
          f"force {1e3 * np.linalg.norm(one.force):.2f} mN")

# %% [markdown]
# The force can be computed in two ways: from the pressure on the skin, and from the momentum in the air around it.

# %%
one = results["cross-section"]
print("on the skin:", one.force, "in the air:", one.far_force)

# %%
import matplotlib.pyplot as plt

low = one.centroids[:, 1] < one.centroids[:, 1].min() + 8e-3
plt.figure(figsize=(5, 5))
plt.scatter(one.centroids[low, 0] * 1e3, one.centroids[low, 2] * 1e3, c=one.langevin[low], s=8)
plt.colorbar(label="radiation pressure (Pa)")
plt.xlabel("x (mm)")
plt.ylabel("z (mm)")
plt.axis("equal")
plt.savefig("pressure.png", bbox_inches="tight")
