"""compare.py: pulses at the outputs against the drives that a run intended."""
import dataclasses

import numpy as np

TOLERANCE = 0.52  # of a step: palpa rounds phases to whole steps


def wrap(steps, period):
    return (steps + period / 2) % period - period / 2


def between(drives, steps):
    """Each drive, and what is in equal steps on the shortest way from each to each."""
    everything = [drives]
    for a in drives:
        for b in drives:
            if a is not b:
                way = wrap(b[:, 1] - a[:, 1], 2 * np.pi)
                everything += [np.stack([a[:, 0] + (b[:, 0] - a[:, 0]) * part, a[:, 1] + way * part], -1)[None]
                               for part in (np.arange(1, steps) / steps)]
    return np.concatenate(everything)


def loudest(drives):
    """The distinct drives without those that a ramp makes quieter."""
    peak = drives[:, :, 0].max(1)
    return drives[peak > 0.999 * peak.max()]


def on_or_off(drives):
    """The distinct drives of boards without amplitudes."""
    drives = drives.copy()
    drives[:, :, 0] = drives[:, :, 0] > 0
    return np.unique(drives, axis=0)


@dataclasses.dataclass
class Result:
    """All phases in steps. `delay`: how late the pulses of this board are, from the begin of the periods of the simulation."""
    runs: int = 0              # of equal periods that were compared
    compared: int = 0          # pulses, one per output and run
    different: int = 0
    mixed: int = 0             # periods in which the outputs change
    spoiled: int = 0           # runs that show no drive at all
    widest: int = 0            # the longest pulse, in steps
    delay: float = float("nan")
    late: float = float("nan")  # by how much slots 3 modulo 8 are later than the others
    rms: float = float("nan")  # of the differences in phase
    focus: float = float("nan")  # the sound at the foci, as a part of what the same amplitudes would give in phase
    drives: int = 0            # distinct drives that were intended
    shown: int = 0             # of them at the outputs
    sounding: float = float("nan")  # part of the transducers, on average
    silent_at_end: bool = False


class Comparison:
    """The pulses of one board. `drives`: drive, transducer of the board in the layout's order, (amplitude, phase)."""

    def __init__(self, board, pins, drives, scaled=False, loudest=None):
        """`loudest`: the loudest amplitude of each drive, if other boards have it. `scaled`: all amplitudes of a frame may be lower by the same factor, as in a ramp. Boards without amplitudes leave
        transducers out for that."""
        self.board, self.scaled, self.steps = board, scaled, board.steps
        self.pins = pins.aligned() if board.aligned else pins
        self.begin, self.width, self.count = self.pins.pulses()
        self.amplitude = np.zeros((len(drives), 256))
        self.turns = np.zeros((len(drives), 256))
        self.amplitude[:, board.slot] = drives[:, :, 0]
        self.turns[:, board.slot] = drives[:, :, 1] / (2 * np.pi)
        self.loudest = self.amplitude.max(1) if loudest is None else loudest
        self.turns += board.correction / self.steps
        self.middle = self.begin + self.width / 2
        self.proper = (self.count == 1) & (self.width <= board.full_width)
        self.silent = (self.width == 0).all(1)
        self.vectors = np.exp(-2j * np.pi * self.turns) * (self.amplitude > 0)

    def nearest(self, run):
        """The drive that a run shows, and the difference of each pulse in steps, from no delay."""
        full = self.proper[run] & (self.width[run] > 0) & (self.board.any_width | (self.width[run] == self.board.full_width))
        if (full & ~self.board.uneven).any():
            full &= ~self.board.uneven
        sums = self.vectors[:, full] @ np.exp(2j * np.pi * self.middle[run][full] / self.steps)
        likely = np.flatnonzero(np.abs(sums) > np.abs(sums).max() - 0.02 * max(full.sum(), 1))
        if len(likely) > 1 and not self.scaled:
            low, high = self.board.widths(self.amplitude[likely], self.loudest[likely, None])
            off = np.maximum(low - self.width[run], self.width[run] - high).clip(0).sum(1) + (1 - np.abs(sums[likely]) / max(full.sum(), 1))
            best = likely[off.argmin()]
        else:
            best = int(np.abs(sums).argmax())
        return best, np.angle(sums[best]) * self.steps / (2 * np.pi), self.middle[run] - self.steps * self.turns[best]

    def widths_of(self, run, best):
        amplitude = self.amplitude[best]
        if self.scaled and not self.board.any_width:
            return np.zeros(256), self.board.widths(amplitude, 1)[1]
        if self.scaled:
            loud = amplitude > 0.5 * amplitude.max()
            factor = np.median(np.sin(np.pi * self.width[run][loud] / (2 * self.board.full_width)) / amplitude[loud])
            about = 0.05  # amplitudes are rounded to steps of up to 0.025, before and after the way between two drives
            return self.board.widths(amplitude * factor - about, 1)[0], self.board.widths(amplitude * factor + about, 1)[1]
        return self.board.widths(amplitude, self.loudest[best])

    def result(self, since_s=0.0):
        """What is before the first silence since then is left out: some boards sound when they are switched on."""
        found = Result(drives=len(self.amplitude))
        silent = np.flatnonzero(self.silent & (self.pins.first + self.pins.count > since_s / 25e-6))
        if not len(silent):
            return found
        runs = range(silent[0], len(self.width))
        found.widest, found.silent_at_end = int(self.width[silent[0]:].max()), bool(self.silent[-1])
        matches = {run: self.nearest(run) for run in runs if not self.silent[run]}
        delay = self.usual_delay(matches)
        if delay is None:
            return found
        shown, even, late, sounding = set(), [], [], []
        for run in runs:
            if self.silent[run]:
                found.runs, found.compared = found.runs + 1, found.compared + 256
                continue
            best, _, difference = matches[run]
            difference = wrap(difference - delay, self.steps)
            sounds, wrong = self.judge(run, best, difference)
            spoiled = (wrong & ~self.board.uneven).sum() > 2
            # A period in which the outputs change. If many of the late slots alone are wrong, it is more than that.
            few = 0 < wrong.sum() <= 4 or (wrong & ~self.board.uneven).any()
            if few and self.pins.count[run] == 1 and not self.board.aligned:
                found.mixed += 1
                continue
            found.runs += 1
            found.compared += int(sounds.sum()) if self.board.modulated else 256
            found.different += int(wrong.sum())
            found.spoiled += int(spoiled)
            if not spoiled:
                shown.add(best)
                sounding.append(sounds.mean())
                even.append(difference[sounds & ~self.board.uneven])
                late.append(difference[sounds & self.board.uneven])
        found.shown = len(shown)
        even, late = (np.concatenate(part) if part else np.zeros(0) for part in (even, late))
        if len(even):
            found.delay = delay + even.mean() + self.pins.offset_s / (25e-6 / self.steps)
            found.sounding = float(np.mean(sounding))
            found.rms = float(even.std())
            found.late = late.mean() - even.mean() if len(late) else float("nan")
            both = np.exp(2j * np.pi / self.steps * np.concatenate([even, late]))
            found.focus = float(abs(both.mean()))
        return found

    def usual_delay(self, matches):
        """The delay of most frames, in half steps: a mixed frame may look proper. If the differences fit better around their middle,
        as those of a board whose lag is no half step, it is that. None without a proper frame."""
        votes = {}
        for run, (_, delay, _) in matches.items():
            if self.proper[run][self.width[run] > 0].all():
                delay = round(2 * delay) / 2 % self.steps
                votes[delay] = votes.get(delay, 0) + self.pins.count[run]
        if not votes:
            return None
        delay = max(votes, key=votes.get)
        rest = np.concatenate([wrap(difference - delay, self.steps)[(self.width[run] > 0) & ~self.board.uneven] for run, (_, _, difference) in matches.items()])
        rest = rest[np.abs(rest) < 1]
        middle = np.percentile(rest, [1, 99]).mean()
        beyond = [(np.abs(rest - shift) > 0.51).sum() for shift in (0, middle)]
        return delay + (middle if beyond[1] < beyond[0] else 0)

    def judge(self, run, best, difference):
        """Which outputs sound, and which of them are wrong."""
        width, late = self.width[run], np.abs(difference) > TOLERANCE
        if self.board.modulated:  # absent pulses are right, and cut ones at a change
            sounds = width == self.board.full_width
            return sounds, sounds & (late | (self.amplitude[best] == 0))
        low, high = self.widths_of(run, best)
        sounds = width > 0
        return sounds, (width < low) | (width > high) | (sounds & (~self.proper[run] | late))
