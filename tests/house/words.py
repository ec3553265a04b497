#!/usr/bin/env python3
"""words.py FILE...: finds the words and constructions of refused-words.txt in comments, texts and pages.

In C++, C and shaders it searches comments and string literals only, so that code may use any name. It searches other
files as a whole. It also finds a construction that begins on one line and ends on the next.
"""
import bisect
import itertools
import pathlib
import re
import sys

LIST = pathlib.Path(__file__).with_name("refused-words.txt")
CODE = (".cpp", ".hpp", ".c", ".h", ".glsl", ".comp", ".vert", ".frag")
# A comment or a string literal. A character literal is neither, but may hold a quotation mark.
TOKEN = re.compile(r'(?P<prose>//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\2"|"(?:\\.|[^"\\\n])*")|' + r"(?<!\w)'(?:\\.|[^'\\\n])'", re.S)
# Everything between the last word of a line and the first word of the next line in a wrapped comment or text.
BREAK = re.compile(r'[ \t]*"?[ \t]*\n[ \t]*(?:/{2,}<?|#+|\*|")?[ \t]*')


def rules() -> list:
    """The expression and the advice of each line of the list."""
    lines = LIST.read_text(encoding="utf-8").splitlines()
    pairs = [line.split("\t") for line in lines if line and not line.startswith("#")]
    return [(re.compile(expression), advice) for expression, advice in pairs]


def without_code(text: str) -> str:
    """Comments and string literals, each on its line; a zero stands for the code between them."""
    pieces, at = [], 0
    for token in TOKEN.finditer(text):
        if token["prose"]:
            pieces += [re.sub(r"[^\s][^\n]*", "\0", text[at:token.start()]), token[0]]
            at = token.end()
    return "".join(pieces) + re.sub(r"[^\s][^\n]*", "\0", text[at:])


def main() -> int:
    refused, faults = rules(), []
    for path in map(pathlib.Path, sys.argv[1:]):
        if path.name in (LIST.name, "LICENSE"):
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture or a model
        lines = BREAK.split(without_code(text) if path.suffix in CODE else text)
        begins = list(itertools.accumulate((len(line) + 1 for line in lines), initial=0))
        prose = " ".join(lines)
        for expression, advice in refused:
            for found in expression.finditer(prose):
                faults.append((str(path), bisect.bisect_right(begins, found.start()), found[0].strip(), advice))
    for path, line, words, advice in sorted(faults):
        print(f'   {path}:{line}: "{words}"; instead: {advice}')
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
