#!/usr/bin/env python3
"""Sends the hands that MediaPipe finds in a webcam's pictures to palpa.

    mediapipe_hands.py MODEL FX [PORT]        MODEL: hand_landmarker.task; FX: the camera's focal length in pixels
    palpa run --scene assets/cube.glb --source joints:udp:9000

Needs mediapipe and opencv-python. MediaPipe knows the shape of a hand, but not where it is. This program finds the
place where a hand of that shape, and of a usual size, would look as it does in the picture. Expect errors of a
centimetre or more, most of them towards the camera: this suits a first look, not shapes. Untried with a person's hand.
"""
import argparse
import sys
import time

import numpy as np
import palpa_lines

# A usual hand's distances from a joint to the skin, metres: thumb, then index to little finger.
THUMB_RADII = [0.0125, 0.011, 0.0095, 0.0085]
FINGER_RADII = [0.0115, 0.010, 0.0085, 0.0075, 0.0065]


def openxr_joints(landmarks):
    """OpenXR's 26 joints of MediaPipe's 21 landmarks, shape (21, 3); those that MediaPipe lacks are derived.

    Both have the tips a little inside of the fingers' ends.
    """
    wrist, knuckles = landmarks[0], landmarks[[5, 9, 13, 17]]
    joints = [0.55 * landmarks[9] + 0.45 * wrist, wrist, *landmarks[1:5]]
    for finger, knuckle in enumerate(knuckles):
        base = wrist + 0.2 * (knuckle - wrist)  # a metacarpal begins a fifth of the way from the wrist
        joints += [base, *landmarks[5 + 4 * finger : 9 + 4 * finger]]
    return np.array(joints)


def openxr_radii():
    return [0.02, 0.02, *THUMB_RADII, *(4 * FINGER_RADII)]


def to_tracker(points):
    """From a camera's axes (x right, y down, z forward) to y up and z backward."""
    return points * np.array([1, -1, -1])


def surest(sides):
    """The hands to send, by number, each with its side. `sides`: for each hand, what MediaPipe calls it and how sure it
    is. If it calls hands alike, only the surest: palpa would leave out all."""
    best = {}
    for n, (name, score) in enumerate(sides):
        if name not in best or score > sides[best[name]][1]:
            best[name] = n
    # MediaPipe assumes a mirrored picture.
    return {n: "left" if name == "Right" else "right" for name, n in best.items()}


def placed(cv2, world, pixels, camera):
    """The landmarks in the camera's frame, metres; None if there is no such place."""
    found, turn, place = cv2.solvePnP(world, pixels, camera, None, flags=cv2.SOLVEPNP_SQPNP)
    if not found or place[2, 0] <= 0:
        return None
    return world @ cv2.Rodrigues(turn)[0].T + place[:, 0]


def main(model, focal, port):
    try:
        import cv2
        import mediapipe as mp
    except ModuleNotFoundError as missing:
        sys.exit(f"mediapipe_hands.py: {missing.name} is missing: pip install mediapipe opencv-python")

    vision = mp.tasks.vision
    options = vision.HandLandmarkerOptions(
        base_options=mp.tasks.BaseOptions(model_asset_path=model), running_mode=vision.RunningMode.VIDEO, num_hands=2
    )
    sender = palpa_lines.Sender(port)
    video = cv2.VideoCapture(0)
    with vision.HandLandmarker.create_from_options(options) as landmarker:
        while True:
            fine, picture = video.read()
            t_s = time.monotonic()  # the time of the exposure is not known
            if not fine:
                sys.exit("mediapipe_hands.py: the camera gives no picture")
            height, width = picture.shape[:2]
            camera = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]])
            image = mp.Image(image_format=mp.ImageFormat.SRGB, data=cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
            result = landmarker.detect_for_video(image, int(1e3 * t_s))
            hands = []
            for n, side in surest([(hand[0].category_name, hand[0].score) for hand in result.handedness]).items():
                world = np.array([(p.x, p.y, p.z) for p in result.hand_world_landmarks[n]])
                pixels = np.array([(p.x * width, p.y * height) for p in result.hand_landmarks[n]])
                where = placed(cv2, world, pixels, camera)
                if where is None:
                    continue
                hands.append(palpa_lines.hand(side, openxr_joints(to_tracker(where)), openxr_radii()))
            sender.send(t_s, hands)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("fx", type=float)
    parser.add_argument("port", type=palpa_lines.port, nargs="?", default=9000)
    line = parser.parse_args()
    try:
        main(line.model, line.fx, line.port)
    except KeyboardInterrupt:
        pass
