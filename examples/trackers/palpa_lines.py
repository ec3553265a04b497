"""The lines that palpa takes with --source joints:udp:PORT (docs/trackers.md), one for each frame of a tracker."""
import argparse
import json
import socket


def hand(side, joints, radii):
    """A hand, "left" or "right", with OpenXR's 26 joints: (x, y, z) in metres, and their distances from the skin."""
    if len(joints) != 26 or len(radii) != 26:
        raise ValueError(f"{len(joints)} joints and {len(radii)} radii, not 26")
    places = [[round(float(x), 6) for x in joint] for joint in joints]
    return {"hand": side, "joints": places, "radii": [round(float(r), 5) for r in radii]}


def line(t_s, hands):
    """A frame that was captured at that time. Without a hand, palpa is silent at once."""
    return json.dumps({"t_s": t_s, "hands": hands}, separators=(",", ":"))


def port(text):
    """A port of a command line."""
    if not text.isdecimal() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"a port is from 1 to 65535, not {text:.20}")
    return int(text)


class Sender:
    """Sends frames to palpa on this computer."""

    def __init__(self, port=9000, host="127.0.0.1"):
        self.address = (host, port)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, t_s, hands):
        self.socket.sendto((line(t_s, hands) + "\n").encode(), self.address)  # so that a file of them has lines
