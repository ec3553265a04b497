#!/usr/bin/env python3
"""tidy.py BUILD [--tests]: clang-tidy over the project's sources in BUILD's compile database, as many at a time as there are
cores. Without --tests only over what ships: the tests would double the time, and the compiler's warnings are errors there too.

A source whose text, headers, flags and rules have been found clean before is not looked at again: BUILD/tidy keeps an empty
file per clean state, named by its hash.

Most of the time goes into the headers, so several sources are looked at as one text, a unit (units.py), with the defines and the
folders of all (the compiler has seen to it that each does with its own). A unit at fault, or one whose sources cannot stand
beside each other, is looked at in halves, down to the single source; only its findings are shown.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

from units import units_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST = 30  # sources of a unit: a check takes disproportionately longer the more text precedes it


def included_files(build):
    """object -> files it was compiled from, as Ninja recorded them"""
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True).stdout
    deps, current = {}, None
    for line in text.splitlines():
        if line and not line.startswith(" "):
            current = deps.setdefault(line.split(":")[0], [])
        elif line.strip():
            current.append(line.strip())
    return deps


class Hashes:
    """Hash of a file's content; a system header's version stands in its package, its size and time are enough."""

    def __init__(self, build):
        self.build, self.known = build, {}

    def of(self, name):
        if name not in self.known:
            path = pathlib.Path(self.build, name)
            if not path.exists():
                self.known[name] = "absent"
            elif path.resolve().is_relative_to(ROOT) or path.resolve().is_relative_to(self.build):
                self.known[name] = hashlib.sha256(path.read_bytes()).hexdigest()
            else:
                status = path.stat()
                self.known[name] = f"{status.st_size} {status.st_mtime_ns}"
        return self.known[name]


def sources_of(entry, build):
    """What a compile command compiles: its file, or the sources that the file is a unit of"""
    file = pathlib.Path(entry["directory"], entry["file"]).resolve()
    if file.parent.name != "Unity" or not file.is_relative_to(build):
        return [file]
    return [pathlib.Path(path) for path in re.findall(r'^#include "(.+)"$', file.read_text(), re.M)]


def flags_of(entries):
    """What clang needs of these compile commands together: defines, folders, the language."""
    kept = {}  # in the order of their first use
    for entry in entries:
        words = shlex.split(entry["command"])
        folders = [("-isystem", words[i + 1]) for i, word in enumerate(words) if word == "-isystem"]
        for flag in [(word,) for word in words if word.startswith(("-D", "-I", "-std=", "-W")) and word != "-Winvalid-pch"] + folders:
            kept[flag] = None
    return [word for flag in kept for word in flag]


class Tidy:
    def __init__(self, build, clean, flags):
        self.build, self.clean, self.flags = build, clean, flags

    def run(self, file, *more):
        return subprocess.run(["clang-tidy", "--quiet", file, "--", *self.flags, *more], cwd=self.build, capture_output=True, text=True)

    def look(self, sources):
        """The sources among these that are at fault; the others' stamps are made. sources: [(path, stamp)]"""
        if len(sources) == 1:
            done = self.run(sources[0][0])
            if done.returncode:
                print(done.stdout + "\n".join(line for line in done.stderr.splitlines() if " generated" not in line), flush=True)
        else:
            unit = self.clean / f"{sources[0][1].name}.cpp"
            unit.write_text("\n".join(path.read_text() for path, _ in sources))
            done = self.run(unit, "-Wno-shadow")  # one source's constants shadowed by another's local names
            unit.unlink()
        if done.returncode == 0:
            for _, stamp in sources:
                stamp.touch()
            return []
        half = len(sources) // 2
        return self.look(sources[:half]) + self.look(sources[half:]) if half else sources


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    database = json.loads((build / "compile_commands.json").read_text())
    rules = (ROOT / ".clang-tidy").read_text() + pathlib.Path(__file__).read_text()
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    deps, hashes = included_files(build), Hashes(build)
    clean = build / "tidy"
    clean.mkdir(exist_ok=True)

    stamps, headers, entries, new = {}, {}, [], []
    for entry in database:
        for source in sources_of(entry, build):
            if not source.is_relative_to(ROOT) or source.is_relative_to(build) or source.suffix != ".cpp":
                continue
            if source.is_relative_to(ROOT / "tests") and "--tests" not in sys.argv:
                continue
            entries.append(entry)
            state = [version, rules, entry["command"], str(source)]
            words = entry["command"].split()
            made = words[words.index("-o") + 1]
            included = deps.get(made, [str(source)])
            headers[source] = set(included)
            state += [f"{name} {hashes.of(name)}" for name in included]
            stamps[source] = clean / hashlib.sha256("\n".join(state).encode()).hexdigest()
            if not stamps[source].exists():
                new.append(source)

    tidy = Tidy(build, clean, flags_of(entries))
    units = [[(source, stamps[source]) for source in unit]
             for unit in units_of(new, headers, min(MOST, -(-len(new) // os.cpu_count())), shadows=True)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = sum(pool.map(tidy.look, sorted(units, key=lambda unit: -len(unit))), [])
    for stale in set(clean.iterdir()) - set(stamps.values()):
        stale.unlink()
    print(f"   {len(stamps)} sources, {len(stamps) - len(new)} known to be clean, {len(faults)} at fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
