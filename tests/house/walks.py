#!/usr/bin/env python3
"""walks.py: follows the chains of calls in docs/notes/forms.md through the sources.

A walk is a heading `### TITLE: N files` and the indented lines below it. Each line names a function, the source that defines it,
and, after two spaces, what it does; a line without a source has the source of the line above. A function stands deeper than its
caller; a line that begins with a tilde has none, since another thread or process goes on there, or the function was passed as a
value. A fault is a source that does not define its function, a caller's source that does not name it, or walks through more or
fewer sources than N."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/notes/forms.md"


def code_of(name):
    """The one source of that name, without its comments: a function that only a comment names is not called."""
    found = [folder / name for folder in (ROOT, ROOT / "engine", ROOT / "driver") if (folder / name).is_file()]
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", found[0].read_text(), flags=re.S) if len(found) == 1 else ""


def defines(text, function):
    """Whether a body or an initialiser list follows the function's parameters somewhere; C++ calls end in a semicolon."""
    for match in re.finditer(rf"\b{re.escape(function)}\s*\(", text):
        depth, at = 1, match.end()
        while at < len(text) and depth:
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        if re.match(r"[\sA-Za-z_:<>&*,-]*\{|\s*(const|noexcept|override|\s)*:[^:]", text[at:at + 200]):
            return True
    return False


def faults_of(title, promised, rows):
    callers, source, sources = [], None, set()  # callers: (indentation, source)
    for row in rows:
        indentation, called = len(row) - len(row.lstrip()), not row.strip().startswith("~ ")
        columns = re.split(r"\s{2,}", row.strip().removeprefix("~ "))
        function = re.split(r"::|\s", columns[0])[-1]
        if len(columns) > 1 and columns[1].endswith((".cpp", ".hpp")):
            source = columns[1]
        sources.add(source)
        if not defines(code_of(source), function):
            yield f"{title}: no one source {source} defines {function}"
        while callers and callers[-1][0] >= indentation:
            callers.pop()
        if called and callers and not re.search(rf"\b{re.escape(function)}\b", code_of(callers[-1][1])):
            yield f"{title}: {callers[-1][1]} does not name {function}"
        callers.append((indentation, source))
    files = sum(source.endswith(".cpp") for source in sources)
    if files != promised:
        yield f"{title}: {files} files, not {promised}"


def main():
    walks = re.findall(r"^### (.+): (\d+) files\n\n((?:    .+\n)+)", PAGE.read_text() + "\n", re.M)
    faults = [fault for title, promised, rows in walks for fault in faults_of(title, int(promised), rows.splitlines())]
    for fault in faults:
        print(f"   docs/notes/forms.md: {fault}")
    print(f"   {len(walks)} walks")
    return 1 if faults or not walks else 0


if __name__ == "__main__":
    sys.exit(main())
