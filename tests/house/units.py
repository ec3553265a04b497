#!/usr/bin/env python3
"""units.py: finds sources that can be compiled as one text, a unit, so that common headers are read once.

Sources that define the same local name are kept apart. palpa's own sources (not its tests) are also kept apart if one defines a name
that occurs anywhere in the other, because a local variable of that name would cause a warning (-Wshadow). As a program, it groups
the sources of each target: it reads lines "TARGET|FOLDER|SOURCE|..." with absolute paths from stdin, and prints a line
"TARGET|SOURCE|UNIT" for each source in a unit (cmake/Units.cmake).
"""
import collections
import pathlib
import re
import sys

TESTS = pathlib.Path(__file__).resolve().parents[1]
MOST = 8  # sources per unit; every core needs units to compile, and the longest unit ends last
# Names that a source imports into its namespace, and from where. Two sources may import the same name from the same place. A check
# for unused names keeps such sources apart; otherwise, it would miss a name that only the other source uses.
BROUGHT = re.compile(r"^using ([\w:]+)::(\w+);|^(?:namespace|using) (\w+) = ([^;]+);", re.M)
# The names that a source defines for itself: types, functions, constants. An extra name costs little.
OWN = re.compile(r"^namespace \{\n(.*?)^\}  // namespace|^(int main\()", re.S | re.M)
DEFINED = re.compile(r"^(?:struct|class|enum class|enum|union) (\w+)|^using (\w+) =|^\w[\w:<>,*& ]*?[ *&](\w+)\(|"
                     r"^(?:inline |static |constexpr |const )+[\w:<>,*& ]+?(\w+)(?:\[\w*\])*(?: = |\{|;)", re.M)
STATIC = re.compile(r"^static [^;{}()=]*?(\w+)(?:\[\w*\])*(?:\(| = |\{|;)", re.M)  # outside the unnamed namespace
# The second and later constants of a line that defines several.
FURTHER = re.compile(r"^(?:inline |static |constexpr |const )+[^;(){}]*;", re.M), re.compile(r", (\w+)(?:\[\w*\])* = ")
# Sources that stay alone: their code affects the sources after them, or they are a library's main(), for programs without their own.
ALONE = re.compile(r"^ *# *define |^int main\(", re.M)
# Namespaces that a source opens with all their names. Such a source is joined with others that open the same.
OPENED = re.compile(r"^using namespace (?!std::)([\w:]+);", re.M)
INCLUDED = re.compile(r"^#include (.+)$", re.M)
WORD = re.compile(r"[A-Za-z_]\w*")


def own_names(text, share):
    """Local names of a source -> where it imports the name from, if two sources may share it; otherwise ''."""
    own = "".join(part[0] or part[1] for part in OWN.findall(text))
    names = {name: "" for found in DEFINED.findall(own) for name in found if name}
    names |= {name: "" for line in FURTHER[0].findall(own) for name in FURTHER[1].findall(line)}
    names |= {name: "" for name in STATIC.findall(text)}
    for room, name, alias, meant in BROUGHT.findall(text):
        names[name or alias] = room + meant if share else ""
    return names


def clash(names, others):
    """Whether a name is in both, unless both import it from the same place."""
    return any(name in names and not (room and room == names[name]) for name, room in others.items())


def units_of(sources, headers, most, shadows, share=False):
    """Groups sources (paths) without a common name; prefers groups that include the same headers. headers: source -> its
    includes; shadows: whether a name of one may occur in another's text; share: whether two may import the same name."""
    texts = {source: source.read_text() for source in sources}
    names = {source: own_names(text, share) for source, text in texts.items()}
    words = {source: names[source] if shadows else dict.fromkeys(WORD.findall(text), "") for source, text in texts.items()}
    opened = {source: set(OPENED.findall(text)) for source, text in texts.items()}
    units = []  # (sources, names, words, headers, opened)
    for source in sorted(sources, key=lambda source: (-len(names[source]), source)):
        fitting = [unit for unit in units
                   if len(unit[0]) < most and not clash(unit[1], words[source]) and not clash(unit[2], names[source])
                   and unit[4] == opened[source]]
        if not fitting:
            fitting = [([], {}, {}, set(), opened[source])]
            units += fitting
        unit = min(fitting, key=lambda unit: len(headers[source] - unit[3]))
        unit[0].append(source)
        unit[1].update(names[source])
        unit[2].update(words[source])
        unit[3].update(headers[source])
    return [unit for unit, *_ in units]


def main():
    targets = [line.split("|") for line in sys.stdin.read().splitlines()]
    # A source that several targets of a folder compile stays alone; otherwise, it would be in the unit of one target only.
    times = collections.Counter((folder, path) for _, folder, *paths in targets for path in set(paths))
    for target, folder, *paths in targets:
        texts = {pathlib.Path(path): pathlib.Path(path).read_text() for path in sorted(set(paths)) if times[folder, path] == 1}
        sources = [path for path, text in texts.items() if not ALONE.search(text)]
        headers = {path: set(INCLUDED.findall(texts[path])) for path in sources}
        shadows = all(path.is_relative_to(TESTS) for path in sources)
        for number, unit in enumerate(units_of(sources, headers, MOST, shadows, share=shadows)):
            for source in unit if len(unit) > 1 else []:
                print(f"{target}|{source}|{number}")


if __name__ == "__main__":
    main()
