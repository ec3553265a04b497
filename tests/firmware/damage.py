"""damage.py: bytes that are lost on the way to a board, and which frames of palpa link test it gets."""
import numpy as np

# Which bytes of a frame of 512 are lost. Later, the rest of a frame is lost, too, so that the board is in step again.
OPENMPD_DAMAGES = {"the first byte": (0, 1), "a phase": (100, 1), "a width": (300, 1), "the last byte": (511, 1), "100 bytes": (200, 100),
                   "phases and widths": (250, 12), "all but one byte": (0, 511), "half a frame": (256, 256)}
# Which bytes of a frame of 258 are lost: 254, 256 phases, 253.
SONICSURFACE_DAMAGES = {"a phase": (100, 1), "the first phase": (1, 1), "the begin": (0, 1), "the swap": (257, 1), "swap and begin": (257, 2),
                        "100 phases": (80, 100)}


def without(wire, ranges):
    kept = np.ones(len(wire), bool)
    for begin, count in ranges:
        kept[begin:begin + count] = False
    return wire[kept]


def damage_openmpd(wire, begin=8, end=12):
    """The same run twice, damaged the first time; when the second one begins."""
    first = int(np.argmax(wire["value"] >= 0x80))
    apart = ((len(wire) - first) // 512 - begin - end) // (2 * len(OPENMPD_DAMAGES))
    if apart < 3:
        raise RuntimeError("the run is too short for all kinds of lost bytes: this machine is too busy")
    ranges = []
    for number, (offset, count) in enumerate(OPENMPD_DAMAGES.values()):
        frame = first + 512 * (begin + 2 * apart * number)
        ranges += [(frame + offset, count), (frame + 512 * apart, 512 - count)]
    again = wire.copy()
    again["at_s"] += wire["at_s"][-1] + 0.05
    return np.concatenate([without(wire, ranges), again]), float(again["at_s"][0])


def damage_sonicsurface(wire, begin=3):
    frames = [at for at in np.flatnonzero(wire["value"] == 254) if at + 257 < len(wire) and wire["value"][at + 257] == 253
              and (wire["value"][at + 1:at + 257] < 32).any()]
    apart = (len(frames) - begin) // len(SONICSURFACE_DAMAGES)
    if apart < 3:
        raise RuntimeError("the run is too short for all kinds of lost bytes: this machine is too busy")
    return without(wire, [(frames[begin + apart * number] + offset, count) for number, (offset, count) in enumerate(SONICSURFACE_DAMAGES.values())])


def single_slots(wire, kind):
    """The slots that sound alone in a frame of palpa link test."""
    values, found = wire["value"], set()
    if kind == "openmpd":
        first = int(np.argmax(values >= 0x80))
        frames = [values[at + 256:at + 512] > 0 for at in range(first, len(values) - 511, 512)]
    else:
        frames = [values[at + 1:at + 257] < 32 for at in np.flatnonzero(values == 254) if at + 257 < len(values) and values[at + 257] == 253]
    for sounds in frames:
        if sounds.sum() == 1:
            found.add(int(sounds.argmax()))
    return found
