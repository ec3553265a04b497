"""pins.py: what the outputs behind the shift registers did: pulses by period, output and board."""
import numpy as np


class Pins:
    """Runs of equal periods: `first` and `count`; `on`: run, step, slot of the wire."""

    def __init__(self, file, steps, slot_of_output):
        """`slot_of_output[n]`: the wire's slot modulo 8 at output n of a register, QA is 0."""
        with open(file, "rb") as stream:
            self.offset_s = float(np.fromfile(stream, "<f8", 1)[0])
            runs = np.fromfile(stream, [("first", "<u8"), ("count", "<u8"), ("outputs", "<u4", (steps, 8))])
        self.steps = steps
        self.first, self.count = runs["first"].astype(np.int64), runs["count"].astype(np.int64)
        bits = np.unpackbits(np.ascontiguousarray(runs["outputs"]).view(np.uint8).reshape(len(runs), steps, 8, 4), axis=-1, bitorder="little")
        self.on = np.empty((len(runs), steps, 32, 8), np.uint8)
        for n, slot in enumerate(slot_of_output):
            self.on[:, :, :, slot] = bits[:, :, n]
        self.on = self.on.reshape(len(runs), steps, 256)

    def aligned(self):
        """The same with periods that begin where the board changes its outputs, if it always changes them at the same step."""
        changes = np.zeros(self.steps, np.int64)
        for before, mixed, after in zip(self.on, self.on[1:], self.on[2:]):
            same_before, same_after = (mixed == before).all(1), (mixed == after).all(1)
            last = len(same_before) - np.argmax(~same_after[::-1]) if not same_after.all() else 0
            if same_before[:last].all():
                changes[last] += 1
        begin = int(changes.argmax())
        if begin == 0:
            return self
        frames, first, count = [], [], []
        for run in range(len(self.on)):
            pieces = [(self.count[run] - 1, np.roll(self.on[run], -begin, axis=0))]
            if run + 1 < len(self.on):
                pieces.append((1, np.concatenate([self.on[run][begin:], self.on[run + 1][:begin]])))
            at = self.first[run]
            for number, frame in pieces:
                if number == 0:
                    continue
                if frames and (frames[-1] == frame).all():
                    count[-1] += number
                else:
                    frames.append(frame)
                    first.append(at)
                    count.append(number)
                at += number
        moved = object.__new__(Pins)
        moved.offset_s, moved.steps = self.offset_s + 25e-6 / self.steps * begin, self.steps
        moved.first, moved.count, moved.on = np.array(first), np.array(count), np.array(frames)
        return moved

    def pulses(self):
        """For each run and slot: begin and width in steps, and how many pulses begin in the period."""
        rises = self.on & (1 - np.roll(self.on, 1, axis=1))
        return rises.argmax(1), self.on.sum(1, dtype=np.int64), rises.sum(1, dtype=np.int64)
