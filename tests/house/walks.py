#!/usr/bin/env python3
"""walks.py: follows the chains of calls in docs/notes/walks.md through the sources.

A walk is a heading `### TITLE: N files` and the indented lines below it. Each line names a function, the source that defines it,
and, after two spaces, what it does; a line without a source has the source of the line above. A function stands deeper than its
caller; a line that begins with a tilde has none, since another thread or process goes on there, or the function was passed as a value. The check fails where a source does not define its function, where the caller's source does not name it, or where the
walk's sources are more or fewer than N."""

import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGE = "docs/notes/walks.md"
ROOTS = ["", "engine", "driver"]


def source_of(name):
    found = [path for path in (os.path.join(root, name) for root in ROOTS) if os.path.isfile(os.path.join(ROOT, path))]
    return found[0] if len(found) == 1 else None


def text_of(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def code_of(path):
    """A source without its comments: a function that only a comment names is not called."""
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text_of(path), flags=re.DOTALL)


def defines(text, function):
    """Whether a body or an initialiser list follows the function's parameters somewhere; C++ calls end in a semicolon."""
    for match in re.finditer(rf"\b{re.escape(function)}\s*\(", text):
        depth, at = 1, match.end()
        while at < len(text) and depth:
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        if re.match(r"[\sA-Za-z_:<>&*,-]*\{", text[at:at + 200]) or re.match(r"\s*(const|noexcept|override|\s)*:[^:]", text[at:at + 200]):
            return True
    return False


def walks(lines):
    title, rows = None, []
    for number, line in enumerate(lines, 1):
        heading = re.match(r"### (.+): (\d+) files$", line)
        if heading or line.startswith("#"):
            if title:
                yield title, rows
            title, rows = (heading[1], int(heading[2])) if heading else None, []
        elif title and line.startswith("    ") and line.strip():
            rows.append((number, line[4:]))
    if title:
        yield title, rows


def main():
    faults, count = [], 0
    for (title, promised), rows in walks(text_of(PAGE).splitlines()):
        count += 1
        callers, source, sources = [], None, set()  # callers: (indentation, source)
        for number, row in rows:
            place = f"{PAGE}:{number}: {title}"
            indentation = len(row) - len(row.lstrip())
            called = not row.strip().startswith("~ ")
            columns = re.split(r"\s{2,}", row.strip().removeprefix("~ "))
            function = re.split(r"::|\s", columns[0])[-1]
            if len(columns) > 1 and columns[1].endswith((".cpp", ".hpp")):
                source = source_of(columns[1])
                if source is None:
                    faults.append(f"{place}: there is no one source {columns[1]}")
                    break
            sources.add(source)
            if not defines(code_of(source), function):
                faults.append(f"{place}: {source} does not define {function}")
            while callers and callers[-1][0] >= indentation:
                callers.pop()
            if called and callers and not re.search(rf"\b{re.escape(function)}\b", code_of(callers[-1][1])):
                faults.append(f"{place}: {callers[-1][1]} does not name {function}")
            callers.append((indentation, source))
        else:
            files = sum(source.endswith(".cpp") for source in sources)
            if files != promised:
                faults.append(f"{PAGE}: {title}: {files} files, not {promised}")
    if not count:
        faults.append(f"{PAGE} has no walks")
    for fault in faults:
        print(f"   {fault}")
    print(f"   {count} walks")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
