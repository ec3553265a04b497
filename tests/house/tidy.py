#!/usr/bin/env python3
"""tidy.py BUILD: clang-tidy over the sources in BUILD's compile database except the tests (the compiler's warnings are errors there,
too), as many at a time as there are cores.

Most of the time goes into the headers, so several sources are looked at as one text, a unit (units.py), with the defines and the
folders of all. A unit at fault is looked at in halves, down to the single source; only the findings of these are shown. If
clang's headers are installed, a plugin (own_code.cpp) keeps clang-tidy out of the system's headers, which makes it about three
times as fast. The findings are the same.

A source whose text, headers, flags and rules have been found clean before is not looked at again, in any clone: palpa-tidy in the
user's cache folder keeps an empty file per clean state, named by its hash. A state that was not met for a month is forgotten.
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

from includes import reached, read
from units import units_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST = 30  # sources of a unit: a check takes disproportionately longer the more text precedes it


def sources_of(entry, build):
    """What a compile command compiles: its file, or the sources that the file is a unit of (cmake/Units.cmake)."""
    file = pathlib.Path(entry["directory"], entry["file"]).resolve()
    if file.parent.name != "units" or not file.is_relative_to(build):
        return [file]
    return [(file.parent / path).resolve() for path in re.findall(r'^#include "(.+)"$', file.read_text(), re.M)]


def flags_of(entries):
    """What clang needs of these compile commands together: defines, folders, the language."""
    kept = {}  # in the order of their first use
    for entry in entries:
        words = shlex.split(entry["command"])
        for word, after in zip(words, words[1:] + [""]):
            if word == "-isystem":
                kept[word, after] = None
            elif word.startswith(("-D", "-I", "-std=", "-W")) and word not in ("-Winvalid-pch", "-Wshadow=local"):
                kept[word,] = None
    return [word for flag in kept for word in flag]


def plugin_options(build, version):
    """The options that load the plugin own_code.cpp; none if it cannot be compiled here or does not find a fault that is there."""
    folder = pathlib.Path("/usr/lib/llvm-" + re.search(r"version (\d+)", version)[1], "include")
    made, sample = build / "own_code.so", build / "own_code_sample.cpp"
    options = [f"--load={made}", "--checks=palpa-own-code"]  # beside the checks of .clang-tidy
    compiled = (folder / "clang-tidy").is_dir() and subprocess.run(
        ["g++", "-std=c++17", "-O1", "-fPIC", "-fno-rtti", "-shared", "-isystem", folder, ROOT / "tests/house/own_code.cpp", "-o", made],
        capture_output=True).returncode == 0
    if compiled:
        sample.write_text("#include <vector>\nnamespace { int* fault() { return 0; } }\nint main() { return fault() != nullptr; }\n")
        if "modernize-use-nullptr" in tidied(build, sample, [f"--config-file={ROOT / '.clang-tidy'}", *options], ["-std=c++20"]).stdout:
            return options
    print("   without clang's headers (Debian: libclang-dev and llvm-dev), this takes three times as long")
    return []


def tidied(build, file, options, flags):
    return subprocess.run(["clang-tidy", "--quiet", *options, file, "--", *flags], cwd=build, capture_output=True, text=True)


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    clean = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache", "palpa-tidy")
    clean.mkdir(parents=True, exist_ok=True)
    for stamp in clean.iterdir():
        if time.time() - stamp.stat().st_mtime > 30 * 24 * 3600:
            stamp.unlink(missing_ok=True)

    sources, entries = set(), []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        own = {source for source in sources_of(entry, build) if source.suffix == ".cpp" and source.is_relative_to(ROOT) and
               not any(map(source.is_relative_to, (build, ROOT / "tests")))}
        sources |= own
        entries += [entry] if own else []
    flags = flags_of(entries)
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    common = "\n".join([version, (ROOT / ".clang-tidy").read_text(), *flags]).replace(str(build), "BUILD").replace(str(ROOT), "ROOT")
    headers = {source: reached(source)[1] for source in sorted(sources)}
    stamps = {}
    for source, own in headers.items():
        state = [common, *(f"{path.relative_to(ROOT)} {read(path)}" for path in [source, *sorted(own)])]
        stamps[source] = clean / hashlib.sha256("\n".join(state).encode()).hexdigest()
        if stamps[source].exists():
            stamps[source].touch()
    new = [source for source in stamps if not stamps[source].exists()]
    options = plugin_options(build, version) if new else []

    def faulty(unit):
        """The sources among these that are at fault; the others' stamps are made."""
        if len(unit) == 1:
            done = tidied(build, unit[0], options, flags)
            if done.returncode:
                print(done.stdout + "\n".join(line for line in done.stderr.splitlines() if " generated" not in line), flush=True)
        else:  # below the build folder, clang-tidy finds the rules of .clang-tidy
            with tempfile.NamedTemporaryFile("w", dir=build, suffix=".cpp") as text:
                text.write("\n".join(source.read_text() for source in unit))
                text.flush()
                done = tidied(build, text.name, options, [*flags, "-Wno-shadow"])  # one's constants, another's local names
        if done.returncode == 0:
            for source in unit:
                stamps[source].touch()
            return []
        half = len(unit) // 2
        return faulty(unit[:half]) + faulty(unit[half:]) if half else unit

    units = units_of(new, headers, min(MOST, -(-len(new) // os.cpu_count())), shadows=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = sum(pool.map(faulty, sorted(units, key=len, reverse=True)), [])
    print(f"   {len(stamps)} sources, {len(stamps) - len(new)} known to be clean, {len(faults)} at fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
