#!/usr/bin/env python3
"""Receives palpa's foci and walks through them slot by slot, as another array's software would.

    palpa run --scene assets/cube.glb --link foci:udp:127.0.0.1:9000
"""
import json
import socket
import time

receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
receiver.bind(("127.0.0.1", 9000))
receiver.setblocking(False)
fingers, slot, dwell_s, heard = [], 0, 0.0015, 0.0
while True:
    try:
        frame = json.loads(receiver.recv(65536))  # one line per frame; no fingers: be silent
        fingers, heard = frame["fingers"], time.monotonic()
    except BlockingIOError:
        if time.monotonic() - heard > 0.1:
            fingers = []  # palpa is gone: be silent
    for finger in fingers:
        step = finger["order"][slot % len(finger["order"])]
        dwell_s = finger["dwell_s"]
        for focus in step if isinstance(step, list) else [step]:  # a list: foci that sound together
            x, y, z = finger["foci_m"][focus]
            print(f"slot {slot}: finger {finger['id']} on {finger['solid']}: focus at {x:.4f} {y:.4f} {z:.4f} m")
    slot += 1
    time.sleep(dwell_s)
