#!/usr/bin/env python3
"""units.py: which sources can be one text, a unit, so that the headers of all are read once.

Those that define the same name for themselves are kept apart; palpa's own are, too, where one defines what stands anywhere in the
other, since a local name above it would be a warning (-Wshadow). As a program it groups the sources of each target: a line
"TARGET|SOURCE|..." of absolute paths on stdin; a line "TARGET|SOURCE|UNIT" on stdout for each that is in a unit (cmake/Units.cmake).
"""
import collections
import pathlib
import re
import sys

TESTS = pathlib.Path(__file__).resolve().parents[1]
MOST = 8  # sources of a target; each core needs units, and the longest ends last
# Names that a source brings into its namespace: an unused one in another source of the unit would not be noticed.
BROUGHT = re.compile(r"^using [\w:]+::(\w+);|^namespace (\w+) =", re.M)
# The names that a source defines for itself: types, functions, constants. An extra name costs little.
OWN = re.compile(r"^namespace \{\n(.*?)^\}  // namespace|^(int main\()", re.S | re.M)
DEFINED = re.compile(r"^(?:struct|class|enum class|enum|union|using) (\w+)|^\w[\w:<>,*& ]*?[ *&](\w+)\(|"
                     r"^(?:inline |static |constexpr |const )+[\w:<>,*& ]+?(\w+)(?:\[\w*\])*(?: = |\{|;)", re.M)
# Code that affects the sources after it; or a source of a library that a program uses only if it has none of its own.
ALONE = re.compile(r"^ *# *define |^using namespace (?!std::)|^int main\(", re.M)
INCLUDED = re.compile(r"^#include (.+)$", re.M)
WORD = re.compile(r"[A-Za-z_]\w*")


def own_names(text):
    """The names that a source defines or brings for itself."""
    own = "".join(part[0] or part[1] for part in OWN.findall(text))
    return {name for found in DEFINED.findall(own) + BROUGHT.findall(text) for name in found if name}


def units_of(sources, headers, most, shadows):
    """Lists of the sources, paths, none with a name twice, those that include the same together. headers: source -> what it
    includes; shadows: whether one's name may stand in another's text"""
    texts = {source: source.read_text() for source in sources}
    names = {source: own_names(text) for source, text in texts.items()}
    words = {source: names[source] if shadows else set(WORD.findall(text)) for source, text in texts.items()}
    units = []  # (sources, names, words, headers)
    for source in sorted(sources, key=lambda source: (-len(names[source]), source)):
        fitting = [unit for unit in units
                   if len(unit[0]) < most and not unit[1] & words[source] and not unit[2] & names[source]]
        if not fitting:
            fitting = [([], set(), set(), set())]
            units += fitting
        unit = min(fitting, key=lambda unit: len(headers[source] - unit[3]))
        unit[0].append(source)
        unit[1].update(names[source])
        unit[2].update(words[source])
        unit[3].update(headers[source])
    return [unit for unit, *_ in units]


def main():
    targets = [line.split("|") for line in sys.stdin.read().splitlines()]
    times = collections.Counter(path for _, *paths in targets for path in paths)
    for target, *paths in targets:
        texts = {pathlib.Path(path): pathlib.Path(path).read_text() for path in paths if times[path] == 1}
        sources = [path for path, text in texts.items() if not ALONE.search(text)]
        headers = {path: set(INCLUDED.findall(texts[path])) for path in sources}
        shadows = all(path.is_relative_to(TESTS) for path in sources)
        for number, unit in enumerate(units_of(sources, headers, MOST, shadows)):
            for source in unit if len(unit) > 1 else []:
                print(f"{target}|{source}|{number}")


if __name__ == "__main__":
    main()
