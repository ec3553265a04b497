#!/usr/bin/env python3
"""tidy.py BUILD [--tests]: clang-tidy over the project's sources in BUILD's compile database, as many at a time as there are
cores. Without --tests only over what ships: the tests would double the time, and the compiler's warnings are errors there too.

A source whose text, headers, flags and rules have been found clean before is not looked at again, in any clone: palpa-tidy in the
user's cache folder keeps an empty file per clean state, named by its hash. A state that was not met for a month is forgotten.

Most of the time goes into the headers, so several sources are looked at as one text, a unit (units.py), with the defines and the
folders of all (the compiler has seen to it that each does with its own). A unit at fault, or one whose sources cannot stand
beside each other, is looked at in halves, down to the single source; only its findings are shown.

If clang's headers are installed, a plugin (own_code.cpp) keeps clang-tidy out of the system's headers, which makes it about three
times as fast. The findings are the same.
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
import tempfile
import time

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


def cache_folder():
    folder = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache", "palpa-tidy")
    folder.mkdir(parents=True, exist_ok=True)
    for stamp in folder.iterdir():
        if time.time() - stamp.stat().st_mtime > 30 * 24 * 3600:
            stamp.unlink(missing_ok=True)
    return folder


def in_any_clone(text, build):
    return text.replace(str(build), "BUILD").replace(str(ROOT), "ROOT")


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
    if file.parent.name != "units" or not file.is_relative_to(build):
        return [file]
    return [(file.parent / path).resolve() for path in re.findall(r'^#include "(.+)"$', file.read_text(), re.M)]


def flags_of(entries):
    """What clang needs of these compile commands together: defines, folders, the language."""
    kept = {}  # in the order of their first use
    for entry in entries:
        words = shlex.split(entry["command"])
        folders = [("-isystem", words[i + 1]) for i, word in enumerate(words) if word == "-isystem"]
        for flag in [(word,) for word in words if word.startswith(("-D", "-I", "-std=", "-W")) and word not in ("-Winvalid-pch", "-Wshadow=local")] + folders:
            kept[flag] = None
    return [word for flag in kept for word in flag]


def plugin_options(build, version):
    """The options that load the plugin own_code.cpp; none if it cannot be compiled here or does not find a fault that is there."""
    folder = pathlib.Path("/usr/lib/llvm-" + re.search(r"version (\d+)", version)[1], "include")
    made, sample = build / "own_code.so", build / "own_code_sample.cpp"
    compiled = (folder / "clang-tidy").is_dir() and subprocess.run(
        ["g++", "-std=c++17", "-O1", "-fPIC", "-fno-rtti", "-shared", "-isystem", folder, ROOT / "tests/house/own_code.cpp", "-o", made],
        capture_output=True).returncode == 0
    options = [f"--load={made}", "--checks=palpa-own-code"]  # beside the checks of .clang-tidy
    if compiled:
        sample.write_text("#include <vector>\nnamespace { int* fault() { return 0; } }\nint main() { return fault() != nullptr; }\n")
        found = subprocess.run(["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}", *options, sample, "--", "-std=c++20"],
                               capture_output=True, text=True)
        if "modernize-use-nullptr" in found.stdout:
            return options
    print("   without clang's headers (Debian: libclang-dev and llvm-dev), this takes three times as long")
    return []


class Tidy:
    def __init__(self, build, folder, flags, options):
        self.build, self.folder, self.flags, self.options = build, folder, flags, options

    def run(self, file, *more):
        return subprocess.run(["clang-tidy", "--quiet", *self.options, file, "--", *self.flags, *more],
                              cwd=self.build, capture_output=True, text=True)

    def look(self, sources):
        """The sources among these that are at fault; the others' stamps are made. sources: [(path, stamp)]"""
        if len(sources) == 1:
            done = self.run(sources[0][0])
            if done.returncode:
                print(done.stdout + "\n".join(line for line in done.stderr.splitlines() if " generated" not in line), flush=True)
        else:
            unit = pathlib.Path(self.folder, f"{sources[0][1].name}.cpp")
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
    clean = cache_folder()

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
            stamps[source] = clean / hashlib.sha256(in_any_clone("\n".join(state), build).encode()).hexdigest()
            if stamps[source].exists():
                stamps[source].touch()
            elif source not in new:  # two targets may compile it
                new.append(source)

    units = [[(source, stamps[source]) for source in unit]
             for unit in units_of(new, headers, min(MOST, -(-len(new) // os.cpu_count())), shadows=True)]
    # Below the build folder, clang-tidy finds the rules of .clang-tidy.
    with tempfile.TemporaryDirectory(dir=build) as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        tidy = Tidy(build, folder, flags_of(entries), plugin_options(build, version) if new else [])
        faults = sum(pool.map(tidy.look, sorted(units, key=lambda unit: -len(unit))), [])
    print(f"   {len(stamps)} sources, {len(stamps) - len(new)} known to be clean, {len(faults)} at fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
