#!/usr/bin/env python3
"""mutants.py [NAME..]: do the tests catch small faults? tests/house/mutants/NAME.patch has one fault each.

Each patch is applied to a copy of the project's files (build/mutants/palpa, which is kept), built, and taken back. The topics
whose programs have changed run, quick ones first, until one fails twice. If that topic fails without the fault, too, it
proves nothing, and the others go on. A patch with a line "leg: NAME" is built and run as that leg of tests/house/matrix.sh.

build/mutants/results has a line for each fault: NAME|caught|TOPIC: TEST|SECONDS, or "missed", "stale" (it does not apply any
more) or "does not build". What is there for the same sources is not run again, so an interrupted run goes on where it was.
To run a fault again, remove its line. build/mutants.md has the table.
"""
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATCHES = ROOT / "tests/house/mutants"
OUT = ROOT / "build/mutants"
COPY = OUT / "palpa"
RESULTS = OUT / "results"
COSTS = "Testing/Temporary/CTestCostData.txt"
# Topics of about the same cost run side by side: those up to each of these seconds, then the rest.
BATCHES = [0.5, 3, 15, float("inf")]
# git must not take the copy for a part of the repository around it. ccache finds what another clone has compiled.
ENVIRONMENT = {**os.environ, "GIT_CEILING_DIRECTORIES": str(OUT), "CCACHE_BASEDIR": str(COPY)}


class Leg:
    """How faults are built and run: a preset, the tests of a label (None: all), and their environment."""

    def __init__(self, name, preset="release", label=None, environment=None):
        self.name, self.preset, self.label = name, preset, label
        self.environment = {**ENVIRONMENT, **(environment or {})}
        if label == "gpu":  # as in matrix.sh: the cases of a pass's twin run elsewhere
            self.environment["GTEST_FILTER"] = "-*/cpu"
        self.build = COPY / "build" / preset
        self.clean = None  # the programs without a fault, by their hashes
        self.passes = set()  # topics that pass without a fault
        self.fails = set()


def say(line):
    print(f"mutants: {line}", flush=True)


def die(line):
    sys.exit(f"mutants: {line}")


def run(command, leg=None, cwd=COPY):
    return subprocess.run(command, cwd=cwd, env=leg.environment if leg else ENVIRONMENT, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", check=False)


# ---- the copy -------------------------------------------------------------------------------------------------------


def project_files():
    """The project's own files, committed or not; in an unpacked archive, everything except what was built."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--deduplicate"], cwd=ROOT,
                            capture_output=True, check=False)
    if listed.returncode == 0:
        names = [os.fsdecode(name) for name in listed.stdout.split(b"\0") if name]
    else:
        names = [str(path.relative_to(ROOT)) for path in ROOT.rglob("*")
                 if path.relative_to(ROOT).parts[0] not in ("build", "out", ".git")]
    return {name for name in names if (ROOT / name).is_file() or (ROOT / name).is_symlink()}


def is_same(a, b):
    if a.is_symlink() or b.is_symlink():
        return a.is_symlink() and b.is_symlink() and os.readlink(a) == os.readlink(b)
    return b.is_file() and a.stat().st_size == b.stat().st_size and a.stat().st_mode == b.stat().st_mode and a.read_bytes() == b.read_bytes()


def put(name):
    """Makes a file of the copy that of the project. A file that is the same keeps its time, so that nothing is built again."""
    source, target = ROOT / name, COPY / name
    if is_same(source, target):
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    target.unlink(missing_ok=True)
    shutil.copy(source, target, follow_symlinks=False)


def sync():
    """Also takes back the patch of an interrupted run."""
    names = project_files()
    for name in sorted(names):
        put(name)
    for folder, folders, files in os.walk(COPY):
        if folder == str(COPY):
            folders[:] = [name for name in folders if name not in ("build", "out")]
        for name in files:
            if os.path.relpath(os.path.join(folder, name), COPY) not in names:
                os.unlink(os.path.join(folder, name))
    # Tests find large files beside the clone.
    shared = OUT / "shared"
    if (ROOT.parent / "shared").is_dir() and not shared.exists():
        shared.symlink_to(ROOT.parent / "shared")


def tree_hash():
    found = subprocess.run([str(ROOT / "tests/house/tree.sh")], capture_output=True, text=True, check=False).stdout.strip()
    if found:
        return found
    digest = hashlib.sha256()
    for name in sorted(project_files()):
        digest.update(name.encode() + b"\0" + (ROOT / name).read_bytes())
    return digest.hexdigest()


# ---- building -------------------------------------------------------------------------------------------------------


def all_legs():
    legs = {"": Leg("")}
    for line in run([str(COPY / "tests/house/matrix.sh"), "list"]).stdout.splitlines():
        name, preset, label, *variables = line.split()
        if label != "program":
            legs[name] = Leg(name, preset, None if label == "-" else label, dict(one.split("=", 1) for one in variables))
    return legs


def build(leg):
    """Returns what the build said, or None if it succeeded."""
    made = run(["cmake", "--preset", leg.preset, "--log-level=WARNING"], leg)
    if made.returncode != 0:
        return made.stdout
    targets = []
    if leg.label:
        targets = ["--target", *sorted(topics_of(leg))]
    jobs = subprocess.run([str(ROOT / "tests/house/jobs.sh"), "compilers", "1200", str((os.cpu_count() or 1) + 1)], stdout=subprocess.PIPE,
                          text=True, check=True).stdout.strip()
    made = run(["cmake", "--build", "--preset", leg.preset, "--parallel", jobs, *targets], leg)
    return None if made.returncode == 0 else made.stdout


def programs(leg):
    """The hashes of all programs and of the Python module, by their paths in the build folder."""
    files = [*leg.build.glob("bin/*"), *leg.build.glob("python/palpa/*.so")]
    return {str(path.relative_to(leg.build)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files if path.is_file()}


def build_clean(leg):
    fault = build(leg)
    if fault:
        die(f"without any fault, the preset {leg.preset} does not build:\n{fault[-3000:]}")
    leg.clean = programs(leg)
    costs = ROOT / "build/release" / COSTS
    if costs.is_file() and not (leg.build / COSTS).is_file():
        (leg.build / COSTS).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(costs, leg.build / COSTS)


# ---- topics ---------------------------------------------------------------------------------------------------------


def topics_of(leg):
    """ctest's entries: name: (command, labels)."""
    listed = run(["ctest", "--test-dir", str(leg.build), "--show-only=json-v1", *(["-L", f"^{leg.label}$"] if leg.label else [])], leg)
    begin = listed.stdout.find("{")
    if listed.returncode != 0 or begin < 0:
        die(f"ctest lists no tests of the preset {leg.preset}:\n{listed.stdout[-2000:]}")
    topics = {}
    for test in json.loads(listed.stdout[begin:])["tests"]:
        labels = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
        topics[test["name"]] = (test.get("command", []), labels[0] if labels else [])
    return topics


def edges(leg):
    """build.ninja: what must be there before each file, as (is a phony name, inputs, order-only inputs)."""
    text = (leg.build / "build.ninja").read_text(errors="replace").replace("$\n", "")
    made = {}
    for outputs, rule, inputs in re.findall(r"^build ([^\n]*?): (\S+)([^\n]*)$", text, re.M):
        inputs, _, order = inputs.partition("||")
        for output in outputs.replace("|", " ").split():
            made[output] = (rule == "phony", inputs.replace("|", " ").split(), order.split())
    return made


def starts(program, made, watched):
    """The watched programs that are built before this one only so that it can start them."""
    found, seen, waiting = set(), {program}, [program]
    while waiting:
        phony, inputs, order = made.get(waiting.pop(), (False, [], []))
        for name in order + (inputs if phony else []):
            if name in watched:
                found.add(name)
            elif name not in seen:
                seen.add(name)
                waiting.append(name)
    return found


def concerned(leg, topics, changed):
    """The topics whose program, or a program that it starts, has changed."""
    watched = {name for name in leg.clean if not Path(name).name.startswith("tests_")}
    made, names = edges(leg), []
    for name, (command, _) in topics.items():
        own = os.path.relpath(command[0], leg.build) if command else ""
        if own in leg.clean:
            uses = {own} | starts(own, made, watched)
        else:  # a script: it may start any program
            uses = watched
        if uses & changed:
            names.append(name)
    return names


def costs(leg):
    known = {}
    for path in (leg.build / COSTS, ROOT / "build/release" / COSTS):
        lines = path.read_text().splitlines() if path.is_file() else []
        for line in lines:
            parts = line.split()
            if len(parts) == 3 and float(parts[2]) > 0:
                known[parts[0]] = float(parts[2])  # those of the real build are not those of a fault
    return known


def batches(leg, topics, names):
    """Lists of topics that run side by side: quick ones first, live ones last, each of these alone."""
    known = costs(leg)
    order = sorted(names, key=lambda name: (known.get(name, 60), name))
    live = [name for name in order if "live" in topics[name][1]]
    rest = [name for name in order if name not in live]
    least = 0
    for most in BATCHES:
        batch = [name for name in rest if least <= known.get(name, 60) < most]
        least = most
        if batch:
            yield batch
    for name in live:
        yield [name]


def first_failure(leg, batch):
    """Runs topics until one fails. Returns (topic, test), or None."""
    said = run([str(COPY / "tests/house/suite.sh"), leg.preset, "--stop-on-failure", "-R", f"^({'|'.join(map(re.escape, batch))})$"], leg)
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


def read_patch(path):
    """Its sentence, its leg and the files that it changes."""
    text = path.read_text()
    head, _, diff = text.partition("diff --git ")
    leg = re.search(r"^leg: (\S+)$", head, re.M)
    return head.splitlines()[0], leg.group(1) if leg else "", re.findall(r"^--- a/(\S+)$", diff, re.M)


def passes_without(leg, path, files, topic):
    """Whether this topic passes without the fault. Leaves the fault applied."""
    if topic not in leg.passes | leg.fails:
        for name in files:
            put(name)
        build_clean(leg)
        (leg.fails if first_failure(leg, [topic]) else leg.passes).add(topic)
        if topic in leg.fails:
            say(f"{topic} fails without any fault, too: left out")
            apply(path)
            build(leg)
    return topic in leg.passes


def apply(path, *options):
    return run(["git", "apply", *options, str(path)]).returncode == 0


def judge(leg, path, files):
    """Applies a fault, and takes it back. Returns (outcome, by what)."""
    if not apply(path, "--check"):
        return "stale", ""
    if leg.clean is None:
        build_clean(leg)
    try:
        apply(path)
        fault = build(leg)
        if fault:
            errors = [line for line in fault.splitlines() if "error" in line.lower()]
            return "does not build", errors[0].strip().replace(f"{COPY}/", "")[:160].replace("|", "/") if errors else ""
        now = programs(leg)
        changed = {name for name in now if now[name] != leg.clean.get(name)}
        if not changed:
            return "missed", "no program changed"
        topics = topics_of(leg)
        for batch in batches(leg, topics, concerned(leg, topics, changed)):
            left = [name for name in batch if name not in leg.fails]
            while left:
                failure = first_failure(leg, left)
                if not failure:
                    break
                if repeats(leg, *failure) and passes_without(leg, path, files, failure[0]):
                    return "caught", f"{failure[0]}: {failure[1]}"
                left = [name for name in left if name not in leg.fails and name != failure[0]]
        return "missed", ""
    finally:
        for name in files:
            put(name)


def read_results(tree):
    lines = RESULTS.read_text().splitlines() if RESULTS.is_file() else []
    if lines and lines[0] != f"tree {tree}":
        RESULTS.rename(OUT / "results-before")  # of other sources
        lines = []
    if not lines:
        RESULTS.write_text(f"tree {tree}\n")
    return {line.split("|")[0]: line.split("|") for line in lines[1:] if line.count("|") == 3}


def table(results, sentences):
    rows = [f"{sum(one[1] == 'caught' for one in results)} of {len(results)} faults are caught.", "",
            "| fault | outcome | by | seconds | what is wrong |", "|---|---|---|---|---|"]
    rows += [f"| {name} | {outcome} | {by} | {seconds} | {sentences[name]} |" for name, outcome, by, seconds in results]
    return "\n".join(rows) + "\n"


def main():
    patches = {path.stem: path for path in sorted(PATCHES.glob("*.patch"))}
    unknown = [name for name in sys.argv[1:] if name not in patches]
    if unknown:
        die(f"there is no fault {unknown[0]}; tests/house/mutants has {', '.join(patches)}")
    wanted = sys.argv[1:] or list(patches)
    COPY.mkdir(parents=True, exist_ok=True)
    tree = tree_hash()
    results = read_results(tree)
    sync()
    legs = all_legs()
    described = {name: read_patch(patches[name]) for name in wanted}
    # Faults of the same leg one after the other, those of a usual build first.
    for name in sorted(wanted, key=lambda one: (described[one][1] != "", described[one][1])):
        sentence, leg, files = described[name]
        if name in results:
            say(f"{name}: {results[name][1]}, as before")
            continue
        if leg not in legs:
            die(f"{name}: there is no leg {leg}; tests/house/matrix.sh list names them")
        say(f"{name}: {sentence}")
        begin = time.monotonic()
        outcome, by = judge(legs[leg], patches[name], files)
        results[name] = [name, outcome, by, str(round(time.monotonic() - begin))]
        with RESULTS.open("a") as out:
            out.write("|".join(results[name]) + "\n")
        say(f"{name}: {outcome}{' by ' + by if outcome == 'caught' else ' (' + by + ')' if by else ''}, {results[name][3]} s")
    made = table([results[name] for name in wanted], {name: described[name][0] for name in wanted})
    (ROOT / "build/mutants.md").write_text(made)
    print(made, end="")
    return 1 if any(results[name][1] in ("stale", "does not build") for name in wanted) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        die("interrupted; the same command goes on from here")
