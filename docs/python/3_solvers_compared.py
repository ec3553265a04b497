# %% [markdown]
# # Solvers compared
# Four foci share one array. The solvers differ in how loud and how even the foci are. `greedy` always drives every
# transducer in full, so the others get the same constraint, `uniform`: with another one they would be quieter.

# %%
import numpy as np
import palpa

array = palpa.Layout("openmpd")
angles = np.arange(4) * np.pi / 2
foci = np.stack([0.015 * np.cos(angles), 0.015 * np.sin(angles), np.full(4, 0.15)], axis=1)

results = {}
for solver in ("naive", "gs-pat", "greedy", "loudest"):
    results[solver] = array.solve(foci, solver=solver, constraint="uniform", backend="cpu")
    one = results[solver]
    print(f"{solver:8} mean {one.pressures.mean():6.0f} Pa, weakest to strongest {one.evenness:.3f}")

# %% [markdown]
# You can also ask for a pressure. The array then gives each focus this pressure, if it can.

# %%
asked = array.solve(foci, pressure=1000, backend="cpu")
print("asked for 1000 Pa:", asked.pressures.round(1))

# %% [markdown]
# Real arrays differ from their data. `spread` computes the drive again for random arrays.

# %%
sure = array.solve(foci, solver="gs-pat", constraint="uniform", spread="amplitude=10%,phase=0.2", draws=50, seed=1, backend="cpu")
print("weakest to strongest, 5 %, 50 % and 95 % of arrays:", np.round(sure.spread["evenness"], 3))

# %%
import matplotlib.pyplot as plt

plt.figure(figsize=(6, 4))
for i, (solver, one) in enumerate(results.items()):
    plt.bar(np.arange(4) + 0.2 * i, one.pressures, width=0.2, label=solver)
plt.xticks(np.arange(4) + 0.3, [f"focus {n}" for n in range(4)])
plt.ylabel("pressure (Pa)")
plt.legend()
plt.savefig("solvers.png", bbox_inches="tight")
