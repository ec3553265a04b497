"""decoded.py: what the outputs behind the shift registers do with the bytes of a wire, by the rules of the makers' firmware, as compare.py
reads it. What is heard again and again is one run, which counts them; the last one is what is heard at the end."""
import numpy as np


class Decoded:
    """`begin`, `width`: of the pulse of each run and slot, in steps; a width of 0 is silence. `late`: by how much the board's periods begin
    later than those of the first board, in steps."""
    offset_s = 0.0

    def __init__(self, steps, begin, width, late=0.0):
        heard = np.concatenate([begin, width], 1)
        _, first, count = np.unique(heard, axis=0, return_index=True, return_counts=True)
        order = np.append(np.sort(first), len(heard) - 1)
        self.begin, self.width = (begin[order] + late) % steps, width[order]
        self.first, self.count = 10 * order, np.append(10 * count[np.argsort(first)], 10)  # of periods

    def aligned(self):
        return self

    def pulses(self):
        return self.begin, self.width, (self.width > 0).astype(np.int64)


def openmpd(wire, late=0.0):
    """Frames of 512 bytes, the first of which has bit 7: 256 phases of 128 steps, 256 widths of the pulses that begin there."""
    frames, frame = [], []
    for byte in wire["value"].tolist():
        if frame or byte & 0x80:
            frame.append(byte & 0x7f)
        if len(frame) == 512:
            frames.append(frame)
            frame = []
    frames = np.array(frames, np.int64).reshape(-1, 2, 256)
    return Decoded(128, frames[:, 0], frames[:, 1], late)


def sonicsurface(wire, late_slots, late=0.0, selected_by=192):
    """254: phases of 32 steps follow, 32 is silence; 253: the buffer that they went into is heard; 192 and 193: the following phases are for
    the first board, for the second. The slots 3 modulo 8 come a step late."""
    buffers, front, counter, selected, heard = np.zeros((2, 256), np.int64), 0, 256, True, []
    for byte in wire["value"].tolist():
        if byte == 254 and selected:
            counter = 0
        elif byte == 253:
            front ^= 1
            counter = 0
            heard.append(buffers[front].copy())
        elif byte in (192, 193):
            selected = byte == selected_by
        elif selected and byte <= 32:
            buffers[front ^ 1][counter % 256] = byte
            counter = counter % 256 + 1
    heard = np.array(heard).reshape(-1, 256)
    return Decoded(32, heard + late_slots, np.where(heard < 32, 16, 0), late)
