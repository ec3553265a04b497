#!/usr/bin/env python3
"""mutants.py [NAME..]: do the tests catch small faults? tests/house/mutants/NAME.patch has one fault each.

Each patch is applied to a copy of the project's files (build/mutants/palpa, which is kept), built, and taken back. The topics
whose programs have changed run, quick ones first, until one fails twice: first those of the folders that the patch names
(engine/touch: tests_touch), before all else is built, then all others. If that topic fails without the fault, too, it
proves nothing, and the others go on. A patch with a line "leg: NAME" is built and run as that leg of tests/house/matrix.sh.

build/mutants/results has a line for each fault: NAME|caught|TOPIC: TEST|SECONDS, or "missed", "stale" (it does not apply any
more) or "does not build". What is there for the same sources is not run again, so an interrupted run goes on where it was.
To run a fault again, remove its line. build/mutants.md has the table.
"""
import hashlib
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATCHES = ROOT / "tests/house/mutants"
OUT = ROOT / "build/mutants"
COPY = OUT / "palpa"
RESULTS = OUT / "results"
# Topics of about the same cost run side by side: those up to each of these seconds, then the rest.
BATCHES = [0.5, 3, 15, float("inf")]
# git must not take the copy for a part of the repository around it. ccache finds what another clone has compiled.
ENVIRONMENT = {**os.environ, "GIT_CEILING_DIRECTORIES": str(OUT), "CCACHE_BASEDIR": str(COPY),
               "GTEST_FAIL_FAST": "1", "PYTEST_ADDOPTS": "-x"}  # the first failure is enough


class Leg:
    """How faults are built and run: a preset, the tests of a label (None: all), and their environment."""

    def __init__(self, name, preset="release", label=None, environment=None):
        self.name, self.preset, self.label = name, preset, label
        self.environment = {**ENVIRONMENT, **(environment or {})}
        self.build = COPY / "build" / preset
        self.clean = None  # the programs without a fault, by their hashes
        self.passes, self.fails = set(), set()  # topics without a fault


def say(line):
    print(f"mutants: {line}", flush=True)


def die(line):
    sys.exit(f"mutants: {line}")


def run(command, leg=None):
    return subprocess.run(command, cwd=COPY, env=leg.environment if leg else ENVIRONMENT, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", check=False)


# ---- the copy -------------------------------------------------------------------------------------------------------


def git(*words):
    """Git on the copy, whose own folder of git lies beside it."""
    return run(["git", f"--git-dir={OUT / 'git'}", f"--work-tree={COPY}", *words])


def make_copy(tree):
    """Makes the copy that tree of the project's repository."""
    (OUT / "git/index.lock").unlink(missing_ok=True)  # of a run that was killed
    git("init", "--quiet")
    objects = subprocess.run(["git", "rev-parse", "--path-format=absolute", "--git-path", "objects"], cwd=ROOT, capture_output=True, text=True, check=True)
    (OUT / "git/objects/info/alternates").write_text(objects.stdout)
    restore(tree)
    git("clean", "--quiet", "-d", "--force")
    shared = OUT / "shared"  # tests find large files beside the clone
    if (ROOT.parent / "shared").is_dir() and not shared.exists():
        shared.symlink_to(ROOT.parent / "shared")


def restore(tree):
    """Takes back a patch. A file that is the same keeps its time, so that nothing is built again."""
    done = git("read-tree", "--reset", "-u", tree)
    if done.returncode:
        die(done.stdout)


def apply(path, *options):
    return run(["git", "apply", *options, str(path)]).returncode == 0


# ---- building -------------------------------------------------------------------------------------------------------


def all_legs():
    legs = {"": Leg("")}
    for line in run(["tests/house/matrix.sh", "list"]).stdout.splitlines():
        name, preset, label, *variables = line.split()
        legs[name] = Leg(name, preset, None if label == "-" else label, dict(one.split("=", 1) for one in variables))
    return legs


def build(leg, targets=()):
    """Builds these targets, or all that the leg's topics need. Returns what the build said, or None if it succeeded."""
    if leg.clean is None:
        made = run(["cmake", "--preset", leg.preset, "--log-level=WARNING"], leg)
        if made.returncode:
            return made.stdout
    jobs = subprocess.run([ROOT / "tests/house/jobs.sh", "compilers", "1200", str((os.cpu_count() or 1) + 1)], stdout=subprocess.PIPE, text=True, check=True)
    targets = targets or (sorted(topics_of(leg)) if leg.label else [])
    made = run(["cmake", "--build", "--preset", leg.preset, "--parallel", jobs.stdout.strip(), *(["--target", *targets] if targets else [])], leg)
    return None if made.returncode == 0 else made.stdout


def programs(leg):
    """The hashes of all programs and of the Python module, by their paths in the build folder."""
    files = [*leg.build.glob("bin/*"), *leg.build.glob("python/palpa/*.so")]
    return {str(path.relative_to(leg.build)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files if path.is_file()}


def build_without(leg, targets=()):
    fault = build(leg, targets)
    if fault:
        die(f"without any fault, the preset {leg.preset} does not build:\n{fault[-3000:]}")


# ---- topics ---------------------------------------------------------------------------------------------------------


def topics_of(leg):
    """ctest's entries: name: (the program, relative to the build folder, labels)."""
    listed = run(["ctest", "--test-dir", str(leg.build), "--show-only=json-v1", *(["-L", f"^{leg.label}$"] if leg.label else [])], leg)
    begin = listed.stdout.find("{")
    if listed.returncode != 0 or begin < 0:
        die(f"ctest lists no tests of the preset {leg.preset}:\n{listed.stdout[-2000:]}")
    topics = {}
    for test in json.loads(listed.stdout[begin:])["tests"]:
        labels = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
        program = os.path.relpath(test["command"][0], leg.build) if "command" in test else ""  # it is not built yet
        topics[test["name"]] = program, labels[0] if labels else []
    return topics


def costs(leg):
    known = {}
    for build_folder in (leg.build, ROOT / "build/release"):
        path = build_folder / "Testing/Temporary/CTestCostData.txt"
        for parts in map(str.split, path.read_text().splitlines() if path.is_file() else []):
            if len(parts) == 3 and float(parts[2]) > 0:
                known[parts[0]] = float(parts[2])  # those of the real build are not those of a fault
    return known


def used_by(leg, program):
    """The programs that a topic may run: its own, and those that are built before it. A script may run all that ship."""
    if program not in leg.clean:
        return {name for name in leg.clean if "/tests_" not in name}
    return {program, *run(["ninja", "-C", str(leg.build), "-t", "inputs", program]).stdout.splitlines()}


def near_of(leg, path):
    """The test programs of the folders that a patch names, if they are not all that the leg has."""
    folders = {part for file in re.findall(r"^\+\+\+ b/(\S+)$", path.read_text(), re.M) for part in Path(file).parts}
    return {} if leg.label else {name for name in leg.clean if Path(name).name.removeprefix("tests_") in folders and "/tests_" in name}


def batches(leg, changed, of, left_out):
    """Lists of topics of programs (None: all) that may run changed ones, to be run side by side: quick ones first, live ones
    last, each of these alone."""
    topics, known = topics_of(leg), costs(leg)
    concerned = {program for program, _ in topics.values() if (of is None or program in of) and changed & used_by(leg, program)}
    order = sorted((name for name in topics if topics[name][0] in concerned and name not in left_out), key=lambda name: (known.get(name, 60), name))
    least = 0
    for most in BATCHES:
        yield [name for name in order if "live" not in topics[name][1] and least <= known.get(name, 60) < most]
        least = most
    yield from ([name] for name in order if "live" in topics[name][1])


def first_failure(leg, batch):
    """Runs topics until one fails. Returns (topic, test), or None."""
    said = run(["tests/house/suite.sh", leg.preset, "--stop-on-failure", "-R", f"^({'|'.join(map(re.escape, batch))})$"], leg)
    if said.returncode == 0:
        return None
    failed = re.findall(r"^\s*\d+ - (\S+) \(([^)]*)\)", said.stdout, re.M)
    failed = [(topic, how) for topic, how in failed if how not in ("Not Run", "Skipped", "Disabled")]
    if not failed:
        die(f"ctest failed, but no topic did:\n{said.stdout[-3000:]}")
    topic, how = failed[0]
    own = re.search(rf"Test +#\d+: {re.escape(topic)} \.*\*.*?(?=\n *\d+/\d+ Test +#|\Z)", said.stdout, re.S)
    tests = re.findall(r"^(?:\[  FAILED  \]|FAILED) ([\w./:\[\]-]+)", own.group(), re.M) if own else []
    return topic, tests[0].rstrip(".") if tests else how.lower()


def repeats(leg, topic, how):
    """Whether a failure comes again, so that it is no chance. Races are chance, and what hangs has taken long enough."""
    return leg.name != "" or how == "timeout" or first_failure(leg, [topic]) is not None


# ---- faults ---------------------------------------------------------------------------------------------------------


def passes_without(leg, path, tree, topic, targets):
    """Whether this topic passes without the fault. If it does not, the fault is applied and built again."""
    if topic not in leg.passes | leg.fails:
        restore(tree)
        build_without(leg, targets)
        (leg.fails if first_failure(leg, [topic]) else leg.passes).add(topic)
        if topic in leg.fails:
            say(f"{topic} fails without any fault, too: left out")
            apply(path)
            build(leg, targets)
    return topic in leg.passes


def judge(leg, path, tree):
    """Applies a fault, and takes it back. Returns (outcome, by what)."""
    if not apply(path, "--check"):
        return "stale", ""
    if leg.clean is None:
        build_without(leg)
        leg.clean = programs(leg)
    try:
        apply(path)
        near, ran = near_of(leg, path), set()
        for of in [near, None] if near else [None]:
            targets = sorted(Path(name).name for name in near) if of else []
            fault = build(leg, targets)
            if fault:
                errors = [line for line in fault.splitlines() if "error" in line.lower()]
                return "does not build", errors[0].strip().replace(f"{COPY}/", "")[:160].replace("|", "/") if errors else ""
            # Some programs that were not built now may still have the fault before.
            changed = {name for name, now in programs(leg).items() if now != leg.clean.get(name)}
            for batch in batches(leg, changed, of, ran):
                ran.update(batch)
                left = [name for name in batch if name not in leg.fails]
                while left:
                    failure = first_failure(leg, left)
                    if not failure:
                        break
                    if repeats(leg, *failure) and passes_without(leg, path, tree, failure[0], targets):
                        return "caught", f"{failure[0]}: {failure[1]}"
                    left = [name for name in left if name not in leg.fails and name != failure[0]]
        return "missed", "" if changed else "no program changed"
    finally:
        restore(tree)


def read_results(tree):
    lines = RESULTS.read_text().splitlines() if RESULTS.is_file() else []
    if lines and lines[0] != f"tree {tree}":
        RESULTS.rename(OUT / "results-before")  # of other sources
        lines = []
    if not lines:
        RESULTS.write_text(f"tree {tree}\n")
    return {line.split("|")[0]: line.split("|") for line in lines[1:] if line.count("|") == 3}


def main():
    patches = {path.stem: path for path in sorted(PATCHES.glob("*.patch"))}
    wanted = sys.argv[1:] or list(patches)
    for name in wanted:
        if name not in patches:
            die(f"there is no fault {name}; tests/house/mutants has {', '.join(patches)}")
    tree = subprocess.run([ROOT / "tests/house/tree.sh"], capture_output=True, text=True, check=True).stdout.strip()
    if not tree:
        die("the sources must be a git repository")
    COPY.mkdir(parents=True, exist_ok=True)
    results = read_results(tree)
    make_copy(tree)
    legs = all_legs()
    texts = {name: patches[name].read_text().partition("diff --git ")[0] for name in wanted}
    leg_of = {name: "".join(re.findall(r"^leg: (\S+)$", text, re.M)) for name, text in texts.items()}
    for name in sorted(wanted, key=leg_of.get):  # faults of the same leg one after the other, those of a usual build first
        if name in results:
            say(f"{name}: {results[name][1]}, as before")
            continue
        if leg_of[name] not in legs:
            die(f"{name}: there is no leg {leg_of[name]}; tests/house/matrix.sh list names them")
        say(f"{name}: {texts[name].splitlines()[0]}")
        begin = time.monotonic()
        outcome, by = judge(legs[leg_of[name]], patches[name], tree)
        results[name] = [name, outcome, by, str(round(time.monotonic() - begin))]
        with RESULTS.open("a") as out:
            out.write("|".join(results[name]) + "\n")
        say(f"{name}: {outcome}, {by or 'by no test'}, {results[name][3]} s")
    rows = [f"{sum(results[name][1] == 'caught' for name in wanted)} of {len(wanted)} faults are caught.", "",
            "| fault | outcome | by | seconds | what is wrong |", "|---|---|---|---|---|",
            *(f"| {' | '.join(results[name])} | {texts[name].splitlines()[0]} |" for name in wanted)]
    (ROOT / "build/mutants.md").write_text("\n".join(rows) + "\n")
    print(*rows, sep="\n")
    return 1 if any(results[name][1] in ("stale", "does not build") for name in wanted) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        die("interrupted; the same command goes on from here")
