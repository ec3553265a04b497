#!/usr/bin/env python3
"""Receives palpa's foci and plays them as another array's software would; here what would sound is printed.

    receive_foci.py [PORT [SECONDS]] &      ends when no line has come for so long after the first one [60]
    palpa run --scene assets/cube.glb --link foci:udp:127.0.0.1:9000
"""
import json
import math
import shutil
import signal
import socket
import sys
import time

HOLD_NS = 100_000_000  # no line for so long: palpa is gone or out of reach, be silent


def number(value, low, high):
    """Whether it is a number from low to high: NaN is in no range, True and False are no numbers."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and low <= value <= high


def fingers_of(datagram):
    """The line's fingers, checked as far as they are used: anybody can send a datagram. ValueError where it is no such line."""

    def need(fine):
        if not fine:
            raise ValueError(datagram)
    try:
        fingers = json.loads(datagram)["fingers"]
        need(isinstance(fingers, list))
        for finger in fingers:
            need(number(finger["id"], 0, 2**32) and number(finger["gain"], 0, 1) and isinstance(finger["solid"], str))
            need(number(finger["dwell_s"], 1e-6, 10) and number(finger["modulation_hz"], 0, 1e6))
            need(finger["modulation_hz"] == 0 or finger["modulation"] in ("pressure-sine", "amplitude-sine"))
            if "gains" in finger:  # where they change from slot to slot
                need(all(number(gain, 0, 1) for gain in finger["gains"]) and number(finger["slot_s"], 1e-6, 10))
            need("pressure_pa" not in finger or number(finger["pressure_pa"], 0, 1e6))  # where one is asked for
            need(isinstance(finger["foci_m"], list) and isinstance(finger["order"], list) and finger["order"])
            for focus in finger["foci_m"]:
                need(isinstance(focus, list) and len(focus) == 3 and all(number(axis, -1e3, 1e3) for axis in focus))
            for step in finger["order"]:
                need(step != [])
                for focus in step if isinstance(step, list) else [step]:
                    need(isinstance(focus, int) and number(focus, 0, len(finger["foci_m"]) - 1))
    except (KeyError, TypeError, RecursionError) as fault:
        raise ValueError(datagram) from fault
    return fingers


def amplitude(finger, time_s, since_s):
    """The amplitude of a finger's foci, 0 to 1: its gain, times its modulation if its foci stand still, times the gain of
    the slot if gains change since its line came."""
    gain = finger["gain"]
    if finger.get("gains"):
        gain *= finger["gains"][min(int(since_s / finger["slot_s"]), len(finger["gains"]) - 1)]
    if finger["modulation_hz"] == 0:
        return gain
    raised = 0.5 * (1 + math.sin(2 * math.pi * finger["modulation_hz"] * time_s))
    return gain * (math.sqrt(raised) if finger["modulation"] == "pressure-sine" else raised)


def show(text):
    """On a terminal, one changing line, cut to the terminal's width; otherwise, one line per text."""
    if sys.stdout.isatty():
        print(f"\r{text[:shutil.get_terminal_size().columns - 1]}\x1b[K", end="", flush=True)
    else:
        print(text, flush=True)


def main():
    """Plays until lines stop coming or a signal arrives. At the end, reports how many datagrams were not lines of foci."""
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    port = sys.argv[1] if len(sys.argv) > 1 else "9000"
    try:
        receiver.bind(("127.0.0.1", int(port)))
    except (ValueError, OverflowError, OSError) as fault:
        sys.exit(f"{sys.argv[0]}: port {port:.20}: {fault}")
    receiver.setblocking(False)
    linger_ns = round(float(sys.argv[2] if len(sys.argv) > 2 else 60) * 1e9)
    show("listening")
    bad = 0
    try:
        fingers, sounding = [], False
        begin, heard = time.monotonic_ns(), None
        while heard is None or time.monotonic_ns() - heard < linger_ns:
            now = time.monotonic_ns()
            for _ in range(1000):  # one line per frame: use the newest of at most 1000 at a time
                try:
                    fingers, heard = fingers_of(receiver.recv(65536)), now  # no fingers: be silent
                except BlockingIOError:
                    break
                except ValueError:
                    bad += 1  # ignored: it does not prolong what sounds
            if heard is None or now - heard > HOLD_NS:
                fingers = []
            t_ns = now - begin  # never starts again: the place in the order runs on from line to line
            for finger in fingers:
                step = finger["order"][t_ns // round(finger["dwell_s"] * 1e9) % len(finger["order"])]
                for focus in step if isinstance(step, list) else [step]:  # a list: foci that sound together
                    x, y, z = finger["foci_m"][focus]
                    loud = amplitude(finger, t_ns * 1e-9, (now - heard) * 1e-9)
                    show(f"{t_ns} ns: finger {finger['id']} on {ascii(finger['solid'])[1:-1]}: amplitude "
                         f"{loud:.3f} of focus {focus} at {x:.4f} {y:.4f} {z:.4f} m")
            if sounding and not fingers:
                show(f"{t_ns} ns: silent")
            sounding = bool(fingers)
            tick_ns = min((round(finger["dwell_s"] * 1e9) for finger in fingers), default=1_500_000)  # shortest dwell
            time.sleep(min(tick_ns - t_ns % tick_ns, HOLD_NS // 20) * 1e-9)  # and soon enough for the hold
        show(f"no line for {linger_ns * 1e-9:g} s")
    finally:  # silence what sounds, however it ends
        show("the end: silent")
        print(end="\n" if sys.stdout.isatty() else "")
        print(f"{bad} datagrams were no lines of foci")


def leave(*_):
    sys.exit()


if __name__ == "__main__":
    for ending in (getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP")):  # SIGHUP: its terminal was closed
        if ending is not None and signal.getsignal(ending) != signal.SIG_IGN:
            signal.signal(ending, leave)
    try:
        main()
    except KeyboardInterrupt:
        pass
