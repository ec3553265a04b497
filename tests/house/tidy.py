#!/usr/bin/env python3
"""tidy.py BUILD [--tests]: clang-tidy over the project's sources in BUILD's compile database, as many at a time as there are
cores. Without --tests only over what ships: the tests would double the time, and the compiler's warnings are errors there too.

A source whose text, headers, flags and rules have been found clean before is not looked at again: BUILD/tidy keeps an empty
file per clean state, named by its hash.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


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


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    database = json.loads((build / "compile_commands.json").read_text())
    rules = (ROOT / ".clang-tidy").read_text()
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    deps, hashes = included_files(build), Hashes(build)
    clean = build / "tidy"
    clean.mkdir(exist_ok=True)

    jobs = {}
    for entry in database:
        source = pathlib.Path(entry["directory"], entry["file"]).resolve()
        if not source.is_relative_to(ROOT) or source.is_relative_to(build) or source.suffix != ".cpp":
            continue
        if source.is_relative_to(ROOT / "tests") and "--tests" not in sys.argv:
            continue
        state = [version, rules, entry["command"]]
        words = entry["command"].split()
        made = words[words.index("-o") + 1]
        state += [f"{name} {hashes.of(name)}" for name in deps.get(made, [str(source)])]
        key = hashlib.sha256("\n".join(state).encode()).hexdigest()
        jobs[source] = clean / key

    def check(source, stamp):
        if stamp.exists():
            return None
        run = subprocess.run(["clang-tidy", "-p", build, "--quiet", source], capture_output=True, text=True)
        if run.returncode == 0:
            stamp.touch()
            return True
        print(run.stdout + "\n".join(line for line in run.stderr.splitlines() if " generated" not in line), flush=True)
        return False

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(check, jobs.keys(), jobs.values()))
    for stale in set(clean.iterdir()) - set(jobs.values()):
        stale.unlink()
    print(f"   {len(jobs)} sources, {results.count(None)} known to be clean, {results.count(False)} at fault")
    return 1 if False in results else 0


if __name__ == "__main__":
    sys.exit(main())
