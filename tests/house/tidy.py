#!/usr/bin/env python3
"""tidy.py BUILD [--tests]: clang-tidy over the project's sources in BUILD's compile database, as many at a time as there are
cores. Without --tests only over what ships: the tests would double the time, and the compiler's warnings are errors there too.

A source whose text, headers, flags and rules have been found clean before is not looked at again: BUILD/tidy keeps an empty
file per clean state, named by its hash.

Most of the time goes into the headers, so several sources of the same flags are looked at as one text, a unit; those that define
the same name for themselves are kept apart. A unit at fault, or one whose sources cannot stand beside each other, is looked at in
halves, down to the single source; only its findings are shown.
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

ROOT = pathlib.Path(__file__).resolve().parents[2]
UNIT = 8  # sources
# What a later source of a unit could use, so that nobody noticed when its own does not: such a source is the last of its unit.
LAST = re.compile(r"^(using [\w:]+::\w+;|namespace \w+ =)", re.M)
# What a source has for itself, and the names there: types, functions, constants. One name too many costs little.
OWN = re.compile(r"^namespace \{\n(.*?)^\}  // namespace|^(int main\()", re.S | re.M)
DEFINED = re.compile(r"^(?:struct|class|enum class|enum|union|using) (\w+)|^[\w:<>,*& ]+?[ *&](\w+)\(|"
                     r"^(?:inline |static |constexpr |const )+[\w:<>,*& ]+?(\w+)(?:\[\w*\])*(?: = |\{|;)", re.M)


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


def flags_of(entry):
    """What clang needs of a compile command: defines, folders, the language."""
    words = shlex.split(entry["command"])
    kept = [word for word in words if word.startswith(("-D", "-I", "-std=", "-W", "-f")) and word != "-Winvalid-pch"]
    systems = [words[i + 1] for i, word in enumerate(words) if word == "-isystem"]
    return kept + [word for folder in systems for word in ("-isystem", folder)]


def own_names(path):
    """The names a source defines for itself; "using" where it must be the last."""
    text = path.read_text()
    own = "".join(part[0] or part[1] for part in OWN.findall(text))
    return {name for found in DEFINED.findall(own) for name in found if name} | ({"using"} if LAST.search(text) else set())


def units_of(sources):
    """Lists of about the same size of the (path, stamp), none with a name twice."""
    most = -(-len(sources) // -(-len(sources) // UNIT))
    units = []  # (sources, names)
    for source in sorted(sources, key=lambda source: (-len(own_names(source[0])), source[0])):
        names = own_names(source[0])
        unit = next((unit for unit in units if len(unit[0]) < most and not unit[1] & names), None)
        if not unit:
            unit = ([], set())
            units.append(unit)
        unit[0].append(source)
        unit[1].update(names)
    return [sorted(unit, key=lambda source: bool(LAST.search(source[0].read_text()))) for unit, _ in units]


class Tidy:
    def __init__(self, build, clean):
        self.build, self.clean = build, clean

    def run(self, file, flags):
        return subprocess.run(["clang-tidy", "--quiet", file, "--", *flags], cwd=self.build, capture_output=True, text=True)

    def look(self, sources, flags):
        """The sources among these that are at fault; the others' stamps are made. sources: [(path, stamp)]"""
        if len(sources) == 1:
            done = self.run(sources[0][0], flags)
            if done.returncode:
                print(done.stdout + "\n".join(line for line in done.stderr.splitlines() if " generated" not in line), flush=True)
        else:
            unit = self.clean / f"{sources[0][1].name}.cpp"
            unit.write_text("\n".join(path.read_text() for path, _ in sources))
            done = self.run(unit, flags)
            unit.unlink()
        if done.returncode == 0:
            for _, stamp in sources:
                stamp.touch()
            return []
        half = len(sources) // 2
        return self.look(sources[:half], flags) + self.look(sources[half:], flags) if half else sources


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    database = json.loads((build / "compile_commands.json").read_text())
    rules = (ROOT / ".clang-tidy").read_text() + pathlib.Path(__file__).read_text()
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    deps, hashes = included_files(build), Hashes(build)
    clean = build / "tidy"
    clean.mkdir(exist_ok=True)

    stamps, groups = {}, {}
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
        stamps[source] = clean / hashlib.sha256("\n".join(state).encode()).hexdigest()
        if not stamps[source].exists():
            groups.setdefault(tuple(flags_of(entry)), []).append((source, stamps[source]))

    units = [(unit, flags) for flags, sources in groups.items() for unit in units_of(sources)]
    units.sort(key=lambda unit: -len(unit[0]))
    tidy, looked = Tidy(build, clean), sum(len(sources) for sources, _ in units)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = sum(pool.map(tidy.look, *zip(*units)), []) if units else []
    for stale in set(clean.iterdir()) - set(stamps.values()):
        stale.unlink()
    print(f"   {len(stamps)} sources, {len(stamps) - looked} known to be clean, {len(faults)} at fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
