"""Hands as a tracker's program sends them, whose fingers point straight down."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples/trackers"))
import mediapipe_hands  # noqa: E402
import palpa_lines  # noqa: E402

TIP_RADIUS = 0.0065


def pointing(depths, x=0.0, side="right"):
    """MediaPipe's 21 landmarks of a hand. From the thumb on, each fingertip's skin is so deep below y = 0."""
    outward = 1 if side == "right" else -1
    landmarks = np.zeros((21, 3))
    landmarks[0] = [x + 0.02 * outward, TIP_RADIUS - max(depths) + 0.17, 0]
    for finger, depth in enumerate(depths):
        for joint in range(4):
            across, above = 0.02 * (finger - 1) * outward, 0.025 * (3 - joint)
            landmarks[1 + 4 * finger + joint] = [x + across, TIP_RADIUS - depth + above, 0]
    return landmarks


def one_finger(depth):
    """The depths of a hand that points with its index finger."""
    return [depth - 0.05, depth, depth - 0.05, depth - 0.05, depth - 0.05]


def hand(depths, x=0.0, side="right"):
    """The same hand as palpa takes it."""
    joints = mediapipe_hands.openxr_joints(pointing(depths, x, side))
    return palpa_lines.hand(side, joints, mediapipe_hands.openxr_radii())
