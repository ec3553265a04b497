"""places.py: where a focus sounds, from what the outputs do and where the makers have the transducers."""
import numpy as np

SPEED_M_S, FREQUENCY_HZ = 343.2, 40e3


def loudness(points, places, turns_late):
    """Sound at points from transducers that face +z from z = 0, relative to all in phase."""
    distance = np.sqrt(((points[:, None, :2] - places[None]) ** 2).sum(-1) + points[:, None, 2] ** 2)
    turns = turns_late + distance * FREQUENCY_HZ / SPEED_M_S
    return np.abs((np.exp(-2j * np.pi * turns) / distance).sum(-1)) / (1 / distance).sum(-1)


def grid(centre, half, step):
    axes = [np.arange(-h, h + s / 2, s) + c for c, h, s in zip(centre, half, step)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)


def loudest_place(places, turns_late):
    """The place above the board where the sound is most in phase, to 0.25 mm."""
    best, half = np.array([0, 0, 0.145]), np.array([0.075, 0.075, 0.045])
    for step in (3e-3, 1e-3, 0.25e-3):
        spacing = np.array([step, step, max(3 * step, 0.25e-3)])
        points = grid(best, half, spacing)
        levels = np.concatenate([loudness(part, places, turns_late) for part in np.array_split(points, max(1, len(points) // 2000))])
        best, half = points[levels.argmax()], 2 * spacing
    return best


def heard_place(comparison, places):
    """Where a single focus sounds, by the run that is the longest and loudest; `places`: of the wire's slots."""
    before = comparison.silent.cumsum() > 0  # some boards sound when they are switched on
    run = max(np.flatnonzero(before & ~comparison.silent), key=lambda run: comparison.pins.count[run] * comparison.width[run].sum())
    return loudest_place(places, comparison.middle[run] / comparison.steps)
