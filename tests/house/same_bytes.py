#!/usr/bin/env python3
"""same_bytes.py BEFORE AFTER [WORD...]: what two builds of palpa compute from the same input, compared byte by byte.

BEFORE and AFTER are folders with the programs (build/release/bin). For changes that are to leave every result as it is: each line says
what was asked and whether both answered the same bytes; timing_ms and the backend are left out. Drives may differ by what a line
allows (--tolerance, as complex amplitudes), and the line says by how much they do. Without $PALPA_SHARED or ../shared, its recordings
are not compared. With WORDs, only the cases whose name holds one of them. Exit code 1 where anything differs by more."""

import argparse
import cmath
import json
import os
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile

from wires import KINDS

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OBJECTS = ["cube", "semi-sphere", "pyramid", "prism"]
PRESS = ["--points", "assets/finger.ply", "--penetration", "3mm"]
DATA = os.path.join(os.environ.get("PALPA_SHARED") or os.path.join(os.path.dirname(ROOT), "shared"), "data")
os.environ["PALPA_BACKEND"] = "gpu"  # of cases that name none
LEFT_OUT = {"timing_ms", "backend", "backend_why"}


def scene(name):
    return ["--scene", f"assets/{name}.glb"]


def films():
    """Name, and arguments for what is seen and touched: recordings, and rendered hands."""
    yield "take", [*scene("cube"), "--source", "recording:assets/depth/take"]
    for hand, model in {"hand": "button-and-knob", "hand-point": "button-and-knob", "hand-relaxed": "hand"}.items():
        yield hand, [*scene(model), "--source", f"synthetic:assets/{hand}.glb", "--frames", "30"]
    flicker, unsteady = os.path.join(DATA, "flicker"), os.path.join(DATA, "hands-unsteady")
    for recording, model in {
        "one-finger-through-semi-sphere": "assets/semi-sphere.glb",
        "spread-hand-leaning": f"{flicker}/plate-35mm.glb",
        "two-fingers-touching": f"{flicker}/plate.glb",
    }.items():
        if os.path.isdir(flicker):
            yield recording, ["--scene", model, "--source", f"recording:{flicker}/{recording}"]
    for recording, model in {"faint-slide": "plate-60.glb", "palm-back-thin": "plate-2.glb"}.items():
        if os.path.isdir(unsteady):
            yield recording, ["--scene", f"{unsteady}/{model}", "--source", f"recording:{unsteady}/{recording}"]


def cases():
    """Name, what is compared, arguments; OUT, with an ending or without, is the file that both write. OUT/NAME is a file in a folder."""
    for backend in ["gpu", "cpu"]:
        on = ["--backend", backend]
        for name, seen in films():
            for what, ahead in {"": [], " ahead": ["--predict-latency", "20ms"]}.items():
                yield f"film {name}{what} {backend}", "film", [
                    "export", *seen, *on, *ahead, "--foci", "OUT/foci.json", "--events", "OUT/events", "--drives", "OUT/drives"]
        for name in OBJECTS:
            yield f"touch {name} {backend}", "json", ["touch", *scene(name), *PRESS, *on, "--json", "OUT"]
            yield f"drives {name} {backend}", "drives", ["export", *scene(name), *on, "--frames", "30", "--drives", "OUT"]
        for method in ["single-focus", "ellipse", "multi-focus"]:
            yield f"touch {method} {backend}", "json", [
                "touch", *scene("prism"), *PRESS, *on, "--method", method, "--json", "OUT"]
            yield f"drives {method} {backend}", "drives", [
                "export", *scene("prism"), *on, "--method", method, "--frames", "12", "--drives", "OUT"]
        for what, options in {
            "parts": ["--surface", "parts"],
            "inside": ["--cluster", "inside"],
            "arc": ["--spacing", "arc"],
            "stride": ["--foci", "12", "--stride", "5"],
            "deltas": ["--delta", "3mm", "--finger-gap", "2mm", "--min-points", "3"],
            "tune": ["--tune", "--spectrum"],
        }.items():
            yield f"touch {what} {backend}", "json", ["touch", *scene("cube"), *PRESS, *on, *options, "--json", "OUT"]
        yield f"touch hand {backend}", "json", [
            "touch", *scene("button-and-knob"), "--points", "assets/finger.ply", *on, "--json", "OUT"]
        yield f"contacts {backend}", "bytes", ["touch", *scene("semi-sphere"), *PRESS, *on, "--csv", "OUT"]
        yield f"events {backend}", "bytes", [
            "run", *scene("button-and-knob"), *on, "--every-frame", "--frames", "60", "--events", "OUT"]
        yield f"foci {backend}", "foci", [
            "run", *scene("button-and-knob"), *on, "--every-frame", "--frames", "60", "--link", "UDP"]
        yield f"foci tune {backend}", "foci", [
            "run", *scene("pyramid"), *on, "--tune", "--every-frame", "--frames", "20", "--link", "UDP"]
        foci = ["--focus", "0,0,0", "--focus", "1cm,0,0", "--focus", "0,8mm,1cm"]
        for solver in ["naive", "gs-pat", "greedy"]:
            for constraint in ["normalise", "uniform", "clamp"]:
                if solver == "greedy" and constraint != "uniform":
                    continue
                yield f"drive {solver} {constraint} {backend}", "drive", [
                    "drive", "--layout", "paper", *foci, *on, "--solver", solver, "--constraint", constraint, "--csv", "OUT"]
    for layout in sorted([*KINDS, "openmpd-pair", "paper"]):
        for amplitude in ["distance", "uniform"]:
            yield f"drive {layout} {amplitude}", "bytes", [
                "drive", "--layout", layout, "--focus", "5mm,-3mm,12cm", "--amplitude", amplitude, "--csv", "OUT"]
    spot = ["--layout", "openmpd", "--focus", "0,0,15cm"]
    plane = ["--plane", "xz", "--centre", "0,0,15cm", "--size", "4cm,4cm", "--pixels", "41,41"]
    finger = ["--finger", "assets/finger.ply", "--penetration", "3mm"]
    for file in ["json", "csv", "vtu", "png"]:
        kind = "json" if file == "json" else "bytes"
        yield f"field {file}", kind, ["field", *spot, *plane, f"--{file}", "OUT"]
        yield f"simulate {file}", kind, ["simulate", *scene("cube"), *finger, f"--{file}", "OUT"]
    for what, options in {
        "cameras": ["--skin", "cameras"],
        "spectrum": ["--spectrum", "--tune"],
        "transfer": ["--transfer", "finger", "--pressure", "2000"],
        "multi-focus": ["--method", "multi-focus", "--solver", "gs-pat"],
    }.items():
        yield f"simulate {what}", "json", ["simulate", *scene("prism"), *finger, *options, "--json", "OUT"]
    yield "simulate figure 6", "json", ["simulate", "--figure6", "--json", "OUT"]
    yield "simulate figure 6 png", "bytes", ["simulate", "--figure6", "--png", "OUT"]
    scattered = ["scatter", "--mesh", "assets/finger.ply", "--plane-wave", "0,0,1"]
    yield "scatter json", "json", [*scattered, "--json", "OUT"]
    yield "scatter faces", "bytes", [*scattered, "--csv", "OUT"]
    yield "scatter plane", "bytes", [*scattered, *plane, "--csv", "OUT"]
    yield "drive json", "json", ["drive", "--layout", "paper", "--focus", "0,0,0", "--focus", "2cm,0,0", "--json", "OUT"]
    yield "drive of a finger", "json", [
        "drive", "--layout", "paper", "--focus", "0,0.2mm,0", "--transfer", "finger", "--mesh", "assets/finger.ply",
        "--json", "OUT"]
    for file in ["csv", "json"]:
        yield f"export foci {file}", "bytes", ["export", *scene("cube"), "--frames", "20", "--foci", f"OUT.{file}"]
    yield "export events", "bytes", ["export", *scene("button-and-knob"), "--frames", "40", "--events", "OUT"]
    yield "target", "bytes", ["calibrate", "--target", "OUT.stl", "--layout", "openmpd"]
    yield "calibrate", "json", ["calibrate", "--layout", "paper", "--frames", "2", "--json", "OUT"]
    yield "recording", "folder", ["run", *scene("cube"), "--every-frame", "--frames", "5", "--record", "OUT"]
    yield "picture", "viewer", [
        *scene("cube"), *PRESS, "--skin", "assets/finger.ply", "--layout", "paper", "--inset", "--spectrum", "--headless",
        "--screenshot", "OUT"]
    yield "afferents json", "json", ["afferents", *scene("cube"), "--json", "OUT"]
    yield "afferents csv", "bytes", ["afferents", *scene("prism"), "--method", "single-focus", "--csv", "OUT"]
    yield "afferents times", "bytes", ["afferents", *scene("prism"), "--duration", "60ms", "--times", "OUT"]
    yield "afferents png", "bytes", ["afferents", *scene("cube"), "--duration", "60ms", "--png", "OUT"]
    for plan in ["paper", "five-minutes"]:
        file = f"assets/studies/{plan}.toml"
        yield f"study plan {plan}", "json", ["study", "plan", file, "--participant", "4", "--json", "OUT"]
        yield f"study plan csv {plan}", "bytes", ["study", "plan", file, "--participant", "4", "--csv", "OUT"]
        yield f"study level {plan}", "json", ["study", "level", file, "--json", "OUT"]
        yield f"study rehearse {plan}", "study", ["study", "rehearse", file, "--participant", "4", "--out", "OUT"]
    yield "study withdraw", "withdrawn", ["study", "withdraw", "4", "--out", "OUT.study", "--json", "OUT"]
    yield "decompose", "gltf", ["decompose", *scene("cube"), "--parts", "4", "--out", "OUT.glb"]


def run(binaries, kind, arguments, out):
    program = os.path.join(binaries, "palpa-viewer" if kind == "viewer" else "palpa")
    receiver = None
    if kind == "foci":
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
        receiver.bind(("127.0.0.1", 0))
    link = f"foci:udp:127.0.0.1:{receiver.getsockname()[1]}" if receiver else ""
    if kind == "withdrawn":  # there must be somebody
        subprocess.run([program, "study", "rehearse", "assets/studies/five-minutes.toml", "--participant", "4", "--out", f"{out}.study",
                        "--quiet"], cwd=ROOT, capture_output=True, check=False)
    if kind == "film":
        os.mkdir(out)
    words = [out + a[3:] if a.startswith(("OUT/", "OUT.study")) else out if a.startswith("OUT") else a.replace("UDP", link)
             for a in arguments] + ["--quiet"]
    done = subprocess.run([program, *words], cwd=ROOT, capture_output=True, check=False)
    if receiver:
        receiver.settimeout(0.2)
        with open(out, "wb") as file:
            try:
                while True:
                    file.write(receiver.recv(1 << 17))
            except socket.timeout:
                pass
        receiver.close()
    return done.returncode, done.stderr.decode(errors="replace").strip()


def without_times(document):
    if isinstance(document, dict):
        return {key: without_times(value) for key, value in document.items() if key not in LEFT_OUT}
    return [without_times(value) for value in document] if isinstance(document, list) else document


def read_study(folder):
    """The logs of a study, by name. When it began and by which build belongs to the run, and a journal has both in every line's checksum."""
    files = {}
    for path in sorted(pathlib.Path(folder).rglob("*")):
        if path.is_file() and not path.name.endswith("_journal.jsonl"):
            text = path.read_text(encoding="utf-8")
            files[path.relative_to(folder).as_posix()] = re.sub(r'"(StartTimeUtc|PalpaVersion)": "[^"]*"', "", text)
    return files


def read_json(path):
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    return without_times(document)


def read_gltf(path):
    """A .glb's JSON, whose white space is free, and its binary chunk."""
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[20 + length:]


def read_drives(path):
    """The header, the slots' numbers, and of each slot (amplitude, phase, ...), from docs/run.md."""
    with open(path, "rb") as file:
        data = file.read()
    transducers = struct.unpack_from("<I", data, 12)[0]
    size = 8 + 8 * transducers
    records = range(24, len(data), size)
    slots = [struct.unpack_from("<Q", data, at)[0] for at in records]
    return data[:24], slots, [struct.unpack_from(f"<{2 * transducers}f", data, at + 8) for at in records]


def apart(a, b):
    """Largest difference of drives given as amplitude, phase, amplitude, phase ..."""
    worst = 0.0
    for i in range(0, len(a), 2):
        if a[i] == b[i] and a[i + 1] == b[i + 1]:
            continue
        worst = max(worst, abs(cmath.rect(a[i], a[i + 1]) - cmath.rect(b[i], b[i + 1])))
    return worst


def compare_drives(before, after):
    head_before, slots_before, drives_before = read_drives(before)
    head_after, slots_after, drives_after = read_drives(after)
    if head_before != head_after or slots_before != slots_after:
        return None
    return max((apart(b, a) for b, a in zip(drives_before, drives_after)), default=0.0)


def compare_csv(before, after):
    with open(before, encoding="utf-8") as one, open(after, encoding="utf-8") as two:
        rows, others = one.read().splitlines(), two.read().splitlines()
    if len(rows) != len(others) or rows[0] != others[0]:
        return None
    drives = []
    for lines in (rows[1:], others[1:]):
        drives.append([float(x) for line in lines for x in line.split(",")[-2:]])
    return apart(drives[0], drives[1])


def compare(kind, before, after, tolerance):
    if kind == "study":
        return "same" if read_study(before) == read_study(after) else "DIFFERENT"
    if kind == "film":
        verdicts = {of: compare(how, f"{before}/{of}", f"{after}/{of}", tolerance)
                    for of, how in {"foci.json": "bytes", "events": "bytes", "drives": "drives"}.items()}
        wrong = [f"{of} {verdict}" for of, verdict in verdicts.items() if verdict.startswith("DIFFERENT")]
        return f"DIFFERENT: {', '.join(wrong)}" if wrong else verdicts["drives"]
    if kind in ("json", "withdrawn"):
        return "same" if read_json(before) == read_json(after) else "DIFFERENT"
    if kind == "gltf":
        return "same" if read_gltf(before) == read_gltf(after) else "DIFFERENT"
    if kind == "folder":
        names = sorted(os.listdir(before))
        if names != sorted(os.listdir(after)):
            return "DIFFERENT files"
        wrong = [n for n in names if compare("bytes", os.path.join(before, n), os.path.join(after, n), 0) != "same"]
        return "same" if not wrong else "DIFFERENT: " + ", ".join(wrong)
    if kind == "foci":  # the number of silences at the end is not compared
        with open(before, "rb") as one, open(after, "rb") as two:
            lines = [[line for line in f.read().splitlines() if b'"fingers":[]' not in line] for f in (one, two)]
        # A plan replaced by the next one was never sent.
        known = set(lines[0])
        strange = [line for line in lines[1] if line not in known]
        common = len(lines[1]) - len(strange)
        if common and len(strange) <= len(lines[1]) // 10 and common >= 0.5 * len(known):
            return f"same ({common} of {len(known)} lines in both)"
        return f"DIFFERENT: {len(strange)} of {len(lines[1])} lines were not there before"
    if kind in ("drives", "drive"):
        with open(before, "rb") as one, open(after, "rb") as two:
            if one.read() == two.read():
                return "same"
        worst = compare_drives(before, after) if kind == "drives" else compare_csv(before, after)
        if worst is None:
            return "DIFFERENT"
        return f"{'apart by' if worst <= tolerance else 'DIFFERENT by'} {worst:.2g}"
    with open(before, "rb") as one, open(after, "rb") as two:
        return "same" if one.read() == two.read() else "DIFFERENT"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--tolerance", type=float, default=1e-5, help="how far drives may be apart, full amplitude being 1 [1e-5]")
    options = parser.parse_args()
    wrong = count = 0
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, kind, arguments) in enumerate(cases()):
            if options.words and not any(word in name for word in options.words):
                continue
            ending = next((word[3:] for word in arguments if word.startswith("OUT") and "/" not in word and word != "OUT.study"), "")
            outs = [os.path.join(folder, f"{side}{number}{ending}") for side in "ba"]
            codes = [run(os.path.abspath(side), kind, arguments, out)
                     for side, out in zip((options.before, options.after), outs)]
            if codes[0][0] != codes[1][0]:
                verdict = f"DIFFERENT exit codes {codes[0][0]}, {codes[1][0]}: {codes[0][1]} | {codes[1][1]}"
            elif codes[0][0] != 0:
                verdict = f"DIFFERENT: neither works: {codes[0][1]}"
            else:
                verdict = compare(kind, outs[0], outs[1], options.tolerance)
            count += 1
            wrong += verdict.startswith("DIFFERENT")
            print(f"{name:34s} {verdict}", flush=True)
    print(f"{count - wrong} of {count} the same")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
