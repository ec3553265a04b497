# %% [markdown]
# # The paper's Figure 6
# The finger in each of the paper's objects, with every method. This takes minutes.

# %%
import palpa

figure = palpa.figure6(palpa.asset("finger.ply"), backend="cpu")
for n in range(len(figure)):
    name, one = figure[n]
    print(f"{name:14} {one.method:13} peak {one.langevin_spot['peak']:7.1f} Pa, elongation {one.langevin_spot['elongation']:.2f} "
          f"(without the finger {one.bare_elongation:.2f})")

# %%
import matplotlib.pyplot as plt

columns = 5
rows = -(-len(figure) // columns)
plt.figure(figsize=(3 * columns, 3 * rows))
for n in range(len(figure)):
    name, one = figure[n]
    low = one.centroids[:, 1] < one.centroids[:, 1].min() + 8e-3
    plt.subplot(rows, columns, n + 1)
    plt.scatter(one.centroids[low, 0] * 1e3, one.centroids[low, 2] * 1e3, c=one.langevin[low], s=3)
    plt.title(f"{name}\n{one.method}")
    plt.axis("equal")
    plt.xlabel("x (mm)")
    plt.ylabel("z (mm)")
plt.tight_layout()
plt.savefig("figure6.png", bbox_inches="tight")
