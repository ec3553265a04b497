#!/usr/bin/env python3
"""tidy.py BUILD: clang-tidy over each source in BUILD's compile database except the tests (the compiler's warnings are errors there,
too), as many at a time as there are cores.

Each source is compiled by itself, without precompiled headers, so a missing include is an error. The flags are those of all
sources together.

A source whose text, headers, flags and rules have been found clean before is not looked at again, in any clone: palpa-tidy in the
user's cache folder keeps an empty file per clean state, named by its hash. A state that was not met for a month is forgotten.
"""
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def sources_of(entry, build):
    """What a compile command compiles: its file, or the sources that the file is a unit of (cmake/Units.cmake)."""
    file = pathlib.Path(entry["directory"], entry["file"]).resolve()
    if file.parent.name != "units" or not file.is_relative_to(build):
        return [file]
    return [(file.parent / path).resolve() for path in re.findall(r'^#include "(.+)"$', file.read_text(), re.M)]


def flags_of(database):
    """What clang needs of all compile commands together: defines, folders, the language."""
    kept = {}  # in the order of their first use
    for entry in database:
        words = shlex.split(entry["command"])
        for word, after in zip(words, words[1:] + [""]):
            if word == "-isystem":
                kept[word, after] = None
            elif word.startswith(("-D", "-I", "-std=", "-W")) and word not in ("-Winvalid-pch", "-Wshadow=local"):
                kept[word,] = None
    return [word for flag in kept for word in flag]


@functools.cache
def read(path):
    """A file's hash, and the project's headers that it includes: those in these folders, or beside it."""
    data = path.read_bytes()
    named = re.findall(rb'^\s*#\s*include\s*"([^"]+)"', data, re.M)
    places = (folder / os.fsdecode(name) for name in named for folder in (path.parent, ROOT, ROOT / "engine"))
    return hashlib.sha256(data).hexdigest(), [place.resolve() for place in places if place.is_file()]


def state_of(source, common):
    """The hash of all that a source's findings depend on."""
    seen, todo = set(), [source]
    while todo:
        path = todo.pop()
        if path not in seen:
            seen.add(path)
            todo += read(path)[1]
    parts = [common, *(f"{path.relative_to(ROOT)} {read(path)[0]}" for path in sorted(seen))]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    clean = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache", "palpa-tidy")
    clean.mkdir(parents=True, exist_ok=True)
    for stamp in clean.iterdir():
        if time.time() - stamp.stat().st_mtime > 30 * 24 * 3600:
            stamp.unlink(missing_ok=True)

    database = json.loads((build / "compile_commands.json").read_text())
    flags = flags_of(database)
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    common = "\n".join([version, (ROOT / ".clang-tidy").read_text(), *flags]).replace(str(build), "BUILD").replace(str(ROOT), "ROOT")
    sources = sorted({source for entry in database for source in sources_of(entry, build) if source.suffix == ".cpp" and
                      source.is_relative_to(ROOT) and not source.is_relative_to(build) and not source.is_relative_to(ROOT / "tests")})
    stamps = {source: clean / state_of(source, common) for source in sources}
    for stamp in stamps.values():
        if stamp.exists():
            stamp.touch()

    def is_clean(source):
        done = subprocess.run(["clang-tidy", "--quiet", source, "--", *flags], cwd=build, capture_output=True, text=True)
        if done.returncode:
            print(done.stdout + "\n".join(line for line in done.stderr.splitlines() if " generated" not in line), flush=True)
        else:
            stamps[source].touch()
        return done.returncode == 0

    new = [source for source in sources if not stamps[source].exists()]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = list(pool.map(is_clean, new)).count(False)
    print(f"   {len(sources)} sources, {len(sources) - len(new)} known to be clean, {faults} at fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
