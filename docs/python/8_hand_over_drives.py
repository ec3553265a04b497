# %% [markdown]
# # Drives for another toolkit
# A drive is a NumPy vector, so every toolkit that takes arrays takes it. palpa's phases are delays: the time factor is
# exp(-i w t). Toolkits with exp(+i w t) need the conjugate.

# %%
import numpy as np
import palpa

array = palpa.Layout("autd3")
drive = array.drive([[0.01, 0, 0.15], [-0.01, 0, 0.15]], solver="gs-pat", backend="cpu")
conjugate = np.conj(drive)

# %% [markdown]
# Boards take phases as bytes, and these are delays, too: a byte is palpa's phase in steps, and not that of the conjugate.
# Here is the rounding to 256 steps, and what it costs at the foci.

# %%
steps = np.round(np.angle(drive) / (2 * np.pi) * 256).astype(int) % 256
amplitudes = np.round(np.abs(drive) * 255).astype(np.uint8)
print(steps[:8], amplitudes[:8])
rounded = amplitudes / 255 * np.exp(2j * np.pi * steps / 256)
transfer = array.transfer([[0.01, 0, 0.15], [-0.01, 0, 0.15]])
print("before:", np.abs(transfer @ drive), "after:", np.abs(transfer @ rounded), "Pa")

# %% [markdown]
# torch, JAX and CuPy take the arrays with DLPack or by `numpy.asarray`. A toolkit that wants complex columns
# (batch, transducers, 1):

# %%
column = np.asarray(drive)[None, :, None]
print(column.shape, column.dtype)

# %% [markdown]
# An optimisation of your own needs only the transfer matrix: here, the loudest drive for one point is the conjugate of
# its row. It drives all transducers in full, as palpa's own drive for this array does.

# %%
row = array.transfer([0, 0, 0.15])[0]
own = np.conj(row) / np.abs(row)
palpas = array.solve([0, 0, 0.15], backend="cpu")
print("own drive:", abs(row @ own), "Pa; palpa's:", palpas.pressures[0], "Pa")
