# %% [markdown]
# # A live loop with events
# A session takes depth frames from a source and plays drives to a link. Here, the source is a finger that palpa
# renders, and the link is a file.

# %%
import tempfile

import palpa

scene = palpa.Scene(palpa.asset("cube.glb"))
folder = tempfile.mkdtemp()
session = palpa.Session(scene, source="synthetic", link=f"record:{folder}/drives.bin", every_frame=True, backend="cpu")

# %% [markdown]
# Callbacks run on the session's thread and must return quickly. If one raises an exception, or if you press Ctrl-C,
# the loop ends in silence, and the exception is raised here.

# %%
depths, kinds = [], []


def on_frame(touch):
    depths.append(max((finger.depth for finger in touch.fingers), default=0.0))


def on_event(event):
    kinds.append(event.kind)
    if event.kind == "touch":
        print("a finger touches", event.solid, "at", event.centroid)


stats = session.run(frames=60, on_frame=on_frame, on_event=on_event)
print(stats, stats.drives, "drives,", stats.silent_drives, "silent")

# %% [markdown]
# While a session runs in the background, any thread may move solids and change the loudness, without waiting. A session
# does not replace the file of its first run, so this is another one, with a file of its own.

# %%
with palpa.Session(scene, source="synthetic", link=f"record:{folder}/softer.bin", every_frame=True, backend="cpu") as session:
    session.start(frames=30)
    session.set_gain(0.5)
    session.set_pose("cube", [[1.0, 0, 0, 0], [0, 1.0, 0, -0.002], [0, 0, 1.0, 0], [0, 0, 0, 1.0]])
    print(session.wait())

# %%
import matplotlib.pyplot as plt

plt.figure(figsize=(6, 3))
plt.plot([1e3 * depth for depth in depths])
plt.xlabel("frame")
plt.ylabel("depth of the finger (mm)")
plt.savefig("live.png", bbox_inches="tight")
