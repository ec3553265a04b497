#!/usr/bin/env python3
"""fuzz.py [--seconds N] [--seed S] [--bin FOLDER] [--part WORD] [--only CASE]: palpa with broken files and random options.

Each case is one command of palpa. Its files are good ones that palpa has made or that the repository has, some of them
broken; its options come from the program's own --help, their values from lists of usual and unusual ones. A case
depends on the seed and its own number only, so that --only repeats it alone and keeps its files.

A case must end by itself with an exit code from 0 to 4 and at most one line of error, in limited memory and processor
time, must leave all files alone that it was given to read, and must not show the contents of files that do not concern
it. JSON that it writes must be JSON. A journal of a study keeps its lines. --part takes only commands that begin with a word.
"""
import atexit
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import shlex
import subprocess
import sys
import time

import fuzz_study
from hostile import ROOT, Cases, Display, faults_of_messages, name_of_end, small_rig
from mutate import boxes_glb, boxes_ply, mutated, octahedron_ply, small_bag, small_database
from wires import SERIAL

COST_S, COST_S_PER_MB = 1.0, 1.0  # of processor time, as in docs/limits.md
NOISE = 2.0                       # on a busy machine, caches and hyperthreads make the same work cost more
MOST_CPU_S = 60                   # for cases without such a limit: they must still end
MOST_MEMORY = 1 << 30
MOST_ADDRESSES = 6 << 30          # protects the machine that runs this
STILL_S = 20                      # without using processor time: counts as a hang
SECRET = "Zq7#vK%9xW@3jH&5"       # in files that no case may show
COMMANDS = {"touch": 10, "drive": 8, "field": 4, "run": 6, "export": 5, "scatter": 3, "simulate": 1, "decompose": 2,
            "calibrate": 3, "link test": 3, "play": 3, "doctor": 0.2, "viewer": 2, "afferents": 0.5, **fuzz_study.COMMANDS}
# The rest of a command's line: one of each of these alternatives. A word is one of its parts between |. <KIND is a file to read, >.ENDING
# a place to write to, @NAME what Case.given() gives, ~ a space.
LINES = {
    "touch": [["--scene <scene"], ["--depth <depth --camera <camera", *["--points <points --penetration 3mm|1mm|0"] * 2]],
    "drive": [["--layout @layout --csv >.csv"], ["--touch <touch", "--focus @focus", "--pattern <pattern"]],
    "field": [["--layout openmpd --csv >.csv"], ["--drive <drive", "--focus @focus"],
              ["--plane xz --size 60mm,60mm --pixels @count,@count", "--line 0,0,0 @point --samples @count", "--points <points"]],
    "run": [["--scene <scene --source @source --frames 1|2|3|3 --rig <rig|<rig|@paper"]],
    "export": [["--scene <scene --source @source --frames 1|2|3|3 --rig <rig|<rig|@paper"], ["--foci >.csv|>.json", "--drives >.bin"]],
    "scatter": [["--mesh <mesh --csv >.csv"], ["--plane-wave @point", "--point-source @point", "--layout openmpd --drive <drive"]],
    "simulate": [["--scene <scene --finger <mesh --penetration 1mm"]],
    "decompose": [["--scene <scene --out >.glb --resolution 1000"]],
    "calibrate": [["--nudge --keys right*2~enter|q|up*99999999|x| --scene <scene --source @source --frames 1|2|3 --rig <rig --out >.toml",
                   "--source @source --frames 1|2|3 --rig <rig --out >.toml", *["--target >.stl|>.glb --layout @layout"] * 2]],
    "link test": [["--link record:>.bin --layout @layout --first 0|0|1|-1 --last 1|1|2|-1 --each 1ms|1ms|2ms|0|nan --rest 1ms|1ms|2ms|0|nan"]],
    "play": [["<sensation --duration 20ms|1ms|0|nan --csv >.csv"]],
    "doctor": [["--json >.json"]],
    "viewer": [["--headless --size 64x64 --screenshot >.png --scene <scene --points <points --penetration 1mm"]],
    "afferents": [["--scene <scene --duration 20ms|60ms|0|nan"]],
    **fuzz_study.LINES}
# Options that rightly make a run endless or long, that look for devices, or that a case sets itself.
LEFT_ALONE = {"--help", "--gpu", "--backend", "--validation", "--frames", "--runs", "--resolution", "--figure6", "--view",
              "--version", "--suite", "--source", "--last", "--first", "--nudge", "--keys", "--pixels", "--samples",
              "--slice", "--write-rig", "--headless", "--size", "--log-level", "--focus", "--touch", "--drive", "--points", "--depth",
              "--camera", "--plane", "--plane-wave", "--point-source", "--line", "--mesh", "--target", "--reference", "--video", "--interact"}
# The kind of the pool that each file option reads; all others are outputs.
READS = {"--scene": "scene", "--points": "points", "--depth": "depth", "--camera": "camera", "--rig": "rig",
         "--layout": "layout", "--touch": "touch", "--mesh": "mesh", "--finger": "mesh", "--drive": "drive",
         "--skin": "points", "--board-files": "boards", "--screen": "rig", "--pattern": "pattern"}
NUMBERS = ["0", "-0", "1", "-1", "0.5", "2", "3", "10", "64", "nan", "-nan", "inf", "-inf", "1e300", "-1e300", "1e-300", "1e39", "1e-40",
           "1e999", "", " ", "x", "0x10", "1e", "--", "9" * 400, "18446744073709551616", "4294967296", "2147483648", "-2147483649",
           "1,5", "½", "1 ", "\u202e1", "\xff", "%s%n", "1\n2", "1;2"]
UNITS = {"LENGTH": ["m", "mm", "um", "cm"], "TIME": ["s", "ms", "us"], "FREQUENCY": ["Hz", "kHz"], "SPEED": ["m/s"],
         "PRESSURE": ["Pa", "kPa"]}
USUAL = {"LENGTH": ["1.5mm", "5mm", "25mm"], "TIME": ["1.5ms", "12ms", "100ms"], "FREQUENCY": ["40kHz", "200Hz"],
         "SPEED": ["343m/s"], "PRESSURE": ["2kPa", "101kPa"], "CELSIUS": ["20"], "PERCENT": ["50"], "NUMBER": ["0.5"],
         "DEGREES": ["30"], "A": ["0.5"], "X,Y,Z": ["0,0,0.1", "0,0,0"], "X,Y,Z[,A]": ["0,0,0.1", "0,5mm,0.1,0.5"],
         "X,Y,Z[,R]": ["0.02,0,0.1", "0,2cm,0.1,0.5mm"]}


class Pool:
    """Good files of each kind, as bytes; a recording is a folder of them."""

    def __init__(self, palpa, folder):
        assets = ROOT / "assets"
        rig = small_rig(8)[1]
        (folder / "rig.toml").write_text(rig)
        cube, finger = assets / "cube.glb", assets / "finger.ply"
        small = ["--scene", cube, "--backend", "cpu", "--quiet"]

        def make(*arguments):
            subprocess.run([palpa, *map(str, arguments), "--quiet"], check=True, timeout=300, stdin=subprocess.DEVNULL)

        make("run", *small, "--rig", folder / "rig.toml", "--frames", 2, "--every-frame", "--record", folder / "take")
        for method in ("cross-section", "multi-focus"):
            make("touch", *small, "--points", finger, "--penetration", "3mm", "--method", method, "--json",
                 folder / f"{method}.json")
        make("drive", "--layout", "openmpd", "--focus", "0,0,0.1", "--csv", folder / "drive.csv", "--backend", "cpu")
        make("calibrate", "--target", folder / "target.stl", "--layout", "openmpd")
        plans = [re.sub(r'"\.\./(\w[\w-]*\.glb)"', rf'"{assets}/\1"', path.read_text()).encode() for path in sorted((assets / "studies").glob("*.toml"))]
        self.study, self.study_plan = folder / "study", folder / "plan.toml"
        self.study_plan.write_bytes(plans[0])
        make("study", "rehearse", self.study_plan, "--participant", 1, "--out", self.study)
        self.take = {path.name: path.read_bytes() for path in sorted((folder / "take").iterdir())}
        camera = rig[:rig.index("[[camera]]", rig.index("[[camera]]") + 1)]
        units = "\n".join("[[transducer]]\nposition_m = [%g, %g, 0.0]\naxis = [0.0, 0.0, 1.0]" % (0.01 * x, 0.01 * y)
                          for x in range(4) for y in range(4))
        binary, text = finger.read_bytes(), octahedron_ply(0.004)
        self.files = {
            "scene": [("s.glb", (assets / name).read_bytes()) for name in
                      ("cube.glb", "prism.glb", "pyramid.glb", "button-and-knob.glb", "semi-sphere.glb", "hand.glb")],
            "points": [("p.ply", binary), ("p.ply", text)],
            "mesh": [("m.ply", text), ("m.ply", octahedron_ply(0.0012))],
            "rig": [("r.toml", rig.encode())],
            "camera": [("c.toml", camera.encode())],
            "layout": [("l.toml", (assets / "layouts/example.toml").read_bytes()), ("l.toml", units.encode())],
            "touch": [("t.json", (folder / f"{method}.json").read_bytes()) for method in ("cross-section", "multi-focus")],
            "drive": [("d.csv", (folder / "drive.csv").read_bytes())],
            "depth": [("d.png", data) for name, data in self.take.items() if name.endswith("0.png")],
            "foreign": [("f.stl", (folder / "target.stl").read_bytes()), ("f.txt", f"{SECRET}: {SECRET}\n".encode() * 40),
                        ("f.bin", bytes(range(256)) * 8), ("empty", b""), ("f.json", b'{"a": "' + SECRET.encode() + b'"}')],
            "bag": [("b.bag", small_bag()), ("b.db3", small_database())],
            "plan": [("plan.toml", plan) for plan in plans],
            "pattern": [("pattern.toml", path.read_bytes()) for path in sorted((assets / "patterns").glob("*.toml"))],
            "sensation": [("s.adaptics", path.read_bytes()) for path in sorted((assets / "sensations").glob("*.adaptics"))],
            "counts": [("counts.csv", counts) for counts in fuzz_study.COUNTS],
            "wav": fuzz_study.sounds(),
        }


class Case:
    """One command: its arguments, and the files that it reads."""

    def __init__(self, number, seed, pool, options, folder):
        self.random = random.Random(f"{seed}:{number}")
        self.pool, self.options, self.folder = pool, options, folder
        self.inputs, self.outputs, self.aliases, self.size = {}, [], [], 0
        self.judge_cost, self.may_erase, self.journal, self.environment = True, False, None, {}
        (folder / "in").mkdir(parents=True)
        (folder / "secret.txt").write_text((SECRET + "\n") * 60)
        (folder / "in/out-of.bin").symlink_to("../secret.txt")
        weights = {name: weight for name, weight in COMMANDS.items() if name in options}
        self.command = self.random.choices(list(weights), list(weights.values()))[0]
        self.arguments = self.make()

    # ---- files ----
    def keep(self, name, data):
        """Writes a file to be read."""
        path = self.folder / "in" / f"{len(self.inputs)}-{name}"
        path.write_bytes(data)
        self.read(path)
        return str(path)

    def read(self, path):
        """The command reads the file, so it may not change it."""
        self.inputs[path] = digest(path)
        self.size += path.stat().st_size

    def one_of(self, *values):
        """One of these; those that are functions are called, so that only the files of the one chosen are made."""
        value = self.random.choice(values)
        return value() if callable(value) else value

    def file(self, kind, broken=0.35):
        draw = self.random
        if kind == "recording":
            return self.recording(broken)
        if kind == "boards":
            folder = self.folder / "in/boards"
            folder.mkdir(exist_ok=True)
            for name in ("board_A.pat", f"{SERIAL}.txt"):
                path = folder / name
                text = " ".join(draw.choice(["0", "180", "-28", "1", "nan", "1e300", "EMU1", "256", "128", SECRET])
                                for _ in range(draw.choice([0, 3, 256, 2000])))
                path.write_text(text)
                self.inputs[path] = digest(path)
                self.size += len(text)
            return str(folder)
        if draw.random() < 0.03:
            return draw.choice([str(self.folder), "/dev/null", "/nonexistent/file", str(self.folder / "none"), "", "x" * 5000,
                                str(self.folder / "secret.txt"), "/proc/self/mem", "in\x01\x1b[2J.toml"])
        if draw.random() < 0.06:
            kind = draw.choice(sorted(self.pool.files))
        if kind == "scene" and draw.random() < 0.25:
            name, data = "boxes.glb", boxes_glb(draw)
        elif kind in ("mesh", "points") and draw.random() < 0.2:
            name, data = "boxes.ply", boxes_ply(draw)
        else:
            name, data = draw.choice(self.pool.files[kind])
        for _ in range(draw.choice([1, 1, 1, 2, 5]) if draw.random() < broken else 0):
            data = mutated(draw, name, data)
        return self.keep(name, data)

    def recording(self, broken):
        draw = self.random
        folder = self.folder / "in/take"
        folder.mkdir(exist_ok=True)
        victim = draw.choice([*self.pool.take, "recording.toml", "times.csv"]) if draw.random() < broken else None
        # A frame that a broken list leaves out is not part of the recording, so it may be an output.
        for name, data in self.pool.take.items():
            if name == victim:
                data = mutated(draw, name, data)
                if name.endswith(".png") and draw.random() < 0.2:
                    (folder / name).symlink_to("../../secret.txt")
                    continue
            (folder / name).write_bytes(data)
            if not name.endswith(".png") or victim not in ("recording.toml", "times.csv"):
                self.inputs[folder / name] = digest(folder / name)
            self.size += len(data)
        return str(folder)

    def out(self, kind):
        """A place to write to; now and then one of the inputs, by another name."""
        draw = self.random
        taken = [path for path in self.inputs if path.exists()]
        if taken and draw.random() < 0.12:
            path = draw.choice(taken)
            alias = self.folder / f"alias-{len(self.aliases)}"
            self.aliases.append(alias)
            how = draw.randrange(5)
            if how == 0:
                alias.symlink_to(path)
            elif how == 1:
                os.link(path, alias)
            return str([alias, alias, path, f"{path.parent}/../{path.parent.name}//{path.name}", f"/proc/self/root{path}"][how])
        if draw.random() < 0.12:
            return draw.choice(["-", "/dev/null", "/dev/full", "/nonexistent/x", str(self.folder), "", "/proc/self/x", "y" * 300])
        path = self.folder / f"out-{len(self.outputs)}{kind}"
        self.outputs.append(path)
        return str(path)

    # ---- options ----
    def value(self, name, what):
        """What an option of the help is given; what: its placeholder, or the words that it takes."""
        draw = self.random
        if name in READS and what != "WORD":
            if name == "--layout" and draw.random() < 0.6:
                return draw.choice(["openmpd", "autd3", "paper", SERIAL, "openmpd-pair", "nothing"])
            return self.file(READS[name])
        if isinstance(what, list):
            return draw.choice(what) if draw.random() < 0.95 else draw.choice(NUMBERS)
        if name == "--link":
            return self.one_of("null", lambda: f"record:{self.out('.bin')}", "foci:udp:127.0.0.1:9", "foci:udp:nowhere.invalid:9", "foci:udp:127.0.0.1:99999",
                                "openmpd:NO-SUCH-BOARD", "autd3:127.0.0.1:1", "autd3-udp:nowhere", "autd3-udp:[::1]:1", f"{SERIAL}:/dev/null", "record:", "", "x:y")
        if name == "--events":
            return self.one_of(lambda: self.out(".jsonl"), "-", "udp:127.0.0.1:9", "udp:", "udp:127.0.0.1:0")
        if name == "--record":
            return str(self.folder / draw.choice(["new", "in", "in/../new"]))
        if "FILE" in what or "-" in what:
            return self.out({"--png": ".png", "--vtu": ".vtu", "--out": draw.choice([".glb", ".toml"]),
                             "--foci": draw.choice([".csv", ".json"])}.get(name, ".txt"))
        if "X,Y,Z" in what or "," in what:
            if draw.random() < 0.8:
                return draw.choice(USUAL.get(what, ["60mm,60mm"]))
            return ",".join(draw.choice(NUMBERS) for _ in range(draw.choice([1, 2, 3, 3, 3, 4, 5])))
        if draw.random() < 0.75:
            return draw.choice(USUAL.get(what, ["1", "2", "3", "5", "10"]))
        return draw.choice(NUMBERS) + (draw.choice(UNITS[what]) if what in UNITS and draw.random() < 0.6 else "")

    def some_options(self, taken, most=4):
        draw = self.random
        known = self.options[self.command]
        names = [name for name in known if name not in LEFT_ALONE | taken]
        arguments = []
        for name in draw.sample(names, min(len(names), draw.choice([0, 0, 1, 1, 2, most]))):
            what = known[name]
            arguments.append(name)
            if what is not None:
                values = [self.value(name, what) for _ in range(2 if name == "--line" else 1)]
                if len(values) == 1 and values[0].startswith("-"):
                    arguments[-1] += "=" + values[0]
                else:
                    arguments += values
        if draw.random() < 0.02:
            arguments.insert(draw.randrange(len(arguments) + 1), draw.choice(["--", "-", "", "--bogus", "-x", "\x1b[0m", "é" * 600]))
        return arguments

    def source(self):
        return self.one_of(*[lambda: f"recording:{self.file('recording')}"] * 4, "synthetic", "synthetic", lambda: f"synthetic:{self.file('points')}",
                           lambda: f"synthetic:{self.file('mesh')}", lambda: f"bag:{self.file('bag', 0.9)}", "bag:/dev/zero", f"bag:{self.folder}",
                           "v4l2:/dev/null", "realsense:any", "recording:", f"recording:{self.folder}", "nothing:x", "")

    def given(self, name):
        """What @NAME of a line stands for."""
        return {"layout": lambda: self.value("--layout", "NAME|FILE"), "focus": lambda: self.value("--focus", "X,Y,Z[,A]"),
                "point": lambda: self.value("", "X,Y,Z"), "source": self.source, "paper": lambda: str(ROOT / "assets/rigs/paper.toml"),
                "count": lambda: self.random.choice(["2", "3", "16", "100"] if self.random.random() < 0.9 else NUMBERS),
                "number": lambda: self.random.choice(["1", "1", "1", *NUMBERS])}.get(name, lambda: fuzz_study.given(self, name))()

    def word(self, text):
        made = {"<": self.file, ">": self.out, "@": self.given}
        return re.sub(r"([<>@])([.\w]+)", lambda found: made[found[1]](found[2]), self.random.choice(text.split("|")).replace("~", " "))

    def make(self):
        draw, command = self.random, self.command
        base = command.split() if command != "viewer" else []
        for alternatives in LINES[command]:
            base += [self.word(text) for text in draw.choice(alternatives).split()]
        # The same option twice is an error, which need not be tested each time.
        more = self.some_options({argument for argument in base if argument.startswith("--") and draw.random() < 0.98})
        if command not in ("doctor", "viewer") and not command.startswith("study"):
            more += ["--backend", "cpu"]
        together = " ".join(base + more)
        # These have other costs (docs/limits.md), or a driver's.
        self.judge_cost = command in ("touch", "drive", "run", "export", "link test") and not re.search(
            r"--surface|--tune|--spectrum|--solver|--transfer|--pressure|--force|--pattern|autd3|bag:", together)
        return base + more


def digest(path):
    stat = path.stat()
    return hashlib.sha256(path.read_bytes()).hexdigest(), stat.st_ino, stat.st_mode


def options_of(program, *command):
    """The options of a command's help: name -> None for a flag, a placeholder, or the words that it takes."""
    def page(*words):
        return subprocess.run([program, *words], capture_output=True, text=True, timeout=60, check=True).stdout

    def rows(text):
        found = {}
        for name, what, rest in re.findall(r"^  (--[\w-]+)(?: (\S+))?((?:\s{2,}.*)?(?:\n {20,}.*)*)$", text, re.M):
            words = re.search(r": ([\w-]+(?:\|[\w-]+)+)", " ".join(rest.split()))
            found[name] = words[1].split("|") if what == "WORD" and words else what or None
        return found

    text = page(*command, "--help", "all")
    found = rows(text)
    # The options that all subcommands share are described on a page of their own.
    shared = text.partition("Common options (palpa help all):")[2].split()
    return found | {name: what for name, what in (rows(page("help", "all")) if shared else {}).items() if name in shared}


def observed(arguments, folder, more):
    """Runs a program, with more variables in its environment: (exit code, what is wrong with how it ran, stderr, stdout, seconds of processor time)"""
    def limits():
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_CPU_S, MOST_CPU_S + 2))
        resource.setrlimit(resource.RLIMIT_AS, (MOST_ADDRESSES, MOST_ADDRESSES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 28, 1 << 28))

    environment = dict(os.environ, PALPA_BACKEND="gpu", PALPA_CACHE="off", XDG_RUNTIME_DIR=str(folder), LP_NUM_THREADS="1", **more)
    with open(folder / "stdout", "wb") as out, open(folder / "stderr", "wb") as err:
        process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=folder, env=environment,
                                   preexec_fn=limits, start_new_session=True)
    faults, pause = [], 0.002
    spent, since = -1, time.monotonic()
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        with open(f"/proc/{process.pid}/stat") as file:
            fields = file.read().rpartition(")")[2].split()
        now = int(fields[11]) + int(fields[12])
        if now != spent or fields[0] in "RD":
            spent, since = now, time.monotonic()
        if time.monotonic() - since > STILL_S and not faults:
            faults.append(f"hangs: no processor time for {STILL_S} s")
            process.kill()
        time.sleep(pause)
        pause = min(0.05, 1.3 * pause)
    process.returncode = code = os.waitstatus_to_exitcode(status)
    if usage.ru_maxrss * 1024 > MOST_MEMORY:
        faults.append(f"{usage.ru_maxrss // 1024} MB of memory")
    err, out = ((folder / name).read_bytes() for name in ("stderr", "stdout"))
    return code, faults, err, out, usage.ru_utime + usage.ru_stime


def refuse_constant(name):
    raise ValueError(f"{name} in JSON")


def faults_of(case, program):
    """Runs a case; what is wrong with it, and its processor time."""
    code, faults, err, out, cost = observed([program, *case.arguments], case.folder, case.environment)
    if not 0 <= code <= 4 and not faults:
        faults.append(f"ends with {name_of_end(code)} after {cost:.1f} s of processor time")
    faults += faults_of_messages(err, code)
    allowed = COST_S + COST_S_PER_MB * case.size / 1e6
    if case.judge_cost and cost > NOISE * allowed:
        faults.append(f"{cost:.1f} s of processor time for {case.size / 1e6:.2f} MB; {allowed:.1f} s are allowed")
    for path, before in case.inputs.items():
        if not path.exists() or digest(path) != before:
            faults.append(f"{path.name} was an input and is another file now")
    faults += fuzz_study.faults_of_study(case)
    said = err + out
    for argument in case.arguments:
        said = said.replace(argument.encode(errors="surrogateescape"), b"")
    secret = SECRET.encode()
    if any(secret[i:i + 4] in said for i in range(len(secret) - 3)):
        faults.append("shows the content of a file that it should not read out")
    if code == 0:
        for argument, value in zip(case.arguments, case.arguments[1:]):
            path = pathlib.Path(value if value.startswith("/") else "/dev/null")
            if argument == "--json" and path.is_file():
                try:
                    json.loads(path.read_text(), parse_constant=refuse_constant)
                except ValueError as error:
                    faults.append(f"--json is no JSON: {error}")
            if argument == "--csv" and path.is_file() and case.command in ("drive", "field") and "nan" in path.read_text():
                faults.append("nan in --csv")
    return faults, cost, code


def main():
    cases = Cases("tests/house/fuzz.py", __doc__, os.cpu_count(), part={"default": "", "help": "only commands that begin with this, such as study"})
    programs = {command: cases.bin / "palpa" for command in COMMANDS if command != "viewer"}
    viewer = cases.bin / "palpa-viewer"
    options = {command: options_of(program, *command.split()) for command, program in programs.items()}
    if viewer.exists():
        options["viewer"], programs["viewer"] = options_of(viewer), viewer
    options = {command: known for command, known in options.items() if command.startswith(cases.chosen.part)}
    pool = Pool(programs["touch"], cases.work)
    display = Display()
    atexit.register(display.close)
    pool.display = display.name

    def run(number, folder):
        case = Case(number, cases.chosen.seed, pool, options, folder)
        program = str(programs[case.command])
        try:
            faults, cost, code = faults_of(case, program)
        except ValueError as error:  # an argument that no program can receive
            if "null byte" not in str(error):
                raise
            (folder / "stderr").touch()
            faults, cost, code = [], 0, 0
        return faults, name_of_end(code), [shlex.join([program, *case.arguments]), f"{name_of_end(code)}, {cost:.2f} s"]

    count, found, ends = cases.run(run)
    counts = ", ".join(f"{times} with {end}" for end, times in sorted(ends.items()))
    return cases.end(f"fuzz: seed {cases.chosen.seed}, {count} cases, {counts}", found)


if __name__ == "__main__":
    sys.exit(main())
