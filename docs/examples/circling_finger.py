#!/usr/bin/env python3
"""Writes a recording of a finger that circles on the top of an object, as the paper's cameras would see it.

    circling_finger.py FOLDER [TURNS]

The finger is an upright cylinder with a round tip, which is 2 mm below y = 0. A turn takes 0.31 s, so the finger moves
at about 200 mm/s. There are 20 turns if you give no number.
"""
import json
import pathlib
import struct
import sys
import tomllib
import zlib

import numpy as np

RIG = pathlib.Path(__file__).resolve().parents[2] / "assets/rigs/paper.toml"
RADIUS_M = 0.007
DEPTH_M = 0.002
CIRCLE_M = 0.01  # the radius of the circle
RATE_HZ = 90
FRAMES = 28  # of a turn


def nearest(a, b, c):
    """The smaller root of a t^2 + 2 b t + c = 0; NaN if there is none."""
    with np.errstate(invalid="ignore"):
        return (-b - np.sqrt(b * b - a * c)) / a


def depth_image(camera, x, z):
    """The camera's image of the finger at x and z: depths along the optical axis in the camera's unit, 0 without a finger."""
    columns, rows = np.meshgrid(np.arange(camera["width"]), np.arange(camera["height"]))
    # Along these rays, the parameter is the depth.
    rays = np.stack([(columns - camera["cx"]) / camera["fx"], (rows - camera["cy"]) / camera["fy"], np.ones(columns.shape)], axis=-1)
    pose = np.array(camera["T_world_camera"])
    rays = rays @ pose[:3, :3].T
    centre = np.array([x, RADIUS_M - DEPTH_M, z])  # of the round tip
    begin = pose[:3, 3] - centre

    flat = np.array([1, 0, 1])  # the cylinder is the same at every y
    side = nearest((rays**2) @ flat, rays @ (begin * flat), (begin**2) @ flat - RADIUS_M**2)
    side[~(begin[1] + side * rays[..., 1] >= 0)] = np.nan
    tip = nearest((rays**2).sum(-1), rays @ begin, begin @ begin - RADIUS_M**2)
    tip[~(begin[1] + tip * rays[..., 1] < 0)] = np.nan
    return np.nan_to_num(np.fmin(side, tip) / camera["depth_unit_m"]).round().astype(np.uint16)


def write_png(file, image):
    """A 16-bit grey PNG."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = b"".join(b"\0" + row.tobytes() for row in image.astype(">u2"))
    header = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 16, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def main(folder, turns=20):
    cameras = tomllib.loads(RIG.read_text())["camera"]
    folder.mkdir(parents=True)
    # A list, number or string of these cameras is the same text in TOML and in JSON.
    text = "[recording]\n"
    for camera in cameras:
        text += "\n[[camera]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in camera.items())
    for frame in range(FRAMES):
        angle = 2 * np.pi * frame / FRAMES
        for c, camera in enumerate(cameras):
            image = depth_image(camera, CIRCLE_M * np.cos(angle), CIRCLE_M * np.sin(angle))
            write_png(folder / f"{frame:02d}-{c}.png", image)
    for frame in range(turns * FRAMES):  # each turn has the same images
        names = [f"{frame % FRAMES:02d}-{c}.png" for c in range(len(cameras))]
        text += f"\n[[frame]]\nfiles = {json.dumps(names)}\ntime_s = {frame / RATE_HZ!r}\n"
    (folder / "recording.toml").write_text(text)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or not all(turns.isdecimal() for turns in sys.argv[2:]):
        sys.exit("usage: circling_finger.py FOLDER [TURNS]")
    try:
        main(pathlib.Path(sys.argv[1]), *map(int, sys.argv[2:]))
    except OSError as error:  # for example, the folder already exists
        sys.exit(f"circling_finger.py: {error.filename}: {error.strerror}")
