#!/usr/bin/env python3
"""filter.py FILE: prints a header or a page as Doxygen wants it, line by line.

Headers: the comment at the top becomes the description of the file, and a backslash in a comment is only a backslash.
Pages: each heading gets an anchor of its own, PAGE_HEADING, and links to headings use it. Links to files that are not part of
the site become plain text.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#:\s]*)(?:#([^)\s]*))?\)")


def header(text: str) -> str:
    lines, top = [], True
    for number, line in enumerate(text.splitlines()):
        code, slashes, comment = line.partition("//")
        if top and line.startswith("//"):
            comment = comment.lstrip("/")
            line = ("/*! \\file\n" if number == 0 else "") + comment.replace("\\", "\\\\").replace("*/", "* /")
        else:
            if top and number > 0:
                lines.append("*/")
            top = False
            if slashes and '"' not in code:
                line = code + slashes + comment.replace("\\", "\\\\")
        lines.append(line)
    return "\n".join(lines) + "\n"


def anchor(page: pathlib.Path, heading: str) -> str:
    """GitHub's anchor of a heading, behind the page's name, so that it is the only one of its name."""
    words = re.sub(r"[^a-z0-9_ -]", "", heading.lower()).replace(" ", "-")
    return f"{page.stem.lower()}_{words}"


def page(path: pathlib.Path, text: str) -> str:
    def link(found: re.Match) -> str:
        words, target, heading = found.groups()
        to = (path.parent / target).resolve() if target else path
        if to.suffix == ".md" and to.is_file():
            return f"[{words}](@ref {anchor(to, heading)})" if heading else f"[{words}]({to.relative_to(ROOT)})"
        # Doxygen does not know which one is meant if several headers have the same name.
        if to.suffix == ".hpp" and len(list((ROOT / "engine").rglob(to.name))) == 1:
            return f"[{words}](@ref {to.relative_to(ROOT)})"
        return words

    seen: dict = {}

    def heading(found: re.Match) -> str:
        name = anchor(path, found[2])
        seen[name] = seen.get(name, -1) + 1  # as GitHub does, which counts headings of the same words
        return f"{found[1]} {found[2]} {{#{name}{'-%d' % seen[name] if seen[name] else ''}}}"

    # Everything outside code, in which a link may be longer than a line.
    pieces = re.split(r"(^```.*?^```$|^    [^\n]*$)", text, flags=re.M | re.S)
    for i in range(0, len(pieces), 2):
        pieces[i] = LINK.sub(link, re.sub(r"^(#+) +(.*)$", heading, pieces[i], flags=re.M))
    return "".join(pieces)


def main() -> None:
    path = pathlib.Path(sys.argv[1]).resolve()
    text = path.read_text(encoding="utf-8")
    sys.stdout.write(page(path, text) if path.suffix == ".md" else header(text))


if __name__ == "__main__":
    main()
