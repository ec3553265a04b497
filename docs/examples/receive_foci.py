#!/usr/bin/env python3
"""Receives palpa's foci and plays them as another array's software would; here what would sound is printed.

    receive_foci.py [PORT] &
    palpa run --scene assets/cube.glb --link foci:udp:127.0.0.1:9000
"""
import json
import math
import socket
import sys
import time

HOLD_NS = 100_000_000  # no line for so long: palpa is gone or out of reach, be silent


def amplitude(finger, time_s):
    """Of a finger's foci, 0 to 1: its gain, times its modulation where its foci stand still."""
    if finger["modulation_hz"] == 0:
        return finger["gain"]
    raised = 0.5 * (1 + math.sin(2 * math.pi * finger["modulation_hz"] * time_s))
    return finger["gain"] * (math.sqrt(raised) if finger["modulation"] == "pressure-sine" else raised)


receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
receiver.bind(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 9000))
receiver.setblocking(False)
print("listening", flush=True)
fingers, sounding = [], False
begin = heard = time.monotonic_ns()
while True:
    now = time.monotonic_ns()
    try:
        while True:  # one line per frame, the newest counts; no fingers: be silent
            fingers, heard = json.loads(receiver.recv(65536))["fingers"], now
    except BlockingIOError:
        if now - heard > HOLD_NS:
            fingers = []
    t_ns = now - begin  # never starts again: the place in the order runs on from line to line
    for finger in fingers:
        step = finger["order"][t_ns // round(finger["dwell_s"] * 1e9) % len(finger["order"])]
        for focus in step if isinstance(step, list) else [step]:  # a list: foci that sound together
            x, y, z = finger["foci_m"][focus]
            print(f"{t_ns} ns: finger {finger['id']} on {finger['solid']}:",
                  f"amplitude {amplitude(finger, t_ns * 1e-9):.3f} of focus {focus}",
                  f"at {x:.4f} {y:.4f} {z:.4f} m", flush=True)
    if sounding and not fingers:
        print(f"{t_ns} ns: silent", flush=True)
    sounding = bool(fingers)
    tick_ns = min((round(finger["dwell_s"] * 1e9) for finger in fingers), default=1_500_000)  # the shortest dwell
    time.sleep((tick_ns - t_ns % tick_ns) * 1e-9)
